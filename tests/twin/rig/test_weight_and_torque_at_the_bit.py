"""Weight and torque at the bit of a deviated well, where the weight changes the friction of the string."""

import functools
from math import cos, hypot, pi, sin

import numpy as np
import pytest
from twin.rig.well_of_a_rig import DEVIATED, well
from twin.rig.well_of_a_rig import VERTICAL as STRAIGHT_DOWN

import tautline
from drillstring.twin.at_bit import AtBit, AtSurface, Known
from tautline.twin.twin import Twin

SCENE = well(DEVIATED, "58 s", "0.2 s")
VERTICAL = well(STRAIGHT_DOWN, "58 s", "0.2 s")
PIPE, COLLAR = (0.127, 0.1086), (0.165, 0.0714)
KICK, END, LENGTH, COLLARS = 600.0, 1200.0, 2400.0, 80.0
INCLINED = np.radians(60.0)
RATE = INCLINED / (END - KICK)
FRICTION = 0.25


@functools.cache
def own_soft_string(weight, sliding, friction=FRICTION, step=0.5):
    """Hook load N and friction torque N m at the top, by Heun's steps of Johancsik's equation from the bit up.

    In a plane the force on the wall is T k - w sin(inclination), positive towards the upper side of a build.
    """

    def of(s, tension):
        inclination = INCLINED * min(max((s - KICK) / (END - KICK), 0.0), 1.0)
        bend = RATE if KICK < s < END else 0.0
        od, bore = COLLAR if s > LENGTH - COLLARS else PIPE
        w = 0.25 * pi * (od**2 - bore**2) * (7850.0 - 1200.0) * 9.81
        wall = abs(tension * bend - w * sin(inclination))
        if sliding:
            return w * cos(inclination) - friction * wall, 0.0
        wall /= hypot(1.0, friction)
        return w * cos(inclination), friction * wall * 0.5 * od

    tension, torque = -weight, 0.0
    ends = np.arange(LENGTH, 0.0, -step).tolist()
    for low in ends:
        first = of(low - 1e-6, tension)
        second = of(low - step + 1e-6, tension + step * first[0])
        tension += 0.5 * step * (first[0] + second[0])
        torque += 0.5 * step * (first[1] + second[1])
    return tension, torque


NOISE = Known(1.0, 0.0)


def told(weight, bit_torque, sliding, friction=(FRICTION, 1e-4), text=SCENE):
    """What is told of a string that shows what the test's own soft string would show."""
    free, loaded = own_soft_string(0.0, sliding), own_soft_string(weight, sliding)
    if text is VERTICAL:
        free, loaded = (400e3, 0.0), (400e3 - weight, 0.0)
    found = AtBit(tautline.read(text), 3.0)
    for k in range(20):
        turned = 0.0 if sliding else 12.0
        found.add(AtSurface(
            0.1 * k, 0.0, turned, *free, free[0] - loaded[0], loaded[1] - free[1] + bit_torque
        ))  # fmt: skip
    return found.told(NOISE, NOISE, {"wall.friction": friction}), found


@pytest.mark.parametrize("weight", [20e3, 60e3, 100e3])
def test_torque_at_the_bit_is_told_with_the_friction_that_its_weight_takes_away(weight):
    lost = own_soft_string(0.0, False)[1] - own_soft_string(weight, False)[1]
    assert lost > 0.01 * weight  # more than half of the bit's torque would be missing
    found = told(weight, 0.04 * weight, sliding=False)[0]
    assert found["bit.weight"][0] == pytest.approx(weight, rel=2e-3)
    assert found["bit.torque"][0] == pytest.approx(0.04 * weight, abs=0.02 * lost)


@pytest.mark.parametrize("weight", [20e3, 60e3, 100e3])
def test_weight_of_a_string_that_slides_down_is_told_with_the_friction_that_it_adds(weight):
    lacking = own_soft_string(0.0, True)[0] - own_soft_string(weight, True)[0]
    assert abs(lacking - weight) > 0.05 * weight
    found = told(weight, 0.0, sliding=True)[0]
    assert found["bit.weight"][0] == pytest.approx(weight, rel=5e-3)


def test_torque_at_the_bit_is_left_out_and_why_is_said_while_the_string_does_not_turn():
    found, at = told(60e3, 0.0, sliding=True)
    assert set(found) == {"bit.weight"}
    assert [line.split(":")[0] for line in at.lost] == ["bit.torque"]


@pytest.mark.parametrize("sliding", [False, True])
def test_in_a_vertical_hole_the_hook_lacks_the_weight_and_the_drive_has_the_torque(sliding):
    found, at = told(40e3, 2e3, sliding, text=VERTICAL)
    assert found["bit.weight"] == pytest.approx((40e3, 1.0 / np.sqrt(20.0)), rel=1e-6)
    if not sliding:
        assert found["bit.torque"] == pytest.approx((2e3, 1.0 / np.sqrt(20.0)), rel=1e-6)
    area = [0.25 * np.pi * (od**2 - bore**2) for od, bore in (PIPE, COLLAR)]
    spring = (LENGTH - COLLARS) / (206e9 * area[0]) + COLLARS / (206e9 * area[1])
    assert at.shorter[0] == pytest.approx(40e3 * spring, rel=1e-6)


@pytest.mark.parametrize(("sliding", "name", "right"), [(True, "bit.weight", 60e3), (False, "bit.torque", 2e3)])
def test_what_a_wrong_friction_makes_wrong_on_bottom_is_in_the_deviation(sliding, name, right):
    friction = 0.3
    at = {mu: (own_soft_string(0.0, sliding, mu), own_soft_string(60e3, sliding, mu)) for mu in (FRICTION, friction)}
    (off, _), (_, on) = at[friction], at[FRICTION]
    found = AtBit(tautline.read(SCENE), 3.0)
    for k in range(20):
        found.add(AtSurface(0.1 * k, 0.0, 0.0 if sliding else 12.0, *off, off[0] - on[0], on[1] - off[1] + 2e3))
    believed = found.told(NOISE, NOISE, {"wall.friction": (friction, friction - FRICTION)})[name]
    assert 0.5 * believed[1] < abs(believed[0] - right) < 1.5 * believed[1]


def test_a_string_that_turns_may_go_down_at_other_speeds_than_the_block_and_its_weight_says_so():
    speed, turned = 0.02, 12.0
    load, torque = own_soft_string(0.0, False)
    # The torque of a sliding pipe over its radius is the force; the part of it along the hole is as the speeds are.
    along = torque * speed / turned / (0.5 * PIPE[0]) ** 2
    found = AtBit(tautline.read(SCENE), 3.0)
    for k in range(20):
        found.add(AtSurface(0.1 * k, 0.1 * k * speed, turned, load - along, torque, 60e3, 0.0))
    sd = found.told(NOISE, NOISE, {"wall.friction": (FRICTION, 1e-6)})["bit.weight"][1]
    assert along > 1e3
    assert sd == pytest.approx(0.15 * along, rel=0.3)


# -- beside a run ------------------------------------------------------------------------------------------------------


MAP = """
sensors:
  - {column: block, unit: m, input: top.block, zero: first}
  - {column: rotary_speed, unit: rad/s, input: top.rotary_speed}
  - {column: hook_load, unit: N, output: top.hook_load, sd: 0.2 %}
  - {column: torque, unit: N m, output: surface_torque, sd: 0.5 %}
  - {column: flow, unit: m^3/s, signal: flow}
  - {column: bit_depth, unit: m, signal: bit_depth}
  - {column: hole_depth, unit: m, signal: hole_depth}
estimate:
  - {parameter: wall.friction, start: 0.25, sd: 0.001, range: [0.02, 0.8]}
ahead: 0 s
"""
SPEEDS = {
    # The string goes up and comes down, is fed, and then only as fast as the bit drills.
    "drilling": ([(3, -0.2), (13, 0.2), (15, 0.15), (24, -0.08), (40, -0.061)], "12 mm/s"),
    "sliding": ([(3, -0.2), (13, 0.2), (15, 0.15), (24, -0.08), (40, -0.067)], "0.01 mm/s"),
}


@functools.cache
def on_bottom(state, lost=np.inf):
    """Lines of a twin beside a run on bottom, whose hook load is lost at a time, and times, weights and torques."""
    steps, penetration = SPEEDS[state]
    block = {"velocity": {"sum": [{"ramp": {"to": to, "over": 2.0, "at": at}} for at, to in steps]}}
    turned = {"ramp": {"to": 12.0, "over": 4.0, "at": 16.0}} if state == "drilling" else 0.0
    bit = {
        "on_bottom": True, "weight": "1 kN", "torque": {"static": 4000.0, "kinetic": 4000.0, "weight": 100e3},
        "penetration": {"rate": penetration, "speed": 12.0, "weight": 100e3},
    }  # fmt: skip
    off = tautline.read(SCENE)
    scene = off.with_values({p: (v, "a test") for p, v in {
        ("top", "block"): block, ("top", "rotation"): turned, ("bit",): bit,
    }.items()})  # fmt: skip
    run = tautline.simulate(scene)
    random = np.random.default_rng(2)
    rows = []
    for k, t in enumerate(run["time"]):
        down = LENGTH + float(run["block_position"][k])
        rows.append((float(t), {
            "block": run["block_position"][k], "rotary_speed": run["rotation_rate"][k, 0],
            "hook_load": run["hook_load"][k] * (1.0 + 0.002 * random.standard_normal()) if t < lost else np.nan,
            "torque": run["surface_torque"][k] * (1.0 + 0.005 * random.standard_normal()),
            "flow": 0.03, "bit_depth": down, "hole_depth": down if run["weight_on_bit"][k] > 1e3 else LENGTH + 2.0,
        }))  # fmt: skip
    twin = Twin(off, MAP)
    lines = [line for t, values in rows for line in twin.add(t, values)] + twin.finish()
    return lines, np.array(run["time"]), np.array(run["weight_on_bit"]), np.array(run["torque_on_bit"])


def errors(state, name):
    """How far a number is off while its state lasts, over the right one, and in standard deviations."""
    lines, times, weight, torque = on_bottom(state)
    right = {"bit.weight": weight, "bit.torque": torque}[name]
    found = []
    for line in lines:
        if line["time"] > 47.0:
            assert line["rig"]["state"] == state
            mean = right[(times > line["time"] - 3.01) & (times <= line["time"])].mean()
            one = line["estimates"][name]
            found.append(((one["value"] - mean) / mean, (one["value"] - mean) / one["sd"]))
    return np.array(found).T


@pytest.mark.parametrize(
    ("state", "name", "within"),
    [("drilling", "bit.torque", 0.07), ("drilling", "bit.weight", 0.05), ("sliding", "bit.weight", 0.03)],
)
def test_a_twin_tells_what_the_bit_of_a_deviated_run_has_and_how_well(state, name, within):
    share, deviations = errors(state, name)
    assert np.abs(share).max() < within
    assert np.abs(deviations).max() < 3.0 and np.sqrt(np.mean(deviations**2)) < 2.0


def test_a_twin_that_slides_tells_no_torque_at_the_bit_and_says_why():
    line = on_bottom("sliding")[0][-1]
    assert "bit.torque" not in line["estimates"]
    assert any(one.startswith("bit.torque") for one in line["rig"]["cannot_be_told"])


def test_the_depth_of_a_bit_whose_weight_is_not_known_is_left_out_and_why_is_said():
    lines = on_bottom("sliding", lost=46.0)[0]
    known = [line for line in lines if 44.0 < line["time"] < 46.0]
    assert all("bit.depth" in line["estimates"] for line in known)
    assert "bit.weight" not in lines[-1]["estimates"] and "bit.depth" not in lines[-1]["estimates"]
    assert any(one.startswith("bit.depth: the weight") for one in lines[-1]["rig"]["cannot_be_told"])
