"""Tables as NetCDF files, as xarray would write them, whole or as they were before.

HDF5 writes much of a file only when it closes it, and h5py has no way to hand on what the disk refuses then: the file
holds zeros in place of numbers, and the interpreter crashes at its end. So HDF5 makes the file in memory, and its bytes
are written as those of any other file.

xarray is not imported: that takes a second with what it imports itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tautline.results.errors import ResultError
from tautline.results.tables.rows import OTHER_NAME, written
from tautline.version import __version__


class Column(NamedTuple):
    """An array with the names of its dimensions, and what it is: ``units`` and ``long_name``."""

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: Mapping[str, str]

    @property
    def is_number(self) -> bool:
        """Whether it holds numbers that may be lacking, and one that is not."""
        return self.values.dtype.kind == "f" and bool(np.isfinite(self.values).any())


def columns_of(entries: Mapping[str, Any]) -> dict[str, Column]:
    """Columns of what xarray takes: name -> (dimension or dimensions, values, attributes)."""
    return {
        name: Column((dims,) if isinstance(dims, str) else tuple(dims), np.asarray(values), about[0] if about else {})
        for name, (dims, values, *about) in entries.items()
    }


def write_columns(
    variables: Mapping[str, Column],
    coordinates: Mapping[str, Column],
    attributes: Mapping[str, Any],
    path: Path,
    cure: str = OTHER_NAME,
    error_type: type[ResultError] | None = None,
) -> Path:
    """Write a dataset as a NetCDF file, whole or not at all.

    Parameters
    ----------
    variables, coordinates : dict of Column
        By name.
    attributes : dict
        Numbers and texts of the dataset.
    cure : str
        What helps where it cannot be written, for the message.

    Raises
    ------
    ResultError
        Of the given type, if the file cannot be written; without one, WriteError where the disk is full.
    """
    made = BytesIO()
    _fill(made, variables, coordinates, attributes)
    with written(path, cure, error_type) as waiting:
        waiting.write_bytes(made.getbuffer())
    return path


def write_dataset(
    entries: Mapping[str, Any], coordinates: Mapping[str, Any], attributes: Mapping[str, Any], path: Path
) -> Path:
    """Write numbers and texts as xarray takes them, see `columns_of`, with our version.

    Attributes that are None are left out. Truth values, None among texts and names with a slash have no place in the
    file: hand over none.

    Raises
    ------
    ResultError
        As of `write_columns`.
    """
    kept = {key: value for key, value in attributes.items() if value is not None} | {"version": __version__}
    return write_columns(columns_of(entries), columns_of(coordinates), kept, path)


def _fill(
    made: BytesIO, variables: Mapping[str, Column], coordinates: Mapping[str, Column], attributes: Mapping[str, Any]
) -> None:
    """Make the file that xarray would write of the same dataset."""
    import h5netcdf
    import h5py

    everything = {**coordinates, **variables}
    aside = {name: one.dims for name, one in coordinates.items() if one.dims != (name,)}
    with h5netcdf.File(made, "w") as file:
        file.dimensions = {
            dim: size
            for one in everything.values()
            for dim, size in zip(one.dims, one.values.shape, strict=True)
        }  # fmt: skip
        for name, one in everything.items():
            text, numbers = one.values.dtype.kind in "OU", one.values.dtype.kind == "f"
            kind = h5py.string_dtype() if text else one.values.dtype
            stored = file.create_variable(name, one.dims, kind, fillvalue=np.nan if numbers else None)
            if one.values.size:
                stored[...] = one.values.astype(object) if text else one.values
            for key, value in one.attrs.items():
                stored.attrs[key] = value
            # The convention by which a reader knows coordinates that are no axes.
            beside = sorted(key for key, dims in aside.items() if set(dims) <= set(one.dims) and " " not in key)
            if beside and name in variables:
                stored.attrs["coordinates"] = " ".join(beside)
        for key, value in attributes.items():
            file.attrs[key] = value
