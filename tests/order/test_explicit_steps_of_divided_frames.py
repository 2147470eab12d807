"""Frames divide a step further than a scene says: it is the step taken that is stable or not, by a mass on a spring.

The reference is the stability polynomial of RK4, |R(i omega h)| <= 1 up to omega h = sqrt(8), with omega^2 = k/m.
"""

from math import sqrt

import pytest

import tautline
from tautline.cable.input.scene import parse
from tautline.integrators.status import Status, StoppedEarly

CRITICAL = sqrt(8.0) / 10.0
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


# Frames of 1.06 critical steps are divided into steps of 0.53; what is left of the run at its end may not be.
@pytest.mark.parametrize(("left", "longest"), [(1.04, 1.04), (0.6, 0.6), (0.0, 0.53)])
def test_what_is_left_of_a_run_after_its_last_whole_frame_is_judged_before_the_run_begins(left, longest):
    scene = swing(1.05 * CRITICAL, 1.06 * CRITICAL, end=(20 * 1.06 + left) * CRITICAL)
    if longest < 1.0:
        assert tautline.simulate(scene).attributes["status"] == "done"
        return
    with pytest.raises(StoppedEarly) as stop:
        tautline.simulate(scene)
    assert stop.value.status == Status.UNSTABLE and stop.value.time == 0.0
    assert f"step {longest * CRITICAL:g} s" in str(stop.value)


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


def test_an_advance_that_takes_one_step_beyond_the_critical_one_is_refused_and_names_that_step():
    sim = tautline.Simulation(swing(1.1 * CRITICAL, 1.2 * CRITICAL, end=1e3))
    for k in range(1, 201):
        sim.advance_to(k * 1.2 * CRITICAL)
    begin = sim.time
    with pytest.raises(StoppedEarly) as stop:
        sim.advance(1.05 * CRITICAL)
    assert stop.value.status == Status.UNSTABLE and sim.time == begin
    assert f"step {1.05 * CRITICAL:g} s" in str(stop.value)
    # The steps before it were good.
    assert not [one for one in stop.value.result.attributes.get("warnings", []) if "critical" in one]
