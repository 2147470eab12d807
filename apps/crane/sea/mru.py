"""A vessel's motion from the CSV file of a motion reference unit, checked row by row.

Columns are t (or time), surge, sway, heave, roll, pitch and yaw, in any order and among others. Units stand in the
header, ``roll [deg]``, ``roll (deg)`` or ``roll_deg``, or beside the file in the scene. Without one, time is in s and
surge, sway and heave are in m; angles have no default, because degrees read as radians look like a heavy sea.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from pydantic_core import PydanticCustomError
from scipy.interpolate import CubicSpline

from crane.sea.frames import MOTIONS
from tautline.scene.errors import Problem, SceneError
from tautline.scene.functions import Constant
from tautline.scene.reading.columns import Columns
from tautline.scene.refusal import nearest
from tautline.scene.values.units import TABLE, UnknownUnit, read_unit
from tautline.system.time_functions import Samples

UNITS = {"t": "s", "surge": "m", "sway": "m", "heave": "m", "roll": "rad", "pitch": "rad", "yaw": "rad"}
ANGLES = MOTIONS[3:]
ALIASES = {"time": "t"}
LARGEST = {
    "surge": 1000.0, "sway": 1000.0, "heave": 30.0,
    "roll": 0.5 * math.pi, "pitch": 0.5 * math.pi, "yaw": 2.0 * math.pi,
}  # fmt: skip
"""What no vessel does, m and rad: the unit must be another."""
ANGLE_WORDS = {word: "deg" for word in ("deg", "degs", "degree", "degrees")}
ANGLE_WORDS |= {word: "rad" for word in ("rad", "rads", "radian", "radians")}
"""Ways to write the units of an angle, in small letters."""
FEWEST_ROWS = 4
LONGEST_GAP = 3.0
"""Median intervals that may pass without a row, where the scene does not say."""
PIECES_PER_ENVELOPE = 200


@dataclass(frozen=True, eq=False)
class Record:
    """Rows of a file in SI: `time` (n,) s, `motions` (6, n) m and rad, and the line (n,) each stands on."""

    path: Path
    time: np.ndarray
    motions: np.ndarray
    lines: np.ndarray

    def problem(self, row: int | None, key: str, value: str | None, cause: str, cure: str) -> Problem:
        """A problem of a row, or of the file as such."""
        return Problem(str(self.path), None if row is None else int(self.lines[row]), key, value, cause, cure)


def read_motions(
    path: str | Path,
    end: float,
    units: Mapping[str, str] | None = None,
    gap: float | None = None,
    ramp: float = 0.0,
    begin: float = 0.0,
) -> tuple[Samples | Constant, ...]:
    """Six motions of a vessel as functions of time, each the natural cubic spline through its column.

    Parameters
    ----------
    path : str or Path
        CSV file.
    end : float
        Time to which the run goes, s.
    units : mapping, optional
        Unit of each column whose header has none, such as ``{"roll": "deg"}``.
    gap : float, optional
        Longest time without a row, s; by default three times the median interval.
    ramp : float
        Time over which the motion grows from nothing, by a quintic, s.
    begin : float
        Time in the file that is the run's t = 0, s.

    Returns
    -------
    tuple of 6
        In the order of `crane.sea.frames.MOTIONS`: m, rad.

    Raises
    ------
    SceneError
        With a Problem for each fault: a cell that is no finite number; times out of order or repeated; a gap; fewer
        than four rows; a motion that no vessel makes, so that its unit must be wrong; a column or unit that is
        missing; a record that begins after the run or ends before it.
    """
    record = read_record(path, units)
    problems = _order(record)
    problems += _gaps(record, gap) if not problems else []
    problems += _wrong_units(record)
    problems += _not_covered(record, begin, end) if not problems else []
    if problems:
        raise SceneError(sorted(problems, key=lambda problem: problem.line or 0))
    return tuple(_smooth(record.time - begin, motion, end, ramp) for motion in record.motions)


def read_record(path: str | Path, units: Mapping[str, str] | None = None) -> Record:
    """Read the rows of a file and turn them into SI; whether they make sense is not looked at.

    Raises
    ------
    SceneError
        If a cell is no finite number, or a column or its unit is missing.
    """
    sheet = Sheet(path)
    found = sheet.find({name: (name,) for name in UNITS} | {alias: (name,) for alias, name in ALIASES.items()})
    lacking = [name for name in UNITS if (name,) not in found]
    if lacking:
        cure = "write a header such as: t [s], surge [m], sway [m], heave [m], roll [deg], pitch [deg], yaw [deg]"
        cause = "there is no such column; one of zeros will do for a motion that was not measured"
        raise SceneError([sheet.problem(sheet.header, ", ".join(lacking), None, cause, cure)])
    asked = {ALIASES.get(name.lower(), name.lower()): unit for name, unit in (units or {}).items()}
    odd = [name for name in asked if name not in UNITS]
    if odd:
        raise SceneError(
            [sheet.problem(None, f"units.{odd[0]}", asked[odd[0]], "no such column", nearest(odd[0], UNITS))]
        )
    factors = {}
    for name, unit in UNITS.items():
        default = None if name in ANGLES else unit
        factors[name] = sheet.factor(found[(name,)], name, unit, asked.get(name), default)
    columns = {name: sheet.numbers(found[(name,)], name) for name in UNITS}
    sheet.raise_if_any()
    values = {name: factors[name] * columns[name] for name in UNITS}
    return Record(sheet.path, values["t"], np.array([values[name] for name in MOTIONS]), np.array(sheet.lines))


class Sheet:
    """A CSV file with a header, whose faults are collected and raised as one.

    Parameters
    ----------
    path : str or Path
        The file.

    Raises
    ------
    SceneError
        If it cannot be read, is empty or has no header.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.problems: list[Problem] = []
        try:
            self.columns = Columns(self.path)
        except PydanticCustomError as error:
            said = error.context or {}
            raise SceneError([self.problem(said.get("line"), "", None, said["cause"], said["cure"])]) from None
        self.header = self.columns.header_line
        self.lines = [line for line, _ in self.columns.rows]
        if not self.columns.headed:
            cause, cure = "the first line holds numbers where the names should be", "write a header above them"
            raise SceneError([self.problem(self.header, "", None, cause, cure)])

    def problem(self, line: int | None, key: str, value: str | None, cause: str, cure: str) -> Problem:
        """A problem of a line, or of the file as such."""
        return Problem(str(self.path), line, key, value, cause, cure)

    def raise_if_any(self) -> None:
        """Raise what was found, in the order of the file.

        Raises
        ------
        SceneError
            If anything was.
        """
        if self.problems:
            raise SceneError(sorted(self.problems, key=lambda problem: problem.line or 0))

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
        for place, (title, bracketed) in enumerate(zip(self.columns.names, self.columns.units, strict=True)):
            name, unit = _name_and_unit(title, bracketed, names)
            if name is None:
                continue
            if names[name] in found:
                cause = f"columns {found[names[name]][0] + 1} and {place + 1} are both this"
                raise SceneError([self.problem(self.header, title, None, cause, "rename the one that is not meant")])
            found[names[name]] = place, unit
        return found

    def factor(
        self, column: tuple[int, str], name: str, wanted: str, asked: str | None = None, default: str | None = None
    ) -> float:
        """SI value of a column's unit, which the header gives, or the scene (`asked`), or else `default`."""
        written = column[1]
        if written and asked and written != asked:
            cause = f"the header says {written}, and the scene says {asked}"
            self.problems.append(self.problem(self.header, name, None, cause, "remove the wrong one"))
            return 1.0
        unit = written or asked or default
        if unit is not None and unit.lower() in ANGLE_WORDS:
            unit = ANGLE_WORDS[unit.lower()]
        if unit is None:
            cause = "no unit: degrees and radians would be taken for one another"
            cure = f"write {name} [{'deg' if wanted == 'rad' else wanted}] in the header"
            cure += f", or `units: {{{name}: deg}}` beside the file" if wanted == "rad" else ""
            self.problems.append(self.problem(self.header, name, None, cause, cure))
            return 1.0
        try:
            found = read_unit(unit)
            cause = f"'{unit}' is not a unit like {wanted}" if found.dimension != read_unit(wanted).dimension else ""
        except UnknownUnit as error:
            cause = str(error)
        if cause:
            self.problems.append(self.problem(self.header, name, None, cause, f"write {name} [{wanted}]"))
            return 1.0
        return found.si(Fraction(1))

    def numbers(self, column: tuple[int, str], name: str) -> np.ndarray:
        """Cells of a column (rows,); what is no finite number is noted."""
        values = []
        for line, row in self.columns.rows:
            cell = row[column[0]].strip() if column[0] < len(row) else ""
            value = _number(cell)
            if not math.isfinite(value):
                cause = "is not a finite number" if cell else "the cell is empty"
                self.problems.append(self.problem(line, name, cell[:40], cause, "give a number, or delete the row"))
            values.append(value)
        return np.array(values)


def _number(cell: str) -> float:
    """Number in a cell, with a decimal comma where the comma is no separator; nan for anything else."""
    try:
        return math.nan if "_" in cell else float(cell.replace(",", ".") if cell.count(",") == 1 else cell)
    except ValueError:
        return math.nan


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


def _order(record: Record) -> list[Problem]:
    """Too few rows, and times that do not increase."""
    time, lines = record.time, record.lines
    if time.size < FEWEST_ROWS:
        cause = f"{time.size} rows are no record of a motion"
        return [record.problem(None, "", None, cause, f"give {FEWEST_ROWS} at least")]
    problems = []
    latest = 0
    for i in range(1, time.size):
        if time[i] > time[latest]:
            latest = i
            continue
        same = time[i] == time[latest]
        cause = f"the same time as line {lines[latest]}" if same else f"earlier than line {lines[latest]}"
        cure = "keep one of the two rows" if same else "sort the rows by time"
        problems.append(record.problem(i, "t", f"{time[i]:.9g} s", cause, cure))
    return problems


def _gaps(record: Record, gap: float | None) -> list[Problem]:
    """Intervals without a row that are too long to be bridged."""
    intervals = np.diff(record.time)
    longest = LONGEST_GAP * float(np.median(intervals)) if gap is None else gap
    cure = (
        "fill it in, run a part of the record without it, or give a longer `gap:` if the motion is known to be smooth"
    )
    return [
        record.problem(
            int(i) + 1,
            "t",
            f"{record.time[i + 1]:.9g} s",
            f"no row in the {intervals[i]:.6g} s before (gap is {longest:.6g} s)",
            cure,
        )
        for i in np.flatnonzero(intervals > longest * (1.0 + 1e-9))
    ]


def _wrong_units(record: Record) -> list[Problem]:
    """Motions that no vessel makes: one problem a column, at the first row of them."""
    problems = []
    for name, motion in zip(MOTIONS, record.motions, strict=True):
        angle = name in ANGLES
        beyond = np.flatnonzero(np.abs(motion) > LARGEST[name] * (1.0 + 1e-9))
        if beyond.size:
            value, most = (math.degrees(x) if angle else x for x in (float(motion[beyond[0]]), LARGEST[name]))
            unit = "deg" if angle else "m"
            others = f", here and in {beyond.size - 1} more rows" if beyond.size > 1 else ""
            cause = f"more than {most:g} {unit}{others}: its unit must be another"
            cure = f"check the unit of the column {name} in the header, or in `units:`"
            problems.append(record.problem(int(beyond[0]), name, f"{value:.6g} {unit}", cause, cure))
        elif angle and np.any(wrapped := np.abs(np.diff(motion)) > math.pi):
            row = int(np.argmax(wrapped)) + 1
            cause = f"it jumps by {abs(math.degrees(motion[row] - motion[row - 1])):.4g} deg from the row before"
            cure = "count a heading on beyond 360 deg, and take its mean off"
            problems.append(record.problem(row, name, f"{math.degrees(motion[row]):.6g} deg", cause, cure))
    return problems


def _not_covered(record: Record, begin: float, end: float) -> list[Problem]:
    """A record that does not hold the run's time."""
    first, last = float(record.time[0]) - begin, float(record.time[-1]) - begin
    if first > 0.0:
        cause = f"the record begins {first:.9g} s after the run"
        cure = f"count its time from the run's start, or give `begin: {record.time[0]:.9g}` beside the file"
        return [record.problem(0, "t", f"{record.time[0]:.9g} s", cause, cure)]
    if last < end * (1.0 - 1e-9):
        cause = f"the record ends {end - last:.6g} s before the run, which goes on to {end:g} s"
        cure = f"let the run end at {last:.6g} s" if last > 0.0 else "check `begin:`"
        return [record.problem(record.time.size - 1, "t", f"{record.time[-1]:.9g} s", cause, cure)]
    return []


def _smooth(time: np.ndarray, value: np.ndarray, end: float, ramp: float) -> Samples | Constant:
    """Natural spline through a column, under an envelope that grows over `ramp`."""
    if not np.any(value):
        return Constant(value=0.0)
    spline = CubicSpline(time, value, bc_type="natural")
    knots = time.copy()
    # a last row that ends the run but for rounding must not let the motion stop before it
    knots[-1] = max(knots[-1], end)
    if ramp > 0.0:
        knots = _knots_under_envelope(knots, ramp)
    f, df, ddf = (spline(knots, order) for order in range(3))
    if ramp > 0.0:
        x = np.clip(knots / ramp, 0.0, 1.0)
        e = x**3 * (10.0 + x * (6.0 * x - 15.0))
        de = 30.0 * (x * (1.0 - x)) ** 2 / ramp
        dde = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / ramp**2
        f, df, ddf = e * f, de * f + e * df, dde * f + 2.0 * de * df + e * ddf
    return Samples(knots, f, df, ddf)


def _knots_under_envelope(time: np.ndarray, ramp: float) -> np.ndarray:
    """Times from 0 on: those of the rows, and more while the envelope grows: from row to row no quintic follows it."""
    near, last = 1e-3 * float(np.diff(time).min()), time[-1]
    rows = time[(time > near) & (np.abs(time - ramp) > near)]
    edges = np.unique(np.concatenate(([0.0], rows, [min(ramp, last)])))
    parts = np.where(edges[1:] <= ramp, np.ceil(np.diff(edges) / (ramp / PIECES_PER_ENVELOPE)), 1.0).astype(int)
    pieces: Sequence[np.ndarray] = [
        np.linspace(left, right, n, endpoint=False) for left, right, n in zip(edges[:-1], edges[1:], parts, strict=True)
    ]
    return np.concatenate((*pieces, edges[-1:]))
