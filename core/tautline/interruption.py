"""Ctrl-C that is not lost: Python drops what is raised while it clears away an object."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


class Ear:
    """Whether Ctrl-C was pressed."""

    def __init__(self) -> None:
        self.heard = False

    def press(self, number: int, frame: object) -> None:
        """Take note of the signal and raise, as Python does."""
        self.heard = True
        raise KeyboardInterrupt

    def check(self) -> None:
        """Raise KeyboardInterrupt where it was pressed and did not come through."""
        if self.heard:
            raise KeyboardInterrupt


@contextmanager
def listening() -> Iterator[Ear]:
    """Listen to Ctrl-C; only in the main thread, where it is raised, and where nobody else does already."""
    ear = Ear()
    plain = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if not plain or threading.current_thread() is not threading.main_thread():
        yield ear
        return
    signal.signal(signal.SIGINT, ear.press)
    try:
        yield ear
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
