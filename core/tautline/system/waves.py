"""A sea of long-crested waves, as a sum of sines (linear theory, Airy)."""

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
        Where the phases hold, m: the vessel's reference, if the vessel answers them.
    ramp : float
        Time over which the sea grows from nothing, s.
    depth, gravity : float
        Of the water, m, and m/s^2.
    """

    amplitude: np.ndarray
    frequency: np.ndarray
    phase: np.ndarray
    number: np.ndarray
    direction: np.ndarray
    origin: np.ndarray
    ramp: float = 0.0
    depth: float = np.inf
    gravity: float = EARTH_GRAVITY

    def elevation(self, x: Any, y: Any, time: Any) -> np.ndarray:
        """Height above still water, m, at places x and y, m, and times, s, which broadcast.

        It is the sum of ``a sin(w t + phi - k s)``; s is the distance from the origin along the direction.
        """
        (east, north), (x0, y0) = self.direction, self.origin
        along = (np.asarray(x, float) - x0) * east + (np.asarray(y, float) - y0) * north
        time = np.asarray(time, float)
        # Wave by wave: all of them at all places and times may be more than the memory holds.
        height = np.zeros(np.broadcast_shapes(along.shape, time.shape))
        for a, w, phi, k in zip(self.amplitude, self.frequency, self.phase, self.number, strict=True):
            height += a * np.sin(w * time + phi - k * along)
        return np.asarray(self.grown(time) * height)

    def grown(self, time: Any) -> np.ndarray:
        """Share of its full height that the sea has: a quintic, as that of every ramp in a scene."""
        if self.ramp <= 0.0:
            return np.ones_like(time, dtype=float)
        share = np.clip(np.asarray(time, float) / self.ramp, 0.0, 1.0)
        return np.asarray(share**3 * (10.0 - 15.0 * share + 6.0 * share**2))

    def highest(self) -> float:
        """Three standard deviations of the surface's height, m, or the sum of all amplitudes if that is less."""
        return _bound(self.amplitude)

    def fastest(self) -> float:
        """The same of its rate, m/s."""
        return _bound(self.amplitude * self.frequency)


def _bound(amplitude: np.ndarray) -> float:
    return float(min(3.0 * np.sqrt(0.5 * (amplitude**2).sum()), np.abs(amplitude).sum()))


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
