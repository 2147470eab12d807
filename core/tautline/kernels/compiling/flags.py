"""Flags of a kernel's compilation, compared by what is set.

As it finds types, numba asks for each operation whether it has met it under the same flags, and compares all options of
both by name: a tenth of the time that it takes to compile a kernel. Nearly always the same ones are set to the same
values, which one look at both tables tells.
"""

from __future__ import annotations

from typing import Any

from numba.core.compiler import Flags


class KernelFlags(Flags):
    """Numba's flags, equal to others where numba's are."""

    __slots__ = ()

    def __eq__(self, other: object) -> Any:
        if isinstance(other, KernelFlags) and self._values == other._values:
            return True
        return Flags.__eq__(self, other)

    def __hash__(self) -> int:
        return NAMES


NAMES = hash(Flags())
"""Numba's hash is of the names of all options, whatever they are set to."""
