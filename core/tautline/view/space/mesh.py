"""Triangles of simple bodies, (points, triangles): what is turned about an axis, and boxes."""

from __future__ import annotations

from typing import Any

import numpy as np

SIDES = 48
"""Of what is round."""

Mesh = tuple[np.ndarray, np.ndarray]
"""Points (n, 3), m, and triangles (k, 3), anticlockwise seen from outside."""


def turned_about(profile: Any, sides: int = SIDES) -> Mesh:
    """Turn a profile about z: cylinders, cones, sheaves with a groove, drums with flanges, capsules.

    Parameters
    ----------
    profile : (k, 2) array
        Radius and z of its corners, m, from the bottom upwards along the outside; begin and end on the axis, at radius
        0, for a closed body. A body with a bore goes round its profile, ending where it began.
    sides : int

    Returns
    -------
    points : (k sides, 3) array
    triangles : (2 (k - 1) sides, 3) array
        Those that a radius of zero makes empty are left out.
    """
    profile = np.asarray(profile, float)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    radial = profile[:, None, :1] * ring
    points = np.concatenate([radial, np.broadcast_to(profile[:, None, 1:], (*radial.shape[:2], 1))], axis=-1)
    i, j = np.meshgrid(np.arange(len(profile) - 1), np.arange(sides), indexing="ij")
    a, b = i * sides + j, i * sides + (j + 1) % sides
    c, d = a + sides, b + sides
    below, above = profile[:-1, 0] > 0.0, profile[1:, 0] > 0.0
    lower, upper = np.stack([a, b, d], axis=-1)[below], np.stack([a, d, c], axis=-1)[above]
    return points.reshape(-1, 3), np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)])


def cylinder(radius: float, length: float, sides: int = SIDES) -> Mesh:
    """A cylinder about z with its middle at the origin; its edges are sharp."""
    half = 0.5 * length
    return turned_about([(0.0, -half), (radius, -half), (radius, half), (0.0, half)], sides)


def box(size: Any, center: Any = (0.0, 0.0, 0.0)) -> Mesh:
    """A box of a size (3,) m about a centre."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [corners for a, b, c, d in quads for corners in ((a, b, c), (a, c, d))]
    return np.asarray(center, float) + 0.5 * signs * np.asarray(size, float), np.array(triangles)


def joined(*meshes: Mesh) -> Mesh:
    """Several meshes as one."""
    starts = np.cumsum([0, *(len(points) for points, _ in meshes)])
    return (
        np.concatenate([points for points, _ in meshes]),
        np.concatenate([triangles + start for (_, triangles), start in zip(meshes, starts, strict=False)]),
    )


def moved(mesh: Mesh, columns: np.ndarray, place: Any = (0.0, 0.0, 0.0)) -> Mesh:
    """A mesh turned by a rotation (3, 3) and put at a place (3,)."""
    return mesh[0] @ np.asarray(columns).T + np.asarray(place, float), mesh[1]
