"""A table that grows row by row, and never holds half a row."""

from __future__ import annotations

import csv
import errno
import io
import os
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from tautline.results.errors import WriteError
from tautline.whole_file import name_beside, take_name

CURE = "name another file with -o, or make room"


class WholeLines:
    """Writes rows beside a file, and gives it their place when they are to be kept; else it is as it was.

    A row that finds no room on the disk is taken off again. What is no file on a disk, such as a pipe, gets its rows at
    once.

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._beside = path

    def __enter__(self) -> Self:
        """Begin; raises WriteError where there can be no file."""
        try:
            self._beside = name_beside(self.path)
            self._file = self._beside.open("wb", buffering=0)
        except OSError as error:
            raise self._error(error) from None
        return self

    def write(self, row: Sequence[str]) -> None:
        """Write a row; raises WriteError where there is no room for all of it."""
        text = io.StringIO()
        csv.writer(text).writerow(row)
        line, begin = text.getvalue().encode(), self._file.tell() if self._file.seekable() else None
        try:
            if self._file.write(line) != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError as error:
            if begin is not None:
                self._file.truncate(begin)
            raise self._error(error) from None
        except BaseException:  # Ctrl-C within the row
            if begin is not None:
                self._file.truncate(begin)
            raise

    def keep(self) -> None:
        """Give the file the rows that were written."""
        self._file.close()
        if self._beside != self.path:
            try:
                take_name(self._beside, self.path)
            except OSError as error:
                raise self._error(error) from None

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Leave nothing beside."""
        self._file.close()
        if self._beside != self.path:
            self._beside.unlink(missing_ok=True)

    def _error(self, error: OSError) -> WriteError:
        return WriteError(self.path, f"cannot be written: {error.strerror or error}", CURE)
