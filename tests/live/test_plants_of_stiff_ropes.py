"""Linear models of ropes so stiff that the rounding of their forces is large beside what small steps change.

A slew about the vertical of a load that hangs at rest changes no tension to first order: it turns all of the scene.
"""

from pathlib import Path

import numpy as np
import pytest

import tautline

SLEWING = (Path(__file__).parents[2] / "data" / "slewing.yaml").read_text(encoding="utf8")
OUTPUTS = ["winch.tension", "max_tension", "min_tension"]


def standing(stiffness):
    """The crane with its rope of a stiffness, N, at rest with the boom slewed."""
    text = SLEWING.replace("axial_stiffness: 4.0e7", f"axial_stiffness: {stiffness:g}")
    assert text != SLEWING
    return tautline.Simulation(
        tautline.read(text), inputs=["boom.slew"], keep=False, initial={"winch.pay_out_speed": 0.0, "boom.slew": 0.3}
    )


@pytest.mark.parametrize("stiffness", [4.0e8, 4.0e9])
def test_a_slew_of_a_hanging_load_changes_no_tension_of_a_stiff_rope_in_the_linear_model(stiffness):
    sim = standing(stiffness)
    plant = sim.linearise(["boom.slew"], OUTPUTS)
    share = 1e-4 * sim["winch.tension"]  # N of N per rad
    assert np.abs(plant.D).max() < share
    assert np.abs(plant.response([0.05, 0.13, 1.0, 2.0])).max() < share


def test_the_largest_tension_of_a_stiff_rope_answers_as_that_of_the_place_where_it_is():
    sim = standing(4.0e9)
    tensions = np.asarray(sim["tension"])
    at = np.unravel_index(int(np.argmax(tensions)), tensions.shape)
    place = f"tension[{','.join(map(str, at))}]"
    plant = sim.linearise(["boom.slew"], ["max_tension", place])
    assert np.abs(plant.C[0] - plant.C[1]).max() < 1e-9 * np.abs(plant.C).max()
