"""Tensions that hold the loads at rest without friction; which drums their brakes hold in a run."""

from __future__ import annotations

import numpy as np

from crane.assembly.friction import closure_of, springs_of
from crane.assembly.layout import carries_nothing, sags_of
from crane.assembly.loads import load_of, pull
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum, End, Sheave
from tautline.kernels.time_function import sample
from tautline.scene.functions import FunctionOfTime
from tautline.system.time_functions import FunctionRequest, compile_functions

MOMENTS = 401
"""How many moments of a run are looked at: whether a drum is held then."""


def static_tension(scene: CraneScene, path: Path) -> np.ndarray | None:
    """Tensions that hold the loads or, without a load, the rope, (spans, 2) N; None where they are not known.

    Without friction there is one level all along the rope, but for the weight of what hangs below each point.
    """
    if carries_nothing(scene):
        tension = np.array([sag.tension for sag in sags_of(scene, path)])
        return tension if tension.max() > 0.0 else None
    g = np.array(scene.gravity, float)
    size = float(np.linalg.norm(g))
    if size == 0.0:
        return None
    up = -g / size
    weight = scene.rope.mass_per_length * size * (path.tangents @ up)
    held, load = [], []
    for name, force in pull(scene, path).items():
        body = scene.body(name)
        fixed = body.spring is not None and any(body.spring.stiffness)
        if fixed or set(body.guide) == set("xyz"):
            continue
        held.append(float(force @ up))
        load.append(load_of(scene, body) - _of_weight(scene, path, name, weight, up))
    share = np.array(held)
    if not (share > 1e-6).any():
        return None
    level = float(share @ np.array(load)) / float(share @ share)
    tension = level + weight
    return tension if tension.max() > 0.0 else None


def _of_weight(scene: CraneScene, path: Path, name: str, weight: np.ndarray, up: np.ndarray) -> float:
    """Upward force on a body of the part of the tension that is the rope's weight, N."""
    total = 0.0
    for i, item in enumerate(scene.path):
        if isinstance(item, (End, Sheave)) and item.body == name:
            if i < len(path.spans):
                total += float(path.spans[i].e @ up) * weight[i, 0]
            if i > 0:
                total -= float(path.spans[i - 1].e @ up) * weight[i - 1, 1]
    return total


def stays_held(scene: CraneScene, path: Path, drum: Drum) -> bool:
    """Whether brake and friction of a drum can hold all through a run what the load at rest and the motor leave them.

    Where the tension at rest is not known, they have to hold what the motor does.
    """
    if springs_of(drum) == 0:
        return False
    times = np.linspace(0.0, scene.solver.end, MOMENTS)
    hold = np.full(MOMENTS, drum.friction_torque)
    if drum.brake is not None:
        hold = hold + drum.brake.torque * np.clip(_course(closure_of(drum), times), 0.0, 1.0)
    tension = static_tension(scene, path)
    end = (0, 0) if drum is scene.path[0] else (-1, 1)
    load = 0.0 if tension is None else drum.radius * float(tension[end])
    motor = _course(drum.torque, times) + drum.radius * _course(drum.tension, times)
    return bool((hold >= np.abs(load - motor)).all())


def _course(function: FunctionOfTime | None, times: np.ndarray) -> np.ndarray:
    if function is None:
        return np.zeros(times.size)
    return np.asarray(sample(compile_functions([FunctionRequest(function)]), 0, times)[:, 0])
