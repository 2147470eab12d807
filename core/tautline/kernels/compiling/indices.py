"""Indices as they stand: none counts from the end of its array.

Numba makes a negative index count from the end, which takes three instructions for every index and keeps loops from
being vectorised: a fifth to a third of the run time. It does so for signed indices only. So the step below, of our own
compilers alone, has it take the index of an array as unsigned: the same 64 bits. With ``NUMBA_BOUNDSCHECK=1`` a
negative index in a kernel is an IndexError.
"""

from __future__ import annotations

from typing import Any

from numba.core import ir, types, typing
from numba.core.compiler_machinery import FunctionPass, register_pass


@register_pass(mutates_CFG=False, analysis_only=False)
class TrustedIndices(FunctionPass):
    """Takes indices of arrays as unsigned, once types are known; literals that are negative stay what they are."""

    _name = "trusted_indices"

    def __init__(self) -> None:
        FunctionPass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Change the types that a function's subscripts are lowered for."""
        calltypes = state.calltypes
        for each, signature in list(calltypes.items()):
            if signature is None or not _is_subscript(each):
                continue
            array, index, *rest = signature.args
            if not isinstance(array, types.Buffer) or _is_negative(getattr(each, "index", None)):
                continue
            del calltypes[each]  # numba's table takes each key once
            calltypes[each] = typing.signature(signature.return_type, array, unsigned(index), *rest)
        return True


def _is_subscript(each: Any) -> bool:
    if isinstance(each, ir.Expr):
        return each.op in ("getitem", "static_getitem")
    return isinstance(each, (ir.SetItem, ir.StaticSetItem))


def _is_negative(index: Any) -> bool:
    parts = index if isinstance(index, tuple) else (index,)
    return any(isinstance(part, int) and part < 0 for part in parts)


def unsigned(index: types.Type) -> types.Type:
    """The type of an index that does not count from the end."""
    if isinstance(index, types.BaseTuple):
        return types.BaseTuple.from_types([unsigned(part) for part in index])
    if isinstance(index, types.IntegerLiteral) and index.literal_value < 0:
        return index
    return types.uintp if isinstance(index, types.Integer) and index.signed else index
