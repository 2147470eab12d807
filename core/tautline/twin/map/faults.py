"""What is said of faults in a map: cause and cure of a unit, and of a start outside its range."""

from __future__ import annotations

import re

from pydantic_core import PydanticCustomError

from tautline.scene.values.quantity import Quantity
from tautline.scene.values.units import TABLE, Unit

UNIT_BEHIND = re.compile(r"[-+]?[0-9.]+(?:[eE][-+]?\d+)?\s*([^\s0-9.+-].*)")
WEIGHTS = {"t": "tf", "kg": "kgf", "lb": "lbf", "klb": "klbf"}
"""Units of mass, and of their weight."""


def other_quantity(written: str, unit: Unit, wanted: str, si: Unit) -> tuple[str, str]:
    """Cause and cure of a column's unit that is one of another quantity than is `wanted`."""
    if (unit.dimension, si.dimension) != (TABLE["kg"].dimension, TABLE["N"].dimension):
        return f"'{written}' is not a unit of this quantity", f"its unit is {wanted or 'none'}"
    weight = next((force for mass, force in WEIGHTS.items() if TABLE[mass].factor == unit.factor), None)
    cure = f"write unit: {weight}, the weight of 1 {written}" if weight else "write a unit of force, such as kN"
    return f"'{written}' is a unit of mass, and this is a force", cure


def outside(
    start: float | str | None,
    scene: float,
    span: tuple[float | str, float | str],
    bounds: tuple[float, float],
    unit: str,
) -> tuple[str, str]:
    """Cause and cure of a start outside its range.

    Parameters
    ----------
    start : number, text or None
        As written; where none is, the estimate begins with the value of the `scene`.
    span : (2,)
        The range as written.
    bounds : (2,)
        The same in SI.
    """
    ends = " to ".join(_as_written(one, unit) for one in span)
    cure = "start within the range, or make it wider"
    if start is None:
        return f"is that of the scene, {_as_written(scene, unit)}, and range is {ends}", cure
    cause = f"is {_as_written(start, unit)}, and range is {ends}"
    if not isinstance(start, str) and (likely := _in_unit_of(start, span, bounds, unit)):
        return f"{cause}. A number without a unit is in {unit}", f"write {likely} if that is meant"
    return cause, cure


def _in_unit_of(start: float, span: tuple[float | str, float | str], bounds: tuple[float, float], unit: str) -> str:
    """A bare number with the unit in which its range is written, where it is within that so; else nothing."""
    for end in span:
        behind = UNIT_BEHIND.fullmatch(end.strip()) if isinstance(end, str) else None
        if behind is None:
            continue
        text = f"{start:.10g} {behind[1]}"
        try:
            value = float(Quantity(unit).read(text))
        except PydanticCustomError:
            continue  # told at the range
        if bounds[0] <= value <= bounds[1]:
            return text
    return ""


def _as_written(value: float | str, unit: str) -> str:
    return value if isinstance(value, str) else f"{value:.10g} {unit}".strip()
