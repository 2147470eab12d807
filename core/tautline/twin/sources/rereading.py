"""Which records are new of a file that is read once more from its begin, where a twin goes on from a state.

Their stamps do not tell it: a clock may have been set back meanwhile. So records are counted. A state has how many were
read, and the places of those that were read and not yet answered.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator, Mapping
from typing import Any

from tautline.twin.sources.record import Record

SHOWN = 50
"""Records at the begin of a file by which it is known again."""
FOLLOWING = 5
"""Records in a row behind the time that is gone on from, in another file: what comes then is new."""


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
    """

    def __init__(self, memory: Mapping[str, Any], begin: float, shift: float) -> None:
        self._read, self._held = int(memory.get("read", 0)), frozenset(memory.get("held", ()))
        self._mark, self._shown = int(memory.get("mark", 0)), int(memory.get("shown", 0))
        self._begin, self._shift = begin, shift
        self._known: bool | None = None if self._read else False
        self._first: list[Record] = []
        self._following = 0
        self.before, self.place = 0, -1
        self._count, self._sum, self._summed = 0, 0, 0

    def new(self, record: Record) -> Iterator[Record]:
        """Records that are new, up to this one: those at the begin wait until it is known whose they are."""
        if self._summed < SHOWN and record.whole:
            self._sum, self._summed = sum_of(record, self._sum), self._summed + 1
        if self._known is None:
            self._first.append(record)
            if self._summed == self._shown:
                self._known = self._sum == self._mark
            if self._known is None:
                return
            waiting, self._first = self._first, []
        else:
            waiting = [record]
        yield from self._sorted_out(waiting)

    def rest(self) -> Iterator[Record]:
        """Records that are new, of a source that has ended before it was known."""
        self._known, waiting, self._first = False, self._first, []
        yield from self._sorted_out(waiting)

    def _sorted_out(self, waiting: list[Record]) -> Iterator[Record]:
        for one in waiting:
            self.place = self._count
            self._count += one.whole  # a half line comes again, and is not counted in a state
            if self._is_new(one):
                yield one
            else:
                self.before += 1

    def _is_new(self, record: Record) -> bool:
        if self._known:
            # A file that has lost rows since is known by its begin. While no clock was set back its stamps count too.
            later = self._shift == 0.0 and record.time > self._begin
            return later or self.place >= self._read or self.place in self._held
        if math.isnan(self._begin) or self._following >= FOLLOWING:
            return True
        later = record.time + self._shift > self._begin
        self._following = self._following + 1 if later else 0
        return later or math.isnan(record.time)

    def memory(self, held: list[int]) -> dict[str, Any]:
        """What is to be saved with a state, where the records at some places are not answered yet."""
        return {"read": self._count, "held": held, "mark": self._sum, "shown": self._summed}


def sum_of(record: Record, before: int) -> int:
    """A checksum of a record, behind that of the records before it."""
    return zlib.crc32(struct.pack(f"{1 + len(record.values)}d", record.time, *record.values.values()), before)
