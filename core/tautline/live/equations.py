"""The equations of motion of a simulation, for integrators of others: ``M(q) a = F(t, q, v)``, r = M a - F."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from tautline.integrators.equations import SUMS, evaluate_at, evaluate_mass
from tautline.integrators.state import State
from tautline.kernels.bound import Lasting
from tautline.kernels.groups import has_constant_mass, hold_laws, link
from tautline.kernels.matrix import factorise_matrix, new_factors, new_matrix, solve_matrix, sparse
from tautline.live.errors import SimulationError, plain_numbers, real
from tautline.live.forces import Force, Group, calls_of, room_for_all
from tautline.system.model import Model

INSTANT = 1.0e-6
"""Length of the step that groups begin where they are evaluated, over that of the scene."""


class Equations:
    """What `Simulation.equations` gives: they belong to a copy, so that the simulation is not touched.

    The unknowns are those that are free; what is tied, prescribed or held follows from them. A multiplier is an unknown
    of which only the acceleration counts. Laws with a memory (friction that sticks) stay as they are at the instant the
    equations are asked for, also before the first step.

    Attributes
    ----------
    names : list of str
        What each unknown is.
    algebraic : int (k,)
        Which of them are multipliers.
    scale : float (n,)
        Force or moment that counts as large in each row, N or N m.
    """

    def __init__(self, model: Model, time: float, state: State, added: Sequence[Force | Group] = ()) -> None:
        system = model.system
        # With what is held where the run has put it: a static start finds how much rope there is.
        self._system, self._state, self._time = system, state, time
        hold_laws(system.groups)
        # Others ask some thousand times: where the scene stands in memory is told once.
        self._scene, self._lasting = (system.link(SUMS), system.dofs, system.functions, state), Lasting()
        # Groups begin a step there; what acts for a whole step of ours acts at its time alone.
        self._h = INSTANT * model.solver.step
        self._q, self._v = state.q.copy(), state.v.copy()
        self.names, self.algebraic, self.scale = list(system.names), system.algebraic.copy(), system.scale.copy()
        self._added = added
        self._residual = np.zeros(system.size)
        self._matrix = new_matrix(system.size, system.bandwidth, system.border)
        self._room = room_for_all(system, added)
        """Of the tangent alone, which is asked for less often than forces and masses are."""
        self._whole: tuple[Any, Any] | None = None
        self._factors = new_factors(system.size, system.bandwidth, system.border)
        self._none = np.zeros(system.size)
        # Laws with a memory that no step has written yet take it from here, not from what is asked first.
        self._evaluate(time, self._q, self._v, self._none, 0.0, 0.0, 0.0, self._matrix)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self._system.size

    def state(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Time s, positions and velocities (n,) at which the simulation stood: m or rad, and per s."""
        return self._time, self._q.copy(), self._v.copy()

    def residual(self, t: float, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """``M(q) a - F(t, q, v)`` (n,), N or N m.

        Parameters
        ----------
        t : float
            s.
        q, v, a : float (n,)
            Positions, velocities and accelerations of the unknowns.

        Raises
        ------
        SimulationError
            For vectors of another size, and numbers that are not finite.
        Exception
            What a function that was added as a force raised.
        """
        self._evaluate(t, q, v, a, 0.0, 0.0, 0.0, self._matrix)
        return self._residual.copy()

    def mass(self, q: np.ndarray, t: float | None = None) -> Any:
        """Mass matrix (n, n) as `scipy.sparse.csc_array`; rows and columns of multipliers are those of the constraints.

        ``t`` says where what is prescribed stands; by default where the simulation stood. Raises as `residual` does.
        """
        (q,) = self._checked(q)
        time = self._time if t is None else _time(t)
        if not has_constant_mass(self._system.groups):
            # Masses are asked for without a time: what changes with it, as in waves, has taken it from the residual.
            self._evaluate(time, q, self._none, self._none, 0.0, 0.0, 0.0, self._matrix)
        self._lasting.call(evaluate_mass, (*self._scene, self._matrix), time, q)
        return sparse(self._matrix)

    def tangent(
        self, t: float, q: np.ndarray, v: np.ndarray, a: np.ndarray, cm: float = 0.0, cc: float = 0.0, ck: float = 1.0
    ) -> Any:
        """``cm dr/da + cc dr/dv + ck dr/dq`` (n, n) as `scipy.sparse.csc_array`; raises as `residual` does."""
        factors = _factor(cm, "cm"), _factor(cc, "cc"), _factor(ck, "ck")
        if self._room.groups is self._system.groups:
            self._evaluate(t, q, v, a, *factors, self._matrix)
            return sparse(self._matrix)
        if self._whole is None:
            matrix = new_matrix(self.size, self._room.bandwidth, self._system.border)
            self._whole = (link(self._room.groups, *SUMS), *self._scene[1:]), matrix
        scene, matrix = self._whole
        q, v, a = self._checked(q, v, a)
        with calls_of(self._added):
            evaluate_at(*scene, matrix, _time(t), self._h, q, v, a, *factors, self._residual)
        return sparse(matrix)

    def acceleration(self, t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Accelerations (n,) that follow from positions and velocities; those of multipliers are their forces.

        Raises
        ------
        SimulationError
            Where the mass matrix is singular, or an acceleration is not finite, naming the unknown; and as `residual`
            does.
        """
        self._evaluate(t, q, v, self._none, 1.0, 0.0, 0.0, self._factors.matrix)
        row = self._lasting.call(factorise_matrix, (self._factors,))
        if row:
            raise SimulationError(f"the mass matrix is singular at {self.names[row - 1]}", "give it a mass")
        self._lasting.call(solve_matrix, (self._factors,), self._residual)
        if not np.isfinite(self._residual).all():
            name = self.names[int(np.argmin(np.isfinite(self._residual)))]
            cause = f"no acceleration follows from these positions and velocities: that of {name} is no finite number"
            raise SimulationError(cause, "give positions near those of `state`")
        return -self._residual

    def first_order(self, t: float, y: np.ndarray) -> np.ndarray:
        """dy/dt of ``y = (q, v)`` (2 n,): what `scipy.integrate.solve_ivp` takes. Raises as `acceleration` does."""
        q, v = self._halves(y)
        n = self.size
        rate = np.concatenate((v, self.acceleration(t, q, v)))
        rate[self.algebraic] = rate[n + self.algebraic] = 0.0
        return rate

    def first_order_tangent(self, t: float, y: np.ndarray) -> np.ndarray:
        """d(first_order)/dy (2 n, 2 n), for methods that ask for it: ``(0, 1; -M^-1 K, -M^-1 C)``."""
        q, v = self._halves(y)
        n = self.size
        a = self.acceleration(t, q, v)
        mass = splu(sparse_csc(self.tangent(t, q, v, a, 1.0, 0.0, 0.0)))
        jacobian = np.zeros((2 * n, 2 * n))
        jacobian[:n, n:] = np.eye(n)
        jacobian[n:, :n] = -mass.solve(self.tangent(t, q, v, a, 0.0, 0.0, 1.0).toarray())
        jacobian[n:, n:] = -mass.solve(self.tangent(t, q, v, a, 0.0, 1.0, 0.0).toarray())
        for k in self.algebraic:
            jacobian[[k, n + k]] = 0.0
        return jacobian

    def _evaluate(self, t: float, q: Any, v: Any, a: Any, cm: float, cc: float, ck: float, matrix: Any) -> None:
        q, v, a = self._checked(q, v, a)
        more = _time(t), self._h, q, v, a, cm, cc, ck, self._residual
        with calls_of(self._added):
            self._lasting.call(evaluate_at, (*self._scene, matrix), *more)

    def _halves(self, y: Any) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities of ``y``."""
        both = _vector(y, 2 * self.size, "positions and velocities", "give the positions, and then the velocities")
        return both[: self.size], both[self.size :]

    def _checked(self, *vectors: Any) -> list[np.ndarray]:
        return [_vector(vector, self.size, "unknowns", "give one number for each of `names`") for vector in vectors]


def _vector(given: Any, size: int, what: str, cure: str) -> np.ndarray:
    """A vector of so many finite real numbers; raises SimulationError."""
    try:
        found = plain_numbers(np.asarray(given))
    except (TypeError, ValueError):  # rows of different lengths
        raise SimulationError("what is given is no vector of numbers", cure) from None
    if found.dtype.kind not in "iuf":
        kind = "complex numbers" if found.dtype.kind == "c" else "no numbers"
        raise SimulationError(f"the vector that is given has {kind}, and real ones are needed", cure)
    if found.shape != (size,):
        raise SimulationError(f"a vector of shape {found.shape} is given, and there are {size} {what}", cure)
    finite = np.isfinite(found)
    if not finite.all():
        place = int(np.argmin(finite))
        raise SimulationError(
            f"number {place} of a vector is {found[place]}, which is not finite", "give finite numbers"
        )
    return np.ascontiguousarray(found, dtype=float)


def _time(given: Any) -> float:
    """A time, s; raises SimulationError."""
    return _finite(real(given, "time", "give seconds, a finite number"), "time")


def _factor(given: Any, name: str) -> float:
    """The factor of a part of the tangent; raises SimulationError."""
    return _finite(real(given, f"factor {name}", "give a finite number"), f"factor {name}")


def _finite(number: float, what: str) -> float:
    if not np.isfinite(number):
        raise SimulationError(f"{number} is no {what}", "give a finite number")
    return number


def sparse_csc(matrix: Any) -> Any:
    """A sparse matrix in the form that factorising asks for."""
    return matrix.tocsc()
