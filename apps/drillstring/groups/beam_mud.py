"""Mud around and in a beam: the mass that follows its motion across the hole, and drag against it.

With w = v - t (t.v) the velocity across the hole, the mass has the kinetic energy m w.w / 2. Where the hole is bent,
the tangent turns with the point, and Lagrange's equations of that energy are m (a - t (t.a)) - m K (t.v)^2 / beta with
the curvature K of the axis. Drag is that of Morison's equation, D |w| w.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from drillstring.well.in_hole import AXES, Hole, add_directions, add_force, combined, hold_points, spot
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot

SLEEVE = np.dtype([(name, np.float64) for name in ("mass", "damping", "drag")])
"""Mud that moves with a point: mass kg; mass-proportional damping N s/m; drag D = rho C_d d l / 2, kg/m."""


class BeamMud(NamedTuple):
    """Mud (n,) of ``SLEEVE`` at the hole's points; ``scratch`` is zeros (3, 3)."""

    hole: Hole
    rows: np.recarray
    scratch: np.ndarray


class Wash(NamedTuple):
    """Directions at a point (t, and the axis's curvature), its velocity across the hole and along it, its speed."""

    t: tuple[float, float, float]
    bend: tuple[float, float, float]
    beta: float
    w: tuple[float, float, float]
    along: float
    speed: float


@kernel
def _wash(g, i, q, v):
    point, s = g.hole.points[i], spot(g.hole, i, q)
    vx, vy, vz = combined(point, v, 0), combined(point, v, 1), combined(point, v, 2)
    along = s.tx * vx + s.ty * vy + s.tz * vz
    w = (vx - along * s.tx, vy - along * s.ty, vz - along * s.tz)
    bend = (
        s.bend_e * s.ex + s.bend_f * s.fx, s.bend_e * s.ey + s.bend_f * s.fy, s.bend_e * s.ez + s.bend_f * s.fz,
    )  # fmt: skip
    speed = sqrt(dot(w, w))
    return Wash((s.tx, s.ty, s.tz), bend, s.beta, w, along, speed)


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    hold_points(g.hole, q)


@kernel
def _residual(g, t, q, v, a, r):
    for i in range(g.rows.size):
        p, point, c = g.rows[i], g.hole.points[i], _wash(g, i, q, v)
        acc = (combined(point, a, 0), combined(point, a, 1), combined(point, a, 2))
        up, loss = dot(c.t, acc), p.damping + p.drag * c.speed
        turn = p.mass * c.along * c.along / c.beta
        add_force(
            point, p.mass * (acc[0] - up * c.t[0]) + loss * c.w[0] - turn * c.bend[0],
            p.mass * (acc[1] - up * c.t[1]) + loss * c.w[1] - turn * c.bend[1],
            p.mass * (acc[2] - up * c.t[2]) + loss * c.w[2] - turn * c.bend[2], r,
        )  # fmt: skip


@kernel
def _mass(g, q, matrix, dofs):
    block = g.scratch
    for i in range(g.rows.size):
        s = spot(g.hole, i, q)
        t = (s.tx, s.ty, s.tz)
        for k in range(AXES):
            for l in range(AXES):
                block[k, l] = -g.rows[i].mass * t[k] * t[l]
            block[k, k] += g.rows[i].mass
        add_directions(matrix, dofs, g.hole.points[i], block)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    block = g.scratch
    for i in range(g.rows.size):
        p, point, c = g.rows[i], g.hole.points[i], _wash(g, i, q, v)
        acc = (combined(point, a, 0), combined(point, a, 1), combined(point, a, 2))
        loss = p.damping + p.drag * c.speed
        steep = p.drag / c.speed if c.speed > 0.0 else 0.0
        curved = dot(c.bend, c.bend)
        v_bend, a_bend, w_bend = dot(c.bend, c.w), dot(c.bend, acc), dot(c.w, c.bend)
        up = dot(c.t, acc)
        turn = p.mass * c.along / c.beta
        for l in range(AXES):
            way = c.t[l] / c.beta
            for k in range(AXES):
                one = 1.0 if k == l else 0.0
                across = one - c.t[k] * c.t[l]
                by_v = loss * across + steep * c.w[k] * c.w[l] - 2.0 * turn * c.bend[k] * c.t[l]
                # By position: the tangent turns, and with it what is across; the curvature's direction turns too.
                w_q = -way * (c.bend[k] * c.along + c.t[k] * v_bend)
                by_q = -p.mass * way * (c.bend[k] * up + c.t[k] * a_bend) + loss * w_q
                by_q -= steep * way * c.along * w_bend * c.w[k]
                by_q += turn * c.along * (curved * way * c.t[k] - c.bend[k] * c.bend[l] / c.beta)
                by_q -= 2.0 * turn * v_bend * way * c.bend[k]
                block[k, l] = cm * p.mass * across + cc * by_v + ck * by_q
        add_directions(matrix, dofs, point, block)


@kernel
def _energy(g, t, q, v, e):
    for i in range(g.rows.size):
        e[0] += 0.5 * g.rows[i].mass * _wash(g, i, q, v).speed ** 2


@kernel
def _dissipation(g, t, q, v, p):
    for i in range(g.rows.size):
        speed = _wash(g, i, q, v).speed
        p[0] += (g.rows[i].damping + g.rows[i].drag * speed) * speed * speed


register(
    BeamMud, begin=_begin, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy, dissipation=_dissipation
)
