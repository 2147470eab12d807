"""Numbers and units as people write them elsewhere: marks of inches, commas, signs, a flow where a speed is wanted."""

from __future__ import annotations

import re

from tautline.scene.values.units import Unit, read_unit

MARKS = {**dict.fromkeys(('"', "″", "”", "''"), "in"), **dict.fromkeys(("'", "′", "’"), "ft")}
"""Marks of inches and feet behind a number."""
COMMA = re.compile(r"(?P<digits>(?:,\d+)+)(?P<point>\.\d+)?(?P<unit>(?:\s*[^\s\d.,].*)?)", re.DOTALL)
"""What stands behind the digits in front of a comma: more digits, perhaps decimals, perhaps a unit."""
MINUS = re.compile(r"\s*(?P<sign>[−–—‐‑‒﹣－])\s*(?P<rest>[\d.].*)", re.DOTALL)
"""A number behind a sign that looks like a minus, as documents have it: the true minus, dashes and other hyphens."""
THOUSANDS = re.compile(r"(,\d{3})+")
FLOWS = ("gpm", "lpm", "bpm")
"""Gallons, litres and barrels per minute, which are no units of the table."""


def habit(number: str, unit: str, wanted: str) -> tuple[str, str] | None:
    """What is wrong with a number and the unit behind it, and how to write what is meant; None where that is not known.

    `wanted` is the SI unit of what is asked for.
    """
    if wanted == "m" and unit in MARKS:
        return f"has the mark {unit} for its unit", f"write {number} {MARKS[unit]}"
    if wanted == "m/s" and unit.lower() in FLOWS:
        return FLOW[0].format(unit), FLOW[1]
    comma = COMMA.fullmatch(unit)
    if comma is None or not re.fullmatch(r"[-+]?\d+", number):
        return None
    digits, behind = comma["digits"], (comma["point"] or "") + comma["unit"]
    thousand = number + digits.replace(",", "") + behind
    decimal = f"{number}.{digits[1:]}{behind}" if digits.count(",") == 1 and not comma["point"] else ""
    if not THOUSANDS.fullmatch(digits) or len(number.lstrip("+-")) > 3 or not number.lstrip("+-0"):
        return ("has a comma", f"write {decimal} with a point") if decimal else None
    return "has a comma", f"write {thousand}" + (f", or {decimal} if it is a decimal comma" if decimal else "")


def other_minus(written: str) -> tuple[str, str] | None:
    """What is wrong with the sign of a number from a document, and how to write it; None for anything else."""
    found = MINUS.fullmatch(written)
    if found is None:
        return None
    sign, rest = found["sign"], found["rest"].strip()
    return f"has another minus sign, U+{ord(sign):04X}", f"write it with the hyphen of the keyboard: -{rest}"


FLOW = (
    "'{}' is the unit of a flow, not of a speed",
    "divide the flow by the area of the bore, and give a speed such as 0.5 m/s",
)
"""What is wrong with the unit of a flow where a speed is wanted, and the cure."""


def flow_for_speed(unit: str, read: Unit, wanted: str) -> tuple[str, str] | None:
    """What is wrong with the unit of a flow where a speed is wanted, and the cure; None for anything else."""
    if wanted != "m/s" or read.dimension != read_unit("m^3/s").dimension:
        return None
    return FLOW[0].format(unit), FLOW[1]
