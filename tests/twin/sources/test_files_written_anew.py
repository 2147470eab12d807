"""A file that is written anew, or that another one takes the place of, while it is replayed."""

import pytest

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.record import SourceStopped

ROWS = 4000


@pytest.fixture
def replayed(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("time,a\n" + "".join(f"{k / 10},{k}\n" for k in range(ROWS)))
    source = CsvFile(path, ["a"])
    assert [source.poll(0.0).values["a"] for _ in range(5)] == list(range(5))
    return path, source


def rest(source):
    found = []
    while not source.ended:
        if (record := source.poll(0.0)) is not None:
            found.append(record.values["a"])
    return found


@pytest.mark.parametrize("rows", [1, 3 * ROWS])
def test_no_row_is_spliced_of_two_files_and_that_is_told(replayed, rows):
    path, source = replayed
    path.write_text("time,a\n" + rows * "0.5,77\n")
    found = []
    with pytest.raises(SourceStopped, match="was written anew while it was read"):
        while True:
            found.append(source.poll(0.0).values["a"])
    assert found == list(range(5, 5 + len(found)))


def test_a_file_that_only_grows_is_read_to_its_end(replayed):
    path, source = replayed
    with path.open("a") as file:
        file.write(f"{ROWS / 10},{ROWS}\n")
    assert rest(source) == list(range(5, ROWS + 1)) and not source.notes


def test_a_file_that_was_renamed_is_read_to_its_end_and_the_other_one_is_told(replayed):
    path, source = replayed
    path.rename(path.with_suffix(".1"))
    path.write_text("time,a\n0,7\n")
    assert rest(source) == list(range(5, ROWS))
    (note,) = source.notes
    assert "another file has this name by now" in note
