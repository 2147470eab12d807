"""Fresh processes that look for no module in the current folder: its files are data, whatever their names."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess

SAFE_PATH = "PYTHONSAFEPATH"


@contextmanager
def without_current_folder() -> Iterator[None]:
    """Have processes that are started inside look for no module in the current folder.

    It is said by a variable of the environment, which is that of this process too until the end of the block.
    """
    before = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[SAFE_PATH]
        else:
            os.environ[SAFE_PATH] = before


class FreshProcess(SpawnProcess):
    """A process that is started so; the environment is another one only while it starts."""

    def start(self) -> None:
        """Start it."""
        with without_current_folder():
            super().start()


class FreshProcesses(SpawnContext):
    """A context of `multiprocessing` whose processes are started so."""

    Process = FreshProcess
