"""What operators of numbers and arrays give, remembered from function to function.

Numba looks for each operation among all of its templates, those of strings and lists too, and once more when it writes
LLVM's code. What they give for numbers, arrays and tuples does not change while a process runs.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba.core import types

from tautline.kernels.compiling.lanes import LanesType, MaskType

OPERANDS = (
    types.Number, types.Boolean, LanesType, MaskType, types.Array, types.BaseTuple, types.SliceType, types.NoneType,
)  # fmt: skip
"""Types of operands whose operations are remembered."""
_known: dict[tuple[types.Function, tuple[types.Type, ...]], Any] = {}


def signature_of_operation(function: Any, given: tuple[types.Type, ...], look: Callable[[], Any]) -> Any:
    """Signature of a call that ``look`` finds: once where it is of an operator with such operands.

    What is not found is not remembered: somebody may still tell numba of it.
    """
    is_operator = isinstance(function, types.Function) and getattr(function.typing_key, "__module__", "") == "_operator"
    if not is_operator or not all(isinstance(kind, OPERANDS) for kind in given):
        return look()
    found = _known.get((function, given)) or look()
    if found is not None:
        _known[function, given] = found
    return found


class Typing:
    """Numba's context for types, which remembers operations."""

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def resolve_function_type(self, function: Any, given: Any, named: Any) -> Any:
        """Signature of a call; None where there is none."""

        def look() -> Any:
            return self._context.resolve_function_type(function, given, named)

        return look() if named else signature_of_operation(function, tuple(given), look)
