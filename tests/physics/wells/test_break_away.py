"""A stuck bit: it stays until the top's stroke exceeds what the friction of the string can hold.

The string is pulled or lowered slowly, and slip comes down it from the top. With friction q per length the stroke at
which it reaches the bit of a uniform string in a straight hole is q L^2/(2 EA) where no friction acted before, and
q L^2/EA after the string slid the other way; of several sections it is the integral of q over the compliance of the
string above. In the J-well the references are an integral of tests/references/soft_string.py, with the clearance (the
string changes the side of the hole, which is 4 % of the stroke), and the statics of `drillstring torque-drag`.

Measured, stroke over closed form - 1 in the slant hole at n = 3, 10, 40: 1.4e-3, 9e-4, 5e-4, mostly of the frames and
of the speed of the block; no order is left, for the trapezoidal lumps give the integral exactly. In the J-well the
statics' stroke errs at n = 12, 25, 50, 100, 200 against the soft string by +2.4e-2, -5.8e-3, -5.3e-3, +1.0e-3, -1e-4 up
and -4.6e-2, +1.6e-2, +2.4e-3, +1.3e-3, +9e-4 down with friction 0.2: one lump stands for both sides where the string
changes from one to the other. The run's stroke is the statics' of the same lumps within 2e-3 at any n.

With a static factor above the kinetic one what slips has the kinetic, so static friction holds at one place at a time:
the bit goes soon after the stroke of the kinetic factor, and the hook load never comes near that of the static one.
"""

import numpy as np
import pytest
from of_the_suite import studies
from physics.wells.strings import (
    COLLAR,
    DENSITY,
    GRAVITY,
    JWELL,
    E,
    area,
    mass_per_length,
    run,
    shipped,
    soft_strokes,
    straight_hole,
)

from drillstring.results.break_away import break_away_figures
from drillstring.statics.statics import Statics
from drillstring.statics.torque_drag import torque_drag

INCLINATION, LENGTH, FRICTION = 1.0, 3000.0, 0.3
SPEED = 0.005
Q = FRICTION * mass_per_length() * GRAVITY * np.sin(INCLINATION)
STROKE = Q * LENGTH**2 / (2.0 * E * area(*COLLAR))
WAYS = {"pick_up": -1.0, "slack_off": 1.0}
STILL, MOVED = 1e-6, 1e-5
SOFT = {"model__bending": "soft"}


def slant(block, elements=10, length=LENGTH, friction=FRICTION, end=110.0, **changes):
    """A run of a string in a slant hole that is hardly wider than its pipe."""
    scene = straight_hole(
        INCLINATION, length=length, elements=elements, diameter=0.1652, friction=friction, top={"block": block},
        solver__step=5e-3, solver__rho_inf=0.3, solver__end=float(end), output__interval=0.02, **changes,
    )  # fmt: skip
    return run(scene)


def last_rest(result, begin=0):
    """Frame before the one in which the bit has left the place it has in frame `begin`."""
    bit = result["bit_depth"][begin:]
    return begin + int(np.flatnonzero(np.abs(bit - bit[0]) > MOVED)[0]) - 1


def stroke_of(result, begin=0):
    """Way of the block from frame `begin` until the bit lets go, m."""
    block = result["block_position"]
    return abs(float(block[last_rest(result, begin)] - block[begin]))


# straight holes
@pytest.mark.parametrize("elements", [3, 10, *studies(40)])
@pytest.mark.parametrize("way", WAYS)
def test_bit_in_a_slant_hole_moves_after_the_stroke_of_the_closed_form_within_0_2_percent(way, elements):
    result = slant({"ramp": {"rate": WAYS[way] * SPEED, "over": 5.0}}, elements)
    last = last_rest(result)
    assert stroke_of(result) == pytest.approx(STROKE, rel=2e-3)
    bit = result["bit_depth"]
    assert np.abs(bit[: last - 5] - bit[0]).max() < 1e-7, "it does not creep"
    weight = mass_per_length() * GRAVITY * LENGTH
    touching = 1.0 - 0.5 / elements  # the half lump in the drive has no wall
    exact = weight * (np.cos(INCLINATION) - WAYS[way] * FRICTION * touching * np.sin(INCLINATION))
    assert result["hook_load"][last] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("way", ["pick_up", *studies("slack_off")])
def test_stroke_is_twice_as_long_after_the_string_slid_the_other_way_within_0_3_percent(way):
    away = {"ramp": {"rate": -WAYS[way] * SPEED, "over": 5.0}}
    back = {"ramp": {"rate": 2.0 * WAYS[way] * SPEED, "over": 5.0, "at": 110.0}}
    result = slant({"sum": [away, back]}, end=310.0)
    turn = int(np.argmax(-WAYS[way] * result["block_position"]))
    assert abs(result["bit_depth"][turn] - result["bit_depth"][0]) > 0.05, "all of it slid"
    # the bit comes to rest a moment after the block has turned
    rest = turn + int(np.argmax(-WAYS[way] * result["bit_depth"][turn : turn + 1000]))
    block = result["block_position"]
    later = abs(float(block[last_rest(result, rest)] - block[turn]))
    assert later == pytest.approx(2.0 * STROKE, rel=3e-3)


def test_stroke_of_a_stepped_string_is_the_integral_of_friction_over_the_compliance_above_it_within_0_2_percent():
    pipe, collar = (0.127, 0.1086), COLLAR
    lengths = (2400.0, 600.0)
    sections = [
        {"name": name, "length": length, "od": od, "id": bore}
        for name, length, (od, bore) in zip(("pipe", "collar"), lengths, (pipe, collar), strict=True)
    ]
    upper, lower = (FRICTION * mass_per_length(*one) * GRAVITY * np.sin(INCLINATION) for one in (pipe, collar))
    soft, hard = (1.0 / (E * area(*one)) for one in (pipe, collar))
    a, b = lengths
    # int q(s) c(s) ds with the compliance c of what is above s
    exact = upper * a**2 * soft / 2.0 + lower * b * (a * soft + b * hard / 2.0)
    # of the wall only its stiffness is scaled with the diameter: both sections touch with the hole hardly wider
    result = slant({"ramp": {"rate": -0.01, "over": 5.0}}, 12, end=1.2 * exact / 0.01 + 5.0, string=sections)
    assert stroke_of(result) == pytest.approx(exact, rel=2e-3)


# static friction above the kinetic
def test_with_more_static_than_kinetic_friction_the_bit_goes_soon_after_the_stroke_of_the_kinetic():
    # a lump waits for the static limit, then has the kinetic: with damping the slip does not run ahead
    friction = {"static": 0.3, "kinetic": 0.2}
    result = slant({"ramp": {"rate": -SPEED, "over": 5.0}}, 25, friction=friction, damping={"structural": 0.02})
    kinetic = STROKE * 0.2 / 0.3
    assert kinetic < stroke_of(result) < 1.03 * kinetic
    weight = mass_per_length() * GRAVITY * LENGTH
    free, most = weight * np.cos(INCLINATION), weight * np.sin(INCLINATION)
    drag = (result["hook_load"] - free) / most
    assert drag[last_rest(result)] < 0.21 and drag.max() < 0.21, "never the static hook load"
    assert drag[-1] == pytest.approx(0.2, abs=5e-3)


# the J-well
def moved(elements, friction, way, **changes):
    """Statics of the J-well and a run that begins with the bit at the end of the hole and moves the block slowly."""
    statics = Statics(shipped("jwell", **SOFT), JWELL.length, elements)
    free, loaded = statics.solve(0.0, way), statics.solve(friction, way)
    stroke = abs(loaded.block - free.block)
    block = {"ramp": {"from": free.block, "rate": 0.01 * WAYS[way], "over": 5.0}}
    calm = {"damping__structural": 0.02, "solver__rho_inf": 0.3, "solver__step": 5e-3, "output__interval": 0.02}
    changes = {"well__wall__friction": friction, "top__block": block, "model__elements": elements} | SOFT | changes
    result = run(shipped("jwell", **calm, solver__end=float(130.0 * stroke + 2.5), **changes))
    return stroke, loaded, result


@pytest.mark.parametrize(("way", "friction"), [("pick_up", 0.2), *studies(("pick_up", 0.3)), ("slack_off", 0.2)])
def test_bit_in_the_jwell_moves_with_the_stroke_and_hook_load_of_the_statics_within_0_3_percent(way, friction):
    stroke, loaded, result = moved(50, friction, way)
    last = last_rest(result)
    assert stroke_of(result) == pytest.approx(stroke, rel=3e-3)
    assert result["hook_load"][last] == pytest.approx(loaded.hook_load, rel=1e-3)
    told = result.headline
    assert told["break_away_stroke"]["value"] == pytest.approx(WAYS[way] * stroke, rel=3e-3)
    assert told["break_away_hook_load"]["value"] == result["hook_load"][last]
    assert told["break_away_time"]["value"] == result.time[last]


@pytest.mark.parametrize("friction", [0.2, *studies(0.3)])
def test_strokes_of_the_statics_in_the_jwell_are_the_soft_strings_within_half_a_percent(friction):
    (case,) = torque_drag(shipped("jwell", **SOFT), [friction])
    up, down = soft_strokes(friction, hole=0.2032)
    found = case.points[0].strokes
    assert found.pick_up == pytest.approx(up, rel=5e-3)
    assert found.slack_off == pytest.approx(down, rel=5e-3)
    assert found.reversing == pytest.approx(up + down, rel=5e-3)
    # a string that stays on the axis would need less
    assert soft_strokes(friction)[0] < 0.97 * up


def test_stroke_of_the_statics_comes_near_the_soft_strings_as_lumps_grow_in_number():
    up, _ = soft_strokes(0.2, hole=0.2032)
    errors = []
    for elements in (12, 25, 100):
        statics = Statics(shipped("jwell", **SOFT), JWELL.length, elements)
        errors.append(abs((statics.solve(0.0, "pick_up").block - statics.solve(0.2, "pick_up").block) / up - 1.0))
    assert errors[0] < 4e-2 and errors[1] < 1e-2 and errors[2] < 2e-3


class Frames(dict):
    """Variables of a result that was never run: a bit that stays for four frames of ten."""

    time = np.arange(10.0)

    def __init__(self, **changes):
        still, way = np.zeros((10, 2)), np.linspace(0.0, 1.0, 10)
        bit, load = np.where(way > 0.4, way, 0.0), 1e5 + 1e3 * way
        super().__init__(block_position=way, bit_depth=bit, axial_velocity=still, rotation_rate=still, hook_load=load)
        held = np.outer(way, [500.0, 500.0])
        self |= {"friction_force": held, "rotation": still} | changes


@pytest.mark.parametrize(
    "changes",
    [
        {"weight_on_bit": np.full(10, 1e4)},
        {"friction_force": np.zeros((10, 2))},
        {"friction_force": np.full((10, 2), 1e4)},
        {"friction_force": np.outer(np.linspace(0.0, 1.0, 10), [400.0, 450.0])},
        {"axial_velocity": np.full((10, 2), 0.1)},
        {"rotation": np.linspace(0.0, 5.0, 20).reshape(10, 2)},
        {"rotation": np.outer(np.linspace(0.0, 5.0, 10), [1.0, 0.0])},
        {"bit_depth": np.zeros(10)},
        {"block_position": np.zeros(10)},
    ],
    ids=[
        "on bottom",
        "no friction",
        "friction that stays",
        "much beside friction",
        "in motion",
        "turning",
        "turning above",
        "stays",
        "block at rest",
    ],
)
def test_break_away_is_told_only_of_a_bit_that_friction_held(changes):
    told = break_away_figures(Frames())
    assert told["break_away_stroke"][0] == pytest.approx(3.0 / 9.0) and told["break_away_time"][0] == 3.0
    assert told["break_away_stroke"][2].endswith("stroke of the block, down")
    up = break_away_figures(Frames(block_position=np.linspace(0.0, -1.0, 10)))["break_away_stroke"]
    assert up[0] == pytest.approx(-3.0 / 9.0) and up[2].endswith("stroke of the block, up")
    assert break_away_figures(Frames(**changes)) == {}


@pytest.mark.parametrize("friction", [0.0, 1e-6, 0.01])
def test_no_break_away_is_told_of_a_bit_that_only_waits_for_the_wave_from_the_block(friction):
    """Next to without friction the bit follows after the time L / c that the wave takes."""
    result = slant({"ramp": {"rate": -0.5, "over": 0.1}}, friction=friction, end=2.0)
    wave = LENGTH / np.sqrt(E / DENSITY)
    assert 0.5 * wave < result.time[last_rest(result)] < 1.5 * wave
    assert "break_away_stroke" not in result.headline


@pytest.mark.parametrize("rotation", [{"ramp": {"to": 6.0, "over": 4.0}}, 0.0])
def test_break_away_is_told_of_the_string_of_the_field_well_only_if_it_does_not_turn(rotation):
    result = run(shipped("field_well", top__rotation=rotation))
    assert ("break_away_stroke" in result.headline) == (rotation == 0.0)


@pytest.mark.parametrize(("share", "moves"), [(0.97, False), (1.03, True)])
def test_heave_moves_the_bit_if_and_only_if_its_amplitude_exceeds_the_stroke(share, moves):
    # up first, then down: the way down is twice the amplitude, which is less than the stroke after the way up
    statics = Statics(shipped("jwell", **SOFT), JWELL.length, 50)
    free, up, down = statics.solve(0.0, "pick_up"), statics.solve(0.2, "pick_up"), statics.solve(0.2, "slack_off")
    stroke = free.block - up.block
    assert 2.0 * share * stroke < down.block - up.block
    heave = {"harmonic": {"amplitude": -share * stroke, "period": 120.0, "mean": free.block, "ramp": 15.0}}
    changes = {"well__wall__friction": 0.2, "top__block": heave, "model__elements": 50} | SOFT
    calm = {"damping__structural": 0.02, "solver__rho_inf": 0.3, "solver__step": 1e-2, "output__interval": 0.1}
    result = run(shipped("jwell", **calm, solver__end=100.0, **changes))
    travel = np.ptp(result["bit_depth"])
    if moves:
        assert travel > 1000.0 * STILL
    else:
        assert travel < STILL
        assert "break_away_stroke" not in result.headline
