"""Thrust of a stream whose speed changes at a node: a nozzle at the end of a hose, or a bore that narrows on its way.

Mass m u a second passes the node and leaves it faster by gain times the speed u r' it came with: the momentum is taken
from the node, a force -m u^2 gain r' on it, whichever way the stream goes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.cubic import AXES
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

JET = np.dtype([("node", "i8"), ("material", "i8"), ("mass", "f8"), ("gain", "f8")])
"""A change of speed: place of the (cubic) node it acts on, place of the stream's p, its mass kg/m, and by what share of
its speed it gets faster."""


class Jets(NamedTuple):
    """Changes of speed (n,) of ``JET``."""

    rows: np.recarray


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        row = g.rows[n]
        force = row.mass * row.gain * v[row.material] * v[row.material]
        for c in range(AXES):
            r[row.node + c] += force * q[row.node + AXES + c]


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        row = g.rows[n]
        u, gain = v[row.material], row.mass * row.gain
        for c in range(AXES):
            add_entry(matrix, dofs, row.node + c, row.node + AXES + c, ck * gain * u * u)
            add_entry(matrix, dofs, row.node + c, row.material, 2.0 * cc * gain * u * q[row.node + AXES + c])


@kernel
def _supply(g, t, q, v, p):
    """Work of the thrust, which whatever drives the stream puts in."""
    for n in range(g.rows.size):
        row = g.rows[n]
        force = row.mass * row.gain * v[row.material] * v[row.material]
        for c in range(AXES):
            p[0] -= force * q[row.node + AXES + c] * v[row.node + c]


register(Jets, residual=_residual, tangent=_tangent, supply=_supply)
