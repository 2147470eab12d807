"""Readings that come one by one, as a JSON object or a variable has them: their numbers, units and quality."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from tautline.scene.errors import shorten
from tautline.scene.reading.columns import NO_UNIT
from tautline.twin.sources.reading_units import OtherQuantity, factor_stated
from tautline.twin.sources.stamps import Stamps, number_of

QUALITY, STATUS, UNIT, VALUE = "quality", "status", ("unit", "units"), "value"
SAID_OF = (QUALITY, STATUS)
"""Keys of what is said of readings, and of the reading itself where the topic names the column."""
GOOD = ("good", "ok", "valid", "normal", "true")
BAD, NOT_OF_OPC = ("bad", "uncertain"), ("invalid", "stale", "false")
"""Words that call a reading good, and not good: those of OPC, and others that are the whole quality."""
NO = ("not", "no", "non")
"""Words that turn the next one round."""
GOOD_NUMBERS = (1.0, 100.0)
GOOD_FROM, GOOD_TO = 192.0, 256.0
"""Numbers that call a reading good: a flag, per cent, and those of OPC DA (data access 3.0, 6.8: 11xxxxxx is good)."""
UNCERTAIN = 0x40000000
"""The first status code of OPC UA that is not good (part 4, 7.39)."""
CODE = re.compile(r"0[xX][0-9a-fA-F]{1,8}")
KEYS = 6
"""Keys of a message that are named."""
LONG = 6
"""Characters from which on a code is one of OPC UA, ``0x80000000``, and none of OPC DA, ``0xC0``."""


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
        self._of_data_access: set[str] = set()  # keys whose numbers are those of OPC DA

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
            good = is_good(key.lower(), value, key in self._of_data_access)
            if key.lower() == QUALITY and GOOD_FROM <= _code_of(value) < GOOD_TO:
                self._of_data_access.add(key)
            said = f"{where} the {key} {shorten(str(value)) or '(empty)'}"
            if good is None:
                self._remarks.tell(f"{where} {key}", f"{said} is not known. Readings with it are used")
            elif not good:
                self._remarks.tell(f"{where} {key} bad", f"{said} is not good. Readings with it count as missing")
                return False
        return True


def is_good(key: str, value: Any, of_data_access: bool = False) -> bool | None:
    """Whether a ``quality`` or a ``status`` calls readings good; None where that is not known.

    A status may be one of the machine, such as `running` or `fault`: only words and codes of OPC call readings bad
    there. As a status, 0 is good (OPC UA); as a quality it is bad (OPC DA). Other small numbers may count anything,
    such as a fix of satellites or a share.

    Parameters
    ----------
    of_data_access : bool
        Whether the numbers of this key are known to be those of OPC DA, of which those below 192 are not good.
    """
    if isinstance(value, bool):
        return True if value else (False if key == QUALITY else None)
    number = _code_of(value)
    if math.isfinite(number):
        if UNCERTAIN <= number < 2**32 or -(2**31) <= number < -UNCERTAIN:  # unsigned, or signed
            return False
        if number == 0.0:
            return key != QUALITY or (isinstance(value, str) and len(value.strip()) >= LONG)
        if key == QUALITY and of_data_access and 0.0 < number < GOOD_FROM:
            return False
        return True if number in GOOD_NUMBERS or GOOD_FROM <= number < GOOD_TO else None
    return _is_good_word(key, value) if isinstance(value, str) else None


def _code_of(value: Any) -> float:
    """A quality as a number; NaN for words."""
    if isinstance(value, str) and CODE.fullmatch(value.strip()):
        return float(int(value.strip(), 16))
    return number_of(value)


def _is_good_word(key: str, text: str) -> bool | None:
    """The same of words: ``OPC_QUALITY_GOOD``, ``Good (192)``, ``BadNoCommunication``."""
    words = [one.lower() for one in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", text)]
    if key != QUALITY and len(text.split("(")[0].split()) != 1:  # a sentence of the machine
        return None
    bad = BAD if key != QUALITY or len(words) > 1 else BAD + NOT_OF_OPC
    for before, word in zip(["", *words], words, strict=False):
        if word in bad and before not in NO:
            return False
        if word in GOOD:
            return True if before not in NO else (False if key == QUALITY else None)
    return None


def factor_told(column: str, units: Sequence[str], asked: str | None, where: str, remarks: Remarks) -> float:
    """Find what readings are multiplied by to be in the map's unit, and tell it with `remarks`.

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
        found = _first_factor(given, asked)
    except OtherQuantity as error:
        cure = "So there is no reading of it. Correct `unit` of this column in the map, or the unit at its source"
        remarks.tell(f"unit of {column} {given[0]}", f"{what}, and the map says {asked}. '{given[0]}' {error}. {cure}")
        return math.nan
    if found is None:
        why = "which is no known unit" if asked else "and the map gives no unit"
        taken = asked or "SI units"
        remarks.tell(f"unit of {column} {given[0]}", f"{what}, {why}: its readings are taken in {taken}")
        return 1.0
    factor, meant = found
    if factor != 1.0 or meant:
        remarks.tell(f"unit of {column} {given[0]}", f"{what}: its readings are converted to {asked}{meant}")
    return factor


def _first_factor(units: Sequence[str], asked: str) -> tuple[float, str] | None:
    """The factor of the first name that is a unit of what is asked for, with what is to be said of it."""
    other: OtherQuantity | None = None
    for one in units:
        try:
            found = factor_stated(one, asked)
        except OtherQuantity as error:
            other = other or error
            continue
        if found is not None:
            return found
    if other is not None:
        raise other
    return None


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


def why_no_reading(found: Any, columns: Sequence[str], column: str) -> str:
    """Why a message has no reading where one is looked for, in words; empty where it has, and for other things.

    Parameters
    ----------
    found : object
        The message, read from JSON.
    columns : sequence of str
    column : str
        The one that its topic names.
    """
    if isinstance(found, list):
        ours = column in columns or any(isinstance(one, dict) and not one.keys().isdisjoint(columns) for one in found)
        return f"a list of {len(found)} values is left out. Send one object for each row" * ours
    if not isinstance(found, dict):
        return ""
    for key, one in found.items():
        inside = isinstance(one, dict) and not one.keys().isdisjoint(columns)
        if inside or (key in columns and isinstance(one, (dict, list))):
            what = "an object" if isinstance(one, dict) else "a list"
            return f"'{shorten(key)}' holds {what}, in which no reading is looked for. Send a number for each column"
    if column in columns and VALUE not in found and found.keys().isdisjoint(columns):
        keys = f"{', '.join(list(found)[:KEYS])}{', ...' if len(found) > KEYS else ''}" or "none"
        return f"a message without the key '{VALUE}' or one of a column is left out. Its keys: {keys}"
    return ""
