"""The wall of the hole: contact penalty springs at every lump, with friction along and around the hole.

The normal force is ``N = max(0, k pen + d pen_rate)``, with no gate on the penetration: a gate would let N jump by
``d pen_rate`` at first touch, and the implicit step would have no solution there. Friction is a force of two
components, along the hole and around it, at the contact point on the pipe; ``w`` is the slip velocity there. The law of
friction is chosen by the type of ``WallContact.law`` (friction.py).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from drillstring.groups.friction import act, force_now, prepare, settle, status
from tautline.kernels.changes import note_change
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.lumped.curve import ALONE, PER_BODY, STRIDE, Curve, members

CENTRED = 1.0e-6
"""Offset from the hole's axis, m, below which no direction to the wall is defined."""


SPRING = np.dtype(
    [("body", np.int64)]
    + [
        (name, np.float64)
        for name in (
            "stiffness",
            "damping",
            "clearance",
            "radius",
            "viscous",
            "normal",
            "along",
            "around",
            "mean_along",
            "mean_around",
        )
    ]
)
"""A contact: body index; stiffness N/m; damping N s/m; radial clearance m; pipe radius m; viscous friction about the
axis while in contact N m s; then normal force and friction along and around at the last accepted step, N, and
the mean of that friction and the one before."""


class WallContact(NamedTuple):
    """Contacts (n,) of ``SPRING`` of successive bodies; ``law`` is the law of friction with its own rows.

    ``scratch`` is zeros (2, 4, 4).
    """

    curve: Curve
    law: tuple
    springs: np.recarray
    scratch: np.ndarray


class Touch(NamedTuple):
    """How one lump touches: radial unit vector, offset, its rate, normal force, slip velocity, factor beta."""

    ex: float
    ey: float
    offset: float
    rate: float
    normal: float
    along: float
    around: float
    beta: float


@kernel
def touch(g, i, q, v):
    """Geometry and normal force of contact i (normal force 0 where the pipe is clear of the wall)."""
    p = g.springs[i]
    o = PER_BODY * p.body
    x, y = q[o + 1], q[o + 2]
    offset = sqrt(x * x + y * y)
    if offset < CENTRED:
        return Touch(1.0, 0.0, CENTRED, 0.0, 0.0, 0.0, 0.0, 1.0)
    ex, ey = x / offset, y / offset
    rate = ex * v[o + 1] + ey * v[o + 2]
    normal = p.stiffness * (offset - p.clearance) + p.damping * rate
    seat = g.curve.seats[p.body]
    beta = 1.0 - (seat.k1 * ex + seat.k2 * ey) * (offset + p.radius)
    along = beta * v[o]
    around = ex * v[o + 2] - ey * v[o + 1] + p.radius * v[o + 3]
    return Touch(ex, ey, offset, rate, max(0.0, normal), along, around, beta)


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    for i in range(g.springs.size):
        o = PER_BODY * g.springs[i].body
        c = touch(g, i, q, v)
        slip_rate_around = c.ex * a[o + 2] - c.ey * a[o + 1] + g.springs[i].radius * a[o + 3]
        prepare(g.law, i, h, beta, gamma, c, c.beta * a[o], slip_rate_around)


@kernel
def _in_window(g):
    """First and past the last contact that is asked for."""
    above = g.springs[0].body if g.springs.size > 0 else 0
    first, last = members(g.curve, ALONE, above + g.springs.size)
    return max(0, first - above), max(0, last - above)


@kernel
def _switch(g, t, q, v, converged, changed):
    first, last = _in_window(g)
    for i in range(first, last):
        c = touch(g, i, q, v)
        if status(g.law, i, c, converged) > 0:
            note_change(changed, PER_BODY * g.springs[i].body, PER_BODY)


@kernel
def _residual(g, t, q, v, a, r):
    first, last = _in_window(g)
    for i in range(first, last):
        c = touch(g, i, q, v)
        if c.normal > 0.0:
            o = PER_BODY * g.springs[i].body
            along, around = act(g.law, i, c)[0:2]
            r[o] -= c.beta * along
            r[o + 1] += c.normal * c.ex + around * c.ey
            r[o + 2] += c.normal * c.ey - around * c.ex
            r[o + 3] += g.springs[i].viscous * v[o + 3] - g.springs[i].radius * around


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    stiffness, damping = g.scratch[0], g.scratch[1]
    first, last = _in_window(g)
    for i in range(first, last):
        c = touch(g, i, q, v)
        if c.normal > 0.0:
            o = PER_BODY * g.springs[i].body
            _contact_tangent(g, i, c, v[o : o + PER_BODY], stiffness, damping)
            for k in range(PER_BODY):
                for l in range(PER_BODY):
                    damping[k, l] = ck * stiffness[k, l] + cc * damping[k, l]
            add_block(matrix, dofs, o, STRIDE, STRIDE, damping)


@kernel
def _contact_tangent(g, i, c, v, stiffness, damping):
    """dr/dq and dr/dv (4, 4) of one contact, columns x, u, v, theta.

    With e the radial and f the circumferential unit vector, de = f f.dx / offset and df = -e f.dx / offset.
    """
    along, around, aa, ac, ca, cc, an, cn = act(g.law, i, c)
    p = g.springs[i]
    seat = g.curve.seats[p.body]
    radius = p.radius
    swirl = c.around - radius * v[3]
    bend_e = seat.k1 * c.ex + seat.k2 * c.ey
    bend_f = seat.k2 * c.ex - seat.k1 * c.ey
    damping[0, 0] = -c.beta * aa * c.beta
    damping[1, 0] = ca * c.beta * c.ey
    damping[2, 0] = -ca * c.beta * c.ex
    damping[3, 0] = -radius * ca * c.beta
    damping[0, 3] = -c.beta * ac * radius
    damping[1, 3] = cc * radius * c.ey
    damping[2, 3] = -cc * radius * c.ex
    damping[3, 3] = p.viscous - radius * cc * radius
    for j in range(1, 3):
        e_j = c.ex if j == 1 else c.ey
        f_j = -c.ey if j == 1 else c.ex
        turn = f_j / c.offset
        beta_q = -(bend_e * e_j + bend_f * turn * (c.offset + radius))
        normal_q = g.springs[i].stiffness * e_j + g.springs[i].damping * swirl * turn
        normal_v = g.springs[i].damping * e_j
        along_q = aa * v[0] * beta_q - ac * c.rate * turn + an * normal_q
        along_v = ac * f_j + an * normal_v
        around_q = ca * v[0] * beta_q - cc * c.rate * turn + cn * normal_q
        around_v = cc * f_j + cn * normal_v
        stiffness[0, j] = -beta_q * along - c.beta * along_q
        stiffness[1, j] = normal_q * c.ex - c.normal * turn * c.ey + around_q * c.ey + around * turn * c.ex
        stiffness[2, j] = normal_q * c.ey + c.normal * turn * c.ex - around_q * c.ex + around * turn * c.ey
        stiffness[3, j] = -radius * around_q
        damping[0, j] = -c.beta * along_v
        damping[1, j] = normal_v * c.ex + around_v * c.ey
        damping[2, j] = normal_v * c.ey - around_v * c.ex
        damping[3, j] = -radius * around_v


@kernel
def _energy(g, t, q, v, e):
    for i in range(g.springs.size):
        o = PER_BODY * g.springs[i].body
        depth = sqrt(q[o + 1] ** 2 + q[o + 2] ** 2) - g.springs[i].clearance
        if depth > 0.0:
            e[1] += 0.5 * g.springs[i].stiffness * depth**2


@kernel
def _dissipation(g, t, q, v, p):
    """With the mean of the friction at both ends of the step, which ``_commit`` has kept."""
    for i in range(g.springs.size):
        c = touch(g, i, q, v)
        depth = c.offset - g.springs[i].clearance
        p[0] += (c.normal - g.springs[i].stiffness * max(0.0, depth)) * c.rate
        if c.normal > 0.0:
            spin = v[PER_BODY * g.springs[i].body + 3]
            p[0] += g.springs[i].viscous * spin**2
            p[0] -= g.springs[i].mean_along * c.along + g.springs[i].mean_around * c.around


@kernel
def _commit(g, t, h, q, v, a):
    for i in range(g.springs.size):
        c = touch(g, i, q, v)
        settle(g.law, i, c)
        along, around = force_now(g.law, i, c)
        along, around = (along, around) if c.normal > 0.0 else (0.0, 0.0)
        share = 0.5 if h > 0.0 else 0.0
        g.springs[i].mean_along = along + share * (g.springs[i].along - along)
        g.springs[i].mean_around = around + share * (g.springs[i].around - around)
        g.springs[i].normal, g.springs[i].along, g.springs[i].around = c.normal, along, around


@kernel
def _record(g, out, at):
    """Normal force and friction force along and around, of every contact: (n, 3) in a row."""
    for i in range(g.springs.size):
        p = g.springs[i]
        out[at[0] + 3 * i] = p.normal
        out[at[0] + 3 * i + 1] = p.along
        out[at[0] + 3 * i + 2] = p.around
    at[0] += 3 * g.springs.size


register(
    WallContact, friction=True, begin=_begin, switch=_switch, residual=_residual, tangent=_tangent, energy=_energy,
    dissipation=_dissipation, commit=_commit, record=_record,
)  # fmt: skip
