"""Natural frequencies and shapes of small vibrations about a state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, eig, eigh, null_space
from scipy.sparse.linalg import eigsh

from tautline.errors import ArgumentError
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.kernels.dofs import HELD
from tautline.kernels.matrix import dense, new_matrix, sparse
from tautline.system.system import System
from tautline.threads import one_thread

DENSE = 1500
"""Unknowns up to which all modes are found by dense algebra."""
RIGID = 50.0 * np.finfo(float).eps
"""Share of the largest squared frequency below which the lowest is zero and rounding."""
SYMMETRIC = 1.0e-9
"""Relative asymmetry below which a matrix counts as symmetric."""


class Modes(NamedTuple):
    """Modes in increasing frequency.

    ``omega`` (k,) rad/s, negative where omega^2 is: the state is unstable there; ``shape`` (n_full, k), each scaled to
    one where it is largest; multipliers and held degrees of freedom are zero.
    """

    omega: np.ndarray
    shape: np.ndarray

    @property
    def frequency(self) -> np.ndarray:
        """Frequencies, Hz."""
        return self.omega / (2.0 * np.pi)


@one_thread()
def modes(system: System, state: State, count: int | None = None) -> Modes:
    """Undamped modes about a state at rest, with the constraints of the scene.

    Material that runs along a rope or a hose brings Coriolis forces, in proportion to velocity, which M and K alone
    leave out: a string at 0.6 of the speed of its waves would get a frequency 25 % too high. Such a state is refused;
    :func:`~tautline.integrators.vibration.vibrations.vibrations` has these forces, and damping.

    Parameters
    ----------
    system : System
    state : State
        In equilibrium, or the modes mean little.
    count : int or None
        How many of the lowest; None for all, which only a small scene allows.

    Raises
    ------
    ArgumentError
        If all modes of a large scene are asked for, or any of a state through which material flows.
    """
    if np.any(state.full_v[system.dofs.flowing]):
        raise ArgumentError(
            "material flows while the scene rests: `modes` leaves out its Coriolis forces; take "
            "tautline.integrators.vibration.vibrations.vibrations, or a scene whose material stands still"
        )
    mass, stiffness = (_part(system, state, *part) for part in ((1.0, 0.0), (0.0, 1.0)))
    if system.size > DENSE and count is not None:
        square, shapes = _lowest(mass, stiffness, count)
    elif system.size > DENSE:
        raise ArgumentError(f"{system.size} unknowns: say how many of the lowest modes are wanted")
    else:
        square, shapes = _all(dense(mass), dense(stiffness), system.algebraic)
    order = np.argsort(square)[:count]
    omega = np.sign(square[order]) * np.sqrt(np.abs(square[order]))
    return Modes(omega, expand_shapes(system, shapes[:, order]))


def _part(system: System, state: State, cm: float, ck: float):
    matrix = new_matrix(system.size, system.bandwidth, system.border)
    keep = state.residual.copy()
    evaluate(system, state, 0.0, 1.0, True, cm, 0.0, ck, matrix, np.zeros(system.size))
    state.residual[:] = keep
    return matrix


def _all(mass: np.ndarray, stiffness: np.ndarray, algebraic: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All modes; what the constraints forbid is taken out through the null space of their rows."""
    free = np.setdiff1d(np.arange(len(mass)), algebraic)
    basis = np.eye(free.size)
    if algebraic.size:
        basis = null_space(stiffness[np.ix_(algebraic, free)])
    m = basis.T @ mass[np.ix_(free, free)] @ basis
    k = basis.T @ stiffness[np.ix_(free, free)] @ basis
    if np.abs(k - k.T).max(initial=0.0) <= SYMMETRIC * np.abs(k).max(initial=0.0):
        square, vectors = _symmetric(0.5 * (k + k.T), 0.5 * (m + m.T))
    else:
        values, vectors = eig(k, m)
        square, vectors = values.real, vectors.real
    shapes = np.zeros((len(mass), square.size))
    shapes[free] = basis @ vectors
    return square, shapes


def _symmetric(k: np.ndarray, m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Squared frequencies, rising, and shapes, of symmetric matrices.

    The eigenvalues of K against M are exact to rounding of the largest, which drowns the lowest beside stiff springs;
    those of M against K, their inverses, are the other way round. The lower half is taken from these where nothing
    moves as a whole and nothing is unstable: there K has no inverse to speak of.
    """
    square, vectors = eigh(k, m)
    try:
        inverse, other = eigh(m, k)
    except LinAlgError:
        return square, vectors
    if not square.size or inverse[-1] <= 0.0 or inverse[-1] * square[-1] * RIGID > 1.0 or inverse[0] <= 0.0:
        return square, vectors
    order = np.argsort(-inverse)
    slow = 1.0 / inverse[order]
    low = slow < np.sqrt(slow[0] * square[-1])
    shapes = other[:, order] * np.sqrt(slow)
    return np.where(low, slow, square), np.where(low, shapes, vectors)


def _lowest(mass, stiffness, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The lowest modes, by shift and invert about zero."""
    k, m = sparse(stiffness).tocsc(), sparse(mass).tocsc()
    # Without a start of ours each call begins elsewhere, and its last digits differ.
    start = np.random.default_rng(0).standard_normal(k.shape[0])
    return eigsh(0.5 * (k + k.T), count, 0.5 * (m + m.T), sigma=0.0, v0=start)


def expand_shapes(system: System, shapes: np.ndarray) -> np.ndarray:
    """Shapes (n, k) in full (n_full, k), each scaled to one where it is largest."""
    dofs = system.dofs
    shapes = shapes.copy()
    shapes[system.algebraic] = 0.0
    full = np.zeros((dofs.number.size, shapes.shape[1]), shapes.dtype)
    for i, number in enumerate(dofs.number):
        if number != HELD:
            for k in range(dofs.start[i], dofs.start[i + 1]):
                if dofs.unknown[k] >= 0:
                    full[i] += dofs.factor[k] * shapes[dofs.unknown[k]]
    largest = full[np.abs(full).argmax(axis=0), np.arange(full.shape[1])] if full.size else np.ones(shapes.shape[1])
    return full / np.where(largest == 0.0, 1.0, largest)
