"""LAPACK's banded LU called from compiled code, against numpy's dense one."""

import numpy as np
import pytest

from tautline.kernels.lapack import band_of, factorise, solve


def banded(rng, n, kl, ku):
    matrix = np.triu(np.tril(rng.standard_normal((n, n)), ku), -kl)
    band = band_of(n, kl, ku)
    for j in range(n):
        for i in range(max(0, j - ku), min(n, j + kl + 1)):
            band[j, kl + ku + i - j] = matrix[i, j]
    return matrix, band


def scratch(n):
    return np.zeros(n, np.int32), np.zeros(8, np.int32)


SIZES = [(1, 0, 0), (7, 0, 0), (9, 2, 2), (25, 3, 1), (25, 0, 4), (12, 11, 11), (66, 11, 11)]


@pytest.mark.parametrize(("n", "kl", "ku"), SIZES)
@pytest.mark.parametrize("seed", [1, 2])
def test_it_solves_as_numpy_does(n, kl, ku, seed):
    rng = np.random.default_rng(seed)
    matrix, band = banded(rng, n, kl, ku)
    right = rng.standard_normal((2, n))
    pivots, integers = scratch(n)
    assert factorise(band, pivots, n, kl, ku, integers) == 0
    for b in right:
        x = b.copy()
        solve(band, pivots, n, kl, ku, integers, x)
        expected = np.linalg.solve(matrix, b)
        assert np.abs(x - expected).max() < 1e-13 * np.linalg.cond(matrix) * np.abs(expected).max()


def test_a_zero_on_the_diagonal_is_pivoted_away():
    """Rows of multipliers have no diagonal."""
    rng = np.random.default_rng(3)
    matrix, band = banded(rng, 10, 2, 2)
    for i in (0, 4, 9):
        matrix[i, i] = band[i, 4] = 0.0
    pivots, integers = scratch(10)
    assert factorise(band, pivots, 10, 2, 2, integers) == 0
    x = np.ones(10)
    solve(band, pivots, 10, 2, 2, integers, x)
    assert np.allclose(matrix @ x, 1.0, rtol=0, atol=1e-11)


def test_a_matrix_with_two_equal_rows_is_singular():
    """Small whole numbers: the elimination is exact, and so is the zero."""
    matrix = np.diag([2.0, 1.0, 4.0, 1.0]) + np.diag([0.0, 1.0, 0.0], 1) + np.diag([0.0, 1.0, 0.0], -1)
    matrix[1:3, 1:3] = 1.0
    band = band_of(4, 1, 1)
    for j in range(4):
        for i in range(max(0, j - 1), min(4, j + 2)):
            band[j, 2 + i - j] = matrix[i, j]
    pivots, integers = scratch(4)
    assert factorise(band, pivots, 4, 1, 1, integers) == 3


def test_an_empty_column_is_named():
    _, band = banded(np.random.default_rng(5), 8, 1, 1)
    band[3] = 0.0
    pivots, integers = scratch(8)
    assert factorise(band, pivots, 8, 1, 1, integers) == 4
