"""The state of a run: reduced and full vectors, what was spent, and the energy ledger."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.status import Status
from tautline.kernels import groups as over
from tautline.kernels.dofs import DOFS, expand, prescribe
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, gather, lane, larger, largest, spread, total, where, within
from tautline.kernels.memory import form_of
from tautline.kernels.separate import separate
from tautline.kernels.time_function import FUNCTIONS
from tautline.system.system import System

STEPS, ITERATIONS, FACTORISATIONS, HALVINGS, WORST, ROWS = range(6)
"""Places in ``counters``: steps taken, Newton iterations, factorisations, halvings, the worst reduced row; and the rows
that were solved for, of all iterations together."""

DONE, BEFORE_ALARMS = int(Status.DONE), int(Status.NO_LENGTH) - 1
"""The statuses of the groups' alarms follow one another."""

TIME, POWER, WORK, DISSIPATED, THROUGHPUT, AT_START, MOVED, TURNED, MOTION, FLOW, RATE, GIVEN, STEPS_OF_IT = range(13)
"""Places in ``ledger``: time of the last entry (s) and power supplied then (W); work done on the system, energy lost
and work counted without its sign (J), less what goes into the kinetic energy of a steady flow; m a^2 at the
start; the integrals of m v^2 (J s) and of m a^2; the largest kinetic energy of any frame (J) without the steady motion;
and where that was looked at last the kinetic energy (J) that there would not be without a flow, the flow's rate (m/s),
the work since then (J), and in how many steps."""
TOGETHER = 8
"""Steps of a steady flow whose work is booked together: its energy takes two evaluations of all energies."""
STATES = form_of(np.zeros((0, 0)))
ADDRESSES = form_of(np.zeros(0, np.int64))
"""The form of groups as they are linked."""
SAME_RATE = 1.0e-12
"""Change of a flow's rate over it that is rounding."""


class State(NamedTuple):
    """Reduced position, velocity, acceleration and the auxiliary one of eq. 2.86 (n,); the same in full (n_full,).

    ``residual`` is the full residual of the last accepted state: at held degrees of freedom it is the force that
    holds them. ``keep`` (4, n) is the state at the start of the step, to go back to; generalized-alpha has its
    accelerations in a history of its own. ``inertia`` (n,) is the diagonal of the mass matrix at the start of the run,
    zero for multipliers. ``entered`` (2, n_full) are position and residual of the last entry in the ledger, of what is
    driven and what such things carry; ``passed`` (n_full,) is the full position up to which losses are booked;
    ``started`` (n_full,) is the full velocity at the start of the run, ``middle`` (2, n_full) is scratch.
    """

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    auxiliary: np.ndarray
    full_q: np.ndarray
    full_v: np.ndarray
    full_a: np.ndarray
    residual: np.ndarray
    keep: np.ndarray
    inertia: np.ndarray
    ledger: np.ndarray
    entered: np.ndarray
    passed: np.ndarray
    started: np.ndarray
    middle: np.ndarray
    counters: np.ndarray


_ROOM = {name: np.zeros((0, 0)) for name in ("keep", "entered", "middle")} | {"counters": np.zeros(0, np.int64)}
STATE = form_of(State(*(_ROOM.get(name, np.zeros(0)) for name in State._fields)))
"""The form of :class:`State`."""


def new_state(system: System) -> State:
    """State at t = 0 with zero acceleration; reduced unknowns are read off the free full ones."""
    n, full = system.size, system.q.size
    q, v = system.q[system.free], system.v[system.free]
    return State(
        q, v, np.zeros(n), np.zeros(n), system.q.copy(), system.v.copy(), np.zeros(full), np.zeros(full),
        np.zeros((4, n)), np.zeros(n), np.zeros(13), np.zeros((2, full)), np.zeros(full), np.zeros(full),
        np.zeros((2, full)), np.zeros(6, dtype=np.int64),
    )  # fmt: skip


@separate(type(None), DOFS, FUNCTIONS, STATE, float)
def stand_at(dofs, functions, state, t):
    """Write the state, which is that of time t, into the full vectors that outputs are read of."""
    prescribe(dofs, functions, t, state.full_q, state.full_v, state.full_a)
    expand(dofs, state.q, state.full_q)
    expand(dofs, state.v, state.full_v)
    expand(dofs, state.a, state.full_a)


@kernel
def worst_between(residual, per_scale, counters, first, last):
    """Largest residual of rows over its scale, given as 1 / scale; its row goes to the counters; NaN is infinite."""
    most, place = spread(0.0), spread(0.0)
    lost = spread(0.0)
    for i in range(first, last, LANES):
        size = abs(gather(residual, i, last)) * gather(per_scale, i, last)
        place = where(size > most, i, place)
        most = larger(size, most)
        lost += 0.0 * size  # no number or infinite: neither becomes zero
    worst = largest(most)
    if worst > 0.0:
        for k in range(LANES):
            if lane(most, k) == worst:
                counters[WORST] = min(int(lane(place, k)) + k, last - 1)
    if total(lost) == 0.0:
        return worst
    for i in range(first, last):
        if not np.isfinite(residual[i] * per_scale[i]):
            counters[WORST] = i
            break
    return np.inf


@kernel
def keep(state):
    """Remember the state, to go back to."""
    for i in range(state.q.size):
        state.keep[0, i] = state.q[i]
        state.keep[1, i] = state.v[i]
        state.keep[2, i] = state.a[i]
        state.keep[3, i] = state.auxiliary[i]


@kernel
def watch(groups, dofs, state, t, alarm):
    """Ask the groups whether the state is one that they can go on from. Returns a status."""
    alarm[0] = 0
    over.alarm(groups, t, state.full_q, alarm)
    if alarm[0] == 0:
        return DONE
    # It is told by its full number, from -1 downwards: a sheave rides on a body, and its unknowns are the body's.
    state.counters[WORST] = -1 - alarm[1]
    return BEFORE_ALARMS + alarm[0]


@kernel
def restore(state):
    """Go back to the state remembered."""
    for i in range(state.q.size):
        state.q[i] = state.keep[0, i]
        state.v[i] = state.keep[1, i]
        state.a[i] = state.keep[2, i]
        state.auxiliary[i] = state.keep[3, i]


@kernel
def open_ledger(groups, dofs, state, t, power):
    """Open the books at the start of a run."""
    state.ledger[TIME] = t
    state.ledger[AT_START] = 0.0
    for i in range(state.a.size):
        state.ledger[AT_START] += state.inertia[i] * state.a[i] * state.a[i]
    state.ledger[MOTION] = 0.0
    for i in range(state.full_v.size):
        state.started[i] = state.full_v[i]
        state.passed[i] = state.entered[0, i] = state.full_q[i]
    if dofs.flowing.size > 0:
        state.ledger[FLOW], state.ledger[RATE] = _energy_of_flow(groups, dofs, state, t), _rate_of_flow(dofs, state)
    _keep_ends(dofs, state)
    power.fill(0.0)
    over.supply(groups, t, state.full_q, state.full_v, power)
    state.ledger[POWER] = power[0] + power[1]


@separate(bool, DOFS, STATE)
def _leave_out_steady(dofs, state):
    """Velocities without the steady motion, as `middle[1]`; returns whether they are other than the state's.

    Steady is what moves as at the start of the run, and material that flows past nodes which stand still.
    """
    other = False
    for i in range(state.full_v.size):
        state.middle[1, i] = state.full_v[i] - state.started[i]
        other = other or state.started[i] != 0.0
    for i in dofs.flowing:
        state.middle[1, i] = 0.0
        other = other or state.full_v[i] != 0.0
    return other


@kernel
def book_energy(groups, dofs, state, t, energy):
    """Write the kinetic, strain and potential energy of a state into ``energy``, and book the motion in it.

    Water that flows steadily through a hose at rest has kinetic energy, and so has a string that turns steadily. None
    of it is exchanged with anything. The motion without what is steady has the kinetic energy that is, and it is the
    same whatever steady motion it is added to.
    """
    other = _leave_out_steady(dofs, state)
    energy.fill(0.0)
    over.energy(groups, t, state.full_q, state.middle[1], energy)
    motion = energy[0]
    if other:
        energy.fill(0.0)
        over.energy(groups, t, state.full_q, state.full_v, energy)
        # What has turned round has a velocity of twice its own less the one at the start.
        motion = min(motion, energy[0])
    state.ledger[MOTION] = max(state.ledger[MOTION], motion)


@kernel(forceinline=True)
def _rate_of_flow(dofs, state):
    rate = 0.0
    for i in dofs.flowing:
        rate += abs(state.full_v[i])
    return rate


@separate(float, ADDRESSES, DOFS, STATE, float, late=True)
def _energy_of_flow(groups, dofs, state, t):
    """Kinetic energy that there would not be without the flow and what moved at the start, J."""
    _leave_out_steady(dofs, state)
    state.middle[0].fill(0.0)
    over.energy(groups, t, state.full_q, state.full_v, state.middle[0])
    whole = state.middle[0, 0]
    state.middle[0].fill(0.0)
    over.energy(groups, t, state.full_q, state.middle[1], state.middle[0])
    return whole - state.middle[0, 0]


@kernel(forceinline=True)
def _keep_ends(dofs, state):
    """Keep what the next step's work is a mean and a difference of; a rope has far more than is held of it."""
    for k in dofs.driven:
        i = dofs.held[k]
        state.entered[0, i], state.entered[1, i] = state.full_q[i], state.residual[i]
    for i in dofs.carried:
        state.entered[1, i] = state.residual[i]


@kernel
def book_losses(groups, state, t, h, power):
    """Book what forces have lost in the step from t to t + h, at whose end the state is.

    A loss counts at the middle of the step, with the displacement of the step. That of a linear damper is then the mean
    of its forces at both ends times what it moved, which is what the step has taken from the motion. The mean of the
    powers at both ends is not: where a motion is faster than the step, its velocity changes sign from end to end, and
    the body hardly moves, but force times velocity is large at both ends.
    """
    per_step = 1.0 / h
    for i in range(state.full_q.size):
        now, before = state.full_q[i], state.passed[i]
        moved = now - before
        state.middle[0, i] = before + 0.5 * moved
        state.middle[1, i] = moved * per_step
        state.passed[i] = now
    power.fill(0.0)
    over.dissipation(groups, t + 0.5 * h, state.middle[0], state.middle[1], power)
    state.ledger[DISSIPATED] += h * power[0]


@kernel
def _less_what_flows(groups, dofs, state, t, work):
    """Work of a step less what goes into the kinetic energy of a steady flow, of several steps together; 0 until then.

    What a hose takes from a steady flow by moving along it, it gives back at once. What speeds a flow up counts: where
    that sets in within a step, the mean of two forces is as wrong as they differ.
    """
    ledger, rate = state.ledger, _rate_of_flow(dofs, state)
    steady = abs(rate - ledger[RATE]) <= SAME_RATE * abs(rate)
    ledger[RATE] = rate
    if steady:
        ledger[GIVEN] += work
        ledger[STEPS_OF_IT] += 1.0
        if ledger[STEPS_OF_IT] < TOGETHER:
            return 0.0
    flow = _energy_of_flow(groups, dofs, state, t)
    counts = ledger[GIVEN] - (flow - ledger[FLOW]) if steady else work
    ledger[FLOW], ledger[GIVEN], ledger[STEPS_OF_IT] = flow, 0.0, 0.0
    return counts


@kernel
def book_work(groups, dofs, state, t, power, work):
    """Book the work done on the system since the last entry, up to time t.

    ``work``, J, is that of held degrees of freedom, see `work_of_means`. Of other drives and of what flows in it is the
    mean of the powers at both ends.
    """
    _keep_ends(dofs, state)
    power.fill(0.0)
    over.supply(groups, t, state.full_q, state.full_v, power)
    work += 0.5 * (t - state.ledger[TIME]) * (power[0] + state.ledger[POWER])
    state.ledger[TIME], state.ledger[POWER] = t, power[0] + power[1]
    state.ledger[WORK] += work
    state.ledger[THROUGHPUT] += abs(_less_what_flows(groups, dofs, state, t, work) if dofs.flowing.size > 0 else work)


@kernel(forceinline=True)
def work_of_means(dofs, state):
    """Work of held degrees of freedom since the last entry: the mean of the force at both ends times the way."""
    work = 0.0
    for k in dofs.driven:
        i = dofs.held[k]
        work += _mean_force(state, i) * (state.full_q[i] - state.entered[0, i])
    for i in dofs.carried:
        for k in range(dofs.start[i], dofs.start[i + 1]):
            if dofs.unknown[k] < 0:
                j = -1 - dofs.unknown[k]
                work += dofs.factor[k] * _mean_force(state, i) * (state.full_q[j] - state.entered[0, j])
    return work


@kernel(forceinline=True)
def _mean_force(state, i):
    return 0.5 * (state.residual[i] + state.entered[1, i])


@kernel
def observe_motion(state, v, a, h):
    """Add a step, with velocities and accelerations at its start, to the integrals that give the oscillation frequency.

    The start counts as the end does, or what is let go would seem to begin without an acceleration.
    """
    moved, turned = spread(0.0), spread(0.0)
    n = state.q.size
    for i in range(0, n, LANES):
        inertia = where(within(i, n), gather(state.inertia, i, n), 0.0)
        v1, a1, v0, a0 = gather(state.v, i, n), gather(state.a, i, n), gather(v, i, n), gather(a, i, n)
        moved += inertia * (v1 * v1 + v0 * v0)
        turned += inertia * (a1 * a1 + a0 * a0)
    book_motion(state, h, total(moved), total(turned))


@kernel(forceinline=True)
def book_motion(state, h, moved, turned):
    """Add a step of length h, of which the sums of m v^2 and of m a^2 at both ends are given, to these integrals."""
    state.ledger[MOVED] += 0.5 * h * moved
    state.ledger[TURNED] += 0.5 * h * turned


def oscillation_frequency(state: State) -> float:
    """How fast the motion of a run has turned over, rad/s: the root of the mean of m a^2 over that of m v^2.

    For a vibration that is its angular frequency; of several each counts by its kinetic energy, those that a step
    cannot follow all the more. What moves at a steady speed does not oscillate; 0 where nothing has moved.
    """
    moved, turned = float(state.ledger[MOVED]), float(state.ledger[TURNED])
    return float(np.sqrt(turned / moved)) if moved > 0.0 and np.isfinite(turned) else 0.0
