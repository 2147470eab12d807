"""Where the eye is: named views, angles, and how far off it must be to see everything."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tautline.results.errors import ResultError

VIEWS = {
    "front": (0.0, -1.0, 0.0),
    "back": (0.0, 1.0, 0.0),
    "right": (1.0, 0.0, 0.0),
    "left": (-1.0, 0.0, 0.0),
    "top": (0.0, 0.0, 1.0),
    "bottom": (0.0, 0.0, -1.0),
    "corner": (1.0, -1.0, 0.7),
}
"""Direction from what is seen to the eye; x is to the right of a view from the front."""

ANGLE = 24.0
"""Angle of view from bottom to top, degrees: small, so that lengths compare."""


class Camera(NamedTuple):
    """Places of eye and focus, (3,) m, and the direction that is up, (3,)."""

    eye: np.ndarray
    focus: np.ndarray
    up: np.ndarray


class Aim(NamedTuple):
    """Direction to the eye, (3,), how much larger than fitting things are drawn, and the name of what is followed."""

    eye: np.ndarray
    zoom: float
    follows: str = ""


CLOSE = 0.0
"""Zoom onto what is followed, unless another is asked for: as close as its size wants."""


def aim(asked: str, usual: tuple[float, float, float]) -> Aim:
    """Read what ``--camera`` says.

    Parameters
    ----------
    asked : str
        A name out of `VIEWS`, or azimuth and elevation in degrees, and a zoom: ``30,20`` or ``30,20,1.5``. Azimuth 0
        looks from the front, 90 from the right. ``@payload`` behind it, or alone, follows a thing by its name. Empty
        for the usual.
    usual : (3,) tuple

    Raises
    ------
    ResultError
        If it is neither.
    """
    asked, _, follows = (part.strip() for part in asked.partition("@"))
    if not asked or asked in VIEWS:
        return Aim(np.array(VIEWS.get(asked, usual), float), CLOSE if follows else 1.0, follows)
    try:
        numbers = [float(part) for part in asked.split(",")]
    except ValueError:
        numbers = []
    good = len(numbers) in (2, 3) and all(math.isfinite(number) for number in numbers)
    if not good or abs(numbers[1]) > 90.0 or (len(numbers) == 3 and not 0.01 <= numbers[2] <= 1000.0):
        cure = f"give {', '.join(VIEWS)}, or azimuth and elevation (-90 to 90) in degrees and a zoom, such as 30,20,1.5"
        raise ResultError("--camera", f"'{asked}' is no view", cure)
    azimuth, elevation = math.radians(numbers[0]), math.radians(numbers[1])
    flat = math.cos(elevation)
    eye = np.array([flat * math.sin(azimuth), -flat * math.cos(azimuth), math.sin(elevation)])
    return Aim(eye, numbers[2] if len(numbers) == 3 else CLOSE if follows else 1.0, follows)


def fitted(points: np.ndarray, to: Aim, aspect: float) -> Camera:
    """Place the eye so that points just fit into the picture.

    Parameters
    ----------
    points : (n, 3) array
        All that must be seen.
    to : Aim
    aspect : float
        Width over height of the room for them.
    """
    back = to.eye / np.linalg.norm(to.eye)
    up = np.array([0.0, 0.0, 1.0]) if abs(back[2]) < 0.999 else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    x, y, depth = points @ right, points @ up, points @ back
    middle = [0.5 * (v.min() + v.max()) for v in (x, y, depth)]
    slope = math.tan(math.radians(0.5 * ANGLE))
    half_x, half_y = np.abs(x - middle[0]), np.abs(y - middle[1])
    away = np.max(depth - middle[2] + np.maximum(half_y / slope, half_x / (slope * aspect)))
    size = max(float(np.ptp(points, axis=0).max()), 1e-6)
    away = max(float(away), size) / to.zoom
    focus = middle[0] * right + middle[1] * up + middle[2] * back
    return Camera(focus + away * back, focus, up)
