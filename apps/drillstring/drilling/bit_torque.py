"""Torque on a bit that turns, or that stands: exact Coulomb friction about one axis, by return mapping.

The law is that of friction.py with one component in place of two: a bit at rest is held by what acts on it, up to its
static torque, with no creep but what the stiffness ``c`` of the projection leaves; a bit that turns is resisted by its
kinetic torque, which may depend on speed, weight on bit and depth of cut. Stick and slip are found within the
iterations of an implicit step. An explicit method takes the torque as a function of the speed, in full above
``slip_speed``. ``b`` is a row of ``BIT`` (bit_numbers.py); torques are those on the bit, positive clockwise.

Torques may differ by the way in which the bit turns, for a drag bit cuts forward only. Then a bit at rest is held
between two bounds that are not alike, which is Coulomb's law still: ``way_of`` says whose bound is asked for.
"""

from __future__ import annotations

from drillstring.groups.friction import FORCED, SLIP, STICK, STIFFNESS
from tautline.kernels.jit import kernel


@kernel
def _sign(x):
    return 1.0 if x > 0.0 else -1.0 if x < 0.0 else 0.0


@kernel
def way_of(b, spin):
    """The way in which a bit slips, or is pushed where it is held: forward where it is not negative."""
    if b.slip_speed > 0.0:
        return spin
    return b.way if b.status == SLIP else b.c * spin - b.force


@kernel
def prepare_torque(b, beta, gamma, spin):
    """An attempt of a step begins with the bit turning at ``spin``."""
    b.status = b.settled
    b.level = 1 if b.settled == STICK else 0
    b.dropped = 0
    b.reversed = 0
    b.slip = spin
    b.way = -_sign(b.force) if b.force != 0.0 else _sign(spin)
    if gamma > 0.0:
        b.c = STIFFNESS * (b.inertia * beta + b.spring) / gamma


@kernel
def change_torque(b, spin, kinetic, static, converged):
    """Let go, or stick; returns 1 if the status has changed. ``kinetic`` and ``static`` bound the torque, N m."""
    if b.slip_speed > 0.0:
        return 0
    if static <= 0.0:
        changed = b.status != SLIP
        b.status = SLIP
        b.way = 0.0
        return 1 if changed else 0
    if converged:
        return _settle_events(b, spin, kinetic != static)
    x = b.c * spin - b.force
    if b.status == SLIP:
        if spin * b.way < 0.0:
            # Never from slip one way straight to slip the other way.
            b.status = FORCED
            return 1
    elif abs(x) > (static if b.level == 1 else kinetic):
        b.status = SLIP
        b.way = _sign(x)
        return 1
    else:
        b.status = STICK
        return 0
    if b.way == 0.0:
        b.way = _sign(x)
    return 0


@kernel
def _settle_events(b, spin, drops):
    """Changes that wait for a converged state, each once a step: static becomes kinetic, or the slip has reversed."""
    if b.status == FORCED:
        return 1
    if b.status == SLIP:
        if b.settled == STICK and b.dropped == 0:
            b.dropped = 1
            b.level = 0
            return 1 if drops else 0
        if b.settled == SLIP and spin * b.slip < 0.0 and b.reversed == 0:
            b.reversed = 1
            b.level = 1
            b.status = FORCED
            return 1
    return 0


@kernel
def act_torque(b, spin, kinetic, static):
    """Torque on the bit; its derivatives by spin with the bounds held, and by the kinetic and the static one."""
    if b.slip_speed > 0.0:
        share = max(-1.0, min(1.0, spin / b.slip_speed))
        slope = 1.0 / b.slip_speed if abs(spin) < b.slip_speed else 0.0
        return -share * kinetic, -slope * kinetic, -share, 0.0
    x = b.c * spin - b.force
    if b.status != SLIP:
        return -x, -b.c, 0.0, 0.0
    way = b.way
    if b.level == 1:
        return -way * static, 0.0, 0.0, -way
    return -way * kinetic, 0.0, -way, 0.0


@kernel
def settle_torque(b, spin, kinetic, static):
    """The step is accepted."""
    if b.slip_speed == 0.0 and static <= 0.0:
        b.force = 0.0
        b.settled = SLIP
        return
    b.force = act_torque(b, spin, kinetic, static)[0]
    b.settled = SLIP if b.status == SLIP else STICK
