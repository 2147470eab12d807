"""A plant without inputs or outputs answers with arrays that have none."""

from pathlib import Path

import numpy as np
import pytest

import tautline

DATA = Path(__file__).parents[2] / "data"


@pytest.fixture(scope="module")
def sim():
    return tautline.Simulation(DATA / "slewing.yaml", keep=False)


@pytest.mark.parametrize(
    ("inputs", "outputs", "shape"),
    [(["winch.pay_out_speed"], [], (0, 1)), ([], ["payload.position"], (3, 0)), ([], [], (0, 0))],
)
def test_responses_of_a_plant_without_inputs_or_outputs_have_none(sim, inputs, outputs, shape):
    plant = sim.linearise(inputs, outputs)
    for frequencies, count in ((0.1, 1), ([0.1, 0.2], 2), (np.zeros(0), 0)):
        assert plant.response(frequencies).shape == (count, *shape)
    system = plant.to_scipy()
    assert (system.C.shape[0], system.B.shape[1]) == shape and len(plant.eigenvalues) == len(plant.A)
