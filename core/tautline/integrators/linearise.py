"""The scene evaluated at a state from Python: residual and tangent in one compiled function.

The same function searches for rest. A scene takes seconds to compile, as much for a second function as for the first.
"""

from __future__ import annotations

import numpy as np

from tautline.integrators.newton_at_rest import LEFT, MORE, SHIFT, Search, iterate, no_search
from tautline.integrators.state import State
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand, expand_held, keep_flowing, prescribe, reduce
from tautline.kernels.jit import entry, kernel
from tautline.kernels.matrix import clear, dense, diagonal, factorise_matrix, new_matrix, solve_matrix
from tautline.system.system import System

SUMS = ("begin", "residual", "smooth_tangent", "switching_tangent")


def evaluate(system, state, t, h, at_rest, cm, cc, ck, matrix, residual, sums=SUMS):
    """Reduced residual ``residual`` (n,) and ``matrix`` = cm M + cc C + ck K at the state's position, at time t.

    ``at_rest`` leaves velocities and accelerations out, but for the rate of material that flows steadily, and groups
    begin with beta = -1; else velocities and accelerations are the state's. Every group begins an explicit step of
    ``h`` s, so that laws and arcs fit the state; with h = 0 a run under way is looked at and not touched, without
    accelerations but for those that are prescribed. ``sums`` may leave some out.
    """
    evaluate_groups(system.link(sums), system, state, t, h, at_rest, cm, cc, ck, matrix, residual)


def evaluate_groups(groups, system, state, t, h, at_rest, cm, cc, ck, matrix, residual):
    """The same of groups that are linked already, which need not be all of the system's."""
    scene = groups, system.dofs, system.functions, state
    system.lasting.call(evaluate_scene, scene, t, h, at_rest, cm, cc, ck, matrix, residual, NO_SEARCH)


def evaluate_damping(system, state, t, matrix):
    """``matrix`` = C at the state of a run under way, which is not touched, without what friction adds to it."""
    groups = system.link_without_friction(SUMS)
    none = np.zeros(system.size)
    evaluate_groups(groups, system, state, t, 0.0, False, 0.0, 1.0, 0.0, matrix, none)


def search_on(system: System, state: State, search: Search) -> int:
    """Let a search for rest make the iterations that are left to it; returns how it stands then."""
    scene = system.link(SUMS), system.dofs, system.functions, state
    none = np.zeros(system.size)
    more = 0.0, 1.0, True, 0.0, 0.0, 1.0, search.factors.matrix, none, search
    return int(system.lasting.call(evaluate_scene, scene, *more))


NO_SEARCH = no_search()
"""With which a scene is evaluated only."""


@kernel(forceinline=True)
def _evaluate(groups, dofs, functions, state, t, h, at_rest, cm, cc, ck, matrix, residual):
    """Residual and tangent of a scene."""
    prescribe(dofs, functions, t, state.full_q, state.full_v, state.full_a)
    expand(dofs, state.q, state.full_q)
    expand(dofs, state.v, state.full_v)
    if at_rest:
        keep_flowing(dofs, state.full_v, state.full_a)
    elif h > 0.0:
        expand(dofs, state.a, state.full_a)
    else:
        expand_held(dofs, state.full_a)
    if h > 0.0:
        over.begin(groups, t, h, -1.0 if at_rest else 0.0, -1.0, state.full_q, state.full_v, state.full_a)
    state.residual.fill(0.0)
    over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)
    reduce(dofs, state.residual, residual)
    clear(matrix)
    # As the corrector does: what it compiles serves here too.
    over.smooth_tangent(groups, t, state.full_q, state.full_v, state.full_a, cm, cc, ck, matrix, dofs)
    over.switching_tangent(groups, t, state.full_q, state.full_v, state.full_a, cm, cc, ck, matrix, dofs)
    expand(dofs, state.v, state.full_v)
    expand(dofs, state.a, state.full_a)
    prescribe(dofs, functions, t, state.full_q, state.full_v, state.full_a)


@entry
def evaluate_scene(groups, dofs, functions, state, t, h, at_rest, cm, cc, ck, matrix, residual, search):
    """The compiled part of :func:`evaluate`, and of :func:`search_on`: an evaluation is a search of no iterations."""
    for _ in range(max(1, search.counts[LEFT])):
        if search.counts[LEFT] > 0:
            cm = search.numbers[SHIFT]
        _evaluate(groups, dofs, functions, state, t, h, at_rest, cm, cc, ck, matrix, residual)
        if search.counts[LEFT] == 0:
            break
        stands = iterate(search, state.q, residual)
        if stands != MORE:
            return stands
    return MORE


def start_moving(system: System, state: State, step: float) -> None:
    """Give the state the velocities of t = 0 and the accelerations that balance the forces there: M a = F.

    ``step`` s is that of the run: a law may look ahead by it.

    Raises
    ------
    StoppedEarly
        SINGULAR, naming the unknown that has no mass.
    """
    n = system.size
    factors = system.spare_factors()
    state.v[:] = system.v[system.free]
    state.q[system.algebraic] = 0.0
    state.a[:] = 0.0
    acceleration = np.zeros(n)
    evaluate(system, state, 0.0, step, False, 1.0, 0.0, 0.0, factors.matrix, acceleration)
    state.inertia[:] = np.abs(diagonal(factors.matrix))
    state.inertia[system.algebraic] = 0.0
    row = factorise_matrix(factors)
    if row:
        raise StoppedEarly(Status.SINGULAR, 0.0, system.names[row - 1])
    solve_matrix(factors, acceleration)
    state.a[:] = -acceleration
    state.auxiliary[:] = state.a
    # With what is accelerated now: the forces that hold what is held have its inertia in them.
    evaluate(system, state, 0.0, step, False, 1.0, 0.0, 0.0, factors.matrix, acceleration)


def matrices(system: System, state: State, at_rest: bool = True) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, damping and stiffness matrices (n, n), dense, at a state: small vibrations about it.

    ``at_rest`` leaves the velocities out.
    """
    parts = []
    for part in np.eye(3):
        matrix = new_matrix(system.size, system.bandwidth, system.border)
        evaluate(system, state, 0.0, 1.0, at_rest, *part, matrix, np.zeros(system.size))
        parts.append(dense(matrix))
    return parts[0], parts[1], parts[2]
