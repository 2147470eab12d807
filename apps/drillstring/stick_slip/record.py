"""A map of stick-slip as a table, as sentences, and as CSV, NetCDF and JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drillstring.results.drilling import stalls_at
from drillstring.stick_slip.severity_map import NOT_RUN, NUMBERS, Cell, Map
from tautline.results.tables.netcdf import write_dataset
from tautline.results.tables.rows import heads_of, write_rows
from tautline.scene.values.printed import quantity, rounded, shown, significant
from tautline.scene.values.units import RPM

if TYPE_CHECKING:
    from rich.table import Table

UNITS = {
    "speed": "rad/s", "weight": "N", "mean": "rad/s", "least": "rad/s", "largest": "rad/s", "torque": "N m",
    "weight_mean": "N", "rate": "m/s", "wall_time": "s", "enough": "s",
}  # fmt: skip
NAMES = {
    "severity": "severity", "stuck": "stuck", "mean": "bit_speed_mean", "least": "bit_speed_min",
    "largest": "bit_speed_max", "torque": "torque_on_bit", "weight_mean": "weight_on_bit",
    "rate": "rate_of_penetration", "so_far": "severity_so_far", "enough": "end_needed",
}  # fmt: skip
"""What a cell's numbers are called in files and JSON."""
MOST_COLUMNS = 9
"""Columns of numbers that a screen has room for."""


def whole_record(found: Map) -> dict[str, Any]:
    """Keys of ``stick-slip --json``: arrays (weights, speeds), SI; null where a run has no number."""
    record: dict[str, Any] = {"speed": list(found.speeds), "weight": list(found.weights)}
    for field, name in NAMES.items():
        record[name] = [[None if np.isnan(x) else float(x) for x in row] for row in found.values(field)]
    record["outcome"] = [[cell.status for cell in row] for row in found.cells]
    record["verdict"] = [[cell.verdict for cell in row] for row in found.cells]
    record["sticking_ends"] = [
        {"weight": weight, "sticks_at": sticks, "turns_at": turns}
        for weight, (sticks, turns) in zip(found.weights, found.ends(), strict=True)
    ]
    record["failures"] = [
        {"speed": cell.speed, "weight": cell.weight, "status": cell.status, "sentence": cell.sentence}
        for cell in found.failures
    ]
    return record


def write_csv(found: Map, path: Path) -> Path:
    """Write a row to a cell, with units in the header; raises ResultError if the file cannot be written."""
    fields = ("speed", "weight", *NUMBERS, "verdict", "status", "sentence", "wall_time")
    heads = heads_of([NAMES.get(f, f) for f in fields], {NAMES.get(f, f): unit for f, unit in UNITS.items()})
    return write_rows(heads, ([getattr(cell, f) for f in fields] for row in found.cells for cell in row), path)


def write_netcdf(found: Map, attributes: Mapping[str, str], path: Path) -> Path:
    """Write arrays along ``weight`` and ``speed``; raises ResultError if the file cannot be written."""
    shape = ("weight", "speed")
    columns: dict[str, Any] = {
        name: (shape, found.values(field), {"units": UNITS[field]} if field in UNITS else {})
        for field, name in NAMES.items()
    }
    for words in ("status", "verdict"):
        columns[words] = (shape, found.values(words).astype(object))
    axes = {
        "speed": ("speed", np.array(found.speeds), {"units": "rad/s", "long_name": "rotary speed"}),
        "weight": ("weight", np.array(found.weights), {"units": "N", "long_name": "weight on bit"}),
    }
    return write_dataset(columns, axes, attributes, path)


def table(found: Map, system: str) -> Table | None:
    """Severity at every speed and weight, and the share of time that the bit is stuck where it is.

    Speeds are across where they fit on a screen, else weights; None where neither do.
    """
    from rich.table import Table

    if min(len(found.speeds), len(found.weights)) > MOST_COLUMNS:
        return None
    laid_out = Table(box=None, padding=(0, 1, 0, 0), header_style="cyan", title="severity, and share of time stuck")
    speeds = [f"{significant(speed / RPM)}\u00a0rpm" for speed in found.speeds]
    weights = [shown(weight, "N", system).replace(" ", "\u00a0") for weight in found.weights]
    words = [[_word(cell) for cell in row] for row in found.cells]
    across = len(speeds) <= MOST_COLUMNS
    laid_out.add_column("weight on bit" if across else "rotary speed", justify="right")
    for head in speeds if across else weights:
        laid_out.add_column(head, justify="right")
    for head, row in zip(*((weights, words) if across else (speeds, zip(*words, strict=True))), strict=True):
        laid_out.add_row(head, *row)
    return laid_out


def _word(cell: Cell) -> str:
    if cell.status != "done":
        return "–" if cell.status == NOT_RUN else cell.status
    return cell.told + (f"\u00a0{100.0 * cell.stuck:.0f}%" if cell.sticks else "")


def sentences(found: Map, system: str) -> list[tuple[str, str]]:
    """Where sticking ends for each weight, and what was not found: text and style."""
    said = []
    for weight, row, ends in zip(found.weights, found.cells, found.ends(), strict=True):
        at, done = shown(weight, "N", system), [cell for cell in row if cell.status == "done"]
        said += [(f"{at}: {text}", "yellow") for text in (*_unjudged(done, system), *_dying_out(done))]
        if any(cell.judged for cell in row):
            text, style = _where_it_ends(row, *ends)
            said.append((f"{at}: {text}", style))
    said += [
        (f"stopped at {quantity(cell.speed / RPM, 'rpm')}, {shown(cell.weight, 'N', system)}: {cell.status}, "
         f"{cell.sentence}", "red")
        for cell in found.failures
    ]  # fmt: skip
    if found.interrupted:
        said.append(("interrupted: some of the map was not run", "yellow"))
    return said


def _unjudged(cells: Sequence[Cell], system: str) -> Iterator[str]:
    """Why some runs of one weight do not tell whether the bit sticks, and what to do."""
    stalled = [cell for cell in cells if not cell.turns and not isnan(cell.stall)]
    if stalled:
        least, most = (shown(pick(c.stall for c in stalled), "N m", system, digits=3) for pick in (min, max))
        torque = most if least == most else f"{least} to {most}"
        cause = f"the bit does not turn{_at(stalled, cells)}. {stalls_at(torque)}"
        yield f"{cause}. Give more torque or less weight"
    waiting = [cell for cell in cells if not cell.turns and isnan(cell.stall)]
    if waiting:
        cause = f"the bit has not begun to turn when the runs end{_at(waiting, cells)}"
        yield f"{cause}. Give a longer --end, or less weight"
    late = [cell for cell in cells if cell.turns and cell.late]
    if late:
        cause = f"the bit begins to turn in the last half of the runs only{_at(late, cells)}, which is judged"
        yield f"{cause}. Give a longer --end"
    short = [cell for cell in cells if cell.turns and cell.short and not cell.late]
    if short:
        yield f"the runs are too short to show how the bit turns{_at(short, cells)}. Give a longer --end"


def _dying_out(cells: Sequence[Cell]) -> Iterator[str]:
    """Where the starting transient of the bit still falls as runs of one weight end, and how long they should be."""
    fading = [cell for cell in cells if cell.dies_out]
    if fading:
        least, most = (f"{pick(cell.so_far for cell in fading):.2f}" for pick in (min, max))
        severity = most if least == most else f"{least} to {most}"
        cause = f"the starting transient of the bit has not decayed (`dying out`){_at(fading, cells)}"
        yield f"{cause}: severity {severity} at the end, and it falls. Give --end '{enough_of(fading)}'"


def enough_of(fading: Sequence[Cell]) -> str:
    """A length of run in which the starting transients of all of them decay."""
    return quantity(rounded(max(cell.enough for cell in fading), 2, up=True), "s")


def _at(some: Sequence[Cell], cells: Sequence[Cell]) -> str:
    """Speeds of some of the runs of one weight; nothing if it is all of them."""
    if len(some) == len(cells):
        return ""
    return f" at {', '.join(significant(cell.speed / RPM) for cell in some)} rpm"


def _where_it_ends(row: Sequence[Cell], sticks: float | None, turns: float | None) -> tuple[str, str]:
    """Up to which speed the bit of one weight sticks, and the style of that sentence."""
    low, high = (quantity(x / RPM, "rpm") if x is not None else "" for x in (sticks, turns))
    if sticks is None:
        return f"the bit does not stick from {high} up", "green"
    if turns is not None:
        return f"sticking ends between {low} and {high}", "yellow"
    of = "that was run" if any(cell.status != "done" for cell in row) else "of all"
    if of == "of all" and not all(cell.judged for cell in row):
        of = "that is judged"
    return f"the bit sticks up to the highest speed {of}, {low}", "yellow"
