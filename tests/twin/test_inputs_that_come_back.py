"""Inputs that come back after they were missing or stuck: nothing is seen that the machine never did.

The records are of a finer model of the shipped hoist, with a load of 5.3 t that the twin has to find.
"""

import functools
import tempfile
from itertools import takewhile
from pathlib import Path

import numpy as np
import pytest
from of_the_suite import studies
from twin.rehearsal import HOIST, SENSORS, alarms, changed

import tautline
from tautline.twin.forecast import Found
from tautline.twin.map.file import read_map
from tautline.twin.map.plan import Channel
from tautline.twin.record import Sensing, record
from tautline.twin.settling import Settling
from tautline.twin.signals.inputs import InputTrack
from tautline.twin.signals.row import Row
from tautline.twin.signals.waves import Waves
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

MAP = (
    SENSORS.replace("sd: 1 %", "sd: 0.5 kN").replace("unit: cm", "unit: m")
    + """
estimate:
  - {parameter: payload.mass, start: 9 t, sd: 4 t, range: [0.5 t, 20 t], drift: 1 kg/s^0.5}
watch:
  - {output: winch.tension, above: 65 kN, ahead: 2 s, name: overload}
  - {output: min_tension, below: 1 kN, ahead: 2 s, name: slack rope ahead}
"""
)
RATE = 20.0
UNTRUE = {"overload", "slack rope ahead"}
"""Alarms of which none is true after four seconds: the tension is 43 to 58 kN then."""
QUIET = 4.0
KEPT = (100, 120, 200)
"""Rows after which a twin is kept: just before what most tests change, at 5, 6 and 10 s."""
FOLDER = tempfile.TemporaryDirectory()


@functools.cache
def finer_rows():
    """Rows of the finer model, without noise of the inputs: (stamp, readings)."""
    fine = {"mesh.elements_per_span": 8, "solver.step": "2 ms", "bodies[0].mass": "5.3 t"}
    return tuple(record(tautline.read(HOIST).replace(fine), read_map(MAP), Sensing(seed=1, rate=RATE), 12.0))


def rows_until(end):
    """Those of them up to a time, s."""
    return [row for row in finer_rows() if row[0] <= end]


def lines_with(change, end=12.0):
    """Lines after `QUIET` of a twin of the changed rows up to a time, s, every forecast looked at, and the twin."""
    twin, lines = gone_through(changed(rows_until(end), change))
    return [line for line in lines + twin.finish() if line["time"] > QUIET], twin


@functools.cache
def kept_after(rows):
    """Lines of a twin of so many of the first rows, and the folder with its state."""
    twin, lines = gone_through(finer_rows()[:rows], rows)
    state = Path(tempfile.mkdtemp(dir=FOLDER.name)) / "state"
    save(twin, state)
    return tuple(lines), state


def gone_through(rows, below=np.inf):
    """A twin that has gone through rows, and its lines, without those that wait.

    What the rows have in common with those of the finer model is gone through once, and is gone on with from a state
    after fewer rows than ``below``: it says what a twin says that was not stopped.
    """
    rows = list(rows)
    alike = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(rows, finer_rows(), strict=False)))
    begun = max(number for number in (0, *KEPT) if number <= alike and number < below)
    twin, lines = Twin(HOIST, MAP), []
    if begun:
        earlier, state = kept_after(begun)
        load(twin, state)
        lines += earlier
    for stamp, readings in rows[begun:]:
        lines += twin.add(stamp, readings)
        twin.work()
    return twin, lines


def lost_between(column, begin, end):
    return lambda t, r: {**r, column: np.nan} if begin - 1e-6 <= t < end - 1e-6 else r


def worst(lines):
    """Largest difference of computed and measured tension, N."""
    return max(abs(line["outputs"]["winch.tension"] - line["measured"]["winch.tension"]) for line in lines)


def states_of_a_hoist(missing, rate=20.0):
    """States (n, 3) that an input gets of an encoder at 2 m/s, some samples of which are missing, and the interval."""
    channel = Channel(
        column="winch", name="winch.pay_out", is_input=True, unit="m", scale=1.0, zero=0.0, zero_first=False,
        sd=np.nan, relative=False, low=-np.inf, high=np.inf, waves=False, lost_after=5.0,
    )  # fmt: skip
    times = np.arange(120) / rate
    values = np.where(missing(times), np.nan, -2.0 * times)
    track = InputTrack(channel, 0)
    track.begin(0.0, -1.0 / rate)
    rows = [Row(t, np.array([x])) for t, x in zip(times, values, strict=True)]
    states = [
        track.follow(rows[max(0, k - 6) : k + 4], values[max(0, k - 6) : k + 4], rows[k], 0.15) for k in range(119)
    ]
    return np.array([state.copy() for state in states]), 1.0 / rate


def test_an_input_that_comes_back_has_not_stood_still_for_a_row():
    states, dt = states_of_a_hoist(lambda t: (t >= 2.0) & (t < 2.5))
    step = np.diff(states[:, 0]) - 0.5 * dt * (states[:-1, 1] + states[1:, 1])
    # A row at 2 m/s is 0.1 m; the trapezium is off by a twelfth of the jerk times the cube of the interval.
    assert np.abs(step).max() < 1e-4


def test_neither_the_rate_nor_the_second_rate_of_an_input_jumps_where_samples_are_missing():
    states, _ = states_of_a_hoist(lambda t: (t >= 2.0) & (t < 2.5))
    # What comes to rest from 2 m/s with a second rate that jumps has 2.9 m/s2 at once.
    assert np.abs(np.diff(states[:, 2])).max() < 0.25
    assert np.abs(states[:, 2]).max() < 1.5


@pytest.mark.parametrize(
    "missing", [("winch_pos", 5.0, 5.5), pytest.param(("heave", 5.0, 5.2), marks=pytest.mark.study)]
)
def test_an_input_that_was_missing_for_a_moment_sets_off_no_bounce(missing):
    lines, twin = lines_with(lost_between(*missing), end=8.0)
    # With an encoder that stood still for a row it was 167 kN and less than nothing, for 58 kN.
    assert worst(lines) < 15e3
    assert min(line["outputs"]["min_tension"] for line in lines) >= 0.0
    assert twin.estimate.horizon.mean[0] == pytest.approx(5300.0, rel=0.01)


def test_what_cannot_push_is_never_extrapolated_to_a_negative_tension():
    twin = Twin(HOIST, MAP)
    read = {"min_tension": np.array([10.0, 8.0, 10.0, 10.0]), "payload.velocity": np.array([1.0, 0.5, 1.0, 1.0])}
    twin.estimate.family.apart = np.array([1.0, 1.0, 1.0])
    twin.estimate.horizon.mean = twin.estimate.horizon.theta0 + np.array([20.0, 0.0, 0.0])
    found = twin.estimate.outputs(read)
    assert found["min_tension"][0] == 0.0
    assert found["payload.velocity"][0] == pytest.approx(-9.0)


def test_two_blocking_is_still_foreseen_and_no_overload_is_while_the_motion_of_the_ship_is_lost():
    lines, _ = lines_with(lost_between("heave", 5.0, np.inf))
    raised = alarms(lines)
    assert not UNTRUE & raised.keys()
    # With all sensors the twin says so from 11.05 s on.
    assert raised["two-blocking ahead"] == pytest.approx(11.05, abs=0.3)


def test_a_run_ahead_begins_where_a_held_motion_stands():
    waves = Waves()
    for k in range(60):
        waves.add(0.1 * k, np.array([0.4, 0.2, 0.0]))
    held = np.array([0.9, 0.05, -0.05])
    waves.add(6.0, held, held=True)
    assert waves.ahead(np.array([1e-6, 20.0]))[0] == pytest.approx(held, abs=1e-5)
    assert abs(waves.ahead(np.array([20.0]))[0, 1]) < 1e-6, "what is held comes to rest"


def test_the_twin_says_that_it_cannot_look_ahead_where_the_simulation_ahead_stops_for_its_own_reasons(settled):
    twin, rows = settled(end=9.0)
    twin.outlook.found = Found(twin.now, stopped=(0.4, "NOT_CONVERGED"))
    lines = [line for stamp, readings in rows[:5] for line in twin.add(stamp, readings)]
    told = {one["text"] for line in lines for one in line["alarms"] if one["name"] == "cannot look ahead"}
    assert len(told) == 1
    assert "not converged" in told.pop()


def held_between(column, begin, end, noise=0.0):
    """A sensor that shows the value of one row for a while, and noise else."""
    kept, rng = [], np.random.default_rng(3)

    def change(t, r):
        shown = {**r, column: r[column] + noise * rng.standard_normal()}
        if not begin - 1e-6 <= t < end - 1e-6:
            return shown
        kept.append(shown[column])
        return {**r, column: kept[0]}

    return change


@pytest.mark.parametrize(
    "stuck",
    [
        ("heave", 5.0, 5.5),
        pytest.param(("heave", 5.0, 6.0, 1e-4), marks=pytest.mark.study),
        pytest.param(("winch_pos", 5.0, 5.3), marks=pytest.mark.study),
    ],
)
def test_a_place_that_sticks_and_lets_go_is_neither_followed_nor_judged_by(stuck):
    lines, _ = lines_with(held_between(*stuck), end=8.0)
    # The ship's motion that was followed into the stop, and after it, made 163 kN of 57 kN, with good health.
    assert worst(lines) < 15e3
    assert not UNTRUE & alarms(lines).keys()


def in_the_dark(stamp, readings):
    return None if 5.0 <= stamp < 5.5 else readings


@pytest.mark.parametrize("back", [0.0, *studies(1.0)])
def test_motion_that_is_caught_up_with_raises_no_alarm_of_its_own(back):
    rows = changed(rows_until(9.0), in_the_dark)
    twin, lines = gone_through((stamp - back * (stamp > 5.0), readings) for stamp, readings in rows)
    lines = [line for line in lines + twin.finish() if line["time"] > QUIET]
    assert not UNTRUE & alarms(lines).keys()
    since = {one["since"] for line in lines for one in line["alarms"] if one["name"] == "catching up"}
    assert len(since) == 1, "it is said once"
    assert {line["health"] for line in lines if 5.0 < line["time"] < 8.0} == {"degraded"}


def test_what_is_computed_is_judged_again_when_it_has_agreed_for_a_second_and_not_before():
    settling, sd, measured = Settling(), np.array([500.0]), np.array([50e3])
    settling.disturb(0.0)
    for k in range(1, 61):
        # A load that bounces by 20 kN until 3 s, and lies within the sensor's noise from then on.
        residual = np.array([20e3 if k < 30 else 400.0])
        settling.follow(0.1 * k, residual, sd, measured)
        assert settling.catching_up == (k < 40)
    assert settling.since == pytest.approx(4.0)


def catching_up_after(residuals, bounce=0.0, before=8e3):
    """How long it is caught up after an input has joined, s, with a sensor that is off by so much before."""
    settling, sd, measured = Settling(), np.array([500.0]), np.array([50e3])
    for k in range(100):
        settling.follow(0.1 * k - 10.0, np.array([before]), sd, measured, bounce)
    settling.disturb(0.0)
    k = 0
    while settling.catching_up and k < 1000:
        k += 1
        settling.follow(0.1 * k, np.array([residuals(0.1 * k)]), sd, measured, bounce)
    return 0.1 * k


def test_a_sensor_that_is_off_does_not_keep_what_is_computed_from_being_judged():
    # It stays eight kilonewtons off, as before, or is put right.
    assert catching_up_after(lambda t: 8e3) == pytest.approx(1.1)
    assert catching_up_after(lambda t: 0.0) == pytest.approx(1.1)


def test_all_is_judged_again_a_few_bounces_after_an_input_has_joined_in_any_case():
    assert catching_up_after(lambda t: 20e3) == pytest.approx(4.0)
    assert catching_up_after(lambda t: 20e3, bounce=1.0) == pytest.approx(5.0)


def test_a_first_reading_far_from_the_start_of_the_scene_is_told_and_health_is_degraded():
    far, near = Twin(HOIST, MAP), Twin(HOIST, MAP.replace("input: winch", "zero: first, input: winch"))
    rows = [(t, {**r, "winch_pos": r["winch_pos"] + 100.0}) for t, r in rows_until(2.0)]
    told = [[line for stamp, readings in rows for line in twin.add(stamp, readings)] for twin in (far, near)]
    note = [text for text in far.notes if "winch_pos begins at 100 m" in text]
    assert len(note) == 1
    assert "the scene begins at 0 m: write `zero: first`" in note[0]
    assert {line["health"] for line in told[0]} == {"degraded"}
    assert near.notes == []
    assert "good" in {line["health"] for line in told[1]}
