"""Lines of a table: rows, headers that come again, and rows that broke off with a header behind them.

A logger that loses its power, or files that are put together, leave lines such as ``1006.0,12time,winch,load``. What
stands before the header there is the piece of a row. The rule:

1. A table's header may come again in the midst, also at the end of a line. There it has all columns of the map and a
   stamp as titles, quotes taken off, with no number among them or behind them; or all titles of the header before.
2. It ends where the line ends. It begins behind the last number or date, for these are no titles, and no later than
   the first of its titles that is known: a column of the map, the stamp, or a title of the header before. Where that is
   one cell, rows behind the line are read by it.
3. Where it may begin in several cells, rows behind the line show in which; an empty cell is no first title. A row
   speaks for a place if it has the cells of a row of that header, with a stamp and numbers where the header has them,
   and if it speaks for no other place. Where the line ends with all titles of the header before, rows have as many
   cells more than titles as they had before, empty ones counted. Behind other titles they fill a cell for each title.
   Words in columns of the map speak against a place only where the number of cells leaves several.
4. A row that broke off has fewer cells than a whole one, and seldom more: two lines may run into one. So a row that
   speaks for the longest header is read by it, and two of them prove it. A shorter header is proved by three such
   rows, one behind the other but for rows that speak for no place; and only where the line ends with all titles of the
   header before, or leaves no other place. For rows of other titles may all lack their last cells.
5. Until one is proved, rows that do not speak for it are left out, counted and told. Where nothing can show it, rows
   are left out until a header comes on a line of its own. No such line ends a source.
6. A line with a stamp in its place that fills no more cells than the header has is a row, whatever its text says. But
   where it may end with all titles that are needed, it is left out, counted and told, and the header before counts as
   the longest in rule 4: one row that is longer than those of a header in it shows that it was a row. (So a row shows
   that a line of words in which a header begins nowhere was a remark.) So does a second line of that kind right behind
   it, and from there on all such lines are rows, unless a number breaks off before a title. Most rows are known by a
   quick look at their cells.
7. What stands before the title in its cell is a piece if it is one of a number before the stamp or before a title that
   is not needed, ``12time``; and any piece if all titles of the header before stand behind it, but for a word where
   rows have the stamp or a column of the map: ``aux winch`` is no ``winch``. Where such a piece stands before a title
   that is needed, or the header behind a piece lacks columns, it begins nowhere (rule 5).
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from tautline.scene.errors import shorten
from tautline.scene.reading.columns import NO_UNIT
from tautline.scene.reading.long_rows import NO_WORDS, STATES, filled, is_number_or_date, kind_of, shows_nothing
from tautline.twin.sources.stamps import heads, is_unit, number_of, stamp_of
from tautline.twin.sources.table.cells import cells_of, separator_of
from tautline.twin.sources.table.header import Header
from tautline.twin.sources.table.rows_in_doubt import RowInDoubt

Row = tuple[float, Mapping[str, float]]
"""Stamp and readings by column."""
MISSING = "#n/a"
"""What a spreadsheet has in a cell without a value, in small letters."""
BETWEEN = re.compile("[;\t,]")
"""What may stand between cells."""
PROOF_OF_LONGEST, PROOF = 2, 3
"""Rows that prove the longest header that a line may have, for seldom do lines run into one; and a shorter one."""
HALF = re.compile(r"(\d{4}-\d\d?-\d\d?[ T])?[\d.,:+-]*")
"""What may be left of a number or a date before a title: ``1006.time``."""


@dataclass(frozen=True)
class HeaderInLine:
    """A header at the end of a line, and where in that line it may begin.

    Attributes
    ----------
    cells : list of str
        Of the line, without quotes and without empty ones at its end.
    separator : str
    starts : sequence of int
        Cells that may be the first title; none where rows cannot be read by that header.
    known : int
        The first cell that is known to be a title.
    title : str
        That title, without a piece of a row before it.
    needed : sequence of int
        Cells with titles of the stamp, which is the first, and of the columns of the map.
    again : bool
        Whether the line ends with the titles of the header before.
    line : str
    number : int
        Of the line, for messages.
    most : int
        Titles that a header in the line has at most.
    as_row : bool
        Whether the line may as well be a row.
    """

    cells: list[str]
    separator: str
    starts: Sequence[int]
    known: int
    title: str
    needed: Sequence[int]
    again: bool
    line: str
    number: int
    most: int
    as_row: bool

    @property
    def may_be_text(self) -> bool:
        """Whether the line may be a row whose last cells are text: no number breaks off before a title, ``12time``."""
        tail = self.cells[-self.most :]
        return self.as_row and not any(cell[:1].isdecimal() and not _is_plain(cell) for cell in tail)

    @property
    def may_be_none(self) -> bool:
        """Whether there may be no header: the line may be a row, or it is one of words in which none begins."""
        return self.as_row or not (self.starts or any(kind_of(cell) == "number" for cell in self.cells))

    def header(self, start: int) -> str:
        """The header as a line of its own."""
        if start == 0 and self.title == self.cells[self.known]:
            return self.line
        cells = [*self.cells[start : self.known], self.title, *self.cells[self.known + 1 :]]
        text = io.StringIO()
        csv.writer(text, delimiter=self.separator, lineterminator="").writerow(cells)
        return text.getvalue()

    def fitting(self, cells: Sequence[str], usual: Set[int]) -> list[int]:
        """Where the header may begin, as the cells of a row behind it show.

        `usual` is how many cells rows of its last titles have more than titles; none where that is not known. A sensor
        may show a word: words in columns of the map decide only where the number of cells does not.
        """
        count, more = (len(cells), usual) if usual else (filled(cells), {0})
        wide = [start for start in self.starts if count - (len(self.cells) - start) in more]
        return [start for start in wide if self._has_numbers(start, cells, words=len(wide) == 1)]

    def _has_numbers(self, start: int, cells: Sequence[str], words: bool) -> bool:
        """Whether there is a stamp; and numbers, or nothing, in columns of the map, where they may have no `words`."""
        stamp, *wanted = (cells[place - start] if place - start < len(cells) else "" for place in self.needed)
        is_stamp = not math.isnan(number_of(stamp)) or math.isfinite(stamp_of(stamp))
        return is_stamp and (words or all(shows_nothing(cell) or kind_of(cell) == "number" for cell in wanted))


@dataclass
class Doubt:
    """A line in which a header begins, nobody knows where, and what rows behind it have shown.

    Attributes
    ----------
    found : HeaderInLine
    usual : set of int
        How many cells rows of its titles have more than titles, empty where that is not known.
    spoke, rows : int
        The place that rows spoke for last, and how many did without one between them for another place.
    chosen : int or None
        The place from which rows are read, and may be no more.
    units : tuple of str and int, optional
        A line of units behind the header, and its number.
    told : bool
    """

    found: HeaderInLine
    usual: Set[int]
    spoke: int = -1
    rows: int = 0
    chosen: int | None = None
    units: tuple[str, int] | None = None
    told: bool = False

    def take(self, starts: Sequence[int]) -> bool:
        """Whether a row that speaks for some places is read by the header that begins there: there is one only."""
        if len(starts) != 1:
            self.rows = 0 if starts else self.rows
            return False
        self.rows = self.rows + 1 if starts[0] == self.spoke else 1
        self.spoke = starts[0]
        return self.is_proved or self._is_longest

    @property
    def is_proved(self) -> bool:
        """Whether there are rows enough."""
        if self._is_longest:
            return self.rows >= PROOF_OF_LONGEST
        return self.rows >= PROOF and (bool(self.usual) or len(self.found.starts) == 1)

    @property
    def _is_longest(self) -> bool:
        """Whether no header that is longer is possible: where the line may be a row, that is the one before."""
        return self.spoke == min(self.found.starts) and not self.found.as_row


class Lines:
    """Lines behind a header: rows are read, and headers that come again are followed.

    Parameters
    ----------
    header : Header
        That of the first line.

    Attributes
    ----------
    header : Header
        By which rows are read.
    headed : bool
        Whether the line that was taken last is a header.
    """

    def __init__(self, header: Header) -> None:
        self.header, self.headed = header, False
        self._doubt: Doubt | None = None
        self._titles_in_rows = False  # whether rows have shown that they may end as a header does
        self._held: tuple[str, RowInDoubt] | None = None
        self._marked = False  # whether a cell that is not the first was `#N/A`

    def is_remark(self, line: str) -> bool:
        """Whether a line that begins with # is a remark.

        `#N/A` is what a spreadsheet has where a value is missing, and `#` before a row that begins with `N/A` looks the
        same. It is a row where other cells have shown that the table writes `#N/A`.
        """
        cells, place = cells_of(line, self.header.separator), self.header.stamp
        if not (place and cells and cells[0].lower() == MISSING):
            return True
        is_row = len(cells) >= self.header.before.shortest and _has_stamp(self.header, cells)
        if is_row and not (self._marked or MISSING in (cell.lower() for cell in cells[1:])):
            said = f"lines such as '{shorten(line)}' are passed over as remarks, for they begin with #"
            self.header.tell_once("marked", f"{said}. If they are rows, write an empty cell or NaN in place of #N/A")
            return True
        return not is_row

    def rows(self, line: str, whole: bool = True, number: int = 0) -> list[tuple[str, Row | None]]:
        """Lines that can be read now, or never (None), and their rows; none for a header.

        A row that may be two lines waits for the row behind it: its stamp shows whether a line is missing.

        Raises
        ------
        SceneError, NewHeader
            As `take`.
        """
        factors, self.header.doubted = self.header.factors, None
        row = self.take(line, whole, number)
        self._marked = self._marked or ("#" in line and MISSING in line.lower())
        doubted = None if self.headed else self.header.doubted
        row_at = doubted.time if doubted is not None else row[0] if row is not None else math.nan
        found = []
        if math.isfinite(row_at):
            found = self._settled(row_at)
        elif self.header.factors != factors or (row is not None and not self.headed):
            found = self.rest()
        if doubted is not None:
            self._held = line, doubted
        elif not self.headed:
            found.append((line, row))
        return found

    def rest(self) -> list[tuple[str, Row | None]]:
        """The line that waits for a row behind it, where none comes any more."""
        return self._settled(None)

    def _settled(self, behind: float | None) -> list[tuple[str, Row | None]]:
        """The line that waited, by the stamp of the row behind it."""
        if self._held is None:
            return []
        (line, doubted), self._held = self._held, None
        return [(line, self.header.settle(doubted, behind))]

    def take(self, line: str, whole: bool = True, number: int = 0) -> Row | None:
        """Stamp and values of a row; None for a header, and for what cannot be read.

        Raises
        ------
        SceneError, NewHeader
            As `Header.read` and `Header.next_header`.
        """
        self.headed = False
        found = header_in(line, number, self.header)
        if found is not None and not self._is_row(found):
            self._head(found, whole)
            return None
        if self._doubt is not None and not self._shown(self._doubt, line, whole, number):
            return None
        self.headed = False
        row = self.header.read(line, whole, number)
        if row is not None and math.isfinite(row[0]):
            return row
        self._follow(line, number, whole)
        return None if self.headed else row

    def _head(self, found: HeaderInLine, whole: bool) -> None:
        """Read rows by a header in a line, or let them show where it begins; half a line is none."""
        if found.as_row:
            said = "is a row, or one that broke off with a header after it: it is left out"
            self.header.tell_once("as row", f"{self.header.where}:{found.number}: '{shorten(found.line)}' {said}")
        if not whole:
            return
        self._doubt, self.headed = Doubt(found, self.header.usual if found.again else frozenset()), not found.as_row
        if len(found.starts) == 1 and not found.as_row:
            self._begin(found, found.starts[0])

    def _is_row(self, found: HeaderInLine) -> bool:
        """Whether a line that may be a row is one: nobody writes two headers, one right behind the other."""
        before = self._doubt
        if before is not None and not before.told and before.found.may_be_text and found.may_be_text:
            self._doubt, self._titles_in_rows = None, True
        return found.may_be_text and self._titles_in_rows

    def _follow(self, line: str, number: int, whole: bool = True) -> None:
        """Read rows by the header that a line is, where it is one."""
        later = self.header.next_header(line, number, whole)
        if later is not None:
            self.header, self.headed, self._doubt = later, True, None

    def _shown(self, doubt: Doubt, line: str, whole: bool, number: int) -> bool:
        """Whether a line is a row by a header that begins where rows have shown."""
        found, usual = doubt.found, self.header.usual  # where the line may be a row, it is still the one before
        cells = cells_of(line, found.separator)
        count = len(cells) if found.as_row and usual else filled(cells)
        longer = count > found.most + max([0, *usual]) and filled(cells) <= self.header.most_cells
        if longer and found.may_be_none and _has_stamp(self.header, cells):
            self._doubt = None  # longer than rows of that header would be: there was none
            return True
        if not any(is_number_or_date(cell) for cell in cells):
            if _are_units(cells) and doubt.chosen is None:
                doubt.units, self.headed = (line, number), whole
            else:
                self._follow(line, number, whole)  # a header on a line of its own
            return False
        starts = found.fitting(cells, doubt.usual) if whole else []
        as_before = found.as_row and len(cells) - self.header.width in usual
        if as_before or not doubt.take(starts):
            self._tell(doubt)
            return False
        if doubt.chosen != starts[0]:
            self._choose(doubt, starts[0], number)
        self._doubt = None if doubt.is_proved else doubt
        return True

    def _choose(self, doubt: Doubt, start: int, number: int) -> None:
        """Read rows by a header that begins in a cell of a line, with the line of units below it."""
        if doubt.chosen is not None:
            where, behind = self.header.where, doubt.found.number
            said = f"shows that the header in line {behind} begins later than the rows after it have shown so far"
            self.header.notes.append(f"{where}:{number}: {said}: what was read of these may be wrong")
        doubt.chosen = start
        self._begin(doubt.found, start)
        if doubt.units is not None:
            self._follow(*doubt.units)

    def _tell(self, doubt: Doubt) -> None:
        """Tell once that rows behind a line are left out."""
        if doubt.told:
            return
        doubt.told, found = True, doubt.found
        at = f"{self.header.where}:{found.number}: in '{shorten(found.line)}' a header stands"
        at += " in the midst of a row that broke off, or has columns added in front"
        until = "until one shows which of its titles is the first" if found.starts or found.as_row else ""
        until = until or "until a header comes on a line of its own"
        cure = "put the header on a line of its own, and delete the row"
        self.header.notes.append(f"{at}. Rows are left out {until}: {cure}")

    def _begin(self, found: HeaderInLine, start: int) -> None:
        """Read rows by a header that begins in a cell of a line; tell once that the row before it broke off."""
        again, header = found.header(start), self.header
        same = start == found.known and [found.title, *found.cells[start + 1 :]] == header.titles
        if start or again != found.line:
            header.tell_once(
                "torn",
                f"{header.where}:{found.number}: the row '{shorten(found.line)}' breaks off, and "
                f"{'the header comes once more' if same else 'a header comes'} after it. Such rows are left out",
            )
        self._doubt = None
        self._follow(again, found.number)


def header_in(line: str, number: int, header: Header) -> HeaderInLine | None:
    """A header at the end of a line of which it is not sure that it begins with that line; else None.

    Parameters
    ----------
    line : str
    number : int
        Of the line, for messages.
    header : Header
        That by which rows are read.
    """
    if not header.may_be_named(line):
        return None
    row = _is_like_row(line, header)
    if row and not _may_end_with_titles(line, header):
        return None
    separators = {header.separator: None, separator_of(line): None}
    for separator in separators:
        ways = [cells_of(line, separator)]
        if line.count('"') % 2:  # a quote was open where the row broke off
            ways.append([cell.strip() for cell in line.split(separator)])
        for cells in ways:
            bare = [cell.replace('"', "").strip() for cell in cells]
            while bare and not bare[-1]:
                bare.pop()
            found = _Search(bare, separator, header, row).found(line, number)
            if found is not None:
                return found
    return None


def _has_stamp(header: Header, cells: Sequence[str]) -> bool:
    """Whether a number or a date is where rows have their stamp."""
    stamp = cells[header.stamp] if header.stamp < len(cells) else ""
    return not math.isnan(number_of(stamp)) or math.isfinite(stamp_of(stamp))


def _is_like_row(line: str, header: Header) -> bool:
    """Whether a line has a stamp in its place, and fills no more cells than the header has."""
    if line.count('"') % 2:
        return False
    cells = cells_of(line, header.separator)
    return _has_stamp(header, cells) and filled(cells) <= header.most_cells


def _may_end_with_titles(line: str, header: Header) -> bool:
    """Whether a line like a row may have all titles that are needed, or one behind half a number: a quick look."""
    name, title = header.names[header.stamp] or header.titles[header.stamp], header.titles[header.stamp]
    ends = (name, title, *header.columns)
    words = [one for cell in BETWEEN.split(line) if (one := cell.strip(' "')) and not _is_plain(one)]
    if any(not one[0].isalpha() and one.endswith(ends) for one in words):
        return True
    if len(words) <= len(header.columns):
        return False
    different = {*words}
    different.update(heads([one for one in different if one[-1] in "])"])[0])
    if not all(any(word.endswith(one) for word in different) for one in header.columns):
        return False
    return any(word.endswith((name, title)) for word in different) or header.stamp_among([*different]) is not None


def _is_plain(cell: str) -> bool:
    """Whether a cell has no letter."""
    return not any(map(str.isalpha, cell))


class _Search:
    """Looks for a header at the end of the cells of a line, which may be `like_row`."""

    def __init__(self, cells: list[str], separator: str, header: Header, like_row: bool) -> None:
        self.cells, self.separator, self.header, self.like_row = cells, separator, header, like_row
        self.titles = [title.replace('"', "") for title in header.titles]
        self.needed = [header.stamp, *header.places.values()]

    def found(self, line: str, number: int) -> HeaderInLine | None:
        """The header of the line; None where there is none, or where it surely begins with the line."""
        same = self._same()
        one = same or self._other()
        if one is None:
            return None
        known, title, needed, starts = one
        again = same is not None
        most, as_row = len(self.cells) - min(self._behind_numbers(known), known), self.like_row and not again
        return HeaderInLine(self.cells, self.separator, starts, known, title, needed, again, line, number, most, as_row)

    def _same(self) -> tuple[int, str, list[int], Sequence[int]] | None:
        """All titles of the header before, in their order, at the end of the line, with something before them."""
        cells, titles = self.cells, self.titles
        known = len(cells) - len(titles)
        if known < 0 or len(titles) < 2 or cells[known + 1 :] != titles[1:] or not cells[known].endswith(titles[0]):
            return None
        piece = cells[known].removesuffix(titles[0])
        if not (known or piece) or (piece and self.header.stamp_among([cells[known]]) == 0):
            return None  # `Datetime` is a title itself
        word, of_needed = not (HALF.fullmatch(piece) or _may_be_missing(piece)), 0 in self.needed
        starts = self._starts(known)
        if piece and of_needed:
            unsure = word and known in self.needed
            if unsure and not known:
                return None  # another column, in a header that begins with the line
            starts = [] if unsure else [known]
        elif not known:
            starts = [0]
        return known, titles[0], [known + place for place in self.needed], starts

    def _other(self) -> tuple[int, str, list[int], Sequence[int]] | None:
        """Another header that has a stamp and all columns of the map, behind cells that may be of a row."""
        cells, header = [*self.cells], self.header
        known = min((i for i in self._last_places(cells).values()), default=len(cells))
        for place in range(known - 1, -1, -1):
            title = cells[place][len(_half(cells[place])) :]
            if title and title != cells[place] and title[0] != " " and self._is_unneeded_or_stamp(title):
                cells[place], known = title, place
                break
        first = self._behind_numbers(known)
        stamp, found = header.stamp_among(cells), self._last_places(cells)
        wanted = [found.get(column) for column in header.columns]
        if stamp is None or not wanted or None in wanted:
            return self._without_columns(cells, known, first, stamp)
        if any(is_number_or_date(cell) and cell not in self.titles for cell in cells[known:]):
            return None
        if known == 0 and cells == self.cells:
            return None  # it begins with the line
        needed = [stamp, *(place for place in wanted if place is not None)]
        starts = self._starts(known) if cells == self.cells else [known]
        return known, cells[known], needed, starts

    def _without_columns(
        self, cells: list[str], known: int, first: int, stamp: int | None
    ) -> tuple[int, str, list[int], Sequence[int]] | None:
        """A header behind the piece of a row that lacks what is needed, or has it behind a piece: none can be read."""
        needed = [self.titles[place] for place in self.needed]
        tail = [*cells[min(first, known) :]]
        # `12time` breaks off a number. `aux winch` and `overload` are words of a row, unless all titles are there; and
        # so is `start`, whatever stands beside it, where `t` is the stamp.
        all_there = len(tail) >= len(needed) and all(
            any(cell == one or (cell.endswith(one) and (len(one) > 1 or not self.like_row)) for cell in tail)
            for one in needed
        )
        glued = [
            cell.removesuffix(title)
            for cell in self.cells[: known + 1]
            for title in needed
            if cell != title and cell.endswith(title)
        ]
        of_number = any(HALF.fullmatch(piece) or _may_be_missing(piece) for piece in glued)
        there = not {*needed}.isdisjoint(cells[known:])
        others = stamp is not None and (first or cells != self.cells) and not self.like_row
        others = others and bool(self.header.is_header(_as_line(tail, self.separator)))
        torn = there and (of_number or (all_there and glued))
        return (known, "", [], []) if torn or others else None

    def _is_unneeded_or_stamp(self, title: str) -> bool:
        """Whether a title, behind a piece of a number, is the stamp or is known and not one of the map."""
        if self.header.stamp_among([title]) == 0:
            return True
        return title in self.titles and self.titles.index(title) not in self.needed

    def _last_places(self, cells: Sequence[str]) -> dict[str, int]:
        """Where titles that are known stand last: a header ends with the line, and has each of them once."""
        names, known = heads(cells)[0], {*self.titles, *self.header.columns}
        found: dict[str, int] = {}
        for place, (name, cell) in enumerate(zip(names, cells, strict=True)):
            found |= {title: place for title in (name, cell) if title in known and title}
        stamp = self.header.stamp_among(cells)
        return found if stamp is None else found | {names[stamp]: stamp}

    def _starts(self, known: int) -> list[int]:
        """Cells that may be the first title, up to one that is known to be a title."""
        first = self._behind_numbers(known)
        return [place for place in range(first, known + 1) if place == known or self.cells[place]]

    def _behind_numbers(self, known: int) -> int:
        """The cell behind the last number or date before the first title that is known."""
        return max((i + 1 for i, cell in enumerate(self.cells[:known]) if is_number_or_date(cell)), default=0)


def _half(cell: str) -> str:
    found = HALF.match(cell)
    return found[0] if found else ""


def _may_be_missing(piece: str) -> bool:
    """Whether a piece is the beginning of a word for a number that is missing: ``Na`` of ``NaN``."""
    return any(word.startswith(piece.strip().lower()) for word in (*NO_WORDS, *STATES))


def _are_units(cells: Sequence[str]) -> bool:
    """Whether cells are units, as they stand below a header: no numbers, and more known units than other words."""
    bare = [cell.strip("[]() ") for cell in cells]
    words = [cell for cell in bare if cell not in NO_UNIT]
    return 2 * sum(map(is_unit, words)) > len(words) and not any(map(is_number_or_date, words))


def _as_line(cells: Sequence[str], separator: str) -> str:
    text = io.StringIO()
    csv.writer(text, delimiter=separator, lineterminator="").writerow(cells)
    return text.getvalue()
