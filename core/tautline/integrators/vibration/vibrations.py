"""Small vibrations with damping and flow, and whatever depends on velocity: complex eigenvalues at a steady state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import eig, null_space
from scipy.sparse import bmat, eye_array
from scipy.sparse.linalg import eigs

from tautline.errors import ArgumentError
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.integrators.vibration.modes import expand_shapes
from tautline.kernels.matrix import dense, new_matrix, sparse
from tautline.system.system import System
from tautline.threads import one_thread

DENSE = 700
"""Unknowns up to which all eigenvalues are found by dense algebra."""
TWIN = 1.0e-9
"""Imaginary part, relative, below which an eigenvalue is real."""
APART = 1.0e-8
"""Share of the largest eigenvalue that one may be off before it is refined."""


class Vibrations(NamedTuple):
    """Motions exp(lambda t), of each conjugate pair one, by rising size of lambda.

    ``value`` (k,) 1/s, imaginary part not negative; ``shape`` (n_full, k) complex, each one where it is largest;
    multipliers and held degrees of freedom are zero. ``rounding`` (k,) 1/s is by how much a value may be off because
    numbers have sixteen digits.
    """

    value: np.ndarray
    shape: np.ndarray
    rounding: np.ndarray

    @property
    def growth(self) -> float:
        """Largest growth rate, 1/s; minus infinity where nothing can move."""
        return float(self.value.real.max(initial=-np.inf))


@one_thread()
def vibrations(system: System, state: State, count: int | None = None) -> Vibrations:
    """Solve (lambda^2 M + lambda C + K) x = 0 about a state at rest, material that flows steadily flowing on.

    Parameters
    ----------
    system : System
    state : State
        In equilibrium at t = 0.
    count : int or None
        How many, those nearest to zero; None for all, which only a small scene allows.

    Raises
    ------
    ArgumentError
        If all of a large scene are asked for, or some of a large scene with multipliers.
    """
    if system.size <= DENSE:
        value, shape, rounding = _all(*(dense(_part(system, state, *part)) for part in np.eye(3)), system.algebraic)
    elif count is None or system.algebraic.size:
        raise ArgumentError(f"{system.size} unknowns: too many for all vibrations, or for any with multipliers")
    else:
        value, shape, rounding = _nearest(*(sparse(_part(system, state, *part)) for part in np.eye(3)), 2 * count)
    upper = value.imag >= -TWIN * np.abs(value)
    value, shape, rounding = value[upper], shape[:, upper], rounding[upper]
    order = np.argsort(np.abs(value), kind="stable")[:count]
    return Vibrations(value[order], expand_shapes(system, shape[:, order]), rounding[order])


def _part(system: System, state: State, cm: float, cc: float, ck: float):
    matrix = new_matrix(system.size, system.bandwidth, system.border)
    keep = state.residual.copy()
    evaluate(system, state, 0.0, 1.0, True, cm, cc, ck, matrix, np.zeros(system.size))
    state.residual[:] = keep
    return matrix


def _all(mass, damping, stiffness, algebraic):
    """All eigenvalues; what the constraints forbid is taken out through the null space of their rows."""
    free = np.setdiff1d(np.arange(len(mass)), algebraic)
    basis = null_space(stiffness[np.ix_(algebraic, free)]) if algebraic.size else np.eye(free.size)
    m, c, k = (basis.T @ part[np.ix_(free, free)] @ basis for part in (mass, damping, stiffness))
    n = len(m)
    # Stiffness and mass are of very different size: time in units that make them alike.
    unit = np.sqrt(np.linalg.norm(k) / np.linalg.norm(m)) if n and k.any() else 1.0
    k, c = k / unit**2, c / unit
    inverse = np.linalg.solve(m, np.hstack([k, c]))
    value, left, right = eig(np.block([[np.zeros((n, n)), np.eye(n)], [-inverse[:, :n], -inverse[:, n:]]]), left=True)
    # The last n rows of a left vector are those of M^T y.
    value, rounding = _refined(m, c, k, value, right[:n], np.linalg.solve(m.T, left[n:]))
    shape = np.zeros((len(mass), 2 * n), complex)
    shape[free] = basis @ right[:n]
    return unit * value, shape, unit * rounding


def _refined(m, c, k, value, x, y):
    """Values as good as the matrices, and how good that is, from values that are as good as the largest of them.

    The eigenvalues of a matrix are found to the rounding of its size, which damping that grows with frequency squared
    makes large. y* (lambda^2 M + lambda C + K) x = 0 with the vectors of both sides errs by the square of theirs, and
    by what is rounded in these sums (Tisseur 2000, Theorem 5): of motions that are slow that is little.
    """
    a, b, d = (np.einsum("ik,ik->k", y.conj(), part @ x) for part in (m, c, k))
    slope = 2.0 * value * a + b
    size = np.abs(value)
    sums = size**2 * _sizes(m, x, y) + size * _sizes(c, x, y) + _sizes(k, x, y)
    with np.errstate(divide="ignore", invalid="ignore"):
        change = -(value**2 * a + value * b + d) / slope
        rounding = np.finfo(float).eps * sums / np.abs(slope)
    # Two values that meet have no vectors of their own: there the sums tell nothing.
    known = np.isfinite(change) & np.isfinite(rounding) & (np.abs(change) < APART * size.max(initial=0.0))
    whole = np.finfo(float).eps * size.max(initial=0.0)
    return np.where(known, value + change, value), np.where(known, rounding, whole)


def _sizes(part, x, y):
    """|y|^T |A| |x| of each pair of vectors."""
    return np.einsum("ik,ik->k", np.abs(y), np.abs(part) @ np.abs(x))


def _nearest(mass, damping, stiffness, count):
    """Those nearest to zero, by shift and invert."""
    n = mass.shape[0]
    one = eye_array(n)
    left = bmat([[None, one], [-stiffness, -damping]], format="csc")
    value, vector = eigs(left, count, bmat([[one, None], [None, mass]], format="csc"), sigma=0.0)
    return value, vector[:n], np.finfo(float).eps * np.abs(value)
