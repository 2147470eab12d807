"""States of a linear model without the lengths of vectors of which only the direction counts, such as quaternions.

The length of a quaternion is an unknown of the program's own. It drives nothing and nothing drives it, so that the
states in which no length changes are an invariant subspace of A: left to them, A has all of its eigenvalues but those
of the lengths. With rows R of the directions and R' of their rates the subspace is

    R y = 0,   R y. + R' y = 0,

and one coordinate of each vector follows from the others.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import qr


class Left(NamedTuple):
    """States that are left, by number (m,), and how all n states follow them (n, m)."""

    kept: np.ndarray
    map: np.ndarray


def without_lengths(directions: np.ndarray, rates: np.ndarray, size: int) -> Left:
    """Leave the lengths of k vectors out of the states (y, y., others), the coordinate that tells most of each.

    Parameters
    ----------
    directions, rates : (k, n) array
        What a change of the n coordinates does to half the square of each length, and the rate of that.
    size : int
        Number of states, 2 n and more.
    """
    count = directions.shape[1]
    gone = np.sort(qr(directions, mode="r", pivoting=True)[1][: len(directions)])
    rest = np.setdiff1d(np.arange(count), gone)
    follow = -np.linalg.solve(directions[:, gone], directions[:, rest])
    turned = -np.linalg.solve(directions[:, gone], rates[:, rest] + rates[:, gone] @ follow)
    kept = np.setdiff1d(np.arange(size), np.concatenate((gone, count + gone)))
    whole = np.eye(size)[:, kept]
    y, y_d = slice(0, rest.size), slice(rest.size, 2 * rest.size)
    whole[gone, y], whole[count + gone, y_d], whole[count + gone, y] = follow, follow, turned
    return Left(kept, whole)
