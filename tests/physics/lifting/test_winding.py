"""Rope that comes onto a drum keeps its stretch and its place: torque is tension times radius, and so is work.

Closed forms: a drum's moment balance, I a / R = Q / R - T, with a load's m a = T - m g; work from outside as the
integral of tension times the rope's speed at the rim. The rope is so light that its own inertia does not count.
"""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, drum, end, hoist, ran, sheave, solved
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

MASS, RADIUS, INERTIA = 5000.0, 0.5, 400.0
WEIGHT = MASS * GRAVITY
LIGHT = 1.0e-3
"""rhoA, kg/m: the rope weighs less than 1e-5 of the load."""
HEAVY = 33.0
"""rhoA, kg/m: rhoA u^2 at 4 m/s is half a kilonewton."""
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


# drums
def test_a_heavy_drum_on_a_soft_rope_follows_its_moment_balance():
    """I theta.. = Q - T R with theta. = lambda S. / R, S the rope on the drum, and m z.. = T - m g: by SciPy.

    The rope has no mass and stretches by 3 %: without the rate of lambda the tension is off by a kilonewton.
    """
    inertia, torque, stiffness = 1.0e4, 1.3 * WEIGHT * RADIUS, WEIGHT / 0.03
    path = [drum((0.0, 0.0, 0.0), RADIUS, torque=torque, inertia=inertia), end("load")]
    rope = {"mass_per_length": LIGHT, "axial_stiffness": stiffness, "damping": 0.0}
    load = body("load", MASS, (RADIUS, 0.0, -20.0))
    mesh = {"elements_per_span": 1}
    result = ran(crane(path, [load], rope, mesh=mesh, solver={"end": 4.0, "step": 2.0e-3, "rho_inf": 1.0}))
    material = result["material_coordinate"][0]
    length = abs(material[-1] - material[0])

    def tension(stretch):
        return 0.5 * stiffness * (stretch**2 - 1.0) * stretch

    at_rest = brentq(lambda stretch: tension(stretch) - WEIGHT, 1.0, 1.1)

    def rates(_, x):
        wound, rim, risen, speed = x
        stretch = (at_rest * length - risen) / (length - wound)
        pull = tension(stretch)
        return rim / stretch, (torque / RADIUS - pull) * RADIUS**2 / inertia, speed, pull / MASS - GRAVITY

    exact = solve_ivp(rates, (0.0, 4.0), np.zeros(4), "DOP853", result["time"], rtol=1e-10, atol=1e-10)
    wound, _, up, _ = exact.y
    expected = tension((at_rest * length - up) / (length - wound))
    assert np.sqrt(np.mean((result["drum_tension"][:, 0] - expected) ** 2)) < 1.0e-3 * WEIGHT
    assert -result["paid_out"][:, 0] == pytest.approx(wound, abs=2.0e-3)


@pytest.mark.parametrize("surface", [-100.0, 10.0, 1000.0])
def test_a_winch_on_the_sea_bed_holds_its_load_however_deep_it_lies(surface):
    """Rope on the drum is as deep as the drum: without its buoyancy a torque of T R hoisted 2.9 m in 2 s at 1000 m."""
    path = [drum((0.0, 0.0, 0.0), RADIUS, torque=0.0, inertia=400.0), end("load")]
    rope = {"mass_per_length": 6.5, "axial_stiffness": 8.0e7, "diameter": 0.036, "damping": 1.0e-3}
    load = body("load", MASS, (RADIUS, 0.0, -20.0))
    scene = crane(path, [load], rope, water={"surface": surface, "density": 1025.0}, solver={"end": 2.0})
    buoyancy = 0.25 * np.pi * 0.036**2 * 1025.0 * GRAVITY if surface > 0.0 else 0.0
    held = WEIGHT + 20.0 * (6.5 * GRAVITY - buoyancy)
    scene["path"][0]["drum"]["torque"] = held * RADIUS
    result = ran(scene)
    # the rope of a radius that lies on the drum is all that is not balanced
    assert np.abs(result["paid_out"]).max() < 2.0e-3


def test_rope_is_counted_from_the_start_on_both_of_two_drums_that_are_driven():
    """The static start adds rope at one of them: 5 m of 1.6 km were taken for paid out, and more for the first turn."""
    drive = {"torque": 1.0e5, "inertia": 3.0e3, "rope_on_drum": 100.0, "brake": {"torque": 1.0e6}}
    path = [
        drum((-0.3, 0.0, 0.0), 0.4, name="A", **drive),
        sheave(None, 0.4, "under", name="block", body="load", offset=(0.0, 0.0, 0.0)),
        drum((1.2, 0.0, 0.0), 0.3, name="B", **drive),
    ]
    rope = {"mass_per_length": HEAVY, "axial_stiffness": 4.0e7, "damping": 1.0e-2}
    load = body("load", 3.0e4, (0.5, 0.0, -800.0), guide=["x", "y"])
    result = ran(crane(path, [load], rope, solver={"end": 0.2, "step": 0.01}))
    for name in ("paid_out", "drum_rotation", "sheave_rotation"):
        assert np.abs(result[name]).max() < 1.0e-5


@pytest.mark.parametrize("bending", [0.0, 2000.0])
def test_a_winch_that_bends_its_rope_has_the_torque_and_the_power_of_that(bending):
    """EJ / (2 R^2) is in each metre on the drum: torque T R + EJ / (2 R), power the rate of the work from outside."""
    rope = {"mass_per_length": LIGHT, "bending_stiffness": bending}
    result = ran(hoist(rope=rope, drive={"pay_out": {"ramp": {"to": -1.0, "over": 1.0}}}, solver={"end": 4.0}))
    time, power, work = result["time"], result["winch_power"][:, 0], result["external_work"]
    late = time >= 2.0
    assert np.trapezoid(power[late], time[late]) == pytest.approx(work[-1] - work[late][0], rel=2.0e-3)
    pull = result["drum_tension"][:, 0] + bending / (2.0 * 0.5**2)
    assert result["winch_torque"][:, 0] == pytest.approx(0.5 * pull, rel=1.0e-12)


# what moves as a whole
def steady(speed, axis):
    """Motion of a vessel at a constant speed from the first moment on."""
    return {
        "reference": [0.0, 0.0, 0.0],
        "motion": {axis: {"table": {"time": [0.0, 60.0], "value": [0.0, 60.0 * speed]}}},
    }


@pytest.mark.parametrize("drive", [{"pay_out": {"ramp": {"to": -4.0, "over": 1.0}}}, {"torque": 3.4e4, "inertia": 4e3}])
@pytest.mark.parametrize("axis", ["surge", "heave"])
def test_tensions_are_the_same_on_a_vessel_that_moves_steadily(axis, drive):
    """Speed of the whole is no force: rhoA p. U was one, 400 N of 37 kN at 10 m/s.

    One element in each span: nodes between would begin at rest in space. What is left, 5e-7, is of the rope on the
    sheave, which has its mass on the line of the centres.
    """
    made = []
    for speed in (0.0, 10.0, -10.0):
        way = [speed, 0.0, 0.0] if axis == "surge" else [0.0, 0.0, speed]
        rope, load = {"mass_per_length": HEAVY}, {"velocity": way}
        scene = hoist(elements=1, drive=drive, rope=rope, load=load, vessel=steady(speed, axis), solver={"end": 2.0})
        made.append(ran(solved(scene, control="fixed", tolerance=1.0e-10)))
    for other in made[1:]:
        for name in ("tension", "drum_tension", "winch_power"):
            assert np.abs(other[name] - made[0][name]).max() < 1.0e-6 * np.abs(made[0][name]).max()


@pytest.mark.parametrize("speed", [0.0, 4.0])
def test_rope_at_rest_in_space_has_the_tension_of_its_weight_below_a_drum_that_climbs_along_it(speed):
    """Statics: T at the drum is that at the ground and what the rope between weighs, however fast it is paid out."""
    path = [drum((0.0, 0.0, 0.0), 1.0, pay_out=speed), anchor((1.0, 0.0, -50.0), "ground", frame="ground")]
    rope = {"mass_per_length": HEAVY, "axial_stiffness": 4.0e8, "damping": 1.0e-3, "length": 49.99}
    result = ran(crane(path, (), rope, vessel=steady(speed, "heave"), solver={"end": 4.0}))
    height = 50.0 + speed * result["time"]
    late = result["time"] > 3.0
    difference = result["tension"][:, 0, 0] - result["tension"][:, 0, 1]
    # the rope stretches by half a thousandth, and the mesh smears its weight over the rim
    assert difference[late] == pytest.approx(HEAVY * GRAVITY * height[late], rel=2.0e-3)


def test_a_winch_that_holds_a_tension_holds_that_of_the_rope_also_while_the_rope_runs():
    """A vessel rises at 4 m/s from an anchor: 528 N, rhoA u^2, were missing."""
    drive = {"tension": 1.0e5, "inertia": 5.0e3, "gains": {"proportional": 5.0, "integral": 5.0}}
    path = [drum((0.0, 0.0, 0.0), 1.0, **drive), anchor((1.0, 0.0, -50.0), "ground", frame="ground")]
    rope = {"mass_per_length": HEAVY, "axial_stiffness": 4.0e8, "damping": 1.0e-3, "length": 49.99}
    vessel = {"reference": [0.0, 0.0, 0.0], "motion": {"heave": {"ramp": {"rate": 4.0, "over": 2.0}}}}
    result = ran(crane(path, (), rope, vessel=vessel, solver={"end": 12.0, "step": 0.01}, interval=0.05))
    assert result["pay_out_speed"][-1, 0] == pytest.approx(4.0, rel=1.0e-2)
    assert result["drum_tension"][-20:] == pytest.approx(1.0e5, rel=5.0e-4)


@pytest.mark.parametrize("length", [None, 56.0, 75.0])
def test_a_sheave_has_its_inertia_and_a_drum_its_turns_however_much_longer_the_rope_is_than_its_path(length):
    """I/R^2 a is the difference of tensions on both sides; a drum turns by what it pays out over R."""
    rope = {"mass_per_length": LIGHT, **({"length": length} if length else {})}
    drive, tip = {"pay_out": {"ramp": {"to": -1.0, "over": 1.0}}}, {"inertia": 4.0e3, "law": "no_slip"}
    result = ran(hoist(rope=rope, tip=tip, drive=drive, solver={"step": 1.0e-3}, interval=2.0e-3))
    time, tension = result["time"], result["tension"]
    rim = np.gradient(np.gradient(0.4 * result["sheave_rotation"][:, 0], time), time)[20:-5]
    pulled = (tension[:, 1, 0] - tension[:, 0, 1])[20:-5]
    assert pulled @ rim / (rim @ rim) == pytest.approx(4.0e3 / 0.4**2, rel=1.0e-2)
    assert result["drum_rotation"][-1, 0] == pytest.approx(result["paid_out"][-1, 0] / 0.5, rel=2.0e-3)
