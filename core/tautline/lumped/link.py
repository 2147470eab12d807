"""Groups of links: axial and torsional springs between neighbouring bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, add_rows, gather, load_rows, total, where, within
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

SPRING = np.dtype([(name, np.float64) for name in ("length", "axial", "torsional")])
"""A link: unstretched length m; axial stiffness EA / l0 N/m; torsional stiffness GJ / l0 N m/rad."""
SPAN = np.int64(2)
"""Bodies of a link, as an argument."""


class Links(NamedTuple):
    """Link i of ``SPRING`` (n,) joins bodies i and i + 1.

    ``damping`` is the Kelvin-Voigt time of both stiffnesses, s (0: none); ``scratch`` is zeros (3, 6, 6).
    """

    curve: Curve
    springs: np.recarray
    damping: float
    slopes: Slopes
    scratch: np.ndarray


@kernel(forceinline=True)
def by_bodies(d, slope):
    """Gradient (6,) by (x, u, v) of both bodies, of what has the gradient d (3,) by the chord, du and dv."""
    return (
        d[0] * slope[0], d[0] * slope[1] - d[1], d[0] * slope[2] - d[2],
        d[0] * slope[3], d[0] * slope[4] + d[1], d[0] * slope[5] + d[2],
    )  # fmt: skip


@kernel
def stretch_of(g, i, q):
    """Stretch of link i, m, and its gradient (6,) by (x, u, v) of both bodies."""
    a, slope = chord_of(g.curve, i, q)
    du, dv = across(i, q)
    stretch, d = generated.link_stretch_gradient(g.springs[i].length, a, du, dv)
    return stretch, by_bodies(d, slope)


@kernel
def _rate(i, v, gradient):
    rate = 0.0
    for k in range(BOTH):
        rate += gradient[k] * v[place(i, k)]
    return rate


@kernel(forceinline=True)
def _four(g, i, last, q):
    """Stretch of links i to i + 3, m, its gradient (6,), and the twist, rad, in lanes."""
    above, below = load_rows(q, i, last), load_rows(q, i + 1, last + 1)
    a, slope = chord_between(above, held_arcs(g.curve, i, last), below, held_arcs(g.curve, i + 1, last + 1))
    length = gather(g.springs.length, i, last)
    stretch, d = generated.link_stretch_gradient(length, a, below[1] - above[1], below[2] - above[2])
    return stretch, by_bodies(d, slope), below[3] - above[3]


@kernel(forceinline=True)
def _rate_of_four(i, last, v, d):
    """Rates of the stretch, m/s, and of the twist, rad/s, in lanes."""
    above, below = load_rows(v, i, last), load_rows(v, i + 1, last + 1)
    rate = d[0] * above[0] + d[1] * above[1] + d[2] * above[2] + d[3] * below[0] + d[4] * below[1] + d[5] * below[2]
    return rate, below[3] - above[3]


@kernel(forceinline=True)
def pull_of_four(g, i, last, v, stretch, d, twist):
    """Tension, N, and torque, N m, of links i to i + 3, in lanes, of :func:`_four`'s figures."""
    axial, torsional = gather(g.springs.axial, i, last), gather(g.springs.torsional, i, last)
    if g.damping > 0.0:
        rate, turning = _rate_of_four(i, last, v, d)
        stretch += g.damping * rate
        twist += g.damping * turning
    return axial * stretch, torsional * twist


@kernel
def _residual(g, t, q, v, a, r):
    first, last = members(g.curve, SPAN, g.springs.size)
    for i in range(first, last, LANES):
        stretch, d, twist = _four(g, i, last, q)
        tension, torque = pull_of_four(g, i, last, v, stretch, d, twist)
        add_rows(r, i, last, tension * d[0], tension * d[1], tension * d[2], -torque)
        add_rows(r, i + 1, last + 1, tension * d[3], tension * d[4], tension * d[5], torque)


def link_slopes() -> Slopes:
    """Pattern of (chord, du, dv) against (x, u, v) of both bodies; the chord's own slopes are written in later."""
    return slopes(3, [[(0, 0.0)], [(0, 0.0), (1, -1.0)], [(0, 0.0), (2, -1.0)]] + [
        [(0, 0.0)], [(0, 0.0), (1, 1.0)], [(0, 0.0), (2, 1.0)]
    ])  # fmt: skip


@kernel
def _stretch_hessian(g, i, q, hessian):
    """Hessian (6, 6) of the stretch of link i."""
    a, slope = chord_of(g.curve, i, q)
    du, dv = across(i, q)
    _, d = generated.link_stretch_gradient(g.springs[i].length, a, du, dv)
    for k in range(BOTH):
        g.slopes.value[g.slopes.start[k]] = slope[k]
    generated.link_stretch_hessian(g.springs[i].length, a, du, dv, g.slopes.inner)
    pull_back(g.slopes, hessian)
    add_chord_hessian(g.curve, i, q, d[0], 0, g.slopes.chord, hessian)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    hessian, block, turned = g.scratch[0], g.scratch[1], g.scratch[2, 0]
    first, last = members(g.curve, SPAN, g.springs.size)
    for i in range(first, last):
        spring = g.springs[i]
        stretch, gradient = stretch_of(g, i, q)
        tension = spring.axial * stretch
        _stretch_hessian(g, i, q, hessian)
        lag = spring.axial * g.damping
        if g.damping > 0.0:
            tension += lag * _rate(i, v, gradient)
            for k in range(BOTH):
                turned[k] = 0.0
                for l in range(BOTH):
                    turned[k] += hessian[k, l] * v[place(i, l)]
        along = ck * spring.axial + cc * lag
        for k in range(BOTH):
            for l in range(BOTH):
                block[k, l] = ck * tension * hessian[k, l] + gradient[k] * (along * gradient[l] + ck * lag * turned[l])
        o, p = PER_BODY * i, PER_BODY * (i + 1)
        add_block(matrix, dofs, o, STRIDE, PLACES, block)
        x = (ck + cc * g.damping) * spring.torsional
        add_entry(matrix, dofs, o + 3, o + 3, x)
        add_entry(matrix, dofs, p + 3, p + 3, x)
        add_entry(matrix, dofs, o + 3, p + 3, -x)
        add_entry(matrix, dofs, p + 3, o + 3, -x)


@kernel
def _energy(g, t, q, v, e):
    for i in range(g.springs.size):
        stretch, _ = stretch_of(g, i, q)
        e[1] += 0.5 * g.springs[i].axial * stretch**2
        e[1] += 0.5 * g.springs[i].torsional * (q[PER_BODY * (i + 1) + 3] - q[PER_BODY * i + 3]) ** 2


@kernel
def _dissipation(g, t, q, v, p):
    if g.damping > 0.0:
        last = g.springs.size
        for i in range(0, last, LANES):
            _, d, _ = _four(g, i, last, q)
            rate, turning = _rate_of_four(i, last, v, d)
            lost = gather(g.springs.axial, i, last) * rate * rate
            lost += gather(g.springs.torsional, i, last) * turning * turning
            p[0] += g.damping * total(where(within(i, last), lost, 0.0))


register(Links, residual=_residual, tangent=_tangent, energy=_energy, dissipation=_dissipation)
