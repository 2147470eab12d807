"""The longest step that an explicit method can take, from the fastest modes of small vibrations about a state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.linearise import evaluate, evaluate_damping
from tautline.integrators.state import State
from tautline.kernels.bound import Lasting
from tautline.kernels.matrix import Rows, factorise_matrix, new_factors, new_matrix, rows_of, solve_matrix
from tautline.scene.methods import RK4, Method
from tautline.system.system import System


def critical_step(stiffness: float, damping: float, method: Method = RK4) -> float:
    """Critical step of an explicit method, s, for x.. + damping x. + stiffness x = 0.

    On the imaginary axis RK4 is stable up to 2.8 / omega (eq. 2.137); the roots of a damped mode leave the axis, and
    beyond critical damping the faster of them, at about -damping, has the limit 2.785 / damping.
    """
    roots = np.roots([1.0, max(damping, 0.0), max(stiffness, 0.0)])
    steps = [method.reach(round(float(abs(np.angle(x))), 3)) / abs(x) for x in roots if x != 0.0]
    return float(min(steps, default=np.inf))


class Mode(NamedTuple):
    """The mode that sets a critical step, s: ``stiffness`` omega^2, 1/s^2, ``damping`` 1/s, ``shape`` (n,)."""

    step: float
    stiffness: float
    damping: float
    shape: np.ndarray

    @property
    def omega(self) -> float:
        """Angular frequency without damping, rad/s; of a mode that is all damping, the rate at which it dies, 1/s."""
        return float(np.sqrt(max(self.stiffness, 0.0))) if self.stiffness > 0.0 else self.damping


class CriticalStep:
    """The critical step of a system with an explicit method, looked for again and again along a run.

    The modes that may set it are the stiffest, of M^-1 K, and the most damped, of M^-1 C: both by power iteration, from
    where the last search ended with a little of every other, the same in each search. Friction does not count as
    damping: it is bounded, however steep it is where it turns.

    Attributes
    ----------
    modes : (2, n) array
        Where the last search ended: all that the next one remembers.
    mode : Mode
        The mode that sets the step.
    """

    FEWEST, MOST = 6, 60
    """Iterations of a search."""
    SETTLED = 1.0e-3
    """Relative change of a quotient in one iteration that ends a search."""

    def __init__(self, system: System, method: Method = RK4) -> None:
        size = system.size, system.bandwidth, system.border
        self.method = method
        self.system = system
        self._stiffness, self._damping, self._mass = new_matrix(*size), new_matrix(*size), new_factors(*size)
        every = np.random.default_rng(1).standard_normal((2, system.size))
        self._every = 0.1 * every / np.maximum(np.linalg.norm(every, axis=1, keepdims=True), 1e-300)
        self.modes = np.zeros((2, system.size))
        self._inertia = rows_of(self._mass.matrix)
        self._calls = Lasting()
        self.mode = Mode(np.inf, 0.0, 0.0, np.zeros(system.size))

    def search(self, state: State, t: float) -> tuple[float, int]:
        """Critical step, s, at a state, infinite where nothing vibrates, and the unknown that has most of the mode."""
        keep, residual = state.residual.copy(), np.zeros(self.system.size)
        parts = ((self._stiffness, (0.0, 0.0, 1.0)), (self._damping, (0.0, 1.0, 0.0)))
        for matrix, part in (*parts, (self._mass.matrix, (1.0, 0.0, 0.0))):
            if matrix is self._damping:
                evaluate_damping(self.system, state, t, matrix)
            else:
                evaluate(self.system, state, t, 0.0, False, *part, matrix, residual)
        state.residual[:] = keep
        mass = self._inertia = rows_of(self._mass.matrix)
        if self.system.size == 0 or factorise_matrix(self._mass):
            return np.inf, 0
        k, c = rows_of(self._stiffness), rows_of(self._damping)
        self.mode = Mode(np.inf, 0.0, 0.0, np.zeros(self.system.size))
        for which, matrix in enumerate((k, c)):
            x = self._fastest(matrix, which) if not matrix.vanishes else None
            if x is not None:
                inertia = abs(float(x @ (mass @ x))) or 1.0
                stiffness, damping = float(x @ (k @ x)) / inertia, float(x @ (c @ x)) / inertia
                step = critical_step(stiffness, damping, self.method)
                if step < self.mode.step:
                    self.mode = Mode(step, stiffness, damping, x)
        return self.mode.step, int(np.abs(self.mode.shape).argmax()) if np.isfinite(self.mode.step) else 0

    def momentum(self) -> np.ndarray:
        """M x of the mode x of the last search, (n,): its product with velocities is how much of the mode moves."""
        return self._inertia @ self.mode.shape

    def _fastest(self, matrix: Rows, which: int) -> np.ndarray | None:
        """The vector that M^-1 times a matrix stretches most; None where it stretches none."""
        x = self._every[which] + self.modes[which]
        last, known = 0.0, bool(self.modes[which].any())
        for iteration in range(self.MOST):
            y = matrix @ x
            self._calls.call(solve_matrix, (self._mass,), y)
            size = float(np.linalg.norm(y))
            if size == 0.0 or not np.isfinite(size):
                return None
            quotient = float(x @ y) / float(x @ x)
            x = y / size
            if known and iteration >= self.FEWEST and abs(quotient - last) < self.SETTLED * abs(quotient):
                break
            last = quotient
        self.modes[which] = x
        return x
