"""The wall force of a string that has buckled into a helix, and the end of that: lock-up.

Beyond the helical limit (buckling.py) the string lies all around the hole with a pitch that its compression F sets, and
presses on the wall with N = r F^2/(4 EI) on average (R. F. Mitchell, "Simple frictional analysis of helical buckling of
tubing", SPE Drilling Engineering 1(6), 1986); its weight across the hole presses as much on one side as it lifts on the
other. At the limit that is twice what the string lying in the hole has, and its friction makes the compression grow up
the hole, and that the wall force. In a level hole F = F0/(1 - mu r F0 s/(4 EI)) at a distance s above F0, which is
endless at s = 4 EI/(mu r F0): no force at the top moves the bit. That is lock-up. In a vertical hole, where weight
works against it, dF/ds = mu r F^2/(4 EI) - w up the hole.
"""

from __future__ import annotations

import numpy as np

LOCKED_STRAIN = 5.0e-3
"""Compressive strain at which a string has locked up: past the yield of any drill pipe, and the compression that leads
to it grows without end."""


class LockedUp(Exception):
    """The compression grows without end on the way up; ``measured_depth`` is where it has outgrown the pipe, m."""

    def __init__(self, measured_depth: float) -> None:
        super().__init__(f"locked up: compression outgrows the pipe at {measured_depth:.0f} m")
        self.measured_depth = measured_depth


def helix_force(compression: np.ndarray | float, clearance: np.ndarray, rigidity: np.ndarray) -> np.ndarray:
    """Wall force per length, N/m, of a helix under a compression N: r F^2/(4 EI)."""
    return clearance * compression**2 / (4.0 * rigidity)
