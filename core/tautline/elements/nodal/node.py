"""What hangs on nodes and between two of them: masses, forces for a time, springs, dampers (thesis section 3.1)."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

AXES = 3


class PointMasses(NamedTuple):
    """Masses (n,) kg at the positions that begin at ``place`` (n,), damped in proportion (1/s), under gravity m/s^2."""

    place: np.ndarray
    mass: np.ndarray
    damping: float
    gravity: np.ndarray


@kernel
def _mass_residual(g, t, q, v, a, r):
    for i in range(g.place.size):
        for c in range(AXES):
            o = g.place[i] + c
            r[o] += g.mass[i] * (a[o] + g.damping * v[o] - g.gravity[c])


@kernel
def _mass_mass(g, q, matrix, dofs):
    for i in range(g.place.size):
        for c in range(AXES):
            add_entry(matrix, dofs, g.place[i] + c, g.place[i] + c, g.mass[i])


@kernel
def _mass_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.place.size):
        for c in range(AXES):
            add_entry(matrix, dofs, g.place[i] + c, g.place[i] + c, g.mass[i] * (cm + cc * g.damping))


@kernel
def _mass_energy(g, t, q, v, e):
    for i in range(g.place.size):
        for c in range(AXES):
            o = g.place[i] + c
            e[0] += 0.5 * g.mass[i] * v[o] * v[o]
            e[2] -= g.mass[i] * g.gravity[c] * q[o]


@kernel
def _mass_dissipation(g, t, q, v, p):
    for i in range(g.place.size):
        for c in range(AXES):
            p[0] += g.damping * g.mass[i] * v[g.place[i] + c] ** 2


register(
    PointMasses, residual=_mass_residual, mass=_mass_mass, tangent=_mass_tangent, energy=_mass_energy,
    dissipation=_mass_dissipation, constant_mass=True,
)  # fmt: skip


class TimedForces(NamedTuple):
    """Forces ``value`` (n, 3) N at the positions ``place`` (n,), from ``interval[i, 0]`` to ``interval[i, 1]`` s.

    ``acts`` (n,) is the share of a step for which a force acts: of the step itself in an explicit method, and of the
    time around its end in an implicit one, where a force that has just stopped still counts by half. So its impulse is
    right, and the order of the method stays what it is. What it does is work from outside; ``before`` (n,) is what
    ``acts`` was when that was last asked for.

    An implicit step counts with half its length before its end and half that of the next one behind it, which is not
    known yet and taken for as long. ``settled`` (n, 4) is the share and the velocity, m/s, at the end of the last step,
    and ``steps`` (4,) that step's length, that of the one under way, s, 1 where this is implicit, and its start, s.
    """

    place: np.ndarray
    value: np.ndarray
    interval: np.ndarray
    acts: np.ndarray
    before: np.ndarray
    settled: np.ndarray
    owed: np.ndarray
    steps: np.ndarray


LONGER = 2.0
"""Times a step by which the last one may be longer for all that it gave too much to be taken back at once."""
ROUNDED = 1.0e-9
"""Difference of a share from one that is rounding."""


def timed_forces(place: np.ndarray, value: np.ndarray, interval: np.ndarray) -> TimedForces:
    """A group of forces that have not acted yet."""
    n = len(place)
    return TimedForces(place, value, interval, np.zeros(n), np.zeros(n), np.zeros((n, 5)), np.zeros(n), np.zeros(5))


@kernel
def _acting(g, i, first, last):
    """How long a force acts between two moments, s; below zero where the second comes first."""
    begin, end = min(first, last), max(first, last)
    acts = max(0.0, min(end, g.interval[i, 1]) - max(begin, g.interval[i, 0]))
    return acts if last > first else -acts


@kernel
def _share_of_step(g, i, t, h):
    """Share of an implicit step from t, with what the last one gave too much or too little for the step that follows.

    The last one reckoned with half of its own length behind its end, and half of this one stands there. A step that is
    much shorter could take that back by a share of many times one alone, and the next, a long one, would give it again,
    and more: what the last one gave beyond twice this step is owed, and paid in the time of the longest step of late.
    """
    acts = _acting(g, i, t + 0.5 * h, t + 1.5 * h)
    before, share, owed = g.steps[0], g.settled[i, 0], g.settled[i, 4]
    g.owed[i] = 0.0
    # A force that goes on has no rounding.
    goes_on = abs(share - 1.0) <= ROUNDED and abs(owed) <= ROUNDED * h and acts >= h * (1.0 - ROUNDED)
    if before == 0.0 or goes_on or (before == h and owed == 0.0):
        return acts / h
    near = min(before, LONGER * h)
    acts += _acting(g, i, t + 0.5 * near, t + 0.5 * h) + 0.5 * (near - h) * share
    owed += _acting(g, i, t + 0.5 * before, t + 0.5 * near) + 0.5 * (before - near) * share
    paid = owed * h / _longest(g, h)
    g.owed[i] = owed - paid
    return (acts + paid) / h


@kernel
def _longest(g, h):
    """Length of the longest step of late, s, the one of length h among them."""
    return max(h, g.steps[4] - h)


@kernel
def _force_begin(g, t, h, beta, gamma, q, v, a):
    g.steps[1], g.steps[2], g.steps[3] = h, 1.0 if beta > 0.0 else 0.0, t
    # The acceleration that a run begins with counts for half a step of an implicit method.
    lasts = 0.5 * h if gamma < 0.0 else h
    for i in range(g.place.size):
        if beta < 0.0 or h == 0.0:
            # An equilibrium is one under the forces that act from the start.
            g.acts[i] = 1.0 if g.interval[i, 0] <= t < g.interval[i, 1] else 0.0
        elif beta > 0.0:
            g.acts[i] = g.before[i] = _share_of_step(g, i, t, h)
        else:
            g.acts[i] = _acting(g, i, t, t + lasts) / lasts


@kernel
def _force_residual(g, t, q, v, a, r):
    # Accelerations that an implicit method finds anew at the start of a step are under the share of the one before.
    anew = g.steps[2] > 0.0 and t == g.steps[3]
    for i in range(g.place.size):
        acts = g.settled[i, 0] if anew else g.acts[i]
        for c in range(AXES):
            r[g.place[i] + c] -= acts * g.value[i, c]


@kernel
def _force_supply(g, t, q, v, p):
    """The books take the mean of both ends' powers; an implicit step does the work of the means of force and speed."""
    for i in range(g.place.size):
        gone = 0.5 * (g.settled[i, 0] - g.acts[i]) * g.steps[2]
        for c in range(AXES):
            speed = v[g.place[i] + c]
            power, more = g.value[i, c] * speed, gone * g.value[i, c] * (speed - g.settled[i, 1 + c])
            p[0] += g.before[i] * power + more
            p[1] += (g.acts[i] - g.before[i]) * power - more
            g.settled[i, 1 + c] = speed
        g.before[i] = g.settled[i, 0] = g.acts[i]
        g.settled[i, 4] = g.owed[i]
    g.steps[4] = _longest(g, g.steps[1])
    g.steps[0] = g.steps[1]


register(TimedForces, begin=_force_begin, residual=_force_residual, supply=_force_supply)


class Anchors(NamedTuple):
    """Springs (n,) N/m with dampers N s/m from the positions ``place`` (n,) to the fixed points ``home`` (n, 3), eqs
    3.1-3.4: each axis for itself."""

    place: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    home: np.ndarray


@kernel
def _anchor_residual(g, t, q, v, a, r):
    for i in range(g.place.size):
        for c in range(AXES):
            o = g.place[i] + c
            r[o] += g.stiffness[i] * (q[o] - g.home[i, c]) + g.damping[i] * v[o]


@kernel
def _anchor_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.place.size):
        for c in range(AXES):
            o = g.place[i] + c
            add_entry(matrix, dofs, o, o, ck * g.stiffness[i] + cc * g.damping[i])


@kernel
def _anchor_energy(g, t, q, v, e):
    for i in range(g.place.size):
        for c in range(AXES):
            e[1] += 0.5 * g.stiffness[i] * (q[g.place[i] + c] - g.home[i, c]) ** 2


@kernel
def _anchor_dissipation(g, t, q, v, p):
    for i in range(g.place.size):
        for c in range(AXES):
            p[0] += g.damping[i] * v[g.place[i] + c] ** 2


register(
    Anchors, residual=_anchor_residual, tangent=_anchor_tangent, energy=_anchor_energy, dissipation=_anchor_dissipation
)

SPRING = np.dtype([("a", "i8"), ("b", "i8"), ("stiffness", "f8"), ("damping", "f8"), ("length", "f8")])
"""A spring with damper between two positions: places, N/m, N s/m, free length m."""


class Springs(NamedTuple):
    """Springs (n,) of ``SPRING`` along the line between two nodes; ``block`` is zeros (6, 6)."""

    rows: np.recarray
    block: np.ndarray


@kernel
def _line(s, q, v):
    """Unit vector from the first to the second end, distance and its rate; a spring of no length has no direction."""
    x, y, z = q[s.b] - q[s.a], q[s.b + 1] - q[s.a + 1], q[s.b + 2] - q[s.a + 2]
    size = sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    x, y, z = x / size, y / size, z / size
    rate = x * (v[s.b] - v[s.a]) + y * (v[s.b + 1] - v[s.a + 1]) + z * (v[s.b + 2] - v[s.a + 2])
    return x, y, z, size, rate


@kernel
def _spring_residual(g, t, q, v, a, r):
    for i in range(g.rows.size):
        s = g.rows[i]
        x, y, z, size, rate = _line(s, q, v)
        force = s.stiffness * (size - s.length) + s.damping * rate
        r[s.a] -= force * x
        r[s.a + 1] -= force * y
        r[s.a + 2] -= force * z
        r[s.b] += force * x
        r[s.b + 1] += force * y
        r[s.b + 2] += force * z


@kernel
def _spring_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.rows.size):
        s = g.rows[i]
        x, y, z, size, rate = _line(s, q, v)
        n = (x, y, z)
        across = 1.0 / size if size > 0.0 else 0.0
        tension = (s.stiffness * (size - s.length) + s.damping * rate) * across
        for c in range(AXES):
            for d in range(AXES):
                one = 1.0 if c == d else 0.0
                # The rate changes with position as well: its gradient is the velocity across the line over the length.
                across_d = (v[s.b + d] - v[s.a + d] - rate * n[d]) * across
                entry = ck * ((s.stiffness - tension) * n[c] * n[d] + tension * one + s.damping * n[c] * across_d)
                entry += cc * s.damping * n[c] * n[d]
                g.block[c, d] = g.block[3 + c, 3 + d] = entry
                g.block[c, 3 + d] = g.block[3 + c, d] = -entry
        add_block(matrix, dofs, s.a, s.b - s.a, AXES, g.block)


@kernel
def _spring_energy(g, t, q, v, e):
    for i in range(g.rows.size):
        e[1] += 0.5 * g.rows[i].stiffness * (_line(g.rows[i], q, v)[3] - g.rows[i].length) ** 2


@kernel
def _spring_dissipation(g, t, q, v, p):
    for i in range(g.rows.size):
        p[0] += g.rows[i].damping * _line(g.rows[i], q, v)[4] ** 2


register(
    Springs, residual=_spring_residual, tangent=_spring_tangent, energy=_spring_energy, dissipation=_spring_dissipation
)
