"""Angles of the rope at its ends: fleet angles at drums, and how far the hook's rope hangs from plumb."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crane.scene.path import Drum, End, Sheave
from crane.scene.scene import CraneScene

UPRIGHT = 0.1
"""Sine of the angle between a wheel's axis and plumb below which no plane is the wheel's own."""


def hook_span(scene: CraneScene) -> tuple[int, int] | None:
    """Numbers of the wheel that a body hangs from and of the item on the body, next to one another; None if none."""
    rides = [isinstance(item, (End, Sheave)) and item.body is not None for item in scene.path]
    pairs = [(i - 1, i) for i in range(1, len(rides))] + [(i, i - 1) for i in range(1, len(rides))]
    for wheel, hook in pairs:
        if rides[hook] and not rides[wheel] and isinstance(scene.path[wheel], (Sheave, Drum)):
            return wheel, hook
    return None


def legs_of(scene: CraneScene, hook: int) -> list[tuple[int, bool]]:
    """Spans by which the body that an item rides on hangs, and whether it is at the span's last end: legs of a sling,
    falls of a block."""
    on = [item.body if isinstance(item, (End, Sheave)) else None for item in scene.path]
    ends = [(k, on[k], on[k + 1]) for k in range(len(on) - 1)]
    return [
        (k, last is not None)
        for k, first, last in ends
        if (first is None) != (last is None) and on[hook] in (first, last)
    ]


def across_plumb(axis: np.ndarray, gravity: Sequence[float]) -> np.ndarray:
    """What of an axis (..., 3) lies across plumb."""
    down = _down(gravity)
    return axis - _along(axis, np.broadcast_to(down, axis.shape))[..., None] * down


def leads(e: np.ndarray, axis: np.ndarray, gravity: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Angles of a hook's rope from plumb, in the plane of the wheel that it hangs from and out of it.

    Parameters
    ----------
    e : (m, 3) array
        Direction of the rope, from the wheel to the hook; of any length.
    axis : (m, 3) array
        Unit axis of the wheel.
    gravity : sequence of 3 floats
        m/s^2.

    Returns
    -------
    offlead, sidelead : (m,) arrays
        rad; positive along the axis crossed with plumb (down), and along the axis.
    """
    down, across = _down(gravity), across_plumb(axis, gravity)
    across = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), UPRIGHT)
    outwards = np.cross(across, down)
    fall = _along(e, np.broadcast_to(down, e.shape))
    return np.arctan2(_along(e, outwards), fall), np.arctan2(_along(e, across), fall)


def out_of_plane(e: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Angle of a rope of direction e (..., 3) and the plane across a wheel's axis (..., 3), rad."""
    return np.arcsin(np.clip(_along(e, axis), -1.0, 1.0))


def _along(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of vectors (..., 3). Written out: a sum by einsum is rounded otherwise in batches of another length."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def _down(gravity: Sequence[float]) -> np.ndarray:
    g = np.array(gravity, float)
    return g / np.linalg.norm(g)
