"""What operators of numbers and arrays give, remembered from function to function.

Numba looks for each operation among all of its templates, those of strings and lists too, and once more when it writes
LLVM's code. What they give for numbers, arrays and tuples does not change while a process runs.
"""

from __future__ import annotations

from typing import Any

from numba.core import types

from tautline.kernels.compiling.lanes import LanesType, MaskType

PLAIN = types.Number, types.Boolean, LanesType, MaskType, types.Array, types.BaseTuple, types.SliceType, types.NoneType
_known: dict[Any, Any] = {}


def signature_of_operation(operation: Any, given: tuple[types.Type, ...], look: Any) -> Any:
    """Signature of an operation of plain operands; ``look`` finds it where it is not known, and of any others."""
    is_operator = (
        isinstance(operation, types.Function) and getattr(operation.typing_key, "__module__", "") == "_operator"
    )
    if not is_operator or not all(isinstance(kind, PLAIN) for kind in given):
        return look()
    if (operation, given) not in _known:
        _known[operation, given] = look()
    return _known[operation, given]


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
