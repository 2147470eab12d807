"""Points of a beam and where they stand in the hole: the nearest place of its axis, and the directions there.

A point's position x is a sum of weights times vectors of unknowns: a node's position alone, or the four vectors of the
cubic element that it lies in. The hole is a chain of arcs. On an arc that begins at r0 with the Bishop frame (m1, m2,
t0) and curvature (k1, k2), k = |(k1, k2)|, let n be the unit vector towards the arc's centre, b and c the components of
x - r0 on n and t0, and R = sqrt((1 - k b)^2 + (k c)^2). The nearest place of the axis then lies at the angle phi of
cos phi = (1 - k b) / R and sin phi = k c / R, and x is off it by (1 - R) / k towards the centre. No angle is needed,
and written as (2 b - k (b^2 + c^2)) / (1 + R) the offset holds on straight hole too.

As in the lumped model a point keeps to its arc through a step, and the arc goes on beyond its ends.
"""

from __future__ import annotations

from math import atan2, sqrt
from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_entry
from tautline.kernels.jit import kernel

AXES, MOST = 3, 4
"""Components of a vector; vectors that a point depends on at most."""
CENTRED = 1.0e-12
"""Offset from the hole's axis, m, below which no direction to the wall is defined: that of rounding."""

PIECE = np.dtype(
    [("start", "f8"), ("k1", "f8"), ("k2", "f8")] + [(name, "f8", (3,)) for name in ("origin", "m1", "m2", "t")]
)
"""An arc of the hole: measured depth of its start m, curvature 1/m; position m and Bishop frame there."""

POINT = np.dtype(
    [("vectors", "i8"), ("turns", "i8"), ("place", "i8", (MOST,)), ("turn", "i8", (2,)), ("arc", "i8")]
    + [("weight", "f8", (MOST,)), ("share", "f8", (2,))]
    + [("found", "i8")]
    + [(name, "f8") for name in ("x", "y", "z")]
    + [(name, "f8") for name in "tx ty tz ex ey ez fx fy fz offset bend_e bend_f beta".split()]
)
"""A point of the beam: how many vectors and rotations it depends on, where those begin or are in the full vector, the
arc that it is held to, and their weights (of slopes in m). Then the last `Spot` that was found: of which arc, counted
from 1 (0: none), at which position m, and what it was."""


class Hole(NamedTuple):
    """Arcs (m,) of ``PIECE`` from the straight above the table down, and points (n,) of ``POINT``."""

    arcs: np.recarray
    points: np.recarray


class Spot(NamedTuple):
    """Where a point is: the hole's tangent t, the unit vector e from the axis to it, f = t x e, and its offset m.

    ``bend_e`` and ``bend_f`` 1/m are the axis's curvature on e and f, and ``beta`` = 1 - bend_e offset.
    """

    tx: float
    ty: float
    tz: float
    ex: float
    ey: float
    ez: float
    fx: float
    fy: float
    fz: float
    offset: float
    bend_e: float
    bend_f: float
    beta: float


@kernel
def combined(point, x, c):
    """Component c of a point's position, velocity or acceleration, from the full vector of them."""
    total = 0.0
    for k in range(point.vectors):
        total += point.weight[k] * x[point.place[k] + c]
    return total


@kernel
def turned(point, x):
    """Rotation of the beam at a point, or its rate, from the full vector."""
    total = 0.0
    for k in range(point.turns):
        total += point.share[k] * x[point.turn[k]]
    return total


@kernel
def _into_arc(arc, x, y, z):
    """Measured depth of the place of an arc that is nearest to a point."""
    x, y, z = x - arc.origin[0], y - arc.origin[1], z - arc.origin[2]
    along = x * arc.t[0] + y * arc.t[1] + z * arc.t[2]
    k = sqrt(arc.k1 * arc.k1 + arc.k2 * arc.k2)
    if k == 0.0:
        return arc.start + along
    a1 = x * arc.m1[0] + y * arc.m1[1] + z * arc.m1[2]
    a2 = x * arc.m2[0] + y * arc.m2[1] + z * arc.m2[2]
    return arc.start + atan2(k * along, 1.0 - arc.k1 * a1 - arc.k2 * a2) / k


@kernel
def hold_points(hole, q):
    """Choose the arc of every point for the step that begins at q."""
    last = hole.arcs.size - 1
    for i in range(hole.points.size):
        p = hole.points[i]
        x, y, z = combined(p, q, 0), combined(p, q, 1), combined(p, q, 2)
        j = p.arc
        while j < last and _into_arc(hole.arcs[j], x, y, z) >= hole.arcs[j + 1].start:
            j += 1
        while j > 0 and _into_arc(hole.arcs[j], x, y, z) < hole.arcs[j].start:
            j -= 1
        p.arc = j


@kernel
def spot(hole, i, q):
    """Where point i is in the hole. Wall and mud ask for one position several times in a step: it is found once."""
    p = hole.points[i]
    x, y, z = combined(p, q, 0), combined(p, q, 1), combined(p, q, 2)
    if p.found != p.arc + 1 or p.x != x or p.y != y or p.z != z:
        s = _found(hole.arcs[p.arc], x, y, z)
        p.found, p.x, p.y, p.z = p.arc + 1, x, y, z
        p.tx, p.ty, p.tz, p.ex, p.ey, p.ez = s.tx, s.ty, s.tz, s.ex, s.ey, s.ez
        p.fx, p.fy, p.fz, p.offset, p.bend_e, p.bend_f, p.beta = s.fx, s.fy, s.fz, s.offset, s.bend_e, s.bend_f, s.beta
        return s
    return Spot(p.tx, p.ty, p.tz, p.ex, p.ey, p.ez, p.fx, p.fy, p.fz, p.offset, p.bend_e, p.bend_f, p.beta)


def found_depth(hole: Hole, i: int) -> float:
    """Measured depth, m, of the place of the axis where point i was found last."""
    p = hole.points[i]
    return float(_into_arc(hole.arcs[p.arc], p.x, p.y, p.z))


@kernel
def _found(arc, x, y, z):
    """Where a position is along an arc of the hole."""
    x, y, z = x - arc.origin[0], y - arc.origin[1], z - arc.origin[2]
    a1 = x * arc.m1[0] + y * arc.m1[1] + z * arc.m1[2]
    a2 = x * arc.m2[0] + y * arc.m2[1] + z * arc.m2[2]
    along = x * arc.t[0] + y * arc.t[1] + z * arc.t[2]
    k = sqrt(arc.k1 * arc.k1 + arc.k2 * arc.k2)
    n1, n2, cosine, sine = 1.0, 0.0, 1.0, 0.0
    inward, aside = a1, a2
    if k > 0.0:
        n1, n2 = arc.k1 / k, arc.k2 / k
        b = n1 * a1 + n2 * a2
        near, far = 1.0 - k * b, k * along
        r = sqrt(near * near + far * far)
        over = 1.0 / r
        cosine, sine = near * over, far * over
        inward, aside = (2.0 * b - k * (b * b + along * along)) / (1.0 + r), n1 * a2 - n2 * a1
    # The vector towards the centre turns with the tangent; that square to the arc's plane stays.
    nx, ny, nz = _mix(arc.m1, arc.m2, n1, n2)
    wx, wy, wz = _mix(arc.m1, arc.m2, -n2, n1)
    tx, ty, tz = cosine * arc.t[0] + sine * nx, cosine * arc.t[1] + sine * ny, cosine * arc.t[2] + sine * nz
    nx, ny, nz = cosine * nx - sine * arc.t[0], cosine * ny - sine * arc.t[1], cosine * nz - sine * arc.t[2]
    offset = sqrt(inward * inward + aside * aside)
    en, ew = 1.0, 0.0
    if offset >= CENTRED:
        en, ew = inward / offset, aside / offset
    return Spot(
        tx, ty, tz, en * nx + ew * wx, en * ny + ew * wy, en * nz + ew * wz,
        en * wx - ew * nx, en * wy - ew * ny, en * wz - ew * nz, offset, k * en, -k * ew, 1.0 - k * inward,
    )  # fmt: skip


@kernel
def write_frame(hole, i, q, m1, m2):
    """Write the unit vectors m1 and m2 (3,) of the Bishop frame where point i is."""
    arc = hole.arcs[hole.points[i].arc]
    s = spot(hole, i, q)
    k = sqrt(arc.k1 * arc.k1 + arc.k2 * arc.k2)
    n1, n2 = (arc.k1 / k, arc.k2 / k) if k > 0.0 else (1.0, 0.0)
    w = _mix(arc.m1, arc.m2, -n2, n1)
    n = (w[1] * s.tz - w[2] * s.ty, w[2] * s.tx - w[0] * s.tz, w[0] * s.ty - w[1] * s.tx)
    for c in range(AXES):
        m1[c] = n1 * n[c] - n2 * w[c]
        m2[c] = n2 * n[c] + n1 * w[c]


@kernel
def _mix(first, second, a, b):
    return a * first[0] + b * second[0], a * first[1] + b * second[1], a * first[2] + b * second[2]


@kernel
def add_force(point, x, y, z, r):
    """Add a force on a point to the rows of what it depends on."""
    for k in range(point.vectors):
        o, w = point.place[k], point.weight[k]
        r[o] += w * x
        r[o + 1] += w * y
        r[o + 2] += w * z


@kernel
def add_moment(point, m, r):
    """Add a moment about the beam's line at a point."""
    for k in range(point.turns):
        r[point.turn[k]] += point.share[k] * m


@kernel
def add_directions(matrix, dofs, point, block):
    """Add a block (3, 3) of a force by a point's position to a matrix."""
    for k in range(point.vectors):
        for l in range(point.vectors):
            w = point.weight[k] * point.weight[l]
            for c in range(AXES):
                for d in range(AXES):
                    add_entry(matrix, dofs, point.place[k] + c, point.place[l] + d, w * block[c, d])


@kernel
def add_rotations(matrix, dofs, point, block):
    """Add the last row and column of a block (4, 4), those of the rotation, to a matrix."""
    for m in range(point.turns):
        turn, share = point.turn[m], point.share[m]
        for k in range(point.vectors):
            for c in range(AXES):
                w = point.weight[k] * share
                add_entry(matrix, dofs, point.place[k] + c, turn, w * block[c, AXES])
                add_entry(matrix, dofs, turn, point.place[k] + c, w * block[AXES, c])
        for l in range(point.turns):
            add_entry(matrix, dofs, turn, point.turn[l], share * point.share[l] * block[AXES, AXES])
