"""What is done with four numbers in one register of the processor, as NumPy does it where nothing is compiled.

An operator or a function has one code for lanes and for plain numbers (:mod:`tautline.kernels.compiling.types.lanes`).
"""

from __future__ import annotations

import numpy as np

from tautline.kernels.numba_registration import taught

LANES = 4
"""Members at a time."""


def negated(mask):
    """The answers turned round."""
    return ~mask


def any_of(mask):
    """Whether any lane says yes."""
    return bool(np.any(mask))


def where(mask, x, y):
    """``x`` where the mask says yes, ``y`` elsewhere; of plain numbers, one of both."""
    return np.where(mask, x, y) if isinstance(mask, np.ndarray) else (x if mask else y)


def larger(x, y):
    """The larger of two, lane by lane; ``y`` where ``x`` is no number."""
    return where(x > y, x, y)


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


def lane(x, k):
    """The number in lane k."""
    return x[k]


def spread(x):
    """One number in every lane."""
    return np.full(LANES, x)


def within(i, last):
    """Which of the members i, i + 1, ... are before the last: the others are repeated."""
    return np.arange(i, i + LANES) < last


def total(x):
    """Sum of the lanes: of pairs first."""
    return (x[0] + x[2]) + (x[1] + x[3])


def largest(x):
    """Largest of the lanes."""
    return max(x)


def pack(a, b, c, d):
    """Four numbers as lanes."""
    return np.array([a, b, c, d], dtype=float)


taught("types.lanes")
