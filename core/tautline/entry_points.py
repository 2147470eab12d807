"""Entry points of the packages that are installed, which are looked through once: that takes some 10 ms where there
are two hundred, and a run asks for those of three groups."""

from __future__ import annotations

import functools
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


def in_group(group: str) -> Iterable[EntryPoint]:
    """Those of one group.

    What is installed while a process goes on is seen by the next process, or once another folder is looked in.
    """
    return _all(tuple(sys.path)).select(group=group)


@functools.cache
def _all(folders: tuple[str, ...]) -> Any:
    """Those of all groups; of which class they are differs from Python to Python."""
    from importlib.metadata import entry_points

    return entry_points()
