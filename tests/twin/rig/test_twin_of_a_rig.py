"""A rig's twin: friction from connections, weight and torque at the bit, stands, slips, a kill on the way."""

import functools
import json

import numpy as np
import pytest

import tautline
from drillstring.twin.records import Connecting, connections
from tautline.twin.signals.sensors import Health
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

SENSORS = """
sensors:
  - {column: block, unit: m, input: top.block, zero: first}
  - {column: rotary_speed, unit: rad/s, input: top.rotary_speed}
  - {column: hook_load, unit: N, output: top.hook_load, sd: 1 %}
  - {column: torque, unit: N m, output: surface_torque, sd: 1 %}
  - {column: bit_depth, unit: m, signal: bit_depth}
  - {column: hole_depth, unit: m, signal: hole_depth}
ahead: 0 s
"""
FRICTION = (
    SENSORS
    + """
estimate:
  - {parameter: wall.friction, start: 0.4, sd: 0.2, range: [0.02, 0.8]}
  - {parameter: casing.friction, start: 0.1, sd: 0.2, range: [0.02, 0.8]}
"""
)
DRILLED = (
    SENSORS
    + """
estimate:
  - {parameter: wall.friction, start: 0.2, sd: 0.02, range: [0.02, 0.8]}
"""
)
HOW = Connecting(in_slips=30.0, drilling=60.0, travel=12.0, turning=16.0)
OPEN, CASED = 0.25, 0.2
RIGHT = {"wall.friction": OPEN, "casing.friction": CASED}


RATE = 2.5
"""Rows a second of a record: a row costs a twin as much as many steps, and 1 Hz of rig data is usual."""


def well(open_hole, cased):
    """The shipped field well with a casing, and friction factors; for the record and for the twin alike.

    Steps are longer than those that are shipped: there is no bit that sticks, and string and twin take the same.
    """
    casing = {"shoe": 1200.0, "friction": cased}
    values = {("well", "wall", "friction"): open_hole, ("well", "wall", "casing"): casing}
    values |= {("solver", "step"): 5e-3, ("output", "interval"): 1.0 / RATE}
    scene = tautline.read("data/field_well.yaml")
    return scene.with_values({path: (value, "a test") for path, value in values.items()})


@functools.cache
def record_of_connections(count):
    """Rows of connections with 1 % noise of hook load and torque: (stamp, readings)."""
    columns = connections(well(OPEN, CASED), count=count, rate=RATE, how=HOW)
    names = [name for name in columns if name != "time"]
    return [(t, {name: columns[name][i] for name in names}) for i, t in enumerate(columns["time"])]


def lines_of(twin, rows):
    return [line for t, values in rows for line in twin.add(t, values)] + twin.finish()


def off(line):
    """How far friction factors are off, and that in standard deviations."""
    found = [(line["estimates"][name], right) for name, right in RIGHT.items()]
    return [abs(one["value"] - right) for one, right in found], [
        abs(one["value"] - right) / one["sd"] for one, right in found
    ]


KILLED = (175.0, 215.0)
"""While the stand is being fetched, and after it was taken up, s."""


@pytest.fixture(scope="module")
def two_and_states(tmp_path_factory):
    """Lines of a twin through two connections, and by time the state that it would have left if it had been killed."""
    folder, states, lines = tmp_path_factory.mktemp("two"), {}, []
    twin = Twin(well(0.4, 0.1), FRICTION)
    for k, (t, values) in enumerate(record_of_connections(2)):
        for when in KILLED:
            if t > when and when not in states:
                save(twin, folder / f"{when}.state")
                states[when] = folder / f"{when}.state", k, lines[-1]
        lines += twin.add(t, values)
    return lines + twin.finish(), states


@pytest.fixture
def two(two_and_states):
    return two_and_states[0]


def test_friction_of_cased_and_open_hole_is_found_within_a_hundredth_from_a_wrong_start(two):
    away, deviations = off(two[-1])
    assert max(away) < 0.01
    assert max(deviations) < 2.5


def test_friction_is_never_believed_better_than_it_is_known(two):
    after = [off(line)[1] for line in two if line["rig"]["state"] != "unknown"]
    assert np.mean(np.max(after, axis=1) < 2.0) > 0.9
    assert np.max(after) < 4.0


def test_the_string_waits_in_slips_and_is_a_stand_longer_after_them(two):
    in_slips = [line for line in two if line["rig"]["state"] in ("in slips", "connection")]
    # But for what passes until slips are told, and while they are taken out.
    assert 1.5 * HOW.in_slips * RATE < len(in_slips) <= 2.0 * HOW.in_slips * RATE
    assert all(line["outputs"] == {} and line["estimates"]["wall.friction"] for line in in_slips)
    added = [line["rig"]["added"] for line in two]
    assert added[-1] == pytest.approx(28.0, abs=0.2) and two[-1]["rig"]["connections"] == 1
    # The string's stretch is all that the bit is deeper than the tally of pipe says.
    tally = record_of_connections(2)[-1][1]["bit_depth"]
    assert 0.0 < two[-1]["estimates"]["bit.depth"]["value"] - tally < 2.5


def test_rotation_off_bottom_raises_no_alarm(two):
    assert {alarm["name"] for line in two for alarm in line["alarms"]} == set()


@pytest.mark.study
def test_ten_connections_tell_friction_within_a_hundredth_and_say_how_well():
    lines = lines_of(Twin(well(0.4, 0.1), FRICTION), record_of_connections(10))
    away, deviations = off(lines[-1])
    assert max(away) < 0.01 and max(deviations) < 2.5


@pytest.mark.parametrize("when", [KILLED[0], pytest.param(KILLED[1], marks=pytest.mark.study)])
def test_a_twin_that_was_killed_goes_on_with_the_string_as_it_has_grown(two_and_states, when):
    two, (state, middle, killed) = two_and_states[0], two_and_states[1][when]
    rows = record_of_connections(2)
    again = Twin(well(0.4, 0.1), FRICTION)
    load(again, state)
    assert again.readings.rows.reached == killed["time"]
    lines = lines_of(again, rows[middle:])
    assert lines[0]["rig"]["added"] == pytest.approx(killed["rig"]["added"])
    assert lines[-1]["rig"]["added"] == pytest.approx(two[-1]["rig"]["added"])
    assert lines[-1]["rig"]["connections"] == two[-1]["rig"]["connections"]
    for name in RIGHT:
        one, other = lines[-1]["estimates"][name], two[-1]["estimates"][name]
        assert one["value"] == pytest.approx(other["value"], abs=1.5 * other["sd"])
    # To the bit: what the rig does, and the window that was half gone through, are in the state.
    texts = [[json.dumps(line | {"lag": 0.0}) for line in some] for some in (lines, two[-len(lines) :])]
    assert texts[0] == texts[1]


# -- on bottom ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def drilled():
    """Lines of a string that is drilled with and sticks, and what its bit had at their times: N, N m, m."""
    sim = tautline.Simulation(tautline.read("data/drilling.yaml"), keep=False)
    random = np.random.default_rng(1)
    rows, right = [], {}
    for k in range(226):
        if k:
            sim.advance_to(0.2 * k)
        noisy = 1.0 + 0.01 * random.standard_normal(2)
        rows.append((0.2 * k, {
            "block": sim["top.block"], "rotary_speed": sim["top.rotary_speed"],
            "hook_load": noisy[0] * sim["top.hook_load"], "torque": noisy[1] * sim["surface_torque"],
            "bit_depth": sim["bit.depth"], "hole_depth": sim["hole_depth"],
        }))  # fmt: skip
        right[round(0.2 * k, 6)] = sim["bit.weight"], sim["bit.torque"], sim["bit.depth"]
    changes = {("bit", "on_bottom"): False, ("top", "rotation"): 0.0, ("top", "block"): 0.0}
    scene = tautline.read("data/drilling.yaml").with_values({p: (v, "a test") for p, v in changes.items()})
    lines = lines_of(Twin(scene, DRILLED), rows)
    return lines, np.array(list(right.values())), np.array(list(right))


@pytest.mark.parametrize(("name", "column", "within"), [("bit.weight", 0, 2e3), ("bit.torque", 1, 400.0)])
def test_weight_and_torque_at_the_bit_are_those_of_the_run_on_bottom(drilled, name, column, within):
    lines, right, times = drilled
    off_by, deviations = [], []
    for line in lines[50:]:
        # Both are means over the last period of torsion.
        near = (times > line["time"] - 4.9) & (times <= line["time"])
        one = line["estimates"][name]
        off_by.append(one["value"] - right[near, column].mean())
        deviations.append(one["sd"])
    off_by = np.array(off_by)
    assert np.sqrt(np.mean(off_by**2)) < within
    assert np.sqrt(np.mean((off_by / np.array(deviations)) ** 2)) < 1.5


def test_the_bit_is_where_the_run_has_it(drilled):
    lines, right, times = drilled
    for line in lines[50::5]:
        k = int(np.argmin(np.abs(times - line["time"])))
        one = line["estimates"]["bit.depth"]
        assert one["value"] == pytest.approx(right[k, 2], abs=0.03)


def test_stick_slip_raises_an_alarm_and_is_told_with_what_would_end_it(drilled):
    line = drilled[0][-1]
    assert [alarm["name"] for alarm in line["alarms"]] == ["stick-slip"]
    assert line["rig"]["state"] == "drilling"
    assert line["estimates"]["bit.stick_slip"]["value"] == pytest.approx(1.0, abs=0.15)
    ends = line["rig"]["stick_slip_ends"]
    assert ends["speed"] > 4.0 * np.pi and 0.0 < ends["weight"] < 100e3


def test_friction_is_not_estimated_from_what_the_bit_carries(drilled):
    one = drilled[0][-1]["estimates"]["wall.friction"]
    assert one["value"] == 0.2 and one["sd"] == pytest.approx(0.02)


def test_a_scene_with_its_bit_on_bottom_is_refused_with_the_cure():
    with pytest.raises(tautline.TautlineError, match="on_bottom: false"):
        Twin(tautline.read("data/drilling.yaml"), DRILLED)


# -- a hook load with the block in it ----------------------------------------------------------------------------------


BLOCK = 250e3


def test_a_map_without_a_zero_for_a_stated_block_is_doubted_at_the_start_with_the_cure():
    scene = well(OPEN, CASED).with_values({("top", "weight"): (BLOCK, "a test")})
    notes = Twin(scene, FRICTION).notes
    assert len(notes) == 1
    assert "hook_load" in notes[0] and "250 kN" in notes[0] and "`zero:`" in notes[0]
    zero = FRICTION.replace("output: top.hook_load,", f"output: top.hook_load, zero: {BLOCK},")
    assert Twin(scene, zero).notes == [] == Twin(well(OPEN, CASED), FRICTION).notes


def far_off(size, rows=600):
    """Times at which readings contradict what is expected: each is so many standard deviations off, and noise."""
    channel = read_channel(DRILLED, "hook_load")
    health, random, told = Health(channel), np.random.default_rng(3), []
    for k in range(rows):
        health.contradict(0.1 * k, 5e3 * (size + random.standard_normal()), 5e3)
        told += [0.1 * k] if health.contradicts else []
    return told


def read_channel(text, column):
    return next(one for one in Twin(well(OPEN, CASED), text).plan.channels if one.column == column)


def test_a_sensor_that_stays_dozens_of_deviations_off_is_told_within_half_a_minute_and_a_drift_is_not():
    assert far_off(0.0) == far_off(-15.0) == []
    for size in (-40.0, 50.0):
        assert 10.0 < far_off(size)[0] < 30.0
