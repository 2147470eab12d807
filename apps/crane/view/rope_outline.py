"""The path of a rope as a line to draw."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crane.geometry.reeving import Path, Wheel, turned
from tautline.errors import ArgumentError


def outline(path: Path, wheels: Sequence[Wheel], samples: int = 32) -> np.ndarray:
    """Points along a rope: its spans, and its arcs around the sheaves between them.

    Parameters
    ----------
    path : Path
    wheels : sequence of Wheel
        Those that `path` was laid over.
    samples : int
        Points of an arc, its ends among them, >= 2.

    Returns
    -------
    array (m, 3)
        In the order of the rope, m; m = 2 + `samples` for each sheave, 1 for one of radius 0. What is wound on a drum
        is left out.

    Raises
    ------
    ArgumentError
        For fewer than 2 samples.
    """
    if samples < 2:
        raise ArgumentError(f"samples = {samples}: an arc needs 2 points at least")
    points = [path.tangents[0, 0]]
    for j in range(1, len(wheels) - 1):
        points += _arc(path, wheels[j], j, samples)
    points.append(path.tangents[-1, 1])
    return np.array(points)


def _arc(path: Path, wheel: Wheel, j: int, samples: int) -> list[np.ndarray]:
    """Points of the rope that lies on a sheave, from where it runs on to where it leaves."""
    if wheel.radius == 0.0:
        return [wheel.center]
    axis, x = path.sigma[j] * wheel.axis, path.spans[j - 1].x2
    inner = [wheel.center + turned(x, axis, path.wraps[j] * k / (samples - 1)) for k in range(1, samples - 1)]
    return [path.tangents[j - 1, 1], *inner, path.tangents[j, 0]]
