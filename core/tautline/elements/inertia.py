"""Inertia and weight of cubic elements whose material does not move past their nodes (eqs 2.44, 2.50)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.cubic import AXES, MATERIAL, VECTORS, add_scalars, vectors
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

INERTIA = np.dtype([("a", "i8"), ("b", "i8"), ("mass", "f8"), ("damping", "f8"), ("load", "f8", (3,))])
"""An element: its nodes' places, mass kg/m, mass-proportional damping 1/s (eq. 2.168), load with the weight N/m."""


class Inertia(NamedTuple):
    """Elements (n,) of ``INERTIA``; ``block`` is zeros (4, 4)."""

    rows: np.recarray
    block: np.ndarray


@kernel
def _length(q, a, b):
    return q[b + MATERIAL] - q[a + MATERIAL]


@kernel
def _write_block(mass, length, block):
    """The consistent mass matrix, a scalar for each pair of X1 ... X4."""
    m = mass * length / 420.0
    h = length
    block[0, 0] = block[2, 2] = 156.0 * m
    block[1, 1] = block[3, 3] = 4.0 * h * h * m
    block[0, 1] = block[1, 0] = 22.0 * h * m
    block[0, 2] = block[2, 0] = 54.0 * m
    block[0, 3] = block[3, 0] = -13.0 * h * m
    block[1, 2] = block[2, 1] = 13.0 * h * m
    block[1, 3] = block[3, 1] = -3.0 * h * h * m
    block[2, 3] = block[3, 2] = -22.0 * h * m


@kernel
def _add_momentum(e, h, factor, x, r):
    """r += factor M x, for an element of length h."""
    i, j = e.a, e.b
    m = factor * e.mass * h / 420.0
    for c in range(AXES):
        x1, x2, x3, x4 = x[i + c], h * x[i + 3 + c], x[j + c], h * x[j + 3 + c]
        r[i + c] += m * (156.0 * x1 + 22.0 * x2 + 54.0 * x3 - 13.0 * x4)
        r[i + 3 + c] += m * h * (22.0 * x1 + 4.0 * x2 + 13.0 * x3 - 3.0 * x4)
        r[j + c] += m * (54.0 * x1 + 13.0 * x2 + 156.0 * x3 - 22.0 * x4)
        r[j + 3 + c] += m * h * (-13.0 * x1 - 3.0 * x2 - 22.0 * x3 + 4.0 * x4)


@kernel
def _subtract_force(e, h, v, r):
    if e.damping != 0.0:
        _add_momentum(e, h, e.damping, v, r)
    for c in range(AXES):
        if e.load[c] != 0.0:
            half = 0.5 * e.load[c] * h
            sixth = half * h / 6.0
            r[e.a + c] -= half
            r[e.a + 3 + c] -= sixth
            r[e.b + c] -= half
            r[e.b + 3 + c] += sixth


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        h = _length(q, g.rows[n].a, g.rows[n].b)
        _add_momentum(g.rows[n], h, 1.0, a, r)
        _subtract_force(g.rows[n], h, v, r)


@kernel
def _force(g, t, q, v, a, r):
    for n in range(g.rows.size):
        _subtract_force(g.rows[n], _length(q, g.rows[n].a, g.rows[n].b), v, r)


@kernel
def _mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        e = g.rows[n]
        _write_block(e.mass, _length(q, e.a, e.b), g.block)
        add_scalars(matrix, dofs, e.a, e.b, 1.0, g.block)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        e = g.rows[n]
        _write_block(e.mass, _length(q, e.a, e.b), g.block)
        add_scalars(matrix, dofs, e.a, e.b, cm + cc * e.damping, g.block)


@kernel
def _twice_kinetic(g, n, q, v):
    e = g.rows[n]
    _write_block(e.mass, _length(q, e.a, e.b), g.block)
    first = vectors(e.a, e.b)
    total = 0.0
    for i in range(VECTORS):
        for j in range(VECTORS):
            for c in range(AXES):
                total += g.block[i, j] * v[first[i] + c] * v[first[j] + c]
    return total


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        e = g.rows[n]
        energy[0] += 0.5 * _twice_kinetic(g, n, q, v)
        h = _length(q, e.a, e.b)
        for c in range(AXES):
            mean = 0.5 * (q[e.a + c] + q[e.b + c]) + h / 12.0 * (q[e.a + 3 + c] - q[e.b + 3 + c])
            energy[2] -= e.load[c] * h * mean


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        if g.rows[n].damping != 0.0:
            p[0] += g.rows[n].damping * _twice_kinetic(g, n, q, v)


register(
    Inertia, residual=_residual, force=_force, mass=_mass, tangent=_tangent, energy=_energy, dissipation=_dissipation,
    constant_mass=True,
)  # fmt: skip
