"""Generalized-alpha: algorithm 1 of Arnold and Bruels (2007) for a variable mass, eqs 2.79-2.89."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from tautline.integrators.corrector.newton import DONE, SAME_STEP, Corrector, correct, corrector
from tautline.integrators.state import (
    STATE,
    STATES,
    WORST,
    book_losses,
    book_motion,
    book_work,
    keep,
    restore,
    stand_at,
    watch,
    work_of_means,
)
from tautline.integrators.status import Status
from tautline.integrators.stepping import Stepping, add
from tautline.kernels import groups as over
from tautline.kernels.changes import COUNT, EVER
from tautline.kernels.dofs import (
    AUXILIARY,
    BEFORE,
    BEGIN,
    DOFS,
    KNOWN,
    LAGGED,
    NUMBERS,
    SPEED,
    book_speeds,
    drop_inertia,
    ease,
    expand,
    expand_tied,
    prescribe_begun,
    prescribe_end,
    prescribe_lasting,
    prescribe_means,
    prescribe_push,
    work_of_easing,
    work_of_push,
)
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, gather, larger, largest, scatter, spread, total, where, within
from tautline.kernels.memory import form_of
from tautline.kernels.separate import separate
from tautline.kernels.time_function import FUNCTIONS
from tautline.kernels.vector import copy
from tautline.system.model import SolverSettings
from tautline.system.system import System

INACCURATE = int(Status.INACCURATE)
HALVINGS_OF_AUTO = 24
"""Times that a step may be halved at least where the longest is as long as an output interval."""
DEPTH = 3
"""Steps whose accelerations are kept: a parabola goes through that of the state and two before it."""
AT_ONCE = 1.0e-9
"""Length of a step, over that of the step under way, in which nothing but accelerations changes."""
START, END, BEGUN, BEHIND = range(4)
"""What is solved for in a step: accelerations at its start, its end, and accelerations there behind a push, as if what
is driven had those with which the step began, and with those with which it goes on."""
TWICE = 2
"""Solutions for accelerations behind a push: the force that holds what is driven is then that of those found."""
LONGER = 2.0
"""Times the last step by which a longer one carries the auxiliary acceleration's lead along. By the whole of a ratio of
4.5, of steps of 0.9 and 0.2 in turn, fast modes grow by 1.8 a pair with rho_inf 0. With 2 no sequence of steps from a
tenth to all of the nominal one grew, for rho_inf from 0 to 0.9; with 1.5 and 3 some did (products of eq. 2.86)."""
STILL = -1
"""Order of the prediction that nothing moves."""
DISTURBED = -2
"""Order before a step at whose start somebody has changed a force, a stiffness or a place: accelerations jump there."""
VECTOR = form_of(np.zeros(0))


class GeneralizedAlpha(NamedTuple):
    """Parameters of the method and its corrector; Newmark-beta is alpha_m = alpha_f = 0.

    ``algebraic`` lists the unknowns that are multipliers; ``power`` (2,) is scratch; ``last_step`` (1,) the length of
    the last accepted step, s, 0 before the first. ``tolerance`` m bounds the error of a step, 0 for no bound;
    ``length`` (n,) is what length a change of an unknown counts as; ``control`` (2,) keeps the last error and the part
    of the nominal step that is taken. ``history`` (3, n) are the accelerations at the start of the last steps: in row
    ``newest`` (1,) of the step under way, in the row before it (the last is before the first) of the one before, and so
    on; ``order`` (1,) is that of the polynomial that continues them best, `STILL` or `DISTURBED`. ``driven`` (15,
    n_full) is what is known of what follows functions, see `prescribe_end`;
    ``begun`` (n,) are accelerations behind a push with those of what is driven from before it, and ``forces`` (2,
    n_full) full residuals at the end of a step with a push, with its mean accelerations and those at its start.
    """

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    max_halvings: int
    corrector: Corrector
    power: np.ndarray
    last_step: np.ndarray
    algebraic: np.ndarray
    tolerance: float
    length: np.ndarray
    control: np.ndarray
    history: np.ndarray
    newest: np.ndarray
    order: np.ndarray
    driven: np.ndarray
    begun: np.ndarray
    forces: np.ndarray


def coefficients(alpha_m: float, alpha_f: float) -> tuple[float, float]:
    """beta and gamma of second-order accuracy, eqs 2.81-2.82."""
    gamma = 0.5 - alpha_m + alpha_f
    return 0.25 * (gamma + 0.5) ** 2, gamma


def energy_set_aside(beta: float, gamma: float, h: float, moving: float) -> float:
    """Energy, J, that the method sets aside for accelerations, of which ``moving`` is the sum m a^2.

    Newmark's method conserves or damps not the energy E of a linear system, but E + (beta - gamma / 2) h^2 a M a / 2
    (Hughes, The Finite Element Method, section 9.2). With generalized-alpha this sum swings within a period, and bounds
    E from the start on. What is set aside at the start, for what is let go there, is given to the motion in the first
    steps.
    """
    return 0.5 * max(0.0, beta - 0.5 * gamma) * h * h * moving


def alphas(rho_inf: float) -> tuple[float, float]:
    """alpha_m and alpha_f for a spectral radius rho_inf at infinite frequency, eqs 2.79-2.80."""
    return (2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)


@kernel
def _local_error(m, state, h):
    """Error of one step in position, m: (beta - 1/6) h^2 times the largest change of an acceleration."""
    worst, before = 0.0, m.history[m.newest[0]]
    for i in range(state.q.size):
        change = m.length[i] * abs(state.a[i] - before[i])
        if change > worst:
            worst = change
            state.counters[WORST] = i
    return abs(m.beta - 1.0 / 6.0) * h * h * worst


@kernel
def _predict(m, state, h, ratio):
    """Predict the end of a step of length h from its start, which is remembered, to go back to.

    The acceleration stays what it is, a_(t+1) = a_t in eq. 2.86, or becomes what the last few make likely: a polynomial
    through them, or what would have nothing move. Behind a change from outside it is what would have all
    keep its speed: a light node that was displaced has an acceleration that would throw it past its neighbours.
    """
    n, order = state.q.size, m.order[0]
    q0, v0, a0 = state.keep[0], state.keep[1], m.history[m.newest[0]]
    old, oldest = m.history[(m.newest[0] + 2) % DEPTH], m.history[(m.newest[0] + 1) % DEPTH]
    slope, bend = 1.0 if order > 0 else 0.0, 1.0 if order > 1 else 0.0
    alpha_m, beta, gamma = m.alpha_m, m.beta, m.gamma
    share = 1.0 / (1.0 - alpha_m)
    part = (1.0 - m.alpha_f) / (1.0 - alpha_m)
    # Products in the loop and no quotients, for which a processor takes ten times as long.
    drop, per_part, squared = 1.0 / h if order == STILL else 0.0, 1.0 / part, h * h
    for i in range(0, n, LANES):
        q, v, a = gather(state.q, i, n), gather(state.v, i, n), gather(state.a, i, n)
        last, new = _auxiliary(alpha_m, share, a, gather(state.auxiliary, i, n), ratio)
        if order < 0:
            stay = (-1.0 / beta) * (drop * v + (0.5 - beta) * last)
            rise = per_part * (stay - new)
        else:
            b = gather(old, i, n)
            rise = slope * (a - b) + bend * (a - 2.0 * b + gather(oldest, i, n))
        new += part * rise
        scatter(q0, i, n, q)
        scatter(v0, i, n, v)
        scatter(a0, i, n, a)
        scatter(state.q, i, n, q + h * v + squared * ((0.5 - beta) * last + beta * new))
        scatter(state.v, i, n, v + h * ((1.0 - gamma) * last + gamma * new))
        scatter(state.a, i, n, a + rise)


@kernel(forceinline=True)
def _auxiliary(alpha_m, share, a, auxiliary, ratio):
    """Auxiliary accelerations of eq. 2.86 at the start of a step, and at its end if the acceleration stays a.

    The first is that at t + (alpha_m - alpha_f) h: for a step ``ratio`` times as long as the last, at most `LONGER`, it
    is moved along.
    ``share`` is 1 / (1 - alpha_m): as long as arrays are written to, nobody else may find that it stays the same.
    """
    last = a + ratio * (auxiliary - a)
    return last, share * (a - alpha_m * last)


@separate(type(None), STATE, VECTOR, late=True)
def _go_back(state, a0):
    """Go back to the start of the step, at which accelerations were ``a0``."""
    for i in range(state.q.size):
        state.q[i], state.v[i], state.a[i] = state.keep[0, i], state.keep[1, i], a0[i]


@kernel
def _accept(m, state, h, ratio, jumped):
    """Close a step: the auxiliary acceleration, how the motion has oscillated, and how the next step predicts.

    What is smooth is continued by two orders more than the method's own prediction; what jumps or chatters is not, and
    no step in which a law has changed its status. Where a mode is far too fast for the step, its acceleration predicts
    a way that folds elements, and a folded element is in equilibrium too: better to predict that nothing moves.
    """
    n = state.q.size
    q0, v0, a0 = state.keep[0], state.keep[1], m.history[m.newest[0]]
    old, oldest = m.history[(m.newest[0] + 2) % DEPTH], m.history[(m.newest[0] + 1) % DEPTH]
    alpha_m, share = m.alpha_m, 1.0 / (1.0 - m.alpha_m)
    part = (1.0 - m.alpha_f) / (1.0 - alpha_m)
    moves = constants = lines = squares = speeds = turns = spread(0.0)
    for i in range(0, n, LANES):
        now, before = gather(state.a, i, n), gather(a0, i, n)
        change = now - before
        _, new = _auxiliary(alpha_m, share, before, gather(state.auxiliary, i, n), ratio)
        scatter(state.auxiliary, i, n, new + part * change)
        length, b = gather(m.length, i, n), gather(old, i, n)
        moves = larger(moves, length * abs(gather(state.q, i, n) - gather(q0, i, n)))
        constants = larger(constants, length * abs(change))
        line = now - 2.0 * before + b
        lines = larger(lines, length * abs(line))
        squares = larger(squares, length * abs(line - before + 2.0 * b - gather(oldest, i, n)))
        inertia = where(within(i, n), gather(state.inertia, i, n), 0.0)
        v1, v2 = gather(v0, i, n), gather(state.v, i, n)
        # The start counts as the end does, or what is let go would seem to begin without an acceleration.
        speeds += inertia * (v1 * v1 + v2 * v2)
        turns += inertia * (before * before + now * now)
    book_motion(state, h, total(speeds), total(turns))
    m.order[0] = _best_order(m, h, jumped, largest(moves), largest(constants), largest(lines), largest(squares))
    m.newest[0] = (m.newest[0] + 1) % DEPTH
    m.last_step[0] = h


@kernel
def _best_order(m, h, jumped, moved, constant, linear, square):
    """The order of polynomial that would have predicted the acceleration at the end of a step.

    ``moved`` is the largest way, m; ``constant``, ``linear`` and ``square`` are the largest errors of the polynomials
    of order 0 to 2, m/s^2.
    """
    reach = h * h * m.beta * (1.0 - m.alpha_f) / (1.0 - m.alpha_m)
    if moved < reach * constant and moved < reach * linear and moved < reach * square:
        return STILL
    if jumped:
        return 0
    if square < linear and square < constant:
        return 2
    return 1 if linear < constant else 0


@kernel
def _forget_what_is_held(dofs, state):
    """Take over accelerations that a law has set to zero, as it commits a step, of what it holds from now on.

    The method reaches the acceleration of what is held at once by an oscillation from step to step, of an amplitude
    that no shorter step makes smaller. It would go on for some steps in the force that holds, and decide what slips.
    """
    for k in range(dofs.number.size):
        i = dofs.number[k]
        if i >= 0 and state.full_a[k] == 0.0 and state.a[i] != 0.0:
            state.a[i] = 0.0
            state.auxiliary[i] = 0.0


@separate(type(None), STATE, late=True)
def _keep_start(state):
    """Remember the start of a step at which a mass or a speed jumps, as `_take_start` puts it back."""
    keep(state)


@separate(type(None), VECTOR, VECTOR, VECTOR, VECTOR, STATES, float, late=True)
def _take_settled(q, v, a, auxiliary, keep, ahead):
    """Begin the step with the accelerations that were found, as a run begins.

    Position and velocity, which the corrector has moved by next to nothing, are what they were. The auxiliary
    acceleration is that at another time: by the part ``ahead`` it stays as far away as it was before.
    """
    for i in range(q.size):
        q[i], v[i], auxiliary[i] = keep[0, i], keep[1, i], a[i] + ahead * (keep[3, i] - keep[2, i])


@separate(type(None), STATE, late=True)
def _take_start(state):
    """Go back to the start that was remembered."""
    restore(state)


@separate(type(None), VECTOR, VECTOR, VECTOR, float, late=True)
def _take_push(a, begun, auxiliary, rest):
    """Give the auxiliary accelerations behind a push what accelerations have jumped by: a - ``begun``.

    Eq. 2.86 has taken over the part 1 - ``rest`` of it, as of a change within the step. All else of the change of an
    acceleration is one, and is followed as in any step: so a motion whose steps are all pushed is damped as others are.
    """
    for i in range(a.size):
        auxiliary[i] += rest * (a[i] - begun[i])


@separate(type(None), DOFS, FUNCTIONS, STATE, STATES, float, late=True)
def _stand_as_before(dofs, functions, state, driven, t):
    """Write the state, which is that of the start t of a step, into the full vectors as they were."""
    stand_at(dofs, functions, state, t)
    for k in dofs.driven:
        i = dofs.held[k]
        # What was found with what lasts behind a bend is in balance with that alone.
        state.full_v[i], state.full_a[i] = driven[SPEED, i], driven[BEFORE, i]
    expand_tied(dofs, state.v, state.full_v)
    expand_tied(dofs, state.a, state.full_a)


@kernel(forceinline=True)
def _judge(m, groups, dofs, state, t, h):
    """Status of a step from t that has converged: whether it is as accurate as asked for, and the groups can go on."""
    if m.tolerance > 0.0:
        m.control[0] = _local_error(m, state, h)
        if m.control[0] > m.tolerance:
            return INACCURATE
    return watch(groups, dofs, state, t + h, m.corrector.changed)


@separate(type(None), NUMBERS, float, VECTOR, VECTOR, VECTOR, VECTOR, late=True)
def _take_means(algebraic, h, v, before, a, means):
    """Accelerations of the mean of a step of length h; multipliers are forces."""
    for i in range(v.size):
        means[i] = (v[i] - before[i]) / h
    for i in algebraic:
        means[i] = a[i]


@separate(type(None), NUMBERS, VECTOR, VECTOR, VECTOR, late=True)
def _take_begin(algebraic, begin, a, found):
    """Accelerations at the start of a step; multipliers are those at its end."""
    for i in range(a.size):
        found[i] = begin[i]
    for i in algebraic:
        found[i] = a[i]


MEAN, AT_START, WITHOUT = range(3)
"""Accelerations with which the residual at the end of a step with a push is asked for."""


@kernel
def _push(m, groups, dofs, state, t, h):
    """Work of what is driven in a step of length h with a push that ends at t, J."""
    for which in range(WITHOUT + 1):
        if which == MEAN:
            _take_means(m.algebraic, h, state.v, state.keep[1], state.a, m.begun)
            prescribe_means(dofs, h, m.driven, state.full_v, state.full_a)
            expand(dofs, m.begun, state.full_a)
        elif which == AT_START:
            _take_begin(m.algebraic, m.history[m.newest[0]], state.a, m.begun)
            for k in dofs.driven:
                state.full_a[dofs.held[k]] = m.driven[BEGIN, dofs.held[k]]
            expand(dofs, m.begun, state.full_a)
        else:
            drop_inertia(dofs, m.algebraic, state.a, state.full_a)
        state.residual.fill(0.0)
        over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)
        if which != WITHOUT:
            copy(state.residual, m.forces[which])
    return work_of_push(
        dofs, h, m.driven, state.full_q, state.full_v, m.forces, state.residual, state.entered, state.middle
    )  # fmt: skip


@kernel(forceinline=True)
def _open_step(m, groups, dofs, state, t, h, beta, gamma):
    """Begin a step: its length over that of the last one, and whether something jumps at its start."""
    over.begin(groups, t, h, beta, gamma, state.full_q, state.full_v, state.full_a)
    ratio = h / m.last_step[0] if m.last_step[0] > 0.0 else 1.0
    if abs(ratio - 1.0) > SAME_STEP:
        m.order[0] = min(m.order[0], 0)
    m.corrector.changed[COUNT] = 0
    over.jump(groups, m.corrector.changed)
    jumped = m.corrector.changed[COUNT] > 0 or m.order[0] == DISTURBED
    if jumped:
        _keep_start(state)
    for k in dofs.driven:
        i = dofs.held[k]
        a = state.full_a[i]
        m.driven[BEFORE, i] = m.driven[BEGIN, i] = m.driven[LAGGED, i] = a
        m.driven[SPEED, i] = state.full_v[i]
        if not jumped and m.last_step[0] > 0.0:
            m.driven[LAGGED, i] = a + min(ratio, LONGER) * (m.driven[AUXILIARY, i] - a)
    return ratio, jumped


@kernel(forceinline=True)
def _undo_step(m, dofs, functions, state, t, jumped):
    """Leave everything as it was at the start t of a step that failed."""
    if jumped:
        _take_start(state)
    else:
        _go_back(state, m.history[m.newest[0]])
    _stand_as_before(dofs, functions, state, m.driven, t)


@kernel(forceinline=True)
def _close_step(m, groups, dofs, state, t, h, ratio, bends, changes, switched, work):
    """Accept a step, and write its books.

    Where something has bent, ``changes`` says whether what is driven goes on with other accelerations than before, and
    ``work``, J, is that of what is driven.
    """
    for i in m.algebraic:
        state.q[i] = 0.0
        state.v[i] = 0.0
    _accept(m, state, h, ratio, bends or switched)
    if changes:
        _take_push(state.a, m.begun, state.auxiliary, (m.alpha_f - m.alpha_m) / (1.0 - m.alpha_m))
    if not bends:
        work = work_of_means(dofs, state)
    book_speeds(dofs, h, m.alpha_m, m.alpha_f, m.gamma, bends, m.driven, state.full_v, state.full_a)
    over.commit(groups, t + h, h, state.full_q, state.full_v, state.full_a)
    if over.may_switch(groups):
        _forget_what_is_held(dofs, state)
    book_losses(groups, state, t, h, m.power)
    book_work(groups, dofs, state, t + h, m.power, work)


@kernel(forceinline=True)
def generalized_alpha_step(method, groups, dofs, functions, state, t, h):
    """Advance the state from t by h; on failure it is left as it was. Returns a status.

    One corrector solves for accelerations at the start of the step where something jumps there, for its end, and for
    the accelerations there behind a push, where a function has bent in it.
    """
    m = method
    beta = (1.0 - m.alpha_m) / (m.beta * h * h * (1.0 - m.alpha_f))
    gamma = m.gamma / (m.beta * h)
    counted = m.gamma * (1.0 - m.alpha_f) / (1.0 - m.alpha_m)
    lagged = 1.0 - m.gamma / (1.0 - m.alpha_m)
    ratio, jumped = _open_step(m, groups, dofs, state, t, h, beta, gamma)
    carried = min(ratio, LONGER)
    stage, left = START if jumped else END, 1
    # Nobody knows the lead of an acceleration that has jumped, but behind a change from outside: it is that of before.
    ahead = 1.0 if m.order[0] == DISTURBED else 0.0
    work, asked, bends, changes, switched = 0.0, False, False, False, False
    while True:
        if stage == END:
            _predict(m, state, h, carried)
            equal, late = m.tolerance == 0.0, 0.5 - m.alpha_f
            bends = prescribe_end(
                dofs, functions, t + h, h, equal, ratio, late, m.driven, state.full_q, state.full_v, state.full_a
            )
            if bends and not asked:
                asked = True
                _go_back(state, m.history[m.newest[0]])
                _stand_as_before(dofs, functions, state, m.driven, t)
                if not ease(dofs, functions, t, h, m.driven, state.full_a):
                    continue
                if not jumped:
                    _keep_start(state)
                    ahead = 1.0
                jumped, stage, left = True, START, TWICE
            elif bends:
                prescribe_push(dofs, functions, t, h, lagged, counted, m.driven, state.full_a)
        end = t if stage == START else t + h
        shrunk = 1.0 if stage == END else 1.0 / AT_ONCE
        # Of a constraint that is kept but for the last digit of a place, nothing is to be closed at once: what is found
        # there are accelerations, and those agree with it as they did before.
        held = m.algebraic[: 0 if stage == END else m.algebraic.size]
        status = correct(m.corrector, groups, dofs, state, end, beta * shrunk * shrunk, gamma * shrunk, held)
        if status != DONE:
            break
        left -= 1
        if stage == START:
            _take_settled(state.q, state.v, state.a, state.auxiliary, state.keep, ahead)
            m.order[0] = min(m.order[0], 0)  # accelerations of before tell nothing of those to come
            if left == 0:
                if asked:
                    work = work_of_easing(
                        dofs, functions, t, h, state.residual, state.entered[1], state.middle[0]
                    )  # fmt: skip
                stage = END
                over.begin(groups, t, h, beta, gamma, state.full_q, state.full_v, state.full_a)
        elif stage == END:
            switched = m.corrector.changed[EVER] > 0
            status = _judge(m, groups, dofs, state, t, h)
            if status != DONE or not bends:
                break
            work += _push(m, groups, dofs, state, t + h, h)
            changes = prescribe_lasting(dofs, functions, t + h, h, m.driven, state.full_a)
            stage, left = BEHIND, TWICE
            if changes:
                prescribe_begun(dofs, m.driven, state.full_a)
                stage = BEGUN
        elif stage == BEGUN:
            copy(state.a, m.begun)
            prescribe_lasting(dofs, functions, t + h, h, m.driven, state.full_a)
            stage, left = BEHIND, TWICE
        elif left == 0:
            break
    if status != DONE:
        _undo_step(m, dofs, functions, state, t, jumped)
        return status
    _close_step(m, groups, dofs, state, t, h, carried, bends, changes, switched, work)
    return DONE


def amplification(m: GeneralizedAlpha, turn: float) -> complex:
    """The principal root of the amplification of (q, h v, h^2 a*), a* the auxiliary acceleration of eq. 2.86."""
    x = turn * turn
    inertia = 1.0 - m.alpha_m + x * (1.0 - m.alpha_f) * m.beta
    late = x * (1.0 - m.alpha_f)
    new = -np.array([x * m.alpha_f + late, late, m.alpha_m + late * (0.5 - m.beta)]) / inertia
    way = np.array([1.0, 1.0, 0.5 - m.beta]) + m.beta * new
    speed = np.array([0.0, 1.0, 1.0 - m.gamma]) + m.gamma * new
    roots = np.linalg.eigvals(np.array([way, speed, new]))
    turning = [complex(root) for root in roots if root.imag > 0.0]
    # Of a step longer than half a period no root is near: the pair that turns is the principal one.
    return max(turning, key=abs, default=-1.0 + 0.0j) if turning else complex(max(roots, key=abs))


def generalized_alpha(system: System, settings: SolverSettings) -> GeneralizedAlpha:
    """Generalized-alpha with the parameters of the settings."""
    return _implicit(system, settings, settings.alpha_m, settings.alpha_f)


def newmark(system: System, settings: SolverSettings) -> GeneralizedAlpha:
    """Newmark-beta, the average acceleration: generalized-alpha with alpha_m = alpha_f = 0, eqs 2.65-2.70."""
    return _implicit(system, settings, 0.0, 0.0)


def _implicit(system: System, settings: SolverSettings, alpha_m: float, alpha_f: float) -> GeneralizedAlpha:
    beta, gamma = coefficients(alpha_m, alpha_f)
    halvings = max(settings.max_halvings, HALVINGS_OF_AUTO) if settings.automatic else settings.max_halvings
    by_energy = settings.criterion == "energy"
    iteration = corrector(
        system,
        settings.tolerance,
        by_energy,
        settings.max_iterations,
        settings.energy_unit,
        settings.contraction,
        full=settings.newton == "full",
    )
    # A row's moment over the force that counts as large is the length by which its unknown counts.
    length = system.scale / (system.force or system.scale.max(initial=1.0))
    length[system.algebraic] = 0.0
    return GeneralizedAlpha(
        alpha_m=alpha_m,
        alpha_f=alpha_f,
        beta=beta,
        gamma=gamma,
        max_halvings=halvings,
        corrector=iteration,
        power=np.zeros(2),
        last_step=np.zeros(1),
        algebraic=system.algebraic,
        tolerance=settings.step_error,
        length=length,
        control=np.array([0.0, 1.0]),
        history=np.zeros((DEPTH, system.size)),
        newest=np.zeros(1, np.int64),
        order=np.zeros(1, np.int64),
        driven=np.zeros((KNOWN, system.q.size)),
        begun=np.zeros(system.size),
        forces=np.zeros((2, system.q.size)),
    )


def _sums(method: GeneralizedAlpha) -> tuple[str, ...]:
    return ("jump", "switch", "kink", "smooth_tangent", "switching_tangent")


def _set_aside(method: GeneralizedAlpha, h: float, moving: float) -> float:
    return energy_set_aside(method.beta, method.gamma, h, moving)


def _disturb(method: GeneralizedAlpha) -> None:
    method.order[0] = DISTURBED


GENERALIZED_ALPHA = add(
    Stepping(
        GeneralizedAlpha, generalized_alpha, generalized_alpha_step, False, _sums, amplification, _set_aside, _disturb
    )
)
NEWMARK = replace(GENERALIZED_ALPHA, make=newmark)
