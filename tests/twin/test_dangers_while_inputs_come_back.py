"""Two blocks that come together by where the winch is: foreseen whatever becomes of an input shortly before."""

import numpy as np
import pytest
from twin.rehearsal import alarms
from twin.test_inputs_that_come_back import lines_with, lost_between

from tautline.twin.restrictions import caught_up

TOLD_WITH_ALL_SENSORS = 11.05


def left_out(begin, end):
    return lambda t, r: None if begin - 1e-6 <= t < end - 1e-6 else r


@pytest.mark.parametrize(
    "change", [left_out(10.0, 10.5), lost_between("winch_pos", 10.0, 10.5), lost_between("heave", 10.8, 11.3)]
)
def test_two_blocking_is_foreseen_in_time_while_an_input_that_was_missing_is_caught_up_with(change):
    lines, _ = lines_with(change)
    raised = [line["time"] for line in lines if "two-blocking ahead" in alarms([line])]
    assert raised[0] == pytest.approx(TOLD_WITH_ALL_SENSORS, abs=0.3)
    assert raised[-1] == lines[-1]["time"]


@pytest.mark.parametrize("lost", [("winch_pos", 11.2, 11.5), ("winch_pos", 11.2, np.inf)])
def test_two_blocking_that_was_foreseen_is_not_over_while_the_winch_is_not_measured(lost):
    lines, _ = lines_with(lost_between(*lost))
    late = [line for line in lines if line["time"] > TOLD_WITH_ALL_SENSORS + 0.1]
    assert all("two-blocking ahead" in alarms([line]) for line in late)


def test_a_run_ahead_catches_up_with_a_sensor_without_a_jump_and_stands_where_it_says():
    state, shown, times = np.array([0.5, -1.0, 0.2]), np.array([0.0, -2.0, 0.0]), np.linspace(1e-6, 2.0, 41)
    path = caught_up(state, shown, times)
    assert path[0] == pytest.approx(state, abs=1e-4)
    assert path[-1] == pytest.approx([-4.0, -2.0, 0.0], abs=1e-9)
