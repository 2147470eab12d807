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


def begins_late(time: float) -> str:
    """A warning for the reader of a result that holds no frames from its start to a time, s."""
    return (
        f"the run was gone on with at {time:.6g} s from a state that another run saved. The frames of that run are not "
        "in this result. What is said of the whole run is said of the frames that are here"
    )


class Kept:
    """Rows of frames in the order of time.

    Parameters
    ----------
    width : int
        Numbers of a frame; the first is its time.
    span : float
        Frames older than this before the newest are dropped, s.

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

    def __init__(self, width: int, span: float = math.inf) -> None:
        self.width, self.span = width, span
        self._rows = np.zeros((BLOCK if span > 0.0 else 0, width))
        self._first = self._last = 0
        self.dropped = 0
        self.start: np.ndarray | None = None
        self.mark = ""
        self.joined: float | None = None

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
        """Mark of the newest frame; empty where none is kept."""
        return mark_of(self._rows[self._last - 1]) if self._last > self._first else ""

    def begin(self, row: np.ndarray) -> None:
        """Keep the frame at the start of a run."""
        self.mark, self.start = mark_of(row), row[None].copy()
        self.add(row)

    def add(self, row: np.ndarray) -> None:
        """Keep a frame."""
        if not self.span > 0.0:
            self.dropped += 1
            return
        oldest = row[0] - self.span
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
        state, ``row``.
        """
        times = self.rows[:, 0]
        self._last = self._first + int(np.searchsorted(times, state.time + tolerance, side="right"))
        if self.joined is not None and state.time < self.joined:
            self.joined = None
        same = state.start in ("", self.mark)
        if same and (not state.last or state.last == self.last or self._last == self._first):
            return
        if same and mark_of(self._rows[self._first]) == self.mark:
            self._last = self._first + 1
        else:
            self.start, self.mark, self._last, self.dropped = None, state.start, self._first, 0
            self.add(row)
        self.joined = state.time if state.time > tolerance else None

    def copy(self) -> Kept:
        """The same frames, kept apart."""
        other = Kept(self.width, self.span)
        other._rows, other._first, other._last, other.dropped = self._rows.copy(), self._first, self._last, self.dropped
        other.start, other.mark, other.joined = self.start, self.mark, self.joined
        return other
