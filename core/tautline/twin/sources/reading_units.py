"""Units that the header of a table gives, beside those of the map."""

from __future__ import annotations

import math

from tautline.errors import TautlineError
from tautline.scene.reading.columns import NO_UNIT, unit_named
from tautline.scene.values.units import Uncounted, UnknownUnit, converted, read_unit

CODES = {
    "MTR": "m", "KMT": "km", "CMT": "cm", "MMT": "mm", "INH": "in", "FOT": "ft", "NEW": "N", "B47": "kN", "B75": "MN",
    "KGM": "kg", "GRM": "g", "TNE": "t", "LBR": "lb", "MTS": "m/s", "C16": "mm/s", "2M": "cm/s", "2X": "m/min",
    "FS": "ft/s", "FR": "ft/min", "C81": "rad", "C25": "mrad", "DD": "deg", "2A": "rad/s", "RPM": "rpm", "PAL": "Pa",
    "KPA": "kPa", "MPA": "MPa", "BAR": "bar", "PS": "psi", "NU": "N·m", "B48": "kN·m", "SEC": "s", "C26": "ms",
    "MIN": "min", "HTZ": "Hz", "WTT": "W", "KWT": "kW",
}  # fmt: skip
"""Units by their common codes (UNECE recommendation 20)."""


def unit_of_code(number: int) -> str:
    """The unit of an OPC UA ``UnitId``, which has the letters of a common code (part 8, 5.6.4.3); empty for others."""
    letters = [number >> shift & 0xFF for shift in (16, 8, 0)] if 0 < number < 1 << 24 else []
    return CODES.get("".join(chr(one) for one in letters if one), "")


class OtherQuantity(TautlineError):
    """A unit of the header that measures something else than that of the map; ``str()`` says why."""


def factor_between(header: str, asked: str) -> float | None:
    """What a reading in the header's unit is multiplied by to be in the map's; exactly 1 where both are the same.

    None where nothing can be said: the map gives a unit, and the header one that nobody knows; or the other way round.

    Raises
    ------
    OtherQuantity
        For units of different dimensions, and for a rotary speed of something that is not counted.
    """
    header, asked = unit_named(header), unit_named(asked)
    if header in NO_UNIT or header == asked:
        return 1.0
    if not asked:
        return None
    try:
        written, wanted = read_unit(header), read_unit(asked)
    except UnknownUnit:
        return None
    if written.dimension != wanted.dimension:
        raise OtherQuantity("is a unit of another quantity")
    try:
        read = converted(written, wanted)
    except Uncounted as error:
        raise OtherQuantity(str(error)) from None
    return float(read.factor / wanted.factor) * math.pi ** (read.turns - wanted.turns)
