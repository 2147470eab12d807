"""Signs for what holds, pulls and weighs on a cable: supports, springs, masses. They show where it is, not its size."""

from __future__ import annotations

import numpy as np

from tautline.view.space.appearance import LOAD, PAINT, STEEL, History, Line, Solid, Values, axes_of, pose_of
from tautline.view.space.mesh import Mesh, box, joined, moved, turned_about

STEEL_DENSITY = 7850.0
"""kg/m^3, of the balls that masses are drawn as."""
TURNS, COIL_POINTS = 6, 121
ROUND = 12
"""Steps from pole to pole of a ball."""


def ball(radius: float) -> Mesh:
    """A sphere about the origin."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, ROUND + 1)
    profile = np.column_stack([np.cos(angle), np.sin(angle)])
    profile[[0, -1], 0] = 0.0
    return turned_about(radius * profile, 2 * ROUND)


def mass(
    kilograms: float, place: Values, extent: float, name: str = "mass", histories: tuple[History, ...] = ()
) -> Solid:
    """A ball at a moving place: of the size that steel would have, but neither too small to see nor in the way.

    Parameters
    ----------
    extent : float
        Of the picture, m.
    """
    radius = (0.75 * kilograms / (np.pi * STEEL_DENSITY)) ** (1.0 / 3.0)
    points, triangles = ball(float(np.clip(radius, 0.008 * extent, 0.03 * extent)))
    return Solid(name, points, triangles, lambda frame: pose_of(place(frame)), LOAD, histories=histories)


def pin(size: float) -> Mesh:
    """A cone of a size, m, whose tip is at the origin and which stands below it."""
    return turned_about([(0.0, -size), (0.5 * size, -size), (0.0, 0.0)], 24)


def plate(size: float, way: np.ndarray, behind: float = -1.0) -> Mesh:
    """A square plate across a way (3,) at the origin; `behind` is -1 for the side that the way leaves, 1 for the other.

    0 puts it in the middle.
    """
    thickness = 0.2 * size
    return moved(box((size, size, thickness), (0.0, 0.0, 0.5 * behind * thickness)), axes_of(way))


def supports(meshes: list[Mesh], name: str = "supports") -> Solid:
    """Signs that never move, as one thing."""
    points, triangles = joined(*meshes)
    return Solid(name, points, triangles, None, STEEL, smooth=False)


def coil(first: Values, second: Values, size: float, name: str = "spring") -> Line:
    """A spring between two places that may move and may meet; `size` is the diameter of its coils, m."""
    x = np.linspace(0.0, 1.0, COIL_POINTS)
    angle = 2.0 * np.pi * TURNS * x
    radius = 0.5 * size * np.clip(8.0 * np.minimum(x, 1.0 - x), 0.0, 1.0)
    ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])

    def points(frame: int) -> np.ndarray:
        begins, ends = first(frame), second(frame)
        way = ends - begins
        # A spring that has no length has no direction: its coils lie level.
        columns = axes_of(way if np.linalg.norm(way) > 1e-3 * size else np.array([0.0, 0.0, 1.0]))
        return begins + x[:, None] * way + ring @ columns[:, :2].T

    return Line(name, points, 0.06 * size, colour=PAINT, thick=False, measured=False)
