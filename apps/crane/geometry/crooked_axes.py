"""Wheels whose axis points along their rope: where no rope can pass, that is the likeliest cause.

An axis in the plane of the rope makes what the geometry says of it true and of no help: there are two ways of one
length, or one height in both senses. With the axis turned square to the rope the path is found.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from crane.geometry.tangents import ReevingError, Wheel, cross

CROOKED = math.sin(math.radians(20.0))
"""Cosine of the angle of axis and rope from which on the axis is in doubt: no rope runs on a wheel so askew."""
SNAPPED = 0.05
"""Part of an axis below which it is offered as zero: most wheels stand square to the axes of the scene."""


def crooked_axis(
    wheels: Sequence[Wheel], up: np.ndarray, found: Callable[[Sequence[Wheel]], Any]
) -> ReevingError | None:
    """Say which wheel's axis makes a path impossible; None where another axis does not make it possible.

    Parameters
    ----------
    wheels : sequence of Wheel
        A path that no rope can take.
    up : array (3,)
        Of length one.
    found : callable
        Finds the path of wheels, or raises ReevingError.
    """
    for j, wheel in enumerate(wheels):
        k, along = _steepest(wheels, j)
        if wheel.radius == 0.0 or abs(along) < CROOKED:
            continue
        for axis in _square(wheels, j, up):
            try:
                found([*wheels[:j], replace(wheel, axis=axis), *wheels[j + 1 :]])
            except ReevingError:
                continue
            angle = math.degrees(math.acos(min(1.0, abs(along))))
            message = (
                f"the axis of {wheel.name!r} is at {angle:.3g} deg to the line to {wheels[k].name!r}, and a rope runs "
                "square to the axis of its wheel"
            )
            return ReevingError(message, f"write axis: {_written(axis)}", j)
    return None


def _steepest(wheels: Sequence[Wheel], j: int) -> tuple[int, float]:
    """The neighbour that lies most along a wheel's axis, and the cosine of the angle."""
    beside = [k for k in (j - 1, j + 1) if 0 <= k < len(wheels)]
    cosines = {k: float(np.dot(_towards(wheels, j, k), wheels[j].axis)) for k in beside}
    k = max(cosines, key=lambda k: abs(cosines[k]))
    return k, cosines[k]


def _square(wheels: Sequence[Wheel], j: int, up: np.ndarray) -> list[np.ndarray]:
    """Axes square to what runs to a wheel: to both neighbours, and to the plumb plane through one."""
    lines = [_towards(wheels, j, k) for k in (j - 1, j + 1) if 0 <= k < len(wheels)]
    normals = [cross(*lines)] if len(lines) == 2 else []
    normals += [cross(up, line) for line in lines]
    axes = []
    for normal in normals:
        size = float(np.linalg.norm(normal))
        if size > SNAPPED:
            axis = np.where(np.abs(normal) < SNAPPED * size, 0.0, normal)
            axis = axis / np.linalg.norm(axis)
            axes.append(axis if axis[np.argmax(np.abs(axis))] > 0.0 else -axis)
    return axes


def _towards(wheels: Sequence[Wheel], j: int, k: int) -> np.ndarray:
    """Direction from the centre of one wheel to that of another; zero where they are at one place."""
    apart = wheels[k].center - wheels[j].center
    return apart / max(float(np.linalg.norm(apart)), 1e-300)


def _written(axis: np.ndarray) -> str:
    return f"[{', '.join(f'{float(x) + 0.0:.3g}' for x in axis)}]"
