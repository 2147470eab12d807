"""Rope between fixed places, which carries nothing but itself: how it sags, and what tension that takes.

A parabola stands for the catenary: as the shape from which rest is looked for, and for estimates before a run.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

STATIONS = 400
"""Points at which the length of a parabola is measured."""
PLUMB = 1.0e-9
"""Level over upright distance below which a rope hangs plumb."""
ASIDE = 1.0e-3
"""Share of its length by which the ends of a slack rope are drawn apart where they are plumb above one another."""
ROUNDS, HALVINGS = 8, 60
"""By which a catenary finds its stretch, and its shape."""


class Sag(NamedTuple):
    """How a span hangs: `points` (n + 1, 3), as much rope between each and the next; `tension` (2,) at its ends, N."""

    points: np.ndarray
    tension: np.ndarray


def sagging(ends: np.ndarray, length: float, count: int, weight: np.ndarray, stiffness: float) -> Sag:
    """Let a rope hang between two points.

    Parameters
    ----------
    ends : (2, 3) array
        m.
    length : float
        Unstretched rope between them, m; it may be more or less than their distance.
    count : int
        Pieces that it is divided into.
    weight : (3,) array
        N/m.
    stiffness : float
        EA, N.
    """
    chord = ends[1] - ends[0]
    distance = float(np.linalg.norm(chord))
    e = chord / distance
    load = float(np.linalg.norm(weight))
    across = float(np.linalg.norm(weight - (weight @ e) * e))
    share = np.linspace(0.0, 1.0, STATIONS + 1)
    plumb = across <= PLUMB * load
    if plumb and load > 0.0 and length > distance:
        return _bight(ends, length, count, weight, stiffness)
    if load == 0.0 or plumb:
        # It hangs along its chord.
        level = max(0.0, stiffness * (distance / length - 1.0))
        return Sag(ends[0] + np.linspace(0.0, 1.0, count + 1)[:, None] * chord, _ends(level, e, weight * length))

    def curve(sag: float) -> np.ndarray:
        return ends[0] + share[:, None] * chord + (4.0 * sag * share * (1.0 - share))[:, None] * (weight / load)

    def pull(sag: float) -> float:
        """Force along the chord that bears the weight, whose sag is measured along the weight, N."""
        return load * length * distance / (8.0 * sag)

    def lacking(sag: float) -> float:
        """Length of the curve less that of the rope which its tension stretches."""
        way = float(np.linalg.norm(np.diff(curve(sag), axis=0), axis=1).sum())
        return way - length * (1.0 + pull(sag) / stiffness)

    from scipy.optimize import brentq

    high = distance + length
    sag = float(brentq(lacking, 1.0e-12 * distance, 4.0 * high, xtol=1.0e-12 * distance))
    line = curve(sag)
    along = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))))
    at = np.linspace(0.0, along[-1], count + 1)
    points = np.column_stack([np.interp(at, along, line[:, c]) for c in range(3)])
    return Sag(points, _ends(pull(sag), e, weight * length))


def _bight(ends: np.ndarray, length: float, count: int, weight: np.ndarray, stiffness: float) -> Sag:
    """Slack rope between two points that are plumb above one another: that of points a little aside, drawn together.

    Along its chord the rope would stand pressed together, from where no search finds down to a bight.
    """
    side = np.cross(weight, np.eye(3)[np.argmin(np.abs(weight))])
    aside = ASIDE * length * side / np.linalg.norm(side)
    drawn = sagging(ends + np.array([np.zeros(3), aside]), length, count, weight, stiffness)
    return drawn._replace(points=drawn.points - np.linspace(0.0, 1.0, count + 1)[:, None] * aside)


def _ends(pull: float, e: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Tension at both ends of a span that is pulled along its chord, and whose ends bear half its weight each, N."""
    first, last = pull * e + 0.5 * weight, pull * e - 0.5 * weight
    return np.linalg.norm([first, last], axis=1) if pull > 0.0 else np.array([0.0, 0.0])


def foot_of_catenary(across: float, rise: float, length: float, weight: float, stiffness: float) -> float:
    """Tension at the lower end of a rope that is longer than the way between its ends, N: also where it hangs steep.

    Of a rope that hangs plumb it is what the lower end bears of the bight: half of the rope that is too long.

    Parameters
    ----------
    across, rise : float
        Level and upright distance of the ends, m.
    length : float
        Unstretched, m.
    weight : float
        N/m.
    stiffness : float
        EA, N.
    """
    stretched = length
    for _ in range(ROUNDS):
        load = weight * length / stretched
        # H = q b / (2 x), V = (q / 2) (z coth x -+ l), and sinh(x) / x = sqrt(l^2 - z^2) / b.
        x = _slackness(math.sqrt(stretched**2 - rise**2) / across) if across > PLUMB * rise else math.inf
        level = load * across / (2.0 * x)
        low, high = (0.5 * load * (rise / math.tanh(x) + sign * stretched) for sign in (-1.0, 1.0))
        foot = math.hypot(level, low)
        stretched = length * (1.0 + 0.5 * (foot + math.hypot(level, high)) / stiffness)
    return foot


def _slackness(ratio: float) -> float:
    """The x at which sinh(x) / x is a ratio, which is more than 1."""
    wanted, low = math.log(ratio), 0.0
    high = 2.0 * wanted + 4.0
    for _ in range(HALVINGS):
        x = 0.5 * (low + high)
        # No sinh, which overflows.
        below = x + math.log(-math.expm1(-2.0 * x) / (2.0 * x)) < wanted
        low, high = (x, high) if below else (low, x)
    return 0.5 * (low + high)
