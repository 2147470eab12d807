"""What a rope carries and turns: bodies with water and ground around them and springs that hold them; rims."""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES
from crane.groups.current import Current, carry
from tautline.kernels.changes import COUNT
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import Edge, register
from tautline.kernels.jit import kernel
from tautline.kernels.time_function import TimeFunctions, evaluate

BODY = np.dtype(
    [
        ("place", "i8"), ("mass", "f8"), ("remaining", "f8"), ("released", "f8"), ("added", "f8", (3,)),
        ("linear", "f8", (3,)), ("quadratic", "f8", (3,)), ("lift", "f8", (3,)), ("functions", "i8", (3,)),
        ("bottom", "f8"), ("touches", "i8"),
    ]
)  # fmt: skip
"""A body: the place of its position, mass kg, what remains of it from a time (s) on, infinite once that is past, added
mass kg and drag N s/m, N s^2/m^2 along each axis, buoyancy N, numbers of functions of time of a force (N) or -1, the
depth of its bottom below its position m, and whether there is ground below it."""
NOW, BEFORE = range(2)
"""Places in ``gone``: in the step under way, and after the last."""
STILL = 1.0e-3
"""Speed, m/s, below which friction on the ground fades, so that a load at rest stays there."""


class Bodies(NamedTuple):
    """Bodies (n,) of ``BODY``, and what is ``left`` (n,) of each after its release.

    ``gravity`` (3,) m/s^2 acts on them, and below is ``ground`` (4,): level m, stiffness N/m, damping N s/m, friction.
    ``gone`` (n, 2) is 1 for those that were released. ``mass`` (n,) is what each has in the step under way and ``kept``
    (n,) what it had after the last; ``let_go`` (n, 2) is the power, W, at which energy leaves with what is released: at
    the start of the step of its release, where an explicit method keeps its books, and at the end, where an implicit
    one does. Drag is by the velocity past a ``current``.
    """

    rows: np.recarray
    left: np.recarray
    gravity: np.ndarray
    ground: np.ndarray
    gone: np.ndarray
    mass: np.ndarray
    kept: np.ndarray
    let_go: np.ndarray
    functions: TimeFunctions
    current: Current


@kernel
def _ground(g, b, q, v):
    """How deep a body is in the ground, and the force that the ground pushes up with, N."""
    depth = g.ground[0] - (q[b.place + 2] - b.bottom)
    if b.touches == 0 or depth <= 0.0:
        return 0.0, 0.0
    return depth, max(0.0, g.ground[1] * depth - g.ground[2] * v[b.place + 2])


@kernel
def _energy_of(g, b, mass, q, v):
    """Energy of a body as a row of ``BODY`` has it, J: of its motion, in gravity and water, and of the ground below."""
    energy = 0.0
    for c in range(AXES):
        o = b.place + c
        energy += 0.5 * (mass + b.added[c]) * v[o] ** 2 - (mass * g.gravity[c] + b.lift[c]) * q[o]
    depth, _ = _ground(g, b, q, v)
    return energy + 0.5 * g.ground[1] * depth * depth


@kernel
def _body_begin(g, t, h, beta, gamma, q, v, a):
    """A load drops at the beginning of a step: one begins at its time (`Releases`), up to rounding."""
    for n in range(g.rows.size):
        b = g.rows[n]
        g.let_go[n, 0] = g.let_go[n, 1] = 0.0
        if beta < 0.0:
            # An equilibrium is one with all of the load.
            g.mass[n], g.gone[n, NOW] = g.kept[n], g.gone[n, BEFORE]
            continue
        drops = t + 0.5 * h >= b.released
        g.mass[n] = b.remaining if drops else g.kept[n]
        g.gone[n, NOW] = 1 if drops else g.gone[n, BEFORE]
        if h > 0.0 and gamma >= 0.0 and g.gone[n, NOW] != g.gone[n, BEFORE]:
            energy = _energy_of(g, b, g.kept[n], q, v) - _energy_of(g, g.left[n], g.mass[n], q, v)
            # The ledger takes the mean of the powers at both ends of a step: twice it at one end is all of it.
            g.let_go[n, 1 if beta > 0.0 else 0] = 2.0 * energy / h


@kernel
def _body_commit(g, t, h, q, v, a):
    for n in range(g.rows.size):
        if h > 0.0:
            if g.gone[n, NOW] != g.gone[n, BEFORE]:
                # It happens once: what is changed later stays.
                g.rows[n].released = np.inf
            g.kept[n], g.gone[n, BEFORE] = g.mass[n], g.gone[n, NOW]


@kernel
def _body_residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[n, NOW] == 0 else g.left[n]
        carry(g.current, q[b.place + 2])
        for c in range(AXES):
            o = b.place + c
            past = v[o] - g.current.flow[c]
            r[o] += (g.mass[n] + b.added[c]) * a[o] - g.mass[n] * g.gravity[c] - b.lift[c]
            r[o] += b.linear[c] * past + b.quadratic[c] * abs(past) * past
            if b.functions[c] >= 0:
                force, _, _ = evaluate(g.functions, b.functions[c], t)
                r[o] -= force
        _, push = _ground(g, b, q, v)
        if push > 0.0:
            r[b.place + 2] -= push
            x, y = v[b.place], v[b.place + 1]
            size = sqrt(x * x + y * y + STILL * STILL)
            r[b.place] += g.ground[3] * push * x / size
            r[b.place + 1] += g.ground[3] * push * y / size


@kernel
def _body_mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[n, NOW] == 0 else g.left[n]
        for c in range(AXES):
            add_entry(matrix, dofs, b.place + c, b.place + c, g.mass[n] + b.added[c])


@kernel
def _body_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[n, NOW] == 0 else g.left[n]
        carry(g.current, q[b.place + 2])
        for c in range(AXES):
            o = b.place + c
            drag = b.linear[c] + 2.0 * b.quadratic[c] * abs(v[o] - g.current.flow[c])
            add_entry(matrix, dofs, o, o, cm * (g.mass[n] + b.added[c]) + cc * drag)
            if g.current.shear[c] != 0.0:
                add_entry(matrix, dofs, o, b.place + 2, -ck * drag * g.current.shear[c])
        _, push = _ground(g, b, q, v)
        if push > 0.0:
            z = b.place + 2
            by = ck * g.ground[1] + cc * g.ground[2]
            add_entry(matrix, dofs, z, z, by)
            x, y = v[b.place], v[b.place + 1]
            size = sqrt(x * x + y * y + STILL * STILL)
            for c in range(2):
                add_entry(matrix, dofs, b.place + c, z, -g.ground[3] * by * v[b.place + c] / size)
                for d in range(2):
                    own = 1.0 if c == d else 0.0
                    bent = (own - v[b.place + c] * v[b.place + d] / (size * size)) / size
                    add_entry(matrix, dofs, b.place + c, b.place + d, cc * g.ground[3] * push * bent)


@kernel
def _body_switch(g, t, q, v, converged, changed):
    """A body that touches the ground, or leaves it, has another tangent: ``touches`` 1 is free of it, 2 on it."""
    if converged:
        return
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[n, NOW] == 0 else g.left[n]
        if b.touches > 0:
            _, push = _ground(g, b, q, v)
            now = 2 if push > 0.0 else 1
            if now != b.touches:
                g.rows[n].touches = g.left[n].touches = now
                changed[0] += 1


@kernel
def _body_energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[n, BEFORE] == 0 else g.left[n]
        for c in range(AXES):
            o = b.place + c
            energy[0] += 0.5 * (g.kept[n] + b.added[c]) * v[o] * v[o]
            energy[2] -= (g.kept[n] * g.gravity[c] + b.lift[c]) * q[o]
        depth, _ = _ground(g, b, q, v)
        energy[1] += 0.5 * g.ground[1] * depth * depth


@kernel
def _body_dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[n, NOW] == 0 else g.left[n]
        carry(g.current, q[b.place + 2])
        for c in range(AXES):
            past = v[b.place + c] - g.current.flow[c]
            p[0] += (b.linear[c] + b.quadratic[c] * abs(past)) * past * past
        depth, push = _ground(g, b, q, v)
        if depth > 0.0:
            x, y = v[b.place], v[b.place + 1]
            p[0] += (g.ground[1] * depth - push) * v[b.place + 2]
            p[0] += g.ground[3] * push * (x * x + y * y) / sqrt(x * x + y * y + STILL * STILL)


@kernel
def _body_supply(g, t, q, v, p):
    for n in range(g.rows.size):
        b = g.rows[n] if g.gone[n, NOW] == 0 else g.left[n]
        # At the end of the step, and no longer at the start of the next.
        p[0] -= g.let_go[n, 1]
        p[1] += g.let_go[n, 1]
        # At the start of the step, and not at the end of the one before. Where a frame ends with the step, its end is
        # asked for too: then nothing may be left.
        p[1] -= g.let_go[n, 0]
        g.let_go[n, 0] = 0.0
        carry(g.current, q[b.place + 2])
        for c in range(AXES):
            past = v[b.place + c] - g.current.flow[c]
            p[0] -= (b.linear[c] + b.quadratic[c] * abs(past)) * past * g.current.flow[c]
            if b.functions[c] >= 0:
                force, _, _ = evaluate(g.functions, b.functions[c], t)
                p[0] += force * v[b.place + c]


@kernel
def supply_of_release(g, t, q, v, p):
    """What leaves with a load that drops, of a group with ``rows`` and ``let_go`` as `Bodies` have them."""
    for n in range(g.rows.size):
        p[0] -= g.let_go[n, 1]
        p[1] += g.let_go[n, 1] - g.let_go[n, 0]
        g.let_go[n, 0] = 0.0


def _body_edges(g: Bodies, q: np.ndarray, v: np.ndarray) -> list[Edge]:
    """How far bodies are from the ground, or from where it lets them go; one that lifts off is free once its damper
    would pull."""
    level, stiffness, damping, _ = g.ground
    found = []
    for whole, left, gone in zip(g.rows, g.left, g.gone[:, NOW], strict=True):
        b = left if gone else whole
        if b.touches == 0:
            continue
        depth = level - (q[b.place + 2] - b.bottom)
        pressed = min(depth, depth - damping / stiffness * v[b.place + 2]) if depth > 0.0 else depth
        places = (int(b.place) + 2,)
        found.append(Edge(places, pressed > 0.0, abs(pressed), stiffness, "is pressed into the ground", CLEAR))
    return found


CLEAR = "is clear of the ground"

register(
    Bodies, begin=_body_begin, switch=_body_switch, residual=_body_residual, mass=_body_mass, tangent=_body_tangent,
    energy=_body_energy, dissipation=_body_dissipation, supply=_body_supply, commit=_body_commit, edges=_body_edges,
)  # fmt: skip


class Releases(NamedTuple):
    """Bodies (n,) of which some drop a part of their mass: ``mass`` and ``kept`` are those of `Bodies`.

    ``at`` (n,) is when, s, infinite for those that do not. A step ends then: in its middle the drop would be early or
    late by up to half a step, which no error of a step shows.
    """

    mass: np.ndarray
    kept: np.ndarray
    at: np.ndarray


@kernel
def _release_instant(g, t, next):
    for n in range(g.at.size):
        if t < g.at[n] < next[0]:
            next[0] = g.at[n]


@kernel
def _release_jump(g, changed):
    for n in range(g.mass.size):
        if g.mass[n] != g.kept[n]:
            changed[COUNT] += 1


register(Releases, instant=_release_instant, jump=_release_jump)


class Rims(NamedTuple):
    """Inertia (n,) of rims, kg, on the degrees of freedom ``place`` (n,): I/R^2 on a rim's travel, or I lambda^2/R^2
    on the material that does not slip on it."""

    place: np.ndarray
    mass: np.ndarray


@kernel
def _rim_residual(g, t, q, v, a, r):
    for i in range(g.place.size):
        r[g.place[i]] += g.mass[i] * a[g.place[i]]


@kernel
def _rim_mass(g, q, matrix, dofs):
    for i in range(g.place.size):
        add_entry(matrix, dofs, g.place[i], g.place[i], g.mass[i])


@kernel
def _rim_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.place.size):
        add_entry(matrix, dofs, g.place[i], g.place[i], cm * g.mass[i])


@kernel
def _rim_energy(g, t, q, v, energy):
    for i in range(g.place.size):
        energy[0] += 0.5 * g.mass[i] * v[g.place[i]] ** 2


register(Rims, residual=_rim_residual, mass=_rim_mass, tangent=_rim_tangent, energy=_rim_energy, constant_mass=True)


class Springs(NamedTuple):
    """Springs (n,) N/m with dampers N s/m that hold the degrees of freedom ``place`` (n,) at ``rest`` (n,) m."""

    place: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    rest: np.ndarray


@kernel
def _spring_residual(g, t, q, v, a, r):
    for i in range(g.place.size):
        o = g.place[i]
        r[o] += g.stiffness[i] * (q[o] - g.rest[i]) + g.damping[i] * v[o]


@kernel
def _spring_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.place.size):
        add_entry(matrix, dofs, g.place[i], g.place[i], ck * g.stiffness[i] + cc * g.damping[i])


@kernel
def _spring_energy(g, t, q, v, energy):
    for i in range(g.place.size):
        energy[1] += 0.5 * g.stiffness[i] * (q[g.place[i]] - g.rest[i]) ** 2


@kernel
def _spring_dissipation(g, t, q, v, p):
    for i in range(g.place.size):
        p[0] += g.damping[i] * v[g.place[i]] ** 2


register(
    Springs, residual=_spring_residual, tangent=_spring_tangent, energy=_spring_energy, dissipation=_spring_dissipation
)
