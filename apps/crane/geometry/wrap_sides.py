"""Which way round each wheel a rope runs, from the side of its centre that it passes on.

A side alone does not say it: a rope that bends down on both sides of a sheave lies on top of it whichever way it runs,
only that one way it has to loop round. So the shortest of all ways that pass every wheel on the side asked for is
taken, as a taut rope does. Left and right need no such search: the travel itself tells them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crane.geometry.crooked_axes import crooked_axis
from crane.geometry.tangents import ReevingError, Span, Wheel, beside, checked, cross, span_between, turned, wrap_angle

LEVEL = 1e-6
"""Sine of the angle above the centre below which a rope passes neither over nor under."""
TILT = 1e-3
"""Sine of the angle between axis and vertical from which over and under have a meaning, and between axis and level
from which left and right have."""
EQUAL, ROUNDING = 1e-7, 1e-12
"""Difference of two ways, over the largest radius or over their length, below which neither is the shorter."""
OPPOSITE = {"over": "under", "under": "over", "left": "right", "right": "left"}

Signs = tuple[int, ...]
Way = tuple[float, Signs]


class Spans(NamedTuple):
    """Every span there can be: by the number of its first wheel, by both signs; and why others cannot."""

    found: list[dict[tuple[int, int], Span]]
    missing: list[dict[tuple[int, int], ReevingError]]


class Contact(NamedTuple):
    """Direction from the centre to the middle of the wrap, and the wrap's angle.

    At an end of the path 0, and the direction of where the rope leaves.
    """

    direction: np.ndarray
    angle: float


def sigma_of(wheels: Sequence[Wheel], up: Sequence[float] | np.ndarray = (0.0, 0.0, 1.0)) -> np.ndarray:
    """Sense in which a rope turns about each wheel's axis.

    Parameters
    ----------
    wheels : sequence of Wheel
        In the order of the rope, n >= 2. Over and under are sides of the centre that the middle of the wrap lies on;
        at a drum the higher and the lower of the two places at which the rope may leave. Left and right are the side
        of its travel, seen from above, on which the rope passes the centre.
    up : array (3,)
        Direction that over and above mean.

    Returns
    -------
    int array (n,)
        +1 right-handed, -1 left-handed; +1 at a point.

    Raises
    ------
    ReevingError
        Where an axis points along the rope, or a side has no meaning for its axis; where a taut rope cannot pass on
        the side asked for, or where it can in both senses by paths of equal length.
    """
    checked(wheels)
    vertical = np.array(up, dtype=float)
    vertical = vertical / np.linalg.norm(vertical)
    try:
        return _sigma_of(wheels, vertical)
    except ReevingError as error:
        raise crooked_axis(wheels, vertical, lambda others: _sigma_of(others, vertical)) or error from None


def _sigma_of(wheels: Sequence[Wheel], vertical: np.ndarray) -> np.ndarray:
    """Senses in which a rope turns about each wheel's axis, as `sigma_of` has them."""
    asked = [_asked(wheel, j, vertical) for j, wheel in enumerate(wheels)]
    spans = _spans(wheels, asked)
    (length, signs), *others = _ways(wheels, spans, asked, vertical)
    largest = max(wheel.radius for wheel in wheels)
    if others and others[0][0] - length <= max(EQUAL * largest, ROUNDING * length):
        j = next(j for j, (s, t) in enumerate(zip(signs, others[0][1], strict=True)) if s != t)
        message = f"the rope can pass {wheels[j].wrap} {wheels[j].name!r} in either sense, by paths of equal length"
        raise ReevingError(message, "move one of its neighbours, so that one path is shorter", j)
    sigma = np.array(signs, dtype=int)
    for j in range(1, len(wheels) - 1):
        if wheels[j].radius == 0.0:
            before, after = spans.found[j - 1][signs[j - 1], 1].e, spans.found[j][1, signs[j + 1]].e
            sigma[j] = 1 if np.dot(wheels[j].axis, cross(before, after)) >= 0.0 else -1
    return sigma


def _asked(wheel: Wheel, j: int, up: np.ndarray) -> Signs:
    """Signs that a wheel's side leaves open."""
    if wheel.radius == 0.0:
        return (1,)
    rise = float(np.dot(wheel.axis, up))
    if wheel.wrap in ("left", "right"):
        if abs(rise) < TILT:
            message = f"the rope passes {wheel.wrap} of {wheel.name!r}, whose axis is level"
            raise ReevingError(message, "write over or under, or set its axis upright", j)
        # Seen against the axis the rope that has its centre on the left turns left.
        sign = 1 if wheel.wrap == "right" else -1
        return (sign if rise > 0.0 else -sign,)
    if wheel.wrap not in ("over", "under"):
        side = "no side" if wheel.wrap is None else f"the side {wheel.wrap!r}"
        raise ReevingError(f"{wheel.name!r} has {side}", "write over, under, left or right", j)
    if math.sqrt(max(0.0, 1.0 - rise**2)) < TILT:
        message = f"the rope passes {wheel.wrap} {wheel.name!r}, whose axis is upright"
        raise ReevingError(message, "write left or right, of the rope's travel, or lay its axis level", j)
    return (1, -1)


def _spans(wheels: Sequence[Wheel], asked: Sequence[Signs]) -> Spans:
    """Spans of all signs, also those not asked for: a rope must not have a shorter way among them."""
    spans = Spans([], [])
    for k in range(len(wheels) - 1):
        found: dict[tuple[int, int], Span] = {}
        missing: dict[tuple[int, int], ReevingError] = {}
        for s in (1, -1) if wheels[k].radius > 0.0 else (1,):
            for t in (1, -1) if wheels[k + 1].radius > 0.0 else (1,):
                try:
                    found[s, t] = span_between(wheels, k, s, t)
                except ReevingError as error:
                    if s in asked[k] and t in asked[k + 1]:
                        missing[s, t] = error
        if not any(s in asked[k] and t in asked[k + 1] for s, t in found):
            # One that does not cross asks least: it tells by how much the wheels are too close.
            raise missing.get((1, 1)) or next(iter(missing.values()))
        spans.found.append(found)
        spans.missing.append(missing)
    return spans


def _ways(wheels: Sequence[Wheel], spans: Spans, asked: Sequence[Signs], up: np.ndarray) -> list[Way]:
    """The shortest way and the next, each with its length, m.

    They are found from wheel to wheel: how a rope goes on depends only on the signs of the last two.
    """
    n = len(wheels)
    ways: dict[tuple[int, int], list[Way]] = {}
    for s, t in spans.found[0]:
        if s in asked[0] and t in asked[1] and _fits(wheels, (0, s, t), spans, 0, up):
            ways[s, t] = [(_length(wheels, (s, t), spans, 0, True, n == 2), (s, t))]
    if not ways:
        raise _refused(wheels, spans, 0, up)
    for j in range(1, n):
        longer: dict[tuple[int, int], list[Way]] = {}
        for (s, t), known in ways.items():
            for u in asked[j + 1] if j < n - 1 else (0,):
                contact = _contact(wheels[j], (s, t, u), spans, j)
                if contact is None or not _fits(wheels, (s, t, u), spans, j, up):
                    continue
                more = wheels[j].radius * contact.angle
                more += _length(wheels, (t, u), spans, j, False, j == n - 2) if u else 0.0
                longer.setdefault((t, u), []).extend((length + more, (*way, u)) for length, way in known)
        if not longer:
            raise _refused(wheels, spans, j, up)
        ways = {pair: sorted(known)[:2] for pair, known in longer.items()}
    found = sorted(way for known in ways.values() for way in known)[:2]
    return [(length, way[:n]) for length, way in found]


def _length(wheels: Sequence[Wheel], signs: tuple[int, int], spans: Spans, k: int, first: bool, second: bool) -> float:
    """Length of a span, m, with what more of the rope lies on the `first` or `second` wheel than if led to centres."""
    one, two = wheels[k], wheels[k + 1]
    span, d = spans.found[k][signs], two.center - one.center
    length = span.length
    for counts, wheel, sign, way in ((first, one, signs[0], 1.0), (second, two, signs[1], -1.0)):
        if counts and wheel.radius > 0.0:
            before, after = beside(d, wheel.axis), beside(span.e, wheel.axis)
            angle = math.atan2(float(np.dot(wheel.axis, cross(before, after))), float(np.dot(before, after)))
            length += way * sign * wheel.radius * angle
    return length


def _contact(wheel: Wheel, signs: tuple[int, int, int], spans: Spans, j: int) -> Contact | None:
    """How a rope lies on wheel j, from the signs before, of and after it, 0 where the path ends.

    None where there is no such rope.
    """
    before, sign, after = signs
    around = [spans.found[j - 1].get((before, sign))] if before else []
    around += [spans.found[j].get((sign, after))] if after else []
    known = [span for span in around if span is not None]
    if len(known) < len(around):
        return None
    sides = [sign * beside(span.e, wheel.axis) for span in known]
    if len(sides) == 1 or wheel.radius == 0.0:
        return Contact(sides[0], 0.0)
    angle = wrap_angle(sides[0], sides[1], sign * wheel.axis)
    return Contact(turned(sides[0], sign * wheel.axis, 0.5 * angle), angle)


def _height(contact: Contact, wheel: Wheel, up: np.ndarray) -> float:
    """Sine of the angle of a contact above the centre, in the wheel's plane."""
    above = up - wheel.axis * np.dot(wheel.axis, up)
    return float(np.dot(contact.direction, above) / np.linalg.norm(above))


def _fits(wheels: Sequence[Wheel], signs: tuple[int, int, int], spans: Spans, j: int, up: np.ndarray) -> bool:
    """Whether a rope of these signs passes wheel j on the side asked for, and would stay there when pulled taut."""
    wheel, (before, sign, after) = wheels[j], signs
    if wheel.radius == 0.0:
        return True
    flipped = (before, -sign, after)
    here, other = _contact(wheel, signs, spans, j), _contact(wheel, flipped, spans, j)
    if here is None:
        return False
    level = wheel.wrap in ("over", "under")
    wanted = 1.0 if wheel.wrap == "over" else -1.0
    if not before or not after:
        below = _height(other, wheel, up) if level and other is not None else 0.0
        return not level or wanted * (_height(here, wheel, up) - below) > LEVEL
    # A line that runs clear of the sheave bends one way only: in the other sense it lies there after a loop.
    clear = other is not None and float(np.dot(here.direction, other.direction)) > 0.0
    if clear and other is not None:
        ways = [
            _length(wheels, (s, t), spans, j - 1, True, False)
            + wheel.radius * contact.angle
            + _length(wheels, (t, u), spans, j, False, True)
            for (s, t, u), contact in ((signs, here), (flipped, other))
        ]
        if ways[0] > ways[1] + EQUAL * wheel.radius:
            return False
    height = _height(here, wheel, up) if level else 0.0
    # A bend to one side, level with the centre, leaves no choice, whatever the side is called.
    return not level or (clear if abs(height) <= LEVEL else wanted * height > 0.0)


def _refused(wheels: Sequence[Wheel], spans: Spans, j: int, up: np.ndarray) -> ReevingError:
    """Why no rope passes wheel j on the side asked for."""
    wheel, n = wheels[j], len(wheels)
    for k in (j - 1, j):
        if 0 <= k < n - 1 and spans.missing[k]:
            return next(iter(spans.missing[k].values()))
    if j in (0, n - 1):
        message = f"the rope leaves {wheel.name!r} at one height in both senses, neither over nor under"
        return ReevingError(message, "move what it runs to off the plumb line through the drum's axis", j)
    if wheel.wrap in ("over", "under"):
        pairs = [(s, t, u) for s, t in spans.found[j - 1] for t_too, u in spans.found[j] if t_too == t]
        contacts = [_contact(wheel, signs, spans, j) for signs in pairs]
        if any(contact is not None and abs(_height(contact, wheel, up)) <= LEVEL for contact in contacts):
            message = f"the rope passes {wheel.name!r} level with its centre, neither over nor under it"
            return ReevingError(message, "move the sheave, or its neighbours", j)
    preposition = {"left": "left of", "right": "right of"}.get(str(wheel.wrap), str(wheel.wrap))
    message = f"the rope cannot pass {preposition} {wheel.name!r}: pulled taut it lies on the other side"
    cure = f"write {OPPOSITE[str(wheel.wrap)]}, or move the sheave so that the rope bends {preposition} it"
    return ReevingError(message, cure, j)
