"""Numbers as people write them: four digits, a prefix, the units of a system."""

from __future__ import annotations

import math
from typing import Any

from tautline.scene.values.systems import SYSTEMS, in_system

PREFIXED = {"N", "J", "W", "Pa", "N m", "N/m", "Hz"}
"""Units that people write with k, M or G in front; a metre or a second stays what it is."""


def significant(value: float, digits: int = 4) -> str:
    """Write a number to so many significant digits, without an exponent where it reads well."""
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return "–"
    size = math.floor(math.log10(abs(value)))
    if -4 <= size < 7:
        text = f"{value:.{max(0, digits - 1 - size)}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    return f"{value:.{digits - 1}e}"


def quantity(value: Any, unit: str, digits: int = 4) -> str:
    """Write a figure with its unit: ``1.234 MN``."""
    if value is None:
        return "–"
    if isinstance(value, (list, tuple)):
        return ", ".join(quantity(item, unit, digits) for item in value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return f"{value} {unit}".strip()
    if isinstance(value, int) and not unit:
        return str(value)
    prefix = ""
    if unit in PREFIXED:
        for factor, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
            if abs(value) >= factor:
                value, prefix = value / factor, letter
                break
    return f"{significant(float(value), digits)} {prefix}{unit}".strip()


def shown(value: Any, unit: str, system: str = "si", digits: int = 4) -> str:
    """Write a figure that is given in SI in the units of a system (a key of `systems.SYSTEMS`)."""
    if isinstance(value, (list, tuple)):
        return ", ".join(shown(item, unit, system, digits) for item in value)
    if unit in SYSTEMS[system] and isinstance(value, (int, float)) and not isinstance(value, bool):
        converted, name = in_system(float(value), unit, system)
        return f"{significant(converted, digits)} {name}"
    return quantity(value, unit, digits)
