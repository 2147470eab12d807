"""What a verb finds in a scene, by name: the rows that a sweep collects."""

from __future__ import annotations

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
