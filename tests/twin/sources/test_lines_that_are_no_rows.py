"""Objects and other lines among the rows of a table: they end no stream, and many of them in a row are told."""

import io

import pytest

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.stream import Stream

ROWS = [f"{0.1 * k:.1f},{k}" for k in range(60)]


def source(way, lines, tmp_path):
    text = "\n".join(["time,a", *lines]) + "\n"
    if way == "stream":
        return Stream(io.StringIO(text), ["a"])
    (tmp_path / "r.csv").write_text(text)
    return CsvFile(tmp_path / "r.csv", ["a"])


def read(one):
    found = []
    while not one.ended:
        if (record := one.poll(1.0)) is not None:
            found.append(record.values["a"])
    return found


@pytest.mark.parametrize("way", ["stream", "file"])
def test_an_object_among_rows_of_a_table_ends_no_stream(way, tmp_path):
    one = source(way, [*ROWS[:30], '{"event": "shift change"}', *ROWS[30:]], tmp_path)
    assert read(one) == list(range(60))
    assert one.refused == 1 and not one.notes


@pytest.mark.parametrize("way", ["stream", "file"])
def test_many_lines_in_a_row_that_cannot_be_read_are_told_once(way, tmp_path):
    one = source(way, [*ROWS[:30], *(30 * ['{"event": "shift change"}']), *ROWS[30:]], tmp_path)
    assert read(one) == list(range(60))
    (note,) = one.notes
    assert "the last 20 lines could not be read" in note and "shift change" in note


def test_objects_behind_a_header_without_rows_are_told_too(tmp_path):
    one = source("stream", 30 * ['{"time": 1, "a": 2}'], tmp_path)
    read(one)
    assert any("could not be read" in note for note in one.notes)


def test_objects_before_any_header_are_read_as_objects():
    one = Stream(io.StringIO('{"time": 0, "a": 1}\nnone\n{"time": 1, "a": 2}\n'), ["a"])
    assert read(one) == [1, 2] and one.refused == 1
