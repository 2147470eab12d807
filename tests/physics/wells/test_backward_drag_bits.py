"""A drag bit that turns backward cuts no chips: all the weight on it rubs, T = mu gamma a W / 2, and the hole stays."""

from math import pi

import numpy as np
import pytest
from physics.wells.strings import COLLAR, G, run, straight_hole

from drillstring.drilling.bit_numbers import bit_row, torque_at
from drillstring.drilling.chatter import calm_step
from drillstring.model.prepared import prepared
from drillstring.warnings import warnings
from tautline.live.simulation import Simulation

WEIGHT, RPM = 5e4, 2.0 * pi / 60.0
RADIUS, MU, GAMMA, ZETA, EPS, FLATS = 0.108, 0.6, 0.9, 0.6, 60e6, 0.108 * 1.2e-3 * 60e6
RUBS = 0.5 * MU * GAMMA * RADIUS * WEIGHT
CUTS = 0.5 * MU * GAMMA * RADIUS * FLATS + 0.5 * RADIUS / ZETA * (WEIGHT - FLATS)
CUTTING = {
    "specific_energy": EPS, "contact_strength": "60 MPa", "wear_flat": "1.2 mm", "friction": MU, "bit_constant": GAMMA,
    "inclination": ZETA, "radius": RADIUS,
}  # fmt: skip
BLADES = pytest.mark.parametrize("blades", [None, 5])


def turned(speed, blades=None, feed=0.0, **changes):
    """A short collar on bottom whose top is turned at a speed, rad/s."""
    cutting = CUTTING | ({} if blades is None else {"blades": blades})
    usual = {
        "length": 200.0, "elements": 2, "bit": {"on_bottom": True, "weight": WEIGHT, "cutting": cutting},
        "top__rotation": speed, "top__block": {"velocity": feed}, "well__wall": "none", "solver__end": 3.0,
        "solver__step": 2e-3, "output__interval": 0.02, "solver__rho_inf": 0.5, "damping": {"structural": 2e-2},
    }  # fmt: skip
    return straight_hole(0.0, **(usual | changes))


@BLADES
@pytest.mark.parametrize("method", ["generalized-alpha", "rk4"])
def test_a_drag_bit_that_turns_backward_rubs_with_all_its_weight_and_drills_nothing(blades, method):
    step = 2e-4 if method == "rk4" else 2e-3
    result = run(turned(-60 * RPM, blades, solver__method=method, solver__step=step))
    assert result["torque_on_bit"][-1] == pytest.approx(-RUBS, rel=1e-4)
    assert result["weight_on_bit"][-1] == pytest.approx(WEIGHT, rel=1e-4)
    assert np.ptp(result["hole_depth"]) == 0.0 and np.all(result["rate_of_penetration"] == 0.0)


@BLADES
def test_a_drag_bit_that_turns_forward_cuts_and_rubs_as_detournay_and_defourny_say(blades):
    feed = (WEIGHT - FLATS) / (RADIUS * ZETA * EPS)
    result = run(turned(60 * RPM, blades, feed, solver__end=1.0))
    assert result["torque_on_bit"] == pytest.approx(CUTS, rel=1e-4)


@BLADES
def test_a_string_that_is_wound_back_slowly_lets_its_bit_go_at_the_torque_with_which_it_rubs(blades):
    """Up to there the bit holds still: k phi = T, k = G J / L. Wound forward it holds up to the torque that cuts."""
    polar = pi / 32.0 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
    stiff = G * polar / 200.0
    for way, most in ((-1.0, RUBS), (1.0, CUTS)):
        top = {"table": {"time": [0.0, 0.5, 60.0], "value": [0.0, way * 0.02, way * 0.02]}}
        scene = turned(top, blades, solver__end=most / stiff / 0.02 + 1.0, solver__step=5e-3)
        result = run(scene)
        torque, angle = way * result["torque_on_bit"], way * result["rotation"][:, -1]
        let_go = np.flatnonzero(angle > 1e-4)[0]
        assert torque[: let_go + 1].max() == pytest.approx(most, rel=0.02)
        assert torque.max() < 1.001 * most


def test_a_roller_bit_whose_torque_is_given_is_braked_alike_both_ways():
    bit = {"on_bottom": True, "weight": WEIGHT, "torque": {"static": 2e3, "kinetic": 2e3}}
    for way in (-1.0, 1.0):
        assert run(turned(way * 6.0, bit=bit))["torque_on_bit"][-1] == pytest.approx(way * 2e3, rel=1e-4)


def test_the_law_before_a_run_is_that_of_the_run():
    scene = turned(-60 * RPM)
    lumps = prepared(scene).lumps
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, -60 * RPM, False)[0]
    assert torque_at(b, WEIGHT, -1.0) == pytest.approx(RUBS) and torque_at(b, WEIGHT, 1.0) == pytest.approx(CUTS)
    steep = turned(0.0, solver__method="rk4", bit=scene.bit.model_dump(mode="json") | {
        "cutting": CUTTING | {"inclination": 60.0}
    })  # fmt: skip
    # Nearly all of the cutting force is along the hole: then it is the way back that holds the bit the most.
    inertia = float(prepared(steep).lumps.of_lumps(lambda tube: tube.rotary_inertia)[-1])
    assert calm_step(steep, prepared(steep).lumps) == pytest.approx(2.785 * 0.1 * inertia / RUBS, rel=1e-2)


THERE_AND_BACK = {"table": {"time": [0, 1, 2, 3], "value": [30 * RPM, 30 * RPM, -60 * RPM, -60 * RPM]}}
BACK = {"ramp": {"to": -60 * RPM, "over": 3.0}}


@pytest.mark.parametrize(("speed", "limit", "said"), [
    (-60 * RPM, 1.01 * RUBS, []), (-60 * RPM, 0.99 * RUBS, ["backward"]), (BACK, 0.5 * (RUBS + CUTS), []),
    (30 * RPM, 1.01 * CUTS, []), (30 * RPM, 0.99 * CUTS, ["forward"]), (THERE_AND_BACK, 1.01 * CUTS, []),
    (THERE_AND_BACK, 0.5 * (RUBS + CUTS), ["forward"]), (THERE_AND_BACK, 0.99 * RUBS, ["forward", "backward"]),
])  # fmt: skip
def test_a_weak_drive_is_judged_by_the_torque_of_the_ways_in_which_it_turns_its_bit(speed, limit, said):
    drive = {"kind": "pi", "speed": speed, "proportional": 5e3, "integral": 2e3, "inertia": 2e3, "torque_limit": limit}
    told = [one.text for one in warnings(turned({"controller": drive})) if one.where.endswith("torque_limit")]
    spin, needed = {"forward": "30 rpm", "backward": "-60 rpm"}, {"forward": CUTS, "backward": RUBS}
    assert len(told) == len(said)
    for text, way in zip(told, said, strict=True):
        assert f"at {spin[way]}, the fastest of the run" in text and "the drive stalls" in text
        assert float(text.split("less than the ")[1].split(" kN m")[0]) == pytest.approx(needed[way] / 1e3, rel=1e-3)
        assert (f"of the run {way}:" in text) == (speed is THERE_AND_BACK)


def test_a_roller_bit_that_may_hold_its_drive_both_ways_is_told_once():
    drive = {"kind": "pi", "speed": THERE_AND_BACK, "proportional": 5e3, "integral": 2e3, "inertia": 2e3}
    bit = {"on_bottom": True, "weight": WEIGHT, "torque": {"static": 2e3, "kinetic": 1e3}}
    scene = turned({"controller": drive | {"torque_limit": 1.5e3}}, bit=bit)
    (text,) = [one.text for one in warnings(scene) if one.where.endswith("torque_limit")]
    assert "the drive may stall there" in text


def test_a_roller_bit_that_stalls_its_drive_both_ways_is_told_once_with_both_speeds():
    drive = {"kind": "pi", "speed": THERE_AND_BACK, "proportional": 5e3, "integral": 2e3, "inertia": 2e3}
    bit = {"on_bottom": True, "weight": WEIGHT, "torque": {"static": 2e3, "kinetic": 2e3}}
    scene = turned({"controller": drive | {"torque_limit": 1.5e3}}, bit=bit)
    (text,) = [one.text for one in warnings(scene) if one.where.endswith("torque_limit")]
    both = (
        "at 30 rpm, the fastest of the run forward, and at -60 rpm, the fastest of the run backward: the drive stalls"
    )
    assert both in text


@pytest.mark.parametrize("outside", [("top.rotary_speed",), ("top.torque",), ("top.block_speed",), ("top.block",)])
def test_what_drives_rotary_or_block_from_outside_decides_how_a_bit_drills_and_the_scene_is_not_blamed(outside):
    """A bit of a scene that does not turn it is pushed on by its block: true, and not where something else turns it."""
    scene = turned(0.0, feed=1e-2, length=2000.0, well__sections=[{"hold": 2000.0}])
    drive = {"kind": "pi", "speed": 0.0, "proportional": 5e3, "integral": 2e3, "inertia": 2e3}
    scene = scene.replace({"top.rotation": {"controller": drive}})
    alone = [one.text for one in warnings(scene) if one.where == "top.block"]
    assert any("The bit does not turn then" in text for text in alone)
    driven = [one.text for one in warnings(scene.driven_by(outside)) if one.where == "top.block"]
    assert not any("does not turn" in text or "leads to a weight on bit" in text for text in driven)


@BLADES
def test_what_is_said_of_a_drag_bit_that_sticks_names_the_torque_of_either_way(blades):
    """Pushed back it is told up to which torque that way."""
    (resting,) = Simulation(turned(0.0, blades)).linearise(["top.rotary_speed"], ["torque_on_bit"]).stuck
    assert f"backward by more than {RUBS:.4g} N m, or forward by more than {CUTS:.4g} N m" in resting
    pushed = Simulation(turned({"table": {"time": [0.0, 0.5, 9.0], "value": [0.0, -0.02, -0.02]}}, blades))
    pushed.advance(1.0)
    (back,) = pushed.linearise(["top.rotary_speed"], ["torque_on_bit"]).stuck
    assert f"turns it backward by more than {RUBS:.4g} N m" in back and "forward" not in back


@BLADES
def test_a_bit_that_sticks_alike_both_ways_is_told_one_torque_without_a_way(blades):
    """A roller bit, and a drag bit whose flats bear all of the weight."""
    light = CUTTING | ({} if blades is None else {"blades": blades})
    for law, most in (({"torque": {"static": 2e3, "kinetic": 2e3}}, 2e3), ({"cutting": light}, RUBS / 10.0)):
        bit = {"on_bottom": True, "weight": WEIGHT if "torque" in law else WEIGHT / 10.0} | law
        (alike,) = Simulation(turned(0.0, bit=bit)).linearise(["top.rotary_speed"], ["torque_on_bit"]).stuck
        assert f"turns it by more than {most:.4g} N m" in alike
