"""The J-well scene with some keys changed, run and timed; and the converged runs that others are compared with."""

from __future__ import annotations

import functools
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

import tautline
from benchmarks import ROOT
from drillstring.scene.scene import DrillstringScene
from tautline.integrators.status import StoppedEarly

SCENE = ROOT / "data" / "jwell.yaml"
FINEST, SECOND = 1e-5, 5e-5
"""Steps of the two finest runs by generalized-alpha and projection, s."""
INTERVAL = 0.05


@dataclass(frozen=True)
class Run:
    """A run: wall time of the solver and CPU time of the whole call, s; the result; how it failed, or None."""

    wall: float
    cpu: float
    result: Any
    failure: str | None

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the result."""
        return self.result.attributes

    @property
    def real_time_factor(self) -> float:
        """Wall time of the solver over simulated time."""
        return float(self.attributes["real_time_factor"])

    @property
    def bit(self) -> np.ndarray:
        """Position of the bit (frames, 3), m."""
        return self.result["position"][:, -1]

    @property
    def displacement(self) -> np.ndarray:
        """Bit displacement along the hole since t = 0 (frames,), m."""
        return self.result["bit_depth"] - self.result["bit_depth"][0]


def changed(keys: dict[str, Any]) -> DrillstringScene:
    """The scene with other values at dotted keys."""
    return tautline.read(SCENE).replace(keys)


def run(method: str, step: float, end: float, **keys: Any) -> Run:
    """Run the scene; ``keys`` have two underscores for a dot. A failure is kept with what there was until then."""
    dotted = {key.replace("__", "."): value for key, value in keys.items()}
    scene = changed({"solver.method": method, "solver.step": step, "solver.end": end} | dotted)
    cpu, failure = time.process_time(), None
    try:
        result = tautline.simulate(scene)
    except StoppedEarly as stop:
        result, failure = stop.result, f"{stop.status.name} at {stop.time:.2f} s"
    return Run(result.attributes["wall_time"], time.process_time() - cpu, result, failure)


def friction(static: float, kinetic: float, law: str = "projection") -> dict[str, Any]:
    """Keys of the wall's friction."""
    return {"well__wall__friction": {"static": static, "kinetic": kinetic, "law": law}}


@functools.cache
def converged(static: float, kinetic: float, end: float, step: float = FINEST) -> Run:
    """A run by generalized-alpha with exact friction at a very small step, frames every ``INTERVAL``."""
    keys = friction(static, kinetic) | {"output__interval": INTERVAL}
    return run("generalized-alpha", step, end, **keys)


def rms(difference: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(difference**2)))


def rmse_of_norm(a: np.ndarray, b: np.ndarray) -> float:
    """Eqs 2.172 and 2.173 as printed, m: the difference is that of the norms of the bit's position vector."""
    return rms(np.linalg.norm(a, axis=1) - np.linalg.norm(b, axis=1))


def rmse_of_distance(a: np.ndarray, b: np.ndarray) -> float:
    """The same with the distance between the two positions, m."""
    return rms(np.linalg.norm(a - b, axis=1))
