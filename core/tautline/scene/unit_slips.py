"""Warnings of numbers that are probably a slip of a unit, by the table of plausible ranges.

A scene that is sound is validated once more, and now every quantity outside of its range raises an error of a kind of
its own: pydantic says under which key it stands, whatever the scene is made of.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from tautline.scene.errors import SceneError, SceneWarning
from tautline.scene.functions import places
from tautline.scene.model import DOUBT, MARK, Model
from tautline.scene.reading.columns import Columns
from tautline.scene.reading.document import Document, Path_, join_key
from tautline.scene.values.quantity import NUMBER, Quantity, decimal
from tautline.scene.values.ranges import RANGES, Range, in_range, sized
from tautline.scene.values.units import Uncounted, UnknownUnit, converted, read_unit

FIELD = re.compile(r"\b(in|ft|psi|ksi|Mpsi|lbf|klbf|lb|ppg|pcf|gal|bbl)\b")
"""Units of the oilfield: who has written one of them means another of them."""
ALSO_FIELD = ("deg", "rpm")
"""Units that the oilfield shares with everybody."""
METRIC = ("kN", "kN m", "deg", "rpm", "m/h", "sg", "t", "bar", "MPa", "l/min")
"""Units of engineers who write metric units and not those of SI."""
SELDOM = ("lbf/ft", "lbf s/ft", "lb ft^2")
"""Units of the oilfield of what is chosen for the computation, and is as usual in SI."""
OFFERED = 2
"""Units that are offered."""
SHOWN = 3
"""Numbers of one kind that are told one by one."""
LISTED = 8
"""Numbers without a unit that are listed one by one in a scene of other units than SI."""
CLOCK = 1e8
"""Moment from which on it is counted from 1970 and not from the start of a run, s: three years."""


@dataclass(frozen=True)
class _Doubt:
    """A doubtful number: where, its row, what was typed, and its value in SI."""

    key: Path_
    line: int | None
    of: str
    unit: str
    typed: str
    value: float
    bare: bool
    column: tuple[str, str] | None = None
    """Of a number that comes from a file: its column, and the file."""

    @property
    def shown(self) -> str:
        """What was typed, with the unit it is read in."""
        return f"{self.typed} {self.unit}".strip() if self.bare else self.typed


def slips_of_units(model: type[Model], document: Document | None) -> list[SceneWarning]:
    """Warn of numbers outside of their plausible range, and of those without a unit where the scene has others than SI.

    Parameters
    ----------
    model : type
        Of the scene, as it is written.
    document : Document or None
        A file that was read and is valid; None for a scene made in Python, of which nothing is known to be typed.

    Returns
    -------
    list of SceneWarning
        In the order of the file; of many numbers of one kind only one, which counts the others.
    """
    if document is None:
        return []
    system = str(document.root.get("units") or "si").lower()
    found = list(_doubts(model, document, _asks(system)))
    groups: dict[tuple[str, str], list[_Doubt]] = {}
    for doubt in found:
        if not RANGES[doubt.of].holds(doubt.value):
            kind = re.sub(r"\[\d+\]", "[]", join_key(doubt.key))
            groups.setdefault((kind, doubt.of), []).append(doubt)
    warnings = [warning for group in groups.values() for warning in _outside(group, system)]
    bare = [doubt for doubt in found if RANGES[doubt.of].holds(doubt.value)]
    columns = {doubt.column: doubt for doubt in bare if doubt.column is not None}
    warnings += [_bare_column(system, doubt) for column, doubt in columns.items() if column and column[0]]
    return warnings + _bare(system, [doubt for doubt in bare if doubt.column is None])


def _asks(system: str) -> Callable[[Quantity, Any, float], None]:
    """What raises the doubts of a quantity."""

    def doubt(quantity: Quantity, written: Any, value: float) -> None:
        row = RANGES.get(quantity.of)
        if row is None:
            return
        bare = not isinstance(written, str)
        usual = _usual_unit(row, system) if bare and value != 0.0 else None
        other = None if usual is None else _in_unit(str(written), usual, quantity.unit)
        unusual = other is not None and row.holds(other)
        if row.holds(value) and not unusual:
            return
        context = {"of": quantity.of, "unit": quantity.unit, "typed": str(written), "value": value, "bare": bare}
        raise PydanticCustomError(DOUBT, "doubtful", context)

    return doubt


def _doubts(model: type[Model], document: Document, ask: Callable[[Quantity, Any, float], None]) -> Iterator[_Doubt]:
    try:
        model.model_validate(document.root, context={"folder": document.folder, "doubt": ask})
    except ValidationError as error:
        errors = error.errors(include_url=False, include_input=False)
    else:
        return
    told: set[Path_] = set()
    doubts: list[_Doubt] = []
    titles: dict[Path_, _Titles] = {}
    largest: dict[tuple[Path_, bool], float] = {}
    for one in errors:
        if one["type"] != DOUBT:
            continue
        key = tuple(part for part in one["loc"] if not (isinstance(part, str) and part.startswith(MARK)))
        context: Any = one.get("ctx") or {}
        place = _place(document, key)
        if place is not None and key not in told:
            told.add(key)
            if context["bare"] and place == key:
                context["typed"] = document.written(key)  # 1.0e9 is not to become 1000000000.0
            line = None if document.origin(place) else document.line(place)
            column = None
            if place != key:
                # A file has as many doubts as numbers, and is read once for all of them.
                if place not in titles:
                    titles[place] = _titles(document, place)
                column = titles[place].of(key[-2:])
                # A row near which a record passes zero is small, and no slip where others are not.
                low, of_time = RANGES[context["of"]].low, key[-2:][0] == "time"
                if low is not None and 0.0 < abs(context["value"]) < low:
                    if (place, of_time) not in largest:
                        largest[place, of_time] = _largest(document, place, of_time, context["unit"])
                    if largest[place, of_time] >= low:
                        continue
            doubts.append(_Doubt(place, line, **context, column=column))
    yield from sorted(doubts, key=lambda doubt: doubt.line or 0)


def _place(document: Document, key: Path_) -> Path_ | None:
    """Where a number was written: its own key, or that of the file it came from; None for what nobody has written."""
    if document.written(key) is not None:
        return key
    ends = [i for i, part in enumerate(key) if isinstance(part, str)]
    if ends and document.written((*key[: ends[-1]], "file")) is not None:
        return (*key[: ends[-1]], "file")
    return None


class _Titles(NamedTuple):
    """What a table's file says of its columns: their names, empty where the header has a unit, and the file's name."""

    file: str
    time: str
    value: str

    def of(self, end: Path_) -> tuple[str, str]:
        """Name of the column that a number comes from, by the end of its key, and of the file."""
        return (self.time if end and end[0] == "time" else self.value), self.file


def _titles(document: Document, place: Path_) -> _Titles:
    """The columns of a table whose file is named at a key; no names where the file cannot be read."""
    file = str(document.written(place))
    try:
        columns = Columns(document.folder / file)
        both = places(columns, document.written((*place[:-1], "column")))
    except SceneError:
        return _Titles(file, "", "")
    return _Titles(file, *("" if columns.units[at] else columns.names[at] or f"{at + 1}" for at in both))


def _largest(document: Document, place: Path_, time: bool, unit: str) -> float:
    """Size in SI of the largest time or value of a table whose file is named at a key; 0 where it cannot be read."""
    try:
        columns = Columns(document.folder / str(document.written(place)))
        both = places(columns, document.written((*place[:-1], "column")))
        return max(map(abs, columns.values(both[0 if time else 1], unit)))
    except SceneError:
        return 0.0


def _bare_column(system: str, doubt: _Doubt) -> SceneWarning:
    """A warning of a column without a unit, in a scene that is in other units than SI."""
    assert doubt.column is not None
    (name, file), usual = doubt.column, _usual_unit(RANGES[doubt.of], system)
    text = (
        f"{system}, and the column {name} of {file} has no unit. Its numbers are read in {doubt.unit or 'no unit'}. "
        f"Write the unit into the header: {name} [{doubt.unit}], or {name} [{usual}]"
    )
    return SceneWarning("units", text)


def _units_meant(doubt: _Doubt, system: str) -> list[tuple[str, float]]:
    """Units under which the number as typed would be plausible, and its value then."""
    row = RANGES[doubt.of]
    return units_that_fit(doubt.typed, doubt.unit, row, system, row.holds)


def units_that_fit(
    typed: str, si: str, row: Range, system: str, fits: Callable[[float], bool]
) -> list[tuple[str, float]]:
    """Units of a row under which a number would be right, and its value in SI then.

    Parameters
    ----------
    typed : str
        The number as it stands in the file, with its unit if it has one.
    si : str
        Unit of a bare number.
    row : Range
        Whose units are tried.
    system : str
        The scene's ``units``, which come first.
    fits : callable
        Value in SI -> whether it would be right.
    """
    match = NUMBER.fullmatch(decimal(typed))
    if match is None:
        return []
    units = list(row.meant)
    system = "field" if FIELD.search(match["unit"]) else system
    units.sort(key=lambda unit: not _belongs(unit, system))
    tried = [unit for unit in (*units, si) if unit not in (match["unit"] or si, "")]
    values = [(unit, _in_unit(match["number"], unit, si)) for unit in tried]
    return [(unit, value) for unit, value in values if value is not None and fits(value)][:OFFERED]


def _in_unit(number: str, unit: str, wanted: str) -> float | None:
    """A number of a unit in SI; None where the two do not go together."""
    try:
        return converted(read_unit(unit), read_unit(wanted or "%")).si(Fraction(number))
    except (UnknownUnit, Uncounted, OverflowError):
        return None


def meant(typed: str, options: list[tuple[str, float]], unit: str) -> str:
    """The sentence that names the units that were probably meant, without its point."""
    match = NUMBER.fullmatch(decimal(typed))
    if match is None or not options:
        return "Check the number and its unit"
    offers = [_both(f"{match['number']} {other}", sized(value, unit)) for other, value in options]
    return f"Was {' or '.join(offers)} meant? Then {'correct' if match['unit'] else 'write'} the unit"


def _both(typed: str, read: str) -> str:
    """What was typed and how it is read, where that is not the same text."""
    return typed if typed == read else f"{typed} = {read}"


def _outside(group: list[_Doubt], system: str) -> Iterator[SceneWarning]:
    """Warnings of numbers of one key outside of their range; of many the first, and how many there are."""
    told = group if len(group) <= SHOWN else group[:1]
    for doubt in told:
        row = RANGES[doubt.of]
        read = doubt.shown if doubt.bare else _both(doubt.typed, sized(doubt.value, doubt.unit))
        line = f" (line {doubt.line})" if doubt.line else ""
        more = f" So are {len(group) - 1} more numbers there." if len(group) > SHOWN else ""
        if doubt.of == "moment" and abs(doubt.value) >= CLOCK:
            text = (
                f"{read}{line} looks like a time of the clock, counted from 1970. Times are counted from the start of "
                f"the run: take that of its start off all of them.{more}"
            )
            yield SceneWarning(join_key(doubt.key), text)
            continue
        text = (
            f"{read}{line} is unusual for {_article(doubt.of)}: {in_range(row)} is plausible. "
            f"{meant(doubt.typed, _units_meant(doubt, system), doubt.unit)}.{more}"
        )
        yield SceneWarning(join_key(doubt.key), text)


def _article(name: str) -> str:
    """A name with its article, where it has one."""
    if name in ("slew", "luff", "heave", "gravity", "yaw", "surge or sway", "roll or pitch", "time simulated"):
        return name
    return f"{'an' if name[0] in 'aeio' else 'a'} {name}"


def _belongs(unit: str, system: str) -> bool:
    """Whether a unit is one of a system's own; SI has none that are sought."""
    if system == "field":
        return bool(FIELD.search(unit)) or unit in ALSO_FIELD
    return system == "metric" and unit in METRIC


def _usual_unit(row: Range, system: str) -> str | None:
    """The unit of a system that is usual for a quantity and is not SI's; None where there is none."""
    return next((unit for unit in row.meant if _belongs(unit, system) and unit not in SELDOM), None)


def _bare(system: str, found: list[_Doubt]) -> list[SceneWarning]:
    """One warning of all numbers without a unit, in a scene that is in other units than SI."""
    if not found:
        return []
    readings = []
    for doubt in found[:LISTED]:
        unit = _usual_unit(RANGES[doubt.of], system) or ""
        value = _in_unit(doubt.typed, unit, doubt.unit)
        other = "" if value is None else f", and {doubt.typed} {unit} would be {sized(value, doubt.unit)}"
        line = f" (line {doubt.line})" if doubt.line else ""
        readings.append(f"{join_key(doubt.key)} = {doubt.typed}{line} is {doubt.shown}{other}")
    more = f"; and {len(found) - LISTED} more" if len(found) > LISTED else ""
    numbers = "1 number has" if len(found) == 1 else f"{len(found)} numbers have"
    text = f"{system}, and {numbers} no unit. A number without a unit is read in SI: {'; '.join(readings)}{more}"
    return [SceneWarning("units", f"{text}. Write the unit that is meant")]
