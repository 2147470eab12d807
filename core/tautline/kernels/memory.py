"""Groups in memory: how compiled code that does not know a group's type hands it to code that does.

A named tuple of arrays, numbers and further such tuples is laid out in 8-byte words exactly as numba holds it; code
compiled for its type loads it from there as a value. The words refer to the arrays, so these must live on.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def words_of(value: Any) -> list[int]:
    """The 8-byte words in which compiled code holds a value.

    Raises
    ------
    TypeError
        For what is neither a C-contiguous array, an integer, a float nor a tuple of such.
    """
    if isinstance(value, tuple):
        return [word for part in value for word in words_of(part)]
    if isinstance(value, np.ndarray) and value.flags.c_contiguous:
        return [0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides]
    if isinstance(value, (float, np.float64)):
        return [int(np.float64(value).view(np.int64))]
    if isinstance(value, (int, np.int64)) and not isinstance(value, bool):
        return [int(value)]
    raise TypeError(f"a group holds contiguous arrays, integers, floats and tuples of them, not {value!r}")
