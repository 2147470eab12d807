"""Chains of ALE-ANCF elements as curves to be drawn: the cubic of each element, at many points and many frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tautline.kernels.hermite import FIRST, SECOND, SHAPE, table
from tautline.view.space.appearance import Quantity, Values

NO_DIRECTION = 1.0e-9
"""Slope, m of curve per m of cable, below which a curve has no direction, and no curvature to speak of."""
BATCH = 200_000
"""Points that are evaluated at a time, about."""
PLANAR = 0.1
"""Share of the second largest extent of points below which the least is depth of a plane that they lie in."""
NARROW = 0.02
"""Share of the largest extent of points below which the second is none: they lie on a line."""
ASKEW = (0.9, -1.0, 0.5)
"""The way to the eye of what lies in no plane."""

Batch = Callable[[slice], np.ndarray]
"""Arrays of several frames, leading axis time."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Elements one behind the other, and what is known of them at points evenly spread over each in p.

    Attributes
    ----------
    position, slope : (frames, n, 3) array
        Of the nodes, m, and dr/dp; the slopes of linear elements' nodes are not looked at.
    material : (frames, n) array
        p of the nodes, m; rising.
    straight : (n - 1,) array of bool
        Linear elements.
    steps : int
        Between points in an element; even, so that the middle of an element, where forces are stored, is a point.
    factor : float
        On displacements from the first frame, by which they are drawn larger.
    across : bool
        Whether only what lies across the first frame's curve is.
    """

    position: np.ndarray
    slope: np.ndarray
    material: np.ndarray
    straight: np.ndarray
    steps: int
    factor: float = 1.0
    across: bool = False

    @property
    def size(self) -> int:
        """Number of points."""
        return (self.position.shape[1] - 1) * self.steps + 1

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.position)

    @property
    def nodes(self) -> np.ndarray:
        """Points that are nodes, (n,)."""
        return np.arange(0, self.size, self.steps)

    def points(self, frames: slice) -> np.ndarray:
        """Places (frames, m, 3), m, drawn larger where that is asked for."""
        return self._drawn(self._joined(self._derivative(frames, 0)), lambda: self._first)

    def curvature(self, frames: slice) -> np.ndarray:
        """|r' x r''| / |r'|^3 of the cubic (frames, m), 1/m; at a node the mean of both sides, zero at a cusp."""
        slope, turn = self._derivative(frames, 1), self._derivative(frames, 2)
        size = np.linalg.norm(slope, axis=-1, keepdims=True)
        across = np.linalg.norm(np.cross(slope, turn), axis=-1, keepdims=True)
        bend = np.where(size > NO_DIRECTION, across / np.maximum(size, NO_DIRECTION) ** 3, 0.0)
        return self._joined(bend)[..., 0]

    def material_velocity(self, frames: slice, velocity: np.ndarray, rate: np.ndarray | None) -> np.ndarray:
        """Velocity of the cable's material (frames, m, 3), m/s: v - p' r', linear in p between nodes.

        Parameters
        ----------
        velocity : (frames, n, 3) array
            Of the nodes, m/s.
        rate : (frames, n) array or None
            At which their p grows, m/s; None where it rests.
        """
        found = self._even(velocity[frames])
        if rate is not None:
            found = found - self._even(rate[frames][..., None]) * self._derivative(frames, 1)
        return self._joined(found)

    def through_middles(self, frames: slice, values: np.ndarray) -> np.ndarray:
        """Values stored in the middle of elements (frames, n - 1) at the points (frames, m).

        They are linear in p between one middle and the next, and constant beyond the first and the last.
        """
        p, place = self.material[frames], self._joined(self._even(self.material[frames][..., None]))[..., 0]
        middle = 0.5 * (p[:, 1:] + p[:, :-1])
        return np.array([np.interp(*one) for one in zip(place, middle, values[frames], strict=True)])

    def place(self, frame: int, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places (k, 3), m, and directions r' (k, 3), as drawn, of material coordinates (k,) at a frame."""
        at, way = self._at(frame, p)
        if self.factor == 1.0:
            return at, way
        first = self._at(0, p)
        return self._drawn(at, lambda: first), self._drawn(way, lambda: (first[1], first[1]))

    def enlarged(self, found: np.ndarray, p: float) -> np.ndarray:
        """Places (k, 3), m, of one material coordinate at any times, as drawn."""
        return self._drawn(found, lambda: self._at(0, np.array([p])))

    def quantity(self, name: str, text: str, unit: str, values: Batch) -> Quantity:
        """A quantity of what is evaluated for several frames at a time; its range is that of all frames."""
        frames = self.frames
        count = max(1, BATCH // self.size)
        found = [values(slice(i, min(i + count, frames))) for i in range(0, frames, count)]
        low, high = min(float(one.min()) for one in found), max(float(one.max()) for one in found)
        return Quantity(name, text, unit, at_a_frame(values), low, high)

    @property
    def _first(self) -> tuple[np.ndarray, np.ndarray]:
        """Places and directions of the points at the first frame."""
        first = slice(0, 1)
        return self._joined(self._derivative(first, 0))[0], self._joined(self._derivative(first, 1))[0]

    def _drawn(self, found: np.ndarray, first: Callable[[], tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
        if self.factor == 1.0:
            return found
        begun, way = first()
        moved = found - begun
        if self.across:
            unit = way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), NO_DIRECTION)
            moved = moved - (moved * unit).sum(axis=-1, keepdims=True) * unit
        return found + (self.factor - 1.0) * moved

    def _at(self, frame: int, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places and slopes, (k, 3) each, of material coordinates at a frame."""
        material = self.material[frame]
        i = np.clip(np.searchsorted(material, p, side="right") - 1, 0, len(material) - 2)
        length = (material[i + 1] - material[i])[:, None]
        x = (p - material[i]) / length[:, 0]
        ends = [self.position[frame, i], self.slope[frame, i], self.position[frame, i + 1], self.slope[frame, i + 1]]
        shape = table(x, np.zeros_like(x))
        straight = self.straight[i][:, None]
        chord = ends[2] - ends[0]
        at = np.where(straight, ends[0] + x[:, None] * chord, _cubic(shape[:, SHAPE:], ends, length))
        return at, np.where(straight, chord, _cubic(shape[:, FIRST:], ends, length)) / length

    def _derivative(self, frames: slice, order: int) -> np.ndarray:
        """Derivative of the place by p, of an order up to 2, (frames, n - 1, steps + 1, 3)."""
        r, t, p = self.position[frames], self.slope[frames], self.material[frames]
        length = np.diff(p, axis=1)[:, :, None, None]
        ends = [x[:, :, None] for x in (r[:, :-1], t[:, :-1], r[:, 1:], t[:, 1:])]
        shape = table(self._places, np.zeros(self.steps + 1))[:, (SHAPE, FIRST, SECOND)[order] :]
        found = _cubic(shape, ends, length) / length**order
        if self.straight.any():
            chord = ends[2] - ends[0]
            linear = (ends[0] + self._places[:, None] * chord, chord / length, 0.0 * chord)[order]
            found = np.where(self.straight[:, None, None], linear, found)
        return found

    @property
    def _places(self) -> np.ndarray:
        return np.linspace(0.0, 1.0, self.steps + 1)

    def _even(self, values: np.ndarray) -> np.ndarray:
        """Values of nodes (frames, n, d) made linear in each element, (frames, n - 1, steps + 1, d)."""
        x = self._places[:, None]
        return (1.0 - x) * values[:, :-1, None] + x * values[:, 1:, None]

    def _joined(self, values: np.ndarray) -> np.ndarray:
        """Values of elements, (frames, n - 1, steps + 1, d), one behind the other (frames, m, d)."""
        frames, _, _, each = values.shape
        flat = np.concatenate([values[:, :, :-1].reshape(frames, -1, each), values[:, -1:, -1]], axis=1)
        flat[:, self.nodes[1:-1]] = 0.5 * (values[:, :-1, -1] + values[:, 1:, 0])
        return flat


def at_a_frame(values: Batch) -> Values:
    """The callable of one frame, of what is evaluated for several at a time."""
    return lambda frame: values(slice(frame, frame + 1))[0]


def steps_for(elements: int) -> int:
    """Steps in each element of so many, so that the curve is smooth and has no more points than it takes."""
    return 2 * int(np.clip(200 // max(elements, 1), 2, 8))


def facing(points: np.ndarray, towards: np.ndarray | None = None) -> tuple[float, float, float]:
    """The direction to the eye from which points (n, 3) are seen best: nearly square on the plane that they lie in.

    Points on a line are seen in the upright plane through it, points in no plane from askew above.

    Parameters
    ----------
    points : (n, 3) array
        m.
    towards : (3,) array, optional
        What should point to the right, such as the vector from root to tip.
    """
    points = np.asarray(points, float).reshape(-1, 3)
    centred = points - points.mean(axis=0)
    _, extent, ways = np.linalg.svd(centred.T @ centred)
    extent = np.sqrt(extent)
    if extent[0] == 0.0:
        return ASKEW
    if extent[1] > NARROW * extent[0] and extent[2] > PLANAR * extent[1]:
        return ASKEW
    z = np.array([0.0, 0.0, 1.0])
    normal = ways[2]
    if extent[1] <= NARROW * extent[0]:
        normal = np.cross(ways[0], z)
        normal = normal / np.linalg.norm(normal) if np.linalg.norm(normal) > NARROW else np.array([0.0, 1.0, 0.0])
    if abs(normal[2]) > 0.9:
        x, y, height = normal * np.sign(normal[2]) + (0.0, -0.25, 0.0)
        return float(x), float(y), float(height)
    right = np.cross(z, normal)
    wanted = right @ (points[-1] - points[0] if towards is None else towards)
    if abs(wanted) < 1e-3 * np.abs(centred).max():
        wanted = right[np.argmax(np.abs(right))]
    sign = 1.0 if wanted >= 0.0 else -1.0
    x, y, height = sign * normal + 0.1 * sign * right / np.linalg.norm(right) + 0.12 * z
    return float(x), float(y), float(height)


def _cubic(shape: np.ndarray, ends: list[np.ndarray], length: np.ndarray) -> np.ndarray:
    """Eq. 2.3 with shape functions, or their derivatives by x, (..., steps + 1, 4 or more)."""
    h = [shape[:, k : k + 1] for k in range(4)]
    return h[0] * ends[0] + length * h[1] * ends[1] + h[2] * ends[2] + length * h[3] * ends[3]
