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
    add_to_vectors,
    corners_of,
    have_columns,
    lengths_of,
    members,
    nodes_in_a_row,
    nodes_of,
    vectors,
    vectors_of,
)
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, laid_flat, pack, spread
from tautline.kernels.vector import scaled_sum

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
def inertia_of_four(g, each, counts, i, j, q, v, a, moving):
    """Inertia (where ``moving``), damping by mass, less the load, of four elements on r1, r1', r2 and r2'.

    ``i`` and ``j`` are the places of their nodes. Three lanes each come back.
    """
    h = lengths_of(q, i, j) * counts
    w, x, y, z = g.rows[each[0]], g.rows[each[1]], g.rows[each[2]], g.rows[each[3]]
    m = pack(w.mass, x.mass, y.mass, z.mass) * h / 420.0
    damped = w.damping != 0.0 or x.damping != 0.0 or y.damping != 0.0 or z.damping != 0.0
    damping = pack(w.damping, x.damping, y.damping, z.damping)
    none = spread(0.0)
    r1 = s1 = r2 = s2 = (none, none, none)
    if moving:
        (r1, s1), (r2, s2) = vectors_of(a, i), vectors_of(a, j)
    if damped:
        (v1, w1), (v2, w2) = vectors_of(v, i), vectors_of(v, j)
        r1, s1 = scaled_sum(r1, damping, v1), scaled_sum(s1, damping, w1)
        r2, s2 = scaled_sum(r2, damping, v2), scaled_sum(s2, damping, w2)
    on_x = _force_along(r1[0], s1[0], r2[0], s2[0], m, h, pack(w.load[0], x.load[0], y.load[0], z.load[0]))
    on_y = _force_along(r1[1], s1[1], r2[1], s2[1], m, h, pack(w.load[1], x.load[1], y.load[1], z.load[1]))
    on_z = _force_along(r1[2], s1[2], r2[2], s2[2], m, h, pack(w.load[2], x.load[2], y.load[2], z.load[2]))
    return (
        (on_x[0], on_y[0], on_z[0]), (on_x[1], on_y[1], on_z[1]), (on_x[2], on_y[2], on_z[2]),
        (on_x[3], on_y[3], on_z[3]),
    )  # fmt: skip


@kernel(forceinline=True)
def _add_four(g, n, q, v, a, r, moving):
    """Add what works on four elements from the n-th on."""
    each, counts = members(n, g.rows.size)
    i, j = nodes_of(g.rows, each)
    on_r1, on_s1, on_r2, on_s2 = inertia_of_four(g, each, counts, i, j, q, v, a, moving)
    add_to_vectors(r, i, on_r1, on_s1)
    add_to_vectors(r, j, on_r2, on_s2)


@kernel(forceinline=True)
def _force_along(r1, s1, r2, s2, m, h, load):
    """Forces of four elements on r1, r1', r2 and r2' along one axis: of inertia, less the load per length."""
    on_r1, on_s1, on_r2, on_s2 = _momentum(r1, h * s1, r2, h * s2)
    half = 0.5 * h
    sixth = half * h / 6.0
    return (
        m * on_r1 - load * half, m * h * on_s1 - load * sixth, m * on_r2 - load * half, m * h * on_s2 + load * sixth
    )  # fmt: skip


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


@kernel(forceinline=True)
def mass_of_four(g, each, counts, i, j, q, cm, cc):
    """The lower half, by columns, of the mass matrices of four elements times cm + cc times their damping."""
    w, x, y, z = g.rows[each[0]], g.rows[each[1]], g.rows[each[2]], g.rows[each[3]]
    h = lengths_of(q, i, j)
    m = pack(w.mass, x.mass, y.mass, z.mass) * h * counts / 420.0
    m = m * (cm + cc * pack(w.damping, x.damping, y.damping, z.damping))
    own, turned = 156.0 * m, 4.0 * m * h * h
    return (
        (own, 22.0 * m * h, 54.0 * m, -13.0 * m * h), (turned, 13.0 * m * h, -3.0 * m * h * h),
        (own, -22.0 * m * h), (turned,),
    )  # fmt: skip


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    number, flat, width = dofs.number, laid_flat(matrix.band), matrix.band.shape[1]
    for n in range(0, g.rows.size, LANES):
        each, counts = members(n, g.rows.size)
        i, j = nodes_of(g.rows, each)
        if not nodes_in_a_row(number, matrix.band.shape[0], i, j):
            add_mass_one_by_one(g, n, q, cm, cc, matrix, dofs)
            continue
        have_columns(matrix, number, i, j)
        first, second, third, fourth = mass_of_four(g, each, counts, i, j, q, cm, cc)
        corners = corners_of(number, width, i, j)
        add_scalar_in_a_row(flat, width, corners, 0, 0, first[0])
        add_scalar_in_a_row(flat, width, corners, 1, 0, first[1])
        add_scalar_in_a_row(flat, width, corners, 1, 1, second[0])
        add_scalar_in_a_row(flat, width, corners, 2, 0, first[2])
        add_scalar_in_a_row(flat, width, corners, 2, 1, second[1])
        add_scalar_in_a_row(flat, width, corners, 2, 2, third[0])
        add_scalar_in_a_row(flat, width, corners, 3, 0, first[3])
        add_scalar_in_a_row(flat, width, corners, 3, 1, second[2])
        add_scalar_in_a_row(flat, width, corners, 3, 2, third[1])
        add_scalar_in_a_row(flat, width, corners, 3, 3, fourth[0])


@kernel
def add_mass_one_by_one(g, first, q, cm, cc, matrix, dofs):
    """Add the mass matrices of up to four elements, times cm + cc times damping, wherever their unknowns are."""
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
