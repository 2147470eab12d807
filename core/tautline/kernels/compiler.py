"""Numba's compiler, quicker: what it asks again and again is answered as it would, by a shorter way.

Each answer is the one that numba itself comes to; together they are some per cent of a first run. Nothing here
depends on a version but the names of what is replaced: where one is gone, its import fails in the first test.
"""

from __future__ import annotations

from typing import Any

from numba.core import ir, types
from numba.core.targetconfig import TargetConfig
from numba.core.typing.npydecl import NumpyRulesArrayOperator

PLAIN = frozenset({str, int, float, bool, type(None), ir.Loc})
"""Types of what an instruction may hold besides variables and instructions."""


def _compare_settings_as_they_are_set() -> None:
    """Compare settings of the compiler by those that were set.

    They are compared at every operator that is compiled, one by one with their defaults; their hash is that of their
    names, the same for all.
    """
    as_written = TargetConfig.__eq__

    def equal(self: TargetConfig, other: Any) -> Any:
        if self is other:
            return True
        if type(self) is not type(other):
            return as_written(self, other)
        set_here = self._values.keys() | other._values.keys()
        return self._values == other._values or all(getattr(self, name) == getattr(other, name) for name in set_here)

    TargetConfig.__eq__ = equal
    TargetConfig.__hash__ = lambda self: hash(type(self))


def _ask_only_arrays_for_their_operators() -> None:
    """Look for NumPy's operator on arrays only where there is an array; for two numbers the answer is always none."""
    as_written = NumpyRulesArrayOperator.generic

    def generic(self: NumpyRulesArrayOperator, args: Any, kws: Any) -> Any:
        if not any(isinstance(kind, types.ArrayCompatible) for kind in args):
            return None
        return as_written(self, args, kws)

    NumpyRulesArrayOperator.generic = generic


def _list_variables_by_type() -> None:
    """List the variables of an instruction by the types of what it holds, the frequent ones first."""
    as_written = ir.Inst._rec_list_vars

    def list_variables(self: ir.Inst, held: Any) -> list[ir.Var]:
        kind = type(held)
        if kind is ir.Var:
            return [held]
        return [] if kind in PLAIN else as_written(self, held)

    ir.Inst._rec_list_vars = list_variables


_compare_settings_as_they_are_set()
_ask_only_arrays_for_their_operators()
_list_variables_by_type()
