"""The corrector of the implicit methods: Newton's method on the residual, eq. 2.87, one step at a time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.state import FACTORISATIONS, ITERATIONS, WORST
from tautline.integrators.status import Status
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand, reduce
from tautline.kernels.jit import kernel
from tautline.kernels.matrix import (
    Factors,
    Matrix,
    clear,
    copy_matrix,
    factorise_matrix,
    new_factors,
    new_matrix,
    solve_matrix,
)
from tautline.kernels.vector import copy
from tautline.system.system import System

DONE, NOT_CONVERGED, SINGULAR, NOT_FINITE = (
    int(s) for s in (Status.DONE, Status.NOT_CONVERGED, Status.SINGULAR, Status.NOT_FINITE)
)
HALF_STEPS_FROM = 9
"""From this iteration on every third increment is halved: two statuses of a law may chase each other."""
SAME_STEP = 1.0e-9
"""Relative difference of beta' below which two steps are the same: frame times are rounded."""
ROUNDED = 8.0 * float(np.finfo(float).eps)
"""Increments of velocity below so much of the largest are rounding: no iteration can do better."""
ROUNDING_MOST = 1.0e4
"""Times the tolerance up to which a residual is put down to rounding. A contact that rolls at speed v, with friction of
stiffness c, leaves eps c v in the residual, and smaller steps only raise c."""


class Corrector(NamedTuple):
    """Settings and scratch of the iteration.

    Old factors are kept while an iteration shrinks the residual to the part ``contraction``, else the tangent is made
    anew; where the iteration is ``full`` it is made anew each time, as eq. 2.87 says. ``tolerance``: with the energy
    criterion the bound of eq. 2.78 with the energy over ``unit``; with the force criterion that of the largest residual
    over ``scale``. ``smooth`` is the tangent of the groups that do not switch,
    kept where others do, and ``factors`` those of the whole; ``made_for`` and ``factored_for`` (2,) are the beta' and
    gamma' that they belong to, zeros where they are out of date. ``rounded`` (1,) is 1 after an increment that rounding
    has made.
    """

    tolerance: float
    contraction: float
    full: bool
    unit: float
    by_energy: bool
    max_iterations: int
    scale: np.ndarray
    smooth: Matrix
    factors: Factors
    increment: np.ndarray
    right_side: np.ndarray
    made_for: np.ndarray
    factored_for: np.ndarray
    changed: np.ndarray
    rounded: np.ndarray


def corrector(
    system: System,
    tolerance: float,
    by_energy: bool,
    max_iterations: int,
    unit: float | None = None,
    contraction: float = 0.1,
    full: bool = False,
) -> Corrector:
    """Make the scratch of the iteration for a system; the unit of energy is that of its largest force by default."""
    n = system.size
    unit = float(system.scale.max(initial=0.0)) or 1.0 if unit is None else unit
    return Corrector(
        float(tolerance), float(contraction), bool(full), float(unit), bool(by_energy), int(max_iterations),
        system.scale,
        new_matrix(n, system.bandwidth, system.border), new_factors(n, system.bandwidth, system.border),
        np.zeros(n), np.zeros(n), np.zeros(2), np.zeros(2),
        np.zeros(2, np.int64), np.zeros(1, np.int64),
    )  # fmt: skip


@kernel(forceinline=True)
def correct(corrector, groups, dofs, state, t, beta, gamma):
    """Iterate position, velocity and acceleration at time t until the residual vanishes.

    ``beta`` and ``gamma`` are beta' and gamma' of eqs 2.88-2.89: how acceleration and velocity follow position.
    The factors of the tangent are used again, also across steps, while they still contract. A law that changes its
    status forces new factors, for which the smooth groups' tangent is used again in turn. Returns a status;
    ``changed[1]`` says whether a law has changed its own.
    """
    c = corrector
    changed = c.changed
    changed[1] = 0
    c.rounded[0] = 0
    previous = energy = np.inf
    if abs(c.factored_for[0] - beta) > SAME_STEP * beta:
        c.factored_for[0] = 0.0
    if abs(c.made_for[0] - beta) > SAME_STEP * beta:
        c.made_for[0] = 0.0
    event = False
    for iteration in range(c.max_iterations + 1):
        expand(dofs, state.q, state.full_q)
        expand(dofs, state.v, state.full_v)
        expand(dofs, state.a, state.full_a)
        changed[0] = 0
        if not event:
            # After an event the forced status is to be solved for before it is tested.
            over.switch(groups, t, state.full_q, state.full_v, False, changed)
        event = False
        if changed[0] > 0:
            changed[1] = 1
            c.rounded[0] = 0
            c.factored_for[0] = 0.0
            previous = energy = np.inf
        state.residual.fill(0.0)
        over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)
        reduce(dofs, state.residual, c.increment)
        size = _worst(c.increment, c.scale, state.counters)
        if not np.isfinite(size):
            return NOT_FINITE
        enough = ROUNDING_MOST * c.tolerance if c.rounded[0] == 1 else c.tolerance
        if size <= enough if not c.by_energy else energy <= c.tolerance:
            changed[0] = 0
            over.switch(groups, t, state.full_q, state.full_v, True, changed)
            if changed[0] == 0:
                return DONE
            changed[1] = 1
            c.rounded[0] = 0
            c.factored_for[0] = 0.0
            previous = energy = np.inf
            event = True
            continue
        if iteration == c.max_iterations:
            break
        if c.full or size > c.contraction * previous:
            c.factored_for[0] = 0.0
            c.made_for[0] = 0.0
        if c.factored_for[0] == 0.0:
            matrix = c.factors.matrix
            switches = over.may_switch(groups)
            smooth = c.smooth if switches else matrix
            if c.made_for[0] == 0.0 or not switches:
                clear(smooth)
                over.smooth_tangent(groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, smooth, dofs)
                c.made_for[0] = beta
                c.made_for[1] = gamma
            if switches:
                copy_matrix(smooth, matrix)
            over.switching_tangent(groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, matrix, dofs)
            state.counters[FACTORISATIONS] += 1
            row = factorise_matrix(c.factors)
            if row != 0:
                state.counters[WORST] = row - 1
                return SINGULAR
            c.factored_for[0] = beta
            c.factored_for[1] = gamma
        energy = _step(c, state, beta, gamma, 0.5 if iteration >= HALF_STEPS_FROM and iteration % 3 == 0 else 1.0)
        state.counters[ITERATIONS] += 1
        if c.by_energy and energy <= c.tolerance and not over.may_switch(groups):
            # What is left of the residual is below what the criterion cares for: it is not evaluated again.
            expand(dofs, state.q, state.full_q)
            expand(dofs, state.v, state.full_v)
            expand(dofs, state.a, state.full_a)
            return DONE
        previous = size
    return NOT_CONVERGED


@kernel
def _step(c, state, beta, gamma, fraction):
    """Solve for the increment and add it; returns the energy error of eq. 2.78."""
    copy(c.increment, c.right_side)
    solve_matrix(c.factors, c.increment)
    energy = fastest = largest = 0.0
    for i in range(state.q.size):
        step = -fraction * c.increment[i]
        energy += c.right_side[i] * c.increment[i]
        fastest = max(fastest, abs(state.v[i]))
        largest = max(largest, gamma * abs(step))
        state.q[i] += step
        state.v[i] += gamma * step
        state.a[i] += beta * step
    c.rounded[0] = 1 if largest <= ROUNDED * fastest else 0
    return np.sqrt(abs(energy) / c.unit)


@kernel
def _worst(residual, scale, counters):
    """Largest residual over its scale; its row goes to the counters; NaN counts as infinite."""
    worst = 0.0
    for i in range(residual.size):
        size = abs(residual[i]) / scale[i]
        if not size <= worst:
            worst = size
            counters[WORST] = i
            if not np.isfinite(size):
                return np.inf
    return worst
