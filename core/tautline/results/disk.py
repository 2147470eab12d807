"""What the operating system knows about a file: whether someone has it open, and whether there is room for more."""

from __future__ import annotations

import errno
import os
import shutil
import signal
from pathlib import Path

UNSUPPORTED = {errno.EINVAL, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.EACCES, errno.EPERM}


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
