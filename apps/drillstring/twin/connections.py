"""When the string was in slips, and how much longer it is since."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple


class Sample(NamedTuple):
    """What was measured at a time, s: the places of block and bit, m, positive down."""

    time: float
    block: float
    bit_depth: float


class Connection(NamedTuple):
    """A time in slips.

    ``start`` and ``end``, s, are when the slips took over and gave back half of the string's weight; ``added``, m, is
    by how much higher the block took the string up again than it had put it down: the length of a stand that was added,
    negative of one that was laid down, near zero of slips without a stand. ``bit_depth`` m at the end.
    """

    start: float
    end: float
    added: float
    bit_depth: float


class Connections:
    """Collects times in slips; told of every sample whether the string hangs in them, None where that is not known.

    One whose beginning was not seen is left out: it would tell a wrong length.
    """

    def __init__(self) -> None:
        self.all: list[Connection] = []
        self._start: tuple[float, float] | None = None
        self._was: bool | None = None

    def add(self, sample: Sample, in_slips: bool | None) -> Connection | None:
        """The connection that ends with this sample, if one does."""
        ended = None
        if in_slips and self._was is False:
            self._start = sample.time, sample.block
        elif in_slips is False and self._start is not None:
            begun, block = self._start
            ended = Connection(begun, sample.time, block - sample.block, sample.bit_depth)
            self.all.append(ended)
            self._start = None
        elif in_slips is None:
            self._start = None
        self._was = in_slips
        return ended

    def memory(self) -> dict[str, Any]:
        """What another process needs to know of the slips under way, for JSON."""
        return {"start": self._start, "was": self._was}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on with slips that another process saw set."""
        start = memory["start"]
        self._start, self._was = None if start is None else (float(start[0]), float(start[1])), memory["was"]
