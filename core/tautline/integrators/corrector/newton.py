"""The corrector of the implicit methods: Newton's method on the residual, eq. 2.87, one step at a time.

An iteration goes over the rows that are not in balance yet. At first these are all. Of a string of a thousand lumps,
one of which has begun to slip, they are some tens, and the work is theirs and not the string's: rows.py and
partial_newton.py.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tautline.integrators.corrector.partial_newton import Window
from tautline.integrators.corrector.rows import (
    AllRows,
    advance_rows,
    ask_as_before,
    balance,
    choose_rows,
    expand_rows,
    renew_factors,
    rotate_factors,
    rows_of,
    set_reference_frame,
    solve_for_increment,
    take_all,
    take_changed,
    use_all_rows,
    widen_to_changes,
    worst_row,
)
from tautline.integrators.corrector.single_precision import doubt
from tautline.integrators.state import FACTORISATIONS, ITERATIONS, ROWS, WORST
from tautline.integrators.status import Status
from tautline.kernels import groups as over
from tautline.kernels.changes import COUNT, EVER, FIRST, PAST, PLACED, new_changed
from tautline.kernels.factors.band import BOLD, CAREFUL
from tautline.kernels.jit import kernel
from tautline.kernels.matrix import (
    Factors,
    Matrix,
    clear_as_filled,
    copy_matrix,
    factorise_apart,
    have_cleared,
    new_factors,
    new_matrix,
)
from tautline.system.system import System

DONE, NOT_CONVERGED, SINGULAR, NOT_FINITE = (
    int(s) for s in (Status.DONE, Status.NOT_CONVERGED, Status.SINGULAR, Status.NOT_FINITE)
)
HALF_STEPS_FROM = 9
"""From this iteration on every third increment is halved: two statuses of a law may chase each other."""
FRESH_SHARE = 0.5
"""Share of the contraction that old factors must bring which those of the same step must bring."""
SAME_STEP = 1.0e-9
"""Relative difference of beta' below which two steps are the same: frame times are rounded."""
ROUNDED = 8.0 * float(np.finfo(float).eps)
"""Increments of velocity below so much of the largest are rounding: no iteration can do better."""
ROUNDING_MOST = 1.0e4
"""Times the tolerance up to which a residual is put down to rounding. A contact that rolls at speed v, with friction of
stiffness c, leaves eps c v in the residual, and smaller steps only raise c."""
SETTLING = 5
"""Iterations that a step takes, as a rule, once what sticks and what slips is found."""
ASTRAY = 10.0
"""Times its first residual, or its scale, above which the iteration of a step is given up and the step divided: what it
would find may be a solution in which elements are folded. Of 84 runs of stiff ropes in steps of 10 to 30 ms 21 failed
without such a bound, 13 with 100, one with 30, and five with 10 and 3: those with the loosest tolerance."""
FIRST_PLACE, PAST_PLACE, FIRST_WAY, PAST_WAY, SINCE, FREE = range(6)
"""Places in ``Corrector.chain``: where laws changed their status last, first and past the last full degree of freedom;
the way that either went last (1 to higher places, -1 to lower ones, 0 none yet); the iteration in which they changed;
how many iterations of the step do not count."""


class Corrector(NamedTuple):
    """Settings and scratch of the iteration.

    Old factors are kept while an iteration shrinks the residual to the part ``contraction``, else the tangent is made
    anew; where the iteration is ``full`` it is made anew each time, as eq. 2.87 says. ``tolerance``: with the energy
    criterion the bound of eq. 2.78 with the energy over ``unit``; with the force criterion that of the largest residual
    over its scale, of which ``per_scale`` (n,) is 1 / scale: products take a tenth of the time of quotients.
    ``smooth`` is the tangent of the groups that do not switch, kept where others do, and ``factors`` those of the
    whole; ``made_for`` and ``factored_for`` (2,) are the beta' and gamma' that they belong to, zeros where they are out
    of date. ``rounded`` (1,) is 1 after an increment that rounding has made, and ``fastest`` (1,) the largest
    velocity when all rows were last solved for. ``rows`` are those of the iteration under way. ``chain`` (6,) tells how
    changes of status go on from contact to contact (`_follow_chain`). ``astray`` (1,) is how many times the first
    residual of a step an iteration may leave: `ASTRAY`, infinite where the step cannot be divided.
    """

    tolerance: float
    contraction: float
    full: int
    unit: float
    by_energy: int
    max_iterations: int
    per_scale: np.ndarray
    smooth: Matrix
    factors: Factors
    increment: np.ndarray
    right_side: np.ndarray
    made_for: np.ndarray
    factored_for: np.ndarray
    changed: np.ndarray
    rounded: np.ndarray
    fastest: np.ndarray
    rows: AllRows | Window
    chain: np.ndarray
    astray: np.ndarray


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
    rows = rows_of(system, in_parts=not (by_energy or full))
    return Corrector(
        tolerance=float(tolerance),
        contraction=float(contraction),
        full=int(full),
        unit=float(unit),
        by_energy=int(by_energy),
        max_iterations=int(max_iterations),
        per_scale=1.0 / system.scale,
        smooth=new_matrix(n, system.bandwidth, system.border),
        factors=new_factors(
            n, system.bandwidth, system.border, BOLD if isinstance(rows, Window) else CAREFUL, improved=True
        ),
        increment=np.zeros(n),
        right_side=np.zeros(n),
        made_for=np.zeros(2),
        factored_for=np.zeros(2),
        changed=new_changed(),
        rounded=np.zeros(1, np.int64),
        fastest=np.zeros(1),
        rows=rows,
        chain=np.zeros(6, np.int64),
        astray=np.full(1, ASTRAY),
    )


def advice(method: Any, status: int) -> str:
    """What may help a run whose step was not solved: empty, unless laws changed shortly before its last iteration.

    Each change begins the search anew. After the last of them Newton's method needs some iterations for the statuses
    that were found: where fewer were left, more of them may be all that lacks.
    """
    c = getattr(method, "corrector", None)
    if status != NOT_CONVERGED or c is None or c.changed[EVER] == 0:
        return ""
    counted = c.chain[SINCE] - c.chain[FREE]
    most = f"{c.max_iterations} iteration{'' if c.max_iterations == 1 else 's'}"
    if counted >= c.max_iterations - 1:
        return f"after {most} it still changed what sticks and what slips: a larger solver.max_iterations may help"
    if c.max_iterations - counted > SETTLING:
        return ""
    return f"{most} were too few once it was found what sticks and what slips: a larger solver.max_iterations may help"


@kernel(forceinline=True)
def correct(corrector, groups, dofs, state, t, beta, gamma, held):
    """Iterate position, velocity and acceleration at time t until the residual vanishes.

    ``beta`` and ``gamma`` are beta' and gamma' of eqs 2.88-2.89: how acceleration and velocity follow position.
    ``held`` lists rows that ask for an increment of zero and are not balanced: see `generalized_alpha_step`.
    Returns a status; ``changed[EVER]`` says whether a law has changed its own.
    """
    c = corrector
    c.changed[EVER] = 0
    c.rounded[0] = 0
    if abs(c.factored_for[0] - beta) > SAME_STEP * beta:
        c.factored_for[0] = 0.0
    if abs(c.made_for[0] - beta) > SAME_STEP * beta:
        c.made_for[0] = 0.0
    take_all(c.rows, state)
    status = _iterate(c, groups, dofs, state, t, beta, gamma, held)
    take_all(c.rows, state)
    return status


@kernel(forceinline=True)
def _iterate(c, groups, dofs, state, t, beta, gamma, held):
    """The iteration itself, which leaves behind the rows of its last one.

    The factors of the tangent are used again, also across steps, while they still contract. A law that changes its
    status forces new factors, for which the smooth groups' tangent is used again in turn. Iterations that a chain of
    changes needs do not count, and are at most as many as there are unknowns.
    """
    c.chain.fill(0)
    changed = c.changed
    previous = energy = first = np.inf
    event = False
    contraction = c.contraction
    for iteration in range(c.max_iterations + state.q.size + 1):
        expand_rows(c.rows, dofs, state, iteration == 0)
        if c.factored_for[0] != 0.0:
            rotate_factors(c.rows, state)
        changed[COUNT] = changed[PLACED] = 0
        if not event:
            # After an event the forced status is to be solved for before it is tested.
            over.switch(groups, t, state.full_q, state.full_v, False, changed)
        event = False
        if changed[COUNT] > 0:
            _heed_change(c, dofs, iteration)
            previous = energy = np.inf
        balance(c.rows, groups, dofs, state, t, c.increment)
        for i in held:
            c.increment[i] = 0.0
        changed[COUNT] = changed[PLACED] = 0
        over.kink(groups, changed)
        if changed[COUNT] > 0:
            _heed_change(c, dofs, iteration)
            previous = energy = np.inf
        size = worst_row(c.rows, c.increment, c.per_scale, state.counters)
        if not np.isfinite(size):
            return NOT_FINITE
        enough = ROUNDING_MOST * c.tolerance if c.rounded[0] == 1 else c.tolerance
        if size <= enough if not c.by_energy else energy <= c.tolerance:
            changed[COUNT] = changed[PLACED] = 0
            take_all(c.rows, state)
            over.switch(groups, t, state.full_q, state.full_v, True, changed)
            if changed[COUNT] == 0:
                return DONE
            _heed_change(c, dofs, iteration)
            take_changed(c.rows, dofs, state, changed)
            previous = energy = np.inf
            event = True
            continue
        first = size if previous == np.inf else first
        counted = iteration - c.chain[FREE]
        if counted >= c.max_iterations or size > c.astray[0] * max(first, 1.0):
            doubt(c.factors)
            break
        slow = c.full or size > contraction * previous
        slow = choose_rows(c.rows, dofs, state, c.increment, c.per_scale, c.tolerance, previous < np.inf, slow)
        if slow:
            # Factors of this very step that contract badly tell of a way that bends: they are not worth keeping.
            if contraction < c.contraction:
                doubt(c.factors)
            contraction = FRESH_SHARE * c.contraction
        row = _prepare_factors(c, groups, dofs, state, t, beta, gamma, slow)
        if row != 0:
            state.counters[WORST] = row - 1
            return SINGULAR
        # Beyond the limit a chain of changes has led: half an increment would turn it back.
        tried = iteration if iteration < c.max_iterations else counted
        energy = _step(c, dofs, state, beta, gamma, 0.5 if tried >= HALF_STEPS_FROM and iteration % 3 == 0 else 1.0)
        state.counters[ITERATIONS] += 1
        if c.by_energy and energy <= c.tolerance and not over.may_switch(groups):
            # What is left of the residual is below what the criterion cares for: it is not evaluated again.
            expand_rows(c.rows, dofs, state, False)
            return DONE
        previous = size
    return NOT_CONVERGED


@kernel
def _heed_change(c, dofs, iteration):
    """A law has changed its status: the factors are out of date, where it is known where, only there."""
    c.changed[EVER] = 1
    c.rounded[0] = 0
    _follow_chain(c.chain, c.changed, iteration)
    if not widen_to_changes(c.rows, dofs, c.changed):
        c.factored_for[0] = 0.0


@kernel
def _follow_chain(chain, changed, iteration):
    """Whether changes of status go on along a chain of contacts: then the iterations since the last do not count.

    A contact that holds keeps the load from the next one. Where a string is to begin to slip, it may do so one contact
    an iteration, and a shorter step has no fewer contacts. Two such chains may run towards each other: what counts is
    whether the first and the last place of the changes go on as they went. What goes to and fro between contacts is no
    such chain: to turn back counts, and so does the first iteration that goes the new way.
    """
    first = past = 0
    if changed[COUNT] == changed[PLACED]:
        if chain[PAST_PLACE] > 0:
            first, past = np.sign(changed[FIRST] - chain[FIRST_PLACE]), np.sign(changed[PAST] - chain[PAST_PLACE])
        chain[FIRST_PLACE], chain[PAST_PLACE] = changed[FIRST], changed[PAST]
    upper, lower = first * chain[FIRST_WAY], past * chain[PAST_WAY]
    if max(upper, lower) > 0 and min(upper, lower) >= 0:
        chain[FREE] += iteration - chain[SINCE]
    chain[FIRST_WAY] = first if first != 0 else chain[FIRST_WAY]
    chain[PAST_WAY] = past if past != 0 else chain[PAST_WAY]
    chain[SINCE] = iteration


@kernel(forceinline=True)
def _prepare_factors(c, groups, dofs, state, t, beta, gamma, slow):
    """Make the factors anew, or a part of them, where they are out of date; ``slow`` says that they contract badly.

    Returns 0, or k > 0 where the k-th pivot is zero.
    """
    if c.factored_for[0] != 0.0:
        if renew_factors(c.rows, groups, dofs, state, t, beta, gamma, slow, c.smooth, c.factors):
            return 0
        c.factored_for[0] = 0.0
        if slow:
            c.made_for[0] = 0.0
    use_all_rows(c.rows, state)
    if over.may_switch(groups):
        if c.made_for[0] == 0.0:
            _make_smooth(c.smooth, groups, dofs, state, t, beta, gamma)
            c.made_for[0] = beta
            c.made_for[1] = gamma
        _add_switching(c.smooth, c.factors.matrix, groups, dofs, state, t, beta, gamma)
    else:
        _make_smooth(c.factors.matrix, groups, dofs, state, t, beta, gamma)
    ask_as_before(c.rows, dofs, state)
    state.counters[FACTORISATIONS] += 1
    set_reference_frame(c.rows, state)
    row = factorise_apart(c.factors)
    if row == 0:
        c.factored_for[0] = beta
        c.factored_for[1] = gamma
    return row


@kernel
def _make_smooth(smooth, groups, dofs, state, t, beta, gamma):
    """Make the tangent of the groups that do not switch."""
    clear_as_filled(smooth)
    over.smooth_tangent(groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, smooth, dofs)
    have_cleared(smooth, smooth.band.shape[0])


@kernel
def _add_switching(smooth, matrix, groups, dofs, state, t, beta, gamma):
    """Make the whole tangent of that of the groups that do not switch."""
    copy_matrix(smooth, matrix)
    over.switching_tangent(groups, t, state.full_q, state.full_v, state.full_a, beta, gamma, 1.0, matrix, dofs)


@kernel
def _step(c, dofs, state, beta, gamma, fraction):
    """Solve for the increment and add it; returns the energy error of eq. 2.78."""
    first, last = solve_for_increment(c.rows, c.factors, c.increment, c.right_side)
    first = max(0, first)
    fastest = c.fastest[0] if last - first < state.q.size else 0.0
    product, most, fastest = advance_rows(
        c.rows, dofs, state, c.increment, c.right_side, first, last, (fraction, beta, gamma), fastest
    )
    state.counters[ROWS] += last - first
    c.fastest[0] = fastest
    c.rounded[0] = 1 if gamma * most <= ROUNDED * fastest else 0
    return np.sqrt(abs(product) / (fraction * c.unit))
