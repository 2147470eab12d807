"""Four members of a group at a time: numbers side by side in one register of the processor.

Compiled code works on `LANES` numbers in one instruction where they lie in one vector of LLVM. Its own vectoriser finds
nothing in the loops over lumps: their degrees of freedom lie four apart, their parameters are records, and two members
add to the same place. So lanes are a type of their own here. An expression of plain numbers, such as those that
``tautline.lumped.derive`` writes, stands for four members as soon as its arguments are lanes: ``+ - * /``, comparisons,
``abs``, and the functions below, which take plain numbers as well.

    for i in range(first, last, LANES):
        x, u, v, theta = load_rows(q, i, last)
        ...
        add_rows(r, i, last, along, north, east, about)

Lanes beyond the last member repeat it when they are read, and are left out when they are written; so every number of
members is gone through by the same code. Vectors are of four doubles, what AVX2 holds; LLVM makes two instructions of
them where registers are narrower. Without a compiler (``NUMBA_DISABLE_JIT=1``) lanes are arrays (4,), masks too.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, register_model
from numba.np.arrayobj import make_array

LANES = 4
"""Members at a time."""

_NUMBERS = ir.VectorType(ir.DoubleType(), LANES)
_BITS = ir.VectorType(ir.IntType(64), LANES)
_CHOICE = ir.VectorType(ir.IntType(1), LANES)
_INDEX = ir.IntType(32)


class LanesType(types.Type):
    """Four numbers, in compiled code."""

    def __init__(self) -> None:
        super().__init__("Lanes")


class MaskType(types.Type):
    """Four answers, in compiled code."""

    def __init__(self) -> None:
        super().__init__("Mask")


LANE, MASK = LanesType(), MaskType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    """A vector of doubles."""

    def __init__(self, dmm: Any, kind: types.Type) -> None:
        super().__init__(dmm, kind, _NUMBERS)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    """A vector of words, all ones where the answer is yes: what comparisons leave in a register."""

    def __init__(self, dmm: Any, kind: types.Type) -> None:
        super().__init__(dmm, kind, _BITS)


Typer = Callable[[tuple[types.Type, ...]], "types.Type | None"]


def _lowered(stub: Any, result: Typer) -> Callable[[Any], Any]:
    """Decorator of the code of a function for compiled callers; ``result`` types it, or says None.

    There is no function in between that would have to be compiled for each place.
    """

    def register(code: Any) -> Any:
        class Template(AbstractTemplate):
            """What numba takes a call for."""

            key = stub

            def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
                """Signature for these arguments."""
                given = tuple(types.unliteral(kind) for kind in args)
                kind = None if kws else result(given)
                return None if kind is None else signature(kind, *given)

        infer_global(stub, types.Function(Template))
        lower_builtin(stub, types.VarArg(types.Any))(code)
        return code

    return register


def _splat(builder: Any, x: Any, kind: Any = _NUMBERS) -> Any:
    nothing = ir.Constant(kind, ir.Undefined)
    one = builder.insert_element(nothing, x, _INDEX(0))
    return builder.shuffle_vector(one, nothing, ir.Constant(ir.VectorType(_INDEX, LANES), [0] * LANES))


def _constant(x: float) -> Any:
    return ir.Constant(_NUMBERS, [x] * LANES)


def _words(x: int) -> Any:
    return ir.Constant(_BITS, [x] * LANES)


def _numbers(context: Any, builder: Any, x: Any, kind: types.Type) -> Any:
    """An argument as a vector: what is one number stands in every lane."""
    return x if kind is LANE else _splat(builder, context.cast(builder, x, kind, types.float64))


def _choice(builder: Any, mask: Any) -> Any:
    return builder.icmp_signed("!=", mask, _words(0))


def _mask(builder: Any, choice: Any) -> Any:
    return builder.sext(choice, _BITS)


def _intrinsic(builder: Any, name: str, kind: Any, *args: Any) -> Any:
    suffix = f"v{LANES}f64" if kind == _NUMBERS else "f64"
    function = cgutils.get_or_insert_function(
        builder.module, ir.FunctionType(kind, [kind] * len(args)), f"llvm.{name}.{suffix}"
    )
    return builder.call(function, args)


# -- arithmetic and comparisons ----------------------------------------------------------------------------------------


def _both(args: tuple[types.Type, ...]) -> bool:
    """Whether these are lanes, or lanes and a number."""
    return LANE in args and all(kind is LANE or isinstance(kind, types.Number) for kind in args)


def _operators(key: Any, kind: types.Type, count: int, apply: Callable[..., Any]) -> None:
    """Teach an operator of Python lanes."""

    class Template(AbstractTemplate):
        """What numba takes the operator for."""

        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
            """Signature for lanes."""
            given = tuple(types.unliteral(each) for each in args)
            return signature(kind, *given) if len(given) == count and _both(given) else None

    Template.key = key  # type: ignore[attr-defined]
    infer_global(key)(Template)

    def code(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> Any:
        return apply(builder, *(_numbers(context, builder, x, t) for x, t in zip(args, sig.args, strict=True)))

    if count == 1:
        lower_builtin(key, LANE)(code)
        return
    for given in ((LANE, LANE), (LANE, types.Number), (types.Number, LANE)):
        lower_builtin(key, *given)(code)


for _keys, _name in (
    ((operator.add, operator.iadd), "fadd"),
    ((operator.sub, operator.isub), "fsub"),
    ((operator.mul, operator.imul), "fmul"),
    ((operator.truediv, operator.itruediv), "fdiv"),
):
    for _key in _keys:
        _operators(_key, LANE, 2, lambda builder, x, y, name=_name: getattr(builder, name)(x, y))
_operators(operator.neg, LANE, 1, lambda builder, x: builder.fneg(x))
_operators(abs, LANE, 1, lambda builder, x: _intrinsic(builder, "fabs", _NUMBERS, x))
for _key, _name in (
    (operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">="), (operator.eq, "=="),
):  # fmt: skip
    _operators(
        _key, MASK, 2, lambda builder, x, y, name=_name: _mask(builder, builder.fcmp_ordered(name, x, y))
    )  # fmt: skip


def _two_masks(key: Any, name: str) -> None:
    class Template(AbstractTemplate):
        """What numba takes the operator for."""

        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
            """Signature for masks."""
            return signature(MASK, MASK, MASK) if args == (MASK, MASK) else None

    Template.key = key  # type: ignore[attr-defined]
    infer_global(key)(Template)
    lower_builtin(key, MASK, MASK)(lambda context, builder, sig, args: getattr(builder, name)(*args))


_two_masks(operator.and_, "and_")
_two_masks(operator.or_, "or_")


def negated(mask):
    """The answers turned round."""
    return ~mask


@_lowered(negated, lambda args: MASK if args == (MASK,) else None)
def _negated(context, builder, sig, args):
    return builder.xor(args[0], _words(-1))


def any_of(mask):
    """Whether any lane says yes."""
    return bool(np.any(mask))


@_lowered(any_of, lambda args: types.boolean if args == (MASK,) else None)
def _any_of(context, builder, sig, args):
    answers = builder.bitcast(_choice(builder, args[0]), ir.IntType(LANES))
    return builder.icmp_unsigned("!=", answers, ir.IntType(LANES)(0))


def where(mask, x, y):
    """``x`` where the mask says yes, ``y`` elsewhere; of plain numbers, one of both."""
    return np.where(mask, x, y) if isinstance(mask, np.ndarray) else (x if mask else y)


def _is_number(kind: types.Type) -> bool:
    return isinstance(kind, types.Number)


def _chosen(args: tuple[types.Type, ...]) -> types.Type | None:
    if len(args) == 3 and args[0] is MASK and all(kind is LANE or _is_number(kind) for kind in args[1:]):
        return LANE
    return types.float64 if args[0] is types.boolean and all(map(_is_number, args[1:])) else None


@_lowered(where, _chosen)
def _where(context, builder, sig, args):
    mask, x, y = args
    if sig.args[0] is MASK:
        x, y = (_numbers(context, builder, v, t) for v, t in zip((x, y), sig.args[1:], strict=True))
        return builder.select(_choice(builder, mask), x, y)
    x, y = (context.cast(builder, v, t, types.float64) for v, t in zip((x, y), sig.args[1:], strict=True))
    return builder.select(mask, x, y)


def larger(x, y):
    """The larger of two, lane by lane; ``y`` where ``x`` is no number."""
    return where(x > y, x, y)


def _of_numbers(args: tuple[types.Type, ...]) -> types.Type | None:
    if all(kind is LANE or _is_number(kind) for kind in args):
        return LANE if LANE in args else types.float64
    return None


@_lowered(larger, _of_numbers)
def _larger(context, builder, sig, args):
    if sig.return_type is LANE:
        x, y = (_numbers(context, builder, v, t) for v, t in zip(args, sig.args, strict=True))
    else:
        x, y = (context.cast(builder, v, t, types.float64) for v, t in zip(args, sig.args, strict=True))
    return builder.select(builder.fcmp_ordered(">", x, y), x, y)


# -- functions ---------------------------------------------------------------------------------------------------------


def sqrt(x):
    """The square root."""
    return np.sqrt(x)


def exp(x):
    """The exponential, of one lane after another."""
    return np.exp(x)


def sin(x):
    """The sine of an angle, rad."""
    return np.sin(x)


def cos(x):
    """The cosine of an angle, rad."""
    return np.cos(x)


@_lowered(sqrt, _of_numbers)
def _sqrt(context, builder, sig, args):
    if sig.return_type is LANE:
        return _intrinsic(builder, "sqrt", _NUMBERS, args[0])
    return _intrinsic(builder, "sqrt", ir.DoubleType(), context.cast(builder, args[0], sig.args[0], types.float64))


@_lowered(exp, _of_numbers)
def _exp(context, builder, sig, args):
    if sig.return_type is LANE:
        return _intrinsic(builder, "exp", _NUMBERS, args[0])
    return _intrinsic(builder, "exp", ir.DoubleType(), context.cast(builder, args[0], sig.args[0], types.float64))


_HALF_PI = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
"""A quarter of a turn in parts of 33 digits: their products with whole numbers are exact (fdlibm)."""
_SINE = (
    -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
    2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10,
)  # fmt: skip
_COSINE = (
    4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
    -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11,
)  # fmt: skip
"""Polynomials of fdlibm (Sun Microsystems, 1993) for an eighth of a turn: errors below a unit in the last place."""
_TO_WHOLE = 6755399441055744.0
"""1.5 2^52: what is added to it is rounded to a whole number, which its last digits hold."""


def _horner(builder: Any, x: Any, factors: Sequence[float]) -> Any:
    y = _constant(factors[-1])
    for factor in reversed(factors[:-1]):
        y = builder.fadd(builder.fmul(y, x), _constant(factor))
    return y


def _turned(builder: Any, x: Any, quarters: int) -> Any:
    """sin(x + quarters pi / 2) in lanes: reduced to an eighth of a turn, then a polynomial."""
    shifted = builder.fadd(builder.fmul(x, _constant(2.0 / np.pi)), _constant(_TO_WHOLE))
    whole = builder.fsub(shifted, _constant(_TO_WHOLE))
    for part in _HALF_PI:
        x = builder.fsub(x, builder.fmul(whole, _constant(part)))
    square = builder.fmul(x, x)
    sine = builder.fadd(x, builder.fmul(builder.fmul(x, square), _horner(builder, square, _SINE)))
    half = builder.fmul(_constant(0.5), square)
    rest = builder.fmul(builder.fmul(square, square), _horner(builder, square, _COSINE))
    cosine = builder.fadd(builder.fsub(_constant(1.0), half), rest)
    turns = builder.add(builder.bitcast(shifted, _BITS), _words(quarters))
    odd = builder.icmp_signed("!=", builder.and_(turns, _words(1)), _words(0))
    value = builder.select(odd, cosine, sine)
    sign = builder.shl(builder.and_(turns, _words(2)), _words(62))
    return builder.bitcast(builder.xor(builder.bitcast(value, _BITS), sign), _NUMBERS)


def _angle_function(name: str, quarters: int) -> Callable[..., Any]:
    def code(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> Any:
        if sig.return_type is LANE:
            return _turned(builder, args[0], quarters)
        return _intrinsic(builder, name, ir.DoubleType(), context.cast(builder, args[0], sig.args[0], types.float64))

    return code


_lowered(sin, _of_numbers)(_angle_function("sin", 0))
_lowered(cos, _of_numbers)(_angle_function("cos", 1))


def lane(x, k):
    """The number in lane k."""
    return x[k]


@_lowered(lane, lambda args: types.float64 if args[0] is LANE else None)
def _lane(context, builder, sig, args):
    return builder.extract_element(args[0], builder.trunc(args[1], _INDEX))


def spread(x):
    """One number in every lane."""
    return np.full(LANES, x)


@_lowered(spread, lambda args: LANE if _is_number(args[0]) else None)
def _spread(context, builder, sig, args):
    return _numbers(context, builder, args[0], sig.args[0])


def within(i, last):
    """Which of the members i, i + 1, ... are before the last: the others are repeated."""
    return np.arange(i, i + LANES) < last


@_lowered(within, lambda args: MASK)
def _within(context, builder, sig, args):
    places = builder.add(_splat(builder, args[0], _BITS), ir.Constant(_BITS, list(range(LANES))))
    return _mask(builder, builder.icmp_signed("<", places, _splat(builder, args[1], _BITS)))


def total(x):
    """Sum of the lanes: of pairs first."""
    return (x[0] + x[2]) + (x[1] + x[3])


@_lowered(total, lambda args: types.float64 if args[0] is LANE else None)
def _total(context, builder, sig, args):
    parts = [builder.extract_element(args[0], _INDEX(k)) for k in range(LANES)]
    return builder.fadd(builder.fadd(parts[0], parts[2]), builder.fadd(parts[1], parts[3]))


def largest(x):
    """Largest of the lanes."""
    return max(x)


@_lowered(largest, lambda args: types.float64 if args[0] is LANE else None)
def _largest(context, builder, sig, args):
    most = builder.extract_element(args[0], _INDEX(0))
    for k in range(1, LANES):
        other = builder.extract_element(args[0], _INDEX(k))
        most = builder.select(builder.fcmp_ordered(">", other, most), other, most)
    return most


# -- memory ------------------------------------------------------------------------------------------------------------


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


@_lowered(load, lambda args: LANE if _is_vector(args[0]) and args[0].layout == "C" else None)
def _load(context, builder, sig, args):
    at = builder.bitcast(_pointer(context, builder, sig.args[0], args[0], args[1]), _NUMBERS.as_pointer())
    return builder.load(at, align=8)


def store(array, i, x):
    """Write lanes over entries i to i + 3 of an array without gaps."""
    array[i : i + LANES] = x


@_lowered(store, lambda args: types.none if _is_vector(args[0]) and args[0].layout == "C" else None)
def _store(context, builder, sig, args):
    at = builder.bitcast(_pointer(context, builder, sig.args[0], args[0], args[1]), _NUMBERS.as_pointer())
    builder.store(_numbers(context, builder, args[2], sig.args[2]), at, align=8)
    return context.get_dummy_value()


def gather(array, i, last):
    """Entries i to i + 3 of an array (n,), or a field of records, as numbers; those from ``last`` on repeat it."""
    return array[np.minimum(np.arange(i, i + LANES), last - 1)].astype(float)


@_lowered(gather, lambda args: LANE if _is_vector(args[0]) else None)
def _gather(context, builder, sig, args):
    array, i, last = args
    kind = sig.args[0]

    def each() -> Any:
        x = ir.Constant(_NUMBERS, ir.Undefined)
        for k in range(LANES):
            at = _pointer(context, builder, kind, array, _clamped(builder, i, k, last))
            one = context.cast(builder, builder.load(at), kind.dtype, types.float64)
            x = builder.insert_element(x, one, _INDEX(k))
        return x

    if kind.layout != "C" or kind.dtype != types.float64:
        return each()
    found = cgutils.alloca_once(builder, _NUMBERS)
    with builder.if_else(builder.icmp_signed("<=", builder.add(i, i.type(LANES)), last), likely=True) as (all_, some):
        with all_:
            at = builder.bitcast(_pointer(context, builder, kind, array, i), _NUMBERS.as_pointer())
            builder.store(builder.load(at, align=8), found)
        with some:
            builder.store(each(), found)
    return builder.load(found)


def equals(array, i, last, value):
    """Which of entries i to i + 3 of an array of whole numbers, or a field of records, are ``value``."""
    return array[np.minimum(np.arange(i, i + LANES), last - 1)] == value


@_lowered(equals, lambda args: MASK if _is_vector(args[0]) and isinstance(args[0].dtype, types.Integer) else None)
def _equals(context, builder, sig, args):
    array, i, last, value = args
    x = ir.Constant(_BITS, ir.Undefined)
    for k in range(LANES):
        at = _pointer(context, builder, sig.args[0], array, _clamped(builder, i, k, last))
        x = builder.insert_element(x, builder.load(at), _INDEX(k))
    return _mask(builder, builder.icmp_signed("==", x, _splat(builder, value, _BITS)))


def scatter(array, i, last, x):
    """Write lanes over entries i to i + 3, those before ``last``."""
    n = min(LANES, last - i)
    array[i : i + n] = np.broadcast_to(x, LANES)[:n]


@_lowered(scatter, lambda args: types.none if _is_vector(args[0]) else None)
def _scatter(context, builder, sig, args):
    array, i, last, x = args
    kind = sig.args[0]
    x = _numbers(context, builder, x, sig.args[3])

    def each() -> None:
        for k in range(LANES):
            place = builder.add(i, i.type(k))
            with builder.if_then(builder.icmp_signed("<", place, last), likely=True):
                one = context.cast(builder, builder.extract_element(x, _INDEX(k)), types.float64, kind.dtype)
                builder.store(one, _pointer(context, builder, kind, array, place))

    if kind.layout != "C" or kind.dtype != types.float64:
        each()
        return context.get_dummy_value()
    with builder.if_else(builder.icmp_signed("<=", builder.add(i, i.type(LANES)), last), likely=True) as (all_, some):
        with all_:
            at = builder.bitcast(_pointer(context, builder, kind, array, i), _NUMBERS.as_pointer())
            builder.store(x, at, align=8)
        with some:
            each()
    return context.get_dummy_value()


def _shuffled(builder: Any, x: Any, y: Any, order: Sequence[int]) -> Any:
    return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(_INDEX, LANES), list(order)))


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


@_lowered(load_rows, lambda args: _ROWS if _is_vector(args[0]) and args[0].layout == "C" else None)
def _load_rows(context, builder, sig, args):
    array, i, last = args
    rows = []
    for k in range(LANES):
        place = builder.mul(_clamped(builder, i, k, last), i.type(LANES))
        at = builder.bitcast(_pointer(context, builder, sig.args[0], array, place), _NUMBERS.as_pointer())
        rows.append(builder.load(at, align=8))
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


def load_fields(array, i, last):
    """Four successive fields of records i to i + 3, numbers all, of which ``array`` is the first: four lanes.

    Records from ``last`` on repeat the one before it.
    """
    fields = np.lib.stride_tricks.as_strided(array, (array.size, LANES), (*array.strides, 8))
    rows = fields[np.minimum(np.arange(i, i + LANES), last - 1)]
    return tuple(rows[:, k].copy() for k in range(LANES))


@_lowered(load_fields, lambda args: _ROWS if _is_vector(args[0]) else None)
def _load_fields(context, builder, sig, args):
    array, i, last = args
    rows = []
    for k in range(LANES):
        at = _pointer(context, builder, sig.args[0], array, _clamped(builder, i, k, last))
        rows.append(builder.load(builder.bitcast(at, _NUMBERS.as_pointer()), align=8))
    return context.make_tuple(builder, sig.return_type, _transposed(builder, rows))


def add_rows(array, i, last, a, b, c, d):
    """Add four lanes to the columns of rows i to i + 3, before ``last``, of four numbers each, laid flat."""
    n = min(LANES, last - i)
    rows = np.column_stack([np.broadcast_to(x, LANES) for x in (a, b, c, d)])
    array.reshape(-1, LANES)[i : i + n] += rows[:n]


@_lowered(add_rows, lambda args: types.none if _is_vector(args[0]) and args[0].layout == "C" else None)
def _add_rows(context, builder, sig, args):
    array, i, last = args[:3]
    columns = [_numbers(context, builder, x, t) for x, t in zip(args[3:], sig.args[3:], strict=True)]
    for k, row in enumerate(_transposed(builder, columns)):
        place = builder.add(i, i.type(k))
        with builder.if_then(builder.icmp_signed("<", place, last), likely=True):
            first = builder.mul(place, i.type(LANES))
            at = builder.bitcast(_pointer(context, builder, sig.args[0], array, first), _NUMBERS.as_pointer())
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
        row = builder.bitcast(_pointer(context, builder, sig.args[0], array, place), _NUMBERS.as_pointer())
        rows.append(builder.load(row, align=8))
        beside = _pointer(context, builder, sig.args[3], kept, builder.add(at, at.type(LANES * k)))
        places.append(builder.bitcast(beside, _NUMBERS.as_pointer()))
    return rows, places


def _two_vectors(args: tuple[types.Type, ...]) -> bool:
    return all(_is_vector(kind) and kind.layout == "C" for kind in (args[0], args[3]))


@_lowered(same_rows, lambda args: types.boolean if _two_vectors(args) else None)
def _same_rows(context, builder, sig, args):
    rows, places = _raw_rows(context, builder, sig, args)
    same = None
    for row, place in zip(rows, places, strict=True):
        equal = _mask(builder, builder.fcmp_ordered("==", row, builder.load(place, align=8)))
        same = equal if same is None else builder.and_(same, equal)
    return builder.icmp_signed("==", builder.bitcast(_choice(builder, same), ir.IntType(LANES)), ir.IntType(LANES)(-1))


def keep_rows(array, i, last, kept, at):
    """Write rows i to i + 3, of four numbers each, into ``kept`` from place ``at`` on; see `same_rows`."""
    rows = array.reshape(-1, LANES)[np.minimum(np.arange(i, i + LANES), last - 1)]
    kept[at : at + LANES * LANES] = rows.ravel()


@_lowered(keep_rows, lambda args: types.none if _two_vectors(args) else None)
def _keep_rows(context, builder, sig, args):
    for row, place in zip(*_raw_rows(context, builder, sig, args), strict=True):
        builder.store(row, place, align=8)


# -- members at any place ----------------------------------------------------------------------------------------------
PLACES = types.UniTuple(types.int64, LANES)


def pack(a, b, c, d):
    """Four numbers as lanes."""
    return np.array([a, b, c, d], dtype=float)


@_lowered(pack, lambda args: LANE if len(args) == LANES and all(map(_is_number, args)) else None)
def _pack(context, builder, sig, args):
    x = ir.Constant(_NUMBERS, ir.Undefined)
    for k, (number, kind) in enumerate(zip(args, sig.args, strict=True)):
        x = builder.insert_element(x, context.cast(builder, number, kind, types.float64), _INDEX(k))
    return x


def collect(array, places, offset):
    """Entries of an array at four places, each moved by ``offset``."""
    return np.array([array[place + offset] for place in places])


def _at_places(args: tuple[types.Type, ...]) -> bool:
    return _is_vector(args[0]) and args[0].layout == "C" and args[0].dtype == types.float64 and args[1] == PLACES


def _places(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> list[Any]:
    start = context.cast(builder, args[2], sig.args[2], types.int64)
    data = _pointer(context, builder, sig.args[0], args[0], start)
    return [builder.gep(data, [builder.extract_value(args[1], k)]) for k in range(LANES)]


@_lowered(collect, lambda args: LANE if _at_places(args) else None)
def _collect(context, builder, sig, args):
    x = ir.Constant(_NUMBERS, ir.Undefined)
    for k, at in enumerate(_places(context, builder, sig, args)):
        x = builder.insert_element(x, builder.load(at), _INDEX(k))
    return x


def add_to(array, places, offset, x):
    """Add lanes to an array at four places, each moved by ``offset``, one after the other: they may be the same."""
    for place, value in zip(places, x, strict=True):
        array[place + offset] += value


@_lowered(add_to, lambda args: types.none if _at_places(args) and args[3] is LANE else None)
def _add_to(context, builder, sig, args):
    for k, at in enumerate(_places(context, builder, sig, args)):
        one = builder.extract_element(args[3], _INDEX(k))
        builder.store(builder.fadd(builder.load(at), one), at)
    return context.get_dummy_value()
