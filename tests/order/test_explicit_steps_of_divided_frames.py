"""Frames divide a step further than a scene says: it is the step taken that is stable or not, by a mass on a spring.

The reference is the stability polynomial of RK4, |R(i omega h)| <= 1 up to omega h = sqrt(8), with omega^2 = k/m.
"""

from math import sqrt

import pytest

import tautline
from tautline.cable.input.scene import parse
from tautline.integrators.schedule import frame_times
from tautline.integrators.status import Status, StoppedEarly
from tautline.live.errors import SimulationError

CRITICAL = sqrt(8.0) / 10.0
LOOKED_FOR = 2.8 / 10.0
"""The same as the thesis rounds it, eq. 2.170, which is what steps are compared with."""
SWING = """
title: A mass on a spring of 100 N/m, 10 rad/s
CableModelMaterial: {{Gravity: [0, 0, 0]}}
CableModel:
  - Node4Dof: {{id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}}
  - Node4Dof: {{id: 1, xyz: [1, 0, 0], BC: [0, 1, 1, 1]}}
  - CableALEelementLin: {{id: 0, nodes4: [0, 1], EA: 100, rhoA: 0, strain: engineering}}
  - PointMass: {{id: 0, nodes4: [1], mass: 1}}
  - PointForce: {{id: 0, nodes4: [1], force: [1, 0, 0]}}
GeneralizedAlpha: {{type: RK4, time_step: {step}, time_end: {end}, plotpoints: {frames}}}
"""


def swing(step, interval, end=8.0):
    return parse(SWING.format(step=step, frames=1.0 / interval, end=end))


def test_a_step_that_frames_divide_to_a_stable_one_runs():
    result = tautline.simulate(swing(1.02 * CRITICAL, 1.06 * CRITICAL))
    assert result.attributes["status"] == "done" and result.time[-1] == pytest.approx(8.0)


def test_a_step_that_frames_leave_beyond_the_critical_one_is_refused():
    with pytest.raises(StoppedEarly) as stop:
        tautline.simulate(swing(1.02 * CRITICAL, 1.02 * CRITICAL))
    assert stop.value.status == Status.UNSTABLE and stop.value.time == 0.0


# Frames of 1.06 critical steps are divided into steps of 0.53: 1.04 that are left are as well, not done in one step.
@pytest.mark.parametrize(("left", "more"), [(1.04, 2), (0.6, 2), (0.5, 1), (0.0, 0)])
def test_what_is_left_of_a_run_after_its_last_whole_frame_takes_no_longer_steps_than_frames_do(left, more):
    scene = swing(1.05 * CRITICAL, 1.06 * CRITICAL, end=(20 * 1.06 + left) * CRITICAL)
    result = tautline.simulate(scene)
    frames = [1.06 * CRITICAL * k for k in range(21)] + [scene.solver.end] * bool(more)
    assert result.time.tolist() == pytest.approx(frames)
    assert result.attributes["status"] == "done" and result.attributes["steps"] == 40 + more
    # So does a simulation that is stepped, to the bit; and in several advances, and a run that is gone on with.
    sim = tautline.Simulation(scene)
    sim.advance_to(scene.solver.end)
    assert (sim.result["position"][:] == result["position"][:]).all()
    sim = tautline.Simulation(scene)
    sim.advance_to(13.3 * CRITICAL)
    begun = sim.result
    sim.advance_to(scene.solver.end)
    on = tautline.simulate(scene, resume=begun)
    for one in (sim.result, on):
        assert one["position"][-1, 1, 0] == pytest.approx(result["position"][-1, 1, 0], abs=2e-4)
        assert one.attributes["status"] == "done"


@pytest.mark.parametrize(("end", "count"), [(0.4, [1]), (0.9, [1]), (0.95, [2]), (1.06, [2]), (1.96, [2, 2])])
def test_a_run_that_is_shorter_than_a_frame_takes_the_steps_that_are_given(end, count):
    ends, steps = frame_times(end, 1.06, 0.9)
    assert steps.tolist() == count and ends[-1] == end


def test_what_is_left_of_a_run_and_shorter_than_a_step_makes_no_step_longer():
    result = tautline.simulate(swing(0.6 * CRITICAL, 0.6 * CRITICAL, end=24.3 * CRITICAL))
    assert result.attributes["status"] == "done"


def test_a_simulation_that_is_stepped_is_judged_by_the_steps_that_its_advances_take():
    sim = tautline.Simulation(swing(1.1 * CRITICAL, 1.2 * CRITICAL))
    for k in range(1, 200):
        sim.advance_to(k * 1.2 * CRITICAL)
    for _ in range(100):
        sim.advance(0.9 * CRITICAL)
    # A steady force of 1 N swings the mass about 1 cm, from 0 to 2 cm: RK4 damps it, and never beyond.
    moved = sim.result["position"][:, 1, 0] - 1.0
    assert -1e-9 < moved.min() and moved.max() < 0.02 and sim.result.attributes["status"] == "done"
    assert not [one for one in sim.result.attributes.get("warnings", []) if "critical" in one]


@pytest.mark.parametrize("driven", [0, 200])
def test_an_advance_by_steps_beyond_the_critical_one_is_refused_and_the_simulation_goes_on(driven):
    sim, other = (tautline.Simulation(swing(1.1 * CRITICAL, 1.2 * CRITICAL, end=1e3)) for _ in range(2))
    for k in range(1, driven + 1):
        sim.advance_to(k * 1.2 * CRITICAL)
        other.advance_to(k * 1.2 * CRITICAL)
    begin = sim.time
    for _ in range(3):
        # It was an end for good: UNSTABLE, though no step of it had been taken.
        with pytest.raises(SimulationError) as refused:
            sim.advance(1.05 * CRITICAL)
        assert sim.time == begin and not sim.stopped
    said = str(refused.value)
    assert f"divided into steps of up to {1.05 * CRITICAL:.6g} s" in said and f"is {LOOKED_FOR:.4g} s" in said
    most = float(said.split("advance by ")[1].split(" s")[0])
    assert 0.99 * LOOKED_FOR < most <= LOOKED_FOR
    for one in (sim, other):
        one.advance(most)
        for _ in range(150):
            one.advance(0.5 * most)
    assert sim["node 1.position"].tolist() == other["node 1.position"].tolist()
    result = sim.result.attributes
    assert not sim.stopped and result["status"] == other.result.attributes["status"] != "unstable"
    assert not [one for one in result.get("warnings", []) if "critical" in one]


def test_an_advance_whose_last_part_alone_is_beyond_the_critical_step_is_refused_before_it_begins():
    # Frames are 1.2 critical steps apart, in steps of 0.6; after the last of them 1.05 are left.
    sim = tautline.Simulation(swing(1.1 * CRITICAL, 1.2 * CRITICAL, end=1e3))
    with pytest.raises(SimulationError, match="critical step of rk4"):
        sim.advance_to((10 * 1.2 + 1.05) * CRITICAL)
    assert sim.time == 0.0
    sim.advance_to((10 * 1.2 + 0.95) * CRITICAL)


def test_looks_at_a_given_step_are_as_many_steps_apart_as_are_taken_not_as_the_scene_gives():
    sim = tautline.Simulation(swing(0.9 * CRITICAL, 0.9 * CRITICAL, end=1e3))
    step = 0.003 * CRITICAL
    sim.advance_to(step)
    # At least a frame apart, which is 300 steps here; it was 100 steps of the scene, 30,000 of those that are taken.
    assert sim._checked.explicit.due <= sim.time + 301 * step
