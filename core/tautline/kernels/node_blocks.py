"""Factors of a band by blocks: a chain of elements is block tridiagonal, a block being a node.

Substitution by columns waits at every unknown for the one before. Here it waits once for each block, of up to eight
unknowns, and what it waits for is a product of a small matrix and a vector, done in registers. With lower, diagonal and
upper blocks L, D, U of the matrix

    S_i = D_i - G_i U_(i-1),   G_i = L_i S_(i-1)^-1,   F_i = S_i^-1 U_i

a solution is y_i = b_i - G_i y_(i-1) forwards and x_i = S_i^-1 y_i - F_i x_(i+1) backwards (block elimination, Golub
and Van Loan, Matrix Computations, section 4.5.1). Rows are exchanged within a block only. Where that is not enough, as
the growth of G shows, the factors are refused and the band is factorised as in :mod:`tautline.kernels.band`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, load, spread, store

ROWS = 2 * LANES
"""Most rows of a block, and places of a column in memory: two registers."""
GROWTH = 100.0
"""Largest entry of G, the matrix being scaled to a unit diagonal, with which factors are taken."""


class NodeBlocks(NamedTuple):
    """Factors of a block tridiagonal matrix.

    Block i is of unknowns ``starts[i]`` to ``starts[i + 1]`` - 1; ``starts`` is (1,) where a matrix has no blocks.
    ``lower``, ``inverse`` and ``upper`` hold G, S^-1 and F, the columns of each one after the other in ``ROWS`` places,
    a block in ``stride`` places. ``taken`` (1,) is 1 while they are the factors of the matrix. Scratch: ``right`` (n +
    ``ROWS``,), ``steps``, a block in ``ROWS`` places, and ``work`` (3, ``ROWS`` ``ROWS``).
    """

    starts: np.ndarray
    stride: int
    lower: np.ndarray
    inverse: np.ndarray
    upper: np.ndarray
    taken: np.ndarray
    right: np.ndarray
    steps: np.ndarray
    work: np.ndarray


def new_node_blocks(starts: np.ndarray) -> NodeBlocks:
    """Room for the factors of a matrix that is divided so; none for ``starts`` (1,)."""
    count, size = starts.size - 1, int(starts[-1])
    stride = ROWS * int(np.diff(starts).max(initial=0))
    return NodeBlocks(
        starts.astype(np.int64), stride, *(np.zeros(count * stride) for _ in range(3)), np.zeros(1, np.int64),
        np.zeros(size + ROWS if count else 0), np.zeros(ROWS * count), np.zeros((3, ROWS * ROWS if count else 0)),
    )  # fmt: skip


@kernel(forceinline=True)
def _product(m, at, columns, x, place):
    """Rows of a small matrix times a vector: the first four and the last four."""
    a = b = c = d = spread(0.0)
    even = columns - columns % 2
    for k in range(0, even, 2):
        column, one, two = at + ROWS * k, spread(x[place + k]), spread(x[place + k + 1])
        a = a + load(m, column) * one
        b = b + load(m, column + 4) * one
        c = c + load(m, column + 8) * two
        d = d + load(m, column + 12) * two
    if even < columns:
        column, one = at + ROWS * even, spread(x[place + even])
        a = a + load(m, column) * one
        b = b + load(m, column + 4) * one
    return a + c, b + d


@kernel
def solve_by_nodes(f, x):
    """Solve by the factors; ``x`` holds the right side before and the solution after."""
    starts, stride, right, steps = f.starts, f.stride, f.right, f.steps
    count, n = starts.size - 1, starts[starts.size - 1]
    for i in range(n):
        right[i] = x[i]
    for i in range(count):
        top, bottom = load(right, starts[i]), load(right, starts[i] + 4)
        if i > 0:
            one, two = _product(f.lower, i * stride, starts[i] - starts[i - 1], steps, ROWS * (i - 1))
            top, bottom = top - one, bottom - two
        store(steps, ROWS * i, top)
        store(steps, ROWS * i + 4, bottom)
    for i in range(count - 1, -1, -1):
        top, bottom = _product(f.inverse, i * stride, starts[i + 1] - starts[i], steps, ROWS * i)
        if i < count - 1:
            one, two = _product(f.upper, i * stride, starts[i + 2] - starts[i + 1], steps, ROWS * (i + 1))
            top, bottom = top - one, bottom - two
        store(steps, ROWS * i, top)
        store(steps, ROWS * i + 4, bottom)
    # What a block writes beyond its end is written over by the next.
    for i in range(count):
        store(right, starts[i], load(steps, ROWS * i))
        store(right, starts[i] + 4, load(steps, ROWS * i + 4))
    for i in range(n):
        x[i] = right[i]


@kernel
def _take_block(band, k, row, rows, column, columns, m):
    """Write rows and columns of a band into a small matrix, and zeros below."""
    for j in range(columns):
        at = 2 * k + row - (column + j)
        for i in range(ROWS):
            inside = i < rows and -k <= row + i - (column + j) <= k
            m[ROWS * j + i] = band[column + j, at + i] if inside else 0.0


@kernel
def _invert(s, size, scale, first, pivots):
    """Invert a small matrix in place by Gauss and Jordan's method, scaled by ``scale`` from ``first`` on.

    Returns whether every pivot was a number other than zero. ``pivots`` is scratch.
    """
    for j in range(size):
        for i in range(size):
            s[ROWS * j + i] *= scale[first + i] * scale[first + j]
    for p in range(size):
        row, largest = p, 0.0
        for i in range(p, size):
            if abs(s[ROWS * p + i]) > largest:
                row, largest = i, abs(s[ROWS * p + i])
        if not (0.0 < largest < np.inf):
            return False
        pivots[p] = row
        if row != p:
            for j in range(size):
                x = s[ROWS * j + p]
                s[ROWS * j + p] = s[ROWS * j + row]
                s[ROWS * j + row] = x
        h = 1.0 / s[ROWS * p + p]
        s[ROWS * p + p] = 0.0
        top, bottom = load(s, ROWS * p), load(s, ROWS * p + 4)
        for j in range(size):
            if j != p:
                x = s[ROWS * j + p] * h
                store(s, ROWS * j, load(s, ROWS * j) - top * x)
                store(s, ROWS * j + 4, load(s, ROWS * j + 4) - bottom * x)
                s[ROWS * j + p] = x
        store(s, ROWS * p, -top * h)
        store(s, ROWS * p + 4, -bottom * h)
        s[ROWS * p + p] = h
    for p in range(size - 1, -1, -1):
        row = int(pivots[p])
        if row != p:
            for i in range(size):
                x = s[ROWS * p + i]
                s[ROWS * p + i] = s[ROWS * row + i]
                s[ROWS * row + i] = x
    for j in range(size):
        for i in range(size):
            s[ROWS * j + i] *= scale[first + i] * scale[first + j]
    return True


@kernel
def factorise_nodes(band, f, scale, n, k):
    """Make the factors of a band (n, 3 k + 1), which stays as it is; ``scale`` (n,) is one over its diagonal's roots.

    Returns whether they are taken.
    """
    starts, stride = f.starts, f.stride
    count = starts.size - 1
    above, below, pivots = f.work[0], f.work[1], f.work[2]
    f.taken[0] = 0
    for i in range(count):
        first, size = starts[i], starts[i + 1] - starts[i]
        at = i * stride
        s = f.inverse[at : at + stride]
        _take_block(band, k, first, size, first, size, s)
        if i > 0:
            before = first - starts[i - 1]
            for j in range(size):
                one, two = _product(f.lower, at, before, above, ROWS * j)
                store(s, ROWS * j, load(s, ROWS * j) - one)
                store(s, ROWS * j + 4, load(s, ROWS * j + 4) - two)
        if not _invert(s, size, scale, first, pivots):
            return False
        if i == count - 1:
            break
        after = starts[i + 2] - starts[i + 1]
        _take_block(band, k, first, size, first + size, after, above)
        for j in range(after):
            one, two = _product(f.inverse, at, size, above, ROWS * j)
            store(f.upper, at + ROWS * j, one)
            store(f.upper, at + ROWS * j + 4, two)
        _take_block(band, k, first + size, after, first, size, below)
        largest = 0.0
        for j in range(size):
            one, two = _product(below, 0, size, f.inverse, at + ROWS * j)
            store(f.lower, at + stride + ROWS * j, one)
            store(f.lower, at + stride + ROWS * j + 4, two)
            for l in range(after):
                grown = abs(f.lower[at + stride + ROWS * j + l]) * scale[first + size + l]
                largest = max(largest, grown / scale[first + j])
        if not largest <= GROWTH:
            return False
    f.taken[0] = 1
    return True
