"""The sections a planned well is written in, each cut into pieces of constant curvature, and the angles they need.

Directions are unit vectors in north, east, down; inclination is measured from the downward vertical and azimuth
clockwise from north, both in radians.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tautline.errors import TautlineError

NORTH, EAST, DOWN = np.eye(3)

VERTICAL = 1e-9
"""Angle from the vertical [rad] below which a direction has no azimuth; the rounding of a sine is 1e-16."""

SAME_ANGLE = 1e-7
"""Two angles [rad] that differ by less are one angle written twice: 0.000006 degrees, far below any survey tool."""

TURN_STEP = math.radians(0.25)
"""Largest change of azimuth [rad] in one arc of a turn; its dogleg is smaller still."""


class WellboreError(TautlineError, ValueError):
    """A well that cannot be drilled as written.

    Parameters
    ----------
    message : str
        What is wrong.
    cure : str
        What to write instead.
    index : int, optional
        Number, from zero, of the section or of the station at fault.
    """

    def __init__(self, message: str, cure: str, index: int | None = None):
        super().__init__(f"{message}; {cure}")
        self.message, self.cure, self.index = message, cure, index


@dataclass(frozen=True)
class Hold:
    """Straight hole of the given length [m]."""

    length: float


@dataclass(frozen=True)
class Build:
    """Circular arc in the vertical plane, up or down, to the inclination `to` [rad].

    `radius` [m] is the arc's. From the vertical, `azimuth` [rad] picks the direction (the present one if None); from
    an inclined hole it must be None or the present azimuth.
    """

    radius: float
    to: float
    azimuth: float | None = None


@dataclass(frozen=True)
class Turn:
    """Change of azimuth to `to` [rad], the short way round, at constant inclination.

    `radius` [m] is one over the total curvature of the hole, not the radius of its plan view.
    """

    radius: float
    to: float


Section = Hold | Build | Turn


Vector = Sequence[float]
"""North, east and down as plain numbers: a well may have a hundred thousand arcs, and each is three numbers."""

Piece = tuple[float, Vector, Vector]
"""One arc before it has a frame: length [m], curvature vector t' at its start [1/m], unit tangent at its end."""


def direction(inclination, azimuth) -> np.ndarray:
    """Unit vector (north, east, down), shape (..., 3), of an inclination and an azimuth [rad]."""
    inclination, azimuth = np.broadcast_arrays(inclination, azimuth)
    level = np.sin(inclination)
    return np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.cos(inclination)], axis=-1)


def direction_angles(tangent) -> tuple[np.ndarray, np.ndarray]:
    """Inclination (0 to pi) and azimuth (0 to 2 pi, 0 if vertical) [rad] of unit vectors of shape (..., 3)."""
    tangent = np.asarray(tangent, dtype=float)
    level = np.hypot(tangent[..., 0], tangent[..., 1])
    azimuth = np.mod(np.arctan2(tangent[..., 1], tangent[..., 0]), 2.0 * np.pi)
    azimuth = np.where(azimuth >= 2.0 * np.pi, 0.0, azimuth)  # a tiny negative angle rounds up to the whole circle
    return np.arctan2(level, tangent[..., 2]), np.where(level < VERTICAL, 0.0, azimuth)


def plain_direction(inclination: float, azimuth: float) -> Vector:
    """The same of one direction, in plain numbers."""
    level = math.sin(inclination)
    return level * math.cos(azimuth), level * math.sin(azimuth), math.cos(inclination)


def dogleg(upper, lower) -> np.ndarray:
    """Angle [rad] between unit vectors of shape (..., 3), exact for small angles and near pi (W. Kahan's form)."""
    upper, lower = np.asarray(upper, dtype=float), np.asarray(lower, dtype=float)
    return 2.0 * np.arctan2(np.linalg.norm(lower - upper, axis=-1), np.linalg.norm(lower + upper, axis=-1))


def rise(inclination: float, azimuth: float) -> np.ndarray:
    """Unit vector in which the tangent moves as the inclination grows."""
    heading = math.cos(azimuth) * NORTH + math.sin(azimuth) * EAST
    return math.cos(inclination) * heading - math.sin(inclination) * DOWN


def drill(section: Section, index: int, inclination: float, azimuth: float) -> tuple[list[Piece], tuple[float, float]]:
    """Pieces of one section and the (inclination, azimuth) at its end.

    Raises
    ------
    WellboreError
        For a section that cannot be drilled as written, with its number.
    """
    if isinstance(section, Hold):
        check_finite(section.length, "hold", index)
        if section.length < 0.0:
            raise WellboreError(f"hold = {section.length:g} m is negative", "give a length of zero or more", index)
        piece = (section.length, (0.0, 0.0, 0.0), plain_direction(inclination, azimuth))
        return ([piece] if section.length > 0.0 else []), (inclination, azimuth)
    _check_radius(section.radius, index)
    if isinstance(section, Build):
        return _drill_build(section, index, inclination, azimuth)
    return _drill_turn(section, index, inclination, azimuth)


def _drill_build(build: Build, index: int, inclination: float, azimuth: float):
    """One arc in the vertical plane."""
    check_inclination(build.to, "to", index)
    if build.azimuth is not None:
        check_finite(build.azimuth, "azimuth", index)
        off = abs(_short_way(azimuth, build.azimuth))
        if math.sin(inclination) < VERTICAL:
            azimuth = build.azimuth
        elif off > SAME_ANGLE:
            raise WellboreError(
                f"the build's azimuth {_degrees(build.azimuth)} is not that of the hole, {_degrees(azimuth)}",
                "leave the azimuth out here and use turn to change it",
                index,
            )
    change = build.to - inclination
    end = (build.to, azimuth)
    if abs(change) <= SAME_ANGLE:
        return [], (inclination, azimuth)
    bend = math.copysign(1.0 / build.radius, change) * rise(inclination, azimuth)
    return [(abs(change) * build.radius, bend.tolist(), plain_direction(*end))], end


def _drill_turn(turn: Turn, index: int, inclination: float, azimuth: float):
    """A curve of constant inclination and total curvature 1/R, cut into arcs by minimum curvature.

    Its tangent runs along a parallel of the unit sphere at 1/R per metre, so its length is R sin(I) times the change
    of azimuth. The arcs share that length and the tangents at their ends; curvature and end point converge with the
    square of the step.
    """
    check_finite(turn.to, "to", index)
    change = _short_way(azimuth, turn.to)
    if math.sin(inclination) < VERTICAL:
        raise WellboreError("a vertical hole has no azimuth to turn", "build an inclination before the turn", index)
    if abs(change) <= SAME_ANGLE:
        return [], (inclination, azimuth)
    if math.pi - abs(change) <= SAME_ANGLE:
        raise WellboreError(
            f"a turn from {_degrees(azimuth)} to {_degrees(turn.to)} is as long in both directions",
            "write it as two turns, the first one on the side that is meant",
            index,
        )
    count = math.ceil(abs(change) / TURN_STEP)
    length = turn.radius * math.sin(inclination) * abs(change) / count
    # Many turns round, an azimuth is rounded to more than the steps between the arcs.
    azimuth = _short_way(0.0, azimuth)
    pieces, upper = [], plain_direction(inclination, azimuth)
    for i in range(1, count + 1):
        lower = plain_direction(inclination, azimuth + change * (1.0 if i == count else i * (1.0 / count)))
        pieces.append((length, _bend(upper, lower, length), lower))
        upper = lower
    return pieces, (inclination, azimuth + change)


def _bend(upper: Vector, lower: Vector, length: float) -> Vector:
    """Curvature vector [1/m] at the start of an arc of a length [m] from one direction to another."""
    (u0, u1, u2), (l0, l1, l2) = upper, lower
    along = l0 * u0 + l1 * u1 + l2 * u2
    n0, n1, n2 = l0 - along * u0, l1 - along * u1, l2 - along * u2
    angle = 2.0 * math.atan2(_length(l0 - u0, l1 - u1, l2 - u2), _length(l0 + u0, l1 + u1, l2 + u2))
    size = angle / (length * _length(n0, n1, n2))
    return n0 * size, n1 * size, n2 * size


def _length(x: float, y: float, z: float) -> float:
    return math.sqrt(x * x + y * y + z * z)


def _short_way(start: float, end: float) -> float:
    """Signed change of azimuth [rad], in -pi to pi."""
    return math.remainder(end - start, 2.0 * math.pi)


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.6g} deg"


def check_finite(value: float, name: str, index: int | None) -> None:
    """Raise WellboreError unless the value is a finite number."""
    if not math.isfinite(value):
        raise WellboreError(f"{name} = {value} is not a finite number", "give a number", index)


def _check_radius(radius: float, index: int) -> None:
    check_finite(radius, "radius", index)
    if radius <= 0.0:
        raise WellboreError(f"radius = {radius:g} m is not above zero", "give a positive radius", index)


def check_inclination(value: float, name: str, index: int | None) -> None:
    """Raise WellboreError unless the value [rad] lies in 0 to pi."""
    check_finite(value, name, index)
    if not 0.0 <= value <= math.pi:
        raise WellboreError(
            f"{name} = {_degrees(value)} is no inclination",
            "give an angle from the downward vertical, 0 to 180 deg",
            index,
        )


def dogleg_severity(curvature: float, system: str) -> str:
    """A curvature, rad/m, as the field states it: in deg/30 m, or deg/100 ft in field units."""
    length, name = (30.48, "100 ft") if system == "field" else (30.0, "30 m")
    return f"{math.degrees(curvature) * length:.3g} deg/{name}"
