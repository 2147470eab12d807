"""What can be asked of a running simulation that it cannot do."""

from __future__ import annotations

import math
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from tautline.errors import TautlineError
from tautline.scene.refusal import nearest
from tautline.scene.values.quantity import Quantity

LONGEST, BEGINNING = 100, 40
"""Characters of what was given up to which all of it is told, and of its beginning where it is longer."""


class SimulationError(TautlineError):
    """A request that a simulation refuses; it is left where it was.

    Attributes
    ----------
    cause, cure : str
        What is wrong and what to do. ``str()`` is both.
    """

    def __init__(self, cause: str, cure: str = "") -> None:
        self.cause, self.cure = cause, cure
        super().__init__(f"{cause}; {cure}" if cure else cause)

    def __str__(self) -> str:
        return str(self.args[0])


class Unpickled:
    """What stands in the arrays of a simulation: it goes to no other process, and has no copy of its own."""

    def __reduce_ex__(self, protocol: Any) -> Any:
        cause = f"the {type(self).__name__.lower()} of a simulation cannot be pickled or copied by themselves"
        raise SimulationError(cause, "pickle `save()`, or what they say: dict(...)")


def real(value: Any, what: str, cure: str) -> float:
    """A number as a float: infinite where it is beyond the largest of these, as a whole number may be.

    Raises
    ------
    SimulationError
        For what is no number, or several. True and False are none: they are slips, not 1 and 0.
    """
    if type(value) is float:  # as a twin or a control gives it, thousands of times a second
        return value
    if not isinstance(value, (str, bytes, bool, np.bool_)) and np.ndim(value) == 0 and _is_countable(value):
        with suppress(TypeError, ValueError):
            try:
                return float(value)
            except OverflowError:
                return math.inf if value > 0 else -math.inf
    raise SimulationError(f"{shown(value)} is no {what}", cure)


def shown(value: Any) -> str:
    """What was given, as it is told: of what is long, such as a number of hundreds of digits, the beginning."""
    try:
        told = repr(value)
    except ValueError:  # Python writes no whole number of more than 4300 digits
        return "a number of thousands of digits"
    return told if len(told) <= LONGEST else f"{told[:BEGINNING]}... ({len(told)} characters)"


def _is_countable(value: Any) -> bool:
    """Whether a scalar is no text and no truth in numpy's disguise, ``np.array(True)``."""
    return not isinstance(value, np.ndarray) or value.dtype.kind not in "bSU"


def plain_numbers(array: np.ndarray) -> np.ndarray:
    """Real numbers that stand in an array as objects, such as fractions, as floats; any other array as it is."""
    # numpy would make a number of a text, and no number of None.
    if array.dtype.kind == "O" and not any(one is None or isinstance(one, (str, bytes)) for one in array.flat):
        with suppress(TypeError, ValueError, OverflowError):
            return array.astype(float)
    return array


def seconds(value: Any) -> float:
    """A time in seconds, also of a text with its unit: ``"100 ms"``.

    Raises
    ------
    SimulationError
        For what is no time.
    """
    if isinstance(value, str):
        try:
            return float(Quantity("s").read(value))
        except PydanticCustomError as error:
            cause, cure = error.message(), str((error.context or {}).get("cure", ""))
            raise SimulationError(f"{value!r} is no time: {cause}", cure or 'give seconds, or "100 ms"') from None
    return real(value, "time", 'give seconds, or a text with a unit: "100 ms"')


def check_length(length: float, least: float) -> None:
    """Refuse a length of an advance, s, that is below the least; raises SimulationError."""
    if length < least:
        cause = f"{length:.3g} s is too short to go on by: it is rounding beside output.interval or the time now"
        raise SimulationError(cause, f"go on by {least:.3g} s at least")


class UnknownName(SimulationError, KeyError):
    """A name that an input, output or parameter does not have."""


def unknown(kind: str, name: object, known: Iterable[str], cure: str = "") -> UnknownName:
    """Refuse a name, with the nearest that there is."""
    told = nearest(str(name), sorted(known))
    return UnknownName(f"there is no {kind} '{name}'", f"{told}{'; ' if cure else ''}{cure}")
