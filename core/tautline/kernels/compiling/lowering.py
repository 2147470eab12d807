"""Values that are assigned once need no place in memory.

Numba gives each variable that two blocks of a function know a place on the stack, writes it there, and reads it again
at each use. A record of a scene has some two hundred parts, and LLVM takes every such reading apart before it finds
that nothing has happened in between.
"""

from __future__ import annotations

import operator
from collections import Counter, defaultdict
from collections.abc import Iterable
from typing import Any

from numba.core import ir, types
from numba.core.analysis import must_use_alloca
from numba.core.lowering import Lower
from numba.core.postproc import VariableLifetime
from numba.core.typing.templates import Signature

from tautline.kernels.compiling.operators import signature_of_operation


def values_of(blocks: dict[int, ir.Block], lives: VariableLifetime | None = None) -> set[str]:
    """Variables whose only assignment comes before all that uses them, on every way and in the text.

    ``lives`` is what numba has found of the blocks as they are.
    """
    lives = lives or VariableLifetime(blocks)
    read_first = lives.usedefs.usemap  # by block, what it reads before it writes it, if it does
    assigned: Counter[str] = Counter()
    where: dict[str, int] = {}
    users = defaultdict(set)
    for label, block in blocks.items():
        for name in read_first[label]:
            users[name].add(label)
        for statement in block.find_insts(ir.Assign):
            assigned[statement.target.name] += 1
            where[statement.target.name] = label
        for statement in block.find_insts(ir.Del):
            users[statement.value].add(label)
    dominators = lives.cfg.dominators()
    in_memory = must_use_alloca(blocks)
    return {
        name
        for name, label in where.items()
        if assigned[name] == 1
        and name not in in_memory
        and name not in read_first[label]
        and all(user == label or (user > label and label in dominators.get(user, ())) for user in users[name])
    }


_types: dict[Any, types.Type] = {}
"""Numba's types of operations: for each it first finds, with an error that nobody reads, that it is no value."""


class KernelLower(Lower):
    """Numba's translation of a function to LLVM's code."""

    def _find_singly_assigned_variable(self) -> None:
        """Find the variables that numba leaves without a place in memory."""
        if self.func_ir.func_id.is_generator:
            super()._find_singly_assigned_variable()
            return
        self._singly_assigned_vars: set[str] = values_of(self.func_ir.blocks, self.func_ir.variable_lifetime)
        self._blk_local_varmap: dict[str, Any] = {}

    def lower_binop(self, kind: types.Type, expression: ir.Expr, operation: Any) -> Any:
        """Write an operation of two operands."""
        if expression.static_lhs is not ir.UNDEFINED or expression.static_rhs is not ir.UNDEFINED:
            return super().lower_binop(kind, expression, operation)
        wanted = self.fndesc.calltypes[expression]
        given = self._cast_vars((expression.lhs, expression.rhs), wanted.args)
        found = self._code_of(operation, wanted.args)(self.builder, given)
        return self.context.cast(self.builder, found, wanted.return_type, kind)

    def lower_getitem(
        self, kind: types.Type, expression: ir.Expr, array: ir.Var, index: ir.Var, wanted: Signature
    ) -> Any:
        """Write what reads an element."""
        given = self._cast_vars((array, index), wanted.args)
        found = self._code_of(operator.getitem, wanted.args)(self.builder, given)
        return self.context.cast(self.builder, found, wanted.return_type, kind)

    def lower_setitem(self, array: ir.Var, index: ir.Var, value: ir.Var, wanted: Signature) -> Any:
        """Write what changes an element."""
        if isinstance(self.typeof(array.name), types.Optional):
            return super().lower_setitem(array, index, value, wanted)
        given = [self.loadvar(array.name), *self._cast_vars((index, value), wanted.args[1:])]
        return self._code_of(operator.setitem, wanted.args)(self.builder, given)

    def _cast_vars(self, variables: Iterable[ir.Var], kinds: Iterable[types.Type]) -> list[Any]:
        """Values of variables as those types."""
        return [self._cast_var(variable, kind) for variable, kind in zip(variables, kinds, strict=True)]

    def _code_of(self, operation: Any, given: tuple[types.Type, ...]) -> Any:
        """What writes an operation for operands of those types."""
        typing = self.context.typing_context
        function = _types.get(operation)
        if function is None:
            function = _types[operation] = typing.resolve_value_type(operation)
        called = signature_of_operation(function, given, lambda: function.get_call_type(typing, given, {}))
        return self.context.get_function(function, called)
