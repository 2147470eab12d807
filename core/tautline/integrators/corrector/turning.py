"""Factors that turn with the nodes of a rope, and so serve for many more steps.

A rope is stiff along itself and yields across. Hardly anything but its turning changes the tangent from one step to the
next, and where all of it turns alike the new tangent is R K R^T: the old one in turned axes. So the vectors r and r' of
each node are solved for in axes that turn with the node, by R the shortest rotation from the slope r' that it had when
the factors were made to the one that it has now. Solutions are R K^-1 R^T b.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dispatch import by_type
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import (
    LANES,
    collect,
    collect_fours,
    collect_pairs,
    lane,
    load_rows,
    sqrt,
    store,
    transposed,
    where,
)
from tautline.system.system import System

AXES = 3


class Turning(NamedTuple):
    """The nodes that turn.

    ``slope`` (k,) is the full degree of freedom where r' of each begins. The unknowns r and r' of the first nodes
    begin at ``both`` (m,), six side by side; of the others only r' is free, and its three begin at ``alone`` (k - m,).
    ``faced`` (4 k,) are the directions of r' when the factors were made, three numbers of four. ``axis`` (4 k,) are
    w = t0 x t and 1 / (1 + t0 . t), of the directions t0 then and t now: R x = x + w x x + w x (w x x) / (1 + t0 . t).
    ``turned`` (1,) says whether any has turned since.
    """

    slope: np.ndarray
    both: np.ndarray
    alone: np.ndarray
    faced: np.ndarray
    axis: np.ndarray
    turned: np.ndarray


class Fixed(NamedTuple):
    """No node of the scene turns; ``nodes`` is 0."""

    nodes: int


def turning_of(system: System) -> Turning | Fixed:
    """The nodes of a system whose free vectors are numbered side by side.

    None with multipliers: these act along the axes of space, and an iteration that is not turned meets the rows of
    linear constraints to rounding.
    """
    number, n = system.dofs.number, system.size - system.border
    slopes = system.slopes
    if not slopes.size or system.algebraic.size:
        return Fixed(0)

    def are_unknowns(first: np.ndarray, count: int) -> np.ndarray:
        """Whether so many degrees of freedom from each on are unknowns of the band, one after the other."""
        begin = number[first]
        numbers = number[first[:, None] + np.arange(count)]
        return (begin >= 0) & (begin + count <= n) & np.all(numbers == begin[:, None] + np.arange(count), axis=1)

    both = are_unknowns(slopes - AXES, 2 * AXES)
    alone = ~both & are_unknowns(slopes, AXES) & np.all(number[slopes[:, None] - 1 - np.arange(AXES)] < 0, axis=1)
    if not both.any():
        return Fixed(0)
    places = np.concatenate((slopes[both], slopes[alone]))
    return Turning(
        places, number[slopes[both] - AXES], number[slopes[alone]],
        np.zeros(LANES * places.size), np.zeros(LANES * places.size), np.zeros(1, np.int64),
    )  # fmt: skip


@kernel(forceinline=True)
def _four_from(n, last):
    """Four members from the n-th on; the last stands for those that there are not."""
    return n, min(n + 1, last - 1), min(n + 2, last - 1), min(n + 3, last - 1)


@kernel(forceinline=True)
def _chosen(array, each):
    """Entries of an array at four places."""
    i, j, k, l = each
    return array[i], array[j], array[k], array[l]


@kernel(forceinline=True)
def _directions(slope, each, full_q):
    """Directions of r' of four nodes, three lanes; zeros where r' is zero."""
    places = _chosen(slope, each)
    x, y, z = collect(full_q, places, 0), collect(full_q, places, 1), collect(full_q, places, 2)
    square = x * x + y * y + z * z
    factor = where(square > 0.0, 1.0 / sqrt(where(square > 0.0, square, 1.0)), 0.0)
    return factor * x, factor * y, factor * z


@kernel(forceinline=True)
def _store_rows(array, each, a, b, c, d):
    """Write columns of four members to their rows, of four numbers each."""
    rows = transposed(a, b, c, d)
    for k in range(LANES):
        store(array, LANES * each[k], rows[k])


@kernel
def _face(turning, full_q):
    for i in range(0, turning.slope.size, LANES):
        each = _four_from(i, turning.slope.size)
        x, y, z = _directions(turning.slope, each, full_q)
        _store_rows(turning.faced, each, x, y, z, z)
    turning.turned[0] = 0


@kernel
def _turn(turning, full_q):
    """A node that has turned by more than a right angle, or has no direction, is solved for as it was."""
    last = turning.slope.size
    for i in range(0, last, LANES):
        each = _four_from(i, last)
        x, y, z = _directions(turning.slope, each, full_q)
        x0, y0, z0, _ = load_rows(turning.faced, i, last)
        cosine = x0 * x + y0 * y + z0 * z
        counts = where(cosine > 0.0, 1.0, 0.0)
        _store_rows(
            turning.axis, each, counts * (y0 * z - z0 * y), counts * (z0 * x - x0 * z), counts * (x0 * y - y0 * x),
            counts / (1.0 + counts * cosine),
        )  # fmt: skip
    turning.turned[0] = 1


@kernel(forceinline=True)
def _rotated(w, s, x):
    """R x = x + w x x + s w x (w x x)."""
    u = w[1] * x[2] - w[2] * x[1], w[2] * x[0] - w[0] * x[2], w[0] * x[1] - w[1] * x[0]
    return (
        x[0] + u[0] + s * (w[1] * u[2] - w[2] * u[1]),
        x[1] + u[1] + s * (w[2] * u[0] - w[0] * u[2]),
        x[2] + u[2] + s * (w[0] * u[1] - w[1] * u[0]),
    )


@kernel
def _rotate(turning, sign, x):
    """Rotate r and r' of all nodes in a vector (n,) of unknowns; with the sign -1, back."""
    many = turning.both.size
    for i in range(0, many, LANES):
        each = _four_from(i, many)
        places = _chosen(turning.both, each)
        (r1, r2, r3, s1), (s2, s3) = collect_fours(x, places, 0), collect_pairs(x, places, LANES)
        w1, w2, w3, s = load_rows(turning.axis, i, many)
        w = sign * w1, sign * w2, sign * w3
        r1, r2, r3 = _rotated(w, s, (r1, r2, r3))
        s1, s2, s3 = _rotated(w, s, (s1, s2, s3))
        rows = transposed(r1, r2, r3, s1)
        for k in range(LANES):
            store(x, places[k], rows[k])
            x[places[k] + 4] = lane(s2, k)
            x[places[k] + 5] = lane(s3, k)
    for i in range(turning.alone.size):
        a, k = turning.alone[i], LANES * (many + i)
        w = sign * turning.axis[k], sign * turning.axis[k + 1], sign * turning.axis[k + 2]
        x[a], x[a + 1], x[a + 2] = _rotated(w, turning.axis[k + 3], (x[a], x[a + 1], x[a + 2]))


@kernel(forceinline=True)
def _to_faced(turning, x):
    if turning.turned[0] == 1:
        _rotate(turning, -1.0, x)


@kernel(forceinline=True)
def _to_turned(turning, x):
    if turning.turned[0] == 1:
        _rotate(turning, 1.0, x)


@kernel(forceinline=True)
def _stay(turning, vector):
    return


face = by_type({Turning: _face, Fixed: _stay})
"""Factors were made at a full position: that is how nodes faced."""
turn = by_type({Turning: _turn, Fixed: _stay})
"""Nodes are at another full position now."""
to_faced = by_type({Turning: _to_faced, Fixed: _stay})
"""Turn a right side (n,) into the axes in which the factors were made."""
to_turned = by_type({Turning: _to_turned, Fixed: _stay})
"""Turn a solution (n,) back into those of space."""
