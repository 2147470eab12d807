"""How fast a scene is driven: the highest frequency of each function of time in it, and what that asks of the step."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator
from typing import Any

import pydantic

from tautline.scene.functions import Chirp, Harmonic, Ramp, Spectrum
from tautline.scene.reading.document import join_key

STEPS_PER_PERIOD = 10.0
"""Steps that a decent picture of an oscillation takes (thesis section 2.5)."""
TOP_OF_SPECTRUM = 2.0
"""Frequency, over that of the peak, above which there is little in a sea: a fiftieth of its energy."""
PLAIN = frozenset({float, int, bool, str, type(None)})
"""Types of what holds no function of time."""

HOLDS_NONE = "holds_no_function"
"""Attribute of parts, such as an element, in which there never is a function of time: some scenes have many."""

Key = tuple[str | int, ...]


def frequencies(part: Any, end: float, key: Key = ()) -> Iterator[tuple[str, float]]:
    """Key path and highest frequency, Hz, of every function of time in a scene or a part of one.

    A sine has its own, a chirp that which it reaches by the ``end``, s, a sea twice its peak's; a ramp counts as a
    period of its length. Constants and tables have none.
    """
    found = _frequency(part, end)
    if found is not None:
        yield join_key(key), found
        return
    if isinstance(part, pydantic.BaseModel):
        items: Any = [(name, getattr(part, name)) for name in _names(type(part))]
    elif _is_record(part):
        items = [(name, getattr(part, name)) for name in _names(part.__class__) if name != "document"]
    elif isinstance(part, (list, tuple)):
        items = list(enumerate(part))
    else:
        return
    for name, value in items:
        if type(value) not in PLAIN and not getattr(value, HOLDS_NONE, False):
            yield from frequencies(value, end, (*key, name))


def _is_record(part: Any) -> bool:
    return (dataclasses.is_dataclass(part) or hasattr(part, "_fields")) and not isinstance(part, type)


@functools.cache
def _names(kind: Any) -> tuple[str, ...]:
    """Fields of a class of models, dataclasses or named tuples; asked for once, not for each of 100,000 parts."""
    if issubclass(kind, pydantic.BaseModel):
        return tuple(kind.model_fields)
    if issubclass(kind, tuple):
        return kind._fields
    return tuple(field.name for field in dataclasses.fields(kind))


def _frequency(part: Any, end: float) -> float | None:
    if isinstance(part, Harmonic):
        return part.frequency if part.frequency is not None else 1.0 / float(part.period or math.inf)
    if isinstance(part, Chirp):
        rates = (2.0 * math.pi / part.period + 2.0 * part.rate * (t - part.shift) for t in (0.0, end))
        return max(abs(rate) for rate in rates) / (2.0 * math.pi)
    if isinstance(part, Spectrum):
        return TOP_OF_SPECTRUM / part.peak_period
    if isinstance(part, Ramp):
        return 1.0 / part.over if part.at < end else None
    return None


def too_fast(scene: Any, solver: Any) -> str | None:
    """Say that a fixed step is too long for what drives a scene, or for what it is to show; None where it is not.

    Parameters
    ----------
    scene : scene
        Validated.
    solver : Solver or CableSolver
        With ``step``, ``end``, ``control`` and ``frequency``, Hz, the highest that the answer is to show.
    """
    if solver.step == "auto" or solver.control != "fixed":
        return None
    found = list(frequencies(scene, float(solver.end)))
    if solver.frequency is not None:
        found.append(("solver.frequency", solver.frequency))
    key, fastest = max(found, key=lambda entry: entry[1], default=("", 0.0))
    steps = 1.0 / (fastest * solver.step) if fastest > 0.0 else math.inf
    if steps >= STEPS_PER_PERIOD * (1.0 - 1e-9):
        return None
    return (
        f"{solver.step:g} s takes {steps:.2g} steps in a period of the {fastest:.3g} Hz of {key}, where "
        f"{STEPS_PER_PERIOD:g} make a decent picture: take {1.0 / (STEPS_PER_PERIOD * fastest):.2g} s or less"
    )
