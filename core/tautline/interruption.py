"""Ctrl-C, and the signal to end, that are not lost: Python drops what is raised while it clears away an object."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

try:
    # What the functions of `signal` call. They make enumerations of what they give back, 3 to 4 us a call, which is as
    # much as all else that an advance of a simulation costs beside its steps.
    from _signal import getsignal as handler_of
    from _signal import signal as handle
except ImportError:
    from signal import getsignal as handler_of
    from signal import signal as handle


SIGINT = int(signal.SIGINT)


class Ear:
    """Whether Ctrl-C was pressed.

    Parameters
    ----------
    patient : bool
        Whether to take note only: whoever listens asks at times at which he can be interrupted.
    """

    def __init__(self, patient: bool = False) -> None:
        self.heard, self.patient = False, patient

    def press(self, number: int, frame: object) -> None:
        """Take note of the signal and raise, as Python does."""
        self.heard = True
        if not self.patient:
            raise KeyboardInterrupt

    def check(self) -> None:
        """Raise KeyboardInterrupt where it was pressed and did not come through."""
        if self.heard:
            raise KeyboardInterrupt


_ears: list[Ear] = []
"""Who listens now."""


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()


def _handled(number: int, handler: Callable[[int, Any], Any]) -> bool:
    """Whether a signal is now handled so.

    Not in a host that starts Python in one thread and imports `threading` in another: each takes another thread for the
    main one, and Python lets only the one that started it handle signals.
    """
    try:
        handle(number, handler)
    except ValueError:
        return False
    return True


@contextmanager
def listening(patient: bool = False) -> Iterator[Ear]:
    """Listen to Ctrl-C; only in the main thread, where it is raised, and where nobody else does already.

    Where Python lets this thread handle no signals, nothing is heard.
    """
    ear = Ear(patient)
    if not _in_main_thread():
        yield ear
        return
    plain = handler_of(SIGINT) is signal.default_int_handler
    if plain and not _handled(SIGINT, ear.press):
        yield ear
        return
    _ears.append(ear)
    try:
        yield ear
    finally:
        _ears.remove(ear)
        if plain:
            handle(SIGINT, signal.default_int_handler)


@contextmanager
def undisturbed(tell: bool = True) -> Iterator[None]:
    """Let what must not be left half done come to its end: Ctrl-C is heard, and raised after it where ``tell``.

    What was heard before is not raised again: who ends a run because of it stores its frames.
    """
    disturbed = [ear for ear in _ears if not ear.patient]
    quiet = [ear for ear in disturbed if not ear.heard]
    for ear in disturbed:
        ear.patient = True
    try:
        yield
    finally:
        for ear in disturbed:
            ear.patient = False
    if tell:
        for ear in quiet:
            ear.check()


def _terminate(number: int, frame: object) -> None:
    for ear in _ears:
        ear.heard = True
    if not (_ears and _ears[-1].patient):
        raise KeyboardInterrupt


@contextmanager
def ended_by_signal() -> Iterator[None]:
    """Treat SIGTERM, and the SIGHUP of a terminal that is closed, as Ctrl-C.

    For a process that is a command of ours, and where nobody else handles them: `nohup` has SIGHUP ignored. Where
    Python lets this thread handle no signals, they stay as they are.
    """
    ends = [signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]
    free = [one for one in ends if _in_main_thread() and signal.getsignal(one) is signal.SIG_DFL]
    taken = [one for one in free if _handled(one, _terminate)]
    try:
        yield
    finally:
        for one in taken:
            signal.signal(one, signal.SIG_DFL)
