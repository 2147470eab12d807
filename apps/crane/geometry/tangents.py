"""Wheels, and the straight rope that touches two of them in space.

On a wheel with centre c, unit axis a and pitch radius R the rope turns right-handed about the axis, sigma = +1, or
left-handed, -1; with rho = sigma R and the direction e of a span it touches at c + rho w, w = (e x a)/|e x a|. A point
is a wheel of radius 0. Lengths are in m, angles in rad.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tautline.errors import TautlineError

SETTLED, MOST_ITERATIONS = 1e-15, 200
"""Change of a span's direction at which it is found. Parallel axes take one or two iterations, sheaves of a crane a
dozen; only sheaves that nearly touch under axes far from parallel take more than 30."""
PARALLEL = 1e-12
"""Square of the sine of the angle between two axes below which they count as parallel."""

Names = tuple[str, str]


class ReevingError(TautlineError, ValueError):
    """A path that no taut rope can take.

    Parameters
    ----------
    message : str
        What is wrong.
    cure : str
        What to write instead.
    index : int, optional
        Number, from zero, of the wheel at fault, or of the first of two.
    """

    def __init__(self, message: str, cure: str, index: int | None = None):
        super().__init__(f"{message}; {cure}")
        self.message, self.cure, self.index = message, cure, index


@dataclass(frozen=True, eq=False)
class Wheel:
    """A drum, a sheave or, of radius 0, a point that the rope ends at.

    Parameters
    ----------
    name : str
    center : array (3,)
        m.
    axis : array (3,)
        Of length one; that of a point is of no effect.
    radius : float
        Pitch radius, m; 0 for a point.
    wrap : str or None
        Side of the centre that the rope passes on: over, under; about an upright axis left, right of its travel.
    point : bool
        Whether this is a point, which stands only at an end of the path.
    """

    name: str
    center: np.ndarray
    axis: np.ndarray
    radius: float
    wrap: str | None = None
    point: bool = False

    def __post_init__(self) -> None:
        for key in ("center", "axis"):
            object.__setattr__(self, key, np.array(getattr(self, key), dtype=float))


@dataclass(frozen=True, eq=False)
class Span:
    """The straight rope between two wheels.

    `e` (3,) is its direction, `x1` and `x2` (3,) lead from either centre to where it touches, m; `length` is in m.
    """

    e: np.ndarray
    x1: np.ndarray
    x2: np.ndarray
    length: float
    iterations: int


def tangent(
    c1: np.ndarray, a1: np.ndarray, rho1: float, c2: np.ndarray, a2: np.ndarray, rho2: float,
    names: Names = ("the first sheave", "the second sheave"), index: int | None = None,
) -> Span:  # fmt: skip
    """Straight rope from one wheel to the next.

    Parameters
    ----------
    c1, c2 : array (3,)
        Centres, m.
    a1, a2 : array (3,)
        Axes, of length one.
    rho1, rho2 : float
        Radii with the sign of the turning about the axis, m; 0 is a point.
    names : tuple of str
        What an error calls the two.
    index : int, optional
        Number of the first, for errors.

    Returns
    -------
    Span
        Its direction solves e = (d + x2(e) - x1(e))/l, d = c2 - c1, to rounding.

    Raises
    ------
    ReevingError
        Where there is no such line: one wheel lies within the other, or they are too close for a crossing rope.
    """
    d = np.asarray(c2, dtype=float) - np.asarray(c1, dtype=float)
    a1, a2 = np.asarray(a1, dtype=float), np.asarray(a2, dtype=float)
    e = _direction_at_mean_axis(d, a1, rho1, a2, rho2, names, index)
    rounding = 0.4 * SETTLED * (float(np.linalg.norm(d)) + abs(rho1) + abs(rho2))
    for iteration in range(1, MOST_ITERATIONS + 1):
        x1, x2 = rho1 * beside(e, a1), rho2 * beside(e, a2)
        chord = d + x2 - x1
        length = float(np.linalg.norm(chord))
        if length <= rounding:
            break
        e, last = chord / length, e
        if np.linalg.norm(e - last) <= max(SETTLED, rounding / length):
            return Span(e, rho1 * beside(e, a1), rho2 * beside(e, a2), length, iteration)
    first, second = names
    message = f"{first!r} and {second!r} are too close for their axes: no straight rope touches both"
    raise ReevingError(message, "move them apart, or turn their axes towards one another's direction", index)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of two vectors (3,); numpy's own is made for many and takes ten times as long for one."""
    (a0, a1, a2), (b0, b1, b2) = a.tolist(), b.tolist()
    return np.array([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0])


def beside(e: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Unit vector w = (e x a)/|e x a| (3,); zero where the rope runs along the axis."""
    w = cross(e, a)
    size = float(np.linalg.norm(w))
    return w / size if size > 1e-12 else np.zeros(3)


def _direction_at_mean_axis(
    d: np.ndarray, a1: np.ndarray, rho1: float, a2: np.ndarray, rho2: float, names: Names, index: int | None
) -> np.ndarray:
    """Direction of the tangent as if both axes were their mean: the closed form, exact where they are parallel."""
    a1, a2 = (a2, a2) if rho1 == 0.0 else (a1, a1) if rho2 == 0.0 else (a1, a2)
    turn = 1.0 if np.dot(a1, a2) >= 0.0 else -1.0
    across = float(np.dot(cross(a1, a2), cross(a1, a2)))
    distance = float(np.linalg.norm(d))
    if rho1 == rho2 == 0.0:
        if distance == 0.0:
            raise _no_tangent(names, index, 0.0, rho1, rho2)
        return d / distance
    mean = a1 + turn * a2
    mean = mean / np.linalg.norm(mean)
    delta = rho1 - turn * rho2
    seen = d - mean * np.dot(mean, d)
    apart = float(np.linalg.norm(seen))
    if apart <= abs(delta) * (1.0 + 1e-12) or apart <= 1e-12 * distance:
        if across < PARALLEL:
            raise _no_tangent(names, index, apart, rho1, turn * rho2)
        return d / distance if distance > 0.0 else cross(a1, a2) / math.sqrt(across)
    inside = math.sqrt((apart - delta) * (apart + delta))
    chord = (inside * seen + delta * cross(mean, seen)) * (inside / apart**2) + mean * np.dot(mean, d)
    return chord / np.linalg.norm(chord)


def _no_tangent(names: Names, index: int | None, apart: float, rho1: float, rho2: float) -> ReevingError:
    """What is wrong with two wheels of parallel axes `apart` that no line touches as wanted."""
    first, second = names
    if rho1 == rho2 == 0.0:
        return ReevingError(f"{first!r} and {second!r} are at one place", "move one of them", index)
    if rho1 * rho2 == 0.0:
        point, wheel = (first, second) if rho1 == 0.0 else (second, first)
        radius = max(abs(rho1), abs(rho2))
        message = f"{point!r} lies inside {wheel!r}, {apart:.6g} m from an axis with rope at {radius:.6g} m"
        return ReevingError(message, "move it out of the wheel", index)
    if rho1 * rho2 > 0.0:
        message = (
            f"{first!r} and {second!r}: one lies inside the other, axes {apart:.6g} m apart and radii "
            f"{abs(rho1):.6g} and {abs(rho2):.6g} m"
        )
        return ReevingError(message, f"move them more than {abs(rho1) + abs(rho2):.6g} m apart", index)
    message = (
        f"{first!r} and {second!r} overlap: axes {apart:.6g} m apart, and a rope that crosses from one side to the "
        f"other needs more than {abs(rho1) + abs(rho2):.6g} m"
    )
    return ReevingError(message, "move them apart, or turn the wrap of one of them", index)


def wrap_angle(x_in: np.ndarray, x_out: np.ndarray, axis: np.ndarray) -> float:
    """Angle from one direction to another, right-handed about a unit axis across both, in [0, 2 pi)."""
    angle = math.atan2(float(np.dot(axis, cross(x_in, x_out))), float(np.dot(x_in, x_out)))
    return angle + 2.0 * math.pi if angle < 0.0 else angle


def turned(x: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Vector (3,) across a unit axis, turned right-handed about it by an angle."""
    return math.cos(angle) * x + math.sin(angle) * cross(axis, x)


def checked(wheels: Sequence[Wheel]) -> None:
    """Refuse a row of wheels that is no path.

    Raises
    ------
    ReevingError
    """
    if len(wheels) < 2:
        raise ReevingError("a path needs two items at least", "give both ends of the rope")
    for j, wheel in enumerate(wheels):
        if not (np.isfinite(wheel.center).all() and math.isfinite(wheel.radius) and wheel.radius >= 0.0):
            message = f"{wheel.name!r} needs a finite centre and a radius that is not negative"
            raise ReevingError(message, "correct them", j)
        if wheel.point and 0 < j < len(wheels) - 1:
            message = f"{wheel.name!r} is an end of the rope and stands between other items"
            raise ReevingError(message, "make it a sheave, or the first or last item", j)
        if wheel.point and wheel.radius > 0.0:
            raise ReevingError(f"{wheel.name!r} is a point and has a radius", "set it to 0", j)
        if wheel.radius > 0.0 and not abs(float(np.linalg.norm(wheel.axis)) - 1.0) < 1e-9:
            raise ReevingError(f"the axis of {wheel.name!r} is not a unit vector", "divide it by its length", j)


def span_between(wheels: Sequence[Wheel], k: int, s: int, t: int) -> Span:
    """Span after wheel k, which the rope turns about as s says and about the next as t says; see `tangent`."""
    one, two = wheels[k], wheels[k + 1]
    return tangent(
        one.center, one.axis, s * one.radius, two.center, two.axis, t * two.radius, (one.name, two.name), k
    )  # fmt: skip
