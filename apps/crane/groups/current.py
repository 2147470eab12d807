"""A steady current, as what is in the water finds it: level, and of one velocity at each depth.

Between the depths at which it is given both components of the velocity go along straight lines; above the first and
below the last it is the one there. Depths are below the level of the surface: waves carry no current up and down.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel

X, Y, Z = range(3)


class Current(NamedTuple):
    """Velocity (n, 2), m/s along x and y, at ``depth`` (n,), m below z = ``surface`` m; n = 0 without a current.

    Scratch: ``flow`` (3,), the velocity at a place, and ``shear`` (3,), how it changes upwards, 1/s.
    """

    depth: np.ndarray
    velocity: np.ndarray
    surface: float
    flow: np.ndarray
    shear: np.ndarray


def new_current(depth: np.ndarray, velocity: np.ndarray, surface: float) -> Current:
    """A current with its scratch."""
    return Current(
        np.array(depth, float), np.array(velocity, float).reshape(-1, 2), float(surface), np.zeros(3), np.zeros(3)
    )


def no_current() -> Current:
    """That of water which stands still."""
    return new_current(np.zeros(0), np.zeros((0, 2)), 0.0)


@kernel
def flows(current):
    """Whether there is any."""
    return current.depth.size > 0


@kernel
def carry(current, z):
    """Find the velocity (3,) of the water at a height, m/s, ``flow``, and how it changes upwards, 1/s, ``shear``."""
    flow, depth = current.flow, current.depth
    last = depth.size - 1
    if last < 0:
        return
    deep = current.surface - z
    k = 0
    while k < last - 1 and deep > depth[k + 1]:
        k += 1
    part = steep = 0.0
    if last > 0:
        apart = depth[k + 1] - depth[k]
        part = (deep - depth[k]) / apart
        steep = -1.0 / apart if 0.0 < part < 1.0 else 0.0
        part = min(max(part, 0.0), 1.0)
    for c in (X, Y):
        first = current.velocity[k, c]
        change = current.velocity[min(k + 1, last), c] - first
        flow[c], current.shear[c] = first + part * change, steep * change


__all__ = ["Current", "carry", "flows", "new_current", "no_current"]
