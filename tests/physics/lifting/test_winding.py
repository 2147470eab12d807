"""Rope that comes onto a drum keeps its stretch and its place: torque is tension times radius, and so is work.

Closed forms: a drum's moment balance, I a / R = Q / R - T, with a load's m a = T - m g; work from outside as the
integral of tension times the rope's speed at the rim. The rope is so light that its own inertia does not count.
"""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, body, crane, drum, end, hoist, ran, sheave

MASS, RADIUS, INERTIA = 5000.0, 0.5, 400.0
WEIGHT = MASS * GRAVITY
LIGHT = 1.0e-3
"""rhoA, kg/m: the rope weighs less than 1e-5 of the load."""
STRETCHES = (0.001, 0.01, 0.05)
LIFTED = ("drum first", "drum last")


def lift(stretch, order, drive, **solver):
    """A load below a sheave, the rope strained by ``stretch``, its drum at the first or the last end of the path."""
    path = [
        drum((0.0, 0.0, 0.0), RADIUS, **drive),
        sheave((5.0, 0.0, 2.0), 0.25, "over"),
        end("load"),
    ]
    if order == "drum last":
        path.reverse()
    rope = {"mass_per_length": LIGHT, "axial_stiffness": WEIGHT / stretch, "damping": 0.01}
    load = body("load", MASS, (5.25, 0.0, -10.0), guide=["x", "y"])
    return crane(path, [load], rope, solver={"end": 4.0, **solver})


def risen(result):
    return result["body_position"][:, 0, 2] - result["body_position"][0, 0, 2]


@pytest.mark.parametrize("order", LIFTED)
@pytest.mark.parametrize("stretch", STRETCHES)
def test_torque_of_weight_times_radius_holds_a_load_however_far_its_rope_stretches(stretch, order):
    # a drum that lets the strain of its rope go would hoist it with half the strain times g m / (m + I/R^2)
    result = ran(lift(stretch, order, {"torque": WEIGHT * RADIUS, "inertia": INERTIA}))
    assert np.abs(risen(result)).max() < 1.0e-3
    assert result["drum_tension"] == pytest.approx(WEIGHT, rel=1.0e-5)


@pytest.mark.parametrize("order", LIFTED)
@pytest.mark.parametrize("stretch", STRETCHES)
@pytest.mark.parametrize("share", [0.98, 1.02])
def test_torque_beyond_that_moves_load_and_drum_by_the_difference(share, stretch, order):
    # after 4 s the bounce of the rope is damped; the drum turns with the stretched rope that comes onto it
    result = ran(lift(stretch, order, {"torque": share * WEIGHT * RADIUS, "inertia": INERTIA}))
    acceleration = (share - 1.0) * WEIGHT / (MASS + INERTIA / RADIUS**2)
    time, speed = result["time"], result["body_velocity"][:, 0, 2]
    late = time > 2.0
    assert np.polyfit(time[late], speed[late], 1)[0] == pytest.approx(acceleration, rel=0.02)


@pytest.mark.parametrize("order", LIFTED)
@pytest.mark.parametrize("stretch", STRETCHES)
def test_brake_slips_at_its_torque_over_the_radius(stretch, order):
    # one per cent too weak, and one per cent strong enough, of a rope that stretches by up to 5 %
    for share in (0.99, 1.01):
        brake = {"torque": share * WEIGHT * RADIUS}
        result = ran(lift(stretch, order, {"torque": 0.0, "inertia": INERTIA, "brake": brake}, end=2.0))
        fallen = -risen(result)[-1]
        expected = 0.5 * (1.0 - share) * WEIGHT / (MASS + INERTIA / RADIUS**2) * 2.0**2 if share < 1.0 else 0.0
        assert fallen == pytest.approx(expected, rel=0.05, abs=1.0e-3)


@pytest.mark.parametrize("order", LIFTED)
@pytest.mark.parametrize("drive", ["pay_out", "torque"])
@pytest.mark.parametrize("stretch", STRETCHES)
def test_work_from_outside_is_tension_times_speed_at_the_rim(stretch, drive, order):
    """Of a drum that is driven either way; the rest, where a motor drives it, is in the drum's own inertia."""
    how = {"pay_out": {"ramp": {"to": -0.5, "over": 1.0}}}
    if drive == "torque":
        how = {"torque": 1.02 * WEIGHT * RADIUS, "inertia": INERTIA}
    result = ran(lift(stretch, order, how))
    time, power = result["time"], result["winch_power"][:, 0]
    rim = np.gradient(result["drum_rotation"][:, 0] * RADIUS, time)
    kept = 0.5 * INERTIA * (rim / RADIUS) ** 2 if drive == "torque" else 0.0 * rim
    work = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(time) * (power[1:] + power[:-1]))))
    late = time > 2.0
    # half the strain would be missing of it, or be too much
    assert (result["external_work"] - kept)[late] == pytest.approx(work[late], rel=0.1 * stretch + 2.0e-4)


@pytest.mark.parametrize("drive", [{"pay_out": {"ramp": {"to": -2.0, "over": 1.0}}}, {"torque": 3.5e4, "inertia": 4e3}])
def test_work_from_outside_is_that_of_the_scene_moved_up_or_down(drive):
    """33 kg/m: a drum that forgets the height of the rope on it takes five times less at 1000 m, or gives energy."""
    made = []
    for height in (0.0, 1000.0, -1000.0):
        scene = hoist(drive=drive, rope={"mass_per_length": 33.0}, solver={"end": 3.0, "control": "fixed"})
        for item in (scene["path"][0]["drum"], scene["path"][1]["sheave"]):
            item["center"] = [*item["center"][:2], item["center"][2] + height]
        scene["bodies"][0]["position"] = [*scene["bodies"][0]["position"][:2], 5.0 + height]
        result = ran(scene)
        made.append((result["external_work"][-1], np.ptp(result["potential_energy"])))
    assert made[1] == pytest.approx(made[0], rel=1.0e-6) and made[2] == pytest.approx(made[0], rel=1.0e-6)
