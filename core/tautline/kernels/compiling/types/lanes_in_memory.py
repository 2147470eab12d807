"""Lanes from memory and to it, in LLVM's code.

What each function does is said, and done by NumPy, in :mod:`tautline.kernels.lanes.memory`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.np.arrayobj import make_array, populate_array

from tautline.kernels.compiling.types.lanes import (
    BITS,
    INDEX,
    LANE,
    MASK,
    NUMBERS,
    as_lanes,
    choice_of,
    lowered,
    mask_of,
    splat,
)
from tautline.kernels.lanes import memory
from tautline.kernels.lanes.arithmetic import LANES


def _is_vector(kind: types.Type) -> bool:
    return isinstance(kind, types.Array) and kind.ndim == 1


def _pointer(context: Any, builder: Any, kind: types.Array, array: Any, i: Any) -> Any:
    """Where entry i of an array of one dimension is, which may be a field of records."""
    held = make_array(kind)(context, builder, array)
    if kind.layout == "C":
        return builder.gep(held.data, [i])
    step = builder.mul(i, builder.extract_value(held.strides, 0))
    at = builder.add(builder.ptrtoint(held.data, ir.IntType(64)), step)
    return builder.inttoptr(at, held.data.type)


def _clamped(builder: Any, i: Any, k: int, last: Any) -> Any:
    """Member i + k, or the last one."""
    place, end = builder.add(i, i.type(k)), builder.sub(last, last.type(1))
    return builder.select(builder.icmp_signed("<", place, end), place, end)


_SINGLES = ir.VectorType(ir.FloatType(), LANES)
"""Four numbers of single precision."""


@lowered(memory.load, lambda args: LANE if _is_vector(args[0]) and args[0].layout == "C" else None)
def _load(context, builder, sig, args):
    at = _pointer(context, builder, sig.args[0], args[0], args[1])
    if sig.args[0].dtype == types.float32:
        return builder.fpext(builder.load(builder.bitcast(at, _SINGLES.as_pointer()), align=4), NUMBERS)
    return builder.load(builder.bitcast(at, NUMBERS.as_pointer()), align=8)


@lowered(memory.store, lambda args: types.none if _is_vector(args[0]) and args[0].layout == "C" else None)
def _store(context, builder, sig, args):
    at = _pointer(context, builder, sig.args[0], args[0], args[1])
    x = as_lanes(context, builder, args[2], sig.args[2])
    if sig.args[0].dtype == types.float32:
        builder.store(builder.fptrunc(x, _SINGLES), builder.bitcast(at, _SINGLES.as_pointer()), align=4)
    else:
        builder.store(x, builder.bitcast(at, NUMBERS.as_pointer()), align=8)
    return context.get_dummy_value()


@lowered(memory.gather, lambda args: LANE if _is_vector(args[0]) else None)
def _gather(context, builder, sig, args):
    array, i, last = args
    kind = sig.args[0]

    def each() -> Any:
        x = ir.Constant(NUMBERS, ir.Undefined)
        for k in range(LANES):
            at = _pointer(context, builder, kind, array, _clamped(builder, i, k, last))
            one = context.cast(builder, builder.load(at), kind.dtype, types.float64)
            x = builder.insert_element(x, one, INDEX(k))
        return x

    if kind.layout != "C" or kind.dtype != types.float64:
        return each()
    found = cgutils.alloca_once(builder, NUMBERS)
    with builder.if_else(builder.icmp_signed("<=", builder.add(i, i.type(LANES)), last), likely=True) as (all_, some):
        with all_:
            at = builder.bitcast(_pointer(context, builder, kind, array, i), NUMBERS.as_pointer())
            builder.store(builder.load(at, align=8), found)
        with some:
            builder.store(each(), found)
    return builder.load(found)


@lowered(memory.equals, lambda args: MASK if _is_vector(args[0]) and isinstance(args[0].dtype, types.Integer) else None)
def _equals(context, builder, sig, args):
    array, i, last, value = args
    x = ir.Constant(BITS, ir.Undefined)
    for k in range(LANES):
        at = _pointer(context, builder, sig.args[0], array, _clamped(builder, i, k, last))
        x = builder.insert_element(x, builder.load(at), INDEX(k))
    return mask_of(builder, builder.icmp_signed("==", x, splat(builder, value, BITS)))


@lowered(memory.scatter, lambda args: types.none if _is_vector(args[0]) else None)
def _scatter(context, builder, sig, args):
    array, i, last, x = args
    kind = sig.args[0]
    x = as_lanes(context, builder, x, sig.args[3])

    def each() -> None:
        for k in range(LANES):
            place = builder.add(i, i.type(k))
            with builder.if_then(builder.icmp_signed("<", place, last), likely=True):
                one = context.cast(builder, builder.extract_element(x, INDEX(k)), types.float64, kind.dtype)
                builder.store(one, _pointer(context, builder, kind, array, place))

    if kind.layout != "C" or kind.dtype != types.float64:
        each()
        return context.get_dummy_value()
    with builder.if_else(builder.icmp_signed("<=", builder.add(i, i.type(LANES)), last), likely=True) as (all_, some):
        with all_:
            at = builder.bitcast(_pointer(context, builder, kind, array, i), NUMBERS.as_pointer())
            builder.store(x, at, align=8)
        with some:
            each()
    return context.get_dummy_value()


def _shuffled(builder: Any, x: Any, y: Any, order: Sequence[int]) -> Any:
    return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(INDEX, LANES), list(order)))


def _transposed(builder: Any, rows: Sequence[Any]) -> list[Any]:
    """Columns of four vectors."""
    a, b, c, d = rows
    even, odd = (_shuffled(builder, a, b, (k, 4 + k, 2 + k, 6 + k)) for k in (0, 1))
    even_below, odd_below = (_shuffled(builder, c, d, (k, 4 + k, 2 + k, 6 + k)) for k in (0, 1))
    return [
        _shuffled(builder, even, even_below, (0, 1, 4, 5)), _shuffled(builder, odd, odd_below, (0, 1, 4, 5)),
        _shuffled(builder, even, even_below, (2, 3, 6, 7)), _shuffled(builder, odd, odd_below, (2, 3, 6, 7)),
    ]  # fmt: skip


_ROWS = types.UniTuple(LANE, LANES)


@lowered(memory.load_rows, lambda args: _ROWS if _is_vector(args[0]) and args[0].layout == "C" else None)
def _load_rows(context, builder, sig, args):
    array, i, last = args
    rows = []
    for k in range(LANES):
        place = builder.mul(_clamped(builder, i, k, last), i.type(LANES))
        at = builder.bitcast(_pointer(context, builder, sig.args[0], array, place), NUMBERS.as_pointer())
        rows.append(builder.load(at, align=8))
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


@lowered(memory.load_fields, lambda args: _ROWS if _is_vector(args[0]) else None)
def _load_fields(context, builder, sig, args):
    array, i, last = args
    rows = []
    for k in range(LANES):
        at = _pointer(context, builder, sig.args[0], array, _clamped(builder, i, k, last))
        rows.append(builder.load(builder.bitcast(at, NUMBERS.as_pointer()), align=8))
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


@lowered(memory.store_fields, lambda args: types.none if _is_vector(args[0]) else None)
def _store_fields(context, builder, sig, args):
    array, i, last = args[:3]
    rows = _transposed(builder, [as_lanes(context, builder, x, t) for x, t in zip(args[3:], sig.args[3:], strict=True)])

    def write(k: int) -> None:
        at = _pointer(context, builder, sig.args[0], array, builder.add(i, i.type(k)))
        builder.store(rows[k], builder.bitcast(at, NUMBERS.as_pointer()), align=8)

    with builder.if_else(builder.icmp_signed("<=", builder.add(i, i.type(LANES)), last), likely=True) as (all_, some):
        with all_:
            for k in range(LANES):
                write(k)
        with some:
            for k in range(LANES - 1):
                with builder.if_then(builder.icmp_signed("<", builder.add(i, i.type(k)), last)):
                    write(k)
    return context.get_dummy_value()


@lowered(memory.add_rows, lambda args: types.none if _is_vector(args[0]) and args[0].layout == "C" else None)
def _add_rows(context, builder, sig, args):
    array, i, last = args[:3]
    columns = [as_lanes(context, builder, x, t) for x, t in zip(args[3:], sig.args[3:], strict=True)]
    for k, row in enumerate(_transposed(builder, columns)):
        place = builder.add(i, i.type(k))
        with builder.if_then(builder.icmp_signed("<", place, last), likely=True):
            first = builder.mul(place, i.type(LANES))
            at = builder.bitcast(_pointer(context, builder, sig.args[0], array, first), NUMBERS.as_pointer())
            builder.store(builder.fadd(builder.load(at, align=8), row), at, align=8)
    return context.get_dummy_value()


def _raw_rows(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """The rows, and the addresses of as many in the fourth argument from the place in the fifth on."""
    array, i, last, kept, at = args
    rows, places = [], []
    for k in range(LANES):
        place = builder.mul(_clamped(builder, i, k, last), i.type(LANES))
        row = builder.bitcast(_pointer(context, builder, sig.args[0], array, place), NUMBERS.as_pointer())
        rows.append(builder.load(row, align=8))
        beside = _pointer(context, builder, sig.args[3], kept, builder.add(at, at.type(LANES * k)))
        places.append(builder.bitcast(beside, NUMBERS.as_pointer()))
    return rows, places


def _two_vectors(args: tuple[types.Type, ...]) -> bool:
    return all(_is_vector(kind) and kind.layout == "C" for kind in (args[0], args[3]))


@lowered(memory.same_rows, lambda args: types.boolean if _two_vectors(args) else None)
def _same_rows(context, builder, sig, args):
    rows, places = _raw_rows(context, builder, sig, args)
    same = None
    for row, place in zip(rows, places, strict=True):
        equal = mask_of(builder, builder.fcmp_ordered("==", row, builder.load(place, align=8)))
        same = equal if same is None else builder.and_(same, equal)
    return builder.icmp_signed(
        "==", builder.bitcast(choice_of(builder, same), ir.IntType(LANES)), ir.IntType(LANES)(-1)
    )


@lowered(memory.keep_rows, lambda args: types.none if _two_vectors(args) else None)
def _keep_rows(context, builder, sig, args):
    for row, place in zip(*_raw_rows(context, builder, sig, args), strict=True):
        builder.store(row, place, align=8)


# -- members at any place ----------------------------------------------------------------------------------------------
PLACES = types.UniTuple(types.int64, LANES)


def _at_places(args: tuple[types.Type, ...]) -> bool:
    return _is_vector(args[0]) and args[0].layout == "C" and args[0].dtype == types.float64 and args[1] == PLACES


def _places(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> list[Any]:
    start = context.cast(builder, args[2], sig.args[2], types.int64)
    data = _pointer(context, builder, sig.args[0], args[0], start)
    return [builder.gep(data, [builder.extract_value(args[1], k)]) for k in range(LANES)]


@lowered(memory.collect, lambda args: LANE if _at_places(args) else None)
def _collect(context, builder, sig, args):
    x = ir.Constant(NUMBERS, ir.Undefined)
    for k, at in enumerate(_places(context, builder, sig, args)):
        x = builder.insert_element(x, builder.load(at), INDEX(k))
    return x


@lowered(memory.collect_fours, lambda args: _ROWS if _at_places(args) else None)
def _collect_fours(context, builder, sig, args):
    places = (builder.bitcast(at, NUMBERS.as_pointer()) for at in _places(context, builder, sig, args))
    rows = [builder.load(at, align=8) for at in places]
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


@lowered(memory.collect_pairs, lambda args: types.UniTuple(LANE, 2) if _at_places(args) else None)
def _collect_pairs(context, builder, sig, args):
    pair = ir.VectorType(ir.DoubleType(), 2)
    places = (builder.bitcast(at, pair.as_pointer()) for at in _places(context, builder, sig, args))
    a, b, c, d = (builder.load(at, align=8) for at in places)
    together = ir.Constant(ir.VectorType(INDEX, LANES), list(range(LANES)))
    above, below = builder.shuffle_vector(a, b, together), builder.shuffle_vector(c, d, together)
    columns = [_shuffled(builder, above, below, (k, 2 + k, 4 + k, 6 + k)) for k in (0, 1)]
    return context.make_tuple(builder, sig.return_type, columns)


@lowered(memory.add_to, lambda args: types.none if _at_places(args) and args[3] is LANE else None)
def _add_to(context, builder, sig, args):
    for k, at in enumerate(_places(context, builder, sig, args)):
        one = builder.extract_element(args[3], INDEX(k))
        builder.store(builder.fadd(builder.load(at), one), at)
    return context.get_dummy_value()


@lowered(memory.transposed, lambda args: _ROWS if args == (LANE,) * LANES else None)
def _transpose(context, builder, sig, args):
    return context.make_tuple(builder, sig.return_type, _transposed(builder, args))


def _add_at(context: Any, builder: Any, sig: Any, args: Sequence[Any], rows: Sequence[Any]) -> Any:
    for place, row in zip(_places(context, builder, sig, args), rows, strict=True):
        at = builder.bitcast(place, row.type.as_pointer())
        builder.store(builder.fadd(builder.load(at, align=8), row), at, align=8)
    return context.get_dummy_value()


@lowered(memory.add_at_places, lambda args: types.none if _at_places(args) and args[3] == _ROWS else None)
def _add_at_places(context, builder, sig, args):
    return _add_at(context, builder, sig, args, cgutils.unpack_tuple(builder, args[3]))


@lowered(memory.add_pairs_at_places, lambda args: types.none if _at_places(args) and args[3:] == (LANE, LANE) else None)
def _add_pairs_at_places(context, builder, sig, args):
    order = (ir.Constant(ir.VectorType(INDEX, 2), [k, LANES + k]) for k in range(LANES))
    return _add_at(
        context, builder, sig, args, [builder.shuffle_vector(args[3], args[4], pair) for pair in order]
    )  # fmt: skip


def _in_one_row(args: tuple[types.Type, ...]) -> types.Type | None:
    array = args[0]
    if not isinstance(array, types.Array) or array.layout != "C":
        return None
    return types.Array(array.dtype, 1, "C", not array.mutable)


@lowered(memory.laid_flat, _in_one_row)
def _laid_flat(context, builder, sig, args):
    held = make_array(sig.args[0])(context, builder, args[0])
    laid = make_array(sig.return_type)(context, builder)
    populate_array(laid, held.data, [held.nitems], [held.itemsize], held.itemsize, None)
    return laid._getvalue()
