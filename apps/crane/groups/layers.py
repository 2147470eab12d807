"""Rope on a drum in layers: how far the drum has turned, and at what radius the rope lies."""

from __future__ import annotations

import math

import numpy as np

from crane.scene.scene import Drum


class Wound:
    """Rope on a drum, as a function of its length.

    With layers, a known amount of rope and a known diameter each layer has its own pitch radius; else there is one.
    Layers go on as long as rope comes, or up to their count.

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
        self.first, self.rise, self.last, self.layer_angle = drum.radius, 0.0, 0.0, math.inf
        layers, self.layered = drum.layers, False
        if layers is not None and diameter is not None and self.begin is not None:
            self.layered = True
            self.first = layers.pitch_radius(1, diameter)
            self.rise = layers.pitch_radius(2, diameter) - self.first
            self.last = math.inf if layers.count is None else layers.count - 1.0
            self.layer_angle = 2.0 * math.pi * layers.turns

    def _below(self, layer: np.ndarray) -> np.ndarray:
        """Rope in all layers below one, m, of which the lowest is 0."""
        return self.layer_angle * layer * (self.first + 0.5 * (layer - 1.0) * self.rise)

    def _layer(self, paid_out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rope on the drum, m, and the layer that it leaves from."""
        stored = np.maximum((self.begin or 0.0) - paid_out, 0.0) * self.stretch
        if not self.layered:
            return stored, np.zeros(stored.shape)
        # The root of _below(layer) = stored.
        middle = self.first - 0.5 * self.rise
        layer = (np.sqrt(middle**2 + 2.0 * self.rise * stored / self.layer_angle) - middle) / self.rise
        return stored, np.minimum(np.floor(layer), self.last)

    def radius_at(self, paid_out: np.ndarray) -> np.ndarray:
        """Pitch radius of the layer that the rope leaves from, m, when so much material has been paid out (m,)."""
        return self.first + self._layer(paid_out)[1] * self.rise

    def rotation_at(self, paid_out: np.ndarray) -> np.ndarray:
        """Angle by which the drum has turned since nothing was, rad, positive where it pays out."""
        if not self.layered:
            return paid_out * self.stretch / self.first
        return self._angle(np.zeros(1))[0] - self._angle(paid_out)

    def _angle(self, paid_out: np.ndarray) -> np.ndarray:
        """Angle that the rope on the drum takes up, rad."""
        stored, layer = self._layer(paid_out)
        return self.layer_angle * layer + (stored - self._below(layer)) / (self.first + layer * self.rise)
