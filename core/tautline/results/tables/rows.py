"""Rows of findings as CSV files with units in the header, and what all tables share that are written whole."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tautline.results.errors import ResultError, unwritten
from tautline.whole_file import reason_of, whole_file

OTHER_NAME = "name another with -o"
"""What helps, as a rule, where a table cannot be written."""


def heads_of(names: Sequence[str], units: Mapping[str, str]) -> list[str]:
    """Names of columns with their units: ``step [s]``."""
    return [f"{name} [{units[name]}]" if name in units else name for name in names]


def write_rows(
    heads: Sequence[str],
    rows: Iterable[Sequence[Any]],
    path: Path,
    cure: str = OTHER_NAME,
    error_type: type[ResultError] | None = None,
) -> Path:
    """Write a CSV file, whole or not at all; what is None or NaN is an empty cell.

    Parameters
    ----------
    heads : sequence of str
        The first row.
    cure : str
        What helps where it cannot be written, for the message.

    Raises
    ------
    ResultError
        Of the given type, if the file cannot be written; without one, WriteError where the disk is full.
    """
    with written(path, cure, error_type) as waiting, waiting.open("w", newline="", encoding="utf8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows([["" if _lacks(x) else x for x in row] for row in rows])
    return path


@contextmanager
def written(path: Path, cure: str, error_type: type[ResultError] | None) -> Iterator[Path]:
    """As `whole_file`, with errors of the package.

    Raises
    ------
    ResultError
        As of `write_rows`.
    """
    try:
        with whole_file(path) as waiting:
            yield waiting
    except OSError as error:
        if error_type is None:
            raise unwritten(path, error, cure) from None
        raise error_type(path, f"cannot be written: {reason_of(error)}", cure) from None


def _lacks(value: Any) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value))
