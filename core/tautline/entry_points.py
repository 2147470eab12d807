"""Entry points of the packages that are installed, which are looked through once: that takes some 10 ms where there
are two hundred, and a run asks for those of three groups."""

from __future__ import annotations

import functools
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


def in_group(group: str) -> Iterable[EntryPoint]:
    """Those of one group.

    What is installed while a process goes on is seen by the next process, or once another folder is looked in.
    """
    return _all(tuple(sys.path)).get(group, ())


@functools.cache
def _all(folders: tuple[str, ...]) -> dict[str, list[EntryPoint]]:
    from importlib.metadata import entry_points

    everything = entry_points()
    return {group: list(everything.select(group=group)) for group in everything.groups}
