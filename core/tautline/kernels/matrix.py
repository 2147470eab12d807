"""The matrix of a scene: a band, with a border of rows and columns for the few unknowns that many others depend on.

One velocity at which a thousand elements of rope flow would fill a band from end to end. Such unknowns are numbered
last; the band is factorised without them, and they are solved for by their Schur complement.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import as_strided

from tautline.kernels.factors.band import (
    CAREFUL,
    NARROW,
    eliminate,
    equilibrate,
    find_envelope,
    renew,
    substitute,
    substitute_between,
)
from tautline.kernels.factors.band_blocks import pack, room_for_blocks, solve_by_blocks
from tautline.kernels.factors.block_elimination import factorise_in_blocks, room_for_window
from tautline.kernels.factors.lapack import factorise_dense_inside, solve_dense_inside
from tautline.kernels.jit import entry, kernel
from tautline.kernels.lanes import LANES
from tautline.kernels.memory import form_of
from tautline.kernels.separate import Code, apart, code_of, separate

EXCHANGED, PACKED, REACH, MAY_BE_SINGLE, SINGLE, DOUBTED = range(7, 13)
"""Places among the ``integers`` of factors: how many rows of the band were exchanged; what is known of the blocks
(`FRESH` and so on), and how many of them stand beside each other; whether they may be rounded to single precision,
whether they are, and whether it is doubted that they serve so."""
FRESH, TRIED, IN_BLOCKS, AGAIN = range(4)
"""Factors that nothing was solved with yet; once, or that are expected to be used often; those that are packed; and
those that were used since."""
MANY = 2**19
"""Numbers of blocks from which they are rounded: 4 MB of doubles, which no core has at hand."""
AHEAD = 64
"""Columns that are cleared ahead of those that something is added to."""
COLUMNS = 2048
"""Of a band that are looked at together."""


class Matrix(NamedTuple):
    """A matrix of n banded and m border unknowns.

    ``band`` (n, 2 k + 1) with entry (i, j) at ``band[j, k + i - j]``; ``right[j]`` (m, n) the border's columns;
    ``lower[i]`` (m, n) its rows; ``corner`` (m, m) with entry (i, j) at ``corner[j, i]``. ``cleared`` (1,) counts the
    columns of the band that stand as they are; those behind them hold what was, and count as zero (`clear_as_filled`).
    """

    band: np.ndarray
    right: np.ndarray
    lower: np.ndarray
    corner: np.ndarray
    cleared: np.ndarray


MATRIX = form_of(Matrix(*(np.zeros((0, 0)) for _ in range(4)), np.zeros(1, np.int64)))
"""The form of :class:`Matrix`."""
VECTOR = form_of(np.zeros(0))
"""That of a vector."""


class Factors(NamedTuple):
    """A matrix, room for its factors, and the scratch for it. The band stays as it is, the border does not.

    ``lu`` (n, 3 k + 1) is room for the band's factors by rows, with k places more for what exchanges of rows fill.
    ``columns[j]`` (m, n) is the band's inverse times the border's column j. ``above`` and ``below`` (n,) say how far
    from the diagonal a column of the band's factors goes, ``right`` (n,) is the last column that a row reaches, and
    ``inverse`` (n,) is one over their diagonal. ``scale`` (n,) has made the diagonal of the band one: slopes and
    positions are of one size then, and rows are seldom exchanged, which would fill the band: only where a pivot is
    below ``threshold`` of its column's largest entry. ``column`` (2 k + 1,) is scratch. ``blocks`` are the band's
    factors once more, as they are quickest to solve with (band_blocks.py). With a ``window``, which is scratch, they
    are made so from the start, if no row has to be exchanged (block_elimination.py). ``singles`` are the blocks in
    single precision, in place of the others where these are many and whoever solves improves the solution.
    """

    matrix: Matrix
    lu: np.ndarray
    pivots: np.ndarray
    corner_pivots: np.ndarray
    columns: np.ndarray
    above: np.ndarray
    below: np.ndarray
    right: np.ndarray
    inverse: np.ndarray
    scale: np.ndarray
    integers: np.ndarray
    column: np.ndarray
    threshold: float
    blocks: np.ndarray
    window: np.ndarray
    singles: np.ndarray


def new_matrix(size: int, bandwidth: int, border: int = 0) -> Matrix:
    """Zero matrix of ``size`` unknowns, the last ``border`` of which are no part of the band."""
    n = size - border
    return Matrix(
        np.zeros((n, 2 * bandwidth + 1)), np.zeros((border, n)), np.zeros((border, n)), np.zeros((border, border)),
        np.array([n], np.int64),
    )  # fmt: skip


def new_factors(
    size: int, bandwidth: int, border: int = 0, threshold: float = CAREFUL, improved: bool = False
) -> Factors:
    """Zero matrix with room for its factors.

    Where whoever solves finds what a solution leaves, and solves for it again (``improved``), blocks of which there
    are `MANY` are rounded to single precision: they are read from memory once for each solution.
    """
    in_blocks = threshold == CAREFUL and bandwidth > NARROW
    blocks = room_for_blocks(size - border, bandwidth) if bandwidth > NARROW else 0
    rounded = improved and in_blocks and border == 0 and blocks >= MANY
    integers = np.zeros(13, np.int32)
    integers[MAY_BE_SINGLE] = int(rounded)
    return Factors(
        # The system gives memory where something is written: for factors by rows only to who makes them.
        new_matrix(size, bandwidth, border), np.zeros((size - border, 3 * bandwidth + 1)),
        np.zeros(size - border, np.int32), np.zeros(border, np.int32),
        np.zeros((border, size - border)), *(np.zeros(size - border, np.int32) for _ in range(3)),
        np.zeros(size - border), np.zeros(size - border), integers, np.zeros(2 * bandwidth + 1), threshold,
        np.zeros(blocks),
        # What is renewed in part, or whose pivots are counted, is eliminated row by row.
        np.zeros(room_for_window(bandwidth) if in_blocks else 0),
        np.zeros(blocks if rounded else 0, np.float32),
    )  # fmt: skip


FACTORS = form_of(new_factors(0, 0))
"""The form of :class:`Factors`."""


def cut(factors: Factors, first: int, last: int) -> Factors:
    """Rows and columns ``first`` to ``last`` - 1 of a matrix without a border, as one of its own in the same memory."""
    band, none = factors.matrix.band[first:last], np.zeros((0, last - first))
    each = {
        name: getattr(factors, name)[first:last]
        for name in ("lu", "pivots", "above", "below", "right", "inverse", "scale")
    }
    own = {
        "matrix": Matrix(band, none, none, np.zeros((0, 0)), np.array([last - first], np.int64)), "columns": none,
        "blocks": np.zeros(0), "window": np.zeros(0), "singles": np.zeros(0, np.float32),
    }  # fmt: skip
    return factors._replace(**own, **each)


@kernel
def clear(matrix):
    """Set all entries to zero."""
    clear_as_filled(matrix)
    have_cleared(matrix, matrix.band.shape[0])


@separate(type(None), MATRIX)
def clear_as_filled(matrix):
    """Set all entries to zero, columns of the band when something is first added to them, or by `have_cleared`.

    A large band does not stay at hand from clearing to filling: to bring it twice takes a third of the time of both.
    """
    matrix.cleared[0] = 0
    matrix.right.fill(0.0)
    matrix.lower.fill(0.0)
    matrix.corner.fill(0.0)


@kernel(forceinline=True)
def have_cleared(matrix, columns):
    """Have as many columns of the band be cleared: what adds to a column sees to that first."""
    if columns > matrix.cleared[0]:
        _clear_up_to(matrix, columns)


@separate(type(None), MATRIX, int)
def _clear_up_to(matrix, columns):
    """Clear the next columns, a few more than are asked for."""
    first, last = matrix.cleared[0], min(matrix.band.shape[0], columns + AHEAD)
    matrix.band[first:last].fill(0.0)
    matrix.cleared[0] = last


@kernel
def _copy(source, target):
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@kernel
def copy_columns(source, target, first, last):
    """Write columns ``first`` to ``last`` - 1 of a band over those of another."""
    for i in range(first, last):
        for j in range(source.band.shape[1]):
            target.band[i, j] = source.band[i, j]


@kernel
def add_columns(source, target, first, last):
    """Add columns ``first`` to ``last`` - 1 of a band to those of another."""
    for i in range(first, last):
        for j in range(source.band.shape[1]):
            target.band[i, j] += source.band[i, j]


@kernel
def clear_columns(matrix, first, last):
    """Set columns ``first`` to ``last`` - 1 of a band to zero."""
    for i in range(first, last):
        for j in range(matrix.band.shape[1]):
            matrix.band[i, j] = 0.0


@separate(type(None), MATRIX, MATRIX)
def copy_matrix(source, target):
    """Write one matrix over another of its shape."""
    _copy(source.band, target.band)
    _copy(source.right, target.right)
    _copy(source.lower, target.lower)
    _copy(source.corner, target.corner)


@kernel
def add_at(matrix, row, column, x):
    """Add x to an entry."""
    n = matrix.band.shape[0]
    if row < n and column < n:
        have_cleared(matrix, column + 1)
        matrix.band[column, matrix.band.shape[1] // 2 + row - column] += x
    elif row < n:
        matrix.right[column - n, row] += x
    elif column < n:
        matrix.lower[row - n, column] += x
    else:
        matrix.corner[column - n, row - n] += x


@separate(type(None), FACTORS, int, int, late=True)
def _pack(f, first, last):
    """Make blocks ``first`` to ``last`` - 1 of the band's factors."""
    n, k = f.matrix.band.shape[0], f.matrix.band.shape[1] // 2
    f.integers[REACH] = pack(f.lu, f.above, f.below, f.inverse, f.scale, f.blocks, n, k, first, last, f.integers[REACH])


@kernel(forceinline=True)
def _substitute(f, n, k, x):
    """Solve by the band's factors: row by row what is solved with once, in blocks what is solved with again."""
    if k > NARROW and f.blocks.size > 0 and f.integers[EXCHANGED] == 0:
        count = (n + LANES - 1) // LANES
        if f.integers[PACKED] == TRIED:
            f.integers[REACH] = 1
            _pack(f, 0, count)
        f.integers[PACKED] = min(f.integers[PACKED] + 1, AGAIN)
        if f.integers[PACKED] >= IN_BLOCKS:
            if f.integers[SINGLE] == 1:
                _solve_by_singles(f, x)
            else:
                solve_by_blocks(f.blocks, f.scale, f.integers[REACH], n, k, 0, count, x)
            return
    substitute(
        f.lu, f.pivots, f.above, f.below, f.inverse, f.scale, f.integers[EXCHANGED] > 0, n, k, x
    )  # fmt: skip


@separate(type(None), FACTORS, VECTOR, late=True)
def _solve_by_singles(f, x):
    """Solve by blocks of single precision."""
    n, k = f.matrix.band.shape[0], f.matrix.band.shape[1] // 2
    solve_by_blocks(f.singles, f.scale, f.integers[REACH], n, k, 0, (n + LANES - 1) // LANES, x)


@kernel(forceinline=True)
def _make_blocks(f, blocks):
    """Make the band's factors in blocks. Returns 0, or 1 where a row has to be exchanged for that."""
    n, k = f.matrix.band.shape[0], f.matrix.band.shape[1] // 2
    reach = factorise_in_blocks(f.matrix.band, f.scale, blocks, f.window, f.threshold, n, k)
    if reach < 0:
        return 1
    f.integers[EXCHANGED], f.integers[PACKED], f.integers[REACH] = 0, IN_BLOCKS, reach
    return 0


@separate(int, FACTORS, late=True)
def _factorise_in_blocks(f):
    """The same, of double precision."""
    f.integers[SINGLE] = 0
    return _make_blocks(f, f.blocks)


@separate(int, FACTORS, late=True)
def _factorise_in_singles(f):
    """The same, rounded to single precision."""
    f.integers[SINGLE] = 1
    return _make_blocks(f, f.singles)


@separate(int, FACTORS, late=True)
def _factorise_by_rows(f):
    """Make the band's factors by rows. Returns 0, or k > 0 where the k-th pivot is exactly zero."""
    n, k = f.matrix.band.shape[0], f.matrix.band.shape[1] // 2
    # Where the factors before these were used often, these will be: they are packed before their first use.
    f.integers[PACKED] = TRIED if f.integers[PACKED] == AGAIN else FRESH
    f.integers[SINGLE] = 0
    equilibrate(f.matrix.band, f.lu, f.scale, n, k)
    find_envelope(f.lu, f.below, f.right, n, k)
    row, f.integers[EXCHANGED] = eliminate(
        f.lu, f.pivots, f.above, f.below, f.right, f.inverse, f.threshold, n, k
    )  # fmt: skip
    return row


@entry
def renew_matrix(factors, first, last):
    """Factorise anew what a change of rows and columns ``first`` to ``last`` - 1 has made of a matrix without a border.

    Returns the columns that were made, or -1 where all has to be factorised.
    """
    n, k = factors.matrix.band.shape[0], factors.matrix.band.shape[1] // 2
    made = renew(factors, n, k, first, last)
    if made > 0 and factors.integers[PACKED] >= IN_BLOCKS:
        begin = max(0, first - k)
        beside = (k + LANES - 1) // LANES
        end = (begin + made + LANES - 1) // LANES + beside
        _pack(factors, max(0, begin // LANES - beside), min((n + LANES - 1) // LANES, end))
    return made


@entry
def solve_rows(factors, x, first, last):
    """Solve for rows ``first`` to ``last`` - 1, as if the unknowns and right sides of all others were zero.

    What is wrong with that is left in the rows beside them. The other places of ``x`` (n,) are scratch. Both ends are
    to stand where blocks of `LANES` rows do.
    """
    f = factors
    n, k = f.matrix.band.shape[0], f.matrix.band.shape[1] // 2
    if f.integers[PACKED] >= IN_BLOCKS:
        begin, end = first // LANES, (last + LANES - 1) // LANES
        solve_by_blocks(f.blocks, f.scale, f.integers[REACH], n, k, begin, end, x)
        return
    for j in range(last, min(n, last + k)):
        x[j] = 0.0
    for j in range(first, last):
        x[j] *= f.scale[j]
    substitute_between(f.lu, f.pivots, f.above, f.below, f.inverse, first, last, k, x)
    for j in range(first, last):
        x[j] *= f.scale[j]


@entry
def solve_matrix(factors, x):
    """Solve A x = b with the factors; ``x`` (n + m,) holds b before and x after."""
    solve_inside(factors, x)


@kernel(forceinline=True)
def solve_inside(factors, x):
    """The same, written out where it is called: for a few unknowns the call is most of the work."""
    f = factors
    n, k = f.matrix.band.shape[0], f.matrix.band.shape[1] // 2
    _substitute(f, n, k, x)
    if f.corner_pivots.size > 0:
        _solve_border(f, x)


@separate(type(None), FACTORS, VECTOR, late=True)
def _solve_border(f, x):
    """Solve for the border's unknowns, and take what they change off those of the band."""
    n, m = f.matrix.band.shape[0], f.corner_pivots.size
    for i in range(m):
        y = 0.0
        for l in range(n):
            y += f.matrix.lower[i, l] * x[l]
        x[n + i] -= y
    solve_dense_inside(f.matrix.corner, f.corner_pivots, m, f.integers, x[n:])
    for j in range(m):
        for l in range(n):
            x[l] -= f.columns[j, l] * x[n + j]


solve_apart = apart(solve_matrix, type(None), FACTORS, VECTOR)
"""The same for what is long and calls it seldom: it does not take it in, which would compile it once more."""


@kernel(forceinline=True)
def _without_border(f):
    """Factors of the band alone, in the same memory."""
    return Factors(
        f.matrix, f.lu, f.pivots, f.corner_pivots[:0], f.columns, f.above, f.below, f.right, f.inverse, f.scale,
        f.integers, f.column, f.threshold, f.blocks, f.window, f.singles,
    )  # fmt: skip


@separate(int, FACTORS, late=True)
def _factorise_border(f):
    """Make the border's columns, and factorise its corner. Returns 0, or k > 0 where the k-th pivot is zero."""
    n, m = f.matrix.band.shape[0], f.corner_pivots.size
    band = _without_border(f)
    for j in range(m):
        y = f.columns[j]
        for i in range(n):
            y[i] = f.matrix.right[j, i]
        solve_apart(band, y)
        for i in range(m):
            x = 0.0
            for l in range(n):
                x += f.matrix.lower[i, l] * y[l]
            f.matrix.corner[j, i] -= x
    row = factorise_dense_inside(f.matrix.corner, f.corner_pivots, m, f.integers)
    return row + n if row != 0 else 0


@kernel(forceinline=True)
def _goes_in_blocks(f):
    """Whether factors are first tried in blocks.

    Where the threshold is lower, somebody counts pivots or renews a part: those stand in factors by rows only.
    """
    return f.window.size > 0 and f.threshold >= CAREFUL


@entry
def factorise_matrix(factors):
    """Make the factors. Returns 0, or k > 0 where the k-th pivot is exactly zero."""
    f = factors
    failed = 1
    if _goes_in_blocks(f):
        failed = _factorise_in_singles(f) if f.integers[MAY_BE_SINGLE] == 1 else _factorise_in_blocks(f)
    row = _factorise_by_rows(f) if failed != 0 else 0
    if row == 0 and f.corner_pivots.size > 0:
        row = _factorise_border(f)
    return row


def code_for(factors: Factors) -> list[Code]:
    """What factorising and solving with such a matrix comes to, as :func:`tautline.kernels.separate.code_of` has it.

    Where a row has to be exchanged, elimination by rows is compiled when it is called.
    """
    in_blocks = factors.window.size > 0 and factors.threshold >= CAREFUL
    if factors.singles.size > 0:
        called = [_factorise_in_singles, _solve_by_singles]
    else:
        called = [_factorise_in_blocks if in_blocks else _factorise_by_rows]
    if factors.blocks.size > 0 and not in_blocks:
        called.append(_pack)
    if factors.corner_pivots.size > 0:
        called += [_factorise_border, _solve_border]
    return [code_of(function) for function in called]


factorise_apart = apart(factorise_matrix, int, FACTORS)
"""The same for what calls it seldom; see `solve_apart`."""


def dense(matrix: Matrix) -> np.ndarray:
    """The matrix (n + m, n + m) in full."""
    n, m = matrix.band.shape[0], matrix.corner.shape[0]
    k = matrix.band.shape[1] // 2
    full = np.zeros((n + m, n + m))
    for j in range(n):
        first, last = max(0, j - k), min(n, j + k + 1)
        full[first:last, j] = matrix.band[j, k + first - j : k + last - j]
    full[:n, n:], full[n:, :n], full[n:, n:] = matrix.right.T, matrix.lower, matrix.corner.T
    return full


class Rows(NamedTuple):
    """A matrix (n + m, n + m) as it is multiplied by vectors, without SciPy, whose import takes a fifth of a second.

    ``band`` (n, 2 k + 1) with entry (i, j) at ``band[i, k + j - i]``; ``right`` (n, m), ``lower`` (m, n) and ``corner``
    (m, m) as they stand.
    """

    band: np.ndarray
    right: np.ndarray
    lower: np.ndarray
    corner: np.ndarray

    def __matmul__(self, x: np.ndarray) -> np.ndarray:
        """The product with a vector (n + m,)."""
        n, k = self.band.shape[0], self.band.shape[1] // 2
        padded = np.zeros(n + 2 * k)
        padded[k : k + n] = x[:n]
        # Row i of the band meets x from i - k to i + k: a view of it, row by row one further.
        inner = np.einsum("ij,ij->i", self.band, as_strided(padded, self.band.shape, 2 * padded.strides))
        if self.corner.size == 0:
            return inner
        return np.concatenate((inner + self.right @ x[n:], self.lower @ x[:n] + self.corner @ x[n:]))

    def __abs__(self) -> Rows:
        """The matrix of the entries' sizes."""
        return Rows(*map(np.abs, self))

    @property
    def vanishes(self) -> bool:
        """Whether every entry is zero."""
        return not any(np.any(entries) for entries in (self.band, self.right, self.lower, self.corner))


def rows_of(matrix: Matrix) -> Rows:
    """The matrix by rows, for products; a copy."""
    n, k = matrix.band.shape[0], matrix.band.shape[1] // 2
    padded = np.zeros((n + 2 * k, 2 * k + 1))
    padded[k : k + n] = matrix.band
    # Along a row each entry stands one column of the matrix further, and one place less deep in it.
    down, along = padded.strides
    band = as_strided(padded.ravel()[2 * k :], (n, 2 * k + 1), (down, down - along)).copy()
    return Rows(band, matrix.right.T.copy(), matrix.lower.copy(), matrix.corner.T.copy())


def sizes_of_rows(matrix: Matrix, x: np.ndarray) -> np.ndarray:
    """What the product with x (n + m,) can be at most in each row: sizes of entries times those of x, (n + m,).

    Of a large matrix nothing is copied but some columns at a time, which stay in the processor's cache.
    """
    n, k, x = matrix.band.shape[0], matrix.band.shape[1] // 2, np.abs(x)
    padded = np.zeros(n + 2 * k)
    for first in range(0, n, COLUMNS):
        last = min(n, first + COLUMNS)
        sizes = np.abs(matrix.band[first:last]) * x[first:last, None]
        for i in range(2 * k + 1):
            padded[first + i : last + i] += sizes[:, i]
    inner = padded[k : k + n] + np.abs(matrix.right.T) @ x[n:]
    return np.concatenate((inner, np.abs(matrix.lower) @ x[:n] + np.abs(matrix.corner.T) @ x[n:]))


def diagonal(matrix: Matrix) -> np.ndarray:
    """The diagonal (n + m,)."""
    k = matrix.band.shape[1] // 2
    return np.concatenate((matrix.band[:, k], np.diagonal(matrix.corner)))


def sparse(matrix: Matrix):
    """The matrix as a SciPy sparse array (n + m, n + m)."""
    from scipy.sparse import block_array, csr_array, dia_array

    n = matrix.band.shape[0]
    if n == 0:
        return csr_array(matrix.corner.T)
    k = matrix.band.shape[1] // 2
    offsets = np.arange(-k, k + 1)
    band = dia_array((np.array([matrix.band[:, k - d] for d in offsets]), offsets), shape=(n, n))
    if matrix.corner.size == 0:
        return band
    return block_array(
        [[band, csr_array(matrix.right.T)], [csr_array(matrix.lower), csr_array(matrix.corner.T)]], format="csr"
    )


@kernel
def size_of_row(matrix, row, x):
    """Sum over a row of its entries' sizes times those of x (n + m,): what its product can be at most."""
    n, k, m = matrix.band.shape[0], matrix.band.shape[1] // 2, matrix.corner.shape[0]
    found = 0.0
    if row >= n:
        for i in range(n):
            found += abs(matrix.lower[row - n, i] * x[i])
        for j in range(m):
            found += abs(matrix.corner[j, row - n] * x[n + j])
        return found
    for i in range(max(0, row - k), min(n, row + k + 1)):
        found += abs(matrix.band[i, k + row - i] * x[i])
    for j in range(m):
        found += abs(matrix.right[j, row] * x[n + j])
    return found


@kernel
def hold_row(matrix, row):
    """Make a row that of the unit matrix: its unknown stays where it is."""
    n, k, m = matrix.band.shape[0], matrix.band.shape[1] // 2, matrix.corner.shape[0]
    if row >= n:
        for i in range(n):
            matrix.lower[row - n, i] = 0.0
        for j in range(m):
            matrix.corner[j, row - n] = 0.0
        matrix.corner[row - n, row - n] = 1.0
        return
    for i in range(max(0, row - k), min(n, row + k + 1)):
        matrix.band[i, k + row - i] = 0.0
    for j in range(m):
        matrix.right[j, row] = 0.0
    matrix.band[row, k] = 1.0


def _along(matrix: Matrix, row: int, first: int, last: int) -> np.ndarray:
    """Entries of a row in columns ``first`` to ``last`` - 1 of the band, a view: each lies a column further."""
    width = matrix.band.shape[1]
    begin = width // 2 + row + first * (width - 1)
    step = max(1, width - 1)
    return matrix.band.reshape(-1)[begin : begin + (last - first - 1) * step + 1 : step]


def replace_by_identity(matrix: Matrix, row: int) -> None:
    """Make a row that of the unit matrix: its unknown stays where it is."""
    n, k = matrix.band.shape[0], matrix.band.shape[1] // 2
    if row >= n:
        matrix.lower[row - n] = 0.0
        matrix.corner[:, row - n] = 0.0
        matrix.corner[row - n, row - n] = 1.0
        return
    _along(matrix, row, max(0, row - k), min(n, row + k + 1))[:] = 0.0
    matrix.right[:, row] = 0.0
    matrix.band[row, k] = 1.0
