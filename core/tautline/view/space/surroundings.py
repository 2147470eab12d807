"""What a scene stands on and in: floor, ground and water as meshes that fade towards the horizon, and the sun."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.system.waves import Waves
from tautline.view.space.appearance import Appearance, Level

FLOOR, FLOOR_NAME = "#D3D7D9", "floor"
"""Colour and name of a floor that is not in the scene."""
DEEP = 0.85
"""Share of the picture's height from which water is so high that most of what is seen hangs in it."""
FAR, PATCH = 14.0, 0.5
"""Radius of a level over the picture's size; and of the surface of deep water, so that one sees what hangs in it."""
WAVY, SEEN = 1.6, 0.65
"""Distance from the middle to where waves end, over the picture's size: at most, and at least, so that all that is seen
in the picture is on waves of their full height."""
FINE, AROUND = 60, 16
"""Parts of a sea from its middle to where its waves end, and from there to its edge."""
CONTRAST = 4.0
"""Of waves: share by which a slope of one towards the sun is brighter."""
SHADED = 0.78
"""Brightness of a level in the shadow, over that in the sun."""


class Surface(NamedTuple):
    """A level as a mesh.

    Attributes
    ----------
    level : Level
    points : (n, 3) array
        m; of a sea at rest.
    triangles : (k, 3) array of int
    fade : (n,) array
        From 1 in the middle to 0 at the edge.
    crest : (n,) array
        Share of the waves' height that the point has: none far off, where the mesh is coarse.
    """

    level: Level
    points: np.ndarray
    triangles: np.ndarray
    fade: np.ndarray
    crest: np.ndarray

    def heights(self, time: float) -> np.ndarray:
        """Heights (n,) of the points at a time, m."""
        waves = self.level.waves
        if waves is None:
            return np.asarray(self.points[:, 2])
        return np.asarray(self.level.height + self.crest * waves.elevation(*self.points[:, :2].T, time))

    def light(self, heights: np.ndarray, light: np.ndarray) -> np.ndarray:
        """Brightness (n,) of the water with its points at some heights (n,), over that of still water.

        What leans to the sun, a unit vector, is brighter; steeper than a wave is, so that waves are seen.
        """
        n = round(len(self.points) ** 0.5)
        grid = heights.reshape(n, n)
        along_y, along_x = np.gradient(grid, self.points[::n, 1], self.points[:n, 0])
        return np.asarray(np.clip(1.0 - CONTRAST * (along_x * light[0] + along_y * light[1]), 0.6, 1.4).ravel())


def sun(eye: tuple[float, float, float]) -> np.ndarray:
    """Direction to the sun, a unit vector: behind the left shoulder of who looks, and high."""
    back = np.array([eye[0], eye[1], 0.0])
    length = float(np.linalg.norm(back))
    back = back / length if length > 1e-6 else np.array([0.0, -1.0, 0.0])
    across = np.array([-back[1], back[0], 0.0])
    light = 0.45 * back - 0.5 * across + [0.0, 0.0, 1.0]
    return np.asarray(light / np.linalg.norm(light))


def shadow(light: np.ndarray, height: float) -> np.ndarray:
    """Matrix (4, 4) that takes a point above a level at a height, m, to its shadow there."""
    flat = np.eye(4)
    flat[:2, 2] = -light[:2] / light[2]
    flat[:2, 3] = height * light[:2] / light[2]
    flat[2] = [0.0, 0.0, 0.0, height]
    return flat


def ground_colour(colour: str) -> str:
    """Of a level as it is drawn: pale, so that what stands on it is seen."""
    parts = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    return "#" + "".join(f"{round(0.5 * part + 0.5 * 0xEC):02X}" for part in parts)


def deep(level: Level, extent: np.ndarray) -> bool:
    """Whether water is so high in a picture of points (n, 3) that most of what is seen hangs in it."""
    low, high = float(extent[:, 2].min()), float(extent[:, 2].max())
    return level.clear and level.height > low + DEEP * (high - low)


def surfaces(appearance: Appearance, extent: np.ndarray) -> list[Surface]:
    """Levels of an appearance, and a floor where it wants one, around points (n, 3), m."""
    size = max(float(np.ptp(extent, axis=0).max()), 1e-6)
    middle = 0.5 * (extent.min(axis=0) + extent.max(axis=0))
    made = [_surface(one, PATCH * size if deep(one, extent) else FAR * size, size, middle) for one in appearance.levels]
    base = appearance.base(extent)
    if base is not None and all(level.clear for level in appearance.levels):
        made.append(_surface(Level(FLOOR_NAME, base, FLOOR, 1.0), FAR * size, size, middle))
    return made


def _surface(level: Level, far: float, size: float, middle: np.ndarray) -> Surface:
    """A level to a distance from the middle of what is seen, whose size is given; m."""
    waves = level.waves
    if waves is None:
        half, near = far * np.linspace(0.0, 1.0, AROUND + 1) ** 2, 0.0
    else:
        near = min(0.9 * far, max(min(WAVY * size, 4.0 * _longest(waves)), SEEN * size))
        beyond = near + (far - near) * (np.arange(1, AROUND + 1) / AROUND) ** 2
        half = np.concatenate([np.linspace(0.0, near, FINE + 1), beyond])
    line = np.concatenate([-half[:0:-1], half])
    n = line.size
    x, y = np.meshgrid(line, line)
    off = np.maximum(np.abs(x), np.abs(y)).ravel()
    reach = np.hypot(x, y).ravel() / far
    points = np.column_stack([x.ravel() + middle[0], y.ravel() + middle[1], np.full(n * n, level.height)])
    i, j = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    a = (i * n + j).ravel()
    faces = np.concatenate([np.column_stack([a, a + 1, a + n + 1]), np.column_stack([a, a + n + 1, a + n])])
    share = np.clip((reach - 0.1) / 0.9, 0.0, 1.0)
    fade = 1.0 - share**2 * (3.0 - 2.0 * share)
    crest = np.clip(5.0 * (1.0 - off / near), 0.0, 1.0) if near > 0.0 else np.zeros(n * n)
    return Surface(level, points, faces, fade, crest)


def _longest(waves: Waves) -> float:
    """Length of the highest of some waves, m."""
    return float(2.0 * np.pi / waves.number[int(np.argmax(waves.amplitude))])
