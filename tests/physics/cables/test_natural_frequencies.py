"""Small vibrations of the stepped string of Table 2.3, linearised, against tests/references/stepped_rod_modes.py."""

import numpy as np
import pytest
from physics.wells.strings import Balance, shipped
from references import stepped_rod_modes as exact
from scipy.linalg import eigh

from tautline.integrators.linearise import matrices

ELEMENTS = (25, 50, 100, 200)
"""Multiples of 25: pipe and collar, 880 m and 120 m, then both have elements of the same length."""
KINDS = {"axial": ("along the hole", exact.axial), "torsional": ("rotation", exact.torsional)}


@pytest.fixture(scope="module")
def errors():
    """Relative errors of the first three frequencies: kind -> (refinements, 3)."""
    found = {kind: [] for kind in KINDS}
    for n in ELEMENTS:
        balance = Balance(shipped("hanging", model__elements=n))
        mass, _, stiffness = matrices(balance.model.system, balance.state)
        for kind, (direction, reference) in KINDS.items():
            rows = balance.rows(direction)
            assert rows.size == n
            block = np.ix_(rows, rows)
            omega = np.sqrt(eigh(stiffness[block], mass[block], eigvals_only=True)[:3])
            found[kind].append(omega / (2 * np.pi * reference(exact.TABLE_2_3, 3)) - 1)
    return {kind: np.array(rows) for kind, rows in found.items()}


@pytest.mark.parametrize("mode", [1, 2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_natural_frequencies_of_the_stepped_string_converge_at_second_order(errors, kind, mode):
    # exact: roots of the transcendental frequency equation; measured orders 1.9995 to 2.0000
    sizes = np.abs(errors[kind][:, mode - 1])
    order = -np.polyfit(np.log(ELEMENTS), np.log(sizes), 1)[0]
    assert order == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("kind", KINDS)
def test_first_frequency_of_50_elements_is_right_to_a_part_in_twenty_thousand(errors, kind):
    assert abs(errors[kind][1, 0]) < 5e-5


def test_axial_and_torsional_motion_do_not_couple_in_a_vertical_hole():
    balance = Balance(shipped("hanging", model__elements=25))
    along, about = balance.rows("along the hole"), balance.rows("rotation")
    for matrix in matrices(balance.model.system, balance.state):
        assert np.abs(matrix[np.ix_(along, about)]).max() == 0.0
        assert np.abs(matrix[np.ix_(about, along)]).max() == 0.0
