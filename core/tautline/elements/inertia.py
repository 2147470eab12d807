"""Inertia and weight of cubic elements whose material does not move past their nodes (eqs 2.44, 2.50)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.cubic import (
    AXES,
    MATERIAL,
    VECTORS,
    add_scalar_in_a_row,
    add_scalars,
    corners_of,
    lengths_of,
    members,
    nodes_in_a_row,
    nodes_of,
    vectors,
)
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, add_to, collect, pack, spread

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


@kernel(forceinline=True)
def _momentum(r1, s1, r2, s2):
    """420 / (m h) times the consistent mass matrix' product with accelerations, or velocities, of four elements.

    The slopes' accelerations s1, s2 have been multiplied by the length h; the slopes' rows are still to be.
    """
    return (
        156.0 * r1 + 22.0 * s1 + 54.0 * r2 - 13.0 * s2,
        22.0 * r1 + 4.0 * s1 + 13.0 * r2 - 3.0 * s2,
        54.0 * r1 + 13.0 * s1 + 156.0 * r2 - 22.0 * s2,
        -13.0 * r1 - 3.0 * s1 - 22.0 * r2 + 4.0 * s2,
    )


@kernel(forceinline=True)
def _add_four(g, n, q, v, a, r, moving):
    """Add inertia (where ``moving``), damping by mass, and less the load, of four elements from the n-th on."""
    each, counts = members(n, g.rows.size)
    i, j = nodes_of(g.rows, each)
    h = lengths_of(q, i, j) * counts
    w, x, y, z = g.rows[each[0]], g.rows[each[1]], g.rows[each[2]], g.rows[each[3]]
    m = pack(w.mass, x.mass, y.mass, z.mass) * h / 420.0
    damped = w.damping != 0.0 or x.damping != 0.0 or y.damping != 0.0 or z.damping != 0.0
    damping = pack(w.damping, x.damping, y.damping, z.damping)
    half = 0.5 * h
    sixth = half * h / 6.0
    for c in range(AXES):
        r1 = s1 = r2 = s2 = spread(0.0)
        if moving:
            r1, s1 = collect(a, i, c), collect(a, i, AXES + c)
            r2, s2 = collect(a, j, c), collect(a, j, AXES + c)
        if damped:
            r1, s1 = r1 + damping * collect(v, i, c), s1 + damping * collect(v, i, AXES + c)
            r2, s2 = r2 + damping * collect(v, j, c), s2 + damping * collect(v, j, AXES + c)
        load = pack(w.load[c], x.load[c], y.load[c], z.load[c])
        on_r1, on_s1, on_r2, on_s2 = _momentum(r1, h * s1, r2, h * s2)
        add_to(r, i, c, m * on_r1 - load * half)
        add_to(r, i, AXES + c, m * h * on_s1 - load * sixth)
        add_to(r, j, c, m * on_r2 - load * half)
        add_to(r, j, AXES + c, m * h * on_s2 + load * sixth)


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(0, g.rows.size, LANES):
        _add_four(g, n, q, v, a, r, True)


@kernel
def _force(g, t, q, v, a, r):
    for n in range(0, g.rows.size, LANES):
        _add_four(g, n, q, v, a, r, False)


@kernel
def _mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        e = g.rows[n]
        _write_block(e.mass, _length(q, e.a, e.b), g.block)
        add_scalars(matrix, dofs, e.a, e.b, 1.0, g.block)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    number, flat, width = dofs.number, matrix.band.reshape(-1), matrix.band.shape[1]
    for n in range(0, g.rows.size, LANES):
        each, counts = members(n, g.rows.size)
        i, j = nodes_of(g.rows, each)
        if not nodes_in_a_row(number, matrix.band.shape[0], i, j):
            _add_one_by_one(g, n, q, cm, cc, matrix, dofs)
            continue
        w, x, y, z = g.rows[each[0]], g.rows[each[1]], g.rows[each[2]], g.rows[each[3]]
        h = lengths_of(q, i, j)
        m = pack(w.mass, x.mass, y.mass, z.mass) * h * counts / 420.0
        m = m * (cm + cc * pack(w.damping, x.damping, y.damping, z.damping))
        corners = corners_of(number, width, i, j)
        add_scalar_in_a_row(flat, width, corners, 0, 0, 156.0 * m)
        add_scalar_in_a_row(flat, width, corners, 1, 0, 22.0 * m * h)
        add_scalar_in_a_row(flat, width, corners, 1, 1, 4.0 * m * h * h)
        add_scalar_in_a_row(flat, width, corners, 2, 0, 54.0 * m)
        add_scalar_in_a_row(flat, width, corners, 2, 1, 13.0 * m * h)
        add_scalar_in_a_row(flat, width, corners, 2, 2, 156.0 * m)
        add_scalar_in_a_row(flat, width, corners, 3, 0, -13.0 * m * h)
        add_scalar_in_a_row(flat, width, corners, 3, 1, -3.0 * m * h * h)
        add_scalar_in_a_row(flat, width, corners, 3, 2, -22.0 * m * h)
        add_scalar_in_a_row(flat, width, corners, 3, 3, 4.0 * m * h * h)


@kernel
def _add_one_by_one(g, first, q, cm, cc, matrix, dofs):
    """The same for up to four elements, wherever their unknowns are."""
    for n in range(first, min(first + LANES, g.rows.size)):
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
