"""Readings that hold until another one is sent.

OPC UA sends changes: a variable that stands still is silent, and silence of a server that is alive means that the last
reading still holds (OPC UA part 4, 7.22.2: the default DataChangeTrigger is STATUS_VALUE, and many servers do not know
the one that tells every stamp). So a reading that is not sent again is repeated here, at the interval in which it used
to come, as far as the server has said that it is alive.
"""

from __future__ import annotations

import math
import time as clock
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tautline.twin.sources.record import Record

KEPT = 20
"""Intervals of a variable that are looked back on."""
ENOUGH = 4
"""Intervals from which on they tell how often a variable is measured."""
REGULAR = 1.5
"""Upper over lower quartile of intervals that are those of a clock; changes of a lever are not."""
LONGEST = 2.0
"""Longest interval that is taken for one of measurement, s."""
SILENT, AGAIN = 1.5, 0.75
"""Intervals after which a reading is repeated: after one that was sent, and after one that was repeated."""

WAIT, OLD, DAY = 1.0, 2.0, 86400.0
"""How long first readings wait for a change that tells the source's clock, s; how far they are from it where they are
old; and how old a stamp may be by our clock, so that the source's clock is taken to show the same, s."""
SET = 1.0
"""Difference from which on stamps tell of a clock that was set, s."""


@dataclass(frozen=True)
class Change:
    """What a server sends of a variable.

    Attributes
    ----------
    time : float
        Stamp of the source, s.
    column : str
    value : float
        NaN where its status is no good.
    arrived : float
        ``time.monotonic()`` at arrival, s.
    first : bool
        Whether it is what a server sends of a new subscription: the reading that holds, however old.
    """

    time: float
    column: str
    value: float
    arrived: float
    first: bool = False


class Holding:
    """Makes records of changes, with readings that still hold.

    Parameters
    ----------
    columns : sequence of str
    sampling : float
        Interval in which the server looks at variables, s.
    now : callable
        The time, s since 1970.
    """

    def __init__(self, columns: Sequence[str], sampling: float, now: Callable[[], float] = clock.time) -> None:
        self._columns, self._sampling = list(columns), sampling
        self._held: dict[str, float] = {}
        self._sent: dict[str, float] = {}
        self._shown: dict[str, float] = {}
        self._intervals: dict[str, deque[float]] = {name: deque(maxlen=KEPT) for name in columns}
        self._clock: tuple[float, float] | None = None
        self._reached = -math.inf
        self._first: list[Change] = []
        self._now = now

    def forget(self) -> None:
        """Hold nothing any more: the connection is lost."""
        self._first.clear()
        self._held.clear()
        self._sent.clear()

    def records(self, changes: Sequence[Change]) -> list[Record]:
        """Records of changes of one stamp, or of the first ones of a subscription: these wait for the next to come."""
        if changes[0].first and self._clock is None:
            self._first += changes
            return []
        found = []
        if self._first:
            # Now it is known what the source's clock shows.
            then = changes[0].time - (changes[0].arrived - self._first[0].arrived)
            stamp = max(one.time for one in self._first)
            found = self._begin(stamp if abs(then - stamp) < OLD else then)
        time = max(one.time for one in changes)
        if changes[0].first and self._clock is not None:
            # What stood still while the connection was lost has the stamp of long ago, and holds now.
            time = max(time, self._clock[0] + changes[0].arrived - self._clock[1])
        elif self._clock is not None and time < self._clock[0] + changes[0].arrived - self._clock[1] + SET:
            found += self._still(time - 0.5 * self.interval)  # all held until this change
        return [*found, self._record(time, changes)]

    def _begin(self, time: float) -> list[Record]:
        changes, self._first = self._first, []
        return [self._record(time, changes)]

    def _record(self, time: float, changes: Sequence[Change]) -> Record:
        values = dict.fromkeys(self._columns, math.nan)
        for one in changes:
            values[one.column] = self._held[one.column] = one.value
            if not one.first and time > self._sent.get(one.column, math.inf):
                self._intervals[one.column].append(time - self._sent[one.column])
            self._sent[one.column] = self._shown[one.column] = time
        self._clock = (time, changes[0].arrived)
        self._hold(time, values, {one.column for one in changes})
        self._reached = time if time < self._reached - SET else max(self._reached, time)
        return Record(time, values, changes[0].arrived)

    def until(self, alive: float) -> list[Record]:
        """Records of what still holds, up to when the server was alive last, by ``time.monotonic()``, s."""
        begun: list[Record] = []
        if self._first and alive - self._first[0].arrived > WAIT:
            # Nothing moves: a stamp tells when it stopped, and it stands there now.
            stamp, now = max(one.time for one in self._first), self._now() - clock.monotonic() + self._first[0].arrived
            begun = self._begin(now if 0.0 < now - stamp < DAY else stamp)
        if self._clock is None or not self._held:
            return begun
        # What was measured a little before may be on its way.
        late = max(2.0 * self._sampling, 0.5 * self.interval)
        return begun + self._still(self._clock[0] + alive - self._clock[1] - late)

    def _still(self, last: float) -> list[Record]:
        """Records of what is held, at the sampling interval up to a stamp."""
        assert self._clock is not None
        (time, arrived), step = self._clock, self.interval
        found = []
        while self._reached + step <= last:
            self._reached += step
            values = dict.fromkeys(self._columns, math.nan)
            self._hold(self._reached, values, None)
            found.append(Record(self._reached, values, arrived + self._reached - time))
        return found

    @property
    def interval(self) -> float:
        """Interval of the variable that is measured most often, s."""
        return min((one for name in self._held if (one := self._usual(name)) is not None), default=self._sampling)

    def _usual(self, column: str) -> float | None:
        """Interval in which a variable is measured, s; None where its changes do not tell."""
        intervals = self._intervals[column]
        if len(intervals) < ENOUGH:
            return None
        low, middle, high = np.quantile(intervals, (0.25, 0.5, 0.75)).tolist()
        return float(middle) if high <= REGULAR * low and middle <= LONGEST else None

    def _hold(self, time: float, values: dict[str, float], new: set[str] | None) -> None:
        """Repeat what was not sent for longer than it used to take; `new` was sent, None where all are silent."""
        for column, value in self._held.items():
            if new is not None and column in new:
                continue
            interval = self._usual(column) or self.interval
            shown = self._shown[column]
            waits = new is not None and shown == self._sent[column]
            if time - shown > (SILENT if waits else AGAIN) * interval:
                values[column], self._shown[column] = value, time
