"""What a run's frames mean in a hose scene: of the cables' variables those of the hose, its tip, the flow."""

from __future__ import annotations

from typing import Any

import numpy as np

from gardenhose.cables import arc_lengths
from gardenhose.scene import HoseScene
from tautline.cable.model.build import Assembly
from tautline.cable.model.observe import variables as of_cables
from tautline.results.variable import Variable

NOT_STORED = ("material_coordinate", "material_velocity")
"""Variables of cables that say nothing of a hose: its material rests, and the water's moves as one."""


def variables(observer: Observer) -> list[Variable]:
    """Everything that is stored, with units."""
    time, tip = ("time",), ("time", "axis")
    return [
        *(one for one in of_cables(observer.cables) if one.name not in NOT_STORED),
        Variable("tip", tip, "m", "position of the tip"),
        Variable("tip_velocity", tip, "m/s", "velocity of the tip"),
        Variable("flow_speed", time, "m/s", "speed of the water in the hose, in its first piece"),
    ]


class Observer:
    """Turns frames into variables; the hose's nodes and elements come first among the cables'."""

    def __init__(self, scene: HoseScene, made: Assembly, flow: int | None) -> None:
        """``flow`` is the full place of the first stream's p, None without water."""
        self.cables = made.observer
        self.arc_length = arc_lengths(scene)
        self.nodes, self.elements = len(self.arc_length), len(self.arc_length) - 1
        # Water on nodes of its own hangs on the hose: its elements stand behind those of the hose, in the same order.
        carrier = self.cables.carrier
        carrier[self.elements :] = np.arange(len(carrier) - self.elements)
        self.flow = flow

    def coordinates(self) -> dict[str, tuple[Any, np.ndarray, str, str]]:
        """Arrays that do not change with time."""
        return {
            **self.cables.coordinates(),
            "node": ("node", np.arange(1, self.nodes + 1), "", "node, from 1 at the root"),
            "element": ("element", np.arange(1, self.elements + 1), "", "element, from 1 at the root"),
            "arc_length": ("node", self.arc_length, "m", "unstretched distance from the root"),
        }

    def observe(self, frames: Any) -> dict[str, np.ndarray]:
        """Variables of a batch of frames, leading axis time."""
        made = self.cables.observe(frames)
        # What flows towards the tip leaves the nodes' p behind; zero is not to be written as -0.
        speed = np.zeros(len(made["position"])) if self.flow is None else 0.0 - frames.v[:, self.flow]
        for name in NOT_STORED:
            del made[name]
        for name in ("position", "slope", "velocity"):
            made[name] = made[name][:, : self.nodes]
        for name in ("axial_force", "end_force", "curvature"):
            made[name] = made[name][:, : self.elements]
        made["tip"], made["tip_velocity"] = made["position"][:, -1].copy(), made["velocity"][:, -1].copy()
        made["flow_speed"] = speed
        return made
