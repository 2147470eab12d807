"""What `tautline.study_errors` and `tautline.study_stability` may be given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tautline.arguments import (
    ABOVE_ZERO,
    COUNT,
    FUNCTION,
    NAMES,
    NUMBERS,
    SWITCH,
    Wanted,
    check,
    check_choices,
    check_options,
    is_number,
)
from tautline.scene import methods
from tautline.study.accuracy.grid import Grid
from tautline.study.trials.trial import Setting

GRID = Wanted("a Grid, such as tautline.Grid(steps=[1e-3, 5e-4])", lambda value: isinstance(value, Grid))
SETTING = Wanted("a Setting", lambda value: isinstance(value, Setting))
TOLERANCE = Wanted("a share, such as 0.01", is_number)
POINT = Wanted("a name", lambda value: isinstance(value, (str, int)))
OF_STABILITY: dict[str, Wanted] = {
    "tolerance": TOLERANCE, "budget": ABOVE_ZERO, "point": POINT, "quick": SWITCH, "progress": FUNCTION,
}  # fmt: skip
OF_STUDY: dict[str, Wanted] = {
    "tolerance": TOLERANCE, "repetitions": COUNT, "budget": ABOVE_ZERO, "point": POINT,
    "reference": SETTING, "progress": FUNCTION, "reduced": SWITCH,
}  # fmt: skip
NEWTON = ("modified", "full")


def check_study(grid: Any, options: Mapping[str, Any]) -> None:
    """Refuse a grid or an option that `study` cannot be given; raises ArgumentError, ArgumentTypeError."""
    check(grid=(grid, GRID))
    lists = {"methods": NAMES, "steps": NUMBERS, "elements": NUMBERS, "constraints": NAMES, "newton": NAMES}
    for name, wanted in lists.items():
        check(**{f"grid.{name}": (getattr(grid, name), wanted)})
    check_choices("grid.methods", grid.methods, methods.names())
    check_choices("grid.newton", grid.newton, NEWTON)
    check_options(options, OF_STUDY)


def check_stability(options: Mapping[str, Any]) -> None:
    """Refuse an option that `stability` cannot be given; raises ArgumentError, ArgumentTypeError."""
    check_options(options, OF_STABILITY)
