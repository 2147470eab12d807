"""Python's garbage collection: objects that refer to one another in a circle, which no count tells to be left.

Python searches after every 700 objects that it makes, now and then among all that there are. A compiler makes millions,
of which most are needed to its end: the search took a fifteenth of a first run, and a tenth of a short one. This is for
processes of our own: the command line and what compiles beside it. In a user's own process the search stays as it is.
"""

from __future__ import annotations

import atexit
import gc
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext

RARELY = 200_000, 20, 100
"""New objects before the young are searched, and searches of them before the old ones are; tens of MB at most."""


COMPILING = 1_000_000, 20, 100
"""The same while many kernels are compiled, 75 MB in each of two processes: searches took a second of a first run."""


@contextmanager
def collected_rarely(rates: tuple[int, int, int] = RARELY) -> Iterator[None]:
    """Collect garbage rarely inside, and then as before; what is there then counts as old."""
    usual = gc.get_threshold()
    gc.set_threshold(*(max(before, here) if before else 0 for before, here in zip(usual, rates, strict=True)))
    try:
        yield
    finally:
        if not gc.get_freeze_count():
            # Else everything would be searched at once.
            gc.freeze()
            gc.unfreeze()
        gc.set_threshold(*usual)


def collected_for_compiling() -> AbstractContextManager[None]:
    """Collect even less inside, where garbage is collected rarely: elsewhere the search is the user's.

    Only the main thread does so: what threads set beside one another would not be set back.
    """
    alone = threading.current_thread() is threading.main_thread()
    return collected_rarely(COMPILING) if alone and gc.get_threshold()[0] >= RARELY[0] else nullcontext()


def left_at_exit() -> None:
    """Have this process end without a last search: it takes a sixth of a second, and the memory goes back anyway."""
    atexit.register(gc.freeze)
