"""What a source gives: records, one after another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from tautline.errors import TautlineError
from tautline.scene.errors import Problem, SceneError
from tautline.twin.pace import Pace
from tautline.twin.sources.stated_units import Stated


@dataclass(frozen=True, slots=True)
class Record:
    """Values by column at a stamp.

    Attributes
    ----------
    time : float
        Stamp by the source's own clock, s; NaN where there is none that can be read.
    values : mapping
        By column, in the columns' units; NaN where there is none.
    arrived : float
        ``time.monotonic()`` at arrival, s.
    whole : bool
        Whether all of it was there: False for a last line without a line end, of which the last cell counts as missing.
    repeated : frozenset of str
        Columns that were not measured at this stamp: their readings are those of before, which hold until others come.
    """

    time: float
    values: Mapping[str, float]
    arrived: float
    whole: bool = True
    repeated: frozenset[str] = frozenset()


class SourceStopped(TautlineError):
    """No record comes any more, though the source has not ended; ``str()`` says why."""


class SourceFault(SourceStopped):
    """What reads a source has stopped by a fault of the program: no record comes any more."""

    def __init__(self, name: str, fault: BaseException) -> None:
        said = " ".join(str(fault).split())[:200]
        super().__init__(f"{name}: reading has stopped by a fault of the program ({type(fault).__name__}: {said})")


class Source(Protocol):
    """Something that records come from.

    Attributes
    ----------
    name : str
        For messages.
    live : bool
        Whether records arrive while they are measured.
    again : bool
        Whether what an operation has had before it is gone on with comes once more: a file is read from its begin.
    ended : bool
        Whether no more will come.
    refused : int
        Lines or messages that could not be read.
    left_out : int
        Those that could be read and are not used, such as messages of another machine or without a time.
    dropped : int
        Records that were let go because they came faster than they were taken.
    factors : dict of str to float
        What readings are multiplied by, by column, to be in the map's unit, where the source gives another one.
    stated : dict
        Units that were stated with readings, up to the record that was given last, and that hold until others are: by
        column and by who states them. Empty where they come anew when an operation is gone on with.
    waiting : int
        Records that have come and were not taken yet.
    pace : Pace
        Whether all records that have come, those that wait among them, were written before.
    notes : list of str
        Sentences for the user that were not yet printed; who prints them takes them out.
    """

    name: str
    live: bool
    again: bool
    ended: bool
    refused: int
    left_out: int
    dropped: int
    factors: dict[str, float]
    notes: list[str]
    pace: Pace

    @property
    def stated(self) -> Stated:
        """Units that hold until others are stated."""

    @property
    def waiting(self) -> int:
        """How many records have come and were not taken yet."""

    def poll(self, timeout: float) -> Record | None:
        """The next record; None where none came within so many seconds."""

    def close(self) -> None:
        """Let go of file, thread or connection."""


@dataclass(frozen=True)
class NoColumn(Problem):
    """A column that a map names and that a table does not have."""

    column: str = ""


class NewHeader(SourceStopped):
    """A header in the midst of rows by which those after it cannot be read."""

    def __init__(self, error: SceneError) -> None:
        cure = "If that line is a remark, begin it with #, or delete it"
        end = "" if str(error).endswith(("?", ".")) else "."
        super().__init__(f"the data have a new header, and rows cannot be read by it: {error}{end} {cure}")


@dataclass(frozen=True)
class Later:
    """A line behind the header that is, or may be, one by which rows cannot be read.

    Attributes
    ----------
    error : NewHeader
        What is wrong with it.
    separator, width : str, int
        Of its cells.
    sure : bool
        Whether it is one; else the row behind it shows whether it is a remark.
    named : bool
        Whether it names a stamp, or has units. One that does not is a header only if rows behind it have as many cells.
    told : str
        What to say where it stays in doubt.
    rows : int
        Rows behind it that speak for a header, and do not prove it.
    """

    error: NewHeader
    separator: str
    width: int
    sure: bool
    named: bool
    told: str
    rows: int = 0

    @property
    def weight(self) -> tuple[bool, bool]:
        """The larger, the more speaks for a header: a line in doubt takes no place of one that is sure."""
        return self.sure, self.named
