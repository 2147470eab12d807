"""What a command says while it prepares a scene: nothing where that is quick."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Timer
from typing import Any

from tautline.cli.output.console import say
from tautline.scene.values.printed import quantity

PATIENCE = 2.0
"""Time after which whoever waits is told, s."""


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
    timer = Timer(PATIENCE, say, (f"preparing {path}{length}: Ctrl-C ends it, and nothing is stored yet",))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
