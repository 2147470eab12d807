"""Parts: kernels that are machine code only inside of what calls them.

Numba optimises every function and turns it into machine code on its own, then links it into each of its callers, and
optimises and translates it there again. A kernel that only kernels call is never run from its own copy. So it is left
as it was lowered, as LLVM's intermediate code, in memory and in the cache; it is optimised once with all that surrounds
it, where it is used. A first run of the J-well takes a third less time for it.

All of it is in classes of our own, which only our decorators name: functions of others are compiled by numba as ever.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering, NopythonTypeInference

from tautline.kernels.compiling.flags import KernelFlags
from tautline.kernels.compiling.indices import TrustedIndices
from tautline.kernels.compiling.lowering import KernelLower
from tautline.kernels.compiling.operators import Typing
from tautline.kernels.compiling.steps import INSTEAD, NEEDLESS
from tautline.kernels.compiling.target import spared
from tautline.kernels.machine.settings import PLAIN


class KernelLibrary(JITCodeLibrary):
    """Code of kernels, whose functions are only tidied before all that they call stands in one module.

    Numba has LLVM optimise each function by itself, in full, and then the module again. Tidied are values that have a
    place in memory, jumps and single instructions: a copy into each caller is then as small, for half of the time.
    """

    def _optimize_functions(self, ll_module: Any) -> None:
        """Tidy the functions of a module."""
        ll_module.data_layout = self._codegen._data_layout
        builder = self._codegen._pass_builder()
        tidy = llvm.create_new_function_pass_manager()
        tidy.add_sroa_pass()
        tidy.add_simplify_cfg_pass()
        tidy.add_instruction_combine_pass()
        tidy.add_simplify_cfg_pass()
        for function in ll_module.functions:
            if not function.is_declaration:
                tidy.run(function, builder)


class PartLibrary(KernelLibrary):
    """A function as it was lowered: neither optimised nor translated, and cached as LLVM's code."""

    @property
    def codegen(self) -> Any:
        """What numba hands the environment of a function to."""
        return _NoEnvironment(self._codegen)

    def _optimize_final_module(self) -> None:
        """Leave the code as it is."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """The code itself: nobody runs it, so that it may be given up by whoever links it in."""
        self._ensure_finalized()
        if self._shared_module is None:
            for function in self._final_module.functions:
                if not function.is_declaration and function.linkage == llvm.Linkage.external:
                    function.linkage = "linkonce_odr"
            self._shared_module = self._final_module
        return self._shared_module

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """There is no object code."""
        return self.serialize_using_bitcode()


class _NoEnvironment:
    """Numba's code generator for a part, which has no machine code that could refer to an environment."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing."""


class Reader:
    """Numba's target for parts that are read from the cache: its own, but for the class of the library."""

    def __init__(self, context: Any) -> None:
        """Take numba's target."""
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def codegen(self) -> Reader:
        """What reads a library."""
        return self

    def unserialize_library(self, stored: tuple[str, str, bytes]) -> JITCodeLibrary:
        """Make a library of what numba's own wrote."""
        name, _, data = stored
        part = PartLibrary(self._context.codegen(), name)
        part._final_module = llvm.parse_bitcode(data)
        part._finalize_final_module()
        return part


@register_pass(mutates_CFG=True, analysis_only=False)
class KernelLowering(NativeLowering):
    """Numba's last step."""

    _name = "kernel_lowering"

    library: type[JITCodeLibrary] = KernelLibrary

    @property
    def lowering_class(self) -> type[KernelLower]:
        """What translates a function."""
        return KernelLower

    def run_pass(self, state: Any) -> bool:
        """Lower the function to LLVM's code."""
        if state.library is None:
            state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
            state.library.enable_object_caching()
        return bool(super().run_pass(state))


@register_pass(mutates_CFG=True, analysis_only=False)
class PartLowering(KernelLowering):
    """The same, into a library that is a part."""

    _name = "part_lowering"
    library = PartLibrary


class KernelCompiler(CompilerBase):
    """Numba's own steps for compiled code, without those that find nothing to do in a kernel."""

    lowering: Any = KernelLowering
    indices: tuple[Any, ...] = ()
    """Steps after those that find the types."""

    def __init__(self, typing: Any, target: Any, *given: Any) -> None:
        super().__init__(Typing(typing), spared(target), *given)
        self.state.flags = KernelFlags(self.state.flags)

    def define_pipelines(self) -> list[Any]:
        """The steps."""
        steps = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes: list[Any] = []
        for step, why in steps.passes:
            if step in NEEDLESS:
                continue
            passes.append((self.lowering if step is NativeLowering else INSTEAD.get(step, step), why))
            if step is NopythonTypeInference:
                passes += [(extra, "indices of kernels") for extra in self.indices]
        steps.passes = passes
        steps.finalize()
        return [steps]


class PartCompiler(KernelCompiler):
    """The same, the last of them :class:`PartLowering`."""

    lowering = PartLowering


class OurCompiler(KernelCompiler):
    """For code of the core and of installed applications, none of which counts from the end of an array."""

    indices = (TrustedIndices,)


class OurPartCompiler(PartCompiler):
    """The same for a part."""

    indices = (TrustedIndices,)


def compiler_for(part: bool, ours: bool) -> type[CompilerBase]:
    """The compiler of a function; ``ours`` is that of the core and of installed applications."""
    if PLAIN:
        return Compiler
    if ours:
        return OurPartCompiler if part else OurCompiler
    return PartCompiler if part else KernelCompiler
