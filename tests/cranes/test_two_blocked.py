"""Where a run ends that hoists its load into the sheave; a rope that lies slack at the winch is another matter."""

import numpy as np
import pytest
from of_the_suite import studies
from physics.lifting.crane_scenes import GRAVITY, HOISTING, body, crane, drum, end, hoist, parsed, ran, sheave, stopped

import tautline
from crane.groups.span import MET
from tautline.integrators.state import WORST
from tautline.integrators.status import Status

RADIUS = 0.4


def left(result):
    """Straight rope between the boom tip and the hook at the last frame, m."""
    place = result["body_position"][-1, 0]
    return float(np.sqrt((place[0] - 12.0) ** 2 + (place[2] - 30.0) ** 2 - RADIUS**2))


@pytest.mark.parametrize(
    ("speed", "numbers"), [(1.0, (4, 30)), (4.0, (4, 30, 120)), *studies((4.0, (4, 30, 120, 250)))]
)
def test_a_load_comes_as_near_to_its_sheave_with_any_number_of_elements(speed, numbers):
    """5 % of the radius are left at 4 to 120 elements, and at 250, within what is hoisted between two frames."""
    interval = 5.0e-3
    times = []
    for elements in numbers:
        drive = {"pay_out": {"table": {"time": [0.0, 1.0, 60.0], "value": [0.0, -speed, -speed]}}}
        far = hoist(elements=elements, drive=drive, solver={"end": 30.0 / speed}, interval=interval)
        far["bodies"][0]["position"] = (12.4, 0.0, 20.0)
        stop = stopped(far, Status.TWO_BLOCKED)
        assert MET * RADIUS - speed * interval < left(stop.result) < MET * RADIUS + 3.0 * speed * 5.0e-3
        times.append(stop.time)
    assert np.ptp(times) <= 2.0 * 5.0e-3


def test_slack_rope_at_the_winch_is_not_a_hook_that_was_hoisted_too_far():
    drive = {"pay_out": {"ramp": {"to": 15.0, "over": 1.0}}}
    stop = stopped(hoist(elements=30, drive=drive, solver={"end": 3.0}), Status.SLACK_ON_WHEEL)
    assert stop.part.startswith("winch")
    assert "pays out faster than the load can follow" in str(stop) and "hoist" not in str(stop)


@pytest.mark.parametrize("speed", [6.0, 12.0])
@pytest.mark.parametrize("stiffness", [2.0e5, 8.0e7])
def test_a_load_that_is_thrown_up_to_its_sheave_has_reached_it_however_far_its_rope_stretches(speed, stiffness):
    """By free flight 6 m/s go 1.8 m up, 1.2 m too little; a rope that is stretched by a quarter throws it on."""
    scene = hoist(drive={"pay_out": 0.0}, rope={"axial_stiffness": stiffness, "damping": 1.0e-3}, solver={"end": 3.0})
    scene["bodies"][0] |= {"position": (12.4, 0.0, 27.0), "velocity": [0.0, 0.0, speed]}
    if speed**2 / (2.0 * GRAVITY) < 3.0 and stiffness > 1.0e6:
        assert ran(scene).attributes["status"] == "done"
        return
    stop = stopped(scene, Status.TWO_BLOCKED)
    assert stop.part == "boom tip" and left(stop.result) < RADIUS
    assert 0.0 < float(stop.result["body_velocity"][-1, 0, 2])


def test_a_step_that_fails_far_from_a_sheave_is_no_two_blocking():
    sim = tautline.Simulation(parsed(hoist()))
    sim.advance_to(0.1)
    state, model = sim._state, sim.model
    assert model.end_of(state, Status.NOT_CONVERGED, 0)[0] is Status.NOT_CONVERGED


def on_a_ship(**solver):
    """A compact winch: its lead sheave is within two radii of it, and both are bolted to a vessel that rolls."""
    path = [
        drum(pay_out=HOISTING),
        sheave((0.97, 0.0, 0.0), name="lead", wrap="under", inertia=20.0, law="no_slip"),
        sheave((12.0, 0.0, 30.0), inertia=20.0, law="capstan", friction=0.1),
        end("payload"),
    ]
    motion = {
        name: {"harmonic": {"amplitude": size, "period": period, "ramp": 1.0}}
        for name, size, period in (("heave", 0.5, 8.0), ("roll", "5 deg", 9.0), ("pitch", "3 deg", 7.0))
    }
    return crane(
        path,
        [body("payload", 5000.0, (12.4, 0.0, 5.0))],
        mesh={"elements_per_span": 1},
        vessel={"reference": [0.0, 0.0, -10.0], "motion": motion},
        solver={"end": 6.0} | solver,
        interval=0.05,
    )


def test_a_step_that_fails_on_a_ship_is_no_two_blocking_of_its_winch_and_a_sheave_bolted_beside_it():
    """They come together by rounding, some 1e-17 m/s; too few iterations were allowed for the payload."""
    stop = stopped(on_a_ship(max_iterations=2, max_halvings=0), Status.NOT_CONVERGED)
    assert stop.part.startswith("payload")


def near_its_sheave(speed):
    """A simulation whose hook has less straight rope than a radius above it, and goes up at some speed, m/s."""
    scene = hoist(drive={"pay_out": 0.0})
    scene["bodies"][0] |= {"position": (12.4, 0.0, 29.7), "velocity": [0.0, 0.0, speed]}
    sim = tautline.Simulation(parsed(scene))
    sim.advance_to(0.005)
    return sim


def end_where(sim, worst):
    """What a step that failed now is called, with an unknown as the worst one."""
    sim._state.counters[WORST] = sim.model.system.names.index(worst)
    return sim.model.end_of(sim._state, Status.NOT_CONVERGED, int(sim._state.counters[WORST]))[0]


def test_a_hook_that_reaches_its_sheave_is_not_blamed_for_a_step_that_failed_elsewhere():
    sim = near_its_sheave(12.0)
    assert end_where(sim, "payload: z") is Status.TWO_BLOCKED
    assert end_where(sim, "rope winch to boom tip, node 2: z") is Status.NOT_CONVERGED


def test_a_hook_that_vibrates_near_its_sheave_has_not_reached_it():
    assert end_where(near_its_sheave(0.5), "payload: z") is Status.NOT_CONVERGED
