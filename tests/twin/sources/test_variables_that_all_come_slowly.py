"""OPC UA: what comes every few seconds has rows of that interval, and its clocks are told from each other."""

from itertools import pairwise

import pytest

from tautline.twin.signals.rows import Rows
from tautline.twin.sources.opc_ua.holding import Change, Holding

BEGIN, ARRIVED = 1.7e9, 1000.0


def rows_of(step, until, columns=("a", "b"), phase=0.0, skew=None, from_=0.0):
    """Records of variables that change every `step` s, each `phase` s after the other, and what is told of them.

    The server says each quarter of a second that it is alive. `skew` is what the clock of a column is off by, s.
    """
    holding, events, skew = Holding(list(columns), 0.05, now=lambda: BEGIN), [], skew or {}
    for number, name in enumerate(columns):
        events += [(k * step + phase * number, name) for k in range(int(until / step))]
    events += [(0.25 * k + 0.01, "") for k in range(int(4 * until))]
    found, known = [], set()
    for at, name in sorted(events):
        if not name:
            found += holding.until(ARRIVED + at)
            continue
        stamp = BEGIN + at + skew.get(name, 0.0)
        found += holding.records([Change(stamp, name, at, ARRIVED + at, name not in known)])
        known.add(name)
    return [one for one in found if one.time >= BEGIN + from_], holding.notes


@pytest.mark.parametrize("step", [2.5, 5.0, 20.0])
def test_what_comes_every_few_seconds_has_rows_of_that_interval_from_its_third_change_on(step):
    found, _ = rows_of(step, 20 * step, from_=3.5 * step)
    measured = sorted({round(one.time - BEGIN, 6) for one in found})
    assert measured == pytest.approx([k * step for k in range(4, 4 + len(measured))]) and len(measured) >= 14
    assert not any(one.repeated for one in found)


@pytest.mark.parametrize("step", [2.5, 5.0, 20.0])
def test_the_sample_interval_is_that_of_what_comes_every_few_seconds(step):
    rows = Rows(["a", "b"], live=True)
    for one in rows_of(step, 20 * step)[0]:
        rows.add(one.time, one.values, one.arrived, one.repeated)
        while rows.ready() is not None:
            pass
    assert rows.interval == pytest.approx(step, rel=0.01)


@pytest.mark.parametrize("step", [2.5, 5.0, 20.0])
def test_readings_are_repeated_once_a_second_at_most_before_an_interval_is_known(step):
    times = sorted({one.time for one in rows_of(step, 3 * step)[0]})
    assert len(times) <= 3 * step + 3
    assert all(b - a >= 0.5 for a, b in pairwise(times))


def test_a_variable_that_is_silent_is_repeated_at_the_interval_of_the_slow_ones_beside_it():
    holding, found = Holding(["a", "still"], 0.05), []
    holding.records([Change(BEGIN, "a", 0.0, ARRIVED, True), Change(BEGIN, "still", 7.0, ARRIVED, True)])
    for k in range(1, 20):
        found += holding.records([Change(BEGIN + 5.0 * k, "a", 1.0 * k, ARRIVED + 5.0 * k)])
        for part in range(1, 20):
            found += holding.until(ARRIVED + 5.0 * k + 0.25 * part)
    late = [one for one in found if one.time > BEGIN + 20.0]
    assert len(late) == 15 and all(one.values["still"] == 7.0 for one in late)


@pytest.mark.parametrize("off", [3600.0, -3600.0, 30.0, -30.0])
@pytest.mark.parametrize("step", [5.0, 20.0])
@pytest.mark.parametrize("wrong", ["b", "c"])
def test_the_slow_variable_of_another_clock_is_left_out_and_named_and_no_other(off, step, wrong):
    found, notes = rows_of(step, 10 * step, ("a", "b", "c"), 0.31 * step, {wrong: off}, from_=3 * step)
    (note,) = notes
    side = "ahead of" if off > 0.0 else "behind"
    assert note.startswith(f"the stamps of {wrong} are {abs(off):.0f} s {side} those of the other variables")
    assert all(one.time < BEGIN + 10.5 * step for one in found)
    assert all(b.time >= a.time for a, b in pairwise(found))


def test_a_first_reading_of_another_clock_makes_no_row_of_a_moment_to_come():
    holding = Holding(["a", "b"], 0.05)
    holding.records([Change(BEGIN, "a", 1.0, ARRIVED, True)])
    holding.records([Change(BEGIN + 1.0, "a", 1.0, ARRIVED + 1.0)])
    (row,) = holding.records([Change(BEGIN + 3601.5, "b", 2.0, ARRIVED + 1.5, True)])
    assert row.time == pytest.approx(BEGIN + 1.5)
