"""Frames that a simulation keeps, as the loop wrote them; they are made a result when one is asked for."""

from __future__ import annotations

import math

import numpy as np

BLOCK = 64
"""Frames that room is made for at a time."""


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
    """

    def __init__(self, width: int, span: float = math.inf) -> None:
        self.width, self.span = width, span
        self._rows = np.zeros((BLOCK if span > 0.0 else 0, width))
        self._first = self._last = 0
        self.dropped = 0
        self.start: np.ndarray | None = None

    @property
    def count(self) -> int:
        """Frames since the start, with those that were dropped."""
        return self.dropped + self._last - self._first

    @property
    def rows(self) -> np.ndarray:
        """The rows (n, width), not a copy."""
        return self._rows[self._first : self._last]

    def add(self, row: np.ndarray) -> None:
        """Keep a frame."""
        if not self.span > 0.0:
            self.dropped += 1
            return
        if self.start is None and row[0] == 0.0:
            self.start = row[None].copy()
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

    def go_back(self, time: float, tolerance: float) -> None:
        """Drop the frames after a time, s."""
        times = self.rows[:, 0]
        self._last = self._first + int(np.searchsorted(times, time + tolerance, side="right"))

    def copy(self) -> Kept:
        """The same frames, kept apart."""
        other = Kept(self.width, self.span)
        other._rows, other._first, other._last, other.dropped = self._rows.copy(), self._first, self._last, self.dropped
        other.start = self.start
        return other
