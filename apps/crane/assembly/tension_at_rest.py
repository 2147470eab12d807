"""Tensions that hold the loads at rest without friction; which drums their brakes surely hold in a run."""

from __future__ import annotations

import numpy as np

from crane.assembly.friction import closure_of, springs_of
from crane.assembly.layout import carries_nothing, sags_of
from crane.assembly.loads import heaviest, load_of, pull
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum, End, Sheave
from tautline.system.time_functions import bounds_of

MARGIN = 2.0
"""How many times the load at rest holds a drum surely: a load in motion pulls more than that at rest."""


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
    """Whether brake and friction of a drum surely hold it all through a run: they can hold `MARGIN` times the load.

    That is the load at rest, with and without the motor. Friction beside a motor that is on does not count: the motor
    overcomes it. A motor that seeks a tension takes what torque it needs. Where no load is known nothing is sure.
    """
    tension, end = static_tension(heaviest(scene), path), scene.solver.end
    if springs_of(drum) == 0 or drum.torque is None or tension is None:
        return False
    motor = bounds_of(drum.torque, end)
    hold = drum.friction_torque if motor == (0.0, 0.0) else 0.0
    if drum.brake is not None:
        hold += drum.brake.torque * min(1.0, max(0.0, bounds_of(closure_of(drum), end)[0]))
    load = drum.radius * float(tension[(0, 0) if drum is scene.path[0] else (-1, 1)])
    return hold >= MARGIN * max(abs(load - torque) for torque in (0.0, *motor))
