"""Products and turns of what moves, with both derivatives: value, rate and second rate in the first dimension."""

from __future__ import annotations

import numpy as np


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of matrices given with both derivatives, (3, m, i, j) and (3, m, j, k)."""
    return np.stack((a[0] @ b[0], a[1] @ b[0] + a[0] @ b[1], a[2] @ b[0] + 2.0 * (a[1] @ b[1]) + a[0] @ b[2]))


def about(axis: int, angle: np.ndarray) -> np.ndarray:
    """Rotation about a coordinate axis with both derivatives (3, m, 3, 3), from those of the angle (3, m)."""
    q, dq, ddq = angle
    c, s = np.cos(q), np.sin(q)
    cosine = np.stack((c, -s * dq, -c * dq * dq - s * ddq))
    sine = np.stack((s, c * dq, -s * dq * dq + c * ddq))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn = np.zeros((3, q.size, 3, 3))
    turn[0, :, axis, axis] = 1.0
    turn[..., i, i] = turn[..., j, j] = cosine
    turn[..., j, i], turn[..., i, j] = sine, -sine
    return turn


def rotation(roll: np.ndarray, pitch: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    """``Rz(yaw) Ry(pitch) Rx(roll)`` with both derivatives (3, m, 3, 3), from those of the angles (3, m)."""
    return product(about(2, yaw), product(about(1, pitch), about(0, roll)))
