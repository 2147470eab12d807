"""Tubes along lines: rings of points that do not twist, for any curve, all points at once."""

from __future__ import annotations

import numpy as np

SHORT = 1e-12
"""Share of a line's length below which a piece of it has no direction."""


def tangents(points: np.ndarray) -> np.ndarray:
    """Unit tangents at the points (m, 3) of a line; where points coincide, those of the nearest piece before."""
    piece = np.diff(points, axis=0)
    length = np.linalg.norm(piece, axis=1)
    longest = length.max(initial=0.0)
    if not longest > 0.0:
        return np.tile([0.0, 0.0, 1.0], (len(points), 1))
    there = length > SHORT * longest
    # Pieces without a direction take that of the last one which has it, and the first ones that of the next.
    last = np.maximum.accumulate(np.where(there, np.arange(len(piece)), -1))
    source = np.where(last < 0, int(np.argmax(there)), last)
    way = piece[source] / length[source, None]
    around = np.concatenate([way[:1], way]) + np.concatenate([way, way[-1:]])
    size = np.linalg.norm(around, axis=1, keepdims=True)
    # Where a line turns back on itself its sides cancel.
    return np.where(size > 1e-6, around / np.maximum(size, 1e-6), np.concatenate([way, way[-1:]]))


def normals(tangent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two normals, each (m, 3), of unit tangents, carried along a line without twisting about it.

    Every point starts with a normal of its own; the angle by which each is twisted against the one before, carried on
    by the least rotation between their tangents, is added up and turned back.
    """
    u = np.cross(tangent, np.eye(3)[np.argmin(np.abs(tangent), axis=1)])
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(tangent, u)
    a, b = tangent[:-1], tangent[1:]
    bend = np.maximum(1.0 + np.einsum("ij,ij->i", a, b), 1e-9)
    carried = u[:-1] - (np.einsum("ij,ij->i", b, u[:-1]) / bend)[:, None] * (a + b)
    twist = np.arctan2(np.einsum("ij,ij->i", carried, v[1:]), np.einsum("ij,ij->i", carried, u[1:]))
    angle = np.concatenate([[0.0], np.cumsum(twist)])[:, None]
    c, s = np.cos(angle), np.sin(angle)
    return c * u + s * v, c * v - s * u


def rings(points: np.ndarray, radius: float | np.ndarray, sides: int) -> tuple[np.ndarray, np.ndarray]:
    """Points of a tube, and the outward normals there.

    Parameters
    ----------
    points : (m, 3) array
    radius : float or (m,) array
    sides : int

    Returns
    -------
    points, normals : (m sides, 3) array
        Ring after ring.
    """
    u, v = normals(tangents(points))
    angle = 2.0 * np.pi * np.arange(sides) / sides
    out = np.cos(angle)[:, None] * u[:, None] + np.sin(angle)[:, None] * v[:, None]
    at = points[:, None] + np.broadcast_to(radius, len(points))[:, None, None] * out
    return at.reshape(-1, 3), out.reshape(-1, 3)


def skin(count: int, sides: int, closed: bool) -> np.ndarray:
    """Triangles (k, 3) of a tube of `count` rings, with its ends closed or open."""
    i, j = np.meshgrid(np.arange(count - 1), np.arange(sides), indexing="ij")
    a, b = i * sides + j, i * sides + (j + 1) % sides
    c, d = a + sides, b + sides
    faces = [np.stack([a, b, d], axis=-1).reshape(-1, 3), np.stack([a, d, c], axis=-1).reshape(-1, 3)]
    if closed:
        k = np.arange(1, sides - 1)
        first, last = np.zeros_like(k), np.full_like(k, (count - 1) * sides)
        faces += [np.stack([first, k + 1, k], axis=-1), np.stack([last, last + k, last + k + 1], axis=-1)]
    return np.concatenate(faces)
