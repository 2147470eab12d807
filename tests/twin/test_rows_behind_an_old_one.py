"""A row of long ago, such as what a broker has kept, and the rows of now behind it: the time between is a gap."""

import time as clock

import numpy as np
import pytest
from of_the_suite import kept
from twin.rehearsal import STILL

from tautline.twin.signals.rows import Rows
from tautline.twin.twin import Twin

DAY = 86400.0
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
    for old in ([0.0, 3600.0], [3600.0, 0.0], [3600.0, 0.0, 10000.0]):
        _, came = taken([*old, *LIVE])
        assert [row.time for row in came] == [*sorted(old), *LIVE] and gaps(came) == list(range(1, len(old) + 1))


def test_what_a_twin_is_given_before_the_sample_interval_is_known_may_be_two_minutes_apart_but_no_more():
    for step, behind in ((119.0, []), (121.0, [1])):
        _, came = taken([0.0, *(round(step + 0.1 * k, 6) for k in range(12))])
        assert gaps(came) == behind


@pytest.mark.parametrize("jitter", [0.0, 6.0])
@pytest.mark.parametrize("step", [121.0, 180.0, 3600.0])
def test_steps_of_a_slow_stream_that_repeat_are_its_interval_and_no_gaps(step, jitter):
    rows, came = taken([step * k + jitter * (k % 2) for k in range(20)])
    assert len(came) == 20 and rows.interval == pytest.approx(step, abs=jitter) and not gaps(came)


@pytest.mark.parametrize("step", [61.0, 90.0, 119.0, 300.0])
def test_one_lost_row_of_a_stream_slower_than_a_row_a_minute_is_no_gap_and_two_are(step):
    for lost, count in (({7}, 0), ({7, 8}, 1)):
        rows, _ = taken([step * k for k in range(14) if k not in lost])
        assert rows.counts["gaps"] == count


def test_a_slow_live_stream_of_which_each_row_is_answered_in_the_silence_behind_it_has_no_gaps_but_the_first():
    rows, came = taken([180.0 * k for k in range(20)], silent_after=range(20))
    assert gaps(came) == [1] and rows.interval == 180.0


def test_a_first_row_from_the_future_is_set_aside_and_the_sample_interval_becomes_known():
    rows, came = taken([1.0e6, *LIVE])
    assert [row.time for row in came] == LIVE and rows.counts == {"future": 1}
    assert rows.interval == pytest.approx(0.1) and not gaps(came)


def test_repeated_readings_of_a_machine_that_stands_still_do_not_hide_a_day_without_rows():
    rows, came = Rows(["x"]), []
    for stamp in (*(0.1 * k for k in range(9)), *LIVE):
        rows.add(stamp, {"x": 1.0}, repeated=["x"])
        while (row := rows.ready()) is not None:
            came.append(row)
    assert gaps(came) == [9]


def beside_a_machine(rows, silent_after=(), live=True):
    """Rows that are handed on, of (stamp, arrival), s; none comes for a while after some of them, and then no more."""
    made, came = Rows(["x"], live=live), []
    for k, (stamp, arrived) in enumerate(rows):
        made.add(stamp, {"x": float(k)}, arrived)
        while (row := made.ready(silent=k in silent_after)) is not None:
            came.append(row.time)
    while (row := made.ready(end=True)) is not None:
        came.append(row.time)
    return made, came


BEFORE = [(0.25 * k, 100.0 + 0.25 * k) for k in range(24)]
"""Rows as they are measured, until 5.75 s."""


@pytest.mark.parametrize("ahead", [10.0, 300.0, 3600.0])
@pytest.mark.parametrize("waited", [0.0, 3.0])
def test_a_stamp_that_ran_ahead_of_the_time_that_went_by_is_not_believed_in_a_silence(waited, ahead):
    false = (5.75 + waited + ahead, 105.75 + waited)
    after = [(5.75 + waited + 3.0 + 0.25 * k, 105.75 + waited + 3.0 + 0.25 * k) for k in range(8)]
    rows, came = beside_a_machine([*BEFORE, false, *after], silent_after=[len(BEFORE)])
    assert came == [stamp for stamp, _ in (*BEFORE, *after)] and rows.counts["future"] == 1


def test_a_stamp_that_ran_ahead_is_left_out_at_the_end_of_a_live_source():
    rows, came = beside_a_machine([*BEFORE, (305.75, 105.8)], silent_after=[len(BEFORE)])
    assert came == [stamp for stamp, _ in BEFORE] and rows.counts == {"future": 1}


@pytest.mark.parametrize("gap", [3.0, 300.0, 3600.0])
def test_a_gap_as_long_as_the_time_that_went_by_is_taken_in_the_silence_behind_it(gap):
    rows, came = beside_a_machine([*BEFORE, (5.75 + gap, 105.75 + gap)], silent_after=[len(BEFORE)])
    assert came[-1] == 5.75 + gap and not rows.counts["future"]


@pytest.mark.parametrize("live", [True, False], ids=["piped in", "a file"])
def test_a_gap_before_the_last_row_of_what_was_written_before_is_taken(live):
    rows, came = beside_a_machine([*((stamp, 1e-3 * stamp) for stamp, _ in BEFORE), (3605.75, 0.01)], live=live)
    assert came[-1] == 3605.75 and not rows.counts["future"]


def test_a_false_stamp_says_nothing_of_how_fast_a_clock_runs():
    stamps = [(0.25 * k + (3600.0 if k == 200 else 0.0), 0.25 * k) for k in range(500)]
    rows, _ = beside_a_machine(stamps)
    assert abs(rows.arrivals.clock_rate) < 1e-9 and not rows.notes and rows.counts["future"] == 1


def lines_of(rows, silent_after=None, live=True):
    """A twin and its lines, of rows of (stamp, reading, arrival); nothing comes for a while after one of them."""
    twin = Twin(STILL, MAP, live=live)
    lines = []
    for k, (stamp, reading, arrived) in enumerate(rows):
        lines += twin.add(stamp, [reading], arrived)
        if k == silent_after:
            lines += twin.answers(silent=True)
    return twin, lines + twin.finish()


def as_measured(rows, since=1000.0):
    """Rows (stamp, reading) with the arrival of each, as they are measured."""
    return [(stamp, reading, since + stamp - rows[0][0]) for stamp, reading in rows]


NOW = as_measured([(stamp, 12.0 + 0.01 * k) for k, stamp in enumerate(LIVE)])
"""Rows as they are measured, of a winch that pays out 0.11 m."""
OLD = {
    "one": [(0.0, 7.0, 990.0)],
    "two": [(0.0, 7.0, 990.0), (500.0, 7.5, 990.0)],
    "six at regular steps": [(300.0 * k, 7.0, 990.0) for k in range(6)],
}


@pytest.mark.parametrize("silent_after", [0, None])
@pytest.mark.parametrize("old", kept(OLD, ("one", "two")))
def test_a_live_twin_whose_first_rows_were_old_when_they_came_counts_from_the_first_row_of_now_and_says_so(
    old, silent_after
):
    twin, lines = lines_of([*OLD[old], *NOW], silent_after)
    # Yesterday's 7 m is no place that 12 m count from.
    assert lines[-1]["inputs"]["winch.pay_out"] == pytest.approx(0.11, abs=1e-3) and twin.readings.zeros == {0: 12.0}
    assert twin.estimate.family.time < 4000.0 and any("no rows came for" in note for note in twin.notes)
    told = [note for note in twin.notes if "counts from" in note]
    assert len(told) == 1 and "winch counts from 12 m now (before: from 7" in told[0]


def test_rows_that_a_gateway_sends_together_are_of_now_where_their_stamps_are_those_of_this_computers_clock():
    now, arrived = clock.time(), clock.monotonic()
    together = [(now - 1.2 + 0.1 * k, 12.0, arrived) for k in range(12)]
    twin, _ = lines_of([(now - DAY, 7.0, arrived - 5.0), *together])
    assert twin.readings.zeros == {0: 12.0}


IN_BURSTS = [(DAY + 0.1 * k, 12.0 + 0.01 * k, 1000.0 + 1.0 * (k // 10)) for k in range(30)]
"""Of a gateway that sends ten rows a second at once, of a winch that pays out 0.29 m."""
LATE = [(DAY + 1.0 * k, 12.0, 1000.0 + 1e-3 * k) for k in range(60)]
LATE += [(DAY + 60.0 + k, 12.0 + 0.1 * k, 1001.0 + k) for k in range(10)]
"""Of a logger that sends a minute that it has kept, and goes on with rows as they are measured."""


@pytest.mark.parametrize("rows", [IN_BURSTS, LATE], ids=["bursts", "a minute late"])
def test_rows_of_now_that_come_late_or_in_bursts_are_known_by_those_behind_them_and_counted_from(rows):
    twin, lines = lines_of([(0.0, 7.0, 990.0), *rows])
    assert 12.0 <= twin.readings.zeros[0] < 12.3
    paid_out = rows[-1][1] - twin.readings.zeros[0]
    assert lines[-1]["inputs"]["winch.pay_out"] == pytest.approx(paid_out, abs=2e-3)
    assert len([note for note in twin.notes if "winch counts from 12" in note and "from 7 m" in note]) == 1
    assert sum("rows come as they are measured from now on" in note for note in twin.notes) == 1
    alarms = {alarm["name"] for line in lines for alarm in line["alarms"]}
    assert alarms <= {"behind the machine", "catching up"}  # arrivals are not those of this computer's clock here
    assert len(lines) == len(rows) + 1


def test_a_log_that_is_followed_counts_from_its_first_row_though_a_pause_was_in_it():
    log = [(0.1 * k, 7.0, 990.0 + 1e-4 * k) for k in range(20)]
    twin, _ = lines_of([*log, *((stamp, 12.0, came) for stamp, _, came in LATE)])
    assert twin.readings.zeros == {0: 7.0}


@pytest.mark.parametrize("live", [False, True])
@pytest.mark.parametrize("step", [300.0, 3600.0, DAY])
def test_two_alike_steps_before_rows_that_come_fast_are_gaps_and_are_not_simulated(step, live):
    stamps = [0.0, step, *(2.0 * step + 0.1 * k for k in range(12))]
    rows = Rows(["x"], live=live)
    came = []
    for stamp in stamps:
        rows.add(stamp, {"x": 1.0}, 1000.0 + stamp)
        while (row := rows.ready()) is not None:
            came.append(row)
    while (row := rows.ready(end=True)) is not None:
        came.append(row)
    assert gaps(came) == [1, 2] and [row.time for row in came] == stamps and rows.counts == {"gaps": 2}


@pytest.mark.parametrize("live", [False, True])
def test_a_file_counts_from_its_first_row_though_a_long_gap_comes_soon_also_where_it_is_piped(live):
    rows = [(0.0, 7.0), (0.1, 7.0), *((t, 10.0) for t in LIVE)]
    arrivals = [1000.0 + 1e-4 * k if live else 0.0 for k in range(len(rows))]
    twin, lines = lines_of([(*row, came) for row, came in zip(rows, arrivals, strict=True)], live=live)
    assert twin.readings.zeros == {0: 7.0} and lines[-1]["inputs"]["winch.pay_out"] == pytest.approx(3.0)


@pytest.mark.parametrize("live", [False, True])
@pytest.mark.parametrize("step", [125.0, 300.0])
def test_a_slow_stream_counts_from_its_first_row(step, live):
    rows = as_measured([(step * k, 100.0 + 0.2 * k) for k in range(9)])
    twin = Twin(STILL, MAP, live=live)
    for row in rows:
        twin.readings.rows.add(row[0], {"winch": row[1]}, row[2])
        while (one := twin.readings.rows.ready(silent=live)) is not None:
            twin.readings.checked(one)
    assert twin.readings.zeros == {0: 100.0}


def test_the_place_that_counts_as_zero_holds_over_a_long_gap_in_rows_that_had_begun():
    before = as_measured([(0.1 * k, 7.0) for k in range(12)], 900.0)
    after = as_measured([(t, 7.5) for t in LIVE])  # the clock was set forward by a day
    twin, lines = lines_of([*before, *after])
    assert twin.readings.zeros == {0: 7.0} and np.isclose(lines[-1]["inputs"]["winch.pay_out"], 0.5)
