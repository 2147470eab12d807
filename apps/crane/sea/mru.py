"""A vessel's motion from the CSV file of a motion reference unit, checked row by row.

Columns are t (or time), surge, sway, heave, roll, pitch and yaw, in any order and among others. Units stand in the
header, ``roll [deg]``, ``roll (deg)`` or ``roll_deg``, or beside the file in the scene. Without one, time is in s and
surge, sway and heave are in m; angles have no default, because degrees read as radians look like a heavy sea.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crane.sea.frames import MOTIONS, with_grace
from tautline.scene.errors import Problem, SceneError
from tautline.scene.functions import Constant
from tautline.scene.reading.columns import Columns
from tautline.scene.refusal import nearest
from tautline.system.time_functions import Samples

UNITS = {"t": "s", "surge": "m", "sway": "m", "heave": "m", "roll": "rad", "pitch": "rad", "yaw": "rad"}
ANGLES = MOTIONS[3:]
ALIASES = {"time": "t"}
LARGEST = {
    "surge": 1000.0, "sway": 1000.0, "heave": 30.0,
    "roll": 0.5 * math.pi, "pitch": 0.5 * math.pi, "yaw": 2.0 * math.pi,
}  # fmt: skip
"""What no vessel does, m and rad: the unit must be another."""
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
    sheet = Columns(path, headed=True)
    found = sheet.find({name: (name,) for name in UNITS} | {alias: (name,) for alias, name in ALIASES.items()})
    lacking = [name for name in UNITS if (name,) not in found]
    if lacking:
        sheet.refuse_title_lines()
        cure = "write a header such as: t [s], surge [m], sway [m], heave [m], roll [deg], pitch [deg], yaw [deg]"
        cause = "there is no such column; one of zeros will do for a motion that was not measured"
        raise SceneError([sheet.problem(sheet.header_line, ", ".join(lacking), None, cause, cure)])
    asked = {ALIASES.get(name.lower(), name.lower()): unit for name, unit in (units or {}).items()}
    odd = [name for name in asked if name not in UNITS]
    if odd:
        raise SceneError(
            [sheet.problem(None, f"units.{odd[0]}", asked[odd[0]], "no such column", nearest(odd[0], UNITS))]
        )
    lacking = [name for name in ANGLES if not found[(name,)][1]]
    given = ", ".join(f"{name}: {asked.get(name) or 'deg'}" for name in lacking)
    beside = f"motion: {{file: {sheet.path.name}, units: {{{given}}}}}"
    factors = {}
    for name, unit in UNITS.items():
        default = None if name in ANGLES else unit
        factors[name] = sheet.factor(found[(name,)], name, unit, asked.get(name), default, beside)
    columns = {name: sheet.numbers(found[(name,)][0], name) for name in UNITS}
    sheet.raise_if_any()
    values = {name: factors[name] * columns[name] for name in UNITS}
    return Record(sheet.path, values["t"], np.array([values[name] for name in MOTIONS]), np.array(sheet.lines))


def _order(record: Record) -> list[Problem]:
    """Too few rows, and times that do not increase."""
    time, lines = record.time, record.lines
    if time.size < FEWEST_ROWS:
        cause = f"{time.size} {'row is' if time.size == 1 else 'rows are'} no record of a motion"
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
        problems.append(record.problem(i, "t", f"{time[i]:.15g} s", cause, cure))
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
            f"{record.time[i + 1]:.15g} s",
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
        cause = f"the record begins {first:.15g} s after the run"
        cure = f"count its time from the run's start, or give `begin: {record.time[0]:.15g}` beside the file"
        return [record.problem(0, "t", f"{record.time[0]:.15g} s", cause, cure)]
    if last < end * (1.0 - 1e-9):
        cause = f"the record ends {end - last:.6g} s before the run, which goes on to {end:g} s"
        # rounded up, it would be refused again
        until = next((text for n in (6, 9) if float(text := f"{last:.{n}g}") <= last), f"{last:.15g}")
        cure = f"let the run end at {until} s" if last > 0.0 else "check `begin:`"
        return [record.problem(record.time.size - 1, "t", f"{record.time[-1]:.15g} s", cause, cure)]
    return []


def _smooth(time: np.ndarray, value: np.ndarray, end: float, ramp: float) -> Samples | Constant:
    """Natural spline through a column, under an envelope that grows over `ramp`."""
    if not np.any(value):
        return Constant(value=0.0)
    from scipy.interpolate import CubicSpline

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
    # A run that ends with the record must not have its last instant where all is held.
    knots, (f, df, ddf) = with_grace(knots, np.stack((f, df, ddf)))
    return Samples(knots, f, df, ddf, reach=float(knots[-2]))


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
