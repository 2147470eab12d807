"""A look at a state between two calls of the time loop, and the books of a change that was made there from outside."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tautline.integrators.state import POWER, THROUGHPUT, WORK, State
from tautline.integrators.stepping import stepping_with
from tautline.integrators.time_loop import frames_of, loop_of, record_frame
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand_now
from tautline.kernels.jit import entry, in_python
from tautline.live.errors import SimulationError
from tautline.results.resumption import TORN
from tautline.system.memory import arrays_of
from tautline.system.system import System

VECTORS = ("q", "v")
"""What may be displaced: positions, velocities."""
CLOSED = 1.0e-6
"""Share of the largest gap that was opened up to which it is closed again."""


class Look(NamedTuple):
    """What was seen: the frame; the forces (n_full,) with the accelerations of the last step; power supplied, W."""

    row: np.ndarray
    residual: np.ndarray
    power: float

    @property
    def energy(self) -> float:
        """Kinetic, strain and potential energy, J."""
        return float(frames_of(self.row[None], self.residual.size).energy[0, :3].sum())


@entry
def _look(groups, dofs, state, t, residual, power, row, at):
    over.residual(groups, t, state.full_q, state.full_v, state.full_a, residual)
    over.commit(groups, t, 0.0, state.full_q, state.full_v, state.full_a)
    over.supply(groups, t, state.full_q, state.full_v, power)
    record_frame(groups, dofs, state, t, row, at)


def look_at(method: Any, system: System, state: State, t: float, width: int) -> Look:
    """Evaluate a state as it is, and put the groups back: the run goes on as if nobody had looked.

    What groups record of their last evaluation, such as the tension at a rope's ends, is then of this state and not of
    that of the last step. ``width`` is that of a frame.
    """
    kept = [(array, array.copy()) for _, array in arrays_of(system.groups, "groups")]
    row, residual, power = np.zeros(width), np.zeros(state.full_q.size), np.zeros(2)
    linked = system.link(loop_of(method)[1])
    _look(linked, system.dofs, state, t, residual, power, row, np.zeros(2, np.int64))
    for array, before in kept:
        array[...] = before
    system.functions.frames.time[0] = np.nan
    return Look(row, residual, float(power.sum()))


def disturb(method: Any) -> None:
    """Let a method find its accelerations anew: those that it has are in balance with what was before a change."""
    stepping_with(method).disturb(method)


def book_change(method: Any, state: State, before: Look, after: Look) -> None:
    """Book what a change from outside has put in, and have the next step begin behind the change.

    The way of a blow is no motion through dampers. The work of a step is a mean of forces and powers at both ends: an
    explicit method enters these anew where its step begins, others have entered them at the end of the last one.
    """
    work = after.energy - before.energy
    state.ledger[WORK] += work
    state.ledger[THROUGHPUT] += abs(work)
    state.passed[:] = state.full_q
    more = after.residual - before.residual
    if more.any():
        disturb(method)
    if not stepping_with(method).explicit:
        state.entered[1] += np.where(np.isfinite(more), more, 0.0)
        state.ledger[POWER] += after.power - before.power


class Ties:
    """Whether displacements have taken apart what multipliers tie.

    A coupling by multipliers is an equation of the state. From a state that does not satisfy it a step would close the
    gap at once, by a speed of the gap over the step.
    """

    def __init__(self) -> None:
        self._gaps = np.zeros((2, 2, 0))  # of positions and velocities: what is open, and the most that was opened

    def memory(self) -> tuple[float, ...]:
        """Numbers with which `recall` knows what is open."""
        return tuple(self._gaps.ravel().tolist())

    def recall(self, memory: tuple[float, ...]) -> None:
        """Know what is open from what `memory` gave."""
        self._gaps = np.reshape(memory, (2, 2, -1)) if memory else np.zeros((2, 2, 0))

    def displace(
        self, vector: str, places: np.ndarray, unknowns: np.ndarray, more: np.ndarray, system: System, q: np.ndarray
    ) -> None:
        """Take note of what a displacement of positions, or of velocities, is going to open, or to close again."""
        if not system.algebraic.size:
            return
        reduced, moved, opened = np.zeros(system.size), np.zeros(system.q.size), np.zeros(system.q.size)
        reduced[unknowns] += more
        moved[places] += more
        expand_now(system.dofs, reduced, moved)
        # The equations are linear in what moves: positions open them as velocities do. The residual would not say it:
        # an explicit step, and one that has not begun, write the rows of multipliers by accelerations.
        with in_python():
            over.violation(system.groups, 1, q, moved, opened)
        opened = opened[system.free[system.algebraic]]
        if self._gaps.size == 0:
            self._gaps = np.zeros((2, 2, opened.size))
        sums, largest = self._gaps[VECTORS.index(vector)]
        sums += opened
        np.maximum(largest, np.abs(opened), out=largest)

    def torn(self, system: System) -> str:
        """What is apart, in words; empty where nothing is."""
        for vector, (opened, largest) in zip(VECTORS, self._gaps, strict=True):
            apart = np.abs(opened) > CLOSED * largest
            if apart.any():
                name = system.names[system.algebraic[int(np.argmax(apart))]]
                what = "moves with" if vector == "v" else "stands at"
                return f"what was displaced no longer {what} what it is tied to, by the {name}"
        return ""

    def attribute(self, system: System) -> dict[str, str]:
        """What a result says of it, for who would go on from there; nothing where nothing is apart."""
        return {TORN: torn} if (torn := self.torn(system)) else {}

    def check(self, system: System) -> None:
        """Raise SimulationError where something is apart."""
        if cause := self.torn(system):
            raise SimulationError(cause, "displace what it is tied to by the same, or restore a saved state")
        self.recall(())
