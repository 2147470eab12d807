"""Four numbers at once: a vector register of the processor as a type of compiled code.

An element's equations have no loop that a compiler could turn into vector instructions: they are hundreds of products
and sums of a dozen numbers. But the next element has the same ones. A kernel that is written for ``Lanes`` does four
elements in the time of one, and reads as it does for one: ``+ - * /`` act lane by lane, a float counts for all lanes.

Where kernels are not compiled (``NUMBA_DISABLE_JIT=1``), lanes are NumPy arrays (4,).
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import config
from numba.core import cgutils, types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from tautline.kernels.jit import kernel

WIDTH = 4
"""Numbers in a register of 256 bits. Narrower processors take two instructions."""
DOUBLE, VECTOR = ir.DoubleType(), ir.VectorType(ir.DoubleType(), WIDTH)
OPERATORS = {operator.add: "fadd", operator.sub: "fsub", operator.mul: "fmul", operator.truediv: "fdiv"}
"""Operators by LLVM's name. None works in place: uncompiled, it would change the array of all that are the same."""


class LanesType(types.Type):
    """The type of four floats in a register."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


LANES = LanesType()
"""Four floats in compiled code."""
PLACES = types.UniTuple(types.int64, WIDTH)


@register_model(LanesType)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: types.Type) -> None:
        super().__init__(manager, kind, VECTOR)


def _constant(k: int) -> ir.Constant:
    return ir.Constant(ir.IntType(32), k)


def _packed(builder: Any, numbers: Any) -> Any:
    vector = ir.Constant(VECTOR, ir.Undefined)
    for k, x in enumerate(numbers):
        vector = builder.insert_element(vector, x, _constant(k))
    return vector


def _lanes(builder: Any, x: Any) -> Any:
    """A vector as it is, a number in all lanes."""
    return x if x.type == VECTOR else _packed(builder, [x] * WIDTH)


def _register(python: Any, name: str) -> None:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        cast = [
            x if t is LANES or isinstance(t, LanesType) else context.cast(builder, x, t, types.float64)
            for x, t in zip(values, given.args, strict=True)
        ]
        return getattr(builder, name)(*(_lanes(builder, x) for x in cast))

    class Typing(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            number = [isinstance(t, (types.Float, types.Integer)) for t in args]
            lanes = [isinstance(t, LanesType) for t in args]
            if len(args) == 2 and any(lanes) and all(a or b for a, b in zip(number, lanes, strict=True)):
                return signature(LANES, *args)
            return None

    infer_global(python)(Typing)
    for left, right in ((LanesType, LanesType), (LanesType, types.Number), (types.Number, LanesType)):
        lower_builtin(python, left, right)(code)


for _python, _name in OPERATORS.items():
    _register(_python, _name)


@infer_global(operator.neg)
class _Negative(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(LANES, LANES) if isinstance(args[0], LanesType) else None


@lower_builtin(operator.neg, LanesType)
def _negative(context: Any, builder: Any, given: Any, values: Any) -> Any:
    return builder.fneg(values[0])


def _data(context: Any, builder: Any, array: Any, value: Any) -> Any:
    return context.make_array(array)(context, builder, value).data


@intrinsic
def _gather(typing: Any, x: Any, places: Any, offset: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        data = _data(context, builder, given.args[0], values[0])
        data = builder.gep(data, [values[2]])
        places = [builder.extract_value(values[1], k) for k in range(WIDTH)]
        return _packed(builder, [builder.load(builder.gep(data, [place])) for place in places])

    return LANES(x, PLACES, types.int64), code


@intrinsic
def _scatter(typing: Any, x: Any, places: Any, offset: Any, lanes: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        data = builder.gep(_data(context, builder, given.args[0], values[0]), [values[2]])
        for k in range(WIDTH):
            at = builder.gep(data, [builder.extract_value(values[1], k)])
            builder.store(builder.fadd(builder.load(at), builder.extract_element(values[3], _constant(k))), at)
        return context.get_dummy_value()

    return types.void(x, PLACES, types.int64, LANES), code


@intrinsic
def _pack(typing: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        return _packed(builder, values)

    return LANES(*[types.float64] * WIDTH), code


@intrinsic
def _load(typing: Any, x: Any, i: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        at = builder.gep(_data(context, builder, given.args[0], values[0]), [values[1]])
        return builder.load(builder.bitcast(at, VECTOR.as_pointer()), align=8)

    return LANES(x, types.int64), code


@intrinsic
def _store(typing: Any, x: Any, i: Any, lanes: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        at = builder.gep(_data(context, builder, given.args[0], values[0]), [values[1]])
        builder.store(values[2], builder.bitcast(at, VECTOR.as_pointer()), align=8)
        return context.get_dummy_value()

    return types.void(x, types.int64, LANES), code


@intrinsic
def _root(typing: Any, x: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        kind = ir.FunctionType(VECTOR, [VECTOR])
        function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.sqrt.v{WIDTH}f64")
        return builder.call(function, values)

    return LANES(LANES), code


@intrinsic
def _where_negative(typing: Any, x: Any, yes: Any, no: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        below = builder.fcmp_ordered("<", values[0], ir.Constant(VECTOR, [0.0] * WIDTH))
        return builder.select(below, values[1], values[2])

    return LANES(LANES, LANES, LANES), code


@intrinsic
def _unpacked(typing: Any, x: Any) -> Any:
    def code(context: Any, builder: Any, given: Any, values: Any) -> Any:
        numbers = [builder.extract_element(values[0], _constant(k)) for k in range(WIDTH)]
        return context.make_tuple(builder, given.return_type, numbers)

    return types.UniTuple(types.float64, WIDTH)(LANES), code


if config.DISABLE_JIT:

    def _gather(x, places, offset):
        return np.array([x[place + offset] for place in places])

    def _scatter(x, places, offset, lanes):
        for place, value in zip(places, lanes, strict=True):
            x[place + offset] += value

    def _pack(*numbers):
        return np.array(numbers, dtype=float)

    def _load(x, i):
        return np.array(x[i : i + WIDTH])

    def _store(x, i, lanes):
        x[i : i + WIDTH] = lanes

    def _root(x):
        return np.sqrt(x)

    def _where_negative(x, yes, no):
        return np.where(x < 0.0, yes, no)

    def _unpacked(x):
        return tuple(x.tolist())


@kernel(forceinline=True)
def gather(x, places, offset):
    """Numbers of a vector from four places, each moved by ``offset``."""
    return _gather(x, places, offset)


@kernel(forceinline=True)
def scatter(x, places, offset, lanes):
    """Add to a vector at four places, each moved by ``offset``, one after the other: they may be the same."""
    _scatter(x, places, offset, lanes)


@kernel(forceinline=True)
def pack(a, b, c, d):
    """Four numbers as lanes."""
    return _pack(a, b, c, d)


@kernel(forceinline=True)
def spread(x):
    """One number in all lanes."""
    return _pack(x, x, x, x)


@kernel(forceinline=True)
def load(x, i):
    """Four numbers of a vector without gaps, from its i-th on."""
    return _load(x, i)


@kernel(forceinline=True)
def store(x, i, lanes):
    """Write four numbers into a vector without gaps, from its i-th on."""
    _store(x, i, lanes)


@kernel(forceinline=True)
def root(x):
    """Square roots."""
    return _root(x)


@kernel(forceinline=True)
def where_negative(x, yes, no):
    """One or the other in each lane, by the sign of x."""
    return _where_negative(x, yes, no)


@kernel(forceinline=True)
def size(x):
    """Values without their signs."""
    return _where_negative(x, -x, x)


@kernel(forceinline=True)
def larger(x, y):
    """The larger of two in each lane; y where one is no number."""
    return _where_negative(y - x, x, y)


@kernel(forceinline=True)
def largest_of(x):
    """The largest of four."""
    a, b, c, d = _unpacked(x)
    return max(max(a, b), max(c, d))


@kernel(forceinline=True)
def sum_of(x):
    """The sum of four."""
    a, b, c, d = _unpacked(x)
    return (a + b) + (c + d)


@kernel(forceinline=True)
def gather_vector(x, places, offset):
    """Three lanes: the components of vectors that begin at four places, each moved by ``offset``."""
    return _gather(x, places, offset), _gather(x, places, offset + 1), _gather(x, places, offset + 2)


@kernel(forceinline=True)
def scatter_vector(x, places, offset, vector):
    """Add three lanes to the vectors that begin at four places, each moved by ``offset``."""
    _scatter(x, places, offset, vector[0])
    _scatter(x, places, offset + 1, vector[1])
    _scatter(x, places, offset + 2, vector[2])


@kernel(forceinline=True)
def members(n, count):
    """Numbers of four members of a group from the n-th on, and 1 for each of them.

    Where there are fewer left, the last stands for those that there are not, and counts 0.
    """
    last = count - 1
    i, j, k = min(n + 1, last), min(n + 2, last), min(n + 3, last)
    counts = _pack(
        1.0, 1.0 if n + 1 <= last else 0.0, 1.0 if n + 2 <= last else 0.0, 1.0 if n + 3 <= last else 0.0
    )  # fmt: skip
    return (n, i, j, k), counts
