"""How far the twin is behind the machine, as rows come faster than they are answered."""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Callable

import numpy as np

from tautline.twin.pace import AT_ONCE, LONG_GAP, TOLD_BY

LIMIT = 1.5
"""Time from which on a twin is behind its machine, where no look ahead is shorter, s."""
CAUGHT_UP = 0.5
"""Part of that limit below which it is so no more."""
FALLS_BACK = 3.0
"""After how long it is told what helps, where the twin has not come nearer to the machine meanwhile, s."""
AT_A_TIME = 0.25
"""Rows that come within this part of the time between their stamps were sent together."""
DRIFT = 0.01
"""By how much the clocks of sender and receiver may differ, as a share."""
PAUSES = 2.0
"""Within so many times as long as rows that were sent together last, a sender of such rows has paused."""


class Backlog:
    """Follows how long rows wait between their arrival and their answer.

    Rows that a gateway sends together are due one after another, as their stamps go by: a twin that answers them as
    fast has answered them all when the next ones come. Rows that a link gives at once after it has stalled look the
    same, and no pause follows them: where rows come one by one again, they are due when they come.

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
    held_up : bool
        Whether it is so by one long wait, such as that for a compiler at the start, and not as rows add up.
    """

    def __init__(self, limit: float = LIMIT, now: Callable[[], float] = clock.monotonic) -> None:
        self.limit, self.behind, self.held_up = min(limit, LIMIT), False, False
        self._now = now
        self._came: deque[tuple[float, float]] = deque()
        self._last: float | None = None
        self._moved = (np.nan, np.nan)
        self._spare, self._waited, self._paced = 0.0, 0.0, 0.0
        self._largest, self._least, self._since = 0.0, 0.0, -np.inf
        self._begun = (np.nan, np.nan)
        self._told = False

    def take(self, stamp: float, arrived: float) -> None:
        """Take notice of the newest stamp, and of when the last record arrived, s."""
        if np.isfinite(stamp):
            stamps = stamp - self._moved[0]
            if stamps > LONG_GAP or stamps < 0.0:
                self._came.clear()  # it has not gone by while rows came, or the first row was from the future
                self._spare = 0.0
            elif stamps > 0.0:
                self._spread(stamps, arrived - self._moved[1])
                self._call_due(arrived)
            if stamps != 0.0:
                self._moved = stamp, arrived
            self._came.append((stamp, arrived))
        while len(self._came) > 1 and self._came[1][1] <= arrived - TOLD_BY:
            self._came.popleft()
        self._last = arrived + self._spare

    def _spread(self, stamps: float, arrivals: float) -> None:
        """Follow how long after its arrival a record is due, by what lies between it and the one before, s."""
        together = arrivals < AT_A_TIME * stamps
        more = (1.0 - DRIFT) * stamps - arrivals
        self._spare = max(0.0, self._spare + (more if together else min(0.0, more)))
        one_by_one = stamps <= AT_ONCE * arrivals and arrivals <= AT_ONCE * stamps
        self._paced = self._paced + arrivals if one_by_one else 0.0

    def _call_due(self, arrived: float) -> None:
        """Take back what no pause of the sender has used up: those rows came at once as the link had stalled."""
        if self._paced >= TOLD_BY:
            self._spare = 0.0
        self._least = min(self._least, self._spare)
        over = arrived - self._since > PAUSES * self._largest
        if over:
            self._spare -= self._least
        if over or self._spare > self._largest:
            self._largest = self._least = self._spare
            self._since = arrived

    def none_waits(self) -> None:
        """Take notice that all that came is taken."""
        self._last = None

    @property
    def seconds(self) -> float:
        """For how long the last record that was taken has been due, s; 0 for what was written before."""
        waited = max(0.0, self._now() - self._last) if self._last is not None else 0.0
        return waited if self._is_measured(waited > self.limit) else 0.0

    def _is_measured(self, soon: bool) -> bool:
        """Whether rows come as they are measured; `soon` to say so of the first ones, which nothing else shows yet."""
        if len(self._came) < 2:
            return False
        (stamp, arrived), (last, then) = self._came[0], self._came[-1]
        return then - arrived >= (0.0 if soon else TOLD_BY) and last - stamp <= AT_ONCE * (then - arrived)

    def judge(self) -> tuple[float, bool]:
        """By how much the twin is behind, s, and whether it is to be told now what helps: once, where it falls back."""
        seconds = self.seconds
        before, self.behind = self.behind, seconds > (CAUGHT_UP if self.behind else 1.0) * self.limit
        if self.behind and not before:
            self._begun = self._now(), seconds
            self.held_up = seconds - self._waited >= CAUGHT_UP * self.limit
        self._waited = seconds
        lasts = self.behind and self._now() - self._begun[0] >= FALLS_BACK and seconds >= self._begun[1]
        self.held_up &= self.behind and not lasts
        tell, self._told = lasts and not self._told, self._told or lasts
        return seconds, tell
