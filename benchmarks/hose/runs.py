"""The hose of Table 2.2 with some keys changed, run and timed; and the references it is compared with."""

from __future__ import annotations

import csv
import json
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

import tautline
from benchmarks import ROOT
from gardenhose.build import build
from gardenhose.motion.limit_cycle import LimitCycle, limit_cycle
from gardenhose.scene import HoseScene
from tautline.integrators.linearise import start_moving
from tautline.integrators.state import new_state
from tautline.integrators.status import StoppedEarly
from tautline.integrators.vibration.critical_step import CriticalStep

SCENE = ROOT / "data" / "hose.yaml"
REFERENCES = ROOT / "tests" / "references"
SPEEDS = (15.0, 25.0, 35.0)
"""Flow speeds of the thesis' Figs 2.29 and 2.30, m/s."""


@dataclass(frozen=True)
class Run:
    """A run: CPU time of the whole call and wall time of the compiled time loop, s; the result; how it failed."""

    cpu: float
    loop: float
    result: Any
    failure: str | None

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the result."""
        return self.result.attributes

    @property
    def end(self) -> np.ndarray:
        """Position of the tip at the end (3,), m."""
        return self.result["tip"][-1]

    @property
    def cycle(self) -> LimitCycle:
        """How the tip moves at the end."""
        return limit_cycle(self.result["time"], self.result["tip"], self.result["tip_velocity"])


def changed(keys: dict[str, Any]) -> HoseScene:
    """The scene with other values at dotted keys."""
    return tautline.read(SCENE).replace(keys)


def run(speed: float | dict[str, Any], end: float, step: float | str = 1e-3, **keys: Any) -> Run:
    """Run the scene at a flow speed, m/s, constant or as a scene writes it; ``keys`` have two underscores for a dot.

    A failure is kept with what there was until then.
    """
    dotted = {key.replace("__", "."): value for key, value in keys.items()}
    scene = changed({"water.speed": speed, "solver.end": end, "solver.step": step} | dotted)
    cpu, failure = time.process_time(), None
    try:
        result = tautline.simulate(scene)
    except StoppedEarly as stop:
        result, failure = stop.result, f"{stop.status.name} at {stop.time:.2f} s"
    return Run(time.process_time() - cpu, result.attributes["wall_time"], result, failure)


def critical_step(speed: float, **keys: Any) -> float:
    """RK4's critical step at the start of a run, s, as the run itself finds it."""
    scene = changed({"water.speed": speed} | {key.replace("__", "."): value for key, value in keys.items()})
    system = build(scene).system
    state = new_state(system)
    start_moving(system, state, 1e-6)
    return CriticalStep(system).search(state, 0.0)[0]


def exact_tip(at: float = 1.0) -> np.ndarray:
    """Position of the tip (3,), m, at 15 m/s from rest, by code that shares nothing with Tautline."""
    with (REFERENCES / "hose_tip.csv").open(encoding="utf8") as file:
        row = next(row for row in csv.DictReader(file) if float(row["t"]) == at)
    return np.array([float(row["x"]), 0.0, float(row["z"])])


def exact_cycles() -> dict[str, Any]:
    """Limit cycles in the plane and critical speeds, from the same code."""
    return json.loads((REFERENCES / "hose_cycles.json").read_text(encoding="utf8"))
