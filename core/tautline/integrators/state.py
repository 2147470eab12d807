"""The state of a run: reduced and full vectors, what was spent, and the energy ledger."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.status import Status
from tautline.kernels import groups as over
from tautline.kernels.jit import kernel
from tautline.system.system import System

STEPS, ITERATIONS, FACTORISATIONS, HALVINGS, WORST, ROWS = range(6)
"""Places in ``counters``: steps taken, Newton iterations, factorisations, halvings, the worst reduced row; and the rows
that were solved for, of all iterations together."""

DONE, BEFORE_ALARMS = int(Status.DONE), int(Status.NO_LENGTH) - 1
"""The statuses of the groups' alarms follow one another."""

TIME, POWER, LOSS, WORK, DISSIPATED, THROUGHPUT, MOVED, TURNED = range(8)
"""Places in ``ledger``: time of the last entry (s), power supplied and lost then (W), work done on the system, energy
lost, and work counted without its sign (J); the integrals of m v^2 (J s) and of m a^2."""


class State(NamedTuple):
    """Reduced position, velocity, acceleration and the auxiliary one of eq. 2.86 (n,); the same in full (n_full,).

    ``residual`` is the full residual of the last accepted state: at held degrees of freedom it is the force that
    holds them. ``keep`` (4, n) is the state at the start of the step, to go back to. ``inertia`` (n,) is the diagonal
    of the mass matrix at the start of the run, zero for multipliers.
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
    counters: np.ndarray


def new_state(system: System) -> State:
    """State at t = 0 with zero acceleration; reduced unknowns are read off the free full ones."""
    n, full = system.size, system.q.size
    q, v = system.q[system.free], system.v[system.free]
    return State(
        q, v, np.zeros(n), np.zeros(n), system.q.copy(), system.v.copy(), np.zeros(full), np.zeros(full),
        np.zeros((4, n)), np.zeros(n), np.zeros(8), np.zeros(6, dtype=np.int64),
    )  # fmt: skip


@kernel(forceinline=True)
def worst_between(residual, scale, counters, first, last):
    """Largest residual of rows over its scale; its row goes to the counters; NaN counts as infinite."""
    worst = 0.0
    for i in range(first, last):
        size = abs(residual[i]) / scale[i]
        if not size <= worst:
            worst = size
            counters[WORST] = i
            if not np.isfinite(size):
                return np.inf
    return worst


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
    # A place that is no unknown of its own is told by its full number, from -1 downwards.
    state.counters[WORST] = dofs.number[alarm[1]] if dofs.number[alarm[1]] >= 0 else -1 - alarm[1]
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
def supplied_power(dofs, state):
    """Power that the held degrees of freedom put into the system, W: the force that moves them times their speed."""
    power = 0.0
    for k in range(dofs.held.size):
        if dofs.motion[k] >= 0:
            i = dofs.held[k]
            power += state.residual[i] * state.full_v[i]
    for i in dofs.carried:
        for k in range(dofs.start[i], dofs.start[i + 1]):
            if dofs.unknown[k] < 0:
                power += dofs.factor[k] * state.residual[i] * state.full_v[-1 - dofs.unknown[k]]
    return power


@kernel
def enter(ledger, t, power, loss, jump):
    """Book work and dissipation up to time t by the trapezoidal rule; from t on the power is larger by ``jump``."""
    h = t - ledger[TIME]
    work = 0.5 * h * (power + ledger[POWER])
    ledger[WORK] += work
    ledger[THROUGHPUT] += abs(work)
    ledger[DISSIPATED] += 0.5 * h * (loss + ledger[LOSS])
    ledger[TIME] = t
    ledger[POWER] = power + jump
    ledger[LOSS] = loss


@kernel
def observe_motion(state, v, a, h):
    """Add a step, with velocities and accelerations at its start, to the integrals that say how fast motion turns over.

    The start counts as the end does, or what is let go would seem to begin without an acceleration.
    """
    moved = turned = 0.0
    for i in range(state.q.size):
        moved += state.inertia[i] * (state.v[i] * state.v[i] + v[i] * v[i])
        turned += state.inertia[i] * (state.a[i] * state.a[i] + a[i] * a[i])
    state.ledger[MOVED] += 0.5 * h * moved
    state.ledger[TURNED] += 0.5 * h * turned


def turns_over(state: State) -> float:
    """How fast the motion of a run has turned over, rad/s: the root of the mean of m a^2 over that of m v^2.

    For a vibration that is its angular frequency; of several each counts by its kinetic energy, those that a step
    cannot follow all the more. What moves at a steady speed turns over never; 0 where nothing has moved.
    """
    moved, turned = float(state.ledger[MOVED]), float(state.ledger[TURNED])
    return float(np.sqrt(turned / moved)) if moved > 0.0 and np.isfinite(turned) else 0.0
