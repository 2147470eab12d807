"""Numba's steps over a function before it is translated, which look at the lives of variables once.

After three of its steps numba follows each variable through all blocks, and does so again where it writes down in which
block a variable ends, which is all that a kernel needs of it. A generator needs more: numba's own steps are left to it.
"""

from __future__ import annotations

from typing import Any

from numba.core import ir
from numba.core.compiler_machinery import register_pass
from numba.core.interpreter import Interpreter, peep_hole_delete_with_exit
from numba.core.ir_utils import build_definitions
from numba.core.rewrites import rewrite_registry
from numba.core.ssa import reconstruct_ssa
from numba.core.typed_passes import AnnotateTypes, NopythonRewrites, PreLowerStripPhis
from numba.core.untyped_passes import (
    GenericRewrites,
    InlineClosureLikes,
    InlineInlinables,
    IRProcessing,
    LiteralUnroll,
    ReconstructSSA,
    TranslateByteCode,
    WithLifting,
)


class Reading(Interpreter):
    """Numba's reading of Python's code, which looks for what leaves a ``with`` only where there is one."""

    def post_process(self, rules: list[Any], func_ir: Any) -> Any:
        """Apply the rules for what Python writes otherwise than numba wants it."""
        if not any(True for block in func_ir.blocks.values() for _ in block.find_insts(ir.EnterWith)):
            rules = [rule for rule in rules if rule is not peep_hole_delete_with_exit]
        return super().post_process(rules, func_ir)


@register_pass(mutates_CFG=True, analysis_only=False)
class Translated(TranslateByteCode):
    """Numba's form of a function, made of Python's."""

    _name = "kernel_translated"

    def run_pass(self, state: Any) -> bool:
        """Read the function."""
        state.func_ir = Reading(state.func_id).interpret(state.bc)
        return True


@register_pass(mutates_CFG=False, analysis_only=False)
class Rewriting(GenericRewrites):
    """What numba writes otherwise before it looks for types, such as a subscript that is a constant."""

    _name = "kernel_rewriting"

    def run_pass(self, state: Any) -> bool:
        """Apply every rule as long as it finds something."""
        if state.func_ir.is_generator:
            return bool(super().run_pass(state))
        blocks = state.func_ir.blocks
        for rule in rewrite_registry.rewrites["before-inference"]:
            rewrite, waiting = rule(state), list(blocks.items())
            while waiting:
                label, block = waiting.pop()
                if rewrite.match(state.func_ir, block, state.typemap, state.calltypes):
                    blocks[label] = rewrite.apply()
                    blocks[label].verify()
                    waiting.append((label, blocks[label]))
        return True


@register_pass(mutates_CFG=False, analysis_only=False)
class SingleAssignment(ReconstructSSA):
    """A name of its own for each value that a variable takes."""

    _name = "kernel_single_assignment"

    def run_pass(self, state: Any) -> bool:
        """Name them."""
        if state.func_ir.is_generator or state.locals:
            return bool(super().run_pass(state))
        state.func_ir = reconstruct_ssa(state.func_ir)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class StrippedPhis(PreLowerStripPhis):
    """Assignments where a block ends in place of choices where the next begins."""

    _name = "kernel_stripped_phis"

    def run_pass(self, state: Any) -> bool:
        """Write them."""
        if state.func_ir.is_generator:
            return bool(super().run_pass(state))
        state.func_ir = self._strip_phi_nodes(state.func_ir)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


NEEDLESS = {
    IRProcessing, WithLifting, InlineClosureLikes, InlineInlinables, LiteralUnroll, NopythonRewrites, AnnotateTypes,
}  # fmt: skip
"""Steps that find nothing to do: kernels have no closures, no Python objects, and no expressions of whole arrays.
Nobody reads their types beside their text, and how long variables live is looked at later."""
INSTEAD = {
    TranslateByteCode: Translated, GenericRewrites: Rewriting, ReconstructSSA: SingleAssignment,
    PreLowerStripPhis: StrippedPhis,
}  # fmt: skip
"""Steps of ours in place of numba's."""
