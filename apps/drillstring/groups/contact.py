"""The wall of the hole: contact penalty springs at every lump, with friction along and around the hole.

The normal force is ``N = max(0, k pen + d pen_rate)``, with no gate on the penetration: a gate would let N jump by
``d pen_rate`` at first touch, and the implicit step would have no solution there. Friction is a force of two
components, along the hole and around it, at the contact point on the pipe; ``w`` is the slip velocity there. The law of
friction is chosen by the type of ``WallContact.law`` (friction.py).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drillstring.groups.friction import act, status
from drillstring.groups.friction_of_four import arrest, commit, may_change, note, prepare, resist, slip_of
from drillstring.groups.sticking import edge_of_the_wall, let_go_without_friction, stuck_on_the_wall
from tautline.kernels.changes import note_change
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import Edge, Stuck, register
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import (
    LANES,
    add_rows,
    any_of,
    gather,
    keep_rows,
    lane,
    larger,
    load,
    load_fields,
    load_rows,
    same_rows,
    scatter,
    sqrt,
    store,
    store_fields,
    total,
    where,
    within,
)
from tautline.lumped.curve import ALONE, PER_BODY, STRIDE, Curve, downward, held_arcs, members

CENTRED = 1.0e-6
"""Offset from the hole's axis, m, below which no direction to the wall is defined."""


NUMBERS = (
    "stiffness", "damping", "clearance", "radius", "viscous", "normal", "along", "around", "mean_along", "mean_around",
)  # fmt: skip
PAD = np.dtype([(name, np.float64) for name in NUMBERS])
"""A contact: stiffness N/m; damping N s/m; radial clearance m; pipe radius m; viscous friction about the axis while in
contact N m s; then normal force and friction along and around at the last accepted step, N, and
the mean of that friction and the one before."""
SPRING = np.dtype([("body", np.int64)] + [(name, np.float64) for name in NUMBERS])
"""The same of a lump, behind the index of its body."""


class WallContact(NamedTuple):
    """Contacts (n,) of ``SPRING`` of successive bodies; ``law`` is the law of friction with its own rows.

    ``scratch`` is zeros (2, 4, 4). ``kept`` is from :func:`nothing_kept`, or empty: then nothing is kept.
    """

    curve: Curve
    law: tuple
    springs: np.recarray
    scratch: np.ndarray
    kept: np.ndarray = np.zeros(0)


KEPT = 16
"""Numbers that are kept of a contact: its body's coordinates and rates (8), and how it touches with them (8)."""


def nothing_kept(count: int) -> np.ndarray:
    """Room for how ``count`` contacts touch at a state, which a step asks for several times; no state yet."""
    return np.full(-(-count // LANES) * LANES * KEPT, np.nan)


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


@kernel(forceinline=True)
def _touching(x, y, dx, dy, slide, spin, stiffness, damping, clearance, radius, k1, k2):
    """How a lump at (x, y) touches, or four of them in lanes; ``slide`` m/s along the hole, ``spin`` rad/s."""
    offset = sqrt(x * x + y * y)
    centred = offset < CENTRED
    offset = larger(offset, CENTRED)
    over = 1.0 / offset
    ex, ey = where(centred, 1.0, x * over), where(centred, 0.0, y * over)
    rate = ex * dx + ey * dy
    normal = stiffness * (offset - clearance) + damping * rate
    beta = where(centred, 1.0, 1.0 - (k1 * ex + k2 * ey) * (offset + radius))
    along = where(centred, 0.0, beta * slide)
    around = where(centred, 0.0, ex * dy - ey * dx + radius * spin)
    normal = where(centred, 0.0, larger(normal, 0.0))
    return Touch(ex, ey, offset, where(centred, 0.0, rate), normal, along, around, beta)


@kernel
def touch(g, i, q, v):
    """Geometry and normal force of contact i (normal force 0 where the pipe is clear of the wall)."""
    p = g.springs[i]
    seat, o = g.curve.seats[p.body], PER_BODY * p.body
    return _touching(
        q[o + 1], q[o + 2], v[o + 1], v[o + 2], v[o], v[o + 3],
        p.stiffness, p.damping, p.clearance, p.radius, seat.k1, seat.k2,
    )  # fmt: skip


@kernel(forceinline=True)
def _touch_of_four(g, i, last, above, q, v):
    """The same of contacts i to i + 3, in lanes; contact 0 is that of body ``above``."""
    _, x, y, _ = load_rows(q, above + i, above + last)
    slide, dx, dy, spin = load_rows(v, above + i, above + last)
    k1, k2, _, _ = held_arcs(g.curve, above + i, above + last)
    return _touching(x, y, dx, dy, slide, spin, *load_fields(g.springs.stiffness, i, last), k1, k2)


@kernel(forceinline=True)
def _touch_anew(g, i, last, above, q, v):
    """The same, found and kept."""
    c = _touch_of_four(g, i, last, above, q, v)
    if g.kept.size > 0:
        at = KEPT * i
        keep_rows(q, above + i, above + last, g.kept, at)
        keep_rows(v, above + i, above + last, g.kept, at + 16)
        store(g.kept, at + 32, c.ex)
        store(g.kept, at + 36, c.ey)
        store(g.kept, at + 40, c.offset)
        store(g.kept, at + 44, c.rate)
        store(g.kept, at + 48, c.normal)
        store(g.kept, at + 52, c.along)
        store(g.kept, at + 56, c.around)
        store(g.kept, at + 60, c.beta)
    return c


@kernel(forceinline=True)
def _touch_here(g, i, last, above, q, v):
    """The same, as it was found last where coordinates and rates are those of then, number by number.

    In the iterations of a step laws and forces ask for the same state in turn; its acceptance asks once more. What else
    it depends on is the same from the beginning of a step on, when it is found anew. ``i`` is a multiple of `LANES`.
    """
    kept, at = g.kept, KEPT * i
    if kept.size > 0 and same_rows(q, above + i, above + last, kept, at):
        if same_rows(v, above + i, above + last, kept, at + 16):
            return Touch(
                load(kept, at + 32), load(kept, at + 36), load(kept, at + 40), load(kept, at + 44),
                load(kept, at + 48), load(kept, at + 52), load(kept, at + 56), load(kept, at + 60),
            )  # fmt: skip
    return _touch_anew(g, i, last, above, q, v)


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    last = g.springs.size
    above = _first_body(g)
    for i in range(0, last, LANES):
        c = _touch_anew(g, i, last, above, q, v)
        slide, dx, dy, spin = load_rows(a, above + i, above + last)
        around_rate = c.ex * dy - c.ey * dx + gather(g.springs.radius, i, last) * spin
        prepare(g.law, i, last, h, beta, gamma, c, c.beta * slide, around_rate)


@kernel(forceinline=True)
def _first_body(g):
    """The body of the first contact; the others follow."""
    return g.springs[0].body if g.springs.size > 0 else 0


@kernel
def _in_window(g, above):
    """First and past the last contact that is asked for."""
    first, last = members(g.curve, ALONE, above + g.springs.size)
    return max(0, first - above), max(0, last - above)


@kernel
def _switch(g, t, q, v, converged, changed):
    above = _first_body(g)
    first, last = _in_window(g, above)
    for i in range(first // LANES * LANES, last, LANES):
        c = _touch_here(g, i, last, above, q, v)
        asks = may_change(g.law, i, last, c, converged)
        if any_of(asks):
            asked = where(asks, 1.0, 0.0)
            for k in range(max(i, first), min(i + LANES, last)):
                if lane(asked, k - i) > 0.0 and status(g.law, k, slip_of(c, k - i), converged) > 0:
                    note_change(changed, PER_BODY * (above + k), PER_BODY)


@kernel
def _residual(g, t, q, v, a, r):
    above = _first_body(g)
    first, last = _in_window(g, above)
    for i in range(first // LANES * LANES, last, LANES):
        c = _touch_here(g, i, last, above, q, v)
        presses = c.normal > 0.0
        if any_of(presses):
            along, around = resist(g.law, i, last, c)
            slide, dx, dy, turn = load_rows(a, above + i, above + last)
            radius, viscous, _, _ = load_fields(g.springs.radius, i, last)
            note(g.law, i, last, c, c.beta * slide, c.ex * dy - c.ey * dx + radius * turn)
            along, around = where(presses, along, 0.0), where(presses, around, 0.0)
            _, _, _, spin = load_rows(v, above + i, above + last)
            about = where(presses, viscous, 0.0) * spin - radius * around
            add_rows(
                r, above + i, above + last, -c.beta * along, c.normal * c.ex + around * c.ey,
                c.normal * c.ey - around * c.ex, about,
            )  # fmt: skip


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    stiffness, damping = g.scratch[0], g.scratch[1]
    first, last = _in_window(g, _first_body(g))
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
    last = g.springs.size
    above = _first_body(g)
    for i in range(0, last, LANES):
        c = _touch_of_four(g, i, last, above, q, v)
        stiffness, _, clearance, _ = load_fields(g.springs.stiffness, i, last)
        _, _, _, spin = load_rows(v, above + i, above + last)
        _, _, mean_along, mean_around = load_fields(g.springs.along, i, last)
        lost = (c.normal - stiffness * larger(c.offset - clearance, 0.0)) * c.rate
        rubbed = gather(g.springs.viscous, i, last) * spin * spin - mean_along * c.along - mean_around * c.around
        lost += where(c.normal > 0.0, rubbed, 0.0)
        p[0] += total(where(within(i, last), lost, 0.0))


@kernel
def _commit(g, t, h, q, v, a):
    share = 0.5 if h > 0.0 else 0.0
    rows, last = g.springs, g.springs.size
    above = _first_body(g)
    for i in range(0, last, LANES):
        c = _touch_here(g, i, last, above, q, v)
        along, around = commit(g.law, i, last, c)
        presses = c.normal > 0.0
        if h > 0.0:
            slide, _, _, _ = load_rows(a, above + i, above + last)
            along, held = arrest(g.law, i, last, c, along, c.beta * slide)
            if any_of(held):
                still = where(held, 1.0, 0.0)
                for k in range(i, min(i + LANES, last)):
                    if lane(still, k - i) > 0.0:
                        a[PER_BODY * (above + k)] = 0.0
        along, around = where(presses, along, 0.0), where(presses, around, 0.0)
        before, about, _, _ = load_fields(rows.along, i, last)
        means = along + share * (before - along), around + share * (about - around)
        store_fields(rows.along, i, last, along, around, *means)
        scatter(rows.normal, i, last, c.normal)


@kernel
def record_contact(g, out, at):
    """Normal force and friction force along and around, of every contact: (n, 3) in a row."""
    for i in range(g.springs.size):
        p = g.springs[i]
        out[at[0] + 3 * i] = p.normal
        out[at[0] + 3 * i + 1] = p.along
        out[at[0] + 3 * i + 2] = p.around
    at[0] += 3 * g.springs.size


def _hold(g: WallContact) -> None:
    """Have what sticks stick, but for what has no friction any more."""
    let_go_without_friction(g.law)


def _sticks(g: WallContact, t: float) -> list[Stuck]:
    """The lumps that stick."""
    return stuck_on_the_wall(g.law, g.springs, PER_BODY * g.springs.body)


def _edges(g: WallContact, q: np.ndarray, v: np.ndarray) -> list[Edge]:
    """How far lumps with a direction to the wall are from it."""
    found = []
    for i, spring in enumerate(g.springs):
        c, place = touch(g, i, q, v), PER_BODY * int(spring.body)
        if c.offset > CENTRED:
            g1, g2, _ = downward(g.curve, spring.body, q[place])
            found.append(edge_of_the_wall(place + 1, spring, c.offset, c.rate, c.ex * g1 + c.ey * g2))
    return found


register(
    WallContact, friction=True, begin=_begin, switch=_switch, residual=_residual, tangent=_tangent, energy=_energy,
    dissipation=_dissipation, commit=_commit, record=record_contact, hold=_hold, sticks=_sticks,
    edges=_edges,
)  # fmt: skip
