"""Values of a NetCDF variable, also where another program has packed them by the CF conventions.

We pack nothing. xarray, NCO and CDO do: numbers become integers with ``scale_factor`` and ``add_offset``, and a number
that is missing becomes ``_FillValue`` or ``missing_value``. See sections 2.5.1 and 8.1 of cfconventions.org.
"""

from __future__ import annotations

import warnings
from typing import Any

import h5py
import numpy as np

from tautline.results.errors import ResultError

CHANGING = ("scale_factor", "add_offset", "_FillValue", "missing_value")
"""Attributes by which values are others than those that are stored."""
MEANT = (*CHANGING, "_Unsigned")
"""All that tells how to read them."""


def values_of(data: h5py.Dataset) -> np.ndarray:
    """All values of a variable, of its shape and in its unit; NaN where one is missing. Texts are as a store has them.

    They are what `xarray.open_dataset` reads: it decodes them here too, and is imported for packed ones only.
    """
    if h5py.check_string_dtype(data.dtype):
        return np.asarray(data.asstr()[...], dtype=str)
    stored: np.ndarray = data[...]
    return stored if not _changes(data) else _decoded(stored, data)


def _changes(data: h5py.Dataset) -> bool:
    """Whether the values are others than those that are stored; that NaN stands for NaN changes none."""
    told = [name for name in CHANGING if h5py.h5a.exists(data.id, name.encode())]
    return any(name not in CHANGING[2:] or not _is_nan(data.attrs[name]) for name in told)


def _is_nan(mark: Any) -> bool:
    return np.asarray(mark).dtype.kind == "f" and bool(np.isnan(mark).all())


def _decoded(stored: np.ndarray, data: h5py.Dataset) -> np.ndarray:
    """The values that stored ones stand for; raises ResultError where what the file says of them makes no sense."""
    import xarray

    told = {name: _one(data.attrs[name]) for name in MEANT if name in data.attrs}
    packed = xarray.Variable(tuple(f"axis {number}" for number in range(stored.ndim)), stored, told)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", xarray.SerializationWarning)  # of two marks of what is missing both hold
            # Times stay numbers, as in a result that is not packed.
            whole = xarray.decode_cf(xarray.Dataset({"values": packed}), decode_times=False, decode_coords=False)
            return np.asarray(whole["values"].values)
    except (TypeError, ValueError, OverflowError):
        said = ", ".join(f"{name} = {value!s}" for name, value in told.items())
        cause = f"'{data.name.lstrip('/')}' is packed in a way that cannot be undone: {said}"
        raise ResultError(data.file.filename, cause, "write it again without packing") from None


def _one(value: Any) -> Any:
    """A value of an attribute, which NetCDF keeps as an array of one."""
    return value.reshape(())[()] if isinstance(value, np.ndarray) and value.size == 1 else value
