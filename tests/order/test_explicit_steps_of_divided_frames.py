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
GeneralizedAlpha: {{type: RK4, time_step: {step}, time_end: 8, plotpoints: {frames}}}
"""


def swing(step, interval):
    return parse(SWING.format(step=step, frames=1.0 / interval))


def test_a_step_that_frames_divide_to_a_stable_one_runs_and_no_warning_says_otherwise():
    scene = swing(1.02 * CRITICAL, 1.06 * CRITICAL)
    assert not [one for one in scene.warnings if "critical" in str(one)]
    result = tautline.simulate(scene)
    assert result.attributes["status"] == "done" and result.time[-1] == pytest.approx(8.0)


def test_a_step_that_frames_leave_beyond_the_critical_one_is_refused():
    with pytest.raises(StoppedEarly) as stop:
        tautline.simulate(swing(1.02 * CRITICAL, 1.02 * CRITICAL))
    assert stop.value.status == Status.UNSTABLE and stop.value.time == 0.0
