"""A quantity that a run records."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Variable:
    """Name, shape and unit of something stored at every frame.

    Attributes
    ----------
    name : str
        Name in the file, such as ``tension``.
    dims : tuple of str
        Dimension names; the first is ``time``.
    units : str
        SI unit, such as ``N``.
    long_name : str
        What it is, in words; plots write it at their axes.
    jumps : bool
        Whether it says which of a few states something is in, such as 1 where it slips and else 0. A run knows it, and
        files do not hold it.
    """

    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    jumps: bool = field(default=False, compare=False)


def listed(variables: Iterable[Variable]) -> list[str]:
    """Variables with their units, a line for each set of dimensions; coordinates are left out."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for one in variables:
        if one.dims != (one.name,):
            groups.setdefault(one.dims, []).append(f"{one.name} [{one.units}]" if one.units else one.name)
    return [f"({', '.join(dims)}) {', '.join(names)}" for dims, names in groups.items()]


def outside(number: float, time: np.ndarray) -> bool:
    """Whether a time, s, is of no frame of a run: before or behind all (m,) by more than lies between two of them."""
    room = float(np.max(np.diff(time))) if len(time) > 1 else 0.0
    return not time[0] - room <= number <= time[-1] + room


def late_start(result: Any) -> str:
    """Where a result begins that does not know the start of its run: ``8 s, where the result begins``; else empty.

    Its `at_start` is then the values of that time.
    """
    start = getattr(result, "start", {})
    begins = start if "time" in start else result
    if "time" not in begins:
        return ""
    time = float(begins["time"][0])
    return f"{time:.4g} s, where the result begins" if time > 0.0 else ""


def at_start(result: Any, name: str) -> Any:
    """Values of a variable at the start of a run: its first frame, also where the result is a part without that frame.

    Parameters
    ----------
    result : Result or mapping
        Of variables by name, (m, ...) each.
    name : str
        Of the variable; its values have the shape (...).
    """
    start = getattr(result, "start", {})
    return (start[name] if name in start else result[name])[0]


def at_rest(result: Any, name: str) -> np.ndarray | None:
    """Values of a variable in the static equilibrium that a run began from, before anything moved.

    They need not be those of the first frame where something is set moving at once: damping may be in that frame.

    Returns
    -------
    array or None
        None where the result does not tell: no equilibrium was sought, it was that of another run, or an earlier
        version wrote the result.
    """
    start = getattr(result, "attributes", {}).get("start") or {}
    found = start.get("at_rest", {}).get(name)
    return None if found is None else np.asarray(found, float)
