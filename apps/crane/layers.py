"""Rope on a drum in layers: how far the drum has turned, and at what radius the rope lies."""

from __future__ import annotations

import math

import numpy as np

from crane.scene import Drum

MOST_LAYERS = 1000


class Wound:
    """Rope on a drum, as a function of its length.

    With layers, a known amount of rope and a known diameter each layer has its own pitch radius; else there is one.

    Parameters
    ----------
    drum : Drum
    diameter : float or None
        Of the rope, m.
    stretch : float
        Of the rope that is wound: material comes as so much more length.
    """

    def __init__(self, drum: Drum, diameter: float | None, stretch: float) -> None:
        self.begin, self.stretch = drum.rope_on_drum, stretch
        self.radius = np.array([drum.radius])
        self.full = np.array([math.inf])
        if drum.layers is None or diameter is None or self.begin is None:
            return
        radii, full, wanted = [], [0.0], 2.0 * self.begin + 1.0
        while full[-1] < wanted and len(radii) < (drum.layers.count or MOST_LAYERS):
            radii.append(drum.layers.pitch_radius(len(radii) + 1, diameter))
            full.append(full[-1] + 2.0 * math.pi * radii[-1] * drum.layers.turns)
        self.radius, self.full = np.array(radii), np.array(full[1:])
        self.full[-1] = math.inf

    def _layer(self, paid_out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        stored = np.maximum((self.begin or 0.0) - paid_out, 0.0) * self.stretch
        return stored, np.searchsorted(self.full, stored, side="right")

    def radius_at(self, paid_out: np.ndarray) -> np.ndarray:
        """Pitch radius of the layer that the rope leaves from, m, when so much material has been paid out (m,)."""
        return self.radius[self._layer(paid_out)[1]]

    def rotation_at(self, paid_out: np.ndarray) -> np.ndarray:
        """Angle by which the drum has turned since nothing was, rad, positive where it pays out."""
        if self.radius.size == 1:
            return paid_out * self.stretch / self.radius[0]
        start = np.zeros(1)
        return self._angle(start)[0] - self._angle(paid_out)

    def _angle(self, paid_out: np.ndarray) -> np.ndarray:
        """Angle that the rope on the drum takes up, rad."""
        stored, layer = self._layer(paid_out)
        below = np.concatenate(([0.0], self.full[:-1]))
        turned = np.concatenate(([0.0], np.cumsum(np.diff(below) / self.radius[:-1])))
        return turned[layer] + (stored - below[layer]) / self.radius[layer]
