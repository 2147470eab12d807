"""Static equilibrium: where the forces balance with everything at rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels.matrix import (
    Matrix,
    factorise_matrix,
    new_factors,
    replace_by_identity,
    rows_of,
    size_of_row,
    solve_matrix,
)
from tautline.system.system import System

SHIFTS = (0.0, 1e-4, 1e-2, 1.0, 100.0)
"""Shifts to begin with, 1/s^2, from plain Newton to heavily damped: the next is tried where one fails."""
ITERATIONS = 400


class Equilibrium(NamedTuple):
    """How the search ended: iterations, and the largest residual over its scale."""

    iterations: int
    residual: float


def find_equilibrium(system: System, state: State, step_limit: float, tolerance: float = 1e-10) -> Equilibrium:
    """Move the state to static equilibrium at t = 0.

    Newton's method, and where it fails the same with the mass matrix as a shift that fades as the residual falls
    (pseudo-transient continuation: an implicit Euler march of an overdamped scene whose step grows). Friction does not
    act, for nothing moves.

    Parameters
    ----------
    system : System
    state : State
        Where the search starts, and where the equilibrium is left.
    step_limit : float
        Largest change of an unknown in one iteration, m or rad.
    tolerance : float
        Largest residual over its scale that counts as balance.

    Returns
    -------
    Equilibrium

    Raises
    ------
    StoppedEarly
        NO_EQUILIBRIUM, naming the unknown that is worst.
    """
    origin, worst, spent = state.q.copy(), 0, 0
    for shift in SHIFTS:
        state.q[:] = origin
        iterations, size, worst = _search(system, state, step_limit, tolerance, shift)
        spent += iterations
        if size <= tolerance:
            return Equilibrium(spent, size)
    raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, system.names[worst])


ROUNDING = 4.0 * np.finfo(float).eps
"""Residual that rounding leaves in a row, over the sum of its stiffnesses times positions."""


def _balances(system: System, matrix: Matrix, q: np.ndarray, x: np.ndarray, tolerance: float, worst: int) -> bool:
    """Whether no row's residual is more than the tolerance and rounding; the worst is asked first, for most are not."""
    limit, size = tolerance * system.scale, np.abs(q)
    if x.size and abs(x[worst]) > limit[worst] + ROUNDING * size_of_row(matrix, worst, size):
        return False
    return bool(np.all(np.abs(x) <= limit + ROUNDING * (abs(rows_of(matrix)) @ size)))


def _search(
    system: System, state: State, step_limit: float, tolerance: float, first_shift: float
) -> tuple[int, float, int]:
    """One search; returns iterations, the residual it ended with, and the worst row."""
    n = system.size
    factors = new_factors(n, system.bandwidth, system.border)
    x, shift, previous, worst = np.zeros(n), first_shift, np.inf, 0
    for iteration in range(ITERATIONS):
        evaluate(system, state, 0.0, 1.0, True, shift, 0.0, 1.0, factors.matrix, x)
        for row in system.at_rest:
            replace_by_identity(factors.matrix, row)
            x[row] = 0.0
        sizes = np.abs(x) / system.scale
        size, worst = float(sizes.max(initial=0.0)), int(sizes.argmax()) if n else 0
        if not np.isfinite(size):
            return iteration, np.inf, worst
        if _balances(system, factors.matrix, state.q, x, tolerance, worst):
            return iteration, min(size, tolerance), worst
        if np.isfinite(previous) and shift > 0.0:
            shift *= min(4.0, max(0.1, size / previous))
        previous = size
        if factorise_matrix(factors):
            return iteration, np.inf, worst
        solve_matrix(factors, x)
        # A multiplier is no way gone: it may change as it must.
        largest = float(np.abs(np.delete(x, system.algebraic)).max(initial=0.0))
        state.q[:] -= x * min(1.0, step_limit / largest) if largest > 0.0 else 0.0
    return ITERATIONS, np.inf, worst
