"""A row of long ago, such as what a broker has kept, and the rows of now behind it: the time between is a gap."""

import numpy as np
import pytest

from tautline.twin.signals.rows import Rows
from tautline.twin.twin import Twin

DAY = 86400.0
SCENE = """
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e7, bending_stiffness: 0, damping: 1.0e-4, diameter: 36 mm}
bodies: [{name: payload, mass: 5 t, position: [0.5, 0, -20]}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: {constant: 0}}
  - end: {name: hook, body: payload}
mesh: {elements_per_span: 2}
gravity: [0, 0, -9.81]
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 60 s}
output: {interval: 50 ms}
"""
MAP = "sensors: [{column: winch, unit: m, input: winch.pay_out, zero: first}]"
LIVE = [round(DAY + 0.1 * k, 6) for k in range(12)]


def taken(stamps, silent_after=(), columns=("x",)):
    """Rows that are handed on, of stamps that come in this order; nothing comes for a while after some of them."""
    rows, came = Rows(columns), []
    for k, stamp in enumerate(stamps):
        rows.add(stamp, {columns[0]: float(k)})
        while (row := rows.ready(silent=k in silent_after)) is not None:
            came.append(row)
    while (row := rows.ready(end=True)) is not None:
        came.append(row)
    return rows, came


def gaps(came):
    """Numbers of the rows that are behind a gap."""
    return [k for k, row in enumerate(came) if row.after_gap]


@pytest.mark.parametrize("silent_after", [(0,), ()])
def test_rows_of_now_behind_one_of_yesterday_are_behind_a_gap_though_no_sample_interval_is_known(silent_after):
    rows, came = taken([0.0, *LIVE], silent_after)
    assert [row.time for row in came] == [0.0, *LIVE]
    assert gaps(came) == [1] and rows.counts["gaps"] == 1 and rows.interval == pytest.approx(0.1)


def test_rows_of_several_ages_in_any_order_are_behind_gaps_and_the_rows_of_now_are_not():
    for old in ([0.0, 3600.0], [3600.0, 0.0], [3600.0, 0.0, 7200.0]):
        _, came = taken([*old, *LIVE])
        assert [row.time for row in came] == [*sorted(old), *LIVE] and gaps(came) == list(range(1, len(old) + 1))


def test_what_a_twin_is_given_before_the_sample_interval_is_known_may_be_two_minutes_apart_but_no_more():
    for step, behind in ((119.0, []), (121.0, [1])):
        _, came = taken([0.0, *(round(step + 0.1 * k, 6) for k in range(12))])
        assert gaps(came) == behind


def test_rows_that_come_every_three_minutes_are_no_gaps_for_ever():
    rows, came = taken([180.0 * k for k in range(20)])
    assert len(came) == 20 and rows.interval == 180.0 and not gaps(came)[6:]


def test_repeated_readings_of_a_machine_that_stands_still_do_not_hide_a_day_without_rows():
    rows, came = Rows(["x"]), []
    for stamp in (*(0.1 * k for k in range(9)), *LIVE):
        rows.add(stamp, {"x": 1.0}, repeated=["x"])
        while (row := rows.ready()) is not None:
            came.append(row)
    assert gaps(came) == [9]


def lines_of(rows, silent_after):
    twin = Twin(SCENE, MAP, live=True)
    lines = []
    for k, (stamp, reading) in enumerate(rows):
        lines += twin.add(stamp, [reading])
        if k == silent_after:
            lines += twin.answers(silent=True)
    return twin, lines


@pytest.mark.parametrize("silent_after", [0, None])
def test_a_twin_of_which_the_first_row_is_of_yesterday_follows_the_rows_of_now_from_their_first_place(silent_after):
    twin, lines = lines_of([(0.0, 7.0), *((t, 12.0) for t in LIVE)], silent_after)
    assert lines[0]["time"] == 0.0 and len(lines) > 8
    # The winch stands where it stood when rows began to come: yesterday's 7 m is no place that 12 m count from.
    assert lines[-1]["inputs"] == {"winch.pay_out": pytest.approx(0.0, abs=1e-9)}
    assert twin.estimate.family.time < 60.0 and any("no rows came for 86400 s" in note for note in twin.notes)


def test_the_place_that_counts_as_zero_holds_over_a_long_gap_in_rows_that_had_begun():
    before = [(0.1 * k, 7.0) for k in range(12)]
    twin, lines = lines_of([*before, *((t, 7.5) for t in LIVE)], None)
    assert twin.readings.zeros == {0: 7.0} and np.isclose(lines[-1]["inputs"]["winch.pay_out"], 0.5)
