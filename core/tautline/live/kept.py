"""Frames that a simulation keeps, as the loop wrote them; they are made a result when one is asked for."""

from __future__ import annotations

import hashlib
import math

import numpy as np

from tautline.live.memory import State

BLOCK = 64
"""Frames that room is made for at a time."""


def mark_of(row: np.ndarray) -> str:
    """What tells one frame from all others: a hash of its numbers."""
    return hashlib.blake2b(row.tobytes(), digest_size=8).hexdigest()


class Kept:
    """Rows of frames in the order of time.

    Parameters
    ----------
    width : int
        Numbers of a frame; the first is its time.
    span : float
        Frames older than this before the newest are dropped, s.
    tolerance : float
        Within which two times are one, s: the frame that is just as old as the span is kept.

    Attributes
    ----------
    start : (1, width) array or None
        The frame at the start of the run, also where it was dropped: rises and amplifications are over it. None where
        the run was not begun here.
    mark : str
        Mark of the frame that the run began with, whether it is still kept or not.
    joined : float or None
        Time of a restored state before which frames are missing, for they were those of another run, s.
    """

    def __init__(self, width: int, span: float = math.inf, tolerance: float = 0.0) -> None:
        self.width, self.span, self.tolerance = width, span, tolerance
        self._rows = np.zeros((BLOCK if span > 0.0 else 0, width))
        self._first = self._last = 0
        self.dropped = 0
        self.start: np.ndarray | None = None
        self.mark = ""
        self.joined: float | None = None
        self._starts: dict[str, np.ndarray] = {}
        # The newest frame, or what was told of it with a state, also where none is kept.
        self._newest: np.ndarray | None = None
        self._told = ""

    @property
    def count(self) -> int:
        """Frames since the start, with those that were dropped."""
        return self.dropped + self._last - self._first

    @property
    def rows(self) -> np.ndarray:
        """The rows (n, width), not a copy."""
        return self._rows[self._first : self._last]

    @property
    def last(self) -> str:
        """Mark of the newest frame, whether it is kept or not."""
        return self._told if self._newest is None else mark_of(self._newest)

    def begin(self, row: np.ndarray) -> None:
        """Keep the frame at the start of a run."""
        self.mark, self.start = mark_of(row), row[None].copy()
        self._starts[self.mark] = self.start
        self.add(row)

    def add(self, row: np.ndarray) -> None:
        """Keep a frame."""
        self._newest = row.copy()
        if not self.span > 0.0:
            self.dropped += 1
            return
        oldest = row[0] - self.span - self.tolerance
        while self._first < self._last and self._rows[self._first, 0] < oldest:
            self._first += 1
            self.dropped += 1
        if self._last == len(self._rows):
            self._make_room()
        self._rows[self._last] = row
        self._last += 1

    def _make_room(self) -> None:
        """Move the rows to the front where half of the room is theirs no more, else double the room."""
        rows, n = self.rows, self._last - self._first
        if n > len(self._rows) // 2:
            room = np.zeros((2 * len(self._rows), self.width))
            room[:n] = rows
            self._rows = room
        else:
            self._rows[:n] = rows.copy()
        self._first, self._last = 0, n

    def go_back(self, state: State, row: np.ndarray, tolerance: float) -> None:
        """Drop the frames after a state that is restored, and those before it that another run has made.

        The frame of the start stays where the state comes from the same start. Else the frames begin with that of the
        state, ``row``. The frames that were kept until then are counted as the state has counted them.
        """
        self._go_back(state, row, tolerance)
        self.dropped = max(0, state.frames - (self._last - self._first))

    def _go_back(self, state: State, row: np.ndarray, tolerance: float) -> None:
        """Drop frames and take that of the start; see `go_back`."""
        times = self.rows[:, 0]
        self._last = self._first + int(np.searchsorted(times, state.time + tolerance, side="right"))
        if self.joined is not None and state.time < self.joined:
            self.joined = None
        same, held = state.start == self.mark, self._last > self._first
        alike = same and (not held or mark_of(self._rows[self._last - 1]) == state.last)
        self._newest, self._told = None, state.last
        if not self.span > 0.0 or alike:
            self._begun_with(state.start)
            return
        if same and held and mark_of(self._rows[self._first]) == self.mark:
            self._last = self._first + 1
        else:
            self._last = self._first
        self._begun_with(state.start)
        self.joined = state.time if state.time > tolerance else None
        if self.joined is not None or not self.rows.size:
            self.add(row)
            self._newest = None

    def _begun_with(self, mark: str) -> None:
        """Take another frame for that of the start; its numbers are known where it was kept here."""
        if mark != self.mark:
            self.mark, self.start = mark, self._starts.get(mark)

    def copy(self) -> Kept:
        """The same frames, kept apart."""
        other = Kept(self.width, self.span, self.tolerance)
        other._rows, other._first, other._last, other.dropped = self._rows.copy(), self._first, self._last, self.dropped
        other.start, other.mark, other.joined = self.start, self.mark, self.joined
        other._starts, other._newest, other._told = self._starts, self._newest, self._told
        return other
