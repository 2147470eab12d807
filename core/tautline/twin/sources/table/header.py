"""The header of a table, and its rows read by it, cell by cell, as a CSV file or a stream of lines has them."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from tautline.scene.errors import Problem, SceneError, shorten
from tautline.scene.reading.columns import NO_UNIT
from tautline.scene.reading.long_rows import (
    cure_of_long_rows,
    filled,
    first_beyond,
    has_half_a_second,
    has_remark,
    kind_of,
    only_words_behind,
    shows_nothing,
    usual_kinds,
)
from tautline.scene.reading.time_columns import unit_of_time
from tautline.twin.sources.record import Later, NewHeader
from tautline.twin.sources.stamps import heads, is_unit, is_unit_of_time, number_of, stamp_column, stamp_of
from tautline.twin.sources.table.cells import cells_of, separator_of, titles_of
from tautline.twin.sources.table.columns import Columns, Wanted, places_of
from tautline.twin.sources.table.numbers import Numbers
from tautline.twin.sources.table.rows_in_doubt import RowInDoubt, RowsBefore

FEW = 10
"""Of so many rows, one that is shorter than most broke off."""


class Header:
    """The header of a table, and how its rows are read.

    Parameters
    ----------
    line : str
        The header.
    columns : sequence of str
        Those that are wanted.
    time : str
        The column of the stamp; empty for the usual names.
    where : str
        File or stream, for messages.
    units : mapping, optional
        Units by column that the readings are wanted in: those of the map.
    notes : list of str, optional
        Where sentences for the user go.
    number : int
        Number of the line, for messages.
    below : sequence of sequences of str
        Units by cell of each line below the header that has them.

    Attributes
    ----------
    notes : list of str
        What is to be known of units that say nothing, and of stamps.
    offsets : Counter
        How many rows have had so many cells more than the header has titles, also rows by the same titles before.
    doubted : RowInDoubt or None
        The row that was read last, where it may be two lines that ran into one.
    before : RowsBefore
        What rows before have shown, also rows by the same titles before.

    Raises
    ------
    SceneError
        Where the stamp or a wanted column is missing, and where a unit of the header is one of another quantity.
    """

    def __init__(
        self, line: str, columns: Sequence[str], time: str, where: str, units: Mapping[str, str] | None = None,
        notes: list[str] | None = None, number: int = 1, below: Sequence[Sequence[str]] = (),
    ) -> None:  # fmt: skip
        self._wanted = Wanted(columns, time, where, units or {})
        self._line, self._number_of_line = line, number
        # Whether the next line may have its units: no row was read by it. And whether rows came before it.
        self._bare, self._behind, self._below = not below, False, below
        self._kept = False  # whether the units below are of the same titles before: others take their place
        self._former: tuple[object, ...] | None = None  # how rows before this header were read; None where none came
        self.separator = separator_of(line)
        titles = self.titles = titles_of(line, self.separator)
        self.columns, self.where = columns, where
        self.width = self._before = len(titles)
        self._cells = max(len(cells_of(line, self.separator)), 1)  # with those that have no title, at its end
        self.notes: list[str] = [] if notes is None else notes
        self._later: Later | None = None
        self._widths: set[int] = set()  # numbers of cells that rows have had, but for those in doubt
        self.offsets: Counter[int] = Counter()
        self._begun = False  # whether any row was read, also one in doubt
        self.before = RowsBefore(self._cells, self.width)
        self.doubted: RowInDoubt | None = None
        # Whether a whole row had a time of the day, and whether words were in the first cell beyond the header.
        self._whole_times = self._status = False
        self._told: set[str] = set()  # what is said once, of this header and those behind it
        found = Columns(titles, self._wanted, number, below, self.notes)
        self.names, self.units, self.stamp, self.factor = found.names, found.units, found.stamp, found.factor
        self.places, self.factors, self._stamps = found.places, found.factors, found.stamps
        self._numbers = Numbers(self.separator, (self.stamp, *self.places.values()), self.tell_once)

    def next_header(self, line: str, number: int, whole: bool = True) -> Header | None:
        """The header that a line is, from which on rows are read by it; None for a line that is none.

        Where a log is begun anew while it is followed, and where files are put together, a header comes once more. It
        may have its columns in another order, and other units. One by which rows cannot be read may be torn, with a
        good one behind it: this header stays, and `read` raises at the first row behind that one. Whether a line that
        has fewer cells is a header or a remark is shown by the row behind it.

        Parameters
        ----------
        line : str
            One that is no row. Where its stamp is a number or a date it is no header, whatever stands behind that.
        number : int
            Of the line, for messages.
        whole : bool
            Whether it ends: half a line is none.
        """
        where = self.where
        if self._has_stamp(line):
            return None
        if whole and (below := self._units_in(line)):
            return self._with_units(below, number)
        sure = self.is_header(line) if whole else False
        if whole and (described := self._described(line, number, sure is not False)):
            return described
        if sure is False:
            return None
        try:
            found = self._again(line, number)
        except SceneError as error:
            separator = separator_of(line)
            titles = titles_of(line, separator)
            if sure:
                self.notes.append(f"{where}:{number}: a new header by which rows cannot be read; it may be torn")
            told = f"{where}:{number}: a new header, or a remark? Readings count as missing until a row shows it"
            later = Later(NewHeader(error), separator, len(titles), bool(sure), self._is_named(titles), told)
            if self._later is None or later.weight >= self._later.weight:
                self._later = later
            return self if sure else None
        found._behind, found._former = True, self._way if self._begun else self._former
        found._told, found._numbers.marks = self._told, self._numbers.marks
        if found.titles == self.titles:
            found.offsets = self.offsets
            if found._cells == self._cells:
                found.before = self.before
        if self._way != found._way:
            other = "its columns, units or separator differ"
            self.notes.append(f"{where}:{number}: a new header; {other}. Rows from here on are read by it")
        return found

    def _again(self, line: str, number: int) -> Header:
        """The header that a line is; the same titles keep the units below them, until a line of units says otherwise.

        A logger may write its titles on each page, and the units below them once.
        """
        same = titles_of(line, separator_of(line)) == self.titles
        found = Header(line, *self._wanted, self.notes, number, self._below if same else ())
        found._bare, found._kept = True, same and bool(self._below)
        return found

    @property
    def _way(self) -> tuple[object, ...]:
        """How rows are read."""
        return self.places, self.factors, self.stamp, self.factor, self.separator

    @property
    def usual(self) -> set[int]:
        """How many cells rows have more than titles; not so the few that are shorter than most: they broke off."""
        if not self.offsets:
            return set()
        most, few = max(self.offsets, key=self.offsets.__getitem__), max(1, self.offsets.total() // FEW)
        return {offset for offset, rows in self.offsets.items() if offset >= most or rows > few}

    @property
    def most_cells(self) -> int:
        """Cells that the header has, also those without a title at its end."""
        return self._cells

    def may_be_named(self, line: str) -> bool:
        """Whether a line may have the title of the stamp, or has the names of all columns of the map: a quick look."""
        if self.columns and all(column in line for column in self.columns):
            return True
        name = re.escape(self.names[self.stamp] or self.titles[self.stamp])
        return re.search(rf"(?<![^\W\d])(?<! ){name}(?!\w)", line) is not None

    def stamp_among(self, titles: Sequence[str]) -> int | None:
        """Which of some titles is the stamp; None where none is."""
        names = heads(titles)[0]
        found = self._stamps.column(names) or self._stamps.column(titles) or self._stamps.timed(names)
        return max((i for i, title in enumerate(titles) if found in (title, names[i])), default=None)

    def tell_once(self, key: str, note: str) -> None:
        """Tell what is said once, of this header and those behind it."""
        if key not in self._told:
            self._told.add(key)
            self.notes.append(note)

    def _has_stamp(self, line: str) -> bool:
        """Whether what a line has in the place of the stamp is a number or a date."""
        cell = next(iter(cells_of(line, self.separator)[self.stamp :]), "")
        return not math.isnan(number_of(cell)) or math.isfinite(stamp_of(cell))

    def _units_in(self, line: str) -> list[str]:
        """Units by cell of a line right below the header that has them; empty for any other line.

        It has no number, and more known units than other words; beside them the cell of the stamp may say anything.
        """
        cells = [one.strip("[]() ") for one in cells_of(line, self.separator)]
        cells = ["" if one in NO_UNIT else one for one in cells]
        words = [one for i, one in enumerate(cells) if one and i != self.stamp]
        known = sum(is_unit(one) for one in words)
        if not self._bare or len(cells) > self.width + 1 or 2 * known <= len(words):
            return []
        if {*cells}.issuperset(self.columns) or not all(math.isnan(number_of(one)) for one in cells):
            return []
        return cells

    def _with_units(self, below: Sequence[str], number: int) -> Header:
        """This header with units of the line below it.

        Raises
        ------
        SceneError
            Where they cannot be, and no row came before. Else `read` raises at the next row.
        """
        lines = [below] if self._kept else [*self._below, below]
        try:
            found = Header(self._line, *self._wanted, self.notes, self._number_of_line, lines)
        except SceneError as error:
            if not self._behind:
                raise
            self._later, self._bare = Later(NewHeader(error), self.separator, self.width, True, True, ""), False
            return self
        found._told, found._numbers.marks, found._behind = self._told, self._numbers.marks, self._behind
        found.offsets, found.before, found._former = self.offsets, self.before, self._former
        if (self._kept or self._former is not None) and self._way != found._way:
            units = "the units of before again" if found._way == self._former else "other units than before"
            self.notes.append(f"{self.where}:{number}: {units}. Rows from here on are read by them")
        return found

    def _described(self, line: str, number: int, told: bool) -> Header | None:
        """The header with units of a second line of titles, before any row; None for any other line.

        Such a line describes the columns in other words: it has as many cells, and no column of the map. What stands in
        its brackets is read as units below the header are.

        Raises
        ------
        SceneError
            As for a line of units.
        """
        columns, where = self.columns, self.where
        cells = cells_of(line, self.separator)
        names, units = heads(cells)
        if self._begun or len(cells) != self.width or not {*names, *cells}.isdisjoint(columns):
            return None
        if self._stamped(cells) and not self._stamped([cells[self.stamp]]):
            return None  # its columns are in another order
        if not all(math.isnan(number_of(one)) for one in cells):
            return None
        asked = self._wanted.units
        known = list(units)
        if line == line.upper():  # in a line of capitals [KN] is the header's [kN], or that of the map
            own = {place: (self.units[place], asked.get(name, "")) for name, place in self.places.items()}
            anywhere = [*self.units, *asked.values()]
            for i, one in enumerate(units):  # [MN] of a column in MN is not the [mN] of another one
                known[i] = next((same for same in (*own.get(i, ()), *anywhere) if same.upper() == one), one)
        known = [one if is_unit(one) or (i == self.stamp and unit_of_time(one)) else "" for i, one in enumerate(known)]
        if not told and not any(known):
            return None
        self.notes.append(f"{where}:{number}: a line below the header that has other names describes its columns")
        for name, place in {**self.places, self.names[self.stamp] or "time": self.stamp}.items():
            unit, wanted = units[place], asked.get(name, "")
            same = unit.upper() in {self.units[place].upper(), wanted.upper()}
            if unit and not same and not is_unit(known[place]):
                self.notes.append(f"{where}:{number}: [{unit}] is no known unit: '{name}' is read as without this line")
        if not any(known):
            return self
        bare, found = self._bare, self._with_units(known, number)
        found._bare = bare and found is not self  # a line of units may come behind it
        return found

    def is_header(self, line: str) -> bool | None:
        """Whether a line is a header; None where the row behind it must show that.

        One that has the stamp and all columns is; and one as wide as this header that has all columns in other places:
        `tare,load` among rows is a remark. So is one without a number that has a name with a unit of time, or two names
        with units; or the stamp and a column; or the stamp and as many other names as the header has, or more. Units
        below a header are none, nor is a remark among rows, nor a line of one cell. A line that has units, fewer cells
        than the header and no stamp is in doubt: a remark may read `stop [s], crane 2`. But where all its cells have
        units, one of them of time, it is a header.
        """
        columns = self.columns
        separator = separator_of(line)
        titles = titles_of(line, separator)
        found, units = heads(titles)
        names = {*found, *titles}
        if len(titles) < 2 and columns:  # it cannot have the stamp and a column
            return False
        stamped = self._stamped(titles)
        if names.issuperset(columns) and (stamped or self._are_moved(titles)):
            return True
        if not all(math.isnan(number_of(one)) for one in titles) or self._are_units(titles):
            return False
        named = [unit for name, unit in zip(found, units, strict=True) if name and is_unit(unit)]
        timed = any(is_unit_of_time(unit) for unit in named)
        if (len(named) > 1 or timed) and separator != self.separator:
            return None
        if len(named) > 1 or timed:
            return True if stamped or len(titles) >= self.width or (timed and len(named) == len(titles)) else None
        if stamped and not names.isdisjoint(columns):
            return True
        if len(titles) < 2 or not (all(titles) or (stamped and sum(map(bool, titles)) > 2)):
            return False
        if stamped and len(titles) >= self.width and separator == self.separator:
            return True
        if stamped:
            return None
        # Names are not twice in a header: `NaN,NaN,NaN` and `bad,bad,bad` are none.
        return None if len(titles) != self.width and len({*titles}) == len(titles) else False

    def _are_moved(self, titles: Sequence[str]) -> bool:
        """Whether as many cells as this header has name columns of the map in other places than it does."""
        moved = any(places_of(column, titles) != [place] for column, place in self.places.items())
        return len(titles) == self.width and moved

    def _is_named(self, titles: Sequence[str]) -> bool:
        """Whether cells name a stamp, or have units as those of a header do."""
        named = [unit for name, unit in zip(*heads(titles), strict=True) if name and is_unit(unit)]
        return self._stamped(titles) or len(named) > 1 or any(is_unit_of_time(unit) for unit in named)

    def _stamped(self, titles: Sequence[str]) -> bool:
        """Whether one of the cells names a stamp."""
        names = [*heads(titles)[0], *titles]
        return self._stamps.column(names) is not None or stamp_column(names, "") is not None

    def _are_units(self, titles: Sequence[str]) -> bool:
        """Whether cells are the units of this header's columns: there `t` is a tonne, and no stamp."""
        if len(titles) <= self.stamp or titles[self.stamp].lower() == "t":
            return False
        if all(one in NO_UNIT or is_unit(one) for one in titles):
            return True
        beside = [one for i, one in enumerate(titles) if i != self.stamp]
        if not self._begun and any(map(is_unit, beside)) and all(one in NO_UNIT or is_unit(one) for one in beside):
            return True  # right below the header the stamp may have its name there; later `time,A,B` are columns
        others = [one for one in titles if one.lower() != "t"]
        return not self._begun and len(others) < len(titles) and not self._stamped(others)

    def read(self, line: str, whole: bool = True, at: int = 0) -> tuple[float, Mapping[str, float]] | None:
        """Stamp and values of a line, the `at`-th; None for one that has too few cells or too many.

        Where a line is shorter than the header, its last cell may be half of one: it counts as missing. A table whose
        lines are all as short, with cells that are left out at their ends, loses by this no more than one cell. So does
        the last cell of a line that is not `whole`: 47.58 may end as 4.

        Raises
        ------
        SceneError
            For the first row, where it cannot be read by the header.
        NewHeader
            For a row with a stamp behind a header by which it cannot be read.
        """
        self.doubted, cells = None, cells_of(line, self.separator)
        count = len(cells)
        number = filled(cells) if count > self._cells else count
        if not whole or (count < self.width and count != self._before):
            cells = cells[:-1]
        name, stamp = self.names[self.stamp] or "time", float("nan")
        if len(cells) > self.stamp:
            self._refuse_doubtful(cells[self.stamp])
            stamp = self._stamps.read(name, cells[self.stamp], self.factor)
            cell = cells[self.stamp]
            if not math.isnan(number_of(cell)) and math.isnan(self._numbers.read(name, cell, cells)):
                stamp = math.nan  # it may be one of thousands
        doubtful = self._later is not None and self._is_in_doubt(line, count, math.isfinite(stamp))
        if math.isfinite(stamp) and number > self._cells:
            if not self._has_remark(line, cells):
                self._too_long(line, cells, at)
                return None
            self._status |= not shows_nothing(first_beyond(cells, self._cells))
            self._tell_remark(line, at)
            self.offsets[count - self.width] += 1
        elif math.isfinite(stamp) and not doubtful:
            seconds = self.before.seconds(cells, self.stamp, self.factor)
            if found := self.before.seems_two(cells, {self.stamp, *self.places.values()}, seconds):
                said, last = self._said_of_two(line, count, at, found), self.before.stamps[-1]
                self.doubted = RowInDoubt(stamp, self._values(cells), found, said, count, last, seconds)
            else:
                self._widths.add(count)
                self.offsets[count - self.width] += 1
                self._whole_times |= ":" in cells[self.stamp] and count >= self.width
                self.before.add(cells, self.stamp)
        if math.isfinite(stamp):
            self._bare, self._begun = False, True
            self._before = min(count, self._cells)  # that of a remark does not show that a row is whole
            self.before.stamps.append(stamp)
        if self.doubted is not None:
            return self.doubted.left
        if len(cells) <= self.stamp:
            return None
        return stamp, dict.fromkeys(self.places, math.nan) if doubtful else self._values(cells)

    def _values(self, cells: Sequence[str]) -> dict[str, float]:
        """Readings by column; NaN where there is none."""
        return {
            name: self.factors[name] * self._numbers.read(name, cells[place], cells) if place < len(cells) else math.nan
            for name, place in self.places.items()
        }

    def settle(self, row: RowInDoubt, behind: float | None) -> tuple[float, Mapping[str, float]] | None:
        """What is read of a row in doubt, as the stamp `behind` it shows; tells once what is left out."""
        if self.before.is_one(row, behind):
            self.offsets[row.count - self.width] += 1
            return row.time, row.values
        self.tell_once(row.kind, row.said)
        return row.left

    def _said_of_two(self, line: str, count: int, at: int, found: str) -> str:
        """That a row is left out, or its readings, for two lines may have run into one."""
        said = f"has {count} cells, and others before had {self.before.usual}: two lines may have run into one"
        what = "Such rows" if found == "two" else "Readings of such rows"
        but = "but where the stamps before and after show that no line is missing"
        return f"{self.where}:{at}: the row '{shorten(line)}' {said}. {what} are left out, {but}"

    def _refuse_doubtful(self, cell: str) -> None:
        """Refuse a number as a stamp where the header leaves it in doubt in which unit that is; a date needs none.

        Raises
        ------
        SceneError, NewHeader
            The second where other rows came before.
        """
        if math.isfinite(self.factor) or math.isnan(number_of(cell)):
            return
        cause, cure = self._stamps.unclear(self.titles[self.stamp])
        refused = SceneError([Problem(self.where, self._number_of_line, "", None, cause, cure)])
        raise NewHeader(refused) if self._behind else refused

    def _has_remark(self, line: str, cells: Sequence[str]) -> bool:
        """Whether what a row has beyond the header is a remark, so that the cells before it are in their places.

        The stamp and columns of the map have numbers also where no row has shown that yet.
        """
        quoted = f'"{cells[self.stamp]}"' in line
        whole = quoted or (self._whole_times and "half" not in self._told)
        if self.separator == "," and not whole and has_half_a_second(cells, self.stamp):
            return False
        places = [self.stamp, *self.places.values()]
        # A column of the map has no status: `Bad` is a missing number there.
        cells = ["" if i in places and shows_nothing(cell) else cell for i, cell in enumerate(cells)]
        if only_words_behind(cells, max(places), self._cells, self._status):
            return True
        numbers = [{"number"} if i in places else set() for i in range(self._cells)]
        usual = [usual_kinds(kinds) | number for kinds, number in zip(self.before.kinds, numbers, strict=True)]
        return has_remark(cells, self._cells, usual, self._status)

    def _tell_remark(self, line: str, at: int) -> None:
        """Tell once that words beyond the header are passed over."""
        shown = f"the row '{shorten(line)}' has words in more cells than the header has"
        self.tell_once("remark", f"{self.where}:{at}: {shown}: they are passed over, and the cells before them count")

    def _too_long(self, line: str, cells: Sequence[str], at: int) -> None:
        """Tell once that a row fills more cells than the header has: which cell is whose is not known.

        Raises
        ------
        SceneError
            Where no row was read yet: by such a header none can be.
        """
        where, number = self.where, filled(cells)
        if self.separator == "," and has_half_a_second(cells, self.stamp):
            self._told.add("half")  # seconds have a comma here: a stamp without one is that of a whole second
        cause = f"the row '{shorten(line)}' fills {number} cells, and the header has {self._cells}"
        first = line.split(self.separator, 1)[0]  # one with the time of a day is no row name: its second has a comma
        one_more = number == self._cells + 1 and not self._begun and ":" not in first
        cure = cure_of_long_rows(self.separator, one_more, "this row")
        if self.separator == "," and kind_of(cells[self._cells - 1]) == "word":
            cure += "; or, if commas are part of a text, put it in quotes"
        if self.separator == "," and has_half_a_second(cells, self.stamp):
            cure += f"; or, if stamps are whole seconds, write them with a zone: {cells[self.stamp]}Z"
        elif one_more and kind_of(cells[number - 1]) != "number":
            cure += "; or, if the last cell is a status or a remark, give its column a title"
        if not self._begun and not self._behind:
            raise SceneError([Problem(where, at or self._number_of_line, "", None, cause, cure)])
        told = f"{where}:{at}: {cause}. Such rows are left out, as lines that cannot be read"
        self.tell_once("long", f"{told}; {cure}" if cure.startswith("if") else f"{told}: {cure}")

    def _is_in_doubt(self, line: str, count: int, stamped: bool) -> bool:
        """Whether a row may be of a later header; raises NewHeader where it is, or where nothing speaks against it.

        A row that has more cells than a line before it is not read by that line: it was a remark.
        """
        later = self._later
        assert later is not None
        another = later.separator != self.separator
        others, filled = cells_of(line, later.separator), len(titles_of(line, self.separator))
        if not stamped and not ((later.sure or another) and any(not math.isnan(number_of(one)) for one in others)):
            return False  # no row
        fits = later.sure or self._fits(later, count, filled, len(others) if another else 0)
        if fits and not self._is_plain(later, line, another):
            raise later.error
        # Where rows were as short before, one more shows nothing; nor does the first one that lacks its last cells.
        waits = filled <= later.width if later.named else self._is_new(later, count)
        if another or not waits:
            self._later = None
            return False
        self._later = later = replace(later, rows=later.rows + 1)
        if later.told:
            self.notes.append(later.told)
            self._later = replace(later, told="")
        return True

    def _fits(self, later: Later, count: int, filled: int, others: int) -> bool:
        """Whether a row is of that header, by its cells: all, those before empty ones at its end, by its separator.

        A number of cells that rows had before shows nothing, where rows with more may come. One that has fewer cells
        than the header may lack its last ones: where the line names no stamp, two such rows show that it is a header.
        """
        if not later.named:
            return self._is_new(later, count) and (count > self.width or later.rows > 0)
        if others:
            return 1 < others <= later.width or filled < 2
        blind = later.rows > 0 and max(self._widths, default=0) <= later.width
        return count <= later.width and (count not in self._widths or blind)

    def _is_new(self, later: Later, count: int) -> bool:
        """Whether a row has as many cells as a later line, and none before it had."""
        return bool(self._widths) and count == later.width and count not in self._widths

    def _is_plain(self, later: Later, line: str, another: bool) -> bool:
        """Whether a row has numbers only by this header's separator, where a line in doubt has another one."""
        cells = titles_of(line, self.separator)
        numbers = len(cells) > 1 and not any(math.isnan(number_of(one)) for one in cells)
        return another and not later.sure and numbers
