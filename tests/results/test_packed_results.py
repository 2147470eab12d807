"""Results that another program has packed by the CF conventions are read as xarray reads them."""

import h5py
import numpy as np
import pytest
import xarray

from tautline.results import result as reading
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.variable import Variable

FRAMES, NODES = 11, 3
LOAD, GAP = 72266.74, 4
"""Largest tension, N, and the frame at which none is known."""
SHORT = {"dtype": "int16", "scale_factor": 10.0, "add_offset": 5.0e4, "_FillValue": -32768}
PACKED = {
    "tension": SHORT,
    "time": {"dtype": "int32", "scale_factor": 0.1},
    "position": {"dtype": "int16", "scale_factor": np.float32(0.001), "add_offset": np.float32(0.0)},
    "slipping": {"dtype": "int8", "_FillValue": 7},
    "pressure": {"dtype": "float32", "missing_value": np.float32(-999.0)},
}


@pytest.fixture
def plain(tmp_path):
    """A result of ours: a tension with a gap, and other variables of other types."""
    path = tmp_path / "plain.nc"
    names = {"time": ("time",), "tension": ("time", "node"), "position": ("time", "node")}
    names |= {"slipping": ("time",), "pressure": ("time",)}
    time = 0.1 * np.arange(FRAMES)
    tension = np.linspace(5.0e3, LOAD, FRAMES * NODES).reshape(FRAMES, NODES)
    tension[GAP, 1] = np.nan
    values = {
        "time": time, "tension": tension, "position": np.cos(tension * 1e-4), "pressure": np.sin(time),
        "slipping": (np.arange(FRAMES) % 2).astype(np.int8),
    }  # fmt: skip
    values["position"][GAP, 1] = 0.0
    values["pressure"][GAP] = np.nan
    variables = [Variable(name, dims, "", "") for name, dims in names.items()]
    coordinates = {"node": (("node",), np.arange(1, NODES + 1), "", "")}
    with Store(path, variables, coordinates, {}) as store:
        store.append(values)
        store.finish()
    return path


@pytest.fixture
def packed(plain, tmp_path):
    path = tmp_path / "packed.nc"
    with pytest.warns(xarray.SerializationWarning, match="position"):  # one variable has no mark of what is missing
        Result.read(plain).data.to_netcdf(path, encoding=PACKED)
    return path


def same(ours, theirs):
    assert ours.dtype == theirs.dtype
    assert np.array_equal(ours, theirs, equal_nan=ours.dtype.kind == "f")


@pytest.mark.parametrize("name", PACKED)
def test_a_packed_variable_is_read_as_xarray_reads_it(packed, name):
    same(Result.read(packed)[name], xarray.load_dataset(packed)[name].values)


def test_what_was_packed_is_what_it_was_before_to_half_a_step_and_missing_where_it_was_missing(plain, packed):
    before, after = Result.read(plain), Result.read(packed)
    assert np.allclose(after["tension"], before["tension"], rtol=0.0, atol=5.0, equal_nan=True)
    assert np.isnan(after["tension"][GAP, 1]) and np.isnan(after["pressure"][GAP])
    assert np.allclose(after.time, before.time, atol=1e-12)


@pytest.mark.parametrize("large", [False, True])
def test_the_data_set_holds_the_same_whether_it_is_read_at_once_or_when_it_is_used(packed, monkeypatch, large):
    if large:
        monkeypatch.setattr(reading, "LARGE", 0)
    data, theirs = Result.read(packed).data, xarray.load_dataset(packed)
    for name in PACKED:
        same(data[name].values, theirs[name].values)


def test_parts_of_a_packed_result_have_the_values_of_the_whole(packed):
    whole = Result.read(packed)
    late, some = whole.from_time(0.5), whole.of_frames(np.array([0, 7]))
    same(late["tension"], whole["tension"][5:])
    same(some["tension"], whole["tension"][[0, 7]])


def test_a_time_that_goes_back_is_seen_in_packed_times_too(packed):
    with h5py.File(packed, "r+") as file:
        file["time"].attrs["scale_factor"] = -0.1
    with pytest.raises(ResultError, match=r"its time goes from -?0 s to -0\.1 s"):
        Result.read(packed)


def test_packing_that_makes_no_sense_is_refused_with_the_variable_and_what_the_file_says(packed):
    with h5py.File(packed, "r+") as file:
        file["tension"].attrs["scale_factor"] = "ten"
    with pytest.raises(ResultError, match="'tension' is packed in a way that cannot be undone: scale_factor = ten"):
        Result.read(packed)["tension"]


def test_a_result_of_ours_is_read_as_it_is_stored_and_never_decoded(plain, monkeypatch):
    monkeypatch.setattr("tautline.results.packed._decoded", None)
    ours = Result.read(plain)
    with h5py.File(plain) as file:
        for name in ours.variables:
            same(ours[name], file[name][...])


def test_a_copy_that_xarray_has_not_packed_is_not_decoded_either(plain, tmp_path, monkeypatch):
    monkeypatch.setattr("tautline.results.packed._decoded", None)
    ours = Result.read(plain)
    ours.data.to_netcdf(tmp_path / "copy.nc")  # xarray marks NaN as what stands for NaN
    same(Result.read(tmp_path / "copy.nc")["tension"], ours["tension"])
