"""Where a string buckles: its compression beside the limit there, at the ends of links and of sections.

A model has the tension in the middle of a link, but a string is pushed most at an end of one, most of all at the bit.
So ends and middles of links are looked at, `Stations`. Between them compression and limit are taken to go straight,
and a stretch of hole in which the string buckles ends where both are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drillstring.scene.scene import DrillstringScene
from drillstring.string.buckling import Limits, limit_at, limits_at
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps, Tube
from drillstring.string.strength import ends_of_links, shares_at_ends, tension_at
from drillstring.well.wellbore import Wellbore

PIECES = 100
"""Pieces at least that a section of a string at rest is looked at in, all of one length but for joints of the hole."""
NO_FORCE = 1.0e-6
"""Force, N, that counts as none: where nothing has weight, limits of buckling are zero, and what is computed is
rounding."""
ROUNDING = 1.0e-6
"""Share of the largest tension of a run below which a compression is what rounding leaves."""
INSIDE = 1.0e-9
"""Part of a piece by which a place at its end lies within it: at a joint the hole has two curvatures."""


class Stations(NamedTuple):
    """Upper end, middle and lower end of each of n links.

    ``measured_depth`` (n, 3) m; ``limits`` are the buckling limits there, (n, 3) each; ``share`` (n - 1,) is that of
    `drillstring.string.strength.shares_at_ends`.
    """

    measured_depth: np.ndarray
    limits: Limits
    share: np.ndarray

    def compression(self, hook_load: float, tension: np.ndarray) -> np.ndarray:
        """Compression (n, 3), N, positive where it is pushed, from hook load N and tension in the middles (n,) N."""
        upper, lower = ends_of_links(self.share, np.asarray(hook_load), tension)
        return -np.stack([upper, tension, lower], axis=1)

    def buckled(self, kind: str, compression: np.ndarray) -> list[tuple[float, float]]:
        """Stretches of hole, from and to measured depth in m, with a compression (n, 3) N beyond a kind of limit."""
        excess = compression - np.maximum(getattr(self.limits, kind), NO_FORCE)
        return stretches(*(_by_halves(values) for values in (self.measured_depth, excess)))


def stations_of(
    scene: DrillstringScene, well: Wellbore, lumps: Lumps, pipes: list[Tube], weight: np.ndarray, middle: Limits
) -> Stations:
    """Stations of a mesh in a hole.

    Parameters
    ----------
    scene : DrillstringScene
    well : Wellbore
    lumps : Lumps
        Mesh of n links, whose top is at the rotary table.
    pipes : list of n Tube
        Of the links.
    weight : (n,) array
        Their buoyed weight per length, N/m.
    middle : Limits
        In their middles.
    """
    upper, lower = lumps.measured_depth[:-1], lumps.measured_depth[1:]
    ends = [_limits(scene, well, place, pipes, weight) for place in _inside(upper, lower)]
    limits = Limits(
        *(np.stack([getattr(one, kind) for one in (ends[0], middle, ends[1])], axis=1) for kind in Limits._fields)
    )
    return Stations(np.stack([upper, 0.5 * (upper + lower), lower], axis=1), limits, shares_at_ends(scene, lumps))


def stretches(depth: np.ndarray, excess: np.ndarray) -> list[tuple[float, float]]:
    """Stretches of hole, m, in which something is in excess, from its excess at both ends of pieces.

    Parameters
    ----------
    depth : (n, 2) array
        Upper and lower end of each piece, m, one piece behind the other.
    excess : (n, 2) array
        There; it goes straight in between. What is not finite is no excess.
    """
    found: list[tuple[float, float]] = []
    excess = np.where(np.isfinite(excess), excess, 0.0)
    for (top, bottom), (above, below) in zip(depth.tolist(), excess.tolist(), strict=True):
        if not max(above, below) > 0.0:
            continue
        crossed = top + (bottom - top) * above / (above - below) if above * below < 0.0 else None
        begin = crossed if crossed is not None and above < 0.0 else top
        end = crossed if crossed is not None and below < 0.0 else bottom
        if found and found[-1][1] == begin:
            begin = found.pop()[0]
        found.append((begin, end))
    return found


class Buckled(NamedTuple):
    """Where a string is farthest beyond its limit: section, compression and limit N, from and to which m, depth m."""

    section: int
    compression: float
    limit: float
    top: float
    bottom: float
    depth: float


def buckled_at_rest(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> Buckled | None:
    """Where the string at rest and without friction is compressed beyond its sinusoidal limit (buckling.py)."""
    edges = _edges(well, lumps)
    ends = np.cumsum([tube.length for tube in lumps.tubes])
    section = np.searchsorted(ends[:-1], 0.5 * (edges[1:] + edges[:-1]), side="right")
    tension = tension_at(scene, well, lumps, edges)
    depth, pushed = (np.stack([x[:-1], x[1:]], axis=1) for x in (edges, -tension))
    return _farthest(depth, section, pushed, _limits_of_pieces(scene, well, lumps, section, depth, pushed))


def buckled_in_frames(
    scene: DrillstringScene, well: Wellbore, lumps: Lumps, hook_load: np.ndarray, tension: np.ndarray
) -> tuple[int, Buckled] | None:
    """The frame in which a string is farthest beyond its sinusoidal limit, and where it is so then.

    Parameters
    ----------
    scene : DrillstringScene
    well : Wellbore
    lumps : Lumps
        Mesh of n links or elements.
    hook_load : (m,) array
        N.
    tension : (m, n) array
        In the middles of the links, or means of the elements, N.
    """
    pushed = -np.stack(ends_of_links(shares_at_ends(scene, lumps), hook_load, tension), axis=2)
    depth = np.stack([lumps.measured_depth[:-1], lumps.measured_depth[1:]], axis=1)
    section = np.asarray(lumps.section)
    limit = _limits_of_pieces(scene, well, lumps, section, depth, pushed.max(axis=0))
    # Of a string that nothing pushes rounding leaves a tension of either sign, and of one without weight no limit.
    limit = np.maximum(limit, ROUNDING * float(np.abs(tension).max(initial=0.0)) + NO_FORCE)
    frame = int(np.argmax((pushed / limit).max(axis=(1, 2))))
    found = _farthest(depth, section, pushed[frame], limit)
    return None if found is None else (frame, found)


def _limits_of_pieces(
    scene: DrillstringScene, well: Wellbore, lumps: Lumps, section: np.ndarray, depth: np.ndarray, pushed: np.ndarray
) -> np.ndarray:
    """Sinusoidal limits (n, 2), N, at both ends of pieces of sections (n,); infinite where nothing is pushed.

    ``depth`` (n, 2) m are their ends, and ``pushed`` (n, 2) N the compression there.
    """
    limit, at = np.full(depth.shape, np.inf), np.flatnonzero(pushed.max(axis=1) > 0.0)
    if at.size == 0:
        return limit
    tubes = lumps.tubes
    weight = np.array([weight_in(fluid_of(scene.mud), tube, scene.gravity) for tube in tubes])[section[at]]
    rigidity = np.array([tube.youngs_modulus * tube.second_moment for tube in tubes])[section[at]]
    clearance = _clearance(scene, tubes)[section[at]]
    for end, place in enumerate(_inside(*depth[at].T)):
        limit[at, end] = limit_at("sinusoidal", well, place, rigidity, weight, clearance)
    return limit


def _farthest(depth: np.ndarray, section: np.ndarray, pushed: np.ndarray, limit: np.ndarray) -> Buckled | None:
    """Where pieces are farthest beyond their limits; None where none is. All as `_limits_of_pieces` has it."""
    found = stretches(depth, pushed - limit)
    if not found:
        return None
    beyond = np.where(pushed > limit, pushed / np.maximum(limit, 1e-9), 0.0)
    worst = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
    reach = found[0][0], found[-1][1]
    return Buckled(int(section[worst[0]]), float(pushed[worst]), float(limit[worst]), *reach, float(depth[worst]))


def _edges(well: Wellbore, lumps: Lumps) -> np.ndarray:
    """Ends of the pieces of a string at rest (n + 1,), m: those of its sections and the joints of the hole too."""
    ends = np.concatenate([[0.0], np.cumsum([tube.length for tube in lumps.tubes])])
    even = [np.linspace(a, b, PIECES + 1) for a, b in pairwise(ends)]
    joints = well.md[well.md < ends[-1]]
    return np.unique(np.concatenate([*even, joints]))


def _limits(
    scene: DrillstringScene, well: Wellbore, place: np.ndarray, pipes: list[Tube], weight: np.ndarray
) -> Limits:
    return limits_at(well, place, pipes, weight, _clearance(scene, pipes))


def _clearance(scene: DrillstringScene, pipes: Sequence[Tube]) -> np.ndarray:
    """Radial clearance of tubes in the hole (n,), m."""
    return np.array([0.5 * (scene.well.diameter - tube.contact_od) for tube in pipes])


def _inside(upper: np.ndarray, lower: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both ends of pieces, m, a little way within them."""
    way = INSIDE * (lower - upper)
    return upper + way, lower - way


def _by_halves(values: np.ndarray) -> np.ndarray:
    """Values at upper end, middle and lower end (n, 3) as those at both ends of each half, (2 n, 2)."""
    return np.stack([values[:, :2], values[:, 1:]], axis=1).reshape(-1, 2)
