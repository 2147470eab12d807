"""OPC UA: what comes once a second has the rows of its stamps, and a variable that is far behind is not lost."""

import math
import random

import pytest

from tautline.twin.signals.rows import Rows
from tautline.twin.sources.opc_ua.holding import Change, Holding

BEGIN = 1.7e9
ARRIVED = 100.0


class Variable:
    """One that changes every `step` s, has `lag` s to come, and was written `old` s before it is first asked for."""

    def __init__(self, step, lag=0.0, old=0.1, skew=0.0):
        self.step, self.lag, self.old, self.skew = step, lag, old, skew

    def value(self, time):
        """What it shows at a time after the begin: that of the change before."""
        return math.floor((time + 1e-6) / self.step) if time > 0.0 else 0.0


def answered(variables, until, delay=None):
    """Rows that are handed on with the times of that, what put them right, and when notes of the source came."""
    chance = random.Random(1)
    events = []
    for name, one in variables.items():
        for k in range(1, int(until / one.step) + 1):
            stamp = one.step * k
            at = stamp + one.lag + 0.01 + abs(chance.gauss(0.0, 0.004))
            change = Change(BEGIN + stamp + one.skew, name, one.value(stamp), ARRIVED + at)
            events.append((round(at, 2 if one.lag == 0.0 else 6), name, change))
    events += [(0.25 * k, "", None) for k in range(1, int(4 * until))]
    together: dict = {}
    for at, _, change in sorted((one for one in events if one[0] < until), key=lambda one: one[:2]):
        together.setdefault((at, change and round(change.time, 3)), []).append(change)
    first = [Change(BEGIN - one.old, name, 0.0, ARRIVED, True) for name, one in variables.items()]
    holding, rows = Holding(list(variables), 0.05, now=lambda: BEGIN), Rows(list(variables), delay, live=True)
    found, told = [], {}
    for at, changes in [(0.0, first), *((key[0], some) for key, some in together.items())]:
        records = holding.until(ARRIVED + at) if changes[0] is None else holding.records(changes)
        for one in records:
            rows.add(one.time, one.values, one.arrived, one.repeated)
            while (row := rows.ready()) is not None:
                found.append((at, row))
        for note in [*holding.notes, *rows.notes]:
            told.setdefault(note, at)
    return found, rows, told


def wrong(found, variables):
    """Stamps after the begin at which a row has another reading of a variable than was measured, or none."""
    stamps = []
    for _, row in found:
        time = row.time - BEGIN
        right = [one.value(time) for one in variables.values()]
        if not all(abs(a - b) < 1e-9 for a, b in zip(row.values, right, strict=True)):
            stamps.append(time)
    return stamps


@pytest.mark.parametrize("step", [0.4, 0.5, 1.0, 1.8])
@pytest.mark.parametrize("old", [0.1, 0.3])
def test_what_is_measured_once_a_second_has_the_rows_of_its_stamps_and_no_gaps(step, old):
    variables = {"winch": Variable(step, old=old), "tension": Variable(step, old=old)}
    found, rows, _ = answered(variables, 60.0)
    assert rows.interval == pytest.approx(step, rel=1e-3)
    assert not rows.counts["gaps"] and not wrong(found, variables)
    true = [row for _, row in found if row.measured.all()]
    assert len(true) >= 60.0 / step - 5


@pytest.mark.parametrize("old", [0.5, 0.9])
def test_first_readings_that_are_old_say_nothing_of_the_clock_of_the_source(old):
    # The first change has to come before it is taken that nothing moves.
    variables = {"winch": Variable(1.0, old=old), "tension": Variable(0.5, old=old)}
    _, rows, _ = answered(variables, 150.0)
    assert not rows.notes


def test_a_variable_far_behind_that_changes_seldom_has_its_readings_where_the_delay_waits_for_it():
    variables = {"depth": Variable(30.0, lag=4.0), "heave": Variable(0.2), "tension": Variable(0.2)}
    found, rows, told = answered(variables, 200.0, delay=6.0)
    assert len(found) > 900 and not wrong(found, variables)
    assert not rows.counts["late"] and not told


def test_a_variable_far_behind_that_changes_seldom_holds_its_newest_reading_and_is_soon_told_without_a_delay():
    variables = {"depth": Variable(30.0, lag=4.0), "heave": Variable(0.2), "tension": Variable(0.2)}
    found, _, told = answered(variables, 200.0)
    ((note, at),) = told.items()
    assert "the stamps of depth are" in note and "`delay: 4." in note and at < 70.0
    assert all(math.isfinite(row.values[0]) for _, row in found)
    # At most as old as it comes later, and its rows.
    assert all(time % 30.0 < 5.0 for time in wrong(found, variables))


def test_a_variable_of_another_clock_holds_its_reading_until_it_is_told_some_seconds_after_its_first_change():
    variables = {"depth": Variable(30.0, skew=-3600.0), "heave": Variable(0.2), "tension": Variable(0.2)}
    found, _, told = answered(variables, 100.0)
    ((note, at),) = told.items()
    assert note.startswith("the stamps of depth are 3600 s behind") and 34.0 < at < 37.0
    held = [row for _, row in found if row.time - BEGIN < 34.0]
    assert all(math.isfinite(row.values[0]) for row in held)
    assert held[-1].values[0] == 1.0
    assert all(math.isnan(row.values[0]) for _, row in found if row.time - BEGIN > 38.0)


def test_one_of_two_variables_that_only_comes_later_does_not_leave_out_the_other():
    variables = {"depth": Variable(30.0, lag=4.0), "heave": Variable(0.2)}
    found, _, told = answered(variables, 100.0, delay=6.0)
    assert not wrong(found, variables) and not told


def test_a_variable_that_comes_late_and_alone_is_of_no_clock_that_was_set_back():
    rows = Rows(["a", "b"], 0.2, live=True)
    for k in range(60):
        rows.add(0.1 * k, {"a": 1.0 * k}, 0.1 * k)
        if k > 30:
            rows.add(0.1 * k - 3.0, {"b": 1.0 * k}, 0.1 * k)
        while rows.ready() is not None:
            pass
    for k in range(60, 80):
        rows.add(0.1 * k - 3.0, {"b": 1.0 * k}, 0.1 * k)
    assert not rows.counts["clock set back"] and rows.shift == 0.0


def test_rows_that_come_less_often_from_now_on_are_no_gaps_for_ever():
    rows = Rows(["a"], None)
    for k in range(100):
        rows.add(0.05 * k, {"a": 1.0 * k})
    for k in range(1, 60):
        rows.add(4.95 + k, {"a": 1.0 * k})
    assert rows.interval == pytest.approx(1.0) and rows.counts["gaps"] <= 6
