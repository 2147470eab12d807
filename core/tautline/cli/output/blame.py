"""Whose fault an error is that nobody foresaw: the program's, or that of what somebody else added to it."""

from __future__ import annotations

import os
import site
import sys
import sysconfig
from collections.abc import Iterator
from types import FrameType

from tautline import entry_points

GROUPS = ("tautline.applications", "tautline.extensions")
"""Entry points of what is added."""


def place_of(error: BaseException) -> tuple[str, bool]:
    """File and line at which an error arose, and whether the program is to blame.

    The innermost code counts that is of no library: of the program, of a package that adds to it, or of a script.
    """
    found = list(_frames(error))
    if not found:
        return "", True
    frame, line = next(((frame, line) for frame, line in reversed(found) if not _is_of_a_library(frame)), found[-1])
    return f"{frame.f_code.co_filename}:{line}", _is_of_ours(frame) or _is_of_a_library(frame)


def _frames(error: BaseException) -> Iterator[tuple[FrameType, int]]:
    here = error.__traceback__
    while here is not None:
        yield here.tb_frame, here.tb_lineno
        here = here.tb_next


def _package(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__", "")).split(".")[0]


def _is_of_ours(frame: FrameType) -> bool:
    return _package(frame) in entry_points.packages_of_ours()


def _is_of_an_addition(frame: FrameType) -> bool:
    points = (point for group in GROUPS for point in entry_points.in_group(group))
    return _package(frame) in {entry_points.package_of(point) for point in points}


def _is_of_a_library(frame: FrameType) -> bool:
    """Whether code is Python's own, or of an installed package that adds nothing to the program."""
    package = _package(frame)
    if _is_of_ours(frame) or _is_of_an_addition(frame):
        return False
    file = os.path.realpath(frame.f_code.co_filename)
    rooms = {sysconfig.get_path("stdlib"), *site.getsitepackages(), site.getusersitepackages()}
    return package in sys.stdlib_module_names - {"__main__"} or any(
        file.startswith(os.path.realpath(room) + os.sep) for room in rooms if room
    )
