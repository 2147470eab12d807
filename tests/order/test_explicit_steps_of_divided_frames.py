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
