"""Damping of bending in a rope that does not spin about its own line.

With e = r', b = r'' and P = 1 - e e^T / e.e the vector of curvature, along the principal normal, is c = P b / e.e. Its
rate in axes that turn with the tangent and do not spin about it is

    w = P y,   y = b. / a - (e.b) e. / a^2 - 2 (e.e.) b / a^2,   a = e.e,

and the dissipation is EJ c w.w / 2 per metre of material. In a plane this is eq. 2.49, kappa-dot^2, smooth through the
straight curve; out of it, bending in every direction is damped, whether the rope is straight or bent. A rope that a
clamp keeps from spinning is damped so. A bent rod that is spun about its own line as a whole is damped too, where
`tautline.elements.beam.bending` is not: of the material's spin, which neither has, that one assumes whatever damps
least.

The force against e. and b. is the derivative of half of the dissipation by them,

    f_b = EJ c w / a,   f_e = -EJ c [(e.b) w + 2 (w.b) e] / a^2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.beam.bending import BOTH, add_point
from tautline.elements.cubic import AXES, MATERIAL, vectors
from tautline.elements.flow import combine
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.hermite import FIRST, SECOND, WEIGHT
from tautline.kernels.jit import kernel

VISCOUS = np.dtype([("a", "i8"), ("b", "i8"), ("viscosity", "f8")])
"""An element through which nothing flows: its nodes' places, EJ c in N m^2 s."""


class BendingDamping(NamedTuple):
    """Elements (n,) of ``VISCOUS``.

    ``points`` (k, 18) is the table of the shape functions; scratch are ``shapes`` (2, 4), ``vector`` (4, 6), ``change``
    (2, 3, 6), ``stress`` (6, 6) and ``block`` (12, 12).
    """

    rows: np.recarray
    points: np.ndarray
    shapes: np.ndarray
    vector: np.ndarray
    change: np.ndarray
    stress: np.ndarray
    block: np.ndarray


NX, NXX = range(2)
Z, RATE, W, Y = range(4)
"""Rows of ``vector``: (e, b) and its rate; w and y (3)."""
BY_RATE, BY_Z = range(2)
"""Of ``change`` (2, 3, 6): dw / d(e., b.) and dw / d(e, b)."""


@kernel
def _dot(x, i, y, j):
    return x[i] * y[j] + x[i + 1] * y[j + 1] + x[i + 2] * y[j + 2]


@kernel
def _write_rate(g, k, q, v, first, length):
    """Write z, its rate, y and w at a point; returns a, e.b, e.e. ."""
    s, z = g.shapes, g.vector
    h = 1.0 / length
    for i in range(4):
        slope = i % 2 == 1
        s[NX, i] = g.points[k, FIRST + i] * (1.0 if slope else h)
        s[NXX, i] = g.points[k, SECOND + i] * (h if slope else h * h)
    for c in range(AXES):
        z[Z, c], z[Z, 3 + c] = combine(s[NX], q, first, c), combine(s[NXX], q, first, c)
        z[RATE, c], z[RATE, 3 + c] = combine(s[NX], v, first, c), combine(s[NXX], v, first, c)
    a, beta, epsilon = _dot(z[Z], 0, z[Z], 0), _dot(z[Z], 0, z[Z], 3), _dot(z[Z], 0, z[RATE], 0)
    one, two = 1.0 / a, 1.0 / (a * a)
    for c in range(AXES):
        z[Y, c] = z[RATE, 3 + c] * one - (beta * z[RATE, c] + 2.0 * epsilon * z[Z, 3 + c]) * two
    along = _dot(z[Z], 0, z[Y], 0) * one
    for c in range(AXES):
        z[W, c] = z[Y, c] - along * z[Z, c]
    return a, beta, epsilon


@kernel
def _residual(g, t, q, v, a, r):
    s, z = g.shapes, g.vector
    for n in range(g.rows.size):
        row = g.rows[n]
        first = vectors(row.a, row.b)
        length = q[row.b + MATERIAL] - q[row.a + MATERIAL]
        for k in range(g.points.shape[0]):
            square, beta, _ = _write_rate(g, k, q, v, first, length)
            pull = 2.0 * _dot(z[W], 0, z[Z], 3)
            weight = g.points[k, WEIGHT] * length * row.viscosity / square
            for c in range(AXES):
                f = -weight / square * (beta * z[W, c] + pull * z[Z, c])
                m = weight * z[W, c]
                for i in range(4):
                    r[first[i] + c] += s[NX, i] * f + s[NXX, i] * m


@kernel
def _write_changes(g, a, beta, epsilon):
    """Write how w changes with the rates and with z, a column for each component."""
    z, change = g.vector, g.change
    one, two = 1.0 / a, 1.0 / (a * a)
    along = _dot(z[Z], 0, z[Y], 0) * one
    for x in range(BOTH):
        c = x % AXES
        e_x, b_x, rate_x = z[Z, c], z[Z, 3 + c], z[RATE, c]
        for d in range(AXES):
            mine = 1.0 if d == c else 0.0
            if x < AXES:
                change[BY_RATE, d, x] = -(beta * mine + 2.0 * e_x * z[Z, 3 + d]) * two
                dy = -2.0 * e_x * z[RATE, 3 + d] * two - b_x * z[RATE, d] * two - 2.0 * rate_x * z[Z, 3 + d] * two
                dy += 4.0 * e_x * (beta * z[RATE, d] + 2.0 * epsilon * z[Z, 3 + d]) * two * one
            else:
                change[BY_RATE, d, x] = one * mine
                dy = -(e_x * z[RATE, d] + 2.0 * epsilon * mine) * two
            change[BY_Z, d, x] = dy
        for which in range(2):
            part = 0.0
            for d in range(AXES):
                part += z[Z, d] * change[which, d, x]
            for d in range(AXES):
                change[which, d, x] -= part * one * z[Z, d]
        if x < AXES:
            # The projection turns with e: of dP y only what P leaves of the change of e counts.
            turned = z[Y, c] - along * e_x
            for d in range(AXES):
                moved = (1.0 if d == c else 0.0) - e_x * z[Z, d] * one
                change[BY_Z, d, x] -= along * moved + z[Z, d] * turned * one


@kernel
def write_stress(g, a, beta, epsilon, viscosity, cc, ck):
    """Stress (6, 6) = cc d(f_e, f_b)/d(e., b.) + ck d(f_e, f_b)/d(e, b)."""
    z, change, stress = g.vector, g.change, g.stress
    _write_changes(g, a, beta, epsilon)
    one, two = 1.0 / a, 1.0 / (a * a)
    pull = _dot(z[W], 0, z[Z], 3)
    for x in range(BOTH):
        c = x % AXES
        by_b = 0.0
        for d in range(AXES):
            by_b += (cc * change[BY_RATE, d, x] + ck * change[BY_Z, d, x]) * z[Z, 3 + d]
        for d in range(AXES):
            by = cc * change[BY_RATE, d, x] + ck * change[BY_Z, d, x]
            mine = 1.0 if d == c else 0.0
            force = beta * by + 2.0 * by_b * z[Z, d]
            if x < AXES:
                scale = -4.0 * z[Z, c] * one
                force += ck * (z[Z, 3 + c] * z[W, d] + 2.0 * pull * mine)
                force += ck * scale * (beta * z[W, d] + 2.0 * pull * z[Z, d])
                by -= ck * 2.0 * z[Z, c] * one * z[W, d]
            else:
                force += ck * (z[Z, c] * z[W, d] + 2.0 * z[W, c] * z[Z, d])
            stress[d, x] = -viscosity * two * force
            stress[3 + d, x] = viscosity * one * by


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        row = g.rows[n]
        first = vectors(row.a, row.b)
        length = q[row.b + MATERIAL] - q[row.a + MATERIAL]
        g.block.fill(0.0)
        for k in range(g.points.shape[0]):
            square, beta, epsilon = _write_rate(g, k, q, v, first, length)
            write_stress(g, square, beta, epsilon, row.viscosity, cc, ck)
            add_point(g.shapes, g.stress, g.points[k, WEIGHT] * length, g.block)
        add_block(matrix, dofs, row.a, row.b - row.a, 2 * AXES, g.block)


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        row = g.rows[n]
        first = vectors(row.a, row.b)
        length = q[row.b + MATERIAL] - q[row.a + MATERIAL]
        for k in range(g.points.shape[0]):
            _write_rate(g, k, q, v, first, length)
            p[0] += g.points[k, WEIGHT] * length * row.viscosity * _dot(g.vector[W], 0, g.vector[W], 0)


register(BendingDamping, residual=_residual, tangent=_tangent, dissipation=_dissipation)
