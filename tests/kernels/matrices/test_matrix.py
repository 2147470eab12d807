"""The bordered band matrix against dense linear algebra."""

import numpy as np
import pytest

from tautline.kernels.jit import entry
from tautline.kernels.matrix import (
    add_at,
    dense,
    diagonal,
    factorise_apart,
    factorise_matrix,
    hold_row,
    new_factors,
    new_matrix,
    replace_by_identity,
    rows_of,
    size_of_row,
    sizes_of_rows,
    solve_apart,
    solve_matrix,
    sparse,
)


@entry
def _fill(matrix, full, k):
    n, size = matrix.band.shape[0], full.shape[0]
    for i in range(size):
        for j in range(size):
            if i >= n or j >= n or abs(i - j) <= k:
                add_at(matrix, i, j, full[i, j])


@entry
def _sizes(matrix, x, found):
    for row in range(found.size):
        found[row] = size_of_row(matrix, row, x)


@entry
def _hold(matrix, row):
    hold_row(matrix, row)


@entry
def _factorise_apart(factors):
    return factorise_apart(factors)


@entry
def _solve_apart(factors, x):
    solve_apart(factors, x)


def random_matrix(size, k, border, seed=3):
    """A bordered matrix, and the same in full with zeros outside its pattern."""
    full = np.random.default_rng(seed).standard_normal((size, size))
    i, j = np.indices(full.shape)
    full[(np.abs(i - j) > k) & (np.maximum(i, j) < size - border)] = 0.0
    return full


@pytest.mark.parametrize(("size", "k", "border"), [(1, 0, 0), (9, 2, 0), (9, 2, 1), (30, 4, 3), (3, 0, 2), (4, 0, 4)])
def test_a_bordered_matrix_is_solved_as_the_dense_one_is(size, k, border, monkeypatch):
    full, factors = random_matrix(size, k, border), new_factors(size, k, border)
    _fill(factors.matrix, full, k)
    assert np.array_equal(dense(factors.matrix), full)
    right = np.random.default_rng(4).standard_normal(size)
    for made in (sparse, rows_of):
        assert np.allclose(made(factors.matrix) @ right, full @ right, rtol=1e-13, atol=1e-13)
        assert np.allclose(abs(made(factors.matrix)) @ right, np.abs(full) @ right, rtol=1e-13, atol=1e-13)
    assert np.array_equal(diagonal(factors.matrix), np.diagonal(full))
    sizes = np.abs(full) @ np.abs(right)
    assert np.allclose(sizes_of_rows(factors.matrix, right), sizes, rtol=1e-13, atol=0.0)
    monkeypatch.setattr("tautline.kernels.matrix.COLUMNS", 4)
    assert np.allclose(sizes_of_rows(factors.matrix, right), sizes, rtol=1e-13, atol=0.0)
    assert factorise_matrix(factors) == 0
    for _ in range(2):
        x = right.copy()
        solve_matrix(factors, x)
        assert np.allclose(full @ x, right, rtol=0, atol=1e-10 * np.linalg.cond(full))


@pytest.mark.parametrize(("size", "k", "border"), [(1, 0, 0), (9, 2, 0), (9, 2, 1), (3, 0, 2), (4, 0, 4)])
def test_the_size_of_a_row_is_that_of_the_dense_one(size, k, border):
    full, matrix = random_matrix(size, k, border), new_matrix(size, k, border)
    _fill(matrix, full, k)
    sizes = np.random.default_rng(4).standard_normal(size)
    found = np.zeros(size)
    _sizes(matrix, sizes, found)
    assert np.allclose(found, np.abs(full) @ np.abs(sizes), rtol=1e-13)


def test_a_border_that_depends_on_the_band_is_found_singular_and_named():
    full = random_matrix(6, 1, 1)
    full[5] = full[:, 5] = 0.0
    factors = new_factors(6, 1, 1)
    _fill(factors.matrix, full, 1)
    assert factorise_matrix(factors) == 6


@pytest.mark.parametrize("row", [0, 3, 6, 7])
def test_a_row_can_be_made_that_of_the_unit_matrix(row):
    for make in (replace_by_identity, _hold):
        full, matrix = random_matrix(8, 2, 2), new_matrix(8, 2, 2)
        _fill(matrix, full, 2)
        make(matrix, row)
        full[row] = np.eye(8)[row]
        assert np.array_equal(dense(matrix), full)


@pytest.mark.parametrize(("size", "k", "border"), [(9, 2, 0), (30, 4, 3), (4, 0, 4)])
def test_what_is_called_apart_is_the_same_to_the_bit_as_what_python_calls(size, k, border):
    full, right = random_matrix(size, k, border), np.random.default_rng(4).standard_normal(size)
    found = []
    for factorise, solve in ((factorise_matrix, solve_matrix), (_factorise_apart, _solve_apart)):
        factors, x = new_factors(size, k, border), right.copy()
        _fill(factors.matrix, full, k)
        assert factorise(factors) == 0
        solve(factors, x)
        found.append(x)
    assert np.array_equal(*found)
    singular = new_factors(size, k, border)
    assert _factorise_apart(singular) == factorise_matrix(singular) != 0


@pytest.mark.parametrize("part", range(4))
def test_a_matrix_by_rows_is_a_copy_and_knows_whether_it_vanishes(part):
    matrix = new_matrix(9, 2, 2)
    assert rows_of(matrix).vanishes and rows_of(new_matrix(0, 0)).vanishes
    assert (rows_of(new_matrix(0, 0)) @ np.zeros(0)).size == 0
    matrix[part][-1, 1 if part == 0 else -1] = 2.0
    rows = rows_of(matrix)
    before = rows @ np.ones(9)
    matrix[part][:] = 0.0
    assert not rows.vanishes and np.array_equal(rows @ np.ones(9), before) and before.any()
