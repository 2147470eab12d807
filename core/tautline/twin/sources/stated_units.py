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

Place = tuple[str, str]
"""A column, and who states units of it."""
Stated = dict[Place, tuple[str, ...]]


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
    before : dict, optional
        `stated` of an earlier process, which holds until a unit is stated.

    Attributes
    ----------
    stated : dict
        The unit that was stated last, and other names of it, by column and by who states it: a unit of another machine,
        whose readings are left out, is none of this one. A new one at each change: other threads may keep it.
    """

    def __init__(
        self, asked: Mapping[str, str], notes: list[str], factors: dict[str, float], before: Stated | None = None
    ) -> None:
        self._asked, self._notes, self._factors = asked, notes, factors
        self._remarks = Remarks(notes)
        self.stated: Stated = dict(before or {})
        self._scales: dict[Place, float] = {}
        self._changes: dict[Place, int] = {}
        self._alike: set[tuple[Place, frozenset[str]]] = set()  # pairs of units with one factor that were told
        self._silent: set[Place] = set()
        for place, names in self.stated.items():
            self._go_on(place, names)

    def _go_on(self, place: Place, names: Sequence[str]) -> None:
        """Take a unit that an earlier process has heard."""
        column, where = place
        factor, then = meaning(names, self._asked.get(column))
        self._hold(place, factor)
        self._silent.add(place)
        if then:
            text = f"{where} the unit of {column} was {shorten(names[0])} when the state was saved{then}"
            self._notes.append(f"{text}. This holds until a unit is stated")

    def factor(self, column: str, units: Sequence[str], where: str, sure: bool = True) -> float:
        """What a reading is multiplied by to be in the map's unit; NaN for one of another quantity.

        Parameters
        ----------
        units : sequence of str
            The unit that is stated, and other names of it; where there is none, the last one holds.
        where : str
            Who states it, for messages.
        sure : bool
            Whether it is that of this column for sure. If not, one of another quantity holds for this reading alone: it
            may be no unit of it, or none at all.
        """
        given, place = _given(units), (column, where)
        if not given:
            return self._last(column, where)
        if place not in self.stated or self.stated[place][0] != given[0]:
            if not sure and math.isnan(meaning(given, self._asked.get(column))[0]):
                return self._pass_over(column, given, where)
            self._take(column, given, where)
        self._silent.discard(place)
        return self._scales[place]

    def _pass_over(self, column: str, given: Sequence[str], where: str) -> float:
        """Tell once of a unit of another quantity that is not of this column for sure; NaN."""
        unit, (factor, then) = shorten(given[0]), meaning(given, self._asked.get(column))
        why = f"This holds for readings beside it alone. If {unit} is no unit of {column}, give that key another name"
        self._remarks.tell(f"beside {column} {given[0]}", f"{where} the unit of {column} is {unit}{then}. {why}")
        return factor

    def _last(self, column: str, where: str) -> float:
        """The factor of the unit that was stated last, 1 without any; told once until one is stated again.

        A logger that states the map's unit at its beginning alone has nothing that could be mistaken.
        """
        place = column, where
        factor = self._scales.get(place, 1.0)
        if place in self.stated and place not in self._silent:
            self._silent.add(place)
            last = shorten(self.stated[place][0])
            then = f"its readings are taken in {last}, the last one"
            if not _is_known(self.stated[place], self._asked.get(column)):
                asked = self._asked.get(column) or "SI units"
                then = f"its readings are taken in {asked}, as {last}, the last one, is no known unit"
            if math.isnan(factor):
                then = f"its readings count as missing, as {last}, the last one, is of another quantity"
            if factor != 1.0 or place in self._changes:
                self._tell(place, f"{where} no unit of {column} is given any more: {then}")
        return factor

    def _take(self, column: str, given: Sequence[str], where: str) -> None:
        """Take a unit that is another one than before, and tell it as a change."""
        place, asked = (column, where), self._asked.get(column)
        before = self.stated.get(place)
        self.stated = {**self.stated, place: tuple(given)}
        if before is None:
            self._hold(place, factor_told(column, given, asked, where, self._remarks))
            return
        factor, then = meaning(given, asked)
        then = then or (f": its readings are in {asked}, as the map says" if asked else "")
        pair = place, frozenset((before[0], given[0]))
        if factor != self._scales[place] or pair not in self._alike:
            names = f"from {shorten(before[0])} to {shorten(given[0])}"
            self._tell(place, f"{where} the unit of {column} has changed {names}{then}")
        if factor == self._scales[place]:
            self._alike.add(pair)
        self._hold(place, factor)

    def _hold(self, place: Place, factor: float) -> None:
        self._scales[place] = factor
        self._factors[place[0]] = factor if math.isfinite(factor) else 1.0

    def _tell(self, place: Place, text: str) -> None:
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
    units, asked
        As those of `meaning`.
    where : str
        Who gives it, for messages.

    Returns
    -------
    float
        1 for a unit that nobody knows, NaN for one of another quantity.
    """
    factor, then = meaning(units, asked)
    if then:
        unit = _given(units)[0]
        remarks.tell(f"unit of {column} {unit}", f"{where} the unit of {column} is {shorten(unit)}{then}")
    return factor


def meaning(units: Sequence[str], asked: str | None) -> tuple[float, str]:
    """What a unit makes of readings.

    Parameters
    ----------
    units : sequence of str
        The unit that is given, and other names of it.
    asked : str or None
        The map's unit, empty for none; None where nothing is asked for.

    Returns
    -------
    factor : float
        What they are multiplied by to be in the map's unit; 1 for a unit that nobody knows, NaN for one of another
        quantity.
    then : str
        What is said of that, to go on with behind the name of the unit; empty where readings stay as they are.
    """
    given = _given(units)
    if not given or asked is None:
        return 1.0, ""
    try:
        found = _first_factor(given, asked)
    except OtherQuantity as error:
        cure = "So there is no reading of it. Correct `unit` of this column in the map, or the unit at its source"
        return math.nan, f", and the map says {asked}. '{given[0]}' {error}. {cure}"
    if found is None:
        why = "which is no known unit" if asked else "and the map gives no unit"
        return 1.0, f", {why}: its readings are taken in {asked or 'SI units'}"
    factor, meant = found
    return factor, f": its readings are converted to {asked}{meant}" if factor != 1.0 or meant else ""


def _is_known(units: Sequence[str], asked: str | None) -> bool:
    """Whether a unit says what readings are in; one of another quantity does, and they are none then."""
    try:
        return asked is None or _first_factor(_given(units), asked) is not None
    except OtherQuantity:
        return True


def _given(units: Sequence[str]) -> list[str]:
    """Names that say something, without blanks around them."""
    return [one.strip() for one in units if one.strip() not in NO_UNIT]


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
