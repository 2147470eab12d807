"""The rows that an iteration goes over: all, or a part of them where the system has a window (partial_newton.py).

Which of both is a matter of type, so that the time loop of a scene without a window knows nothing of parts.
"""

from __future__ import annotations

from typing import NamedTuple

from tautline.integrators.corrector import partial_newton as part
from tautline.integrators.corrector.partial_newton import Window, is_worth_while, new_window
from tautline.integrators.corrector.single_precision import solve_for
from tautline.integrators.corrector.turning import Fixed, Turning, face, to_faced, to_turned, turn, turning_of
from tautline.integrators.state import worst_between
from tautline.kernels import groups as over
from tautline.kernels.dispatch import by_type
from tautline.kernels.dofs import COUNT, PLACES, REPEATS, RUN, UNKNOWNS, copy_some_runs, expand, expand_tied, reduce
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, gather, larger, largest, scatter, spread, total, where, within
from tautline.kernels.vector import copy
from tautline.system.system import System

STRIP = 1536
"""Unknowns that are moved together."""


class AllRows(NamedTuple):
    """Every iteration goes over all rows, by factors that may turn with what they belong to (turning.py)."""

    turning: Turning | Fixed


def rows_of(system: System, in_parts: bool) -> AllRows | Window:
    """All rows, or where ``in_parts`` is allowed and the system has a window, those out of balance."""
    return new_window(system) if in_parts and is_worth_while(system) else AllRows(turning_of(system))


@kernel
def _take_all(rows, state):
    return


@kernel
def _take_changed(rows, dofs, state, changed):
    return


@kernel
def _choose_all(rows, dofs, state, right_side, per_scale, tolerance, tried, slow):
    return slow


@kernel(forceinline=True)
def _expand(rows, dofs, state, predicted):
    # What an iteration adds is written by `_advance`.
    if predicted:
        expand(dofs, state.q, state.full_q)
        expand(dofs, state.v, state.full_v)
        expand(dofs, state.a, state.full_a)


@kernel(forceinline=True)
def _expand_part(rows, dofs, state, predicted):
    part.expand_part(rows, dofs, state)


@kernel(forceinline=True)
def _add(state, increment, right_side, first, last, factors, sums):
    """Add increments of rows; sums of work, largest step and largest velocity before it, in lanes."""
    fraction, beta, gamma = factors
    products, steps, speeds = sums
    for i in range(first, last, LANES):
        step = -fraction * gather(increment, i, last)
        v = gather(state.v, i, last)
        products += where(within(i, last), gather(right_side, i, last) * step, 0.0)
        speeds = larger(abs(v), speeds)
        steps = larger(abs(step), steps)
        scatter(state.q, i, last, gather(state.q, i, last) + step)
        scatter(state.v, i, last, v + gamma * step)
        scatter(state.a, i, last, gather(state.a, i, last) + beta * step)
    return products, steps, speeds


@kernel
def _advance_part(rows, dofs, state, increment, right_side, first, last, factors, fastest):
    start = spread(0.0), spread(0.0), spread(fastest)
    products, steps, speeds = _add(state, increment, right_side, first, last, factors, start)
    return total(products), largest(steps), largest(speeds)


@kernel
def _advance(rows, dofs, state, increment, right_side, first, last, factors, fastest):
    """Strip by strip, each written into the full vectors while a processor has it at hand."""
    runs = dofs.runs
    sums = spread(0.0), spread(0.0), spread(fastest)
    for k in range(0, runs.size, RUN):
        at, count, repeats = runs[k + UNKNOWNS], runs[k + COUNT], runs[k + REPEATS]
        many = max(1, STRIP // count)
        for begin in range(0, repeats, many):
            end = min(begin + many, repeats)
            sums = _add(state, increment, right_side, at + begin * count, at + end * count, factors, sums)
            copy_some_runs(runs, k, begin, end, state.q, UNKNOWNS, state.full_q, PLACES)
            copy_some_runs(runs, k, begin, end, state.v, UNKNOWNS, state.full_v, PLACES)
            copy_some_runs(runs, k, begin, end, state.a, UNKNOWNS, state.full_a, PLACES)
    if runs.size == 0:
        sums = _add(state, increment, right_side, first, last, factors, sums)
        expand(dofs, state.q, state.full_q)
        expand(dofs, state.v, state.full_v)
        expand(dofs, state.a, state.full_a)
    else:
        expand_tied(dofs, state.q, state.full_q)
        expand_tied(dofs, state.v, state.full_v)
        expand_tied(dofs, state.a, state.full_a)
    products, steps, speeds = sums
    return total(products), largest(steps), largest(speeds)


@kernel(forceinline=True)
def _balance(rows, groups, dofs, state, t, right_side):
    state.residual.fill(0.0)
    over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)
    reduce(dofs, state.residual, right_side)


@kernel
def _worst(rows, residual, per_scale, counters):
    return worst_between(residual, per_scale, counters, 0, residual.size)


@kernel
def _never_widen(rows, dofs, changed):
    return False


@kernel
def _renew(rows, groups, dofs, state, t, beta, gamma, slow, smooth, factors):
    return not slow


@kernel
def _ask_as_before(rows, dofs, state):
    return


@kernel
def _solve(rows, factors, increment, right_side):
    copy(increment, right_side)
    to_faced(rows.turning, increment)
    solve_for(factors, increment, right_side)
    to_turned(rows.turning, increment)
    return 0, increment.size


@kernel
def _rotate_factors(rows, state):
    turn(rows.turning, state.full_q)


@kernel
def _set_reference_frame(rows, state):
    face(rows.turning, state.full_q)


take_all = by_type({AllRows: _take_all, Window: part.take_all})
take_changed = by_type({AllRows: _take_changed, Window: part.take_changed})
choose_rows = by_type({AllRows: _choose_all, Window: part.choose_rows})
expand_rows = by_type({AllRows: _expand, Window: _expand_part})
advance_rows = by_type({AllRows: _advance, Window: _advance_part})
balance = by_type({AllRows: _balance, Window: part.balance_part})
worst_row = by_type({AllRows: _worst, Window: part.worst_of_part})
widen_to_changes = by_type({AllRows: _never_widen, Window: part.widen_to_changes})
renew_factors = by_type({AllRows: _renew, Window: part.renew_part})
use_all_rows = by_type({AllRows: _take_all, Window: part.use_all_rows})
ask_as_before = by_type({AllRows: _ask_as_before, Window: part.ask_as_before})
rotate_factors = by_type({AllRows: _rotate_factors, Window: _take_all})
set_reference_frame = by_type({AllRows: _set_reference_frame, Window: _take_all})
solve_for_increment = by_type({AllRows: _solve, Window: part.solve_part})
"""What an iteration does with its rows; the functions for a window tell what each is for."""
