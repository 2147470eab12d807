"""Inertia and weight of linear elements through whose nodes material moves, with the momentum turned at their nodes.

r'' is zero inside these elements: a particle that goes round the corner of two of them is turned at once, which takes
the force m p.^2 (r'_right - r'_left) on the node and -m p.^2 (|r'_right|^2 - |r'_left|^2) / 2 on its p. Each element
adds its own side of it at the nodes that are marked; a free outflow end is not.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.dense_blocks import BLOCK_WRITERS, mass_of_blocks, tangent_of_blocks
from tautline.elements.linear import AXES, MATERIAL, NODE, watch_length
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

LINEAR_FLOW = np.dtype(
    [("a", "i8"), ("b", "i8"), ("mass", "f8"), ("damping", "f8"), ("load", "f8", (3,)), ("kinks", "f8", (2,))]
)
"""An element as ``INERTIA``; ``kinks`` is 1 at an end where another element goes on, else 0."""
PLACES = (0.21132486540518713, 0.7886751345948129)
"""Gauss points: the integrands are cubic at most."""


class LinearFlow(NamedTuple):
    """Elements (n,) of ``LINEAR_FLOW``; scratch are ``vector`` (3, 3) and ``block`` (8, 8)."""

    rows: np.recarray
    vector: np.ndarray
    block: np.ndarray


@kernel
def _inertia(e, q, v, a, c, x, h):
    """Component c of m r.. - load of the particle at x, and r' and v' there."""
    i, j = e.a, e.b
    slope, rate = (q[j + c] - q[i + c]) * h, (v[j + c] - v[i + c]) * h
    u = (1.0 - x) * v[i + MATERIAL] + x * v[j + MATERIAL]
    b = (1.0 - x) * a[i + MATERIAL] + x * a[j + MATERIAL]
    l_d = v[j + MATERIAL] - v[i + MATERIAL]
    inertia = (1.0 - x) * a[i + c] + x * a[j + c] - b * slope - 2.0 * u * rate + 2.0 * l_d * u * slope * h
    inertia += e.damping * ((1.0 - x) * v[i + c] + x * v[j + c] - u * slope)
    return e.mass * inertia - e.load[c], slope, rate


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        e = g.rows[n]
        i, j = e.a, e.b
        length = q[j + MATERIAL] - q[i + MATERIAL]
        h = 1.0 / length
        turned1 = e.kinks[0] * e.mass * v[i + MATERIAL] ** 2
        turned2 = e.kinks[1] * e.mass * v[j + MATERIAL] ** 2
        for c in range(AXES):
            for x in PLACES:
                force, slope, _ = _inertia(e, q, v, a, c, x, h)
                force *= 0.5 * length
                r[i + c] += (1.0 - x) * force
                r[j + c] += x * force
                r[i + MATERIAL] -= (1.0 - x) * slope * force
                r[j + MATERIAL] -= x * slope * force
            slope = (q[j + c] - q[i + c]) * h
            r[i + c] += turned1 * slope
            r[j + c] -= turned2 * slope
            r[i + MATERIAL] -= 0.5 * turned1 * slope * slope
            r[j + MATERIAL] += 0.5 * turned2 * slope * slope


@kernel
def _write_block(g, e, q, v, a, cm, cc, ck):
    """cm M + cc C + ck K of an element (8, 8)."""
    block, z = g.block, g.vector
    i, j = e.a, e.b
    length = q[j + MATERIAL] - q[i + MATERIAL]
    h = 1.0 / length
    l_d = v[j + MATERIAL] - v[i + MATERIAL]
    m = e.mass
    block.fill(0.0)
    for x in PLACES:
        w = 0.5 * length
        u = (1.0 - x) * v[i + MATERIAL] + x * v[j + MATERIAL]
        b = (1.0 - x) * a[i + MATERIAL] + x * a[j + MATERIAL]
        for c in range(AXES):
            z[0, c], z[1, c], z[2, c] = _inertia(e, q, v, a, c, x, h)
        for side in range(2):
            sign = 2.0 * side - 1.0
            phi = x if side == 1 else 1.0 - x
            by_x = sign * h * (-b + 2.0 * l_d * u * h - e.damping * u)
            scalar = m * (cm * phi + cc * (e.damping * phi - 2.0 * u * sign * h) + ck * by_x)
            column = side * NODE
            for c in range(AXES):
                force, slope = z[0, c], z[1, c]
                block[c, column + c] += w * (1.0 - x) * scalar
                block[NODE + c, column + c] += w * x * scalar
                pull = w * (slope * scalar + ck * sign * h * force)
                block[MATERIAL, column + c] -= (1.0 - x) * pull
                block[NODE + MATERIAL, column + c] -= x * pull
            column = side * NODE + MATERIAL
            for c in range(AXES):
                force, slope, rate = z[0, c], z[1, c], z[2, c]
                by_l = b * slope * h + 2.0 * u * rate * h - 4.0 * l_d * u * slope * h * h
                by_l += e.damping * u * slope * h
                by_rate = -2.0 * phi * rate + 2.0 * (sign * u + phi * l_d) * slope * h - e.damping * phi * slope
                by_p = m * (-cm * phi * slope + cc * by_rate + ck * sign * by_l)
                grown = ck * sign * force
                whole = w * by_p + 0.5 * grown
                block[c, column] += (1.0 - x) * whole
                block[NODE + c, column] += x * whole
                # The virtual motion of a particle with p_a, -phi_a r', shrinks as L grows.
                pull = slope * whole - w * slope * h * grown
                block[MATERIAL, column] -= (1.0 - x) * pull
                block[NODE + MATERIAL, column] -= x * pull
    _add_kink(e, e.kinks[0], i, 0, 1.0, q, v, h, cc, ck, block)
    _add_kink(e, e.kinks[1], j, NODE, -1.0, q, v, h, cc, ck, block)


@kernel
def _add_kink(e, kink, node, row, sign, q, v, h, cc, ck, block):
    """Derivatives of an element's side of the momentum turned at one of its nodes."""
    if kink == 0.0:
        return
    u = v[node + MATERIAL]
    force = sign * kink * e.mass * u * u
    for c in range(AXES):
        slope = (q[e.b + c] - q[e.a + c]) * h
        for side in range(2):
            way = 2.0 * side - 1.0
            block[row + c, side * NODE + c] += ck * force * way * h
            block[row + c, side * NODE + MATERIAL] -= ck * force * way * slope * h
            block[row + MATERIAL, side * NODE + c] -= ck * force * slope * way * h
            block[row + MATERIAL, side * NODE + MATERIAL] += ck * force * slope * slope * way * h
        block[row + c, row + MATERIAL] += cc * 2.0 * sign * kink * e.mass * u * slope
        block[row + MATERIAL, row + MATERIAL] -= cc * sign * kink * e.mass * u * slope * slope


BLOCK_WRITERS[LinearFlow] = _write_block


@kernel
def _energies(e, q, v):
    """Twice the kinetic energy of an element, and its potential energy."""
    i, j = e.a, e.b
    length = q[j + MATERIAL] - q[i + MATERIAL]
    kinetic = potential = 0.0
    for c in range(AXES):
        slope = (q[j + c] - q[i + c]) / length
        x1, x2 = v[i + c] - v[i + MATERIAL] * slope, v[j + c] - v[j + MATERIAL] * slope
        kinetic += e.mass * length / 3.0 * (x1 * x1 + x1 * x2 + x2 * x2)
        potential -= 0.5 * length * e.load[c] * (q[i + c] + q[j + c])
    return kinetic, potential


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        kinetic, potential = _energies(g.rows[n], q, v)
        energy[0] += 0.5 * kinetic
        energy[2] += potential


@kernel
def _carried(e, node, kink, q, v):
    """Energy that moving material carries past a node towards larger p, W: what leaves the element before it.

    Where the momentum is turned at the node, the force that turns it makes up for what both sides differ by: what is
    carried is what moves with the node.
    """
    length = q[e.b + MATERIAL] - q[e.a + MATERIAL]
    rate = v[node + MATERIAL]
    total = 0.0
    for c in range(AXES):
        speed = v[node + c] - (1.0 - kink) * rate * (q[e.b + c] - q[e.a + c]) / length
        total += 0.5 * e.mass * speed * speed - e.load[c] * q[node + c]
    return total * rate


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        p[0] += g.rows[n].damping * _energies(g.rows[n], q, v)[0]


@kernel
def _supply(g, t, q, v, p):
    """The energy of the material that an element takes in at its ends, which a drive must bring along."""
    for n in range(g.rows.size):
        e = g.rows[n]
        p[0] += _carried(e, e.b, e.kinks[1], q, v) - _carried(e, e.a, e.kinks[0], q, v)


register(
    LinearFlow, residual=_residual, mass=mass_of_blocks, tangent=tangent_of_blocks, energy=_energy,
    dissipation=_dissipation,
    supply=_supply,
    alarm=watch_length,
)  # fmt: skip
