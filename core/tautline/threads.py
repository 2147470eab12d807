"""One thread for the small matrices of our own linear algebra.

BLAS shares each product among all cores. For the matrices of a scene, some hundreds of rows, the threads wait for each
other more than they compute: ten times the processor time, and more wall time where other programs run beside.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_lock = threading.Lock()
_inside = 0
_limit: Any = None


@functools.cache
def _libraries() -> Any:
    """The BLAS libraries of NumPy and SciPy, each of which may have its own; looked up once, for that takes long."""
    import scipy.linalg  # noqa: F401  (loads SciPy's)
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController().select(user_api="blas")


@contextmanager
def one_thread() -> Iterator[None]:
    """Let BLAS use one thread inside; what was set before is set again after. A decorator too: ``@one_thread()``.

    BLAS has one setting for the process: with several Python threads inside the first sets it and the last restores it.
    """
    global _inside, _limit
    libraries = _libraries()
    with _lock:
        if _inside == 0:
            _limit = libraries.limit(limits=1)
        _inside += 1
    try:
        yield
    finally:
        with _lock:
            _inside -= 1
            if _inside == 0:
                _limit.restore_original_limits()
                _limit = None
