"""Rows of findings as files: CSV with units in the header, and NetCDF."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tautline.results.errors import ResultError, unwritten
from tautline.version import __version__
from tautline.whole_file import reason_of, whole_file


def heads_of(names: Sequence[str], units: Mapping[str, str]) -> list[str]:
    """Names of columns with their units: ``step [s]``."""
    return [f"{name} [{units[name]}]" if name in units else name for name in names]


def write_rows(
    heads: Sequence[str],
    rows: Iterable[Sequence[Any]],
    path: Path,
    cure: str = "name another with -o",
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
    try:
        with whole_file(path) as waiting, waiting.open("w", newline="", encoding="utf8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(heads)
            writer.writerows([["" if _lacks(x) else x for x in row] for row in rows])
    except OSError as error:
        if error_type is None:
            raise unwritten(path, error, cure) from None
        raise error_type(path, f"cannot be written: {reason_of(error)}", cure) from None
    return path


def _lacks(value: Any) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value))


def write_dataset(
    columns: Mapping[str, Any], coordinates: Mapping[str, Any], attributes: Mapping[str, Any], path: Path
) -> Path:
    """Write columns as an xarray.Dataset into a NetCDF file, with our version; raises ResultError if it cannot be."""
    import xarray

    kept = {key: value for key, value in attributes.items() if value is not None} | {"version": __version__}
    try:
        with whole_file(path) as waiting:
            xarray.Dataset(columns, coordinates, kept).to_netcdf(waiting, engine="h5netcdf")
    except OSError as error:
        raise unwritten(path, error) from None
    return path
