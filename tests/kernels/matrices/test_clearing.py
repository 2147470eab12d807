"""A band whose columns are cleared when something is first added to them is the one that is cleared before."""

from pathlib import Path

import numpy as np
import pytest

from tautline.application.installed import Installed
from tautline.integrators.state import new_state
from tautline.kernels import groups as over
from tautline.kernels.jit import entry
from tautline.kernels.matrix import AHEAD, add_at, clear, clear_as_filled, have_cleared, new_matrix

DATA = Path(__file__).parents[3] / "data"
SCENES = sorted(
    path.stem for path in DATA.glob("*.yaml") if "solver:" in path.read_text() or "GeneralizedAlpha" in path.read_text()
)
SUMS = "smooth_tangent", "switching_tangent"
LONG = """
CableModelMaterial: {{Gravity: [0, 0, -9.81]}}
CableModel:
  - Node7Dof: {{id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 0, 0, 0, 1]}}
  - Node7Dof: {{id: 1, xyz: [100, 0, 0], BC: [1, 1, 1, 0, 0, 0, {held}]}}
  - CableLine: {{id: 0, nodes7: [0, 1], elements: 201, length: 110 m, EA: 1.0e7, EJ: {bending}, rhoA: 5}}
GeneralizedAlpha: {{type: G-alpha, rho_inf: 0.6, time_step: 0.005, time_end: 0.05}}
"""
"""A cable of more elements than are cleared ahead; its last node may be free to let material pass."""


@entry
def _tangent(groups, dofs, state, matrix, as_filled):
    if as_filled == 1:
        clear_as_filled(matrix)
    else:
        clear(matrix)
    over.smooth_tangent(groups, 0.0, state.full_q, state.full_v, state.full_a, 1e4, 10.0, 1.0, matrix, dofs)
    over.switching_tangent(groups, 0.0, state.full_q, state.full_v, state.full_a, 1e4, 10.0, 1.0, matrix, dofs)
    have_cleared(matrix, matrix.band.shape[0])


@entry
def _add(matrix, row, column):
    clear_as_filled(matrix)
    add_at(matrix, row, column, 2.0)


def _soiled(system):
    """A matrix of the size of a system's, with rubbish in it."""
    matrix = new_matrix(system.size, system.bandwidth, system.border)
    for entries in (matrix.band, matrix.right, matrix.lower, matrix.corner):
        entries.fill(7.0)
    return matrix


def _agree(path):
    application, scene = Installed().read(path)
    system = application.build(scene).system
    state, groups = new_state(system), system.link(SUMS)
    before, as_filled = _soiled(system), _soiled(system)
    _tangent(groups, system.dofs, state, before, 0)
    _tangent(groups, system.dofs, state, as_filled, 1)
    assert before.band.any() and not (before.band == 7.0).any()
    for one, other in zip(before, as_filled, strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("name", SCENES)
def test_a_tangent_is_the_same_where_columns_are_cleared_as_they_are_filled(name):
    _agree(DATA / f"{name}.yaml")


@pytest.mark.parametrize("held", [1, 0])
@pytest.mark.parametrize("bending", [0.0, 10.0])
def test_the_tangent_of_a_long_cable_is_the_same_where_columns_are_cleared_as_they_are_filled(tmp_path, held, bending):
    (tmp_path / "long.yaml").write_text(LONG.format(held=held, bending=bending))
    _agree(tmp_path / "long.yaml")


def test_the_tangent_of_a_long_string_is_the_same_where_columns_are_cleared_as_they_are_filled(tmp_path):
    path = tmp_path / "string.yaml"
    path.write_text((DATA / "jwell.yaml").read_text().replace("elements: 12", "elements: 150"))
    assert "elements: 150" in path.read_text()
    _agree(path)


@pytest.mark.parametrize(("row", "column"), [(0, 0), (3, 5), (500, 499), (999, 999)])
def test_no_more_is_cleared_than_is_asked_for_and_a_little_ahead(row, column):
    matrix = new_matrix(1000, 3)
    matrix.band.fill(7.0)
    _add(matrix, row, column)
    reached = min(1000, column + 1 + AHEAD)
    assert matrix.cleared[0] == reached
    assert matrix.band[column, 3 + row - column] == 2.0 and np.count_nonzero(matrix.band[:reached]) == 1
    assert np.all(matrix.band[reached:] == 7.0)
