"""Where rope ran on and off a sheave: the stretches that an end of an arc passed, and how often each place was passed.

All are exact for ends that move straight between frames. A count against the material coordinate p is a staircase.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

SLIVER = 1.0e-6
"""Share of a bin that is too narrow to stand for it: the gap that rounding leaves between equal positions."""
Stretch = tuple[float, float]


class Arc(NamedTuple):
    """Rope on a contact: (m,) each, low <= high."""

    low: np.ndarray
    high: np.ndarray
    tension: np.ndarray
    bends: np.ndarray
    """(m - 1,), whether rope lies on the contact in each step; as it was before ripple was taken out."""


class Staircase(NamedTuple):
    """A function of p, constant between breaks and 0 outside."""

    breaks: np.ndarray
    heights: np.ndarray
    """Of the stretch that begins at each break."""

    def at(self, p: np.ndarray) -> np.ndarray:
        """Values at places that are no breaks."""
        k = np.searchsorted(self.breaks, p) - 1
        return np.where(k >= 0, self.heights[np.maximum(k, 0)], 0.0) if self.breaks.size else np.zeros(len(p))


def _turns(value: np.ndarray, least: float) -> list[int]:
    """Indices of the extremes between which a history moves by at least so much; none, or at least two."""
    history = value.tolist()
    turns: list[int] = []
    low = high = 0
    rising: bool | None = None
    for k, here in enumerate(history):
        low, high = k if here < history[low] else low, k if here > history[high] else high
        if rising is not True and here - history[low] >= least:
            turns.append(low)
            rising, high = True, k
        elif rising is not False and history[high] - here >= least:
            turns.append(high)
            rising, low = False, k
    return [*turns, high if rising else low] if turns else []


def without_ripple(value: np.ndarray, least: float) -> np.ndarray:
    """A history, (m,), without its turns to and fro of less than so much; extremes that stay keep their values."""
    if least <= 0.0 or not np.isfinite(value).all():
        return value
    turns = _turns(value, least)
    smooth = np.full(value.shape, value[turns[0] if turns else 0])
    for a, b in pairwise(turns):
        further = np.maximum if value[b] > value[a] else np.minimum
        smooth[a : b + 1] = further.accumulate(value[a : b + 1])
        smooth[b:] = value[b]
    return smooth


def passages(arc: Arc) -> list[Stretch]:
    """Stretches that an end of the arc passes, a step each, while rope lies on the contact."""
    passed: list[Stretch] = []
    for end in (arc.low, arc.high):
        if np.isfinite(end).all():
            moves = arc.bends & (end[:-1] != end[1:])
            low, high = np.minimum(end[:-1], end[1:])[moves], np.maximum(end[:-1], end[1:])[moves]
            passed += zip(low.tolist(), high.tolist(), strict=True)
    return passed


def staircase(stretches: Sequence[Stretch]) -> Staircase:
    """How many of the stretches hold p, as a function of p."""
    breaks, where = np.unique(np.array(stretches, float).reshape(-1, 2), return_inverse=True)
    begins, ends = (np.bincount(side, minlength=breaks.size) for side in where.reshape(-1, 2).T)
    steps = (begins - ends).astype(float)
    # Where one step of a steady motion ends and the next begins there is no stair.
    stair = steps != 0.0
    return Staircase(breaks[stair], np.cumsum(steps)[stair])


def most_worked_places(stairs: Sequence[Staircase], edges: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place in each bin where the sum of staircases is highest, its height there, and its mean; (n,) each."""
    count, width = len(edges) - 1, np.diff(edges)
    breaks = np.concatenate([edges, *(stair.breaks for stair in stairs)])
    breaks = np.unique(breaks[(breaks >= edges[0]) & (breaks <= edges[-1])])
    middle, length = 0.5 * (breaks[:-1] + breaks[1:]), np.diff(breaks)
    total = np.sum([stair.at(middle) for stair in stairs], axis=0) if stairs else np.zeros(middle.size)
    within = np.minimum(np.searchsorted(edges, breaks[:-1], side="right") - 1, count - 1)
    wide = length > SLIVER * width[within]
    # Last of each bin in this order: the highest of the wide pieces, of equals the widest.
    order = np.lexsort((length, total, wide, within))
    last = order[np.searchsorted(within[order], np.arange(count), side="right") - 1]
    mean = np.bincount(within, weights=total * length, minlength=count) / width
    return middle[last], total[last], mean


def reversals(before: Arc, after: Arc, reach: float) -> list[Stretch]:
    """Stretches that leave one of two neighbours and come to the other, on at most so much rope between them."""
    one, other = before.high, np.maximum(before.high, after.low)
    gap = other - one
    if gap.size == 0 or gap.min() >= reach:
        return []
    sides = _Sides(float(one[0]), float(other[0]))
    begin, end = while_below(gap[:-1], gap[1:], reach)
    found: list[Stretch] = []
    ends = ((one, -1, before.bends), (other, 1, after.bends))
    # Rope comes to the first where its end rises and to the other where its end falls, in one step never the same.
    for k, (line, side, bends) in ((k, item) for k in range(len(gap) - 1) for item in ends):
        start, stop = float(line[k]), float(line[k + 1])
        move = stop - start
        if side * move < 0.0:
            came = sides.turn(min(start, stop), max(start, stop), side if bends[k] else 0)
            if begin[k] < end[k]:
                low, high = sorted((start + move * float(begin[k]), start + move * float(end[k])))
                found += [(max(a, low), min(b, high)) for a, b in came if max(a, low) < min(b, high)]
    return found


class _Sides:
    """Which of two neighbours bent each stretch of rope last: -1 the one before, 1 the one after, 0 not known."""

    def __init__(self, low: float, high: float) -> None:
        self._cuts = [low, high]
        self._side = [-1, 0, 1]

    def turn(self, low: float, high: float, side: int) -> list[Stretch]:
        """Let a stretch come to a side, and say which parts of it came from the other."""
        first, last = bisect_left(self._cuts, low), bisect_right(self._cuts, high)
        cuts = [low, *(min(max(cut, low), high) for cut in self._cuts[first:last]), high]
        sides = self._side[first : last + 1]
        came = [(a, b) for a, b, old in zip(cuts[:-1], cuts[1:], sides, strict=True) if side and old == -side and a < b]
        # A cut stays only where the sides on its two hands differ.
        ends = [(low, sides[0]), (high, sides[-1])]
        self._cuts[first:last] = [cut for cut, neighbour in ends if neighbour != side]
        self._side[first : last + 1] = [
            *([sides[0]] if sides[0] != side else []), side, *([sides[-1]] if sides[-1] != side else [])
        ]  # fmt: skip
        return came


def while_below(begin: np.ndarray, end: np.ndarray, limit: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shares of a step from and to which a straight line is at or below a limit; from > to for never."""
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = (limit - begin) / (end - begin)
    from_here = np.where(begin <= limit, 0.0, np.where(end <= limit, crossing, 1.0))
    to_there = np.where(end <= limit, 1.0, np.where(begin <= limit, crossing, 0.0))
    return from_here, to_there
