"""Inertia and weight of cubic elements whose two nodes let material through at one rate, so that L is constant.

With u the rate of p, b its derivative, X the four vectors of the element and the constant matrices

    M = int N^T N,   C = int N^T N',   D = int N^T N'',   E = int N'^T N'   (over dp, times the mass per length)

the rows of position and slope are M a - C (b X + 2 u v) + u^2 D X - weight, and the sum of the rows of both p is
-[a.C X - b X.E X - 2 u v.E X + m u^2 (|r'_2|^2 - |r'_1|^2) / 2] + load.(r_2 - r_1): a quarter of the work of
`tautline.elements.flow`, which it equals. A node's p stands for both: they have one master, or move alike.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.cubic import AXES, MATERIAL, NODE, VECTORS, row_of, vectors
from tautline.elements.dense_blocks import BLOCK_WRITERS, mass_of_blocks, tangent_of_blocks
from tautline.kernels.groups import register
from tautline.kernels.hermite import FIRST, SECOND, SHAPE, WEIGHT, gauss, table
from tautline.kernels.jit import kernel


class SharedFlow(NamedTuple):
    """Elements (n,) of ``INERTIA``; ``unit`` (4, 4, 4) are M, C, D, E of an element of length one and mass one.

    Scratch are ``y`` (4, 3, 4), X, v, a with slopes times L and what acts on the p, and ``block`` (14, 14).
    """

    rows: np.recarray
    unit: np.ndarray
    y: np.ndarray
    block: np.ndarray


M, C, D, E = range(4)
X, V, A = range(3)


def unit_matrices() -> np.ndarray:
    """M, C, D, E (4, 4, 4) of the functions H on the unit interval, by an exact quadrature."""
    points = table(*gauss(4))
    h, h1, h2 = (points[:, k : k + VECTORS] for k in (SHAPE, FIRST, SECOND))
    w = points[:, WEIGHT, None]
    return np.array([h.T @ (w * h), h.T @ (w * h1), h.T @ (w * h2), h1.T @ (w * h1)])


@kernel
def _gather(g, e, q, v, a):
    """Write X, v and a with slopes times L; returns L."""
    first = vectors(e.a, e.b)
    length = q[e.b + MATERIAL] - q[e.a + MATERIAL]
    for j in range(VECTORS):
        factor = length if j % 2 == 1 else 1.0
        for c in range(AXES):
            g.y[X, c, j] = factor * q[first[j] + c]
            g.y[V, c, j] = factor * v[first[j] + c]
            g.y[A, c, j] = factor * a[first[j] + c]
    return length


@kernel
def times_c(x1, x2, x3, x4):
    """C X of an element of length and mass one."""
    return (
        0.5 * (x3 - x1) + 0.1 * (x2 - x4), 0.1 * (x3 - x1) - x4 / 60.0,
        0.5 * (x3 - x1) - 0.1 * (x2 - x4), 0.1 * (x1 - x3) + x2 / 60.0,
    )  # fmt: skip


@kernel
def times_e(x1, x2, x3, x4):
    """E X of an element of length and mass one, but for the third row, which is the first's opposite."""
    return (
        1.2 * (x1 - x3) + 0.1 * (x2 + x4), 0.1 * (x1 - x3) + (4.0 * x2 - x4) / 30.0,
        0.1 * (x1 - x3) + (4.0 * x4 - x2) / 30.0,
    )  # fmt: skip


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        e = g.rows[n]
        i, j, alpha = e.a, e.b, e.damping
        length = q[j + MATERIAL] - q[i + MATERIAL]
        u, b = v[i + MATERIAL], a[i + MATERIAL]
        turned, m420, pull = u * u / length, length / 420.0, 0.0
        for c in range(AXES):
            x1, x2, x3, x4 = q[i + c], length * q[i + 3 + c], q[j + c], length * q[j + 3 + c]
            v1, v2, v3, v4 = v[i + c], length * v[i + 3 + c], v[j + c], length * v[j + 3 + c]
            a1, a2 = a[i + c] + alpha * v1, length * a[i + 3 + c] + alpha * v2
            a3, a4 = a[j + c] + alpha * v3, length * a[j + 3 + c] + alpha * v4
            # What C is applied to: -(b + alpha u) X - 2 u v. D = -E but for its ends, where N N' is left.
            f, w = -(b + alpha * u), -2.0 * u
            w1, w2, w3, w4 = f * x1 + w * v1, f * x2 + w * v2, f * x3 + w * v3, f * x4 + w * v4
            c1, c2, c3, c4 = times_c(w1, w2, w3, w4)
            e1, e2, e4 = times_e(x1, x2, x3, x4)
            half = 0.5 * e.load[c] * length
            sixth = half * length / 6.0
            flow1, flow3 = c1 - turned * (e1 + x2), c3 + turned * (e1 + x4)
            r[i + c] += e.mass * (m420 * (156.0 * a1 + 22.0 * a2 + 54.0 * a3 - 13.0 * a4) + flow1) - half
            r[j + c] += e.mass * (m420 * (54.0 * a1 + 13.0 * a2 + 156.0 * a3 - 22.0 * a4) + flow3) - half
            slope = e.mass * length
            r[i + 3 + c] += slope * (m420 * (22.0 * a1 + 4.0 * a2 + 13.0 * a3 - 3.0 * a4) + c2 - turned * e2) - sixth
            r[j + 3 + c] += slope * (m420 * (-13.0 * a1 - 3.0 * a2 - 22.0 * a3 + 4.0 * a4) + c4 - turned * e4) + sixth
            c1, c2, c3, c4 = times_c(x1, x2, x3, x4)
            along = a1 * c1 + a2 * c2 + a3 * c3 + a4 * c4
            along += ((w1 - w3) * e1 + w2 * e2 + w4 * e4) / length
            s1, s2 = q[i + 3 + c], q[j + 3 + c]
            pull += e.load[c] * (x3 - x1) - e.mass * (along + 0.5 * u * u * (s2 * s2 - s1 * s1))
        r[i + MATERIAL] += pull


@kernel
def _write_block(g, e, q, v, a, cm, cc, ck):
    """cm M + cc C + ck K of an element (14, 14); the columns and rows of p are those of the first node's."""
    y, unit, block = g.y, g.unit, g.block
    length = _gather(g, e, q, v, a)
    u, b, m, alpha = v[e.a + MATERIAL], a[e.a + MATERIAL], e.mass, e.damping
    block.fill(0.0)
    for i in range(VECTORS):
        left = length if i % 2 == 1 else 1.0
        for j in range(VECTORS):
            right = length if j % 2 == 1 else 1.0
            scalar = (cm + alpha * cc) * length * unit[M, i, j] - (2.0 * u * cc + ck * (b + alpha * u)) * unit[C, i, j]
            scalar += ck * u * u / length * unit[D, i, j]
            for c in range(AXES):
                block[row_of(i) + c, row_of(j) + c] = m * left * right * scalar
                x, x_d = y[X, c, j], y[V, c, j]
                # Column of p: its acceleration turns C X, its rate 2 C v and 2 u D X.
                by_p = -cm * unit[C, i, j] * x
                by_p += cc * (2.0 * u / length * unit[D, i, j] * x - unit[C, i, j] * (2.0 * x_d + alpha * x))
                block[row_of(i) + c, MATERIAL] += m * left * by_p
                # Row of p: -[a.C X - b X.E X - 2 u v.E X], damped.
                by_x = -(cm + alpha * cc) * unit[C, i, j] * x + 2.0 * u * cc * unit[E, i, j] * x / length
                by_x -= ck * unit[C, j, i] * (y[A, c, j] + alpha * x_d)
                by_x += ck * unit[E, i, j] * (2.0 * (b + alpha * u) * x + 2.0 * u * x_d) / length
                block[MATERIAL, row_of(i) + c] += m * left * by_x
                both = unit[E, i, j] * y[X, c, i] / length
                block[MATERIAL, MATERIAL] += m * both * (cm * x + cc * (2.0 * x_d + alpha * x))
    for c in range(AXES):
        s1, s2 = q[e.a + AXES + c], q[e.b + AXES + c]
        block[MATERIAL, AXES + c] += ck * m * u * u * s1
        block[MATERIAL, NODE + AXES + c] -= ck * m * u * u * s2
        block[MATERIAL, MATERIAL] -= cc * m * u * (s2 * s2 - s1 * s1)
        block[MATERIAL, c] -= ck * e.load[c]
        block[MATERIAL, NODE + c] += ck * e.load[c]


BLOCK_WRITERS[SharedFlow] = _write_block


@kernel
def _energies(g, e, q, v):
    """Twice the kinetic energy of an element, and its potential energy."""
    y, unit = g.y, g.unit
    length = _gather(g, e, q, v, v)
    u = v[e.a + MATERIAL]
    kinetic = potential = 0.0
    for c in range(AXES):
        for i in range(VECTORS):
            for j in range(VECTORS):
                x, x_d = y[X, c, j], y[V, c, j]
                kinetic += length * unit[M, i, j] * y[V, c, i] * x_d - 2.0 * u * unit[C, i, j] * y[V, c, i] * x
                kinetic += u * u / length * unit[E, i, j] * y[X, c, i] * x
        middle = 0.5 * (y[X, c, 0] + y[X, c, 2]) + (y[X, c, 1] - y[X, c, 3]) / 12.0
        potential -= e.load[c] * length * middle
    return e.mass * kinetic, potential


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        kinetic, potential = _energies(g, g.rows[n], q, v)
        energy[0] += 0.5 * kinetic
        energy[2] += potential


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        e = g.rows[n]
        if e.damping != 0.0:
            p[0] += e.damping * _energies(g, e, q, v)[0]


@kernel
def _supply(g, t, q, v, p):
    """The energy of the material that an element takes in at its ends, which a drive must bring along."""
    for n in range(g.rows.size):
        e = g.rows[n]
        u = v[e.a + MATERIAL]
        taken = 0.0
        for c in range(AXES):
            out, into = v[e.b + c] - u * q[e.b + AXES + c], v[e.a + c] - u * q[e.a + AXES + c]
            taken += 0.5 * e.mass * (out * out - into * into) - e.load[c] * (q[e.b + c] - q[e.a + c])
        p[0] += taken * u


register(
    SharedFlow, residual=_residual, mass=mass_of_blocks, tangent=tangent_of_blocks, energy=_energy,
    dissipation=_dissipation,
    supply=_supply,
)  # fmt: skip
