"""Columns of numbers from a CSV file: one reader for tables, surveys, records of motion, and measured loads.

Comma, semicolon or tab stand between cells; decimal commas where the comma is no separator. Lines that begin with ``#``
and lines without any cell are passed over. Units stand in the header: ``md [ft]``, ``roll (deg)``, ``roll_deg``,
``RollDeg``. All faults of a file are collected, and raised together by the lines that they stand on.
"""

from __future__ import annotations

import csv
import functools
import math
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import NoReturn

import numpy as np

from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.force_units import not_a_force, unit_of_force
from tautline.scene.reading.long_rows import (
    cure_of_long_rows,
    filled,
    first_beyond,
    has_remark,
    is_number_or_date,
    kind_or_state,
    shows_nothing,
    usual_kinds,
)
from tautline.scene.reading.text import decode
from tautline.scene.reading.title_lines import MOST_LINES, header_below
from tautline.scene.refusal import nearest
from tautline.scene.values.habits import other_minus
from tautline.scene.values.magnitude import LARGEST, OUTSIDE
from tautline.scene.values.units import TABLE, Uncounted, UnknownUnit, converted, read_unit

LARGEST_TABLE = 200_000_000
"""Bytes of a file, where its reader does not say."""
MOST_FAULTS = 1000
"""Faults that are collected before a file is given up."""
USUAL_ROWS = 1000
"""Rows that show what kind of cell each column has."""
HEADER = re.compile(r"\s*(?P<name>[^\[(]*?)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?\s*")
NO_UNIT = ("", "-", "--", "1")
"""What stands for a unit in the header of a column without one."""
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
THOUSANDS = re.compile(r"[+-]?\d{1,3}((\.\d{3})+|(,\d{3})+)", re.ASCII)
"""A number that may have points, or commas, as marks of thousands."""
THOUSAND = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}", re.ASCII)
"""A number whose one point or comma may be a mark of thousands."""
SEPARATOR_LINE = re.compile(r"\s*\"?sep=(.)\"?\s*", re.IGNORECASE)
"""The first line of files that a spreadsheet writes for itself: it states what stands between cells."""
WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
"""First bytes of the files of spreadsheets: .xlsx and .ods are archives, .xls is older."""
WORDS = {
    "°": "deg", "deg": "deg", "degs": "deg", "degree": "deg", "degrees": "deg", "dega": "deg",
    "rad": "rad", "rads": "rad", "radian": "rad", "radians": "rad", "grad": "gon", "hz": "Hz",
    "meter": "m", "meters": "m", "metre": "m", "metres": "m", "mkb": "m",
    "ftkb": "ft", "us ft": "usft", "ftus": "usft", "survey ft": "usft",
}  # fmt: skip
"""Ways to write units in headers, in small letters; `ftKB` and `mKB` count from the kelly bushing."""

LETTER_UNITS = ("ns", "us", "ms", "s")
"""Units that may follow the bare letter `t`: t_min is a least value, t_h and t_d are other things' indices."""


class Columns:
    """A CSV file as columns.

    Parameters
    ----------
    path : str or Path
    largest : int
        Bytes that it may have.
    headed : bool
        Whether it must have a header; a file without one has columns without names.

    Attributes
    ----------
    titles, names, units : list of str
        Of each column: the cell of the header, its name in small letters, its unit; empty where there is none.
    rows : list of (line, cells)
    header_line : int
    problems : list of Problem
        Faults found so far.

    Raises
    ------
    SceneError
        If there is no such file, or it is too large, empty, no text, or lacks its header.
    """

    def __init__(self, path: str | Path, largest: int = LARGEST_TABLE, headed: bool = False) -> None:
        self.path = Path(path)
        self.problems: list[Problem] = []
        self._read_so_far: dict[int, str] = {}  # names of columns by place
        rows = self._read(largest)
        self.header_line, first = rows[0]
        self.headed = not all(_is_number(cell) for cell in first if cell)
        filled_below = len(rows) > 1 and all(_is_number(_cell(rows[1][1], i)) for i in range(len(first)))
        if self.headed and len(first) > 2 and all(_is_number(cell) for cell in first[:2]) and not filled_below:
            cause = "begins with numbers as a row does, and has words as a header does"
            cure = "write a header above it, such as time,value, and begin remarks with # in lines of their own"
            self.stop(self.header_line, "", None, cause, cure)
        if self.headed and len(first) == 2 and is_number_or_date(first[0]):
            below = [_cell(row, 0) for _, row in rows[1 : USUAL_ROWS + 1]]
            if below and all(map(_is_number, below)):
                word = next(cell for cell in reversed(first) if not _is_number(cell))
                cause = f"begins with '{first[0]}' as a row does, and '{word}' is no number that can be read"
                cure = "write plain numbers, or a header above them, such as time,value"
                self.stop(self.header_line, "", None, cause, cure)
        if headed and not self.headed:
            cause, cure = "the first line holds numbers where the names should be", "write a header above them"
            self.stop(self.header_line, "", None, cause, cure)
        self.titles = first if self.headed else [""] * len(first)
        heads = [HEADER.fullmatch(cell) for cell in self.titles]
        self.names = [head["name"].lower() if head else "" for head in heads]
        self.units = [(head["unit"] or "") if head else "" for head in heads]
        self.rows = rows[1:] if self.headed else rows
        if not self.rows:
            self.stop(self.header_line, "", None, "holds a header and no rows", "add rows of numbers")
        self._refuse_long_rows(first)

    # faults
    def problem(self, line: int | None, key: str, value: str | None, cause: str, cure: str) -> Problem:
        """A problem of a line, or of the file as such."""
        return Problem(str(self.path), line, key, value, cause, cure)

    def add(self, line: int | None, key: str, value: str | None, cause: str, cure: str) -> None:
        """Note a problem and read on; raises SceneError where there are too many."""
        self.problems.append(self.problem(line, key, value, cause, cure))
        if len(self.problems) >= MOST_FAULTS:
            self.raise_if_any()

    def stop(self, line: int | None, key: str, value: str | None, cause: str, cure: str) -> NoReturn:
        """Raise SceneError with this problem after those already found."""
        raise SceneError([*self.problems, self.problem(line, key, value, cause, cure)])

    def raise_if_any(self) -> None:
        """Raise SceneError with what was found, in the order of the file."""
        if self.problems:
            raise SceneError(sorted(self.problems, key=lambda problem: problem.line or 0))

    # the file
    def _read(self, largest: int) -> list[tuple[int, list[str]]]:
        try:
            if not self.path.is_file():
                what = "is a folder, not a file" if self.path.is_dir() else "there is no such file"
                self.stop(None, "", None, what, "check the path: it is relative to the scene's folder")
            if (size := self.path.stat().st_size) > largest:
                cause = f"is {size / 1e6:.0f} MB long, and {largest / 1e6:.0f} MB are the most"
                self.stop(None, "", None, cause, "keep only the rows that are needed")
            data = self.path.read_bytes()
        except (OSError, ValueError) as error:
            cause = f"cannot be read: {getattr(error, 'strerror', None) or error}"
            self.stop(None, "", None, cause, "check the path and its permissions")
        if data.startswith(WORKBOOKS):
            self.stop(
                None, "", None, "is a workbook of a spreadsheet, and no text", "save it as CSV, and name that file"
            )
        text = decode(data, self.path, legacy=True)
        if not text.strip():
            self.stop(None, "", None, "is empty", "write a header and rows of numbers into it")
        lines = [(i, s) for i, s in enumerate(text.splitlines(), 1) if s.strip(" \t;,\x1a") and s.lstrip()[0] != "#"]
        stated = SEPARATOR_LINE.fullmatch(lines[0][1]) if lines else None
        lines = lines[1:] if stated else lines
        if not lines:
            self.stop(None, "", None, "holds only comments", "write a header and rows of numbers into it")
        self._first_lines = lines[:MOST_LINES]
        self.separator = stated[1] if stated else next((mark for mark in "\t;," if mark in lines[0][1]), ",")
        return [(i, self._cells(i, s)) for i, s in lines]

    def _refuse_long_rows(self, first: list[str]) -> None:
        """Refuse a file in which rows fill more cells than the header has: which cell is whose is not known.

        A remark without a title is passed over, where other rows have none.
        """
        width = max(len(first), 1)
        long = [(line, n, row) for line, row in self.rows if len(row) > width and (n := filled(row)) > width]
        if long:
            plain = [row for _, row in self.rows if len(row) <= width][:USUAL_ROWS]
            usual = [usual_kinds(Counter(kind_or_state(_cell(row, i)) for row in plain)) for i in range(width)]
            status = any(not shows_nothing(first_beyond(row, width)) for _, _, row in long)
            long = [one for one in long if not plain or not has_remark(one[2], width, usual, status)]
        if not long:
            self._refuse_two_lines(width)
            return
        self.refuse_title_lines()
        line, number, row = long[0]
        of = "the header has" if self.headed else f"line {self.header_line} has"
        cause = f"fills {number} cells, and {of} {width}"
        if len(long) > 1:
            cause += f"; so do all {len(long)} rows" if len(long) == len(self.rows) else f"; {len(long)} rows do"
        one_more = self.headed and len(long) == len(self.rows) and all(n == width + 1 for _, n, _ in long)
        self.stop(line, "row", self.separator.join(row)[:60], cause, cure_of_long_rows(self.separator, one_more))

    def refuse_title_lines(self) -> None:
        """Refuse a file, of which the header does not fit, where another line looks like it; raises SceneError."""
        below = header_below(self._first_lines) if self.headed else None
        if below is not None:
            line, text = below
            (first, title), *more = [(i, s.strip()) for i, s in self._first_lines if i < line]
            cause = f"is taken as the header, and line {line} looks like one: {text.strip()[:80]}"
            those = f"the lines above line {line}, or begin each of them" if more else f"line {first}, or begin it"
            self.stop(first, "header", title[:60], cause, f"delete {those} with #")

    def _refuse_two_lines(self, width: int) -> None:
        """Refuse a row that two lines may have run into, the second with empty cells at its end.

        It has more cells than most, and a number in a column that has none in those.
        """
        long = [(line, row) for line, row in self.rows if len(row) > width >= filled(row)]
        most = Counter(len(row) for _, row in self.rows).most_common(1)[0][0] if long else 0
        long = [(line, row) for line, row in long if len(row) > most]
        usual = [row for _, row in self.rows if len(row) == most][:USUAL_ROWS] if long else []
        known = {i for row in usual for i, cell in enumerate(row) if kind_or_state(cell) == "number"}
        for line, row in long:
            if any(kind_or_state(cell) == "number" and i not in known for i, cell in enumerate(row)):
                cause = f"has {len(row)} cells, and most rows have {most}: two lines may have run into one"
                cure = "delete that row, or write each of its lines anew"
                self.stop(line, "row", self.separator.join(row)[:60], cause, cure)

    def _cells(self, line: int, text: str) -> list[str]:
        if '"' not in text:
            return [cell.strip() for cell in text.split(self.separator)]
        # Line by line, so that a quote left open spoils one line, and line numbers are the file's.
        try:
            cells = next(csv.reader([text], delimiter=self.separator, skipinitialspace=True))
        except csv.Error as error:
            self.stop(line, "row", text[:40], str(error), "write plain numbers, one cell to a column")
        return [cell.strip() for cell in cells]

    @property
    def lines(self) -> list[int]:
        """Line of the file that each row stands on."""
        return [line for line, _ in self.rows]

    def filled(self) -> list[int]:
        """Columns that have a cell with something in it: separators at the ends of lines make none."""
        return [i for i in range(len(self.names)) if any(_cell(row, i) for _, row in self.rows)]

    def grows(self, place: int) -> bool:
        """Whether a column holds numbers that grow from row to row, of two rows at least."""
        cells = [_cell(row, place) for _, row in self.rows]
        if len(cells) < 2 or not all(_is_number(cell) for cell in cells):
            return False
        return bool(np.all(np.diff([float(cell.replace(",", ".")) for cell in cells]) > 0.0))

    # columns by name
    def index(self, names: Sequence[str], otherwise: int | None = None) -> int:
        """Find the column of one of these names; `otherwise` is used if none has it; raises SceneError."""
        for name in names:
            if name.lower() in self.names:
                return self.names.index(name.lower())
        if otherwise is not None and otherwise < len(self.names):
            return otherwise
        self.refuse_title_lines()
        cure = f"name it in the header; {nearest(names[0], [n for n in self.names if n])}"
        self.stop(self.header_line, names[0], None, f"there is no column '{names[0]}'", cure)

    def titled(self, title: str) -> int | None:
        """Find the one column whose whole title this is, with the unit in brackets: ``Heave (ft)``; else None."""
        meant = _letters(title)
        found = [i for i, one in enumerate(self.titles) if meant and _letters(one) == meant]
        return found[0] if len(found) == 1 else None

    def find(self, names: Mapping[str, tuple[str, ...]]) -> dict[tuple[str, ...], tuple[int, str]]:
        """Column and unit (empty for none) of every meaning, by the words of its header.

        Parameters
        ----------
        names : mapping
            From a header in small letters, its words joined by a space, to what it means.

        Raises
        ------
        SceneError
            If two columns mean the same.
        """
        found: dict[tuple[str, ...], tuple[int, str]] = {}
        for place, (title, bracketed) in enumerate(zip(self.names, self.units, strict=True)):
            name, unit = _name_and_unit(title, bracketed, names)
            if name is None or (name == "t" and unit and not bracketed and not _after_t(self.titles[place], unit)):
                continue
            if names[name] in found:
                cause = f"columns {found[names[name]][0] + 1} and {place + 1} are both this"
                self.stop(self.header_line, title, None, cause, "rename the one that is not meant")
            found[names[name]] = place, unit
        return found

    # numbers
    def factor(
        self,
        column: tuple[int, str],
        name: str,
        wanted: str,
        asked: str | None = None,
        default: str | None = None,
        beside: str = "",
    ) -> float:
        """SI value of a column's unit, which the header gives, or the scene (`asked`), or else `default`.

        What is missing, contradictory or another quantity's is noted. `beside` is how a scene gives a missing unit, in
        the syntax of its key; empty where no scene can.
        """
        written = column[1]
        if written and asked and unit_named(written) != unit_named(asked):
            cause = f"two units: the header says {written}, and the scene says {asked}"
            self.add(self.header_line, name, None, cause, "remove the wrong one")
            return 1.0
        unit = unit_named(written or asked or default or "")
        if not unit and wanted and not (written or asked or default):
            cause = "no unit: degrees and radians would be taken for one another" if wanted == "rad" else "no unit"
            cure = f"write {name} [{_usual(wanted)}] in the header, or with the unit that the numbers are in"
            cure += f", or `{beside}` in the scene" if beside else ""
            self.add(self.header_line, name, None, cause, cure)
            return 1.0
        try:
            found, meant = read_unit(unit), read_unit(wanted or "%")
            cause = f"'{unit}' is not a unit like {wanted}" if found.dimension != meant.dimension else ""
            factor = 1.0 if cause else converted(found, meant).si(Fraction(1))
        except (UnknownUnit, Uncounted) as error:
            cause = f"'{unit}' {error}" if isinstance(error, Uncounted) else str(error)
            if wanted == "N" and isinstance(error, UnknownUnit):
                cause = not_a_force(unit)
        if cause:
            usual = f"write the unit that the numbers are in, such as {name} [{_usual(wanted)}]"
            told = unit_of_force(unit, name) if wanted == "N" else None
            self.add(self.header_line, name, None, *(told or (cause, usual)))
            return 1.0
        return factor

    def numbers(self, place: int, name: str, missing: str = "fill it in, or delete the row") -> np.ndarray:
        """Cells of a column (rows,); nan for no finite number, which is noted. `missing` cures an empty cell."""
        try:
            values = np.array([float(row[place]) for _, row in self.rows])
            if np.isfinite(values).all() and not any("_" in row[place] for _, row in self.rows):
                self._refuse_two_marks(place, name)
                return values
        except (IndexError, ValueError):
            pass
        self._refuse_two_marks(place, name)
        return np.array([self.number(line, name, _cell(row, place), missing) for line, row in self.rows])

    def _refuse_two_marks(self, place: int, name: str) -> None:
        """Refuse a column whose points or commas may mark thousands: others in the table show the other to be decimal.

        So it is also where the other mark is in the same column, and none is shown to be decimal. Where the table shows
        both to be decimal, as with a version `2.1` beside decimal commas, only columns that are read show anything.
        """
        if not self._has_commas:
            return
        self._read_so_far[place] = name
        for place, name in self._read_so_far.items():  # this column may show the mark of one that was read before
            self._refuse_thousands(place, name)

    def _refuse_thousands(self, place: int, name: str) -> None:
        own = [(line, cell) for line, row in self.rows if _mark(cell := _cell(row, place))]
        for mark, other, one, two in ((",", ".", "comma", "point"), (".", ",", "point", "comma")):
            marked = [(line, cell) for line, cell in own if mark in cell]
            if not marked or not all(may_mark_thousands(cell) for _, cell in marked):
                continue
            read = set(self._read_so_far) if next(self._decimals(mark), None) else None
            seen = next((beside for beside in own if other in beside[1]), None) or next(
                self._decimals(other, read), None
            )
            if seen is not None:
                cause = (
                    f"has a {one}, and {seen[1]} in line {seen[0]} has a {two}: one of both may be a mark of thousands"
                )
                self.stop(marked[0][0], name, marked[0][1], cause, "write numbers without marks of thousands")

    @functools.cached_property
    def _has_commas(self) -> bool:
        """Whether commas are within cells: else all marks are points."""
        return self.separator != "," and any("," in cell for _, row in self.rows for cell in row)

    def _decimals(self, mark: str, places: Collection[int] | None = None) -> Iterator[tuple[int, str]]:
        """Lines and numbers, of all columns or of those at some places, that show a mark to be decimal."""
        for line, row in self.rows:
            cells = row if places is None else [_cell(row, i) for i in places]
            yield from ((line, cell) for cell in cells if _mark(cell) == mark and not may_mark_thousands(cell))

    def number(self, line: int, name: str, cell: str, missing: str = "fill it in, or delete the row") -> float:
        """Number in a cell; nan for anything else, which is noted."""
        plain = cell.replace(",", ".") if self.separator != "," and cell.count(",") == 1 else cell
        if not cell:
            self.add(line, name, "", "the cell is empty", missing)
        elif cell.lower().lstrip("+-") in ("nan", "inf", "infinity") or (
            NUMBER.fullmatch(plain) and not math.isfinite(float(plain))
        ):
            self.add(line, name, cell[:40], "is not a finite number", "give the value, or delete the row")
        elif not NUMBER.fullmatch(plain):
            plainly = "is not a number", "write plain numbers, without units or thousands' marks"
            self.add(line, name, cell[:40], *(other_minus(cell) or plainly))
        else:
            return float(plain)
        return math.nan

    def in_order(self, place: int, values: Sequence[float]) -> None:
        """Refuse rows whose values of a column do not grow from row to row; raises SceneError with all of them."""
        latest = 0
        for i in range(1, len(values)):
            if values[i] > values[latest]:
                latest = i
                continue
            (line, row), (other, before) = self.rows[i], self.rows[latest]
            same = values[i] == values[latest]
            cause = f"is the same as in line {other}" if same else f"is less than {before[place]} in line {other}"
            cure = f"keep one of lines {other} and {line}" if same else f"sort the rows{thousand(row[place])}"
            self.add(line, self.names[place] or f"column {place + 1}", row[place], cause, cure)
        self.raise_if_any()

    def values(self, place: int, unit: str) -> tuple[float, ...]:
        """A column in SI, `unit` where the header has none; raises SceneError for what is wrong with it."""
        name = self.names[place] or f"column {place + 1}"
        factor = self.factor((place, self.units[place]), name, unit, default=unit or "m/m")
        values = self.numbers(place, name)
        self.raise_if_any()
        if factor != 1.0:
            values = values * factor
        if values.size and abs(largest := values[np.abs(values).argmax()]) > LARGEST:
            line, row = self.rows[int(np.flatnonzero(values == largest)[0])]
            self.stop(line, name, row[place], *OUTSIDE)
        return tuple(float(value) for value in values)


def may_mark_thousands(cell: str) -> bool:
    """Whether the mark of a number may stand for thousands: ``1,001``, but neither ``0,500`` nor ``10,25``."""
    return THOUSAND.fullmatch(cell) is not None


def _mark(cell: str) -> str:
    """The one point or comma of a number; empty where there is none."""
    marks = [one for one in cell if one in ".,"]
    return marks[0] if len(marks) == 1 and NUMBER.fullmatch(cell.replace(",", ".")) else ""


def thousand(cell: str) -> str:
    """What to ask of a number that is smaller than it should be: ``1.000`` may be meant as 1000; else nothing."""
    if not THOUSANDS.fullmatch(cell):
        return ""
    mark, name = (",", "comma") if "," in cell else (".", "point")
    return f", or is the {name} a mark of thousands? Then write {cell.replace(mark, '')} without it"


def _usual(unit: str) -> str:
    """A unit in which sheets have what is computed in an SI unit: kN for N, deg/m for rad/m."""
    return "kN" if unit == "N" else unit.replace("rad", "deg") if unit.startswith("rad") else unit


def _letters(title: str) -> str:
    """A title without blanks at its brackets, and in small letters; of units the letters stay as they are."""
    match = HEADER.fullmatch(title)
    return f"{match['name'].lower()} [{match['unit'] or ''}]" if match else title.strip().lower()


def _cell(row: list[str], place: int) -> str:
    return row[place] if place < len(row) else ""


def unit_named(text: str) -> str:
    """A unit as the table of units writes it: ``Degrees`` -> ``deg``."""
    plain = text.strip()
    return WORDS.get(plain.lower(), plain)


def is_unit(text: str, like: str, known: Callable[[str], bool] = TABLE.__contains__) -> bool:
    """Whether a word is a unit of the same dimension as another; no library is asked."""
    name = unit_named(text.lower())
    return (known(name) or name == "gon") and read_unit(name).dimension == read_unit(like).dimension


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _after_t(title: str, unit: str) -> bool:
    """Whether `t` with a unit behind it is a time: T_min is a least tension, T_h a horizontal one, T_s a period."""
    return title.startswith("t") and unit in LETTER_UNITS


def _name_and_unit(title: str, bracketed: str, names: Mapping[str, object]) -> tuple[str | None, str]:
    """Name and unit of a header: ``roll [deg]``, ``roll_deg``, ``roll deg``, ``RollDeg``; None if it is unknown."""
    words = re.sub(r"[\s_.]+", " ", title).strip()
    if words in names:
        return words, bracketed
    for name in sorted(names, key=len, reverse=True):
        rest = words.removeprefix(name)
        unit = rest.strip()
        spaced = rest.startswith(" ") and all(part in TABLE or part == "hz" for part in unit.split("/"))
        if words.startswith(name) and not bracketed and (spaced or unit in ("deg", "rad")):
            return name, unit
    return None, ""
