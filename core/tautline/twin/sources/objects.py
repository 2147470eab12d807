"""Readings that come one by one, as a JSON object or a variable has them: their numbers, units and quality."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from tautline.scene.errors import shorten
from tautline.scene.reading.columns import NO_UNIT
from tautline.twin.sources.reading_units import OtherQuantity, factor_between
from tautline.twin.sources.stamps import Stamps, number_of

QUALITY, STATUS, UNIT, VALUE = "quality", "status", ("unit", "units"), "value"
SAID_OF = (QUALITY, STATUS)
"""Keys of what is said of readings, and of the reading itself where the topic names the column."""
GOOD = ("good", "ok", "valid", "normal", "true")
BAD = ("bad", "uncertain", "invalid", "err", "fault", "fail", "stale", "offline", "disconnected", "false")
"""How words begin that call a reading good, and not good. Another status may be one of the machine."""
GOOD_NUMBERS = (1.0, 100.0)
GOOD_FROM, GOOD_TO = 192.0, 256.0
"""Numbers that call a reading good: a flag, per cent, and those of OPC DA (data access 3.0, 6.8: 11xxxxxx is good)."""
UNCERTAIN = float(0x40000000)
"""The first status code of OPC UA that is not good (part 4, 7.39)."""


class Remarks:
    """Sentences that are told once each.

    Parameters
    ----------
    notes : list of str
        Where they go.
    """

    def __init__(self, notes: list[str]) -> None:
        self._notes, self._told = notes, set[str]()

    def tell(self, what: str, text: str) -> None:
        """Tell a sentence, unless one of that was told."""
        if what not in self._told:
            self._told.add(what)
            self._notes.append(text)


class ObjectReadings:
    """Reads numbers of JSON objects, and what is said of them there.

    Parameters
    ----------
    columns : sequence of str
    units : mapping
        Units by column that the readings are wanted in.
    notes : list of str
        Where sentences for the user go.
    factors : dict of str to float
        Where what readings are multiplied by is kept, by column.
    """

    def __init__(
        self, columns: Sequence[str], units: Mapping[str, str], notes: list[str], factors: dict[str, float]
    ) -> None:
        self._columns, self._units, self.factors = frozenset(columns), units, factors
        self._remarks = Remarks(notes)

    def number(self, column: str, value: Any) -> float:
        """A reading; NaN for what is no number, and for a text with a comma: that may be a mark of thousands."""
        if isinstance(value, str) and "," in value:
            if not math.isnan(number_of(value.replace(",", ""))):
                self._remarks.tell(
                    f"comma of {column}",
                    f"column '{column}' has texts such as \"{shorten(value)}\". This may be a mark of thousands or a "
                    "decimal comma. Such readings are left out: send numbers with a decimal point",
                )
            return math.nan
        return number_of(value)

    def stamp(self, stamps: Stamps, key: str, value: Any) -> float:
        """A stamp, s; NaN for what is none, and for a number with a comma."""
        if isinstance(value, str) and "," in value and math.isnan(self.number(key, value)):
            return stamps.read(key, value) if math.isnan(number_of(value)) else math.nan
        return stamps.read(key, value)

    def scaled(self, column: str, value: float, unit: Any, where: str) -> float:
        """A reading in the map's unit, of one in the unit that its object gives."""
        if not isinstance(unit, str):
            return value
        factor = factor_told(column, [unit], self._units.get(column), where, self._remarks)
        self.factors[column] = factor if math.isfinite(factor) else 1.0
        return value * factor

    def are_good(self, found: Mapping[str, Any], where: str) -> bool:
        """Whether an object calls its readings good, or says nothing of that."""
        for key, value in found.items():
            if key in self._columns or key.lower() not in SAID_OF:
                continue
            good = is_good(key.lower(), value)
            said = f"{where} the {key} {shorten(str(value)) or '(empty)'}"
            if good is None:
                self._remarks.tell(f"{where} {key}", f"{said} is not known. Readings with it are used")
            elif not good:
                self._remarks.tell(f"{where} {key} bad", f"{said} is not good. Readings with it count as missing")
                return False
        return True


def is_good(key: str, value: Any) -> bool | None:
    """Whether a ``quality`` or a ``status`` calls readings good; None where that is not known.

    A quality is good or it is not. A status may be one of the machine, such as `running`. As a status, 0 is good (OPC
    UA); as a quality it is bad (OPC DA).
    """
    if value is None:
        return None
    if isinstance(value, bool):
        return value
    number = number_of(value)
    if math.isfinite(number):
        good = number in GOOD_NUMBERS or GOOD_FROM <= number < GOOD_TO
        if key == QUALITY:
            return good
        return True if good or number == 0.0 else (False if number >= UNCERTAIN else None)
    word = str(value).strip().lower()
    if word.startswith(GOOD):
        return True
    return False if key == QUALITY or word.startswith(BAD) else None


def factor_told(column: str, units: Sequence[str], asked: str | None, where: str, remarks: Remarks) -> float:
    """What readings are multiplied by to be in the map's unit; what that does is told.

    Parameters
    ----------
    units : sequence of str
        The unit that is given, and other names of it.
    asked : str or None
        The map's unit, empty for none; None where nothing is asked for.
    where : str
        Who gives it, for messages.

    Returns
    -------
    float
        1 for a unit that nobody knows, NaN for one of another quantity.
    """
    given = [one for one in units if one.strip() not in NO_UNIT]
    if not given or asked is None:
        return 1.0
    what = f"{where} the unit of {column} is {shorten(given[0])}"
    try:
        factor = next(_factors(given, asked), None)
    except OtherQuantity as error:
        cure = "So there is no reading of it. Correct `unit` of this column in the map, or leave it out"
        remarks.tell(f"unit of {column} {given[0]}", f"{what}, and the map says {asked}. '{given[0]}' {error}. {cure}")
        return math.nan
    if factor is None:
        why = "which is no known unit" if asked else "and the map gives no unit"
        taken = asked or "SI units"
        remarks.tell(f"unit of {column} {given[0]}", f"{what}, {why}: its readings are taken in {taken}")
        return 1.0
    if factor != 1.0:
        remarks.tell(f"unit of {column} {given[0]}", f"{what}: its readings are converted to {asked}")
    return factor


def _factors(units: Sequence[str], asked: str) -> Iterator[float]:
    for one in units:
        if (factor := factor_between(one, asked)) is not None:
            yield factor


def what_is(value: Any) -> str:
    """What a value is that is no number, in words."""
    if value is None:
        return "without a value"
    if isinstance(value, bool):
        return "as true or false (Boolean)"
    if isinstance(value, (list, tuple)):
        return f"as a list of {len(value)} values"
    if isinstance(value, str):
        return f'as the text "{shorten(value)}"'
    return f"as a value of type {type(value).__name__}"
