"""The surface of a sea: long-crested waves that a vessel's motion is the response to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tautline.scene.vector import EARTH_GRAVITY


@dataclass(frozen=True, eq=False)
class Waves:
    """Sines that run in one direction (linear theory, Airy).

    Attributes
    ----------
    amplitude, frequency, phase, number : (n,) array
        m, rad/s, rad, and the wave number, rad/m.
    direction : (2,) array
        Unit vector in which the waves run.
    origin : (2,) array
        Where the phases hold, m: the vessel's reference.
    ramp : float
        Time over which the sea grows from nothing, s.
    """

    amplitude: np.ndarray
    frequency: np.ndarray
    phase: np.ndarray
    number: np.ndarray
    direction: np.ndarray
    origin: np.ndarray
    ramp: float = 0.0

    def elevation(self, x: Any, y: Any, time: float) -> np.ndarray:
        """Height above still water, m, at places x and y, m, of one shape.

        It is the sum of ``a sin(w t + phi - k s)``; s is the distance from the origin along the direction.
        """
        at = np.stack(np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float)), axis=-1) - self.origin
        angle = self.frequency * time + self.phase - (at @ self.direction)[..., None] * self.number
        return np.asarray(self.grown(time) * (self.amplitude * np.sin(angle)).sum(axis=-1))

    def grown(self, time: float) -> float:
        """Share of its full height that the sea has: a quintic, as that of every ramp in a scene."""
        if self.ramp <= 0.0:
            return 1.0
        share = min(max(time / self.ramp, 0.0), 1.0)
        return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


def wave_number(frequency: np.ndarray, depth: float = np.inf, gravity: float = EARTH_GRAVITY) -> np.ndarray:
    """Wave numbers, rad/m, of frequencies, rad/s, in water of a depth, m: ``w^2 = g k tanh(k d)``, by Newton's method.

    The start is that of Fenton and McKee (1990), within 2 % of the root.
    """
    w2 = np.asarray(frequency, float) ** 2
    if not np.isfinite(depth):
        return w2 / gravity
    deep = w2 * depth / gravity
    kd = deep / np.tanh(deep**0.75) ** (2.0 / 3.0)
    for _ in range(6):
        th = np.tanh(kd)
        kd = kd - (kd * th - deep) / (th + kd * (1.0 - th**2))
    return kd / depth
