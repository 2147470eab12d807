"""Numba's target for kernels, spared the searches that find nothing.

Wherever an array is made or taken apart, numba looks for how it becomes an array. No array has that. Each time numba
then looks for implementations that were added meanwhile, searches again, and writes an error that nobody reads: two
thousand times in a first run. So it does for an index that is written as a number, before it takes it as any other.
"""

from __future__ import annotations

import copy
from typing import Any

from numba.core import types
from numba.core.cpu import CPUContext

UNLIKELY = ("static_getitem", "static_setitem")
"""What numba asks for first, and arrays do not have."""


class KernelTarget(CPUContext):
    """Numba's target, which finds what numba's does."""

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
        return super().get_function(fn, sig, _firstcall)


def spared(target: CPUContext) -> CPUContext:
    """A copy of numba's target, as numba makes one for each function, of our class."""
    own = copy.copy(target)
    own.__class__ = KernelTarget
    return own
