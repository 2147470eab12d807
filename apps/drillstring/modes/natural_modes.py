"""Natural modes of a string, lateral, torsional and axial, and how they are found and compared."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import eigsh

from tautline.threads import one_thread

KINDS = ("lateral", "torsional", "axial")
DENSE = 1500
"""Unknowns up to which all modes are found by dense algebra."""
BATCH = 40
"""Modes that are asked for at a time where there are more unknowns."""
RIGID = 4.0 * float(np.finfo(float).eps)
"""Share of the largest squared frequency below which one is rounding."""


class Mode(NamedTuple):
    """A natural mode.

    ``kind`` lateral, torsional or axial; ``plane`` of a lateral one; ``frequency`` Hz, negative for the growth rate
    over 2 pi of what is not stable; ``error`` Hz, by Richardson's rule from a mesh of half as many links, NaN where
    that has no such mode; ``depth`` (k,) measured depth of the lumps, m; ``shape`` (k, 2) up and sideways, or (k, 1),
    one where it is largest; ``turning`` ratio of polar rotatory inertia to mass of the motion (0 but for lateral ones).
    """

    kind: str
    plane: str
    frequency: float
    error: float
    depth: np.ndarray
    shape: np.ndarray
    turning: float

    def gyroscopic(self, speed: float) -> float:
        """Half the relative difference that gyroscopic terms would make between forward and backward whirl.

        First order in a rotary speed, rad/s: J Omega / (2 m omega), with the ratio of ``turning``.
        """
        return self.turning * speed / (4.0 * pi * self.frequency) if self.frequency > 0.0 else 0.0

    @property
    def rotatory(self) -> float:
        """Relative fall of the frequency by rotatory inertia, to first order."""
        return 0.25 * self.turning


@one_thread()
def modes_below(mass: np.ndarray | csc_array, stiffness: csc_array, highest: float) -> tuple[np.ndarray, np.ndarray]:
    """Modes of K x = omega^2 M x up to a frequency, Hz; what moves as a whole, without a spring, is no vibration.

    Parameters
    ----------
    mass : (n,) array, or (n, n) sparse array
        Diagonal of M, or all of it.
    stiffness : (n, n) sparse array
        Symmetric.

    Returns
    -------
    frequency : (k,) array
        Hz, rising, negative where omega^2 is.
    vectors : (n, k) array
        Of unit mass.
    """
    whole = None if isinstance(mass, np.ndarray) else mass
    root = 1.0 / np.sqrt(mass if isinstance(mass, np.ndarray) else mass.diagonal())
    scale = diags_array(root)
    scaled = csc_array(scale @ stiffness @ scale)
    inertia = None if whole is None else csc_array(scale @ whole @ scale)
    limit, n = (2.0 * pi * highest) ** 2, root.size
    if n <= DENSE:
        dense = None if inertia is None else inertia.toarray()
        square, vectors = eigh(scaled.toarray(), dense, subset_by_value=(-np.inf, limit))
    else:
        count = BATCH
        # Lanczos' method would begin with another vector each time: what it finds would differ in its last digits.
        start = np.random.default_rng(0).standard_normal(n)
        while True:
            square, vectors = eigsh(scaled, min(count, n - 2), inertia, sigma=-1e-3 * limit, v0=start)
            if square.max() > limit or count >= n - 2:
                break
            count *= 2
        order = np.argsort(square)
        order = order[square[order] <= limit]
        square, vectors = square[order], vectors[:, order]
    swings = np.abs(square) > RIGID * float(np.abs(scaled.diagonal()).max(initial=0.0))
    square, vectors = square[swings], vectors[:, swings]
    return np.sign(square) * np.sqrt(np.abs(square)) / (2.0 * pi), root[:, None] * vectors


def with_errors(modes: list[Mode], rough: list[Mode]) -> list[Mode]:
    """Modes with the error that those of half as many links tell: a third of the difference, for order two.

    Each mode is compared with the nearest in frequency of its kind and plane.
    """
    found = []
    for mode in modes:
        off = [abs(one.frequency - mode.frequency) for one in rough if one.plane == mode.plane]
        found.append(mode._replace(error=min(off, default=np.nan) / 3.0))
    return found
