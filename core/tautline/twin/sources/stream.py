"""Standard input: a JSON object a line, or a table with a header."""

from __future__ import annotations

import json
import math
import queue
import threading
import time as clock
from collections.abc import Mapping, Sequence
from typing import IO, Any

from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.columns import SEPARATOR_LINE
from tautline.twin.pace import Pace
from tautline.twin.sources.objects import ObjectReadings
from tautline.twin.sources.record import Record, SourceFault, SourceStopped
from tautline.twin.sources.stamps import Stamps
from tautline.twin.sources.stated_units import Stated
from tautline.twin.sources.strays import Strays
from tautline.twin.sources.table.cells import has_end
from tautline.twin.sources.table.header import Header
from tautline.twin.sources.table.lines import Lines, Row

MOST = 100_000
"""Records that may wait; beyond, the writer waits."""
WHERE = "in the data"
"""Who states what objects say of their readings, for messages."""


class Stream:
    """Reads lines on a thread of its own, so that they can be waited for.

    Parameters
    ----------
    file : text file
    columns : sequence of str
    time : str
        The column of the stamp; empty for the usual names.
    units : mapping, optional
        Units by column that the readings are wanted in; those of a header are converted.
    stated : dict, optional
        Units that an earlier process has heard.
    """

    def __init__(
        self, file: IO[str], columns: Sequence[str], time: str = "", name: str = "standard input",
        units: Mapping[str, str] | None = None, stated: Stated | None = None,
    ) -> None:  # fmt: skip
        self.name, self.live, self.again, self.ended = name, True, False, False
        self.refused, self.left_out, self.last, self._number = 0, 0, "", 0
        self.dropped, self.notes = 0, list[str]()
        self.pace, self._held_up = Pace(), 0.0
        self.factors: dict[str, float] = {}
        self._file, self._columns, self._time, self._units = file, list(columns), time, units
        self._queue: queue.Queue[Record | Header | Stated | SceneError | SourceStopped | None] = queue.Queue(MOST)
        self._header: Header | None = None
        self._lines: Lines | None = None
        self._objects, self._strays = False, Strays(name, self.notes)
        self._stamps = Stamps(time, self.notes, columns)
        self._readings = ObjectReadings(columns, units or {}, self.notes, self.factors, stated)
        self.stated = self._readings.stated
        threading.Thread(target=self._listen, daemon=True, name="tautline source").start()

    def _listen(self) -> None:
        try:
            for line in self._file:
                self._number += 1
                if self._number == 1:
                    line = text_of(line, self.name)
                if line.strip() and not self._is_remark(line):
                    self._take(line.rstrip("\r\n"), has_end(line))  # tabs at the end are cells
            self._rest(whole=False)
        except (SceneError, SourceStopped) as error:
            self._rest(whole=True)
            self._queue.put(error)
        except ValueError:  # the file was closed
            pass
        except BaseException as fault:  # told by `poll`: a thread that died in silence would be waited for without end
            self._queue.put(SourceFault(self.name, fault))
        finally:
            self._queue.put(None)

    def _is_remark(self, line: str) -> bool:
        if not line.lstrip().startswith("#"):
            return self._strays.is_heading(line, self._number)
        return self._lines is None or self._lines.is_remark(line.rstrip("\r\n"))

    def _rest(self, whole: bool) -> None:
        """Give the row that waits for one behind it, which does not come any more."""
        for one, row in self._lines.rest() if self._lines is not None else ():
            self._give(one, row, whole)

    def _take(self, line: str, whole: bool = True) -> None:
        row: Row | None
        if self._objects or (self._lines is None and line.lstrip().startswith("{")):
            self._objects, whole = True, True  # half an object is none
            before = self._readings.stated
            row = read_object(line, self._columns, self._stamps, self._readings)
            if self._readings.stated is not before:
                self._queue.put(self._readings.stated)  # before the records that it holds for
        elif self._lines is None and SEPARATOR_LINE.fullmatch(line):
            return  # of a spreadsheet
        elif self._lines is None:
            given = self._columns, self._time, self.name, self._units, self.notes, self._number
            self._lines = Lines(Header(line, *given))
            self._begin(self._lines.header)
            return
        else:
            rows = self._lines.rows(line, whole, self._number)
            if self._lines.header is not self._header:
                self._begin(self._lines.header)
            for one, row in rows:
                self._give(one, row, whole)
            return
        self._give(line, row, whole)

    def _give(self, line: str, row: Row | None, whole: bool) -> None:
        """Put a row into the queue, or count a line that cannot be read."""
        self._strays.judge(line, row is not None and math.isfinite(row[0]))
        if row is None:
            self.refused, self.last = self.refused + 1, line[:80]
            return
        arrived = clock.monotonic()
        self.pace.take(row[0], arrived - self._held_up, row[1])
        record = Record(row[0], row[1], arrived, whole)
        try:
            self._queue.put_nowait(record)
        except queue.Full:
            # The writer waits for us: the rows behind come at our pace, and that is none of a machine.
            self._queue.put(record)
            self._held_up += clock.monotonic() - arrived

    def _begin(self, header: Header) -> None:
        """Read lines by a header from now on; its factors hold for the records behind it in the queue."""
        self._header = header
        self._queue.put(header)

    def poll(self, timeout: float) -> Record | None:
        """The next record.

        Raises
        ------
        SceneError
            For a header without the columns.
        SourceStopped
            For one that comes later, and where reading has died.
        """
        if self.ended:
            return None
        try:
            found = self._queue.get(timeout=timeout) if timeout > 0.0 else self._queue.get_nowait()
        except queue.Empty:
            return None
        if isinstance(found, Header):
            self.factors |= found.factors
            return self.poll(timeout)
        if isinstance(found, dict):
            self.stated = found
            return self.poll(timeout)
        if isinstance(found, (SceneError, SourceStopped)):
            self.ended = True
            raise found
        self.ended = found is None
        return found

    @property
    def waiting(self) -> int:
        """Records that were read and not taken yet."""
        return sum(isinstance(one, Record) for one in list(self._queue.queue))

    def close(self) -> None:
        """Nothing: the thread ends with the process, or with the stream."""


def text_of(line: str, name: str) -> str:
    """The first line without the mark that some programs begin UTF-8 with.

    Raises
    ------
    SceneError
        For what is text in another encoding, or none.
    """
    if "\0" in line:
        raise SceneError([Problem(name, 1, "", None, "is not UTF-8 text", "save it as UTF-8")])
    return line.removeprefix("\ufeff")


def read_object(
    line: str, columns: Sequence[str], stamps: Stamps, readings: ObjectReadings
) -> tuple[float, dict[str, float]] | None:
    """Stamp and values of a JSON object; None for what is none."""
    try:
        found: Any = json.loads(line)
    except (ValueError, RecursionError):  # the second for brackets in brackets without end
        return None
    if not isinstance(found, dict):
        return None
    stamp = stamps.column([str(key) for key in found])
    values = dict.fromkeys(columns, math.nan)
    readings.hear_units(found, WHERE, stamp)
    if readings.are_good(found, WHERE):
        values |= readings.values(found, WHERE, stamp)
    return readings.stamp(stamps, stamp, found[stamp]) if stamp is not None else float("nan"), values
