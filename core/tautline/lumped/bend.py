"""Groups of bends: bending stiffness between three neighbouring bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, add_rows, gather, load_rows
from tautline.lumped import generated
from tautline.lumped.chain import (
    BOTH,
    Slopes,
    across,
    add_chord_hessian,
    chord_between,
    chord_of,
    place,
    pull_back,
    slopes,
)
from tautline.lumped.curve import PER_BODY, PLACES, STRIDE, Curve, held_arcs, members

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


@kernel(forceinline=True)
def turned_of_four(stiff, one, arc1, three, arc3):
    """How far the hole turns about both axes from bodies ``one`` to bodies ``three``, half of it, rad, in lanes."""
    half = 0.5 * stiff
    return (
        half * (arc3[2] + arc3[0] * three[0] - arc1[2] - arc1[0] * one[0]),
        half * (arc3[3] + arc3[1] * three[0] - arc1[3] - arc1[1] * one[0]),
    )


@kernel(forceinline=True)
def forces_of_four(f, d, above, below, stiff, arc1, arc3):
    """Forces by (x, u, v) of three bodies: f times the gradient of the energy, whose gradient by vectors (8,) is d."""
    half, upper, lower = 0.5 * stiff, d[0], d[3]
    # The turning of the hole from body to body changes as the ends move along it.
    along1 = upper * above[0] - half * (d[6] * arc1[0] + d[7] * arc1[1])
    along3 = lower * below[3] + half * (d[6] * arc3[0] + d[7] * arc3[1])
    return (
        (f * along1, f * (upper * above[1] - d[1]), f * (upper * above[2] - d[2])),
        (
            f * (upper * above[3] + lower * below[0]),
            f * (upper * above[4] + lower * below[1] + d[1] - d[4]),
            f * (upper * above[5] + lower * below[2] + d[2] - d[5]),
        ),
        (f * along3, f * (lower * below[4] + d[4]), f * (lower * below[5] + d[5])),
    )


@kernel
def _residual(g, t, q, v, a, r):
    first, last = members(g.curve, SPAN, g.stiffness.size)
    for i in range(first, last, LANES):
        one, two, three = load_rows(q, i, last), load_rows(q, i + 1, last + 1), load_rows(q, i + 2, last + 2)
        arc1, arc2 = held_arcs(g.curve, i, last), held_arcs(g.curve, i + 1, last + 1)
        arc3 = held_arcs(g.curve, i + 2, last + 2)
        a1, above = chord_between(one, arc1, two, arc2)
        a2, below = chord_between(two, arc2, three, arc3)
        _, d = generated.bend_gradient(
            gather(g.length, i, last) + a1, two[1] - one[1], two[2] - one[2],
            gather(g.length, i + 1, last + 1) + a2, three[1] - two[1], three[2] - two[2],
            *turned_of_four(g.stiff, one, arc1, three, arc3),
        )  # fmt: skip
        f = gather(g.stiffness, i, last)
        on1, on2, on3 = forces_of_four(f, d, above, below, g.stiff, arc1, arc3)
        add_rows(r, i, last, *on1, 0.0)
        add_rows(r, i + 1, last + 1, *on2, 0.0)
        add_rows(r, i + 2, last + 2, *on3, 0.0)


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
