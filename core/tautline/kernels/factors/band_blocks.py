"""Factors of a band in blocks of four unknowns, for those that are solved with more than once.

Substitution goes from row to row, and every row waits for the one before it. With blocks B of a band's factors L U,

    y_b = L_bb^-1 (S b)_b - sum_r L_bb^-1 L_b,b-r y_b-r,    x_b = S_b (U_bb^-1 y_b - sum_r U_bb^-1 U_b,b+r x'_b+r),

S being the scale of rows and columns and x = S x'. All products with inverses are made once, when the factors are
packed: a block then waits for the block before it by two products and a sum, and its first part waits for nothing.
Rows must not have been exchanged. Packing costs about as much as one substitution row by row.
"""

from __future__ import annotations

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, gather, lane, load, negated, scatter, spread, store, where, within

BLOCK = LANES * LANES
"""Numbers of a block, column by column."""


def room_for_blocks(size: int, bandwidth: int) -> tuple[int, int]:
    """Shape of the blocks of a band, forward and backward: that on the diagonal stands before those beside it."""
    return 2, -(-size // LANES) * (1 + reach_of(bandwidth)) * BLOCK


def reach_of(k: int) -> int:
    """Blocks that a band reaches on either side of the diagonal at most."""
    return (k + LANES - 1) // LANES


@kernel(forceinline=True)
def _part(flat, j, width, centre, i, first, last):
    """Entries of rows i to i + 3 of column j of the band, zero but for rows ``first`` to ``last`` - 1."""
    column = load(flat, j * width + centre + i - j)
    return where(within(i, last) & negated(within(i, first)), column, 0.0)


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


@kernel
def pack(band, above, below, inverse, scale, blocks, n, k, first, last, reach):
    """Make blocks ``first`` to ``last`` - 1 of factors without exchanged rows; returns how far blocks reach, at least
    ``reach``.
    """
    flat, width, centre = band.reshape(-1), band.shape[1], 2 * k
    most = reach_of_band(k)
    stride = (1 + most) * BLOCK
    forward, backward = blocks[0], blocks[1]
    for b in range(first, last):
        i = LANES * b
        end = min(i + LANES, n)
        at = b * stride
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
            j = i + c
            store(forward, at + LANES * c, _below(one * (scale[j] if j < n else 0.0), l0, l1, l2))
            store(backward, at + LANES * c, size * _above(one if j < n else 0.0 * one, over, u1, u2, u3))
        for r in range(1, most + 1):
            place, below_it, right_of_it = at + r * BLOCK, i - LANES * r, i + LANES * r
            inverse_scale = 1.0 / gather(scale, right_of_it, n)
            unscaled = lane(inverse_scale, 0), lane(inverse_scale, 1), lane(inverse_scale, 2), lane(inverse_scale, 3)
            for c in range(LANES):
                # What lies outside the envelope, also between the columns of the band, are zeros.
                j = below_it + c
                beside = spread(0.0)
                if j >= 0 and j + below[j] >= i:
                    beside = load(flat, j * width + centre + i - j)
                    reach = max(reach, r)
                store(forward, place + LANES * c, _below(beside, l0, l1, l2))
                j = right_of_it + c
                beside = spread(0.0)
                if j < n and j - above[j] < end:
                    beside = load(flat, j * width + centre + i - j) * unscaled[c]
                    reach = max(reach, r)
                store(backward, place + LANES * c, size * _above(beside, over, u1, u2, u3))
    return reach


@kernel(forceinline=True)
def reach_of_band(k):
    """The same as `reach_of`, compiled."""
    return (k + LANES - 1) // LANES


@kernel(forceinline=True)
def _times(m, at, x0, x1, x2, x3):
    return (load(m, at) * x0 + load(m, at + 4) * x1) + (load(m, at + 8) * x2 + load(m, at + 12) * x3)


@kernel(forceinline=True)
def _times_lanes(m, at, x):
    return _times(m, at, lane(x, 0), lane(x, 1), lane(x, 2), lane(x, 3))


@kernel
def solve_by_blocks(blocks, reach, n, k, first, last, x):
    """Solve for the unknowns of blocks ``first`` to ``last`` - 1, as if all others and their right sides were zero.

    ``x`` (n,) holds the right side before and the solution after.
    """
    stride = (1 + reach_of_band(k)) * BLOCK
    forward, backward = blocks[0], blocks[1]
    before = spread(0.0)
    for b in range(first, last):
        i, at = LANES * b, b * stride
        y = _times_lanes(forward, at, gather(x, i, n))
        for r in range(2, min(reach, b - first) + 1):
            j = i - LANES * r
            y -= _times(forward, at + r * BLOCK, x[j], x[j + 1], x[j + 2], x[j + 3])
        before = y - _times_lanes(forward, at + BLOCK, before)
        scatter(x, i, n, before)
    before = spread(0.0)
    for b in range(last - 1, first - 1, -1):
        i, at = LANES * b, b * stride
        y = _times_lanes(backward, at, gather(x, i, n))
        for r in range(2, min(reach, last - 1 - b) + 1):
            y -= _times_lanes(backward, at + r * BLOCK, gather(x, i + LANES * r, n))
        before = y - _times_lanes(backward, at + BLOCK, before)
        scatter(x, i, n, before)
