"""The wall of the hole around a beam: contact penalty springs at its nodes and along its elements, with friction.

Normal force and friction are those of the lumped model (contact.py, friction.py): N = max(0, k pen + d pen_rate), and a
force of two components, along the hole and around it. Here the point that touches is a point of a beam in space, and
the hole's directions there turn with its place: with ds = t.dx / beta and the curvature K of the axis,

    de = f (f.dx) / offset - (K.e) t ds,    df = -e (f.dx) / offset - (K.f) t ds,    dt = K ds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drillstring.groups.contact import record_contact
from drillstring.groups.friction import act, commit, force_now, prepare, status
from drillstring.groups.sticking import edge_of_the_wall, let_go_without_friction, stuck_on_the_wall
from drillstring.well.in_hole import (
    AXES,
    CENTRED,
    Hole,
    Spot,
    add_directions,
    add_force,
    add_moment,
    add_rotations,
    combined,
    found_depth,
    hold_points,
    spot,
    turned,
)
from tautline.kernels.groups import Edge, Stuck, register
from tautline.kernels.jit import kernel


class BeamContact(NamedTuple):
    """Contacts (n,) of ``PAD`` at the hole's points; ``law`` as in friction.py; ``scratch`` is zeros (2, 4, 4)."""

    hole: Hole
    law: tuple
    springs: np.recarray
    scratch: np.ndarray


class Press(NamedTuple):
    """How a point touches: where it is, its velocity, its rate of offset, normal force and slip velocity."""

    at: Spot
    vx: float
    vy: float
    vz: float
    rate: float
    normal: float
    along: float
    around: float


@kernel
def press(g, i, q, v):
    """Geometry and normal force of contact i (normal force 0 where the pipe is clear of the wall)."""
    p, point = g.springs[i], g.hole.points[i]
    s = spot(g.hole, i, q)
    vx, vy, vz = combined(point, v, 0), combined(point, v, 1), combined(point, v, 2)
    rate = s.ex * vx + s.ey * vy + s.ez * vz
    normal = p.stiffness * (s.offset - p.clearance) + p.damping * rate
    if s.offset < CENTRED:
        normal = 0.0
    along = s.tx * vx + s.ty * vy + s.tz * vz
    around = s.fx * vx + s.fy * vy + s.fz * vz + p.radius * turned(point, v)
    return Press(s, vx, vy, vz, rate, max(0.0, normal), along, around)


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    hold_points(g.hole, q)
    for i in range(g.springs.size):
        point = g.hole.points[i]
        c = press(g, i, q, v)
        s = c.at
        ax, ay, az = combined(point, a, 0), combined(point, a, 1), combined(point, a, 2)
        around_rate = s.fx * ax + s.fy * ay + s.fz * az + g.springs[i].radius * turned(point, a)
        prepare(g.law, i, h, beta, gamma, c, s.tx * ax + s.ty * ay + s.tz * az, around_rate)


@kernel
def _switch(g, t, q, v, converged, changed):
    for i in range(g.springs.size):
        c = press(g, i, q, v)
        changed[0] += status(g.law, i, c, converged)


@kernel
def _residual(g, t, q, v, a, r):
    for i in range(g.springs.size):
        c = press(g, i, q, v)
        if c.normal > 0.0:
            p, point, s, n = g.springs[i], g.hole.points[i], c.at, c.normal
            along, around = act(g.law, i, c)[0:2]
            add_force(
                point, n * s.ex - along * s.tx - around * s.fx, n * s.ey - along * s.ty - around * s.fy,
                n * s.ez - along * s.tz - around * s.fz, r,
            )  # fmt: skip
            add_moment(point, p.viscous * turned(point, v) - p.radius * around, r)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    stiffness, damping = g.scratch[0], g.scratch[1]
    for i in range(g.springs.size):
        c = press(g, i, q, v)
        if c.normal > 0.0:
            point = g.hole.points[i]
            _write_tangent(g, i, c, turned(point, v), stiffness, damping)
            for k in range(AXES + 1):
                for l in range(AXES + 1):
                    damping[k, l] = ck * stiffness[k, l] + cc * damping[k, l]
            add_directions(matrix, dofs, point, damping)
            add_rotations(matrix, dofs, point, damping)


@kernel
def _write_tangent(g, i, c, spin, stiffness, damping):
    """dr/dq and dr/dv (4, 4) of one contact by the point's position and its rotation."""
    along, around, aa, ac, ca, cc, an, cn = act(g.law, i, c)
    p, s = g.springs[i], c.at
    t, e, f = (s.tx, s.ty, s.tz), (s.ex, s.ey, s.ez), (s.fx, s.fy, s.fz)
    radius, n = p.radius, c.normal
    swirl = c.around - radius * spin
    for d in range(AXES):
        way, turn = t[d] / s.beta, f[d] / s.offset
        # How normal force and slip change with position, and what friction makes of it.
        n_q = p.stiffness * e[d] + p.damping * (turn * swirl - s.bend_e * way * c.along)
        along_q = way * (s.bend_e * c.rate + s.bend_f * swirl)
        around_q = -turn * c.rate - s.bend_f * way * c.along
        a_q = aa * along_q + ac * around_q + an * n_q
        c_q = ca * along_q + cc * around_q + cn * n_q
        # The same with velocity.
        n_v = p.damping * e[d]
        a_v = aa * t[d] + ac * f[d] + an * n_v
        c_v = ca * t[d] + cc * f[d] + cn * n_v
        for k in range(AXES):
            e_q = turn * f[k] - s.bend_e * way * t[k]
            f_q = -turn * e[k] - s.bend_f * way * t[k]
            t_q = way * (s.bend_e * e[k] + s.bend_f * f[k])
            stiffness[k, d] = n_q * e[k] + n * e_q - a_q * t[k] - along * t_q - c_q * f[k] - around * f_q
            damping[k, d] = n_v * e[k] - a_v * t[k] - c_v * f[k]
        stiffness[AXES, d] = -radius * c_q
        damping[AXES, d] = -radius * c_v
        stiffness[d, AXES] = 0.0
        damping[d, AXES] = -radius * (ac * t[d] + cc * f[d])
    stiffness[AXES, AXES] = 0.0
    damping[AXES, AXES] = p.viscous - radius * cc * radius


@kernel
def _energy(g, t, q, v, e):
    for i in range(g.springs.size):
        depth = spot(g.hole, i, q).offset - g.springs[i].clearance
        if depth > 0.0:
            e[1] += 0.5 * g.springs[i].stiffness * depth**2


@kernel
def _dissipation(g, t, q, v, p):
    """With the mean of the friction at both ends of the step, which ``_commit`` has kept."""
    for i in range(g.springs.size):
        c = press(g, i, q, v)
        spring = g.springs[i]
        p[0] += (c.normal - spring.stiffness * max(0.0, c.at.offset - spring.clearance)) * c.rate
        if c.normal > 0.0:
            spin = turned(g.hole.points[i], v)
            p[0] += spring.viscous * spin**2 - spring.mean_along * c.along - spring.mean_around * c.around


@kernel
def _commit(g, t, h, q, v, a):
    for i in range(g.springs.size):
        c = press(g, i, q, v)
        commit(g.law, i, c)
        along, around = force_now(g.law, i, c)
        along, around = (along, around) if c.normal > 0.0 else (0.0, 0.0)
        share = 0.5 if h > 0.0 else 0.0
        g.springs[i].mean_along = along + share * (g.springs[i].along - along)
        g.springs[i].mean_around = around + share * (g.springs[i].around - around)
        g.springs[i].normal, g.springs[i].along, g.springs[i].around = c.normal, along, around


def _hold(g: BeamContact) -> None:
    """Have what sticks stick, but for what has no friction any more."""
    let_go_without_friction(g.law)


def _sticks(g: BeamContact, t: float) -> list[Stuck]:
    """The points of the beam that stick."""
    return stuck_on_the_wall(g.law, g.springs, g.hole.points.place[:, 0], lambda i: _name(g.hole, i))


def _edges(g: BeamContact, q: np.ndarray, v: np.ndarray) -> list[Edge]:
    """How far points of the beam with a direction to the wall are from it."""
    found = []
    for i, (point, spring) in enumerate(zip(g.hole.points, g.springs, strict=True)):
        c = press(g, i, q, v)
        if c.at.offset >= CENTRED:
            place, name = int(point.place[0]), _name(g.hole, i)
            found.append(edge_of_the_wall(place, spring, c.at.offset, c.rate, c.at.ez, name))
    return found


def _name(hole: Hole, i: int) -> str:
    """A point by where it was found last in the hole: most lie between two nodes."""
    return f"the string at {found_depth(hole, i):.1f} m of the hole"


register(
    BeamContact, friction=True, begin=_begin, switch=_switch, residual=_residual, tangent=_tangent, energy=_energy,
    dissipation=_dissipation, commit=_commit, record=record_contact, hold=_hold, sticks=_sticks,
    edges=_edges,
)  # fmt: skip
