"""What the arguments of public functions may be, checked in one place and refused in one form of words."""

from __future__ import annotations

import math
import numbers
import os
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from tautline.errors import ArgumentError, ArgumentTypeError


class Wanted(NamedTuple):
    """What an argument may be.

    Attributes
    ----------
    text : str
        In words, with an example where that helps.
    is_one : callable
        Value -> whether it is of the type.
    may_be : callable
        Value of the type -> whether it can be.
    """

    text: str
    is_one: Callable[[Any], bool]
    may_be: Callable[[Any], bool] = lambda value: True


def is_number(value: Any) -> bool:
    """Whether a value is a real number; True and False are none."""
    return isinstance(value, numbers.Real) and not isinstance(value, (bool, np.bool_))


def is_whole(value: Any) -> bool:
    """Whether a value is a whole number; True and 2.0 are none."""
    return isinstance(value, numbers.Integral) and not isinstance(value, (bool, np.bool_))


def is_list(value: Any) -> bool:
    """Whether a value lists others, and can be gone through more than once: a text does not."""
    return isinstance(value, Collection) and not isinstance(value, (str, bytes, Mapping))


def is_positive(value: Any) -> bool:
    """Whether a number is finite and above zero."""
    return bool(0.0 < value < math.inf)


PATH = Wanted("a path", lambda value: isinstance(value, (str, os.PathLike)))
NAME = Wanted("a name", lambda value: isinstance(value, str))
SWITCH = Wanted("True or False", lambda value: isinstance(value, (bool, np.bool_)))
FUNCTION = Wanted("a function", callable)
MAPPING = Wanted('a mapping, such as {"bodies[0].mass": "6 t"}', lambda value: isinstance(value, Mapping))
OPTIONS = Wanted('a mapping of names to values, such as {"depth": 500}', MAPPING.is_one)
COUNT = Wanted("a whole number from 1 on", is_whole, lambda value: value >= 1)
ABOVE_ZERO = Wanted("a number above zero", is_number, is_positive)
NUMBERS = Wanted(
    "a list of numbers above zero, such as [1e-3, 5e-4]",
    lambda value: is_list(value) and all(is_number(one) for one in value),
    lambda value: all(is_positive(one) for one in value),
)
NAMES = Wanted("a list of names", lambda value: is_list(value) and all(isinstance(one, str) for one in value))
FIGURES = Wanted(
    'a name, or a list of names and mappings, such as ["max_tension"]',
    lambda value: isinstance(value, Iterable) and not isinstance(value, bytes),
)
RESULT = Wanted(
    "a result, as simulate and Result.read give it",
    lambda value: hasattr(value, "attributes") and hasattr(value, "restart"),
)


def check(**arguments: tuple[Any, Wanted]) -> None:
    """Check arguments, of which None is allowed: name = (value, what is wanted).

    Raises
    ------
    ArgumentTypeError, ArgumentError
        For the first that is of another type, or cannot be.
    """
    check_given(**{name: one for name, one in arguments.items() if one[0] is not None})


def check_given(**arguments: tuple[Any, Wanted]) -> None:
    """Check arguments that have to be given; raises as `check`."""
    for name, (value, wanted) in arguments.items():
        if not wanted.is_one(value):
            raise ArgumentTypeError(f"{name} = {value!r}: {wanted.text} is wanted, not {type(value).__name__}")
        if not wanted.may_be(value):
            raise ArgumentError(f"{name} = {value!r}: {wanted.text} is wanted")


def check_options(given: Mapping[str, Any], known: Mapping[str, Wanted]) -> None:
    """Check arguments that are handed on by name; raises as `check`, and ArgumentTypeError for a name that is none."""
    for name, value in given.items():
        if name not in known:
            raise ArgumentTypeError(f"there is no argument '{name}'; give one of {', '.join(known)}")
        check(**{name: (value, known[name])})


def check_choices(name: str, given: Iterable[str] | None, known: Collection[str]) -> None:
    """Refuse a word that is none of those known; raises ArgumentError."""
    for one in given or ():
        if one not in known:
            raise ArgumentError(f"{name}: there is no '{one}'; give some of {', '.join(known)}")
