"""Groups in memory: their types, and how compiled code that does not know a group's type hands it to code that does.

A named tuple of arrays, numbers and further such tuples is laid out in 8-byte words exactly as numba holds it; code
compiled for its type loads it from there as a value. The words refer to the arrays, so these must live on.
"""

from __future__ import annotations

import contextlib
import ctypes
from typing import Any

import numpy as np
from numba import typeof, types
from numba.core.errors import NumbaNotImplementedError
from numba.np.numpy_support import from_dtype, map_layout

PLAIN = (int, float, bool, type(None), np.float64, np.int64)
"""Classes whose values are all of one type to numba."""
ARRAYS = (np.ndarray, np.recarray)
_flags, _entries, _shape, _strides, _size, _width, _memory = (
    getattr(np.ndarray, name).__get__ for name in ("flags", "dtype", "shape", "strides", "size", "itemsize", "ctypes")
)
"""Attributes of arrays, past the class of record arrays: it looks for each in Python, and describes all of its fields
where only an address is wanted."""

_kinds: dict[Any, types.Type] = {}


def kind_of(value: Any) -> types.Type:
    """Numba's type of a value, found once for all values that are made alike.

    Numba looks through all arrays of a group each time, and makes a type for every record in them: that takes a
    millisecond or two. What is looked at here is all that such a type depends on.
    """
    form = form_of(value)
    if form not in _kinds:
        _kinds[form] = _new_kind(value)
    return _kinds[form]


def _new_kind(value: Any) -> types.Type:
    """What numba's `typeof` says of a value; it asks of every array whether it is masked, and loads what these need."""
    kind = type(value)
    if kind in ARRAYS:
        with contextlib.suppress(NumbaNotImplementedError):
            return types.Array(from_dtype(_entries(value)), value.ndim, map_layout(value), not _flags(value).writeable)
    elif isinstance(value, tuple):
        parts = [kind_of(part) for part in value]
        if all(part is not None for part in parts):
            return types.BaseTuple.from_types(parts, kind)
    return typeof(value)


def form_of(value: Any) -> Any:
    """What the type of a value depends on: classes, and of arrays the kind of their entries and how they lie.

    It is made and compared much faster than a type of numba's, which is hashed part by part each time.
    """
    kind = type(value)
    if kind in ARRAYS:
        flags, entries = _flags(value), _entries(value)
        lies = flags.c_contiguous, flags.f_contiguous, flags.writeable, flags.aligned, entries.isalignedstruct
        return entries, value.ndim, lies
    if isinstance(value, tuple):
        return kind, *map(form_of, value)
    # A whole number that needs all of 64 bits has no sign.
    return kind if kind in PLAIN and not (kind is int and value.bit_length() > 63) else typeof(value)


def words_of(value: Any) -> list[int]:
    """The 8-byte words in which compiled code holds a value.

    Raises
    ------
    TypeError
        For what is neither a C-contiguous array, an integer, a float nor a tuple of such.
    """
    if isinstance(value, tuple):
        return [word for part in value for word in words_of(part)]
    if isinstance(value, np.ndarray) and _flags(value).c_contiguous:
        return [0, 0, _size(value), _width(value), _address(value), *_shape(value), *_strides(value)]
    if isinstance(value, (float, np.float64)):
        return [int(np.float64(value).view(np.int64))]
    if isinstance(value, (int, np.int64)) and not isinstance(value, bool):
        return [int(value)]
    raise TypeError(f"a group holds contiguous arrays, integers, floats and tuples of them, not {value!r}")


def laid(value: Any, known: dict[int, tuple[list[int], Any]]) -> tuple[list[int], Any]:
    """Words and form of a value, found in one pass; ``known`` keeps those of tuples by their identity."""
    kind = type(value)
    if kind in ARRAYS:
        flags = _flags(value)
        if flags.c_contiguous:
            entries, shape = _entries(value), _shape(value)
            lies = True, flags.f_contiguous, flags.writeable, flags.aligned, entries.isalignedstruct
            words = [0, 0, _size(value), entries.itemsize, _address(value), *shape, *_strides(value)]
            return words, (entries, len(shape), lies)
    if not isinstance(value, tuple):
        return words_of(value), form_of(value)
    found = known.get(id(value))
    if found is None:
        words, forms = [], [kind]
        for part in value:
            more, form = laid(part, known)
            words += more
            forms.append(form)
        found = known[id(value)] = words, tuple(forms)
    return found


_memory_from = (ctypes.c_char * 0).from_buffer
"""What stands where an array's numbers do, and is no longer than nothing: any array has room for it."""


def _address(array: np.ndarray) -> int:
    """Where an array's numbers are: numpy's own way to it describes the whole array, and takes twice as long."""
    try:
        return ctypes.addressof(_memory_from(array))
    except (TypeError, ValueError, BufferError):  # it is read only, or tells no other its entries
        return int(_memory(array).data)
