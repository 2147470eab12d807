"""Shapes of a crane's parts, as meshes: sheaves, drums, cheek plates, lattice booms, loads on slings.

A scene says where wheels are and how large, and nothing of what carries them: that is drawn to fit. Wheels turn about
their own z; all else is in the axes of what it rides on. Every mesh is closed, or is several closed ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tautline.view.space.appearance import axes_of
from tautline.view.space.mesh import Mesh, box, cylinder, joined, moved, turned_about

SPOKES = 5
STRUT_SIDES = 10
GROOVE_POINTS = 9


def sheave(radius: float, diameter: float, width: float) -> Mesh:
    """A spoked wheel with a round groove that the lower half of the rope lies in.

    Parameters
    ----------
    radius : float
        Pitch radius, m: to the middle of the rope.
    diameter, width : float
        Of the rope, and of the rim along the axis, m.
    """
    deep = min(0.5 * diameter, 0.45 * width)
    inner = max(radius - deep - max(0.1 * radius, 0.5 * diameter), 0.45 * radius)
    angle = np.linspace(0.5 * np.pi, -0.5 * np.pi, GROOVE_POINTS)
    half = 0.5 * width
    groove = np.column_stack([radius - deep * np.cos(angle), -deep * np.sin(angle)])
    sides = [(inner, -half), (radius, -half), *groove, (radius, half), (inner, half), (inner, -half)]
    return joined(turned_about(sides), *_spokes(inner, 0.2 * radius, 0.6 * width), cylinder(0.2 * radius, 1.3 * width))


def drum(radius: float, diameter: float, length: float) -> Mesh:
    """A barrel of a length under rope whose middle is at the pitch radius, between spoked flanges, on an axle."""
    outer = max(radius - 0.5 * diameter, 0.5 * radius)
    half, thick, rim = 0.5 * length, 0.08 * radius, radius + max(0.7 * diameter, 0.12 * radius)
    barrel = [(0.9 * outer, -half), (outer, -half), (outer, half), (0.9 * outer, half), (0.9 * outer, -half)]
    flange = [(0.8 * outer, -0.5 * thick), (rim, -0.5 * thick), (rim, 0.5 * thick), (0.8 * outer, 0.5 * thick)]
    wheel = joined(turned_about([*flange, flange[0]]), *_spokes(0.82 * outer, 0.25 * outer, thick))
    ends = [moved(wheel, np.eye(3), (0.0, 0.0, z)) for z in (-half - 0.5 * thick, half + 0.5 * thick)]
    return joined(turned_about(barrel), *ends, cylinder(0.14 * outer, length + 6.0 * thick))


def _spokes(outer: float, hub: float, thick: float) -> list[Mesh]:
    """Spokes from within a hub to a rim's inside, and a disc around the hub."""
    made = [cylinder(1.6 * hub, 0.8 * thick)]
    for k in range(SPOKES):
        spoke = box((1.04 * outer - hub, 0.62 * hub, thick), (0.5 * (1.04 * outer + hub), 0.0, 0.0))
        made.append(moved(spoke, axes_of(np.array([0.0, 0.0, 1.0]), 2.0 * np.pi * k / SPOKES)))
    return made


def strut(one: Any, other: Any, radius: float) -> Mesh:
    """A bar between two points."""
    one, other = np.asarray(one, float), np.asarray(other, float)
    length = float(np.linalg.norm(other - one))
    if length == 0.0:
        return box((2.0 * radius,) * 3, one)
    return moved(cylinder(radius, length, STRUT_SIDES), axes_of((other - one) / length), 0.5 * (one + other))


def cheeks(pins: np.ndarray, axis: np.ndarray, radius: float, half: float, thick: float) -> Mesh:
    """Two plates on either side of a row of wheels, with their pins.

    Parameters
    ----------
    pins : (k, 3) array
        Centres of wheels and whatever else the plates hold, m.
    axis : (3,) array
        Unit axis of the wheels.
    radius : float
        Of a plate around each pin, m.
    half : float
        From the outermost pin along the axis to the inside of a plate, m.
    thick : float
        Of a plate, m.
    """
    columns = axes_of(axis)
    local = np.asarray(pins, float) @ columns
    outline = _hull(local[:, :2], radius)
    low, high = local[:, 2].min() - half - 0.5 * thick, local[:, 2].max() + half + 0.5 * thick
    made = [moved(_plate(outline, thick), columns, columns @ (0.0, 0.0, z)) for z in (low, high)]
    for x, y in np.unique(local[:, :2].round(9), axis=0):
        made.append(strut(columns @ (x, y, low - thick), columns @ (x, y, high + thick), 0.3 * radius))
    return joined(*made)


def _hull(centers: np.ndarray, radius: float) -> np.ndarray:
    """Corners, anticlockwise, of the convex hull of circles about centres (k, 2)."""
    angle = 2.0 * np.pi * np.arange(32) / 32
    points = (centers[:, None] + radius * np.column_stack([np.cos(angle), np.sin(angle)])).reshape(-1, 2)
    points = points[np.lexsort(points.T[::-1])]

    def chain(ordered: np.ndarray) -> list[np.ndarray]:
        kept: list[np.ndarray] = []
        for point in ordered:
            while len(kept) > 1 and _left(kept[-2], kept[-1], point) <= 1e-9 * radius**2:
                kept.pop()
            kept.append(point)
        return kept[:-1]

    return np.array(chain(points) + chain(points[::-1]))


def _left(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Twice the area of a triangle, positive where it turns left."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _plate(outline: np.ndarray, thick: float) -> Mesh:
    """A plate of a convex outline (n, 2), anticlockwise, about z = 0."""
    n, middle = len(outline), outline.mean(axis=0)
    flat = np.vstack([outline, middle])
    points = np.concatenate([np.column_stack([flat, np.full(n + 1, z)]) for z in (-0.5 * thick, 0.5 * thick)])
    i = np.arange(n)
    j, up = (i + 1) % n, n + 1
    faces = [(np.full(n, n), j, i), (np.full(n, n + up), i + up, j + up), (i, j, j + up), (i, j + up, i + up)]
    return points, np.concatenate([np.column_stack(face) for face in faces])


def lattice(foot: np.ndarray, tip: np.ndarray, across: np.ndarray, breadth: Sequence[float], depth: float) -> Mesh:
    """A boom of four chords with bracing, below the line from its foot to its tip, so that no rope along it is hidden.

    Parameters
    ----------
    foot, tip : (3,) array
        m.
    across : (3,) array
        Unit vector, level, across the boom.
    breadth : (3,) sequence
        Half the breadth at foot, middle and tip, m.
    depth : float
        Of its middle, m.
    """
    way = tip - foot
    length = float(np.linalg.norm(way))
    along = way / length
    below = np.cross(along, across)
    below = below if below[2] < 0.0 or (below[2] == 0.0 and below[0] > 0.0) else -below
    bays = int(np.clip(round(length / (1.4 * depth)), 6, 24))
    s = np.linspace(0.0, 1.0, bays + 1)
    half = np.interp(s, (0.0, 0.15, 0.85, 1.0), (breadth[0], max(breadth[0], breadth[1]), breadth[1], breadth[2]))
    deep = np.interp(s, (0.0, 0.15, 0.85, 1.0), (0.0, depth, depth, 0.04 * depth))
    line = foot + s[:, None] * way
    top = [line + side * half[:, None] * across for side in (-1.0, 1.0)]
    bottom = [one + deep[:, None] * below for one in top]
    chord, brace = 0.05 * depth, 0.028 * depth
    made = []
    for side in (0, 1):
        for row in (top[side], bottom[side]):
            made += [strut(row[k], row[k + 1], chord) for k in range(bays)]
        # Zigzag in the sides.
        for k in range(bays):
            one, other = (top[side], bottom[side]) if k % 2 else (bottom[side], top[side])
            made.append(strut(one[k], other[k + 1], brace))
    for row in (top, bottom):
        made += [strut(row[k % 2][k], row[1 - k % 2][k + 1], brace) for k in range(bays)]
        made += [strut(row[0][k], row[1][k], brace) for k in range(bays + 1)]
    return joined(*made)


def slung(size: np.ndarray, center: np.ndarray, apex: np.ndarray, thick: float) -> tuple[Mesh, Mesh]:
    """A box, and slings to its upper corners from a point that it hangs from.

    Parameters
    ----------
    size, center : (3,) array
        Of the box, m.
    apex : (3,) array
        Where the slings meet, m; there are none where that is not above the box.
    thick : float
        Of a sling, m.
    """
    top = center[2] + 0.5 * size[2]
    reach = 0.5 * size[:2] - thick
    corners = [center + (x * reach[0], y * reach[1], 0.5 * size[2]) for x in (-1, 1) for y in (-1, 1)]
    slings = [strut(apex, corner, 0.5 * thick) for corner in corners] if apex[2] > top + thick else []
    return box(size, center), joined(moved(hook(1.5 * thick), np.eye(3), apex), *slings)


def hook(radius: float) -> Mesh:
    """A socket at the origin that the rope ends in."""
    return turned_about([(0.0, -radius), (0.8 * radius, -0.6 * radius), (radius, 0.0), (0.5 * radius, radius),
                         (0.0, radius)], 20)  # fmt: skip


def column(foot: np.ndarray, top: np.ndarray, radius: float) -> Mesh:
    """A pedestal, wider at its foot, with a ring at its top that a crane slews on."""
    height = float(top[2] - foot[2])
    ring = min(0.12 * height, 0.5 * radius)
    profile = [(0.0, 0.0), (1.25 * radius, 0.0), (radius, 0.25 * height), (radius, height - ring),
               (1.2 * radius, height - ring), (1.2 * radius, height), (0.0, height)]  # fmt: skip
    return moved(turned_about(profile), np.eye(3), foot)
