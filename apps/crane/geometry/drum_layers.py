"""Rope on a drum in layers: how far the drum has turned, and at what radius the rope lies."""

from __future__ import annotations

import math

import numpy as np


class DrumLayers:
    """Rope on a drum, as a function of its length: of one layer, or of layers that go on as long as rope comes.

    Parameters
    ----------
    radius : float
        Pitch radius of the only layer, or of the first, m.
    held : float or None
        Unstretched rope on the drum before any is paid out, m; None for no end of it, which has one layer only.
    stretch : float
        Of the rope that is wound: material comes as so much more length.
    rise : float
        Pitch radius of a layer over that of the one below, m; 0 for one layer.
    turns : int or None
        Of rope in a layer; None for one layer.
    count : int or None
        Layers that there may be: further rope lies in the last; None for any number.
    """

    def __init__(
        self,
        radius: float,
        held: float | None,
        stretch: float,
        rise: float = 0.0,
        turns: int | None = None,
        count: int | None = None,
    ) -> None:
        self.begin, self.stretch, self.first, self.rise = held, stretch, radius, rise
        self.layered = turns is not None
        self.layer_angle = math.inf if turns is None else 2.0 * math.pi * turns
        self.last = math.inf if count is None else count - 1.0

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
