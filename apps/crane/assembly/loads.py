"""What bodies and rope pull at each other with, as far as that is known before a run."""

from __future__ import annotations

import numpy as np

from crane.geometry.reeving import Path
from crane.scene.bodies import Body
from crane.scene.scene import CraneScene, End, Sheave
from tautline.kernels.time_function import value_at
from tautline.system.time_functions import FunctionRequest, compile_functions


def load_of(scene: CraneScene, body: Body) -> float:
    """Weight of a body less its buoyancy, with the force on it at t = 0, along gravity, N; below 0 it goes up."""
    g = np.array(scene.gravity, float)
    size = float(np.linalg.norm(g))
    if size == 0.0:
        return 0.0
    weight = (body.mass - buoyancy_of(scene, body)) * size
    if not body.force:
        return weight
    functions = compile_functions([FunctionRequest(force) for force in body.force])
    force = np.array([value_at(functions, i, 0.0)[0] for i in range(len(body.force))])
    return weight + float(force @ g) / size


def floating(scene: CraneScene, path: Path) -> list[tuple[int, float]]:
    """Bodies that hang on a rope from above and go up: their numbers, and what lifts them more than they weigh, N."""
    up, pulls, found = -np.array(scene.gravity, float), pull(scene, path), []
    for k, body in enumerate(scene.bodies):
        sprung = body.spring is not None and any(body.spring.stiffness)
        free = any(up[c] != 0.0 and axis not in body.guide for c, axis in enumerate("xyz"))
        if body.name in pulls and free and not sprung and pulls[body.name] @ up > 0.0:
            load = load_of(scene, body)
            found += [(k, -load)] if load < 0.0 else []
    return found


def buoyancy_of(scene: CraneScene, body: Body) -> float:
    """Mass of the water that a body takes the place of, kg: it does so at any height."""
    return scene.water.density * body.volume if scene.water is not None else 0.0


def pull(scene: CraneScene, path: Path) -> dict[str, np.ndarray]:
    """By body that the rope touches: the force on it of a tension of 1 N all along the rope, (3,); found once."""
    return scene.once("pull", (scene.path, path), lambda: _pull(scene, path))


def _pull(scene: CraneScene, path: Path) -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    for i, item in enumerate(scene.path):
        if isinstance(item, (End, Sheave)) and item.body is not None:
            found[item.body] = found.get(item.body, np.zeros(3)) + pull_on(path, i)
    return found


def pull_on(path: Path, i: int) -> np.ndarray:
    """Force on item i of the path of a tension of 1 N all along the rope, (3,): the rope shortens that way."""
    leaves = path.spans[i].e if i < len(path.spans) else np.zeros(3)
    comes = path.spans[i - 1].e if i > 0 else np.zeros(3)
    return np.asarray(leaves) - np.asarray(comes)
