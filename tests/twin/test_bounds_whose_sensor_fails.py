"""Bounds of `watch` whose sensor is not believed: an overload is not told as ended where nothing shows that it is.

Readings are written here, in kN: a load that hangs still with 49 kN, and what comes from 2 s on. The bound is 80 kN.
"""

import numpy as np
import pytest
from twin.rehearsal import SENSORS, STILL, hoist, rows_of

from tautline.twin.signals.sensors import Health
from tautline.twin.twin import Twin
from tautline.twin.watch import Compared, Watch

HELD, OVER, RATE, END = 49.0, 83.95, 10.0, 12.0
TIMES = np.arange(0.0, END, 1.0 / RATE)
MISSING = float("nan")


@pytest.fixture(scope="module")
def told():
    """A function that judges readings by time, and gives (time, alarm of that name or None) of all rows."""
    plan = Twin(
        STILL,
        """
sensors:
  - {column: load, unit: kN, output: winch.tension, sd: 0.5 kN, range: [0 kN, 90 kN]}
watch:
  - {output: winch.tension, above: 80 kN, name: overload}
  - {residual: winch.tension, above: 20 kN, for: 1 s, name: irregular}
  - {output: winch.tension, above: 80 kN, for: 0.5 s, name: lasting overload}
  - {residual: winch.tension, above: 20 kN, for: 0.5 s, name: lasting irregular}
  - {output: winch.tension, above: 80 kN, for: 3 s, name: long overload}
  - {residual: winch.tension, above: 20 kN, for: 3 s, name: long irregular}
ahead: 0 s
""",
    ).plan

    def judged(readings, computed=lambda time: HELD, name="overload", times=TIMES, rests=np.inf, down=()):
        health, noise = Health(plan.channels[0]), np.random.default_rng(1)
        watch, found = Watch(plan, [health], None), []
        for time in times:
            if time >= rests:
                watch.begun_again()
                rests = np.inf
            reading = readings(time)
            reading += 0.1 * noise.standard_normal() * (reading not in (OVER, 90.0))
            value = health.check(time, 1e3 * reading)
            expected = 1e3 * computed(time)
            watch.judge(Compared(
                time, np.array([value]), {"winch.tension": (expected, 100.0)}, np.array([value - expected]),
                np.full(1, 500.0), np.isfinite([value]), np.ones(1), True, None,
                put_down=any(begin - 0.01 < time < end - 0.01 for begin, end in down),
            ))  # fmt: skip
            found.append((time, watch.alarms.active.get(name)))
        return found

    return judged


def between(found, begin, end):
    """Alarms from a time to another, s."""
    return [one for time, one in found if begin < time < end]


def steps(*parts):
    """Readings that change at times: (time, reading)."""
    return lambda time: [HELD, *(reading for at, reading in parts if time > at + 1e-9)][-1]


FAILING = {
    "nothing is shown": ((2.0, 84.0), (4.0, MISSING)),
    "the cell is stuck": ((2.0, 84.0), (5.0, OVER)),
}


@pytest.mark.parametrize("kind", FAILING)
def test_an_overload_is_not_over_while_its_cell_fails_and_is_so_when_the_cell_shows_less(kind, told):
    found = told(steps(*FAILING[kind], (10.0, HELD)))
    assert all(one is not None for one in between(found, 2.0, 10.0))
    assert all(not one.known and "not known any more" in one.text for one in between(found, 6.0, 10.0))
    assert not any(between(found, 11.2, END))


def test_what_is_computed_ends_an_overload_of_a_dead_cell_only_where_it_was_one_there_too(told):
    dead = steps((2.0, 84.0), (4.0, MISSING))
    assert all(between(told(dead, lambda time: 50.0), 2.0, END)), "a load that was picked up as the cell broke"
    found = told(dead, lambda time: 84.0 if 2.0 < time < 7.0 else 50.0)
    assert all(between(found, 2.0, 7.0)) and not any(between(found, 8.2, END))


def test_what_is_computed_and_begun_again_from_rest_has_followed_no_overload_and_ends_none(told):
    found = told(steps((2.0, 84.0), (4.0, MISSING)), lambda time: 84.0 if 2.0 < time < 7.0 else 50.0, rests=7.0)
    assert all(between(found, 2.0, END))


STANDS = 1.0
"""For how long a load has to stand on the ground, on a slack rope, s, by docs/twin_alarms.md."""


@pytest.mark.parametrize("down", [7.0, 8.5])
def test_an_overload_that_was_computed_too_ends_where_its_load_is_put_down_behind_a_rest_and_no_sooner(down, told):
    """What began again at rest as the load was put down is never beyond the bound again."""
    dead, followed = steps((2.0, 84.0), (4.0, MISSING)), lambda time: 84.0 if 2.0 < time < 7.0 else 0.0
    found = told(dead, followed, rests=7.0, down=((down, END),))
    assert all(between(found, 2.0, down + STANDS + 0.85)) and not any(between(found, down + STANDS + 1.2, END))


@pytest.mark.parametrize("touches", [0.1, 0.9, 1.1])
def test_a_load_that_touches_the_ground_in_the_troughs_of_waves_is_put_down_where_it_stands_for_a_second(touches, told):
    """A trough every two seconds, and one before what is computed began again at rest, which goes on behind that."""
    dead, followed = steps((2.0, 84.0), (4.0, MISSING)), lambda time: 84.0 if 2.0 < time < 7.0 else 0.0
    troughs = ((6.0, 7.0 + 0.5 * touches), *((begin, begin + touches) for begin in (8.0, 10.0)))
    found = told(dead, followed, rests=7.0, down=troughs)
    assert all(between(found, 2.0, 8.0 + STANDS + 0.85))
    assert any(between(found, 8.0 + STANDS + 1.2, END)) == (touches < STANDS)


def test_a_load_that_was_never_computed_ends_no_overload_by_being_put_down_behind_a_rest(told):
    dead = steps((2.0, 84.0), (4.0, MISSING))
    assert all(between(told(dead, lambda time: 0.0, rests=7.0, down=((7.0, END),)), 2.0, END))


@pytest.mark.parametrize("beyond, known", [(((2.0, 84.0), (3.0, 120.0)), True), (((2.0, 120.0),), False)])
def test_a_reading_beyond_its_range_is_an_overload_and_certain_only_where_one_was_seen_before(beyond, known, told):
    found = told(steps(*beyond, (8.0, HELD)))
    assert all(one is not None and one.known == known for one in between(found, 2.0, 8.0))
    assert any("outside its range" in one.text for one in between(found, 4.0, 8.0))
    assert not any(between(found, 9.2, END))


def test_a_cell_that_is_clipped_at_the_end_of_its_range_shows_an_overload(told):
    found = told(steps((2.0, 90.0), (8.0, HELD)))
    assert any("has shown 90 kN since" in one.text for one in between(found, 4.0, 8.0))
    assert all(one is not None and one.known for one in between(found, 2.0, 8.0))
    assert not any(between(found, 9.2, END))


def test_an_overload_that_ended_as_the_cell_broke_does_not_stay(told):
    assert not any(between(told(steps((2.0, 84.0), (4.0, HELD), (4.5, MISSING))), 5.2, END))


@pytest.mark.parametrize("name", ["overload", "irregular"])
def test_a_cell_of_every_second_row_shows_what_one_of_every_row_does(name, told):
    whole = steps((2.0, 84.0), (8.0, HELD))
    half = told(lambda time: whole(time) if round(RATE * time) % 2 == 0 else MISSING, name=name)
    assert not any(between(half, 0.0, 2.0))
    assert all(one is not None and one.known for one in between(half, 3.3, 8.0))
    assert not any(between(half, 9.3, END))


@pytest.mark.parametrize("name", ["overload", "irregular"])
@pytest.mark.parametrize("shown", ["1101100110010111", "1110000110", "1000000000"])
def test_single_readings_that_are_missing_change_nothing_of_an_alarm(name, shown, told):
    """Rows of 10 Hz: one that has a reading is 1, one that has none is 0, again and again."""
    whole = steps((2.0, 84.0))
    found = told(lambda time: whole(time) if shown[round(RATE * time) % len(shown)] == "1" else MISSING, name=name)
    assert not any(between(found, 0.0, 2.0))
    assert all(one is not None and one.known for one in between(found, 5.1, END))


@pytest.mark.parametrize("name", ["overload", "irregular"])
def test_a_sensor_whose_readings_come_in_pairs_shows_an_overload_between_them(name, told):
    """Two readings 1 ms apart every half second: most rows are of other sensors."""
    pairs = [0.5 * k + one for k in range(24) for one in (0.0, 0.001)]
    times, whole = np.union1d(pairs, np.arange(0.05, END, 0.1)), steps((2.0, 84.0))
    found = told(lambda time: whole(time) if time in pairs else MISSING, name=name, times=times)
    assert not any(between(found, 0.0, 2.0))
    assert all(one is not None and one.known for one in between(found, 4.1, END))


def test_a_sensor_that_falls_silent_shows_nothing_after_a_second_or_two_and_a_half_of_its_intervals(told):
    for every, stands in ((1, 1.0), (10, 2.5)):
        whole = steps((2.0, 84.0), (5.0, MISSING))
        found = told(lambda time, of=every, w=whole: w(time) if round(RATE * time) % of == 0 else MISSING)
        assert all(one is not None and one.known for one in between(found, 3.1, 5.0 + stands))
        assert all(not one.known for one in between(found, 5.1 + stands, END))


@pytest.mark.parametrize("name", ["lasting overload", "lasting irregular"])
@pytest.mark.parametrize("wrong", [89.0, 120.0], ids=["within the range", "beyond the range"])
def test_one_wrong_reading_of_a_slow_sensor_has_not_lasted_and_two_have(name, wrong, told):
    """A reading a second among rows of 10 Hz, and bounds with `for: 0.5 s`."""

    def slow(shown):
        return lambda time: MISSING if round(RATE * time) % 10 else shown.get(round(time), HELD)

    assert not any(one for _, one in told(slow({5: wrong}), name=name))
    if name == "lasting overload" or wrong < 90.0:
        two = told(slow({5: wrong, 6: wrong}), name=name)
        assert not any(between(two, 0.0, 5.95)) and all(between(two, 5.95, 7.0))


@pytest.mark.parametrize("name", ["lasting overload", "lasting irregular"])
def test_a_second_reading_beyond_a_bound_need_not_come_as_its_time_is_over(name, told):
    found = told(lambda time: 84.0 if round(time, 3) in (5.0, 5.3) else HELD if time < 5.0 else MISSING, name=name)
    assert not any(between(found, 0.0, 5.45)) and all(between(found, 5.45, 6.2))


def test_what_is_computed_beyond_a_bound_lasts_without_readings(told):
    found = told(steps((0.0, MISSING)), lambda time: 84.0 if time > 5.05 else HELD, "lasting overload")
    assert not any(between(found, 0.0, 5.55)) and all(between(found, 5.65, END))


BURSTS = {"2 s in 5 s": (5.0, 2.0), "three readings in 1.7 s": (1.7, 0.25), "all but 1.2 s in 5 s": (5.0, 3.8)}
"""Period of readings that come in bursts, and how long one lasts, s."""


def bursts(kind, whole, until=np.inf):
    """Readings in bursts, up to a time, s."""
    period, lasting = BURSTS[kind]
    return lambda time: whole(time) if time % period < lasting and time < until else MISSING


@pytest.mark.parametrize("name", ["long overload", "long irregular"])
@pytest.mark.parametrize("kind", BURSTS)
def test_silences_of_a_sensor_do_not_keep_a_bound_from_having_been_passed_for_its_time(kind, name, told):
    """All readings from 5 s on are beyond the bound, with `for: 3 s`."""
    read, times = bursts(kind, steps((5.0, 84.0))), np.arange(0.0, 20.0, 0.1)
    found = told(read, name=name, times=times)
    over = [time for time in times if time > 5.05 and np.isfinite(read(time))]
    lasted = next(time for time in over if time >= over[0] + 3.0)
    assert not any(between(found, 0.0, over[0] + 2.95)) and all(between(found, lasted - 0.05, 20.0))


@pytest.mark.parametrize("name", ["long overload", "long irregular"])
def test_a_reading_within_a_bound_begins_its_time_anew_behind_a_silence_and_no_silence_is_time(name, told):
    """Bursts of 2 s in 5 s, of which the last two readings alone are beyond the bound, with `for: 3 s`."""
    read = bursts("2 s in 5 s", lambda time: 84.0 if 1.75 < time % 5.0 < 1.95 else HELD)
    assert not any(one for _, one in told(read, name=name, times=np.arange(0.0, 40.0, 0.1)))


@pytest.mark.parametrize("name", ["long overload", "long irregular"])
@pytest.mark.parametrize(("silent", "rows"), [(9.5, True), (10.5, True), (50.0, True), (9.5, False), (3600.0, False)])
def test_two_lone_readings_beyond_a_bound_are_no_overload_that_lasts_where_ten_silent_seconds_are_between(
    silent, rows, name, told
):
    """`for: 3 s`; one reading at 2 s, silence with rows or without, and one behind it."""
    begin, again = np.arange(0.0, 2.05, 0.1), 2.0 + silent
    times = np.r_[begin, np.arange(2.1, again - 0.05, 0.1) if rows else [], again + np.arange(0.0, 5.0, 0.1)]

    def reading(time):
        if min(abs(time - 2.0), abs(time - again)) < 0.04:
            return 84.0
        return MISSING if 2.0 < time < again else HELD

    found = told(reading, name=name, times=times)
    assert any(one for _, one in found) == (silent < 10.0)


def test_one_computed_row_is_no_overload_that_lasts_behind_a_reading_of_fifty_seconds_ago(told):
    dead = steps((1.95, 84.0), (2.05, MISSING))
    found = told(dead, lambda time: 84.0 if abs(time - 52.0) < 0.04 else HELD, "long overload", np.arange(0, 60, 0.1))
    assert not any(one for _, one in found)


def test_single_rows_of_what_is_computed_are_no_overload_that_lasts_where_rows_between_are_within(told):
    """A dead cell that showed 84 kN last: computed rows at 8, 14 and 20 s are beyond the bound, all others are not."""
    dead = steps((1.95, 84.0), (2.25, MISSING))
    computed = {8.0, 14.0, 20.0}
    found = told(
        dead, lambda time: 84.0 if round(time, 3) in computed else HELD, "long overload", np.arange(0, 25, 0.1)
    )
    assert not any(one for _, one in found)


@pytest.mark.parametrize("name", ["long overload", "long irregular"])
@pytest.mark.parametrize("rows", [1.0, 20.0])
def test_two_readings_of_a_sensor_that_is_slower_than_ten_seconds_have_lasted(rows, name, told):
    """A reading in 20 s, of which those of 60 s and later are beyond the bound; rows as often, or every second."""
    found = told(
        lambda time: MISSING if time % 20.0 else 84.0 if time > 50.0 else HELD, name=name, times=np.arange(0, 101, rows)
    )
    assert not any(between(found, 0.0, 79.5)) and all(between(found, 79.5, 101.0))


@pytest.mark.parametrize("name", ["overload", "irregular"])
@pytest.mark.parametrize(("kind", "rate"), [*((kind, 10.0) for kind in BURSTS), ("2 s in 5 s", 50.0)])
def test_an_alarm_stays_known_in_silences_as_long_as_three_of_the_last_minute_and_no_longer(kind, rate, name, told):
    """Bursts to 25 s, of an overload from 15.5 s on, and nothing from then on."""
    (period, lasting), times = BURSTS[kind], np.arange(0.0, 30.0, 1.0 / rate)
    read = bursts(kind, steps((15.5, 84.0)), until=25.0)
    found, shown = told(read, name=name, times=times), [time for time in times if np.isfinite(read(time))]
    begin, silence = next(time for time in shown if time > 18.5), np.diff(shown).max()
    assert period - lasting <= silence < period - lasting + 0.2
    assert all(one is not None and one.known for one in between(found, begin, shown[-1] + silence + 0.01))
    assert all(not one.known for one in between(found, shown[-1] + 1.3 * silence, 30.0))


@pytest.mark.parametrize("name", ["overload", "irregular"])
def test_two_silences_are_not_usual_yet_nor_are_three_of_which_one_is_longer(name, told):
    """Readings of 10 Hz but for silences of 3, 3, 1.5 and 3 s: the last stands 1, 1, 1 and 1.9 s."""
    silent = ((4.0, 7.0), (9.0, 12.0), (14.0, 15.5), (17.0, 20.0))
    found = told(
        lambda time: MISSING if any(a < time < b for a, b in silent) else 84.0, name=name, times=np.arange(0, 21, 0.1)
    )
    for (begin, end), stands in zip(silent, (1.0, 1.0, 1.0, 1.25 * 1.5), strict=True):
        assert all(one.known for one in between(found, begin, begin + stands - 0.15))
        assert all(not one.known for one in between(found, begin + stands + 0.15, end))


@pytest.mark.parametrize(("every", "lost", "stands"), [(12.0, 99.0, 10.0), (4.0, 4.5, 4.5)])
def test_no_silence_is_usual_for_longer_than_ten_seconds_or_than_its_sensor_counts_as_lost(every, lost, stands):
    """Two readings again and again, and none behind the fifth time."""
    load = f"sensors: [{{column: load, unit: kN, output: winch.tension}}]\nlost: {lost} s"
    health, last = Health(Twin(STILL, load).plan.channels[0]), 4.0 * every + 0.1
    for time in np.arange(0.0, last + 15.0, 0.1):
        health.check(time, 84e3 + time if time % every < 0.15 and time < last + 0.05 else MISSING)
        if abs(time - last - stands) > 0.05 and time > last:
            assert np.isfinite(health.last_side(time)) == (time < last + stands)


def lowered(cell_dies, rests, end):
    """Lines of a crane that lowers 5 t onto the ground, with a bound of 40 kN, and when the rope is slack first."""
    scene = hoist({"time": [0, 1, 4, 5, 60], "value": [0, 0.8, 0.8, 0, 0]}, start_height=-20, ground=-21.5, heave=0.0)
    bound = "watch: [{output: winch.tension, above: 40 kN, name: overload}]\nahead: 0 s\n"
    twin, lines = Twin(scene, SENSORS + bound), []
    for stamp, readings in rows_of(scene, end=end):
        slack = lines and lines[-1]["outputs"]["winch.tension"] < 20e3
        if rests and slack:
            twin.estimate.from_rest, rests = True, False
        dead = {"rope_tension": MISSING} if stamp > cell_dies else {}
        lines += twin.add(stamp, readings | dead)
    return lines + twin.finish()


@pytest.mark.parametrize("rests", [False, True])
def test_an_overload_of_a_crane_whose_cell_is_dead_ends_when_its_load_stands_on_the_ground(rests):
    lines = lowered(1.5, rests, 9.0)
    down = next(line["time"] for line in lines if line["outputs"]["winch.tension"] < 20e3)
    active = [line["time"] for line in lines if any(one["name"] == "overload" for one in line["alarms"])]
    assert active[0] == lines[0]["time"] and down < active[-1] < down + 4.0
