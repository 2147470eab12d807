"""What a simulation may be made with, checked and refused in words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from tautline.errors import ArgumentTypeError
from tautline.kernels.dofs import TIED, Dofs
from tautline.live.errors import SimulationError, real, shown
from tautline.system.handles import Output

EXAMPLES = {"parameters": '{"payload.mass": 5200.0}', "initial": '{"winch.pay_out_speed": -0.2}'}
"""Of values by name."""


class Displacement(NamedTuple):
    """What is added to a vector of a state, ``q`` or ``v``: at full places, which are these unknowns."""

    vector: str
    places: np.ndarray
    unknowns: np.ndarray
    by: np.ndarray


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


def displacement_of(name: str, by: Any, outputs: Mapping[str, Output], found: Output, dofs: Dofs) -> Displacement:
    """What a displacement changes: a vector of the state, its places and unknowns that are free, and by how much.

    Raises
    ------
    SimulationError
        For what is no position or velocity of a thing, no vector of its size, what only goes along with others, and
        where nothing would move.
    """
    try:
        given = np.asarray(by, float)
    except (TypeError, ValueError, OverflowError):
        raise SimulationError(f"{shown(by)} is no displacement of {name}", "give finite numbers") from None
    if found.places is None:
        free = [each for each, one in outputs.items() if one.places is not None and _is_free(one.places[1], dofs)]
        example = next((each for each in free if each.endswith("velocity")), next(iter(free), ""))
        cure = f"give another output, such as {example}" if example else "nothing of this scene can be displaced"
        raise SimulationError(f"{name} cannot be displaced", cure)
    vector, places = found.places
    if given.shape != places.shape or not np.isfinite(given).all():
        raise SimulationError(f"{by!r} is no displacement of {name}", f"give {places.size} finite numbers")
    places, given = np.atleast_1d(places), np.atleast_1d(given)
    number = dofs.number[places]
    free, asked = number >= 0, given != 0.0
    nothing = not (free & asked if asked.any() else free).any()
    if nothing and (number[asked] == TIED if asked.any() else number == TIED).any():
        on = _what_carries(places, vector, outputs, dofs)
        cure = f"displace {on}: {name} goes along" if on else "displace what it is tied to"
        raise SimulationError(f"{name} cannot be displaced by itself: it rides on other things", cure)
    if nothing and asked.any():
        cause = f"{name} does not move by {np.asarray(by).tolist()}: it is held or prescribed there"
        raise SimulationError(cause, "displace what is free to move; what is prescribed is moved by `inputs`")
    return Displacement(vector, places[free], number[free], given[free])


def _is_free(places: Any, dofs: Dofs) -> bool:
    """Whether a thing can be displaced in some direction."""
    return bool((dofs.number[np.atleast_1d(places)] >= 0).any())


def _what_carries(places: np.ndarray, vector: str, outputs: Mapping[str, Output], dofs: Dofs) -> str:
    """Names of outputs of the same vector that some places are tied to and that can be displaced."""
    masters = {int(k) for i in places for k in dofs.unknown[dofs.start[i] : dofs.start[i + 1]]}
    names = []
    for name, one in outputs.items():
        if one.places is None or one.places[0] != vector:
            continue
        number = dofs.number[np.atleast_1d(one.places[1])]
        unknowns = set(number[number >= 0].tolist())
        if unknowns & masters:
            masters -= unknowns  # another name of the same is told once
            names.append(name)
    return " or ".join(names)
