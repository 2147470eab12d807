"""Attributes of a NetCDF-4 file as numbers and texts, whichever library has written them."""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np


def attributes_of(thing: h5py.File | h5py.Dataset) -> dict[str, Any]:
    """Attributes of a file or a variable as numbers and texts, whoever has written them.

    Other libraries keep a text as bytes of a fixed length, and a number as an array of one.
    """
    return {key: _plain(value) for key, value in thing.attrs.items() if not key.startswith(("_NC", "_Netcdf4"))}


def _plain(value: Any) -> Any:
    if isinstance(value, h5py.Empty):
        return ""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(())[()]
    value = value.item() if isinstance(value, np.generic) else value
    return value.decode("utf8", "replace") if isinstance(value, bytes) else value


def mark_of(file: h5py.File) -> str:
    """What a file says of its format; empty for one that says nothing."""
    return str(_plain(file.attrs.get("format", "")))
