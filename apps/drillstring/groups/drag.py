"""Quadratic drag of the mud on lateral motion (Morison)."""

from __future__ import annotations

from math import hypot
from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, add_rows, gather, load_rows, sqrt, total, where, within
from tautline.lumped.curve import ALONE, PER_BODY, Curve, members


class Drag(NamedTuple):
    """Drag of n lumps: ``coefficient`` (n,) is rho_m C_d d l / 2, N s^2/m^2, of the lump of that index."""

    curve: Curve
    coefficient: np.ndarray


@kernel
def _residual(g, t, q, v, a, r):
    first, last = members(g.curve, ALONE, g.coefficient.size)
    for i in range(first, last, LANES):
        _, x, y, _ = load_rows(v, i, last)
        drag = gather(g.coefficient, i, last) * sqrt(x * x + y * y)
        add_rows(r, i, last, 0.0, drag * x, drag * y, 0.0)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    first, last = members(g.curve, ALONE, g.coefficient.size)
    for i in range(first, last):
        o = PER_BODY * i
        x, y = v[o + 1], v[o + 2]
        speed = hypot(x, y)
        if speed > 0.0:
            c = cc * g.coefficient[i]
            add_entry(matrix, dofs, o + 1, o + 1, c * (speed + x * x / speed))
            add_entry(matrix, dofs, o + 2, o + 2, c * (speed + y * y / speed))
            add_entry(matrix, dofs, o + 1, o + 2, c * x * y / speed)
            add_entry(matrix, dofs, o + 2, o + 1, c * x * y / speed)


@kernel
def _dissipation(g, t, q, v, p):
    last = g.coefficient.size
    for i in range(0, last, LANES):
        _, x, y, _ = load_rows(v, i, last)
        square = x * x + y * y
        p[0] += total(where(within(i, last), gather(g.coefficient, i, last) * square * sqrt(square), 0.0))


register(Drag, residual=_residual, tangent=_tangent, dissipation=_dissipation)
