"""Factors by blocks: the solution is that of the matrix, or they are refused."""

import numpy as np
import pytest

from tautline.kernels.matrix import NO_NODES, factorise_matrix, new_factors, solve_matrix
from tautline.kernels.node_blocks import ROWS
from tautline.system.pattern import Pattern

REFUSED, TAKEN = 0, 1


def block_tridiagonal(sizes, rng, spread=0.0):
    """A random matrix with blocks of these sizes, rows and columns scaled over decades, and its starts."""
    starts = np.concatenate(([0], np.cumsum(sizes)))
    full = np.zeros((starts[-1], starts[-1]))
    for i, first in enumerate(starts[:-1]):
        last = starts[min(i + 2, len(sizes))]
        own = starts[i + 1]
        full[first:own, first:last] = rng.uniform(-1.0, 1.0, (own - first, last - first))
        full[first:last, first:own] = rng.uniform(-1.0, 1.0, (last - first, own - first))
    full += 6.0 * np.eye(starts[-1])
    scale = 10.0 ** rng.uniform(-spread, spread, starts[-1])
    return scale[:, None] * full * scale, starts


def factorised(full, starts, border=0):
    n = full.shape[0]
    banded = full[: n - border, : n - border]
    rows, columns = np.nonzero(banded)
    k = int(np.abs(rows - columns).max())
    factors = new_factors(n, k, border, nodes=starts)
    matrix = factors.matrix
    for i, j in zip(rows, columns, strict=True):
        matrix.band[j, 2 * k + i - j] = full[i, j]
    if border:
        matrix.right[:] = full[: n - border, n - border :].T
        matrix.lower[:] = full[n - border :, : n - border]
        matrix.corner[:] = full[n - border :, n - border :].T
    assert factorise_matrix(factors) == 0
    return factors


def solved(factors, right):
    x = right.copy()
    solve_matrix(factors, x)
    return x


@pytest.mark.parametrize(
    "sizes", [(6,) * 7, (3, 6, 6, 6, 3), (8, 8, 8, 8), (5, 7, 1, 8, 2, 6), (6, 6), (1, 5, 5, 5, 5, 5, 4)]
)
@pytest.mark.parametrize("spread", [0.0, 3.0])
def test_blocks_solve_what_the_matrix_says(sizes, spread):
    rng = np.random.default_rng(len(sizes))
    full, starts = block_tridiagonal(sizes, rng, spread)
    factors = factorised(full, starts)
    assert factors.nodes.taken[0] == TAKEN
    scale = np.sqrt(np.abs(np.diagonal(full)))
    for _ in range(3):
        exact = rng.uniform(-1.0, 1.0, full.shape[0]) / scale
        assert np.allclose(scale * solved(factors, full @ exact), scale * exact, rtol=0.0, atol=1e-12)


def test_a_border_goes_with_blocks():
    rng = np.random.default_rng(1)
    inner, starts = block_tridiagonal((6,) * 5, rng)
    n = inner.shape[0]
    full = np.zeros((n + 2, n + 2))
    full[:n, :n], full[:n, n:], full[n:, :n] = inner, rng.uniform(-1, 1, (n, 2)), rng.uniform(-1, 1, (2, n))
    full[n:, n:] = [[9.0, 1.0], [-1.0, 7.0]]
    factors = factorised(full, starts, border=2)
    assert factors.nodes.taken[0] == TAKEN
    exact = rng.uniform(-1.0, 1.0, n + 2)
    assert np.allclose(solved(factors, full @ exact), exact, rtol=0.0, atol=1e-12)


def test_a_zero_on_the_diagonal_is_passed_by_within_its_block():
    full, starts = block_tridiagonal((6,) * 4, np.random.default_rng(2))
    full[7, 7] = 0.0
    factors = factorised(full, starts)
    assert factors.nodes.taken[0] == TAKEN
    exact = np.linspace(-1.0, 1.0, full.shape[0])
    assert np.allclose(solved(factors, full @ exact), exact, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("small", [0.0, 1e-6])
def test_a_block_that_needs_rows_of_the_next_is_refused_and_solved_by_columns(small):
    """The first block alone is singular, or nearly: only with rows of the second can it be eliminated."""
    full, starts = block_tridiagonal((6,) * 4, np.random.default_rng(3))
    full[:6, :6] = np.ones((6, 6)) + small * np.eye(6)
    factors = factorised(full, starts)
    assert factors.nodes.taken[0] == REFUSED
    exact = np.linspace(-1.0, 1.0, full.shape[0])
    assert np.allclose(solved(factors, full @ exact), exact, rtol=0.0, atol=1e-10)


def test_factors_that_were_refused_once_are_taken_again():
    full, starts = block_tridiagonal((6,) * 4, np.random.default_rng(4))
    singular = full.copy()
    singular[:6, :6] = 1.0
    factors = factorised(singular, starts)
    k = (factors.matrix.band.shape[1] - 1) // 3
    factors.matrix.band.fill(0.0)
    for i, j in zip(*np.nonzero(full), strict=True):
        factors.matrix.band[j, 2 * k + i - j] = full[i, j]
    assert factorise_matrix(factors) == 0
    assert factors.nodes.taken[0] == TAKEN
    exact = np.linspace(-1.0, 1.0, full.shape[0])
    assert np.allclose(solved(factors, full @ exact), exact, rtol=0.0, atol=1e-12)


def _pattern(full):
    return Pattern(full.shape[0], *np.nonzero(full))


@pytest.mark.parametrize("sizes", [(3, 6, 6, 6, 3), (6,) * 9, (3, 6, 6, 6, 6, 6), (7,) * 5])
def test_a_chain_of_nodes_is_divided_into_its_nodes(sizes):
    full, starts = block_tridiagonal(sizes, np.random.default_rng(5))
    assert np.array_equal(_pattern(full).nodes(), starts)


@pytest.mark.parametrize("sizes", [(2,) * 20, (9,) * 9, (6, 6), (1,)])
def test_what_is_too_narrow_too_wide_or_too_short_has_no_blocks(sizes):
    full, _ = block_tridiagonal(sizes, np.random.default_rng(6))
    assert np.array_equal(_pattern(full).nodes(), NO_NODES)
    assert ROWS == 8


def test_parts_that_are_not_coupled_at_all_are_divided_too():
    one, _ = block_tridiagonal((6,) * 4, np.random.default_rng(7))
    n = one.shape[0]
    full = np.zeros((2 * n, 2 * n))
    full[:n, :n] = full[n:, n:] = one
    starts = _pattern(full).nodes()
    assert starts[0] == 0 and starts[-1] == 2 * n and np.diff(starts).max() <= ROWS
    factors = factorised(full, starts)
    assert factors.nodes.taken[0] == TAKEN
    exact = np.linspace(-1.0, 1.0, 2 * n)
    assert np.allclose(solved(factors, full @ exact), exact, rtol=0.0, atol=1e-12)
