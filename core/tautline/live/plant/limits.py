"""Inputs that stand where a law has a kink, as at a limit: no one number says what they do."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tautline.system.time_functions import Steering


class Limited(NamedTuple):
    """An input at a limit, and the change of the force that differs most, for each unit that it rises and falls."""

    steering: Steering
    above: float
    below: float


def limits_said(found: Sequence[Limited]) -> list[str]:
    """A warning of each input at a limit: what each side is, which one the linear model has, and the ways out."""
    said = {}
    for one in found:
        name, unit = one.steering.name, one.steering.unit or "1"
        has = "rises" if abs(one.above) < abs(one.below) else "falls"
        said[name] = (
            f"{name} stands at a limit. For each {unit} that it rises a force changes by {_number(one.above)}, and for "
            f"each {unit} that it falls by {_number(-one.below)}, in SI. The linear model has what it does when it "
            f"{has}. For the other side give {name}, or what limits it, another value"
        )
    return list(said.values())


def _number(value: float) -> str:
    """With its sign; what is nothing without one."""
    return f"{value:+.4g}" if value else "nothing"
