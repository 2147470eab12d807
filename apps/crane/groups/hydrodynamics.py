"""Rope in water that is still or flows steadily: buoyancy, drag across the rope and added mass.

The rope between two stations is their straight chord d of direction e, which holds L = p_b - p_a of unstretched rope of
cross-section A; where a station is a sheave's that is its centre. All is per unstretched metre, so that rope keeps its
volume. A share s of every particle is under water, from 0 to 1 over the rope's diameter or a centimetre, whichever is
larger: rope that enters the water level meets no jump.

Buoyancy has the potential V = rho A g L mean(f(D)), D the depth below the surface and f' = s. It acts on the stations
and on their material coordinates, and its tension is the effective one: that in the rope plus A times the water's
pressure. Drag and added mass act across the chord, at two points that integrate s times a quadratic exactly: Gauss's of
the part under water. Nothing of that is along r' and so none of it moves rope past its stations.

- Drag, Morison's: 0.5 rho Cd d |n| n per metre, n = (1 - e e^T) r.; |n| is rounded within 1 mm/s of rest.
- Added mass, m = rho Ca A per metre: the water across the rope is pushed at n and resists with
  m (1 - e e^T)(r.. - 2 (e.r.) e.). The second term takes away what r.. has of rope, or of stations, that move along
  a line which turns: the water does not notice them. Morison's own term has m (1 - e e^T) r.. alone, as most other
  programs do. The kinetic energy m n^2 / 2 is counted.

In a current u(z) the water finds the rope move at r. - u: n and e.r. above are of that. A current changes neither the
acceleration of water, which stays at its depth, nor the energy that is counted, (1 - e e^T) r. being taken of the rope
as seen from the ground.

Left out of added mass: the momentum of water that rope takes up as it comes in (slamming), the force along z that
comes with it, and what water in motion carries from element to element at kinks, and away at the ends. What these
would do is accounted for as work from outside. Nor are there waves, drag along the rope, or vibration by vortices.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES
from crane.groups.current import Current, carry, flows, no_current
from crane.groups.span import FIRST, LAST, MATERIAL, SIZE, STATION, Spans
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot

WET = np.dtype([("a", "i8"), ("b", "i8"), ("diameter", "f8"), ("density", "f8"), ("drag", "f8"), ("added", "f8")])
"""Rope between two stations: their places, diameter m, the water's density kg/m^3, Cd and Ca across the rope."""
NARROWEST = 0.01
"""Least depth over which rope gets wet, m."""
AT_REST = 1.0e-3
"""Speed below which drag is linear, m/s."""
DRY = 1.0e-9
"""Share under water below which drag and added mass are nothing."""
CLOSEST = 1.0e-7
"""Spread, in xi, below which both points stay together."""
NODES = ((-sqrt(0.6), 5.0 / 18.0), (0.0, 8.0 / 18.0), (sqrt(0.6), 5.0 / 18.0))
"""Gauss's points of [-1, 1] and weights whose sum is one."""

AFLOAT, SHARE, EDGE = 0, 1, 4
"""Places in ``number`` of mean(f), the means of s, s xi, s xi^2, and of s' times 1, xi, xi^2, xi^3, xi from a to b."""
LENGTH, CHORD, MEAN, SPREAD, DRAG, ADDED = range(8, 14)
"""Places of L and |d|, m; of the middle of the two points and how far they are from it, in xi; of 0.5 rho Cd d L and
rho Ca A L, times half the share under water."""
E, D_D, D_DD, E_D, U, N, ACCELERATION, FORCE, INERTIA, E_BY, U_BY, FORCE_BY = range(12)
"""Places in ``vector`` of e, d., d.., e.; at a point of the particle's velocity as far as stations make it and its part
across, of r.. - 2 (e.r.) d. / |d|, of drag and of what added mass takes; and of changes."""


class Wet(NamedTuple):
    """Rope (n,) of ``WET`` in water below z = ``surface`` m, ``gravity`` (3,) m/s^2 being along -z.

    ``found`` (n, 9) and ``direction`` (n, 3) are those of the spans, whose tension at the marks the water's lift takes
    part in. ``current`` is the water's. Scratch: ``number`` (14,), ``vector`` (12, 3) and ``block`` (8, 8).
    """

    rows: np.recarray
    surface: float
    gravity: np.ndarray
    found: np.ndarray
    direction: np.ndarray
    current: Current
    number: np.ndarray
    vector: np.ndarray
    block: np.ndarray


@kernel
def _add_wet(first, last, deep_a, change, number):
    """Add the part from xi = first to last that is wholly under water."""
    number[AFLOAT] += (last - first) * (deep_a + 0.5 * (first + last) * change)
    number[SHARE] += last - first
    number[SHARE + 1] += (last**2 - first**2) / 2.0
    number[SHARE + 2] += (last**3 - first**3) / 3.0


@kernel
def _add_edge(first, last, deep_a, change, width, number):
    """Add the part that is getting wet: a cubic share, which these points integrate exactly with what goes with it."""
    for place, weight in NODES:
        xi = 0.5 * (first + last + place * (last - first))
        weight *= last - first
        x = (deep_a + xi * change) / width
        number[AFLOAT] += weight * width * (0.1875 + 0.5 * x + 0.375 * x**2 - 0.0625 * x**4)
        share, slope = 0.25 * (2.0 + 3.0 * x - x**3), 0.75 * (1.0 - x * x) / width
        for k in range(3):
            number[SHARE + k] += weight * share * xi**k
        for k in range(4):
            number[EDGE + k] += weight * slope * xi**k


@kernel
def _immerse(g, n, q):
    """How much of a chord is under water. Returns rho A g, N/m."""
    s, number = g.rows[n], g.number
    number.fill(0.0)
    number[LENGTH] = q[s.b + MATERIAL] - q[s.a + MATERIAL]
    width = 0.5 * max(s.diameter, NARROWEST)
    deep_a = g.surface - q[s.a + 2]
    change = g.surface - q[s.b + 2] - deep_a
    # A level chord is one that leaves the water far away.
    slope = change if change != 0.0 else 1.0e-300
    begin = min(max((-width - deep_a) / slope, 0.0), 1.0)
    end = min(max((width - deep_a) / slope, 0.0), 1.0)
    if slope < 0.0:
        _add_wet(0.0, end, deep_a, change, number)
        begin, end = end, begin
    else:
        _add_wet(end, 1.0, deep_a, change, number)
    if end > begin:
        _add_edge(begin, end, deep_a, change, width, number)
    return 0.25 * pi * s.diameter**2 * s.density * sqrt(dot(g.gravity, g.gravity))


@kernel
def _set_points(g, n):
    """The two points, and drag and added mass at each. Returns whether there is any."""
    s, number = g.rows[n], g.number
    share = number[SHARE]
    if share < DRY or (s.drag == 0.0 and s.added == 0.0):
        return False
    mean = number[SHARE + 1] / share
    number[MEAN], number[SPREAD] = mean, sqrt(max(0.0, number[SHARE + 2] / share - mean * mean))
    half = 0.5 * share * number[LENGTH]
    number[DRAG] = half * 0.5 * s.density * s.drag * s.diameter
    number[ADDED] = half * s.density * s.added * 0.25 * pi * s.diameter**2
    return True


@kernel
def _find_chord(g, n, q):
    s, e = g.rows[n], g.vector[E]
    for c in range(AXES):
        e[c] = q[s.b + c] - q[s.a + c]
    size = sqrt(dot(e, e))
    g.number[CHORD] = size
    for c in range(AXES):
        e[c] = e[c] / size if size > 0.0 else 0.0


@kernel
def _turn(g, n, v):
    """Rates of d and e."""
    s, x, size = g.rows[n], g.vector, g.number[CHORD]
    for c in range(AXES):
        x[D_D, c] = v[s.b + c] - v[s.a + c]
    along = dot(x[E], x[D_D])
    for c in range(AXES):
        x[E_D, c] = (x[D_D, c] - along * x[E, c]) / size if size > 0.0 else 0.0


@kernel
def _velocity(g, n, v, xi):
    """Velocity of the chord at xi."""
    s, x = g.rows[n], g.vector
    for c in range(AXES):
        x[U, c] = (1.0 - xi) * v[s.a + c] + xi * v[s.b + c]


@kernel
def _part(g):
    """Part of a velocity across the chord. Returns that along, and the rounded size of that across."""
    x = g.vector
    along = dot(x[E], x[U])
    for c in range(AXES):
        x[N, c] = x[U, c] - along * x[E, c]
    return along, sqrt(dot(x[N], x[N]) + AT_REST * AT_REST)


@kernel
def _pass(g, n, q, v, xi):
    """Velocity of the chord at xi past the water there, and its part across; returns what :func:`_part` does."""
    _velocity(g, n, v, xi)
    if flows(g.current):
        s = g.rows[n]
        carry(g.current, (1.0 - xi) * q[s.a + 2] + xi * q[s.b + 2])
        for c in range(AXES):
            g.vector[U, c] -= g.current.flow[c]
    return _part(g)


@kernel
def _resist(g, n, q, v, a, xi):
    """Forces of the water at xi, less what it pushes. Returns what :func:`_pass` does."""
    s, x, number = g.rows[n], g.vector, g.number
    along, size = _pass(g, n, q, v, xi)
    for c in range(AXES):
        x[ACCELERATION, c] = (1.0 - xi) * a[s.a + c] + xi * a[s.b + c] - 2.0 * along * x[E_D, c]
    push = dot(x[E], x[ACCELERATION])
    for c in range(AXES):
        x[INERTIA, c] = number[ADDED] * (x[ACCELERATION, c] - push * x[E, c])
        x[FORCE, c] = number[DRAG] * size * x[N, c]
    return along, size


@kernel
def _residual(g, t, q, v, a, r):
    number, x = g.number, g.vector
    for n in range(g.rows.size):
        s = g.rows[n]
        lift = _immerse(g, n, q)
        first = lift * number[LENGTH] * (number[SHARE] - number[SHARE + 1])
        last = lift * number[LENGTH] * number[SHARE + 1]
        r[s.a + 2] -= first
        r[s.b + 2] -= last
        g.found[n, FIRST] += first * g.direction[n, 2]
        g.found[n, LAST] -= last * g.direction[n, 2]
        r[s.a + MATERIAL] -= lift * number[AFLOAT]
        r[s.b + MATERIAL] += lift * number[AFLOAT]
        if not _set_points(g, n):
            continue
        _find_chord(g, n, q)
        _turn(g, n, v)
        for k in range(2):
            xi = number[MEAN] + (2 * k - 1) * number[SPREAD]
            _resist(g, n, q, v, a, xi)
            for c in range(AXES):
                force = x[FORCE, c] + x[INERTIA, c]
                r[s.a + c] += (1.0 - xi) * force
                r[s.b + c] += xi * force


@kernel
def _write_buoyancy(g, lift, ck):
    """Begin a tangent with the second derivatives of V."""
    block, number = g.block, g.number
    block.fill(0.0)
    k = ck * lift * number[LENGTH]
    a, b = 2, STATION + 2
    p_a, p_b = MATERIAL, STATION + MATERIAL
    block[a, a] = k * (number[EDGE] - 2.0 * number[EDGE + 1] + number[EDGE + 2])
    block[a, b] = block[b, a] = k * (number[EDGE + 1] - number[EDGE + 2])
    block[b, b] = k * number[EDGE + 2]
    by_a, by_b = ck * lift * (number[SHARE] - number[SHARE + 1]), ck * lift * number[SHARE + 1]
    block[a, p_a] = block[p_a, a] = by_a
    block[a, p_b] = block[p_b, a] = -by_a
    block[b, p_a] = block[p_a, b] = by_b
    block[b, p_b] = block[p_b, b] = -by_b


@kernel
def _drift(number, z_a, z_b):
    """Changes of share, middle and spread of the points with those of the stations' heights."""
    share, mean, spread = number[SHARE], number[MEAN], number[SPREAD]
    d_0 = -((number[EDGE] - number[EDGE + 1]) * z_a + number[EDGE + 1] * z_b)
    d_1 = -((number[EDGE + 1] - number[EDGE + 2]) * z_a + number[EDGE + 2] * z_b)
    d_2 = -((number[EDGE + 2] - number[EDGE + 3]) * z_a + number[EDGE + 3] * z_b)
    d_mean = (d_1 - mean * d_0) / share
    d_spread = 0.0
    if spread > CLOSEST:
        d_spread = ((d_2 - number[SHARE + 2] / share * d_0) / share - 2.0 * mean * d_mean) / (2.0 * spread)
    return d_0 / share, d_mean, d_spread


@kernel
def _vary_forces(g, column, size, along, xi, d_xi, cm, cc, ck):
    """Write the change of both forces together at a point that moves by d_xi: position ck, velocity cc, acceleration
    cm along one degree of freedom. The change of the share is not in it."""
    x, number, a = g.vector, g.number, g.vector[ACCELERATION]
    first, axis = column < STATION, column % STATION
    sign, part = (-1.0, 1.0 - xi) if first else (1.0, xi)
    e, e_by, u_by, force_by = x[E], x[E_BY], x[U_BY], x[FORCE_BY]
    h = 1.0 / number[CHORD] if number[CHORD] > 0.0 else 0.0
    # By how much the point rises, into water that flows otherwise.
    higher = (part * ck if axis == 2 else 0.0) + e[2] * number[CHORD] * d_xi
    for c in range(AXES):
        own = 1.0 if c == axis else 0.0
        e_by[c] = sign * ck * (own - e[axis] * e[c]) * h
        u_by[c] = part * cc * own + x[D_D, c] * d_xi - g.current.shear[c] * higher
    d_along = dot(e_by, x[U]) + dot(e, u_by)
    d_size = 0.0
    for c in range(AXES):
        # u_by: from here on the change of n.
        u_by[c] -= d_along * e[c] + along * e_by[c]
        d_size += x[N, c] * u_by[c] / size
    # In the part of the acceleration that e. makes, only what is across the chord counts: d. / |d| does as well.
    stretched = -sign * ck * e[axis] * h
    for c in range(AXES):
        own = 1.0 if c == axis else 0.0
        turned = h * x[D_D, c]
        turned_by = sign * cc * own * h + turned * stretched
        force_by[c] = part * cm * own + x[D_DD, c] * d_xi - 2.0 * (d_along * turned + along * turned_by)
    whole = dot(e, a) - 2.0 * along * h * dot(e, x[D_D])
    d_push = dot(e, force_by)
    for c in range(AXES):
        d_push += e_by[c] * (a[c] - 2.0 * along * (h * x[D_D, c] - x[E_D, c]))
    for c in range(AXES):
        inertia = force_by[c] - d_push * e[c] - whole * e_by[c]
        force_by[c] = number[ADDED] * inertia + number[DRAG] * (d_size * x[N, c] + size * u_by[c])


@kernel
def _add_point(g, n, k, q, v, a, cm, cc, ck):
    """Add the forces at one point to a tangent."""
    x, number, block = g.vector, g.number, g.block
    side = 2 * k - 1
    xi = number[MEAN] + side * number[SPREAD]
    along, size = _resist(g, n, q, v, a, xi)
    for column in range(2 * STATION):
        first, axis = column < STATION, column % STATION
        share = d_xi = 0.0
        if axis == MATERIAL:
            share = ck * (-1.0 if first else 1.0) / number[LENGTH]
            x[FORCE_BY].fill(0.0)
        else:
            if axis == 2 and ck != 0.0:
                share, d_mean, d_spread = _drift(number, ck if first else 0.0, 0.0 if first else ck)
                d_xi = d_mean + side * d_spread
            _vary_forces(g, column, size, along, xi, d_xi, cm, cc, ck)
        for c in range(AXES):
            force = x[FORCE, c] + x[INERTIA, c]
            by = x[FORCE_BY, c] + share * force
            block[c, column] += (1.0 - xi) * by - d_xi * force
            block[STATION + c, column] += xi * by + d_xi * force


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        s = g.rows[n]
        lift = _immerse(g, n, q)
        if g.number[SHARE] == 0.0:
            continue
        _write_buoyancy(g, lift, ck)
        if _set_points(g, n):
            _find_chord(g, n, q)
            _turn(g, n, v)
            for c in range(AXES):
                g.vector[D_DD, c] = a[s.b + c] - a[s.a + c]
            for k in range(2):
                _add_point(g, n, k, q, v, a, cm, cc, ck)
        add_block(matrix, dofs, s.a, s.b - s.a, STATION, g.block)


@kernel
def _mass(g, q, matrix, dofs):
    number, block, e = g.number, g.block, g.vector[E]
    for n in range(g.rows.size):
        s = g.rows[n]
        if s.added == 0.0:
            continue
        _immerse(g, n, q)
        if not _set_points(g, n):
            continue
        _find_chord(g, n, q)
        block.fill(0.0)
        for k in range(2):
            xi = number[MEAN] + (2 * k - 1) * number[SPREAD]
            for c in range(AXES):
                for d in range(AXES):
                    m = number[ADDED] * ((1.0 if c == d else 0.0) - e[c] * e[d])
                    block[c, d] += m * (1.0 - xi) ** 2
                    block[c, STATION + d] += m * xi * (1.0 - xi)
                    block[STATION + c, d] += m * xi * (1.0 - xi)
                    block[STATION + c, STATION + d] += m * xi**2
        add_block(matrix, dofs, s.a, s.b - s.a, STATION, block)


@kernel
def _energy(g, t, q, v, energy):
    number, x = g.number, g.vector
    for n in range(g.rows.size):
        energy[2] += _immerse(g, n, q) * number[LENGTH] * number[AFLOAT]
        if g.rows[n].added == 0.0 or not _set_points(g, n):
            continue
        _find_chord(g, n, q)
        for k in range(2):
            _velocity(g, n, v, number[MEAN] + (2 * k - 1) * number[SPREAD])
            _part(g)
            energy[0] += 0.5 * number[ADDED] * dot(x[N], x[N])


@kernel
def _dissipation(g, t, q, v, p):
    number, x = g.number, g.vector
    for n in range(g.rows.size):
        _immerse(g, n, q)
        if not _set_points(g, n):
            continue
        _find_chord(g, n, q)
        for k in range(2):
            _, size = _pass(g, n, q, v, number[MEAN] + (2 * k - 1) * number[SPREAD])
            p[0] += number[DRAG] * size * dot(x[N], x[N])


@kernel
def _supply(g, t, q, v, p):
    """What the kinetic energy of the water gains, from outside, by what is left out of its force; and what a current
    does: with drag it works on rope that rests, and added mass meets rope at e.(r. - u)."""
    number, x = g.number, g.vector
    for n in range(g.rows.size):
        s = g.rows[n]
        if s.added == 0.0 and not flows(g.current):
            continue
        _immerse(g, n, q)
        if not _set_points(g, n):
            continue
        _find_chord(g, n, q)
        _turn(g, n, v)
        grown, d_mean, d_spread = _drift(number, v[s.a + 2], v[s.b + 2])
        grown += (v[s.b + MATERIAL] - v[s.a + MATERIAL]) / number[LENGTH]
        for k in range(2):
            side = 2 * k - 1
            xi = number[MEAN] + side * number[SPREAD]
            _velocity(g, n, v, xi)
            along, _ = _part(g)
            square, turns = dot(x[N], x[N]), dot(x[N], x[E_D])
            turned = turns * (along + number[CHORD] * (d_mean + side * d_spread))
            p[0] += number[ADDED] * (0.5 * grown * square + turned)
            if flows(g.current):
                past, size = _pass(g, n, q, v, xi)
                p[0] -= number[DRAG] * size * dot(x[N], g.current.flow)
                p[0] -= 2.0 * number[ADDED] * (along - past) * turns


register(
    Wet, residual=_residual, tangent=_tangent, mass=_mass, energy=_energy, dissipation=_dissipation, supply=_supply
)


def new_wet(
    rows: np.recarray, surface: float, gravity: np.ndarray, spans: Spans | None = None, current: Current | None = None
) -> Wet:
    """Group of rope in water with its scratch; the rows are those of the spans, where these are given."""
    found, direction = np.zeros((len(rows), SIZE)), np.zeros((len(rows), 3))
    if spans is not None:
        found, direction = spans.found, spans.start
    number, vector, block = np.zeros(14), np.zeros((12, 3)), np.zeros((2 * STATION, 2 * STATION))
    water = no_current() if current is None else current
    return Wet(rows, float(surface), np.array(gravity, dtype=float), found, direction, water, number, vector, block)


__all__ = ["WET", "Wet", "new_wet"]
