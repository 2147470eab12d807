"""Rows of data in the order of their stamps: what is late, doubled, out of order or from the future is put right here.

A row is handed on when all rows that may still come before it have come: a *delay* after its stamp. The delay is also
what lets the inputs be smoothed from both sides (:mod:`tautline.twin.signals.smoothing`).

| what comes | what becomes of it |
|---|---|
| a stamp that was there | its values fill what was empty; it is counted where a column came twice |
| a repeated reading, and the true one after it, a small part of the sample interval apart | the true one counts |
| out of order, within the delay | it is put in its place |
| later than the delay | it is left out, and counted |
| a stamp far ahead | it waits for the next row: if that goes on from it there was a gap, else it is left out |
| such a stamp, and no row behind it for now | a gap if as much time has gone by, or rows do not come as measured |
| stamps that go on from an earlier time | the clock was set back: time goes on from where it was |
| rows that were answered, from a stream that a later process begins to read some rows back | they are left out |
| columns in rows of their own, a small part of the sample interval apart | they are one row, of the first stamp |
| no readable stamp | it is left out, and counted |
| a reading beyond 1e30 | it counts as missing, and the row is counted |
| -999, -999.25, -9999 or -9999.25, written for none | it counts as missing where the sensor cannot show it; counted |
"""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter, deque
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, pairwise, takewhile
from typing import Any

import numpy as np

from tautline.scene.reading.nulls import NEAR, written_for_none
from tautline.scene.values.moments import duration_said
from tautline.twin.pace import AT_ONCE, LONG_GAP, ONE_STAMP, TOLD_BY
from tautline.twin.signals.arrivals import TYPICAL, Arrivals
from tautline.twin.signals.doubles import Doubles
from tautline.twin.signals.row import Row
from tautline.twin.signals.spacing import DELAY, SHOWN_IN, Spacing

REGULAR_GAPS, EQUAL = 5, 1.5
"""Gaps in a row that are the sample interval, as the longest of them is no more than so many times the shortest."""
FAR = 4.0
"""Stamps further ahead than so many sample intervals wait for the next."""
SEVERAL = 2.5
"""Sample intervals that are no long gap however long each is: a row may be lost."""
BACK = 5
"""Rows in a row that are late and follow one another: the clock was set back."""
INTERVALS = 51
"""Intervals of which the median is the sample interval."""
BEHIND = 10
"""Late rows of a column after which this is told; another column has as many that are in time, without a late one."""
OFTEN = 0.4
"""Share of the last rows of a column that are late, from which on this is told."""
AHEAD = 10
"""Rows of a column in a row from far ahead, after which this is told."""
BEHIND_FOR = 5.0
"""Time between late rows of a column, without one in time between, after which this is told, s."""
LONGEST_DELAY = 10.0
"""Longest delay that is of use to a twin, s."""
SPARE = 1.5
"""Sample intervals that a delay is to be longer than what it waits for."""
JOINED = 0.1
"""Part of the sample interval within which rows that have no column in common are one."""
KEPT, MOST_KEPT = 60.0, 3000
"""For how long, s, rows that were answered are known again by a later process; and how many of them at most."""
MOST_ASIDE = 100_000
"""Rows from before those that are known again that wait until it is known what they are."""

ABSURD = 1.0e30
"""Reading from which one is none: what other programs write for a missing value is one (9.97e36, 3.4e38)."""


@dataclass
class Rows:
    """Rows as they come, and in order.

    Parameters
    ----------
    columns : sequence of str
        In the order of the values.
    delay : float or None
        s; None for three sample intervals, of the rarest input where that comes more rarely.
    live : bool
        Whether rows arrive while they are measured, so that the source's clock can be compared with ours.

    Attributes
    ----------
    counts : Counter
        What was put right, by kind: late, doubled, out of order, future, no stamp, gaps, clock set back, and rows
        with an absurd reading or one that stands for none, which count as missing.
    bounds : sequence of (float, float)
        What each column can show, in its unit: by its range in the map, else infinite.
    scales : (c,)
        How many SI units one of a column is: what is absurd is so in either.
    factors : mapping of str to float
        What the source has multiplied the readings of a column by, where it gives them in another unit than the map:
        what stands for none is told by what was written.
    interval : float
        The sample interval, s; NaN until it is known.
    wanted : float
        How long rows are to wait at least where the map gives no delay, s: what noisy inputs are smoothed over.
    fewest : int
        Rows that are to be there before the first is handed on: they show the noise of inputs.
    newest : float
        Largest time of a row so far, s; minus infinity before the first.
    taken : int
        Records that this process has taken as rows, or as parts of them: others tell nothing of the machine.
    place : int
        Place of the next record among all that the source gives, from zero.
    """

    MADE_ANEW = (
        "columns", "delay", "live", "notes", "bounds", "scales", "factors", "fewest", "arrivals",
        "_came_first", "doubles", "taken",
    )  # fmt: skip
    """What another process has by itself: times of arrival are of one computer's clock."""

    columns: Sequence[str]
    delay: float | None = None
    live: bool = False
    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.shift, self.place, self.taken = 0.0, 0, 0
        self.bounds: Sequence[tuple[float, float]] = [(-np.inf, np.inf)] * len(self.columns)
        self.scales = np.ones(len(self.columns))
        self.factors: Mapping[str, float] = {}
        self._lowest = np.full(len(self.columns), np.inf)
        self._seen = np.full(len(self.columns), np.nan)
        self._last_shown = np.ones(len(self.columns), bool)
        self.waiting: list[Row] = []
        self.past: deque[Row] = deque()
        self.answered: deque[tuple[float, np.ndarray]] = deque(maxlen=MOST_KEPT)
        self._running_up, self._came_first = False, (np.nan, np.nan)
        self._aside: list[Row] = []
        self._taken_back: deque[Row] = deque()
        self.reached = -np.inf
        self.newest = self._newest_sent = -np.inf
        self._suspect: Row | None = None
        self._late: list[Row] = []
        self.doubles = Doubles(self.notes)
        # By how much the last rows of each column came too late, s; zero for those that did not.
        self._behind: list[deque[float]] = [deque(maxlen=INTERVALS) for _ in self.columns]
        self._ahead: list[list[float]] = [[] for _ in self.columns]
        self._in_time = np.zeros(len(self.columns), int)  # rows of each column in time, without a late one
        self._behind_told = self._ahead_told = False
        self._behind_since = np.full(len(self.columns), np.nan)  # first of the late rows of each column in a row
        self._intervals: deque[float] = deque(maxlen=INTERVALS)
        # Those of rows with repeated readings only: they serve until others are known.
        self._repeats: deque[float] = deque(maxlen=INTERVALS)
        self._gaps: deque[float] = deque(maxlen=REGULAR_GAPS)
        self.arrivals, self.spacing = Arrivals(), Spacing(len(self.columns))
        self.known_interval = np.nan
        self.wanted, self.fewest = 0.0, 1
        self._kept: list[tuple[Row, np.ndarray]] = []

    @property
    def interval(self) -> float:
        """The sample interval, s."""
        return self.known_interval

    @property
    def patience(self) -> float:
        """How long a row waits for others, s."""
        return max(self.smoothed, self.spacing.waited(self.interval)) if self.delay is None else self.delay

    @property
    def smoothed(self) -> float:
        """How long it waits for what is as frequent as rows, so that it can be smoothed, where no delay is given, s."""
        return max(DELAY * self.interval, self.wanted) if np.isfinite(self.interval) else np.inf

    @property
    def judged_in(self) -> float:
        """How long it may take until late rows are enough to show whether the clock was set back, s; 0 without any."""
        return (BACK + 1) * self.interval if self._late else 0.0

    def add(
        self, time: float, values: Mapping[str, float], arrived: float = 0.0, repeated: Collection[str] = ()
    ) -> None:
        """Take a record of the source; `repeated` are columns whose readings were not measured at this stamp."""
        place, self.place = self.place, self.place + 1
        if not np.isfinite(time):
            self.counts["no stamp"] += 1
            return
        read = np.array([values.get(c, np.nan) for c in self.columns], float)
        absurd = np.abs(read) * np.maximum(self.scales, 1.0) >= ABSURD
        read[absurd] = np.nan
        null = self._nulls(read)
        read[null] = np.nan
        if self._kept and self._is_kept(time, read, place):
            return
        for kind, some in (("an absurd reading", absurd), ("a reading that stands for none (-999.25)", null)):
            if some.any():
                self.counts[f"with {kind}"] += 1
        row = Row(time, read, arrived, places=[place], repeated=np.array([one in repeated for one in self.columns]))
        if self._taken_back:
            self._taken_back.append(row)  # those before it are not put in their place yet
        else:
            self._take(row)

    def _is_kept(self, time: float, read: np.ndarray, place: int) -> bool:
        """Whether a record was taken by an earlier process already, which kept it with the state.

        A file gives it once more, with its place, and so does a stream that repeats its last rows.
        """
        shown = np.isfinite(read)
        for row, values in self._kept:
            within = JOINED * self.interval if row.joined else 0.0
            if abs(time - row.stamp) > within + ONE_STAMP:
                continue
            if place in row.places or np.array_equal(read[shown], values[shown]):
                if self._running_up:
                    self._running_up = False
                    self._leave_out()
                return True
        if time + self.shift > self.reached + KEPT:
            self._kept.clear()
        return False

    def gone_on(self, arrived: float) -> None:
        """Take notice that what is here was taken by an earlier process: a source may give it once more.

        Parameters
        ----------
        arrived : float
            This computer's clock now, s.
        """
        rows = [*self.waiting, *self._late, *self._aside, *self._taken_back]
        rows += [self._suspect] if self._suspect is not None else []
        self._kept = [(row, row.values.copy()) for row in rows]
        if self.live:
            for row in rows:
                row.arrived = arrived
        self._running_up = self.live

    def _take(self, row: Row) -> None:
        """Put a row in its place, or keep it until it is known what it is."""
        row.time = row.stamp + self.shift
        if self._suspect is not None:
            self._resolve(row)
        if row.measured.any():
            self.doubles.come(row.time, self.newest, self.interval)
        if self._is_too_late(row):
            if row.repeated.any() and not row.measured.any():
                return  # nothing is lost by it
            if row.new or not self._is_repeated(row):
                self._add_late(row)
            return
        if row.time - self.newest > self._far and np.isfinite(self.newest):
            self._suspect = row  # it may be no row of now: what a stream repeats has not ended yet
            return
        self._doubt_first(row)
        self._running_up = False
        self._leave_out()
        self._late.clear()
        measured = row.measured
        self._in_time[measured] += 1
        self._behind_since[measured] = np.nan
        if measured.any() and np.isfinite(self.interval):
            self._gaps.clear()
        for i in np.flatnonzero(measured).tolist():
            self._behind[i].append(0.0)
            self._ahead[i].clear()
        self._insert(row)

    def _is_too_late(self, row: Row) -> bool:
        """Whether what a row belongs to was handed on: a row of its stamp, or one that repeats what it measured."""
        if row.time <= self.reached + ONE_STAMP:
            return True
        if not self.past or not np.isfinite(self.interval):
            return False
        repeats = bool((self.past[-1].repeated & row.measured).any())
        return repeats and row.time - self.past[-1].time <= JOINED * self.interval

    def _compare_columns(self, row: Row) -> None:
        """Tell once where rows of some columns are late and those of others are not, and what helps."""
        measured = row.measured
        self._in_time[measured] = 0
        self._behind_since[measured] = np.fmin(self._behind_since[measured], row.time)
        for i in np.flatnonzero(measured).tolist():
            self._behind[i].append(self.newest - row.time)
        if self._behind_told:
            return
        often = [sum(by > 0.0 for by in one) for one in self._behind]
        late = [i for i, n in enumerate(often) if n >= BEHIND and n >= OFTEN * len(self._behind[i])]
        late = late or np.flatnonzero(measured & (row.time - self._behind_since >= BEHIND_FOR)).tolist()
        others = np.flatnonzero(self._in_time >= BEHIND).tolist()
        if not late or not (others or row.time > self._newest_sent):
            return
        self._behind_told = True
        often_late = [i for i, n in enumerate(often) if n >= BEHIND - 1 and n >= OFTEN * len(self._behind[i])]
        late = sorted({*late, *often_late})
        behind = [by for i in late for by in self._behind[i] if by > 0.0]
        longer = max(behind) + SPARE * (self.interval if np.isfinite(self.interval) else 0.0)
        names, beside = (", ".join(self.columns[i] for i in some) for some in (late, others))
        beside = beside or "rows that repeat what held meanwhile"
        cure = "Let one clock give the stamps of all columns. A message without a stamp has the time of its arrival"
        if longer <= LONGEST_DELAY:
            cure += (
                ". If the stamps are right, and these readings only come later, write "
                f"`delay: {np.ceil(10.0 * longer) / 10.0:.1f} s` in the map"
            )
        by = duration_said(float(np.median(behind)))
        self.notes.append(
            f"the stamps of {names} are {by} behind those of {beside}: rows with them come too late and are left out. "
            f"{cure}"
        )

    def _compare_ahead(self, row: Row) -> None:
        """Tell once where rows of some columns are from far ahead, and those of others are not: their clocks differ."""
        for i in np.flatnonzero(row.measured).tolist():
            self._ahead[i].append(row.time - self.newest)
        ahead = [i for i, one in enumerate(self._ahead) if len(one) >= AHEAD]
        others = [i for i in np.flatnonzero(self._in_time >= AHEAD).tolist() if not self._ahead[i]]
        if self._ahead_told or not ahead or not others:
            return
        self._ahead_told = True
        by = float(np.median(np.concatenate([self._ahead[i] for i in ahead])))
        names, beside = (", ".join(self.columns[i] for i in some) for some in (ahead, others))
        self.notes.append(
            f"the stamps of {names} are {duration_said(by)} ahead of those of {beside}: rows with them are left out. "
            "Let one clock give the stamps of all columns"
        )

    def _nulls(self, read: np.ndarray) -> np.ndarray:
        """Which readings (c,) stand for none: what the sensor can show by its range, or has come near to, does not."""
        factors = np.array([self.factors.get(one, 1.0) for one in self.columns])
        null = written_for_none(read, factors)
        for i in np.flatnonzero(null).tolist():
            low, high = self.bounds[i]
            known = np.isfinite(low) or np.isfinite(high)
            null[i] = not (low <= read[i] <= high if known else self._lowest[i] < NEAR * read[i])
        self._lowest = np.fmin(self._lowest, np.where(null, np.inf, read))
        return null

    @property
    def _far(self) -> float:
        interval = self.interval
        # What is repeated until something is measured does not tell how far apart measurements are.
        if self._repeats or not np.isfinite(interval):
            return LONG_GAP
        return min(FAR * interval, max(LONG_GAP, SEVERAL * interval))

    def _doubt_first(self, row: Row) -> None:
        """Let the first row wait as one from far ahead, where the second comes long before it."""
        if self.reached == -np.inf and len(self.waiting) == 1 and self.waiting[0].time - row.time > self._far:
            self._suspect = self.waiting.pop()
            self.newest = self._newest_sent = -np.inf
            self._seen[:], self._last_shown[:] = np.nan, True

    def _resolve(self, row: Row) -> None:
        """A row that came from far ahead: time has gone by if the next goes on from it."""
        suspect, self._suspect = self._suspect, None
        assert suspect is not None
        if row.time >= suspect.time:
            self._go_far(suspect, [row.time - suspect.time])
        else:
            self._leave_out_ahead(suspect)

    def _leave_out_ahead(self, row: Row) -> None:
        self.counts["future"] += 1
        self._compare_ahead(row)

    def _go_far(self, row: Row, then: Sequence[float] = ()) -> None:
        """Insert a row from far ahead: behind a gap, unless steps as long as that are known to repeat.

        `then` is the step behind it, where that is known.
        """
        self._gaps.append(row.time - self.newest)
        unknown = not np.isfinite(self.interval)
        steps = [*self._gaps, *then][-2:] if unknown else list(self._gaps)
        alike = len(steps) == (2 if unknown else REGULAR_GAPS) and max(steps) <= EQUAL * min(steps)
        if not (alike and unknown):
            self._put_behind_gap(row)
        if alike and unknown:
            self.known_interval = float(np.median(steps))
        self._insert(row)
        if alike and not unknown:
            # No gaps: what is measured comes less often than before.
            self._intervals.clear()
            self._intervals.extend(self._gaps)
            self.known_interval = float(np.median(self._gaps))
            self._gaps.clear()

    def _put_behind_gap(self, row: Row) -> None:
        row.after_gap = True
        self.counts["gaps"] += 1

    def _is_repeated(self, row: Row) -> bool:
        """Whether a row of a stream that is gone on with is none to go on with now: one that it repeats is left out.

        Such as the last lines of a log, with which a program that follows it begins. Rows from before those that are
        known again wait for one that shows it: a row that was answered, or one that comes later than all of them. A
        row among those that differs is of a clock that was set back, and so are rows that come as they are measured.
        """
        if not self._running_up:
            return False
        if not np.isfinite(self._came_first[0]):
            self._came_first = row.time, row.arrived
        stamps, passed = row.time - self._came_first[0], row.arrived - self._came_first[1]
        if passed >= TOLD_BY and stamps <= AT_ONCE * passed:
            self._running_up = False
        elif self._was_answered(row):
            self.counts["doubled"] += 1
            self._leave_out()
            self._late.clear()  # a row that is known again between late ones shows that the clock is the same
            return True
        elif not self.answered or row.time < self.answered[0][0] - ONE_STAMP:
            if len(self._aside) < MOST_ASIDE:
                self._aside.append(row)
            else:
                self.counts["late"] += 1
            return True
        if not self._aside:
            return False
        # One by one, as they are answered: all at once each would be looked for among all others.
        self._taken_back.extend((*self._aside, row))
        for one in self._taken_back:
            one.new = True
        self._aside.clear()
        return True

    def _leave_out(self) -> None:
        """Rows that waited are repeated."""
        if self._aside:
            self.counts["late"] += len(self._aside)
            self._aside.clear()

    def _was_answered(self, row: Row) -> bool:
        """Whether there was a row of that stamp with the same readings; its columns may have come one by one."""
        shown = np.isfinite(row.raw)
        within = 0.0 if shown.all() or not np.isfinite(self.interval) else JOINED * self.interval
        first = bisect_left(self.answered, row.time - within - ONE_STAMP, key=lambda one: one[0])
        for time, values in islice(self.answered, first, None):
            if time > row.time + ONE_STAMP:
                return False
            if np.array_equal(values[shown], row.raw[shown]):
                return True
        return False

    def _add_late(self, row: Row) -> None:
        """A row that is too late, unless the clock was set back."""
        known = next((one for one in reversed(self.past) if abs(one.time - row.time) <= ONE_STAMP), None)
        if known is not None and np.array_equal(known.raw, row.raw, equal_nan=True):
            self.counts["doubled"] += 1
            return
        if known is not None:
            self._compare(np.where(known.repeated, np.nan, known.raw), row)
        self.counts["late"] += 1
        self._compare_columns(row)
        if row.time > self._newest_sent:
            return  # nothing has gone back: only what was repeated meanwhile is newer
        if self._late and not row.time > self._late[-1].time:
            self._late.clear()
        self._late.append(row)
        if len(self._late) < BACK:
            return
        rows, self._late = self._late, []
        if self._were_late(rows):
            return
        self._behind_since[:] = np.nan
        step = self.interval if np.isfinite(self.interval) else rows[-1].time - rows[-2].time
        back = max(self.newest, self.reached) + step - rows[0].time
        self.shift += back
        self.counts["late"] -= BACK
        self.counts["clock set back"] += 1
        self.doubles.was_set_back()
        self.notes.append(f"the source's clock was set back by {back:.3g} s; time goes on from where it was")
        for one in rows:
            one.time += back
            one.after_gap = one is rows[0]
            self._insert(one)

    def _were_late(self, rows: Sequence[Row]) -> bool:
        """Whether rows are of columns that came late before, as others were in time: no clock was set back then."""
        columns = np.any([one.measured for one in rows], axis=0)
        known = bool((self._behind_since[columns] < rows[0].time - ONE_STAMP).all())
        return known and self.newest - rows[0].time <= LONGEST_DELAY

    def _compare(self, known: np.ndarray, row: Row) -> None:
        """Take notice where rows of one stamp have different readings (c,): they are not one row that came twice."""
        both = np.isfinite(known) & row.measured
        if not np.array_equal(known[both], row.values[both]):
            self.doubles.differ(row.time - self.shift)

    def _insert(self, row: Row) -> None:
        self._correct(row)
        self.spacing.take(row.time, row.values, self.newest)
        self._newest_sent = max(self._newest_sent, row.time) if row.measured.any() else self._newest_sent
        # What is behind others came later than they did, and what is repeated was never sent.
        if self.live and row.measured.any() and row.time > self.newest:
            told = self.arrivals.take(row.stamp, row.arrived, row.after_gap)
            self.notes += [told] if told else []
        k = bisect_left(self.waiting, row.time - ONE_STAMP, key=lambda one: one.time)
        if k < len(self.waiting) and self.waiting[k].time - row.time <= ONE_STAMP:
            known = self.waiting[k]
            if (row.measured & known.measured).any():
                self.counts["doubled"] += 1
            self._compare(np.where(known.repeated, np.nan, known.values), row)
            known.places += row.places
            self.taken += bool((row.measured & ~known.measured).any())
            known.fill(row)
            return
        if self._join(row, k):
            return
        limit = self._far
        if k < len(self.waiting):
            self.counts["out of order"] += 1
        elif self._learn_interval(row) and self._join(row, len(self.waiting)):
            return
        self.waiting.insert(min(k, len(self.waiting)), row)
        self.taken += 1
        self.newest = max(self.newest, row.time)
        near = self.waiting[max(k - 1, 0) : k + 2]
        if max(LONG_GAP, self._far) < limit:  # rows come faster than it seemed by their first steps: these were gaps
            near = [*list(self.past)[-1:], *self.waiting]
        for before, one in pairwise(near):
            if not one.after_gap and one.time - before.time > max(LONG_GAP, self._far):
                self._put_behind_gap(one)  # or it came before those of long ago

    def _correct(self, row: Row) -> None:
        """Repeat what is measured at a row in later ones that wait: they repeat what held before it was known."""
        if not self.waiting or self.waiting[-1].time <= row.time + ONE_STAMP:
            return
        columns = row.measured
        for one in self.waiting[bisect_left(self.waiting, row.time + ONE_STAMP, key=lambda one: one.time) :]:
            columns = columns & ~one.measured
            if not columns.any():
                return
            stale = columns & one.repeated & np.isfinite(one.values)
            one.values[stale] = row.values[stale]
            one.raw[stale] = row.raw[stale]

    def _learn_interval(self, row: Row) -> bool:
        """Learn the sample interval from a row that is the newest, and whether it is known by that for the first time.

        Of columns that come in rows of their own it is that of a column. What waited is joined then.
        """
        shown = np.isfinite(row.values)
        unknown = not np.isfinite(self.interval)
        if np.isfinite(self.newest) and not row.after_gap:
            if shown.any() and not row.measured.any():
                if len(self._intervals) < TYPICAL - 1:
                    self._repeats.append(row.time - self.newest)
            elif (shown & self._last_shown).any() or not shown.any() or not self._last_shown.any():
                self._intervals.append(row.time - self.newest)
            else:
                steps = row.time - self._seen[shown]
                self._intervals.extend(steps[np.isfinite(steps)].tolist())
            if len(self._intervals) >= TYPICAL - 1:
                self._repeats.clear()
                self.known_interval = float(np.median(self._intervals))
            elif len(self._repeats) >= TYPICAL - 1:
                self.known_interval = float(np.median(self._repeats))
        self._seen[shown], self._last_shown = row.time, shown
        found = unknown and bool(np.isfinite(self.interval))
        if found:
            waiting, self.waiting = self.waiting, []
            for one in waiting:
                if not self._join(one, len(self.waiting)):
                    self.waiting.append(one)
        return found

    def _join(self, row: Row, k: int) -> bool:
        """Let a row be part of the one beside its place k, where they are close and have no column in common."""
        shown = np.isfinite(row.values)
        if not shown.any() or not np.isfinite(self.interval):
            return False
        for one in self.waiting[max(k - 1, 0) : k + 1]:
            if abs(one.time - row.time) > JOINED * self.interval or row.after_gap:
                continue
            # A reading that is repeated in the one is none beside what is measured in the other.
            apart = not (row.measured & one.measured).any() and (row.measured.any() or one.measured.any())
            if apart or not (shown & np.isfinite(one.values)).any():
                if row.measured.any() and not one.measured.any():
                    # Only what was sent knows its stamp.
                    one.time, one.stamp, one.arrived = row.time, row.stamp, row.arrived
                    self.newest = max(self.newest, row.time)
                one.fill(row)
                one.places = one.places + row.places
                one.raw, one.joined = one.values.copy(), True
                self.taken += 1
                self._seen[shown] = row.time
                return True
            if one.joined and np.array_equal(one.raw[shown], row.raw[shown]):  # a message that came twice
                self.counts["doubled"] += 1
                return True
        return False

    def ready(self, end: bool = False, silent: bool = False) -> Row | None:
        """The next row that no other can come before.

        With `silent`, as none comes now, nothing more is waited for; with `end` none comes any more.
        """
        if end:
            self.doubles.end()
        if end and self._aside:
            count = len(self._aside)
            rows, them = ("1 row is", "It is") if count == 1 else (f"{count} rows are", "They are")
            self.notes.append(
                f"{rows} from before all that were answered in the last minute, and the source ended before it showed "
                f"whether its clock was set back. {them} left out"
            )
            self._leave_out()
        while (row := self._next(end, silent)) is None and self._taken_back:
            self._take(self._taken_back.popleft())
        return row

    def _next(self, end: bool, silent: bool) -> Row | None:
        """The next row in order, of which nothing more is waited for at the end or in a silence."""
        at_once = (end or silent) and not self._taken_back
        if at_once:
            self._settle_suspect(end)
        if not self.waiting:
            return None
        if self.reached == -np.inf and not at_once and self._shows_too_little:
            return None
        row = self.waiting[0]
        behind = self._suspect is not None or any(one.after_gap for one in self.waiting[1:])
        if not (at_once or behind or self.newest - row.time >= self.patience - ONE_STAMP):
            return None
        if self.live and row.after_gap:
            together = [row, *takewhile(lambda one: not one.after_gap, self.waiting[1:])]
            row.begins = self.arrivals.begin_now(together, silent and not end)
        elif self.live and self.arrivals.begin_late(row):
            row.begins = row.after_gap = True  # those before it do not go with it
        self.waiting.pop(0)
        self.past.append(row)
        self.reached = row.time
        self.answered.append((row.time, row.values.copy()))
        while self.answered[0][0] < row.time - KEPT:
            self.answered.popleft()
        keep = row.time - 10.0 * (self.patience if np.isfinite(self.patience) else 1.0)
        while len(self.past) > 8 and self.past[0].time < keep:
            self.past.popleft()
        return row

    def _settle_suspect(self, end: bool) -> None:
        """Take a row from far ahead where none comes behind it now, as time may have gone by; unless it shows itself to
        be false as of now: then it waits on, and is left out at the end."""
        suspect = self._suspect
        if suspect is None:
            return
        ahead = self.live and self.arrivals.runs_ahead(suspect)
        if ahead and not end:
            return
        self._suspect = None
        if ahead:
            self._leave_out_ahead(suspect)
        else:
            self._go_far(suspect)

    @property
    def _shows_too_little(self) -> bool:
        """Whether more rows are waited for before the first is handed on, where the map leaves that open."""
        span, few = self.newest - self.waiting[0].time, len(self.waiting) < self.fewest
        return self.delay is None and ((few and span < SHOWN_IN) or self.spacing.shows_too_little(span))

    def around(self, row: Row) -> list[Row]:
        """Rows on both sides of one that was handed on last, in order, without a gap between them."""
        rows = [*self.past, *self.waiting]
        i = rows.index(row)
        first = i
        while first > 0 and not rows[first].after_gap:
            first -= 1
        last = i
        while last + 1 < len(rows) and not rows[last + 1].after_gap:
            last += 1
        return rows[first : last + 1]

    @property
    def held(self) -> list[int]:
        """Places of the records that were taken and not yet handed on."""
        suspect = [self._suspect] if self._suspect is not None else []
        return sorted(place for row in (*self.waiting, *self._late, *suspect) for place in row.places)

    # -- to be kept over a restart -------------------------------------------------------------------------------------

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {
            "reached": self.reached, "shift": self.shift, "interval": self.interval, "counts": dict(self.counts),
            "answered": [[time, *values.tolist()] for time, values in self.answered],
        }  # fmt: skip

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self.reached = self.newest = self._newest_sent = float(memory["reached"])
        self.shift, self.known_interval = float(memory["shift"]), float(memory["interval"])
        self.counts.update(memory["counts"])
        # States of earlier versions do not say which rows were answered.
        self.answered.extend((float(time), np.array(values, float)) for time, *values in memory.get("answered", ()))
        # What is new of a file is counted, and its rows do not arrive.
        self._running_up = self.live
        self.arrivals.go_on()
