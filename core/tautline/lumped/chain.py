"""From the vector between two neighbouring bodies to their coordinates: the chain rule of links and bends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel
from tautline.lumped import generated
from tautline.lumped.curve import PER_BODY

BOTH = 6
"""Coordinates of a link: x, u, v of the body above, then of the one below."""


@kernel
def place(i, k):
    """Full degree of freedom of coordinate k (x, u, v of body i, of body i + 1, ...) counted from body i."""
    return PER_BODY * (i + k // 3) + k % 3


@kernel
def chord_of(curve, i, q):
    """Chord of link i beyond its unstretched length, m, and its gradient (6,)."""
    o, p = PER_BODY * i, PER_BODY * (i + 1)
    above, below = curve.seats[i], curve.seats[i + 1]
    return generated.chord_gradient(
        q[o], q[o + 1], q[o + 2], q[p], q[p + 1], q[p + 2],
        above.turn1 + above.k1 * q[o], above.turn2 + above.k2 * q[o], above.k1, above.k2,
        below.turn1 + below.k1 * q[p], below.turn2 + below.k2 * q[p], below.k1, below.k2,
    )  # fmt: skip


@kernel(forceinline=True)
def chord_between(above, held_above, below, held_below):
    """The same of four links, in lanes: bodies' coordinates (x, u, v, theta) and the arcs that they are held to."""
    x1, u1, v1, _ = above
    x2, u2, v2, _ = below
    k11, k21, f11, f21 = held_above
    k12, k22, f12, f22 = held_below
    return generated.chord_gradient(
        x1, u1, v1, x2, u2, v2, f11 + k11 * x1, f21 + k21 * x1, k11, k21, f12 + k12 * x2, f22 + k22 * x2, k12, k22
    )


@kernel
def add_chord_hessian(curve, i, q, factor, corner, chord, hessian):
    """Add factor times the Hessian (6, 6) of the chord of link i to ``hessian`` from row and column ``corner`` on.

    ``chord`` (6, 6) is scratch.
    """
    o, p = PER_BODY * i, PER_BODY * (i + 1)
    above, below = curve.seats[i], curve.seats[i + 1]
    generated.chord_hessian(
        q[o], q[o + 1], q[o + 2], q[p], q[p + 1], q[p + 2],
        above.turn1 + above.k1 * q[o], above.turn2 + above.k2 * q[o], above.k1, above.k2,
        below.turn1 + below.k1 * q[p], below.turn2 + below.k2 * q[p], below.k1, below.k2,
        chord,
    )  # fmt: skip
    # Only a body's x with a body's offset have a second derivative: the turning is linear in x.
    for row in range(BOTH):
        for column in range(row + 1, BOTH):
            if (row % 3 == 0) != (column % 3 == 0):
                x = factor * chord[row, column]
                hessian[corner + row, corner + column] += x
                hessian[corner + column, corner + row] += x


@kernel
def across(i, q):
    """Lateral components du, dv of link i, m."""
    o, p = PER_BODY * i, PER_BODY * (i + 1)
    return q[p + 1] - q[o + 1], q[p + 2] - q[o + 2]


class Slopes(NamedTuple):
    """How m inner quantities move with n coordinates: a sparse matrix by columns, its pattern fixed.

    ``start`` (n + 1,), ``row`` (nnz,), ``value`` (nnz,); ``inner`` (m, m), ``half`` (m, n) and ``chord`` (6, 6) are
    scratch.
    """

    start: np.ndarray
    row: np.ndarray
    value: np.ndarray
    inner: np.ndarray
    half: np.ndarray
    chord: np.ndarray


def slopes(inner: int, columns: list[list[tuple[int, float]]]) -> Slopes:
    """Sparse slopes from the (row, value) pairs of each column; values that vary are written over later."""
    return Slopes(
        np.cumsum([0] + [len(c) for c in columns]),
        np.array([row for c in columns for row, _ in c]),
        np.array([value for c in columns for _, value in c], dtype=float),
        np.zeros((inner, inner)),
        np.zeros((inner, len(columns))),
        np.zeros((BOTH, BOTH)),
    )


@kernel
def pull_back(slopes, hessian):
    """hessian (n, n) = S^T H S, with S the slopes and H (m, m) the upper triangle of ``slopes.inner``."""
    s = slopes
    m, n = s.half.shape
    for i in range(m):
        for j in range(i):
            s.inner[i, j] = s.inner[j, i]
    for k in range(n):
        for i in range(m):
            x = 0.0
            for p in range(s.start[k], s.start[k + 1]):
                x += s.value[p] * s.inner[s.row[p], i]
            s.half[i, k] = x
    for k in range(n):
        for l in range(k, n):
            x = 0.0
            for p in range(s.start[k], s.start[k + 1]):
                x += s.value[p] * s.half[s.row[p], l]
            hessian[k, l] = x
            hessian[l, k] = x
