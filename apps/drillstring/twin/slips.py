"""What speaks against slips: a hook gauge that is wrong, or dead, tells that the string stands in them for ever.

In slips the simulation waits, and nothing is compared. So two signs are looked at that need no simulation: a hook load
far below that of the empty hook, and a string that turns for long with the torque of a string in the hole.
"""

from __future__ import annotations

from math import exp, isfinite, nan
from typing import NamedTuple

OF_STRING, OF_BLOCK, LEAST_FORCE = 0.15, 0.2, 20.0e3
"""How far below that of the empty hook a load has to be: shares of what the string and the block weigh, and N.

Drilling lines with their friction, hoses and the like change the load of an empty hook by a tenth of the block."""
NOISES, OFFSETS = 5.0, 3.0
"""The same as standard deviations of the sensor, and of an offset of it that is estimated."""
BELOW_FOR = 30.0
"""For how long, s: a block that is set down to make up a stand rests for seconds."""
OF_TORQUE, LEAST_TORQUE = 0.5, 1.0e3
"""Torque of a string that turns in the hole: share of what is computed off bottom, and N m: an idle one has less."""
TURNS_FOR = 60.0
"""For how long it has to turn so, s: a joint is made up within seconds."""
TURNS_LONG = 300.0
"""The same of a gauge that has shown the string, s: casing is made up slowly, and a rotary table may turn in slips."""
OVER = 3.0
"""Time over which loads and torques are averaged, s."""
FEWEST = 3
"""Rows in succession that have to show it: of rows that come slowly one may fall into a block that is set down."""
LONGEST = 120.0
"""Longest time between two rows, s, of which something is said."""


class Expected(NamedTuple):
    """What slips are judged by.

    Attributes
    ----------
    empty : float
        Hook load of the empty hook, N, as scene and map state it.
    below : float
        How far below it a load is none of an empty hook, N.
    torque : float
        From which on a string turns in the hole, N m.
    """

    empty: float
    below: float
    torque: float


def expected(block: float, string: float, torque: float, noise: float, offset: float, empty: float) -> Expected:
    """By what the block, N, and the string weigh, N, and the string takes to turn, N m.

    ``noise`` and ``offset`` are standard deviations of the hook load, N; ``empty`` is what an empty hook should show.
    """
    below = max(OF_STRING * string, OF_BLOCK * block, LEAST_FORCE, NOISES * noise, OFFSETS * offset)
    return Expected(empty, below, max(OF_TORQUE * torque, LEAST_TORQUE))


class _Lasting:
    """The mean of a signal over some seconds, and for how long it has been above a bound."""

    def __init__(self) -> None:
        self.mean, self.lasts, self.rows = nan, 0.0, 0

    def clear(self) -> None:
        self.mean, self.lasts, self.rows = nan, 0.0, 0

    def add(self, value: float, bound: float, passed: float) -> None:
        """One more value; one that is not there changes nothing."""
        if not isfinite(value):
            return
        keep = exp(-passed / OVER) if isfinite(self.mean) else 0.0
        self.mean = keep * self.mean + (1.0 - keep) * value if keep > 0.0 else value
        beyond = self.mean > bound
        # What passed before the first of them was none of it.
        self.lasts = self.lasts + passed * (self.rows > 0) if beyond else 0.0
        self.rows = self.rows + 1 if beyond else 0

    def lasted(self, time: float) -> bool:
        """Whether it has been above its bound for that long, s, in rows enough."""
        return self.lasts >= time and self.rows >= FEWEST


class Slips:
    """Follows rows in slips: how long they last of all, and what speaks against them.

    Attributes
    ----------
    watched, in_them : float
        Time of all rows, and of those in slips or in a connection, s.
    carried : bool
        Whether the gauge has shown more than the empty hook: it was not dead from the beginning.
    """

    def __init__(self) -> None:
        self.watched = self.in_them = 0.0
        self.carried = False
        self.empty = nan
        self._time = nan
        self._below, self._turning = _Lasting(), _Lasting()

    def add(self, time: float, in_slips: bool, load: float, torque: float, by: Expected, known: bool = True) -> None:
        """One more row: hook load with the block, N, and the torque, N m, with which the string turns; 0 at rest.

        ``known`` is False while the rig's state is not: in its first rows the gauge is none that has shown the string.
        """
        passed = time - self._time if isfinite(self._time) else 0.0
        passed = passed if 0.0 < passed <= LONGEST else 0.0
        self._time, self.watched, self.empty = time, self.watched + passed, by.empty
        if not in_slips:
            self._below.clear()
            self._turning.clear()
            self.carried = self.carried or (known and bool(load - by.empty > by.below))
            return
        self.in_them += passed
        if isfinite(load):  # a gauge that shows nothing is told by itself
            self._below.add(by.empty - load, by.below, passed)
            self._turning.add(abs(torque), by.torque, passed)

    @property
    def below(self) -> float:
        """How far the hook load is below that of the empty hook, N, where that has lasted; else NaN."""
        return self._below.mean if self._below.lasted(BELOW_FOR) else nan

    @property
    def turning(self) -> float:
        """Torque of a string that turns in slips, N m, where that has lasted; else NaN."""
        return self._turning.mean if self._turning.lasted(TURNS_LONG if self.carried else TURNS_FOR) else nan

    def memory(self) -> list[float]:
        """What a later process needs to go on."""
        return [self.watched, self.in_them, float(self.carried)]

    def recall(self, memory: list[float]) -> None:
        """Go on from what an earlier process kept; an earlier program kept no more than the times."""
        self.watched, self.in_them, *carried = map(float, memory)
        self.carried = any(carried)
