"""When rows of a live source arrive beside their stamps: how fast its clock runs, and where its rows of now begin."""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from tautline.twin.pace import AT_ONCE, LONG_GAP, TOLD_BY, Pace

TYPICAL = 5
"""Rows after which the sample interval is known."""
CLOCK_WRONG = 1e-3
"""Rate of the source's clock beside ours that is reported."""
CLOCK_TIME = 60.0
"""Over how long that is found, s."""
FROM_LINE = 3.0
"""Distance from a line through all rows over that from the row before, from which there is a step among them."""


class Arrived(Protocol):
    """What has a stamp and came at a time of this computer's clock, s."""

    stamp: float
    arrived: float


class Arrivals:
    """Follows stamps of a live source and when they came.

    The first rows of one may be old, such as what a broker has kept: they come at once, and the stamps of the rows
    behind them are later by more than the time that went by. A stream of which each row takes minutes shows no such
    thing, and a file, whose rows do not arrive, shows nothing.

    Attributes
    ----------
    clock_rate : float
        How much faster the source's clock runs than ours, as a share.
    """

    def __init__(self) -> None:
        self.clock_rate = 0.0
        self._clock: deque[tuple[float, float]] = deque(maxlen=600)
        self._first_left_out = False
        # The first of the rows that are no older than those behind them, and how many came since; the newest.
        self._since, self._count = (np.nan, np.nan), 0
        self._newest = (np.nan, np.nan)
        self._pace = Pace()
        self._come_as_measured = False
        self._behind_old: list[float] = []
        # Whether all rows before those were a few each; and the first of rows of which it is not known whose they are.
        self._few, self._asked = True, np.nan
        self._paced = 0  # rows in a row that came as measured

    def go_on(self) -> None:
        """Take notice that an earlier process has begun: the first rows that come now are not the first."""
        self._come_as_measured = True

    def take(self, stamp: float, arrived: float, after_gap: bool = False) -> str:
        """Take a row that is newer than all before, and that counts; gives what is to be told."""
        if after_gap:
            self._clock.clear()  # it may have been set: how fast it runs is seen between two settings alone
        self._pace.take(stamp, arrived)
        self._look_for_old(stamp, arrived)
        self._newest = stamp, arrived
        return self._compare_clocks(stamp, arrived)

    def _look_for_old(self, stamp: float, arrived: float) -> None:
        """Keep the stamp of a row that shows by its arrival that all before it were old."""
        if self._come_as_measured:
            return
        step, waited = stamp - self._newest[0], arrived - self._newest[1]
        if step - waited > LONG_GAP:
            self._behind_old.append(stamp)
            self._few &= self._count < TYPICAL
        if step - waited > LONG_GAP or not self._count:
            self._since, self._count, self._paced = (stamp, arrived), 1, 0
            return
        self._count += 1
        # One by one, or all of them: rows of now may come behind others that were kept, or in bursts.
        self._paced = self._paced + 1 if step <= AT_ONCE * waited else 0
        stamps, passed = stamp - self._since[0], arrived - self._since[1]
        long_enough = self._count >= TYPICAL or passed >= TOLD_BY
        together = long_enough and passed > 0.0 and stamps <= AT_ONCE * passed
        self._come_as_measured = together or self._paced >= TYPICAL

    def runs_ahead(self, row: Arrived) -> bool:
        """Whether the stamp of a row is further ahead of the newest than time has gone by: it may be false.

        Nothing shows that where rows did not come as they were measured, such as those of a file.
        """
        step, waited = row.stamp - self._newest[0], row.arrived - self._newest[1]
        return self._pace.has_paced and step > AT_ONCE * waited + TOLD_BY

    def begin_now(self, rows: Sequence[Arrived], silent: bool) -> bool:
        """Whether with the first of some rows the rows of now begin, and all before it were old.

        Those are of now that come as they are measured, or whose stamps are those of this computer's clock.

        Parameters
        ----------
        rows : sequence
            That row and those behind it, without a gap between them.
        silent : bool
            Whether none has come for a while.
        """
        first, last = rows[0], rows[-1]
        self._asked = np.nan
        if first.stamp not in self._behind_old:
            return False
        stamps, passed = last.stamp - first.stamp, last.arrived - first.arrived
        as_measured = silent if first is last else stamps <= AT_ONCE * passed
        begin = as_measured or _is_of_this_clock(first)
        self._asked = np.nan if begin else first.stamp
        return begin

    def begin_late(self, row: Arrived) -> bool:
        """Whether a row shows that with the gap before it the rows of now had begun, as `begin_now` could not know.

        So it is where rows of now come late or in bursts. Where more than a few rows were before the gap, they are a
        log, and what is counted from its first row stays.
        """
        as_measured = self._come_as_measured and self._since[0] == self._asked
        begin = self._few and np.isfinite(self._asked) and (as_measured or _is_of_this_clock(row))
        self._asked = np.nan if begin else self._asked
        return bool(begin)

    def _compare_clocks(self, stamp: float, arrived: float) -> str:
        """Find how fast the source's clock runs beside ours; gives the sentence where that is to be told."""
        if not self._first_left_out:
            self._first_left_out = True  # what holds when it is first asked for is older than what follows
            return ""
        if self._clock and arrived - self._clock[-1][1] < 0.1:
            return ""
        self._clock.append((stamp, arrived))
        first, last = self._clock[0], self._clock[-1]
        if last[1] - first[1] <= CLOCK_TIME:
            return ""
        before = abs(self.clock_rate) > CLOCK_WRONG
        self.clock_rate = _rate(np.array(self._clock))
        if abs(self.clock_rate) <= CLOCK_WRONG or before:
            return ""
        return f"the source's clock runs {100.0 * self.clock_rate:+.2g} % beside ours; the twin goes by its stamps"


def _rate(clock: np.ndarray) -> float:
    """How much faster than ours a clock runs, by stamps and arrivals (n, 2), s: a share.

    It is the slope of a line through all rows. A clock that was set by less than rows are apart leaves a step in it,
    and rows are further from the line then than from one another: the median of pairs counts that are a quarter of all
    rows apart, most of which do not hold the step.
    """
    ahead, arrived = clock[:, 0] - clock[:, 1], clock[:, 1] - clock[0, 1]
    line, at = np.polyfit(arrived, ahead, 1)
    if np.std(ahead - line * arrived - at) <= FROM_LINE * np.median(np.abs(np.diff(ahead))):
        return float(line)
    apart = max(1, len(clock) // 4)
    return float(np.median((ahead[apart:] - ahead[:-apart]) / (arrived[apart:] - arrived[:-apart])))


def _is_of_this_clock(row: Arrived) -> bool:
    """Whether the stamp of a row is the time of this computer's clock at which it came."""
    wall = clock.time() - clock.monotonic() + row.arrived
    return abs(row.stamp - wall) <= LONG_GAP
