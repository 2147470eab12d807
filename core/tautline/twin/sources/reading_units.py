"""Units that the header of a table gives, beside those of the map."""

from __future__ import annotations

import math
import re

from tautline.errors import TautlineError
from tautline.scene.reading.columns import NO_UNIT, unit_named
from tautline.scene.values.unclear import several
from tautline.scene.values.units import TABLE, Uncounted, Unit, UnknownUnit, converted, read_unit

CODES = {
    "MTR": "m", "KMT": "km", "CMT": "cm", "MMT": "mm", "INH": "in", "FOT": "ft", "NEW": "N", "B47": "kN", "B75": "MN",
    "KGM": "kg", "GRM": "g", "TNE": "t", "LBR": "lb", "MTS": "m/s", "C16": "mm/s", "2M": "cm/s", "2X": "m/min",
    "FS": "ft/s", "FR": "ft/min", "C81": "rad", "C25": "mrad", "DD": "deg", "2A": "rad/s", "RPM": "rpm", "PAL": "Pa",
    "KPA": "kPa", "MPA": "MPa", "BAR": "bar", "PS": "psi", "NU": "N·m", "B48": "kN·m", "SEC": "s", "C26": "ms",
    "MIN": "min", "HTZ": "Hz", "WTT": "W", "KWT": "kW",
}  # fmt: skip
"""Units by their common codes (UNECE recommendation 20)."""

WRITTEN = {"Nm": "N m", "kNm": "kN m", "MNm": "MN m", "M": "m", "Hz": "rev/s"} | dict.fromkeys(
    ("1/min", "/min", "min-1", "min^-1", "min⁻¹", "U/min", "u/min", "rev/min", "r/min", "RPM", "Rpm"), "rpm"
)
"""Units as machines state them in free text, by what is meant; turns only where a rotary speed is asked for."""
HABITS = {name: name for name in "ft in lb lbs lbf klb klbf kft kip psi ksi kg cm bar".split()} | {
    "klbs": "klb", "kips": "kip", "ftlb": "ft lb", "ftlbs": "ft lb", "ftlbf": "ft lbf", "kftlb": "kft lb",
    "kftlbs": "kft lb", "kftlbf": "kft lbf", "inlb": "in lb", "inlbs": "in lb", "inlbf": "in lbf",
}  # fmt: skip
"""Names of the field, in small letters, that machines write in capitals or in one word, by what is meant."""
NAME = re.compile(r"[A-Za-zµμ°%]+")
COUNTED = ("rpm", "rev/s")
OF_CURRENT = ("A", "mA", "V", "mV")
"""Units of another quantity for sure, of sensors whose signal is not scaled."""
GRAVITIES = {"g": 1.0, "mg": 1e-3}
"""Units of mass that beside an acceleration are multiples of gravity."""
GRAVITY = 9.80665
"""Standard gravity, m/s^2: what makes a kilogram a kilogram-force."""


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
        For units of different dimensions, for a name of several units, and for a rotary speed of something that is
        not counted.
    """
    header, asked = unit_named(header), unit_named(asked)
    if header in NO_UNIT or header == asked:
        return 1.0
    if not asked:
        return None
    if why := several(header):
        raise OtherQuantity(why)
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


def factor_stated(stated: str, asked: str) -> tuple[float, str] | None:
    """The same for a unit that a server or a message states in free text, with what is to be said of it.

    Such a text is no unit for sure, so only units of the table are of another quantity: pint has a name for nearly
    every letter, and reads `Nm` as a number of textiles and `°C` as degrees times coulombs.

    Raises
    ------
    OtherQuantity
        For a unit of the table that is of another quantity.
    """
    stated, asked = unit_named(stated), unit_named(asked)
    try:
        wanted = read_unit(asked)
    except UnknownUnit:
        found = factor_between(stated, asked)
        return None if found is None else (found, "")
    if (why := several(stated)) and stated != asked and wanted.mass == 1:
        raise OtherQuantity(why)
    if stated in OF_CURRENT and stated != asked:
        raise OtherQuantity("is a unit of another quantity")
    plain = WRITTEN.get(stated) or _usual(stated)
    is_speed = wanted.is_rate and wanted.angle == 1 and wanted.time == -1
    if plain in COUNTED and not is_speed:
        plain = stated
    try:
        written = read_unit(plain)
    except UnknownUnit:
        return None
    if plain in COUNTED and plain != stated and plain.lower() != stated.lower():
        return _ratio(written, wanted), ", and turns are counted"
    if weighed := _by_gravity(stated, plain, written, wanted):
        return weighed
    try:
        found = factor_between(plain, asked)
    except OtherQuantity:
        is_uncounted = written.dimension == wanted.dimension
        names = NAME.findall(plain)
        if is_uncounted or not all(name in TABLE for name in names):
            return None
        raise
    return None if found is None else (found, "")


def _usual(stated: str) -> str:
    """A unit with the field's names as the table of units has them: ``KFT.LB`` -> ``kft*lb``."""
    between = re.sub(r"(?<=[A-Za-z])\.\s*(?=[A-Za-z])", "*", stated.strip().rstrip("."))
    return NAME.sub(lambda one: one[0] if one[0] in TABLE else HABITS.get(one[0].lower(), one[0]), between)


def _by_gravity(stated: str, plain: str, written: Unit, wanted: Unit) -> tuple[float, str] | None:
    """The factor where masses stand for their weight, or weights for their mass, and what is assumed; None elsewhere.

    So a kilogram is a force beside kN, a foot-pound a torque beside kN m, and kg/cm2 a pressure beside bar.
    """
    gravity = TABLE["m"] * TABLE["s"] ** -2
    if stated in GRAVITIES and wanted.dimension == gravity.dimension:
        return _ratio(gravity, wanted) * GRAVITY * GRAVITIES[stated], ", as multiples of gravity"
    masses, forces = TABLE["kg"].dimension, TABLE["N"].dimension
    alone = {written.dimension, wanted.dimension} == {masses, forces}  # any word for a mass, `tonnes`, is a weight
    if not alone and not all(name in TABLE for name in NAME.findall(plain)):
        return None
    if wanted.mass == 1 and wanted.time == -2 and (written * gravity).dimension == wanted.dimension:
        what = "" if written.dimension == masses else f"'{stated}' has a mass, read "
        return _ratio(written * gravity, wanted) * GRAVITY, f", {what}as the weight of that mass"
    if written.dimension == forces and wanted.dimension == masses:
        return _ratio(written, wanted * gravity) / GRAVITY, ", as the mass of that weight"
    return None


def _ratio(written: Unit, wanted: Unit) -> float:
    return float(written.factor / wanted.factor) * math.pi ** (written.turns - wanted.turns)
