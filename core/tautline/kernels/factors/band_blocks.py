"""Factors of a band in blocks of four unknowns, for those that are solved with more than once.

Substitution goes from row to row, and every row waits for the one before it. With blocks of the scaled matrix of which
those before P have been eliminated, D on the diagonal and S beside it, and multipliers M_IP = S_IP D^-1,

    y_I = s_I b_I - sum_P M_IP y_P,    x_P = s_P (D^-1 y_P - sum_J D^-1 S_PJ x_J / s_J),

s being the scale of rows and columns. All products with inverses are made once: a block then waits for the block before
it by one product and a sum.

Factors by rows are of this form too, D being L_PP U_PP and M_IP being L_IP L_PP^-1. Rows must not have been exchanged.
Packing them costs about as much as one substitution row by row.
"""

from __future__ import annotations

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, gather, laid_flat, lane, load, negated, scatter, spread, store, where, within

BLOCK = LANES * LANES
"""Numbers of a block, column by column."""


def room_for_blocks(size: int, bandwidth: int) -> int:
    """Numbers of the blocks of a band: forward those below the diagonal, backward that on it and those to its right."""
    return -(-size // LANES) * (1 + 2 * reach_of(bandwidth)) * BLOCK


def reach_of(k: int) -> int:
    """Blocks that a band reaches on either side of the diagonal at most."""
    return (k + LANES - 1) // LANES


@kernel(forceinline=True)
def _part(flat, j, width, centre, i, first, last):
    """Entries of rows i to i + 3 of column j of the band, zero but for rows ``first`` to ``last`` - 1."""
    column = load(flat, j * width + centre + i - j)
    return where(within(i, last) & negated(within(i, first)), column, 0.0)


@kernel(forceinline=True)
def halves(blocks, n, most):
    """The blocks forward, as many as are reached at most for each four unknowns, and backward, one more for each."""
    forward = (n + LANES - 1) // LANES * most * BLOCK
    return blocks[:forward], blocks[forward:]


@kernel(forceinline=True)
def place_below(b, r, most):
    """Where the multipliers stand of the r-th block below block b; those of one row follow one another."""
    return ((b + r) * most + r - 1) * BLOCK


@kernel(forceinline=True)
def _column_below(flat, j, width, centre, i, below, n):
    """Entries of rows i to i + 3 of column j of L, which stand below the diagonal; zero where the column is shorter."""
    if j < n and j + below[j] >= i:
        return load(flat, j * width + centre + i - j)
    return spread(0.0)


@kernel(forceinline=True)
def _below(z, l0, l1, l2):
    """L^-1 z for the columns of L below its diagonal of ones."""
    z -= l0 * lane(z, 0)
    z -= l1 * lane(z, 1)
    z -= l2 * lane(z, 2)
    return z


@kernel(forceinline=True)
def _above(z, over, u1, u2, u3):
    """U^-1 z for the columns of U above its diagonal, over the diagonal, of which ``over`` is one over."""
    z *= over
    z -= u3 * lane(z, 3)
    z -= u2 * lane(z, 2)
    z -= u1 * lane(z, 1)
    return z


@kernel(forceinline=True)
def _write_multipliers(flat, width, centre, i, beside, below, n, l0, l1, l2, forward, place):
    """Write L_IP L_PP^-1 for the columns from i and the rows from ``beside`` on."""
    m0 = _column_below(flat, i, width, centre, beside, below, n)
    m1 = _column_below(flat, i + 1, width, centre, beside, below, n)
    m2 = _column_below(flat, i + 2, width, centre, beside, below, n)
    m3 = _column_below(flat, i + 3, width, centre, beside, below, n)
    m2 -= m3 * lane(l2, 3)
    m1 -= m2 * lane(l1, 2) + m3 * lane(l1, 3)
    m0 -= m1 * lane(l0, 1) + (m2 * lane(l0, 2) + m3 * lane(l0, 3))
    store(forward, place, m0)
    store(forward, place + LANES, m1)
    store(forward, place + 2 * LANES, m2)
    store(forward, place + 3 * LANES, m3)


@kernel
def pack(lu, above, below, inverse, scale, blocks, n, k, first, last, reach):
    """Make blocks ``first`` to ``last`` - 1 of factors without exchanged rows; returns how far blocks reach, at least
    ``reach``.
    """
    flat, width, centre = laid_flat(lu), lu.shape[1], 2 * k
    most = reach_of_band(k)
    forward, backward = halves(blocks, n, most)
    for b in range(first, last):
        i = LANES * b
        end = min(i + LANES, n)
        at = b * (1 + most) * BLOCK
        # Columns of the block on the diagonal: those beyond the last unknown are of zeros.
        c1, c2, c3 = min(i + 1, n - 1), min(i + 2, n - 1), min(i + 3, n - 1)
        l0 = _part(flat, i, width, centre, i, i + 1, min(end, i + below[i] + 1))
        l1 = _part(flat, c1, width, centre, i, c1 + 1, min(end, c1 + below[c1] + 1))
        l2 = _part(flat, c2, width, centre, i, c2 + 1, min(end, c2 + below[c2] + 1))
        over = where(within(i, n), gather(inverse, i, n), 0.0)
        size = where(within(i, n), gather(scale, i, n), 0.0)
        u1 = over * _part(flat, c1, width, centre, i, c1 - above[c1], c1)
        u2 = over * _part(flat, c2, width, centre, i, c2 - above[c2], c2)
        u3 = over * _part(flat, c3, width, centre, i, c3 - above[c3], c3)
        for c in range(LANES):
            one = where(within(i, i + c + 1) & negated(within(i, i + c)), 1.0, 0.0)
            solved = _above(_below(one if i + c < n else 0.0 * one, l0, l1, l2), over, u1, u2, u3)
            store(backward, at + LANES * c, size * solved)
        for r in range(1, most + 1):
            # What lies outside the envelope, also between the columns of the band, are zeros.
            beside = i + LANES * r
            if beside < n:
                to = place_below(b, r, most)
                _write_multipliers(flat, width, centre, i, beside, below, n, l0, l1, l2, forward, to)
            inverse_scale = 1.0 / gather(scale, beside, n)
            unscaled = lane(inverse_scale, 0), lane(inverse_scale, 1), lane(inverse_scale, 2), lane(inverse_scale, 3)
            for c in range(LANES):
                if i + c < n and i + c + below[i + c] >= beside:
                    reach = max(reach, r)
                j = beside + c
                right = spread(0.0)
                if j < n and j - above[j] < end:
                    right = load(flat, j * width + centre + i - j) * unscaled[c]
                    reach = max(reach, r)
                store(backward, at + r * BLOCK + LANES * c, size * _above(right, over, u1, u2, u3))
    return reach


@kernel(forceinline=True)
def reach_of_band(k):
    """The same as `reach_of`, compiled."""
    return (k + LANES - 1) // LANES


@kernel(forceinline=True)
def _product(m, at, x0, x1, x2, x3):
    """A block times four numbers."""
    return (load(m, at) * x0 + load(m, at + LANES) * x1) + (load(m, at + 2 * LANES) * x2 + load(m, at + 3 * LANES) * x3)


@kernel(forceinline=True)
def _times(m, at, x):
    """A block times four lanes."""
    return _product(m, at, lane(x, 0), lane(x, 1), lane(x, 2), lane(x, 3))


@kernel
def solve_by_blocks(blocks, scale, reach, n, k, first, last, x):
    """Solve for the unknowns of blocks ``first`` to ``last`` - 1, as if all others and their right sides were zero.

    ``x`` (n,) holds the right side before and the solution after.
    """
    most = reach_of_band(k)
    forward, backward = halves(blocks, n, most)
    before = spread(0.0)
    for b in range(first, last):
        i = LANES * b
        y = gather(x, i, n) * gather(scale, i, n)
        for r in range(2, min(reach, b - first) + 1):
            j = i - LANES * r
            y -= _product(forward, place_below(b - r, r, most), x[j], x[j + 1], x[j + 2], x[j + 3])
        before = y - _times(forward, place_below(b - 1, 1, most), before)
        scatter(x, i, n, before)
    beside = spread(0.0)
    for b in range(last - 1, first - 1, -1):
        i, at = LANES * b, b * (1 + most) * BLOCK
        y = _times(backward, at, gather(x, i, n))
        for r in range(2, min(reach, last - 1 - b) + 1):
            y -= _times(backward, at + r * BLOCK, gather(x, i + LANES * r, n))
        beside = y - _times(backward, at + BLOCK, beside)
        scatter(x, i, n, beside)
