"""How groups' kernels are called by their addresses (:mod:`tautline.kernels.groups`), in LLVM's code."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.np.arrayobj import make_array, populate_array

from tautline.kernels.compiling.errors import error_of_hook
from tautline.kernels.compiling.kernels import intrinsic_for
from tautline.kernels.compiling.raises import refuse_raising
from tautline.kernels.compiling.types.kinds import kind_of
from tautline.kernels.compiling.types.records import Record
from tautline.kernels.groups import CALLS, KINDS, ROWS, SUMS, apply
from tautline.kernels.machine.sources import comes_with_us


@intrinsic_for(apply, prefer_literal=True)
def _apply(typing, row, kind, group, arguments):
    """Call the kernel of a kind of group for the sum in a row; group and arguments are taken from their addresses."""
    if not isinstance(row, types.IntegerLiteral):
        return None  # numba tries again so after an error, which it then reports
    hook, expected, _ = list(SUMS.values())[row.literal_value]
    member, given_types = kind.instance_type, tuple(map(kind_of, expected.values()))
    compiled = _compiled(member.instance_class, hook, (member, *given_types))
    kernel: Any = KINDS[member.instance_class].hooks[hook]
    ours = comes_with_us(kernel.py_func)

    def code(context, builder, _, given):
        g = builder.load(builder.inttoptr(given[2], context.get_value_type(member).as_pointer()))
        packet = builder.load(builder.inttoptr(given[3], _packet(context, given_types).as_pointer()))
        rest = [_unpacked(context, builder, builder.extract_value(packet, i), t) for i, t in enumerate(given_types)]
        context.add_linking_libs([compiled.library])
        # Written out here: arrays of a group that are handed over one by one are half of the work of a small one.
        callee = context.declare_function(builder.module, compiled.fndesc)
        status, _ = context.call_conv.call_function(
            builder, callee, types.none, compiled.signature.args, [g, *rest], attrs=("alwaysinline",)
        )
        with cgutils.if_unlikely(builder, status.is_error):
            if not ours:
                _spoil(context, builder, expected, rest)
            context.call_conv.return_status_propagate(builder, status)
        return context.get_dummy_value()

    return types.void(row, kind, group, arguments), code


WRITTEN = ("r", "e", "p", "matrix")
"""Arguments into which a hook writes what it computes."""


def _spoil(context: Any, builder: Any, expected: dict[str, Any], given: list[Any]) -> None:
    """Make what a hook has written no number, for it raised: the sum lacks the rest, and the run must not go on."""
    for name, x in zip(expected, given, strict=True):
        t: Any = kind_of(expected[name])
        if name in WRITTEN and _is_vector(t):
            array = make_array(t)(context, builder, x)
            with cgutils.for_range(builder, array.nitems) as loop:
                builder.store(ir.Constant(ir.DoubleType(), float("nan")), builder.gep(array.data, [loop.index]))


def _compiled(kind: type, hook: str, signature: tuple[types.Type, ...]) -> Any:
    """What numba makes of a kind's hook; a mistake in a hook of others is told to them."""
    kernel = KINDS[kind].hooks[hook]
    function, ours = kernel.compiled, comes_with_us(kernel.py_func)
    if signature not in function.overloads:
        if not ours:
            refuse_raising(kind, hook, kernel.py_func)
        try:
            function.compile(signature)
        except Exception as error:
            if ours:
                raise
            raise error_of_hook(kind, hook, kernel.py_func, error) from None
    return function.overloads[signature]


def _is_vector(t: types.Type) -> bool:
    return isinstance(t, types.Array) and t.ndim == 1


def _packet(context: Any, given: tuple[types.Type, ...]) -> ir.Type:
    """How the arguments of a hook lie in memory: vectors as pointer and size, records by their address, all else as
    numba holds it. A matrix and the map of unknowns are a hundred words, of which a group uses a few."""
    size = context.get_value_type(types.intp)

    def part(t: types.Type) -> ir.Type:
        if isinstance(t, Record):
            return size
        if _is_vector(t):
            return ir.LiteralStructType([context.get_data_type(t.dtype).as_pointer(), size])
        return context.get_value_type(t)

    return ir.LiteralStructType([part(t) for t in given])


def _packed(context: Any, builder: Any, x: Any, t: types.Type) -> Any:
    if isinstance(t, Record):
        place = context.data_model_manager[t].as_argument(builder, x)
        return builder.ptrtoint(place, context.get_value_type(types.intp))
    if not _is_vector(t):
        return x
    array = make_array(t)(context, builder, x)
    packed = cgutils.get_null_value(_packet(context, (t,)).elements[0])
    packed = builder.insert_value(packed, array.data, 0)
    return builder.insert_value(packed, array.nitems, 1)


def _unpacked(context: Any, builder: Any, x: Any, t: types.Type) -> Any:
    if isinstance(t, Record):
        return builder.load(builder.inttoptr(x, context.get_value_type(t).as_pointer()))
    if not _is_vector(t):
        return x
    array = make_array(t)(context, builder)
    size, step = builder.extract_value(x, 1), context.get_constant(types.intp, t.dtype.bitwidth // 8)
    populate_array(array, builder.extract_value(x, 0), [size], [step], step, None)
    return array._getvalue()


def _called(row: int, expected: tuple[types.Type, ...]) -> Any:
    """How compiled code calls the code at an address with a group and the arguments of a sum."""

    def call(typing, address, group, arguments):
        def code(context, builder, signature, values):
            given = cgutils.unpack_tuple(builder, values[2])
            cast = [
                context.cast(builder, x, actual, wanted)
                for x, actual, wanted in zip(given, arguments.types, expected, strict=True)
            ]
            place = cgutils.alloca_once(builder, _packet(context, expected))
            for i, (x, wanted) in enumerate(zip(cast, expected, strict=True)):
                builder.store(_packed(context, builder, x, wanted), cgutils.gep_inbounds(builder, place, 0, i))
            at = builder.ptrtoint(place, context.get_value_type(types.intp))
            signature = (types.literal(row), types.TypeRef(types.none), types.intp, types.intp)
            function = context.call_conv.get_function_type(types.none, signature)
            result, error = (cgutils.alloca_once(builder, t.pointee) for t in function.args[:2])
            constant = [context.get_constant(types.intp, row), cgutils.get_null_value(function.args[3])]
            builder.call(builder.inttoptr(values[0], function.as_pointer()), [result, error, *constant, values[1], at])
            return context.get_dummy_value()

        return types.void(address, group, arguments), code

    return call


for _name, _stub in CALLS.items():
    intrinsic_for(_stub)(_called(ROWS[_name], tuple(map(kind_of, SUMS[_name].arguments.values()))))
