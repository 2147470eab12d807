"""Stamps: seconds, or a date and time; and which column has them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from tautline.scene.reading.columns import HEADER, unit_named
from tautline.scene.reading.time_columns import is_contradicted, is_of_days, time_head, unit_of_stamps, unit_of_time
from tautline.scene.values.moments import UNIX
from tautline.scene.values.units import Unit, UnknownUnit, read_unit

NAMES = ("time", "t", "timestamp", "stamp", "ts", "datetime")
"""Columns of the stamp, where none is named."""
DOUBTFUL = ("ts",)
"""Those of them that may be something else, such as a temperature or a torque."""
LAST_BRACKET = re.compile(r"\s*(?P<name>.*[^\s])\s*[\[(]\s*(?P<unit>[^\[\]()]*?)\s*[\])]\s*")
FINER = ((1e14, "ms", "milliseconds"), (1e17, "us", "microseconds"), (math.inf, "ns", "nanoseconds"))
"""Units of stamps since 1970 that are no seconds: below which number a stamp is likely in each."""


def stamp_of(value: Any, factor: float = 1.0) -> float:
    """A stamp in seconds: a number times its unit, or ISO 8601 (UTC where it names no zone); NaN for anything else.

    A number may have a comma in place of its point, as readings may. One beyond `UNIX` is none: it would lie thousands
    of years ahead, and is one of milliseconds.
    """
    number = number_of(value)
    if not math.isnan(number) or not isinstance(value, str):
        return number * factor if abs(number * factor) < UNIX[1] else math.nan
    try:
        moment = datetime.fromisoformat(value.strip())
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        return math.nan


class Stamps:
    """Reads stamps, and says once where they are in a unit that nobody has named.

    Parameters
    ----------
    asked : str
        The column of the stamp in the map, with its unit where it has one, ``time [ms]``; empty for the usual names.
    notes : list of str
        Where the sentence goes.
    columns : sequence of str, optional
        Columns of the map: none of them is the stamp, unless the map says so.
    """

    def __init__(self, asked: str, notes: list[str], columns: Sequence[str] = ()) -> None:
        names, units = heads([asked])
        self.asked, self.unit, self._bare, self._notes, self._told = asked, units[0], names[0], notes, False
        self.factor = self.factor_of("", "")
        self._columns = frozenset([*columns, *heads(columns)[0]])
        self._named = ""

    def column(self, names: Sequence[str]) -> str | None:
        """The name of the stamp among names; None where it is not there."""
        if self.asked:
            return stamp_column(names, self.asked) or (stamp_column(names, self._bare) if self._bare else None)
        return stamp_column([name for name in names if name not in self._columns], "")

    def timed(self, names: Sequence[str]) -> str | None:
        """The only one of a header's names that means the time, such as `time_s`; None where none is, or two are."""
        found = [name for name in names if name not in self._columns and time_head(name).kind == "name"]
        return found[0] if len(found) == 1 and not self.asked else None

    def factor_of(self, name: str, bracketed: str) -> float:
        """What numbers of a column are multiplied by to be seconds: by its brackets, or the map's, or its name.

        NaN where the unit is doubtful: then a stamp can be a date only. `doubt` has what is not clear about it.
        """
        if not unit_of_time(bracketed) and not is_unit_of_time(bracketed):
            bracketed = self.unit or bracketed
        unit, self.doubt = unit_of_stamps(name or self._bare or self.asked, bracketed)
        if self.doubt == "unit" and is_unit_of_time(bracketed):  # one that only the library of units knows
            unit, self.doubt = bracketed, ""
        if not self.unit and is_contradicted(name, bracketed):  # else the map has said it
            note = f"the name and the brackets of '{name} [{bracketed}]' have two units: that in brackets is read"
            self._notes += [note] if note not in self._notes else []
        return math.nan if self.doubt == "unit" else seconds_in(unit)

    def dated(self, name: str, names: Sequence[str]) -> tuple[str, str] | None:
        """Cause and cure where a column is no milliseconds, as its name says, but the days of a spreadsheet; else None.

        So WinCC writes `Time_ms`: days since 1900 times a million, beside the same moment as a text.
        """
        if self.unit or not is_of_days(name, names):
            return None
        cause = f"'{name}' beside TimeString or VarName has the days of a spreadsheet times a million, as WinCC writes"
        cure = (
            "write the moments as `2026-01-01 00:00:00`, and name their column in the map, such as `time: TimeString`"
        )
        return cause, f'{cure}; if these are milliseconds, write `time: "{name} [ms]"` there'

    def unclear(self, name: str) -> tuple[str, str]:
        """Cause and cure where numbers are stamps whose unit is doubtful."""
        bare = heads([name])[0][0] or name
        said = f"{name} [{self.unit}]" if self.unit and bare == name else name
        cure = f'write the unit that they are in, such as `time: "{bare} [s]"` in the map, or [s] or [ms] in the header'
        return f"'{said}' is the time, and it is not clear in which unit its numbers are", cure

    def read(self, name: str, value: Any, factor: float | None = None) -> float:
        """A stamp, s; NaN for what is none. `factor` is that of a header's unit."""
        factor = self.factor if factor is None else factor
        found = stamp_of(value, factor)
        number = number_of(value)
        if not self.unit and factor == 1e-3 and is_of_days(name, (), number):
            self._tell_days(name, number)
            return math.nan
        if math.isfinite(found):
            self._tell_name(name, factor)
        if self.doubt and not self._told and math.isfinite(number):
            self._told = True
            cause, cure = self.unclear(name)
            taken = "Such rows are left out:" if self.doubt == "unit" else "Seconds are read. If they are none,"
            self._notes.append(f"{cause}. {taken} {cure}")
        if math.isnan(found) and not self._told and factor == 1.0 and UNIX[1] <= number < math.inf:
            _, unit, said = next(one for one in FINER if number < one[0])
            self._told = True
            self._notes.append(
                f"stamps such as {number:.0f} are no seconds: rows with them are left out. "
                f'If they are {said}, write `time: "{name} [{unit}]"` in the map'
            )
        return found

    def _tell_days(self, name: str, number: float) -> None:
        """Say once that stamps are no milliseconds, but days."""
        note = (
            f"stamps such as {number:.0f} of `{name}` are no milliseconds, but the days of a spreadsheet times a "
            "million, as WinCC writes: rows with them are left out. Write the moments as `2026-01-01 00:00:00`, and "
            f'name their column in the map; if these are milliseconds, write `time: "{name} [ms]"` there'
        )
        self._notes += [note] if note not in self._notes and not self._told else []
        self._told = True

    def _tell_name(self, name: str, factor: float) -> None:
        """Say once which column is taken as the time, where the map names none, and what its numbers count."""
        if not self.asked and self._named != name and (name.lower() in DOUBTFUL or name.lower() not in NAMES):
            self._named = name
            counted = f", and its numbers count {factor:g} s each" if math.isfinite(factor) and factor != 1.0 else ""
            note = f"`{name}` is taken as the time{counted}. If it is none, write `time:` in the map with what is"
            self._notes += [note] if note not in self._notes else []


def number_of(value: Any) -> float:
    """A reading; NaN for what is no number, as `1_000`. A comma in place of a point is understood."""
    if isinstance(value, bool) or value is None:
        return math.nan
    if isinstance(value, (int, float)):
        try:
            return float(value)
        except OverflowError:  # a whole number of hundreds of digits
            return math.nan
    text = str(value).strip()
    if "_" in text:  # a number to Python only
        return math.nan
    try:
        return float(text)
    except ValueError:
        try:
            return float(text.replace(",", ".")) if text.count(",") == 1 else math.nan
        except ValueError:
            return math.nan


def heads(titles: Sequence[str]) -> tuple[list[str], list[str]]:
    """Names and units of a header's cells: ``heave [cm]``."""
    found = [_parts(title) for title in titles]
    return [name for name, _ in found], [unit for _, unit in found]


def _parts(title: str) -> tuple[str, str]:
    """Name and unit of a title: of several brackets the last has the unit, and the name has the others."""
    if one := HEADER.fullmatch(title):
        return one["name"], one["unit"] or ""
    if one := LAST_BRACKET.fullmatch(title):
        return one["name"], one["unit"]
    return title.strip(), ""


def seconds_in(unit: str) -> float:
    """What a stamp in a unit is multiplied by; 1 where the unit is none of time."""
    read = _known(unit)
    return float(read.factor) if read is not None and read.dimension == read_unit("s").dimension else 1.0


def is_unit_of_time(unit: str) -> bool:
    """Whether what a header gives in brackets is a unit of time."""
    read = _known(unit)
    return read is not None and read.dimension == read_unit("s").dimension


def is_unit(unit: str) -> bool:
    """Whether what a header gives in brackets is a unit, as sheets or as the table of units write it; no number is."""
    return math.isnan(number_of(unit)) and _known(unit_named(unit)) is not None


def _known(unit: str) -> Unit | None:
    """A unit; None where there is none, and for one that nobody knows."""
    try:
        return read_unit(unit) if unit else None
    except UnknownUnit:
        return None


def stamp_column(names: Sequence[str], asked: str) -> str | None:
    """The column of the stamp: that asked for, or the first that is called so."""
    if asked:
        return asked if asked in names else None
    return next((name for known in NAMES for name in names if name.lower() == known), None)
