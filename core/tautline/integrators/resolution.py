"""Whether the steps of a run can follow the motion that it shows: ten to a period make a decent picture of it."""

from __future__ import annotations

import numpy as np

from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.kernels.matrix import new_matrix, sparse
from tautline.system.system import System

STEPS_PER_PERIOD = 10.0
"""Steps that a decent picture of an oscillation takes (thesis section 2.5)."""


class Resolution:
    """How fast the motion of a run turns over: the root of the mean of a.M a over that of v.M v.

    For a vibration that is its angular frequency; of several each counts by its kinetic energy, those that a step
    cannot follow all the more. What moves at a steady speed turns over never.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self._matrix = new_matrix(system.size, system.bandwidth, system.border)
        self._residual = np.zeros(system.size)
        self._moved = self._turned = 0.0

    def add(self, state: State, t: float, v: np.ndarray, a: np.ndarray) -> None:
        """Take note of frames: full velocities and accelerations (m, n_full), with the mass of the state at time t."""
        if self.system.size == 0:
            return
        keep = state.residual.copy()
        evaluate(self.system, state, t, 0.0, False, 1.0, 0.0, 0.0, self._matrix, self._residual)
        state.residual[:] = keep
        mass = sparse(self._matrix)
        free = self.system.free
        moved, turned = (rows[:, free] for rows in (v, a))
        turned[:, self.system.algebraic] = 0.0
        self._moved += float(np.sum(moved * (mass @ moved.T).T))
        self._turned += float(np.sum(turned * (mass @ turned.T).T))

    @property
    def frequency(self) -> float:
        """Angular frequency, rad/s; 0 where nothing has moved."""
        if not (self._moved > 0.0 and np.isfinite(self._turned)):
            return 0.0
        return float(np.sqrt(max(self._turned, 0.0) / self._moved))
