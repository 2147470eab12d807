"""Results too large to be held in memory as an xarray data set: their arrays are read when they are used."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray

from tautline.results.errors import ResultError


class Lazy(xarray.Dataset):
    """A data set whose arrays are still in its file, which it does not let be written over.

    A writer empties the file before it asks for the first value.
    """

    __slots__ = ()

    def to_netcdf(self, path: Any = None, *arguments: Any, **more: Any) -> Any:
        """As of `xarray.Dataset`.

        Raises
        ------
        ResultError
            For the path of the file that its arrays are read from.
        """
        encodings: list[Any] = [self.encoding, *(self[name].encoding for name in self.variables)]
        sources = {str(one["source"]) for one in encodings if "source" in one}
        if path is not None and any(_same(path, source) for source in sources):
            cause = "holds the values that are to be written: they would be lost"
            raise ResultError(str(path), cause, "give another name, or call `.load()` first")
        return super().to_netcdf(path, *arguments, **more)


def lazy(path: Path) -> Lazy:
    """Open a file as a data set."""
    opened = xarray.open_dataset(path, engine="h5netcdf")
    made = Lazy(opened.variables, attrs=opened.attrs)
    made.encoding = {"source": str(path)}
    return made


def _same(path: Any, source: str) -> bool:
    try:
        return Path(path).samefile(source)
    except (OSError, TypeError):
        return False
