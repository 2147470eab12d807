"""Words and scales of a drill string's picture: what its parts are called, and how deep they are."""

from __future__ import annotations

import math

import numpy as np

from drillstring.view.string_curve import Drawn, turned_over
from tautline.scene.values.systems import length_unit
from tautline.view.space.appearance import ARROW, Label, Line, Ruler, still

TICKS = 9
"""Of a ruler, at most."""
LINE = 0.035
"""Distance of lines of words over the size of the picture."""


def words(drawn: Drawn, size: float, low: list[Line]) -> tuple[Label, ...]:
    """Names of things: the bit; unrolled, the sections and the low side of the hole beside it."""
    course = drawn.course
    if not drawn.unrolled:
        return (Label("bit", lambda frame: drawn.end(frame)[0]),)
    below = np.array([0.0, 0.0, 0.0 if course.hole is None else -0.05 * size])
    said = [Label("bit", lambda frame: drawn.end(frame)[0] + below)]
    right = drawn.right
    middle = 0.5 * (course.depth[0, 1:] + course.depth[0, :-1])
    places = [(str(name), float(middle[course.section == name].mean())) for name in dict.fromkeys(course.section)]
    if low:
        # Where it is farthest from other words.
        depths = -np.concatenate([line.points(0)[:, 2] for line in low])
        taken = np.array([depth for _, depth in places] + [float(course.depth[0, -1])])
        places.append(("low side", float(depths[np.argmax(np.abs(depths[:, None] - taken).min(axis=1))])))
    places.sort(key=lambda place: place[1])
    depths = _apart(np.array([depth for _, depth in places]), LINE * size, float(course.path[-1]))
    for (name, _), depth in zip(places, depths, strict=True):
        if course.hole is None:
            lump = int(np.argmin(np.abs(course.depth[0] - depth)))
            at = drawn.place(depth, *course.lateral[0, lump]) + drawn.factor * float(course.diameter.max()) * right
        else:
            at = drawn.place(depth, 0.0, 0.0) + (0.5 * drawn.factor * course.hole + ARROW * size) * right
        said.append(Label(name, still(at)))
    return tuple(said)


def depth_scale(drawn: Drawn, size: float, units: str = "si") -> Ruler:
    """Depth at the left: along an unrolled hole, else true vertical depth; in the units of a system."""
    metres, unit = length_unit(units)
    course = drawn.course
    right = drawn.right
    if drawn.unrolled:
        numbers = metres * _round(0.0, course.deepest / metres, TICKS)
        aside = drawn.factor * course.widest + 0.14 * size
        points = -aside * right - np.outer(numbers, [0.0, 0.0, 1.0])
        return Ruler("measured depth", unit, points, (numbers / metres).round(9))
    axis = turned_over(course.well.position(course.path))
    low, high = float(-axis[:, 2].max()), float(-axis[:, 2].min())
    if high - low > 0.02 * size:
        numbers = metres * _round(min(low, 0.0) / metres, high / metres, TICKS)
        text, aside, heights = "true vertical depth", 0.24, -numbers
    else:
        # Of a level string depth is offset, and drawn as such.
        string = course.well.point(course.depth, course.lateral[..., 0], course.lateral[..., 1])
        high = max(float(string[..., 2].max()), course.widest)
        numbers = metres * _round(0.0, high / metres, max(3, min(TICKS, int(drawn.factor * high / (LINE * size)))))
        text, aside, heights = "depth", 0.1, -drawn.factor * numbers
    beside = (axis[0] - aside * size * right)[:2]
    points = np.column_stack([np.broadcast_to(beside, (numbers.size, 2)), heights])
    return Ruler(text, unit, points, (numbers / metres).round(9))


def _apart(depths: np.ndarray, gap: float, last: float) -> np.ndarray:
    """Rising depths moved so that they are a gap apart, and none below the last if there is room."""
    steps = gap * np.arange(depths.size)
    apart = np.maximum.accumulate(depths - steps) + steps
    return np.minimum.accumulate(np.minimum(apart, last)[::-1] + steps)[::-1] - steps[::-1]


def _round(low: float, high: float, most: int) -> np.ndarray:
    """Round numbers from low to high, so many at most."""
    rough = (high - low) / (most - 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = power * next(digit for digit in (1.0, 2.0, 2.5, 5.0, 10.0) if digit * power >= rough * (1.0 - 1e-9))
    return step * np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
