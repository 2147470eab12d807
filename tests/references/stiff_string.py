"""A stiff string in a plane well under friction all one way: a boundary value problem, integrated with scipy.

Measured depth s down the hole, whose inclination phi(s) has the curvature k = phi' constant on each piece; offset y
from its axis towards the side to which it builds, where offsets and slopes are small against lengths and one. The
string has the inclination phi + y', the curvature k + y'' and the moment M = EI (k + y''); with effective tension T,
shear V, weight w and the wall's force N per metre towards +y, balance along the string, across it and of moments is

    T' = (k + y'') V - w cos(phi + y') - eps mu |N|,   V' = w sin(phi + y') - (k + y'') T - N,   M' = -V,

eps = +1 for a string that is picked up, -1 slacked off. N is that of elastic walls at +-r of the stiffness c [N/m^2].
The string is held on the axis at the top, without moment, and free at the bit: y = M = 0 there, V = M = T = 0 here.
Stretch is not counted. Without V and M this is the soft string.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_bvp

Y, SLOPE, MOMENT, SHEAR, TENSION = range(5)


@dataclass
class StiffString:
    """Pieces (length [m], curvature [1/m]) of the hole from the vertical top; EI [N m^2], w [N/m], r [m], c [N/m^2]."""

    pieces: list
    rigidity: float
    weight: float
    clearance: float
    wall: float

    def wall_force(self, y):
        """Force of both walls on the string, positive towards +y [N/m]."""
        return self.wall * (np.maximum(0.0, -y - self.clearance) - np.maximum(0.0, y - self.clearance))

    def solve(self, friction, eps, points=60):
        """Measured depth (n,), and y, y', M, V, T (5, n), from the top down."""
        lengths = np.array([length for length, _ in self.pieces])
        bends = np.array([k for _, k in self.pieces])
        starts = np.concatenate([[0.0], np.cumsum(lengths)])[:-1]
        inclined = np.concatenate([[0.0], np.cumsum(lengths * bends)])[:-1]
        force, count = self.weight * lengths.sum(), lengths.size
        unit = np.array([1.0, 1.0, force, force, force])

        def slopes(x, z):
            z = z.reshape(count, 5, -1) * unit[:, None]
            out = np.empty_like(z)
            for i in range(count):
                y, turn, moment, shear, tension = z[i]
                angle = inclined[i] + bends[i] * lengths[i] * x + turn
                curvature, wall = moment / self.rigidity, self.wall_force(y)
                out[i, Y], out[i, SLOPE], out[i, MOMENT] = turn, curvature - bends[i], -shear
                out[i, SHEAR] = self.weight * np.sin(angle) - curvature * tension - wall
                out[i, TENSION] = curvature * shear - self.weight * np.cos(angle) - eps * friction * np.abs(wall)
                out[i] *= lengths[i]
            return (out / unit[:, None]).reshape(5 * count, -1)

        def ends(top, bit):
            top, bit = top.reshape(count, 5), bit.reshape(count, 5)
            return np.concatenate(
                [top[0, [Y, MOMENT]], bit[-1, [MOMENT, SHEAR, TENSION]], (top[1:] - bit[:-1]).ravel()]
            )

        mesh = np.linspace(0.0, 1.0, points)
        guess = np.zeros((count, 5, points))
        for i in range(count):
            below = lengths.sum() - starts[i] - lengths[i] * mesh
            guess[i, TENSION], guess[i, MOMENT] = below / lengths.sum(), self.rigidity * bends[i] / force
        guess = guess.reshape(5 * count, -1)
        # The wall and its friction grow to what they are.
        whole = self.wall
        try:
            for part in (1e-3, 1e-2, 0.1, 1.0):
                self.wall = part * whole
                found = solve_bvp(slopes, ends, mesh, guess, tol=1e-5, max_nodes=20000)
                assert found.success, found.message
                mesh, guess = found.x, found.y
        finally:
            self.wall = whole
        values = found.y.reshape(count, 5, -1) * unit[:, None]
        depth = (starts[:, None] + lengths[:, None] * found.x).ravel()
        return depth, np.concatenate(list(values), axis=1)
