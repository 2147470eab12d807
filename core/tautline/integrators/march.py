"""The time loop: compiled, through as many output frames as it is given, with nothing allocated inside."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from tautline.integrators.generalized_alpha import GeneralizedAlpha, generalized_alpha_step
from tautline.integrators.newton import DONE
from tautline.integrators.rk4 import RungeKutta4, accelerate, account, rk4_step
from tautline.integrators.state import DISSIPATED, HALVINGS, LOSS, POWER, STEPS, TIME, WORK, State, supplied_power
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand
from tautline.kernels.jit import entry, kernel
from tautline.kernels.vector import copy

class Frames(NamedTuple):
    """What the loop leaves behind at each output time, one row a frame.

    Full position, velocity, acceleration and residual (m, n_full); the groups' own numbers (m, k); kinetic, strain
    and potential energy, work and dissipation (m, 5) J.
    """

    time: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    residual: np.ndarray
    own: np.ndarray
    energy: np.ndarray
    at: np.ndarray


def new_frames(rows: int, full: int, own: int) -> Frames:
    """Room for a number of frames."""
    return Frames(
        np.zeros(rows), *(np.zeros((rows, full)) for _ in range(4)), np.zeros((rows, own)), np.zeros((rows, 5)), np.zeros(1, np.int64)
    )


@kernel
def record_frame(groups, state, t, frames, row):
    """Write one frame."""
    frames.time[row] = t
    copy(state.full_q, frames.q[row])
    copy(state.full_v, frames.v[row])
    copy(state.full_a, frames.a[row])
    copy(state.residual, frames.residual[row])
    frames.at[0] = 0
    over.record(groups, frames.own[row], frames.at)
    energy = frames.energy[row]
    energy.fill(0.0)
    over.energy(groups, t, state.full_q, state.full_v, energy)
    energy[3] = state.ledger[WORK]
    energy[4] = state.ledger[DISSIPATED]


@entry
def open_run(groups, dofs, state, t, frames):
    """Settle the laws at the start, open the ledger and record the first frame."""
    over.commit(groups, t, 0.0, state.full_q, state.full_v, state.full_a)
    frames.energy[0].fill(0.0)
    over.dissipation(groups, t, state.full_q, state.full_v, frames.energy[0])
    state.ledger[TIME] = t
    state.ledger[LOSS] = frames.energy[0, 0]
    state.ledger[POWER] = supplied_power(dofs, state) + frames.energy[0, 1]
    record_frame(groups, state, t, frames, 0)


@kernel(inline="always")
def divide_and_advance(method, groups, dofs, functions, state, t, h):
    """One implicit step of length h, in halves, quarters, ... where it does not converge whole. Returns a status."""
    finest = 2**method.max_halvings
    size = finest
    at = 0
    while at < finest:
        status = generalized_alpha_step(
            method, groups, dofs, functions, state, t + h * (at / finest), h * (size / finest)
        )
        if status == DONE:
            state.counters[STEPS] += 1
            at += size
            if size < finest and at % (2 * size) == 0:
                size *= 2
        elif size == 1:
            return status
        else:
            size //= 2
            state.counters[HALVINGS] += 1
    return DONE


@entry
def march_implicit(method, groups, dofs, functions, state, ends, steps, begin, frames):
    """Go through output frames with an implicit method; see :func:`march`."""
    t0 = begin
    for row in range(ends.size):
        h = (ends[row] - t0) / steps[row]
        for k in range(steps[row]):
            status = divide_and_advance(method, groups, dofs, functions, state, t0 + k * h, h)
            if status != DONE:
                return status, row, t0 + k * h
        record_frame(groups, state, ends[row], frames, row)
        t0 = ends[row]
    return DONE, ends.size, t0


@entry
def march_explicit(method, groups, dofs, functions, state, ends, steps, begin, frames):
    """Go through output frames with an explicit method; see :func:`march`.

    Such a method knows acceleration and reactions at the start of its steps only: they are made anew for a frame.
    """
    t0 = begin
    for row in range(ends.size):
        h = (ends[row] - t0) / steps[row]
        for k in range(steps[row]):
            status = rk4_step(method, groups, dofs, functions, state, t0 + k * h, h)
            if status != DONE:
                return status, row, t0 + k * h
            state.counters[STEPS] += 1
        status = accelerate(method, groups, dofs, functions, ends[row], state)
        if status != DONE:
            return status, row, ends[row]
        expand(dofs, state.a, state.full_a)
        account(method, groups, dofs, ends[row], state)
        record_frame(groups, state, ends[row], frames, row)
        t0 = ends[row]
    return DONE, ends.size, t0


MARCHES = {GeneralizedAlpha: march_implicit, RungeKutta4: march_explicit}
"""The compiled loop of each method: a new method is one line here."""


def march(method, groups, dofs, functions, state, ends, steps, begin, frames):
    """Go through output frames and record each, in compiled code.

    Parameters
    ----------
    method : GeneralizedAlpha or RungeKutta4
    groups, dofs, functions, state
        The system and its state at time ``begin``.
    ends : (m,) array
        Time of each frame, s.
    steps : (m,) int array
        Steps up to it from the frame before.
    begin : float
        Time of the frame before the first, s.
    frames : Frames
        Filled row by row.

    Returns
    -------
    (int, int, float)
        Status, frames filled, time reached.
    """
    return MARCHES[type(method)](method, groups, dofs, functions, state, ends, steps, begin, frames)
