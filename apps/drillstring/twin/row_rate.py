"""What rows that come slowly do not show: friction, stick-slip, and how weight and torque at the bit swing."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any

import numpy as np

from drillstring.twin.at_bit import RESOLVED, mean_time
from tautline.twin.estimation.estimate import FEWEST as FEWEST_OF_FRICTION

TYPICAL = 5
"""Rows after which their interval is known."""
REMEMBERED = 51
"""Intervals of which the median counts."""
NEARLY = 1.01
"""How much longer an interval may be than one that is enough: stamps are rounded."""


class RowInterval:
    """Time from row to row, s, as the median of the last; NaN until it is known."""

    def __init__(self) -> None:
        self._last = nan
        self._intervals: deque[float] = deque(maxlen=REMEMBERED)

    def add(self, time: float) -> float:
        """The interval with one more row."""
        if isfinite(self._last) and time > self._last:
            self._intervals.append(time - self._last)
        self._last = time
        return self.value

    @property
    def value(self) -> float:
        """s."""
        return float(np.median(self._intervals)) if len(self._intervals) >= TYPICAL - 1 else nan

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {"last": self._last, "intervals": list(self._intervals)}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self._last = float(memory["last"])
        self._intervals = deque(memory["intervals"], maxlen=REMEMBERED)


@dataclass(frozen=True)
class Needed:
    """Longest intervals of rows, s, with which something is told.

    Attributes
    ----------
    friction : float
        Of friction factors, which are found from means over some seconds.
    swing : float
        Of weight and torque at the bit with deviations for rows that show how hook load and torque swing.
    stick_slip : float
        Of stick-slip, of which one harmonic at least is to be seen.
    mean : float
        Time, s, over which weight and torque are averaged where rows come as fast as they should.
    """

    friction: float
    swing: float
    stick_slip: float
    mean: float

    @classmethod
    def of(cls, friction_mean: float, axial: float, torsional: float, highest: float, mean: float) -> Needed:
        """For means of friction over a time, s; periods of a string, s; and the highest order that is looked for."""
        # A mean ends with the first row that is so much later than its first.
        return cls(friction_mean / (FEWEST_OF_FRICTION - 2), RESOLVED * axial, 0.4 * torsional / highest, mean)

    def lost(self, interval: float, *, estimates: bool) -> list[str]:
        """Sentences on what rows do not tell that come at an interval, s; none where that is not known.

        ``estimates`` tells whether friction is asked for.
        """
        found = []
        come = f"rows come every {interval:.3g} s"
        if estimates and interval > NEARLY * self.friction:
            found.append(
                f"friction: {come}, and at least every {self.friction:.3g} s is needed. Friction factors stay "
                "as the map has them at the start"
            )
        if interval > NEARLY * self.swing:
            found.append(
                f"bit.weight and bit.torque as they swing: {come}, and at least every {self.swing:.2g} s is needed. "
                f"Both are means over {mean_time(interval, self.mean):.3g} s, and their stated deviations are larger"
            )
        if interval > NEARLY * self.stick_slip:
            found.append(f"bit.stick_slip: {come}, and at least every {self.stick_slip:.2g} s is needed")
        return found


class Remarks:
    """Sentences that are said once of each subject, which is what stands before the colon."""

    def __init__(self) -> None:
        self._subjects: set[str] = set()

    def new(self, sentences: list[str]) -> list[str]:
        """Those on a subject of which nothing was said; from now on something was."""
        found = [one for one in sentences if _subject(one) not in self._subjects]
        self._subjects.update(map(_subject, found))
        return found

    def memory(self) -> list[str]:
        """What a later process needs to go on."""
        return sorted(self._subjects)

    def recall(self, memory: list[str]) -> None:
        """Go on from what an earlier process kept."""
        self._subjects = set(memory)


def _subject(sentence: str) -> str:
    return sentence.split(":")[0]
