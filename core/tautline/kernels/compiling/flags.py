"""Flags of a kernel's compilation, compared by what is set.

As it finds types, numba asks for each operation whether it has met it under the same flags, and compares all options of
both by name: a tenth of the time that it takes to compile a kernel. What is set in neither is the same.
"""

from __future__ import annotations

from typing import Any

from numba.core.compiler import Flags


class KernelFlags(Flags):
    """Numba's flags, equal to others where numba's are."""

    __slots__ = ()

    def __eq__(self, other: object) -> Any:
        if not isinstance(other, Flags):
            return NotImplemented
        own, others = self._values, other._values
        if own == others:
            return True
        return all(getattr(self, name) == getattr(other, name) for name in own.keys() | others.keys())

    def __hash__(self) -> int:
        return NAMES


NAMES = hash(Flags())
"""Numba's hash is of the names of all options, whatever they are set to."""
