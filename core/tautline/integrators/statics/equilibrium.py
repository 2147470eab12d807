"""Static equilibrium: where the forces balance with everything at rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.linearise import evaluate, search_on
from tautline.integrators.newton_at_rest import (
    AWAY,
    FOUND,
    ITERATION,
    LEFT,
    LOOSE,
    MORE,
    NEAREST,
    PREVIOUS,
    ROUNDING,
    SHIFT,
    WORST,
    WORST_THERE,
    Search,
)
from tautline.integrators.state import State
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels.dofs import TIED
from tautline.kernels.matrix import Factors, cut, factorise_matrix, replace_by_identity, sizes_of_rows, solve_matrix
from tautline.system.system import System

SHIFTS = (0.0, 1e-4, 1e-2, 1.0, 100.0)
"""Shifts to begin with, 1/s^2, from plain Newton to heavily damped: the next is tried where one fails."""
ITERATIONS, PATIENT = 400, 2000
"""Iterations of a search, and of one that leaves an unstable equilibrium: that may lead along a valley of the energy,
where nearly nothing resists."""
AHEAD = 160
"""Rows on either side of those out of balance that are let move with them: contacts come and go along a front."""
PART_ITERATIONS = 100
"""Iterations over a part of the rows between two over all of them: a front passes a lump in each."""

TURN = 0.1
"""Largest change of a quaternion of length one in an iteration: a fifth of a radian."""
FAR = 20.0
"""Extents of a scene by which no part of it moves into balance."""

NEXT_TO_REST = 1e-5
"""Residual over its scale at which a search that finds no balance is not far from one."""
TOO_FAR = (
    "the initial geometry is too far from any equilibrium, or there is none; "
    "give positions closer to those at rest, or take finer elements"
)
"""Cause and cure of a search that has found nothing, of scenes that give positions."""
LOOSE_OR_FAR = (
    "in a shape on the way a part moves without resistance: nothing holds a part of the scene, or the search began far "
    "from rest; hold it, or give it stiffness or tension"
)
"""The same of one that came to a shape without stiffness, or went far away."""
UNSETTLED = (
    "the search came next to a rest and did not settle there, as where next to nothing holds a part of the scene; "
    "hold it, or give it stiffness or tension"
)
"""The same of one that has nearly found balance."""

ACTING = 1.0e-6
"""What a tolerance may leave in a row where stiffness makes its scale, over an equal share of what acts."""
OF_ROUNDING, NEAR_ROUNDING = 1.0, 1.0e7
"""What is left in a row over its rounding: up to the first it is put down to rounding; up to the second it may be that
a search stretches what is stiff by more than it bends it. Hoses that fail by their EA have 2e-4 to 190, slack ropes
without bending stiffness up to 7e5, a rope that nothing holds 4e11."""
SEEN = 1.0e-6
"""Way over the extent of the scene that a balance may leave to go, where rounding hides the rest."""


class Equilibrium(NamedTuple):
    """How the search ended: iterations, and the largest residual over its scale."""

    iterations: int
    residual: float


def find_equilibrium(system: System, state: State, step_limit: float, tolerance: float = 1e-10) -> Equilibrium:
    """Move the state to static equilibrium at t = 0.

    Newton's method, and where it fails the same with the mass matrix as a shift that fades as the residual falls
    (pseudo-transient continuation: implicit Euler steps of an overdamped scene whose step grows). Friction does not
    act, for nothing moves. Where a system has a window and only a part of its rows is out of balance, that part is
    brought into balance between two iterations over all: a string that peels off the wall does so lump by lump.

    Parameters
    ----------
    system : System
    state : State
        Where the search starts, and where the equilibrium is left.
    step_limit : float
        Largest change of an unknown in one iteration, m or rad; of a system's neighbours, of their difference: a long
        cable of short elements may sink by many of their lengths at once. Where a system has room, it is so many times
        as large: one short element then does not make all others change by no more than it may.
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
    origin, spent = state.q.copy(), 0
    tried: list[_Ended] = []
    for shift in SHIFTS:
        state.q[:] = origin
        ended = _search(system, state, step_limit, tolerance, shift)
        spent += ended.iterations
        if ended.found:
            return Equilibrium(spent, ended.residual)
        tried.append(ended)
    nearest = min(tried, key=lambda ended: ended.residual)
    scale = scales_at_rest(system, tolerance)
    times = over_rounding(system, state, nearest.worst, nearest.residual * scale[nearest.worst])
    why = _cause(nearest, tried[0].loose, times, system.softer)
    detail = f"{_amount(system, nearest, spent, scale)}; {why}"
    raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, system.names[nearest.worst], detail)


class _Ended(NamedTuple):
    """How one search ended: iterations, residual over its scale, its row, whether it is balance, and whether the
    stiffness was singular or the scene went far away."""

    iterations: int
    residual: float
    worst: int
    found: bool = False
    loose: bool = False
    away: bool = False


def _amount(system: System, ended: _Ended, spent: int, scale: np.ndarray) -> str:
    """What a search that failed has left, whose residuals were judged by scales (n,), N."""
    left, whole = ended.residual, "the scene's largest force"
    if scale[ended.worst] < system.scale[ended.worst]:
        left *= scale[ended.worst] / (system.given * levers(system)[ended.worst])
        whole = "the force that acts"
    if not np.isfinite(left):
        return f"after {spent} iterations the search has left what numbers can hold"
    share = f"{float(f'{left:.2g}'):g} times" if left > 1.0 else f"{100.0 * left:.2g} % of"
    if ended.worst in system.algebraic:
        return f"after {spent} iterations this constraint is still open by {share} what is large in the scene"
    return f"after {spent} iterations {share} {whole} is still out of balance there"


def _cause(ended: _Ended, loose: bool, times: float, softer: str) -> str:
    """Cause and cure of a search that failed, by how it ended, and by how many times rounding it has left."""
    if ended.away or loose:
        return LOOSE_OR_FAR
    if times <= OF_ROUNDING:
        return softer
    why = UNSETTLED if ended.residual < NEXT_TO_REST else TOO_FAR
    return f"{why}; or {softer}" if times <= NEAR_ROUNDING else why


def over_rounding(system: System, state: State, row: int, left: float) -> float:
    """What is left in a row, N, over what rounding leaves in it; infinite where no stiffness is so large as to hide it.

    Rounding is that of the state in which a search has ended: as it was drawn a row may have no stiffness.
    """
    if not system.softer:
        return np.inf
    factors = system.spare_factors()
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, factors.matrix, np.zeros(system.size))
    rounding = ROUNDING * float(sizes_of_rows(factors.matrix, state.q)[row])
    return left / rounding if rounding > 0.0 else np.inf


def refuse_without_number(system: System, state: State) -> None:
    """Say of a search that failed where the force is no number in the state: nothing else counts then.

    Raises
    ------
    StoppedEarly
        With the part of the first such row.
    """
    residual = np.zeros(system.size)
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, system.spare_factors().matrix, residual)
    rows = np.flatnonzero(~np.isfinite(residual))
    if rows.size:
        detail = (
            "the force there is no finite number in the scene as it is drawn; look at what acts there, such as a force "
            "of an extension that divides by zero"
        )
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, system.names[int(rows[0])], detail) from None


def search_from(
    system: System, state: State, step_limit: float, shift: float, tolerance: float = 1e-10, most: int = PATIENT
) -> bool:
    """One patient search with the mass matrix as a shift, 1/s^2, that fades; whether it found an equilibrium."""
    return _search(system, state, step_limit, tolerance, shift, most).found


def _search(
    system: System, state: State, step_limit: float, tolerance: float, first_shift: float, most: int = ITERATIONS
) -> _Ended:
    """One search, of ``most`` iterations."""
    n, in_parts = system.size, system.window.size > 0 and system.size > 4 * AHEAD
    lever, origin = levers(system), state.q.copy()
    if system.room.size:
        lever /= system.room[system.free]
    lever[system.turns] = np.maximum(lever[system.turns], step_limit / TURN)
    lever[system.algebraic] = 0.0  # a multiplier is no way gone: it may change as it must
    extent = max(float(np.ptp(origin)) if n else 0.0, step_limit)
    pairs, room, far = neighbours(system)
    lever[far] = step_limit / max(step_limit, system.reach)
    numbers, counts = np.array([step_limit, tolerance, first_shift, np.inf, np.inf]), np.zeros(4, np.int64)
    factors, scale = system.spare_factors(), scales_at_rest(system, tolerance)
    search = Search(factors, system.at_rest, scale, lever, pairs, room, numbers, counts)
    stands = MORE
    while stands == MORE and counts[ITERATION] < most:
        # Between two iterations over all rows a part may be brought into balance.
        counts[LEFT] = 1 if in_parts and numbers[SHIFT] == 0.0 else most - counts[ITERATION]
        stands = search_on(system, state, search)
        if stands == MORE and in_parts and numbers[SHIFT] == 0.0:
            _balance_part(system, state, step_limit, tolerance, factors, np.zeros(n))
    iterations = int(counts[ITERATION])
    if stands == FOUND:
        hidden = bool(system.hidden and numbers[PREVIOUS] > tolerance) and _hides(system, state, extent)
        left = float(numbers[PREVIOUS])
        return _Ended(iterations, left if hidden else min(left, tolerance), int(counts[WORST]), not hidden)
    nearest = _Ended(iterations, float(numbers[NEAREST]), int(counts[WORST_THERE]))
    if stands != MORE:
        return nearest._replace(away=stands == AWAY, loose=stands == LOOSE)
    moved = np.delete(np.abs(state.q - origin), system.algebraic)
    return nearest._replace(away=bool(moved.max(initial=0.0) > FAR * extent))


def scales_at_rest(system: System, tolerance: float) -> np.ndarray:
    """What residuals are judged by on the way to rest, to a tolerance: the system's scales, but no more than what acts.

    A scale (n,), N, may count stiffness. Beside a large one a tolerance of it would be more than all that acts on a
    row. It may be more than what acts as long as it leaves no more than `ACTING` of a row's share.
    """
    if not system.given > 0.0:
        return system.scale
    most = system.given * max(1.0, ACTING / (tolerance * max(system.size, 1))) * levers(system)
    most[system.algebraic] = np.inf  # a constraint is no force
    return np.minimum(system.scale, most)


def _hides(system: System, state: State, extent: float) -> bool:
    """Whether what is left of a balance, which rounding may have made, still moves the shape by more than `SEEN`."""
    factors, x = system.spare_factors(), np.zeros(system.size)
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, factors.matrix, x)
    for row in system.at_rest:
        replace_by_identity(factors.matrix, row)
        x[row] = 0.0
    if factorise_matrix(factors):
        return True
    solve_matrix(factors, x)
    way = np.abs(np.delete(x * levers(system), system.algebraic))
    return not bool(way.max(initial=0.0) <= SEEN * extent)


def levers(system: System) -> np.ndarray:
    """What moves by how much, at most, when an unknown changes by one, (n,): slopes of short elements move little."""
    if not system.force > 0.0:
        return np.ones(system.size)
    return np.minimum(1.0, system.scale / system.force)


def neighbours(system: System) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unknowns of a system's neighbours (m, 2), negative where one is held; the room of each (m,), in limits of a step;
    and those that may go far.

    Of what is mixed from several unknowns the difference is not known: its neighbours may not go far.
    """
    number = system.dofs.number[system.neighbours]
    mixed = (number == TIED).any(axis=1)
    counts = ~mixed & (number >= 0).any(axis=1)
    pairs = np.ascontiguousarray(number[counts])
    room = system.room_between[counts] if system.room_between.size else np.ones(len(pairs))
    far = np.zeros(system.size, dtype=bool)
    far[pairs[pairs >= 0]] = True
    near = number[mixed]
    far[near[near >= 0]] = False
    return pairs, room, np.flatnonzero(far)


def _balance_part(
    system: System, state: State, step_limit: float, tolerance: float, factors: Factors, x: np.ndarray
) -> None:
    """Bring the rows that are out of balance into it, if they are a small part, while all others stay where they are.

    What that leaves at the edges is for the next iteration over all rows. ``factors`` and ``x`` (n,) are scratch.
    """
    n, window = system.size, system.window
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, factors.matrix, x)
    wrong = np.flatnonzero(~(np.abs(x) <= tolerance * system.scale))
    first, last = (max(0, wrong[0] - AHEAD), min(n, wrong[-1] + 1 + AHEAD)) if wrong.size else (0, n)
    if 2 * (last - first) > n:
        return
    part = slice(first, last)
    rows = cut(factors, first, last)
    begun, before = state.q[part].copy(), float((np.abs(x[part]) / system.scale[part]).max())
    window[:] = system.free[first], system.free[last - 1] + 1
    try:
        for _ in range(PART_ITERATIONS):
            evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, factors.matrix, x)
            size = float((np.abs(x[part]) / system.scale[part]).max())
            if size <= tolerance or not np.isfinite(size):
                break
            for row in system.at_rest:
                if first <= row < last:
                    replace_by_identity(factors.matrix, row)
                    x[row] = 0.0
            if factorise_matrix(rows):
                break
            solve_matrix(rows, x[part])
            largest = float(np.abs(x[part]).max())
            state.q[part] -= x[part] * min(1.0, step_limit / largest) if largest > 0.0 else 0.0
    finally:
        window[:] = 0, system.q.size
    if not size < before:
        state.q[part] = begun
