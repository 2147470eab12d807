"""Lanes from memory and to it: members side by side, rows of four numbers, fields of records, and members anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.np.arrayobj import make_array

from tautline.kernels.lanes.arithmetic import (
    BITS,
    INDEX,
    LANE,
    LANES,
    MASK,
    NUMBERS,
    as_lanes,
    choice_of,
    lowered,
    mask_of,
    splat,
)


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


def load(array, i):
    """Entries i to i + 3 of an array without gaps."""
    return array[i : i + LANES].copy()


@lowered(load, lambda args: LANE if _is_vector(args[0]) and args[0].layout == "C" else None)
def _load(context, builder, sig, args):
    at = builder.bitcast(_pointer(context, builder, sig.args[0], args[0], args[1]), NUMBERS.as_pointer())
    return builder.load(at, align=8)


def store(array, i, x):
    """Write lanes over entries i to i + 3 of an array without gaps."""
    array[i : i + LANES] = x


@lowered(store, lambda args: types.none if _is_vector(args[0]) and args[0].layout == "C" else None)
def _store(context, builder, sig, args):
    at = builder.bitcast(_pointer(context, builder, sig.args[0], args[0], args[1]), NUMBERS.as_pointer())
    builder.store(as_lanes(context, builder, args[2], sig.args[2]), at, align=8)
    return context.get_dummy_value()


def gather(array, i, last):
    """Entries i to i + 3 of an array (n,), or a field of records, as numbers; those from ``last`` on repeat it."""
    return array[np.minimum(np.arange(i, i + LANES), last - 1)].astype(float)


@lowered(gather, lambda args: LANE if _is_vector(args[0]) else None)
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


def equals(array, i, last, value):
    """Which of entries i to i + 3 of an array of whole numbers, or a field of records, are ``value``."""
    return array[np.minimum(np.arange(i, i + LANES), last - 1)] == value


@lowered(equals, lambda args: MASK if _is_vector(args[0]) and isinstance(args[0].dtype, types.Integer) else None)
def _equals(context, builder, sig, args):
    array, i, last, value = args
    x = ir.Constant(BITS, ir.Undefined)
    for k in range(LANES):
        at = _pointer(context, builder, sig.args[0], array, _clamped(builder, i, k, last))
        x = builder.insert_element(x, builder.load(at), INDEX(k))
    return mask_of(builder, builder.icmp_signed("==", x, splat(builder, value, BITS)))


def scatter(array, i, last, x):
    """Write lanes over entries i to i + 3, those before ``last``."""
    n = min(LANES, last - i)
    array[i : i + n] = np.broadcast_to(x, LANES)[:n]


@lowered(scatter, lambda args: types.none if _is_vector(args[0]) else None)
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


def load_rows(array, i, last):
    """Columns of rows i to i + 3 of an array of four numbers a row, laid flat: four lanes.

    Rows from ``last`` on repeat the one before. So the four coordinates of four bodies are read by four loads.
    """
    rows = array.reshape(-1, LANES)[np.minimum(np.arange(i, i + LANES), last - 1)]
    return tuple(rows[:, k].copy() for k in range(LANES))


@lowered(load_rows, lambda args: _ROWS if _is_vector(args[0]) and args[0].layout == "C" else None)
def _load_rows(context, builder, sig, args):
    array, i, last = args
    rows = []
    for k in range(LANES):
        place = builder.mul(_clamped(builder, i, k, last), i.type(LANES))
        at = builder.bitcast(_pointer(context, builder, sig.args[0], array, place), NUMBERS.as_pointer())
        rows.append(builder.load(at, align=8))
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


def load_fields(array, i, last):
    """Four successive fields of records i to i + 3, numbers all, of which ``array`` is the first: four lanes.

    Records from ``last`` on repeat the one before it.
    """
    fields = np.lib.stride_tricks.as_strided(array, (array.size, LANES), (*array.strides, 8))
    rows = fields[np.minimum(np.arange(i, i + LANES), last - 1)]
    return tuple(rows[:, k].copy() for k in range(LANES))


@lowered(load_fields, lambda args: _ROWS if _is_vector(args[0]) else None)
def _load_fields(context, builder, sig, args):
    array, i, last = args
    rows = []
    for k in range(LANES):
        at = _pointer(context, builder, sig.args[0], array, _clamped(builder, i, k, last))
        rows.append(builder.load(builder.bitcast(at, NUMBERS.as_pointer()), align=8))
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


def add_rows(array, i, last, a, b, c, d):
    """Add four lanes to the columns of rows i to i + 3, before ``last``, of four numbers each, laid flat."""
    n = min(LANES, last - i)
    rows = np.column_stack([np.broadcast_to(x, LANES) for x in (a, b, c, d)])
    array.reshape(-1, LANES)[i : i + n] += rows[:n]


@lowered(add_rows, lambda args: types.none if _is_vector(args[0]) and args[0].layout == "C" else None)
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


def same_rows(array, i, last, kept, at):
    """Whether rows i to i + 3, of four numbers each, are those that stand in ``kept`` from place ``at`` on."""
    rows = array.reshape(-1, LANES)[np.minimum(np.arange(i, i + LANES), last - 1)]
    return bool(np.all(rows.ravel() == kept[at : at + LANES * LANES]))


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


@lowered(same_rows, lambda args: types.boolean if _two_vectors(args) else None)
def _same_rows(context, builder, sig, args):
    rows, places = _raw_rows(context, builder, sig, args)
    same = None
    for row, place in zip(rows, places, strict=True):
        equal = mask_of(builder, builder.fcmp_ordered("==", row, builder.load(place, align=8)))
        same = equal if same is None else builder.and_(same, equal)
    return builder.icmp_signed(
        "==", builder.bitcast(choice_of(builder, same), ir.IntType(LANES)), ir.IntType(LANES)(-1)
    )


def keep_rows(array, i, last, kept, at):
    """Write rows i to i + 3, of four numbers each, into ``kept`` from place ``at`` on; see `same_rows`."""
    rows = array.reshape(-1, LANES)[np.minimum(np.arange(i, i + LANES), last - 1)]
    kept[at : at + LANES * LANES] = rows.ravel()


@lowered(keep_rows, lambda args: types.none if _two_vectors(args) else None)
def _keep_rows(context, builder, sig, args):
    for row, place in zip(*_raw_rows(context, builder, sig, args), strict=True):
        builder.store(row, place, align=8)


# -- members at any place ----------------------------------------------------------------------------------------------
PLACES = types.UniTuple(types.int64, LANES)


def collect(array, places, offset):
    """Entries of an array at four places, each moved by ``offset``."""
    return np.array([array[place + offset] for place in places])


def _at_places(args: tuple[types.Type, ...]) -> bool:
    return _is_vector(args[0]) and args[0].layout == "C" and args[0].dtype == types.float64 and args[1] == PLACES


def _places(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> list[Any]:
    start = context.cast(builder, args[2], sig.args[2], types.int64)
    data = _pointer(context, builder, sig.args[0], args[0], start)
    return [builder.gep(data, [builder.extract_value(args[1], k)]) for k in range(LANES)]


@lowered(collect, lambda args: LANE if _at_places(args) else None)
def _collect(context, builder, sig, args):
    x = ir.Constant(NUMBERS, ir.Undefined)
    for k, at in enumerate(_places(context, builder, sig, args)):
        x = builder.insert_element(x, builder.load(at), INDEX(k))
    return x


def collect_fours(array, places, offset):
    """Four numbers each from four places on, moved by ``offset``, as columns: the k-th lanes are the k-th numbers."""
    rows = np.array([array[place + offset : place + offset + LANES] for place in places])
    return tuple(rows[:, k].copy() for k in range(LANES))


@lowered(collect_fours, lambda args: _ROWS if _at_places(args) else None)
def _collect_fours(context, builder, sig, args):
    places = (builder.bitcast(at, NUMBERS.as_pointer()) for at in _places(context, builder, sig, args))
    rows = [builder.load(at, align=8) for at in places]
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


def collect_pairs(array, places, offset):
    """The same with two numbers each: two lanes."""
    rows = np.array([array[place + offset : place + offset + 2] for place in places])
    return rows[:, 0].copy(), rows[:, 1].copy()


@lowered(collect_pairs, lambda args: types.UniTuple(LANE, 2) if _at_places(args) else None)
def _collect_pairs(context, builder, sig, args):
    pair = ir.VectorType(ir.DoubleType(), 2)
    places = (builder.bitcast(at, pair.as_pointer()) for at in _places(context, builder, sig, args))
    a, b, c, d = (builder.load(at, align=8) for at in places)
    together = ir.Constant(ir.VectorType(INDEX, LANES), list(range(LANES)))
    above, below = builder.shuffle_vector(a, b, together), builder.shuffle_vector(c, d, together)
    columns = [_shuffled(builder, above, below, (k, 2 + k, 4 + k, 6 + k)) for k in (0, 1)]
    return context.make_tuple(builder, sig.return_type, columns)


def add_to(array, places, offset, x):
    """Add lanes to an array at four places, each moved by ``offset``, one after the other: they may be the same."""
    for place, value in zip(places, x, strict=True):
        array[place + offset] += value


@lowered(add_to, lambda args: types.none if _at_places(args) and args[3] is LANE else None)
def _add_to(context, builder, sig, args):
    for k, at in enumerate(_places(context, builder, sig, args)):
        one = builder.extract_element(args[3], INDEX(k))
        builder.store(builder.fadd(builder.load(at), one), at)
    return context.get_dummy_value()


def transposed(a, b, c, d):
    """Four lanes as columns made rows: the k-th of what comes back holds the k-th numbers of all."""
    return tuple(np.column_stack([a, b, c, d]))


@lowered(transposed, lambda args: _ROWS if args == (LANE,) * LANES else None)
def _transpose(context, builder, sig, args):
    return context.make_tuple(builder, sig.return_type, _transposed(builder, args))


def add_at_places(array, places, offset, rows):
    """Add a row of four numbers each to successive entries of an array from four places on, moved by ``offset``.

    One after the other: they may overlap. A processor waits long where it reads four numbers that it has just written
    by other fours, so what overlaps is to overlap by the whole.
    """
    for place, row in zip(places, rows, strict=True):
        array[place + offset : place + offset + LANES] += row


def _add_at(context: Any, builder: Any, sig: Any, args: Sequence[Any], rows: Sequence[Any]) -> Any:
    for place, row in zip(_places(context, builder, sig, args), rows, strict=True):
        at = builder.bitcast(place, row.type.as_pointer())
        builder.store(builder.fadd(builder.load(at, align=8), row), at, align=8)
    return context.get_dummy_value()


@lowered(add_at_places, lambda args: types.none if _at_places(args) and args[3] == _ROWS else None)
def _add_at_places(context, builder, sig, args):
    return _add_at(context, builder, sig, args, cgutils.unpack_tuple(builder, args[3]))


def add_pairs_at_places(array, places, offset, a, b):
    """The same with two numbers each: entry k of two lanes."""
    for place, one, other in zip(places, a, b, strict=True):
        array[place + offset : place + offset + 2] += one, other


@lowered(add_pairs_at_places, lambda args: types.none if _at_places(args) and args[3:] == (LANE, LANE) else None)
def _add_pairs_at_places(context, builder, sig, args):
    order = (ir.Constant(ir.VectorType(INDEX, 2), [k, LANES + k]) for k in range(LANES))
    return _add_at(
        context, builder, sig, args, [builder.shuffle_vector(args[3], args[4], pair) for pair in order]
    )  # fmt: skip
