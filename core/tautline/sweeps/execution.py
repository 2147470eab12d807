"""How a sweep is executed: by whom, where to, and who is told of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any


def _tell_nobody(*_: Any) -> None:
    """What is called where nobody wants to know."""


@dataclass(frozen=True)
class Execution:
    """What of a sweep changes none of its numbers.

    Attributes
    ----------
    jobs : int or None
        Workers; None or 0 for as many as there are processors.
    dask : str or None
        Address of a Dask scheduler, or ``local`` for processes on this machine.
    folder : Path or None
        Where result, table and journal go; nothing is written without it.
    resume : bool
        Whether to go on with the sweep in that folder.
    progress : callable
        Called with the number of finished cases and that of all.
    announce : callable or None
        Called before kernels are compiled, with their number.
    say : callable
        Called with what the user should know: who runs the cases.
    begin : callable
        Called before the first case, when nothing of the sweep can be refused any more.
    """

    jobs: int | None = None
    dask: str | None = None
    folder: Path | None = None
    resume: bool = False
    progress: Callable[[int, int], None] = _tell_nobody
    announce: Callable[[int], Any] | None = None
    say: Callable[[str], None] = _tell_nobody
    begin: Callable[[], None] = _tell_nobody
