"""Two blocks that come together by where the winch is: foreseen whatever becomes of an input shortly before."""

import numpy as np
import pytest
from of_the_suite import studies
from twin.rehearsal import alarms, changed
from twin.test_inputs_that_come_back import finer_rows, gone_through, lines_with, lost_between

from tautline.twin.restrictions import caught_up

TOLD_WITH_ALL_SENSORS = 11.05


def left_out(begin, end):
    return lambda t, r: None if begin - 1e-6 <= t < end - 1e-6 else r


@pytest.mark.parametrize(
    "change",
    [lost_between("winch_pos", 10.0, 10.5), *studies(left_out(10.0, 10.5), lost_between("heave", 10.8, 11.3))],
)
def test_two_blocking_is_foreseen_in_time_while_an_input_that_was_missing_is_caught_up_with(change):
    lines, _ = lines_with(change)
    raised = [line["time"] for line in lines if "two-blocking ahead" in alarms([line])]
    assert raised[0] == pytest.approx(TOLD_WITH_ALL_SENSORS, abs=0.3)
    assert raised[-1] == lines[-1]["time"]


@pytest.fixture(scope="module")
def lines_without_winch():
    """Lines of a twin of the record, in which the winch is lost for good at 11.2 s, and of 5 s in waves behind it."""
    rows = changed(finer_rows(), lost_between("winch_pos", 11.2, np.inf))
    return gone_through([*rows, *in_waves_without_winch(17.0)])[1]


@pytest.fixture(scope="module")
def lines_with_winch_back():
    """Lines of a twin of the record, in which the winch is lost from 11.2 to 11.5 s."""
    return lines_with(lost_between("winch_pos", 11.2, 11.5))[0]


@pytest.mark.parametrize(
    "lines", ["lines_without_winch", pytest.param("lines_with_winch_back", marks=pytest.mark.study)]
)
def test_two_blocking_that_was_foreseen_is_not_over_while_the_winch_is_not_measured(lines, request):
    late = [line for line in request.getfixturevalue(lines) if TOLD_WITH_ALL_SENSORS + 0.1 < line["time"] <= 12.0]
    assert len(late) > 15 and all("two-blocking ahead" in alarms([line]) for line in late)


def test_a_run_ahead_catches_up_with_a_sensor_without_a_jump_and_stands_where_it_says():
    state, shown, times = np.array([0.5, -1.0, 0.2]), np.array([0.0, -2.0, 0.0]), np.linspace(1e-6, 2.0, 41)
    path = caught_up(state, shown, times)
    assert path[0] == pytest.approx(state, abs=1e-4)
    assert path[-1] == pytest.approx([-4.0, -2.0, 0.0], abs=1e-9)


def told_of(line, name):
    return next((one for one in line["alarms"] if one["name"] == name), None)


def in_waves_without_winch(end):
    """Rows after those of the record, at 20 Hz: the ship goes on in its waves, and the winch is lost."""
    kept = [(t, r) for t, r in finer_rows() if t > 8.0]
    at = 2.0 * np.pi / 8.0 * np.array([t for t, _ in kept])
    wave = np.linalg.lstsq(np.transpose([np.sin(at), np.cos(at)]), [r["heave"] for _, r in kept], rcond=None)[0]
    for t in np.arange(kept[-1][0] + 0.05, end, 0.05):
        heave = wave @ [np.sin(2.0 * np.pi / 8.0 * t), np.cos(2.0 * np.pi / 8.0 * t)]
        yield float(t), {"heave": float(heave), "rope_tension": kept[-1][1]["rope_tension"]}


def test_two_blocking_that_was_foreseen_is_said_to_be_not_known_while_the_winch_is_lost_and_known_when_it_is_back(
    lines_without_winch, lines_with_winch_back
):
    late = [line for line in lines_without_winch if line["time"] > 14.0]
    assert late and not any(told_of(line, "two-blocking ahead")["known"] for line in late)
    assert "not known any more" in told_of(late[-1], "two-blocking ahead")["text"]
    assert all("nothing shows where" in told_of(line, "cannot look ahead")["text"] for line in late)
    assert {line["health"] for line in late if line["time"] > 16.3} == {"lost"}
    assert told_of(lines_with_winch_back[-1], "two-blocking ahead")["known"]


def zero_between(column, begin, end):
    return lambda t, r: {**r, column: 0.0} if begin - 1e-6 <= t < end - 1e-6 else r


def test_an_encoder_that_falls_to_zero_for_good_is_stuck_and_is_never_followed_to_there():
    lines, twin = lines_with(zero_between("winch_pos", 6.0, np.inf), end=10.0)
    # The load was let down by 11 m in the simulation, with good health at the end.
    assert {line["health"] for line in lines if line["time"] > 6.0} == {"degraded"}
    assert told_of(lines[-1], "winch_pos stuck") and told_of(lines[-1], "cannot look ahead")
    assert max(line["inputs"]["winch.pay_out"] for line in lines if line["time"] > 6.5) < -10.0
    assert twin.estimate.horizon.mean[0] == pytest.approx(5300.0, rel=0.01)


def test_two_blocking_is_foreseen_in_time_after_an_encoder_that_fell_to_zero_has_come_back():
    lines, _ = lines_with(zero_between("winch_pos", 6.0, 7.0))
    raised = [line["time"] for line in lines if "two-blocking ahead" in alarms([line])]
    assert raised[0] == pytest.approx(TOLD_WITH_ALL_SENSORS, abs=0.3)
    assert raised[-1] == lines[-1]["time"] and told_of(lines[-1], "winch_pos stuck") is None
