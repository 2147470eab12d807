"""Centres of gravity off a beam's axis: what drives whirl.

The centre of gravity is at x + e, where e turns with the beam: e = e1 b1 + e2 b2, b1 = m1 cos theta + m2 sin theta and
b2 = t x b1 in the hole's frame. Of the kinetic energy m |x' + e'|^2 / 2 the part of x' alone belongs to the element;
the rest gives, with g = t x e, the force m (theta'' g - theta'^2 e) and the moment m (g.x'' + e^2 theta'') - W g.down.
The frame is that at the start of a step: within one a point moves along the hole by too little to turn it.
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

import numpy as np

from drillstring.well.in_hole import AXES, Hole, hold_points, write_frame
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

OFF_AXIS = np.dtype(
    [(name, np.float64) for name in ("mass", "weight", "e1", "e2")] + [("m1", "f8", (AXES,)), ("m2", "f8", (AXES,))]
)
"""A mass off the axis: kg, weight in the mud N, offsets m; the frame (m1, m2) that is held through a step."""


class BeamEccentricity(NamedTuple):
    """Masses (n,) of ``OFF_AXIS`` at the hole's points, which are nodes."""

    hole: Hole
    rows: np.recarray


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    hold_points(g.hole, q)
    for i in range(g.rows.size):
        write_frame(g.hole, i, q, g.rows[i].m1, g.rows[i].m2)


@kernel
def _arms(g, i, q):
    """e and t x e, north, east, down."""
    p = g.rows[i]
    c, s = cos(q[g.hole.points[i].turn[0]]), sin(q[g.hole.points[i].turn[0]])
    x, y = p.e1 * c - p.e2 * s, p.e1 * s + p.e2 * c
    return (
        (x * p.m1[0] + y * p.m2[0], x * p.m1[1] + y * p.m2[1], x * p.m1[2] + y * p.m2[2]),
        (x * p.m2[0] - y * p.m1[0], x * p.m2[1] - y * p.m1[1], x * p.m2[2] - y * p.m1[2]),
    )


@kernel
def _residual(g, t, q, v, a, r):
    for i in range(g.rows.size):
        p, o, turn = g.rows[i], g.hole.points[i].place[0], g.hole.points[i].turn[0]
        e, f = _arms(g, i, q)
        r[turn] += p.mass * (p.e1 * p.e1 + p.e2 * p.e2) * a[turn] - p.weight * f[2]
        for c in range(AXES):
            r[o + c] += p.mass * (a[turn] * f[c] - v[turn] * v[turn] * e[c])
            r[turn] += p.mass * f[c] * a[o + c]


@kernel
def _mass(g, q, matrix, dofs):
    for i in range(g.rows.size):
        p, o, turn = g.rows[i], g.hole.points[i].place[0], g.hole.points[i].turn[0]
        _, f = _arms(g, i, q)
        add_entry(matrix, dofs, turn, turn, p.mass * (p.e1 * p.e1 + p.e2 * p.e2))
        for c in range(AXES):
            add_entry(matrix, dofs, o + c, turn, p.mass * f[c])
            add_entry(matrix, dofs, turn, o + c, p.mass * f[c])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.rows.size):
        p, o, turn = g.rows[i], g.hole.points[i].place[0], g.hole.points[i].turn[0]
        e, f = _arms(g, i, q)
        own = cm * p.mass * (p.e1 * p.e1 + p.e2 * p.e2) + ck * p.weight * e[2]
        for c in range(AXES):
            own -= ck * p.mass * e[c] * a[o + c]
            by_turn = cm * f[c] - cc * 2.0 * v[turn] * e[c] - ck * (a[turn] * e[c] + v[turn] * v[turn] * f[c])
            add_entry(matrix, dofs, o + c, turn, p.mass * by_turn)
            add_entry(matrix, dofs, turn, o + c, cm * p.mass * f[c])
        add_entry(matrix, dofs, turn, turn, own)


@kernel
def _energy(g, t, q, v, energy):
    for i in range(g.rows.size):
        p, o, turn = g.rows[i], g.hole.points[i].place[0], g.hole.points[i].turn[0]
        e, f = _arms(g, i, q)
        energy[0] += 0.5 * p.mass * (p.e1 * p.e1 + p.e2 * p.e2) * v[turn] * v[turn]
        energy[2] -= p.weight * e[2]
        for c in range(AXES):
            energy[0] += p.mass * v[turn] * f[c] * v[o + c]


register(BeamEccentricity, begin=_begin, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy)
