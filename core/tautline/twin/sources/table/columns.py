"""Columns of a table: where the stamp and those of a map are in its header, and in which units their readings are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.time_columns import unit_of_time
from tautline.scene.refusal import nearest
from tautline.twin.sources.reading_units import OtherQuantity, factor_between
from tautline.twin.sources.record import NoColumn
from tautline.twin.sources.stamps import Stamps, heads, is_unit_of_time


class Wanted(NamedTuple):
    """What is wanted of a table.

    ``columns`` of the map; ``time`` the column of the stamp, empty for the usual names; ``where`` file or stream, for
    messages; ``units`` by column that the readings are wanted in: those of the map.
    """

    columns: Sequence[str]
    time: str
    where: str
    units: Mapping[str, str]


class Columns:
    """Where the wanted columns of a table are, and what their readings are multiplied by.

    Parameters
    ----------
    titles : sequence of str
        Cells of the header.
    wanted : Wanted
    number : int
        Line of the header, for messages.
    below : sequence of sequences of str
        Units by cell of each line below the header that has them.
    notes : list of str
        Where sentences for the user go.

    Attributes
    ----------
    names, units : list of str
        By cell; units are those of the header and of the lines below it.
    stamps : Stamps
        How stamps are read.
    stamp, factor : int, float
        The cell of the stamp, and how many seconds its unit is; NaN where the header leaves that in doubt.
    places, factors : dict of str
        By wanted column: its cell, and what its readings are multiplied by.

    Raises
    ------
    SceneError
        Where the stamp or a wanted column is missing or there twice, and where a unit of the header is one of another
        quantity.
    """

    def __init__(
        self, titles: Sequence[str], wanted: Wanted, number: int, below: Sequence[Sequence[str]], notes: list[str]
    ) -> None:
        self._titles, self._wanted, self._number, self._below, self._notes = titles, wanted, number, below, notes
        self.names, self.units = heads(titles)
        self.stamps = Stamps(wanted.time, notes, wanted.columns)
        self.stamp, self.places, self.factors = -1, dict[str, int](), dict[str, float]()
        stamp = self.stamps.column(self.names) or self.stamps.column(titles) or self.stamps.timed(self.names)
        problems = self._of_stamp(stamp)
        for column in wanted.columns:
            problems += self._twice(column) if column != stamp else []
            problems += self._of_column(column)
        if problems:
            raise SceneError(problems)
        self.factor = self.stamps.factor_of(self.names[self.stamp] or titles[self.stamp], self.units[self.stamp])

    def _of_stamp(self, stamp: str | None) -> list[Problem]:
        """Find the stamp; faults where it is missing or there twice, and where it is no stamp or has two units."""
        time = self._wanted.time
        if stamp is None:
            cause = f"there is no column '{time}'" if time else "there is no column of time"
            cure = nearest(time, sorted(self.names)) if time else "call it `time`, or name it in the map under `time:`"
            return [self._problem(cause, cure)]
        problems = self._twice(stamp)
        self.stamp = places_of(stamp, self._titles)[0]
        problems += self._other_units(stamp, self.stamp)
        if dated := self.stamps.dated(stamp, self.names):
            problems.append(self._problem(*dated))
        return problems

    def _of_column(self, column: str) -> list[Problem]:
        """Find a wanted column; faults where it is missing, has two units, or one of another quantity."""
        place = next(iter(places_of(column, self._titles)), None)
        if place is None:
            cure = nearest(column, sorted(name for name in self.names if name))
            return [
                NoColumn(self._wanted.where, self._number, "", None, f"there is no column '{column}'", cure, column)
            ]
        if others := self._other_units(column, place):
            return others
        self.places[column] = place
        unit, asked = self.units[place], self._wanted.units.get(column)
        try:
            self.factors[column] = self._factor(column, unit, asked)
        except OtherQuantity as error:
            cause = f"its unit is [{unit}], and the map says {asked}: '{unit}' {error}"
            cure = f"correct `unit` of this column in the map, or write [{asked}] in the header"
            return [self._problem(cause, cure, f"column '{column}'")]
        return []

    def _problem(self, cause: str, cure: str, key: str = "") -> Problem:
        return Problem(self._wanted.where, self._number, key, None, cause, cure)

    def _twice(self, column: str) -> list[Problem]:
        """That a column is there more than once: nothing shows which of them is meant."""
        places = places_of(column, self._titles)
        if len(places) < 2:
            return []
        shown = ", ".join(f"cell {i + 1} ('{self._titles[i]}')" for i in places)
        cause = f"there are {len(places)} columns '{column}' in the header: {shown}"
        return [self._problem(cause, "give each column a name of its own")]

    def _other_units(self, column: str, place: int) -> list[Problem]:
        """Take the unit of a column from the lines below the header; faults where two of these lines differ."""
        for line in self._below:
            one, before = line[place] if place < len(line) else "", self.units[place]
            if one and place == self.stamp:
                one, before = _time_below(one), unit_of_time(before) or before
            if not one:
                continue
            if before and not _are_alike(before, one):
                cause = f"the unit is [{before}] in the header and {one} in the line below it"
                return [self._problem(cause, "give one of both", f"column '{column}'")]
            self.units[place] = one
        return []

    def _factor(self, column: str, header: str, asked: str | None) -> float:
        """What readings of a column are multiplied by; 1 where the header or nobody gives a unit."""
        if asked is None:
            return 1.0
        factor = factor_between(header, asked)
        if factor is None:
            said = f"its readings are taken in {asked}" if asked else "its readings are taken in SI units"
            why = "which is no known unit" if asked else "and the map gives no unit"
            note = f"column '{column}' has the unit [{header}] in the header, {why}: {said}"
            self._notes += [note] if note not in self._notes else []
            return 1.0
        return factor


def places_of(column: str, titles: Sequence[str]) -> list[int]:
    """Where a column is, by its name or by its whole title, ``rope [kN]``."""
    return [i for i, (one, name) in enumerate(zip(titles, heads(titles)[0], strict=True)) if column in (one, name)]


def _time_below(cell: str) -> str:
    """A unit of time below a header; empty for anything else: in the place of the stamp it may say anything.

    `m` stays: metres are no times, and minutes or months are not clear.
    """
    if cell.casefold() == "m":
        return cell
    return unit_of_time(cell) or (cell if is_unit_of_time(cell) else "")


def _are_alike(one: str, other: str) -> bool:
    """Whether two units are the same, however they are written."""
    try:
        return one == other or factor_between(one, other) == 1.0
    except OtherQuantity:
        return False
