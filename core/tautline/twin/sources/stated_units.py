"""Units that are stated with the readings: a unit holds until another one is stated, and a change of it is told.

A logger that is set from kN to N goes on with a thousand times the readings, and one that states a unit now and then
does not mean the map's unit in between. So each column has the unit that was stated of it last.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from tautline.scene.errors import shorten
from tautline.scene.reading.columns import NO_UNIT
from tautline.twin.sources.reading_units import OtherQuantity, factor_stated

CHANGES = 20
"""Changes of the unit of a column that are told: where two senders take turns, each row would be one."""


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


class StatedUnits:
    """The unit that was stated last of each column, and what its readings are multiplied by.

    Parameters
    ----------
    asked : mapping of str to str
        Units by column that the readings are wanted in.
    notes : list of str
        Where sentences for the user go.
    factors : dict of str to float
        Where what readings are multiplied by is kept, by column.
    """

    def __init__(self, asked: Mapping[str, str], notes: list[str], factors: dict[str, float]) -> None:
        self._asked, self._notes, self._factors = asked, notes, factors
        self._remarks = Remarks(notes)
        # By column and by who states it: a unit of another machine, whose readings are left out, is none of this one.
        self._stated: dict[tuple[str, str], str] = {}
        self._scales: dict[tuple[str, str], float] = {}
        self._changes: dict[tuple[str, str], int] = {}
        self._silent: set[tuple[str, str]] = set()

    def factor(self, column: str, units: Sequence[str], where: str) -> float:
        """What a reading is multiplied by to be in the map's unit; NaN for one of another quantity.

        Parameters
        ----------
        units : sequence of str
            The unit that is stated, and other names of it; where there is none, the last one holds.
        where : str
            Who states it, for messages.
        """
        given = [one for one in units if one.strip() not in NO_UNIT]
        place = column, where
        if not given:
            return self._last(column, where)
        self._silent.discard(place)
        if self._stated.get(place) != given[0]:
            self._take(column, given, where)
        return self._scales[place]

    def _last(self, column: str, where: str) -> float:
        """The factor of the unit that was stated last, which is told once until one is stated again; 1 without any."""
        place = column, where
        if place in self._stated and place not in self._silent:
            self._silent.add(place)
            last = shorten(self._stated[place])
            text = f"{where} no unit of {column} is given any more: its readings are taken in {last}, the last one"
            self._tell(place, text)
        return self._scales.get(place, 1.0)

    def _take(self, column: str, given: Sequence[str], where: str) -> None:
        """Take a unit that is another one than before, and tell it as a change."""
        place, told = (column, where), list[str]()
        before, self._stated[place] = self._stated.get(place), given[0]
        factor = factor_told(column, given, self._asked.get(column), where, Remarks(told) if before else self._remarks)
        self._scales[place] = factor
        self._factors[column] = factor if math.isfinite(factor) else 1.0
        if before is not None:
            asked = self._asked.get(column)
            then = told or ([f"its readings are in {asked}, as the map says"] if asked else [])
            changed = f"{where} the unit of {column} has changed from {shorten(before)} to {shorten(given[0])}"
            self._tell(place, f"{changed}. {'. '.join(then)}" if then else changed)

    def _tell(self, place: tuple[str, str], text: str) -> None:
        """Tell of a change; of a unit that changes with every other reading no more than some times."""
        count = self._changes[place] = self._changes.get(place, 0) + 1
        if count < CHANGES:
            self._notes.append(text)
        elif count == CHANGES:
            self._notes.append(f"{text}. It changes again and again: this is told no more. Let one program state it")


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
