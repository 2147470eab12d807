"""What the compiler is taught of ours: recorded as modules are imported, and told when there is something to compile.

Most runs find all of their kernels as machine code. They load no compiler, which would be a third of a short run. What
teaches, and whatever else needs numba, is in :mod:`tautline.kernels.compiling`; its modules are imported by name here
and nowhere else.
"""

from __future__ import annotations

import importlib
import threading
from collections.abc import Callable
from typing import Any

from tautline.kernels.machine.settings import UNCOMPILED

ROOM = "tautline.kernels.compiling"
_waiting: list[Callable[[], Any]] = []
"""What is to be told, in its order."""
_teaching = threading.RLock()
"""Held until all of it is told: another thread has to wait with what it compiles."""


def taught(module: str, function: str | None = None, *arguments: Any, **more: Any) -> None:
    """Have the compiler know something before anything of ours is compiled.

    Parameters
    ----------
    module : str
        In the room of the compiler; it teaches as it is imported.
    function : str, optional
        That is called with the arguments then.
    *arguments, **more
        For the function.
    """

    def lesson() -> None:
        teacher = importlib.import_module(f"{ROOM}.{module}")
        if function is not None:
            getattr(teacher, function)(*arguments, **more)

    if not UNCOMPILED:
        _waiting.append(lesson)


def compiler() -> Any:
    """What compiles (:mod:`tautline.kernels.compiling.kernels`), loaded now and told what it does not know yet."""
    with _teaching:
        made = importlib.import_module(f"{ROOM}.kernels")
        while _waiting:
            _waiting.pop(0)()
    return made


def stands_for(stub: Any, **options: Any) -> Callable[[Any], Any]:
    """Decorator of a function of types that returns what compiled code calls for them: ``@stands_for(stub)``."""

    def registered(choose: Any) -> Any:
        taught("kernels", "overloaded", stub, choose, options)
        return choose

    return registered


def is_array(kind: Any) -> bool:
    """Whether a type of numba's, as it is handed to what `stands_for` something, is that of an array."""
    return bool(compiler().is_array(kind))
