"""What a simulation may be made with, checked and refused in words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from tautline.errors import ArgumentTypeError
from tautline.live.errors import SimulationError, real

EXAMPLES = {"parameters": '{"payload.mass": 5200.0}', "initial": '{"winch.pay_out_speed": -0.2}'}
"""Of values by name."""


def names_of(inputs: Any) -> tuple[str, ...]:
    """Names of what is to be driven."""
    names = (inputs,) if isinstance(inputs, str) else tuple(inputs or ()) if np.iterable(inputs or ()) else (inputs,)
    for name in names:
        if not isinstance(name, str):
            raise SimulationError(f"{name!r} is no name of an input", 'give names, such as ["winch.pay_out"]')
    return names


def values_of(given: Any, what: str) -> Mapping[str, Any]:
    """Values by name; raises ArgumentTypeError for what is none."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise ArgumentTypeError(f"{what} = {given!r} is no mapping; give values by name, such as {EXAMPLES[what]}")
    return given


def span_of(keep: Any) -> float:
    """Over how many seconds frames are kept."""
    span = real(keep, "time over which frames are kept", "give True, False or seconds")
    if not 0.0 <= span < math.inf:
        raise SimulationError(f"cannot keep frames of {span:g} s", "give True, False, or seconds from zero on")
    return span
