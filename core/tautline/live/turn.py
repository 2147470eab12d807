"""One thread at a time: what two of them made of one simulation would be neither's."""

from __future__ import annotations

import threading
from typing import Any

from tautline.live.errors import SimulationError


class Turn:
    """Held by the thread that works with a simulation; another is refused at once, and does not wait.

    Attributes
    ----------
    advancing : bool
        Whether it is in the middle of an advance: only reading, and inputs for the next advance, are allowed then, as
        they are to a force of the user's.
    reading : Reading
        To be entered for these.
    """

    def __init__(self) -> None:
        self.lock, self.advancing = threading.RLock(), False
        self.reading = Reading(self.lock)

    def __enter__(self) -> None:
        if not self.lock.acquire(False):
            raise of_another_thread()
        if self.advancing:
            self.lock.release()
            cause = "the simulation is in the middle of an advance: what it calls then can only read it and give inputs"
            raise SimulationError(cause, "do it after the advance, or with a copy that was made before")

    def __exit__(self, *_: object) -> None:
        self.lock.release()


class Reading:
    """The turn of whoever reads: also in the middle of an advance of its own thread."""

    def __init__(self, lock: Any) -> None:
        self._lock = lock

    def __enter__(self) -> None:
        if not self._lock.acquire(False):
            raise of_another_thread()

    def __exit__(self, *_: object) -> None:
        self._lock.release()


def of_another_thread() -> SimulationError:
    """The refusal of a second thread."""
    cause = "the simulation is being advanced by another thread, or is in use by one"
    return SimulationError(cause, "give each thread its own: sim.copy()")
