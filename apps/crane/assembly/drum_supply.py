"""Rope that drums give and take over a run, as far as it is prescribed: whether they hold it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.scene.path import no_share, pushing
from crane.scene.scene import CraneScene, Drum
from tautline.kernels.time_function import sample
from tautline.scene.errors import Problem, SceneError
from tautline.scene.functions import FunctionOfTime, Sum, Table
from tautline.system.time_functions import FunctionRequest, bounds_of, compile_functions

SAMPLES = 4001
ROUNDING = 1.0e-9
"""Share of a tension by which a sum that comes down to 0 may be below it."""


class Supply(NamedTuple):
    """What a drum's operator pays out over a run: `time` (n,) s, `paid_out` m since t = 0, and `speed` m/s, (n,)."""

    time: np.ndarray
    paid_out: np.ndarray
    speed: np.ndarray


def supply_of(scene: CraneScene, drum: Drum) -> Supply | None:
    """Prescribed supply of a drum; None where its motion follows from torques. Heave compensation is not in it."""
    if not drum.prescribed:
        return None
    drive, factor = (drum.pay_out, 1.0) if drum.drive == "pay_out" else (drum.speed, drum.radius)
    _, place, _ = scene.key_of(drum)
    end = scene.solver.end
    request = FunctionRequest(drive, integrate=True, end=end, key=f"path[{place}].drum.{drum.drive}", factor=factor)
    time = np.linspace(0.0, end, SAMPLES)
    values = sample(compile_functions([request]), 0, time)
    return Supply(time, values[:, 0], values[:, 1])


def reeled_of(scene: CraneScene) -> tuple[list[Drum], np.ndarray, np.ndarray]:
    """Drums that take rope in by prescription, times (n,) s, and what all prescribed ones take in together, (n,) m."""
    supplies = [(drum, supply) for drum in scene.drums if (supply := supply_of(scene, drum)) is not None]
    if not supplies:
        return [], np.zeros(1), np.zeros(1)
    taken = -np.sum([supply.paid_out for _, supply in supplies], axis=0)
    return [drum for drum, supply in supplies if supply.paid_out.min() < 0.0], supplies[0][1].time, taken


def hoisted_spans(scene: CraneScene) -> list[int]:
    """Numbers of the spans of which just one end rides on a body: those that hoisting shortens."""
    rides = [getattr(item, "body", None) is not None for item in scene.path]
    return [k for k in range(len(rides) - 1) if rides[k] != rides[k + 1]]


def check_drums(scene: CraneScene) -> None:
    """Refuse more rope on a drum than its layers hold, a tension below 0, and a brake closed by less than 0 or over 1.

    Each at the start or later in the run.

    Raises
    ------
    SceneError
        Naming each such drum, how much it would hold and when it is full; or the least tension and when it is held; or
        the share by which the brake is closed and when.
    """
    checks = (_too_much, _pushing, _no_share)
    problems = [problem for drum in scene.drums for check in checks for problem in check(scene, drum)]
    if problems:
        raise SceneError(problems)


def _pushing(scene: CraneScene, drum: Drum) -> list[Problem]:
    """Of a tension to be held that falls below 0 in the run, be it for one of its parts alone."""
    end = float(scene.solver.end)
    if drum.tension is None:
        return []
    least, largest = bounds_of(drum.tension, end)
    if least >= -ROUNDING * max(abs(least), largest):
        return []
    time = np.linspace(0.0, end, SAMPLES)
    tension = sample(compile_functions([FunctionRequest(drum.tension)]), 0, time)[:, 0]
    k = int(np.argmin(tension))
    if tension[k] >= -ROUNDING * max(abs(least), largest):
        return []
    key = (*scene.key_of(drum), "tension")
    return [scene.problem(key, *pushing(float(tension[k]), f"at t = {time[k]:.4g} s"))]


def _no_share(scene: CraneScene, drum: Drum) -> list[Problem]:
    """Of a brake that is to be closed by less than 0 or more than 1 in the run, be it by the sum of several."""
    closed = None if drum.brake is None else drum.brake.closed
    if closed is None:
        return []
    time = np.linspace(0.0, float(scene.solver.end), SAMPLES)
    share = sample(compile_functions([FunctionRequest(_between_rows(closed))]), 0, time)[:, 0]
    k = int(np.argmax(np.abs(share - 0.5)))
    if abs(share[k] - 0.5) <= 0.5 + ROUNDING:
        return []
    key = (*scene.key_of(drum), "brake", "closed")
    return [scene.problem(key, *no_share(float(share[k]), f"at t = {time[k]:.4g} s"))]


def _between_rows(function: FunctionOfTime) -> FunctionOfTime:
    """A function whose tables stay between their rows: that their curve swings beyond them was not asked for."""
    if isinstance(function, Table):
        return function.model_copy(update={"interpolation": "linear"})
    if isinstance(function, Sum):
        return Sum(terms=tuple(_between_rows(term) for term in function.terms))
    return function


def capacity_of(scene: CraneScene, drum: Drum) -> float | None:
    """Rope that a drum's layers hold, m; None where their number or the rope's diameter is not given."""
    diameter = scene.rope.diameter
    return None if drum.layers is None or diameter is None else drum.layers.capacity(diameter)


def _too_much(scene: CraneScene, drum: Drum) -> list[Problem]:
    capacity, layers, diameter = capacity_of(scene, drum), drum.layers, scene.rope.diameter
    if capacity is None or layers is None or diameter is None:
        return []
    key = (*scene.key_of(drum), "layers")
    held = f"{layers.count} layers of {layers.turns} turns hold {capacity:.4g} m"
    cure = "give the drum more turns or layers"
    start = drum.rope_on_drum or 0.0
    supply = supply_of(scene, drum)
    if supply is None:
        return []
    held_then = start - supply.paid_out
    k = int(np.argmax(held_then > capacity))
    if held_then[k] <= capacity:
        return []
    begin = f"beginning with {start:.4g} m" if start else "beginning empty, as no rope_on_drum is given"
    cause = (
        f"{drum.name}, {begin}, would come to {float(held_then.max()):.4g} m of rope, and {held}: it is full at "
        f"t = {supply.time[k]:.4g} s ({layers.pitch_radii(diameter)})"
    )
    return [scene.problem(key, cause, f"{cure}, or hoist less")]
