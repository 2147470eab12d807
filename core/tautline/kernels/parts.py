"""Parts: kernels that are machine code only inside of what calls them.

Numba optimises every function and turns it into machine code on its own, then links it into each of its callers, and
optimises and translates it there again. A kernel that only kernels call is never run from its own copy. So it is left
as it was lowered, as LLVM's intermediate code, in memory and in the cache; it is optimised once with all that surrounds
it, where it is used. A first run of the J-well takes a third less time for it.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import CPUCodeLibrary, JITCPUCodegen
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering, NopythonRewrites
from numba.core.untyped_passes import InlineClosureLikes, InlineInlinables, LiteralUnroll, WithLifting


@register_pass(mutates_CFG=True, analysis_only=False)
class PartLowering(NativeLowering):
    """Numba's last step, into a library that is a part."""

    _name = "part_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower the function to LLVM's code."""
        if state.library is None:
            state.library = state.targetctx.codegen().create_library(state.func_id.func_qualname)
        state.library.is_part = True
        return super().run_pass(state)


NEEDLESS = {WithLifting, InlineClosureLikes, InlineInlinables, LiteralUnroll, NopythonRewrites}
"""Steps that find nothing to do: kernels have no closures, no Python objects, and no expressions of whole arrays."""


class KernelCompiler(CompilerBase):
    """Numba's own steps for compiled code, without those that find nothing to do in a kernel."""

    lowering = NativeLowering

    def define_pipelines(self) -> list[Any]:
        """The steps."""
        steps = DefaultPassBuilder.define_nopython_pipeline(self.state)
        needed = [(step, why) for step, why in steps.passes if step not in NEEDLESS]
        steps.passes = [(self.lowering if step is NativeLowering else step, why) for step, why in needed]
        steps.finalize()
        return [steps]


class PartCompiler(KernelCompiler):
    """The same, the last of them :class:`PartLowering`."""

    lowering = PartLowering


def _keep_parts() -> None:
    """Have numba's libraries know parts: neither optimised nor translated, and cached as LLVM's code.

    The LLVM code of a whole, which only a caller that is compiled later needs, is read when it is asked for.
    """
    optimise, finish = CPUCodeLibrary._optimize_final_module, CPUCodeLibrary._finalize_final_module
    store, for_linking = CPUCodeLibrary.serialize_using_object_code, CPUCodeLibrary._get_module_for_linking
    set_env = JITCPUCodegen.set_env

    def optimise_whole(self: CPUCodeLibrary) -> None:
        if not self.is_part:
            optimise(self)

    def finish_whole(self: CPUCodeLibrary) -> None:
        if not self.is_part:
            return finish(self)
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def store_as_it_is(self: CPUCodeLibrary) -> tuple[Any, ...]:
        if self.is_part:
            return self.serialize_using_bitcode()
        name, kind, (code, bitcode) = store(self)
        module = self._final_module
        symbols = [s.name for held in (module.functions, module.global_variables) for s in held if not s.is_declaration]
        return name, kind, (code, bitcode, symbols)

    def load_as_it_is(cls: type, codegen: Any, stored: tuple[Any, ...]) -> CPUCodeLibrary:
        name, kind, data = stored
        library = codegen.create_library(name)
        if kind == "bitcode":
            library.is_part = True
            library._final_module = llvm.parse_bitcode(data)
        else:
            code, library.unread, symbols = data
            library.enable_object_caching()
            library._set_compiled_object(code)
            codegen._engine._defined_symbols.update(symbols)
        library._finalize_final_module()
        return library

    def read_for_linking(self: CPUCodeLibrary) -> Any:
        # A run that compiles nothing never asks for it.
        if self.unread is not None:
            self._shared_module, self.unread = llvm.parse_bitcode(self.unread), None
        return for_linking(self)

    def set_env_of_whole(self: JITCPUCodegen, name: str, env: Any) -> None:
        # A part has no machine code that could refer to its environment.
        if self._engine.is_symbol_defined(name):
            set_env(self, name, env)

    CPUCodeLibrary.is_part, CPUCodeLibrary.unread = False, None
    CPUCodeLibrary._get_module_for_linking = read_for_linking
    CPUCodeLibrary._optimize_final_module = optimise_whole
    CPUCodeLibrary._finalize_final_module = finish_whole
    CPUCodeLibrary.serialize_using_object_code = store_as_it_is
    CPUCodeLibrary._unserialize = classmethod(load_as_it_is)
    JITCPUCodegen.set_env = set_env_of_whole


_keep_parts()
