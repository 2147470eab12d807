"""Events that wait for a browser that does not read them at once."""

from __future__ import annotations

import asyncio
from collections import deque

OF_MANY = "line"
"""The kind of events each of which tells something else; of the others the newest holds alone."""


class Waiting:
    """Events that wait for one browser: lines, and the newest of each other kind.

    A browser that stalls may lose lines and pictures, for more come. What comes once, such as a shape, is never lost.

    Parameters
    ----------
    most : int
        Lines that wait before the oldest is left out.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._lines = 0
        self._events: deque[tuple[str, str]] = deque()
        self._come = asyncio.Event()

    @property
    def empty(self) -> bool:
        """Whether none waits."""
        return not self._events

    def put(self, kind: str, text: str) -> None:
        """Let an event wait behind all others; it takes the place of what it makes void."""
        if kind != OF_MANY or self._lines == self._most:
            self._leave_out(kind)
        self._lines += kind == OF_MANY
        self._events.append((kind, text))
        self._come.set()

    def _leave_out(self, kind: str) -> None:
        """Take the oldest event of a kind out, where there is one: few of other kinds are before it."""
        for k, (other, _) in enumerate(self._events):
            if other == kind:
                del self._events[k]
                self._lines -= kind == OF_MANY
                return

    async def next(self, within: float) -> tuple[str, str]:
        """The oldest event, kind and text; raises TimeoutError where none comes within so many seconds."""
        if not self._events:
            self._come.clear()
            await asyncio.wait_for(self._come.wait(), within)
        kind, text = self._events.popleft()
        self._lines -= kind == OF_MANY
        return kind, text
