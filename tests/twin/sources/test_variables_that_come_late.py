"""OPC UA: a variable that reaches us later than another of the same stamp keeps its stamps and its readings."""

import math
from itertools import groupby

import pytest
from of_the_suite import studies

from tautline.twin.signals.rows import Rows
from tautline.twin.sources.opc_ua.holding import Change, Holding

STEP = 0.1
BEGIN = 1.7e9
COLUMNS = ["winch", "heave", "tension"]


def truth(column, time):
    """What a sensor measures at a stamp: known in closed form."""
    since = time - BEGIN
    return {
        "winch": 2.0 * math.sin(0.6 * since), "heave": 0.5 * math.cos(0.8 * since), "tension": 50.0 + 3.0 * since,
    }[column]  # fmt: skip


def sent(late, count=300, still=(), skew=()):
    """Changes by arrival: all of a grid, some columns so much later; the readings in `still` stand between two times.

    Those of `skew` have the stamps of a clock that is so far off.
    """
    late, skew, found = dict(late), dict(skew), []
    for name in COLUMNS:
        found.append((1000.0, Change(BEGIN, name, truth(name, BEGIN), 1000.0, True)))
        for k in range(1, count):
            if any(name == one and a <= STEP * k < b for one, a, b in still):
                continue
            # A little after another, as variables are written one by one.
            arrives = 1000.0 + STEP * k + late.get(name, 0.0) + 1e-3 * COLUMNS.index(name)
            stamp = BEGIN + STEP * k
            found.append((arrives, Change(stamp + skew.get(name, 0.0), name, truth(name, stamp), arrives)))
    return sorted(found, key=lambda one: one[0])


def answered(changes, delay=None):
    """Rows that are handed on, in order, and those that put them right; and what the variables' holding has said."""
    holding, rows, found = Holding(COLUMNS, 0.05), Rows(COLUMNS, delay, live=True), []
    groups = groupby(changes, lambda one: (one[1].first, round(one[0], 2), round(one[1].time, 3)))  # as `poll` does
    for _, group in groups:
        together = list(group)
        alive = together[-1][0]
        for one in [*holding.records([change for _, change in together]), *holding.until(alive)]:
            rows.add(one.time, one.values, one.arrived, one.repeated)
            while (row := rows.ready()) is not None:
                found.append(row)
    rows.notes += holding.notes
    return found, rows


def off(row):
    """By how much each reading of a row differs from what was measured at its stamp."""
    return {name: abs(x - truth(name, row.time)) for name, x in zip(COLUMNS, row.values, strict=True)}


@pytest.mark.parametrize("late", [{}, *studies({"tension": 0.3}, {"heave": 0.75}), {"winch": 0.5, "heave": 0.5}])
def test_with_a_delay_all_readings_have_the_stamps_at_which_they_were_measured(late):
    found, rows = answered(sent(late), delay=1.0)
    assert len(found) > 280
    assert max(max(off(row).values()) for row in found) < 1e-9  # NaN fails as well
    assert [row.time - BEGIN for row in found] == pytest.approx([STEP * k for k in range(len(found))], abs=1e-6)
    assert not rows.counts["late"] and not rows.notes


@pytest.mark.parametrize("late", [*studies({"tension": 0.45}), {"winch": 0.5, "heave": 0.5}])
def test_without_enough_delay_no_old_reading_has_a_new_stamp_and_it_is_said_which_delay_helps(late):
    found, rows = answered(sent(late))
    wrong = [row.time - BEGIN for row in found if any(by > 1e-9 for by in off(row).values())]
    assert not [time for time in wrong if time > 1.0]
    (note,) = rows.notes
    assert f"the stamps of {', '.join(late)} are" in note and "`delay: " in note
    told = float(note.split("`delay: ")[1].split(" s`")[0])
    right, again = answered(sent(late), delay=told)
    assert max(max(off(row).values()) for row in right) < 1e-9 and not again.counts["late"]


@pytest.mark.parametrize("skew", [{"winch": 0.2, "heave": 0.2}, *studies({"tension": 0.25}), {"tension": -0.2}])
def test_a_variable_whose_clock_is_a_little_off_has_the_readings_of_its_own_stamps(skew):
    found, rows = answered(sent({}, skew=skew), delay=1.0)
    for row in found:
        if row.time < BEGIN + 1.0:
            continue
        for name, value in zip(COLUMNS, row.values, strict=True):
            if math.isfinite(value):
                assert value == pytest.approx(truth(name, row.time - skew.get(name, 0.0)), abs=1e-6)
    assert not [note for note in rows.notes if "same stamp" in note]


@pytest.mark.parametrize("late", [{}, {"winch": 0.3}])
def test_a_late_variable_that_stands_still_holds_its_reading_in_all_rows_meanwhile(late):
    found, _ = answered(sent(late, still=[("winch", 10.0, 20.0)]), delay=1.0)
    stood = [row for row in found if 10.0 - 1e-6 <= row.time - BEGIN < 20.0 - 1e-6]
    stood = stood if late else stood[1:]  # the first one is in step with the others, and not known to be missing yet
    assert len(stood) >= 99
    assert [row.values[0] for row in stood] == [truth("winch", BEGIN + 9.9)] * len(stood)
    moved = [row for row in found if row.time - BEGIN > 20.0 - 1e-6]
    assert max(off(row)["winch"] for row in moved) < 1e-9


def test_repeated_readings_say_nothing_of_stamps_that_have_too_few_digits():
    rows = Rows(["a", "b"], 1.0)
    for k in range(40):
        rows.add(0.1 * k, {"a": 1.0 * k, "b": 0.0}, repeated={"b"})
        rows.add(0.1 * k, {"b": 2.0 * k})
    assert not rows.notes and not rows.counts["doubled"]
    assert [rows.ready().values.tolist() for _ in range(20)] == [[1.0 * k, 2.0 * k] for k in range(20)]


def test_a_repeated_reading_takes_no_place_of_a_true_one_that_came_before():
    rows = Rows(["a", "b"], 1.0)
    for k in range(40):
        rows.add(0.1 * k, {"b": 2.0 * k})
        rows.add(0.1 * k, {"a": 1.0 * k, "b": -1.0}, repeated={"b"})
    assert [rows.ready().values.tolist() for _ in range(20)] == [[1.0 * k, 2.0 * k] for k in range(20)]


def test_a_repeated_reading_that_comes_too_late_is_no_loss_and_not_counted():
    rows = Rows(["a", "b"], 0.0)
    for k in range(40):
        rows.add(0.1 * k, {"a": 1.0 * k})
        rows.ready()
        rows.add(0.1 * (k - 2), {"b": 1.0}, repeated={"b"})
    assert not rows.counts["late"] and not rows.notes


@pytest.mark.parametrize("column", ["tension", "winch"])
def test_a_variable_whose_clock_is_an_hour_ahead_is_named_and_the_others_keep_their_rows(column):
    found, rows = answered(sent({}, skew={column: 3600.0}))
    (note,) = rows.notes
    assert note.startswith(f"the stamps of {column} are 3600 s ahead of those of ")
    others = [i for i, name in enumerate(COLUMNS) if name != column]
    good = [row for row in found if all(math.isfinite(row.values[i]) for i in others)]
    assert len(good) > 250 and max(row.time for row in found) < BEGIN + 100.0
    assert all(off(row)[COLUMNS[i]] < 1e-9 for row in good for i in others)
