"""Whether an equilibrium is stable: the inertia of the tangent, which is how many of its eigenvalues are negative."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.kernels.matrix import Matrix, dense, factorise_matrix, new_factors, replace_by_identity
from tautline.system.system import System

NEUTRAL = 1e-8
"""Share of a row's own stiffness below which a negative stiffness counts as none: rounding and the balance's tolerance
leave that much in a mode that nothing resists, such as a free rotation."""
SKEW = 1e-6
"""Share of the largest entry above which a tangent is not symmetric: its forces have no potential, and the sign of its
pivots then proves nothing."""
SMALL = 600
"""Unknowns up to which eigenvalues are taken in full: a second opinion, and the only one beside multipliers."""


class Stability(NamedTuple):
    """How many independent motions lower the energy, and the unknown that the first of them moves most.

    ``negative`` is -1 where it is not known: the tangent is not symmetric, or too large beside multipliers.
    """

    negative: int
    worst: int


UNKNOWN = Stability(-1, 0)


def count_negative(system: System, state: State) -> Stability:
    """Negative pivots of the stiffness at a state at rest, with t = 0; those that multipliers bring are left out."""
    n = system.size
    # With a threshold of zero no rows are exchanged: the signs of the pivots are then those of the eigenvalues.
    factors = new_factors(n, system.bandwidth, system.border, 0.0)
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, factors.matrix, np.zeros(n))
    for row in system.at_rest:
        replace_by_identity(factors.matrix, row)
    if n == 0:
        return Stability(0, 0)
    if system.border or system.algebraic.size or n <= SMALL:
        return _by_eigenvalues(system, factors.matrix) if n <= SMALL else UNKNOWN
    band, k = factors.matrix.band, system.bandwidth
    if not _symmetric(band, k):
        return UNKNOWN
    size = np.abs(band[:, 2 * k])
    band[:, 2 * k] += NEUTRAL * np.where(size > 0.0, size, 1.0)
    if factorise_matrix(factors):
        return UNKNOWN
    wrong = np.flatnonzero(factors.inverse < 0.0)
    return Stability(wrong.size, int(wrong[0]) if wrong.size else 0)


def _symmetric(band: np.ndarray, k: int) -> bool:
    limit = SKEW * float(np.abs(band).max(initial=0.0))
    below = ((band[:-d, 2 * k + d], band[d:, 2 * k - d]) for d in range(1, min(k, band.shape[0] - 1) + 1))
    return all(np.abs(low - high).max() <= limit for low, high in below)


def _by_eigenvalues(system: System, matrix: Matrix) -> Stability:
    full = dense(matrix)
    full[system.at_rest] = 0.0
    full[:, system.at_rest] = 0.0
    full[system.at_rest, system.at_rest] = 1.0
    if np.abs(full - full.T).max() > SKEW * np.abs(full).max():
        return UNKNOWN
    unit = np.abs(np.diagonal(full)).copy()
    unit[unit == 0.0] = 1.0
    unit[system.algebraic] = 1.0
    unit = 1.0 / np.sqrt(unit)
    full *= unit[:, None] * unit
    held = full[system.algebraic]
    moves = np.setdiff1d(np.arange(system.size), system.algebraic)
    free = np.eye(moves.size)
    if held.size:
        _, sizes, directions = np.linalg.svd(held[:, moves])
        rank = int((sizes > 1e-12 * sizes.max(initial=0.0)).sum())
        free = directions[rank:].T
    values, modes = np.linalg.eigh(free.T @ full[np.ix_(moves, moves)] @ free)
    negative = int((values < -NEUTRAL).sum())
    worst = int(moves[np.argmax(np.abs((free @ modes[:, 0]) * unit[moves]))]) if negative else 0
    return Stability(negative, worst)
