"""Bending cycles of a rope, metre by metre: which stretch ran over which sheave, how often, under what tension.

A metre of rope that goes from straight to bent and back to straight has made one bending cycle; either change alone is
a half. On a sheave lies the rope between two material coordinates, where it runs on and where it runs off; a metre
changes whenever one of these passes it. So the count at p is half the number of times that either has passed p: a
staircase in p, found exactly from the positions at the frames, between which they are taken to move straight. What
turns back between two frames is not seen: store frames that follow the motion.

Only wrapped sheaves bend: while nothing of the rope lies on a sheave, rope that runs past it is not bent.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from crane.events import checked

RESOLUTION = 1.0
"""Travel of a contact's end, in rope diameters, below which a turn to and fro is ripple. The rope takes its curvature
over about such a length, not at a point; without this a load that trembles works some millimetres without end."""
REACH = 200.0
"""Rope between two sheaves, in diameters, within which bending the other way counts as reversed: our choice, as the
rules of lifts, cranes and ropeways differ."""
SLIVER = 1.0e-6
"""Share of a bin that is too narrow to stand for it: the gap that rounding leaves between equal positions."""
OVERLAP = 1.0e-6
"""Rope that two contacts may share, m, before they are refused."""
PAIRS = 1_000_000
"""Steps times bins that are worked on at once: bounds the memory."""


class Contact(NamedTuple):
    """A sheave or a drum, and the rope on it at m frames. Which end it runs on and which off does not matter."""

    name: str
    on: np.ndarray
    """(m,) m, material coordinate of one end of the arc; equal to the other where the rope has left the sheave."""
    off: np.ndarray
    """(m,) m, the other end; -inf or inf for all that is stored on a drum, see `drum_contact`."""
    tension: np.ndarray
    """(m,) N, >= 0; where the two sides differ, the larger."""
    radius: float
    """Pitch radius, m; of a drum's layers, the innermost."""
    side: float = 0.0
    """Way in which it bends the rope: positive and negative are opposite; 0 for neither, as with crossed axes. For
    sheaves with parallel axes the sign of sigma, times that of the axis' product with one axis for all."""


@dataclass(frozen=True, eq=False)
class BendingCycles:
    """Bending of a rope in n bins by c contacts.

    The counts of a bin are those of its most worked place, a multiple of one half; `mean` tells whether all of it is.

    Attributes
    ----------
    edges : (n + 1,) array
        Ends of the bins, material coordinates, m.
    contacts : tuple of str
        Names of the contacts.
    cycles : (n,) array
        Bending cycles over all contacts.
    by_contact : (n, c) array
        The same, shared out: `cycles` is its sum.
    worst : (n,) int array
        Contact that did most of them; -1 where there are none.
    mean : (n,) array
        Average of the count over the bin's length.
    reversals : (n,) array
        How often rope left a sheave and then came to a neighbour that bends it the other way, at the place of the bin
        where this happened most. These bendings are in `cycles` too.
    tension : (n,) array
        Largest tension while bent, N; 0 where never bent. Rope that stays deeper on a drum than its outer turn keeps
        the tension it was wound with, which the run does not know; it is left out.
    ratio : (n,) array or None
        Smallest D/d, twice the pitch radius over the rope's diameter, that the rope was bent to, in motion or not;
        inf where it stayed straight. None where the diameter is not known.
    """

    edges: np.ndarray
    contacts: tuple[str, ...]
    cycles: np.ndarray
    by_contact: np.ndarray
    worst: np.ndarray
    mean: np.ndarray
    reversals: np.ndarray
    tension: np.ndarray
    ratio: np.ndarray | None

    def most_worked(self) -> tuple[int, str] | None:
        """Bin with the most cycles and the contact that did most of them; None where nothing was bent."""
        busiest = int(np.argmax(self.cycles))
        return (busiest, self.contacts[self.worst[busiest]]) if self.cycles[busiest] > 0.0 else None


def drum_contact(
    name: str, lead: np.ndarray, tension: np.ndarray, radius: float, side: float = 0.0, stored: str = "before"
) -> Contact:
    """Make the contact of a drum, on which all rope beyond its lead point lies.

    Parameters
    ----------
    name : str
    lead : (m,) array
        Material coordinate where the rope leaves the drum, m.
    tension, radius, side
        As in `Contact`.
    stored : {"before", "after"}
        Whether the stored rope has the smaller coordinates (a drum at end A of the path) or the larger (at end B).
    """
    if stored not in ("before", "after"):
        raise ValueError(f"stored = {stored!r}: 'before' or 'after'")
    beyond = np.full(np.shape(lead), -np.inf if stored == "before" else np.inf)
    return Contact(name, beyond, np.asarray(lead, float), tension, radius, side)


def bending_cycles(
    time: np.ndarray,
    contacts: Sequence[Contact],
    edges: np.ndarray,
    diameter: float | None = None,
    resolution: float | None = None,
    reach: float | None = None,
) -> BendingCycles:
    """Bending cycles in every bin of a rope.

    Parameters
    ----------
    time : (m,) array
        s.
    contacts : sequence of Contact
        In the order of the path, that of rising material coordinate.
    edges : (n + 1,) array
        Ends of the bins, rising, m. Rope outside them is not looked at.
    diameter : float, optional
        Of the rope, m.
    resolution : float, optional
        Turns to and fro of less are ripple, m; by default `RESOLUTION` diameters, or 0 without a diameter.
    reach : float, optional
        Rope between two sheaves within which bending the other way is counted as reversed, m; by default `REACH`
        diameters, or 0, which counts none, without a diameter.

    Raises
    ------
    ValueError
        Where a history is not finite or of another length, edges do not rise, a radius or the diameter is not above
        0, or contacts overlap or are not in the order of the path.
    """
    time, edges = checked(time)[0], _edges(edges)
    for name, value in (("diameter", diameter), ("resolution", resolution), ("reach", reach)):
        if value is not None and not (value >= 0.0 and (value > 0.0 or name != "diameter")):
            raise ValueError(f"{name} = {value}: must be above 0" + (" or 0" if name != "diameter" else ""))
    resolution = RESOLUTION * (diameter or 0.0) if resolution is None else resolution
    reach = REACH * (diameter or 0.0) if reach is None else reach
    arcs = [_arc(time, contact) for contact in contacts]
    _in_order(time, contacts, arcs)
    smooth = [
        arc._replace(low=_without_ripple(arc.low, resolution), high=_without_ripple(arc.high, resolution))
        for arc in arcs
    ]
    smooth = [arc._replace(high=np.maximum(arc.low, arc.high)) for arc in smooth]
    stairs = [_staircase(_passages(arc)) for arc in smooth]
    place, total, mean = _most_worked_places(stairs, edges)
    by_contact = np.array([0.5 * stair.at(place) for stair in stairs]).reshape(len(contacts), len(place)).T
    turned = [
        stretch
        for k in range(len(contacts) - 1)
        if contacts[k].side * contacts[k + 1].side < 0.0
        for stretch in _reversals(smooth[k], smooth[k + 1], reach)
    ]
    tension, ratio = np.zeros(len(place)), np.full(len(place), np.inf)
    for contact, arc in zip(contacts, arcs, strict=True):
        _largest_tension(arc, contact.radius, edges, tension)
        bent = _bins_bent(arc, edges)
        ratio[bent] = np.minimum(ratio[bent], 2.0 * contact.radius / (diameter or math.inf))
    return BendingCycles(
        edges=edges,
        contacts=tuple(contact.name for contact in contacts),
        cycles=0.5 * total,
        by_contact=by_contact,
        worst=np.where(total > 0.0, by_contact.argmax(axis=1) if contacts else -1, -1),
        mean=0.5 * mean,
        reversals=_most_worked_places([_staircase(turned)], edges)[1],
        tension=tension,
        ratio=ratio if diameter else None,
    )


Stretch = tuple[float, float]


class _Arc(NamedTuple):
    """Rope on a contact: (m,) each, low <= high."""

    low: np.ndarray
    high: np.ndarray
    tension: np.ndarray
    bends: np.ndarray
    """(m - 1,), whether rope lies on the contact in each step; as it was before ripple was taken out."""


class _Staircase(NamedTuple):
    """A function of p, constant between breaks and 0 outside."""

    breaks: np.ndarray
    heights: np.ndarray
    """Of the stretch that begins at each break."""

    def at(self, p: np.ndarray) -> np.ndarray:
        """Values at places that are no breaks."""
        k = np.searchsorted(self.breaks, p) - 1
        return np.where(k >= 0, self.heights[np.maximum(k, 0)], 0.0) if self.breaks.size else np.zeros(len(p))


def _edges(edges: np.ndarray) -> np.ndarray:
    edges = np.asarray(edges, float)
    if edges.ndim != 1 or edges.size < 2 or not np.isfinite(edges).all() or (np.diff(edges) <= 0.0).any():
        raise ValueError("edges: at least two finite coordinates that rise are wanted")
    return edges


def _arc(time: np.ndarray, contact: Contact) -> _Arc:
    """Check a contact and put its ends in order."""
    if not (np.isfinite(contact.radius) and contact.radius > 0.0):
        raise ValueError(f"{contact.name}: radius = {contact.radius}: must be finite and above 0")
    ends = []
    for end in (contact.on, contact.off):
        end = np.asarray(end, float)
        stored = end.size > 0 and bool(np.isinf(end).all() and (end == end.flat[0]).all())
        # An end in the stored rope never moves; any number passes the check in its place.
        checked(time, **{f"{contact.name}, end of the arc": np.zeros(end.shape) if stored else end})
        ends.append(end)
    tension = checked(time, **{f"{contact.name}, tension": contact.tension})[1]
    if any(array.ndim != 1 for array in (*ends, tension)):
        raise ValueError(f"{contact.name}: ends of the arc and tension are histories, (m,)")
    wrapped = ends[0] != ends[1]
    return _Arc(np.minimum(*ends), np.maximum(*ends), tension, wrapped[:-1] | wrapped[1:])


def _in_order(time: np.ndarray, contacts: Sequence[Contact], arcs: Sequence[_Arc]) -> None:
    for k in range(len(arcs) - 1):
        beyond = arcs[k].high - arcs[k + 1].low
        if (beyond > OVERLAP).any():
            frame = int(np.argmax(beyond > OVERLAP))
            raise ValueError(
                f"{contacts[k].name}, {contacts[k + 1].name}: the rope on them overlaps by {beyond[frame]:g} m at "
                f"time {time[frame]:g} s; contacts go in the order of the path"
            )


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


def _without_ripple(value: np.ndarray, least: float) -> np.ndarray:
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


def _passages(arc: _Arc) -> list[Stretch]:
    """Stretches that an end of the arc passes, a step each, while rope lies on the contact."""
    passed: list[Stretch] = []
    for end in (arc.low, arc.high):
        if np.isfinite(end).all():
            moves = arc.bends & (end[:-1] != end[1:])
            low, high = np.minimum(end[:-1], end[1:])[moves], np.maximum(end[:-1], end[1:])[moves]
            passed += zip(low.tolist(), high.tolist(), strict=True)
    return passed


def _staircase(stretches: Sequence[Stretch]) -> _Staircase:
    """How many of the stretches hold p, as a function of p."""
    breaks, where = np.unique(np.array(stretches, float).reshape(-1, 2), return_inverse=True)
    begins, ends = (np.bincount(side, minlength=breaks.size) for side in where.reshape(-1, 2).T)
    steps = (begins - ends).astype(float)
    # Where one step of a steady motion ends and the next begins there is no stair.
    stair = steps != 0.0
    return _Staircase(breaks[stair], np.cumsum(steps)[stair])


def _most_worked_places(stairs: Sequence[_Staircase], edges: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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


def _reversals(before: _Arc, after: _Arc, reach: float) -> list[Stretch]:
    """Stretches that leave one of two neighbours and come to the other, on at most so much rope between them."""
    one, other = before.high, np.maximum(before.high, after.low)
    gap = other - one
    if gap.size == 0 or gap.min() >= reach:
        return []
    sides = _Sides(float(one[0]), float(other[0]))
    begin, end = _while_below(gap[:-1], gap[1:], reach)
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


def _while_below(begin: np.ndarray, end: np.ndarray, limit: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shares of a step from and to which a straight line is at or below a limit; from > to for never."""
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = (limit - begin) / (end - begin)
    from_here = np.where(begin <= limit, 0.0, np.where(end <= limit, crossing, 1.0))
    to_there = np.where(end <= limit, 1.0, np.where(begin <= limit, crossing, 0.0))
    return from_here, to_there


def _bins_bent(arc: _Arc, edges: np.ndarray) -> np.ndarray:
    """Whether any of a bin ever lay on the contact, (n,)."""
    low, high = _spans(arc)
    first, last = (np.bincount(ends, minlength=len(edges)) for ends in _touched(low, high, edges))
    return np.cumsum(first - last)[:-1] > 0


def _spans(arc: _Arc) -> tuple[np.ndarray, np.ndarray]:
    """All rope that lay on the contact in each step with any on it; a single frame is a step."""
    if arc.low.size == 1:
        return arc.low, arc.high
    low, high = np.minimum(arc.low[:-1], arc.low[1:]), np.maximum(arc.high[:-1], arc.high[1:])
    return low, np.where(arc.bends, high, low)


def _touched(low: np.ndarray, high: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First bin of each stretch, and the one after its last; equal for none."""
    first = np.clip(np.searchsorted(edges, low, side="right") - 1, 0, len(edges) - 1)
    last = np.clip(np.searchsorted(edges, high, side="left"), 0, len(edges) - 1)
    return first, np.where(high > low, np.maximum(first, last), first)


def _largest_tension(arc: _Arc, radius: float, edges: np.ndarray, tension: np.ndarray) -> None:
    """Raise each bin's largest tension, (n,), to that of the contact while any of the bin is on it."""
    # Only the outer turn on a drum feels the tension at the lead point.
    turn = 2.0 * math.pi * radius
    arc = arc._replace(
        low=np.where(np.isinf(arc.low), arc.high - turn, arc.low),
        high=np.where(np.isinf(arc.high), arc.low + turn, arc.high),
    )
    if arc.low.size == 1:
        low, high, held = (np.repeat(array, 2) for array in arc[:3])
        arc = _Arc(low, high, held, arc.high > arc.low)
    first, last = _touched(*_spans(arc), edges)
    for block in _blocks(last - first):
        number = (last - first)[block]
        step = np.repeat(np.arange(first.size)[block], number)
        bins = np.arange(step.size) - np.repeat(np.cumsum(number) - number, number) + first[step]
        # On the contact while its lower end is below the bin's upper one, and the other way round.
        on = _while_below(arc.low[step], arc.low[step + 1], edges[bins + 1])
        off = _while_below(-arc.high[step], -arc.high[step + 1], -edges[bins])
        begin, end = np.maximum(on[0], off[0]), np.minimum(on[1], off[1])
        rise = arc.tension[step + 1] - arc.tension[step]
        most = arc.tension[step] + np.maximum(rise * begin, rise * end)
        np.maximum.at(tension, bins[begin <= end], most[begin <= end])


def _blocks(number: np.ndarray) -> Iterator[slice]:
    """Runs of steps that together have about `PAIRS` bins."""
    cuts = np.flatnonzero(np.diff(np.cumsum(number) // PAIRS)) + 1
    for begin, end in zip([0, *cuts.tolist()], [*cuts.tolist(), number.size], strict=True):
        yield slice(begin, end)
