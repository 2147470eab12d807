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


@pytest.mark.parametrize(
    ("inputs", "outputs", "name"),
    [
        (["winch.pay_out_speed"] * 2, ["payload.position"], "inputs: winch.pay_out_speed"),
        (["boom.slew", "winch.pay_out", "boom.slew"], ["payload.position"], "inputs: boom.slew"),
        (["boom.slew"], ["winch.tension", "winch.tension"], "outputs: winch.tension"),
        (["boom.slew"], ["payload.position", "payload.position[2]"], r"outputs: payload.position\[2\]"),
    ],
)
def test_what_is_given_twice_to_a_linear_model_is_refused_with_its_name(inputs, outputs, name):
    sim = tautline.Simulation(DATA / "slewing.yaml", inputs=["boom.slew"], keep=False)
    with pytest.raises(SimulationError, match=f"{name} stands 2 times; give each once"):
        sim.linearise(inputs, outputs)
