"""Solver settings that are given beside a scene, by the names of its file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tautline.errors import ArgumentTypeError

Place = tuple[str | int, ...]

SETTINGS = ("method", "step", "end", "rho_inf", "control", "step_error", "interval", "newton", "accuracy")


def overrides(given: Mapping[str, Any], places: Mapping[str, Place]) -> dict[Place, tuple[Any, str]]:
    """Values to replace in a document: key path -> (value, the option that it came from).

    ``rho_inf`` stands for both alphas, and ``control: fixed`` has no error to keep to: what a scene gives of these is
    taken out.

    Parameters
    ----------
    given : mapping
        Some of `SETTINGS`; None keeps what the scene says.
    places : mapping
        Setting, and ``alpha_m`` and ``alpha_f`` -> key path.
    """
    unknown = sorted(set(given) - set(SETTINGS))
    if unknown:
        raise ArgumentTypeError(f"no solver setting is called {unknown[0]!r}: one of {', '.join(SETTINGS)}")
    values: dict[Place, tuple[Any, str]] = {}
    for key, value in given.items():
        if value is None:
            continue
        option = "--" + key.replace("_", "-")
        values[places[key]] = (value, option)
        if key == "rho_inf":
            values |= {places[alpha]: (None, option) for alpha in ("alpha_m", "alpha_f")}
        if key == "control" and value == "fixed":
            values[places["step_error"]] = (None, option)
    return values
