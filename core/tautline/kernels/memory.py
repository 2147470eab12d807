"""Groups in memory: the form of each, and how compiled code that does not know it hands it to code that does.

A named tuple of arrays, numbers and further such tuples is laid out in 8-byte words exactly as compiled code holds it;
code compiled for its form loads it from there as a value. The words refer to the arrays, so these must live on.

A *form* is all that the type of a value depends on, told without a compiler:

- of a number its class: float, int, bool, and NoneType of what is none; of one with fewer bits its dtype;
- of an array the kind of its entries, its dimensions, its layout ("C", "F" or "A"), whether it can be written to, and
  whether its records are aligned;
- of a tuple its class and the forms of its parts;
- ``("literal", k)`` is a whole number that is known to the compiler, ``("type", form)`` is the type itself.

What else a compiler may know, such as a text, has numba's own type as its form.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Hashable, Iterator
from typing import Any

import numpy as np

Form = Hashable
"""The form of a value."""
CLASSES = {float: float, np.float64: float, int: int, np.int64: int, bool: bool, type(None): type(None)}
"""Classes whose values are all of one form, and that form."""
ARRAYS = (np.ndarray, np.recarray)
_flags, _entries, _shape, _strides, _size, _width, _memory = (
    getattr(np.ndarray, name).__get__ for name in ("flags", "dtype", "shape", "strides", "size", "itemsize", "ctypes")
)
"""Attributes of arrays, past the class of record arrays: it looks for each in Python, and describes all of its fields
where only an address is wanted."""


def form_of(value: Any) -> Form:
    """The form of a value.

    Raises
    ------
    TypeError
        For what compiled code cannot take.
    """
    kind = type(value)
    if kind in ARRAYS:
        flags, entries = _flags(value), _entries(value)
        layout = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
        return entries, value.ndim, layout, flags.writeable, entries.isalignedstruct
    if isinstance(value, tuple):
        return kind, *map(form_of, value)
    # A whole number that needs all of 64 bits has no sign.
    if kind in CLASSES and not (kind is int and value.bit_length() > 63):
        return CLASSES[kind]
    from numba import typeof

    try:
        return typeof(value)
    except Exception:
        raise TypeError(f"compiled code takes arrays, numbers and named tuples of them, not {value!r}") from None


def parts_of(form: Form) -> tuple[type, tuple[Form, ...]] | None:
    """Class and parts of a tuple's form; None of another."""
    if isinstance(form, tuple) and isinstance(form[0], type):
        return form[0], form[1:]
    return None


def classes_in(form: Form) -> Iterator[type]:
    """Classes of the named tuples in a form."""
    if isinstance(form, tuple):
        if isinstance(form[0], type) and form[0] is not tuple:
            yield form[0]
        if isinstance(form[0], (type, str)):
            for part in form[1:]:
                yield from classes_in(part)


@functools.cache
def text_of(form: Form) -> str:
    """A form in words that are the same in every process: a part of the name under which code is kept."""
    if isinstance(form, type):
        return f"{form.__module__}.{form.__qualname__}{getattr(form, '_fields', '')}"
    if isinstance(form, tuple):
        if isinstance(form[0], np.dtype):
            entries, dimensions, layout, writeable, aligned = form
            marks = "".join(mark for mark, true in ((" constant", not writeable), (" aligned", aligned)) if true)
            return f"array({entries}, {dimensions}{layout}{marks})"
        return f"({' '.join(map(text_of, form))})"
    return str(form)


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
        return [0, 0, _size(value), _width(value), address_of(value), *_shape(value), *_strides(value)]
    if isinstance(value, (float, np.float64)):
        return [int(np.float64(value).view(np.int64))]
    if isinstance(value, (int, np.int64)) and not isinstance(value, bool):
        return [int(value)]
    raise TypeError(f"compiled code takes contiguous arrays, integers, floats and tuples of them, not {value!r}")


Known = dict[int, tuple[list[int], Any]]
"""Words and forms of tuples by their identity."""


def laid(value: Any, known: Known, scattered: bool = False) -> tuple[list[int], Any]:
    """Words and form of a value, found in one pass.

    ``known`` keeps those of tuples by their identity; ``scattered`` says whether arrays may have gaps.

    Raises
    ------
    TypeError
        For what compiled code cannot take from memory.
    """
    kind = type(value)
    if kind in ARRAYS:
        flags = _flags(value)
        if flags.c_contiguous or scattered:
            entries, shape = _entries(value), _shape(value)
            words = [0, 0, _size(value), entries.itemsize, address_of(value), *shape, *_strides(value)]
            layout = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
            return words, (entries, len(shape), layout, flags.writeable, entries.isalignedstruct)
    if not isinstance(value, tuple):
        return words_of(value), form_of(value)
    found = known.get(id(value))
    if found is None:
        words, forms = [], [kind]
        for part in value:
            more, form = laid(part, known, scattered)
            words += more
            forms.append(form)
        found = known[id(value)] = words, tuple(forms)
    return found


def laid_out(argument: Any, known: Known) -> tuple[list[int], Any]:
    """Words and form of an argument of a kernel, whose arrays may have gaps; ``known`` as of `laid`."""
    # A yes or no has a word of its own, and None one that nobody reads.
    if argument is None or type(argument) is bool:
        return [int(argument or 0)], type(argument)
    return laid(argument, known, True)


_memory_from = (ctypes.c_char * 0).from_buffer
"""What stands where an array's numbers do, and is no longer than nothing: any array has room for it."""


def address_of(array: np.ndarray) -> int:
    """Where an array's numbers are: numpy's own way to it describes the whole array, and takes twice as long."""
    try:
        return ctypes.addressof(_memory_from(array))
    except (TypeError, ValueError, BufferError):  # it is read only, or tells no other its entries
        return int(_memory(array).data)
