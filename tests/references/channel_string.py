"""A soft string in a plane well whose hole has a width: a string in a channel, by finite differences and active sets.

Measured depth s down the hole, whose inclination phi(s) has the curvature k(s) = phi'; offset y from its axis towards
the low side, |y| <= r. With effective tension T and buoyed weight w across and along the hole,

    (T y')' + q - R = 0,   q = w sin(phi) - T k,   dT/ds = -w cos(phi) - eps mu |R|,

R the force per length on the wall, positive on the low side, zero where |y| < r: a string under tension that lies on
one wall or the other, or crosses freely between them. T and y are found in turn. eps = +1 for a string that is picked
up, -1 slacked off. Turning, |R| is less by sqrt(1 + mu^2) and does not act along the hole. No stretch, no bending.
Without clearance R = q.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

PASSES, SETS = 60, 400


@dataclass
class ChannelString:
    """At points s (n,) of even spacing from the top down: phi [rad], k [1/m], w [N/m], clearance r [m], od [m]."""

    s: np.ndarray
    inclination: np.ndarray
    curvature: np.ndarray
    weight: np.ndarray
    clearance: np.ndarray
    od: np.ndarray

    def solve(self, friction, eps):
        """Hook load [N], and torque [N m] at the top if it turned (eps = 0)."""
        h, n = self.s[1] - self.s[0], self.s.size
        tension, wall = np.zeros(n), np.zeros(n)
        for _ in range(PASSES):
            growth = self.weight * np.cos(self.inclination) + eps * friction * wall
            new = np.append(np.cumsum((0.5 * (growth[1:] + growth[:-1]) * h)[::-1])[::-1], 0.0)
            if abs(new[0] - tension[0]) < 1e-7 * abs(new[0]):
                turning = friction / np.hypot(1.0, friction)
                return new[0], np.trapezoid(turning * wall * 0.5 * self.od, self.s)
            tension = new
            wall = np.abs(self.on_the_wall(tension, h))
        raise RuntimeError("tension and shape were not found together")

    def on_the_wall(self, tension, h):
        """Force per length on the wall, positive on the low side [N/m]."""
        n, r = self.s.size, self.clearance
        q = self.weight * np.sin(self.inclination) - tension * self.curvature
        stiffness = np.maximum(0.5 * (tension[1:] + tension[:-1]), 1.0) / h**2
        share = np.append(np.ones(n - 1), 0.5)
        low, high = q > 0.0, q < 0.0
        for _ in range(SETS):
            held = low | high
            held[0] = True
            bands = np.zeros((3, n))
            bands[1, :-1] += stiffness
            bands[1, 1:] += stiffness
            bands[0, 1:] = np.where(held[:-1], 0.0, -stiffness)
            bands[2, :-1] = np.where(held[1:], 0.0, -stiffness)
            bands[1, held] = 1.0
            at = np.where(low, r, np.where(high, -r, 0.0))
            y = solve_banded((1, 1), bands, np.where(held, at, q * share))
            pull = stiffness * np.diff(y)
            force = q * share + np.append(pull, 0.0) - np.append(0.0, pull)
            force = np.where(held, force, 0.0)
            force[0] = 0.0
            before = low, high
            low, high = force + 1e9 * (y - r) > 0.0, force + 1e9 * (y + r) < 0.0
            if np.array_equal(before[0], low) and np.array_equal(before[1], high):
                return force / share
        raise RuntimeError("what touches the wall was not found")
