"""LU factors of a band that exchange few rows, against numpy's dense ones."""

import numpy as np
import pytest

from tautline.kernels.factors.band import BOLD, CAREFUL
from tautline.kernels.factors.lapack import factorise_dense, solve_dense
from tautline.kernels.matrix import (
    EXCHANGED,
    Matrix,
    factorise_matrix,
    new_factors,
    renew_matrix,
    solve_matrix,
    solve_rows,
)


def banded(rng, n, kl, ku):
    """A random matrix (n, n) of some sub- and superdiagonals."""
    return np.triu(np.tril(rng.standard_normal((n, n)), ku), -kl)


def factors_of(matrix, k, threshold=CAREFUL):
    """Room for the factors, with the matrix in it."""
    n = len(matrix)
    factors = new_factors(n, k, threshold=threshold)
    for j in range(n):
        for i in range(max(0, j - k), min(n, j + k + 1)):
            factors.matrix.band[j, k + i - j] = matrix[i, j]
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
    factors = factors_of(matrix, k, BOLD)
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


def chain(rng, n, k, share=0.4):
    """A matrix whose inverse fades away from the diagonal, as that of a time step of a chain of lumps."""
    i, j = np.indices((n, n))
    return np.where(abs(i - j) <= k, share / k * rng.uniform(-1.0, 1.0, (n, n)), 0.0) + np.diag(
        rng.uniform(1.0, 9.0, n)
    )


CHANGES = [(0, 3), (1, 2), (150, 154), (148, 171), (296, 300), (0, 300)]


@pytest.mark.parametrize(("first", "last"), CHANGES)
@pytest.mark.parametrize("stiffness", [1e-3, 1e6])
def test_factors_renewed_where_the_matrix_changes_are_those_of_the_whole_and_no_more_are_made(first, last, stiffness):
    rng = np.random.default_rng(first + last)
    n, k = 300, 5
    before = chain(rng, n, k)
    after = before.copy()
    after[first:last, first:last] = chain(rng, last - first, k) * stiffness
    factors, whole = factors_of(before, k, BOLD), factors_of(after, k, BOLD)
    assert factorise_matrix(factors) == 0 and factorise_matrix(whole) == 0
    factors.matrix.band[...] = whole.matrix.band
    made = renew_matrix(factors, first, last)
    assert last - first <= made <= min(n, last - first + 16 * k)
    entries, expected = factors.lu[:, k:], whole.lu[:, k:]
    assert np.allclose(entries, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
    assert np.allclose(factors.inverse, whole.inverse, rtol=1e-13, atol=0)
    b = rng.standard_normal(n)
    x = b.copy()
    solve_matrix(factors, x)
    assert np.allclose(after @ x, b, rtol=0, atol=1e-9 if stiffness > 1.0 else 1e-12)


def test_factors_are_not_renewed_where_a_row_has_to_be_or_was_exchanged():
    rng = np.random.default_rng(9)
    before = chain(rng, 60, 3)
    after = before.copy()
    after[30, 30] = 0.0
    factors = factors_of(before, 3)
    assert factorise_matrix(factors) == 0
    factors.matrix.band[...] = factors_of(after, 3).matrix.band
    assert renew_matrix(factors, 30, 31) == -1
    factors = factors_of(after, 3)
    assert factorise_matrix(factors) == 0 and factors.integers[EXCHANGED] > 0
    factors.matrix.band[...] = factors_of(before, 3).matrix.band
    assert renew_matrix(factors, 32, 33) == -1
    factors.matrix.band[...] = factors_of(after, 3).matrix.band
    assert renew_matrix(factors, 50, 51) > 0


@pytest.mark.parametrize(("first", "last"), [(0, 40), (130, 170), (260, 300), (0, 300)])
def test_solving_for_a_part_of_the_rows_leaves_an_error_at_its_edges_only(first, last):
    rng = np.random.default_rng(7)
    n, k = 300, 5
    matrix = chain(rng, n, k)
    factors = factors_of(matrix, k, BOLD)
    assert factorise_matrix(factors) == 0
    middle = slice((first + last) // 2 - 1, (first + last) // 2 + 1)
    b = np.zeros(n)
    b[middle] = 1.0
    x = np.full(n, 7.0)
    x[first:last] = b[first:last]
    solve_rows(factors, x, first, last)
    whole = np.linalg.solve(matrix, b)
    assert np.allclose(x[middle], whole[middle], rtol=1e-6, atol=0)
    taken = np.zeros(n)
    taken[first:last] = x[first:last]
    left = np.abs(matrix @ taken - b)
    inner = slice(first + k if first > 0 else 0, last - k if last < n else n)
    assert left[inner].max() < 1e-14
    assert left.max() < 1e-3 if last - first < n else left.max() < 1e-14


def test_exchanged_rows_of_a_border_are_counted_from_one_compiled_or_not():
    """A run that goes on takes over the factors of the run before, which may have been made the other way."""
    exchanged, integers = np.zeros(2, np.int32), np.zeros(16, np.int32)
    swapped, x = np.array([[0.0, 1.0], [1.0, 0.0]]), np.array([3.0, 5.0])
    assert factorise_dense(swapped, exchanged, 2, integers) == 0
    assert exchanged.tolist() == [2, 2]
    solve_dense(swapped, exchanged, 2, integers, x)
    assert x.tolist() == [5.0, 3.0]
