"""A result as tables of comma-separated values, which every spreadsheet and every language reads."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tautline.results.errors import ResultError, WriteError, once_each
from tautline.results.output_path import check_folder
from tautline.results.result import Result
from tautline.results.tables.pieces import pieces_of
from tautline.results.variable import Variable
from tautline.whole_file import name_beside, take_name

CURE = "name another file with -o, or make room"
PIECE = "piece"
"""Column of a result with gaps between its frames: the number of the piece of time."""
ROWS = 1000
"""That are made into text at a time."""


class _Table(NamedTuple):
    """A file, the dimension that has a row for each of its places, and the variables that stand in it."""

    file: Path
    rows: str
    variables: list[Variable]


def write_csv(
    result: Result,
    path: str | Path,
    what: Sequence[str] = (),
    progress: Callable[[int, int], None] | None = None,
) -> list[Path]:
    """Write variables as tables with a row for each frame.

    Variables that are one number at each time go into one file, each with more dimensions into its own: of
    ``run.csv``, ``run_position.csv`` with columns such as ``node 1 x [m]``. What does not change with time goes into a
    file for its first dimension, such as ``run_by_node.csv``. The first row holds names with units; numbers are the
    shortest that read back as they are stored. Where windows round the extremes are kept in place of every frame, the
    second column over time is the number of the piece without a gap (`tautline.results.tables.pieces`).

    Parameters
    ----------
    result : Result
        What is read only.
    path : str or Path
        The ending ``.csv`` is added where it lacks. Earlier tables of these names are replaced.
    what : sequence of str
        Names of variables; empty for all.
    progress : callable, optional
        Called with the number of tables that are written, and of all.

    Returns
    -------
    list of Path

    Raises
    ------
    ResultError
        For a name that the result does not have, a missing folder, a file that is there and no table of such a result,
        or one that cannot be written; every table is then as it was before.
    """
    path = Path(path)
    path = path if path.suffix.lower() == ".csv" else path.with_name(path.name + ".csv")
    check_folder(path)
    tables = _tables(_chosen(result, what), path)
    _check_replaceable(result, tables, path)
    beside: dict[Path, Path] = {}
    try:
        for table in tables:
            beside[table.file] = _begun(table.file)
        for number, table in enumerate(tables, start=1):
            _write(result, table, beside[table.file])
            if progress is not None:
                progress(number, len(tables))
        for file, waiting in beside.items():  # all are on the disk: from here on they only take their names
            _take_name(waiting, file)
    finally:
        for waiting in (waiting for file, waiting in beside.items() if waiting != file):
            waiting.unlink(missing_ok=True)
    return [table.file for table in tables]


def _chosen(result: Result, what: Sequence[str]) -> list[Variable]:
    """Variables by name; all of them, but those that only name places along a dimension, for no name."""
    for name in what:
        if name not in result.variables:
            cure = once_each(name) or f"it has {', '.join(result.variables)}"
            raise ResultError("--what", f"{result.path or 'the result'} has no variable '{name}'", cure)
    if what:
        return [result.variables[name] for name in dict.fromkeys(what)]
    return [one for one in result.variables.values() if one.dims != (one.name,) or one.name == "time"]


def _tables(variables: Sequence[Variable], path: Path) -> list[_Table]:
    """What goes into which file."""
    single = [one for one in variables if one.dims == ("time",)]
    tables = [_Table(path, "time", single)] if single else []
    still: dict[str, list[Variable]] = {}
    for one in variables:
        if "time" not in one.dims:
            still.setdefault(one.dims[0] if one.dims else "", []).append(one)
        elif one.dims != ("time",):
            tables.append(_Table(path.with_name(f"{path.stem}_{one.name}.csv"), "time", [one]))
    for dimension, some in still.items():
        ending = f"by_{dimension}" if dimension else "constants"
        tables.append(_Table(path.with_name(f"{path.stem}_{ending}.csv"), dimension, some))
    return tables


def _check_replaceable(result: Result, tables: Sequence[_Table], path: Path) -> None:
    """Raise ResultError if a table would take the place of a file that is no table of such a result.

    Most of its columns, and the first, must be of those that there can be: a log of a machine begins with its time too,
    and an earlier table may be of other variables, or of a scene that has been changed since.
    """
    every = {table.file: table for table in _tables(_chosen(result, ()), path)}
    for table in tables:
        held = _header(table.file)
        if not held:
            continue
        known = {title for one in (table, every.get(table.file, table)) for title in _columns(result, one)[0]}
        if held[0] not in known or 2 * sum(title in known for title in held) <= len(held):
            cause = "exists and is no table of such a result: it would be lost"
            raise ResultError(table.file, cause, "name another file with -o")


def _header(file: Path) -> list[str]:
    """First row of a file that is there; empty where nothing can be lost."""
    if not file.is_file() or not file.stat().st_size:
        return []
    try:
        with file.open(encoding="utf8", errors="replace", newline="") as text:
            return next(csv.reader(text), None) or [""]
    except OSError as error:
        raise ResultError(file, f"cannot be read: {error.strerror}", "name another file with -o") from None
    except csv.Error:
        return [""]


def _columns(result: Result, table: _Table) -> tuple[list[str], list[np.ndarray]]:
    """Titles of all columns, and the arrays that they are of."""
    index = [result.variables[table.rows]] if table.rows in result.variables else []
    variables = index + [one for one in table.variables if one not in index]
    arrays = [np.asarray(result[one.name]) for one in variables]
    titles = [title for one, array in zip(variables, arrays, strict=True) for title in _titles(result, one, array)]
    pieces = pieces_of(result) if table.rows == "time" else None
    if pieces is not None:
        titles, arrays = [titles[0], PIECE, *titles[1:]], [arrays[0], pieces, *arrays[1:]]
    return titles, arrays


def _write(result: Result, table: _Table, waiting: Path) -> None:
    """Write a table under another name, until all of them are whole."""
    header, arrays = _columns(result, table)
    count = len(arrays[0]) if table.rows else 1
    blocks = [array.reshape(count, -1) for array in arrays]
    try:
        with waiting.open("w", encoding="utf8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            for i in range(0, count, ROWS):
                parts = [block[i : i + ROWS].tolist() for block in blocks]
                writer.writerows([x for part in row for x in part] for row in zip(*parts, strict=True))
    except OSError as error:
        raise WriteError(table.file, f"cannot be written: {error.strerror or error}", CURE) from None


def _take_name(waiting: Path, file: Path) -> None:
    try:
        take_name(waiting, file)
    except OSError as error:
        raise WriteError(file, f"cannot be written: {error.strerror or error}", CURE) from None


def _begun(file: Path) -> Path:
    """Begin an empty file beside a table's place, and give its name; raises ResultError where none can be."""
    if file.is_dir():
        raise ResultError(file, "is a folder", "name another file with -o")
    try:
        waiting = name_beside(file)
        waiting.touch()
    except OSError as error:
        raise ResultError(file, f"cannot be written: {error.strerror}", "name another file or folder with -o") from None
    return waiting


def _titles(result: Result, variable: Variable, array: np.ndarray) -> list[str]:
    """Titles of a variable's columns: its name, or the places along its dimensions but the first; the unit."""
    unit = f" [{variable.units}]" if variable.units else ""
    if array.ndim < 2:
        return [variable.name + unit]
    # In a file of its own a variable's name is that of the file.
    name = "" if variable.dims[0] == "time" else f"{variable.name} "
    labels = [_labels(result, dim, size) for dim, size in zip(variable.dims[1:], array.shape[1:], strict=True)]
    return [name + " ".join(place) + unit for place in product(*labels)]


def _labels(result: Result, dimension: str, size: int) -> list[str]:
    """What places along a dimension are called: ``node 1``, or ``x`` where they have names."""
    if dimension in result.variables:
        places = np.asarray(result[dimension])
        if places.dtype.kind in "OSU":
            return [str(place) for place in places]
        return [f"{dimension} {place}" for place in places.tolist()]
    return [f"{dimension} {i}" for i in range(1, size + 1)]
