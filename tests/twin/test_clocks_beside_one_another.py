"""Whether rows come as they are measured is seen of each clock by itself, whatever false stamps are among them."""

import random

import pytest

from tautline.twin.pace import Pace


def after(rows):
    """What is known of rows (stamp, arrival, column), s, when all have come."""
    pace = Pace()
    for stamp, arrived, column in rows:
        pace.take(stamp, arrived, {column: 1.0})
    return pace


@pytest.mark.parametrize("rate", [0.5, 1.0, 2.0, 5.0, 20.0])
@pytest.mark.parametrize("ahead", [-3600.0, -121.0, -100.0, 1.5, 60.0, 121.0, 3600.0])
@pytest.mark.parametrize("other", ["a", "b"], ids=["of the same columns", "of other columns"])
def test_rows_of_two_clocks_that_come_as_they_are_measured_are_no_record(other, ahead, rate):
    one = [(k / 20.0, k / 20.0, "a") for k in range(600)]
    two = [(ahead + k / rate, 0.01 + k / rate, other) for k in range(int(30 * rate))]
    assert not after(sorted(one + two, key=lambda row: row[1])).is_record


def test_rows_of_two_clocks_that_were_written_before_are_a_record():
    rows = [(300.0 * (k % 2) + 0.1 * k, 1e-4 * k, "ab"[k % 2]) for k in range(400)]
    assert after(rows).is_record


@pytest.mark.parametrize("ahead", [2.0, 50.0, 119.0, 121.0, 3600.0])
def test_a_false_stamp_ahead_among_rows_that_were_kept_hides_no_row_of_now(ahead):
    kept = [(0.1 * k + (ahead if k == 40 else 0.0), 1e-4 * k, "a") for k in range(100)]
    now = [(10.0 + 0.1 * k, 0.1 * k, "a") for k in range(1, 15)]  # 1.4 s of them
    assert after(kept).is_record and after(kept + now).has_paced


@pytest.mark.parametrize("every", [7, 20, 50])
def test_false_stamps_ahead_again_and_again_do_not_hide_that_rows_come_as_they_are_measured(every):
    rows = [(0.05 * k + (3600.0 if k % every == 3 else 0.0), 0.05 * k, "a") for k in range(60)]
    assert after(rows).has_paced


@pytest.mark.parametrize("faster", [3.0, 10.0, 100.0])
@pytest.mark.parametrize("stall", [1.5, 5.0, 10.0])
def test_a_fast_replay_that_stalls_once_or_twice_stays_a_record(stall, faster):
    rows, passed = [], 0.0
    for k in range(3000):
        passed += 0.1 / faster + (stall if k in (1000, 2000) else 0.0)
        rows.append((0.1 * k, passed, "a"))
    assert after(rows).is_record and not after(rows).has_paced


@pytest.mark.parametrize("together", [0.5, 2.0, 5.0])
def test_rows_that_are_sent_together_as_they_are_measured_are_no_record(together):
    rate = 10
    rows = [(k / rate, together * (1 + int(k / rate / together)) + 1e-4 * (k % 50), "a") for k in range(200)]
    assert after(rows).has_paced


@pytest.mark.parametrize("rate", [0.05, 0.2, 0.4, 1.0])
@pytest.mark.parametrize("together", [1, 4])
def test_a_simulator_slower_than_time_is_no_record_whatever_came_at_once_at_its_begin(together, rate):
    kept = [(0.02 * k, 1e-4 * k, "a") for k in range(100)]
    now = [(2.0 + rate * 0.1 * k, 0.1 * together * (1 + k // together) + 1e-4 * k, "a") for k in range(40)]
    assert after(kept).is_record and not after(kept + now).is_record


@pytest.mark.parametrize("every", [0.3, 1.0, 60.0])
def test_variables_that_change_one_at_a_time_behind_a_burst_of_another_are_no_record(every):
    burst = [(1.0 * k, 1e-4 * k, "a") for k in range(100)]
    changes = [(100.0 + every * k, every * k, f"v{k}") for k in range(1, 8)]
    assert after(burst).is_record and not after(burst + changes).is_record


@pytest.mark.parametrize("faster", [3.0, 10.0])
@pytest.mark.parametrize("stall", [0.5, 1.5])
@pytest.mark.parametrize("clocks", [1, 20])
def test_a_fast_replay_that_stalls_again_and_again_stays_a_record_of_however_many_clocks(clocks, stall, faster):
    rows, passed = [], 0.0
    for k in range(8000):
        passed += 0.01 / faster + (stall if k % 1000 == 999 else 0.0)
        rows.append((0.01 * k, passed, f"v{k % clocks}"))
    assert after(rows).is_record and not after(rows).has_paced


def test_readings_that_are_missing_at_random_do_not_make_a_clock_for_each_row():
    pace, draw = Pace(), random.Random(1)
    for k in range(3000):
        pace.take(0.1 * k, 1e-5 * k, {f"c{i}": 1.0 if draw.random() < 0.5 else float("nan") for i in range(20)})
    assert len(pace._clocks) <= 51 and pace.is_record
