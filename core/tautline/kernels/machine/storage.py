"""Where compiled kernels are kept: a folder of our own, named by a hash of all kernel sources.

Numba keeps a compiled function under the contents of its own file only: an edited callee in another file leaves a stale
caller behind (numba issue 1833). Here a changed kernel means a new folder; nobody ever has to delete one, and old ones
that carry our mark are removed. Where nothing can be kept, it is said once and a temporary folder takes its place.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

from tautline.kernels.machine import sources
from tautline.kernels.machine.settings import PLAIN, UNFUSED

FOLDERS_KEPT = 6
"""Cache folders kept beside the one in use: other checkouts and versions that a user may go back to."""
OWN = "tautline-kernels"
"""The folder below the one that ``TAUTLINE_CACHE`` names, in which all of ours is."""
MARK = ".made-by-tautline"
"""A file in each folder that we made, and may therefore remove."""
SHIPPED = Path(__file__).parents[1] / "compiled"
"""Folders of compiled code that a wheel brings (``.ci/wheels.py``); nothing is written there."""
MADE_FOR = "MADE_FOR"
"""A file there that names the versions that the code is for."""
NAME = re.compile("[0-9a-f]{16}")


def root() -> Path:
    """Where the folders of all versions are.

    Raises
    ------
    OSError
        Where the user's cache has no place: there is no home.
    """
    named = os.environ.get("TAUTLINE_CACHE", "").strip()
    try:
        if named:
            return Path(named).expanduser().absolute() / OWN
        from platformdirs import user_cache_path

        base = user_cache_path("tautline", appauthor=False)
    except RuntimeError as error:
        raise OSError(str(error)) from None
    if not base.is_absolute():
        raise OSError("there is no home folder")
    return base / OWN


@functools.cache
def name() -> str:
    """Name of this version's folder."""
    return sources.hash_of_sources("plain" if PLAIN else "parts", "unfused" if UNFUSED else "fused")


@functools.cache
def kept_folder() -> Path | None:
    """Folder of this version's kernels, None where there cannot be one; it may be one that can only be read."""
    try:
        return root() / name()
    except OSError:
        return None


@functools.cache
def shipped_folder() -> Path | None:
    """Folder of compiled code that came with the installation and is of these sources and this numba, None without."""
    folder = SHIPPED / name()
    return folder if folder.is_dir() else None


def shipped_for() -> str | None:
    """What the installed code is for, in words, where it is of no use: other versions, or sources since changed."""
    if shipped_folder() is not None:
        return None
    with contextlib.suppress(OSError):
        return (SHIPPED / MADE_FOR).read_text(encoding="utf8").strip()
    return None


@functools.cache
def folder_to_write() -> Path | None:
    """Folder in which kernels are kept from now on: the same, a temporary one, or none, which is said once."""
    try:
        folder = root() / name()
        _make(folder)
        _prune(folder.parent, keep=folder)
        return folder
    except OSError as error:
        cause = error
    with contextlib.suppress(OSError):
        base = tempfile.mkdtemp(prefix="tautline-")
        atexit.register(shutil.rmtree, base, ignore_errors=True)
        folder = Path(base) / OWN / name()
        _make(folder)
        kept = "this run keeps it in a temporary folder, and each run compiles anew"
        say(f"compiled code cannot be kept ({_cause(cause)}): {kept}")
        return folder
    say(f"compiled code cannot be kept ({_cause(cause)}): this run compiles anew what it needs")
    return None


def is_kept() -> bool:
    """Whether what this process compiles is there for later ones; False once something could not be written."""
    try:
        return folder_to_write() == root() / name() and not _told
    except OSError:
        return False


def base_to_write() -> Path | None:
    """What ``TAUTLINE_CACHE`` has to name for another process to write where this one does."""
    folder = folder_to_write()
    return folder.parent.parent if folder else None


def _make(folder: Path) -> None:
    """Make a folder with our mark, or see that it can be written to."""
    folder.mkdir(parents=True, exist_ok=True)
    mark = folder / MARK
    if not mark.is_file():
        mark.write_text("Kernels compiled by Tautline, which removes this folder when it is old.\n", encoding="utf8")
    tempfile.TemporaryFile(dir=folder).close()
    with contextlib.suppress(OSError):
        os.utime(folder)


def _prune(parent: Path, keep: Path) -> None:
    """Remove old folders that carry our mark, none through a link."""
    with contextlib.suppress(OSError):
        made = [f for f in parent.iterdir() if f != keep and _is_our_own(f)]
        made.sort(key=lambda f: f.stat().st_mtime)
        for folder in made[: max(0, len(made) - FOLDERS_KEPT)]:
            shutil.rmtree(folder, ignore_errors=True)


def _is_our_own(folder: Path) -> bool:
    mark = folder / MARK
    plain = not folder.is_symlink() and folder.is_dir() and mark.is_file() and not mark.is_symlink()
    return plain and NAME.fullmatch(folder.name) is not None


def _cause(error: OSError) -> str:
    return f"{error.filename}: {error.strerror}" if error.strerror and error.filename else str(error)


@functools.cache
def say(sentence: str) -> None:
    """Print a warning, once in a process."""
    with contextlib.suppress(OSError, AttributeError, ValueError):
        print(f"warning: {sentence}. It is only slower. TAUTLINE_CACHE names another folder.", file=sys.stderr)


def say_not_kept(cause: str) -> None:
    """Say that what was compiled could not be written, with the first cause only."""
    if not _told:
        _told.append(cause)
        say(f"compiled code could not be kept ({cause}): the next run compiles it again")


_told: list[str] = []
