"""How far the twin is behind the machine, as rows come faster than they are answered."""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Callable

import numpy as np

from tautline.twin.signals.rows import AT_ONCE, TOLD_BY

LIMIT = 1.5
"""Time from which on a twin is behind its machine, where no look ahead is shorter, s."""
CAUGHT_UP = 0.5
"""Part of that limit below which it is so no more."""
FALLS_BACK = 3.0
"""After how long it is told what helps, where the twin has not come nearer to the machine meanwhile, s."""


class Backlog:
    """Follows how long rows wait between their arrival and their answer.

    Rows that were written before, such as those of a file that is piped in, come many times as fast as they were
    measured: no machine waits for their answers, and they do not count.

    Parameters
    ----------
    limit : float
        From which on the twin is behind, s.
    now : callable
        The clock of arrivals, s.

    Attributes
    ----------
    behind : bool
        Whether the twin is behind the machine.
    """

    def __init__(self, limit: float = LIMIT, now: Callable[[], float] = clock.monotonic) -> None:
        self.limit, self.behind = min(limit, LIMIT), False
        self._now = now
        self._came: deque[tuple[float, float]] = deque()
        self._last: float | None = None
        self._begun = (np.nan, np.nan)
        self._told = False

    def take(self, stamp: float, arrived: float) -> None:
        """Take notice of the newest stamp, and of when the last record arrived, s."""
        self._last = arrived
        if np.isfinite(stamp):
            self._came.append((stamp, arrived))
        while len(self._came) > 1 and self._came[1][1] <= arrived - TOLD_BY:
            self._came.popleft()

    def none_waits(self) -> None:
        """Take notice that all that came is taken."""
        self._last = None

    @property
    def seconds(self) -> float:
        """For how long the last record that was taken had waited until now, s; 0 for what was written before."""
        return max(0.0, self._now() - self._last) if self._last is not None and self._is_measured else 0.0

    @property
    def _is_measured(self) -> bool:
        """Whether rows come as they are measured."""
        if len(self._came) < 2:
            return False
        (stamp, arrived), (last, then) = self._came[0], self._came[-1]
        return then - arrived >= TOLD_BY and last - stamp <= AT_ONCE * (then - arrived)

    def judge(self) -> tuple[float, bool]:
        """By how much the twin is behind, s, and whether it is to be told now what helps: once, where it falls back."""
        seconds = self.seconds
        before, self.behind = self.behind, seconds > (CAUGHT_UP if self.behind else 1.0) * self.limit
        if self.behind and not before:
            self._begun = self._now(), seconds
        lasts = self.behind and self._now() - self._begun[0] >= FALLS_BACK and seconds >= self._begun[1]
        tell, self._told = lasts and not self._told, self._told or lasts
        return seconds, tell
