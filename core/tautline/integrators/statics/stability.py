"""Whether an equilibrium is stable: the inertia of the tangent, which is how many of its eigenvalues are negative."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.integrators.statics.equilibrium import find_equilibrium, levers, neighbours, search_from
from tautline.integrators.status import StoppedEarly
from tautline.kernels.matrix import (
    Factors,
    Matrix,
    dense,
    factorise_matrix,
    new_factors,
    new_matrix,
    replace_by_identity,
    solve_matrix,
    sparse,
)
from tautline.system.system import System

ROUNDING = 2e-14
"""Share of a row's own stiffness that rounding may leave of a stiffness that is none. It must not be more: the lowest
stiffness of a beam of n elements over that of its rows falls as 1 / n^4."""
UNBALANCED = 1e-9
"""Share of a row's force, over its lever, that a balance within its tolerance may leave in a mode that nothing resists,
such as a free rotation: its stiffness is the residual force along it."""
SKEW = 1e-6
"""Share of the stiffness of its two rows by which an entry may differ from its mirror. Beyond it a tangent is not
symmetric: its forces have no potential, and the sign of its pivots proves nothing."""
EPSILON = 4.0 * float(np.finfo(float).eps)
"""Force that rounding leaves in a row, over the sum of its stiffnesses times positions."""
AXES = 3
SMALL = 600
"""Unknowns up to which eigenvalues are taken in full: they show the motion that lowers the energy most."""

ALIKE = 1e-4
"""Share by which stiffnesses of two motions may differ that gain alike."""
ALL_ALIKE = 1.0 + 1e-6
"""Room up to which equal elements differ by rounding alone."""
SPRING = 1e-4
"""Softness of a constraint where pivots are counted, over that of the stiffest unknown. What is left of a stiffness
beside a spring is rounded as the spring is."""


MEANT = 1e-7
"""Way along the motions that gain, over the extent of the scene, by which a drawing means a side. It is more than what
rounding and the tolerance of a balance leave."""
FURTHER = 4
"""Searches from all saddles but the first, together, that may lead nowhere: each may be as long as there is patience
for."""
DRAWN, ON_THE_WAY, ARBITRARY = SIDES = ("drawn", "on the way", "arbitrary")
"""What decided the side to which a scene was pushed out of unstable balance: where it was drawn; what it came to from
any side alike; or nothing."""


class Stability(NamedTuple):
    """How many independent motions lower the energy, the unknown that one of them moves most, and that motion (n,);
    where there is none (0,).

    ``negative`` is -1 where it is not known: the tangent is not symmetric, or a pivot of it is zero. ``meant`` is
    whether the motion leads the way that was asked for; else it is any of those that gain alike.
    """

    negative: int
    worst: int
    mode: np.ndarray
    meant: bool = False


class Rest(NamedTuple):
    """Whether the equilibrium in which a scene was left is stable, how often it was pushed out of another, and what
    decided the side: one of `SIDES`."""

    stability: Stability
    pushes: int = 0
    side: str = DRAWN

    @property
    def negative(self) -> int:
        """Motions that lower the energy; -1 where they are not known."""
        return self.stability.negative


UNKNOWN = Stability(-1, 0, np.zeros(0))
LEAVING = ((2.0, 0.1), (2.0, 1.0), (10.0, 1.0))
"""With which a search leaves an unstable equilibrium: its shift over the square of the rate at which the motion grows,
and the push over the largest change of an unknown. A step as long as the motion's own time follows it downhill."""
MOST_MODES = 10
"""Motions of a large scene, at most, of which one is mixed along which the energy falls."""
LANCZOS = 100
"""Restarts of the search for a motion of a large scene along which the energy falls."""
SHIFTS = (1.0, 100.0, 1.0e4, 1.0e6, 1.0e8)
"""Shifts, 1/s^2, that are tried after those."""
ASIDE = 0.1
"""The push with them."""


def find_stable_equilibrium(system: System, state: State, step_limit: float) -> Rest:
    """Move the state to a static equilibrium at t = 0, and to a stable one if that can be found.

    What :func:`~tautline.integrators.statics.equilibrium.find_equilibrium` finds may be a maximum or a saddle of the
    energy. It is left then to the side where the drawing lies, or else along the motion that lowers the energy most,
    and searched on by pseudo-transient continuation, an overdamped motion downhill. That may lead to another that is
    unstable, which is left in turn. Where it leads nowhere, and the system has room, all of it is done again without.

    Returns
    -------
    Rest
        Of where the state is left: the first equilibrium, unstable, if none that is stable was found.

    Raises
    ------
    StoppedEarly
        NO_EQUILIBRIUM, where none was found at all.
    """
    drawn = state.q.copy()
    find_equilibrium(system, state, step_limit)
    first = count_negative(system, state, drawn)
    if first.negative <= 0:
        return Rest(first)
    found = state.q.copy()
    stable = _downhill(system, state, step_limit, first, drawn) or _on_another_path(system, state, step_limit, drawn)
    if stable is not None:
        return stable
    state.q[:] = found
    again = new_factors(system.size, system.bandwidth, system.border).matrix
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, again, np.zeros(system.size))
    return Rest(first)


def _downhill(system: System, state: State, step_limit: float, unstable: Stability, drawn: np.ndarray) -> Rest | None:
    """Leave an unstable equilibrium downhill, to a stable one; None, with the state anywhere, if none was found.

    The motion that gains most may lead to another unstable one: from straight a column comes to rest in its second
    mode, where the first still gains. It is left in turn, if fewer motions lower the energy there than at any before.
    """
    saddles, least, left = [_ways_down(system, state, step_limit, unstable)], unstable.negative, FURTHER
    path = [(state.q.copy(), unstable)]
    while saddles:
        way = next(saddles[-1], None) if left > 0 or len(saddles) == 1 else None
        if way is None:
            saddles.pop()
            path.pop()
            continue
        path[-1] = path[-1][0], way.along
        state.q[:] = way.begin
        if search_from(system, state, step_limit, way.shift) and _keeps_side(system, state, *path[-1]):
            judged = count_negative(system, state, drawn)
            if judged.negative == 0:
                return Rest(judged, len(path), side_of(system, state, path))
            # Where the tangent proves nothing, as where a load follows the shape, it shows no way down.
            if 0 < judged.negative < least:
                least = judged.negative
                saddles.append(_ways_down(system, state, step_limit, judged))
                path.append((state.q.copy(), judged))
                continue
        left -= len(saddles) > 1
    return None


def side_of(system: System, state: State, path: Sequence[tuple[np.ndarray, Stability]]) -> str:
    """What decided the side to which unstable equilibria were left, for the rest of the state: one of `SIDES`.

    ``path`` holds the unknowns (n,) of each, and how it was judged. One that was not left towards the drawing was left
    to any side of what gains there. That side is arbitrary where the rest lies to one, as of a bar that is bent to it.
    It is not where both sides lead to one rest: a bow that stands falls to any side, and hangs below. The state is left
    as it is.
    """
    rest, side = state.q.copy(), DRAWN
    for there, judged in path:
        if judged.meant:
            continue
        state.q[:] = there
        aside = count_negative(system, state, rest).meant
        side = max(side, ARBITRARY if aside else ON_THE_WAY, key=SIDES.index)
    state.q[:] = rest
    # All that goes with the unknowns is again that of where the state is left.
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, system.spare_factors().matrix, np.zeros(system.size))
    return side


class _Way(NamedTuple):
    """Where a search begins that leaves an unstable equilibrium (n,), its shift, 1/s^2, and what it goes along."""

    begin: np.ndarray
    shift: float
    along: Stability


def _ways_down(system: System, state: State, step_limit: float, unstable: Stability) -> Iterator[_Way]:
    """Ways to leave the unstable equilibrium of the state: to the side that is meant, and then to any."""
    found, along = state.q.copy(), unstable
    while True:
        growth = _growth(system, state, along.mode)
        mode = along.mode / max(float(np.abs(along.mode * levers(system)).max()), 1e-300)
        tries = [(share * growth, push) for share, push in LEAVING if growth > 0.0]
        tries += [(shift, ASIDE) for shift in SHIFTS]
        for shift, push in tries:
            yield _Way(found + push * step_limit * mode, shift, along)
        if not along.meant:
            return
        state.q[:] = found
        along = count_negative(system, state)


def _keeps_side(system: System, state: State, left: np.ndarray, along: Stability) -> bool:
    """Whether a search that left unknowns (n,) has ended on the side that is meant: its shift may fade too early."""
    moved = (state.q - left) * levers(system) ** 2
    moved[system.algebraic] = 0.0
    return not along.meant or float(moved @ along.mode) > 0.0


def _on_another_path(system: System, state: State, step_limit: float, drawn: np.ndarray) -> Rest | None:
    """Search again from where the first search began (n,), where there is another path: with as little room for all.

    Room lets long elements change by more at once than short ones. From a drawing far from rest both paths are a matter
    of luck, and the slower one may end at a stable equilibrium where the other did not.
    """
    if max(system.room.max(initial=0.0), system.room_between.max(initial=0.0)) <= ALL_ALIKE:
        return None
    alike = replace(system, room=np.zeros(0), room_between=np.zeros(0))
    state.q[:] = drawn
    try:
        find_equilibrium(alike, state, step_limit)
    except StoppedEarly:
        return None
    there = count_negative(alike, state, drawn)
    if there.negative > 0:
        return _downhill(alike, state, step_limit, there, drawn)
    return Rest(there) if there.negative == 0 else None


def _growth(system: System, state: State, mode: np.ndarray) -> float:
    """Square of the rate, 1/s^2, at which a motion (n,) away from a state at rest grows: -K over M along it."""
    along = []
    for part in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
        matrix = new_matrix(system.size, system.bandwidth, system.border)
        evaluate(system, state, 0.0, 1.0, True, *part, matrix, np.zeros(system.size))
        along.append(float(mode @ (sparse(matrix) @ mode)))
    mass, stiffness = along
    return -stiffness / mass if mass > 0.0 else 0.0


def count_negative(system: System, state: State, towards: np.ndarray | None = None) -> Stability:
    """Negative pivots of the stiffness at a state at rest, with t = 0; those that multipliers bring are left out.

    The factors count them. Where there are some, the eigenvalues of a small scene show the motion that gains most. They
    also judge what forces without a potential act on, but only along motions that multipliers take away. The motion
    leads ``towards`` other unknowns (n,) where those that gain do.
    """
    if system.size == 0:
        return Stability(0, 0, np.zeros(0))
    factors = _stiffness(system, state)
    none = _nothing(system, state, factors.matrix)
    way = np.zeros(system.size) if towards is None else (towards - state.q) / _extent(system, state)
    found = _by_pivots(system, factors, none, way)
    if found.negative == 0 or system.size > SMALL:
        return found
    return _by_eigenvalues(system, _stiffness(system, state).matrix, none, way)


def _extent(system: System, state: State) -> float:
    return max(float(np.ptp(np.delete(state.q, system.algebraic))), 1e-300)


def _part_along(system: System, modes: np.ndarray, way: np.ndarray) -> np.ndarray:
    """The part (n,) of a way (n,) along modes (n, m): what is nearest to it in space.

    By stiffnesses the stretch of a rope that its load has shortened would outweigh what is aside.
    """
    lever = levers(system)
    lever[system.algebraic] = 0.0
    return np.asarray(modes @ np.linalg.lstsq(lever[:, None] * modes, lever * way, rcond=None)[0])


def _is_meant(system: System, part: np.ndarray) -> bool:
    """Whether a part (n,) of a way, in extents of the scene, is more than rounding."""
    return bool(np.abs(np.delete(part * levers(system), system.algebraic)).max(initial=0.0) > MEANT)


def _nothing(system: System, state: State, matrix: Matrix) -> np.ndarray:
    """What of a stiffness along each unknown (n,) counts as none, N/m or N m, for the balance is not exact.

    Nor are forces: rounding of coordinates leaves a tension, which resists sideways by itself over the length of an
    element. A rope without tension would else be pressed by rounding.
    """
    is_slope = levers(system) < 1.0
    is_slope[system.turns] = True
    extent = _extent(system, state)
    none = UNBALANCED * system.scale * np.where(is_slope, 1.0, 1.0 / extent)
    pairs, _, _ = neighbours(system)
    pairs = pairs[(pairs >= 0).all(axis=1)]
    if pairs.size:
        # Of lines in all directions: the mean distance along the three axes.
        length = AXES * float(np.abs(state.q[pairs[:, 0]] - state.q[pairs[:, 1]]).mean())
        left = EPSILON * _forces_without_signs(matrix, np.abs(state.q))
        none += np.where(is_slope, 0.0, left / max(length, 1e-12 * extent))
    none[system.algebraic] = 0.0
    return none


def _forces_without_signs(matrix: Matrix, size: np.ndarray) -> np.ndarray:
    """|K| |q| (n,) of sizes |q| (n,): what of forces rounding is a share of."""
    n, width = matrix.band.shape
    inner, edge = size[:n], size[n:]
    around = np.lib.stride_tricks.sliding_window_view(np.pad(inner, width // 2), width)
    band = np.einsum("ij,ij->i", np.abs(matrix.band), around) + np.abs(matrix.right).T @ edge
    return np.concatenate([band, np.abs(matrix.lower) @ inner + np.abs(matrix.corner) @ edge])


def _stiffness(system: System, state: State) -> Factors:
    """Tangent at rest, with what stays at rest left out, and room for its factors."""
    # With a threshold of zero no rows are exchanged: the signs of the pivots are then those of the eigenvalues.
    factors = system.spare_factors()._replace(threshold=0.0)
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, factors.matrix, np.zeros(system.size))
    for row in system.at_rest:
        _leave_out(factors.matrix, row)
    return factors


def _leave_out(matrix: Matrix, row: int) -> None:
    """Make a row and its column those of the unit matrix."""
    n = matrix.band.shape[0]
    if row >= n:
        matrix.right[row - n] = 0.0
        matrix.corner[row - n] = 0.0
    else:
        matrix.band[row] = 0.0
        matrix.lower[:, row] = 0.0
    replace_by_identity(matrix, row)


def _by_pivots(system: System, factors: Factors, none: np.ndarray, way: np.ndarray) -> Stability:
    """Count by the factors: as many pivots are negative as eigenvalues (Sylvester's law of inertia).

    A multiplier takes away a motion and brings one negative pivot. Its row is given a slight negative entry on the
    diagonal, which is a stiff spring in the constraint's place and lets rows stay in their order. What is left of a
    border when the band has been eliminated is a small matrix of its own, whose eigenvalues are counted.
    """
    n, k, border = system.size, system.bandwidth, system.border
    band, corner = factors.matrix.band, factors.matrix.corner
    if not _symmetric(factors.matrix, k):
        return UNKNOWN
    size = np.abs(np.concatenate([band[:, k], np.diagonal(corner)]))
    stiffest = max(float(size[: n - border].max(initial=0.0)), float(np.abs(corner).max(initial=0.0)), 1e-300)
    shift = none + ROUNDING * size
    shift[system.at_rest] = 0.0
    shift[system.algebraic] = -SPRING / stiffest
    band[:, k] += shift[: n - border]
    corner[np.arange(border), np.arange(border)] += shift[n - border :]
    left = corner.T.copy()
    if factorise_matrix(factors):
        return UNKNOWN
    wrong, beyond = np.flatnonzero(factors.inverse < 0.0), 0
    if border:
        left -= factors.matrix.lower @ factors.columns.T
        beyond = int((np.linalg.eigvalsh(0.5 * (left + left.T)) < 0.0).sum())
    negative = wrong.size + beyond - system.algebraic.size
    if negative == 0:
        return Stability(0, n - 1, np.zeros(0))
    worst = np.setdiff1d(wrong, system.algebraic)
    mode, meant = _falling(system, factors, size, negative, way)
    return Stability(negative, int(worst[0]) if worst.size else n - 1, mode, meant)


def _falling(
    system: System, factors: Factors, size: np.ndarray, negative: int, way: np.ndarray
) -> tuple[np.ndarray, bool]:
    """A motion (n,) along which the energy falls, of a stiffness that is factorised: the softest of its own; and
    whether it leads along a way (n,), in extents of the scene.

    Lanczos' method with the inverse finds those next to zero, some of which are negative. ``size`` (n,) are the
    stiffnesses of the rows. Any disturbance has a part along a motion that grows: one at random serves where none is
    found.
    """
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    n = size.size
    still = np.concatenate([system.at_rest, system.algebraic]).astype(int)
    any_way = np.random.default_rng(1).uniform(-1.0, 1.0, n)
    any_way[still] = 0.0
    # A multiplier weighs nothing, and moves nothing.
    weight = np.where(size > 0.0, size, 1.0)
    weight[still] = 0.0

    def solve(force: np.ndarray) -> np.ndarray:
        moved = force.copy()
        solve_matrix(factors, moved)
        return moved

    shape, wanted = (n, n), min(negative, MOST_MODES, n - 2)
    inverse = LinearOperator(shape, matvec=solve, dtype=float)
    metric = LinearOperator(shape, matvec=lambda x: weight * x, dtype=float)
    try:
        _, modes = eigsh(inverse, wanted, metric, 0.0, "SA", any_way, maxiter=LANCZOS, OPinv=inverse)
    except ArpackError:
        return any_way, False
    part = _part_along(system, modes, way)
    meant = _is_meant(system, part)
    # Which of several motions rounding shows first must not decide.
    mode = part if meant else np.asarray(modes @ (modes.T @ (weight * any_way)))
    return mode / max(float(np.abs(mode).max()), 1e-300), meant


def _symmetric(matrix: Matrix, k: int) -> bool:
    """Whether each entry of the band and the border is as its mirror, by the stiffness of their rows."""
    n, width = matrix.band.shape
    # Rows of zeros beyond the last: entry (j + d, j) and its mirror (j, j + d) are at [j, d] for every j and d.
    band, size = np.zeros((n + k, width)), np.ones(n + k)
    band[:n] = matrix.band
    size[:n] = np.sqrt(np.abs(matrix.band[:, k]))
    size[size == 0.0] = 1.0
    step = band.itemsize
    low = np.ndarray((n, k + 1), float, band, k * step, (width * step, step))
    high = np.ndarray((n, k + 1), float, band, k * step, (width * step, (width - 1) * step))
    both = size[:n, None] * np.ndarray((n, k + 1), float, size, 0, (step, step))
    if not bool((np.abs(low - high) <= SKEW * both).all()):
        return False
    if matrix.corner.size == 0:
        return True
    edge = np.sqrt(np.abs(np.diagonal(matrix.corner)))
    edge[edge == 0.0] = 1.0
    border = (
        (matrix.right, matrix.lower, edge[:, None] * size[:n]),
        (matrix.corner, matrix.corner.T, np.outer(edge, edge)),
    )
    return all(np.all(np.abs(low - high) <= SKEW * both) for low, high, both in border)


def _by_eigenvalues(system: System, matrix: Matrix, none: np.ndarray, way: np.ndarray) -> Stability:
    full = dense(matrix)
    rows = np.delete(np.arange(system.size), [*system.algebraic, *system.at_rest])
    full[rows, rows] += none[rows] + ROUNDING * np.abs(full[rows, rows])
    unit = np.abs(np.diagonal(full)).copy()
    unit[unit == 0.0] = 1.0
    unit[system.algebraic] = 1.0
    unit = 1.0 / np.sqrt(unit)
    full *= unit[:, None] * unit
    held = full[system.algebraic]
    moves = np.setdiff1d(np.arange(system.size), system.algebraic)
    free = np.eye(moves.size)
    if held.size:
        _, sizes, directions = np.linalg.svd(held[:, moves])
        rank = int((sizes > 1e-12 * sizes.max(initial=0.0)).sum())
        free = directions[rank:].T
    inner = free.T @ full[np.ix_(moves, moves)] @ free
    if np.abs(inner - inner.T).max(initial=0.0) > SKEW:
        return UNKNOWN
    values, modes = np.linalg.eigh(0.5 * (inner + inner.T))
    negative = int((values < 0.0).sum())
    falling = np.zeros((system.size, negative))
    falling[moves] = (free @ modes[:, :negative]) * unit[moves, None]
    mode = _part_along(system, falling, way)
    meant = _is_meant(system, mode)
    if not meant:
        mode = np.zeros(system.size)
        # A column may fall to any side alike. Which of such motions rounding shows first must not decide.
        alike = modes[:, values <= values[0] + ALIKE * np.abs(values[0])]
        any_way = np.random.default_rng(1).uniform(-1.0, 1.0, moves.size)
        mode[moves] = (free @ (alike @ (alike.T @ (free.T @ any_way)))) * unit[moves]
    worst = int(np.argmax(np.abs(mode)))
    return Stability(negative, worst, mode / np.abs(mode[worst]), meant)
