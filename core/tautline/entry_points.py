"""Entry points of the packages that are installed, which are looked through once: that takes some 10 ms where there
are two hundred, and a run asks for those of three groups. And which code comes with this program, by its package."""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from importlib.metadata import Distribution, EntryPoint


def in_group(group: str) -> Iterable[EntryPoint]:
    """Those of one group.

    What is installed while a process goes on is seen by the next process, or once another folder is looked in.
    """
    return _in_group(group, tuple(sys.path))


@functools.cache
def _in_group(group: str, folders: tuple[str, ...]) -> Iterable[EntryPoint]:
    found: Iterable[EntryPoint] = _all(folders).select(group=group)
    return found


@functools.cache
def _all(folders: tuple[str, ...]) -> Any:
    """Those of all groups; of which class they are differs from Python to Python."""
    from importlib.metadata import entry_points

    return entry_points()


@functools.cache
def packages_of_ours() -> frozenset[str]:
    """The core and the applications that are installed with it."""
    points = in_group("tautline.applications")
    return frozenset({"tautline"} | {package_of(point) for point in points if is_of_ours(point)})


def is_of_ours(point: EntryPoint) -> bool:
    """Whether an entry point comes with this program."""
    dist = getattr(point, "dist", None)
    return dist is not None and _name_of(dist) == "tautline"


@functools.cache
def _name_of(dist: Distribution) -> str:
    """Name of a distribution; Python reads its file and takes it apart for each question, in half a millisecond."""
    return dist.name


def package_of(point: EntryPoint) -> str:
    """The package, or module of one file, in which an entry point is."""
    return point.value.partition(":")[0].partition(".")[0].strip()


def module_of_caller() -> str:
    """Name of the module that has called the function which asks."""
    asking = inspect.currentframe()
    for _ in range(2):
        asking = asking.f_back if asking is not None else None
    return str(asking.f_globals.get("__name__", "")) if asking is not None else ""
