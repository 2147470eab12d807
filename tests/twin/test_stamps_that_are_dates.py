"""Stamps of today are doubles in steps of 2.4e-7 s: what is told by them is told as by stamps from zero."""

import math

import numpy as np
import pytest

from tautline.twin.alarms import CLEAR, Alarms
from tautline.twin.settling import AGREED, Settling
from tautline.twin.signals.knocks import TIME, knocked
from tautline.twin.signals.rows import Rows
from tautline.twin.signals.smoothing import smooth

BASES = [0.0, 1795900000.0, 1795900000.3, 1795900001.7]
STEP = 0.1


def followed(base=BASES[1]):
    """Rows of two inputs that have come for a second."""
    rows = Rows(["winch", "heave"], 1.0, live=True)
    for k in range(10):
        rows.add(base + STEP * k, {"winch": STEP * k, "heave": 0.0}, 100.0 + STEP * k)
    return rows


def handed_on(rows):
    found = []
    while (row := rows.ready(end=True)) is not None:
        found.append(row)
    return found


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("ulps", [-4, -1, 0, 1, 4])
@pytest.mark.parametrize("true_first", [False, True])
def test_a_repeated_reading_beside_the_true_one_makes_no_second_row(base, ulps, true_first):
    rows, stamp = followed(base), base + 1.0
    beside = stamp + ulps * math.ulp(stamp)
    both = [(beside, {"winch": 0.9, "heave": 0.0}, ["winch", "heave"]), (stamp, {"winch": 1.0, "heave": 0.0}, ())]
    for time, values, repeated in reversed(both) if true_first else both:
        rows.add(time, values, 101.2, repeated)
    rows.add(base + 1.1, {"winch": 1.1, "heave": 0.0}, 101.3)
    found = handed_on(rows)
    assert [row.time - base for row in found] == pytest.approx([STEP * k for k in range(12)], abs=2e-6)
    assert [row.values[0] for row in found] == pytest.approx([STEP * k for k in range(12)])
    assert not rows.counts


@pytest.mark.parametrize("apart", [-8e-3, 3e-6, 8e-3])
def test_a_true_reading_takes_the_place_of_a_repeated_one_a_small_part_of_the_interval_away_with_its_stamp(apart):
    rows = followed()
    rows.add(BASES[1] + 1.0, {"winch": 0.9, "heave": 0.0}, 101.2, ["winch", "heave"])
    rows.add(BASES[1] + 1.0 + apart, {"winch": 1.0}, 101.25)
    rows.add(BASES[1] + 1.1, {"winch": 1.1, "heave": 0.0}, 101.3)
    last = handed_on(rows)[-2]
    assert last.values.tolist() == [1.0, 0.0] and last.time == BASES[1] + 1.0 + apart
    assert last.repeated.tolist() == [False, True]


def test_a_true_reading_that_comes_as_its_repeated_one_was_handed_on_is_late_and_no_leap():
    rows = followed()
    rows.delay = 0.0
    rows.add(BASES[1] + 1.0, {"winch": 0.9, "heave": 0.0}, 101.2, ["winch", "heave"])
    while rows.ready() is not None:
        pass
    for apart in (2.4e-7, 5e-6):
        rows.add(BASES[1] + 1.0 + apart, {"winch": 1.0}, 101.3)
    assert rows.counts["late"] == 2 and not handed_on(rows)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("lasting", [0.3, 0.7, 1.0])
def test_an_alarm_comes_and_ends_at_the_same_row_whatever_its_stamps_count_from(base, lasting):
    alarms, begun, ended, wanted = Alarms(), [], [], round(lasting / STEP)
    for k in range(100):
        alarms.judge("over", 20 <= k < 60, base + STEP * k, "", lasting)
        begun += [k] if "over" in alarms.active and not begun else []
        ended += [k] if begun and "over" not in alarms.active else []
    assert begun == [20 + wanted] and ended[0] == 59 + round(CLEAR / STEP)


@pytest.mark.parametrize("base", BASES)
def test_inputs_have_settled_at_the_same_row_whatever_stamps_count_from(base):
    settling, one = Settling(), np.ones(1)
    settling.disturb(base)
    row = next(
        k for k in range(1, 99) if settling.follow(base + STEP * k, 0 * one, one, one) or not settling.catching_up
    )
    assert row == 1 + round(AGREED / STEP)


@pytest.mark.parametrize("base", BASES)
def test_a_knock_is_seen_whatever_stamps_count_from(base):
    times = base + 0.25 * np.arange(12)  # the reading behind it is `TIME` later than the one before it
    values = np.zeros(12)
    values[6] = 5.0
    assert TIME == 2 * 0.25 and np.flatnonzero(knocked(times, values, 0.1)[0]).tolist() == [6]


@pytest.mark.parametrize("base", BASES)
def test_samples_at_the_edge_of_the_reach_count_whatever_stamps_count_from(base):
    times = base + STEP * np.arange(21)
    values = np.sin(3.0 * (STEP * np.arange(21) - 1.0))
    values[[7, 13]] += 0.3  # at the edge: a fit has them or not
    assert smooth(times, values, times[10], 3 * STEP) == pytest.approx(
        smooth(STEP * np.arange(-10, 11), values, 0.0, 3 * STEP + 1e-3), rel=1e-4, abs=1e-4
    )


@pytest.mark.parametrize("base", [*BASES, 1.8e9])
@pytest.mark.parametrize("first", [0.3, 0.400001, 0.123456])
def test_rows_one_microsecond_apart_are_two_rows_whatever_stamps_count_from(base, first):
    rows = Rows(["x"], 1.0)
    for k in range(50):
        rows.add(float(f"{base + first:.6f}") if not k else float(f"{base + first + 1e-6 * k:.6f}"), {"x": float(k)})
    assert [row.values[0] for row in handed_on(rows)] == list(range(50)) and not rows.counts and not rows.notes


@pytest.mark.parametrize(("first", "asks"), [(0.0, True), (0.25, True), (0.123, True), (0.123456, False)])
def test_stamps_with_microseconds_are_not_asked_to_have_milliseconds(first, asks):
    rows = Rows(["x"], 0.0)
    for k in range(40):
        rows.add(1.8e9 + first + k // 4, {"x": float(k)})
        handed_on(rows)
    (note,) = rows.notes
    assert ("milliseconds" in note) is asks and "the first one of a stamp counts" in note


def test_a_first_row_from_the_future_does_not_make_late_readings_a_clock_that_was_set_back():
    """Only what was repeated is ahead of these readings: as without that row."""
    counts = []
    for future in (False, True):
        rows, base = Rows(["a", "b"], 0.0, live=True), 1.8e9
        if future:
            rows.add(base + 1e6, {"a": 0.0, "b": 0.0}, 99.9)
        for k in range(40):
            repeated = ["a", "b"] if k >= 20 else []
            rows.add(base + STEP * k, {"a": float(min(k, 19)), "b": 0.0}, 100.0 + STEP * k, repeated)
            while rows.ready() is not None:
                pass
        for k in range(20, 40):
            rows.add(base + STEP * k + 1e-7, {"a": float(k), "b": 0.0}, 104.0)
        counts.append((rows.counts["late"], rows.counts["clock set back"]))
    assert counts == [(20, 0)] * 2
