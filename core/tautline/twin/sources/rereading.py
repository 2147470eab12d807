"""Which records are new of a file that is read once more from its begin, where a twin goes on from a state.

Their stamps do not tell it: a clock may have been set back meanwhile, and a stamp may be false, such as 4294967.295. So
records are counted. A state has how many were read, the places of those that were read and not yet answered, and the
last one that was read. Where that one is no more in its place the file has lost rows, and stamps tell what is new.

Two rows from far ahead, one behind the other, are believed to come after a gap. In a file every false stamp has true
ones behind it; where the true ones are left out as they are not new, the false ones must be too.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from tautline.twin.sources.record import Record

SHOWN = 50
"""Records at the begin of a file by which it is known again."""
FOLLOWING = 5
"""Records in a row behind the time that is gone on from: they, and what comes then, are new."""

LOST = (
    "the file has lost rows, or some were changed, since the state was saved: "
    "its rows with later stamps are taken as new"
)
LOST_BEFORE = (
    "the file has lost rows, or some were changed, since the state was saved, and its clock was set back before. "
    "As many new rows are left out as were lost"
)


@dataclass(frozen=True)
class Ending:
    """Rows that were answered without others behind them, as their source had ended: when others come, they are anew.

    Attributes
    ----------
    time : float
        Of the last of them, s.
    rows : int
        How many they are.
    """

    time: float
    rows: int

    @classmethod
    def of(cls, memory: Mapping[str, Any]) -> Ending | None:
        """What a state says of them; None where it has none."""
        return cls(float(memory["ended"][0]), int(memory["ended"][1])) if "ended" in memory else None

    def memory(self) -> dict[str, Any]:
        """What is to be saved with a state."""
        return {"ended": [self.time, self.rows]}


class Rereading:
    """Tells which records of a source are new.

    Parameters
    ----------
    memory : mapping
        What `memory` gave when the state was saved; empty for an operation that begins, and for an old state.
    begin : float
        Time from which the operation is gone on with, s; NaN for one that begins.
    shift : float
        What was added to stamps of the source up to then, s: more than zero where its clock was set back.

    Attributes
    ----------
    before : int
        Records that were left out, as they are not new.
    place : int
        Place of the last record that was given by `new`, from zero.
    is_new : bool
        Whether that record was not read before: else the state holds it, as it was not answered for good.
    notes : list of str
        Sentences for the user that were not yet printed.
    """

    def __init__(self, memory: Mapping[str, Any], begin: float, shift: float) -> None:
        self._read, self._held = int(memory.get("read", 0)), frozenset(memory.get("held", ()))
        self._mark, self._shown = int(memory.get("mark", 0)), int(memory.get("shown", 0))
        self._begin, self._shift = begin, shift
        self._newest = float(memory.get("newest", begin))
        self._last: list[int] | None = memory.get("last")
        self._known: bool | None = None if self._read else False
        # Whether rows are in their places: a state of an earlier version has not kept its last record, and is believed.
        self._fits: bool | None = None if self._last else True
        self._waiting: list[tuple[int, Record]] = []
        self._unproven: list[tuple[int, Record]] = []
        self._following = 0
        self.before, self.place, self.notes = 0, -1, list[str]()
        self.is_new = True
        self._come, self._count, self._sum, self._summed = 0, 0, 0, 0
        self._end: tuple[int, Record] | None = None

    def new(self, record: Record) -> Iterator[Record]:
        """Records that are new, up to this one: they wait until it is known whether the file is the same, and whole."""
        place = self._come
        self._come += record.whole  # a half line comes again, and is not counted in a state
        self._recognise(place, record)
        if self._known is None or (self._known and self._fits is None):
            self._keep(place, record)
        elif self._waiting:
            self._waiting.append((place, record))
            yield from self._waited()
        else:
            yield from self._sorted_out(place, record)

    def rest(self) -> Iterator[Record]:
        """Records that are new, of a source that has ended: before it was known, or with fewer rows than were read."""
        self._known, self._fits = bool(self._known), bool(self._fits)
        yield from self._waited()
        yield from self._proven()
        self._count = self._come

    def _recognise(self, place: int, record: Record) -> None:
        """Compare a record with what the state knows of the file."""
        if self._summed < SHOWN and record.whole:
            self._sum, self._summed = sum_of(record, self._sum), self._summed + 1
            if self._known is None and self._summed == self._shown:
                self._known = self._sum == self._mark
        if self._fits is None and self._last is not None and record.whole and place == self._last[0]:
            self._fits = sum_of(record) == self._last[1]

    def _keep(self, place: int, record: Record) -> None:
        """Let a record wait; of old ones, one behind the other, the last will do."""
        if self._known and self._is_old(place, record):
            if math.isnan(record.time):
                self.before += 1
                return
            if self._waiting and self._is_old(*self._waiting[-1]):
                self._waiting.pop()
                self.before += 1
        self._waiting.append((place, record))

    def _is_old(self, place: int, record: Record) -> bool:
        """Whether a record is new neither by its place nor by its stamp."""
        return place < self._read and place not in self._held and not record.time > self._begin

    def _waited(self) -> Iterator[Record]:
        if self._waiting and self._known and not self._fits:
            self.notes.append(LOST_BEFORE if self._shift else LOST)
        waiting, self._waiting = self._waiting, []
        for place, record in waiting:
            yield from self._sorted_out(place, record)

    def _sorted_out(self, place: int, record: Record) -> Iterator[Record]:
        """This record if it is new, behind those that it shows to be new."""
        self._count = place + record.whole
        if record.whole and math.isfinite(record.time):
            self._end = place, record
        # Behind a clock that was set back stamps could not tell what is new.
        if self._known and (self._fits or self._shift != 0.0 or place >= self._read):
            yield from self._proven()
            yield from self._given(place, record, place >= self._read or place in self._held)
        elif math.isnan(self._begin) or self._following >= FOLLOWING or math.isnan(record.time):
            yield from self._given(place, record)
        else:
            yield from self._later(place, record)

    def _later(self, place: int, record: Record) -> Iterator[Record]:
        """New by its stamp: one that was believed when the state was saved, or that others follow."""
        time = record.time + self._shift
        if time <= self._begin:
            self.before += 1 + len(self._unproven)
            self._unproven, self._following = [], 0
            return
        self._following += 1
        if time <= self._newest:
            yield from self._given(place, record)
        else:
            self._unproven.append((place, record))
        if self._following >= FOLLOWING:
            yield from self._proven()

    def _proven(self) -> Iterator[Record]:
        """Those that nothing has come behind that is not new."""
        while self._unproven:
            yield from self._given(*self._unproven.pop(0))

    def _given(self, place: int, record: Record, new: bool = True) -> Iterator[Record]:
        if new:
            self.place = place
            self.is_new = not (self._known and self._fits and place < self._read)
            yield record
        else:
            self.before += 1

    def memory(self, held: list[int], newest: float = math.nan) -> dict[str, Any]:
        """What is to be saved with a state.

        Parameters
        ----------
        held : list of int
            Places of records that were taken and are not answered yet.
        newest : float
            Latest time that a stamp was believed to show, s; NaN for the time from which the operation is gone on with.
        """
        waiting = sorted({*held, *(place for place, record in self._unproven if record.whole)})
        found: dict[str, Any] = {"read": self._count, "held": waiting, "mark": self._sum, "shown": self._summed}
        if self._end is not None:
            found["last"] = [self._end[0], sum_of(self._end[1])]
        if math.isfinite(newest):
            found["newest"] = newest
        return found


def sum_of(record: Record, before: int = 0) -> int:
    """A checksum of a record, behind that of the records before it."""
    return zlib.crc32(struct.pack(f"{1 + len(record.values)}d", record.time, *record.values.values()), before)
