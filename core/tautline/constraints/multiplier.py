"""Lagrange multipliers, eqs 2.33-2.36 and 2.56-2.60, with the scaling of eqs 2.90-2.93.

A multiplier is an unknown with an acceleration and nothing else: lambda = w x.., w a typical mass. An implicit step
then writes beta' w G^T into the columns, and with the row w beta' phi = 0 it writes the same into the rows: the matrix
is beta' (M, w G^T; w G, 0) + ..., as well conditioned for a short step as for a long one. An explicit step has the row
w G q.. = 0 (eq. 2.117; G is constant), and statics takes lambda = w x and w phi = 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.constraints.equations import Equations, value_of
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel


class Multipliers(NamedTuple):
    """Equations with the places ``unknown`` (n,) of their multipliers, over ``weight`` kg.

    ``beta`` (1,) keeps beta' of the step: 0 while it is explicit, negative while an equilibrium is sought.
    """

    equations: Equations
    unknown: np.ndarray
    weight: float
    beta: np.ndarray


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    g.beta[0] = beta


@kernel
def _residual(g, t, q, v, a, r):
    e, beta = g.equations, g.beta[0]
    for i in range(g.unknown.size):
        row = g.unknown[i]
        force = g.weight * (q[row] if beta < 0.0 else a[row])
        for k in range(e.start[i], e.start[i + 1]):
            r[e.place[k]] += e.factor[k] * force
        if beta == 0.0:
            r[row] += g.weight * value_of(e, i, a)
        else:
            r[row] += g.weight * (beta if beta > 0.0 else 1.0) * (value_of(e, i, q) + e.offset[i])


@kernel
def _add(g, columns, rows, matrix, dofs):
    e = g.equations
    for i in range(g.unknown.size):
        for k in range(e.start[i], e.start[i + 1]):
            entry = g.weight * e.factor[k]
            add_entry(matrix, dofs, e.place[k], g.unknown[i], columns * entry)
            add_entry(matrix, dofs, g.unknown[i], e.place[k], rows * entry)


@kernel
def _mass(g, q, matrix, dofs):
    _add(g, 1.0, 1.0, matrix, dofs)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    beta = g.beta[0]
    if beta < 0.0:
        _add(g, ck, ck, matrix, dofs)
    elif beta == 0.0:
        _add(g, cm, cm, matrix, dofs)
    else:
        _add(g, cm, ck * beta, matrix, dofs)


@kernel
def _violation(g, order, q, v, r):
    e = g.equations
    for i in range(g.unknown.size):
        r[g.unknown[i]] += g.weight * (value_of(e, i, q) + e.offset[i] if order == 0 else value_of(e, i, v))


register(Multipliers, begin=_begin, residual=_residual, mass=_mass, tangent=_tangent, violation=_violation,
         constant_mass=True)  # fmt: skip
