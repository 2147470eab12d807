"""Symbols of what holds a string and what drills: derrick, block, bit. Their sizes suit the picture, not the yard."""

from __future__ import annotations

import numpy as np

from tautline.view.space.appearance import axes_of
from tautline.view.space.mesh import Mesh, box, cylinder, joined, moved, turned_about

BAYS, LEG = 4, 0.03
"""Girts of a derrick between its foot and its crown, and thickness of a leg over the derrick's height."""
FOOT, CROWN = 0.19, 0.06
"""Half the width of a derrick at its foot and at its crown, over its height."""
BLADES = 5


def derrick(height: float) -> Mesh:
    """A derrick of four legs with girts, over a rotary table; its foot at the origin, z up."""
    foot, crown = FOOT * height, CROWN * height
    corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
    beams: list[Mesh] = []
    for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True):
        beams.append(_beam((foot * a, foot * b, 0.0), (crown * a, crown * b, height), LEG * height))
        for level in np.arange(1, BAYS + 1) / BAYS:
            half = foot + level * (crown - foot)
            z = level * height
            beams.append(_beam((half * a, half * b, z), (half * c, half * d, z), 0.6 * LEG * height))
    head = box((3.0 * crown, 3.0 * crown, 1.5 * LEG * height), (0.0, 0.0, height))
    table = moved(cylinder(1.15 * foot, 0.5 * LEG * height), np.eye(3), (0.0, 0.0, 0.25 * LEG * height))
    return joined(*beams, head, table)


def block(height: float) -> Mesh:
    """A travelling block with its top drive; what hangs in it begins at the origin, z up."""
    h = height
    body = [(0.0, 0.0), (0.10, 0.0), (0.10, 0.25), (0.26, 0.3), (0.26, 0.65), (0.12, 0.7), (0.12, 0.85), (0.0, 1.0)]
    return turned_about(np.array(body) * h)


def bit(diameter: float, length: float) -> Mesh:
    """A bit with blades that show how it turns; it is put over what ends at the origin, z down the hole."""
    r, h = 0.5 * diameter, length
    top, brim, face = -0.9 * h, 0.02 * h, 0.1 * h
    body = turned_about([(0.0, top), (0.93 * r, top), (0.93 * r, brim), (0.7 * r, face), (0.0, face)])
    blade = box((0.5 * r, 0.25 * r, 0.8 * h), (0.75 * r, 0.0, -0.3 * h))
    turns = 2.0 * np.pi * np.arange(BLADES) / BLADES
    return joined(body, *(moved(blade, axes_of(np.array([0.0, 0.0, 1.0]), turn)) for turn in turns))


def _beam(start: tuple[float, ...], end: tuple[float, ...], thick: float) -> Mesh:
    """A square beam between two points."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    return moved(box((thick, thick, float(np.linalg.norm(b - a)))), axes_of(b - a), 0.5 * (a + b))
