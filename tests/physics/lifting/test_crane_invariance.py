"""A crane that is moved, turned or rolled with all about it feels nothing of it, and no energy comes from nowhere."""

import numpy as np
import pytest
from of_the_suite import studies
from physics.lifting.crane_scenes import (
    ACROSS,
    HOISTING,
    block_of_falls,
    body,
    crane,
    drum,
    end,
    hoist,
    ran,
    sheave,
    solved,
    turn,
    turned,
    unbalanced,
)

SAME = 1.0e-9
EXACT = {"control": "fixed", "tolerance": 1.0e-10}
"""What a step leaves unsolved is far less than this: Newton's method squares it. Below is rounding, which 100 m of
displacement add to, and steps that cannot do better are halved."""
UP, ALONG = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
TURNS = {
    "moved": (np.eye(3), (100.0, -30.0, 7.0)),
    "about the vertical": (turn(UP, 0.7), (0.0, 0.0, 0.0)),
    "rolled by 30 degrees": (turn(ALONG, np.radians(30.0)), (3.0, 4.0, 5.0)),
    "laid on its side": (turn(ALONG, 0.5 * np.pi), (0.0, 0.0, 0.0)),
    "pitched on its nose": (turn(ACROSS, 0.5 * np.pi), (0.0, 0.0, 0.0)),
    "any way": (turn((1.0, 2.0, -0.5), 2.1), (-3.0, 4.0, 5.0)),
    "upside down": (turn(ALONG, np.pi), (0.0, 0.0, 60.0)),
}
RIM = {"inertia": 12.0, "law": "capstan", "friction": 0.004}


def slewing(base=None, **payload):
    """A boom that slews and luffs while it hoists, on the ground or on a frame turned by an angle `base`."""
    boom = {"name": "boom", "pivot": (0.0, 0.0, 0.0), "slew": {"ramp": {"rate": 0.25, "over": 2.0}}}
    boom["luff"] = {"harmonic": {"amplitude": 0.1, "period": 5.0, "ramp": 2.0}}
    frames = [boom]
    if base is not None:
        frames = [{"name": "base", "pivot": (0.0, 0.0, 0.0), "slew": base}, boom | {"parent": "base"}]
    place = turn(UP, base or 0.0) @ np.array([8.0, 0.0, -9.0])
    path = [
        drum((0.5, 0.5, 0.0), 0.3, frame="boom", pay_out={"ramp": {"to": -0.8, "over": 1.0}}),
        sheave((7.8, 0.0, 6.0), 0.2, frame="boom", inertia=1.5),
        end("payload"),
    ]
    bodies = [body("payload", 2000.0, [float(x) for x in place], **payload)]
    rope = {"mass_per_length": 2.2, "axial_stiffness": 4.0e7, "damping": 0.0}
    return crane(path, bodies, rope, frames=frames, mesh={"elements_per_span": 3}, solver={"end": 4.0})


def askew(aside=4.0, tilt=0.05):
    """A hoist whose drum, sheave and swinging payload lie in no plane: fleet angles everywhere."""
    path = [
        drum((0.0, aside, 0.0), pay_out=HOISTING),
        sheave((12.0, 0.0, 30.0), axis=(0.1, 1.0, tilt), inertia=20.0),
        end("payload"),
    ]
    load = body("payload", 5000.0, (12.4, 3.0, 5.0), velocity=(0.5, 2.0, 0.0))
    return crane(path, [load], {"damping": 0.0}, solver={"end": 2.0})


# Contacts that slip all at once may leave a step with two ways to go, of which the last digit takes one, and the run
# goes on 1e-4 off. Of eight lengths that the winch hauls it is so with two or three, now as before; not with this one.
SCENES = {
    "a hoist": hoist(),
    "a swinging payload": hoist(load={"velocity": (1.0, 2.0, 0.0)}),
    "four falls that slip": block_of_falls(
        4, 20.0e3, hooks=RIM, drive={"pay_out": {"ramp": {"to": -2.4, "over": 0.3}}}, load={"guide": []}
    ),
    "fleet angles": askew(),
    "a drum of torque and a heavy rope": hoist(
        drive={"torque": {"constant": 3.0e3}, "inertia": 4000.0}, rope={"mass_per_length": 25.0}, solver={"end": 2.0}
    ),
    "a rope that bends": hoist(rope={"bending_stiffness": 2000.0}),
    "a slack rope": hoist(rope={"length": 58.0, "damping": 1.0e-2}, start="as drawn"),
}


@pytest.fixture(scope="module")
def upright():
    """Runs of the scenes as they are drawn."""
    return {name: ran(solved(scene, **EXACT)) for name, scene in SCENES.items()}


def off(one, two):
    """Largest difference of tensions over the largest tension."""
    return np.abs(one - two).max() / np.abs(two).max()


# the whole scene
@pytest.mark.parametrize("way", TURNS)
@pytest.mark.parametrize("name", SCENES)
def test_a_scene_that_is_moved_or_turned_with_its_gravity_has_the_same_tensions_and_takes_the_same_work(
    name, way, upright
):
    result = ran(turned(solved(SCENES[name], **EXACT), *TURNS[way]))
    assert off(result["tension"], upright[name]["tension"]) < SAME
    if upright[name]["external_work"].any():
        assert off(result["external_work"], upright[name]["external_work"]) < SAME


@pytest.mark.parametrize("base", [None, *studies(0.7)])
def test_a_boom_that_slews_far_from_the_origin_of_the_scene_carries_what_it_carries_at_the_origin(base):
    """As in map coordinates. Numbers of the boom's place were pushed alone: 100 to 300 N, by what R x is there."""
    scene = solved(slewing(base), end=3.0)
    scene["frames"][-1] |= {"slew": {"ramp": {"to": 0.3, "over": 2.0}}, "luff": 0.0}
    near, far = (turned(scene, np.eye(3), shift) for shift in ((0.0, 0.0, 0.0), (450.0e3, 6700.0e3, 0.0)))
    assert off(ran(far)["tension"], ran(near)["tension"]) < 1.0e-5


@pytest.mark.parametrize("motion", ["heave", *studies("surge")])
def test_a_speed_that_jumps_while_the_vessel_yaws_is_felt_far_from_the_origin_as_it_is_at_the_origin(motion):
    """Told at the scene's origin a frame's place moved by R x: beside that a jump was not seen, and 700 N were off."""
    jump = {"ramp": {"rate": 0.2, "over": 1.0e-3, "at": 1.0}}
    yaw = {"harmonic": {"amplitude": 0.1, "period": 6.0, "ramp": 2.0}}
    scene = solved(
        hoist() | {"vessel": {"reference": [0.0, 0.0, -10.0], "motion": {motion: jump, "yaw": yaw}}}, end=2.0
    )
    near, far = (ran(turned(scene, np.eye(3), shift)) for shift in ((0.0, 0.0, 0.0), (450.0e3, 6700.0e3, 0.0)))
    assert off(far["tension"], near["tension"]) < 1.0e-6


@pytest.mark.parametrize(
    "motion", [{"roll": 10.0}, {"roll": 10.0, "pitch": -5.0, "yaw": 30.0}], ids=["roll", "all three"]
)
def test_a_vessel_that_lies_rolled_is_the_same_as_its_crane_drawn_rolled(motion):
    """The payload hangs plumb in both; drum and sheave stand askew, so that the rope leaves them at an angle."""
    angles = {key: float(np.radians(angle)) for key, angle in motion.items()}
    reference = np.array([0.0, 0.0, -10.0])
    matrix = np.eye(3)
    for key, axis in (("yaw", UP), ("pitch", ACROSS), ("roll", ALONG)):
        matrix = matrix @ turn(axis, angles.get(key, 0.0))
    drawn = solved(hoist(), **EXACT)
    place = matrix @ (np.array([12.4, 0.0, 30.0]) - reference) + reference - (0.0, 0.0, 25.0)
    drawn["bodies"][0]["position"] = [float(x) for x in place]
    ship = drawn | {"vessel": {"reference": [float(x) for x in reference], "motion": angles}}
    rolled = turned(drawn, matrix, reference - matrix @ reference, gravity=False)
    rolled["bodies"] = drawn["bodies"]
    one, two = ran(ship), ran(rolled)
    assert np.degrees(np.abs(one["fleet_angle"]).max()) > 4.9
    assert off(one["tension"], two["tension"]) < SAME
    assert one["tension"][0] == pytest.approx(two["tension"][0], rel=SAME)


def test_a_boom_on_a_base_that_stands_turned_slews_as_on_one_that_does_not():
    # what a frame does is followed by quintics to 1e-11 of how far it moves: that is 2e-9 of the rope's tension
    one, two = (ran(solved(slewing(base), **EXACT)) for base in (None, 0.7))
    assert off(one["tension"], two["tension"]) < 1.0e-8


# energy
UNDAMPED = {"damping": 0.0}
LEISURELY = {"pay_out": {"ramp": {"to": -0.5, "over": 1.0}}}
# the scene, the drift over the largest kinetic energy at 5 ms, and the fleet angle that it has at least, in degrees
CONSERVING = {
    "a hoist": (hoist(rope=UNDAMPED, solver={"end": 2.0}), 7.0e-5, 0.0),
    "a swinging payload": (hoist(rope=UNDAMPED, load={"velocity": (1.0, 0.5, 0.0)}, solver={"end": 2.0}), 7.0e-5, 0.0),
    "a rope that bends": (hoist(rope=UNDAMPED | {"bending_stiffness": 2000.0}, solver={"end": 2.0}), 7.0e-5, 0.0),
    "two falls": (block_of_falls(2, 5000.0, rope=UNDAMPED, drive=LEISURELY, solver={"end": 2.0}), 6.0e-4, 0.0),
    "sixteen falls": (block_of_falls(16, rope=UNDAMPED, drive=LEISURELY, solver={"end": 2.0}), 6.0e-4, 0.0),
    "fleet angles": (askew(), 6.0e-5, 5.0),
    "large fleet angles": (askew(18.0, 0.4), 1.0e-4, 20.0),
    "a boom that slews and luffs": (slewing(), 3.0e-5, 9.0),
    "such a boom with fleet angles": (slewing(velocity=(0.5, 3.0, 0.0)), 4.0e-5, 11.0),
}


def undamped(scene, step):
    """A run by a method that damps nothing."""
    return ran(solved(scene, step=step, rho_inf=1.0, control="fixed", tolerance=1e-11))


def drift(result):
    """Largest energy from nowhere over the largest kinetic energy."""
    return np.abs(unbalanced(result)).max() / result["kinetic_energy"].max()


@pytest.mark.parametrize("name", CONSERVING)
def test_energy_drifts_with_the_square_of_the_step(name):
    """By a factor of 4 at every halving, as far as the moving frames' quintics allow (1e-8)."""
    scene, most, fleet = CONSERVING[name]
    results = [undamped(scene, step) for step in (5.0e-3, 2.5e-3, 1.25e-3)]
    assert np.degrees(np.abs(results[0]["fleet_angle"]).max()) >= fleet
    found = [drift(result) for result in results]
    assert found[0] < most
    assert found[0] / found[1] == pytest.approx(4.0, rel=0.05)
    assert found[1] / found[2] == pytest.approx(4.0, rel=0.05)


def test_energy_drifts_by_as_little_as_was_hoped_for():
    """A planar trial of the equations gave 5e-5, 2e-6 and 8e-8 of the kinetic energy at 5, 1 and 0.2 ms.

    Here it is the hoist of hoist.yaml: less, because the work of what moves it is that of the step's mean forces. It
    falls with the square of the step.
    """
    scene = CONSERVING["a hoist"][0]
    found = [drift(undamped(scene, step)) for step in (5.0e-3, 1.0e-3, 2.0e-4)]
    assert found == pytest.approx([4.6e-7, 1.84e-8, 7.3e-10], rel=0.05)
