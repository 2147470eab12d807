"""What the arguments of public functions may be, checked in one place and refused in one form of words.

A command calls by its option what Python calls by its argument. What lies below both raises errors in the words of the
command, and functions of the public interface translate them.
"""

from __future__ import annotations

import math
import numbers
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

from tautline.errors import ArgumentError, ArgumentTypeError, TautlineError

OPTION = re.compile(r"(?<![\w-])--?[a-z][a-z-]*(?![\w-])")
"""An option in a sentence."""


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
    """Whether a value is a real number, or an array of no dimension that holds one; True and False are none."""
    return isinstance(plain(value), numbers.Real) and not isinstance(plain(value), (bool, np.bool_))


def is_whole(value: Any) -> bool:
    """Whether a value is a whole number, or an array of no dimension that holds one; True and 2.0 are none."""
    return isinstance(plain(value), numbers.Integral) and not isinstance(plain(value), (bool, np.bool_))


def is_switch(value: Any) -> bool:
    """Whether a value says yes or no: True, False, 1 or 0."""
    return isinstance(plain(value), (bool, np.bool_)) or (is_whole(value) and value in (0, 1))


def is_list(value: Any) -> bool:
    """Whether a value lists others, and can be gone through more than once: a text does not."""
    if isinstance(value, np.ndarray):
        return value.ndim > 0
    return isinstance(value, Collection) and not isinstance(value, (str, bytes, Mapping))


def plain(value: Any) -> Any:
    """Take the number out of an array of no dimension; anything else stays as it is."""
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


def is_positive(value: Any) -> bool:
    """Whether a number is finite and above zero."""
    return bool(0.0 < value < math.inf)


def mapping_of(value: Any) -> Any:
    """Make a mapping of what `dict` takes, such as a table or a list of pairs; what has no texts as keys stays."""
    if isinstance(value, (Mapping, str, bytes)):
        return value
    try:
        made = dict(value)
    except (TypeError, ValueError):
        return value
    return made if made and all(isinstance(key, str) for key in made) else value


PATH = Wanted("a path", lambda value: isinstance(value, (str, os.PathLike)))
NAME = Wanted("a name", lambda value: isinstance(value, str))
SWITCH = Wanted("True or False", is_switch)
FUNCTION = Wanted("a function", callable)
MAPPING = Wanted('a mapping, such as {"bodies[0].mass": "6 t"}', lambda value: isinstance(value, Mapping))
VARIED = Wanted('a mapping, such as {"bodies[0].mass": ["5 t", "6 t"]}', MAPPING.is_one)
OPTIONS = Wanted('a mapping of names to values, such as {"depth": 500}', MAPPING.is_one)
COUNT = Wanted("a whole number from 1 on", is_whole, lambda value: value >= 1)
WHOLE = Wanted("a whole number", is_whole)
BUDGET = Wanted("a number above zero, or infinity for no limit,", is_number, lambda value: bool(value > 0.0))
ABOVE_ZERO = Wanted("a finite number above zero", is_number, is_positive)
NUMBERS = Wanted("a list of numbers above zero, such as [1e-3, 5e-4]", is_list)
NAMES = Wanted("a list of names", is_list)
FIGURES = Wanted(
    'a name, or a list of names and mappings, such as ["max_tension"]',
    lambda value: isinstance(value, Iterable) and not isinstance(value, bytes),
)
RESULT = Wanted(
    "a result, as simulate and Result.read give it",
    lambda value: hasattr(value, "attributes") and hasattr(value, "restart"),
)

RESULTS = Wanted("a list of results", is_list)


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


def check_members(name: str, given: Any, listed: Wanted, member: Wanted) -> None:
    """Check a list, or None, and each of its members, which is named by its place; raises as `check`."""
    check(**{name: (given, listed)})
    for place, one in enumerate(() if given is None else given):
        check_given(**{f"{name}[{place}]": (one, member)})


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


@contextmanager
def as_arguments(names: Mapping[str, str]) -> Iterator[None]:
    """Have what is refused name arguments where it would name options; it also decorates a function.

    Parameters
    ----------
    names : mapping
        Option -> argument: ``{"-o": "path", "--image": "time"}``. An option that is not among them stays as it is.
    """

    def subject(option: str) -> str:
        return f"argument {names[option]}" if option in names else option

    def sentence(text: str) -> str:
        return OPTION.sub(lambda one: f"the argument `{names[one[0]]}`" if one[0] in names else one[0], text)

    try:
        yield
    except TautlineError as error:
        error.translate(subject, sentence)
        raise
