"""Sheaves in each other's way, and spans that run through a sheave."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from crane.geometry.tangents import PARALLEL, ReevingError, Span, Wheel, cross

GRAZES = 1e-6
"""Part of its radius by which a rope may cut into a sheave that it only runs past."""


def refuse_overlap(wheels: Sequence[Wheel], k: int) -> None:
    """Refuse a wheel and the next if they cut into each other.

    Sheaves are thin here: two beside each other on parallel axes are in nobody's way.

    Raises
    ------
    ReevingError
    """
    one, two = wheels[k], wheels[k + 1]
    if one.radius == 0.0 or two.radius == 0.0 or not _discs_meet(one, two):
        return
    message = f"{one.name!r} and {two.name!r} overlap: they cut into each other"
    raise ReevingError(message, f"move them more than {one.radius + two.radius:.6g} m apart", k)


def cut_sheaves(wheels: Sequence[Wheel], spans: Sequence[Span], thickness: float) -> list[str]:
    """Warnings of spans that run through a sheave they do not touch, each sheave `thickness` m wide."""
    found = []
    for k, (one, two) in enumerate(pairwise(wheels)):
        start, end = one.center + spans[k].x1, two.center + spans[k].x2
        for wheel in wheels:
            if wheel is one or wheel is two:
                continue
            inside = _inside(start, end, wheel, thickness)
            if inside > GRAZES * wheel.radius:
                found.append(
                    f"the rope from {one.name!r} to {two.name!r} runs through {wheel.name!r}, up to {inside:.3g} m "
                    f"inside its radius of {wheel.radius:.3g} m. In a run it passes there as if there were no sheave. "
                    "Move the sheave, or the ends of that rope, aside along the axis of the sheave"
                )
    return found


def _discs_meet(one: Wheel, two: Wheel) -> bool:
    """Whether two discs have a point in common."""
    d = two.center - one.center
    along = cross(one.axis, two.axis)
    sine = float(np.dot(along, along))
    if sine < PARALLEL:
        height = float(np.dot(one.axis, d))
        flat = abs(height) <= 1e-9 * (one.radius + two.radius)
        return flat and float(np.linalg.norm(d - height * one.axis)) < one.radius + two.radius
    # Both planes meet in one line; each disc takes a piece of it, of half a chord either side of its foot.
    along = along / math.sqrt(sine)
    foot = np.dot(two.axis, d) * cross(along, one.axis) / np.dot(two.axis, cross(along, one.axis))
    reach = []
    for wheel, center in ((one, np.zeros(3)), (two, d)):
        place = float(np.dot(center, along))
        half = wheel.radius**2 - float(np.sum((foot + along * place - center) ** 2))
        if half <= 0.0:
            return False
        reach.append((place - math.sqrt(half), place + math.sqrt(half)))
    return max(reach[0][0], reach[1][0]) < min(reach[0][1], reach[1][1])


def _inside(start: np.ndarray, end: np.ndarray, wheel: Wheel, thickness: float) -> float:
    """How far a straight line comes inside the rim of a disc of some thickness, m; 0 where it does not."""
    if wheel.radius <= 0.0:
        return 0.0
    p, d = start - wheel.center, end - start
    height, climb = float(np.dot(p, wheel.axis)), float(np.dot(d, wheel.axis))
    half = max(0.5 * thickness, 1e-9 * (wheel.radius + float(np.linalg.norm(p))))
    lower, upper = 0.0, 1.0
    if abs(climb) > 0.0:
        ends = sorted(((-half - height) / climb, (half - height) / climb))
        lower, upper = max(lower, ends[0]), min(upper, ends[1])
    elif abs(height) > half:
        return 0.0
    if lower > upper:
        return 0.0
    flat, way = p - height * wheel.axis, d - climb * wheel.axis
    speed = float(np.dot(way, way))
    nearest = -float(np.dot(flat, way)) / speed if speed > 0.0 else lower
    nearest = min(upper, max(lower, nearest))
    return max(0.0, wheel.radius - float(np.linalg.norm(flat + nearest * way)))
