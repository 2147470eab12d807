"""What a verb finds in a scene, by name: what a sweep collects of every case."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple


class Finding(NamedTuple):
    """One thing that was found.

    Attributes
    ----------
    value : float, int, str, list of float or None
        In SI. A list has a value for each of what it runs along; None where there is none.
    unit : str
        SI unit; empty for a count or a ratio.
    text : str
        What it is, in words.
    along : str
        Name of the finding that holds the places of a list: ``depth``.
    """

    value: Any
    unit: str = ""
    text: str = ""
    along: str = ""


class Table(NamedTuple):
    """A verb whose findings can be collected.

    Attributes
    ----------
    options : tuple of str
        Names of its options, as on its command line without the dashes.
    read : callable
        Scene, options -> what these ask for; raises SceneError naming the option.
    find : callable
        Scene, what was read -> findings by name; raises StoppedEarly where nothing is found, and SceneError.
    """

    options: tuple[str, ...]
    read: Callable[[Any, Mapping[str, Any]], Any]
    find: Callable[[Any, Any], dict[str, Finding]]
