"""How compiled code calls what stands apart from it by its name (:mod:`tautline.kernels.separate`), in LLVM's code."""

from __future__ import annotations

from typing import Any, NamedTuple

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing import signature

from tautline.kernels.compiling.kernels import intrinsic_for
from tautline.kernels.compiling.types.kinds import kind_of
from tautline.kernels.memory import Form
from tautline.kernels.separate import StandIn, find


class Needed(NamedTuple):
    """Separate code that a caller needs, by name; numba calls it before it loads the caller from its cache."""

    name: str

    def __call__(self) -> None:
        """Have LLVM know the address of the code."""
        find(self.name)


def called_by_name(stub: StandIn, returned: Form, given: tuple[Form, ...], late: bool = False) -> None:
    """Tell numba how to call what a stub stands for: by its symbol, or late code by the address at a place."""
    needed, result, arguments = Needed(stub.symbol), kind_of(returned), tuple(map(kind_of, given))

    def call(typing, *given):
        def code(context, builder, _, values):
            needed()
            context.active_code_library._reload_init.add(needed)
            kind = context.call_conv.get_function_type(result, arguments)
            if late:
                callee = builder.load(_place(builder, kind.as_pointer(), needed.name))
            else:
                callee = cgutils.get_or_insert_function(builder.module, kind, needed.name)
            status, found = context.call_conv.call_function(builder, callee, result, arguments, values)
            with cgutils.if_unlikely(builder, status.is_error):
                context.call_conv.return_status_propagate(builder, status)
            return found

        return signature(result, *arguments), code

    # Numba asks for names of arguments, one by one.
    plain = stub.py_func.__code__
    names = ", ".join(plain.co_varnames[: plain.co_argcount])
    space: dict[str, Any] = {"call": call, "__name__": stub.py_func.__module__}
    exec(f"def {stub.__name__}(typing, {names}):\n    return call(typing, {names})", space)
    intrinsic_for(stub)(space[stub.__name__])


def _place(builder: Any, function: ir.Type, symbol: str) -> Any:
    """A place in memory that is known by its symbol, where the address of a function stands."""
    return builder.module.globals.get(symbol) or ir.GlobalVariable(builder.module, function, symbol)


def called_by_place(stub: Any, symbol: str) -> None:
    """Tell numba how to call a routine whose address stands at a place that is known by its symbol."""

    def call(typing, given):
        def code(context, builder, _, values):
            words = [
                context.cast(builder, word, actual, types.uintp)
                for word, actual in zip(cgutils.unpack_tuple(builder, values[0]), given.types, strict=True)
            ]
            function = ir.FunctionType(ir.VoidType(), [word.type for word in words]).as_pointer()
            builder.call(builder.load(_place(builder, function, symbol)), words)
            return context.get_dummy_value()

        return types.void(given), code

    intrinsic_for(stub)(call)


def called_at(stub: Any) -> None:
    """Tell numba how to call a C function of time and four arrays, which is known by its address."""

    def call(typing, address, t, q, v, f, k):
        def code(context, builder, signature, given):
            double, word = ir.DoubleType(), ir.IntType(64)
            pointer = double.as_pointer()
            kind = ir.FunctionType(ir.VoidType(), [double, pointer, pointer, pointer, word])
            arrays = [
                context.make_array(array)(context, builder, x).data
                for array, x in zip(signature.args[2:5], given[2:5], strict=True)
            ]
            builder.call(builder.inttoptr(given[0], kind.as_pointer()), [given[1], *arrays, given[5]])
            return context.get_dummy_value()

        return types.void(address, t, q, v, f, k), code

    intrinsic_for(stub)(call)
