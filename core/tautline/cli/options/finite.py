"""Numbers as typer reads them, of which it takes nan and inf: every bound that is compared with nan seems to hold."""

from __future__ import annotations

import math

import typer


def a_number(parameter: typer.CallbackParam, value: float | None) -> float | None:
    """The number of an option that may be infinite, such as a budget that never ends.

    Raises
    ------
    SceneError
        Naming the option, for what is no number.
    """
    if value is not None and math.isnan(value):
        _refuse(parameter, value)
    return value


def finite(parameter: typer.CallbackParam, value: float | None) -> float | None:
    """The number of an option; a callback of every option that is a float.

    Raises
    ------
    SceneError
        Naming the option, for what is not finite.
    """
    if value is not None and not math.isfinite(value):
        _refuse(parameter, value)
    return value


def _refuse(parameter: typer.CallbackParam, value: float) -> None:
    from tautline.scene.errors import option_error

    raise option_error(str(parameter.opts[0]), f"{value:g}", "is not finite", "give a number")
