"""Groups of bodies: inertia, weight and linear damping of the lumps, with and without eccentricity."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dispatch import by_type
from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, add_rows, gather, load_fields, load_rows, total, where, within
from tautline.lumped import generated
from tautline.lumped.curve import (
    ALONE,
    PER_BODY,
    STRIDE,
    Curve,
    downward,
    downward_of_four,
    held_arcs,
    hold_arcs,
    members,
    vertical_depth,
)

LUMP = np.dtype(
    [
        (name, np.float64)
        for name in (
            "mass", "polar", "transverse", "lateral_mass", "weight",
            "damping_along", "damping_across", "damping_about", "e1", "e2",
        )
    ]
)  # fmt: skip
"""A lump: mass kg; polar and transverse inertia kg m^2; mass that follows lateral motion only kg; buoyed weight N;
damping along, across (N s/m) and about (N m s) the curve; eccentricity of the centre of gravity m."""


class Bodies(NamedTuple):
    """Lumps (n,) of ``LUMP`` whose centre of gravity is on the axis; ``scratch`` is zeros (3, 4, 4)."""

    curve: Curve
    lumps: np.recarray
    scratch: np.ndarray


class EccentricBodies(NamedTuple):
    """Lumps (n,) of ``LUMP`` with their centre of gravity at (e1, e2) in the frame that turns with them."""

    curve: Curve
    lumps: np.recarray
    scratch: np.ndarray


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    hold_arcs(g.curve, q)


@kernel(forceinline=True)
def _on_centred(g, i, last, arcs, q, v, a):
    mass, polar, transverse, lateral = load_fields(g.lumps.mass, i, last)
    weight, along, across, about = load_fields(g.lumps.weight, i, last)
    k1, k2, _, _ = arcs
    (x, u, w, th), (dx, du, dw, dth) = q, v
    g1, g2, g3 = downward_of_four(g.curve, i, last, x)
    r0, r1, r2, r3 = generated.body_residual(
        mass, polar, transverse, lateral, weight, k1, k2, g1, g2, g3, u, w, th, dx, du, dw, dth, *a
    )
    return r0 + along * dx, r1 + across * du, r2 + across * dw, r3 + about * dth


@kernel(forceinline=True)
def _on_eccentric(g, i, last, arcs, q, v, a):
    mass, polar, transverse, lateral = load_fields(g.lumps.mass, i, last)
    weight, along, across, about = load_fields(g.lumps.weight, i, last)
    e1, e2 = gather(g.lumps.e1, i, last), gather(g.lumps.e2, i, last)
    k1, k2, _, _ = arcs
    (x, u, w, th), (dx, du, dw, dth) = q, v
    g1, g2, g3 = downward_of_four(g.curve, i, last, x)
    r0, r1, r2, r3 = generated.eccentric_body_residual(
        mass, polar, transverse, lateral, weight, e1, e2, k1, k2, g1, g2, g3, u, w, th, dx, du, dw, dth, *a
    )
    return r0 + along * dx, r1 + across * du, r2 + across * dw, r3 + about * dth


on_bodies = by_type({Bodies: _on_centred, EccentricBodies: _on_eccentric})
"""M a - F (4,) of bodies i to i + 3, in lanes, with the arcs that they are held to and their rows of q, v and a."""


@kernel
def _residual(g, t, q, v, a, r):
    first, last = members(g.curve, ALONE, g.lumps.size)
    for i in range(first, last, LANES):
        arcs = held_arcs(g.curve, i, last)
        rows = load_rows(q, i, last), load_rows(v, i, last), load_rows(a, i, last)
        add_rows(r, i, last, *on_bodies(g, i, last, arcs, *rows))


@kernel
def _mass(g, q, matrix, dofs):
    block = g.scratch[0]
    for i in range(g.lumps.size):
        b, seat, o = g.lumps[i], g.curve.seats[i], PER_BODY * i
        generated.body_mass(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight,
            seat.k1, seat.k2, q[o + 1], q[o + 2], q[o + 3], block,
        )  # fmt: skip
        for k in range(PER_BODY):
            add_entry(matrix, dofs, o + k, o + k, block[k, k])


@kernel
def _eccentric_mass(g, q, matrix, dofs):
    block = g.scratch[0]
    for i in range(g.lumps.size):
        b, seat, o = g.lumps[i], g.curve.seats[i], PER_BODY * i
        generated.eccentric_body_mass(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight, b.e1, b.e2,
            seat.k1, seat.k2, q[o + 1], q[o + 2], q[o + 3], block,
        )  # fmt: skip
        for k in range(PER_BODY):
            for l in range(PER_BODY):
                add_entry(matrix, dofs, o + k, o + l, block[k, l])


@kernel
def _combine(b, o, cm, cc, ck, mass, damping, stiffness, matrix, dofs):
    """Add cm M + cc C + ck K of one body, whose C is still without the damping that is given."""
    damping[0, 0] += b.damping_along
    damping[1, 1] += b.damping_across
    damping[2, 2] += b.damping_across
    damping[3, 3] += b.damping_about
    for k in range(PER_BODY):
        for l in range(PER_BODY):
            stiffness[k, l] = cm * mass[k, l] + cc * damping[k, l] + ck * stiffness[k, l]
    add_block(matrix, dofs, o, STRIDE, STRIDE, stiffness)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    mass, damping, stiffness = g.scratch[0], g.scratch[1], g.scratch[2]
    first, last = members(g.curve, ALONE, g.lumps.size)
    for i in range(first, last):
        b, seat, o = g.lumps[i], g.curve.seats[i], PER_BODY * i
        g1, g2, g3 = downward(g.curve, i, q[o])
        generated.body_mass(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight,
            seat.k1, seat.k2, q[o + 1], q[o + 2], q[o + 3], mass,
        )  # fmt: skip
        generated.body_tangent(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight,
            seat.k1, seat.k2, g1, g2, g3, q[o + 1], q[o + 2], q[o + 3],
            v[o], v[o + 1], v[o + 2], v[o + 3], a[o], a[o + 1], a[o + 2], a[o + 3], stiffness, damping,
        )  # fmt: skip
        _combine(b, o, cm, cc, ck, mass, damping, stiffness, matrix, dofs)


@kernel
def _eccentric_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    mass, damping, stiffness = g.scratch[0], g.scratch[1], g.scratch[2]
    first, last = members(g.curve, ALONE, g.lumps.size)
    for i in range(first, last):
        b, seat, o = g.lumps[i], g.curve.seats[i], PER_BODY * i
        g1, g2, g3 = downward(g.curve, i, q[o])
        generated.eccentric_body_mass(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight, b.e1, b.e2,
            seat.k1, seat.k2, q[o + 1], q[o + 2], q[o + 3], mass,
        )  # fmt: skip
        generated.eccentric_body_tangent(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight, b.e1, b.e2,
            seat.k1, seat.k2, g1, g2, g3, q[o + 1], q[o + 2], q[o + 3],
            v[o], v[o + 1], v[o + 2], v[o + 3], a[o], a[o + 1], a[o + 2], a[o + 3], stiffness, damping,
        )  # fmt: skip
        _combine(b, o, cm, cc, ck, mass, damping, stiffness, matrix, dofs)


@kernel
def _height(g, i, q):
    """Depth below the rotary table of the axis at body i, m."""
    o = PER_BODY * i
    g1, g2, _ = downward(g.curve, i, q[o])
    return vertical_depth(g.curve, i, q[o]) + q[o + 1] * g1 + q[o + 2] * g2


@kernel
def _energy(g, t, q, v, e):
    for i in range(g.lumps.size):
        b, seat, o = g.lumps[i], g.curve.seats[i], PER_BODY * i
        e[0] += generated.body_kinetic_energy(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight,
            seat.k1, seat.k2, q[o + 1], q[o + 2], q[o + 3], v[o], v[o + 1], v[o + 2], v[o + 3],
        )  # fmt: skip
        e[2] -= b.weight * _height(g, i, q)


@kernel
def _eccentric_energy(g, t, q, v, e):
    for i in range(g.lumps.size):
        b, seat, o = g.lumps[i], g.curve.seats[i], PER_BODY * i
        e[0] += generated.eccentric_body_kinetic_energy(
            b.mass, b.polar, b.transverse, b.lateral_mass, b.weight, b.e1, b.e2,
            seat.k1, seat.k2, q[o + 1], q[o + 2], q[o + 3], v[o], v[o + 1], v[o + 2], v[o + 3],
        )  # fmt: skip
        g1, g2, _ = downward(g.curve, i, q[o])
        c, s = np.cos(q[o + 3]), np.sin(q[o + 3])
        e1, e2 = b.e1, b.e2
        e[2] -= b.weight * (_height(g, i, q) + g1 * (e1 * c - e2 * s) + g2 * (e1 * s + e2 * c))


@kernel
def _dissipation(g, t, q, v, p):
    last = g.lumps.size
    for i in range(0, last, LANES):
        _, along, across, about = load_fields(g.lumps.weight, i, last)
        dx, du, dw, dth = load_rows(v, i, last)
        lost = along * dx * dx + about * dth * dth + across * (du * du + dw * dw)
        p[0] += total(where(within(i, last), lost, 0.0))


register(
    Bodies, begin=_begin, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy, dissipation=_dissipation
)
register(
    EccentricBodies,
    begin=_begin,
    residual=_residual,
    mass=_eccentric_mass,
    tangent=_eccentric_tangent,
    energy=_eccentric_energy,
    dissipation=_dissipation,
)
