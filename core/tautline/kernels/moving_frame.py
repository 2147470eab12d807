"""Frames that move by prescription: where they are, exactly and for large angles, with two derivatives.

A point that is drawn at x in a frame with pivot p stands at ``C + R (x - p)``: C is where the pivot is. Twelve numbers
place a frame: the three of C, then the columns of R one after another. They follow from the frame's six motions and its
parent's place: nothing is differenced. Nor do they depend on how far from the scene's origin anything is drawn.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel

ENTRIES, MOTIONS, AXES = 12, 6, 3


class MovingFrames(NamedTuple):
    """The frames of a scene, parents before children.

    Attributes
    ----------
    parent : int64 (k,)
        Number of the frame that each stands in, -1 for the ground.
    pivot : float64 (k, 3)
        The point that it turns about, as it is drawn, m.
    motion : int64 (k, 6)
        Functions of its surge, sway and heave (m), roll, pitch and yaw (rad); -1 where it has none.
    placed : float64 (k, 3, 12)
        Its place, with first and second derivative, at ``time`` (1,) s.
    moved : float64 (6, 3)
        Scratch: the motions of a frame with both derivatives.
    turns : float64 (3, 3, 3, 3)
        Scratch: three rotations with both derivatives.
    """

    parent: np.ndarray
    pivot: np.ndarray
    motion: np.ndarray
    placed: np.ndarray
    time: np.ndarray
    moved: np.ndarray
    turns: np.ndarray


class Lifts(NamedTuple):
    """How far one frame's motion lifts points that ride on others, some time ago, times a gain: heave that is answered.

    Attributes
    ----------
    frame, still : int64 (n,)
        Number of the frame that the point rides on, and of that whose motion counts.
    point : float64 (n, 3)
        Where it is drawn, m.
    gain, delay, offset : float64 (n,)
        ``gain (z(t - delay) - z_still(t - delay)) + offset``; before t = 0 the lift is what it is then.
    """

    frame: np.ndarray
    still: np.ndarray
    point: np.ndarray
    gain: np.ndarray
    delay: np.ndarray
    offset: np.ndarray


def new_frames(parent: np.ndarray, pivot: np.ndarray, motion: np.ndarray) -> MovingFrames:
    """Frames that are not placed yet."""
    k = len(parent)
    return MovingFrames(
        np.asarray(parent, np.int64).reshape(k), np.asarray(pivot, float).reshape(k, AXES),
        np.asarray(motion, np.int64).reshape(k, MOTIONS), np.zeros((k, AXES, ENTRIES)), np.full(1, np.nan),
        np.zeros((MOTIONS, AXES)), np.zeros((AXES,) * 4),
    )  # fmt: skip


@kernel
def height(frames, k, point, order):
    """Height of a point of a frame as it is placed, m, or a derivative of it."""
    place, z = frames.placed[k, order], 0.0
    for j in range(AXES):
        z += (point[j] - frames.pivot[k, j]) * place[AXES * (j + 1) + 2]
    return place[2] + z


@kernel
def clear_place(frames):
    """Forget the motions of the frame before."""
    for c in range(MOTIONS):
        for d in range(AXES):
            frames.moved[c, d] = 0.0


@kernel
def _turn(axis, moved, out):
    """Rotation about a coordinate axis with both derivatives, from those of the angle."""
    q, dq, ddq = moved[0], moved[1], moved[2]
    c, s = np.cos(q), np.sin(q)
    i, j = (axis + 1) % AXES, (axis + 2) % AXES
    for d in range(AXES):
        for row in range(AXES):
            for column in range(AXES):
                out[d, row, column] = 0.0
    out[0, axis, axis] = 1.0
    cosine, sine = c, s
    for d in range(AXES):
        if d == 1:
            cosine, sine = -s * dq, c * dq
        elif d == 2:
            cosine, sine = -c * dq * dq - s * ddq, -s * dq * dq + c * ddq
        out[d, i, i] = cosine
        out[d, j, j] = cosine
        out[d, j, i] = sine
        out[d, i, j] = -sine


@kernel
def _product(a, b, out):
    """Product of two matrices that are given with both derivatives."""
    for i in range(AXES):
        for j in range(AXES):
            value, rate, second = 0.0, 0.0, 0.0
            for k in range(AXES):
                value += a[0, i, k] * b[0, k, j]
                rate += a[1, i, k] * b[0, k, j] + a[0, i, k] * b[1, k, j]
                second += a[2, i, k] * b[0, k, j] + 2.0 * a[1, i, k] * b[1, k, j] + a[0, i, k] * b[2, k, j]
            out[0, i, j] = value
            out[1, i, j] = rate
            out[2, i, j] = second


@kernel
def place_frame(frames, k):
    """Place a frame from its motions in ``moved``: R = Rz(yaw) Ry(pitch) Rx(roll), C = pivot + motion.

    In a parent's frame R is multiplied by the parent's, and C is a point of the parent.
    """
    placed, one, two, three = frames.placed, frames.turns[0], frames.turns[1], frames.turns[2]
    _turn(0, frames.moved[3], one)
    _turn(1, frames.moved[4], two)
    _product(two, one, three)
    _turn(2, frames.moved[5], two)
    _product(two, three, one)
    parent = frames.parent[k]
    for i in range(AXES):
        drawn = frames.pivot[k, i] - (frames.pivot[parent, i] if parent >= 0 else 0.0)
        placed[k, 0, i] = drawn + frames.moved[i, 0]
        placed[k, 1, i], placed[k, 2, i] = frames.moved[i, 1], frames.moved[i, 2]
    if parent >= 0:
        for d in range(AXES):
            for i in range(AXES):
                for j in range(AXES):
                    two[d, i, j] = placed[parent, d, AXES * (j + 1) + i]
        for i in range(AXES):
            value, rate, second = placed[parent, 0, i], placed[parent, 1, i], placed[parent, 2, i]
            for j in range(AXES):
                way, v, a = placed[k, 0, j], placed[k, 1, j], placed[k, 2, j]
                value += two[0, i, j] * way
                rate += two[1, i, j] * way + two[0, i, j] * v
                second += two[2, i, j] * way + 2.0 * two[1, i, j] * v + two[0, i, j] * a
            three[0, 0, i], three[1, 0, i], three[2, 0, i] = value, rate, second
        for d in range(AXES):
            for i in range(AXES):
                placed[k, d, i] = three[d, 0, i]
        _product(two, one, three)
        one = three
    for d in range(AXES):
        for i in range(AXES):
            for j in range(AXES):
                placed[k, d, AXES * (j + 1) + i] = one[d, i, j]


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
    turn = np.zeros((3, q.size, 3, 3), q.dtype)
    turn[0, :, axis, axis] = 1.0
    turn[..., i, i] = turn[..., j, j] = cosine
    turn[..., j, i], turn[..., i, j] = sine, -sine
    return turn


def rotation(roll: np.ndarray, pitch: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    """``Rz(yaw) Ry(pitch) Rx(roll)`` with both derivatives (3, m, 3, 3), from those of the angles (3, m)."""
    return product(about(2, yaw), product(about(1, pitch), about(0, roll)))


def places_of(parent: np.ndarray, pivot: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places of frames while their motions have given values, for callers in Python.

    Parameters
    ----------
    parent : int (k,)
        Number of the frame that each stands in, -1 for the ground; parents come before children.
    pivot : float64 (k, 3)
        m.
    values : float64 (k, 6, m, 3)
        Value, rate and second rate of every frame's motions at m times.

    Returns
    -------
    value, rate, second : float64 (m, k, 12)
    """
    m = values.shape[2]
    placed = np.empty((3, m, len(parent), ENTRIES), values.dtype)
    places: list[np.ndarray] = []
    turns: list[np.ndarray] = []
    for k, above in enumerate(parent):
        derivatives = np.moveaxis(values[k], 2, 0)
        turn = rotation(*derivatives[:, 3:].transpose(1, 0, 2))
        place = np.ascontiguousarray(derivatives[:, :3].transpose(0, 2, 1))
        place[0] += pivot[k] - (pivot[above] if above >= 0 else 0.0)
        if above >= 0:
            place = places[above] + product(turns[above], place[..., None])[..., 0]
            turn = product(turns[above], turn)
        places.append(place)
        turns.append(turn)
        placed[:, :, k, :3] = place
        placed[:, :, k, 3:] = turn.transpose(0, 1, 3, 2).reshape(3, m, 9)
    return placed[0], placed[1], placed[2]
