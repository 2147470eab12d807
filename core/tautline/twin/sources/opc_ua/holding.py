"""Readings that hold until another one is sent.

OPC UA sends changes: a variable that stands still is silent, and silence of a server that is alive means that the last
reading still holds (OPC UA part 4, 7.22.2: the default DataChangeTrigger is STATUS_VALUE, and many servers do not know
the one that tells every stamp). So a reading that is not sent again is repeated here, at the interval in which it used
to come, as far as the server has said that it is alive.

One variable may reach us later than another of the same stamp. How far its stamps run behind the newest one is known
from its changes, and by so much longer it is waited for before it counts as silent. A repeated reading is marked: where
the true one comes yet, that one counts.
"""

from __future__ import annotations

import math
import time as clock
from collections import deque
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from tautline.scene.values.moments import duration_said
from tautline.twin.sources.record import Record

KEPT = 20
"""Intervals of a variable that are looked back on."""
ENOUGH = 4
"""Intervals from which on they tell how often a variable is measured."""
REGULAR = 1.5
"""Upper over lower quartile of intervals that are those of a clock; changes of a lever are not."""
FEW, ALIKE = 2, 1.1
"""Intervals that tell it already where they are as much alike as these: longest over shortest."""
SHORT, LONGEST = 2.0, 60.0
"""Interval up to which a variable is interpolated between its readings beside any other, and longest interval that is
taken for one of measurement, s. A longer one than the first is told by intervals that are alike."""
APART = 10.0
"""Beside variables that come so many times as often, one whose interval is long counts as one that changes seldom."""
RESTING = 1.0
"""Interval at which readings are repeated where none is known, s: more often, what is measured every few seconds would
become rows with stairs."""
UNTOLD = 2.0
"""Silence from which on readings are repeated where no interval is known, s: rows that come sooner than what is
measured would tell a wrong sample interval."""
SILENT, AGAIN = 1.5, 0.75
"""Intervals after which a reading is repeated: after one that was sent, and after one that was repeated."""

WAIT, OLD, DAY = 1.0, 2.0, 86400.0
"""How long first readings wait for a change that tells the source's clock, s; how far they are from it where they are
old; and how old a stamp may be by our clock, so that the source's clock is taken to show the same, s."""
SET = 1.0
"""Difference from which on stamps tell of a clock that was set, s."""
MOSTLY = 0.9
"""Share of the changes of a variable that come no later than what counts as its lag."""
IN_STEP = 0.5
"""Part of the interval up to which a variable that comes behind others is no later than they are."""
AHEAD, BEHIND = 2.0, 10.0
"""By how much the stamps of a variable are ahead of those of most others, or behind them, where they are of another
clock, s: for those that are less behind, the map may give a delay that waits for them."""
TOLD_AT, TOLD_AFTER = 3, 5.0
"""Changes of another clock of a variable after which this is told; and time after the first of them, s."""
VOTES = 3.0
"""Intervals of most variables for which the stamp of one shows where its clock stands."""
SKIPPED = 1000
"""Stamps at which a silent variable may have to be repeated yet."""


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


@dataclass
class _Offset:
    """The newest stamp of a variable less the time of its arrival, when it arrived, and the interval before that, s."""

    by: float
    arrived: float
    gap: float = math.inf


@dataclass
class _Stray:
    """A variable of another clock: how many changes in a row were so, since when, and by how much, s."""

    since: float
    by: float = 0.0
    count: int = 0
    told: bool = False


class Holding:
    """Makes records of changes, with readings that still hold.

    Parameters
    ----------
    columns : sequence of str
    sampling : float
        Interval in which the server looks at variables, s.
    now : callable
        The time, s since 1970.
    notes : list of str, optional
        Where sentences for the user go.
    """

    def __init__(
        self, columns: Sequence[str], sampling: float, now: Callable[[], float] = clock.time,
        notes: list[str] | None = None,
    ) -> None:  # fmt: skip
        self._columns, self._sampling = list(columns), sampling
        self._held: dict[str, float] = {}
        self._sent: dict[str, float] = {}
        self._shown: dict[str, float] = {}
        self._intervals: dict[str, deque[float]] = {name: deque(maxlen=KEPT) for name in columns}
        self._usual: dict[str, float | None] = dict.fromkeys(columns)
        self._lags: dict[str, deque[float]] = {name: deque(maxlen=KEPT) for name in columns}
        self._skipped: dict[str, deque[float]] = {name: deque(maxlen=SKIPPED) for name in columns}
        self._offsets: dict[str, _Offset] = {}
        self._common = self._newest = math.nan
        self._strays: dict[str, _Stray] = {}
        self._told: set[str] = set()
        self._rests = False
        self.notes: list[str] = [] if notes is None else notes
        self._clock: tuple[float, float] | None = None
        self._reached = -math.inf
        self._first: list[Change] = []
        self._early: list[Sequence[Change]] = []
        self._now = now

    def forget(self) -> None:
        """Hold nothing any more: the connection is lost."""
        self._first.clear()
        self._early.clear()
        self._held.clear()
        self._sent.clear()
        for skipped in self._skipped.values():
            skipped.clear()

    def records(self, changes: Sequence[Change]) -> list[Record]:
        """Records of changes of one stamp, or of the first ones of a subscription: these wait for the next to come."""
        if changes[0].first and self._clock is None:
            self._first += changes
            return []
        found = []
        time = max(one.time for one in changes)
        apart = not changes[0].first and self._is_apart(time, changes)
        if self._first:
            self._early.append(changes)
            waited = changes[0].arrived - self._first[0].arrived
            # One clock may be wrong: half of the variables show it.
            return self._shown_clock() if 2 * len(self._offsets) >= len(self._columns) or waited > WAIT else []
        if apart:
            self._tell_apart(time, changes)
            return []
        if changes[0].first and self._clock is not None:
            # What stood still while the connection was lost has the stamp of long ago, and holds now.
            # And none is of a moment to come: such a stamp is of another clock.
            now = self._clock[0] + changes[0].arrived - self._clock[1]
            time = now if time > now + AHEAD else max(time, now)
        elif self._clock is not None and time < self._clock[0] + changes[0].arrived - self._clock[1] + SET:
            # All held until this change.
            found += self._still(time - 0.5 * self.interval)
        return [*found, *self._recorded(time, changes)]

    def _shown_clock(self) -> list[Record]:
        """Records of first readings and of changes since: now it is known what the source's clock shows."""
        early, self._early = self._early, []
        then, stamp = self._common + self._first[0].arrived, max(one.time for one in self._first)
        found = self._begin(stamp if abs(then - stamp) < OLD else then)
        for changes in early:
            found += self.records(changes)
        return found

    def _begin(self, time: float) -> list[Record]:
        changes, self._first = self._first, []
        return self._recorded(time, changes)

    def _is_apart(self, time: float, changes: Sequence[Change]) -> bool:
        """Whether changes are of another clock than those of most variables; learns where the clock of these stands."""
        arrived = changes[0].arrived
        for one in changes:
            last = self._offsets.get(one.column)
            gap = arrived - last.arrived if last else math.inf
            self._offsets[one.column] = _Offset(time - arrived, arrived, gap)
        recent = self._recent(arrived)
        # Of two the one behind, as rows of a stamp far ahead are of no use to anyone; unless it may only come later.
        before, low, high = self._common, recent[(len(recent) - 1) // 2], recent[len(recent) // 2]
        self._common = high if high - low <= BEHIND else low
        if abs(self._common - before) > SET:
            self._newest, self._reached, self._clock = math.nan, -math.inf, None
            for lags in self._lags.values():
                lags.clear()
            for column in [name for name in self._strays if not self._is_off(self._offsets[name].by)]:
                del self._strays[column]
        apart = self._is_off(time - arrived)
        if not apart:
            for one in changes:
                self._strays.pop(one.column, None)
        return apart

    def _is_off(self, offset: float) -> bool:
        """Whether a stamp less the time of its arrival, s, is of another clock than that of most variables."""
        return not -BEHIND <= offset - self._common <= AHEAD

    def _recent(self, now: float) -> list[float]:
        """Offsets that show where clocks stand now, in order, s: those of the last few intervals of most variables.

        Of a variable that has come once only, the interval is as long as it has been silent.
        """
        gaps = sorted(min(one.gap, max(now - one.arrived, UNTOLD)) for one in self._offsets.values())
        usual = min(gaps[len(gaps) // 2], LONGEST)
        span = max(UNTOLD, VOTES * usual)
        return sorted(one.by for one in self._offsets.values() if now - one.arrived <= span)

    def _tell_apart(self, time: float, changes: Sequence[Change]) -> None:
        """Leave out stamps of another clock; the newest readings hold until it is told that they are left out."""
        arrived = changes[0].arrived
        for one in changes:
            stray = self._strays.setdefault(one.column, _Stray(arrived))
            stray.by, stray.count = time - arrived - self._common, stray.count + 1
            if one.column in self._held and not stray.told:
                self._held[one.column] = one.value
        self._tell_strays(arrived)

    def _tell_strays(self, now: float) -> None:
        """Tell of each variable of another clock that does not come to its senses, and hold it no more."""
        for column, stray in self._strays.items():
            if stray.told or (stray.count < TOLD_AT and now - stray.since < TOLD_AFTER):
                continue
            stray.told = True
            self._held.pop(column, None)
            if column in self._told:
                continue
            self._told.add(column)
            where = f"{duration_said(abs(stray.by))} {'ahead of' if stray.by > 0.0 else 'behind'}"
            self.notes.append(
                f"the stamps of {column} are {where} those of the other variables: its readings "
                "are left out. Let one clock give the stamps of all variables"
            )

    def _recorded(self, time: float, changes: Sequence[Change]) -> list[Record]:
        """The record of changes, behind those of stamps at which they are known by now to have held."""
        found, arrived = [], changes[0].arrived
        self._rests = self._rests and changes[0].first
        values = dict.fromkeys(self._columns, math.nan)
        for one in changes:
            if one.column in self._held:
                found += self._made_up_for(one.column, time - 0.5 * self.interval, arrived, silent=False)
            skipped = self._skipped[one.column]
            while skipped and skipped[0] <= time:
                skipped.popleft()
            values[one.column] = self._held[one.column] = one.value
            if not one.first and time > self._sent.get(one.column, math.inf):
                self._intervals[one.column].append(time - self._sent[one.column])
                self._usual[one.column] = _usual(self._intervals[one.column])
            if not one.first and math.isfinite(self._newest):
                self._lags[one.column].append(max(0.0, self._newest - time))
            self._sent[one.column] = self._shown[one.column] = time
        self._newest = max(time, self._newest) if math.isfinite(self._newest) else time
        if self._clock is None or time >= self._clock[0] or changes[0].first:
            self._clock = (time, arrived)
        repeated = self._hold(time, values, {one.column for one in changes})
        for name in repeated:
            found += self._made_up_for(name, time - 0.5 * self.interval, arrived)
            self._shown[name] = time
        self._reached = max(self._reached, time)
        return [*found, Record(time, values, arrived, repeated=frozenset(repeated))]

    def until(self, alive: float) -> list[Record]:
        """Records of what still holds, up to when the server was alive last, by ``time.monotonic()``, s."""
        begun: list[Record] = []
        if self._early and alive - self._first[0].arrived > WAIT:
            begun = self._shown_clock()
        elif self._first and not self._early and alive - self._first[0].arrived > WAIT:
            # Nothing moves: a stamp tells when it stopped, and it stands there now.
            stamp, now = max(one.time for one in self._first), self._now() - clock.monotonic() + self._first[0].arrived
            begun = self._begin(now if 0.0 < now - stamp < DAY else stamp)
            self._rests = True
        self._tell_strays(alive)
        if self._clock is None or not self._held:
            return begun
        # What was measured a little before may be on its way.
        late = max(2.0 * self._sampling, 0.5 * self.interval)
        return begun + self._still(self._clock[0] + alive - self._clock[1] - late)

    def _still(self, last: float) -> list[Record]:
        """Records of what is held, at the interval of what is measured most often, up to a stamp."""
        assert self._clock is not None
        known = self._rests or any(self._usual[name] is not None for name in self._held)
        if not known and last - self._newest < UNTOLD:
            return []
        (time, arrived), step = self._clock, self.interval
        found = []
        while self._reached + step <= last:
            self._reached += step
            values, then = dict.fromkeys(self._columns, math.nan), arrived + self._reached - time
            repeated = self._hold(self._reached, values, None)
            for name in repeated:
                found += self._made_up_for(name, self._reached - 0.5 * step, then)
                self._shown[name] = self._reached
            found.append(Record(self._reached, values, then, repeated=frozenset(repeated)))
        return found

    def _made_up_for(self, column: str, until: float, arrived: float, silent: bool = True) -> list[Record]:
        """Records of stamps at which a variable was not repeated, as it might have come yet, and is known to hold.

        It is `silent`, or has come now, and was silent before if that took longer than it used to.
        """
        skipped, found, interval = self._skipped[column], [], self._pace(column)
        least = AGAIN if silent else SILENT
        while skipped and skipped[0] <= until:
            stamp = skipped.popleft()
            since = stamp - self._shown[column]
            if since > (least if self._shown[column] == self._sent[column] else AGAIN) * interval:
                self._shown[column] = stamp
                values = dict.fromkeys(self._columns, math.nan) | {column: self._held[column]}
                found.append(Record(stamp, values, arrived, repeated=frozenset([column])))
        return found

    @property
    def interval(self) -> float:
        """Interval of the variable that is measured most often, s; that of rest where none is known."""
        return self._shortest() or RESTING

    def _shortest(self) -> float | None:
        return min((one for name in self._held if (one := self._usual[name]) is not None), default=None)

    def _pace(self, column: str) -> float:
        """Interval by which it is told that a variable is silent beside others, s.

        One that is measured far less often than another, or by no clock, is held in each row of that one.
        """
        shortest, usual = self._shortest(), self._usual[column]
        if shortest is None or (usual is None and shortest > SHORT):
            return self._sampling
        return usual if usual is not None and usual <= max(SHORT, APART * shortest) else shortest

    def _lag(self, column: str) -> float:
        """How far the stamps of a variable run behind the newest one when they come, s; 0 where it is in step."""
        lags = sorted(self._lags[column])
        late = lags[math.ceil(MOSTLY * (len(lags) - 1))] if lags else 0.0
        return late if late > IN_STEP * self.interval else 0.0

    def _hold(self, time: float, values: dict[str, float], new: set[str] | None) -> list[str]:
        """Repeat what was not sent for longer than it takes; `new` was sent, None where all are silent. Gives names."""
        repeated = []
        for column, value in self._held.items():
            if new is not None and column in new:
                continue
            interval, lag = self._pace(column), self._lag(column)
            since, sent = time - self._shown[column], self._shown[column] == self._sent[column]
            if since > (SILENT if new is not None and sent else AGAIN) * interval + (lag if sent else 0.0):
                values[column] = value
                repeated.append(column)
            elif lag > 0.0 and since > 0.0:
                self._skipped[column].append(time)
        return repeated


def _usual(intervals: Collection[float]) -> float | None:
    """Interval in which a variable is measured, s, from those between its changes; None where these do not tell."""
    if len(intervals) < FEW:
        return None
    low, middle, high = _quartiles(sorted(intervals))
    regular = REGULAR if len(intervals) >= ENOUGH and middle <= SHORT else ALIKE
    return middle if high <= regular * low and middle <= LONGEST else None


def _quartiles(values: Sequence[float]) -> list[float]:
    """Quartiles of values in order, on lines between them; in plain floats, as they are few and come often."""
    found = []
    for quarter in (1, 2, 3):
        below, part = divmod(quarter * (len(values) - 1), 4)
        step = values[min(below + 1, len(values) - 1)] - values[below]
        found.append(values[below] + 0.25 * part * step)
    return found
