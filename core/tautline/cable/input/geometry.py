"""Lengths and directions of elements as the scene places them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from tautline.cable.input.parts import CableScene, Element, Node, Vector
from tautline.scene.model import MADE

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(32)
POINTS, WEIGHTS = 0.5 * (POINTS[:, None] + 1.0), 0.5 * WEIGHTS
COINCIDENT = 1.0e-12
"""Distance, m, below which two nodes stand at one point."""
FARTHEST = 1.0e9
"""Length, m, beyond which no element is meant."""
MONOTONE = 3.0
"""Slopes up to which a straight cubic does not run back on itself (the usual bound of monotone interpolation)."""
LONGEST = 100.0
"""Chords among which the length of an element is looked for."""
WIDER, MOST_STEPS = 1.1, 100
"""Factor by which an interval grows until it holds a length; Newton steps within it, of which ten are many."""
DRAWN = "elements as they are drawn"
"""Where a scene keeps them."""
BLOCK = 2048
"""Elements that are looked at together: their points fit the cache."""


class Drawn(NamedTuple):
    """Elements as a scene draws them: whether they are linear (m,), their chords (m, 3) m, slopes at their ends (m, 3).

    The slopes of a linear element are zero.
    """

    linear: np.ndarray
    chord: np.ndarray
    first: np.ndarray
    second: np.ndarray

    @classmethod
    def of(cls, elements: Sequence[Element], nodes: Mapping[int, Node]) -> Drawn:
        """Of some elements; nodes by their ids."""
        ends = [(nodes[element.nodes[0]], nodes[element.nodes[1]]) for element in elements]
        none = (0.0, 0.0, 0.0)
        begin, end = (np.array([pair[i].position for pair in ends], dtype=float).reshape(-1, 3) for i in (0, 1))
        with np.errstate(over="ignore", invalid="ignore"):
            chords = end - begin
        return cls(
            np.array([element.kind == "linear" for element in elements], dtype=bool),
            chords,
            *(np.array([pair[i].slope or none for pair in ends]).reshape(-1, 3) for i in (0, 1)),
        )

    @property
    def distance(self) -> np.ndarray:
        """Between the nodes of each element (m,), m."""
        return np.array([math.hypot(*line) for line in self.chord.tolist()])

    def part(self, which: np.ndarray | slice) -> Drawn:
        """Some of the elements."""
        return Drawn(*(values[which] for values in self))


def drawn_of(scene: CableScene) -> Drawn:
    """All elements of a scene, in its order; found once, for a scene does not change."""
    kept = scene.__dict__.setdefault(MADE, {})
    if DRAWN not in kept:
        kept[DRAWN] = Drawn.of(scene.elements, {node.id: node for node in scene.nodes})
    return kept[DRAWN]


def chord(first: Vector, second: Vector) -> Vector:
    """Vector from one point to another, m."""
    (x1, y1, z1), (x2, y2, z2) = first, second
    return x2 - x1, y2 - y1, z2 - z1


def arc_lengths(drawn: Drawn, length: np.ndarray) -> np.ndarray:
    """Arcs (m,), m, of elements whose slopes are dr/dp and whose material lengths are ``length`` (m,), m.

    Gauss quadrature with 32 points: to rounding where the cubic has no cusp. Infinite where slopes are beyond numbers.
    """
    arcs = np.where(drawn.linear, drawn.distance, 0.0)
    cubic = np.flatnonzero(~drawn.linear)
    for begin in range(0, cubic.size, BLOCK):
        some = cubic[begin : begin + BLOCK]
        arcs[some] = _arcs(_rates(drawn.part(some), length[some])[0])
    return arcs


def _rates(drawn: Drawn, length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How fast cubics go, dr/dx (m, points, 3), m, and how that grows with the material length (m, points, 3)."""
    x = POINTS
    with np.errstate(over="ignore", invalid="ignore"):
        turning = (1.0 - 4.0 * x + 3.0 * x * x) * drawn.first[:, None] + (3.0 * x * x - 2.0 * x) * drawn.second[:, None]
        return 6.0 * x * (1.0 - x) * drawn.chord[:, None] + length[:, None, None] * turning, turning


def _arcs(rate: np.ndarray) -> np.ndarray:
    """Arcs of cubics (m,), m."""
    with np.errstate(over="ignore", invalid="ignore"):
        arc = np.sqrt(_dot(rate, rate)) @ WEIGHTS
    return np.where(np.isfinite(arc), arc, math.inf)


def _growth(rate: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """How the arcs of cubics grow with the material length (m,)."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        return (_dot(rate, turning) / np.sqrt(_dot(rate, rate))) @ WEIGHTS


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar products of vectors (..., 3): part by part, for a sum over three numbers takes numpy twice as long."""
    x, y, z = (a[..., i] * b[..., i] for i in range(3))
    return x + y + z


def unstretched_lengths(drawn: Drawn) -> np.ndarray:
    """Unstretched lengths (m,), m, of elements that lie unstretched: a chord, or the L with which the cubic's arc is L.

    Not a number where there is none: the nodes coincide, or are astronomically far apart, or the slopes are so long
    that the arc always exceeds it.
    """
    distance = drawn.distance
    good = (distance > COINCIDENT) & (distance < FARTHEST)
    lengths = np.where(good, distance, math.nan)
    curved = np.flatnonzero(good & ~drawn.linear)
    curved = curved[~_is_straight(drawn.part(curved), distance[curved])]
    for begin in range(0, curved.size, BLOCK):
        some = curved[begin : begin + BLOCK]
        lengths[some] = _own_arcs(drawn.part(some), distance[some])
    return lengths


def _own_arcs(drawn: Drawn, distance: np.ndarray) -> np.ndarray:
    """The shortest lengths (m,), m, with which the arcs of cubics are as long; not a number if none is found."""

    def excess(length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rate, turning = _rates(drawn, length)
        return _arcs(rate) - length, _growth(rate, turning) - 1.0

    low, high = distance, WIDER * distance
    is_chord = excess(low)[0] <= 1e-15 * distance
    while (beyond := ~is_chord & (high <= LONGEST * distance) & (excess(high)[0] > 0.0)).any():
        low, high = np.where(beyond, high, low), np.where(beyond, WIDER * high, high)
    x = 0.5 * (low + high)
    for _ in range(MOST_STEPS):
        error, growth = excess(x)
        low, high = np.where(error > 0.0, x, low), np.where(error > 0.0, high, x)
        with np.errstate(all="ignore"):
            newton = x - error / growth
        following = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
        moved, x = np.abs(following - x), np.where(error == 0.0, x, following)
        if not (moved > 1e-15 * distance)[~is_chord].any():
            break
    return np.where(is_chord, distance, np.where(high <= LONGEST * distance, x, math.nan))


def _is_straight(drawn: Drawn, distance: np.ndarray) -> np.ndarray:
    """Whether both slopes point along the chord, and are short enough for the cubic to run one way (m,)."""
    straight = np.ones(distance.size, dtype=bool)
    for slope in (drawn.first, drawn.second):
        size = np.sqrt((slope * slope).sum(axis=1))
        along = (slope * drawn.chord).sum(axis=1) / distance
        across = np.sqrt(np.maximum(0.0, (size - along) * (size + along)))
        straight &= (along > 0.0) & (along <= MONOTONE) & ~(across > 1e-14 * size)
    return straight


def mean_direction(chords: Iterable[Vector]) -> Vector | None:
    """Unit vector of the mean of the directions of some vectors; None if they have none, or cancel."""
    total = [0.0, 0.0, 0.0]
    for vector in chords:
        size = math.hypot(*vector)
        if size > COINCIDENT:
            total = [t + v / size for t, v in zip(total, vector, strict=True)]
    size = math.hypot(*total)
    return (total[0] / size, total[1] / size, total[2] / size) if size > 1e-9 else None
