"""Rows of data: what is late, doubled, shuffled, from the future, or without a stamp has a stated answer."""

import re

import numpy as np
import pytest

from tautline.twin.map.plan import Channel
from tautline.twin.signals.rows import Rows
from tautline.twin.signals.sensors import Health
from tautline.twin.sources.table.header import Header


def given(stamps, delay=0.3, interval=0.1):
    rows, came = Rows(["x"], delay), []
    rows.known_interval = interval
    for k, stamp in enumerate(stamps):
        rows.add(stamp, {"x": float(k)})
        while (row := rows.ready()) is not None:
            came.append(row)
    while (row := rows.ready(end=True)) is not None:
        came.append(row)
    return rows, came


def times(came):
    return [round(row.time, 6) for row in came]


REGULAR = [round(0.1 * k, 6) for k in range(40)]


def test_rows_in_order_come_out_as_they_came():
    rows, came = given(REGULAR)
    assert times(came) == REGULAR
    assert not +rows.counts


def test_rows_out_of_order_within_the_delay_are_put_in_order():
    shuffled = REGULAR.copy()
    for k in range(10, 38, 3):
        shuffled[k], shuffled[k + 1] = shuffled[k + 1], shuffled[k]
    rows, came = given(shuffled)
    assert times(came) == REGULAR
    assert rows.counts["out of order"] == 10


def test_a_row_later_than_the_delay_is_left_out_and_counted():
    rows, came = given([*REGULAR[:20], 0.55, *REGULAR[20:]])
    assert times(came) == REGULAR
    assert rows.counts["late"] == 1


def test_doubled_rows_count_once_and_fill_what_was_empty():
    rows = Rows(["x", "y"], 0.0)
    rows.add(0.0, {"x": 1.0})
    rows.add(0.0, {"x": 5.0, "y": 2.0})
    row = rows.ready(end=True)
    assert row.values.tolist() == [1.0, 2.0]
    assert rows.counts["doubled"] == 1


def test_columns_that_come_one_by_one_with_one_stamp_are_not_doubled_and_one_that_comes_twice_is():
    rows = Rows(["a", "b", "c"], 0.15)
    apart(rows, gap=0.0)
    assert not rows.counts
    rows.add(0.05 * 39, {"b": 391.0})
    assert rows.counts == {"doubled": 1}
    assert [list(row.values) for row in rows.waiting[-2:]] == [[10.0 * k, 10.0 * k + 1, 10.0 * k + 2] for k in (38, 39)]


def test_a_stamp_from_the_future_is_left_out_and_the_next_rows_are_not():
    rows, came = given([*REGULAR[:20], 1000.0, *REGULAR[20:]])
    assert times(came) == REGULAR
    assert rows.counts["future"] == 1


@pytest.mark.parametrize("gap", [0.1, 1.0, 10.0, 60.0])
def test_a_gap_is_a_gap_and_nothing_is_lost_after_it(gap):
    late = [round(stamp + gap, 6) for stamp in REGULAR[20:]]
    rows, came = given([*REGULAR[:20], *late])
    assert times(came) == [*REGULAR[:20], *late]
    assert rows.counts["gaps"] == (gap > 0.4)
    assert [row.after_gap for row in came].count(True) == (gap > 0.4)


def test_a_clock_that_is_set_back_goes_on_from_where_it_was():
    rows, came = given([*REGULAR[:20], *(round(stamp - 1.5, 6) for stamp in REGULAR[20:])])
    found = times(came)
    assert found == sorted(found)
    assert len(found) == 40
    assert np.allclose(np.diff(found), 0.1)
    assert rows.counts["clock set back"] == 1


def test_rows_without_a_stamp_are_left_out():
    rows, came = given([*REGULAR[:20], float("nan"), *REGULAR[20:]])
    assert times(came) == REGULAR
    assert rows.counts["no stamp"] == 1


def test_a_clock_that_runs_fast_is_reported():
    rows = Rows(["x"], 0.0, live=True)
    for k in range(900):
        rows.add(0.1 * k * 1.01, {"x": 0.0}, arrived=0.1 * k)
    assert rows.arrivals.clock_rate == pytest.approx(0.01, abs=1e-4)
    assert "runs +1 %" in rows.notes[0]


def faults_of_a_rotary(speeds, **channel):
    """Faults that a sensor of the rotary speed is said to have, row by row at 10 Hz."""
    one = Channel(**{
        "column": "rpm", "name": "top.rotary_speed", "is_input": True, "is_output": False, "unit": "rad/s",
        "scale": 1.0, "zero": 0.0, "zero_first": False, "sd": np.nan, "relative": False, "low": -np.inf,
        "high": np.inf, "waves": False, "lost_after": 5.0,
    } | channel)  # fmt: skip
    health = Health(one)
    faults = []
    for k, speed in enumerate(speeds):
        health.check(0.1 * k, speed)
        faults.append(health.fault)
    return faults


def set_point():
    """A rotary that stands, is taken to 12 rad/s with the rounding of six digits, and stays there."""
    random, t = np.random.default_rng(4), np.arange(0.0, 200.0, 0.1)
    rising = np.round(12.0 * np.clip((t - 50.0) / 5.0, 0.0, 1.0) + 1e-4 * random.standard_normal(t.size), 6)
    return np.where(t < 55.0, rising, 12.0)


def test_a_rotary_speed_that_stands_at_its_set_point_is_not_clipped():
    assert set(faults_of_a_rotary(set_point())) == {""}


def test_a_rotary_speed_that_stands_at_the_end_of_its_range_is_clipped():
    assert faults_of_a_rotary(set_point(), low=0.0, high=12.0)[-1] == "clipped"


def told_missing(readings, bounds=(-np.inf, np.inf)):
    """Which readings of a column come out as missing."""
    rows = Rows(["x"], 0.0)
    rows.bounds = [bounds]
    for k, reading in enumerate(readings):
        rows.add(0.1 * k, {"x": reading})
    came = []
    while (row := rows.ready(end=True)) is not None:
        came.append(row)
    return [bool(np.isnan(row.values[0])) for row in came]


@pytest.mark.parametrize("null", [-999.0, -999.25, -9999.0, -9999.25])
def test_what_rigs_write_for_a_missing_value_is_no_reading(null):
    assert told_missing([null, 205.0, null, 204.0]) == [True, False, True, False]
    assert told_missing([205.0, null], (0.0, 600.0)) == [False, True]


def test_a_null_of_rigs_is_a_reading_where_the_sensor_can_show_it():
    assert not any(told_missing([-990.0, -995.0, -999.0, -1003.0]))
    assert not any(told_missing([0.0, -999.0], (-2000.0, 2000.0)))


@pytest.mark.parametrize("unit", ["kN", "N", "klbf", "tf"])
def test_a_null_is_told_by_what_was_written_whatever_unit_the_header_gives(unit):
    header = Header(f"time [s],x [{unit}]", ["x"], "", "rec.csv", {"x": "klbf"})
    rows = Rows(["x"], 0.0)
    rows.bounds, rows.factors = [(0.0, 600.0)], header.factors
    for k, written in enumerate(["100", "-999.25", "-9999.25", "101"]):
        rows.add(*header.read(f"{0.1 * k},{written}"))
    came = []
    while (row := rows.ready(end=True)) is not None:
        came.append(np.isnan(row.values[0]))
    assert came == [False, True, True, False]
    assert rows.counts["with a reading that stands for none (-999.25)"] == 2


@pytest.mark.parametrize("zero", [{"zero_first": True, "zero": 0.0}, {"zero_first": False, "zero": -980.0}])
def test_a_null_is_a_reading_where_the_zero_of_the_sensor_is_near_it(zero):
    place = Channel(
        column="x", name="winch.pay_out", is_input=True, unit="m", scale=1.0, sd=np.nan, relative=False, low=-50.0,
        high=50.0, waves=False, lost_after=5.0, **zero,
    )  # fmt: skip
    assert not any(told_missing([-985.0, -998.0, -999.0, -1000.0], place.shown))
    assert told_missing([-985.0, -9999.0], place.shown) == [False, True]


def hook(readings, rate=10.0, **channel):
    """What a hook load in klbf is taken for, reading by reading, with the next three known; and its health."""
    klbf = 4448.2216152605
    one = Channel(**{
        "column": "hook_load", "name": "top.hook_load", "is_input": False, "unit": "N", "scale": klbf, "zero": 0.0,
        "zero_first": False, "sd": 0.01, "relative": True, "low": -np.inf, "high": np.inf, "waves": False,
        "lost_after": 5.0, "column_unit": "klbf", "factor": klbf,
    } | channel)  # fmt: skip
    health, si = Health(one), klbf * np.asarray(readings, float)
    t = np.arange(si.size) / rate
    values = [health.check(t[k], si[k], si[k + 1 : k + 4], list(t[k + 1 : k + 4])) for k in range(si.size)]
    return np.array(values) / klbf, health


NOISY = 200.0 + 2.0 * np.random.default_rng(5).standard_normal(120)


@pytest.mark.parametrize(("at", "jump"), [([60], -1200.0), ([60, 61], 800.0), ([40, 80], 300.0)])
def test_a_reading_that_jumps_away_and_back_is_left_out_counted_and_told(at, jump):
    readings = NOISY.copy()
    readings[at] += jump
    values, health = hook(readings)
    assert np.flatnonzero(np.isnan(values)).tolist() == at
    assert health.jumps == len(at)
    assert health.jump.startswith("hook_load jumped from ") and "klbf" in health.jump
    assert health.jumping(0.1 * at[-1] + 5.0) and not health.jumping(0.1 * at[-1] + 15.0)


def test_a_jump_below_the_usual_digits_is_told_with_as_many_as_show_it():
    readings = 800.0 + 1e-4 * np.random.default_rng(5).standard_normal(120)
    readings[60] = 800.02
    _, health = hook(readings, sd=1e-4, relative=False)
    one, other = re.fullmatch(r".* jumped from (\S+) klbf to (\S+) klbf and back .*", health.jump).groups()
    assert float(other) - float(one) == pytest.approx(0.02, rel=0.1)


def test_a_hook_load_that_falls_into_slips_or_swings_from_row_to_row_does_not_jump():
    assert hook(np.where(np.arange(120) < 60, NOISY, NOISY - 150.0))[1].jumps == 0
    swing = 100.0 + 60.0 * np.cos(2.0 * np.pi * np.arange(120) / 2.7)
    assert hook(swing, sd=0.001)[1].jumps == 0


@pytest.mark.parametrize("sd", [{"sd": np.nan, "relative": False}, {"sd": 0.0005}], ids=["no sd", "a small sd"])
def test_the_last_digit_of_a_sensor_that_shows_round_numbers_does_not_jump(sd):
    flicker = np.where(np.arange(200) % 17 == 0, 51.0, 50.0)
    values, health = hook(flicker, **sd)
    assert health.jumps == 0 and np.isfinite(values).all()
    knocked = np.where(np.arange(200) == 100, 400.0, flicker)
    assert hook(knocked, **sd)[1].jumps == 1


@pytest.mark.parametrize(("rate", "away", "jumps"), [(1.0, 1, 0), (2.0, 1, 0), (5.0, 1, 1), (5.0, 2, 0), (10.0, 2, 2)])
def test_what_is_away_for_longer_than_half_a_second_does_not_jump(rate, away, jumps):
    readings = NOISY.copy()
    readings[60 : 60 + away] += 300.0
    assert hook(readings, rate)[1].jumps == jumps


def test_a_spike_outside_the_range_is_out_of_range_and_no_jump():
    klbf = 4448.2216152605
    spiked = np.where(np.arange(61) == 60, 9999.0, NOISY[:61])
    health = hook([*spiked, 9999.0], low=0.0, high=600.0 * klbf)[1]
    assert health.fault == "out of range" and health.jumps == 0 and np.isnan(health.left_out)
    # A sensor that shows round numbers comes back with the very reading that it had before.
    assert hook([200.0, 9999.0, 200.0], low=0.0, high=600.0 * klbf)[1].fault == ""


def test_a_sensor_outside_its_range_is_told_in_its_own_unit_with_the_range():
    klbf = 4448.2216152605
    _, health = hook([155.0, 700.0], low=0.0, high=600.0 * klbf)
    assert health.text == "hook_load shows 700 klbf, outside its range of 0 klbf to 600 klbf"


def test_the_rounding_of_a_sensor_that_stands_at_zero_does_not_jump():
    random = np.random.default_rng(6)
    readings = 10.0 ** random.uniform(-15.0, -11.0, 200) * random.choice([-1.0, 1.0], 200)
    assert hook(readings)[1].jumps == 0


def test_a_reading_that_is_absurd_in_si_is_none():
    rows = Rows(["x"], 0.0)
    rows.scales = np.array([1e3])
    rows.add(0.0, {"x": 1e29})
    assert np.isnan(rows.ready(end=True).values[0]) and rows.counts["with an absurd reading"] == 1


def test_a_place_that_counts_from_elsewhere_has_not_leapt_and_one_that_falls_to_zero_and_stands_is_stuck():
    block = Channel(
        column="block", name="top.block", is_input=True, unit="m", scale=1.0, zero=0.0, zero_first=True, sd=np.nan,
        relative=False, low=-np.inf, high=np.inf, waves=False, lost_after=5.0,
    )  # fmt: skip
    faults = {}
    for counted_anew in (True, False):
        health = Health(block)
        for k in range(100):
            health.check(0.1 * k, 28.0 - 0.05 * k + 0.02 * np.sin(0.1 * k))
        if counted_anew:
            health.count_anew(-health.last)
        for k in range(100, 120):
            health.check(0.1 * k, 0.0)
        faults[counted_anew] = health.fault
    assert faults == {True: "", False: "stuck"}


def apart(rows, order=(0, 1, 2), gap=0.001, count=40):
    """Rows of three columns, each in a row of its own, 20 times a second."""
    for k in range(count):
        for i, column in enumerate(order):
            rows.add(0.05 * k + gap * i, {"abc"[column]: float(10 * k + column)})


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1)])
def test_columns_in_rows_of_their_own_that_are_close_are_one_row_at_their_own_interval(order):
    rows = Rows(["a", "b", "c"])
    apart(rows, order)
    assert rows.interval == pytest.approx(0.05)
    found = []
    while (row := rows.ready(True)) is not None:
        found.append(row)
    assert [row.time for row in found] == pytest.approx([0.05 * k for k in range(40)])
    assert [list(row.values) for row in found] == [[10.0 * k, 10.0 * k + 1, 10.0 * k + 2] for k in range(40)]
    assert not rows.counts and not any(row.after_gap for row in found)
    assert [row.places for row in found] == [[3 * k, 3 * k + 1, 3 * k + 2] for k in range(40)]


def test_a_column_that_comes_twice_within_a_row_is_doubled():
    rows = Rows(["a", "b", "c"])
    apart(rows)
    rows.add(0.05 * 39 + 0.002, {"c": 392.0})
    assert rows.counts == {"doubled": 1}


def test_close_rows_that_have_columns_in_common_stay_apart():
    rows = Rows(["a", "b"])
    for k in range(20):
        rows.add(0.05 * k, {"a": 1.0, "b": float(k)})
    rows.add(0.951, {"a": 2.0})
    assert [row.time for row in rows.waiting][-2:] == pytest.approx([0.95, 0.951])


@pytest.mark.parametrize("delay", [None, 0.0])
def test_rows_of_one_stamp_with_different_readings_are_told_once_as_stamps_with_too_few_digits(delay):
    rows, told = Rows(["x"], delay), []
    for k in range(200):
        rows.add(1767225600.0 + k // 20, {"x": float(k)})
        while rows.ready() is not None:
            pass
        told += [k] * len(rows.notes[len(told) :])
    assert told == [3]
    assert "at 2026-01-01 00:00:00.0 UTC" in rows.notes[0] and "too few digits" in rows.notes[0]


def test_rows_that_come_twice_with_equal_readings_or_fill_one_another_need_no_word():
    rows = Rows(["x", "y"], 0.0)
    for k in range(40):
        rows.add(k // 4, {("x", "y")[k % 2]: float(k // 4)})
    assert not rows.notes


def test_columns_whose_stamps_are_behind_those_of_another_are_told_once_with_how_far():
    rows, told = Rows(["winch", "heave", "tension"]), []
    for k in range(400):
        rows.add(100.0 + 0.05 * k, {"winch": 0.1 * k})
        rows.add(98.5 + 0.05 * k, {"heave": 0.2 * k, "tension": 0.3 * k})
        while rows.ready() is not None:
            pass
        told += [k] * len(rows.notes[len(told) :])
    assert rows.counts["late"] > 300
    assert len(told) == 1 and told[0] < 60
    assert rows.notes[0].startswith("the stamps of heave, tension are 1.5 s behind those of winch: ")


def test_late_rows_of_all_columns_and_a_column_that_is_late_now_and_then_need_no_such_word():
    rows = Rows(["winch", "heave"], 0.1)
    for k in range(400):
        rows.add(100.0 + 0.05 * k, {"winch": 0.1 * k, "heave": 0.3 * k})
        late = 98.5 + 0.05 * k + 0.025
        rows.add(late, {"winch": 0.1 * k, "heave": 0.2 * k} if k % 2 else {"heave": 0.2 * k})
        while rows.ready() is not None:
            pass
    assert rows.counts["late"] > 300 and not rows.notes


@pytest.mark.parametrize("first", [0, 1])
def test_columns_whose_stamps_are_far_ahead_of_those_of_others_are_told_once_and_the_others_stay(first):
    rows, found = Rows(["winch", "heave", "tension"]), []
    for k in range(400):
        both = (100.0 + 0.05 * k, {"winch": 0.1 * k, "tension": 0.3 * k}), (3700.0 + 0.05 * k, {"heave": 0.2 * k})
        for one in (both[first], both[1 - first]) if k >= 10 else both[:1]:
            rows.add(*one)
        while (row := rows.ready()) is not None:
            found.append(row)
    (note,) = rows.notes
    assert note.startswith("the stamps of heave are 3600 s ahead of those of winch, tension: ")
    assert len(found) > 390 and found[-1].time < 120.0


def test_no_delay_of_an_hour_is_advised():
    rows = Rows(["winch", "heave"])
    for k in range(100):
        rows.add(3700.0 + 0.05 * k, {"winch": 0.1 * k})
        rows.add(100.0 + 0.05 * k, {"heave": 0.1 * k})
        while rows.ready() is not None:
            pass
    (note,) = rows.notes
    assert "heave are 3600 s behind those of winch" in note and "`delay" not in note


def test_a_column_that_is_late_every_second_time_is_told_as_one_that_always_is():
    rows = Rows(["winch", "heave"], 0.3)
    for k in range(200):
        rows.add(100.0 + 0.05 * k, {"winch": 0.1 * k})
        rows.add(100.0 + 0.05 * (k - (8 if k % 2 else 4)) + 0.02, {"heave": 0.2 * k})
        while rows.ready() is not None:
            pass
    (note,) = rows.notes
    assert note.startswith("the stamps of heave are 0.38 s behind those of winch") and "`delay: 0.5 s`" in note
