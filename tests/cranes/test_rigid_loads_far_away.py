"""A rigid load costs as many iterations far from the origin of the drawing as near it."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import body, crane, drum, end, ran, sheave

MASS = 500.0


def hoisted(x):
    """A hook of 500 kg on a rope of 2 m, of which 1 m is hoisted in: its socket is a hundred times as stiff as 1 m."""
    hook = body("hook", MASS, (x + 0.4, 0.0, 27.0), inertia=[150.0, 170.0, 100.0])
    path = [
        drum((x - 12.0, 0.0, 0.0), pay_out={"ramp": {"to": -2.0, "over": 0.2}}),
        sheave((x, 0.0, 30.0)),
        end("hook", name="eye", offset=(0.1, 0.05, 1.0)),
    ]
    return crane(path, [hook], mesh={"elements_per_span": 2}, solver={"end": 0.6})


@pytest.mark.parametrize("x", [1.0e2, 1.0e3, 1.0e4])
def test_a_rigid_load_far_from_the_origin_takes_the_iterations_of_the_same_load_near_it(x):
    """As a difference of two positions the gap of its socket would have their rounding, 1.4e-14 m at x = 100 m.

    Times 8e9 N/m, a hundred times a metre of rope, that is 1.1e-4 N, and the tolerance is 1e-8 m g = 4.9e-5 N.
    """
    near, far = ran(hoisted(12.0)), ran(hoisted(x))
    assert far.attributes["halvings"] == 0 and far.attributes["steps"] == near.attributes["steps"]
    assert far.attributes["newton_iterations"] < 1.1 * near.attributes["newton_iterations"]
    tension = near["tension"]
    assert np.abs(far["tension"] - tension).max() < 1.0e-4 * tension.max()
