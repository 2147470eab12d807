"""What can be wrong with a result file."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from tautline.errors import TautlineError
from tautline.whole_file import reason_of

FULL = frozenset(os.strerror(number) for number in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO))
"""What is said by a disk that has no room, or fails."""


class ResultError(TautlineError):
    """A result that cannot be read or written.

    Attributes
    ----------
    path : Path
        The file, as it was named.
    cause, cure : str
        What is wrong and what to do. ``str()`` is all three.
    written : dict of list of Path
        Files that a command had written by then, by what it calls them: see `naming_written`.
    """

    def __init__(self, path: str | Path, cause: str, cure: str = "") -> None:
        self.path, self.cause, self.cure = Path(path), cause, cure
        self.written: dict[str, list[Path]] = {}
        super().__init__(f"{path}: {cause}; {cure}" if cure else f"{path}: {cause}")

    def translate(self, subject: Callable[[str], str], sentence: Callable[[str], str]) -> None:
        """See `TautlineError.translate`; what it is about may stand in the place of the file."""
        written = self.written
        ResultError.__init__(self, subject(str(self.path)), sentence(self.cause), sentence(self.cure))
        self.written = written


class WriteError(ResultError):
    """Writing failed in mid-run, as on a full disk; what was written before is kept under the result's name."""


@contextmanager
def naming_written(called: str, files: Sequence[Path]) -> Iterator[None]:
    """Let an error that ends the writing of several files name those that are there by then.

    Parameters
    ----------
    called : str
        What ``--json`` lists them under.
    files : sequence of Path
        It grows as they are written.

    Raises
    ------
    ResultError
        That of the block.
    """
    try:
        yield
    except ResultError as error:
        error.written[called] = [*files, *error.written.get(called, ())]
        raise


def unwritten(path: str | Path, error: OSError, cure: str = "name another with -o") -> ResultError:
    """What to raise for a file that cannot be written: WriteError where the disk is why, and else what was asked for.

    Parameters
    ----------
    cure : str
        What helps where the disk has room.
    """
    reason = reason_of(error)
    if reason in FULL:
        return WriteError(path, f"cannot be written: {reason}", f"{cure}, or make room")
    return ResultError(path, f"cannot be written: {reason}", cure)


def once_each(words: str, option: str = "--what") -> str:
    """The cure of several names in one option, ``a,b``: it is written once for each; empty where there is one name."""
    names = [name.strip() for name in words.split(",") if name.strip()]
    return f"write it once for each: {' '.join(f'{option} {name}' for name in names)}" if len(names) > 1 else ""
