"""What a scene says its mass matrix couples holds every entry of it: explicit methods order the unknowns by that."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from crane.model.build import build
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import new_state
from tautline.kernels.matrix import dense, new_matrix
from tautline.system.system import number_by_mass

DATA = Path(__file__).parents[3] / "data"
TURNING = {"inertia": (1000.0, 2000.0, 2500.0)}


@pytest.mark.parametrize("changes", [{}, TURNING], ids=["a point", "a body that turns"])
@pytest.mark.parametrize("name", ["hoist", "hookblock", "slewing"])
def test_no_entry_of_the_mass_matrix_lies_outside_its_pattern(name, changes):
    scene = tautline.read(DATA / f"{name}.yaml")
    bodies = (scene.bodies[0].model_copy(update=changes), *scene.bodies[1:])
    system = build(scene.model_copy(update={"bodies": bodies})).system
    state = new_state(system)
    state.q[:] += 1e-3 * np.random.default_rng(1).standard_normal(system.size)
    matrix = new_matrix(system.size, system.bandwidth, system.border)
    evaluate(system, state, 0.0, 1e-4, False, 1.0, 0.0, 0.0, matrix, np.zeros(system.size))
    mass, pattern = dense(matrix), system.mass_pattern.toarray() != 0
    assert not np.any(mass[~pattern])
    # And some of those that may be there are.
    assert np.count_nonzero(mass) > system.size
    numbering = number_by_mass(system)
    i, j = np.nonzero(mass[np.ix_(numbering.order, numbering.order)])
    inner = np.maximum(i, j) < system.size - numbering.border
    assert np.abs(i - j)[inner].max() <= numbering.bandwidth
