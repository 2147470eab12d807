"""A string that turns while it goes up or down, and a hole whose friction changes at a casing shoe: closed forms.

In a straight hole of inclination i the wall bears q = w sin i per length. Friction mu N is against the slip
(v, R Omega): with a = v/sqrt(v^2 + R^2 Omega^2) and b = R Omega/sqrt(...) the pipe climbs the wall until
N = q/sqrt(1 + (b mu)^2), and

    hook load = w L cos i -+ a mu N L,    torque = b mu N R L.

A casing down to S has the friction of its length: mu_cased q S + mu_open q (L - S).
"""

import numpy as np
import pytest
from physics.wells.strings import COLLAR, GRAVITY, mass_per_length, run, shipped, straight_hole

from drillstring.scene.scene import DrillstringScene
from drillstring.statics.back_calculation import Measured, fit
from drillstring.statics.motion import MOTIONS, Motion, reaming
from drillstring.statics.soft_string import soft_string
from drillstring.statics.statics import Statics
from drillstring.statics.torque_drag import torque_drag
from drillstring.string.factors import Factors
from drillstring.warnings import warnings
from tautline.scene.errors import SceneError

W = mass_per_length() * GRAVITY
INCLINATION, LENGTH, LINKS, FRICTION = 1.0, 1000.0, 10, 0.3
RADIUS = COLLAR[0] / 2.0
ACROSS, ALONG = W * LENGTH * np.sin(INCLINATION), W * LENGTH * np.cos(INCLINATION)
TOUCHING = 1.0 - 0.5 / LINKS
"""Share of the lumped string that has a wall: not the half link in the drive."""


def slant(friction=FRICTION, diameter=0.1652, **changes):
    return straight_hole(INCLINATION, length=LENGTH, elements=LINKS, diameter=diameter, friction=friction, **changes)


def loads(motion, friction, touching=1.0):
    """Hook load and torque of the closed form."""
    slip = np.hypot(motion.speed, RADIUS * motion.rotary)
    a, b = motion.speed / slip, RADIUS * motion.rotary / slip
    normal = touching * ACROSS / np.hypot(1.0, b * friction)
    return ALONG - a * friction * normal, b * friction * normal * RADIUS


# reaming
@pytest.mark.parametrize("rotary", [0.5, 6.0, -6.0])
@pytest.mark.parametrize("speed", [-0.3, 0.05])
def test_hook_load_and_torque_of_reaming_in_a_slant_hole_are_the_closed_form(speed, rotary):
    motion = Motion(speed, rotary)
    statics = Statics(slant(), LENGTH, LINKS)
    found = statics.solve(FRICTION, motion)
    load, torque = loads(motion, FRICTION, TOUCHING)
    assert found.hook_load == pytest.approx(load, rel=1e-5)
    assert found.surface_torque == pytest.approx(torque, rel=1e-4)
    soft = soft_string(statics.well, statics.tubes, statics.weight, FRICTION, motion)
    load, torque = loads(motion, FRICTION)
    assert (soft.hook_load, soft.surface_torque) == pytest.approx((load, torque), rel=1e-9)


def test_reaming_goes_over_into_picking_up_and_into_rotating():
    statics = Statics(shipped("jwell"), 3770.0, 50)
    for motion, name in ((Motion(-1.0, 1e-6), "pick_up"), (Motion(1e-6, 10.0), "rotating")):
        near, exact = statics.solve(0.2, motion), statics.solve(0.2, name)
        assert near.hook_load == pytest.approx(exact.hook_load, rel=1e-5)
        assert near.surface_torque == pytest.approx(exact.surface_torque, rel=1e-5, abs=1.0)


def test_faster_rotation_takes_drag_off_the_hook_and_only_the_ratio_of_the_speeds_counts():
    statics = Statics(shipped("jwell"), 3770.0, 50)
    drag = [statics.solve(0.2, Motion(-0.3, rotary)).hook_load for rotary in (0.0, 2.0, 6.0, 20.0)]
    assert (np.diff(drag) < -1e3).all() and drag[-1] > statics.solve(0.2, "rotating").hook_load
    slow = statics.solve(0.2, Motion(-0.03, 0.6)).hook_load
    assert slow == pytest.approx(drag[2], rel=1e-9)


def test_run_that_is_pulled_while_it_turns_has_the_hook_load_and_torque_of_the_closed_form_within_a_thousandth():
    # 0.2 m/s and 60 rpm: the pipe's surface goes round at 0.52 m/s; in a wider hole, where the lumps can swing and rest
    motion = Motion(-0.2, 2.0 * np.pi)
    top = {
        "block": {"velocity": {"ramp": {"to": -0.2, "over": 8.0}}},
        "rotation": {"ramp": {"to": "60 rpm", "over": 8}},
    }
    scene = slant(diameter=0.2, top=top, damping={"structural": 0.5}, solver__step=5e-3, solver__end=30.0)
    result = run(scene)
    late = result.time > 24.0
    load, torque = loads(motion, FRICTION, TOUCHING)
    assert result["hook_load"][late].mean() == pytest.approx(load, rel=1e-3)
    assert result["surface_torque"][late].mean() == pytest.approx(torque, rel=1e-3)
    # and not what either motion alone would give
    assert abs(load / loads(MOTIONS["pick_up"], FRICTION, TOUCHING)[0] - 1.0) > 0.1
    assert abs(torque / loads(MOTIONS["rotating"], FRICTION, TOUCHING)[1] - 1.0) > 0.05


def test_reaming_stands_beside_the_other_motions_of_torque_drag():
    (case,) = torque_drag(slant(), elements=LINKS, reamed=reaming(0.3, 6.0))
    for way, motion in reaming(0.3, 6.0).items():
        load, torque = loads(motion, FRICTION, TOUCHING)
        assert case.hook_loads(way)[0] == pytest.approx(load, rel=1e-5)
        assert case.torques_of(way)[0] == pytest.approx(torque, rel=1e-4)
    assert case.hook_loads("reaming_up")[0] < case.hook_loads("pick_up")[0]


# casing
CASED, SHOE = 0.15, 430.0


def cased(shoe=SHOE, **changes):
    return slant(well__wall__casing={"shoe": shoe, "friction": CASED}, **changes)


def drag(top=0.0):
    """Friction of a string whose wall begins at `top`: cased to the shoe, open below."""
    per_metre = ACROSS / LENGTH
    return per_metre * (CASED * (SHOE - top) + FRICTION * (LENGTH - SHOE))


@pytest.mark.parametrize(("way", "sign"), [("pick_up", 1.0), ("slack_off", -1.0)])
def test_drag_of_cased_and_open_hole_is_the_sum_of_both(way, sign):
    (case,) = torque_drag(cased(), elements=LINKS)
    half_a_link = 0.5 * LENGTH / LINKS
    assert case.hook_loads(way)[0] == pytest.approx(ALONG + sign * drag(half_a_link), rel=1e-6)
    assert case.soft_hook_loads(way)[0] == pytest.approx(ALONG + sign * drag(), rel=1e-9)
    assert f"{case.friction:.3g}" == "0.15/0.3"


def test_pair_of_factors_and_a_number_stand_beside_each_other_and_a_shoe_below_the_bit_cases_all():
    low, pair = torque_drag(cased(), [0.2, Factors(0.4, 0.1, SHOE)], elements=LINKS)
    free = torque_drag(slant(0.0), elements=LINKS)[0].hook_loads("pick_up")[0]
    assert low.hook_loads("pick_up")[0] - free == pytest.approx(0.2 * TOUCHING * ACROSS, rel=1e-5)
    mean = (0.1 * (SHOE - 50.0) + 0.4 * (LENGTH - SHOE)) / LENGTH
    assert pair.hook_loads("pick_up")[0] - free == pytest.approx(mean * ACROSS, rel=1e-5)
    (deep,) = torque_drag(cased(shoe=2000.0), elements=LINKS)
    assert deep.hook_loads("pick_up")[0] - free == pytest.approx(CASED * TOUCHING * ACROSS, rel=1e-5)


@pytest.mark.parametrize("law", ["projection", "karnopp", "regularised"])
def test_run_in_a_cased_hole_has_the_drag_of_both_parts_within_half_a_percent(law):
    friction = {"static": FRICTION, "kinetic": FRICTION, "law": law, "slip_velocity": 1e-2}
    method = {"solver__method": "rk4", "solver__step": 1e-3} if law == "karnopp" else {"solver__step": 5e-3}
    top = {"block": {"velocity": {"ramp": {"to": -0.1, "over": 4.0}}}}
    result = run(cased(friction=friction, top=top, damping={"structural": 0.2}, solver__end=12.0, **method))
    load = ALONG + drag(0.5 * LENGTH / LINKS)
    assert result["hook_load"][result.time > 9.0].mean() == pytest.approx(load, rel=5e-3)


def test_both_factors_are_found_again_from_hook_loads_that_were_made_with_them():
    scene = shipped("jwell", well__wall__casing={"shoe": 2400.0, "friction": 0.2}, model__bending="soft")
    # twice as many loads as factors; above the first depth there is nearly no open hole, above the second a third of it
    depths = np.array([2500.0, 3700.0])
    made = Factors(0.31, 0.17, 2400.0)
    (case,) = torque_drag(scene, [made], depths, 12)
    measured = Measured(depths, case.hook_loads("pick_up"), case.hook_loads("slack_off"), np.arange(2) + 2)
    found = fit(scene, measured, 12)
    assert found.friction == pytest.approx(0.31, abs=1e-4) and found.cased == pytest.approx(0.17, abs=1e-4)
    assert found.spread < 1e-4 and found.cased_spread < 1e-4


def test_loads_that_cannot_tell_the_factors_apart_have_an_endless_spread():
    # above the shoe the open hole's factor does nothing
    scene = shipped("jwell", well__wall__casing={"shoe": 3600.0, "friction": 0.2}, model__bending="soft")
    depths = np.array([2900.0, 3300.0])
    (case,) = torque_drag(scene, [0.2], depths, 20)
    made = (case.hook_loads(way) for way in ("pick_up", "slack_off"))
    found = fit(scene, Measured(depths, *made, np.arange(2)), 20)
    assert found.cased == pytest.approx(0.2, abs=1e-3) and found.cased_spread < 0.01
    assert np.isinf(found.spread)


def test_shoe_and_its_friction_are_read_and_refused_by_key():
    scene = cased()
    assert scene.well.wall.casing.friction.static == CASED == scene.well.wall.casing.friction.kinetic
    text = {"shoe": SHOE, "friction": {"static": 0.1, "kinetic": 0.2}}
    with pytest.raises(SceneError, match=r"casing\.friction\.kinetic.*larger than static"):
        slant(well__wall__casing=text)
    with pytest.raises(SceneError, match=r"casing\.shoe"):
        slant(well__wall__casing={"friction": 0.1})


def test_shoe_below_the_hole_and_a_string_that_moves_past_it_are_warned_of():
    (one,) = [c for c in warnings(cased(shoe=2000.0)) if c.where == "well.wall.casing.shoe"]
    assert "below the end of the hole" in one.text
    moving = cased(top={"block": {"ramp": {"to": -150.0, "over": 1.0}}})
    assert any("keep the friction of where they start" in c.text for c in warnings(moving))
    assert isinstance(moving, DrillstringScene)
