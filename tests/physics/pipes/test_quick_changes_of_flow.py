"""A flow that stops within less than a step pushes the hose by all of its momentum: closed forms of the bar."""

import numpy as np
import pytest
from physics.pipes.hoses import SECTION, WATER, scene

from gardenhose.build import build
from tautline.simulation import simulate

MASS = SECTION["mass_per_length"] + WATER
SPEED = 1.0 * WATER / MASS
"""Of the whole hose just after a flow of 1 m/s has stopped, m/s: what both had is shared."""
SHUT = 0.1
FLOWS = {
    "ramp at the end of a step": {"ramp": {"from": 1.0, "to": 0.0, "at": SHUT, "over": 1e-4}},
    "ramp within a step": {"ramp": {"from": 1.0, "to": 0.0, "at": SHUT + 3e-4, "over": 1e-4}},
    "table": {"table": {"time": [0.0, SHUT, SHUT + 1e-4, 1.0], "value": [1.0, 1.0, 0.0, 0.0]}},
}


def straight(flow, **solver):
    """The tip's way along a straight hose without gravity since the flow began to stop, m, and the result."""
    hose = {"length": 0.5, "elements": 16, **SECTION, "damping": 0.0}
    given = scene(hose, {"mass_per_length": WATER, "speed": flow}, {"end": 0.13, **solver}, 1e-3, gravity=[0, 0, 0])
    result = simulate(build(given))
    time, tip = np.asarray(result["time"]), np.asarray(result["tip"])[:, 0]
    return lambda t: float(np.interp(t, time, tip) - np.interp(SHUT - 1e-3, time, tip)), result


@pytest.mark.parametrize("step", [1e-3, 1e-4])
@pytest.mark.parametrize("flow", FLOWS)
def test_a_hose_whose_flow_stops_at_once_goes_on_at_the_speed_of_the_momentum_that_the_water_had(flow, step):
    tip, result = straight(FLOWS[flow], step=step)
    # Until the wave from the clamp comes, L sqrt(m / EA) = 9.9 ms, the tip goes as a body that flies.
    speed = (tip(SHUT + 7e-3) - tip(SHUT + 3e-3)) / 4e-3
    assert speed == pytest.approx(SPEED, rel=0.03)
    # It sets off within the step in which the flow stops.
    assert SPEED * (5e-3 - 1.5 * max(step, 4e-4)) < tip(SHUT + 5e-3) < SPEED * 5e-3
    assert result.attributes["energy_error"] < 0.015


def test_the_step_is_chosen_small_where_a_flow_stops_at_once():
    tip, _ = straight(FLOWS["ramp within a step"], step="auto", end=0.112)
    # The change lasts from 0.3 to 0.4 ms: the tip sets off in the middle of that. It was not seen at all.
    assert tip(SHUT + 6e-3) == pytest.approx(SPEED * (6e-3 - 3.5e-4), rel=0.03)
