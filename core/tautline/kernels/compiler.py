"""Numba's compiler, quicker: what it asks again and again is answered as it would, by a shorter way.

Each answer is the one that numba itself comes to; together they are a fifth of a first run. Nothing here depends on a
version but the names of what is replaced: where one is gone, its import fails in the first test.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from types import SimpleNamespace
from typing import Any

from numba.core import base, dispatcher, event, ir, postproc, types
from numba.core.targetconfig import ConfigStack, TargetConfig
from numba.core.transforms import canonicalize_cfg
from numba.core.types.functions import BaseFunction
from numba.core.typing import templates
from numba.core.typing.npydecl import NumpyRulesArrayOperator

NUMBERS = frozenset({types.Integer, types.Float, types.Boolean})
"""Types of numbers, whose operators have one meaning each."""
HOW_IT_IS_LINKED = frozenset({"forceinline", "no_cpython_wrapper", "no_cfunc_wrapper", "inline"})
"""Settings of the compiler that say where code goes and not what it does."""


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


# By the number of an object of settings: the object, its settings then, and what they mean.
_meanings: dict[int, tuple[Any, dict[str, Any], tuple[Any, ...]]] = {}


def _meaning() -> tuple[Any, ...]:
    """The settings under way that change what code does."""
    settings = ConfigStack.top_or_none()
    if settings is None:
        return ()
    values, known = settings._values, _meanings.get(id(settings))
    if known is None or known[1] != values:
        names = sorted(values.keys() - HOW_IT_IS_LINKED)
        known = settings, dict(values), (type(settings), *((name, str(values[name])) for name in names))
        _meanings[id(settings)] = known
    return known[2]


def _find_operators_of_numbers_once() -> None:
    """Find what an operator or function does for numbers once, and word no failure that leads to a success.

    Numba asks each of some forty candidates in turn, twice, in every round of finding types, and composes a message for
    each that does not fit.
    """
    as_written = BaseFunction.get_call_type
    known: dict[tuple[Any, ...], tuple[BaseFunction, Any]] = {}

    def get_call_type(self: BaseFunction, context: Any, args: Any, kws: Any) -> Any:
        if kws or not all(type(kind) in NUMBERS for kind in args):
            return as_written(self, context, args, kws)
        key = id(self), context, args, _meaning()
        if key not in known:
            # The function is kept, that no other one gets its number.
            known[key] = self, as_written(self, context, args, kws)
        return known[key][1]

    BaseFunction.get_call_type = get_call_type


def _compile_functions_of_numpy_once() -> None:
    """Compile what stands in for a function of NumPy or Python once, and not once more for callers that are inlined."""

    def _get_impl(self: Any, args: Any, kws: Any) -> Any:
        key = self.context, tuple(args), tuple(kws.items()), _meaning()
        found = self._impl_cache.get(key)
        return self._build_impl(key, args, kws) if found is None else found

    templates._OverloadFunctionTemplate._get_impl = _get_impl


def _list_variables_by_type() -> None:
    """List the variables of an instruction by the types of what it holds, the frequent ones first."""

    def gather(held: Any, found: list[ir.Var]) -> None:
        kind = type(held)
        if kind is ir.Var:
            found.append(held)
        elif kind is tuple or kind is list:
            for each in held:
                gather(each, found)
        elif kind is dict:
            for each in held.values():
                gather(each, found)
        elif isinstance(held, ir.Inst):
            found.extend(held.list_vars())

    def list_variables(self: ir.Inst, held: Any) -> list[ir.Var]:
        found: list[ir.Var] = []
        gather(held, found)
        return found

    def of_assignment(self: ir.Assign) -> list[ir.Var]:
        value = self.value
        if type(value) is ir.Var:
            return [value, self.target]
        return [*value.list_vars(), self.target] if isinstance(value, ir.Inst) else [self.target]

    ir.Inst._rec_list_vars = list_variables
    ir.Assign.list_vars = of_assignment


def _find_lifetimes_when_asked() -> None:
    """Find the lifetimes of variables after the last of the steps that change a function, and not after each."""
    as_written = postproc.PostProcessor.run

    def run(self: postproc.PostProcessor, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
        if emit_dels or self.func_ir.is_generator:
            as_written(self, emit_dels, extend_lifetimes)
            return
        self.func_ir.blocks = canonicalize_cfg(self.func_ir.blocks)
        self.func_ir.variable_lifetime = postproc.VariableLifetime(self.func_ir.blocks)
        self.func_ir.generator_info = None

    postproc.PostProcessor.run = run


def _load_declarations_when_there_are_new_ones() -> None:
    """Look through numba's declarations only if some were added since."""
    as_written = base.BaseContext.refresh
    kinds = templates.builtin_registry

    def refresh(self: base.BaseContext) -> None:
        bodies = (held for one in self._registries for held in (one.functions, one.getattrs, one.casts))
        count = [len(held) for held in (kinds.functions, kinds.attributes, kinds.globals, *bodies)]
        if self.__dict__.get("_count") != count:
            as_written(self)
            self._count = count

    base.BaseContext.refresh = refresh


def _tell_only_who_listens() -> None:
    """Make no event that nobody listens to: one for every call of LLVM, and two for every step of a function."""
    start, end, both = event.start_event, event.end_event, event.trigger_event

    def start_event(kind: str, data: Any = None) -> None:
        if event._registered.get(kind):
            start(kind, data)

    def end_event(kind: str, data: Any = None, exc_details: Any = None) -> None:
        if event._registered.get(kind):
            end(kind, data, exc_details)

    def trigger_event(kind: str, data: Any = None) -> AbstractContextManager[None]:
        return both(kind, data) if event._registered.get(kind) else nullcontext()

    def install_timer(kind: str, callback: Any) -> AbstractContextManager[None]:
        return nullcontext()

    event.start_event, event.end_event, event.trigger_event = start_event, end_event, trigger_event
    # A dispatcher notes how long each function took, and would be the one that listens.
    dispatcher.ev = SimpleNamespace(trigger_event=trigger_event, install_timer=install_timer)


_compare_settings_as_they_are_set()
_ask_only_arrays_for_their_operators()
_find_operators_of_numbers_once()
_compile_functions_of_numpy_once()
_list_variables_by_type()
_find_lifetimes_when_asked()
_load_declarations_when_there_are_new_ones()
_tell_only_who_listens()
