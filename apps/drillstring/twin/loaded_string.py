"""What a weight on the bit changes at the surface, by the soft string.

In a vertical hole the hook lacks the weight, and the drive has the bit's torque more. In a curved one the weight also
lowers the tension, and so the force on the wall. A string that turns then has less friction torque than off bottom. A
string that slides down has more friction along the hole where the weight pushes it against the wall: the hook lacks
less than the weight.
"""

from __future__ import annotations

from math import atan2
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.motion import Motion
from drillstring.statics.soft_string import SoftString, StringInHole
from drillstring.statics.statics import weight_per_length
from drillstring.string.factors import Factors

STEP = 20.0
"""Longest step of the integration, m: it is of fourth order, and the twin has no time for more."""
POINTS = 5
"""Weights of a table."""
LEAST_REACH = 50e3
"""A table goes up to this weight at least, N."""
SPARE = 1.5
"""And to so many times the weight that is asked for."""
LARGEST_REACH = 64e6
"""Weight, N, from which on a table is not made longer."""
BISECTIONS = 6
"""Halvings in which the weight that locks the string up is found."""
TURNED, ARM = 0.02, 0.08
"""Change of the direction of slip, rad, from which on a table is made anew; and the radius, m, it is reckoned at."""
MOVED = 2e-3
"""Relative change of a friction factor from which on a table is made anew."""
LEAST_APART, MOST_APART = 5e-3, 0.05
"""How far the friction factors of neighbouring tables are off: a standard deviation within these."""


class Loaded(NamedTuple):
    """At a weight on the bit, N: what the hook lacks, N; by how much friction torque is smaller, N m; by how much the
    string is shorter, m.
    """

    weight: float
    lacking: float
    torque: float
    shorter: float


class Table:
    """A string of one friction and one motion, with weights on its bit.

    Parameters
    ----------
    rows : (n, 4) array
        As `Loaded`, by rising weight from zero on.
    hook_load, torque : float
        Off bottom, N and N m.
    locks : bool
        Whether more weight than the last locks the string up.
    """

    def __init__(self, rows: np.ndarray, hook_load: float, torque: float, locks: bool) -> None:
        self.hook_load, self.torque, self.locks = hook_load, torque, locks
        self.rows = rows
        # What the hook lacks rises with the weight everywhere: the tension above depends steadily on that below.
        self._at = PchipInterpolator(rows[:, 1], rows, axis=0)
        self._slope = self._at.derivative()

    @property
    def most(self) -> float:
        """What the hook lacks at the largest weight, N."""
        return float(self.rows[-1, 1])

    def at(self, lacking: float) -> Loaded:
        """What there is where the hook lacks so much, N; straight on beyond the table's ends."""
        within = min(max(lacking, 0.0), self.most)
        return Loaded(*(self._at(within) + (lacking - within) * self._slope(within)).tolist())

    def slope(self, lacking: float) -> Loaded:
        """Derivatives of that by what the hook lacks."""
        return Loaded(*self._slope(min(max(lacking, 0.0), self.most)).tolist())


class Tables(NamedTuple):
    """A table; those with one friction factor after the other a little larger, and by how much; and the hook load, N,
    of the string without friction.
    """

    middle: Table
    apart: dict[str, tuple[Table, float]]
    without: float


class LoadedString:
    """Tables of a string, made anew when friction or motion are others, or the weight outgrows them.

    Parameters
    ----------
    scene : DrillstringScene
        Off bottom.
    """

    MADE_ANEW = ("well", "tubes", "weight", "hole", "_in_hole", "_stiffness", "_ends", "_made")

    def __init__(self, scene: DrillstringScene) -> None:
        self.well = well_of(scene)
        self.tubes = tubes_of(scene, self.well.length)
        self.weight = weight_per_length(scene, self.tubes)
        self.hole = scene.well.diameter
        self._in_hole = StringInHole(self.well, self.tubes, self.weight, self.hole, STEP)
        self._stiffness = np.array([tube.youngs_modulus * tube.area for tube in self.tubes])
        self._ends = np.cumsum([tube.length for tube in self.tubes])
        self._made: tuple[Factors, float, Tables] | None = None
        # From what they were made, so that a later process has the same.
        self._made_of: tuple[Factors, dict[str, float], Motion, float] | None = None

    def tables(self, factors: Factors, apart: dict[str, float], motion: Motion, lacking: float) -> Tables | None:
        """Tables for a friction and a motion that reach at least as far as what the hook lacks, N, if they can.

        ``apart`` are standard deviations of the factors by their names in `Factors`. None where the string locks up off
        bottom.
        """
        if self._made is None and self._made_of is not None:
            self._make(*self._made_of)
        slip = _slip_of(motion)
        if self._made is not None:
            old, at, made = self._made
            close = all(abs(a - b) <= MOVED * abs(b) for a, b in zip(factors, old, strict=True))
            close = close and abs(slip - at) <= TURNED and set(apart) == set(made.apart)
            if close and (made.middle.locks or lacking <= made.middle.most):
                return made
        return self._make(factors, apart, motion, lacking)

    def _make(self, factors: Factors, apart: dict[str, float], motion: Motion, lacking: float) -> Tables | None:
        """Make tables anew; None where the string locks up off bottom."""
        reach = max(LEAST_REACH, SPARE * lacking)
        middle = self._table(factors, motion, reach)
        while middle is not None and not middle.locks and middle.most < lacking and reach < LARGEST_REACH:
            reach *= 2.0
            middle = self._table(factors, motion, reach)
        if middle is None:
            self._made = self._made_of = None
            return None
        others = {}
        for name, sd in apart.items():
            off = min(max(sd, LEAST_APART), MOST_APART)
            more = self._table(factors._replace(**{name: getattr(factors, name) + off}), motion, middle.rows[-1, 0])
            if more is not None:
                others[name] = more, off
        free = self._soft(Factors(0.0, 0.0), motion, 0.0).hook_load
        made = Tables(middle, others, free)
        self._made, self._made_of = (factors, _slip_of(motion), made), (factors, apart, motion, lacking)
        return made

    def _soft(self, factors: Factors, motion: Motion, weight: float) -> SoftString:
        return self._in_hole.solved(factors, motion, -weight)

    def _table(self, factors: Factors, motion: Motion, reach: float) -> Table | None:
        """Up to a weight, N, or to where it locks up; None where it does so without any."""
        first = self._soft(factors, motion, 0.0)
        if first.locked is not None:
            return None
        last, locks = self._soft(factors, motion, reach), False
        if last.locked is not None:
            low, locks = 0.0, True
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + reach)
                held = self._soft(factors, motion, middle)
                if held.locked is None:
                    low, last = middle, held
                else:
                    reach = middle
            if low == 0.0:
                return None
            reach = low
        weights = np.linspace(0.0, reach, POINTS)
        strings = [first, *(self._soft(factors, motion, w) for w in weights[1:-1]), last]
        rows = [
            Loaded(
                w, first.hook_load - one.hook_load, first.surface_torque - one.surface_torque, self._shorter(first, one)
            )
            for w, one in zip(weights.tolist(), strings, strict=True)
        ]
        return Table(np.array(rows), first.hook_load, first.surface_torque, locks)

    def _shorter(self, first: SoftString, one: SoftString) -> float:
        """By how much a string is shorter than another one, m."""
        s = one.measured_depth
        middle = 0.5 * (s[1:] + s[:-1])
        stiffness = self._stiffness[np.minimum(np.searchsorted(self._ends, middle), self._stiffness.size - 1)]
        lower = first.tension - one.tension
        return float(np.sum(0.5 * (lower[1:] + lower[:-1]) * np.diff(s) / stiffness))


def _slip_of(motion: Motion) -> float:
    """Direction in which the string slides on its wall, rad."""
    return atan2(motion.speed, ARM * abs(motion.rotary)) * (1.0 if motion.rotary >= 0.0 else -1.0)
