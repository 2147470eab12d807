"""Equations phi = sum of factors times degrees of freedom + offset = 0, as groups see them.

Position, slope and material coordinate of two nodes are equal (eqs 3.11-3.19): every one of these is linear, so that
G = d(phi)/dq is constant.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel


class Equations(NamedTuple):
    """Equations (n,): ``place[start[i]:start[i + 1]]`` and ``factor[...]``, and ``offset`` (n,)."""

    start: np.ndarray
    place: np.ndarray
    factor: np.ndarray
    offset: np.ndarray


def equations(rows: Sequence[Sequence[tuple[int, float]]], offsets: Sequence[float]) -> Equations:
    """Make equations of rows of (full degree of freedom, factor) and offsets."""
    return Equations(
        np.cumsum([0] + [len(row) for row in rows]).astype(np.int64),
        np.array([place for row in rows for place, _ in row], dtype=np.int64),
        np.array([factor for row in rows for _, factor in row], dtype=np.float64),
        np.array(offsets, dtype=np.float64),
    )


@kernel
def value_of(equations, i, x):
    """Sum of factors times x in equation i: without its offset."""
    total = 0.0
    for k in range(equations.start[i], equations.start[i + 1]):
        total += equations.factor[k] * x[equations.place[k]]
    return total
