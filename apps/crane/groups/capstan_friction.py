"""Friction of ropes on sheaves, of sheaves in their bearings, and of brakes: one law that sticks until it slips.

Each has a coordinate u = k_p p + k_s s of material p at a mark and travel s of a rim. On a rim that moves by itself k_p
is the stretch of the rope there, the mean of both sides at the end of the last step: the same force F is then T lambda
- W on p and, but for the step's change of stretch, T_1 - T_2 on the rim. It resists u. with a force that
grows with u as a stiff spring's does, F = F_n + k (u - u_n), up to a limit F_m, and slips there: return mapping, as in
plasticity (J. C. Simo and T. J. R. Hughes, Computational Inelasticity, 1998, ch. 1). F_n and u_n are those of the last
accepted step. A rope that sticks does not creep, and its tangent is that of the spring. The limits:

- ``CAPSTAN``, Euler-Eytelwein: (exp(mu theta) - 1) max(T, 0), theta the wrap and T the lower tension, less rhoA u^2;
- ``EFFICIENCY``: the same with 1/eta in place of exp(mu theta);
- ``BEARING``: mu_b r_b / R |F|, F what rope and rim press on the pin;
- ``TORQUE``: what a function of time says.

The lower tension is that of the side towards which friction drags the rope, for it lifts the other by F. While an
iteration has not balanced the two, the lesser of them may be the wrong one: the drag would then grow as the rope
follows it, by more than the rope's inertia where exp(mu theta) is above two or so, and no iteration comes to an end.
"""

from __future__ import annotations

from math import exp, sqrt
from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES
from crane.groups.span import (
    ELASTIC_FORCE,
    FIRST,
    FIRST_PSI,
    LAST,
    LAST_PSI,
    MATERIAL,
    STRAIN_ENERGY,
    STRETCH,
    add_by_tension,
)
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import Stuck, register
from tautline.kernels.jit import kernel
from tautline.kernels.time_function import TimeFunctions, evaluate, sample_all

CAPSTAN, EFFICIENCY, BEARING, TORQUE = range(4)
NONE = -1
SPENT = 1.0 - 1.0e-9
"""Share of its limit from which what holds a rope holds all that it can."""
LAST_DIGITS = 32.0 * float(np.finfo(float).eps)
"""Share of u that is the rounding of a few of its changes."""
SLIP = np.dtype(
    [
        ("kind", "i8"), ("p", "i8"), ("by_p", "f8"), ("s", "i8"), ("by_s", "f8"), ("before", "i8"), ("after", "i8"),
        ("coefficient", "f8"), ("stiffness", "f8"), ("function", "i8"),
    ]
)  # fmt: skip
"""A contact: kind; places of p and of s or ``NONE`` with their factors; numbers of the spans before and after, for
``TORQUE`` that at the drum as before; mu, 1/eta - 1 or mu_b r_b / R; k N/m; and the function of time of a limit (N),
times the coefficient."""


class Slips(NamedTuple):
    """Contacts (n,) of ``SLIP``.

    ``found`` (spans, 14) and ``direction`` (spans, 3) are what the spans found, ``ends`` (spans, 2) their stations.
    ``force``, ``travel`` (n,) are F_n and u_n, ``now`` (n,) the force, ``power`` (n,) what slip turned to heat in the
    last step over its length, W, ``slips`` (n,) what the tangent was made for: 0, or the sign of the slip, which only
    implicit methods ask for; ``acts``
    (1,) is 0 while an equilibrium is sought: nothing moves there, and nothing resists. ``fresh`` (1,) is 1 until the
    first step is accepted, or begun where ``held``: no contact has moved or been loaded before.

    ``by_p`` (n,) is k_p of the step under way: the row's, or the present stretch of rope on a rim that moves.

    ``follows`` (2,) is gamma' of an implicit step under way, 0 in any other, and 1 until its prediction is seen, of
    which ``predicted`` (n, 2) keeps u - u_n, m, and u., m/s.

    ``slid`` (n,) is the sign of the slip at the end of the last step, or 0. ``held`` (1,) is 1 where no step is taken
    and what slid then slips on: in a linear model and in equations.
    """

    rows: np.recarray
    found: np.ndarray
    direction: np.ndarray
    ends: np.ndarray
    force: np.ndarray
    travel: np.ndarray
    now: np.ndarray
    power: np.ndarray
    slips: np.ndarray
    acts: np.ndarray
    fresh: np.ndarray
    by_p: np.ndarray
    follows: np.ndarray
    predicted: np.ndarray
    slid: np.ndarray
    held: np.ndarray
    functions: TimeFunctions


@kernel
def _travel(g, i, x):
    row = g.rows[i]
    u = g.by_p[i] * x[row.p] if row.p != NONE else 0.0
    return u + row.by_s * x[row.s] if row.s != NONE else u


@kernel
def _pin(g, row):
    """What rope presses on a pin with, N, and its share across each side."""
    one, two = g.found[row.before, LAST], g.found[row.after, FIRST]
    square = 0.0
    by_one = by_two = 0.0
    for c in range(AXES):
        x = two * g.direction[row.after, c] - one * g.direction[row.before, c]
        square += x * x
        by_two += x * g.direction[row.after, c]
        by_one -= x * g.direction[row.before, c]
    size = sqrt(square)
    h = 1.0 / size if size > 0.0 else 0.0
    return size, by_one * h, by_two * h


class Limit(NamedTuple):
    """F_m, and its derivatives by the tensions, and by the stretches, before and after."""

    most: float
    by_one: float
    by_two: float
    by_stretch_one: float
    by_stretch_two: float


@kernel
def _limit(g, i, t, force):
    """The limit for a force of this sign."""
    row, by_p = g.rows[i], g.by_p[i]
    if row.kind == TORQUE:
        share, _, _ = evaluate(g.functions, row.function, t)
        # The drum turns with the rope that comes onto it, by lambda p. / R.
        stretch = max(1.0, g.found[row.before, STRETCH]) / by_p
        most = row.coefficient * min(1.0, max(0.0, share))
        # A step converges without this derivative, which is small; what is only looked at has it.
        by_stretch = most / by_p if g.held[0] == 1 and g.found[row.before, STRETCH] > 1.0 else 0.0
        return Limit(stretch * most, 0.0, 0.0, by_stretch, 0.0)
    # In balance by_p F = T_1 - T_2, but for the stretch.
    before_is_lower = by_p * force < 0.0
    lower = g.found[row.before, LAST] if before_is_lower else g.found[row.after, FIRST]
    if row.kind == BEARING:
        size, by_one, by_two = _pin(g, row)
        drag, by_one, by_two = row.coefficient * size, row.coefficient * by_one, row.coefficient * by_two
    else:
        gain = row.coefficient
        if row.kind == CAPSTAN:
            gain = exp(row.coefficient * abs(g.found[row.after, FIRST_PSI] - g.found[row.before, LAST_PSI])) - 1.0
        if lower <= 0.0:
            return Limit(0.0, 0.0, 0.0, 0.0, 0.0)
        drag = gain * lower
        by_one, by_two = (gain, 0.0) if before_is_lower else (0.0, gain)
    if row.p == NONE:
        return Limit(drag, by_one, by_two, 0.0, 0.0)
    return _at_mark(g, row, by_p, before_is_lower, lower, drag, by_one, by_two)


@kernel
def _at_mark(g, row, by_p, before_is_lower, lower, drag, by_one, by_two):
    """The limit on p at which the tensions at the mark differ by ``drag``.

    The row of p is in balance where by_p F = (T lambda - W)_h - (T lambda - W)_l, h the side of the higher tension and
    l that of the lower, with any law of strain. With T_h = T_l + drag

        by_p F = lambda_h drag + T_l (lambda_h - lambda_l) - W_h + W_l.

    In balance its derivatives by the stretches vanish but for the weight of half an element and what is viscous.
    """
    high, low = (row.after, row.before) if before_is_lower else (row.before, row.after)
    stretch, short = max(1.0, g.found[high, STRETCH]), max(1.0, g.found[low, STRETCH])
    most = stretch * drag + lower * (stretch - short) - g.found[high, STRAIN_ENERGY] + g.found[low, STRAIN_ENERGY]
    if most * by_p <= 0.0:
        return Limit(0.0, 0.0, 0.0, 0.0, 0.0)
    by_high = drag + lower - g.found[high, ELASTIC_FORCE] if g.found[high, STRETCH] > 1.0 else 0.0
    by_low = g.found[low, ELASTIC_FORCE] - lower if g.found[low, STRETCH] > 1.0 else 0.0
    by_one, by_two = stretch * by_one, stretch * by_two
    if before_is_lower:
        by_one, by_high, by_low = by_one + stretch - short, by_low, by_high
    else:
        by_two += stretch - short
    x = 1.0 / by_p
    return Limit(x * most, x * by_one, x * by_two, x * by_high, x * by_low)


@kernel
def _see_prediction(g, q, v):
    """Keep where an implicit step is predicted to end; its corrector moves u. by gamma' times what it moves u by."""
    if g.follows[1] == 1.0:
        g.follows[1] = 0.0
        for i in range(g.rows.size):
            g.predicted[i, 0] = _travel(g, i, q) - g.travel[i]
            g.predicted[i, 1] = _travel(g, i, v)


@kernel
def _travel_since_step(g, i, q, v):
    """u - u_n, m.

    A drum that is held hardly moves, and is so stiff that a last digit of its p, of which there may be kilometres, is
    a force that no iteration could balance. Its velocity has all digits of what little it does move.
    """
    row = g.rows[i]
    u = _travel(g, i, q)
    moved = u - g.travel[i]
    if row.kind == TORQUE and g.follows[0] > 0.0:
        finer = g.predicted[i, 0] + (_travel(g, i, v) - g.predicted[i, 1]) / g.follows[0]
        if abs(finer - moved) <= LAST_DIGITS * abs(u):
            return finer
    return moved


@kernel
def _trial(g, i, t, q, v):
    """Force, the sign of the slip or 0, and the limit."""
    row = g.rows[i]
    if g.held[0] == 1 and g.slid[i] != 0:
        limit = _limit(g, i, t, float(g.slid[i]))
        return g.slid[i] * limit.most, g.slid[i], limit
    force = g.force[i] + row.stiffness * _travel_since_step(g, i, q, v)
    limit = _limit(g, i, t, force)
    # What was at its limit already slips as soon as anything moves: an open brake, one too weak, a sheave without
    # friction. Rest is found with as much as they hold, and no step has been taken that could tell.
    at_limit = g.held[0] == 1 and abs(force) >= SPENT * limit.most
    if abs(force) <= limit.most and not at_limit:
        return force, 0, limit
    return (limit.most, 1, limit) if force > 0.0 else (-limit.most, -1, limit)


@kernel
def _see_stretch(g, i):
    """Take the present stretch of the rope on a rim that moves by itself for what the next step turns it with."""
    row = g.rows[i]
    if row.p != NONE and row.s != NONE:
        g.by_p[i] = 0.5 * (max(1.0, g.found[row.before, STRETCH]) + max(1.0, g.found[row.after, STRETCH]))


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    g.acts[0] = 0.0 if beta < 0.0 else 1.0
    g.follows[0], g.follows[1] = (gamma, 1.0) if beta > 0.0 and gamma > 0.0 else (0.0, 0.0)
    if g.fresh[0] == 1.0:
        for i in range(g.rows.size):
            g.travel[i] = _travel(g, i, q)
        if g.held[0] == 1:
            # No step will be accepted: what is asked for first is where the contact stood.
            g.fresh[0] = 0.0


@kernel
def _switch(g, t, q, v, converged, changed):
    """A contact that lets go, or catches, has another tangent; the residual knows by itself."""
    if converged:
        return
    _see_prediction(g, q, v)
    for i in range(g.rows.size):
        _, sign, _ = _trial(g, i, t, q, v)
        if sign != g.slips[i]:
            g.slips[i] = sign
            changed[0] += 1


@kernel
def _residual(g, t, q, v, a, r):
    _see_prediction(g, q, v)
    for i in range(g.rows.size):
        row = g.rows[i]
        force, _, _ = _trial(g, i, t, q, v)
        force *= g.acts[0]
        g.now[i] = force
        if row.p != NONE:
            r[row.p] += g.by_p[i] * force
        if row.s != NONE:
            r[row.s] += row.by_s * force


@kernel
def _add(g, i, matrix, dofs, column, x):
    row = g.rows[i]
    if row.p != NONE:
        add_entry(matrix, dofs, row.p, column, g.by_p[i] * x)
    if row.s != NONE:
        add_entry(matrix, dofs, row.s, column, row.by_s * x)


@kernel
def _add_span(g, i, n, first, matrix, dofs, x, cm, cc, ck):
    """Add x times the derivative of the tension at one end of a span."""
    row, a, b = g.rows[i], g.ends[n, 0], g.ends[n, 1]
    if row.p != NONE:
        by = x * g.by_p[i]
        add_by_tension(g.found, g.direction, n, a, b, first, row.p, by, cm, cc, ck, matrix, dofs)
    if row.s != NONE:
        by = x * row.by_s
        add_by_tension(g.found, g.direction, n, a, b, first, row.s, by, cm, cc, ck, matrix, dofs)


@kernel
def _add_by_stretch(g, i, n, q, x, matrix, dofs):
    """Add x times the derivative of the stretch of a span."""
    a, b = g.ends[n, 0], g.ends[n, 1]
    by = x / (q[b + MATERIAL] - q[a + MATERIAL])
    for c in range(AXES):
        _add(g, i, matrix, dofs, a + c, -by * g.direction[n, c])
        _add(g, i, matrix, dofs, b + c, by * g.direction[n, c])
    _add(g, i, matrix, dofs, a + MATERIAL, by * g.found[n, STRETCH])
    _add(g, i, matrix, dofs, b + MATERIAL, -by * g.found[n, STRETCH])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    if g.acts[0] == 0.0:
        return
    for i in range(g.rows.size):
        row = g.rows[i]
        _, sign, limit = _trial(g, i, t, q, v)
        if sign == 0:
            x = ck * row.stiffness
            if row.p != NONE:
                _add(g, i, matrix, dofs, row.p, x * g.by_p[i])
            if row.s != NONE:
                _add(g, i, matrix, dofs, row.s, x * row.by_s)
        else:
            if limit.by_one != 0.0:
                _add_span(g, i, row.before, False, matrix, dofs, sign * limit.by_one, cm, cc, ck)
            if limit.by_two != 0.0:
                _add_span(g, i, row.after, True, matrix, dofs, sign * limit.by_two, cm, cc, ck)
            if limit.by_stretch_one != 0.0:
                _add_by_stretch(g, i, row.before, q, sign * ck * limit.by_stretch_one, matrix, dofs)
            if limit.by_stretch_two != 0.0:
                _add_by_stretch(g, i, row.after, q, sign * ck * limit.by_stretch_two, matrix, dofs)


@kernel
def _energy(g, t, q, v, energy):
    for i in range(g.rows.size):
        energy[1] += 0.5 * g.force[i] ** 2 / g.rows[i].stiffness


@kernel
def _dissipation(g, t, q, v, p):
    for i in range(g.rows.size):
        p[0] += g.power[i]


@kernel
def _commit(g, t, h, q, v, a):
    """Keep force and travel, and what slip turned to heat.

    That is the mean of F at both ends of the step times the slip: what the step has taken from the motion, beside what
    it put into the spring. The force at its end alone, times all of the slip, is off by half a step of its change, as
    where a brake closes. Where slip turns round within a step, F may have been larger the other way: friction gives
    nothing back.
    """
    if h == 0.0:
        return
    g.fresh[0] = 0.0
    for i in range(g.rows.size):
        row = g.rows[i]
        u = _travel(g, i, q)
        force, sign, _ = _trial(g, i, t, q, v)
        # Of the way that F went, its spring took some; the rest is slip.
        slipped = u - g.travel[i] - (force - g.force[i]) / row.stiffness
        g.power[i] = max(0.0, 0.5 * (g.force[i] + force) * slipped) / h if sign != 0 else 0.0
        _see_stretch(g, i)
        g.force[i], g.travel[i], g.now[i], g.slid[i] = force, _travel(g, i, q), force, sign
    g.follows[0] = 0.0


@kernel
def _record(g, out, at):
    for i in range(g.rows.size):
        out[at[0]] = g.now[i]
        out[at[0] + 1] = g.slid[i]
        at[0] += 2


def _hold(g: Slips) -> None:
    """Have what slid in the last step slip on."""
    g.held[0] = 1


def most_difference(g: Slips, i: int, t: float) -> float:
    """Difference of the rope's tensions on both sides, N, up to which contact i sticks at t, s; of a drum, the tension.

    It is that of `_limit` but for the stretch of the rope, which is a few thousandths of it.
    """
    row = g.rows[i]
    if row.kind == TORQUE:
        share = float(sample_all(g.functions, [int(row.function)], np.array([t]))[0, 0, 0])
        return float(row.coefficient * min(1.0, max(0.0, share)))
    one, two = g.found[row.before, LAST], g.found[row.after, FIRST]
    if row.kind == BEARING:
        pressed = two * g.direction[row.after] - one * g.direction[row.before]
        return float(row.coefficient * np.linalg.norm(pressed))
    gain = row.coefficient
    if row.kind == CAPSTAN:
        gain = exp(gain * abs(g.found[row.after, FIRST_PSI] - g.found[row.before, LAST_PSI])) - 1.0
    return float(gain * max(0.0, min(one, two)))


UNTIL = "until the rope's tensions on both sides differ by more"
STUCK = {
    CAPSTAN: (f"the rope sticks on it {UNTIL}", "set its parameter groove_friction to 0"),
    EFFICIENCY: (f"its efficiency holds the rope {UNTIL}", "set its parameter efficiency to 1"),
    BEARING: (f"its bearing sticks {UNTIL}", "set its parameter bearing_friction to 0"),
}
"""What each kind of contact at a sheave does that sticks, and what frees it."""
PULLS = "until the rope's pull and its motor's differ by more"
NO_FRICTION = "set its friction_torque in the scene to 0"
STUCK_DRUM = {
    (True, False): (f"its brake holds it {PULLS}", "open its brake"),
    (False, True): (f"its friction holds it {PULLS}", f"let its motor pull by more or less, or {NO_FRICTION}"),
    (True, True): (f"its brake and its friction hold it {PULLS}", f"open its brake and {NO_FRICTION}"),
}
"""The same of a drum, by whether its brake and whether its friction holds it."""


def _is_brake(g: Slips, i: int) -> bool:
    """Whether a contact of a drum is its brake, which an input drives, and not the friction that it always has."""
    return bool(g.functions.live[g.rows[i].function] >= 0)


def _held_difference(g: Slips, i: int) -> float:
    """Difference of the pulls on both sides that contact i holds now, N, with the sign of its force."""
    row = g.rows[i]
    if row.s != NONE:
        return float(g.now[i])
    return float(g.now[i] * g.by_p[i] / max(1.0, g.found[row.before, STRETCH]))


def _sticks(g: Slips, t: float) -> list[Stuck]:
    """The contacts that stick; what holds one drum, its brake and its friction, counts as one."""
    contacts: dict[tuple[int, int], list[int]] = {}
    for i in map(int, np.flatnonzero(g.slid == 0)):
        row, here = g.rows[i], most_difference(g, i, t)
        spent = abs(g.force[i] * g.by_p[i]) >= SPENT * here * max(1.0, float(g.found[row.before, STRETCH]))
        if here > 0.0 and not (row.kind == TORQUE and spent):  # else it slips in the plant, see `_trial`
            contacts.setdefault((int(row.kind), int(row.p if row.p != NONE else row.s)), []).append(i)
    return [_stuck(g, t, kind, place, some) for (kind, place), some in contacts.items()]


def _stuck(g: Slips, t: float, kind: int, place: int, contacts: list[int]) -> Stuck:
    """What some contacts of one kind hold together."""
    brakes = [_is_brake(g, i) for i in contacts if kind == TORQUE]
    text, cure = STUCK_DRUM[any(brakes), not all(brakes)] if brakes else STUCK[kind]
    most = sum(most_difference(g, i, t) for i in contacts)
    return Stuck(place, text, most, "N", cure, abs(sum(_held_difference(g, i) for i in contacts)))


register(
    Slips, friction=True, begin=_begin, switch=_switch, residual=_residual, tangent=_tangent, energy=_energy,
    dissipation=_dissipation, commit=_commit, record=_record, hold=_hold,
    sticks=_sticks,
    feels=lambda slips: bool((slips.rows["kind"] != TORQUE).any()),  # friction goes by the tensions at a sheave
)  # fmt: skip
