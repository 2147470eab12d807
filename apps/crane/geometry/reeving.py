"""The way of a taut rope over sheaves in space: wraps, fleet angles, lengths and marks.

A rope runs over a row of wheels, of which the first and the last are a drum or a point each. `crane.geometry.tangents`
says what a wheel is and how a span touches it, `crane.geometry.wrap_sides` which way round the rope runs. Lengths are
in m, angles in rad.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crane.geometry.clearance import cut_sheaves, refuse_overlap
from crane.geometry.tangents import (
    ReevingError,
    Span,
    Wheel,
    beside,
    checked,
    span_between,
    tangent,
    turned,
    wrap_angle,
)
from crane.geometry.wrap_sides import sigma_of

__all__ = ["Path", "ReevingError", "Span", "Wheel", "reeve", "sigma_of", "tangent", "turned", "wrap_angle"]

LEAST_WRAP, PASSED = 1e-9, 2.0 * math.pi - 0.2
"""Wraps of a rope that does not touch: none, or all of a turn less the small bend of a rope that passes by."""
CROSSED = 1.5 * math.pi
"""Wrap above which the rope's two spans cross beside the sheave."""


@dataclass(frozen=True, eq=False)
class Path:
    """The path of a rope over n wheels.

    Attributes
    ----------
    sigma : int array (n,)
    spans : tuple of Span
        n - 1.
    tangents : array (n - 1, 2, 3)
        Where each span begins and ends, m.
    wraps : array (n,)
        Angle of contact, rad; 0 at both ends of the path, what is wound on a drum left out.
    arcs : array (n,)
        Length of contact, m.
    fleet : array (n - 1, 2)
        Angle of a span out of the plane of the wheel it leaves and of that it runs onto, positive along the axis,
        rad; 0 at a point.
    marks : array (n, 3)
        Direction from the centre to the middle of the wrap, or at an end of the path to where the rope leaves.
    before, after : array (n,)
        Right-handed angle about the axis from the mark to where the rope runs on, and to where it leaves, rad.
    chords : array (n - 1,)
        Length of rope from mark to mark, m.
    length : float
        m.
    warnings : list of str
        What is odd about the path but does not forbid it.
    """

    sigma: np.ndarray
    spans: tuple[Span, ...]
    tangents: np.ndarray
    wraps: np.ndarray
    arcs: np.ndarray
    fleet: np.ndarray
    marks: np.ndarray
    before: np.ndarray
    after: np.ndarray
    chords: np.ndarray
    length: float
    warnings: list[str]


def reeve(wheels: Sequence[Wheel], sigma: np.ndarray, thickness: float = 0.0) -> Path:
    """Lay a taut rope over wheels.

    Parameters
    ----------
    wheels : sequence of Wheel
        In the order of the rope, n >= 2.
    sigma : int array (n,)
        +1 where the rope runs right-handed about the axis, -1 where left-handed; see `sigma_of`.
    thickness : float
        Width along its axis, m, over which a sheave is in the way of spans that only run past it; such as the rope's
        diameter.

    Returns
    -------
    Path

    Raises
    ------
    ReevingError
        Where a span has no tangent, two wheels next to one another on the rope cut into each other, or the rope would
        pass a sheave without touching it.
    """
    checked(wheels)
    n = len(wheels)
    sigma = np.array(sigma, dtype=int)
    if sigma.shape != (n,) or not np.isin(sigma, (-1, 1)).all():
        raise ReevingError(f"{n} items need as many signs, +1 or -1", "take those of sigma_of")
    spans = tuple(span_between(wheels, k, int(sigma[k]), int(sigma[k + 1])) for k in range(n - 1))
    for k in range(n - 1):
        refuse_overlap(wheels, k)
    wraps, marks = np.zeros(n), np.zeros((n, 3))
    for j, wheel in enumerate(wheels):
        wraps[j], marks[j] = _wrap_and_mark(wheel, int(sigma[j]), spans[j - 1 : j] if j else (), spans[j : j + 1])
        if 0 < j < n - 1 and wheel.radius > 0.0 and not LEAST_WRAP <= wraps[j] <= PASSED:
            message = f"the rope passes {wheel.name!r} without touching it"
            raise ReevingError(message, "turn its wrap to the other side, or move it into the path of the rope", j)
    radii = np.array([wheel.radius for wheel in wheels])
    lengths = np.array([span.length for span in spans])
    after, before = 0.5 * sigma * wraps, -0.5 * sigma * wraps
    rho = sigma * radii
    return Path(
        sigma=sigma,
        spans=spans,
        tangents=np.array([[wheels[k].center + s.x1, wheels[k + 1].center + s.x2] for k, s in enumerate(spans)]),
        wraps=wraps,
        arcs=radii * wraps,
        fleet=np.array([[_fleet(s.e, wheels[k]), _fleet(s.e, wheels[k + 1])] for k, s in enumerate(spans)]),
        marks=marks,
        before=before,
        after=after,
        chords=lengths + rho[:-1] * after[:-1] - rho[1:] * before[1:],
        length=float(lengths.sum() + (radii * wraps).sum()),
        warnings=[*_crossings(wheels, wraps), *cut_sheaves(wheels, spans, thickness)],
    )


def _wrap_and_mark(
    wheel: Wheel, sign: int, before: Sequence[Span], after: Sequence[Span]
) -> tuple[float, np.ndarray]:  # fmt: skip
    """Angle of contact, and the direction of its middle; at an end of the path 0 and that of the tangent point."""
    sides = [sign * beside(span.e, wheel.axis) for span in (*before, *after)]
    if len(sides) == 1:
        if sides[0].any():
            return 0.0, sides[0]
        # A point has no axis of its own: any direction across the rope will do.
        return 0.0, beside((*before, *after)[0].e, np.eye(3)[int(np.argmin(np.abs((*before, *after)[0].e)))])
    axis = sign * wheel.axis
    angle = wrap_angle(sides[0], sides[1], axis)
    return angle, turned(sides[0], axis, 0.5 * angle)


def _fleet(e: np.ndarray, wheel: Wheel) -> float:
    return 0.0 if wheel.point else math.asin(min(1.0, max(-1.0, float(np.dot(e, wheel.axis)))))


def _crossings(wheels: Sequence[Wheel], wraps: np.ndarray) -> list[str]:
    return [
        f"the rope wraps {wheel.name!r} by {math.degrees(wrap):.4g} deg: it crosses itself beside it"
        for wheel, wrap in zip(wheels, wraps, strict=True)
        if wrap > CROSSED and wheel.radius > 0.0
    ]
