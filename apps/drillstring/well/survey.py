"""Directional surveys from CSV files: stations of measured depth, inclination and azimuth.

What the file may look like: comma, semicolon or tab between the cells, decimal commas where the comma is not the
delimiter; one header line; units in the header (`md [ft]`, `inc (deg)`, `md_m`, `IncDeg`), in a row of their own
below it, or given by the scene; lines that start with #, blank lines and further columns are passed over. What it may
not hold is refused by line of the file, all of it at once.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np

from drillstring.well.sections import direction, dogleg
from drillstring.well.wellbore import LARGEST_DOGLEG
from tautline.scene.errors import Problem, SceneError

MAX_GAP = 500.0
"""Longest hole [m] without a station, unless the scene says otherwise: a stand is 30 m, a forgotten page 1000 m."""

MAX_DOGLEG_SEVERITY = math.radians(60.0) / 30.0
"""Sharpest turn [rad/m] taken for a hole rather than a slip of the pen; short-radius wells reach about half."""

LARGEST_FILE = 10_000_000
"""Bytes; a survey of ten thousand stations has half a million."""

TEXT_CONTROLS = b"\t\n\v\f\r\x1a"
"""Control characters that text files do hold; the last is the end mark of old DOS files."""

PROBLEMS_KEPT = 1000
"""Problems collected before the reader gives up on a file; SceneError prints the first of them."""

LENGTHS = {
    "m": 1.0, "meter": 1.0, "meters": 1.0, "metre": 1.0, "metres": 1.0,
    "ft": 0.3048, "feet": 0.3048, "foot": 0.3048, "ftkb": 0.3048, "mkb": 1.0, "km": 1000.0,
    "usft": 1200.0 / 3937.0, "us ft": 1200.0 / 3937.0, "ftus": 1200.0 / 3937.0, "survey ft": 1200.0 / 3937.0,
}  # fmt: skip
"""Units of length in metres; the US survey foot is what some planning software exports, `ftkb` counts feet from the
kelly bushing."""

ANGLES = {
    "deg": math.pi / 180.0, "degs": math.pi / 180.0, "degree": math.pi / 180.0, "degrees": math.pi / 180.0,
    "°": math.pi / 180.0, "dega": math.pi / 180.0, "rad": 1.0, "radian": 1.0, "radians": 1.0,
    "gon": math.pi / 200.0, "grad": math.pi / 200.0,
}  # fmt: skip
"""Units of angle in radians."""

UNITS = {"md": LENGTHS, "inc": ANGLES, "azi": ANGLES}

NAMES = {
    "md": ("measured depth", "meas depth", "depth", "md"),
    "inc": ("inclination", "incl", "inc"),
    "azi": ("azimuth", "azim", "azi", "azm"),
}
"""Headers read as each column, longest first, in small letters."""

NORTH = r"(?:\s?[\[(]?(?:true|grid|tn|gn)\b(?: north)?[\])]?)?"
"""Which north an azimuth counts from, as some headers say; all of a survey counts from the same one."""

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class Survey:
    """Stations of a survey, in SI units and sorted by depth.

    Attributes
    ----------
    md : (n,) array
        Measured depth [m].
    inc, azi : (n,) arrays
        Inclination from the downward vertical and azimuth clockwise from north [rad]; azimuth from 0 to 2 pi.
    lines : (n,) int array
        Line of the file that each station stands on.
    """

    md: np.ndarray
    inc: np.ndarray
    azi: np.ndarray
    lines: np.ndarray


class _Row(NamedTuple):
    line: int
    cells: list[str]


class _Column(NamedTuple):
    place: int  # among the cells
    unit: str | None  # as the header has it
    title: str


class _Ledger:
    """The problems found in one file."""

    def __init__(self, path: Path):
        self.file = str(path)
        self.problems: list[Problem] = []

    def add(self, line: int | None, key: str, value: str | None, cause: str, cure: str) -> None:
        """Note a problem and read on."""
        self.problems.append(Problem(self.file, line, key, value, cause, cure))
        if len(self.problems) >= PROBLEMS_KEPT:
            self.raise_if_any()

    def stop(self, line: int | None, key: str, value: str | None, cause: str, cure: str) -> NoReturn:
        """Raise with this problem after those already found."""
        self.problems.append(Problem(self.file, line, key, value, cause, cure))
        raise SceneError(self.problems)

    def raise_if_any(self) -> None:
        """Raise SceneError with the problems in the order of the file."""
        if self.problems:
            raise SceneError(sorted(self.problems, key=lambda problem: problem.line or 0))


def read_survey(
    path: str | Path,
    units: Mapping[str, str] | None = None,
    max_gap: float = MAX_GAP,
    max_dogleg_severity: float = MAX_DOGLEG_SEVERITY,
) -> Survey:
    """Read and check a survey.

    Parameters
    ----------
    path : str or Path
        CSV file with a header; UTF-8, or Windows-1252 if it is not that.
    units : mapping, optional
        Units of the columns `md`, `inc`, `azi`, where the file does not tell (`{"md": "ft", "inc": "deg"}`). They may
        not contradict the file.
    max_gap : float
        Longest interval without a station [m], the one above the first station included.
    max_dogleg_severity : float
        Sharpest turn between two stations [rad/m].

    Returns
    -------
    Survey

    Raises
    ------
    tautline.scene.errors.SceneError
        With a Problem for each row at fault: cells that are missing or no numbers, depths that are
        negative, repeated or out of order, angles out of range, gaps, impossible doglegs; or for the file as such:
        not there, empty, binary, too large, without the columns or their units, fewer than two stations.
    """
    path = Path(path)
    ledger = _Ledger(path)
    lines = _lines(path, ledger)
    rows, delimiter = _rows(lines, ledger)
    columns = _columns(rows[0], ledger)
    width, body = len(rows[0].cells), rows[1:]
    row_units = _row_of_units(body[0], columns) if body else {}
    body = body[1:] if row_units else body
    factors = _factors(columns, row_units, units or {}, rows[0].line, ledger)
    stations = []
    for row in body:
        station = _station(row, columns, factors, width, delimiter, ledger)
        if station is not None:
            stations.append((row, station))
    stations = _in_order(stations, columns, ledger)
    ledger.raise_if_any()
    if len(stations) < 2:
        ledger.stop(None, "", None, "a survey needs two stations at least", "add those that are missing")
    md, inc, azi = np.array([station for _, station in stations]).T
    survey = Survey(md.copy(), inc.copy(), np.mod(azi, 2.0 * np.pi), np.array([row.line for row, _ in stations]))
    _check_intervals(survey, max_gap, max_dogleg_severity, ledger)
    ledger.raise_if_any()
    return survey


def _lines(path: Path, ledger: _Ledger) -> list[str]:
    """Lines of a text file of sensible size."""
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            ledger.stop(None, "", None, f"{size} bytes are too much for a survey (10 MB)", "keep only the stations")
        data = path.read_bytes()
    except OSError as error:
        ledger.stop(None, "", None, (error.strerror or "cannot be read").lower(), "check the path")
    if not data.strip():
        ledger.stop(None, "", None, "the file is empty", "write a header and the stations into it")
    if b"\0" in data or any(byte < 32 and byte not in TEXT_CONTROLS for byte in data[:4096]):
        ledger.stop(None, "", None, "the file is binary or UTF-16, not text", "export it as CSV in UTF-8")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    return re.split(r"\r\n|\n|\r", text)


def _rows(lines: list[str], ledger: _Ledger) -> tuple[list[_Row], str]:
    """Cells of every line that holds any, and the delimiter, which is the header's."""
    kept = [(i, line) for i, line in enumerate(lines, start=1) if line.strip(" \t;,\x1a") and line.lstrip()[0] != "#"]
    if not kept:
        ledger.stop(None, "", None, "the file holds only comments", "write a header and the stations into it")
    header = kept[0][1]
    delimiter = next((mark for mark in "\t;" if mark in header), ",")
    rows = []
    for number, line in kept:
        # Line by line, so that a quote left open spoils one line, and line numbers are the file's.
        try:
            cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
        except csv.Error as error:
            ledger.stop(number, "row", line[:40], str(error), "write plain numbers, one cell to a column")
        rows.append(_Row(number, [cell.strip() for cell in cells]))
    return rows, delimiter


def _columns(header: _Row, ledger: _Ledger) -> dict[str, _Column]:
    """Where md, inc and azi stand, by the header."""
    columns: dict[str, _Column] = {}
    for place, title in enumerate(header.cells):
        named = _named(title)
        if named is None:
            continue
        key, unit = named
        if key in columns:
            ledger.stop(
                header.line, key, title, f"the header has two such columns, the other is '{columns[key].title}'",
                "rename the one that is not meant",
            )  # fmt: skip
        columns[key] = _Column(place, unit, title)
    missing = [key for key in NAMES if key not in columns]
    if missing:
        numbers = all(NUMBER.fullmatch(cell.replace(",", ".")) for cell in header.cells if cell)
        cause = "the first line holds numbers where the names should be" if numbers else "no such column in the header"
        cure = "write a header such as: md [m], inc [deg], azi [deg]; comma, semicolon or tab between the names"
        ledger.stop(header.line, ", ".join(missing), " | ".join(header.cells)[:80], cause, cure)
    return columns


def _named(title: str) -> tuple[str, str | None] | None:
    """Column and unit of a header cell; None if it is another column."""
    plain = re.sub(r"[\s_.]+", " ", title.strip().lower()).strip()
    for key, names in NAMES.items():
        for name in names:
            if plain.replace(" ", "").startswith(name.replace(" ", "")):
                break
        else:
            continue
        north = NORTH if key == "azi" else ""
        rest = re.fullmatch(r"\s?".join(name.split()) + north + r"\s?(?:[\[(]\s*(.*?)\s*[\])]|(.*))", plain)
        if rest is None:
            return None
        if rest[1] is not None:
            return key, rest[1]
        unit = rest[2].strip(" ,-:/")
        if unit and unit not in UNITS[key]:
            return None  # "depth error", "inclinometer": columns of another kind
        return key, unit or None
    return None


def _row_of_units(row: _Row, columns: dict[str, _Column]) -> dict[str, str]:
    """Units of a second row that holds them; empty if it is a row of numbers."""
    cells = {key: row.cells[c.place].strip(" []()").lower() for key, c in columns.items() if c.place < len(row.cells)}
    if not any(cells[key] in UNITS[key] for key in cells):
        return {}
    return {key: cell for key, cell in cells.items() if cell}


def _factors(columns, row_units, scene_units: Mapping[str, str], line: int, ledger: _Ledger) -> dict[str, float]:
    """SI value of each column's unit."""
    factors = {}
    for key in sorted(set(scene_units) - set(UNITS)):
        ledger.add(None, f"units.{key}", scene_units[key], "no such column", "give units of md, inc and azi")
    for key, known in UNITS.items():
        given = {
            "the header": columns[key].unit,
            "the row of units": row_units.get(key),
            "the scene": scene_units.get(key),
        }
        given = {where: unit.strip().lower() for where, unit in given.items() if unit}
        if not given:
            example = "md [m]" if known is LENGTHS else f"{key} [deg]"
            cure = f"write {example} in the header, or `{key}: {example.split()[1][1:-1]}` beside `file:` in the scene"
            ledger.add(line, key, columns[key].title, "no unit", cure)
            continue
        for where, unit in given.items():
            if unit not in known:
                kind, choice = ("length", "m, km or ft") if known is LENGTHS else ("angle", "deg, rad or gon")
                ledger.add(line, key, unit, f"not a unit of {kind} (in {where})", f"use {choice}")
        values = {where: known[unit] for where, unit in given.items() if unit in known}
        if len(set(values.values())) > 1:
            said = ", ".join(f"{where} says {given[where]}" for where in values)
            ledger.add(line, key, columns[key].title, f"two units: {said}", "keep the right one")
        factors[key] = next(iter(values.values()), 1.0)
    ledger.raise_if_any()
    return factors


def _station(row: _Row, columns, factors, width: int, delimiter: str, ledger: _Ledger):
    """(md, inc, azi) in SI of one row, or None after noting what is wrong with it."""
    if any(row.cells[width:]):
        ledger.add(
            row.line, "row", delimiter.join(row.cells)[:60], f"{len(row.cells)} cells under {width} names",
            "put semicolons between the cells if the comma is the decimal mark, else remove what is too much",
        )  # fmt: skip
        return None
    values = {}
    for key, column in columns.items():
        cell = row.cells[column.place] if column.place < len(row.cells) else ""
        value = _number(row.line, key, cell, delimiter, ledger)
        if value is not None and _in_range(row.line, key, cell, value * factors[key], ledger):
            values[key] = value * factors[key]
    return tuple(values[key] for key in NAMES) if len(values) == 3 else None


def _number(line: int, key: str, cell: str, delimiter: str, ledger: _Ledger) -> float | None:
    """Finite number in a cell."""
    plain = cell.replace(",", ".") if delimiter != "," and cell.count(",") == 1 else cell
    if not cell:
        cure = "give any azimuth where the hole is vertical" if key == "azi" else "fill it in, or delete the row"
        ledger.add(line, key, "", "the cell is missing", cure)
    elif cell.lower().lstrip("+-") in ("nan", "inf", "infinity"):
        ledger.add(line, key, cell, "not a finite number", "give the measured value, or delete the row")
    elif not NUMBER.fullmatch(plain):
        ledger.add(line, key, cell[:40], "not a number", "write plain numbers, without units or thousands' marks")
    elif not math.isfinite(float(plain)):
        ledger.add(line, key, cell[:40], "not a finite number", "give the measured value, or delete the row")
    else:
        return float(plain)
    return None


def _in_range(line: int, key: str, cell: str, value: float, ledger: _Ledger) -> bool:
    """Whether a value [m or rad] can be what its column says."""
    if key == "md":
        if value >= 0.0:
            return True
        ledger.add(line, key, cell, "negative", "measure depth downwards from the rotary table")
        return False
    low, high = (0.0, 180.0) if key == "inc" else (-360.0, 720.0)
    if low - 1e-9 <= math.degrees(value) <= high + 1e-9:
        return True
    ledger.add(line, key, cell, f"outside {low:g} to {high:g} deg", "check the column and its unit")
    return False


def _in_order(stations: list, columns, ledger: _Ledger) -> list:
    """Stations whose depth lies below all before; the others are noted."""
    kept: list = []
    lines: dict[float, _Row] = {}
    for row, station in stations:
        md, cell = station[0], row.cells[columns["md"].place]
        if md in lines:
            first = lines[md]
            same = first.cells == row.cells
            cause = f"{'the same row' if same else 'the same depth'} as line {first.line}"
            ledger.add(row.line, "md", cell, cause, f"keep one of lines {first.line} and {row.line}")
        elif kept and md < kept[-1][1][0]:
            ledger.add(row.line, "md", cell, f"above the station of line {kept[-1][0].line}", "sort the rows by depth")
        else:
            kept.append((row, station))
        lines.setdefault(md, row)
    return kept


def _check_intervals(survey: Survey, max_gap: float, max_severity: float, ledger: _Ledger) -> None:
    """Note gaps and doglegs that no hole has."""
    cure = "add a station in between, or raise max_gap if the hole is known to be smooth there"
    above = np.concatenate([[0.0], survey.md[:-1]])
    for i in np.flatnonzero(survey.md - above > max_gap * (1.0 + 1e-9)):
        cause = f"no station in the {survey.md[i] - above[i]:.6g} m above it (max_gap is {max_gap:g} m)"
        ledger.add(int(survey.lines[i]), "md", f"{survey.md[i]:.6g} m", cause, cure)
    tangents = direction(survey.inc, survey.azi)
    bend = dogleg(tangents[:-1], tangents[1:])
    severity = bend / np.diff(survey.md)
    for i in np.flatnonzero((severity > max_severity) | (bend > LARGEST_DOGLEG)) + 1:
        cause = (
            f"the hole turns {math.degrees(bend[i - 1]):.4g} deg in {survey.md[i] - survey.md[i - 1]:.4g} m below line "
            f"{survey.lines[i - 1]}, more than {math.degrees(30.0 * max_severity):.4g} deg in 30 m"
        )
        value = f"{math.degrees(survey.inc[i]):.6g} deg, {math.degrees(survey.azi[i]):.6g} deg"
        if severity[i - 1] <= max_severity:
            cause = f"the hole turns right round below line {survey.lines[i - 1]}: its plane is not known"
        ledger.add(int(survey.lines[i]), "inc, azi", value, cause, "correct the angles, or add the stations in between")
