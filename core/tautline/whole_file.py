"""Files that are whole at every moment: written beside, and renamed when they are done."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from uuid import uuid4


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give the name to write under; the file takes its own where the block ends well, else nothing is left of it.

    What was there before stays as it was until then. What is no file on a disk, such as a pipe, is written at once.

    Parameters
    ----------
    path : Path
        Where the file is to be.

    Yields
    ------
    Path
        A name in the same folder, with the same ending.

    Raises
    ------
    OSError
        Where a file cannot be there, or must not be replaced.
    """
    waiting = name_beside(path)
    try:
        yield waiting
        take_name(waiting, path)
    finally:
        if waiting != path:
            with contextlib.suppress(OSError):
                waiting.unlink(missing_ok=True)


def name_beside(path: Path) -> Path:
    """The name under which a file waits until it is whole; its own where it is no file on a disk.

    Raises
    ------
    OSError
        Where a file cannot be there, or must not be replaced: its folder would let us rename another over it.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    if path.exists() and not path.is_file():
        return path
    place = Path(os.path.realpath(path))  # a link stays one
    return place.with_name(f".{place.stem}.{uuid4().hex[:8]}.part{place.suffix}")


def take_name(waiting: Path, path: Path) -> None:
    """Rename a file that is whole; it keeps the permissions of the one that it replaces. Raises OSError."""
    if waiting == path:
        return
    place = os.path.realpath(path)
    with contextlib.suppress(OSError):
        shutil.copymode(place, waiting)
    os.replace(waiting, place)
