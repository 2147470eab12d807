"""How much of a hole's bends a string feels that touches the wall at some places only.

Between its places a string knows nothing of the hole. What it feels of the bends at a place is the change of direction
of the chords to the places on either side, and that is the mean of the curvature, with a sign, over both stretches. In
an arc it is all of the bend. A hole that bends to and fro within the stretches has more: the string feels less of it,
or nothing where a whole period fits in.

In the frame that does not turn about the hole (wellbore.py) the way of the hole across is the integral of its turning,
to first order in the angle by which a few stretches bend. Turning is straight between the hole's joints, so that the
integral is a parabola there, and exact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drillstring.well.wellbore import Wellbore

LOOKS = 8
"""Places within each stretch at which the hole is compared with an arc."""


class Followed(NamedTuple):
    """Of n inner places: measured depth m, bend of the hole and what is felt of it rad, distance from an arc m.

    The bend is that of half of the stretches on either side. The arc goes through the place and its neighbours;
    ``off`` is how far the hole leaves it between them.
    """

    depth: np.ndarray
    bend: np.ndarray
    felt: np.ndarray
    off: np.ndarray

    @property
    def missed(self) -> np.ndarray:
        """Bend that is not felt (n,), rad."""
        return np.maximum(0.0, self.bend - self.felt)


class _Across:
    """The way of a hole across, both components, and the integral of its bend, which is the way without signs."""

    def __init__(self, well: Wellbore) -> None:
        rates = np.array([well.k1, well.k2, np.hypot(well.k1, well.k2)])
        step = np.diff(well.md)
        turned = np.cumsum(rates * step, axis=1)
        turning = np.concatenate([np.zeros((3, 1)), turned], axis=1)
        way = np.cumsum(0.5 * step * (turning[:, 1:] + turning[:, :-1]), axis=1)
        self.well, self.rates, self.turning = well, rates, turning
        self.way = np.concatenate([np.zeros((3, 1)), way], axis=1)

    def at(self, depth: np.ndarray) -> np.ndarray:
        """Both components of the way across, and the integral of the bend, at depths (n,) m: (3, n)."""
        arc = self.well.arc(depth)
        past = depth - self.well.md[arc]
        return self.way[:, arc] + self.turning[:, arc] * past + 0.5 * self.rates[:, arc] * past**2


def followed(well: Wellbore, places: np.ndarray) -> Followed:
    """What a string that touches a hole at places (n + 2,), m of measured depth and rising, feels of its bends."""
    across = _Across(well)
    length, ways = np.diff(places), across.at(places)
    slopes = np.diff(ways, axis=1) / length
    change = np.diff(slopes, axis=1)
    # Newton's form of the parabola through three places: its third coefficient.
    bow = change[:2] / (length[1:] + length[:-1])
    off = np.zeros(places.size - 2)
    for share in (np.arange(LOOKS) + 0.5) / LOOKS:
        for first in (slice(None, -1), slice(1, None)):
            look = places[:-1][first] + share * length[first]
            from_upper = look - places[:-2]
            arc = ways[:2, :-2] + slopes[:, :-1][:2] * from_upper + bow * from_upper * (look - places[1:-1])
            off = np.maximum(off, np.hypot(*(across.at(look)[:2] - arc)))
    return Followed(places[1:-1], change[2], np.hypot(change[0], change[1]), off)
