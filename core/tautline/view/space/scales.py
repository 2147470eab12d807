"""Scales beside what is seen: heights with round numbers."""

from __future__ import annotations

import numpy as np

from tautline.view.figures.figure import round_numbers, scale_in
from tautline.view.space.appearance import Appearance, Ruler

ASIDE = 0.06
"""Distance of a scale from what it stands beside, over the size of the picture."""
TICKS = 8
FLAT = 0.05
"""Height over size below which a picture needs no scale of heights."""


def grid_pitch(size: float) -> float:
    """Pitch of a grid on the ground: 1, 2 or 5 times a power of ten, at most an eighth of the picture's size.

    It is in the unit of the size, in which it is round.
    """
    power = 10.0 ** np.floor(np.log10(size / 8.0))
    return float(power * next(digit for digit in (5.0, 2.0, 1.0) if digit * power <= size / 8.0 * (1.0 + 1e-6)))


def scales(appearance: Appearance, points: np.ndarray) -> tuple[Ruler, ...]:
    """Rulers of an appearance; where it has none, one of heights, on the left of points (n, 3), m, as seen."""
    if appearance.rulers:
        return appearance.rulers
    low, high = points.min(axis=0), points.max(axis=0)
    tall, size = float(high[2] - low[2]), float((high - low).max())
    if not tall > FLAT * size:
        return ()
    left = np.cross(appearance.eye, [0.0, 0.0, 1.0])
    length = float(np.linalg.norm(left))
    left = left / length if length > 1e-6 else np.array([-1.0, 0.0, 0.0])
    middle = 0.5 * (low + high)[:2]
    far = float(((points[:, :2] - middle) @ left[:2]).max())
    foot = middle + (far + ASIDE * size) * left[:2]
    factor, unit = scale_in(appearance.units, [np.array([low[2], high[2]])], "m")
    numbers = np.array(round_numbers(low[2] / factor, high[2] / factor, TICKS))
    if len(numbers) < 2:
        return ()
    ticks = np.column_stack([np.broadcast_to(foot, (len(numbers), 2)), factor * numbers])
    # The topmost is first: that is where the name stands.
    return (Ruler("height", unit, ticks[::-1], numbers[::-1]),)
