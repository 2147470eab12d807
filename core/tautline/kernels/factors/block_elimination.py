"""Factors of a band made in blocks of four unknowns from the start, where no row has to be exchanged.

What is left of the scaled matrix when the blocks before P have been eliminated, S, loses one pivot D = S_PP after the
other,

    M_IP = S_IP D^-1,    S_IJ -= M_IP S_PJ,

and M and D^-1 S are what :func:`tautline.kernels.factors.band_blocks.solve_by_blocks` solves with; they are written as
they come. Only the blocks that a pivot reaches are at hand, in a window, and the band is read once.

Elimination row by row (band.py) is general: it stops at the envelope, exchanges rows, and is renewed in part. Here four
columns are eliminated by products of blocks that stay in registers, which takes half of the time or less. Where a row
would have to be exchanged, -1 is returned and the matrix is as it was.
"""

from __future__ import annotations

from tautline.kernels.factors.band_blocks import BLOCK, halves, place_below, reach_of, reach_of_band
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import (
    LANES,
    any_of,
    gather,
    laid_flat,
    lane,
    larger,
    largest,
    load,
    negated,
    pack,
    scatter,
    spread,
    sqrt,
    store,
    where,
    within,
)

LARGEST = 100.0
"""Multipliers M up to which rows stay in their order: beyond, rounding would grow by as much in each block."""


def room_for_window(bandwidth: int) -> int:
    """Numbers of the blocks that one block of pivots reaches, of the inverse of one, and of a mark for each row."""
    return (1 + reach_of(bandwidth)) ** 2 * BLOCK + BLOCK + 1 + reach_of(bandwidth)


@kernel(forceinline=True)
def _block(head, span, i, j):
    """Where the block stands that is i rows and j columns of blocks from that of the pivots, which is at ``head``.

    Blocks that no pivot reaches any more make room for those that come.
    """
    row, column = head + i, head + j
    row = row - span if row >= span else row
    column = column - span if column >= span else column
    return (row * span + column) * BLOCK


@kernel(forceinline=True)
def _write_scale(band, scale, i, n, k):
    """Write one over the square root of the diagonal for four unknowns."""
    last = n - 1
    sizes = abs(
        pack(
            band[min(i, last), k], band[min(i + 1, last), k], band[min(i + 2, last), k], band[min(i + 3, last), k],
        )
    )  # fmt: skip
    scatter(scale, i, n, where(sizes > 0.0, 1.0 / sqrt(sizes), 1.0))


@kernel(forceinline=True)
def _read_block(flat, k, scale, b, d, n, window, to):
    """Read the scaled block of rows b and columns d of the band; beyond the last unknown stands the unit matrix.

    What is beyond the band's edge are other columns: zeros are read there.
    """
    i = LANES * b
    of_rows = gather(scale, i, n)
    for c in range(LANES):
        j = LANES * d + c
        if j < n:
            column = load(flat, 2 * k * j + k + i)
            if i - j + LANES - 1 > k or j - i > k:
                column = where(within(i, j + k + 1) & negated(within(i, j - k)), column, 0.0)
            store(window, to + LANES * c, column * of_rows * scale[j])
        else:
            store(window, to + LANES * c, spread(0.0))
            window[to + LANES * c + c] = 1.0 if b == d else 0.0


@kernel(forceinline=True)
def _columns(x, at):
    """The four columns of a block."""
    return load(x, at), load(x, at + LANES), load(x, at + 2 * LANES), load(x, at + 3 * LANES)


@kernel(forceinline=True)
def _write_columns(x, at, columns):
    """Write the four columns of a block."""
    for c in range(LANES):
        store(x, at + LANES * c, columns[c])


@kernel(forceinline=True)
def _read_reach(band, scale, head, span, p, n, k, window):
    """Read the blocks of the last row and column that the pivots of block p reach; those before were read earlier."""
    flat, most = laid_flat(band), span - 1
    e = p + most
    _write_scale(band, scale, LANES * e, n, k)
    for j in range(max(0, -p), most):
        _read_block(flat, k, scale, e, p + j, n, window, _block(head, span, most, j))
        _read_block(flat, k, scale, p + j, e, n, window, _block(head, span, j, most))
    _read_block(flat, k, scale, e, e, n, window, _block(head, span, most, most))


@kernel(forceinline=True)
def _clear_block(x, at):
    """Set a block to zero."""
    for c in range(0, BLOCK, LANES):
        store(x, at + c, spread(0.0))


@kernel(forceinline=True)
def _is_zero(window, at):
    """Whether a block is of zeros."""
    return not any_of(
        negated(
            (load(window, at) == 0.0) & (load(window, at + LANES) == 0.0)
            & (load(window, at + 2 * LANES) == 0.0) & (load(window, at + 3 * LANES) == 0.0)
        )
    )  # fmt: skip


@kernel(forceinline=True)
def _inverted(row, k, own, b, c, d):
    """One step of Gauss and Jordan on four columns: row k is divided by the pivot and subtracted from the others' rows.

    ``row`` is one in row k and zero elsewhere; the pivot's ``own`` column becomes that of the inverse.
    """
    h = 1.0 / lane(own, k)
    others = where(row > 0.0, 0.0, own)
    x, y, z = lane(b, k) * h, lane(c, k) * h, lane(d, k) * h
    return (
        where(row > 0.0, h, -(others * h)), where(row > 0.0, x, b - others * x),
        where(row > 0.0, y, c - others * y), where(row > 0.0, z, d - others * z),
    )  # fmt: skip


@kernel(forceinline=True)
def _write_inverse(window, at, to, threshold):
    """Write the inverse of a block; returns whether no row of it had to be exchanged."""
    a0, a1 = load(window, at), load(window, at + LANES)
    a2, a3 = load(window, at + 2 * LANES), load(window, at + 3 * LANES)
    good = lane(a0, 0) != 0.0 and abs(lane(a0, 0)) >= threshold * largest(abs(a0))
    a0, a1, a2, a3 = _inverted(pack(1.0, 0.0, 0.0, 0.0), 0, a0, a1, a2, a3)
    pivot, below = abs(lane(a1, 1)), max(abs(lane(a1, 2)), abs(lane(a1, 3)))
    good = good and pivot != 0.0 and pivot >= threshold * below
    a1, a0, a2, a3 = _inverted(pack(0.0, 1.0, 0.0, 0.0), 1, a1, a0, a2, a3)
    pivot = abs(lane(a2, 2))
    good = good and pivot != 0.0 and pivot >= threshold * abs(lane(a2, 3))
    a2, a0, a1, a3 = _inverted(pack(0.0, 0.0, 1.0, 0.0), 2, a2, a0, a1, a3)
    good = good and lane(a3, 3) != 0.0
    a3, a0, a1, a2 = _inverted(pack(0.0, 0.0, 0.0, 1.0), 3, a3, a0, a1, a2)
    store(window, to, a0)
    store(window, to + LANES, a1)
    store(window, to + 2 * LANES, a2)
    store(window, to + 3 * LANES, a3)
    return good


@kernel(forceinline=True)
def _product(x0, x1, x2, x3, window, at):
    """Four columns times a column of four numbers that stands at a place."""
    return (x0 * window[at] + x1 * window[at + 1]) + (x2 * window[at + 2] + x3 * window[at + 3])


@kernel(forceinline=True)
def _write_right(window, head, span, p, last, scale, n, backward):
    """Write D^-1 and D^-1 S_PJ, which solve for the unknowns of block p; returns how far blocks reach."""
    most, reach, inverse = span - 1, 1, span * span * BLOCK
    marks = inverse + BLOCK
    d0, d1, d2, d3 = _columns(window, inverse)
    at, size = p * (1 + most) * BLOCK, gather(scale, LANES * p, n)
    _write_columns(backward, at, (size * d0, size * d1, size * d2, size * d3))
    for j in range(1, most + 1):
        place, source = at + j * BLOCK, _block(head, span, 0, j)
        empty = j > last or _is_zero(window, source)
        window[marks + j] = 0.0 if empty else 1.0
        if empty:
            _clear_block(backward, place)
            continue
        reach = j
        unscaled = 1.0 / gather(scale, LANES * (p + j), n)
        for c in range(LANES):
            solved = size * _product(d0, d1, d2, d3, window, source + LANES * c)
            store(backward, place + LANES * c, solved * lane(unscaled, c))
    return reach


@kernel(forceinline=True)
def _eliminate_below(window, head, span, p, last, forward):
    """Write M_IP, and subtract what it takes from the blocks beside it.

    Returns how far blocks reach, and the largest multiplier.
    """
    inverse, multipliers, reach = span * span * BLOCK, spread(0.0), 1
    marks = inverse + BLOCK
    for b in range(1, last + 1):
        source, place = _block(head, span, b, 0), place_below(p, b, span - 1)
        if _is_zero(window, source):
            _clear_block(forward, place)
            continue
        reach = b
        s0, s1, s2, s3 = _columns(window, source)
        m0, m1 = _product(s0, s1, s2, s3, window, inverse), _product(s0, s1, s2, s3, window, inverse + LANES)
        m2 = _product(s0, s1, s2, s3, window, inverse + 2 * LANES)
        m3 = _product(s0, s1, s2, s3, window, inverse + 3 * LANES)
        _write_columns(forward, place, (m0, m1, m2, m3))
        multipliers = larger(larger(abs(m0), abs(m1)), larger(larger(abs(m2), abs(m3)), multipliers))
        for j in range(1, last + 1):
            if window[marks + j] == 0.0:
                continue
            right, target = _block(head, span, 0, j), _block(head, span, b, j)
            for c in range(0, BLOCK, LANES):
                left = load(window, target + c) - _product(m0, m1, m2, m3, window, right + c)
                store(window, target + c, left)
    return reach, largest(multipliers)


@kernel
def factorise_in_blocks(band, scale, blocks, window, threshold, n, k):
    """Make the blocks that a band is solved with; the band stays as it is.

    Parameters
    ----------
    band : (n, 2 k + 1) array
        The matrix, as in band.py.
    scale : (n,) array
        On return, what rows and columns were multiplied by: one over the square root of the diagonal.
    blocks : (m,) array
        On return, the factors; of :func:`~tautline.kernels.factors.band_blocks.room_for_blocks`.
    window : (m,) array
        Scratch, of :func:`room_for_window`.
    threshold : float
        Share of the largest entry of its column in a block that a pivot must have.

    Returns
    -------
    int
        How many blocks stand beside each other, or -1 where a row would have to be exchanged.
    """
    most = reach_of_band(k)
    span, count, reach = most + 1, (n + LANES - 1) // LANES, 1
    forward, backward = halves(blocks, n, most)
    head = 0  # of the first pivot; those before it only read what it reaches
    for p in range(-most, count):
        head = head + 1 if head + 1 < span else 0
        if p + most < count:
            _read_reach(band, scale, head, span, p, n, k, window)
        if p < 0:
            continue
        if not _write_inverse(window, _block(head, span, 0, 0), span * span * BLOCK, threshold):
            return -1
        last = min(count - 1 - p, most)
        right = _write_right(window, head, span, p, last, scale, n, backward)
        below, multiplier = _eliminate_below(window, head, span, p, last, forward)
        if not multiplier <= LARGEST:
            return -1
        reach = max(reach, right, below)
    return reach
