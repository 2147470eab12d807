"""Numbers and units as people write them elsewhere: marks of inches, commas, a flow where a speed is wanted."""

from __future__ import annotations

import re

from tautline.scene.values.units import Unit, read_unit

MARKS = {**dict.fromkeys(('"', "″", "”", "''"), "in"), **dict.fromkeys(("'", "′", "’"), "ft")}
"""Marks of inches and feet behind a number."""
COMMA = re.compile(r"(?P<digits>(?:,\d+)+)(?P<point>\.\d+)?(?P<unit>(?:\s*[^\s\d.,].*)?)", re.DOTALL)
"""What stands behind the digits in front of a comma: more digits, perhaps decimals, perhaps a unit."""
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
