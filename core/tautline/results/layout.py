"""How a result lies in NetCDF-4: dimensions, variables, attributes, and the raw state to resume from."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tautline.errors import ArgumentError
from tautline.results.headline import to_json
from tautline.results.variable import Variable
from tautline.version import __version__
from tautline.whole_file import legible

FORMAT = "tautline-result 1"
"""The attribute ``format`` by which a result is known for one of ours."""

STRUCTURED = frozenset(
    {"accuracy", "between_frames", "headline", "limits", "start", "step_error", "warnings", "windows"}
)
"""Attributes that are dicts or lists, which a file holds as JSON. Others may look like JSON and be none, as a scene."""

CHUNK = 32768
"""Bytes of a chunk, about: small enough that a short run makes a small file."""

Coordinate = tuple[tuple[str, ...], np.ndarray, str, str]
"""Dimension names, values, unit, long name of something that does not change with time."""

BARE_DIMENSION = b"This is a netCDF dimension but not a netCDF variable. %9d"


def create(
    path: Path,
    variables: Sequence[Variable],
    coordinates: Mapping[str, Coordinate],
    attributes: Mapping[str, Any],
    samples: Mapping[str, np.ndarray],
) -> None:
    """Write a NetCDF-4 file with all variables and no frame.

    Parameters
    ----------
    samples : dict of str to (frames, ...) array
        A batch, for the sizes of the dimensions and the types of the variables.
    """
    sizes = dimensions(variables, coordinates, samples)
    numbers = {dim: number for number, dim in enumerate(sizes)}
    with h5py.File(path, "w", libver=("earliest", "v110"), track_order=True) as file:
        named = set(coordinates) | {variable.name for variable in variables}
        for dim in (dim for dim in sizes if dim not in named):
            _make_bare_dimension(file, dim, sizes[dim] or 0, numbers[dim])
        entries = []
        for name, (dims, values, units, long_name) in coordinates.items():
            texts = values.dtype.kind in "US"
            dtype = h5py.string_dtype() if texts else values.dtype
            entry = file.create_dataset(name, values.shape, dtype, track_order=True)
            entry[...] = values.astype(object) if texts else values
            entries.append((entry, name, dims, units, long_name))
        for variable in variables:
            sample = samples[variable.name]
            rest = sample.shape[1:]
            frames = max(1, CHUNK // max(1, int(np.prod(rest)) * sample.dtype.itemsize))
            most, chunks = (None, *rest), (frames, *(max(1, size) for size in rest))
            entry = file.create_dataset(
                variable.name, (0, *rest), sample.dtype, maxshape=most, chunks=chunks, track_order=True
            )
            entries.append((entry, variable.name, variable.dims, variable.units, variable.long_name))
        _name_dimensions(file, entries, numbers)
        properties = f"version=2,tautline={__version__},h5py={h5py.version.version},hdf5={h5py.version.hdf5_version}"
        write_attributes(file, {"_NCProperties": np.bytes_(properties), "format": FORMAT, **attributes})


def _make_bare_dimension(group: h5py.Group, dim: str, size: int, number: int) -> h5py.Dataset:
    """Add a dimension that no variable is named after: a dataset of its size that readers take for no variable."""
    scale = group.create_dataset(dim, (size,), ">f4", track_order=True)
    scale.make_scale(BARE_DIMENSION % size)
    scale.attrs["_Netcdf4Dimid"] = np.int32(number)
    return scale


def _name_dimensions(file: h5py.File, entries: Sequence[Any], numbers: Mapping[str, int]) -> None:
    """Tell readers the dimensions of each dataset, and what it is.

    A variable of the name of its own dimension is that dimension's scale. The numbers of the dimensions let a reader
    tell two of one size apart without following references.
    """
    for entry, name, dims, *_ in entries:
        if dims == (name,):
            entry.make_scale(name)
            entry.attrs["_Netcdf4Dimid"] = np.int32(numbers[name])
    scales = {dim: h5py.h5d.open(file.id, dim.encode()) for dim in numbers}
    for entry, name, dims, units, long_name in entries:
        if dims != (name,):
            for axis, dim in enumerate(dims):
                h5py.h5ds.attach_scale(entry.id, scales[dim], axis)
        if dims:
            entry.attrs["_Netcdf4Coordinates"] = np.array([numbers[dim] for dim in dims], np.int32)
        for key, text in (("units", units), ("long_name", long_name)):
            if text:
                entry.attrs[key] = text


def dimensions(
    variables: Sequence[Variable], coordinates: Mapping[str, Coordinate], samples: Mapping[str, np.ndarray]
) -> dict[str, int | None]:
    """Size of every dimension, None for ``time``.

    Raises
    ------
    ArgumentError
        If two variables give a dimension two sizes, a variable has not as many axes as dimensions, or one is named
        after a dimension that is not its only one.
    """
    sizes: dict[str, int | None] = {"time": None}
    owners: dict[str, str] = {}
    shapes = {name: (dims, values.shape) for name, (dims, values, _, _) in coordinates.items()}
    shapes |= {variable.name: (variable.dims, samples[variable.name].shape) for variable in variables}
    for name, (dims, shape) in shapes.items():
        if len(dims) != len(shape):
            raise ArgumentError(f"{name}: {len(shape)} axes, but its dimensions are {dims}")
        for dim, size in zip(dims, shape, strict=True):
            if dim != "time" and sizes.setdefault(dim, size) != size:
                raise ArgumentError(f"{name}: {dim} has size {size}, but {sizes[dim]} in {owners[dim]}")
            owners.setdefault(dim, name)
    for name, (dims, _) in shapes.items():
        if name in sizes and dims != (name,):
            raise ArgumentError(f"{name}: named after a dimension, but its dimensions are {dims}")
    return sizes


def append(path: Path, batches: Sequence[tuple[int, Mapping[str, np.ndarray]]]) -> None:
    """Add batches of frames, each at its first frame's index, and close the file.

    h5py's low-level calls do this in a third of the time of ``dataset[n:] = values``.

    Raises
    ------
    BlockingIOError, OSError
        If the file cannot be opened, because another process reads it or it is gone; or cannot be written.
    """
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_fclose_degree(h5py.h5f.CLOSE_STRONG)
    access.set_libver_bounds(h5py.h5f.LIBVER_EARLIEST, h5py.h5f.LIBVER_V110)
    file = h5py.h5f.open(os.fsencode(path), h5py.h5f.ACC_RDWR, access)
    try:
        for name in batches[0][1]:
            dataset = h5py.h5d.open(file, name.encode())
            last, values = batches[-1][0], batches[-1][1][name]
            dataset.set_extent((last + len(values), *values.shape[1:]))
            space = dataset.get_space()
            for start, batch in batches:
                values = batch[name]
                space.select_hyperslab((start,) + (0,) * (values.ndim - 1), values.shape)
                dataset.write(h5py.h5s.create_simple(values.shape), space, values)
    finally:
        file.close()


def bytes_needed(batches: Sequence[Mapping[str, np.ndarray]]) -> int:
    """Bytes that a file may grow by when batches are added, at most: chunks are allocated whole."""
    return 1_000_000 + sum(array.nbytes + 3 * CHUNK for batch in batches for array in batch.values())


def size(values: Mapping[str, Any]) -> int:
    """Bytes of attributes or arrays, about, and rather too many."""
    return sum(value.nbytes if isinstance(value, np.ndarray) else 4 * len(str(value)) for value in values.values())


def encoded(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes as a file holds them: numbers and texts; dicts and lists become JSON, and None is left out."""
    held: dict[str, Any] = {}
    for key, value in attributes.items():
        if isinstance(value, np.generic):
            value = value.item()
        if value is None:
            continue
        if isinstance(value, bool):
            value = int(value)
        if isinstance(value, str):
            value = legible(value)
        held[key] = value if isinstance(value, (str, bytes, int, float)) else to_json(value)
    return held


def decoded(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes of a file with the structured ones as dicts and lists."""
    return {key: json.loads(value) if key in STRUCTURED and value else value for key, value in attributes.items()}


def write_attributes(file: h5py.File, attributes: Mapping[str, Any]) -> None:
    """Set attributes, see `encoded`. Text of any length is kept."""
    for key, value in encoded(attributes).items():
        file.attrs[key] = value


def write_restart(file: h5py.File, arrays: Mapping[str, np.ndarray]) -> None:
    """Keep arrays as they are in the group ``restart``; their dimensions are named by their sizes.

    Where the group is there, its arrays are replaced: those of one run keep their names and shapes. As above, by
    low-level calls: this is done with each batch, of some seventy arrays.
    """
    numbers = {name: as_number(np.asarray(values)) for name, values in arrays.items()}
    if "restart" in file:
        group_id = h5py.h5g.open(file.id, b"restart")
        for name, values in numbers.items():
            _fill(h5py.h5d.open(group_id, name.encode()), values)
        return
    group = file.create_group("restart")
    scales: dict[Any, Any] = {}
    made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    made.set_obj_track_times(False)
    for name, values in numbers.items():
        kind, shape = h5py.h5t.py_create(values.dtype, logical=True), h5py.h5s.create_simple(values.shape)
        dataset = h5py.h5d.create(group.id, name.encode(), kind, shape, made)
        _fill(dataset, values)
        for axis, size in enumerate(values.shape):
            dim = f"size_{size}"
            if dim not in scales:
                scales[dim] = _make_bare_dimension(group, dim, size, 1000 + len(scales))
            h5py.h5ds.attach_scale(dataset, scales[dim].id, axis)


def as_number(values: np.ndarray) -> np.ndarray:
    """Values as NetCDF has them, which knows no truth values."""
    return values.astype(np.int8) if values.dtype.kind == "b" else values


def _fill(dataset: h5py.h5d.DatasetID, values: np.ndarray) -> None:
    """Write all of a dataset."""
    if values.size:
        dataset.write(h5py.h5s.ALL, h5py.h5s.ALL, np.ascontiguousarray(values))
