"""Lengths and directions of elements as the scene places them."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from tautline.cable.input.parts import Element, Node, Vector

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(32)
POINTS, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS
COINCIDENT = 1.0e-12
"""Distance, m, below which two nodes stand at one point."""
FARTHEST = 1.0e9
"""Length, m, beyond which no element is meant."""
MONOTONE = 3.0
"""Slopes up to which a straight cubic does not run back on itself (the usual bound of monotone interpolation)."""
LONGEST = 100.0
"""Chords among which the length of an element is looked for."""


def chord(first: Vector, second: Vector) -> Vector:
    """Vector from one point to another, m."""
    (x1, y1, z1), (x2, y2, z2) = first, second
    return x2 - x1, y2 - y1, z2 - z1


def arc_length(first: Node, second: Node, length: float) -> float:
    """Arc, m, of the cubic between two nodes whose slopes are dr/dp and whose material length is `length`, m.

    Gauss quadrature with 32 points: to rounding where the cubic has no cusp. Infinite where slopes are beyond numbers.
    """
    assert first.slope is not None and second.slope is not None
    x = POINTS[:, None]
    with np.errstate(over="ignore", invalid="ignore"):
        rate = 6.0 * x * (1.0 - x) * np.array(chord(first.position, second.position))
        rate = rate + length * (1.0 - 4.0 * x + 3.0 * x * x) * np.array(first.slope)
        rate = rate + length * (3.0 * x * x - 2.0 * x) * np.array(second.slope)
        arc = float(WEIGHTS @ np.sqrt((rate * rate).sum(axis=1)))
    return arc if math.isfinite(arc) else math.inf


def element_length(element: Element, first: Node, second: Node) -> float | None:
    """Unstretched length, m, of an element that lies unstretched: its chord, or L where the arc of the cubic is L.

    None if there is none: the nodes coincide, or are astronomically far apart, or the slopes are so long that the arc
    always exceeds it.
    """
    straight = math.hypot(*chord(first.position, second.position))
    if not COINCIDENT < straight < FARTHEST:
        return None
    if element.kind == "linear" or _is_straight(first, second):
        return straight

    def excess(length: float) -> float:
        return arc_length(first, second, length) - length

    low, high = straight, 1.1 * straight
    if excess(low) <= 1e-15 * straight:
        return straight
    while excess(high) > 0.0:
        low, high = high, 1.1 * high
        if high > LONGEST * straight:
            return None
    from scipy.optimize import brentq

    return float(brentq(excess, low, high, xtol=1e-15 * straight, rtol=1e-15))


def _is_straight(first: Node, second: Node) -> bool:
    """Whether both slopes point along the chord, and are short enough for the cubic to run one way."""
    line = chord(first.position, second.position)
    whole = math.hypot(*line)
    for slope in (first.slope, second.slope):
        assert slope is not None
        size = math.hypot(*slope)
        along = sum(a * b for a, b in zip(slope, line, strict=True)) / whole
        if not 0.0 < along <= MONOTONE or math.sqrt(max(0.0, (size - along) * (size + along))) > 1e-14 * size:
            return False
    return True


def mean_direction(chords: Iterable[Vector]) -> Vector | None:
    """Unit vector of the mean of the directions of some vectors; None if they have none, or cancel."""
    total = [0.0, 0.0, 0.0]
    for vector in chords:
        size = math.hypot(*vector)
        if size > COINCIDENT:
            total = [t + v / size for t, v in zip(total, vector, strict=True)]
    size = math.hypot(*total)
    return (total[0] / size, total[1] / size, total[2] / size) if size > 1e-9 else None
