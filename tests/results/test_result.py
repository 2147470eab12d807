"""What is put into a store comes out of the result, by either way of reading it."""

import contextlib
import subprocess
import sys

import h5py
import netCDF4
import numpy as np
import pytest
import xarray

from tautline.results.errors import ResultError
from tautline.results.headline import Figure
from tautline.results.output_path import check_target
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.variable import Variable

VARIABLES = [
    Variable("tension", ("time", "link"), "N", "tension of a link"),
    Variable("stuck", ("time", "body"), "", "whether a body sticks"),
    Variable("hook_load", ("time",), "N", "hook load"),
]
COORDINATES = {
    "axis": np.array(["north", "east", "down"]),
    "rest_depth": ("body", np.array([0.0, 10.0, 20.0]), "m", "depth at rest"),
}
ATTRIBUTES = {"scene": "title: J-well, 90°\n" * 8000, "method": "rk4", "step": 1e-3, "nothing": None, "flag": True}
HEADLINE = {"peak": Figure(1.5e6, "N", "largest hook load"), "odd": Figure(float("nan"), "", "none")}
RESTART = {"q": np.arange(12.0).reshape(3, 4), "n": np.array(7), "empty": np.zeros(0), "on": np.array([True, False])}


def frames(first, count):
    time = 0.1 * np.arange(first, first + count)
    tension = np.outer(np.sin(time), [1.0, 2.0])
    return {"time": time, "tension": tension, "stuck": np.outer(time > 0.3, [1, 1, 1]) > 0, "hook_load": tension[:, 0]}


@pytest.fixture
def stored(tmp_path):
    """Path of a result."""
    with Store(tmp_path / "own.nc", VARIABLES, COORDINATES, ATTRIBUTES) as store:
        store.append(frames(0, 50))
        store.finish()
    return tmp_path / "own.nc"


@pytest.fixture(params=["file", "memory"])
def result(request, tmp_path):
    store = Store(tmp_path / "a.nc" if request.param == "file" else None, VARIABLES, COORDINATES, ATTRIBUTES)
    for first in range(0, 50, 5):
        store.append(frames(first, 5))
    return store.finish({"status": "done", "steps": 5000, "headline": HEADLINE}, restart=RESTART)


def test_a_result_lists_its_variables_as_a_mapping_does(result):
    assert list(result) == list(result.variables) and len(result) == len(result.variables) > 0
    assert all(name in result and len(result[name]) for name in result) and 0 not in result
    assert result.keys() == set(result)
    for arrays in (dict(result), dict(**result)):
        assert list(arrays) == list(result)
        np.testing.assert_array_equal(arrays["hook_load"], frames(0, 50)["hook_load"])


def test_a_result_is_true_and_nothing_of_it_is_read_to_see_that(result, monkeypatch):
    monkeypatch.setattr(Result, "variables", property(lambda result: pytest.fail("the variables were read")))
    assert result


def test_numpy_access_gives_the_frames(result):
    np.testing.assert_array_equal(result["tension"], frames(0, 50)["tension"])
    assert result["tension"].dtype == np.float64
    assert list(result["axis"]) == ["north", "east", "down"]
    assert "tension" in result and "body" not in result
    assert result.variables["tension"] == VARIABLES[0]


def test_xarray_gives_names_dimensions_units_and_plain_seconds(result):
    data = result.data
    assert data["tension"].dims == ("time", "link")
    assert data["tension"].attrs["units"] == "N"
    assert data["tension"].attrs["long_name"] == "tension of a link"
    assert data["time"].dtype == np.float64 and data["time"].attrs["units"] == "s"
    assert data["rest_depth"].dims == ("body",)
    assert float(data["tension"].sel(time=1.0, method="nearest")[1]) == 2 * np.sin(1.0)


def test_attributes_of_any_length_and_letters_come_back(result):
    assert result.attributes["scene"] == ATTRIBUTES["scene"]
    assert result.attributes["step"] == 1e-3 and result.attributes["steps"] == 5000
    assert result.attributes["status"] == "done"
    assert "nothing" not in result.attributes and result.attributes["flag"] == 1


def test_a_result_in_memory_has_the_attributes_of_the_same_one_in_a_file(tmp_path):
    """The reference is what the other way holds; that both are what was put in is seen for each attribute below."""
    found = {
        "headline": HEADLINE, "warnings": ["small steps"], "limits": [{"name": "pull", "passed": np.bool_(True)}],
        "start": {"stable": True, "moved": np.float64(0.25)}, "step_error": {"others": (1e-3, 5e-4), "force": np.nan},
        "accuracy": {"met": None}, "windows": [], "steps": np.int64(7), "place": (1, 2), "title": '["no list"]',
    }  # fmt: skip
    both = []
    for path in (None, tmp_path / "a.nc"):
        store = Store(path, VARIABLES, COORDINATES, ATTRIBUTES)
        store.append(frames(0, 5), restart=RESTART)
        both.append(store.finish(found))
    memory, file = both[0], Result.read(tmp_path / "a.nc")
    assert memory.attributes == file.attributes
    assert memory.attributes["warnings"] == ["small steps"] == memory.warnings
    assert memory.attributes["start"] == {"stable": True, "moved": 0.25}
    assert memory.step_error == {"others": [1e-3, 5e-4], "force": None}
    assert memory.attributes["title"] == '["no list"]' and memory.attributes["place"] == "[1, 2]"
    for name in ("headline", "warnings", "limits", "step_error", "accuracy"):
        assert getattr(memory, name) == getattr(file, name) == file.attributes[name]
    assert memory.restart.keys() == file.restart.keys() == RESTART.keys()
    assert {name: array.dtype for name, array in memory.restart.items()} == {
        name: array.dtype for name, array in file.restart.items()
    }
    assert memory.variables == file.variables
    assert {name: memory[name].dtype for name in memory.variables} == {
        name: file[name].dtype for name in file.variables
    }
    xarray.testing.assert_identical(memory.data, file.data)


@pytest.mark.parametrize("engine", [None, "h5netcdf", "netcdf4"])
def test_the_data_set_of_a_result_can_be_stored_and_is_a_result_again(result, tmp_path, engine):
    """None is what a user gets who asks for no engine: it depends on what is installed."""
    result.data.to_netcdf(tmp_path / "copy.nc", engine=engine)
    copy = Result.read(tmp_path / "copy.nc")
    assert copy.variables == result.variables
    assert all(type(value) is type(result.attributes[key]) for key, value in copy.attributes.items())
    assert check_target(tmp_path / "copy.nc")
    np.testing.assert_array_equal(copy["tension"], frames(0, 50)["tension"])
    assert copy.headline == result.headline and copy.attributes == result.attributes


@pytest.mark.parametrize("engine", [None, "h5netcdf", "netcdf4"])
def test_a_data_set_that_is_stored_onto_its_own_file_does_not_lose_the_run(stored, engine):
    Result.read(stored).data.to_netcdf(stored, engine=engine)
    again = Result.read(stored)
    np.testing.assert_array_equal(again["tension"], frames(0, 50)["tension"])
    again.data["tension"].to_netcdf(stored, engine=engine)
    with h5py.File(stored) as file:
        np.testing.assert_array_equal(file["tension"][...], frames(0, 50)["tension"])


@pytest.mark.parametrize("part", [lambda data: data, lambda data: data[["tension"]], lambda data: data.isel(time=0)])
def test_a_large_result_is_read_as_it_is_used_and_refuses_to_be_stored_onto_itself(stored, monkeypatch, part):
    whole, before = Result.read(stored).data, stored.read_bytes()
    monkeypatch.setattr("tautline.results.result.LARGE", 0)
    data = Result.read(stored).data
    xarray.testing.assert_identical(xarray.Dataset(data.variables, attrs=data.attrs), whole)
    with pytest.raises(ResultError, match="would be lost"):
        part(data).to_netcdf(stored)
    assert stored.read_bytes() == before
    part(data).to_netcdf(stored.with_name("copy.nc"))


def test_nothing_that_a_result_gives_out_changes_it(result):
    before = result["tension"].copy()
    for array in (result["tension"], result["rest_depth"], result.restart["q"]):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = -999.0
    with contextlib.suppress(ValueError):
        result.data["tension"].values[...] = -999.0  # what was read of a file may be written to
    result.headline["peak"]["value"] = 0.0
    np.testing.assert_array_equal(result["tension"], before)
    np.testing.assert_array_equal(result.restart["q"], RESTART["q"])
    assert result.headline["peak"]["value"] == 1.5e6


def test_a_result_at_a_prompt_tells_its_status_its_frames_and_its_variables_with_dimensions_and_units(result):
    lines = repr(result).splitlines()
    assert lines[0].startswith("Result(") and lines[1] == "  status: done, 50 frames"
    assert set(lines[2:]) == {
        "  (time, link) tension [N]", "  (time, body) stuck", "  (time) hook_load [N]", "  (body) rest_depth [m]",
    }  # fmt: skip


def test_a_result_whose_file_is_gone_still_tells_its_name(tmp_path):
    store = Store(tmp_path / "a.nc", VARIABLES, COORDINATES, ATTRIBUTES)
    store.append(frames(0, 5))
    found = Result.read(store.finish({"status": "done"}).path)
    (tmp_path / "a.nc").unlink()
    assert repr(found) == f"Result({str(tmp_path / 'a.nc')!r})"


def test_headline_keeps_value_unit_and_text_and_has_no_nan(result):
    assert result.headline["peak"] == {"value": 1.5e6, "unit": "N", "text": "largest hook load"}
    assert result.headline["odd"]["value"] is None


def test_restart_state_is_kept_bit_for_bit(result):
    assert result.restart.keys() == RESTART.keys()
    for name, values in RESTART.items():
        np.testing.assert_array_equal(result.restart[name], values)


def test_an_unknown_variable_is_named_with_those_there_are(result):
    with pytest.raises(ResultError, match=r"has no variable 'tensoin'; it has .*tension"):
        result["tensoin"]


def test_plain_xarray_reads_the_file_and_its_restart_group(tmp_path):
    with Store(tmp_path / "a.nc", VARIABLES, COORDINATES, ATTRIBUTES) as store:
        store.append(frames(0, 5))
        store.finish(restart=RESTART)
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as data:
        assert data.sizes == {"time": 5, "link": 2, "body": 3, "axis": 3}
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf", group="restart") as data:
        np.testing.assert_array_equal(data["q"].values, RESTART["q"])


def test_the_netcdf_library_reads_what_was_written_and_the_same_as_h5netcdf(tmp_path):
    """Unidata's netCDF-C, which shares nothing with how the file was laid out."""
    with Store(tmp_path / "a.nc", VARIABLES, COORDINATES, ATTRIBUTES) as store:
        store.append(frames(0, 5))
        store.append(frames(5, 2))
        store.finish(restart=RESTART)
    with netCDF4.Dataset(tmp_path / "a.nc") as file:
        assert {name: len(dim) for name, dim in file.dimensions.items()} == {"time": 7, "link": 2, "body": 3, "axis": 3}
        assert [name for name, dim in file.dimensions.items() if dim.isunlimited()] == ["time"]
        for variable in VARIABLES:
            stored = file[variable.name]
            assert stored.dimensions == variable.dims
            assert getattr(stored, "units", "") == variable.units
            assert getattr(stored, "long_name", "") == variable.long_name
            np.testing.assert_array_equal(
                stored[:], np.concatenate([frames(0, 5)[variable.name], frames(5, 2)[variable.name]])
            )
        for name, values in RESTART.items():
            np.testing.assert_array_equal(file["restart"][name][:], values)
        assert file.format.startswith("tautline-result") and file.data_model == "NETCDF4"
    opened = [xarray.open_dataset(tmp_path / "a.nc", engine=engine) for engine in ("h5netcdf", "netcdf4")]
    assert opened[0].identical(opened[1])
    for data in opened:
        data.close()


def test_a_variable_named_after_a_dimension_that_is_not_its_own_is_refused_before_anything_is_written(tmp_path):
    wrong = {"axis": ("body", np.zeros(3), "", ""), "place": ("axis", np.zeros(2), "", "")}
    with Store(tmp_path / "a.nc", VARIABLES, wrong) as store:
        with pytest.raises(ValueError, match="axis: named after a dimension"):
            store.append(frames(0, 1))
    assert not list(tmp_path.iterdir())


def test_time_can_grow_without_limit(tmp_path):
    with Store(tmp_path / "a.nc", VARIABLES) as store:
        store.append(frames(0, 1))
    with h5py.File(tmp_path / "a.nc") as file:
        assert file["tension"].maxshape == (None, 2)


def test_a_batch_may_be_reused_by_its_owner(tmp_path):
    buffer = frames(0, 5)
    with Store(tmp_path / "a.nc", VARIABLES) as store:
        for first in range(0, 20, 5):
            for name, values in frames(first, 5).items():
                buffer[name][...] = values
            store.append(buffer)
        result = store.finish()
    np.testing.assert_array_equal(result["tension"], frames(0, 20)["tension"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tension": np.zeros((5, 3))}, "tension: shape"),
        ({"hook_load": np.zeros(4)}, "hook_load: shape"),
        ({"extra": np.zeros(5)}, "unknown extra"),
    ],
)
def test_a_batch_of_another_shape_is_refused_and_named(tmp_path, change, message):
    with Store(tmp_path / "a.nc", VARIABLES) as store:
        store.append(frames(0, 5))
        with pytest.raises(ValueError, match=message):
            store.append(frames(5, 5) | change)
        store.append(frames(5, 5))
        assert len(store.finish().time) == 10


def test_dimensions_that_disagree_are_refused_before_anything_is_written(tmp_path):
    store = Store(tmp_path / "a.nc", VARIABLES, {"body": np.arange(4)})
    with pytest.raises(ValueError, match="stuck: body has size 3, but 4 in body"):
        store.append(frames(0, 5))
    store.close()
    assert not list(tmp_path.iterdir())


def other_netcdf(path):
    with h5py.File(path, "w") as file:
        file["x"] = 1


def without_frames(path):
    with Store(path, VARIABLES, {}, ATTRIBUTES) as store:
        store.append(frames(0, 1))
    with h5py.File(path, "r+") as file:
        file["time"].resize(0, 0)


def cut_short(path):
    with Store(path, VARIABLES, {}, ATTRIBUTES) as store:
        store.append(frames(0, 100))
    path.write_bytes(path.read_bytes()[:5000])


def with_time(path, value):
    """Five frames, of which the time of the fourth was changed, s."""
    with Store(path, VARIABLES, {}, ATTRIBUTES) as store:
        store.append(frames(0, 5))
    with h5py.File(path, "r+") as file:
        file["time"][:] = [0.0, 0.1, 0.2, value, 0.4]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: None, "there is no such file"),
        (lambda path: path.mkdir(), "is a folder"),
        (lambda path: path.touch(), "is empty"),
        (lambda path: path.write_text("title: a scene\n"), "is not a NetCDF-4 file"),
        (other_netcdf, "not a Tautline result"),
        (without_frames, "has no frame"),
        (lambda path: with_time(path, 0.05), r"is damaged: its time goes from 0\.2 s to 0\.05 s at frame 4"),
        (cut_short, "is damaged"),
    ],
)
def test_what_is_no_result_is_refused_with_its_cause(tmp_path, make, message):
    make(tmp_path / "x.nc")
    with pytest.raises(ResultError, match=message) as caught:
        Result.read(tmp_path / "x.nc")
    assert caught.value.cure


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing/a.nc", "there is no folder"),
        (".", "is a folder"),
        ("scene.yaml", "is not a result"),
        ("scene.yaml/a.nc", "is a file, not a folder"),
        ("scene.yaml/b/a.nc", r"scene\.yaml is a file, not a folder"),
        ("a" * 300 + ".nc", "cannot be written"),
        ("a\0.nc", "cannot be written"),
    ],
)
def test_a_result_that_cannot_be_written_is_refused_before_the_run(tmp_path, name, message):
    (tmp_path / "scene.yaml").write_text("title: precious\n")
    with pytest.raises(ResultError, match=message):
        check_target(tmp_path / name)
    with pytest.raises(ResultError, match=message):
        Store(tmp_path / name, VARIABLES)
    assert [file.name for file in tmp_path.iterdir()] == ["scene.yaml"]


@pytest.mark.parametrize("name", ["run.csv", "run.PNG", "scene.yaml"])
def test_a_result_is_not_named_as_another_kind_of_file(tmp_path, name):
    with pytest.raises(ResultError, match=r"another kind of file.*name it (run|scene)\.nc"):
        check_target(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_numpy_access_does_not_load_xarray(tmp_path):
    with Store(tmp_path / "a.nc", VARIABLES) as store:
        store.append(frames(0, 5))
        store.finish()
    code = "import sys; from tautline.results.result import Result; Result.read(sys.argv[1])['tension'];"
    code += "sys.exit('xarray' in sys.modules or 'pandas' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code, tmp_path / "a.nc"]).returncode == 0
