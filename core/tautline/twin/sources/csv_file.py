"""A CSV file, replayed row by row."""

from __future__ import annotations

import math
import os
import time as clock
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.columns import SEPARATOR_LINE
from tautline.scene.reading.text import LEGACY
from tautline.twin.pace import Pace
from tautline.twin.sources.record import Record, SourceStopped
from tautline.twin.sources.stated_units import Stated
from tautline.twin.sources.strays import Strays
from tautline.twin.sources.table.cells import has_end
from tautline.twin.sources.table.header import Header
from tautline.twin.sources.table.lines import Lines, Row

PATIENT = 0.5
"""Longest sleep while a row is waited for, s."""
KNOWN_BY = 4096
"""Bytes at the begin of a file by which it is seen that another one was written in its place."""


class CsvFile:
    """Replays a file as fast as it is asked for, or at a speed by its stamps. It is read row by row: it may be large.

    Parameters
    ----------
    path : Path
    columns : sequence of str
    time : str
        The column of the stamp; empty for the usual names.
    speed : float or None
        Times real time; None for as fast as possible.
    now, sleep : callable
        The clock.
    units : mapping, optional
        Units by column that the readings are wanted in; those of the header are converted.

    Raises
    ------
    SceneError
        For a file that cannot be read, columns that it does not have, and units of another quantity.
    """

    def __init__(
        self, path: Path, columns: Sequence[str], time: str = "", speed: float | None = None,
        now: Callable[[], float] = clock.monotonic, sleep: Callable[[float], None] = clock.sleep,
        units: Mapping[str, str] | None = None,
    ) -> None:  # fmt: skip
        self.name, self.live, self.again = str(path), speed == 1.0, True
        self.ended, self._number, self._whole = False, 0, True
        self.refused = self.left_out = 0
        self.dropped, self.notes, self.pace = 0, list[str](), Pace()
        self.stated: Stated = {}  # its header comes again
        self._speed, self._now, self._sleep = speed, now, sleep
        try:
            self._file = path.open(encoding="utf-8-sig", errors=LEGACY, newline="")
        except OSError as error:
            cause = (
                "there is no such file" if isinstance(error, FileNotFoundError) else f"cannot be read: {error.strerror}"
            )
            raise SceneError([Problem(str(path), None, "", None, cause, "check the name of --source")]) from None
        self._begin = self._first_bytes(KNOWN_BY)
        self._headed, self._strays = False, Strays(self.name, self.notes)
        self._ready: deque[Record] = deque()
        line = self._line()
        if line is not None and SEPARATOR_LINE.fullmatch(line):  # of a spreadsheet
            line = self._line()
        if line is None:
            self._file.close()
            raise SceneError([Problem(str(path), None, "", None, "is empty", "give a file with a header and rows")])
        if "\0" in line or line.startswith("\u2030HDF"):
            self._file.close()
            if line.startswith(("\xff\xfe", "\xfe\xff")):  # the mark of UTF-16
                raise SceneError([Problem(str(path), None, "", None, "is not UTF-8 text", "save it as UTF-8")])
            cure = "--source wants a CSV file with a header and rows, such as `record` writes"
            raise SceneError([Problem(str(path), None, "", None, "is not a table: it is a binary file", cure)])
        try:
            self._lines = Lines(Header(line, columns, time, str(path), units, self.notes, self._number))
        except SceneError:
            self._file.close()
            raise
        self._headed, self.factors = True, dict(self._lines.header.factors)
        self._stopped: SourceStopped | None = None
        self._replaced = False
        try:
            self._next, self._later = self._taken(), self._taken()
        except SceneError:  # units in the line below the header that cannot be
            self._file.close()
            raise
        self._begun = (self._now(), self._next[0].time if self._next else 0.0)
        self._arrived = self._begun[0]

    def _line(self) -> str | None:
        """The next line that is neither empty nor a comment."""
        for line in self._file:
            self._number += 1
            line, self._whole = line.rstrip("\r\n"), has_end(line)
            if line.strip() and not self._is_remark(line):
                return line
        return None

    def _is_remark(self, line: str) -> bool:
        if not line.lstrip().startswith("#"):
            return self._strays.is_heading(line, self._number)
        return not self._headed or self._lines.is_remark(line)

    def _read(self) -> Record | None:
        while not self._ready and self._stopped is None:
            line = self._line()
            if self._is_another():
                self._stop_reading()
                break
            try:
                if line is None:
                    self._tell_replaced()
                    self._keep(self._lines.rest(), False)  # what comes behind it later may show another thing
                    break
                self._keep(self._lines.rows(line, self._whole, self._number), self._whole)
            except SourceStopped as stop:
                self._stopped = stop
                self._keep(self._lines.rest(), True)
        return self._ready.popleft() if self._ready else None

    def _is_another(self) -> bool:
        """Whether the file was written anew since it was opened: what is read then is no row of either."""
        file = self._file.fileno()
        if os.fstat(file).st_size < os.lseek(file, 0, os.SEEK_CUR):
            return True
        return self._first_bytes(len(self._begin)) != self._begin

    def _first_bytes(self, count: int) -> bytes:
        """Bytes at the begin of the file; it is read on where it was."""
        file = self._file.fileno()
        place = os.lseek(file, 0, os.SEEK_CUR)
        os.lseek(file, 0, os.SEEK_SET)
        found = os.read(file, count)
        os.lseek(file, place, os.SEEK_SET)
        return found

    def _tell_replaced(self) -> None:
        """Say, at its end, where another file has the name of this one by now, as where logs are renamed in turn."""
        try:
            other = not os.path.samestat(os.fstat(self._file.fileno()), os.stat(self.name))
        except OSError:  # removed, and nothing in its place
            return
        if other and not self._replaced:
            self._replaced = True
            self.notes.append(f"{self.name}: another file has this name by now, and its rows were not read")

    def _stop_reading(self) -> None:
        """Give no row more: not the one that was read just now, and none that waits for it."""
        self._stopped = SourceStopped(
            f"{self.name}: the file was written anew while it was read, and the twin ends with the last row of before"
        )

    def _keep(self, lines: Sequence[tuple[str, Row | None]], whole: bool) -> None:
        """Keep rows that were read, and count lines that cannot be."""
        for line, row in lines:
            self._strays.judge(line, row is not None)
            self.refused += row is None
        self._ready.extend(Record(row[0], row[1], 0.0, whole) for _, row in lines if row is not None)

    def _taken(self) -> tuple[Record, dict[str, float]] | None:
        """The row behind those that were read, with the factors of its header."""
        row = self._read()
        return None if row is None else (row, self._lines.header.factors)

    def poll(self, timeout: float) -> Record | None:
        """The next row, when it is due.

        Raises
        ------
        SourceStopped
            After the last row before a header by which rows cannot be read.
        """
        if self._next is None:
            self.ended = True
            if self._stopped is not None:
                raise self._stopped
            return None
        row, factors = self._next
        # A stamp far ahead that is wrong is not waited for: the row behind it is due before.
        time = min(row.time, self._later[0].time) if self._later and math.isfinite(self._later[0].time) else row.time
        arrived = self._now()
        if self._speed is not None and math.isfinite(time):
            due = self._begun[0] + (time - self._begun[1]) / self._speed
            end = self._now() + timeout
            while (left := due - self._now()) > 0.0:
                if self._now() >= end:
                    return None
                self._sleep(min(left, end - self._now(), PATIENT))
            # A row that was asked for late was there when it was due.
            arrived = max(due, self._arrived)
        self._arrived = arrived
        self.pace.take(row.time, arrived, row.values)
        self.factors |= factors  # those of this row: the next may be read by another header
        self._next, self._later = self._later, self._taken()
        self.ended = self._next is None and self._stopped is None
        return Record(row.time, row.values, arrived, row.whole)

    @property
    def waiting(self) -> int:
        """None: rows of a file are read as they are asked for."""
        return 0

    def close(self) -> None:
        """Close the file."""
        self._file.close()
