"""What a linear model holds still although a run moves it: what sticks, and what goes on by itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from tautline.kernels.groups import Stuck, known_of
from tautline.kernels.jit import in_python
from tautline.system.system import System

NAMED = 3
"""Things that a warning names; of more it says how many there are."""


class Named(NamedTuple):
    """What sticks, with the name of what it belongs to."""

    name: str
    stuck: Stuck

    @property
    def told(self) -> str:
        """What it is, what holds it, up to which force or torque, and what that is now, where these are known."""
        most = f" than {self.stuck.most:.4g} {self.stuck.unit}" if math.isfinite(self.stuck.most) else ""
        now = f", now {self.stuck.now:.4g} {self.stuck.unit}" if math.isfinite(self.stuck.now) else ""
        return f"{self.name}: {self.stuck.text}{most}{now}"


def what_sticks(system: System, time: float) -> list[Named]:
    """What sticks in a system at a time, s; its residual was asked for at that time."""
    with in_python():
        found = [one for g in system.groups if (sticks := known_of(g).sticks) for one in sticks(g, time)]
    return [Named(one.name or system.places[one.place].rpartition(": ")[0], one) for one in found]


def stuck_said(found: Sequence[Named]) -> list[str]:
    """One warning of all that sticks, with the ways out; none where nothing does."""
    if not found:
        return []
    some = ". ".join(one.told for one in found[:NAMED])
    more = len(found) - NAMED
    rest = f". {more} more stick: plant.stuck lists them" if more > 0 else ""
    cures = list(dict.fromkeys(one.stuck.cure for one in found if one.stuck.cure))
    ways = ", or ".join(["Advance the simulation until it slips", *cures])
    return [f"what sticks never moves in the linear model: it answers small changes alone. {some}{rest}. {ways}"]


def held_said(held: Sequence[str]) -> list[str]:
    """A warning of each thing that goes on in a run and is held still in a linear model."""
    return [
        f"{thing} is constant in the linear model but changes in a run. The model is valid only for frequencies well "
        "above that change"
        for thing in held
    ]
