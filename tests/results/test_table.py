"""Tables of comma-separated values: every number of a result, bit for bit, under a title with its unit."""

import csv
import hashlib
import resource
from pathlib import Path

import numpy as np
import pytest

from tautline.results.errors import ResultError, WriteError
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.tables.table import write_csv
from tautline.results.variable import Variable


def stored(path=None, frames=40):
    """Numbers of every size, some of which are not finite; names with commas."""
    rng = np.random.default_rng(7)

    def any_number(*shape):
        return rng.normal(size=shape) * 10.0 ** rng.integers(-300, 300, shape)

    values = {
        "time": np.cumsum(rng.uniform(0.0, 0.1, frames)),
        "hook_load": any_number(frames),
        "position": any_number(frames, 3, 3),
        "multiplier": any_number(frames, 2),
        "rough": any_number(frames, 3),
        "count": rng.integers(-9, 9, frames),
    }
    values["hook_load"][: min(frames, 3)] = [np.nan, np.inf, -0.0][: min(frames, 3)]
    units = {"time": "s", "hook_load": "N", "position": "m", "multiplier": "N"}
    dims = {"position": ("node", "axis"), "multiplier": ("constraint",), "rough": ("place",)}
    variables = [Variable(name, ("time", *dims.get(name, ())), units.get(name, ""), name) for name in values]
    coordinates = {
        "node": ("node", np.array([4, 7, 9]), "", "node"),
        "axis": ("axis", np.array(["x", "y", "z"]), "", "axis"),
        "constraint": ("constraint", np.array(["r = r, node 4", 'the "other"']), "", "equation"),
        "arc_length": ("node", any_number(3), "m", "distance"),
        "well": ("node", any_number(3, 3), "m", "places"),
    }
    coordinates["well"] = (("node", "axis"), *coordinates["well"][1:])
    with Store(path, variables, coordinates, {"scene": ""}) as store:
        store.append(values)
        return store.finish()


def read(file):
    """Titles, and columns as text."""
    with file.open(newline="") as lines:
        titles, *rows = list(csv.reader(lines))
    return titles, list(zip(*rows, strict=True))


def same(text, array):
    """Whether the texts of a column read back as an array, to the last bit."""
    back = np.array([float(x) for x in text]).astype(array.dtype)
    return back.tobytes() == np.ascontiguousarray(array).tobytes() or np.array_equal(back, array, equal_nan=True)


def test_numbers_at_each_time_share_a_table_and_read_back_bit_for_bit(tmp_path):
    result = stored()
    assert write_csv(result, tmp_path / "run.csv")[0] == tmp_path / "run.csv"
    titles, columns = read(tmp_path / "run.csv")
    assert titles == ["time [s]", "hook_load [N]", "count"]
    for name, column in zip(("time", "hook_load", "count"), columns, strict=True):
        assert same(column, result[name]), name
    back = np.genfromtxt(tmp_path / "run.csv", delimiter=",", skip_header=1)
    np.testing.assert_array_equal(back[:, 0], result.time)


def test_a_variable_of_nodes_has_a_table_of_its_own_with_the_time_first(tmp_path):
    result = stored()
    write_csv(result, tmp_path / "run.csv")
    titles, columns = read(tmp_path / "run_position.csv")
    assert titles == ["time [s]", *(f"node {i} {axis} [m]" for i in (4, 7, 9) for axis in "xyz")]
    assert same(columns[0], result.time)
    for k, column in enumerate(columns[1:]):
        assert same(column, result["position"][:, k // 3, k % 3])


def test_titles_hold_commas_and_quotes_and_places_without_names_are_counted(tmp_path):
    write_csv(stored(), tmp_path / "run.csv", ("multiplier", "rough"))
    assert read(tmp_path / "run_multiplier.csv")[0] == ["time [s]", "r = r, node 4 [N]", 'the "other" [N]']
    assert read(tmp_path / "run_rough.csv")[0] == ["time [s]", "place 1", "place 2", "place 3"]


def test_what_does_not_change_with_time_is_listed_by_its_dimension(tmp_path):
    result = stored()
    files = write_csv(result, tmp_path / "run.csv")
    titles, columns = read(tmp_path / "run_by_node.csv")
    assert titles == ["node", "arc_length [m]", "well x [m]", "well y [m]", "well z [m]"]
    assert columns[0] == ("4", "7", "9") and same(columns[1], result["arc_length"])
    assert same(columns[3], result["well"][:, 1])
    assert [file.name for file in files] == [
        "run.csv", "run_position.csv", "run_multiplier.csv", "run_rough.csv", "run_by_node.csv",
    ]  # fmt: skip
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(file.name for file in files)


def test_only_what_is_asked_for_is_written(tmp_path):
    files = write_csv(stored(), tmp_path / "run", ("hook_load", "position"))
    assert [file.name for file in files] == ["run.csv", "run_position.csv"]
    assert read(files[0])[0] == ["time [s]", "hook_load [N]"]


def test_an_unknown_variable_is_refused_with_those_that_exist(tmp_path):
    with pytest.raises(ResultError, match=r"no variable 'hookload'.*hook_load, position"):
        write_csv(stored(), tmp_path / "run.csv", ("hookload",))
    assert not list(tmp_path.iterdir())


def test_one_frame_is_one_row(tmp_path):
    result = stored(frames=1)
    write_csv(result, tmp_path / "run.csv")
    assert len((tmp_path / "run_position.csv").read_text().splitlines()) == 2


def test_the_result_stays_as_it_is(tmp_path):
    stored(tmp_path / "run.nc")
    before = hashlib.sha256((tmp_path / "run.nc").read_bytes()).hexdigest()
    write_csv(Result.read(tmp_path / "run.nc"), tmp_path / "run.csv")
    assert hashlib.sha256((tmp_path / "run.nc").read_bytes()).hexdigest() == before


def test_a_missing_folder_and_a_folder_in_the_way_are_refused(tmp_path):
    with pytest.raises(ResultError, match="no folder"):
        write_csv(stored(), tmp_path / "none" / "run.csv")
    (tmp_path / "run.csv").mkdir()
    with pytest.raises(ResultError, match="is a folder"):
        write_csv(stored(), tmp_path / "run.csv")


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="there is no folder that nobody may write to")
def test_a_folder_that_cannot_be_written_to_is_bad_input():
    with pytest.raises(ResultError, match=r"/proc/run\.csv: cannot be written") as refused:
        write_csv(stored(), "/proc/run.csv")
    assert not isinstance(refused.value, WriteError)


def test_a_full_disk_leaves_the_earlier_table(tmp_path):
    """A limit on the size of files stands in for the disk."""
    earlier = "time [s],hook_load [N]\n0.0,1.0\n"
    (tmp_path / "run.csv").write_text(earlier)
    result = stored(frames=4000)
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limit[1]))
    try:
        with pytest.raises(WriteError, match="cannot be written"):
            write_csv(result, tmp_path / "run.csv")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("run.csv", earlier)]


@pytest.mark.parametrize(
    "mine",
    [
        "name,phone\nAnn,12\n",
        "time [s],pressure [bar]\n0,1\n",
        "time [s],pressure [bar],hook_load [kN]\n",
        "\nnotes\n",
        "a" * 200_000,
        "\x00\x01\x02",
    ],
)
@pytest.mark.parametrize("name", ["run.csv", "run_position.csv", "run_by_node.csv"])
def test_a_table_that_export_would_not_write_is_not_replaced_and_nothing_is_written(tmp_path, mine, name):
    (tmp_path / name).write_text(mine)
    with pytest.raises(ResultError, match="exists and is no table of such a result: it would be lost"):
        write_csv(stored(), tmp_path / "run.csv")
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [(name, mine)]


def test_earlier_tables_are_replaced_by_those_of_other_variables_and_of_another_run(tmp_path):
    write_csv(stored(), tmp_path / "run.csv", ("count",))
    files = write_csv(stored(frames=7), tmp_path / "run.csv")
    assert write_csv(stored(frames=9), tmp_path / "run.csv") == files
    write_csv(stored(), tmp_path / "run.csv", ("hook_load",))
    assert read(tmp_path / "run.csv")[0] == ["time [s]", "hook_load [N]"]
    (tmp_path / "run.csv").write_text("")
    write_csv(stored(), tmp_path / "run.csv", ("hook_load",))
