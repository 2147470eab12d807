"""Files that are whole at every moment: written beside, and renamed when they are done."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from uuid import uuid4
from zlib import crc32

DEVICES = (("/", "dev"), ("/", "proc"))
"""Where names are that lead to what a process has open: /dev/stdout may be a file, which others write too."""
KEPT = (errno.EPERM, errno.EACCES, errno.EBUSY, errno.EXDEV)
"""Errors of a name that may not be taken, though its file may be written."""
LONGEST, LONGEST_ENDING = 190, 30
"""Bytes of a name, and of its ending, that hidden files beside it have too: names may have 255."""


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
        A name in the same folder, with the ending that was asked for.

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


def place_of(path: Path) -> Path:
    """Where a file is, or will be: a link stays one, and what it leads to is written."""
    return Path(os.path.realpath(path))


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
    place = place_of(path)
    if path.exists() and not (path.is_file() and os.access(place.parent, os.W_OK) and path.parts[:2] not in DEVICES):
        return path
    ending = path.suffix if len(os.fsencode(path.suffix)) <= LONGEST_ENDING else ""
    return place.with_name(f".{for_hidden(place.stem)}.{uuid4().hex[:8]}.part{ending}")


def for_hidden(name: str) -> str:
    """A name as hidden files beside it begin: one that is long or no UTF-8 is cut, and has a number of its own then."""
    told = os.fsencode(name)
    short = told[:LONGEST].decode(errors="ignore")
    return short if os.fsencode(short) == told else f"{short}.{crc32(told):08x}"


def legible(name: str) -> str:
    """A name as a text that any file can hold: bytes that are no UTF-8 are written as numbers."""
    return name.encode(errors="backslashreplace").decode()


def take_name(waiting: Path, path: Path) -> None:
    """Rename a file that is whole; it keeps the permissions of the one that it replaces. Raises OSError."""
    if waiting == path:
        return
    place = place_of(path)
    with contextlib.suppress(OSError):
        shutil.copymode(place, waiting)
    try:
        os.replace(waiting, place)
    except OSError as error:
        if error.errno not in KEPT or not os.path.isfile(place):
            raise
        shutil.copyfile(waiting, place)  # its folder, or what is mounted there, keeps it from being replaced
        os.unlink(waiting)


def reason_of(error: OSError) -> str:
    """Why a file cannot be written, in one line and without the name that it waits under, both of which HDF5 adds."""
    told = re.search(r"error message = '([^']*)'", str(error))
    return error.strerror or (told[1] if told else str(error).partition("\n")[0].partition(" (file ")[0])
