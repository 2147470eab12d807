"""Two slopes at one place kept in one direction: where the section of a beam changes.

The tension passes a change of section and the strain does not: |r'| jumps there, and the direction of r' does not. So
the elements on both sides have slopes a and b of their own, and a stiff spring turns one into the other's direction,
with the energy K (1 - cos of their angle).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from tautline.elements.cubic import AXES
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot


class Welds(NamedTuple):
    """Slopes that begin at ``a`` (n,) and ``b`` (n,) in the full vectors; ``stiffness`` (n,) K N m/rad."""

    a: np.ndarray
    b: np.ndarray
    stiffness: np.ndarray


@kernel
def _unit(q, o):
    size = sqrt(q[o] * q[o] + q[o + 1] * q[o + 1] + q[o + 2] * q[o + 2])
    return (q[o] / size, q[o + 1] / size, q[o + 2] / size), size


@kernel
def _residual(g, t, q, v, a, r):
    for i in range(g.a.size):
        x, x_size = _unit(q, g.a[i])
        y, y_size = _unit(q, g.b[i])
        cosine = dot(x, y)
        for c in range(AXES):
            r[g.a[i] + c] -= g.stiffness[i] / x_size * (y[c] - cosine * x[c])
            r[g.b[i] + c] -= g.stiffness[i] / y_size * (x[c] - cosine * y[c])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.a.size):
        x, x_size = _unit(q, g.a[i])
        y, y_size = _unit(q, g.b[i])
        cosine = dot(x, y)
        k = ck * g.stiffness[i]
        for c in range(AXES):
            dx, dy = y[c] - cosine * x[c], x[c] - cosine * y[c]
            for d in range(AXES):
                one = 1.0 if c == d else 0.0
                across = one - x[c] * x[d] - y[c] * y[d] + cosine * x[c] * y[d]
                xx = dx * x[d] + x[c] * (y[d] - cosine * x[d]) + cosine * (one - x[c] * x[d])
                yy = dy * y[d] + y[c] * (x[d] - cosine * y[d]) + cosine * (one - y[c] * y[d])
                add_entry(matrix, dofs, g.a[i] + c, g.a[i] + d, k / (x_size * x_size) * xx)
                add_entry(matrix, dofs, g.b[i] + c, g.b[i] + d, k / (y_size * y_size) * yy)
                add_entry(matrix, dofs, g.a[i] + c, g.b[i] + d, -k / (x_size * y_size) * across)
                add_entry(matrix, dofs, g.b[i] + d, g.a[i] + c, -k / (x_size * y_size) * across)


@kernel
def _energy(g, t, q, v, energy):
    for i in range(g.a.size):
        x, _ = _unit(q, g.a[i])
        y, _ = _unit(q, g.b[i])
        # 1 - cos from the difference of the directions: the angle is small.
        energy[1] += 0.5 * g.stiffness[i] * ((x[0] - y[0]) ** 2 + (x[1] - y[1]) ** 2 + (x[2] - y[2]) ** 2)


register(Welds, residual=_residual, tangent=_tangent, energy=_energy)
