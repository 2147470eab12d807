"""Warnings of records: that lack rows in a stretch, or before or after it, and whose speeds or places jump."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from tautline.scene.errors import SceneError, SceneWarning
from tautline.scene.functions import RATES, Duration, Table, places, usual_interval
from tautline.scene.model import DOUBT, MARK, Model
from tautline.scene.reading.columns import Columns
from tautline.scene.reading.document import Document, Path_, join_key
from tautline.scene.unit_slips import CLOCK
from tautline.scene.values.printed import rounded
from tautline.scene.values.ranges import sized

RECORDED = 20
"""Rows from which on a file is a record: what somebody has thought out is shorter."""
MISSING = 5.0
"""Usual intervals without a row that are a missing stretch."""
ROUNDED = 1e-5
"""Share by which a stretch may be longer: a gap is told in six digits."""
SAME = 1e-6
"""Share of the spread of all rows by which one may lie off a straight line that is gone on with."""
STEP = 1e-3
"""Share of the spread of all rows by which a value still moves."""
OFTEN, BESIDE = 4, 5
"""Turns beside a gap from which on a value goes up and down as waves do; rows beside it that show a crest."""
CLOSE, NOISE = 4.0, 0.3
"""Steps from row to row below which jumps of speed add up; their size over the speeds from which on they are noise."""
SUDDEN = 2.0
"""Times the way of a step that its fastest speed, kept for a step, may lead: beyond that the place jumps within it."""
LEAST = 1e-6
"""Throw, m or rad, below which nothing is said of a jump."""
LOOKED_AT = 100
"""Pairs of rows that are looked at for it: those that throw the farthest."""
SHOWN = 3
"""Stretches of one file that are told."""


def gaps_of_records(document: Document | None) -> list[SceneWarning]:
    """Warn of tables from files in which a stretch many times as long as the usual interval has no row.

    A table whose curve swings beyond the two rows is refused before that. Where the scene states a `gap`, every longer
    stretch is told, and none that is shorter. Else nothing is said of rows as uneven as somebody wrote them, and where
    the value stands, or goes on in a straight line, before it or behind it. Nor of two rows of one value with ramps
    around, or at the end: somebody wrote a hold. Records of a vessel's six motions are refused by their own reader.

    Parameters
    ----------
    document : Document or None
        A file that was read and is valid; None for a scene made in Python.
    """
    if document is None:
        return []
    tables = [one for one in _tables(document.root, ()) if isinstance(one[1].get("file"), str)]
    return [found for path, table in tables for found in _gaps(document, path, table)]


def ends_of_records(model: type[Model], document: Document | None, end: float, step: float = 0.0) -> list[SceneWarning]:
    """Warn of tables from files that begin after the run or end before it, where the value that holds there matters.

    Also of places on straight lines between rows closer than some steps, where their speed jumps as noise does, and of
    places of any table that jump within a step.

    A rate that is not zero goes on and on: that is told of a record, for who writes a few rows means it. A place, a
    force or another value stops where the rows before moved it, and a record of waves wherever it stops. Nothing is
    said of a single row, of what a row more would cover, nor of times of a clock, which are told as such.

    Parameters
    ----------
    model : type
        Of the scene, as it is written.
    document : Document or None
        A file that was read and is valid; None for a scene made in Python.
    end : float
        Time to which the run goes, s.
    step : float, optional
        Of the solver, s; 0 where it is chosen.
    """
    if document is None or not any(_is_asked_for(table, step) for _, table in _tables(document.root, ())):
        return []

    def ask(table: Table, unit: str) -> None:
        of_file = (_held(table, unit, end), _jumps(table, unit, step)) if table.file is not None else ()
        if said := ". ".join(filter(None, (*of_file, _sudden(table, unit, end, step)))):
            raise PydanticCustomError(DOUBT, "doubtful", {"said": said, "of": "file" if table.file else "value"})

    try:
        model.model_validate(document.root, context={"folder": document.folder, "record": ask})
    except ValidationError as error:
        errors = error.errors(include_url=False, include_input=False)
    else:
        return []
    found: dict[Path_, str] = {}
    for one in errors:
        if one["type"] == DOUBT:
            key = tuple(part for part in one["loc"] if not (isinstance(part, str) and part.startswith(MARK)))
            told = one.get("ctx", {})
            found.setdefault((*key, told["of"]), told["said"])
    return [
        SceneWarning(join_key(key), said, None if document.origin(key) else document.line(key), of_a_run=True)
        for key, said in found.items()
    ]


def _held(table: Table, unit: str, end: float) -> str:
    """What to say of a table whose rows do not cover the run; empty where nothing is amiss."""
    time, value = np.array(table.time), np.array(table.value)
    if time.size < 2:
        return ""
    first, last, usual = float(time[0]), float(time[-1]), float(np.median(np.diff(time)))
    if abs(first) >= CLOCK:
        return ""  # told as a time of the clock, which is the cause
    if (first >= end or last <= 0.0) and np.ptp(value) > 0.0:
        which, held = ("first", value[0]) if first >= end else ("last", value[-1])
        return (
            f"no row of {table.file} lies in the run, from 0 to {end:.6g} s: its times go from {first:.15g} s to "
            f"{last:.15g} s. The {which} value, {sized(float(held), unit)}, holds throughout. Count its times from the "
            "start of the run"
        )
    said = []
    if first > min(usual, end) and _matters(value, 0, unit):
        said.append(
            f"{table.file} begins at {first:.15g} s, and the run at 0: the first value, "
            f"{sized(float(value[0]), unit)}, holds until then. Count its times from the start of the run, or add a "
            "row at 0 s with what is meant"
        )
    if last < end - usual and _matters(value, -1, unit):
        said.append(
            f"{table.file} ends at {last:.15g} s, and the run goes on to {end:.6g} s: the last value, "
            f"{sized(float(value[-1]), unit)}, holds from there on. Let the run end there, or add rows with what "
            "is meant"
        )
    return ". ".join(said)


def _jumps(table: Table, unit: str, step: float) -> str:
    """What to say of places on straight lines whose rows are closer than some steps, and whose speed jumps as noise.

    A step sees what all jumps in it are together, not when they are: what it is early or late by adds up.
    """
    time, value = np.array(table.time), np.array(table.value)
    if table.interpolation != "linear" or unit not in ("m", "rad") or time.size < RECORDED:
        return ""
    apart, speed = float(np.median(np.diff(time))), np.diff(value) / np.diff(time)
    jump = float(np.sqrt(np.mean(np.diff(speed) ** 2)))
    if apart >= CLOSE * step * (1.0 - ROUNDED) or jump <= NOISE * float(np.sqrt(np.mean(speed**2))):
        return ""
    return (
        f"rows of {table.file} are {apart:.6g} s apart, and a step takes {step:.6g} s. On straight lines between them "
        f"the speed jumps by {sized(jump, unit + '/s')} from row to row, as noise makes it. Steps cannot follow that: "
        "places and forces beside it go wrong, and the longer the more. Smooth the record, keep fewer rows, or take "
        f"steps of {rounded(apart / CLOSE, 2, within=ROUNDED):.6g} s: {CLOSE:g} or more from row to row"
    )


def _sudden(table: Table, unit: str, end: float, step: float) -> str:
    """What to say of places that jump within a step.

    A step that ends in the jump sees its speed, and what is carried keeps that for a step.
    """
    time, value = np.array(table.time), np.array(table.value)
    if unit not in ("m", "rad") or time.size < 2 or step <= 0.0:
        return ""
    lasts, ways = np.diff(time), np.diff(value)
    far = np.abs(ways) * step / lasts
    # What matters is how far it throws; nothing behind the run's end or before its start is.
    sudden = (lasts < step) & (far > STEP * float(np.ptp(value))) & (time[:-1] < end) & (time[1:] > 0.0)
    for i in sorted(np.flatnonzero(sudden), key=lambda i: -far[i])[:LOOKED_AT]:
        edges = np.array([time[i] - step, time[i + 1] + step])
        near = value[(time > edges[0]) & (time < edges[1])]
        way, thrown = float(np.ptp(np.concatenate((near, np.interp(edges, time, value))))), float(far[i])
        if thrown > max(SUDDEN * way, LEAST):
            return (
                f"{table.file or 'the table'} jumps by {sized(abs(float(ways[i])), unit)} within {lasts[i]:.3g} s, at "
                f"{time[i]:.6g} s, and a step takes {step:.6g} s. A step that ends in the jump throws what is carried "
                f"too far, up to {thrown / abs(float(ways[i])):.2g} times. Spread the jump over {2.0 * step:.3g} s or "
                f"more, or take steps of {rounded(float(lasts[i]) / 2.0, 2, within=ROUNDED):.2g} s"
            )
    return ""


def _matters(value: np.ndarray, edge: int, unit: str) -> bool:
    """Whether it matters that the first value (edge 0) or the last (-1) holds."""
    if unit in RATES:
        return value.size >= RECORDED and abs(float(value[edge])) > SAME * float(np.abs(value).max())
    step = float(value[1] - value[0] if edge == 0 else value[-1] - value[-2])
    return abs(step) > STEP * float(np.ptp(value)) or (value.size >= RECORDED and _turns(value))


def _is_asked_for(table: Mapping[str, Any], step: float) -> bool:
    """Whether there may be something to say of a table: of a file, or a list with rows closer than a step."""
    if isinstance(table.get("file"), str):
        return True
    times = table["time"]
    if not all(isinstance(one, (int, float)) for one in times):
        return True  # with units: they are read where the scene is
    return bool(np.any(np.diff(np.array(times, float)) < step))


def _tables(value: Any, path: Path_) -> Iterator[tuple[Path_, Mapping[str, Any]]]:
    """Tables of a scene."""
    if isinstance(value, Mapping):
        if path and path[-1] == "table" and (isinstance(value.get("file"), str) or isinstance(value.get("time"), list)):
            yield path, value
        for key, part in value.items():
            yield from _tables(part, (*path, key))
    elif isinstance(value, list):
        for place, part in enumerate(value):
            yield from _tables(part, (*path, place))


def _gaps(document: Document, path: Path_, table: Mapping[str, Any]) -> Iterator[SceneWarning]:
    try:
        allowed = None if table.get("gap") is None else TypeAdapter(Duration).validate_python(table["gap"])
        columns = Columns(document.folder / table["file"])
        at_time, at_value = places(columns, table.get("column"))
        time = np.array(columns.values(at_time, "s"))
        value = columns.numbers(at_value, "value")
    except (SceneError, ValidationError):
        return  # a key of this name that holds no table of times
    intervals, usual = np.diff(time), usual_interval(time, RECORDED)
    if not intervals.size or (allowed is None and not usual):
        return
    longest = (MISSING * usual if allowed is None else allowed) * (1.0 + ROUNDED)
    long = np.flatnonzero(intervals > longest).tolist()
    missing = long if allowed is not None else [i for i in long if _moves(time, value, i)]
    apart = float(np.median(intervals))
    key = (*path, "file")
    line = None if document.origin(key) else document.line(key)
    for told, i in enumerate(missing[:SHOWN], 1):
        (before, _), (behind, _) = columns.rows[i], columns.rows[i + 1]
        left = len(missing) - SHOWN if told == SHOWN else 0
        more = f" There are {left} more of this kind." if left > 0 else ""
        yield SceneWarning(
            join_key(key),
            f"{table['file']} has no row for {intervals[i]:.6g} s, between line {before} ({time[i]:.15g} s) and line "
            f"{behind} ({time[i + 1]:.15g} s). Its rows are {apart:.6g} s apart else. The motion in between is not "
            f"known: a curve or a straight line goes from one row to the other. Fill it in, or write "
            f"`gap: {intervals[i]:.6g}` beside the file if the motion is known to be so.{more}",
            line,
        )


def _moves(time: np.ndarray, value: np.ndarray, i: int) -> bool:
    """Whether a value goes another way beside a gap behind row i than over it: a drum at rest may have no rows."""
    spread = SAME * float(np.ptp(value))
    if abs(value[i + 1] - value[i]) <= spread and _holds(value, i):
        return False
    slope = (value[i + 1] - value[i]) / (time[i + 1] - time[i])
    off = [value[k] - value[i] - slope * (time[k] - time[i]) for k in (i - 1, i + 2) if 0 <= k < time.size]
    return bool(off) and min(map(abs, off)) > spread


def _holds(value: np.ndarray, i: int) -> bool:
    """Whether somebody wrote a hold or a rest behind row i, where the values at both ends of a gap are the same.

    A last row says how long. Lifts turn seldom; in a record of waves equal ends are chance, unless both are 0, a drum
    at rest, or the value went to a crest before the gap and leaves it behind.
    """
    before, behind = value[max(i - BESIDE, 0) : i + 1], value[i + 1 : i + 2 + BESIDE]
    if i + 2 == value.size or value[i] == value[i + 1] == 0.0:
        return True
    if _turned(value[: i + 1]) + _turned(value[i + 1 :]) < OFTEN:
        return True
    crest = (before[-1] - before[0]) * (behind[-1] - behind[0]) < 0.0
    return bool(crest) and not _turns(before) and not _turns(behind)


def _turned(value: np.ndarray) -> int:
    """How often a value turns from up to down or back."""
    steps = np.diff(value)
    way = np.sign(steps[steps != 0.0])
    return int(np.count_nonzero(way[1:] != way[:-1]))


def _turns(value: np.ndarray) -> bool:
    """Whether a value goes up and down."""
    steps = np.diff(value)
    return bool(steps.size) and float(steps.min()) < 0.0 < float(steps.max())
