"""Groups of bends: bending stiffness between three neighbouring bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.lumped import generated
from tautline.lumped.chain import BOTH, Slopes, across, add_chord_hessian, chord_of, place, pull_back, slopes
from tautline.lumped.curve import PER_BODY, PLACES, STRIDE, Curve, members

THREE = 9
"""Coordinates of a bend: x, u, v of three bodies."""
SPAN = np.int64(3)
"""Bodies of a bend, as an argument."""


class Bends(NamedTuple):
    """Bend i sits at body i + 1, between links i and i + 1.

    length (n + 1,) of the links m; stiffness (n,) EI over the mean length of the two links, N m; ``stiff`` is 1 where
    the string resists the curvature of the hole, 0 where only its departure from it. ``scratch`` is zeros (9, 9).
    """

    curve: Curve
    length: np.ndarray
    stiffness: np.ndarray
    stiff: float
    slopes: Slopes
    scratch: np.ndarray


@kernel
def _hole(g, i, q):
    """How far the hole turns about both axes from the link above bend i to the one below, rad."""
    above, below = g.curve.seats[i], g.curve.seats[i + 2]
    x1, x2 = q[place(i, 0)], q[place(i, 6)]
    half = 0.5 * g.stiff
    return (
        half * (below.turn1 + below.k1 * x2 - above.turn1 - above.k1 * x1),
        half * (below.turn2 + below.k2 * x2 - above.turn2 - above.k2 * x1),
    )


@kernel
def _residual(g, t, q, v, a, r):
    first, last = members(g.curve, SPAN, g.stiffness.size)
    a2, below = chord_of(g.curve, first, q)
    u2, v2 = across(first, q)
    for i in range(first, last):
        a1, above, u1, v1 = a2, below, u2, v2
        a2, below = chord_of(g.curve, i + 1, q)
        u2, v2 = across(i + 1, q)
        h1, h2 = _hole(g, i, q)
        _, d = generated.bend_gradient(g.length[i] + a1, u1, v1, g.length[i + 1] + a2, u2, v2, h1, h2)
        f = g.stiffness[i]
        for k in range(BOTH):
            r[place(i, k)] += f * d[0] * above[k]
            r[place(i, k + 3)] += f * d[3] * below[k]
        r[place(i, 1)] -= f * d[1]
        r[place(i, 2)] -= f * d[2]
        r[place(i, 4)] += f * (d[1] - d[4])
        r[place(i, 5)] += f * (d[2] - d[5])
        r[place(i, 7)] += f * d[4]
        r[place(i, 8)] += f * d[5]
        # The turning of the hole from body to body changes as the ends move along it.
        half = 0.5 * f * g.stiff
        r[place(i, 0)] -= half * (d[6] * g.curve.seats[i].k1 + d[7] * g.curve.seats[i].k2)
        r[place(i, 6)] += half * (d[6] * g.curve.seats[i + 2].k1 + d[7] * g.curve.seats[i + 2].k2)


def bend_slopes() -> Slopes:
    """Pattern of both links' (chord, du, dv) and the hole's two turnings against (x, u, v) of three bodies.

    Chord slopes come first in a column, that of the link above before that of the link below, then turnings.
    """
    return slopes(8, [
        [(0, 0.0), (6, 0.0), (7, 0.0)], [(0, 0.0), (1, -1.0)], [(0, 0.0), (2, -1.0)],
        [(0, 0.0), (3, 0.0)], [(0, 0.0), (3, 0.0), (1, 1.0), (4, -1.0)], [(0, 0.0), (3, 0.0), (2, 1.0), (5, -1.0)],
        [(3, 0.0), (6, 0.0), (7, 0.0)], [(3, 0.0), (4, 1.0)], [(3, 0.0), (5, 1.0)],
    ])  # fmt: skip


@kernel
def _write_slopes(g, i, above, below):
    start, value = g.slopes.start, g.slopes.value
    for k in range(BOTH):
        value[start[k]] = above[k]
    for k in range(BOTH):
        value[start[k + 3] + (1 if k < 3 else 0)] = below[k]
    half = 0.5 * g.stiff
    value[start[0] + 1] = -half * g.curve.seats[i].k1
    value[start[0] + 2] = -half * g.curve.seats[i].k2
    value[start[6] + 1] = half * g.curve.seats[i + 2].k1
    value[start[6] + 2] = half * g.curve.seats[i + 2].k2


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    hessian = g.scratch
    first, last = members(g.curve, SPAN, g.stiffness.size)
    for i in range(first, last):
        a1, above = chord_of(g.curve, i, q)
        a2, below = chord_of(g.curve, i + 1, q)
        u1, v1 = across(i, q)
        u2, v2 = across(i + 1, q)
        h1, h2 = _hole(g, i, q)
        l1, l2 = g.length[i] + a1, g.length[i + 1] + a2
        _, d = generated.bend_gradient(l1, u1, v1, l2, u2, v2, h1, h2)
        _write_slopes(g, i, above, below)
        generated.bend_hessian(l1, u1, v1, l2, u2, v2, h1, h2, g.slopes.inner)
        pull_back(g.slopes, hessian)
        add_chord_hessian(g.curve, i, q, d[0], 0, g.slopes.chord, hessian)
        add_chord_hessian(g.curve, i + 1, q, d[3], 3, g.slopes.chord, hessian)
        factor = ck * g.stiffness[i]
        for k in range(THREE):
            for l in range(THREE):
                hessian[k, l] *= factor
        add_block(matrix, dofs, PER_BODY * i, STRIDE, PLACES, hessian)


@kernel
def _energy(g, t, q, v, e):
    for i in range(g.stiffness.size):
        a1, _ = chord_of(g.curve, i, q)
        a2, _ = chord_of(g.curve, i + 1, q)
        u1, v1 = across(i, q)
        u2, v2 = across(i + 1, q)
        h1, h2 = _hole(g, i, q)
        energy, _ = generated.bend_gradient(g.length[i] + a1, u1, v1, g.length[i + 1] + a2, u2, v2, h1, h2)
        e[1] += g.stiffness[i] * energy


register(Bends, residual=_residual, tangent=_tangent, energy=_energy)
