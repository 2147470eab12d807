"""Numba's target for kernels, spared the searches that find nothing.

Wherever an array is made or taken apart, numba looks for how it becomes an array. No array has that. Each time numba
then looks for implementations that were added meanwhile, searches again, and writes an error that nobody reads: two
thousand times in a first run. So it does for an index that is written as a number, before it takes it as any other.

Before each function it looks through all of its registries, and it asks each implementation by its signature whether it
wants to know a place in the sources. The first is done where a registry has grown, the second is read from the code.
"""

from __future__ import annotations

import copy
import inspect
from typing import Any
from weakref import WeakKeyDictionary

from numba.core import types
from numba.core.cpu import CPUContext
from numba.core.errors import NumbaNotImplementedError

UNLIKELY = ("static_getitem", "static_setitem")
"""What numba asks for first, and arrays do not have."""


LISTS = ("functions", "attributes", "globals", "getattrs", "setattrs", "casts", "constants")
"""What numba's registries list, those of types and those of implementations."""
_seen: WeakKeyDictionary[Any, int] = WeakKeyDictionary()
"""By context of numba's, how long the lists were when it was refreshed last."""


def refresh_where_grown(context: Any) -> bool:
    """Have one of numba's contexts look through its registries, if one of them has grown since; whether it had."""
    grown = _seen.get(context) != _listed(context)
    if grown:
        context.refresh()
        _seen[context] = _listed(context)
    return grown


def _listed(context: Any) -> int:
    return sum(len(getattr(registry, name, ())) for registry in context._registries for name in LISTS)


class Implementation:
    """What writes the code of a function, for one signature."""

    def __init__(self, write: Any, context: Any, signature: Any) -> None:
        self._write, self._context, self._signature = write, context, signature

    def __call__(self, builder: Any, given: Any, loc: Any = None) -> Any:
        """Write it."""
        place = {"loc": loc} if _takes_place(self._write) else {}
        found = self._write(self._context, builder, self._signature, given, **place)
        self._context.add_linking_libs(getattr(self._write, "libs", ()))
        return found

    def __getattr__(self, name: str) -> Any:
        return getattr(self._write, name)


def _takes_place(write: Any) -> bool:
    """Whether an implementation asks for a place in the sources, as its argument ``loc``."""
    code = getattr(write, "__code__", None)
    if code is None or hasattr(write, "__wrapped__"):
        return "loc" in inspect.signature(write).parameters
    return "loc" in code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]


class KernelTarget(CPUContext):
    """Numba's target, which finds what numba's does."""

    def refresh(self) -> None:
        """Look through the registries."""
        refresh_where_grown(self._of_numba)

    def get_function(self, fn: Any, sig: Any, _firstcall: bool = True) -> Any:
        """What writes the code of a function for a signature.

        Raises
        ------
        NotImplementedError
            Where there is none.
        """
        if sig.args and type(sig.args[0]) is types.Array:
            if isinstance(fn, str) and fn == "__array__":
                raise NotImplementedError("an array is one")
            if isinstance(fn, str) and fn in UNLIKELY:
                return super().get_function(fn, sig, _firstcall=False)
        called = sig.as_function()
        known = self._defns[fn.get_impl_key(called) if isinstance(fn, types.Callable) else fn]
        try:
            return Implementation(known.find(called.args), self, called)
        except NumbaNotImplementedError:
            return super().get_function(fn, sig, _firstcall)


def spared(target: CPUContext) -> CPUContext:
    """A copy of numba's target, as numba makes one for each function, of our class."""
    own = copy.copy(target)
    own.__class__, own._of_numba = KernelTarget, target
    return own
