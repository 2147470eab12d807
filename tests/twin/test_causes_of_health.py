"""Why the health of a twin is not good stands in its lines, and the result has the state of each alarm by its name."""

from pathlib import Path

import numpy as np
import xarray
from twin.rehearsal import CALM, hoist, rows_of, weight_twin

from tautline.results.result import Result
from tautline.twin.series import Series


def told(twin, rows):
    return [line for stamp, readings in rows for line in twin.add(stamp, readings)]


def test_health_is_good_where_and_only_where_no_cause_is_told_and_a_sensor_that_stands_is_named():
    twin, rows = weight_twin(start="5 t"), rows_of(hoist(CALM), end=14.0)
    for stamp, readings in rows:
        if stamp > 9.0:
            readings["rope_tension"] = 49.0  # a cell that is stuck
    lines = told(twin, rows)
    assert all((line["health"] == "good") == (line["causes"] == []) for line in lines)
    assert "good" in {line["health"] for line in lines}
    late = [line for line in lines if line["time"] > 12.5]
    assert late and all(any("rope_tension" in cause for cause in line["causes"]) for line in late)


def test_a_result_has_the_state_of_each_alarm_by_its_name(tmp_path):
    twin, rows = weight_twin(start="5 t"), rows_of(hoist(CALM), end=13.0)
    for stamp, readings in rows:
        if stamp > 9.0:
            readings["rope_tension"] = 49.0  # a cell that is stuck
    path = Path(tmp_path / "twin.nc")
    series, lines = Series(path, twin), told(twin, rows)
    for line in lines:
        series.add(line)
    series.finish("done")
    with xarray.open_dataset(path, decode_times=False) as data:
        names, states = [str(name) for name in data["alarm"].values], data["alarm_state"].values
    assert {"overload", "irregular", "rope_tension lost", "behind the machine", "two-blocking ahead"} <= set(names)
    for line, row in zip(lines, states, strict=True):
        stood = {one["name"]: 2 if one["known"] else 1 for one in line["alarms"]}
        assert {name: int(state) for name, state in zip(names, row, strict=True) if state} == stood
    assert np.any(states[:, names.index("rope_tension stuck")] == 2)
    assert Result.read(path).plot.alarms().axes
