"""The rope as one line in space at every frame: straight spans, arcs on sheaves, turns on drums, and what it bears.

A result holds where items and nodes are. `crane.results.course` tells from them where the rope touches its wheels;
between touches it is straight from node to node, as its elements are, and on a sheave it follows the pitch circle.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from crane.results.course import Course, nodes_of
from crane.results.observe import LEAD_ANGLE
from crane.scene.scene import CraneScene, Drum, Sheave

ARC_STEP, COIL_STEP = 0.1, 0.25
"""Angle between points of an arc on a sheave, and of a turn on a drum, rad: a chord is 1 - step^2 / 24 of its arc."""
FEWEST_TURNS, MOST_TURNS = 3.0, 40
"""Turns that are never paid out where a scene does not say what is on a drum; and the most that are drawn."""
ROPE_DENSITY = 5000.0
"""Mass of a wire rope per length and square of diameter, kg/m^3."""
PITCH = 1.06
"""From turn to turn on a drum, over the rope's diameter."""


class RopeLine(NamedTuple):
    """The rope at m frames, through k points.

    Attributes
    ----------
    points : (m, k, 3) array
        m.
    material, tension : (m, k) array
        Material coordinate, m, and tension, N.
    speed : (m, k) array or None
        Of the rope along itself, from its first end to its last, m/s; None for a single frame.
    nodes : (n,) array of int
        Points that are nodes; of a sheave the middle of what lies on it.
    spans : (items - 1, 2) array of int
        Points where each span begins and ends.
    """

    points: np.ndarray
    material: np.ndarray
    tension: np.ndarray
    speed: np.ndarray | None
    nodes: np.ndarray
    spans: np.ndarray


class _Piece(NamedTuple):
    """A stretch of rope: points (m, k, 3), directions (m, k, 3), material (m, k), tension (m, k), nodes among them."""

    points: np.ndarray
    along: np.ndarray
    material: np.ndarray
    tension: np.ndarray
    nodes: tuple[int, ...]


def diameter_of(scene: CraneScene) -> float:
    """Diameter of the rope, m: as given, or that of a wire rope of its mass, and small beside its sheaves."""
    wheels = [item.radius for item in scene.path if isinstance(item, (Drum, Sheave))]
    given = scene.rope.diameter or float(np.sqrt(scene.rope.mass_per_length / ROPE_DENSITY))
    return given if scene.rope.diameter or not wheels else min(given, 0.25 * min(wheels))


def rope_line(result: Any, course: Course, exaggerate: float = 1.0) -> RopeLine:
    """Lay the rope out at every frame.

    Parameters
    ----------
    result : Result
    course : Course
        Of all its frames.
    exaggerate : float
        Factor on what lies across the chord of each span.
    """
    rope = _Rope(result, course)
    pieces: list[_Piece] = []
    last = len(rope.scene.path) - 1
    for i, item in enumerate(rope.scene.path):
        pieces.append(
            rope.arc(i) if isinstance(item, Sheave) else rope.coil(i) if isinstance(item, Drum) else rope.point(i)
        )
        if i < last:
            pieces.append(rope.span(i))
    starts = np.cumsum([0, *(piece.points.shape[1] for piece in pieces)])
    nodes = [start + node for start, piece in zip(starts, pieces, strict=False) for node in piece.nodes]
    points, along, material, tension = (
        np.concatenate([piece[k] for piece in pieces], axis=1) for k in range(4)
    )  # fmt: skip
    speed = _speed(rope, points, along, material, tension)
    if exaggerate != 1.0:
        for i in range(last):
            k = 2 * i + 1
            at = slice(starts[k], starts[k + 1])
            points[:, at] = _across(points[:, at], points[:, starts[k] - 1], points[:, starts[k + 1]], exaggerate)
    spans = np.array([(starts[2 * i + 1] - 1, starts[2 * i + 2]) for i in range(last)], dtype=int).reshape(-1, 2)
    return RopeLine(points, material, tension, speed, np.array(nodes, dtype=int), spans)


def cut(rope: RopeLine, kept: Sequence[bool], reach: float) -> list[RopeLine]:
    """Parts of a rope around some of its items.

    Parameters
    ----------
    rope : RopeLine
    kept : sequence of bool
        Of each item of the path, whether it is.
    reach : float
        How far spans go on from what is kept towards what is not, m.

    Returns
    -------
    list of RopeLine
        Without nodes: their numbers would not be those of the whole.
    """
    made: list[RopeLine] = []
    count = len(kept)
    first = 0
    while first < count:
        if not kept[first]:
            first += 1
            continue
        last = first
        while last + 1 < count and kept[last + 1]:
            last += 1
        begin = rope.spans[first - 1, 1] if first > 0 else 0
        end = rope.spans[last, 0] if last < count - 1 else rope.points.shape[1] - 1
        parts = [_taken(rope, slice(begin, end + 1))]
        if first > 0:
            before = _taken(rope, slice(rope.spans[first - 1, 0], begin + 1))
            parts.insert(0, _shortened([values[:, ::-1] for values in before], reach, back=True))
        if last < count - 1:
            parts.append(_shortened(_taken(rope, slice(end, rope.spans[last, 1] + 1)), reach, back=False))
        whole = [np.concatenate(values, axis=1) for values in zip(*parts, strict=True)]
        speed = whole[3] if rope.speed is not None else None
        none = np.zeros(0, dtype=int)
        made.append(RopeLine(whole[0], whole[1], whole[2], speed, none, none.reshape(-1, 2)))
        first = last + 1
    return made


def _taken(rope: RopeLine, at: slice) -> list[np.ndarray]:
    """Points, material, tension and, where it is known, speed of some points."""
    return [values[:, at] for values in rope[:4] if values is not None]


def _shortened(part: list[np.ndarray], reach: float, back: bool) -> list[np.ndarray]:
    """As many points on the first stretch of a part, its first point left out; the other way round if `back`."""
    points = part[0]
    steps = np.linalg.norm(np.diff(points, axis=1), axis=-1)
    way = np.concatenate([np.zeros((len(points), 1)), np.cumsum(steps, axis=1)], axis=1)
    share = np.linspace(0.0, 1.0, points.shape[1])[1:]
    made = []
    for values in part:
        columns = values.reshape(*values.shape[:2], -1)
        short = np.empty((len(points), len(share), columns.shape[2]))
        for k in range(len(points)):
            at = share * min(reach, way[k, -1])
            for c in range(columns.shape[2]):
                short[k, :, c] = np.interp(at, way[k], columns[k, :, c])
        short = short.reshape(len(points), len(share), *values.shape[2:])
        made.append(short[:, ::-1] if back else short)
    return made


def _across(inside: np.ndarray, first: np.ndarray, last: np.ndarray, factor: float) -> np.ndarray:
    """Points of a span with what lies across its chord made larger."""
    chord = last - first
    chord = chord / np.maximum(np.linalg.norm(chord, axis=-1, keepdims=True), 1e-300)
    from_first = inside - first[:, None]
    along = np.einsum("mkc,mc->mk", from_first, chord)[..., None] * chord[:, None]
    return first[:, None] + along + factor * (from_first - along)


def _speed(rope: _Rope, points: Any, along: Any, material: Any, tension: Any) -> np.ndarray | None:
    """Speed of the particles along the rope, from differences of frames: t.(dr/dt at a point - r' dp/dt there)."""
    time = rope.time
    if len(time) < 2:
        return None
    order = 2 if len(time) > 2 else 1
    speed = -(1.0 + tension / rope.stiffness) * np.gradient(material, time, axis=0, edge_order=order)
    for c in range(3):
        speed += along[..., c] * np.gradient(points[..., c], time, axis=0, edge_order=order)
    return speed


class _Rope:
    """What the pieces of the rope are made of, read once."""

    def __init__(self, result: Any, course: Course) -> None:
        self.result, self.course, self.scene = result, course, course.scene
        self.time = result.time
        self.position, self.material, self.ends = (
            result[name] for name in ("position", "material_coordinate", "tension")
        )
        self.force = result["axial_force"]
        self.node = nodes_of(self.scene)
        self.rho = np.array(course.layout.wheels.radius)
        self.stiffness = self.scene.rope.axial_stiffness
        if self.scene.rope.compression == "none":
            self.ends, self.force = np.maximum(self.ends, 0.0), np.maximum(self.force, 0.0)
        self.wrap = result["wrap_angle"] if self.scene.sheaves else np.zeros((len(self.time), 0))

    def stretch(self, tension: np.ndarray) -> np.ndarray:
        return 1.0 + tension / self.stiffness

    def point(self, i: int) -> _Piece:
        """An end of the rope at a point."""
        span = 0 if i == 0 else i - 1
        along = self.course.leaves[:, i] if i == 0 else self.course.comes[:, i]
        tension = self.ends[:, span, 0 if i == 0 else 1]
        place = self.course.center[:, i]
        return _Piece(place[:, None], along[:, None], self.material[:, [self.node[i]]], tension[:, None], (0,))

    def span(self, i: int) -> _Piece:
        """Nodes inside a span, and the middles of its elements; its ends belong to what it ends on."""
        course, first, last = self.course, self.node[i], self.node[i + 1]
        begin, end = course.touch(i, comes=False), course.touch(i + 1, comes=True)
        corners = np.concatenate([begin[:, None], self.position[:, first + 1 : last], end[:, None]], axis=1)
        material = np.concatenate(
            [self._at_touch(i, False)[:, None], self.material[:, first + 1 : last],
             self._at_touch(i + 1, True)[:, None]], axis=1,
        )  # fmt: skip
        along = np.diff(corners, axis=1)
        along = along / np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), 1e-300)
        force = self.force[:, first:last]
        count = last - first
        shape = (len(self.time), 2 * count - 1)
        points, directions = np.empty((*shape, 3)), np.empty((*shape, 3))
        laid, tension = np.empty(shape), np.empty(shape)
        for made, nodes in ((points, corners), (laid, material)):
            made[:, ::2] = 0.5 * (nodes[:, :-1] + nodes[:, 1:])
            made[:, 1::2] = nodes[:, 1:-1]
        directions[:, ::2], directions[:, 1::2] = along, _unit(along[:, :-1] + along[:, 1:])
        tension[:, ::2], tension[:, 1::2] = force, 0.5 * (force[:, :-1] + force[:, 1:])
        return _Piece(points, directions, laid, tension, tuple(range(1, 2 * count - 1, 2)))

    def _at_touch(self, i: int, comes: bool) -> np.ndarray:
        """Material coordinate where the rope runs onto an item, or leaves it, (m,) m."""
        if self.rho[i] == 0.0:
            return self.material[:, self.node[i]]
        middle, half = self._laid(i)
        return middle - half if comes else middle + half

    def _laid(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Material at the middle of what lies on a wheel, and half of what does; of a drum at its edge, and none."""
        sides = ([self.ends[:, i - 1, 1]] if i > 0 else []) + ([self.ends[:, i, 0]] if i < len(self.rho) - 1 else [])
        stretch = self.stretch(np.mean(sides, axis=0))
        middle = self.material[:, self.node[i]] + self.rho[i] * self.course.middle[:, i] / stretch
        if not isinstance(self.scene.path[i], Sheave):
            return middle, np.zeros_like(middle)
        return middle, 0.5 * abs(self.rho[i]) * self.wrap[:, self._number(i)] / stretch

    def _number(self, i: int) -> int:
        return sum(isinstance(item, Sheave) for item in self.scene.path[:i])

    def arc(self, i: int) -> _Piece:
        """What lies on a sheave; the tension goes over exponentially, as with a rope at the point of slipping."""
        wrap = self.wrap[:, self._number(i)]
        count = 2 * max(1, int(np.ceil(0.5 * float(wrap.max(initial=0.0)) / ARC_STEP))) + 1
        share = np.linspace(0.0, 1.0, count)
        points, along = self._around(i, self.course.touch(i, comes=True), wrap[:, None] * share)
        middle, half = self._laid(i)
        on, off = self.ends[:, i - 1, 1, None], self.ends[:, i, 0, None]
        tension = (1.0 - share) * on + share * off
        taut = (on > 0.0) & (off > 0.0)
        ratio = np.log(np.where(taut, off, 1.0) / np.where(taut, on, 1.0))
        tension = np.where(taut, on * np.exp(share * ratio), tension)
        material = middle[:, None] + half[:, None] * (2.0 * share - 1.0)
        return _Piece(points, along, material, tension, (count // 2,))

    def coil(self, i: int) -> _Piece:
        """Turns on a drum, those next to where the rope leaves it, side by side along its axis.

        How much lies on it is known where the scene says so; else `FEWEST_TURNS` are left when most is paid out. What
        tension deeper turns were wound with the run does not know: they are given that of the rope that leaves.
        """
        first = i == 0
        turns = turns_on(self.result, self.course, i)
        angle = 2.0 * np.pi * turns
        share = np.linspace(1.0, 0.0, int(np.ceil(float(angle.max()) / COIL_STEP)) + 1)
        back = (angle[:, None] * share) if first else (angle[:, None] * share)[:, ::-1]
        signed = -back if first else back
        lead = self.course.touch(i, comes=not first)
        points, along = self._around(i, lead, signed)
        pitch = PITCH * diameter_of(self.scene)
        points = points + (pitch * back / (2.0 * np.pi))[..., None] * self.course.axis[:, None, i]
        edge = self._at_touch(i, comes=not first)
        tension = self.ends[:, 0, 0] if first else self.ends[:, -1, 1]
        material = edge[:, None] + abs(self.rho[i]) * signed / self.stretch(tension)[:, None]
        borne = np.broadcast_to(tension[:, None], material.shape)
        return _Piece(points, along, material, borne, (len(share) - 1 if first else 0,))

    def _around(self, i: int, start: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points of the pitch circle, by angles (m, k) the way the rope runs from a point (m, 3) on it."""
        center, axis = self.course.center[:, i], np.sign(self.rho[i]) * self.course.axis[:, i]
        x = start - center
        y = np.cross(axis, x)
        c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
        points = center[:, None] + c * x[:, None] + s * y[:, None]
        return points, (c * y[:, None] - s * x[:, None]) / abs(self.rho[i])


def turns_on(result: Any, course: Course, i: int) -> np.ndarray:
    """Turns that are drawn on a drum at every frame, (m,), at least one."""
    drum = course.scene.path[i]
    k = [j for j, item in enumerate(course.scene.path) if isinstance(item, Drum)].index(i)
    out = result["paid_out"][:, k]
    stretch = course.layout.stretch
    if LEAD_ANGLE in result:
        out = out + result[LEAD_ANGLE][:, k] * drum.radius / stretch
    if drum.rope_on_drum is None:
        turns = FEWEST_TURNS + (out.max() - out) * stretch / (2.0 * np.pi * drum.radius)
    else:
        turns = np.maximum(drum.rope_on_drum - out, 0.0) * stretch / (2.0 * np.pi * drum.radius)
    most = MOST_TURNS if drum.layers is None else min(drum.layers.turns, MOST_TURNS)
    return np.clip(turns, 1.0, most)


def _unit(x: np.ndarray) -> np.ndarray:
    return x / np.maximum(np.linalg.norm(x, axis=-1, keepdims=True), 1e-300)
