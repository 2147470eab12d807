"""What a command says while it prepares a scene, or searches: nothing where that is quick."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import Any

from tautline.cli.output.console import say
from tautline.scene.values.printed import quantity

PATIENCE = 2.0
"""Time after which whoever waits is told, s."""
AGAIN = 4.0
"""Ratio of the times after which whoever still waits is told again."""


@contextmanager
def preparing(path: Path, scene: Any, quiet: bool = False) -> Iterator[None]:
    """Say what is waited for, if it takes long: of a long run the sea and what answers it are computed ahead.

    It is not known before how long that takes; so a thread waits beside.

    Parameters
    ----------
    path : Path
        The scene's file, which is named.
    scene : scene
        Its ``solver.end`` is told, s, where it has one.
    quiet : bool
        Say nothing.
    """
    if quiet:
        yield
        return
    end = getattr(getattr(scene, "solver", None), "end", None)
    length = f", {quantity(end, 's')}" if isinstance(end, (int, float)) else ""
    with told_if_long(lambda: f"preparing {path}{length}: Ctrl-C ends it, and nothing is stored yet", often=False):
        yield


@contextmanager
def told_if_long(sentence: Callable[[], str], often: bool = True) -> Iterator[None]:
    """Say a sentence, as it is by then, where what is inside takes longer than `PATIENCE`.

    Parameters
    ----------
    sentence : callable
        Without arguments.
    often : bool
        Say it again each time that four times as long has passed, with the time: so each is news.
    """
    ended = Event()

    def wait() -> None:
        passed, until = 0.0, PATIENCE
        while not ended.wait(until - passed):
            say(sentence() + (f" (after {until:.0f} s)" if passed else ""))
            if not often:
                return
            passed, until = until, AGAIN * until

    beside = Thread(target=wait, daemon=True)
    beside.start()
    try:
        yield
    finally:
        ended.set()
        beside.join()
