"""Numba's types of forms, and forms of numba's types."""

from __future__ import annotations

import functools

import numpy as np
from numba.core import types
from numba.np.numpy_support import from_dtype

from tautline.kernels.compiling.types.records import Record
from tautline.kernels.memory import Form

NUMBERS = {float: types.float64, int: types.int64, bool: types.boolean, type(None): types.none}


@functools.cache
def kind_of(form: Form) -> types.Type:
    """Numba's type of values of a form (:mod:`tautline.kernels.memory`).

    Raises
    ------
    TypeError
        For an array of Python's objects.
    """
    if isinstance(form, types.Type):
        return form
    if isinstance(form, type):
        return NUMBERS[form]
    if isinstance(form, np.dtype):
        return from_dtype(form)
    assert isinstance(form, tuple)
    first, *rest = form
    if isinstance(first, np.dtype):
        if first.hasobject:
            raise TypeError("compiled code takes arrays of numbers and records, not of Python's objects")
        dimensions, layout, writeable, _ = rest
        return types.Array(from_dtype(first), dimensions, layout, not writeable)
    if isinstance(first, str):
        return types.literal(rest[0]) if first == "literal" else types.TypeRef(kind_of(rest[0]))
    kinds = [kind_of(part) for part in rest]
    return types.BaseTuple.from_types(kinds, first) if first is tuple else Record(kinds, first)


def form_of_returned(kind: types.Type) -> Form:
    """The form of what a kernel gives back; None for what Python could not take from memory."""
    kind = types.unliteral(kind)
    for form, same in NUMBERS.items():
        if kind == same:
            return form
    if isinstance(kind, (types.Integer, types.Float)):
        return np.dtype(kind.name)
    if isinstance(kind, types.BaseTuple) and not hasattr(kind, "instance_class"):
        parts = [form_of_returned(part) for part in kind.types]
        return None if None in parts else (tuple, *parts)
    return None
