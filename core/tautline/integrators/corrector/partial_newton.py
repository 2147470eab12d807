"""Iterations over a part of the rows: those of a chain that are not in balance, and their neighbours.

What happens at one lump of a string (it begins to slip, it comes to rest) moves, within a step, the lumps as far as a
wave runs and hardly any beyond. So after an iteration over all rows only those that are left out of balance are solved
for, with some on either side; all others count as at rest meanwhile, and what is wrong with that shows in the residual
of the rows at the edges: then more are taken. The residual is asked for in a *window* (`System.window`) that reaches a
little further, so that no row outside it can have changed, and no step is accepted before every row is in balance.

The factors, too, are made anew only where a law has changed its status, and as far as that reaches (`renew`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.state import FACTORISATIONS, worst_between
from tautline.kernels import groups as over
from tautline.kernels.changes import COUNT, FIRST, PAST, PLACED
from tautline.kernels.dofs import PLACES, REPEATS, RUN, UNKNOWNS, expand, reduce
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, any_of, gather, within
from tautline.kernels.matrix import (
    Matrix,
    add_columns,
    clear_columns,
    copy_columns,
    new_matrix,
    renew_matrix,
    solve_matrix,
    solve_rows,
)
from tautline.kernels.vector import copy
from tautline.system.system import System

SOLVED, SOLVED_END, ASKED, ASKED_END, STALE, STALE_END, MARGIN = range(7)
"""Places in ``Window.at``: rows that increments are solved for; rows whose residual is asked for; rows where the matrix
is no longer the one that was factorised; how many rows move with those not in balance, on either side. Ends are past
the last."""
LEAST_MARGIN = 4
"""Widths of the band that a disturbance is taken to reach at least."""
PART = 0.5
"""Share of all rows from which on a part of them costs as much as all."""
LITTLE = 0.1
"""Share of the tolerance below which a row counts as in balance where only a part of the rows is solved for."""


class Window(NamedTuple):
    """The rows of the iteration under way, of a system with a window, and scratch for them.

    ``asked`` (2,) is the system's window, in full degrees of freedom; ``at`` (7,) are the rows, in reduced ones;
    ``band`` is their coupling. ``beside`` is a place to make a part of the matrix, and ``own`` (n_full,) a part of the
    residual.
    """

    asked: np.ndarray
    at: np.ndarray
    band: int
    beside: Matrix
    own: np.ndarray


def is_worth_while(system: System) -> bool:
    """Whether a part of the rows can be less than all of them."""
    return system.window.size > 0 and 2 * LEAST_MARGIN * system.bandwidth < PART * system.size


def new_window(system: System) -> Window:
    """Make the scratch for a system that has a window."""
    n, k = system.size, system.bandwidth
    at = np.array([0, n, 0, n, n, 0, LEAST_MARGIN * k])
    return Window(system.window, at, k, new_matrix(n, k), np.zeros(system.q.size))


# -- which rows ------------------------------------------------------------------------------------------------------


@kernel
def _is_part(w):
    return w.at[SOLVED_END] - w.at[SOLVED] < w.beside.band.shape[0]


@kernel
def take_all(w, state):
    """Go over all rows."""
    w.at[SOLVED], w.at[SOLVED_END] = 0, state.q.size
    w.at[ASKED], w.at[ASKED_END] = 0, state.q.size
    w.asked[0], w.asked[1] = 0, state.full_q.size


@kernel
def _take(w, dofs, state, first, last):
    """Solve for rows ``first`` to ``last`` - 1, and ask for the residual of all that these can change.

    Twice the band on either side: degrees of freedom that are held are not in it, and have a residual too. The rows are
    made whole blocks of `LANES`.
    """
    first, last = first // LANES * LANES, min(state.q.size, (last + LANES - 1) // LANES * LANES)
    w.at[SOLVED], w.at[SOLVED_END] = first, last
    w.at[ASKED], w.at[ASKED_END] = max(0, first - 2 * w.band), min(state.q.size, last + 2 * w.band)
    _ask(w, dofs, state, w.at[ASKED], w.at[ASKED_END])


@kernel
def _ask(w, dofs, state, first, last):
    """Set the window to the degrees of freedom of rows ``first`` to ``last`` - 1 and the held ones among them."""
    w.asked[0] = 0 if first == 0 else dofs.free[first]
    w.asked[1] = state.full_q.size if last == state.q.size else dofs.free[last - 1] + 1


@kernel
def take_changed(w, dofs, state, changed):
    """After an event in a state of balance: only the rows of laws that have changed can be out of it."""
    if changed[COUNT] == changed[PLACED] and w.at[STALE] < w.at[STALE_END]:
        _take(w, dofs, state, w.at[STALE], w.at[STALE_END])


@kernel
def choose_rows(w, dofs, state, right_side, per_scale, tolerance, tried, slow):
    """Take the rows that are not in balance, and a margin; their residual goes into ``right_side`` (n,).

    Where rows at the edge of a part that increments were ``tried`` for are out of balance, the margin was too small,
    and is doubled. Returns whether the factors contract badly, given that the residual fell slowly: not in that case.
    """
    at, n = w.at, right_side.size
    first, last = n, 0
    end = at[ASKED_END]
    # Rows are taken by fours in any case.
    for b in range(at[ASKED], end, LANES):
        if any_of(within(b, end) & (abs(gather(right_side, b, end)) * gather(per_scale, b, end) > LITTLE * tolerance)):
            first, last = min(first, b), min(b + LANES, end)
    above = first < at[SOLVED] + w.band and at[SOLVED] > 0
    below = last > at[SOLVED_END] - w.band and at[SOLVED_END] < n
    if tried and (above or below):
        at[MARGIN] = min(2 * at[MARGIN], n)
        slow = False
    elif not _is_part(w) and at[MARGIN] > LEAST_MARGIN * w.band:
        at[MARGIN] -= 1
    first, last = max(0, first - at[MARGIN]), min(n, last + at[MARGIN])
    if last - first < PART * n:
        _take(w, dofs, state, first, last)
        first, last = at[SOLVED], at[SOLVED_END]
    else:
        take_all(w, state)
        first, last = 0, n
    _reduce_rows(dofs, state.residual, right_side, first, last)
    return slow


@kernel
def _reduce_rows(dofs, full, reduced, first, last):
    """Take rows ``first`` to ``last`` - 1 out of a full vector; no row of a system with a window is tied."""
    if dofs.runs.size == RUN and dofs.runs[REPEATS] == 1:
        place = dofs.runs[PLACES] - dofs.runs[UNKNOWNS]
        for i in range(first, last):
            reduced[i] = full[place + i]
    else:
        for i in range(first, last):
            reduced[i] = full[dofs.free[i]]


@kernel
def _expand_rows(dofs, reduced, full, first, last):
    """The other way."""
    if dofs.runs.size == RUN and dofs.runs[REPEATS] == 1:
        place = dofs.runs[PLACES] - dofs.runs[UNKNOWNS]
        for i in range(first, last):
            full[place + i] = reduced[i]
    else:
        for i in range(first, last):
            full[dofs.free[i]] = reduced[i]


# -- state and residual ----------------------------------------------------------------------------------------------


@kernel
def expand_part(w, dofs, state):
    """Write reduced unknowns of the rows into the full vectors."""
    if not _is_part(w):
        expand(dofs, state.q, state.full_q)
        expand(dofs, state.v, state.full_v)
        expand(dofs, state.a, state.full_a)
        return
    first, last = w.at[ASKED], w.at[ASKED_END]
    _expand_rows(dofs, state.q, state.full_q, first, last)
    _expand_rows(dofs, state.v, state.full_v, first, last)
    _expand_rows(dofs, state.a, state.full_a, first, last)


@kernel
def balance_part(w, groups, dofs, state, t, right_side):
    """Residual of the rows: in full into ``state.residual``, which keeps that of all others, reduced into the other."""
    w.own.fill(0.0)
    over.residual(groups, t, state.full_q, state.full_v, state.full_a, w.own)
    # What members of a group that reach beyond the window add outside it is not all that acts there.
    for i in range(w.asked[0], w.asked[1]):
        state.residual[i] = w.own[i]
    if _is_part(w):
        _reduce_rows(dofs, w.own, right_side, w.at[ASKED], w.at[ASKED_END])
    else:
        reduce(dofs, w.own, right_side)


@kernel
def worst_of_part(w, residual, per_scale, counters):
    """Largest residual of the rows that are asked for, over its scale."""
    return worst_between(residual, per_scale, counters, w.at[ASKED], w.at[ASKED_END])


# -- matrix and increments -------------------------------------------------------------------------------------------


@kernel
def widen_to_changes(w, dofs, changed):
    """Note where the matrix is no longer the one that was factorised; returns whether that is known."""
    if changed[COUNT] > changed[PLACED]:
        return False
    for i in range(changed[FIRST], changed[PAST]):
        row = dofs.number[i]
        if row >= 0:
            _widen(w, row, row + 1)
    return True


@kernel
def _widen(w, first, last):
    w.at[STALE] = min(w.at[STALE], first)
    w.at[STALE_END] = max(w.at[STALE_END], last)


@kernel
def _forget(w):
    """The factors are those of the matrix as it is."""
    w.at[STALE], w.at[STALE_END] = w.beside.band.shape[0], 0


@kernel
def _make_beside(w, groups, dofs, state, t, beta, gamma, first, last, smooth):
    """Make columns ``first`` to ``last`` - 1 of the smooth or of the switching groups' tangent, and rubbish around."""
    _ask(w, dofs, state, first, last)
    clear_columns(w.beside, max(0, first - w.band), min(state.q.size, last + w.band))
    if smooth:
        over.smooth_tangent(groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, w.beside, dofs)
    else:
        over.switching_tangent(groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, w.beside, dofs)


@kernel
def renew_part(w, groups, dofs, state, t, beta, gamma, slow, smooth, factors):
    """Bring factors up to date that are so but for a part. Returns whether they are now; if not, all are to be made.

    Where those of all contract badly (``slow``) that is not tried; where those of a part do, the tangent of the smooth
    groups is made anew there too.
    """
    at = w.at
    if slow:
        if not _is_part(w):
            return False
        first, last = at[SOLVED], at[SOLVED_END]
        _make_beside(w, groups, dofs, state, t, beta, gamma, first, last, True)
        copy_columns(w.beside, smooth, first, last)
        _widen(w, first, last)
    first, last = at[STALE], at[STALE_END]
    if first < last:
        if last - first >= PART * state.q.size:
            return False
        _make_beside(w, groups, dofs, state, t, beta, gamma, first, last, False)
        copy_columns(smooth, factors.matrix, first, last)
        add_columns(w.beside, factors.matrix, first, last)
        if renew_matrix(factors, first, last) < 0:
            return False
        _forget(w)
        state.counters[FACTORISATIONS] += 1
        _ask(w, dofs, state, at[ASKED], at[ASKED_END])
    return True


@kernel
def use_all_rows(w, state):
    """Ask for all rows, to make the matrix of all."""
    w.asked[0], w.asked[1] = 0, state.full_q.size


@kernel
def ask_as_before(w, dofs, state):
    """Go back to the rows that were asked for: the matrix is there."""
    _forget(w)
    _ask(w, dofs, state, w.at[ASKED], w.at[ASKED_END])


@kernel
def solve_part(w, factors, increment, right_side):
    """Solve for the increments of the rows, of which ``increment`` (n,) holds the residual; returns first and end."""
    if not _is_part(w):
        copy(increment, right_side)
        solve_matrix(factors, increment)
        return 0, increment.size
    first, last = w.at[SOLVED], w.at[SOLVED_END]
    for i in range(first, last):
        right_side[i] = increment[i]
    solve_rows(factors, increment, first, last)
    return first, last
