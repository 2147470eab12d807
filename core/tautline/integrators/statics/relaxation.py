"""Dynamic relaxation: damped motion with all that drives the scene held as it is at t = 0, until it is at rest.

It finds what the static solver cannot look for: the state that a scene with friction, contacts and slack ropes settles
in from where it begins. The damping is proportional to mass, eq. 2.168, with the force -alpha M v integrated exactly by
v <- v exp(-alpha h) after each step, so that every group and every method has it. alpha is twice the frequency of what
still moves, the critical damping of a mode of that frequency, estimated as in adaptive dynamic relaxation (Underwood
1983) by the Rayleigh quotient of the way gone and the force lost on it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, sqrt
from typing import Any, NamedTuple

import numpy as np

from tautline.integrators.linearise import evaluate
from tautline.integrators.state import WORST, State
from tautline.integrators.statics.equilibrium import NEAR_ROUNDING, levers, over_rounding, scales_at_rest, search_from
from tautline.integrators.statics.stability import ASIDE, DRAWN, Rest, Stability, count_negative, side_of
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.stepping import stepping_with
from tautline.integrators.time_loop import new_frames, run_steps
from tautline.integrators.vibration.critical_step import CriticalStep
from tautline.kernels.dofs import expand
from tautline.kernels.jit import entry
from tautline.kernels.matrix import Matrix, Rows, new_matrix, rows_of
from tautline.kernels.time_function import DEGREES, TimeFunctions, value_at
from tautline.system.memory import recall, remember
from tautline.system.system import System

MOST_STEPS = 200_000
"""Steps after which a scene that still moves is taken not to come to rest."""
BETWEEN = 20
"""Steps between two looks at the balance of forces, and of an explicit method between two dampings."""
STEPS_PER_RADIAN = 5.0
"""An implicit method takes steps up to this part of what still moves, or the scene's own step where that is longer."""

TOLERANCE = 1e-7
"""Largest inertia force over the scale of its row that counts as rest."""
NEXT, NEAR = 20, 1e-5
"""Iterations of Newton's method that takes away what is left out of balance, and the share of the extent of the scene
that it may move it."""
PUSHES = 4
"""How often a scene is pushed out of an unstable equilibrium: each may lead to another."""


class Relaxation(NamedTuple):
    """How it ended: steps taken, and the largest inertia force over its row's scale."""

    steps: int
    imbalance: float


def relax(
    system: System,
    state: State,
    method: Any,
    step: float,
    own: int = 0,
    tolerance: float = TOLERANCE,
    most: int = MOST_STEPS,
) -> Relaxation:
    """March the state to rest, and leave it there with no velocity.

    Parameters
    ----------
    system : System
    state : State
        Where it begins, and where it is left.
    method : NamedTuple
        Scratch of the method of the run; friction and contacts act as they do in it.
    step : float
        Step, s; an implicit method may take longer ones.
    own : int
        Numbers that the groups record.
    tolerance : float
        Largest inertia force over the scale of its row that counts as rest.
    most : int
        Steps after which to give up.

    Returns
    -------
    Relaxation

    Raises
    ------
    StoppedEarly
        NO_EQUILIBRIUM where the scene does not come to rest, or with the status of a step that failed.
    """
    still = replace(system, functions=_frozen(system))
    motion = _DampedMotion(
        still, state, method, step, new_frames(1, system.q.size, own), state.q[system.at_rest].copy(),
        explicit=stepping_with(method).explicit, h=step,
    )  # fmt: skip
    if motion.explicit:
        _check(still, state, step)
    mass = new_matrix(system.size, system.bandwidth, system.border)
    moves = _moves(system)
    scale = scales_at_rest(system, tolerance)
    last_q, last_a = state.q.copy(), np.zeros(system.size)
    size, worst = 0.0, 0
    for round_ in range(1, most // BETWEEN + 1):
        motion.take_steps()
        m = _mass(still, state, mass)
        force = np.abs(m @ (moves * state.a)) * moves / scale
        size, worst = float(force.max(initial=0.0)), int(force.argmax()) if force.size else 0
        if not np.isfinite(size):
            raise StoppedEarly(Status.NOT_FINITE, 0.0, system.names[worst], _during(system, Status.NOT_FINITE))
        if size <= tolerance:
            _settle(system, state)
            return Relaxation(BETWEEN * round_, size)
        square = _frequency(m, moves * (state.q - last_q), moves * (last_a - state.a)) if round_ > 1 else 0.0
        if square > 0.0:
            motion.damp_critically(square)
        last_q, last_a = state.q.copy(), state.a.copy()
    near = over_rounding(system, state, worst, size * float(scale[worst])) <= NEAR_ROUNDING
    detail = f"still moving after {most} steps of dynamic relaxation" + (f"; {system.softer}" if near else "")
    raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, system.names[worst], detail)


def _during(system: System, status: Status) -> str:
    """When a step of a relaxation failed, and what it may be; what such a step has left is not kept, so both are said.

    A number that overflows is no rounding.
    """
    if status is not Status.NOT_CONVERGED or not system.softer:
        return "during the relaxation"
    return f"during the relaxation; nothing holds a part of the scene, or {system.softer}"


@dataclass
class _DampedMotion:
    """Motion with damping in proportion to mass.

    Attributes
    ----------
    system : System
        With functions of time that stay what they are at t = 0.
    step : float
        Step of the run, s: no step is shorter.
    frames : tuple
        Of one frame: nothing of the motion is kept.
    held : array
        Value of each unknown that is at rest from the start, ``system.at_rest``.
    h, longest : float
        Step, s, and the longest that an implicit method may take.
    alpha : float
        Damping over mass, 1/s.
    """

    system: System
    state: State
    method: Any
    step: float
    frames: Any
    held: np.ndarray
    explicit: bool
    h: float
    longest: float = np.inf
    alpha: float = 0.0

    def take_steps(self) -> None:
        """Take `BETWEEN` steps; raises StoppedEarly for a step that fails and is no longer than the run's."""
        system, state = self.system, self.state
        # An explicit step is so short that many pass before the damping has to act again.
        together, times = (BETWEEN, 1) if self.explicit else (1, BETWEEN)
        for _ in range(times):
            part = np.array([together * self.h]), np.array([together])
            status, _, _ = run_steps(self.method, system, state, *part, 0.0, self.frames)
            if status != Status.DONE and self.h > self.step:
                # Too long a step: what it was grown by is taken back.
                self.h = self.longest = max(self.step, 0.25 * self.h)
                continue
            if status != Status.DONE:
                name = system.name_of(int(state.counters[WORST]))
                raise StoppedEarly(Status(status), 0.0, name, _during(system, Status(status)))
            state.q[system.at_rest] = self.held
            state.v[system.at_rest] = state.a[system.at_rest] = 0.0
            damp(system.dofs, state, exp(-self.alpha * together * self.h))

    def damp_critically(self, square: float) -> None:
        """Take the critical damping of a mode, by the square of its frequency, 1/s^2, and a step that follows it."""
        self.alpha = 2.0 * sqrt(square)
        if not self.explicit:
            following = max(self.step, 2.0 / (STEPS_PER_RADIAN * self.alpha))
            self.h = min(self.longest, 2.0 * self.h, following)


def relax_to_stable(system: System, state: State, method: Any, step: float, step_limit: float, own: int = 0) -> Rest:
    """Relax and balance, and from an unstable equilibrium push the scene aside and do so again.

    A scene that is drawn in perfect balance, such as a rope that stands on its end, has no force that moves it away.
    In a run the least disturbance would.

    Parameters
    ----------
    system, state, method, step, own
        As of :func:`relax`.
    step_limit : float
        Largest change of an unknown in a search for equilibrium, m; a push is a tenth of it.

    Returns
    -------
    Rest

    Raises
    ------
    StoppedEarly
        As :func:`relax`.
    """
    drawn, path = state.q.copy(), list[tuple[np.ndarray, Stability]]()
    relax(system, state, method, step, own)
    found = _judged(system, state, step_limit, drawn)
    while found.negative > 0 and len(path) < PUSHES:
        path.append((state.q.copy(), found))
        largest = float(np.abs(found.mode * levers(system)).max())
        state.q[:] += ASIDE * step_limit / largest * found.mode
        relax(system, state, method, step, own)
        found = _judged(system, state, step_limit, drawn)
    memory = remember((), system.groups, ())
    side = side_of(system, state, path) if path else DRAWN
    recall(memory, (), system.groups, ())
    return Rest(found, len(path), side)


def _judged(system: System, state: State, step_limit: float, drawn: np.ndarray) -> Stability:
    """Whether the balance next to where a scene has come to rest is stable; the scene is left in it.

    A relaxation leaves a small force in each row. Along a motion that nothing resists, such as the turn of a bow about
    the line between its ends, that force is the stiffness, of either sign, and another step leaves another one.
    Newton's method takes it away. Where it leads elsewhere, as it may with what is loose, the scene is judged as it is;
    and where there is friction the scene stays as it is, for that may bear what is left.
    """
    rest, memory, moves = state.q.copy(), remember((), system.groups, ()), _moves(system)
    extent = max(float(np.ptp(rest[moves > 0.0])) if moves.any() else 0.0, step_limit)
    way = np.inf
    if search_from(system, state, step_limit, 0.0, most=NEXT):
        way = float((moves * np.abs(state.q - rest) * levers(system)).max(initial=0.0))
    if not way <= NEAR * extent:
        state.q[:] = rest
    recall(memory, (), system.groups, ())
    found = count_negative(system, state, drawn)
    if system.has_friction:
        state.q[:] = rest
    recall(memory, (), system.groups, ())
    # All that goes with the unknowns is again that of where the scene is left.
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, system.spare_factors().matrix, np.zeros(system.size))
    return found


def _moves(system: System) -> np.ndarray:
    """One for each unknown that moves, and zero for multipliers, (n,)."""
    moves = np.ones(system.size)
    moves[system.algebraic] = 0.0
    return moves


def _frequency(mass: Rows, way: np.ndarray, lost: np.ndarray) -> float:
    """Square of the frequency of what still moves, 1/s^2, from the way gone and the acceleration lost on it."""
    weight = float(way @ (mass @ way))
    return float(way @ (mass @ lost)) / weight if weight > 0.0 else 0.0


@entry
def damp(dofs, state, factor):
    """Multiply every velocity that is an unknown."""
    for i in range(state.v.size):
        state.v[i] *= factor
    expand(dofs, state.v, state.full_v)


def _mass(system: System, state: State, matrix: Matrix) -> Rows:
    """Mass matrix (n, n) at the state; the state is left as it is."""
    keep = state.residual.copy()
    evaluate(system, state, 0.0, 0.0, False, 1.0, 0.0, 0.0, matrix, np.zeros(system.size))
    state.residual[:] = keep
    return rows_of(matrix)


def _check(system: System, state: State, step: float) -> None:
    critical, worst = CriticalStep(system).search(state, 0.0)
    if step > critical:
        detail = f"step {step:g} s, critical step {critical:.4g} s"
        raise StoppedEarly(Status.UNSTABLE, 0.0, system.names[worst], detail)


def _settle(system: System, state: State) -> None:
    """Leave the state at rest, with nothing in the books."""
    damp(system.dofs, state, 0.0)
    state.a.fill(0.0)
    state.auxiliary.fill(0.0)
    state.ledger.fill(0.0)
    state.counters.fill(0)


def _frozen(system: System) -> TimeFunctions:
    """Functions of time that stay what they are at t = 0; those of steady flow go on at their rate."""
    count = system.functions.track_from.size
    dofs, flowing = system.dofs, set(system.dofs.flowing.tolist())
    for i in system.dofs.flowing:
        masters = dofs.unknown[dofs.start[i] : dofs.start[i + 1]]
        flowing |= {int(-1 - k) for k in masters if k < 0}
    goes_on = {int(m) for i, m in zip(dofs.held, dofs.motion, strict=True) if int(i) in flowing}
    rows = np.zeros((count, DEGREES))
    for k in range(count):
        value, rate, _ = value_at(system.functions, k, 0.0)
        rows[k, :2] = value, rate if k in goes_on else 0.0
    each, none = np.arange(count), np.zeros(count, np.int64)
    return TimeFunctions(
        each, each + 1, np.zeros(count + 1, np.int64), np.empty(0), np.zeros(count), rows, none, none.copy(),
        np.empty((0, 5)), np.full(count, -1), np.full(count, -1), system.functions.frames, system.functions.sums,
        system.functions.lifts,
    )  # fmt: skip
