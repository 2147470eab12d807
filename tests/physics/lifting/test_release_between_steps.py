"""A load drops when the scene says, wherever that lies between the ends of steps and frames.

Reference: a load m on a drum of inertia I and radius R, whose torque m g R holds it. Of the load m' remains, and it
rises with a = (m - m') g / (m' + I/R^2) from the time of the release on: z = a (t - at)^2 / 2 (Newton, by hand).
"""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, body, crane, drum, end, fall, ran, sheave, solved

import tautline
from tautline import run as running
from tautline.run import Run

MASS, LEFT, INERTIA, RADIUS, END = 5000.0, 2500.0, 400.0, 0.4, 5.0
RISE = (MASS - LEFT) * GRAVITY / (LEFT + INERTIA / RADIUS**2)
ROPE = {"mass_per_length": 1.0e-3, "axial_stiffness": 2.0e8, "damping": 2.0e-3, "strain": "engineering"}


def rising(at, step, interval=0.1, until=END, method="generalized-alpha"):
    """The load of the reference on 80 m of stiff rope."""
    load = body("load", MASS, (10.2, 0.0, -60.0), release={"at": at, "remaining": LEFT})
    path = [
        drum((0.0, 0.0, 10.0), RADIUS, torque=MASS * GRAVITY * RADIUS, inertia=INERTIA),
        sheave((10.0, 0.0, 20.0), 0.2, name="tip"),
        end("load"),
    ]
    solver = {"step": step, "end": until, "method": method}
    return crane(path, [load], ROPE, mesh={"elements_per_span": 1}, interval=interval, solver=solver)


def off(result, at):
    """By how much the load is above its closed form at the end, m."""
    last = result["time"][-1]
    return result["body_position"][-1, 0, 2] + 60.0 - 0.5 * RISE * (last - at) ** 2


@pytest.mark.parametrize("step", ["auto", 0.05, 0.02])
def test_a_load_rises_from_the_time_of_its_release_and_not_from_the_step_nearest_to_it(step):
    # Both were alike to the last digit, 0.348 m and 0.013 m off with frames of 100 ms.
    found = [off(ran(rising(at, step)), at) for at in (2.026, 2.049, 2.0500001)]
    assert np.abs(found).max() < 2.0e-3  # the rope, relieved, is 5.8 mm shorter
    assert np.ptp(found) < 1.0e-4


def test_momentum_and_work_of_a_release_between_steps_are_those_of_its_time():
    result = ran(rising(2.029, 0.02, 0.02))
    late = result["time"] > 2.5
    slope, begin = np.polyfit(result["time"][late], result["body_velocity"][late, 0, 2], 1)
    assert slope == pytest.approx(RISE, rel=1.0e-3) and -begin / slope == pytest.approx(2.029, abs=2.0e-3)
    assert result.attributes["energy_error"] < 1.0e-3
    # What leaves takes m g z along; the motor gives its torque times the turn.
    way = result["body_position"][-1, 0, 2] + 60.0
    lost = -(MASS - LEFT) * GRAVITY * -60.0
    assert result["external_work"][-1] == pytest.approx(lost + MASS * GRAVITY * way, rel=2.0e-3)


@pytest.mark.parametrize("until", [2.0, 2.017, 2.02])
def test_a_run_that_ended_about_a_release_is_gone_on_with_to_the_bit(until):
    # ended at the very time of the release it differed by 95 N
    scene = rising(2.017, 5.0e-3, 0.02, 3.0)
    whole = ran(scene)
    part = ran(solved(scene, end=until))
    rest = tautline.simulate(scene, resume=part)
    both = np.isin(rest["time"].round(9), whole["time"].round(9))
    assert both.sum() == whole["time"].size
    for name in ("tension", "body_position", "body_velocity"):
        np.testing.assert_array_equal(rest[name][both], whole[name])


@pytest.mark.parametrize("method", ["generalized-alpha", "rk4"])
def test_a_run_with_a_release_is_the_same_to_the_bit_wherever_it_pauses(method, monkeypatch):
    solver = {"method": method, "step": 2.0e-4, "end": 0.04}
    load = {"release": {"at": 0.01237, "remaining": 1000.0}}
    scene = fall(2000.0, 30.0, 1, load, rope={"axial_stiffness": 4.0e7}, solver=solver, interval=0.01)
    whole = ran(scene)
    monkeypatch.setattr(Run, "_allow", lambda run, done, spent: None)
    for work in (1, 7):
        monkeypatch.setattr(running, "FIRST_WORK", work)
        paused = ran(scene)
        for name in ("tension", "body_position", "external_work"):
            np.testing.assert_array_equal(paused[name], whole[name])
        assert paused.attributes["steps"] == whole.attributes["steps"]


def test_a_release_between_steps_costs_one_step_more_in_its_frame_and_none_in_others():
    def steps(at):
        load = {"release": {"at": at, "remaining": 1900.0}}
        solver = {"step": 1.0e-3, "end": 0.1, "control": "fixed"}
        return ran(fall(2000.0, 30.0, 1, load, solver=solver, interval=0.02)).attributes["steps"]

    assert [steps(at) for at in (0.05, 0.0503, 0.2)] == [100, 101, 100]


def test_a_live_simulation_drops_its_load_at_the_time_of_its_release_wherever_advances_end():
    scene = rising(2.026, 0.02, 0.1, 3.0)
    for ends in ((3.0,), (2.0, 2.031, 3.0), (2.026, 3.0)):
        sim = tautline.Simulation(scene)
        for time in ends:
            sim.advance_to(time)
        assert abs(off(sim.result, 2.026)) < 4.0e-3  # the load bounces on its rope; half a step is 0.1 m
