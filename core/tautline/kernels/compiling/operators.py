"""What operators of numbers and arrays give, remembered from function to function.

Numba looks for each operation among all of its templates, those of strings and lists too, and once more when it writes
LLVM's code. What they give for numbers, arrays and tuples does not change while a process runs. A subscript alone is
looked for a thousand times in a first run, among some fifteen templates.
"""

from __future__ import annotations

from collections.abc import Callable
from types import BuiltinFunctionType, FunctionType
from typing import Any

from numba.core import types

from tautline.kernels.compiling.target import refresh_where_grown
from tautline.kernels.compiling.types.lanes import LanesType, MaskType

OPERANDS = (
    types.Number, types.Boolean, LanesType, MaskType, types.Array, types.BaseTuple, types.SliceType, types.NoneType,
    types.RangeType, types.RangeIteratorType,
)  # fmt: skip
"""Types of operands whose operations are remembered."""
HOLDERS = (types.BaseTuple, types.Record, types.Array)
"""Types whose parts are remembered."""
OTHERS = ("getiter", "iternext", bool, range)
"""Operations beside the operators, as numba names them: those of loops over whole numbers, and of conditions."""
NAMED = (FunctionType, BuiltinFunctionType, type)
"""What may be a function that numba knows by its templates, among the values that a function names."""
_functions: dict[Any, types.Function] = {}
"""Numba's types of such functions, until a registry grows: one of more templates is another type."""
_parts: dict[tuple[types.Type, str], types.Type] = {}
"""Types of parts of records, and of what arrays tell of themselves."""
_known: dict[tuple[Any, tuple[types.Type, ...]], Any] = {}


def signature_of_operation(function: Any, given: tuple[types.Type, ...], look: Callable[[], Any]) -> Any:
    """Signature of a call that ``look`` finds: once where it is of an operator with such operands.

    What is not found is not remembered: somebody may still tell numba of it.
    """
    if not _is_operation(function) or not all(isinstance(kind, OPERANDS) for kind in given):
        return look()
    found = _known.get((function, given)) or look()
    if found is not None:
        _known[function, given] = found
    return found


def _is_operation(function: Any) -> bool:
    """Whether numba is asked for an operation: by its type, as it is, or by a name."""
    key = function.typing_key if isinstance(function, types.Function) else function
    return getattr(key, "__module__", "") == "_operator" or any(key is each for each in OTHERS)


class Typing:
    """Numba's context for types, which remembers operations."""

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def refresh(self) -> None:
        """Look through the registries, if one has grown."""
        if refresh_where_grown(self._context):
            _functions.clear()

    def resolve_value_type(self, value: Any) -> Any:
        """Type of a value that a function names.

        Numba first finds, with an error that nobody reads, that a function is no number.

        Raises
        ------
        ValueError
            For a value without a type.
        """
        if not isinstance(value, NAMED):
            return self._context.resolve_value_type(value)
        found = _functions.get(value)
        if found is None:
            found = self._context.resolve_value_type(value)
            if isinstance(found, types.Function):
                _functions[value] = found
        return found

    def resolve_function_type(self, function: Any, given: Any, named: Any) -> Any:
        """Signature of a call; None where there is none."""

        def look() -> Any:
            return self._context.resolve_function_type(function, given, named)

        return look() if named else signature_of_operation(function, tuple(given), look)

    def resolve_getattr(self, kind: types.Type, name: str) -> Any:
        """Type of a part of a value; None where it has none of that name."""
        found = _parts.get((kind, name))
        if found is None:
            found = self._context.resolve_getattr(kind, name)
            if isinstance(kind, HOLDERS) and found is not None and not isinstance(found, types.Callable):
                _parts[kind, name] = found
        return found
