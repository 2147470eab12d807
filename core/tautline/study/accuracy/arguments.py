"""What `tautline.study_errors` and `tautline.study_stability` may be given."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from tautline.arguments import (
    ABOVE_ZERO,
    BUDGET,
    COUNT,
    FUNCTION,
    NAME,
    NAMES,
    NUMBERS,
    SWITCH,
    Wanted,
    check_choices,
    check_given,
    check_members,
    check_options,
    is_number,
    is_positive,
    plain,
)
from tautline.errors import ArgumentError
from tautline.scene import methods
from tautline.scene.values.quantity import Quantity
from tautline.study.accuracy.grid import Grid
from tautline.study.trials.trial import Setting

GRID = Wanted("a Grid, such as tautline.Grid(steps=[1e-3, 5e-4])", lambda value: isinstance(value, Grid))
SETTING = Wanted("a Setting", lambda value: isinstance(value, Setting))
TOLERANCE = Wanted('a share, such as 0.01 or "1 %",', is_number)
STEP = Wanted('a finite time above zero, such as 1e-3 or "1 ms",', is_number, is_positive)
MEMBERS = {
    "methods": (NAMES, NAME), "steps": (NUMBERS, STEP), "elements": (NUMBERS, ABOVE_ZERO),
    "constraints": (NAMES, NAME), "newton": (NAMES, NAME),
}  # fmt: skip
"""What is wanted of each list of a grid, and of its members."""
POINT = Wanted("a name", lambda value: isinstance(value, (str, int)))
OF_STABILITY: dict[str, Wanted] = {
    "tolerance": TOLERANCE, "budget": BUDGET, "point": POINT, "quick": SWITCH, "progress": FUNCTION,
}  # fmt: skip
OF_STUDY: dict[str, Wanted] = {
    "tolerance": TOLERANCE, "repeat": COUNT, "budget": BUDGET, "point": POINT, "quick": SWITCH,
    "reference": SETTING, "progress": FUNCTION, "repetitions": COUNT, "reduced": SWITCH,
}  # fmt: skip
SAID = {"quick": "reduced", "repeat": "repetitions"}
"""Arguments of `study` by what the command, and `stability`, call them; either name may be given."""
NEWTON = ("modified", "full")


def as_study_takes(options: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of `study` by its own names, of some that are called as options are; raises ArgumentError."""
    for said, name in SAID.items():
        if said in options and name in options:
            raise ArgumentError(f"{said} and {name} are one argument: leave one of them out")
    return {SAID.get(name, name): one for name, one in options.items()}


def with_share(options: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments with a tolerance as a share, of a text such as ``1 %``; what is none stays, to be refused."""
    return {name: _number(one, "") if name == "tolerance" else one for name, one in options.items()}


def check_study(grid: Any, options: Mapping[str, Any]) -> Grid:
    """Refuse a grid or an option that `study` cannot be given; raises ArgumentError, ArgumentTypeError.

    Returns
    -------
    Grid
        With tuples of what may be gone through only once, and steps in seconds.
    """
    check_given(grid=(grid, GRID))
    lists = {name: _listed(getattr(grid, name)) for name in MEMBERS}
    if isinstance(lists["steps"], tuple):
        lists["steps"] = tuple(_number(one, "s") for one in lists["steps"])
    for name, given in lists.items():
        check_members(f"grid.{name}", given, *MEMBERS[name])
    check_choices("grid.methods", lists["methods"], methods.names())
    check_choices("grid.newton", lists["newton"], NEWTON)
    check_options(options, OF_STUDY)
    return Grid(**{name: given for name, given in lists.items() if given is not None})


def _listed(given: Any) -> Any:
    """A tuple of what is listed, in whatever form; a text or a number stays what it is."""
    if isinstance(given, (str, bytes)) or not isinstance(given, Iterable):
        return given
    if isinstance(given, np.ndarray) and given.ndim == 0:
        return given
    return tuple(plain(one) for one in given)


def _number(given: Any, unit: str) -> Any:
    """A number in a unit, of a text with its own; what is none stays what it is, to be refused by its place."""
    try:
        return Quantity(unit).read(given) if isinstance(given, str) else given
    except PydanticCustomError:
        return given


def check_stability(options: Mapping[str, Any]) -> None:
    """Refuse an option that `stability` cannot be given; raises ArgumentError, ArgumentTypeError."""
    check_options(options, OF_STABILITY)
