"""A crane's part of a twin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from crane.scene.scene import CraneScene
from tautline.twin.family import Blow
from tautline.twin.map import TwinMap

SPEED = 0.01
"""Size of a blow that sets off the free bounce of a load, m/s: small enough to keep what sticks and slips as it is."""


class CraneExtras:
    """What the twin asks of a crane.

    Attributes
    ----------
    outputs : dict
        Name -> unit of what it tells beside the outputs of the simulation.
    blows : list of Blow
        Free motions: loads that bounce on their ropes.
    """

    def __init__(self, scene: CraneScene, map: TwinMap) -> None:
        self.scene = scene
        self.outputs: dict[str, str] = {}
        up = [-g for g in scene.gravity]
        size = sum(g * g for g in up) ** 0.5
        axis = [g / size for g in up] if size > 0.0 else [0.0, 0.0, 1.0]
        self.blows = [
            Blow(f"{body.name}.velocity", tuple(SPEED * x for x in axis), late)
            for body in scene.bodies for late in (False, True)
        ]  # fmt: skip

    def before(self, time: float, values: Mapping[str, float]) -> None:
        """Say how a row is to be taken; None for as it is."""

    def after(self, time: float, sim: Any, values: Mapping[str, float], outputs: Mapping[str, Any]) -> dict[str, Any]:
        """Further outputs of a row."""
        return {}

    def alarms(self, time: float) -> Iterator[tuple[str, bool, str]]:
        """Further alarms: name, whether it holds, text."""
        return iter(())

    def save(self) -> None:
        """Write what is kept over operations."""

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
