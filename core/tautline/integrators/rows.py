"""The rows that an iteration goes over: all of them, or those of a chain that are not in balance and their neighbours.

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

from tautline.integrators.state import FACTORISATIONS, WORST
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand, reduce
from tautline.kernels.groups import COUNT, FIRST, PAST, PLACED
from tautline.kernels.jit import kernel
from tautline.kernels.matrix import (
    Matrix,
    add_columns,
    clear_columns,
    copy_columns,
    new_matrix,
    renew_matrix,
)
from tautline.system.system import System

SOLVED, SOLVED_END, ASKED, ASKED_END, STALE, STALE_END, MARGIN = range(7)
"""Places in ``Rows.at``: rows that increments are solved for; rows whose residual is asked for; rows where the matrix
is no longer the one that was factorised; how many rows move with those not in balance, on either side. Ends are past
the last."""
LEAST_MARGIN = 4
"""Widths of the band that a disturbance is taken to reach at least."""
PART = 0.5
"""Share of all rows from which on a part of them costs as much as all."""
LITTLE = 0.1
"""Share of the tolerance below which a row counts as in balance where only a part of the rows is solved for."""


class Rows(NamedTuple):
    """Scratch of iterations that go over a part of the rows; all empty where a system has no window.

    ``window`` (2,) is the system's, in full degrees of freedom; ``at`` (7,) the rows, in reduced ones; ``band`` their
    coupling. ``whole`` is the matrix of the factors, ``beside`` a place to make a part of it, and ``own`` (n_full,) a
    part of the residual.
    """

    window: np.ndarray
    at: np.ndarray
    band: int
    whole: Matrix
    beside: Matrix
    own: np.ndarray


def new_rows(system: System, allowed: bool) -> Rows:
    """Make the scratch; where parts are not allowed or never small enough, that of a system without a window."""
    allowed = allowed and 2 * LEAST_MARGIN * system.bandwidth < PART * system.size
    window = system.window if allowed else np.zeros(0, np.int64)
    n, full = (system.size, system.q.size) if window.size else (0, 0)
    at = np.zeros(7, np.int64)
    at[SOLVED_END] = at[ASKED_END] = at[STALE] = n
    at[MARGIN] = LEAST_MARGIN * system.bandwidth
    k = system.bandwidth
    return Rows(window, at, k, new_matrix(n, k), new_matrix(n, k), np.zeros(full))


@kernel
def is_part(rows):
    """Whether less than all rows are solved for."""
    return rows.window.size > 0 and rows.at[SOLVED_END] - rows.at[SOLVED] < rows.whole.band.shape[0]


@kernel
def take_all(rows, state):
    """Go over all rows."""
    if rows.window.size > 0:
        rows.at[SOLVED], rows.at[SOLVED_END] = 0, state.q.size
        rows.at[ASKED], rows.at[ASKED_END] = 0, state.q.size
        rows.window[0], rows.window[1] = 0, state.full_q.size


@kernel
def _take(rows, dofs, state, first, last):
    """Solve for rows ``first`` to ``last`` - 1, and ask for the residual of all that these can change.

    Twice the band on either side: degrees of freedom that are held are not in it, and have a residual too.
    """
    n = state.q.size
    rows.at[SOLVED], rows.at[SOLVED_END] = first, last
    rows.at[ASKED], rows.at[ASKED_END] = max(0, first - 2 * rows.band), min(n, last + 2 * rows.band)
    _look_at(rows, dofs, state, rows.at[ASKED], rows.at[ASKED_END])


@kernel
def _look_at(rows, dofs, state, first, last):
    """Set the window to the degrees of freedom of rows ``first`` to ``last`` - 1 and the held ones among them."""
    n = state.q.size
    rows.window[0] = 0 if first == 0 else dofs.free[first]
    rows.window[1] = state.full_q.size if last == n else dofs.free[last - 1] + 1


@kernel
def ask_all(rows, state):
    """Set the window to all degrees of freedom."""
    if rows.window.size > 0:
        rows.window[0], rows.window[1] = 0, state.full_q.size


@kernel
def ask_again(rows, dofs, state):
    """Set the window to the rows that are asked for."""
    _look_at(rows, dofs, state, rows.at[ASKED], rows.at[ASKED_END])


@kernel
def take_changed(rows, dofs, state, changed):
    """After an event in a state of balance: only the rows of laws that have changed can be out of it."""
    if rows.window.size > 0 and changed[COUNT] == changed[PLACED] and rows.at[STALE] < rows.at[STALE_END]:
        _take(rows, dofs, state, rows.at[STALE], rows.at[STALE_END])


@kernel
def heed_place(rows, dofs, changed):
    """Note where the matrix is no longer the one that was factorised; returns whether that is known."""
    if rows.window.size == 0 or changed[COUNT] > changed[PLACED]:
        return False
    for i in range(changed[FIRST], changed[PAST]):
        row = dofs.number[i]
        if row >= 0:
            _widen(rows, row, row + 1)
    return True


@kernel
def _widen(rows, first, last):
    rows.at[STALE] = min(rows.at[STALE], first)
    rows.at[STALE_END] = max(rows.at[STALE_END], last)


@kernel
def forget_stale(rows):
    """All factors have been made anew."""
    rows.at[STALE], rows.at[STALE_END] = rows.whole.band.shape[0], 0


@kernel(forceinline=True)
def expand_rows(rows, dofs, state):
    """Write reduced unknowns of the rows into the full vectors."""
    if is_part(rows):
        for i in range(rows.at[ASKED], rows.at[ASKED_END]):
            place = dofs.free[i]
            state.full_q[place] = state.q[i]
            state.full_v[place] = state.v[i]
            state.full_a[place] = state.a[i]
    else:
        expand(dofs, state.q, state.full_q)
        expand(dofs, state.v, state.full_v)
        expand(dofs, state.a, state.full_a)


@kernel(forceinline=True)
def balance(rows, groups, dofs, state, t, right_side):
    """Residual of the rows: in full into ``state.residual``, which keeps that of all others, reduced into the other."""
    if is_part(rows):
        rows.own.fill(0.0)
        over.residual(groups, t, state.full_q, state.full_v, state.full_a, rows.own)
        # What members of a group that reach beyond the window add outside it is not all that acts there.
        for i in range(rows.window[0], rows.window[1]):
            state.residual[i] = rows.own[i]
        for i in range(rows.at[ASKED], rows.at[ASKED_END]):
            right_side[i] = rows.own[dofs.free[i]]
    else:
        state.residual.fill(0.0)
        over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)
        reduce(dofs, state.residual, right_side)


@kernel
def worst_row(rows, residual, scale, counters):
    """Largest residual over its scale; its row goes to the counters; NaN counts as infinite."""
    first, last = 0, residual.size
    if rows.window.size > 0:
        first, last = rows.at[ASKED], rows.at[ASKED_END]
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
def aim_at_imbalance(rows, dofs, state, right_side, scale, tolerance, tried, slow):
    """Take the rows that are not in balance, and a margin; their residual goes into ``right_side`` (n,).

    Where rows at the edge of a part that increments were ``tried`` for are out of balance, the margin was too small,
    and is doubled. Returns whether the factors contract badly, given that the residual fell slowly: not in that case.
    """
    if rows.window.size == 0:
        return slow
    at, n = rows.at, right_side.size
    first, last = n, 0
    for i in range(at[ASKED], at[ASKED_END]):
        if abs(right_side[i]) > LITTLE * tolerance * scale[i]:
            first, last = min(first, i), i + 1
    if is_part(rows) and tried:
        if first < at[SOLVED] + rows.band or last > at[SOLVED_END] - rows.band:
            at[MARGIN] = min(2 * at[MARGIN], n)
            slow = False
    elif not is_part(rows) and at[MARGIN] > LEAST_MARGIN * rows.band:
        at[MARGIN] -= 1
    first, last = max(0, first - at[MARGIN]), min(n, last + at[MARGIN])
    if last - first < PART * n:
        _take(rows, dofs, state, first, last)
    else:
        take_all(rows, state)
        first, last = 0, n
    for i in range(first, last):
        right_side[i] = state.residual[dofs.free[i]]
    return slow


@kernel
def renew_part(rows, groups, dofs, state, t, beta, gamma, slow, smooth, factors):
    """Bring factors up to date that are so but for a part. Returns whether they are now; if not, all are to be made.

    Where those of all contract badly (``slow``) that is not tried; where those of a part do, the tangent of the smooth
    groups is made anew there too.
    """
    if rows.window.size == 0 or (slow and not is_part(rows)):
        return not slow
    at, n = rows.at, state.q.size
    if slow:
        first, last = at[SOLVED], at[SOLVED_END]
        _look_at(rows, dofs, state, first, last)
        clear_columns(rows.beside, max(0, first - rows.band), min(n, last + rows.band))
        over.smooth_tangent(
            groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, rows.beside, dofs
        )  # fmt: skip
        # Only in these columns is it all that couples to them.
        copy_columns(rows.beside, smooth, first, last)
        _widen(rows, first, last)
    first, last = at[STALE], at[STALE_END]
    done = True
    if first < last:
        done = last - first < PART * n
        if done:
            _look_at(rows, dofs, state, first, last)
            clear_columns(rows.beside, max(0, first - rows.band), min(n, last + rows.band))
            over.switching_tangent(
                groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, rows.beside, dofs
            )  # fmt: skip
            copy_columns(smooth, rows.whole, first, last)
            add_columns(rows.beside, rows.whole, first, last)
            done = renew_matrix(factors, rows.whole, first, last) >= 0
    if done and first < last:
        forget_stale(rows)
        state.counters[FACTORISATIONS] += 1
    ask_again(rows, dofs, state)
    return done
