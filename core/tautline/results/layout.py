"""How a result lies in NetCDF-4: dimensions, variables, attributes, and the raw state to resume from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tautline.results.headline import to_json
from tautline.results.variable import Variable

FORMAT = "tautline-result 1"
"""The attribute ``format`` by which a result is known for one of ours."""

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
    import h5netcdf

    with h5netcdf.File(path, "w", libver=("earliest", "v110")) as file:
        file.dimensions = dimensions(variables, coordinates, samples)
        for name, (dims, values, units, long_name) in coordinates.items():
            dtype = h5py.string_dtype() if values.dtype.kind in "US" else values.dtype
            entry = file.create_variable(name, dims, dtype)
            entry[...] = values.astype(object) if values.dtype.kind in "US" else values
            entry.attrs.update(_described(units, long_name))
        for variable in variables:
            sample = samples[variable.name]
            rest = sample.shape[1:]
            frames = max(1, CHUNK // max(1, int(np.prod(rest)) * sample.dtype.itemsize))
            chunks = (frames, *(max(1, size) for size in rest))
            entry = file.create_variable(variable.name, variable.dims, sample.dtype, chunks=chunks)
            entry.attrs.update(_described(variable.units, variable.long_name))
    with h5py.File(path, "r+") as file:
        write_attributes(file, {"format": FORMAT, **attributes})


def _described(units: str, long_name: str) -> dict[str, str]:
    return {key: text for key, text in (("units", units), ("long_name", long_name)) if text}


def dimensions(
    variables: Sequence[Variable], coordinates: Mapping[str, Coordinate], samples: Mapping[str, np.ndarray]
) -> dict[str, int | None]:
    """Size of every dimension, None for ``time``.

    Raises
    ------
    ValueError
        If two variables give a dimension two sizes, or a variable has not as many axes as dimensions.
    """
    sizes: dict[str, int | None] = {"time": None}
    owners: dict[str, str] = {}
    shapes = {name: (dims, values.shape) for name, (dims, values, _, _) in coordinates.items()}
    shapes |= {variable.name: (variable.dims, samples[variable.name].shape) for variable in variables}
    for name, (dims, shape) in shapes.items():
        if len(dims) != len(shape):
            raise ValueError(f"{name}: {len(shape)} axes, but its dimensions are {dims}")
        for dim, size in zip(dims, shape, strict=True):
            if dim != "time" and sizes.setdefault(dim, size) != size:
                raise ValueError(f"{name}: {dim} has size {size}, but {sizes[dim]} in {owners[dim]}")
            owners.setdefault(dim, name)
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
    file = h5py.h5f.open(str(path).encode(), h5py.h5f.ACC_RDWR, access)
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


def room(batches: Sequence[Mapping[str, np.ndarray]]) -> int:
    """Bytes that a file may grow by when batches are added, at most: chunks are allocated whole."""
    return 1_000_000 + sum(array.nbytes + 3 * CHUNK for batch in batches for array in batch.values())


def size(values: Mapping[str, Any]) -> int:
    """Bytes of attributes or arrays, about, and rather too many."""
    return sum(value.nbytes if isinstance(value, np.ndarray) else 4 * len(str(value)) for value in values.values())


def write_attributes(file: h5py.File, attributes: Mapping[str, Any]) -> None:
    """Set attributes; dicts and lists become JSON, None is left out. Text of any length is kept."""
    for key, value in attributes.items():
        if isinstance(value, np.generic):
            value = value.item()
        if value is None:
            continue
        if isinstance(value, bool):
            value = int(value)
        file.attrs[key] = value if isinstance(value, (str, int, float)) else to_json(value)


def write_restart(file: h5py.File, arrays: Mapping[str, np.ndarray]) -> None:
    """Keep arrays as they are in the group ``restart``; their dimensions are named by their sizes."""
    group = file.create_group("restart")
    for name, values in arrays.items():
        values = np.asarray(values)
        if values.dtype.kind == "b":
            values = values.astype(np.int8)
        dataset = group.create_dataset(name, data=values)
        for axis, size in enumerate(values.shape):
            dim = f"size_{size}"
            if dim not in group:
                scale = group.create_dataset(dim, data=np.zeros(size, np.float32))
                scale.make_scale(BARE_DIMENSION % size)
                scale.attrs["_Netcdf4Dimid"] = np.int32(1000 + len(group))
            dataset.dims[axis].attach_scale(group[dim])
