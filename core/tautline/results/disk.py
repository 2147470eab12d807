"""What the operating system knows about a file: whether someone has it open, and whether there is room for more."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import signal
from pathlib import Path

from tautline.whole_file import for_hidden

UNSUPPORTED = {errno.EINVAL, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EACCES, errno.EPERM}
HELD = {errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES}
"""What is said of a lock that another holds."""


def is_open_elsewhere(path: Path) -> bool:
    """Whether anyone has a file open, this process included, where the system can tell.

    Linux grants a write lease only on a file that nobody else has open (fcntl(2), F_SETLEASE), so asking for one is
    an exact test, also of readers that take no locks. Elsewhere the answer is False, and HDF5's own locks have to do.

    Raises
    ------
    FileNotFoundError
    """
    with path.open("rb") as file:
        try:
            import fcntl

            # Should anyone open the file before the lease is given back, the default signal would end this process.
            fcntl.fcntl(file, fcntl.F_SETSIG, signal.SIGURG)
            fcntl.fcntl(file, fcntl.F_SETLEASE, fcntl.F_WRLCK)
            fcntl.fcntl(file, fcntl.F_SETLEASE, fcntl.F_UNLCK)
        except (ImportError, AttributeError):
            return False
        except OSError as error:
            return error.errno == errno.EAGAIN
    return False


class Lock:
    """A lock on a name, of the process that writes there; it goes with its process, however that ends.

    The file of the lock is hidden beside the name and removed when the lock is given back. Where the system or the file
    system knows no such locks, it is always granted.
    """

    def __init__(self, path: Path) -> None:
        folder = path.parent.resolve()
        self.file = folder / f".{for_hidden(path.name)}.lock"
        self._number: int | None = None

    def take(self) -> int | None:
        """Take the lock; returns None, or the number of the process that holds it (0 if that is not known)."""
        try:
            import fcntl
        except ImportError:
            return None
        while self._number is None:
            number = os.open(self.file, os.O_RDWR | os.O_CREAT, 0o666)
            try:
                fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                held = _told_in(number)
                os.close(number)
                return held if error.errno in HELD else None
            # Who held it before may have removed the file between our opening and locking it: then it locks nothing.
            if os.fstat(number).st_nlink == 0:
                os.close(number)
                continue
            self._number = number
            os.ftruncate(number, 0)
            with contextlib.suppress(OSError):
                os.write(number, str(os.getpid()).encode())
        return None

    def holder(self) -> int | None:
        """Process that holds the lock (0 if that is not known); None where nobody does, or this object itself."""
        try:
            import fcntl

            number = os.open(self.file, os.O_RDONLY)
        except (ImportError, OSError):
            return None
        try:
            fcntl.flock(number, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError as error:
            return _told_in(number) if self._number is None and error.errno in HELD else None
        finally:
            os.close(number)
        return None

    def give_back(self) -> None:
        """Remove the lock and its file."""
        if self._number is not None:
            self.file.unlink(missing_ok=True)
            os.close(self._number)
            self._number = None


def _told_in(number: int) -> int:
    """Process that an open file of a lock names; 0 for none."""
    held = os.read(number, 20)
    return int(held) if held.isdigit() else 0


def cure_of(path: Path, cure: str) -> str:
    """What to do about a file that cannot be written: to make its folder again where that is gone, else `cure`."""
    folder = path.parent
    return cure if folder.is_dir() else f"the folder {folder} is gone: make it again"


def reserve(path: Path, amount: int) -> None:
    """Make room for a file to grow by `amount` bytes, or fail while that is harmless.

    HDF5 cannot be trusted after a write that failed: a file that could not be closed crashes the process later on.
    So the disk's blocks are taken beforehand; HDF5 cuts off what it did not need when it closes the file.

    Raises
    ------
    OSError
        If the disk is full, or a quota or a limit on file sizes is reached.
    """
    with path.open("ab") as file:
        try:
            os.posix_fallocate(file.fileno(), file.seek(0, os.SEEK_END), amount)
            return
        except AttributeError:
            pass
        except OSError as error:
            if error.errno not in UNSUPPORTED:
                raise
    if shutil.disk_usage(path.parent).free < amount:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
