"""The time loop: compiled, through as many output frames as it is given, with nothing allocated inside."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from tautline.integrators.corrector.newton import ASTRAY, DONE, NOT_FINITE
from tautline.integrators.explicit import accelerate, account, is_finite
from tautline.integrators.linearise import NO_SEARCH, SUMS, evaluate_scene
from tautline.integrators.newton_at_rest import iterate
from tautline.integrators.state import (
    DISSIPATED,
    FACTORISATIONS,
    HALVINGS,
    ITERATIONS,
    STEPS,
    WORK,
    book_energy,
    open_ledger,
    stand_at,
)
from tautline.integrators.stepping import stepping_with, take_step
from tautline.kernels import groups as over
from tautline.kernels import matrix, time_function
from tautline.kernels.dofs import expand, expand_held
from tautline.kernels.groups import hook_jobs
from tautline.kernels.jit import entry, kernel
from tautline.kernels.machine.settings import UNCOMPILED
from tautline.kernels.matrix import Factors, factorise_matrix, new_factors, new_matrix, solve_matrix
from tautline.kernels.memory import form_of
from tautline.kernels.parallel_compile import compile_all
from tautline.kernels.separate import code_of

ENERGIES = 5
"""Numbers of a frame that are energies."""
WORK_LIMIT, STEP, PART = range(3)
"""Places in ``pause``, see :func:`new_pause`."""
NO_LIMIT = int(np.iinfo(np.int64).max)
"""Work that no run does."""
PAUSED = -1
"""In place of a status: the loop goes back to Python in the middle of a frame, and can be called again."""


class Frames(NamedTuple):
    """What the loop leaves behind at each output time, one row a frame, cut out of ``rows`` (m, width).

    Time (m,); full position, velocity, acceleration and residual (m, n_full); kinetic, strain and potential energy,
    work and dissipation (m, 5) J; the groups' own numbers (m, k).
    """

    rows: np.ndarray
    time: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    residual: np.ndarray
    energy: np.ndarray
    own: np.ndarray


def new_frames(rows: int, full: int, own: int) -> Frames:
    """Room for a number of frames."""
    return frames_of(np.zeros((rows, 1 + 4 * full + ENERGIES + own)), full)


def frames_of(rows: np.ndarray, full: int) -> Frames:
    """Name the parts of frames (m, width)."""
    cuts = 1 + full * np.arange(5)
    parts = [rows[:, cuts[k] : cuts[k + 1]] for k in range(4)]
    return Frames(rows, rows[:, 0], *parts, rows[:, cuts[4] : cuts[4] + ENERGIES], rows[:, cuts[4] + ENERGIES :])


def new_pause() -> np.ndarray:
    """Where the loop stands between two calls (3,) int, at the start of a frame and without a limit.

    The work (:func:`work_done`) at which it goes back to Python before the next part of a step, whether a frame is full
    or not; the steps of the frame under way that are done; and of the step under way the parts of the finest size.
    """
    return np.array([NO_LIMIT, 0, 0])


@kernel(forceinline=True)
def work_done(counters):
    """Steps, iterations and factorisations of a run so far: what its time goes into, whatever its steps do."""
    return counters[STEPS] + counters[ITERATIONS] + counters[FACTORISATIONS]


@kernel
def record_frame(groups, dofs, state, t, row, at):
    """Write one frame into its row; ``at`` is scratch for the groups' own numbers."""
    n = state.full_q.size
    row[0] = t
    for i in range(n):
        row[1 + i] = state.full_q[i]
        row[1 + n + i] = state.full_v[i]
        row[1 + 2 * n + i] = state.full_a[i]
        row[1 + 3 * n + i] = state.residual[i]
    energy = row[1 + 4 * n : 1 + 4 * n + ENERGIES]
    book_energy(groups, dofs, state, t, energy)
    energy[3] = state.ledger[WORK]
    energy[4] = state.ledger[DISSIPATED]
    at[0] = 1 + 4 * n + ENERGIES
    over.record(groups, row, at)


@entry
def _record_now(groups, dofs, state, t, row, at):
    record_frame(groups, dofs, state, t, row, at)


def record_now(method, system, state, t, row):
    """Write the frame of a state as it is into a row, between two calls of the loop."""
    _record_now(system.link(loop_of(method)[1]), system.dofs, state, t, row, np.zeros(2, np.int64))


@kernel(forceinline=True)
def open_run(groups, dofs, state, t, power):
    """Settle the laws at the start and open the ledger."""
    over.commit(groups, t, 0.0, state.full_q, state.full_v, state.full_a)
    open_ledger(groups, dofs, state, t, power)


ASIDE = 1.0e-6
"""Share of a step by which an instant lies off the end of a frame, at least, for a step to end there."""
ROUNDING = 1.0e-9
"""Share of a step that no further step is made for."""


@kernel(forceinline=True)
def steps_to_instant(groups, begin, end, longest, next):
    """Where equal steps from ``begin`` lead without a jump within any: to ``end``, s, the end of a frame, or before.

    Returns that time, how many steps there are, none longer than ``longest`` s, and their length, s. ``next`` (1,) is
    scratch.
    """
    next[0] = end
    over.instant(groups, begin + ASIDE * longest, next)
    until = next[0] if next[0] < end - ASIDE * longest else end
    steps = max(1, int(np.ceil((until - begin) / longest * (1.0 - ROUNDING))))
    return until, steps, (until - begin) / steps


DOUBLED_BELOW = 1.0 / 12.0
"""Share of the tolerance below which a step's error lets the next be twice as long: the error grows by about eight."""


@kernel(forceinline=True)
def divide_and_advance(method, groups, dofs, functions, state, t, h, pause):
    """One implicit step of length h, in halves, quarters, ... where it is not solved or not accurate.

    Returns a status, or PAUSED; ``pause`` then says which parts were accepted, and so it does of a step that fails. The
    next step goes on in parts of the size that this one ended with, or twice that: a step much longer than the last
    would carry what is left of a disturbance too far.
    """
    finest = 1 << method.max_halvings
    controlled = method.tolerance > 0.0
    size = max(1, int(method.control[1] * finest))
    at = pause[PART]
    pause[PART] = 0
    while at < finest:
        if work_done(state.counters) >= pause[WORK_LIMIT]:
            pause[PART] = at
            method.control[1] = size / finest
            return PAUSED
        # The last attempt is let run.
        method.corrector.astray[0] = ASTRAY if size > 1 else np.inf
        status = take_step(method, groups, dofs, functions, state, t + h * (at / finest), h * (size / finest))
        if status == DONE:
            state.counters[STEPS] += 1
            at += size
            may_grow = not controlled or method.control[0] < DOUBLED_BELOW * method.tolerance
            if size < finest and at % (2 * size) == 0 and may_grow:
                size *= 2
        elif size == 1:
            pause[PART] = at
            return status
        else:
            size //= 2
            state.counters[HALVINGS] += 1
    method.control[1] = size / finest
    return DONE


@entry
def run_implicit(method, groups, dofs, functions, state, ends, steps, begin, rows, pause):
    """Go through output frames with an implicit method; see :func:`run_steps`."""
    t0 = begin
    at = method.corrector.changed
    for k in range(ends.size):
        if steps[k] == 0:
            open_run(groups, dofs, state, t0, method.power)
        longest = (ends[k] - t0) / max(steps[k], 1)
        done, before = pause[STEP], 0
        pause[STEP] = 0
        while t0 < ends[k]:
            until, count, h = steps_to_instant(groups, t0, ends[k], longest, method.power)
            for step in range(max(done - before, 0), count):
                status = divide_and_advance(method, groups, dofs, functions, state, t0 + step * h, h, pause)
                if status != DONE:
                    # The state is that of the parts that were accepted, and so is the time.
                    reached = t0 + step * h + h * (pause[PART] / (1 << method.max_halvings))
                    if status == PAUSED:
                        pause[STEP] = before + step
                        return DONE, k, reached
                    pause[PART] = 0
                    return status, k, reached
            before += count
            t0 = until
        record_frame(groups, dofs, state, ends[k], rows[k], at)
    return DONE, ends.size, t0


@entry
def run_explicit(method, groups, dofs, functions, state, ends, steps, begin, rows, pause):
    """Go through output frames with an explicit method; see :func:`run_steps`.

    Such a method knows acceleration and reactions at the start of its steps only: they are made anew for a frame.
    """
    t0 = begin
    for k in range(ends.size):
        if steps[k] == 0:
            open_run(groups, dofs, state, t0, method.power)
        longest = (ends[k] - t0) / max(steps[k], 1)
        done, before = pause[STEP], 0
        pause[STEP] = 0
        while t0 < ends[k]:
            until, count, h = steps_to_instant(groups, t0, ends[k], longest, method.power)
            for step in range(max(done - before, 0), count):
                if work_done(state.counters) >= pause[WORK_LIMIT]:
                    pause[STEP] = before + step
                    return DONE, k, t0 + step * h
                status = take_step(method, groups, dofs, functions, state, t0 + step * h, h)
                if status != DONE:
                    stand_at(dofs, functions, state, t0 + step * h)
                    return status, k, t0 + step * h
                state.counters[STEPS] += 1
            before += count
            t0 = until
        expand_held(dofs, state.full_a)
        status = accelerate(method, groups, dofs, ends[k], state)
        if status == DONE and not is_finite(state.a):
            status = NOT_FINITE
        if status != DONE:
            return status, k, ends[k]
        expand(dofs, state.a, state.full_a)
        account(method, groups, dofs, ends[k], state)
        record_frame(groups, dofs, state, ends[k], rows[k], method.at)
    return DONE, ends.size, t0


_ALWAYS = ("begin", "instant", "alarm", "commit", "record", "energy", "dissipation", "supply", "residual")
"""Sums over groups that every method asks for."""


def loop_of(method):
    """The compiled loop for a method's scratch, and the sums that it asks of the groups."""
    stepping = stepping_with(method)
    return run_explicit if stepping.explicit else run_implicit, (*_ALWAYS, *stepping.sums(method))


def _factors_in(scratch: Any) -> Iterator[Factors]:
    """The factors that a method's scratch holds."""
    if isinstance(scratch, Factors):
        yield scratch
    elif isinstance(scratch, tuple):
        for part in scratch:
            yield from _factors_in(part)


_ready: set[Any] = set()
"""What runs were made of that were compiled for in this process: sums over groups, and forms."""


def compile_for(method, system, state, announce=None, at_rest=False):
    """Compile what a run will need, or load it, with the processors there are; see :func:`compile_all`.

    ``at_rest`` says that it begins at rest, which is searched for; whether it stays there the signs of pivots tell, of
    factors by rows.
    """
    if UNCOMPILED:
        return
    loop, sums = loop_of(method)
    made_of = sums, at_rest, form_of((method, system.groups, system.dofs, system.functions, state))
    if made_of in _ready:
        return
    groups, scene = np.zeros(0, np.int64), (system.dofs, system.functions, state)
    none, rows = np.zeros(0), np.zeros((0, 0))
    factors = new_factors(0, 0)
    calls = [
        (loop, (method, groups, *scene, none, groups, 0.0, rows, groups)),
        (evaluate_scene, (groups, *scene, 0.0, 0.0, False, 0.0, 0.0, 0.0, new_matrix(0, 0), none, NO_SEARCH)),
        (solve_matrix, (factors, none)),
        (factorise_matrix, (factors,)),
    ]
    heavy, common, *parts = ((function, tuple(map(form_of, given))) for function, given in calls)
    hooks = hook_jobs(system.groups, *dict.fromkeys((*sums, *SUMS)))
    # The loop, which is heaviest, takes in the last two: it is begun when others have made them. Functions of time are
    # called by it, and have to be there before it can be.
    solved = [*_factors_in(method), *([new_factors(0, 0, threshold=0.0)] if at_rest else [])]
    late = dict.fromkeys(code for each in solved for code in matrix.code_for(each))
    if at_rest:
        late[code_of(iterate)] = None
    compile_all([*time_function.code_for(system.functions), heavy, common, *hooks, *late, *parts], announce)
    _ready.add(made_of)


def run_steps(method, system, state, ends, steps, begin, frames, pause=None):
    """Go through output frames and record each, in compiled code.

    Parameters
    ----------
    method : NamedTuple
        Scratch of a method.
    system : System
    state : State
        At time ``begin``.
    ends : (m,) array
        Time of each frame, s.
    steps : (m,) int array
        Steps up to it from the frame before; 0 for the frame that opens the run.
    begin : float
        Time of the frame before the first, s.
    frames : Frames
        Filled row by row from the first.
    pause : (3,) int array, optional
        From :func:`new_pause`, with a limit of work; it keeps what is needed to go on. The results are the same to the
        bit wherever a run is paused.

    Returns
    -------
    (int, int, float)
        Status, frames filled, time reached. Fewer frames than were asked for, with DONE, are those of a run that was
        paused: the next call has to begin with the frame under way.
    """
    loop, sums = loop_of(method)
    groups, pause = system.link(sums), new_pause() if pause is None else pause
    scene = method, groups, system.dofs, system.functions, state
    return system.lasting.call(loop, scene, ends, steps, begin, frames.rows, pause)
