"""The bit on bottom as a group of the solver: weight along the hole, torque about it, and what the rock takes.

It knows the string by its measured depth alone, a linear function of some degrees of freedom, and by the rotation of
its end. Until the run opens, while the string comes to its start, a constant weight and torque stand for the rock; the
first ``commit`` puts the bottom where it carries that weight (bit_rock.py). Torque and sticking are bit_torque.py's.
"""

from __future__ import annotations

from math import isclose, sqrt

import numpy as np

from drillstring.drilling.bit_rock import (
    ANGLE,
    DEPTH,
    KINETIC,
    SPEED,
    SPIN,
    STATIC,
    WEIGHT,
    BladeBit,
    RockBit,
    advance,
    measure,
    place,
    speed_of,
    stores,
    strain,
)
from drillstring.drilling.bit_torque import act_torque, change_torque, prepare_torque, settle_torque, way_of
from drillstring.groups.friction import SLIP, STICK, STIFFNESS
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import Stuck, register
from tautline.kernels.jit import kernel

OWN = 4
"""Numbers that a bit records: weight N, torque that resists it N m, rate of penetration m/s, depth of the hole m."""

SAME = 1.0e-12
"""Relative difference of two torques that is rounding."""


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    b = g.row[0]
    if b.placed == 1:
        # Committed depths are those of the time that the step begins at.
        b.time = t
    prepare_torque(b, beta, gamma, v[g.turn])


@kernel
def _switch(g, t, q, v, converged, changed):
    b = g.row[0]
    if b.placed == 1:
        measure(g, t, q, v, way_of(b, v[g.turn]))
        changed[0] += change_torque(b, v[g.turn], g.value[KINETIC], g.value[STATIC], converged)


@kernel
def _residual(g, t, q, v, a, r):
    b = g.row[0]
    weight, torque = b.weight, -b.torque
    if b.placed == 1:
        measure(g, t, q, v, way_of(b, v[g.turn]))
        weight = g.value[WEIGHT]
        torque = act_torque(b, v[g.turn], g.value[KINETIC], g.value[STATIC])[0]
    for k in range(g.places.size):
        r[g.places[k]] += weight * g.direction[k]
    r[g.turn] -= torque


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    b = g.row[0]
    if b.placed == 0:
        return
    measure(g, t, q, v, way_of(b, v[g.turn]))
    _, by_spin, by_kinetic, by_static = act_torque(b, v[g.turn], g.value[KINETIC], g.value[STATIC])
    w, low, high = g.slope[WEIGHT], g.slope[KINETIC], g.slope[STATIC]
    along = ck * w[DEPTH] + cc * w[SPEED]
    around = ck * w[ANGLE] + cc * w[SPIN]
    torque_along = by_kinetic * (ck * low[DEPTH] + cc * low[SPEED]) + by_static * (ck * high[DEPTH] + cc * high[SPEED])
    torque_around = by_kinetic * (ck * low[ANGLE] + cc * low[SPIN]) + by_static * (ck * high[ANGLE] + cc * high[SPIN])
    torque_around += cc * by_spin
    for k in range(g.places.size):
        for l in range(g.places.size):
            add_entry(matrix, dofs, g.places[k], g.places[l], g.direction[k] * along * g.direction[l])
        add_entry(matrix, dofs, g.places[k], g.turn, g.direction[k] * around)
        add_entry(matrix, dofs, g.turn, g.places[k], -torque_along * g.direction[k])
    add_entry(matrix, dofs, g.turn, g.turn, -torque_around)


@kernel
def _energy(g, t, q, v, e):
    if g.row[0].placed == 1:
        e[1] += strain(g, q)


@kernel
def _dissipation(g, t, q, v, p):
    """With what ``_commit`` has kept: the bottom has moved on since, and cannot be asked for the middle of the step."""
    b = g.row[0]
    if b.placed == 1:
        p[0] += b.mean_weight * speed_of(g, v) - b.storing - b.mean_force * v[g.turn]


@kernel
def _commit(g, t, h, q, v, a):
    b = g.row[0]
    if b.placed == 1:
        advance(g, t, q, v)
    elif h == 0.0:
        place(g, t, q, v)
        b.placed = 1
    else:
        return
    measure(g, t, q, v, way_of(b, v[g.turn]))
    settle_torque(b, v[g.turn], g.value[KINETIC], g.value[STATIC])
    _keep_power(g, h, q, v)


@kernel
def _keep_power(g, h, q, v):
    """Keep the means of weight and torque over the step, and the power that went into the rock's spring."""
    b = g.row[0]
    weight, stored = g.value[WEIGHT], strain(g, q)
    b.mean_weight, b.mean_force, b.storing = weight, b.force, stores(g, q, v)
    if h > 0.0:
        b.mean_weight, b.mean_force = 0.5 * (weight + b.last_weight), 0.5 * (b.force + b.last_force)
        b.storing = (stored - b.stored) / h
    b.last_weight, b.last_force, b.stored = weight, b.force, stored


@kernel
def _record(g, out, at):
    b = g.row[0]
    out[at[0]] = g.value[WEIGHT]
    out[at[0] + 1] = -b.force
    out[at[0] + 2] = b.drilled
    out[at[0] + 3] = g.datum + b.hole
    at[0] += 4


HOOKS = {
    "begin": _begin, "switch": _switch, "residual": _residual, "tangent": _tangent, "energy": _energy,
    "dissipation": _dissipation, "commit": _commit, "record": _record,
}  # fmt: skip


def _bottom(g: RockBit | BladeBit) -> str:
    """The bottom goes on while the bit is on it."""
    return "the bottom of the hole" if g.row[0].placed == 1 and g.value[WEIGHT] > 0.0 else ""


def _hold(g: RockBit | BladeBit) -> None:
    """Have a bit that no step has seen yet stick as one does that a step has seen: its law knows of a step then."""
    b = g.row[0]
    if b.settled == STICK and b.status != SLIP:
        b.c = max(b.c, STIFFNESS * sqrt(b.inertia * b.spring))


def _onward(g: BladeBit, q: np.ndarray, v: np.ndarray) -> list[int]:
    """The angle of a bit whose blades go on cutting: right behind it is what they have cut already."""
    newest = g.ring[g.head[0], 0]
    turns = g.row[0].placed == 1 and g.row[0].settled == SLIP and v[g.turn] > 0.0
    return [g.turn] if turns and q[g.turn] >= newest else []


def _sticks(g: RockBit | BladeBit, t: float) -> list[Stuck]:
    """The bit, where it stands on the bottom and turns with no torque below its static one."""
    b = g.row[0]
    most = float(g.value[STATIC])
    if b.placed == 0 or b.settled != STICK or b.slip_speed > 0.0 or most <= 0.0:
        return []
    return [Stuck(g.turn, f"the bit sticks in the rock until the string turns it {_ways(g, most)}by more", most, "N m")]


def _ways(g: RockBit | BladeBit, most: float) -> str:
    """For which way ``most``, N m, holds a bit, with the bound of the way back; empty where both ways are alike."""
    b = g.row[0]
    if b.cut_torque == 0.0:
        return ""
    back = float((b.back + b.excess) * g.value[WEIGHT])
    # `measure` has written the torque of a rubbing weight by the same product.
    if not isclose(most, back, rel_tol=SAME):
        return f"backward by more than {back:.4g} N m, or forward "
    rubs_only = g.value[WEIGHT] <= b.limit and b.force <= 0.0
    return "" if rubs_only else "backward "


for kind, onward in ((RockBit, None), (BladeBit, _onward)):
    register(kind, friction=True, memory=_bottom, hold=_hold, sticks=_sticks, onward=onward, **HOOKS)
