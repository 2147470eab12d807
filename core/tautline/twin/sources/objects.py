"""Readings that come one by one, as a JSON object or a variable has them: their numbers, units and quality."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from tautline.scene.errors import shorten
from tautline.scene.reading.columns import NO_UNIT
from tautline.twin.sources.stamps import Stamps, number_of
from tautline.twin.sources.stated_units import Remarks, Stated, StatedUnits

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
    stated : dict, optional
        Units that were stated before.
    """

    def __init__(
        self, columns: Sequence[str], units: Mapping[str, str], notes: list[str], factors: dict[str, float],
        stated: Stated | None = None,
    ) -> None:  # fmt: skip
        self._columns, self._remarks = frozenset(columns), Remarks(notes)
        self._stated = StatedUnits(units, notes, factors, stated)
        self._of_data_access: set[str] = set()  # keys whose numbers are those of OPC DA

    @property
    def stated(self) -> Stated:
        """The unit that was stated last, by column and by who states it."""
        return self._stated.stated

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

    def values(self, found: Mapping[str, Any], where: str, stamp: str | None, column: str = "") -> dict[str, float]:
        """Readings of an object in the map's units, by column; that of `column`, its topic, may stand under `value`.

        `stamp` is the key of its time.
        """
        given = {column: found[VALUE]} if column in self._columns and VALUE in found else {}
        stated, sure = self._units_of(found, column if given else "", where, stamp)
        given |= {name: found[name] for name in self._columns if name in found}
        return {
            name: self.number(name, value)
            * self._stated.factor(name, [stated[name]] if name in stated else [], where, sure)
            for name, value in given.items()
        }

    def hear_units(self, found: Mapping[str, Any], where: str, stamp: str | None, column: str = "") -> None:
        """Take the units that an object states of columns for sure, though it has no good reading of them.

        `stamp` and `column` are those of `values`.
        """
        stated, sure = self._units_of(found, column if column in self._columns and VALUE in found else "", where, stamp)
        for name, unit in stated.items():
            if sure and name in self._columns:
                self._stated.factor(name, [unit], where)

    def _units_of(
        self, found: Mapping[str, Any], column: str, where: str, stamp: str | None
    ) -> tuple[dict[str, str], bool]:
        """Units that an object states, by column, and whether they are of these columns for sure.

        An object of units goes before one unit. That is of the reading that stands under `value`, the one of `column`,
        or else of the only number.
        """
        said = {key: found[key] for key in found if key in UNIT and key not in self._columns}
        for one in said.values():
            if isinstance(one, Mapping):
                return {name: text for name, text in one.items() if isinstance(text, str)}, True
        texts = [(key, one) for key, one in said.items() if isinstance(one, str) and one.strip() not in NO_UNIT]
        if not texts:
            return {}, True
        key, text = texts[0]
        if column:
            return {column: text}, True
        names = self._numbers(found, stamp)
        ours = [name for name in names if name in self._columns]
        if ours and len(names) > 1:
            self._remarks.tell(
                f"{where} {key}",
                f"{where} the {key} {shorten(text)} stands beside several columns, and nothing shows of which it "
                f'is: it does not count. Send an object, such as {{"{key}": {{"{ours[0]}": "..."}}}}',
            )
            return {}, True
        return {name: text for name in ours}, False

    def _numbers(self, found: Mapping[str, Any], stamp: str | None) -> list[str]:
        """Keys of an object that a unit beside them may be of: columns, and whatever else is a number but its stamp."""
        own = {stamp, *UNIT}
        return [
            key
            for key, value in found.items()
            if key in self._columns or not (key in own or key.lower() in SAID_OF or math.isnan(number_of(value)))
        ]

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
        if key in UNIT and key not in columns:
            continue
        inside = isinstance(one, dict) and not one.keys().isdisjoint(columns)
        if inside or (key in columns and isinstance(one, (dict, list))):
            what = "an object" if isinstance(one, dict) else "a list"
            return f"'{shorten(key)}' holds {what}, in which no reading is looked for. Send a number for each column"
    if column in columns and VALUE not in found and found.keys().isdisjoint(columns):
        keys = f"{', '.join(list(found)[:KEYS])}{', ...' if len(found) > KEYS else ''}" or "none"
        return f"a message without the key '{VALUE}' or one of a column is left out. Its keys: {keys}"
    return ""
