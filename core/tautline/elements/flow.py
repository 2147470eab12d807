"""Inertia and weight of cubic elements through whose nodes material moves: M and Q_p of eqs 2.44 and 2.46.

A particle keeps its material coordinate p while nodes and their material coordinates move. With u the rate at which
material coordinates change at a place inside the element and b its derivative,

    r.. = N a + L.. r_L - b r' + 2 (L. v_L - u v') + 2 L. u W + u^2 r'',      G_a = sigma_a r_L - phi_a r',

where ``_L`` is the derivative by L at a fixed place x, W = -r'_L, sigma = (-1, 1), phi = (1 - x, x), and G_a is how a
particle moves with p_a. Derivatives of all of it are needed by L alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.cubic import AXES, MATERIAL, NODE, VECTORS, row_of, vectors
from tautline.elements.dense_blocks import BLOCK_WRITERS, mass_of_blocks, tangent_of_blocks
from tautline.elements.length_alarm import report_empty
from tautline.kernels.groups import register
from tautline.kernels.hermite import FIRST, PLACE, SECOND, SHAPE, WEIGHT
from tautline.kernels.jit import kernel


class Flow(NamedTuple):
    """Elements (n,) of ``INERTIA``.

    ``points`` (k, 18) is the table of the shape functions; scratch are ``shapes`` (6, 4), the same at one point with
    their powers of L, ``vector`` (10, 3) and ``block`` (14, 14).
    """

    rows: np.recarray
    points: np.ndarray
    shapes: np.ndarray
    vector: np.ndarray
    block: np.ndarray


N, NX, NXX, NL, NXL, NXXL = range(6)
"""Rows of ``shapes``: N, N', N'' and their derivatives by L at a fixed place."""


@kernel
def write_shapes(point, length, shapes):
    """The shape functions and their derivatives by p and by L at a point, with their powers of L."""
    h = 1.0 / length
    for k in range(VECTORS):
        slope = k % 2 == 1
        value, first, second = point[SHAPE + k], point[FIRST + k], point[SECOND + k]
        shapes[N, k] = length * value if slope else value
        shapes[NX, k] = first if slope else first * h
        shapes[NXX, k] = second * h if slope else second * h * h
        shapes[NL, k] = value if slope else 0.0
        shapes[NXL, k] = 0.0 if slope else -first * h * h
        shapes[NXXL, k] = -second * h * h if slope else -2.0 * second * h * h * h


@kernel
def combine(weights, x, first, c):
    """Sum of weights (4,) times component c of X1 ... X4."""
    return (
        weights[0] * x[first[0] + c] + weights[1] * x[first[1] + c]
        + weights[2] * x[first[2] + c] + weights[3] * x[first[3] + c]
    )  # fmt: skip


@kernel
def _residual(g, t, q, v, a, r):
    s = g.shapes
    for n in range(g.rows.size):
        e = g.rows[n]
        first = vectors(e.a, e.b)
        p1, p2 = e.a + MATERIAL, e.b + MATERIAL
        length = q[p2] - q[p1]
        l_d, l_dd = v[p2] - v[p1], a[p2] - a[p1]
        r1 = r2 = 0.0
        for k in range(g.points.shape[0]):
            x, weight = g.points[k, PLACE], g.points[k, WEIGHT] * length
            write_shapes(g.points[k], length, s)
            u = (1.0 - x) * v[p1] + x * v[p2]
            b = (1.0 - x) * a[p1] + x * a[p2]
            for c in range(AXES):
                slope, turn = combine(s[NX], q, first, c), combine(s[NXX], q, first, c)
                r_l, w = combine(s[NL], q, first, c), -combine(s[NXL], q, first, c)
                v_l, v_x = combine(s[NL], v, first, c), combine(s[NX], v, first, c)
                inertia = combine(s[N], a, first, c) + l_dd * r_l - b * slope
                inertia += 2.0 * (l_d * v_l - u * v_x) + 2.0 * l_d * u * w + u * u * turn
                inertia += e.damping * (combine(s[N], v, first, c) + l_d * r_l - u * slope)
                force = weight * (e.mass * inertia - e.load[c])
                for i in range(VECTORS):
                    r[first[i] + c] += s[N, i] * force
                r1 += (-r_l - (1.0 - x) * slope) * force
                r2 += (r_l - x * slope) * force
        r[p1] += r1
        r[p2] += r2


E, TURN, W, RL, B, BL, G1, G2, P1, P2 = range(10)
"""Rows of ``vector`` at a point: r', r'', W, r_L, the acceleration without the load's, its derivative by L, G_1, G_2,
and its derivatives by the rates of p_1 and p_2."""


@kernel
def _write_vectors(g, e, k, q, v, a, first, p1, p2):
    """Everything of a point that the tangent needs."""
    s, z = g.shapes, g.vector
    length = q[p2] - q[p1]
    l_d, l_dd = v[p2] - v[p1], a[p2] - a[p1]
    x = g.points[k, PLACE]
    u = (1.0 - x) * v[p1] + x * v[p2]
    b = (1.0 - x) * a[p1] + x * a[p2]
    for c in range(AXES):
        slope, turn = combine(s[NX], q, first, c), combine(s[NXX], q, first, c)
        r_l, w = combine(s[NL], q, first, c), -combine(s[NXL], q, first, c)
        v_l, v_x, v_w = combine(s[NL], v, first, c), combine(s[NX], v, first, c), -combine(s[NXL], v, first, c)
        z[E, c], z[TURN, c], z[W, c], z[RL, c] = slope, turn, w, r_l
        inertia = combine(s[N], a, first, c) + l_dd * r_l - b * slope
        inertia += 2.0 * (l_d * v_l - u * v_x) + 2.0 * l_d * u * w + u * u * turn
        inertia += e.damping * (combine(s[N], v, first, c) + l_d * r_l - u * slope)
        z[B, c] = e.mass * inertia - e.load[c]
        by_l = combine(s[NL], a, first, c) + b * w + 2.0 * u * v_w - 4.0 * l_d * u * w / length
        by_l += u * u * combine(s[NXXL], q, first, c) + e.damping * (v_l + u * w)
        z[BL, c] = e.mass * by_l
        g1, g2 = -r_l - (1.0 - x) * slope, r_l - x * slope
        z[G1, c], z[G2, c] = g1, g2
        gv1, gv2 = -v_l - (1.0 - x) * v_x, v_l - x * v_x
        # D_ab of both rates: (sigma_a phi_b + sigma_b phi_a) W + phi_a phi_b r''
        d1 = (-u + (1.0 - x) * l_d) * w + (1.0 - x) * u * turn
        d2 = (u + x * l_d) * w + x * u * turn
        z[P1, c] = e.mass * (2.0 * gv1 + 2.0 * d1 + e.damping * g1)
        z[P2, c] = e.mass * (2.0 * gv2 + 2.0 * d2 + e.damping * g2)
    return length, l_d, l_dd, u, b, x


@kernel
def _write_block(g, e, q, v, a, cm, cc, ck):
    """cm M + cc C + ck K of an element (14, 14)."""
    s, z, block = g.shapes, g.vector, g.block
    first = vectors(e.a, e.b)
    p1, p2 = e.a + MATERIAL, e.b + MATERIAL
    m = e.mass
    block.fill(0.0)
    for k in range(g.points.shape[0]):
        length = q[p2] - q[p1]
        write_shapes(g.points[k], length, s)
        length, l_d, l_dd, u, b, x = _write_vectors(g, e, k, q, v, a, first, p1, p2)
        weight = g.points[k, WEIGHT]
        for j in range(VECTORS):
            by_x = l_dd * s[NL, j] - b * s[NX, j] - 2.0 * l_d * u * s[NXL, j] + u * u * s[NXX, j]
            by_x += e.damping * (l_d * s[NL, j] - u * s[NX, j])
            by_v = 2.0 * (l_d * s[NL, j] - u * s[NX, j]) + e.damping * s[N, j]
            scalar = m * (cm * s[N, j] + cc * by_v + ck * by_x)
            column = row_of(j)
            for c in range(AXES):
                for i in range(VECTORS):
                    block[row_of(i) + c, column + c] += weight * length * s[N, i] * scalar
                block[MATERIAL, column + c] += (
                    weight * length * (z[G1, c] * scalar + ck * (-s[NL, j] - (1.0 - x) * s[NX, j]) * z[B, c])
                )
                block[NODE + MATERIAL, column + c] += (
                    weight * length * (z[G2, c] * scalar + ck * (s[NL, j] - x * s[NX, j]) * z[B, c])
                )
        for side in range(2):
            sign = 2.0 * side - 1.0
            column = side * NODE + MATERIAL
            for c in range(AXES):
                by_p = cm * m * z[G1 + side, c] + cc * z[P1 + side, c] + ck * sign * z[BL, c]
                grown = ck * sign * z[B, c]
                for i in range(VECTORS):
                    block[row_of(i) + c, column] += weight * (
                        length * s[N, i] * by_p + (s[N, i] + length * s[NL, i]) * grown
                    )
                block[MATERIAL, column] += weight * (
                    length * (z[G1, c] * by_p + (1.0 - x) * z[W, c] * grown) + z[G1, c] * grown
                )
                block[NODE + MATERIAL, column] += weight * (
                    length * (z[G2, c] * by_p + x * z[W, c] * grown) + z[G2, c] * grown
                )


BLOCK_WRITERS[Flow] = _write_block


@kernel
def _energies(g, n, q, v):
    """Twice the kinetic energy of an element, and its potential energy."""
    e, s = g.rows[n], g.shapes
    first = vectors(e.a, e.b)
    p1, p2 = e.a + MATERIAL, e.b + MATERIAL
    length = q[p2] - q[p1]
    l_d = v[p2] - v[p1]
    kinetic = potential = 0.0
    for k in range(g.points.shape[0]):
        write_shapes(g.points[k], length, s)
        x, weight = g.points[k, PLACE], g.points[k, WEIGHT] * length
        u = (1.0 - x) * v[p1] + x * v[p2]
        for c in range(AXES):
            speed = combine(s[N], v, first, c) + l_d * combine(s[NL], q, first, c) - u * combine(s[NX], q, first, c)
            kinetic += weight * e.mass * speed * speed
            potential -= weight * e.load[c] * combine(s[N], q, first, c)
    return kinetic, potential


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        kinetic, potential = _energies(g, n, q, v)
        energy[0] += 0.5 * kinetic
        energy[2] += potential


@kernel
def _carried(e, node, q, v):
    """Energy that moving material carries past a node towards larger p, W: what leaves the element before it."""
    rate = v[node + MATERIAL]
    kinetic = potential = 0.0
    for c in range(AXES):
        speed = v[node + c] - rate * q[node + AXES + c]
        kinetic += 0.5 * e.mass * speed * speed
        potential -= e.load[c] * q[node + c]
    return (kinetic + potential) * rate


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        if g.rows[n].damping != 0.0:
            p[0] += g.rows[n].damping * _energies(g, n, q, v)[0]


@kernel
def _supply(g, t, q, v, p):
    """The energy of the material that an element takes in at its ends, which a drive must bring along."""
    for n in range(g.rows.size):
        e = g.rows[n]
        p[0] += _carried(e, e.b, q, v) - _carried(e, e.a, q, v)


@kernel
def watch_length(g, t, q, alarm):
    """Raise the alarm of an element whose length is gone."""
    report_empty(g.rows, MATERIAL, q, alarm)


register(
    Flow, residual=_residual, mass=mass_of_blocks, tangent=tangent_of_blocks, energy=_energy, dissipation=_dissipation,
    supply=_supply,
    alarm=watch_length,
)  # fmt: skip
