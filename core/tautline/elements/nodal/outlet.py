"""Open ends, fixed in space, through which rope leaves or enters (formulation notes: they need one term, on p).

The row of p of an element holds the derivative of its stored energy by p at fixed places, and material that leaves
takes its own energy along: + Psi on p1 or - Psi on p2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.beam.curvature import write_gradient
from tautline.elements.cubic import AXES, MATERIAL, VECTORS, vectors
from tautline.elements.tension import is_slack, strain_of
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

OUTLET = np.dtype(
    [("a", "i8"), ("b", "i8"), ("end", "i8"), ("stiffness", "f8"), ("bending", "f8"), ("engineering", "i8"),
     ("slack", "i8")]
)  # fmt: skip
"""The element at an open end: its nodes' places, which of its ends is open (0 or 1), EA N, EJ N m^2, the strain."""


class Outlets(NamedTuple):
    """Open ends (n,) of ``OUTLET`` of cubic elements; scratch are ``shapes`` (4, 4) and ``vector`` (3, 6)."""

    rows: np.recarray
    shapes: np.ndarray
    vector: np.ndarray


NX, NXX, NXL, NXXL = range(4)
Z, GRADIENT, BY_L = range(3)


@kernel
def _write_shapes(row, length, s):
    """N' and N'' at the open end, and their derivatives by L."""
    h = 1.0 / length
    s.fill(0.0)
    s[NX, 1 if row.end == 0 else 3] = 1.0
    sign = 1.0 if row.end == 0 else -1.0
    s[NXX, 0], s[NXX, 2] = -6.0 * sign * h * h, 6.0 * sign * h * h
    s[NXX, 1], s[NXX, 3] = (-4.0 * h, -2.0 * h) if row.end == 0 else (2.0 * h, 4.0 * h)
    for j in range(VECTORS):
        s[NXXL, j] = -(1.0 if j % 2 == 1 else 2.0) * s[NXX, j] * h


@kernel
def _stored(g, row, q):
    """Stored energy at the end, J/m, and EA eps h; writes z, d(kappa^2)/dz and z_L."""
    s, z = g.shapes, g.vector
    first = vectors(row.a, row.b)
    _write_shapes(row, q[row.b + MATERIAL] - q[row.a + MATERIAL], s)
    square = 0.0
    for c in range(AXES):
        e = turn = turn_l = 0.0
        for j in range(VECTORS):
            x = q[first[j] + c]
            e += s[NX, j] * x
            turn += s[NXX, j] * x
            turn_l += s[NXXL, j] * x
        z[Z, c], z[Z, 3 + c], z[BY_L, c], z[BY_L, 3 + c] = e, turn, 0.0, turn_l
        square += e * e
    strain, factor, _ = strain_of(row, square)
    if is_slack(row, strain):
        strain = 0.0
    bent = write_gradient(z[Z], z[GRADIENT])
    stored = 0.5 * row.stiffness * strain * strain + 0.5 * row.bending * bent
    return stored, row.stiffness * strain * factor


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        row = g.rows[n]
        stored, _ = _stored(g, row, q)
        r[(row.a if row.end == 0 else row.b) + MATERIAL] += stored if row.end == 0 else -stored


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    s, z = g.shapes, g.vector
    for n in range(g.rows.size):
        row = g.rows[n]
        _, force = _stored(g, row, q)
        first = vectors(row.a, row.b)
        place = (row.a if row.end == 0 else row.b) + MATERIAL
        sign = ck if row.end == 0 else -ck
        by_l = 0.0
        for c in range(AXES):
            f, m = force * z[Z, c] + 0.5 * row.bending * z[GRADIENT, c], 0.5 * row.bending * z[GRADIENT, 3 + c]
            by_l += m * z[BY_L, 3 + c]
            for j in range(VECTORS):
                add_entry(matrix, dofs, place, first[j] + c, sign * (s[NX, j] * f + s[NXX, j] * m))
        add_entry(matrix, dofs, place, row.a + MATERIAL, -sign * by_l)
        add_entry(matrix, dofs, place, row.b + MATERIAL, sign * by_l)


@kernel
def _supply(g, t, q, v, p):
    """The energy that comes in with the material."""
    for n in range(g.rows.size):
        row = g.rows[n]
        stored, _ = _stored(g, row, q)
        rate = v[(row.a if row.end == 0 else row.b) + MATERIAL]
        p[0] -= stored * rate if row.end == 0 else -stored * rate


register(Outlets, residual=_residual, tangent=_tangent, supply=_supply)
