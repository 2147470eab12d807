"""Whether rows of a source were written before, or are measured while they come: seen as they come, not when taken."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping

import numpy as np

ONE_STAMP = 0.5e-6
"""Stamps that are no further apart than this are one, and times between stamps count as long enough so much sooner, s.
Seconds since 1970 have doubles in steps of 2.4e-7 s, so that two roundings are no more than 4.8e-7 s apart. Stamps are
written with microseconds: those that differ by one are two."""
LONG_GAP = 120.0
"""Step of stamps that is a gap however little is known of the sample interval, s: it is not simulated."""
AT_ONCE, TOLD_BY = 2.0, 1.0
"""Stamps that go by so many times as fast as rows come are of rows that were written before; and the time after which
that is told, s."""
BACK = 5
"""Rows in a row that are not later than the newest, and follow one another: they are of now, and that one is not."""
LOOKS = 5
"""Looks in a row, over `TOLD_BY` or more together, at none of which rows came before they were due: they are of now."""
MOST_CLOCKS = 50
"""Sets of columns that have a clock of their own: of readings that are missing at random there is no end of sets."""


class Pace:
    """Follows stamps and arrivals of a source at the moment that its records come in.

    A machine is beside its twin as soon as one row has come as it was measured, also while many others wait to be taken
    before it. The thread that hears the source takes, any other may look.

    Columns that come in records of their own may have a clock of their own, minutes beside that of others: records of
    the same columns are compared with one another alone, as far as there are not too many such sets.

    Rows that keep coming no earlier than they are due are of now, also those of a simulator that is slower than time,
    or of variables of which each changes once. So that is counted over all clocks.

    Attributes
    ----------
    is_record : bool
        Whether all rows so far were written before, so that nobody waits for their answers. What a link gives at once
        after it has stalled is none: its machine goes on.
    has_paced : bool
        Whether rows have come as they are measured.
    """

    def __init__(self) -> None:
        self._clocks: dict[frozenset[str] | None, _Clock] = {}
        self._looked: tuple[float, float] | None = None  # at a row of whatever clock
        self._in_time, self._until = 0, -np.inf  # looks in a row, and when the last of them was
        self.has_paced, self.is_record = False, False

    def take(self, stamp: float, arrived: float, values: Mapping[str, float] | None = None) -> None:
        """Take notice of a record by its stamp, when it came, s, and the readings that it has by column."""
        if self.has_paced or not np.isfinite(stamp):
            return
        one = self._clock_of(values or {})
        one.take(stamp, arrived)
        self.has_paced = one.has_paced or self._keeps_in_time(one, stamp, arrived)
        self.is_record = not self.has_paced and (self.is_record or one.hurries)

    def _clock_of(self, values: Mapping[str, float]) -> _Clock:
        """The clock of the columns that have a reading; those behind the first sets share one."""
        columns: frozenset[str] | None = frozenset(name for name, value in values.items() if value == value)
        if columns not in self._clocks and len(self._clocks) >= MOST_CLOCKS:
            columns = None
        return self._clocks.setdefault(columns, _Clock())

    def _keeps_in_time(self, clock: _Clock, stamp: float, arrived: float) -> bool:
        """Whether rows have kept coming no earlier than they were due.

        A look is at the first row behind some time. Rows of a fast replay come too early at all looks but those behind
        its stalls, and one stall is counted once, of however many clocks. The first row of a clock is compared with
        that of another, as its clock may be the same.
        """
        last = clock.looked or self._looked
        if last is not None and arrived - last[1] < TOLD_BY / LOOKS:
            return False
        clock.looked = self._looked = stamp, arrived
        if last is None:
            return False
        step, waited = stamp - last[0], arrived - last[1]
        if step > AT_ONCE * waited:
            self._in_time = 0
        elif step > 0.0 and last[1] >= self._until:  # what is not newer shows nothing
            self._in_time, self._until = self._in_time + 1, arrived
        return self._in_time >= LOOKS


class _Clock:
    """Stamps of one clock beside arrivals.

    Rows that are sent together come behind a pause, and so does a row of a fast replay that has stalled. So the pace is
    that from one row behind a pause to another: between those of a replay its stamps go by as fast as ever, and over
    the pause alone they go by too little.

    Attributes
    ----------
    hurries, has_paced : bool
        Whether the newest row has come much before it was due, and whether it has shown that rows come as measured.
    looked : (float, float) or None
        Stamp and arrival of the row that was looked at last, s.
    """

    def __init__(self) -> None:
        # Rows behind a pause: the last one from more than the shortest time before, and those since; or the first row.
        self._paused: deque[tuple[float, float]] = deque()
        self._newest = self._before = (-np.inf, -np.inf)
        self._behind: list[tuple[float, float]] = []
        self.looked: tuple[float, float] | None = None
        self.hurries = self.has_paced = False

    def take(self, stamp: float, arrived: float) -> None:
        """Take notice of a row; one that is not the newest shows nothing, unless it shows that one to be false."""
        if stamp <= self._newest[0]:
            if not self._before[0] < stamp or not self._has_leapt:
                self._fall_behind(stamp, arrived)
                return
            self._newest = self._before
            if self._paused[-1][0] > self._newest[0]:
                self._paused.pop()
        self._behind.clear()
        step, waited = stamp - self._newest[0], arrived - self._newest[1]
        self._before, self._newest = self._newest, (stamp, arrived)
        behind_pause = not self._paused or step <= AT_ONCE * waited
        if behind_pause:
            self._paused.append((stamp, arrived))
        while len(self._paused) > 1 and self._paused[1][1] <= arrived - TOLD_BY:
            self._paused.popleft()
        stamps, passed = stamp - self._paused[0][0], arrived - self._paused[0][1]
        self.hurries = stamps > AT_ONCE * passed
        self.has_paced |= behind_pause and passed >= TOLD_BY and stamps <= AT_ONCE * passed <= AT_ONCE**2 * stamps

    @property
    def _has_leapt(self) -> bool:
        """Whether the newest stamp is ahead of the one before it by more than went by: it is false, or there was a gap.

        The first row that comes is no such one: nothing was before it."""
        return self._newest[0] - self._before[0] > self._newest[1] - self._before[1] + TOLD_BY

    def _fall_behind(self, stamp: float, arrived: float) -> None:
        """Keep a row that is not later than the newest, and begin anew with such rows where they follow one another."""
        if self._behind and stamp <= self._behind[-1][0]:
            self._behind.clear()
        self._behind.append((stamp, arrived))
        if len(self._behind) < BACK:
            return
        rows, self._behind = self._behind, []
        self._paused.clear()
        self._newest = self._before = (-np.inf, -np.inf)
        for one in rows:
            self.take(*one)
