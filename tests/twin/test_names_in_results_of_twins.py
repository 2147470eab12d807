"""Names of a machine's parts may hold what NetCDF does not take in the name of a variable."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray

from tautline.results.result import Result
from tautline.twin.series import Series


def of(name):
    return SimpleNamespace(name=name, unit="N")


@pytest.mark.parametrize("name", ["boom/tip.force[2]", "a/b/c", "/tip"])
def test_what_a_part_with_a_slash_in_its_name_measures_is_found_by_all_readers(tmp_path, name):
    beside = name.replace("/", "_")  # a name that another part has already
    plan = SimpleNamespace(unknowns=[of(name)], inputs=[], measured=[of(beside), of(name)], keep=[])
    names = SimpleNamespace(shapes={})
    scene, watch = SimpleNamespace(units="si"), SimpleNamespace(names=lambda: ["overload"])
    twin = SimpleNamespace(mark="", plan=plan, plan_names=names, units={}, scene=scene, watch=watch)
    series = Series(tmp_path / "tw.nc", twin)
    numbers = {
        "measured": {beside: 1.0, name: 2.0}, "residuals": {beside: 3.0, name: 4.0},
        "outputs": {beside: 5.0, name: 6.0}, "estimates": {name: {"value": 7.0, "sd": 8.0}},
    }  # fmt: skip
    series.add({"time": 0.0, **numbers, "inputs": {}, "alarms": [], "health": "good", "lag": 0.0})
    series.finish("done")
    with xarray.open_dataset(tmp_path / "tw.nc", decode_times=False) as data:
        found = {str(key): one.item() for key, one in data.data_vars.items()}
        assert data[f"residual {beside}_"].attrs["long_name"] == f"{name}, measured less expected"
    assert sorted(x for key, x in found.items() if key not in ("alarms", "alarm_state", "health", "lag")) == list(
        np.arange(1.0, 9.0)
    )
    assert found[f"residual {beside}_"] == 4.0 and found[f"estimate {beside}"] == 7.0
    assert len(Result.read(tmp_path / "tw.nc").variables) >= len(found)
