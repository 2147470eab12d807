"""Torsion of a string of cubic elements: twist is linear along an element, inertia stands at its ends.

An ALE-ANCF element of a cable has no rotation about its own line. A string that is turned has one more unknown at each
node, the rotation theta of the cross-section, clockwise along the line. On a curve of small torsion theta' is the
twist of the material, so that torsion and the curve's shape do not act on each other.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

TWISTED = np.dtype([("a", "i8"), ("b", "i8")] + [(name, "f8") for name in ("stiffness", "damping", "inertia", "drag")])
"""An element: places of theta at its nodes; GJ / L N m/rad; Kelvin-Voigt time s; half its polar inertia kg m^2, and
half its resistance to rotation N m s/rad, at either end."""


class Twist(NamedTuple):
    """Elements (n,) of ``TWISTED``."""

    rows: np.recarray


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        e = g.rows[n]
        torque = e.stiffness * (q[e.b] - q[e.a] + e.damping * (v[e.b] - v[e.a]))
        r[e.a] += e.inertia * a[e.a] + e.drag * v[e.a] - torque
        r[e.b] += e.inertia * a[e.b] + e.drag * v[e.b] + torque


@kernel
def _mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        e = g.rows[n]
        add_entry(matrix, dofs, e.a, e.a, e.inertia)
        add_entry(matrix, dofs, e.b, e.b, e.inertia)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        e = g.rows[n]
        x = (ck + cc * e.damping) * e.stiffness
        own = cm * e.inertia + cc * e.drag + x
        add_entry(matrix, dofs, e.a, e.a, own)
        add_entry(matrix, dofs, e.b, e.b, own)
        add_entry(matrix, dofs, e.a, e.b, -x)
        add_entry(matrix, dofs, e.b, e.a, -x)


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        e = g.rows[n]
        energy[0] += 0.5 * e.inertia * (v[e.a] ** 2 + v[e.b] ** 2)
        energy[1] += 0.5 * e.stiffness * (q[e.b] - q[e.a]) ** 2


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        e = g.rows[n]
        p[0] += e.drag * (v[e.a] ** 2 + v[e.b] ** 2) + e.stiffness * e.damping * (v[e.b] - v[e.a]) ** 2


register(
    Twist, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy, dissipation=_dissipation,
    constant_mass=True,
)  # fmt: skip
