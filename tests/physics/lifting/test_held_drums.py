"""A drum that its brake or its friction holds is as stiff as one that does not turn.

References: the bounce of a load on the rope below, 2 pi sqrt(M L0 / EA) with a third of the rope's mass in M; the snap
of a load that falls freely into its rope, T = m g + sqrt((m g)^2 + 2 k m g h) by energy; and runs whose drum is at rest
by its drive, without any brake.
"""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, body, crane, drum, end, hoist, parsed, ran, solved

import tautline
from crane.assembly.estimates import estimate
from crane.assembly.layout import lay_out
from crane.assembly.mesh_damping import damping_of
from crane.warnings import warnings

STIFFNESS, WEIGHT = 8.0e7, 6.5
RADIUS, LENGTH, MASS = 1.2, 4.0, 20.0e3
HELD = {
    "brake": {"torque": 0.0, "inertia": 500.0, "brake": {"torque": 2.0e6}},
    "friction": {"torque": RADIUS * MASS * GRAVITY, "inertia": 500.0, "friction_torque": 1.0e5},
}
AT_REST = {"pay_out": 0.0}


def hanging(drive, mass=MASS, length=LENGTH, order=1, radius=RADIUS, elements=4, rope=None, load=None, **more):
    """A load plumb below a drum at the first or, with order -1, at the last end of the rope."""
    path = [drum((0.0, 0.0, 0.0), radius, **drive), end("load")][::order]
    placed = {"velocity": [0.0, 0.0, 0.05], "guide": ["x", "y"]} | (load or {})
    bodies = [body("load", mass, (order * radius, 0.0, -length), **{k: x for k, x in placed.items() if x is not None})]
    rope = {"mass_per_length": WEIGHT, "axial_stiffness": STIFFNESS, "strain": "engineering", "damping": 0.0} | (
        rope or {}
    )
    return crane(path, bodies, rope, mesh={"elements_per_span": elements}, **more)


def period(result, of=None):
    """Of the load's bounce, s, from the upward crossings of its height, or of another course."""
    time, z = result["time"], result["body_position"][:, 0, 2] if of is None else of
    z = z - z.mean()
    k = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
    return np.diff(time[k] - z[k] * (time[k + 1] - time[k]) / (z[k + 1] - z[k])).mean()


@pytest.mark.parametrize("how", HELD)
@pytest.mark.parametrize("solver", [{"step": 5.0e-4}, {"step": "auto", "method": "rk4", "rho_inf": None}])
def test_a_load_below_a_held_drum_bounces_on_the_rope_alone(how, solver):
    # R = 1.2 m of rope more, as which a held drum gave way, makes it 14 % longer
    scene = solved(hanging(HELD[how], interval=2.0e-3), end=1.0, **solver)
    mass, unstretched = MASS + WEIGHT * LENGTH / 3.0, LENGTH / (1.0 + MASS * GRAVITY / STIFFNESS)
    assert period(ran(scene)) == pytest.approx(2.0 * np.pi * np.sqrt(mass * unstretched / STIFFNESS), rel=1.0e-3)


MOMENT = {"time": [0.0, 0.5005, 0.501, 0.5015], "value": [1.0, 1.0, 0.0, 1.0], "interpolation": "linear"}
BOUNCES = {
    "held by its brake": (HELD["brake"], 0.0),
    "held by its friction": ({"torque": 0.0, "inertia": 500.0, "friction_torque": 2.0e6}, 0.0),
    "whose motor is on beside its friction": (HELD["friction"], RADIUS**2 / 500.0),
    "free": ({"torque": RADIUS * MASS * GRAVITY, "inertia": 5.0e3}, RADIUS**2 / 5.0e3),
    "free, with 500 m of rope on it": (
        {"torque": RADIUS * MASS * GRAVITY, "inertia": 5.0e3, "rope_on_drum": 500.0},
        1.0 / (5.0e3 / RADIUS**2 + 500.0 * WEIGHT),
    ),
    "whose brake opens": ({**HELD["brake"], "brake": {"torque": 2.0e6, "until": 0.5}}, RADIUS**2 / 500.0),
    "whose brake is too weak": ({**HELD["brake"], "brake": {"torque": 1.0e5}}, RADIUS**2 / 500.0),
    "whose brake holds half as much again": (
        {**HELD["brake"], "brake": {"torque": 1.5 * RADIUS * MASS * GRAVITY}},
        RADIUS**2 / 500.0,
    ),
    "whose brake opens for a moment": (
        {**HELD["brake"], "brake": {"torque": 2.0e6, "closed": {"table": MOMENT}}},
        RADIUS**2 / 500.0,
    ),
    "whose motor heaves for a moment": (
        {**HELD["brake"], "torque": {"table": MOMENT | {"value": [0.0, 0.0, 2.0e6, 0.0]}}},
        RADIUS**2 / 500.0,
    ),
}


@pytest.mark.parametrize("how", BOUNCES)
def test_check_reckons_a_bounce_with_the_mass_of_a_drum_and_its_rope_unless_it_is_held(how):
    drive, mobility = BOUNCES[how]
    mass = MASS + WEIGHT * LENGTH / 3.0
    expected = np.sqrt(STIFFNESS / LENGTH * (1.0 / mass + mobility)) / (2.0 * np.pi)
    assert estimate(parsed(hanging(drive))).frequency == pytest.approx(expected, rel=1.0e-9)


@pytest.mark.parametrize("how", BOUNCES)
def test_damping_that_is_not_given_goes_by_the_inertia_of_a_drum_whatever_holds_it_and_for_how_long(how):
    """1 % of critical of the bounce with a drum that turns: a brake that opens after the run has no part in it."""
    drive = BOUNCES[how][0]
    mass = MASS + WEIGHT * LENGTH / 3.0
    omega = np.sqrt(STIFFNESS / LENGTH * (1.0 / mass + RADIUS**2 / drive["inertia"]))
    for end_of_run in (0.2, 1.0, 50.0):
        scene = parsed(solved(hanging(drive, elements=1, rope={"damping": None}), end=end_of_run))
        assert damping_of(scene, lay_out(scene).path) == pytest.approx([0.02 / omega], rel=1.0e-9)


def test_check_warns_of_frames_by_the_bounce_with_a_drum_that_friction_beside_its_motor_may_not_hold():
    """In waves such a drum turns by 2 rad, however little the load at rest leaves its friction of 500 N m to hold."""
    drive = {"torque": 24.0e3, "inertia": 200.0, "rope_on_drum": 100.0, "friction_torque": 500.0}
    wave = {"heave": {"harmonic": {"amplitude": 0.5, "period": 8.0, "ramp": 1.0}}}
    vessel = {"reference": [0.0, 0.0, -10.0], "motion": wave}
    found = warnings(parsed(hoist(drive=drive, vessel=vessel, interval=0.05)))
    assert any("keeps fewer than 4 frames in a natural period" in text for text in map(str, found))


@pytest.mark.parametrize("how", ["held by its brake", "free", "free, with 500 m of rope on it"])
def test_the_bounce_that_check_reckons_is_that_of_the_run(how):
    scene = solved(hanging(BOUNCES[how][0], interval=1.0e-3), end=1.0, step=5.0e-4)
    result = ran(scene)
    # the load itself goes down with a drum that is free
    assert period(result, result["tension"][:, 0, 1]) == pytest.approx(
        1.0 / estimate(parsed(scene)).frequency, rel=5.0e-3
    )


def test_a_load_that_falls_into_a_rope_held_by_a_brake_snaps_as_hard_as_below_a_drum_at_rest():
    light, rope, height = 2.0e3, 4.3, 0.3
    more = {"start": "as drawn", "rope": {"length": rope, "damping": 1.0e-5}, "mass": light, "load": {"velocity": None}}
    solver = {"step": 5.0e-4, "end": 0.5}
    found = [ran(hanging(how, elements=1, solver=solver, interval=5.0e-4, **more)) for how in (HELD["brake"], AT_REST)]
    held, at_rest = (float(one["tension"].max()) for one in found)
    assert held == pytest.approx(at_rest, rel=1.0e-3)
    pull, spring = light * GRAVITY, STIFFNESS / rope
    assert held == pytest.approx(pull + np.sqrt(pull**2 + 2.0 * spring * pull * height), rel=0.01)


@pytest.mark.parametrize("method", ["generalized-alpha", "rk4"])
def test_the_energy_of_a_brake_that_opens_and_closes_again_balances(method):
    closed = {"table": {"time": [0.0, 0.3, 0.31, 0.5, 0.51, 1.0], "value": [1.0, 1.0, 0.0, 0.0, 0.6, 0.6]}}
    drive = HELD["brake"] | {"brake": {"torque": 4.0e5, "closed": closed}}
    of = {} if method == "generalized-alpha" else {"method": "rk4", "step": "auto", "rho_inf": None}
    found = ran(solved(hanging(drive, rope={"damping": 1.0e-4}), end=1.0, **of))
    # it falls for 0.2 s with I/R^2 beside the mass, and 0.6 of the torque stop it
    least = 0.5 * GRAVITY * MASS / (MASS + 500.0 / RADIUS**2) * 0.2**2
    assert least < float(found["paid_out"][-1, 0]) < 20.0 * least


@pytest.mark.parametrize("control", [{}, {"control": "error", "step_error": 1.0e-5}])
def test_kilometres_of_rope_before_a_held_drum_cost_no_more_steps_than_behind_it(control):
    # p is 3000 m at a drum at the rope's end, and 0 at one at its beginning: a last digit of it is a newton of brake
    closed = {"table": {"time": [0.0, 0.1, 0.2, 0.4, 0.5, 1.0], "value": [1.0, 1.0, 0.0, 0.0, 1.0, 1.0]}}
    drive = {"torque": 0.0, "inertia": 500.0, "brake": {"torque": 1.0e7, "closed": closed}}
    rope = {"axial_stiffness": 1.0e9, "damping": 1.0e-3}
    one, other = (
        ran(solved(hanging(drive, order=order, length=3000.0, radius=0.3, rope=rope), step=1.0e-2, **control), 0.02)
        for order in (1, -1)
    )
    assert other.attributes["steps"] <= 1.1 * one.attributes["steps"]
    assert other["tension"].max() == pytest.approx(one["tension"].max(), rel=1.0e-6)


def test_a_braked_drum_steps_live_and_goes_on_from_a_file_as_it_runs_at_once(tmp_path):
    closed = {"table": {"time": [0.0, 0.2, 0.21, 0.3, 0.31, 1.0], "value": [1.0, 1.0, 0.0, 0.0, 0.6, 0.6]}}
    drive = HELD["brake"] | {"brake": {"torque": 4.0e5, "closed": closed}}
    scene = parsed(hanging(drive, rope={"damping": 1.0e-4}, solver={"end": 0.6}, order=-1))
    whole = tautline.simulate(scene)
    sim = tautline.Simulation(scene)
    for time in whole["time"][1:31]:
        sim.advance_to(float(time))
    state = sim.save()
    for time in whole["time"][31:]:
        sim.advance_to(float(time))
    assert np.array_equal(sim.result["tension"], whole["tension"])
    sim.restore(state)
    sim.advance_to(0.6)
    assert sim.result["tension"][-1] == pytest.approx(whole["tension"][-1], rel=1.0e-12)
