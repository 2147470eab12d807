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

In waves (`crane.groups.waves`) the surface is where they have it at the body's position, and water has a velocity u and
an acceleration a_w: those in the middle of what is under water. The body is small beside the waves' length. A current
adds its velocity there to u.

- Drag is by v - u. Water that is pushed aside resists with s m (a - a_w), and while x grows it takes s. m (v - u).
- The waves' pressure accelerates what was there in place of the body: the force s rho V a_w (Froude and Krylov).

The energies are those of still water; what waves do beyond that is work from outside.

Left out: the water that runs off a body or out of it, the moment of buoyancy, the pile-up of water beside a
body that comes in fast, and that bodies and vessel change the waves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES
from crane.groups.current import Current, carry, flows
from crane.groups.masses import BEFORE, NOW, supply_of_release
from crane.groups.waves import (
    ACCELERATION,
    ALONG,
    DEEPER,
    RATE,
    SLOPE,
    VELOCITY,
    Sea,
    X,
    Y,
    Z,
    look,
    stir,
    stretched_of,
    vary,
)
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

IMMERSED = np.dtype(
    [
        ("place", "i8"), ("body", "i8"), ("height", "f8"), ("bottom", "f8"), ("buoyancy", "f8"), ("displaced", "f8"),
        ("added", "f8", (3,)), ("linear", "f8", (3,)), ("quadratic", "f8", (3,)),
    ]
)  # fmt: skip
"""A body: the place of its position, its number among bodies, height m, depth of its lowest point below its position
m, and of all of it under water: buoyancy N, displaced water and added mass kg and drag N s/m, N s^2/m^2 along each
axis."""
EDGE = 0.02
"""Part of the height over which s' grows at either end."""
ENDS = (1.0, 0.0), (-1.0, 1.0)
"""How s'' acts at the lowest and at the highest point, and where they are in x."""


class Immersed(NamedTuple):
    """Bodies (n,) of ``IMMERSED`` in water of the level z = ``surface`` m, and what is ``left`` (n,) of each when it
    drops; ``sea`` are the waves on it.

    ``gone`` (bodies, 2) is that of `crane.groups.masses.Bodies`. ``let_go`` (n, 2) W is, as there, the power at which
    the water's energy leaves with what is released. Scratch: ``leans`` (3,), how x changes with the position, 1/m;
    ``moved`` (2, 3, 3) and ``hurried`` (3,), how the water's motion and the rate of x at a body change with its
    position; ``seen`` (1,), the time at which the residual was asked for last, s, as masses are asked for without one.
    """

    rows: np.recarray
    left: np.recarray
    surface: float
    gone: np.ndarray
    let_go: np.ndarray
    sea: Sea
    current: Current
    leans: np.ndarray
    moved: np.ndarray
    hurried: np.ndarray
    seen: np.ndarray


def new_scratch() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The last four fields of `Immersed`."""
    return np.zeros(AXES), np.zeros((2, AXES, AXES)), np.zeros(AXES), np.zeros(1)


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
def _in_water(g, b, t, q):
    """How deep a body is in the water as it stands then: x of `share_of`, and its rate while the body is at rest.

    How x changes with the position is left in ``leans``, and how the water moves in the sea's ``moves``.
    """
    eta, eta_t, slope = look(g.sea, t, q[b.place + X], q[b.place + Y])
    wet = g.surface + eta - q[b.place + Z] + b.bottom
    g.leans[X], g.leans[Y] = slope * g.sea.way[X] / b.height, slope * g.sea.way[Y] / b.height
    g.leans[Z] = -1.0 / b.height
    middle = 0.5 * (max(wet, 0.0) + max(wet - b.height, 0.0))
    stir(g.sea, t, eta, middle)
    carry(g.current, g.surface + eta - middle)
    for c in range(AXES):
        g.sea.moves[VELOCITY, c] += g.current.flow[c]
    return wet / b.height, eta_t / b.height


@kernel
def _vary(g, b, t, q, v):
    """How the motion of the water, and the rate of x, change with the position of a body where it was looked at."""
    sea, moved = g.sea, g.moved
    eta, _, slope = look(sea, t, q[b.place + X], q[b.place + Y])
    wet = g.surface + eta - q[b.place + Z] + b.bottom
    middle = 0.5 * (max(wet, 0.0) + max(wet - b.height, 0.0))
    follows = 0.5 * ((1.0 if wet > 0.0 else 0.0) + (1.0 if wet > b.height else 0.0))
    vary(sea, t, eta, middle)
    _, by_middle, by_eta = stretched_of(sea, eta, middle)
    carry(g.current, g.surface + eta - middle)
    for d in range(AXES):
        way = sea.way[d] if d < Z else 0.0
        raised = slope * way
        deeper = follows * (raised - (1.0 if d == Z else 0.0))
        stretched = by_middle * deeper + by_eta * raised
        for k in range(2):
            for c in range(AXES):
                moved[k, c, d] = sea.by[ALONG, k, c] * way + sea.by[DEEPER, k, c] * stretched
        turns = sea.bends[RATE]
        for c in (X, Y):
            moved[VELOCITY, c, d] += g.current.shear[c] * (raised - deeper)
            turns += sea.bends[SLOPE] * sea.way[c] * v[b.place + c]
        g.hurried[d] = turns * way / b.height


@kernel
def _rate(g, b, rises, v):
    """Rate of x, 1/s, of a body that moves."""
    for c in range(AXES):
        rises += g.leans[c] * v[b.place + c]
    return rises


@kernel
def _energy_of(g, b, t, q, v):
    """Energy of the water that a body moves, and of what it lifts, J."""
    eta, _, _ = look(g.sea, t, q[b.place + X], q[b.place + Y])
    _, _, share, depth = share_of((g.surface + eta - q[b.place + Z] + b.bottom) / b.height)
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
            moved, lifted = _energy_of(g, g.rows[n], t, q, v)
            moves, lifts = _energy_of(g, g.left[n], t, q, v)
            g.let_go[n, 1 if beta > 0.0 else 0] = 2.0 * (moved + lifted - moves - lifts) / h


@kernel
def _residual(g, t, q, v, a, r):
    g.seen[0] = t
    water = g.sea.moves
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        x, rises = _in_water(g, b, t, q)
        _, slope, share, _ = share_of(x)
        if share == 0.0:
            continue
        entering = slope * max(0.0, _rate(g, b, rises, v))
        for c in range(AXES):
            o = b.place + c
            past = v[o] - water[VELOCITY, c]
            drag = b.linear[c] + b.quadratic[c] * abs(past)
            r[o] += share * b.added[c] * (a[o] - water[ACCELERATION, c])
            r[o] += (share * drag + entering * b.added[c]) * past
            r[o] -= share * b.displaced * water[ACCELERATION, c]
        r[b.place + Z] -= b.buoyancy * share


@kernel
def _mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        x, _ = _in_water(g, b, g.seen[0], q)
        _, _, share, _ = share_of(x)
        for c in range(AXES):
            add_entry(matrix, dofs, b.place + c, b.place + c, share * b.added[c])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    water = g.sea.moves
    moving = ck != 0.0 and (g.sea.rows.size > 0 or flows(g.current))
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        x, rises = _in_water(g, b, t, q)
        bend, slope, share, _ = share_of(x)
        if share == 0.0:
            continue
        if moving:
            _vary(g, b, t, q, v)
        rate = max(0.0, _rate(g, b, rises, v))
        for c in range(AXES):
            o = b.place + c
            past, added = v[o] - water[VELOCITY, c], b.added[c]
            drag = b.linear[c] + b.quadratic[c] * abs(past)
            own = share * (drag + b.quadratic[c] * abs(past)) + slope * rate * added
            add_entry(matrix, dofs, o, o, cm * share * added + cc * own)
            deeper = slope * (added * (a[o] - water[ACCELERATION, c]) - b.displaced * water[ACCELERATION, c])
            deeper += slope * drag * past + bend * rate * added * past
            if c == Z:
                deeper -= b.buoyancy * slope
            faster = slope * added * past if rate > 0.0 else 0.0
            for d in range(AXES):
                by = (ck * deeper + cc * faster) * g.leans[d]
                if moving:
                    pushed = share * (added + b.displaced) * g.moved[ACCELERATION, c, d] + own * g.moved[VELOCITY, c, d]
                    by += ck * (faster * g.hurried[d] - pushed)
                if by != 0.0:
                    add_entry(matrix, dofs, o, b.place + d, by)


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, BEFORE] == 0 else g.left[n]
        moved, lifted = _energy_of(g, b, t, q, v)
        energy[0] += moved
        energy[2] += lifted


@kernel
def _dissipation(g, t, q, v, p):
    water = g.sea.moves
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        x, rises = _in_water(g, b, t, q)
        _, slope, share, _ = share_of(x)
        passing = 0.5 * slope * abs(_rate(g, b, rises, v))
        for c in range(AXES):
            past = v[b.place + c] - water[VELOCITY, c]
            p[0] += (share * (b.linear[c] + b.quadratic[c] * abs(past)) + passing * b.added[c]) * past * past


@kernel
def _supply(g, t, q, v, p):
    """What leaves with a load that drops, and what waves do: their work, and the rate of both energies beyond it."""
    supply_of_release(g, t, q, v, p)
    if g.sea.rows.size == 0 and not flows(g.current):
        return
    water = g.sea.moves
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[g.rows[n].body, NOW] == 0 else g.left[n]
        x, rises = _in_water(g, b, t, q)
        _, slope, share, _ = share_of(x)
        rate = _rate(g, b, rises, v)
        passing = 0.5 * slope * rate
        for c in range(AXES):
            own, u = v[b.place + c], water[VELOCITY, c]
            past = own - u
            p[0] += share * (b.added[c] + b.displaced) * water[ACCELERATION, c] * own
            p[0] -= share * (b.linear[c] + b.quadratic[c] * abs(past)) * past * u
            p[0] += passing * b.added[c] * (u * u if passing > 0.0 else own * own - past * past)
        # The surface rises and falls above the body, which itself moves along its slope.
        p[0] += b.buoyancy * share * (b.height * rate + v[b.place + Z])


register(
    Immersed, begin=_begin, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy,
    dissipation=_dissipation, supply=_supply,
)  # fmt: skip
