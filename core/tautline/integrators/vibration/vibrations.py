"""Small vibrations with damping and flow, and whatever depends on velocity: complex eigenvalues at a steady state."""

from __future__ import annotations

from operator import attrgetter
from typing import NamedTuple

import numpy as np
from scipy.linalg import eig, null_space
from scipy.sparse import bmat, eye_array
from scipy.sparse.linalg import ArpackNoConvergence, eigs, norm, splu

from tautline.errors import ArgumentError
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.integrators.vibration.modes import expand_shapes
from tautline.kernels.matrix import dense, new_matrix, sparse
from tautline.system.system import System
from tautline.threads import one_thread

DENSE = 300
"""Unknowns up to which all eigenvalues are found by dense algebra."""
CERTAIN = 10.0
"""Growth over what rounding may make of it that is growth."""
GROWING = 24
"""Eigenvalues sought of more unknowns, farthest towards growth, beside the slowest ones."""
RESTARTS = 3
"""Restarts of Arnoldi's method after which those eigenvalues are taken that have converged.

Damping in proportion to stiffness, c, gathers values of fast motions at -1/c, more and more: few of these converge.
"""
TWIN = 1.0e-9
"""Imaginary part, relative, below which an eigenvalue is real."""
APART = 1.0e-8
"""Share of the largest eigenvalue that one may be off before it is refined."""
NEAR = 1.0e-3
"""Share of itself that one of a few may be off before it is refined."""
ROUGHLY, UNHELD = 4, 2
"""Inverse iterations for the size of the slowest frequency, and motions that nothing may hold: a hose about its pin."""
HELD, BESIDE = 1.0e-14, 1.0e-9
"""Stiffness, relative, that holds what nothing holds, and how far beside an eigenvalue its vectors are sought."""
SHIFT = 0.01
"""About which eigenvalues are sought, over the slowest frequency: not zero, where motions that nothing holds are."""
SAME = 1.0e-6
"""Relative difference below which an eigenvalue that is found twice is one."""


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
        How many, those nearest to zero, and those that grow beside them, of a large scene up to 24 values; None for
        all, which only a small scene allows. Fast motions whose damping is in proportion to stiffness, c, have values
        that lie ever closer about -1/c: of a large scene few of these are found.

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
    order = np.argsort(np.abs(value), kind="stable")
    # Heavy damping in proportion to stiffness has slow motions by the hundred: those that grow lie beyond them.
    grows = value[order].real > CERTAIN * rounding[order]
    order = order[grows | (np.arange(order.size) < (order.size if count is None else count))]
    return Vibrations(value[order], expand_shapes(system, shape[:, order]), rounding[order])


def _part(system: System, state: State, cm: float, cc: float, ck: float):
    matrix = new_matrix(system.size, system.bandwidth, system.border)
    keep = state.residual.copy()
    evaluate(system, state, 0.0, 1.0, True, cm, cc, ck, matrix, np.zeros(system.size))
    state.residual[:] = keep
    return matrix


def _all(mass, damping, stiffness, algebraic):
    """All eigenvalues; what the constraints forbid is taken out through the null space of their rows."""
    parts = [_Part.of(rows, mass, damping, stiffness, algebraic) for rows in _apart(mass, damping, stiffness)]
    # Stiffness and mass are of very different size: time in units that make them alike.
    stiff, heavy = (np.linalg.norm([np.linalg.norm(matrix(part)) for part in parts]) for matrix in (_k, _m))
    unit = np.sqrt(stiff / heavy) if stiff else 1.0
    found = [_eigenvalues(part.m, part.c / unit, part.k / unit**2) for part in parts]
    value, change, rounding = (np.concatenate([one[i] for one in found] or [np.zeros(0)]) for i in range(3))
    # Two values that meet have no vectors of their own: there the sums tell nothing.
    size = np.abs(value).max(initial=0.0)
    known = np.isfinite(rounding) & (np.abs(change) < APART * size)
    value, rounding = np.where(known, value, value - change), np.where(known, rounding, np.finfo(float).eps * size)
    shape, begin = np.zeros((len(mass), value.size), complex), 0
    for part, (*_, right) in zip(parts, found, strict=True):
        end = begin + right.shape[1]
        shape[part.free, begin:end] = part.basis @ right
        begin = end
    return unit * value, shape, unit * rounding


def _apart(*matrices):
    """Rows that no entry of any matrix ties to others, as the two planes of a straight hose: arrays of their numbers.

    What takes the cube of all rows takes the cubes of these.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    tied = csr_array(np.any([matrix != 0.0 for matrix in matrices], axis=0))
    count, which = connected_components(tied, directed=False)
    return [np.flatnonzero(which == i) for i in range(count)]


class _Part(NamedTuple):
    """Rows ``free`` that nothing ties to others, with what their constraints leave, ``basis``, and its matrices."""

    free: np.ndarray
    basis: np.ndarray
    m: np.ndarray
    c: np.ndarray
    k: np.ndarray

    @classmethod
    def of(cls, rows, mass, damping, stiffness, algebraic):
        """Of rows and all matrices."""
        ties = np.intersect1d(rows, algebraic)
        free = np.setdiff1d(rows, ties)
        basis = null_space(stiffness[np.ix_(ties, free)]) if ties.size and free.size else np.eye(free.size)
        return cls(free, basis, *(basis.T @ part[np.ix_(free, free)] @ basis for part in (mass, damping, stiffness)))


_m, _k = attrgetter("m"), attrgetter("k")


def _eigenvalues(m, c, k):
    """Eigenvalues, by how much they were changed, how good they are, and their vectors."""
    n = len(m)
    inverse = np.linalg.solve(m, np.hstack([k, c]))
    value, left, right = eig(np.block([[np.zeros((n, n)), np.eye(n)], [-inverse[:, :n], -inverse[:, n:]]]), left=True)
    # The last n rows of a left vector are those of M^T y.
    return *_refined(m, c, k, value, right[:n], np.linalg.solve(m.T, left[n:])), right[:n]


def _refined(m, c, k, value, x, y):
    """Values as good as the matrices, by how much they are changed, and how good they are.

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
    change = np.where(np.isfinite(change), change, 0.0)
    return value + change, change, rounding


def _sizes(part, x, y):
    """|y|^T |A| |x| of each pair of vectors."""
    return np.einsum("ik,ik->k", np.abs(y), abs(part) @ np.abs(x))


def _nearest(mass, damping, stiffness, count):
    """Those nearest to zero, and those that grow, by shift and invert."""
    n = mass.shape[0]
    # Time in units in which slow motions have eigenvalues near one: only then is lambda x as large as x.
    unit = _slowness(mass, stiffness)
    m, c, k = mass, damping / unit, stiffness / unit**2
    # Of 1 / (lambda - SHIFT) the largest are of slow motions, those of positive real part of motions that grow.
    value, shape = _converged(m, c, k, 2 * count, "LM")
    growing, of_growing = _converged(m, c, k, GROWING, "LR")
    new = [bool((np.abs(value - one) > SAME * abs(one)).all()) for one in growing]
    value, shape = np.concatenate([value, growing[new]]), np.hstack([shape, of_growing[:, new]])
    x, y = _vectors(m, c, k, value, shape[:n])
    better, change, rounding = _refined(m, c, k, value, x, y)
    # A motion that nothing holds has an eigenvalue of zero twice: of that no more than its size is known.
    known = np.isfinite(rounding) & (np.abs(change) < NEAR * np.abs(value))
    value, rounding = np.where(known, better, value), np.where(known, rounding, np.abs(value))
    return unit * value, x, unit * rounding


def _slowness(mass, stiffness):
    """Angular frequency, about, of the slowest motion that is held, without damping, 1/s, by inverse iteration."""
    held = HELD * norm(stiffness) / norm(mass)
    factors = splu((stiffness + held * mass).tocsc())
    x = np.random.default_rng(0).standard_normal((mass.shape[0], UNHELD + 1))
    for _ in range(ROUGHLY):
        x, sizes = np.linalg.qr(factors.solve(mass @ x))
    return 1.0 / np.sqrt(np.abs(np.diag(sizes)).min())


def _converged(m, c, k, count, which):
    """Eigenvalues that Arnoldi's method finds of those sought, and their vectors (x, lambda x)."""
    n = m.shape[0]
    one = eye_array(n)
    left, right = bmat([[None, one], [-k, -c]], format="csc"), bmat([[one, None], [None, m]], format="csc")
    start = np.random.default_rng(0).standard_normal(2 * n)
    try:
        return eigs(left, min(count, n), right, sigma=SHIFT, which=which, v0=start, maxiter=RESTARTS)
    except ArpackNoConvergence as found:
        return found.eigenvalues, found.eigenvectors


def _vectors(m, c, k, value, start):
    """Vectors of both sides of values that are nearly right, by two inverse iterations from one side's."""
    right, left = np.empty(start.shape, complex), np.empty(start.shape, complex)
    for i, near in enumerate(value):
        # Where it is right to the last digit nothing can be factored.
        near += BESIDE * (1.0 + abs(near))
        factors = splu((near**2 * m + near * c + k).tocsc())
        slope = 2.0 * near * m + c
        x = y = start[:, i]
        for _ in range(2):
            x, y = factors.solve(slope @ x), factors.solve(slope.conj().T @ y, "H")
            x, y = x / np.linalg.norm(x), y / np.linalg.norm(y)
        right[:, i], left[:, i] = x, y
    return right, left
