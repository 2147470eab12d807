"""Derivatives by differences: of fourth order, within what may be given, and with a look for kinks.

Where a law is clamped a central difference across the clamp is half of the slope beside it. So a step stays within the
bounds of what may be given, by one-sided differences at these. Within them a kink shows as two slopes, by one step and
by two, that differ, and right at it as slopes of both sides that do. Right at a jump one of these grows as the step
shrinks: the other side goes on from what is now, and counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

FINER, FINEST = 0.1, 1.0e-5
"""By how much a step is made smaller where it meets a kink, and share of the first one that it stays above."""
KINK = 1.0e-4
"""Share of a derivative by which those of one and of two steps differ if a kink lies between, such as where a beam that
lies on its wall by less than the step leaves it."""
ROUNDED = 1.0e-12
"""Share of what is differenced that may be rounding."""
SIDES = 1.0e-2
"""Share of the larger slope by which those of both sides differ at a kink."""
STAYS = 0.1
"""Share of their difference by which it changes with a finer step, where it is a kink and no rounding."""
ALIKE = 0.99
"""Ratio of the smaller slope to the larger one from which both are as large: neither is that of a limit."""
Sample = Callable[[float], Mapping[str, np.ndarray]]
"""Values by their names, a step away."""


class Room(NamedTuple):
    """How far a step may go down and up: nowhere where both are nothing."""

    below: float = math.inf
    above: float = math.inf

    def along(self, rate: float) -> Room:
        """That of something by which this moves at a rate."""
        if rate == 0.0:
            return FREE
        below, above = self if rate > 0.0 else (self.above, self.below)
        return Room(below / abs(rate), above / abs(rate))

    def both(self, other: Room) -> Room:
        """What is left where another has to be kept to as well."""
        return Room(min(self.below, other.below), min(self.above, other.above))


FREE = Room()
AHEAD = Room(below=0.0)
"""Of what leaves the place where it is, with another law behind it."""


class Slope(NamedTuple):
    """A derivative, those of both sides, and whether these differ as at a limit: it is the smaller of them there."""

    value: np.ndarray
    below: np.ndarray
    above: np.ndarray
    limited: bool


class _Stencil(NamedTuple):
    """Points, in steps; weights of the best derivative, of those of second order by one step and by two, and of those
    from below and above."""

    points: tuple[float, ...]
    best: tuple[float, ...]
    one: tuple[float, ...]
    two: tuple[float, ...]
    below: tuple[float, ...]
    above: tuple[float, ...]


_UP = (-25 / 12, 4.0, -3.0, 4 / 3, -1 / 4)
"""Weights at 0 to 4 steps, of fourth order."""
CENTRAL = _Stencil(
    (-2.0, -1.0, 0.0, 1.0, 2.0), (1 / 12, -2 / 3, 0.0, 2 / 3, -1 / 12), (0.0, -0.5, 0.0, 0.5, 0.0),
    (-0.25, 0.0, 0.0, 0.0, 0.25), (0.5, -2.0, 1.5, 0.0, 0.0), (0.0, 0.0, -1.5, 2.0, -0.5),
)  # fmt: skip
UPWARDS = _Stencil((0.0, 1.0, 2.0, 3.0, 4.0), _UP, (-1.5, 2.0, -0.5, 0.0, 0.0), (-0.75, 0.0, 1.0, 0.0, -0.25), _UP, _UP)
DOWNWARDS = _Stencil(tuple(-x for x in UPWARDS.points), *(tuple(-x for x in weights) for weights in UPWARDS[1:]))


class _Seen(NamedTuple):
    """Changes (points, ...) at the points of a stencil, with its step, and how large the values themselves are.

    Of what does not change at all the slope is then exactly nothing.
    """

    stencil: _Stencil
    step: float
    changes: np.ndarray
    size: float

    def by(self, weights: tuple[float, ...]) -> np.ndarray:
        # Each number in the same order, whatever stands beside it: a product of matrices rounds by their shapes.
        parts = [weight * change for weight, change in zip(weights, self.changes, strict=True)]
        return np.asarray(sum(parts) / self.step)

    @property
    def apart(self) -> float:
        """How far the slopes by one step and by two are apart."""
        return _largest(self.by(self.stencil.one) - self.by(self.stencil.two))

    def kinked(self, step: float) -> bool:
        """Whether that is more than the rounding of a step."""
        return self.apart > KINK * _largest(self.by(self.stencil.best)) + ROUNDED * self.size / step

    @property
    def below(self) -> np.ndarray:
        """The slope of the side below."""
        return self.by(self.stencil.below)

    @property
    def above(self) -> np.ndarray:
        """The slope of the side above."""
        return self.by(self.stencil.above)

    @property
    def jump(self) -> np.ndarray:
        """The slope above less that below."""
        return self.above - self.below

    @property
    def sides_differ(self) -> bool:
        most = max(_largest(self.above), _largest(self.below))
        return _largest(self.jump) > SIDES * most + ROUNDED * self.size / self.step


def slopes(
    sample: Sample, step: float, room: Room = FREE, here: Mapping[str, np.ndarray] | None = None
) -> dict[str, Slope]:
    """Derivatives of all that is sampled, each by a step that no kink lies in.

    A smaller step brings one and two steps together where a kink parted them, and further apart where rounding did,
    such as of the tension of a stiff rope in a direction that leaves it as it is. Where no step brings them together,
    that counts where they are nearest. Where slopes of both sides differ, the smaller one counts: what is at a limit
    stays there, as it does in the tangents. Right at a jump the side counts that has no part in it.

    Parameters
    ----------
    sample : callable
        A step -> arrays by their names.
    step : float
        The first one.
    room : Room
        How far steps may go; one way may be none. Where both are, nothing changes, and all derivatives are nothing.
    here : mapping, optional
        What is sampled at no step, where that is known.
    """
    at_hand = sample(0.0) if here is None else here
    if max(room) == 0.0:
        return {name: _still(value) for name, value in at_hand.items()}
    stencil, step = _within(step, room)
    least = FINEST * step
    found: dict[str, _Seen] = {}
    while True:
        for name, seen in _look(sample, at_hand, stencil, step).items():
            if name not in found or seen.apart < found[name].apart:
                found[name] = seen
        if step * FINER < least or not any(one.kinked(step) for one in found.values()):
            break
        step *= FINER
    finer = _finer(sample, at_hand, found)
    return {name: _slope(seen, finer.get(name)) for name, seen in found.items()}


def _still(value: np.ndarray) -> Slope:
    """The slope of what cannot change: it is at no limit that one side could leave."""
    none = np.zeros(np.shape(value))
    return Slope(none, none, none, False)


def _within(step: float, room: Room) -> tuple[_Stencil, float]:
    """The stencil and the step that stay within the room."""
    if min(room) >= 2.0 * step:
        return CENTRAL, step
    upwards = room.above >= room.below
    return (UPWARDS if upwards else DOWNWARDS), min(step, 0.25 * max(room))


def _look(sample: Sample, here: Mapping[str, np.ndarray], stencil: _Stencil, step: float) -> dict[str, _Seen]:
    """All that is sampled, at the points of a stencil."""
    frames = [here if point == 0.0 else sample(point * step) for point in stencil.points]
    found = {}
    for name, value in here.items():
        values = np.array([frame[name] for frame in frames], dtype=float)
        found[name] = _Seen(stencil, step, values - value, _largest(values))
    return found


def _finer(sample: Sample, here: Mapping[str, np.ndarray], found: Mapping[str, _Seen]) -> dict[str, _Seen]:
    """What is seen with a finer step of all whose slopes of both sides differ."""
    some = {name: seen for name, seen in found.items() if seen.sides_differ}
    finer: dict[str, _Seen] = {}
    for step in {seen.step for seen in some.values()}:
        looked = _look(sample, here, next(iter(found.values())).stencil, FINER * step)
        finer |= {name: looked[name] for name, seen in some.items() if seen.step == step}
    return finer


def _slope(seen: _Seen, finer: _Seen | None) -> Slope:
    """The slope that counts. Where a finer step shows jumps, that of the other side in each of their numbers; where it
    shows kinks, the smaller one, unless both are as large."""
    best, below, above = seen.by(seen.stencil.best), seen.below, seen.above
    if finer is None:
        return Slope(best, below, above, False)
    down = _jumps(seen, (below, finer.below), (above, finer.above))
    up = _jumps(seen, (above, finer.above), (below, finer.below))
    best, smooth = np.where(down, above, np.where(up, below, best)), ~(down | up)
    at_kink = _largest((finer.jump - seen.jump)[smooth]) <= STAYS * _largest(seen.jump[smooth])
    limited = smooth & _parted(seen, smooth) & at_kink
    limited &= np.minimum(np.abs(below), np.abs(above)) < ALIKE * np.maximum(np.abs(below), np.abs(above))
    lesser = np.where(np.abs(above) < np.abs(below), above, below)
    return Slope(np.where(limited, lesser, best), below, above, bool((limited | ~smooth).any()))


def _jumps(seen: _Seen, side: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Which numbers jump at once on a side: by as much with a finer step, while the slope of the other side stays.

    ``side`` and ``other`` are the slopes of the sides with the step and with a finer one.
    """
    slope, finer = side
    steep, grows = np.abs(slope) > np.abs(other[0]), np.abs(FINER * finer - slope) <= STAYS * np.abs(slope)
    return _parted(seen) & steep & grows & (np.abs(other[1] - other[0]) <= STAYS * np.abs(slope))


def _parted(seen: _Seen, among: Any = ...) -> np.ndarray:
    """Which numbers have slopes of both sides that differ, beside the largest slope among some of them."""
    return np.asarray(np.abs(seen.jump) > SIDES * max(_largest(seen.below[among]), _largest(seen.above[among])))


def _largest(values: np.ndarray) -> float:
    return float(np.abs(values).max(initial=0.0))
