"""LU factors of a band that exchange few rows, against numpy's dense ones."""

import numpy as np
import pytest

from tautline.kernels.matrix import Matrix, factorise_matrix, new_factors, solve_matrix


def banded(rng, n, kl, ku):
    """A random matrix (n, n) of some sub- and superdiagonals."""
    return np.triu(np.tril(rng.standard_normal((n, n)), ku), -kl)


def factors_of(matrix, k):
    """Room for the factors, with the matrix in it."""
    n = len(matrix)
    factors = new_factors(n, k)
    for j in range(n):
        for i in range(max(0, j - k), min(n, j + k + 1)):
            factors.matrix.band[j, 2 * k + i - j] = matrix[i, j]
    return factors


SIZES = [(1, 0, 0), (7, 0, 0), (9, 2, 2), (25, 3, 1), (25, 0, 4), (12, 11, 11), (66, 11, 11), (200, 5, 5)]


@pytest.mark.parametrize(("n", "kl", "ku"), SIZES)
@pytest.mark.parametrize("seed", [1, 2])
def test_it_solves_as_numpy_does(n, kl, ku, seed):
    rng = np.random.default_rng(seed)
    matrix = banded(rng, n, kl, ku)
    right = rng.standard_normal((2, n))
    factors = factors_of(matrix, max(kl, ku))
    assert factorise_matrix(factors) == 0
    for b in right:
        x = b.copy()
        solve_matrix(factors, x)
        expected = np.linalg.solve(matrix, b)
        assert np.abs(x - expected).max() < 1e-12 * np.linalg.cond(matrix) * np.abs(expected).max()


def test_a_ragged_band_is_worked_on_within_its_envelope_only():
    """Blocks of six in a chain, as nodes of cubic elements are: no exchange, and no factor outside the blocks."""
    rng = np.random.default_rng(4)
    n, k = 60, 11
    i, j = np.indices((n, n))
    matrix = np.where(abs(i // 6 - j // 6) <= 1, 0.1 * rng.standard_normal((n, n)), 0.0) + 3.0 * np.eye(n)
    factors = factors_of(matrix, k)
    assert factorise_matrix(factors) == 0
    assert np.array_equal(factors.pivots, np.arange(1, n + 1))
    block = np.arange(n) // 6
    assert np.array_equal(factors.below, np.minimum(6 * block + 11, n - 1) - np.arange(n))
    assert np.array_equal(factors.above, np.arange(n) - np.maximum(6 * block - 6, 0))
    x = np.ones(n)
    solve_matrix(factors, x)
    assert np.allclose(matrix @ x, 1.0, rtol=0, atol=1e-14)


def test_a_small_pivot_is_exchanged_and_a_moderate_one_is_not():
    matrix = np.array([[1.0, 4.0, 0.0], [4.0, 1.0, 1.0], [0.0, 1.0, 1.0]])
    factors = factors_of(matrix, 1)
    assert factorise_matrix(factors) == 0
    assert factors.pivots.tolist() == [1, 2, 3]
    matrix[0, 0], matrix[1, 0], matrix[0, 1] = 1.0, 40.0, 40.0
    factors = factors_of(matrix, 1)
    assert factorise_matrix(factors) == 0
    assert factors.pivots[0] == 2
    x = np.array([1.0, 2.0, 3.0])
    solve_matrix(factors, x)
    assert np.allclose(matrix @ x, [1.0, 2.0, 3.0], rtol=0, atol=1e-12)


def test_a_zero_on_the_diagonal_is_pivoted_away():
    """Rows of multipliers have no diagonal."""
    matrix = banded(np.random.default_rng(3), 10, 2, 2)
    for i in (0, 4, 9):
        matrix[i, i] = 0.0
    factors = factors_of(matrix, 2)
    assert factorise_matrix(factors) == 0
    x = np.ones(10)
    solve_matrix(factors, x)
    assert np.allclose(matrix @ x, 1.0, rtol=0, atol=1e-11)


def test_a_matrix_with_two_equal_rows_is_singular():
    """Small whole numbers and a diagonal of powers of four: the elimination is exact, and so is the zero."""
    matrix = np.diag([4.0, 1.0, 4.0, 1.0])
    matrix[1:3, 1:3] = 1.0
    factors = factors_of(matrix, 1)
    assert factorise_matrix(factors) == 3


def test_an_empty_column_is_named():
    matrix = banded(np.random.default_rng(5), 8, 1, 1)
    matrix[:, 3] = 0.0
    assert factorise_matrix(factors_of(matrix, 1)) == 4


def test_nothing_to_factorise_is_done_at_once():
    factors = new_factors(0, 0)
    assert isinstance(factors.matrix, Matrix)
    assert factorise_matrix(factors) == 0
