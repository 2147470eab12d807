"""Penalty springs, eqs 2.37-2.39 and 2.61-2.62: k phi^2 / 2 for each equation.

With multipliers on the same equations they make the augmented Lagrange method, eqs 2.40-2.42 and 2.63-2.64.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.constraints.equations import Equations, value_of
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel


class Penalties(NamedTuple):
    """Equations and the stiffness (n,) of their springs."""

    equations: Equations
    stiffness: np.ndarray


@kernel
def _residual(g, t, q, v, a, r):
    e = g.equations
    for i in range(g.stiffness.size):
        force = g.stiffness[i] * (value_of(e, i, q) + e.offset[i])
        for k in range(e.start[i], e.start[i + 1]):
            r[e.place[k]] += e.factor[k] * force


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    e = g.equations
    for i in range(g.stiffness.size):
        for k in range(e.start[i], e.start[i + 1]):
            for l in range(e.start[i], e.start[i + 1]):
                entry = ck * g.stiffness[i] * e.factor[k] * e.factor[l]
                add_entry(matrix, dofs, e.place[k], e.place[l], entry)


@kernel
def _energy(g, t, q, v, energy):
    e = g.equations
    for i in range(g.stiffness.size):
        energy[1] += 0.5 * g.stiffness[i] * (value_of(e, i, q) + e.offset[i]) ** 2


register(Penalties, residual=_residual, tangent=_tangent, energy=_energy)
