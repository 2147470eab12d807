"""Linear ALE elements without moving material: inertia, weight, axial stiffness and damping (eqs 2.21-2.24).

The unknowns are (r1, p1, r2, p2); r' = (r2 - r1) / L is constant in an element and jumps at nodes. Stiffness needs no
second kind for moving material: with one strain an element's rows of p are no more work than to leave them out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.length_alarm import report_empty
from tautline.elements.slackening import edges_of_slack
from tautline.elements.tension import is_slack, strain_of
from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.groups import Edge, register
from tautline.kernels.jit import kernel

NODE, MATERIAL, AXES = 4, 3, 3
"""Unknowns of a node; place of p among them; components of a vector."""


class LinearInertia(NamedTuple):
    """Elements (n,) of ``INERTIA``."""

    rows: np.recarray


@kernel
def _inertia_residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        e = g.rows[n]
        i, j = e.a, e.b
        length = q[j + MATERIAL] - q[i + MATERIAL]
        m = e.mass * length / 6.0
        for c in range(AXES):
            x1, x2 = a[i + c] + e.damping * v[i + c], a[j + c] + e.damping * v[j + c]
            half = 0.5 * e.load[c] * length
            r[i + c] += m * (2.0 * x1 + x2) - half
            r[j + c] += m * (x1 + 2.0 * x2) - half


@kernel
def _inertia_force(g, t, q, v, a, r):
    for n in range(g.rows.size):
        e = g.rows[n]
        i, j = e.a, e.b
        length = q[j + MATERIAL] - q[i + MATERIAL]
        m = e.damping * e.mass * length / 6.0
        for c in range(AXES):
            half = 0.5 * e.load[c] * length
            r[i + c] += m * (2.0 * v[i + c] + v[j + c]) - half
            r[j + c] += m * (v[i + c] + 2.0 * v[j + c]) - half


@kernel
def _add_mass(e, q, factor, matrix, dofs):
    m = factor * e.mass * (q[e.b + MATERIAL] - q[e.a + MATERIAL]) / 6.0
    for c in range(AXES):
        add_entry(matrix, dofs, e.a + c, e.a + c, 2.0 * m)
        add_entry(matrix, dofs, e.a + c, e.b + c, m)
        add_entry(matrix, dofs, e.b + c, e.a + c, m)
        add_entry(matrix, dofs, e.b + c, e.b + c, 2.0 * m)


@kernel
def _inertia_mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        _add_mass(g.rows[n], q, 1.0, matrix, dofs)


@kernel
def _inertia_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        _add_mass(g.rows[n], q, cm + cc * g.rows[n].damping, matrix, dofs)


@kernel
def _twice_kinetic(e, q, v):
    total = 0.0
    for c in range(AXES):
        x1, x2 = v[e.a + c], v[e.b + c]
        total += x1 * x1 + x1 * x2 + x2 * x2
    return e.mass * (q[e.b + MATERIAL] - q[e.a + MATERIAL]) / 3.0 * total


@kernel
def _inertia_energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        e = g.rows[n]
        energy[0] += 0.5 * _twice_kinetic(e, q, v)
        half = 0.5 * (q[e.b + MATERIAL] - q[e.a + MATERIAL])
        for c in range(AXES):
            energy[2] -= half * e.load[c] * (q[e.a + c] + q[e.b + c])


@kernel
def _inertia_dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        p[0] += g.rows[n].damping * _twice_kinetic(g.rows[n], q, v)


register(
    LinearInertia, residual=_inertia_residual, force=_inertia_force, mass=_inertia_mass, tangent=_inertia_tangent,
    energy=_inertia_energy, dissipation=_inertia_dissipation, constant_mass=True,
)  # fmt: skip


class LinearTension(NamedTuple):
    """Elements (n,) of ``TENSION``, moving material or not; scratch are ``vector`` (4, 3) and ``block`` (8, 8)."""

    rows: np.recarray
    vector: np.ndarray
    block: np.ndarray


SLOPE, RATE, CHANGE = range(3)
"""Rows of ``vector``: e = r', its rate for a particle, scratch."""


@kernel
def _stress(row, z, q, v):
    """Write e and e.; returns 1/L, L., strain, h, its derivative and e.e."""
    i, j = row.a, row.b
    h = 1.0 / (q[j + MATERIAL] - q[i + MATERIAL])
    l_d = v[j + MATERIAL] - v[i + MATERIAL]
    square = rate = 0.0
    for c in range(AXES):
        e = (q[j + c] - q[i + c]) * h
        e_d = (v[j + c] - v[i + c]) * h - l_d * e * h
        z[SLOPE, c], z[RATE, c] = e, e_d
        square += e * e
        rate += e * e_d
    strain, d_strain, d_factor = strain_of(row, square)
    return h, l_d, strain, d_strain, d_factor, rate


@kernel
def _residual(g, t, q, v, a, r):
    z = g.vector
    for n in range(g.rows.size):
        row = g.rows[n]
        _, _, strain, d_strain, _, rate = _stress(row, z, q, v)
        if is_slack(row, strain):
            continue
        force = row.stiffness * d_strain * (strain + row.damping * d_strain * rate)
        given = 0.5 * row.stiffness * strain * strain
        for c in range(AXES):
            f = force * z[SLOPE, c]
            r[row.a + c] -= f
            r[row.b + c] += f
            given -= f * z[SLOPE, c]
        r[row.a + MATERIAL] -= given
        r[row.b + MATERIAL] += given


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        row = g.rows[n]
        h, l_d, strain, d_strain, d_factor, rate = _stress(row, g.vector, q, v)
        if not is_slack(row, strain):
            _write_block(g, row, h, l_d, strain, d_strain, d_factor, rate, cc, ck, v)
            add_block(matrix, dofs, row.a, row.b - row.a, NODE, g.block)


@kernel
def _write_block(g, row, h, l_d, strain, d_strain, d_factor, rate, cc, ck, v):
    """The block (8, 8): every column is a change of e and e., and a change of F for both ends."""
    z, block = g.vector, g.block
    e, e_d, change = z[SLOPE], z[RATE], z[CHANGE]
    stiffness, viscosity = row.stiffness, row.stiffness * row.damping
    viscous = viscosity * d_strain * d_strain * rate
    f1 = stiffness * (d_strain * d_strain + strain * d_factor) + 2.0 * viscosity * d_strain * d_factor * rate
    t2 = viscosity * d_strain * d_strain
    both = stiffness * strain * d_strain + viscous
    for column in range(2 * NODE):
        sign = 1.0 if column >= NODE else -1.0
        y = column % NODE
        along = along_rate = along_d = 0.0
        for c in range(AXES):
            if y < MATERIAL:
                by = ck * sign * h if c == y else 0.0
                rated = -l_d * h * by + (cc * sign * h if c == y else 0.0)
            else:
                by = -ck * sign * h * e[c]
                speed = (v[row.b + c] - v[row.a + c]) * h
                rated = ck * sign * h * (2.0 * l_d * h * e[c] - speed) - cc * sign * h * e[c]
            change[c] = by
            along += e[c] * by
            along_rate += e_d[c] * by
            along_d += e[c] * rated
        given = 0.0
        for c in range(AXES):
            by = change[c]
            force = e[c] * (f1 * along + t2 * (along_rate + along_d)) + both * by
            block[c, column], block[NODE + c, column] = -force, force
            given -= viscous * e[c] * by + e[c] * force
        block[MATERIAL, column], block[NODE + MATERIAL, column] = -given, given


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        row = g.rows[n]
        h, _, strain, _, _, _ = _stress(row, g.vector, q, v)
        if not is_slack(row, strain):
            energy[1] += 0.5 * row.stiffness * strain * strain / h


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        row = g.rows[n]
        h, _, strain, d_strain, _, rate = _stress(row, g.vector, q, v)
        if row.damping != 0.0 and not is_slack(row, strain):
            p[0] += row.stiffness * row.damping * (d_strain * rate) ** 2 / h


@kernel
def watch_length(g, t, q, alarm):
    """Raise the alarm of an element whose length is gone."""
    report_empty(g.rows, MATERIAL, q, alarm)


def _edges(g: LinearTension, q: np.ndarray, v: np.ndarray) -> list[Edge]:
    """How far elements are from where they go slack, or taut again."""
    return edges_of_slack(g.rows, np.zeros((0, 0)), MATERIAL, q)


register(
    LinearTension, residual=_residual, tangent=_tangent, energy=_energy, dissipation=_dissipation, alarm=watch_length,
    edges=_edges,
)  # fmt: skip
