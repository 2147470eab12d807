"""Bodies that come into still water and out of it: what buoyancy, drag and added mass they have there.

A body whose height H is given is taken as a prism of that height that stays upright: of what water does to all of it,
a share s acts, that of its height which is under water. With x = (surface - lowest point) / H, s grows from 0 to 1
while x does, and s' = 1 in between. At both ends s' grows within EDGE of the height, so that a body that meets the
surface feels no jump of its forces; f with f' = s is the depth of what is under water, over H.

- Buoyancy rho g V s has the potential rho g V H f.
- Drag is s times that of the whole body.
- Added mass is s m, along each axis. While the body sinks, the water that it sets in motion takes its momentum from
  the body: the force s. m v against the motion, along each axis (von Karman, The impact on seaplane floats during
  landing, NACA TN 321, 1929). Half of its power goes into the motion of that water, the other half into spray. While
  the body rises, water stays behind with the motion that it has, and no force comes of it: its energy is lost to the
  body as well. So the energy of body and water falls by m |s.| v^2 / 2 either way.

Left out: waves and current, the water that runs off a body or out of it, the moment of buoyancy, and the pile-up of
water beside a body that comes in fast.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES
from crane.groups.masses import BEFORE, NOW, supply_of_release
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

IMMERSED = np.dtype(
    [
        ("place", "i8"), ("body", "i8"), ("height", "f8"), ("bottom", "f8"), ("buoyancy", "f8"), ("added", "f8", (3,)),
        ("linear", "f8", (3,)), ("quadratic", "f8", (3,)),
    ]
)  # fmt: skip
"""A body: the place of its position, its number among bodies, height m, depth of its lowest point below its position
m, and of all of it under water: buoyancy N, added mass kg and drag N s/m, N s^2/m^2 along each axis."""
EDGE = 0.02
"""Part of the height over which s' grows at either end."""
ENDS = (1.0, 0.0), (-1.0, 1.0)
"""How s'' acts at the lowest and at the highest point, and where they are in x."""
Z = 2


class Immersed(NamedTuple):
    """Bodies (n,) of ``IMMERSED`` in water below z = ``surface`` m, and what is ``left`` (n,) of each when it drops.

    ``gone`` (bodies, 2) is that of `crane.groups.masses.Bodies`. ``let_go`` (n, 2) W is, as there, the power at which
    the water's energy leaves with what is released.
    """

    rows: np.recarray
    left: np.recarray
    surface: float
    gone: np.ndarray
    let_go: np.ndarray


@kernel
def share_of(x):
    """Share of a prism under water: s'', s', s and f, by how far the surface is above its lowest point, over H."""
    if x >= 1.0 + 0.5 * EDGE:
        return 0.0, 0.0, 1.0, x - 0.5
    bend = slope = share = depth = 0.0
    for sign, end in ENDS:
        beyond = x - end
        u = beyond / EDGE + 0.5
        if u >= 1.0:
            slope += sign
            share += sign * beyond
            depth += sign * (0.5 * beyond * beyond + EDGE * EDGE / 24.0)
        elif u > 0.0:
            bend += sign / EDGE
            slope += sign * u
            share += sign * 0.5 * EDGE * u * u
            depth += sign * EDGE * EDGE * u * u * u / 6.0
    return bend, slope, share, depth


@kernel
def _immerse(g, b, q):
    """`share_of` a body where it is."""
    return share_of((g.surface - q[b.place + Z] + b.bottom) / b.height)


@kernel
def _energy_of(g, b, q, v):
    """Energy of the water that a body moves, and of what it lifts, J."""
    _, _, share, depth = _immerse(g, b, q)
    moved = 0.0
    for c in range(AXES):
        moved += 0.5 * share * b.added[c] * v[b.place + c] ** 2
    return moved, b.buoyancy * b.height * depth


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    """What water does to a load that drops goes with it: `crane.groups.masses.Bodies` have said that it does."""
    for n in range(g.rows.size):
        g.let_go[n, 0] = g.let_go[n, 1] = 0.0
        k = g.rows[n].body
        if h > 0.0 and gamma >= 0.0 and beta >= 0.0 and g.gone[k, NOW] != g.gone[k, BEFORE]:
            moved, lifted = _energy_of(g, g.rows[n], q, v)
            moves, lifts = _energy_of(g, g.left[n], q, v)
            g.let_go[n, 1 if beta > 0.0 else 0] = 2.0 * (moved + lifted - moves - lifts) / h


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        _, slope, share, _ = _immerse(g, b, q)
        if share == 0.0:
            continue
        entering = slope * max(0.0, -v[b.place + Z]) / b.height
        for c in range(AXES):
            o = b.place + c
            drag = b.linear[c] + b.quadratic[c] * abs(v[o])
            r[o] += share * b.added[c] * a[o] + (share * drag + entering * b.added[c]) * v[o]
        r[b.place + Z] -= b.buoyancy * share


@kernel
def _mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        _, _, share, _ = _immerse(g, b, q)
        for c in range(AXES):
            add_entry(matrix, dofs, b.place + c, b.place + c, share * b.added[c])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        bend, slope, share, _ = _immerse(g, b, q)
        if share == 0.0:
            continue
        z, sinking = b.place + Z, max(0.0, -v[b.place + Z])
        deeper = -ck / b.height
        for c in range(AXES):
            o = b.place + c
            drag, added = b.linear[c] + b.quadratic[c] * abs(v[o]), b.added[c]
            own = cm * share * added + cc * share * (drag + b.quadratic[c] * abs(v[o]))
            add_entry(matrix, dofs, o, o, own + cc * slope * sinking / b.height * added)
            by = deeper * (slope * (added * a[o] + drag * v[o]) + bend * sinking / b.height * added * v[o])
            if sinking > 0.0:
                by -= cc * slope / b.height * added * v[o]
            add_entry(matrix, dofs, o, z, by)
        add_entry(matrix, dofs, z, z, -deeper * b.buoyancy * slope)


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, BEFORE] == 0 else g.left[n]
        moved, lifted = _energy_of(g, b, q, v)
        energy[0] += moved
        energy[2] += lifted


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        _, slope, share, _ = _immerse(g, b, q)
        passing = 0.5 * slope * abs(v[b.place + Z]) / b.height
        for c in range(AXES):
            o = b.place + c
            p[0] += (share * (b.linear[c] + b.quadratic[c] * abs(v[o])) + passing * b.added[c]) * v[o] * v[o]


register(
    Immersed, begin=_begin, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy,
    dissipation=_dissipation, supply=supply_of_release,
)  # fmt: skip
