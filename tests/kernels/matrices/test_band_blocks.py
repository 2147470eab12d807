"""Factors in blocks of four unknowns against dense linear algebra and against substitution row by row."""

import numpy as np
import pytest

from tautline.integrators.corrector.single_precision import LEFT, doubt, solve_for
from tautline.kernels import matrix
from tautline.kernels.factors.band import BOLD
from tautline.kernels.jit import entry
from tautline.kernels.matrix import (
    DOUBTED,
    IN_BLOCKS,
    MAY_BE_SINGLE,
    PACKED,
    SINGLE,
    factorise_matrix,
    new_factors,
    renew_matrix,
    solve_matrix,
    solve_rows,
)

BANDS = [(5, 4), (12, 4), (48, 10), (49, 10), (50, 7), (51, 11), (203, 12)]


def _band(n, k, seed=0):
    """A band with a large diagonal, in which no row is exchanged; some of its entries are zero."""
    rng = np.random.default_rng([n, k, seed])
    full = rng.standard_normal((n, n)) * (rng.random((n, n)) < 0.7)
    i, j = np.indices(full.shape)
    full[np.abs(i - j) > k] = 0.0
    return full + np.diag(3.0 * k + rng.random(n))


def _write(full, matrix, k):
    for j in range(len(full)):
        for i in range(max(0, j - k), min(len(full), j + k + 1)):
            matrix.band[j, k + i - j] = full[i, j]


def _solved(factors, b):
    x = b.copy()
    solve_matrix(factors, x)
    return x


@pytest.mark.parametrize(("n", "k"), BANDS)
def test_what_is_solved_with_again_is_solved_in_blocks_and_is_the_same(n, k):
    full, factors = _band(n, k), new_factors(n, k, threshold=BOLD)
    _write(full, factors.matrix, k)
    assert factorise_matrix(factors) == 0
    b = np.random.default_rng(1).standard_normal(n)
    by_rows = _solved(factors, b)
    assert factors.integers[PACKED] != IN_BLOCKS
    by_blocks = _solved(factors, b)
    assert factors.integers[PACKED] == IN_BLOCKS
    np.testing.assert_allclose(by_blocks, by_rows, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(full @ by_blocks, b, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize(("n", "k"), BANDS[2:])
def test_blocks_are_renewed_with_the_factors(n, k):
    full, factors = _band(n, k), new_factors(n, k, threshold=BOLD)
    _write(full, factors.matrix, k)
    factorise_matrix(factors)
    b = np.random.default_rng(2).standard_normal(n)
    _solved(factors, b), _solved(factors, b)
    first, last = n // 3, n // 3 + 6
    full[first:last, first:last] *= 1.3
    _write(full, factors.matrix, k)
    assert renew_matrix(factors, first, last) > 0
    np.testing.assert_allclose(full @ _solved(factors, b), b, rtol=0.0, atol=1e-13)


def test_a_part_of_the_rows_is_solved_in_blocks_as_row_by_row():
    n, k, first, last = 203, 12, 60, 124
    full, b = _band(n, k), np.random.default_rng(3).standard_normal(n)
    b[:first] = b[last:] = 0.0
    found = []
    for times in (0, 2):
        factors = new_factors(n, k, threshold=BOLD)
        _write(full, factors.matrix, k)
        factorise_matrix(factors)
        for _ in range(times):
            _solved(factors, b)
        x = b.copy()
        solve_rows(factors, x, first, last)
        found.append(x[first:last])
    np.testing.assert_allclose(found[1], found[0], rtol=0.0, atol=1e-15)


def test_factors_with_exchanged_rows_are_never_put_into_blocks():
    n, k = 40, 6
    full = _band(n, k)
    full[np.arange(0, n, 5), np.arange(0, n, 5)] = 1e-9
    factors = new_factors(n, k)
    _write(full, factors.matrix, k)
    assert factorise_matrix(factors) == 0
    b = np.random.default_rng(4).standard_normal(n)
    for _ in range(3):
        np.testing.assert_allclose(full @ _solved(factors, b), b, rtol=0.0, atol=1e-7)
    assert factors.integers[PACKED] < IN_BLOCKS


def test_factors_are_put_into_blocks_before_their_first_use_only_where_those_before_them_were_used_often():
    n, k = 203, 12
    full, factors = _band(n, k), new_factors(n, k, threshold=BOLD)
    b = np.random.default_rng(5).standard_normal(n)
    # Uses of one after the other, and whether the first of the next finds blocks.
    for uses, packed in ((3, True), (2, False), (1, False), (4, True)):
        _write(full, factors.matrix, k)
        factorise_matrix(factors)
        for _ in range(uses):
            np.testing.assert_allclose(full @ _solved(factors, b), b, rtol=0.0, atol=1e-13)
        _write(full, factors.matrix, k)
        factorise_matrix(factors)
        np.testing.assert_allclose(full @ _solved(factors, b), b, rtol=0.0, atol=1e-13)
        assert (factors.integers[PACKED] >= IN_BLOCKS) == packed


@pytest.mark.parametrize(("n", "k"), [*BANDS, (1, 4), (3, 6), (61, 6), (64, 8), (65, 9), (100, 23), (77, 5)])
def test_elimination_in_blocks_solves_as_dense_algebra_and_leaves_the_band_as_it_was(n, k):
    full, factors = _band(n, k), new_factors(n, k)
    _write(full, factors.matrix, k)
    before = factors.matrix.band.copy()
    assert factorise_matrix(factors) == 0
    assert factors.integers[PACKED] >= IN_BLOCKS
    assert np.array_equal(factors.matrix.band, before)
    b = np.random.default_rng(6).standard_normal(n)
    np.testing.assert_allclose(full @ _solved(factors, b), b, rtol=0.0, atol=1e-13)


def _free_beam(free):
    """A beam that nearly nothing holds, stiff along and soft across, as strings are, and turned; and its bandwidth.

    An inverse of a pivot has few digits right.
    """
    n, k = 800, 11
    bend = np.diff(np.eye(n // 4), n=2, axis=0)
    along = np.diff(np.eye(n // 4), axis=0)
    full = np.zeros((n, n))
    for c, parts in enumerate((1e3 * along.T @ along, bend.T @ bend, bend.T @ bend, along.T @ along)):
        full[c::4, c::4] = parts + free * np.eye(n // 4)
    turn = np.linalg.qr(np.random.default_rng(9).standard_normal((n // 4, 4, 4)))[0]
    for i in range(0, n, 4):
        full[i : i + 4] = turn[i // 4] @ full[i : i + 4]
        full[:, i : i + 4] = full[:, i : i + 4] @ turn[i // 4].T
    return full, k


@pytest.mark.parametrize("free", [1e-2, 1e-4, 1e-6])
def test_of_a_beam_that_nearly_nothing_holds_the_equations_are_solved_to_rounding(free):
    full, k = _free_beam(free)
    n = len(full)
    factors = new_factors(n, k)
    _write(full, factors.matrix, k)
    assert factorise_matrix(factors) == 0
    assert factors.integers[PACKED] >= IN_BLOCKS
    b = np.random.default_rng(8).standard_normal(n)
    x = _solved(factors, b)
    assert np.max(np.abs(full @ x - b) / (np.abs(full) @ np.abs(x) + np.abs(b))) < 1e-12


def test_a_block_without_entries_is_left_out_and_a_part_of_the_rows_is_solved_alone():
    n, k, first, last = 96, 12, 32, 64
    full = _band(n, k)
    full[:, :first][first:] = full[:first, first:] = 0.0
    full[:last, last:] = full[last:, :last] = 0.0
    factors = new_factors(n, k)
    _write(full, factors.matrix, k)
    assert factorise_matrix(factors) == 0
    b = np.random.default_rng(7).standard_normal(n)
    np.testing.assert_allclose(full @ _solved(factors, b), b, rtol=0.0, atol=1e-13)
    x = b.copy()
    solve_rows(factors, x, first, last)
    inner = slice(first, last)
    np.testing.assert_allclose(full[inner, inner] @ x[inner], b[inner], rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("broken", ["pivot", "below", "beside", "singular"])
def test_where_a_row_has_to_be_exchanged_elimination_in_blocks_leaves_it_to_that_by_rows(broken):
    n, k, at = 60, 10, 28
    full = _band(n, k)
    if broken == "pivot":
        full[at, at] = 1e-12  # scaled to one: its column outgrows it
    elif broken == "below":
        full[at + 2, at] = 1e4 * full[at, at]
    elif broken == "beside":
        full[at + 6, at] = 1e5 * full[at, at]
    else:
        full[at] = 0.0
    factors = new_factors(n, k)
    _write(full, factors.matrix, k)
    row = factorise_matrix(factors)
    if broken == "singular":
        assert row > 0
        return
    assert row == 0
    assert factors.integers[PACKED] < IN_BLOCKS
    b = np.random.default_rng(8).standard_normal(n)
    np.testing.assert_allclose(_solved(factors, b), np.linalg.solve(full, b), rtol=1e-9, atol=1e-12)


@entry
def _solve_for(factors, x, right_side, doubtful):
    if doubtful:
        doubt(factors)
    solve_for(factors, x, right_side)


def _rounded(full, k, monkeypatch):
    """Factors of single precision; made, as those of few unknowns never are."""
    with monkeypatch.context() as few:
        few.setattr(matrix, "MANY", 1)
        factors = new_factors(len(full), k, improved=True)
    _write(full, factors.matrix, k)
    assert factorise_matrix(factors) == 0
    return factors


@pytest.mark.parametrize(("n", "k"), [(48, 10), (203, 12), (6, 6), (100, 23)])
def test_rounded_blocks_give_seven_digits_and_improve_what_is_left_to_the_last(n, k, monkeypatch):
    full = _band(n, k)
    factors = _rounded(full, k, monkeypatch)
    assert (factors.integers[SINGLE], factors.integers[PACKED]) == (1, IN_BLOCKS)
    assert not np.any(factors.blocks)
    b = np.random.default_rng(5).standard_normal(n)
    x = _solved(factors, b)
    left = [np.abs(full @ x - b).max()]
    for _ in range(3):
        x -= _solved(factors, full @ x - b)
        left.append(np.abs(full @ x - b).max())
    assert 1e-10 < left[0] < 1e-6
    assert left[-1] < 1e-14


@pytest.mark.parametrize("free", [1.0, 1e-6])
@pytest.mark.parametrize("doubtful", [False, True])
def test_single_precision_that_are_doubted_are_kept_where_they_serve_and_made_double_where_not(
    free, doubtful, monkeypatch
):
    full, k = _free_beam(free)
    factors, exact = _rounded(full, k, monkeypatch), new_factors(len(full), k)
    _write(full, exact.matrix, k)
    factorise_matrix(exact)
    b = np.random.default_rng(8).standard_normal(len(full))
    x, kept = b.copy(), b.copy()
    _solve_for(factors, x, kept, doubtful)
    assert np.array_equal(kept, b)
    left = np.abs(exact.scale * (full @ x - b)).max() / np.abs(exact.scale * b).max()
    stays = free == 1.0 or not doubtful
    assert (factors.integers[SINGLE], factors.integers[MAY_BE_SINGLE]) == (int(stays), int(stays))
    assert (left <= LEFT) == (free == 1.0 or doubtful)
    if not stays:
        assert np.array_equal(x, _solved(exact, b))
    # What was found to serve, or made anew, is not tested again.
    assert factors.integers[DOUBTED] == 0


def test_few_factors_and_those_of_a_border_or_of_one_solution_are_not_rounded(monkeypatch):
    assert new_factors(600, 11, improved=True).singles.size == 0
    monkeypatch.setattr(matrix, "MANY", 1)
    assert new_factors(600, 11, improved=True).singles.size > 0
    for factors in (
        new_factors(600, 11), new_factors(600, 11, 1, improved=True), new_factors(600, 3, improved=True),
        new_factors(600, 11, threshold=BOLD, improved=True),
    ):  # fmt: skip
        assert factors.singles.size == 0
        assert factors.integers[MAY_BE_SINGLE] == 0
