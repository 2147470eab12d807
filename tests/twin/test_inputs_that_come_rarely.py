"""Inputs that come more rarely than what is measured beside them: rows wait for their next readings."""

import math

import numpy as np
import pytest
from twin.rehearsal import HOIST
from twin.test_inputs_that_come_back import MAP, finer_rows

from tautline.twin.signals.rows import Rows
from tautline.twin.signals.spacing import SHOWN_IN, Spacing
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

INTERVAL = 0.05
NOTHING = "winch_pos shows nothing now"


def rows_with_winch(every, until=12.0):
    """Rows of the finer model of which only each so many has a reading of the winch."""
    for k, (stamp, readings) in enumerate(finer_rows()):
        if stamp <= until:
            yield stamp, readings if k % every == 0 else readings | {"winch_pos": math.nan}


def lines_of(twin, rows):
    return [line for stamp, readings in rows for line in twin.add(stamp, readings)] + twin.finish()


def told(twin):
    return [text for text in twin.notes if "winch_pos comes every" in text]


@pytest.mark.parametrize("every", [4, 6])
def test_a_winch_that_comes_more_rarely_than_the_rope_tension_is_followed_and_the_load_is_found(every):
    twin = Twin(HOIST, MAP)
    lines = lines_of(twin, rows_with_winch(every))
    true = {stamp: readings["winch_pos"] for stamp, readings in finer_rows()}
    off = [abs(line["inputs"]["winch.pay_out"] - true[line["time"]]) for line in lines if 2.0 < line["time"] < 11.0]
    # With rows that waited for 0.15 s the winch came to rest between its readings, for ever.
    assert np.max(off) < 0.02
    assert lines[-1]["estimates"]["payload.mass"]["value"] == pytest.approx(5300.0, rel=0.01)
    assert not any(NOTHING in cause for line in lines for cause in line["causes"])
    assert "catching up" not in {one["name"] for line in lines for one in line["alarms"]}
    (text,) = told(twin)
    assert f"every {every * INTERVAL:.2g} s" in text and f"after {3 * every * INTERVAL:.2g} s" in text


def test_an_input_that_comes_with_every_second_row_is_waited_for_no_longer_than_one_that_comes_with_each():
    rows = Rows(["in", "out"])
    rows.spacing.inputs = [0]
    for k in range(20):
        rows.add(INTERVAL * k, {"in": 1.0 if k % 2 == 0 else math.nan, "out": 0.01 * k})
    assert rows.patience == pytest.approx(3 * INTERVAL)


def test_an_input_that_stops_stalls_no_row():
    twin = Twin(HOIST, MAP)
    rows = [(t, row if t < 4.0 else row | {"winch_pos": math.nan}) for t, row in rows_with_winch(4)]
    behind = [stamp - line["time"] for stamp, readings in rows for line in twin.add(stamp, readings) if stamp > 1.5]
    # Three of its pauses are 0.6 s, and noise is smoothed over less than a second.
    assert max(behind) < 1.0
    # What was said of it is true still: rows are answered sooner now.
    (text,) = told(twin)
    assert "every 0.2 s: while it does so, rows are answered after 0.6 s" in text
    assert behind[-30:] == pytest.approx([3 * INTERVAL] * 30, abs=0.6 * INTERVAL)
    assert twin.now > rows[-1][0] - 1.0


def test_a_row_waits_for_an_input_that_has_stopped_only_until_two_and_a_half_of_its_intervals_have_passed():
    twin = Twin(HOIST, MAP)
    lines = []
    for k, (stamp, readings) in enumerate(finer_rows()):
        comes = k % 20 == 0 and stamp < 3.5
        new = twin.add(stamp, readings if comes else readings | {"winch_pos": math.nan})
        lines += [(stamp, stamp - line["time"], line["health"]) for line in new]
    of_then = [behind for stamp, behind, _ in lines if 3.5 < stamp < 5.45]
    assert of_then == [] or min(of_then) > 2.9
    # The last reading was at 3 s, and one comes each second: rows wait until 5.5 s, and then as for what is frequent.
    assert [behind for stamp, behind, _ in lines if stamp > 5.65] == pytest.approx(
        [3 * INTERVAL] * sum(stamp > 5.65 for stamp, *_ in lines), abs=1e-6
    )
    assert next(stamp for stamp, _, health in lines if health == "lost") == pytest.approx(3.0 + 5.0 + 0.15, abs=0.06)


def test_an_input_that_has_stopped_is_waited_for_again_from_its_next_reading_on_and_one_that_comes_late_has_not():
    spacing = Spacing(2)
    spacing.inputs = [0]
    for time in np.arange(0.0, 3.05, 0.1):
        whole = abs(time - round(time)) < 0.01
        spacing.take(float(time), np.array([1.0 if whole else math.nan, 1.0]))
    assert spacing.waited(0.1) == pytest.approx(3.0)
    spacing.take(5.4, np.array([math.nan, 1.0]))
    assert not spacing.has_stopped(0)
    spacing.take(5.6, np.array([math.nan, 1.0]))
    assert spacing.has_stopped(0) and spacing.waited(0.1) == 0.0
    spacing.take(20.0, np.array([1.0, 1.0]))
    assert spacing.waited(0.1) == pytest.approx(3.0)
    late = Spacing(2)
    late.inputs = [0]
    for time in np.arange(0.0, 9.95, 0.1):
        late.take(float(time), np.array([math.nan, 1.0]), float(time) - 0.1)
        if abs(time - round(time)) < 0.01 and time > 1.5:  # each reading comes two seconds after its stamp
            late.take(float(time) - 2.0, np.array([1.0, math.nan]), float(time))
        if time > 6.0:
            assert not late.has_stopped(0)


def test_an_input_that_never_comes_delays_the_first_row_by_no_more_than_a_second():
    rows = Rows(["in", "out"])
    rows.spacing.inputs = [0]
    for k in range(100):
        rows.add(INTERVAL * k, {"out": 0.01 * k})
        if rows.ready() is not None:
            break
    assert INTERVAL * k == pytest.approx(SHOWN_IN, abs=INTERVAL + 1e-9)


def test_a_delay_that_is_shorter_than_the_pause_of_an_input_is_told_once_with_one_that_works():
    twin = Twin(HOIST, MAP + "delay: 0.1 s\n")
    lines = lines_of(twin, rows_with_winch(4, 6.0))
    (text,) = told(twin)
    assert "rows are answered after 0.1 s, before its next reading is there" in text
    assert "`delay: 0.6 s`" in text
    made_up = [cause for line in lines for cause in line["causes"] if "is made up" in cause]
    assert any("winch_pos comes every 0.2 s, and rows wait 0.1 s only" in cause for cause in made_up)
    again = Twin(HOIST, MAP + "delay: 0.6 s\n")
    lines = lines_of(again, rows_with_winch(4, 6.0))
    assert not any("is made up" in cause for line in lines if 1.5 < line["time"] < 5.0 for cause in line["causes"])
    assert not told(again)


def test_without_a_delay_an_input_is_not_waited_for_longer_than_three_seconds_and_the_map_can_say_so():
    spacing = Spacing(1)
    spacing.inputs = [0]
    for k in range(6):
        spacing.take(2.0 * k, np.zeros(1))
    assert spacing.of(0) == pytest.approx(2.0) and spacing.waited(0.05) == 0.0


def test_an_input_that_comes_now_and_then_has_no_pause_and_a_first_stamp_from_the_future_is_forgotten():
    spacing = Spacing(1)
    spacing.inputs = [0]
    for time in (0.0, 0.1, 7.0, 7.3, 20.0, 21.0):
        spacing.take(time, np.zeros(1))
    assert spacing.of(0) == 0.0 and spacing.known
    other = Spacing(1)
    other.inputs = [0]
    for time in (1e6, 0.0, 0.2, 0.4, 0.6):
        other.take(time, np.zeros(1))
    assert other.of(0) == pytest.approx(0.2)


def test_an_input_that_has_stopped_is_not_waited_for_and_is_lost_as_soon_as_without_it():
    twin = Twin(HOIST, MAP)
    every, seen = 20, []
    for k, (stamp, readings) in enumerate(finer_rows()):
        if stamp > 12.0:
            break
        shown = k % every == 0 and stamp < 3.1
        for line in twin.add(stamp, readings if shown else readings | {"winch_pos": math.nan}):
            seen.append((stamp, stamp - line["time"]))
    assert max(behind for stamp, behind in seen if 7.5 < stamp) == pytest.approx(3 * INTERVAL, abs=1e-6)


def test_an_input_that_comes_again_is_waited_for_again():
    spacing = Spacing(1)
    spacing.inputs = [0]
    for k in range(5):
        spacing.take(0.2 * k, np.array([1.0]))
    assert spacing.waited(0.02) == pytest.approx(0.6)
    for k in range(100):
        spacing.take(0.8 + 0.02 * k, np.array([np.nan]))
    assert spacing.has_stopped(0) and spacing.waited(0.02) == 0.0
    spacing.take(3.0, np.array([1.0]))
    assert not spacing.has_stopped(0) and spacing.waited(0.02) == pytest.approx(0.6)


@pytest.mark.parametrize("pauses", [[1, 9], [1, 7], [4, 12, 7, 5, 9], [2, 2, 16]])
def test_rows_wait_for_the_longest_of_usual_pauses_of_an_input_that_comes_irregularly(pauses):
    rows, comes = Rows(["in", "out"]), set(np.cumsum(pauses * 60).tolist())
    rows.spacing.inputs = [0]
    patience = []
    for k in range(400):
        rows.add(INTERVAL * k, {"in": 1.0 if k in comes else math.nan, "out": 0.01 * k})
        while rows.ready() is not None:
            pass
        patience.append(rows.patience)
    settled = np.array(patience[150:])
    # Each row between two readings has the next one when it is answered.
    assert settled.min() >= INTERVAL * max(pauses) and settled.max() <= 3.0
    assert rows.spacing.is_told(0)


@pytest.mark.parametrize("every", [15, 20])
def test_an_input_that_comes_each_second_is_known_before_the_first_row_is_answered(every):
    rows = Rows(["in", "out"])
    rows.spacing.inputs = [0]
    for k in range(100):
        rows.add(INTERVAL * k, {"in": 1.0 if k % every == 0 else math.nan, "out": 0.01 * k})
        if (row := rows.ready()) is not None:
            assert rows.newest - row.time == pytest.approx(3 * every * INTERVAL)
            return
    pytest.fail("no row was answered")


def test_how_often_an_input_comes_is_not_said_again_by_a_twin_that_goes_on(tmp_path):
    twin, rows = Twin(HOIST, MAP), list(rows_with_winch(4, 6.0))
    for stamp, readings in rows[:60]:
        twin.add(stamp, readings)
    assert len(told(twin)) == 1
    save(twin, tmp_path / "state.npz")
    again = Twin(HOIST, MAP)
    load(again, tmp_path / "state.npz")
    lines_of(again, rows[60:])
    assert not told(again)
