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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crane.rope_life.events import checked
from crane.rope_life.passages import (
    Arc,
    most_worked_places,
    passages,
    reversals,
    staircase,
    while_below,
    without_ripple,
)
from tautline.errors import ArgumentError

RESOLUTION = 1.0
"""Travel of a contact's end, in rope diameters, below which a turn to and fro is ripple. The rope takes its curvature
over about such a length, not at a point; without this a load that trembles works some millimetres without end."""
REACH = 200.0
"""Rope between two sheaves, in diameters, within which bending the other way counts as reversed: our choice, as the
rules of lifts, cranes and ropeways differ."""
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

    Raises
    ------
    ArgumentError
        For another `stored`.
    """
    if stored not in ("before", "after"):
        raise ArgumentError(f"stored = {stored!r}: 'before' or 'after'")
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
    ArgumentError
        Where a history is not finite or of another length, edges do not rise, a radius or the diameter is not above
        0, or contacts overlap or are not in the order of the path.
    """
    time, edges = checked(time)[0], _edges(edges)
    _check_lengths(diameter, resolution, reach)
    resolution = RESOLUTION * (diameter or 0.0) if resolution is None else resolution
    reach = REACH * (diameter or 0.0) if reach is None else reach
    arcs = [_arc(time, contact) for contact in contacts]
    _in_order(time, contacts, arcs)
    smooth = [_smooth(arc, resolution) for arc in arcs]
    stairs = [staircase(passages(arc)) for arc in smooth]
    place, total, mean = most_worked_places(stairs, edges)
    by_contact = np.array([0.5 * stair.at(place) for stair in stairs]).reshape(len(contacts), len(place)).T
    turned = [
        stretch
        for k in range(len(contacts) - 1)
        if contacts[k].side * contacts[k + 1].side < 0.0
        for stretch in reversals(smooth[k], smooth[k + 1], reach)
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
        reversals=most_worked_places([staircase(turned)], edges)[1],
        tension=tension,
        ratio=ratio if diameter else None,
    )


def _check_lengths(diameter: float | None, resolution: float | None, reach: float | None) -> None:
    if diameter is not None and not diameter > 0.0:
        raise ArgumentError(f"diameter = {diameter}: must be above 0")
    for name, value in (("resolution", resolution), ("reach", reach)):
        if value is not None and not value >= 0.0:
            raise ArgumentError(f"{name} = {value}: must be 0 or above")


def _smooth(arc: Arc, resolution: float) -> Arc:
    """An arc whose ends turn to and fro by `resolution`, m, at least; they do not pass each other."""
    low, high = without_ripple(arc.low, resolution), without_ripple(arc.high, resolution)
    return arc._replace(low=low, high=np.maximum(low, high))


def _edges(edges: np.ndarray) -> np.ndarray:
    edges = np.asarray(edges, float)
    if edges.ndim != 1 or edges.size < 2 or not np.isfinite(edges).all() or (np.diff(edges) <= 0.0).any():
        raise ArgumentError("edges: at least two finite coordinates that rise are wanted")
    return edges


def _arc(time: np.ndarray, contact: Contact) -> Arc:
    """Check a contact and put its ends in order."""
    if not (np.isfinite(contact.radius) and contact.radius > 0.0):
        raise ArgumentError(f"{contact.name}: radius = {contact.radius}: must be finite and above 0")
    ends = []
    for end in (contact.on, contact.off):
        end = np.asarray(end, float)
        stored = end.size > 0 and bool(np.isinf(end).all() and (end == end.flat[0]).all())
        # An end in the stored rope never moves; any number passes the check in its place.
        checked(time, **{f"{contact.name}, end of the arc": np.zeros(end.shape) if stored else end})
        ends.append(end)
    tension = checked(time, **{f"{contact.name}, tension": contact.tension})[1]
    if any(array.ndim != 1 for array in (*ends, tension)):
        raise ArgumentError(f"{contact.name}: ends of the arc and tension are histories, (m,)")
    wrapped = ends[0] != ends[1]
    return Arc(np.minimum(*ends), np.maximum(*ends), tension, wrapped[:-1] | wrapped[1:])


def _in_order(time: np.ndarray, contacts: Sequence[Contact], arcs: Sequence[Arc]) -> None:
    for k in range(len(arcs) - 1):
        beyond = arcs[k].high - arcs[k + 1].low
        if (beyond > OVERLAP).any():
            frame = int(np.argmax(beyond > OVERLAP))
            raise ArgumentError(
                f"{contacts[k].name}, {contacts[k + 1].name}: the rope on them overlaps by {beyond[frame]:g} m at "
                f"time {time[frame]:g} s; contacts go in the order of the path"
            )


def _bins_bent(arc: Arc, edges: np.ndarray) -> np.ndarray:
    """Whether any of a bin ever lay on the contact, (n,)."""
    low, high = _spans(arc)
    first, last = (np.bincount(ends, minlength=len(edges)) for ends in _touched(low, high, edges))
    return np.cumsum(first - last)[:-1] > 0


def _spans(arc: Arc) -> tuple[np.ndarray, np.ndarray]:
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


def _largest_tension(arc: Arc, radius: float, edges: np.ndarray, tension: np.ndarray) -> None:
    """Raise each bin's largest tension, (n,), to that of the contact while any of the bin is on it."""
    # Only the outer turn on a drum feels the tension at the lead point.
    turn = 2.0 * math.pi * radius
    arc = arc._replace(
        low=np.where(np.isinf(arc.low), arc.high - turn, arc.low),
        high=np.where(np.isinf(arc.high), arc.low + turn, arc.high),
    )
    if arc.low.size == 1:
        low, high, held = (np.repeat(array, 2) for array in arc[:3])
        arc = Arc(low, high, held, arc.high > arc.low)
    first, last = _touched(*_spans(arc), edges)
    for block in _blocks(last - first):
        number = (last - first)[block]
        step = np.repeat(np.arange(first.size)[block], number)
        bins = np.arange(step.size) - np.repeat(np.cumsum(number) - number, number) + first[step]
        # On the contact while its lower end is below the bin's upper one, and the other way round.
        on = while_below(arc.low[step], arc.low[step + 1], edges[bins + 1])
        off = while_below(-arc.high[step], -arc.high[step + 1], -edges[bins])
        begin, end = np.maximum(on[0], off[0]), np.minimum(on[1], off[1])
        rise = arc.tension[step + 1] - arc.tension[step]
        most = arc.tension[step] + np.maximum(rise * begin, rise * end)
        np.maximum.at(tension, bins[begin <= end], most[begin <= end])


def _blocks(number: np.ndarray) -> Iterator[slice]:
    """Runs of steps that together have about `PAIRS` bins."""
    cuts = np.flatnonzero(np.diff(np.cumsum(number) // PAIRS)) + 1
    for begin, end in zip([0, *cuts.tolist()], [*cuts.tolist(), number.size], strict=True):
        yield slice(begin, end)
