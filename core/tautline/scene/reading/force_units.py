"""What sheets write over a column of forces that is no unit of force: a mass, or a force in other letters."""

from __future__ import annotations

import re

from tautline.scene.values.units import nearest_unit

POUND, THOUSAND_POUNDS = ("a pound", "lbf"), ("a thousand pounds", "klbf")
KILOGRAM, THOUSAND_KILOGRAMS, TONNE = ("a kilogram", "kgf"), ("a thousand kilograms", "tf"), ("a tonne", "tf")
FORCE_OF_MASS = {
    **dict.fromkeys(("lb", "lbs", "lbm", "pound", "pounds"), POUND),
    **dict.fromkeys(("klb", "klbs", "klbm"), THOUSAND_POUNDS),
    **dict.fromkeys(("kg", "kgs", "kgm"), KILOGRAM),
    **dict.fromkeys(("kkg", "kkgs", "kkgm"), THOUSAND_KILOGRAMS),
    **dict.fromkeys(("t", "tonne", "tonnes", "te", "mt", "metricton", "metrictons"), TONNE),
}
"""Units of mass that stand for a force in many a sheet, in small letters without blanks and points: what they are, and
the unit of their weight. In a sheet of loads MT is a metric ton."""
TONS = ("ton", "tons", "tonf", "tonsf")
"""May be tonnes of 1000 kg or short tons of 2000 lb."""
SHORT_TONS = tuple(f"{before}{ton}" for before in ("short", "us", "s") for ton in TONS)
FORCES = ("N", "daN", "kN", "MN", "lbf", "klbf", "kip", "kgf", "tf")
"""Units of force that loads come in."""
THOUSANDS = {
    **dict.fromkeys(("kkgf", "kkp"), "write {column} [tf]"),
    "kdan": "multiply the numbers by 10 and write {column} [kN]",
    "kkn": "write {column} [MN]",
    "kklbf": "multiply the numbers by 1000 and write {column} [klbf]",
    "kkip": "multiply the numbers by 1000 and write {column} [kip]",
}
"""Thousands of units that have no prefix more; the unit without its thousand would be the nearest in letters."""
THOUSAND = re.compile(r"^(1000|10\^3|10\*\*3|10³)(?=[a-z])")


def unit_of_force(written: str, column: str) -> tuple[str, str] | None:
    """What is wrong with a unit over a column of forces, and the cure; None for what is neither mass nor force.

    Letters large or small, blanks and points do not count: ``KLB``, ``k lbs`` and ``1000 lb`` are thousands of pounds.
    No unit of mass is ever the cure.
    """
    plain = THOUSAND.sub("k", re.sub(r"[\s.,_·×-]|^x(?=\d)", "", written.lower()))
    if plain in FORCE_OF_MASS:
        what, force = FORCE_OF_MASS[plain]
        return f"'{written}': {what} is a mass", f"write {column} [{force}]"
    if plain.removesuffix("s") in THOUSANDS:
        return f"unknown unit '{written}'", THOUSANDS[plain.removesuffix("s")].format(column=column)
    doubled = f"multiply the numbers by 2 and write {column} [klbf]"
    if plain in TONS:
        cause = f"'{written}' may be a tonne of 1000 kg or a short ton of 2000 lb"
        return cause, f"for tonnes write {column} [tf]; for short tons {doubled}"
    if plain in SHORT_TONS:
        return f"'{written}': a short ton of 2000 lb is not known as a unit of force", doubled
    for force in FORCES:
        if plain in (force.lower(), f"{force.lower()}s"):
            return f"unknown unit '{written}'", f"write {column} [{force}]"
    return None


def not_a_force(written: str) -> str:
    """That a unit which nobody knows is none of force, and which unit of force was perhaps meant."""
    return f"'{written}' is not a unit of force; {nearest_unit(written, FORCES)}"
