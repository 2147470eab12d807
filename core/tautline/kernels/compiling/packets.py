"""How compiled code takes its arguments from a packet (:mod:`tautline.kernels.machine.packet`), in LLVM's code."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from numba.core import cgutils, types

from tautline.kernels.compiling.kernels import intrinsic_for
from tautline.kernels.jit import run_at
from tautline.kernels.machine.packet import HEAD


@intrinsic_for(run_at, prefer_literal=True)
def _run(typing, kind, packet):
    arguments, returned = kind.instance_type.types
    given = tuple(arguments.types)

    def code(context, builder, _, values):
        word = context.get_value_type(types.intp)
        base = builder.inttoptr(values[1], word.as_pointer())
        kind_of = context.call_conv.get_function_type(returned, given)
        function = builder.inttoptr(builder.load(base), kind_of.as_pointer())
        parts, at = [], HEAD
        for kind in given:
            parts.append(_argument(context, builder, builder.gep(base, [word(at)]), kind))
            at += max(1, context.get_abi_sizeof(context.get_value_type(kind)) // context.get_abi_sizeof(word))
        status, found = context.call_conv.call_function(builder, function, returned, given, parts)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        for i, x in enumerate(_numbers(context, builder, found, returned)):
            place = builder.gep(base, [word(1 + i)])
            builder.store(x, builder.bitcast(place, x.type.as_pointer()))
        return context.get_dummy_value()

    return types.void(kind, packet), code


def _argument(context: Any, builder: Any, place: Any, kind: types.Type) -> Any:
    """An argument from where it begins; a yes or no has a word of its own."""
    if isinstance(kind, types.Boolean):
        return context.cast(builder, builder.load(place), types.int64, kind)
    return builder.load(builder.bitcast(place, context.get_value_type(kind).as_pointer()))


def _numbers(context: Any, builder: Any, x: Any, kind: types.Type) -> Iterator[Any]:
    """What was given back, number by number: whole ones in words, all others in floats."""
    if isinstance(kind, types.BaseTuple):
        for i, part in enumerate(kind.types):
            yield from _numbers(context, builder, builder.extract_value(x, i), part)
    elif isinstance(kind, types.Float):
        yield context.cast(builder, x, kind, types.float64)
    elif not isinstance(kind, types.NoneType):
        yield context.cast(builder, x, kind, types.int64)
