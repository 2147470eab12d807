"""Directional surveys from CSV files: stations of measured depth, inclination and azimuth.

What the file may look like: comma, semicolon or tab between the cells, decimal commas where the comma is not the
delimiter; one header line; units in the header (`md [ft]`, `inc (deg)`, `md_m`, `IncDeg`), in a row of their own
below it, or given by the scene; lines that start with #, blank lines and further columns are passed over. What it may
not hold is refused by line of the file, all of it at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drillstring.well.sections import direction, dogleg
from drillstring.well.wellbore import LARGEST_DOGLEG
from tautline.scene.reading.columns import Columns, is_unit, may_mark_thousands, thousand, unit_named
from tautline.scene.values.ranges import RANGES

MAX_GAP = 500.0
"""Longest hole [m] without a station, unless the scene says otherwise: a stand is 30 m, a forgotten page 1000 m."""

SAME_DIRECTION = math.radians(0.1)
"""Angle [rad] between two stations below which the hole between them is straight: what survey tools resolve."""

MAX_DOGLEG_SEVERITY = RANGES["dogleg severity"].high or math.inf
"""Sharpest turn [rad/m] taken for a hole rather than a slip of the pen, a radius of 2 m: short-radius wells have 6 to
12 m."""

LARGEST_FILE = 10_000_000
"""Bytes; a survey of ten thousand stations has half a million."""

LIKE = {"md": "m", "inc": "rad", "azi": "rad"}
"""SI unit of each column."""

EXAMPLES = {"md": "m", "inc": "deg", "azi": "deg"}
"""Unit that each column mostly has, for messages."""

NAMES = {
    "md": ("measured depth", "meas depth", "depth", "md"),
    "inc": ("inclination", "incl", "inc"),
    "azi": ("azimuth", "azim", "azi", "azm"),
}
"""Headers read as each column, longest first, in small letters."""

NORTH = r"(?:\s?[\[(]?(?:true|grid|tn|gn)\b(?: north)?[\])]?)?"
"""Which north an azimuth counts from, as some headers say; all of a survey counts from the same one."""


class _Unlike(NamedTuple):
    """Headers of a quantity that is like one of a survey and is not it, why, and what to do."""

    titles: re.Pattern[str]
    cause: str
    cure: str


UNLIKE = {
    "md": (
        _Unlike(
            re.compile(r"\btvd|vertical.*depth|depth.*vertical", re.IGNORECASE),
            "vertical depths: stations stand at measured depths, along the hole",
            "give a column of measured depths, and name it md [m]",
        ),
    ),
    "azi": (
        _Unlike(
            # Those that are corrected are told what they lack, and not to be corrected again.
            re.compile(r"(?=.*az[im])(?=.*mag(?:n|[^a-z]|$))(?!.*(?<!un)corr)", re.IGNORECASE),
            "azimuths from magnetic north: those of a hole count from true or grid north",
            "correct them for the declination, and for grid north for the convergence; then name the column azi [deg]",
        ),
        _Unlike(
            # Not any south: it may be in the name of a field or of a grid, and the cure turns the hole right round.
            re.compile(
                r"(?=.*az[im])"
                r"(?=.*(?:from (?:the )?south|south[ _-]?az|[\[(]\s*south\s*[\])]|(?:deg|°),? south\s*(?:[\])]|$)))",
                re.IGNORECASE,
            ),
            "azimuths from south: those of a hole count from north",
            "add 180 deg to them; then name the column azi [deg]",
        ),
    ),
}
"""Of each column, wherever the header says it: as a word of its own, or in the brackets of the unit."""

RELATED = {
    "md": re.compile(r"depth|(?<![a-z])md", re.IGNORECASE),
    "azi": re.compile(r"az[im]", re.IGNORECASE),
}
"""Headers that may hold a column under a title that is not read."""


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


class _Column(NamedTuple):
    place: int  # among the cells
    unit: str  # as the header has it
    title: str


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
    table = Columns(path, LARGEST_FILE, headed=True)
    columns = _columns(table)
    below = _row_of_units(table, columns)
    factors = _factors(table, columns, below, units or {})
    table.raise_if_any()
    values = {}
    for key, column in columns.items():
        cure = "give any azimuth where the hole is vertical" if key == "azi" else "fill it in, or delete the row"
        values[key] = factors[key] * table.numbers(column.place, key, cure)
        _check_range(table, key, column, values[key])
    stations = np.array([values[key] for key in NAMES]).T.reshape(-1, len(NAMES))
    sound = np.flatnonzero(np.isfinite(stations).all(axis=1))
    kept = _in_order(table, columns["md"].place, stations[:, 0], sound)
    table.raise_if_any()
    if len(kept) < 2:
        table.stop(None, "", None, "a survey needs two stations at least", "add those that are missing")
    md, inc, azi = stations[kept].T
    survey = Survey(md.copy(), inc.copy(), np.mod(azi, 2.0 * np.pi), np.array(table.lines)[kept])
    written = {key: below.get(key) or column.unit or (units or {}).get(key, "") for key, column in columns.items()}
    columns = {key: column._replace(unit=unit_named(written[key])) for key, column in columns.items()}
    _check_intervals(survey, max_gap, max_dogleg_severity, table, columns, factors["md"])
    table.raise_if_any()
    return survey


def _columns(table: Columns) -> dict[str, _Column]:
    """Where md, inc and azi stand, by the header."""
    columns: dict[str, _Column] = {}
    for place, title in enumerate(table.titles):
        named = _survey_column(title)
        if named is None:
            continue
        key, unit = named
        if key in columns:
            cause = f"the header has two such columns, the other is '{columns[key].title}'"
            table.stop(table.header_line, key, title, cause, "rename the one that is not meant")
        columns[key] = _Column(place, unit or "", title)
    missing = [key for key in NAMES if key not in columns]
    for key in missing:
        found = [(title, unlike) for title in table.titles if (unlike := _unlike(key, title))]
        # Beside another that may be the one that is meant, a column that is like it is not to blame.
        if found and not any(RELATED[key].search(title) and not _unlike(key, title) for title in table.titles):
            title, unlike = found[0]
            table.stop(table.header_line, key, title, unlike.cause, unlike.cure)
    if missing:
        table.refuse_title_lines()
        cure = "write a header such as: md [m], inc [deg], azi [deg]; comma, semicolon or tab between the names"
        text = " | ".join(table.titles)[:80]
        table.stop(table.header_line, ", ".join(missing), text, "no such column in the header", cure)
    return columns


def _unlike(key: str, title: str) -> _Unlike | None:
    """What a header cell holds in place of a column that it is like; None if it is not."""
    return next((unlike for unlike in UNLIKE.get(key, ()) if unlike.titles.search(title)), None)


def _survey_column(title: str) -> tuple[str, str | None] | None:
    """Column and unit of a header cell; None if it is another column."""
    plain = re.sub(r"[\s_.]+", " ", title.strip().lower()).strip()
    for key, names in NAMES.items():
        for name in names:
            if plain.replace(" ", "").startswith(name.replace(" ", "")):
                break
        else:
            continue
        if _unlike(key, title):
            return None
        north = NORTH if key == "azi" else ""
        rest = re.fullmatch(r"\s?".join(name.split()) + north + r"\s?(?:[\[(]\s*(.*?)\s*[\])]|(.*))", plain)
        if rest is None:
            return None
        if rest[1] is not None:
            return key, rest[1]
        unit = rest[2].strip(" ,-:/")
        if unit and not is_unit(unit, LIKE[key]):
            return None  # "depth error", "inclinometer": columns of another kind
        return key, unit or None
    return None


def _row_of_units(table: Columns, columns: dict[str, _Column]) -> dict[str, str]:
    """Units of a first row that holds them, which is taken off; empty if it is a row of numbers."""
    row = table.rows[0][1] if table.rows else []
    cells = {key: row[c.place].strip(" []()").lower() for key, c in columns.items() if c.place < len(row)}
    if not any(is_unit(cell, LIKE[key]) for key, cell in cells.items() if cell):
        return {}
    table.rows = table.rows[1:]
    return {key: cell for key, cell in cells.items() if cell}


def _factors(
    table: Columns, columns: dict[str, _Column], row_units: dict[str, str], asked: Mapping[str, str]
) -> dict[str, float]:
    """SI value of each column's unit; the header, the row of units and the scene may not contradict each other."""
    for key in sorted(set(asked) - set(NAMES)):
        table.add(None, f"units.{key}", asked[key], "no such column", "give units of md, inc and azi")
    named = {key: row_units.get(key, "") or column.unit for key, column in columns.items()}
    given = {key: asked.get(key) or EXAMPLES[key] for key in NAMES if not named.get(key)}
    units = ", ".join(f"{key}: {unit}" for key, unit in given.items())
    beside = f"survey: {{file: {table.path.name}, {units}}}"
    factors = {}
    for key, column in columns.items():
        header, below = column.unit, row_units.get(key, "")
        if unlike := _unlike(key, f"{column.title} {below}"):
            table.stop(table.header_line, key, f"{column.title} {below}", unlike.cause, unlike.cure)
        if header and below and table.factor((0, header), key, LIKE[key]) != table.factor((0, below), key, LIKE[key]):
            cause = f"two units: the header says {header}, the row of units says {below}"
            table.add(table.header_line, key, column.title, cause, "keep the right one")
        if LIKE[key] == "rad" and re.fullmatch(r"d[\W_]*m[\W_]*s|dd?[:.]mm[:.]ss", (header or below).strip().lower()):
            cause = "degrees, minutes and seconds are not read"
            table.add(table.header_line, key, column.title, cause, f"write decimal degrees: {key} [deg]")
            factors[key] = 1.0
            continue
        factors[key] = table.factor((column.place, header or below), key, LIKE[key], asked.get(key), beside=beside)
    return factors


def _check_range(table: Columns, key: str, column: _Column, values: np.ndarray) -> None:
    """Note values (m or rad) that cannot be what their column says; they become nan."""
    if key == "md":
        wrong, cause, cure = values < 0.0, "negative", "measure depth downwards from the rotary table"
    else:
        low, high = (0.0, 180.0) if key == "inc" else (-360.0, 720.0)
        degrees = np.degrees(values)
        wrong = (degrees < low - 1e-9) | (degrees > high + 1e-9)
        cause, cure = f"outside {low:g} to {high:g} deg", "check the column and its unit"
    for i in np.flatnonzero(wrong):
        line, row = table.rows[i]
        table.add(line, key, row[column.place], cause, cure)
    values[wrong] = np.nan


def _in_order(table: Columns, place: int, md: np.ndarray, sound: np.ndarray) -> list[int]:
    """Those of the sound rows whose depth lies below all before; the others are noted."""
    kept: list[int] = []
    first: dict[float, int] = {}
    for i in sound:
        (line, row), depth = table.rows[i], float(md[i])
        if depth in first:
            other, cells = table.rows[first[depth]]
            cause = f"{'the same row' if cells == row else 'the same depth'} as line {other}"
            table.add(line, "md", row[place], cause, f"keep one of lines {other} and {line}")
        elif kept and depth < md[kept[-1]]:
            above = table.rows[kept[-1]][0]
            cure = f"sort the rows by depth{thousand(row[place])}"
            table.add(line, "md", row[place], f"above the station of line {above}", cure)
        else:
            kept.append(int(i))
        first.setdefault(depth, int(i))
    return kept


def _check_intervals(
    survey: Survey,
    max_gap: float,
    max_severity: float,
    table: Columns,
    columns: dict[str, _Column],
    size: float,
) -> None:
    """Note gaps and doglegs that no hole has, in the words of the file; ``size`` is its unit of depth, m."""
    rows = dict(table.rows)

    def cell(line: int, key: str) -> str:
        return f"{rows[line][columns[key].place]} {columns[key].unit}"

    def told(length: float) -> str:
        return f"{length / size:.6g} {columns['md'].unit}"

    cure = "add a station in between, or raise max_gap if the hole is known to be smooth there"
    above = np.concatenate([[0.0], survey.md[:-1]])
    tangents = direction(survey.inc, survey.azi)
    # Between equal directions the hole is taken as straight: there nothing is lost. At the table it is vertical.
    turned = dogleg(np.vstack([[[0.0, 0.0, 1.0]], tangents[:-1]]), tangents) > SAME_DIRECTION
    for i in np.flatnonzero((survey.md - above > max_gap * (1.0 + 1e-9)) & turned):
        line = int(survey.lines[i])
        cause = (
            f"no station in the {told(survey.md[i] - above[i])} above it, in which the hole turns (max_gap is "
            f"{told(max_gap)})"
        )
        table.add(line, "md", cell(line, "md"), cause, cure)
    _check_doglegs(survey, tangents, max_gap, max_severity, table, columns, size)


def _check_doglegs(
    survey: Survey,
    tangents: np.ndarray,
    max_gap: float,
    max_severity: float,
    table: Columns,
    columns: dict[str, _Column],
    size: float,
) -> None:
    """Note doglegs that no hole has: of the angles, or of depths whose marks of thousands were read as decimal."""
    rows = dict(table.rows)
    bend, length = dogleg(tangents[:-1], tangents[1:]), np.diff(survey.md)
    marked = _may_have_thousands([row[columns["md"].place] for row in rows.values()])
    # Without marks of thousands the hole is as many times as long, and what turns must have stations there, too.
    marked = marked and bool((1000.0 * length[bend > SAME_DIRECTION] <= max_gap * (1.0 + 1e-9)).all())
    severity = bend / length
    for i in np.flatnonzero((severity > max_severity) | (bend > LARGEST_DOGLEG)):
        line, above = int(survey.lines[i + 1]), survey.lines[i]
        depth, *angles = (f"{rows[line][columns[key].place]} {columns[key].unit}" for key in NAMES)
        key, value = "inc, azi", ", ".join(angles)
        cure = "correct the angles or the depths, or add the stations in between"
        if severity[i] <= max_severity:
            cause = f"the hole turns right round below line {above}: its plane is not known"
            cure = "correct the angles, or add the stations in between"
        else:
            over = f"{length[i] / size:.6g} {columns['md'].unit}"
            cause = f"the hole turns {math.degrees(bend[i]):.4g} deg in {over} below line {above}, more than "
            cause += f"{math.degrees(30.0 * max_severity):.4g} deg in 30 m"
            if marked:
                key, value = "md", depth
                cure = f"correct the depths or the angles{thousand(rows[line][columns['md'].place])}"
        table.add(line, key, value, cause, cure)


def _may_have_thousands(depths: Sequence[str]) -> bool:
    """Whether all points and commas of a column may be marks of thousands, and there are some."""
    marked = [cell for cell in depths if "." in cell or "," in cell]
    return bool(marked) and all(map(may_mark_thousands, marked))
