"""How the direction of a taut line turns to second order, inside compiled code.

`crane.geometry.line` has de = E dd for d = c_b - c_a. With x_i = rho_i w_i, k = rho1 w1 - rho2 w2 and z = E^T y,

    y.d2e = -(y.e) de.de + z.d2(x2 - x1) - 2 (e.dd + k.de) (z.de),

in which w = u / |u|, u = e x a is bent by d2w = -(2 (w.du) du + (du.du) w - 3 (w.du)^2 w) / |u|^2, and the angle psi
follows with d2psi = 2 (w.de) (p.de) / c^2, p = a x w the direction in which the rim runs. All of it is exact for any
axes that stand still.
"""

from __future__ import annotations

from crane.geometry.line import AXES, AXIS, COS1, PLANE, POINT, W
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot

Y, Z, TURNED_Z = range(3)
"""Rows of ``vector``: y, z = E^T y, E^T z."""


@kernel
def radius_of(wheels, n):
    """Signed radius of a wheel, zero in place of a point."""
    return wheels[n].radius if n != POINT else 0.0


@kernel
def _add_second(line, side, rho, z, middle):
    """Add z.d2(rho w) to the form ``middle`` in de."""
    x = line.wheel[side]
    axis, w, plane = x[AXIS], x[W], x[PLANE]
    f = -rho / line.number[COS1 + side] ** 2
    turned = f * dot(z, w)
    for i in range(AXES):
        j, k = (i + 1) % AXES, (i + 2) % AXES
        across = f * (axis[j] * z[k] - axis[k] * z[j])
        for m in range(AXES):
            middle[i, m] += across * plane[m] - turned * (axis[i] * axis[m] + 3.0 * plane[i] * plane[m])
            middle[m, i] += across * plane[m]
        middle[i, i] += turned


@kernel
def add_psi(line, side, f, middle):
    """Add f d2psi to the form ``middle`` in de."""
    w, plane = line.wheel[side, W], line.wheel[side, PLANE]
    f /= line.number[COS1 + side] ** 2
    for i in range(AXES):
        for j in range(AXES):
            middle[i, j] += f * (w[i] * plane[j] + plane[i] * w[j])


@kernel
def add_turning(line, rho1, rho2, vector, middle):
    """Add to ``middle`` the form in de of y.d2e, and write z and E^T z, for what of it goes by e.dd."""
    e, turn = line.e, line.turn
    y, z, turned = vector[Y], vector[Z], vector[TURNED_Z]
    for i in range(AXES):
        z[i] = turn[0, i] * y[0] + turn[1, i] * y[1] + turn[2, i] * y[2]
    along = dot(y, e)
    for i in range(AXES):
        turned[i] = turn[0, i] * z[0] + turn[1, i] * z[1] + turn[2, i] * z[2]
        middle[i, i] -= along
    for side in range(2):
        rho = rho1 if side == 0 else rho2
        if rho != 0.0:
            w = line.wheel[side, W]
            f = -rho if side == 0 else rho
            for i in range(AXES):
                for j in range(AXES):
                    middle[i, j] += f * (w[i] * z[j] + z[i] * w[j])
            _add_second(line, side, f, z, middle)


@kernel
def sandwich(left, middle, right, out, row, column):
    """Write E1^T middle E2."""
    for i in range(AXES):
        for j in range(AXES):
            x = 0.0
            for k in range(AXES):
                x += left[k, i] * (middle[k, 0] * right[0, j] + middle[k, 1] * right[1, j] + middle[k, 2] * right[2, j])
            out[row + i, column + j] = x
