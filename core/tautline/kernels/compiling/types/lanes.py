"""Four numbers in one register of the processor as a type of compiled code: operators and functions, in LLVM's code.

What each does is said, and done by NumPy, in :mod:`tautline.kernels.lanes.arithmetic`.
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

from tautline.kernels.lanes import arithmetic
from tautline.kernels.lanes.arithmetic import LANES

NUMBERS = ir.VectorType(ir.DoubleType(), LANES)
BITS = ir.VectorType(ir.IntType(64), LANES)
INDEX = ir.IntType(32)


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
        super().__init__(dmm, kind, NUMBERS)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    """A vector of words, all ones where the answer is yes: what comparisons leave in a register."""

    def __init__(self, dmm: Any, kind: types.Type) -> None:
        super().__init__(dmm, kind, BITS)


Typer = Callable[[tuple[types.Type, ...]], "types.Type | None"]


def lowered(stub: Any, result: Typer) -> Callable[[Any], Any]:
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


def splat(builder: Any, x: Any, kind: Any = NUMBERS) -> Any:
    """One value in all places of a vector."""
    nothing = ir.Constant(kind, ir.Undefined)
    one = builder.insert_element(nothing, x, INDEX(0))
    return builder.shuffle_vector(one, nothing, ir.Constant(ir.VectorType(INDEX, LANES), [0] * LANES))


def _constant(x: float) -> Any:
    return ir.Constant(NUMBERS, [x] * LANES)


def _words(x: int) -> Any:
    return ir.Constant(BITS, [x] * LANES)


def as_lanes(context: Any, builder: Any, x: Any, kind: types.Type) -> Any:
    """An argument as a vector: what is one number stands in every lane."""
    return x if kind is LANE else splat(builder, context.cast(builder, x, kind, types.float64))


def choice_of(builder: Any, mask: Any) -> Any:
    """A mask as bits."""
    return builder.icmp_signed("!=", mask, _words(0))


def mask_of(builder: Any, choice: Any) -> Any:
    """Bits as a mask."""
    return builder.sext(choice, BITS)


def _intrinsic(builder: Any, name: str, kind: Any, *args: Any) -> Any:
    suffix = f"v{LANES}f64" if kind == NUMBERS else "f64"
    function = cgutils.get_or_insert_function(
        builder.module, ir.FunctionType(kind, [kind] * len(args)), f"llvm.{name}.{suffix}"
    )
    return builder.call(function, args)


# -- arithmetic and comparisons ----------------------------------------------------------------------------------------


def _both(args: tuple[types.Type, ...]) -> bool:
    """Whether these are lanes, or lanes and a number."""
    return LANE in args and all(kind is LANE or isinstance(kind, types.Number) for kind in args)


def _operators(python: Any, kind: types.Type, count: int, apply: Callable[..., Any]) -> None:
    """Teach an operator of Python lanes."""

    class Template(AbstractTemplate):
        """What numba takes the operator for."""

        key = python

        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
            """Signature for lanes."""
            given = tuple(types.unliteral(each) for each in args)
            return signature(kind, *given) if len(given) == count and _both(given) else None

    infer_global(python)(Template)

    def code(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> Any:
        return apply(builder, *(as_lanes(context, builder, x, t) for x, t in zip(args, sig.args, strict=True)))

    if count == 1:
        lower_builtin(python, LANE)(code)
        return
    for given in ((LANE, LANE), (LANE, types.Number), (types.Number, LANE)):
        lower_builtin(python, *given)(code)


for _keys, _name in (
    ((operator.add, operator.iadd), "fadd"),
    ((operator.sub, operator.isub), "fsub"),
    ((operator.mul, operator.imul), "fmul"),
    ((operator.truediv, operator.itruediv), "fdiv"),
):
    for _key in _keys:
        _operators(_key, LANE, 2, lambda builder, x, y, name=_name: getattr(builder, name)(x, y))
_operators(operator.neg, LANE, 1, lambda builder, x: builder.fneg(x))
_operators(abs, LANE, 1, lambda builder, x: _intrinsic(builder, "fabs", NUMBERS, x))
for _key, _name in (
    (operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">="), (operator.eq, "=="),
):  # fmt: skip
    _operators(
        _key, MASK, 2, lambda builder, x, y, name=_name: mask_of(builder, builder.fcmp_ordered(name, x, y))
    )  # fmt: skip


def _two_masks(python: Any, name: str) -> None:
    class Template(AbstractTemplate):
        """What numba takes the operator for."""

        key = python

        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
            """Signature for masks."""
            return signature(MASK, MASK, MASK) if args == (MASK, MASK) else None

    infer_global(python)(Template)
    lower_builtin(python, MASK, MASK)(lambda context, builder, sig, args: getattr(builder, name)(*args))


_two_masks(operator.and_, "and_")
_two_masks(operator.or_, "or_")


@lowered(arithmetic.negated, lambda args: MASK if args == (MASK,) else None)
def _negated(context, builder, sig, args):
    return builder.xor(args[0], _words(-1))


@lowered(arithmetic.any_of, lambda args: types.boolean if args == (MASK,) else None)
def _any_of(context, builder, sig, args):
    answers = builder.bitcast(choice_of(builder, args[0]), ir.IntType(LANES))
    return builder.icmp_unsigned("!=", answers, ir.IntType(LANES)(0))


def is_number(kind: types.Type) -> bool:
    """Whether this is the type of one number."""
    return isinstance(kind, types.Number)


def _chosen(args: tuple[types.Type, ...]) -> types.Type | None:
    if len(args) == 3 and args[0] is MASK and all(kind is LANE or is_number(kind) for kind in args[1:]):
        return LANE
    return types.float64 if args[0] is types.boolean and all(map(is_number, args[1:])) else None


@lowered(arithmetic.where, _chosen)
def _where(context, builder, sig, args):
    mask, x, y = args
    if sig.args[0] is MASK:
        x, y = (as_lanes(context, builder, v, t) for v, t in zip((x, y), sig.args[1:], strict=True))
        return builder.select(choice_of(builder, mask), x, y)
    x, y = (context.cast(builder, v, t, types.float64) for v, t in zip((x, y), sig.args[1:], strict=True))
    return builder.select(mask, x, y)


def _of_numbers(args: tuple[types.Type, ...]) -> types.Type | None:
    if all(kind is LANE or is_number(kind) for kind in args):
        return LANE if LANE in args else types.float64
    return None


@lowered(arithmetic.larger, _of_numbers)
def _larger(context, builder, sig, args):
    if sig.return_type is LANE:
        x, y = (as_lanes(context, builder, v, t) for v, t in zip(args, sig.args, strict=True))
    else:
        x, y = (context.cast(builder, v, t, types.float64) for v, t in zip(args, sig.args, strict=True))
    return builder.select(builder.fcmp_ordered(">", x, y), x, y)


@lowered(arithmetic.sqrt, _of_numbers)
def _sqrt(context, builder, sig, args):
    if sig.return_type is LANE:
        return _intrinsic(builder, "sqrt", NUMBERS, args[0])
    return _intrinsic(builder, "sqrt", ir.DoubleType(), context.cast(builder, args[0], sig.args[0], types.float64))


@lowered(arithmetic.exp, _of_numbers)
def _exp(context, builder, sig, args):
    if sig.return_type is LANE:
        return _intrinsic(builder, "exp", NUMBERS, args[0])
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
    turns = builder.add(builder.bitcast(shifted, BITS), _words(quarters))
    odd = builder.icmp_signed("!=", builder.and_(turns, _words(1)), _words(0))
    value = builder.select(odd, cosine, sine)
    sign = builder.shl(builder.and_(turns, _words(2)), _words(62))
    return builder.bitcast(builder.xor(builder.bitcast(value, BITS), sign), NUMBERS)


def _angle_function(name: str, quarters: int) -> Callable[..., Any]:
    def code(context: Any, builder: Any, sig: Any, args: Sequence[Any]) -> Any:
        if sig.return_type is LANE:
            return _turned(builder, args[0], quarters)
        return _intrinsic(builder, name, ir.DoubleType(), context.cast(builder, args[0], sig.args[0], types.float64))

    return code


lowered(arithmetic.sin, _of_numbers)(_angle_function("sin", 0))
lowered(arithmetic.cos, _of_numbers)(_angle_function("cos", 1))


@lowered(arithmetic.lane, lambda args: types.float64 if args[0] is LANE else None)
def _lane(context, builder, sig, args):
    return builder.extract_element(args[0], builder.trunc(args[1], INDEX))


@lowered(arithmetic.spread, lambda args: LANE if is_number(args[0]) else None)
def _spread(context, builder, sig, args):
    return as_lanes(context, builder, args[0], sig.args[0])


@lowered(arithmetic.within, lambda args: MASK)
def _within(context, builder, sig, args):
    places = builder.add(splat(builder, args[0], BITS), ir.Constant(BITS, list(range(LANES))))
    return mask_of(builder, builder.icmp_signed("<", places, splat(builder, args[1], BITS)))


@lowered(arithmetic.total, lambda args: types.float64 if args[0] is LANE else None)
def _total(context, builder, sig, args):
    parts = [builder.extract_element(args[0], INDEX(k)) for k in range(LANES)]
    return builder.fadd(builder.fadd(parts[0], parts[2]), builder.fadd(parts[1], parts[3]))


@lowered(arithmetic.largest, lambda args: types.float64 if args[0] is LANE else None)
def _largest(context, builder, sig, args):
    most = builder.extract_element(args[0], INDEX(0))
    for k in range(1, LANES):
        other = builder.extract_element(args[0], INDEX(k))
        most = builder.select(builder.fcmp_ordered(">", other, most), other, most)
    return most


@lowered(arithmetic.pack, lambda args: LANE if len(args) == LANES and all(map(is_number, args)) else None)
def _pack(context, builder, sig, args):
    x = ir.Constant(NUMBERS, ir.Undefined)
    for k, (number, kind) in enumerate(zip(args, sig.args, strict=True)):
        x = builder.insert_element(x, context.cast(builder, number, kind, types.float64), INDEX(k))
    return x
