"""One thread at a time: what two of them made of one simulation would be neither's."""

from __future__ import annotations

import os
import threading
import time as clock
from collections.abc import Sequence
from typing import Any
from weakref import WeakSet

from tautline.live.errors import SimulationError

PATIENCE = 5.0
"""Wall time, s, for which a force may hold up whoever waits to read: it may itself wait for that reading."""
LOOK = 0.05
"""Wall time, s, after which whoever waits looks at what the other does."""

_within = threading.local()
"""How many advances this thread is in the middle of: a force may advance another simulation."""


def _depth() -> int:
    return getattr(_within, "depth", 0)


class Turn:
    """Taken by the thread that works with a simulation; another waits, and cannot change it in another's advance.

    Readings and inputs take it in place, as `read` and `give`, and release `lock`: they are asked for at every step of
    a control, where a context would cost more than they do.

    Parameters
    ----------
    forces : sequence
        Those that were added: what they call is called in the middle of an advance.

    Attributes
    ----------
    lock : RLock
        Held by whoever has the turn.
    version : int
        Odd while the simulation changes, and another one after that: what was copied between two equal and even ones is
        of one state, without the lock.
    advancing : int
        The thread that is in the middle of an advance; 0 where none is. What it calls may read, and give inputs for
        the next advance.
    change, look : context manager
        The turn of whoever changes the simulation; and of whoever takes it as a whole, which is none in the middle of
        an advance.
    """

    def __init__(self, forces: Sequence[Any]) -> None:
        self.lock = threading.RLock()
        self._condition = threading.Condition(self.lock)
        self.version, self.advancing = 0, 0
        self.change, self.look = _Change(self), _Look(self)
        self._forces, self._gate, self._waiting = forces, threading.RLock(), set[object]()
        self._abandoned = False  # whether who has the turn is no thread of this process, and left its work half done
        _turns.add(self)

    def read(self) -> None:
        """Take the turn to read: at the end of another thread's advance, and within that of its own."""
        if self._waiting or not self.lock.acquire(False):
            self._wait(False)

    def give(self) -> None:
        """Take the turn to give inputs; raises SimulationError in the middle of another thread's advance."""
        if self.advancing and self.advancing != threading.get_ident():
            raise of_another_thread()
        if self._waiting or not self.lock.acquire(False):
            self._wait(True)

    def begin_advance(self) -> None:
        """Take notice that this thread, which has the turn, is in the middle of an advance from here on."""
        _within.depth, self.advancing = _depth() + 1, threading.get_ident()

    def end_advance(self) -> None:
        """Take notice that the advance is over."""
        _within.depth, self.advancing = _depth() - 1, 0

    def take_whole(self) -> None:
        """Take the turn to read, not in the middle of an advance; raises SimulationError in that of its own thread."""
        self.read()
        if self.advancing:
            self.lock.release()
            raise in_its_middle()

    def forked(self) -> None:
        """In the child of a fork only the thread that forked goes on: whoever else has the turn never gives it back.

        What only reads leaves a whole state behind. What changes it leaves one that is neither of before nor of after:
        whoever asks for the turn then is refused.
        """
        self._waiting.clear()
        if not _is_free(self._gate):
            self._gate = threading.RLock()
        if _is_free(self.lock):
            return
        self.advancing, self._abandoned = 0, bool(self.version & 1)
        if self._abandoned:
            self._waiting.add(self)  # nobody passes by `_wait`
            return
        self.lock = threading.RLock()
        self._condition, self.change = threading.Condition(self.lock), _Change(self)

    def _wait(self, changes: bool) -> None:
        """Wait until the turn is free: one after another, or who asks again and again would keep all others out.

        Raises
        ------
        SimulationError
            As `_acquire`, and in the child of a fork where nobody can give the turn back.
        """
        if self._abandoned:
            raise of_a_fork()
        if self._is_own():
            self.lock.acquire()
            return
        mark = object()
        self._waiting.add(mark)
        try:
            self._acquire(self._gate, changes)
            try:
                self._acquire(self.lock, changes)
            finally:
                self._gate.release()
        finally:
            self._waiting.discard(mark)

    def _is_own(self) -> bool:
        """Whether this thread has the turn already; only who has the lock of a condition can notify of it."""
        try:
            self._condition.notify()
        except RuntimeError:
            return False
        return True

    def _acquire(self, lock: Any, changes: bool) -> None:
        """Acquire a lock; raises SimulationError where the other advances meanwhile, or would never come to its end."""
        before, since = None, 0.0
        # Who waits in the middle of an advance keeps others waiting, perhaps the one that is waited for.
        refused = changes or _depth() > 0
        while True:
            if refused and self.advancing:
                raise of_another_thread()
            if lock.acquire(True, LOOK):
                return
            calls = [force.calls for force in self._forces]
            if calls != before or not any(number % 2 for number in calls):
                before, since = calls, clock.monotonic()
            elif clock.monotonic() - since > PATIENCE:
                raise of_another_thread(f". A force of it has not returned for {PATIENCE:g} s")


class _Change:
    """See `Turn`."""

    def __init__(self, turn: Turn) -> None:
        self._turn, self._depth = turn, 0

    def __enter__(self) -> None:
        turn = self._turn
        turn.give()
        if turn.advancing:
            turn.lock.release()
            raise in_its_middle()
        self._depth += 1
        turn.version += self._depth == 1

    def __exit__(self, *_: object) -> None:
        self._depth -= 1
        self._turn.version += self._depth == 0
        self._turn.lock.release()


class _Look:
    """See `Turn`."""

    def __init__(self, turn: Turn) -> None:
        self._turn = turn

    def __enter__(self) -> None:
        self._turn.take_whole()

    def __exit__(self, *_: object) -> None:
        self._turn.lock.release()


_turns: WeakSet[Turn] = WeakSet()
"""Those of all simulations."""


def _is_free(lock: Any) -> bool:
    """Whether this thread can have a lock, or has it."""
    if not lock.acquire(False):
        return False
    lock.release()
    return True


def _after_fork() -> None:
    for turn in list(_turns):
        turn.forked()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def of_a_fork() -> SimulationError:
    """The refusal of a simulation that a fork has torn."""
    return SimulationError(
        "this process was forked while another thread advanced or changed the simulation. That thread is not in this "
        "process, and its work is left half done here",
        "fork between two advances; or save() before the fork, and restore the state in the child in a new simulation",
    )


def in_its_middle() -> SimulationError:
    """The refusal of what a force would do with the simulation that asks for it."""
    cause = "the simulation is in the middle of an advance: what it calls then can only read it and give inputs"
    return SimulationError(cause, "do it after the advance, or with a copy that was made before")


def of_another_thread(more: str = "") -> SimulationError:
    """The refusal of a second thread; also of one that comes from a force of another simulation."""
    if _depth() > 0:
        return SimulationError(
            "a force asks for another simulation, which is being advanced by another thread: what it would get is of "
            "another time, and where each asks for the other both would wait without end",
            "advance simulations whose forces ask for one another in one thread, by turns: a.advance(0.01), "
            "b.advance(0.01)",
        )
    return SimulationError(
        f"the simulation is being advanced by another thread{more}", "give each thread its own: sim.copy()"
    )
