"""Where a run ends that hoists its load into the sheave; a rope that lies slack at the winch is another matter."""

import numpy as np
import pytest
from of_the_suite import studies
from physics.lifting.crane_scenes import hoist, stopped

from crane.groups.span import MET
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
