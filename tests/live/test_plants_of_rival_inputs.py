"""Inputs of a linear model that drive the same."""

from pathlib import Path

import pytest

import tautline
from tautline.live.errors import SimulationError

DATA = Path(__file__).parents[2] / "data"


@pytest.mark.parametrize("order", [1, -1])
def test_two_inputs_that_drive_the_same_are_refused_in_a_linear_model_as_in_an_fmu(order):
    sim = tautline.Simulation(DATA / "slewing.yaml", inputs=["boom.slew"], keep=False)
    with pytest.raises(SimulationError, match="drive the same; leave one of them out"):
        sim.linearise(["boom.slew", *["winch.pay_out", "winch.pay_out_speed"][::order]], ["payload.position"])
