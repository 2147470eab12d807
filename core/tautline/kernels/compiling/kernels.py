"""Kernels as numba compiles them: what it is told of them, and machine code for those that stand alone."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba.core import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.event import trigger_event
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.sigutils import normalize_signature
from numba.core.typing.templates import AbstractTemplate, infer, infer_global, make_intrinsic_template
from numba.extending import overload

from tautline.kernels.compiling.caching import PartCache
from tautline.kernels.compiling.errors import KernelError
from tautline.kernels.compiling.inlined import compiler_for
from tautline.kernels.compiling.signatures import signature_of
from tautline.kernels.compiling.types.kinds import form_of_returned, kind_of
from tautline.kernels.machine.code import Stored
from tautline.kernels.machine.settings import PLAIN
from tautline.kernels.machine.sources import is_ours
from tautline.kernels.memory import Form


class Inner(CPUDispatcher):
    """A function that compiled code calls."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Compile for a call; once for all whole numbers, not once more for each that stands in a call.

        Where the code is inlined the number is still known, and what depends on it is left out there.
        """
        if PLAIN:
            return super().get_call_template(args, kws)
        kinds = tuple(types.unliteral(kind) if isinstance(kind, types.IntegerLiteral) else kind for kind in args)
        return super().get_call_template(kinds, kws)

    def compile(self, sig: Any) -> Any:
        """Compile for a signature, or load: as numba does, without its two timers around it.

        Each function that is being compiled, of those around this one too, would be told of each call of LLVM.
        """
        if PLAIN or not self._can_compile:
            return super().compile(sig)
        with global_compiler_lock, self._compiling_counter:
            given, returned = normalize_signature(sig)
            known = self.overloads.get(tuple(given))
            if known is not None:
                return known.entry_point
            made = self._cache.load_overload(sig, self.targetctx)
            if made is None:
                self._cache_misses[sig] += 1
                told = {"dispatcher": self, "args": given, "return_type": returned}
                with trigger_event("numba:compile", data=told):
                    made = self._compiler.compile(given, returned)
                self._cache.save_overload(sig, made)
            else:
                self._cache_hits[sig] += 1
                self.targetctx.insert_user_function(made.entry_point, made.fndesc, [made.library])
            self.add_overload(made)
            return made.entry_point


def dispatcher_of(kernel: Any) -> Inner:
    """What numba's ``njit`` makes of a function, without its decorator, which takes as long again."""
    function = kernel.py_func
    function.__signature__ = signature_of(function)
    made = Inner(function, {}, dict(kernel.targetoptions), pipeline_class=compiler_for(kernel.part, is_ours(function)))
    if kernel.part:
        made._cache = PartCache(function)
    return made


def compile_whole(compiled: Inner, forms: tuple[Form, ...]) -> tuple[int, Stored]:
    """Compile a function for the forms of its arguments: its address in this process, and what is kept of it."""
    signature = tuple(map(kind_of, forms))
    with global_compiler_lock:
        try:
            compiled.compile(signature)
        except KernelError as error:
            # Behind it are 150 lines of numba's steps; the error has what it said.
            raise error.with_traceback(None) from None
        return _compiled(compiled.overloads[signature])


def _compiled(found: Any) -> tuple[int, Stored]:
    """Address and contents of what numba has compiled."""
    library, symbol = found.library, found.fndesc.llvm_func_name
    address = int(library.get_pointer_to_function(symbol))
    module = library._final_module
    needed = [each.name for each in (*module.functions, *module.global_variables) if each.is_declaration]
    needed = [name for name in needed if not name.startswith("llvm.")]
    returned = form_of_returned(found.signature.return_type)
    return address, Stored(symbol, returned, tuple(needed), bytes(library._get_compiled_object()))


def forget(compiled: Inner, forms: tuple[Form, ...]) -> None:
    """Have numba forget what it has compiled for the forms of some arguments, and what our intrinsics wrote for types.

    A kind of group that is registered anew has the same type, and other hooks.
    """
    compiled.overloads.pop(tuple(map(kind_of, forms)), None)
    for template in _templates:
        template._impl_cache.clear()


_templates: list[Any] = []
"""What numba asks for the intrinsics that are defined here; each remembers what it was given."""


def make_ready() -> None:
    """Have numba name the routines of its own that machine code may call."""
    with global_compiler_lock:
        cpu_target.target_context.refresh()


def is_array(kind: types.Type) -> bool:
    """Whether this is the type of an array."""
    return isinstance(kind, types.Array)


def overloaded(stub: Any, choose: Any, options: dict[str, Any]) -> None:
    """Tell numba what compiled code calls for a stub: a function of types gives it."""
    given = {"pipeline_class": compiler_for(True, is_ours(choose)), "no_cfunc_wrapper": True}
    overload(stub, jit_options=given, **options)(choose)


def intrinsic_for(stub: Any, *, prefer_literal: bool = False) -> Callable[[Any], Any]:
    """Decorator of the code of a stub: a function of types that gives a signature and what writes LLVM's code."""

    def registered(defined: Any) -> Any:
        template = make_intrinsic_template(stub, defined, stub.__name__, prefer_literal=prefer_literal)
        infer(template)
        infer_global(stub, types.Function(template))
        _templates.append(template)
        return defined

    return registered


def chosen_by_type(stub: Any, table: dict[type, Any]) -> None:
    """Tell numba that a call of a stub is one of the kernel that a table has for the class of its first argument."""

    class Choice(AbstractTemplate):
        """What numba takes the call for: one of the kernel."""

        key = stub

        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
            """Signature of the kernel for these arguments."""
            self._kernel = types.Dispatcher(table[args[0].instance_class].compiled)
            return self._kernel.get_call_type(self.context, args, kws)

        def get_impl_key(self, sig: Any) -> Any:
            """Where numba finds the kernel's code."""
            return self._kernel.get_impl_key(sig)

    infer_global(stub, types.Function(Choice))
