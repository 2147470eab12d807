"""Quaternions of rigid bodies: products that attitudes and levers are made of.

A body's attitude is a quaternion Q = (s, x, y, z) of any length: R turns the body's axes into space by Q / |Q|, and a
vector o of the body is at R o = vec(Q o Q*) / N, N = Q.Q. G(Q) b = vec(Q* b).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin

import numpy as np

from crane.geometry.line import AXES
from tautline.kernels.jit import kernel

QUATERNION = 4
"""Numbers of a quaternion."""


@kernel
def into_body(a, i, b, j, out):
    """G(a) b, of quaternions that begin at places i and j."""
    s, x, y, z = a[i], a[i + 1], a[i + 2], a[i + 3]
    out[0] = s * b[j + 1] - b[j] * x - (y * b[j + 3] - z * b[j + 2])
    out[1] = s * b[j + 2] - b[j] * y - (z * b[j + 1] - x * b[j + 3])
    out[2] = s * b[j + 3] - b[j] * z - (x * b[j + 2] - y * b[j + 1])


@kernel
def out_of_body(a, i, b, out):
    """G(a)^T b (4,) of a vector b of the body."""
    s, x, y, z = a[i], a[i + 1], a[i + 2], a[i + 3]
    out[0] = -(x * b[0] + y * b[1] + z * b[2])
    out[1] = s * b[0] + y * b[2] - z * b[1]
    out[2] = s * b[1] + z * b[0] - x * b[2]
    out[3] = s * b[2] + x * b[1] - y * b[0]


@kernel
def product(a, i, b, j):
    """Of two quaternions that begin at places i and j."""
    return a[i] * b[j] + a[i + 1] * b[j + 1] + a[i + 2] * b[j + 2] + a[i + 3] * b[j + 3]


@kernel
def pair(o, a, i, b, j, out):
    """The symmetric bilinear form of two quaternions that is vec(Q o Q*) of one."""
    plain, along_a, along_b = a[i] * b[j], 0.0, 0.0
    for c in range(AXES):
        plain -= a[i + 1 + c] * b[j + 1 + c]
        along_a += a[i + 1 + c] * o[c]
        along_b += b[j + 1 + c] * o[c]
    x = a[i] * b[j + 1] + b[j] * a[i + 1]
    y = a[i] * b[j + 2] + b[j] * a[i + 2]
    z = a[i] * b[j + 3] + b[j] * a[i + 3]
    for c in range(AXES):
        out[c] = plain * o[c] + along_a * b[j + 1 + c] + along_b * a[i + 1 + c]
    out[0] += y * o[2] - z * o[1]
    out[1] += z * o[0] - x * o[2]
    out[2] += x * o[1] - y * o[0]


def quaternion_of(orientation: Sequence[float]) -> np.ndarray:
    """Quaternion (4,) of ``Rz(yaw) Ry(pitch) Rx(roll)``, from roll, pitch and yaw, rad."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(0.5 * angle), sin(0.5 * angle)) for angle in orientation)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def rotation_of(quaternion: np.ndarray) -> np.ndarray:
    """Matrices (..., 3, 3) whose columns are a body's axes in space, from quaternions (..., 4) of any length."""
    unit = quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True)
    s, v = unit[..., :1, None], unit[..., 1:]
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack((zero, -z, y, z, zero, -x, -y, x, zero), axis=-1).reshape(*x.shape, 3, 3)
    return np.eye(3) + 2.0 * (s * cross + cross @ cross)


def turned_least(quaternion: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """A quaternion (4,) turned further by the least rotation that brings a direction to another, (3,) of any length.

    Of opposite directions all rotations by half a turn across them are least: it is one of them.
    """
    one, other = one / np.linalg.norm(one), other / np.linalg.norm(other)
    cosine = float(one @ other)
    across = np.cross(one, other)
    if cosine < -1.0 + 1e-12:
        across = np.cross(one, np.eye(AXES)[int(np.argmin(np.abs(one)))])
        least = np.array([0.0, *(across / np.linalg.norm(across))])
    else:
        least = np.array([1.0 + cosine, *across])
        least = least / np.linalg.norm(least)
    s, v, w, x = least[0], least[1:], quaternion[0], quaternion[1:]
    return np.array([s * w - v @ x, *(s * x + w * v + np.cross(v, x))])
