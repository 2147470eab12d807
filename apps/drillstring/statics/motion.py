"""How a string is moved slowly, and which way friction acts on it: up or down the hole, turned, or both at once.

The surface of a pipe of radius R that goes down the hole at v and turns at Omega slips at (v, R Omega). Coulomb's
friction has its full size mu N and is against the slip, so rotation takes friction off the hook: along the hole there
is ``mu N v / sqrt(v^2 + R^2 Omega^2)``, around it ``mu N R Omega / sqrt(v^2 + R^2 Omega^2)`` (combined motion of
B. S. Aadnoy and K. Andersen, "Design of oil wells using analytical friction models", J. Petroleum Science and
Engineering 32, 2001). Only the ratio of the speeds counts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Motion(NamedTuple):
    """Speed along the hole, m/s, positive down, and rotary speed, rad/s, clockwise; not both zero."""

    speed: float
    rotary: float

    def friction(self, radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unit direction of the friction force on pipes of a radius (n,) m: along the hole and around, (n,) each."""
        around = np.asarray(radius, float) * self.rotary
        size = np.hypot(self.speed, around)
        return -self.speed / size, -around / size


MOTIONS = {"pick_up": Motion(-1.0, 0.0), "slack_off": Motion(1.0, 0.0), "rotating": Motion(0.0, 1.0)}
"""Picked up, slacked off, turned off bottom."""
REAMING = ("reaming_up", "reaming_down")


def reaming(speed: float, rotary: float) -> dict[str, Motion]:
    """Up and down the hole at a speed, m/s, while the string turns, rad/s."""
    return dict(zip(REAMING, (Motion(-speed, rotary), Motion(speed, rotary)), strict=True))
