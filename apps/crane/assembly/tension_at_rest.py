"""Tensions that hold the loads at rest without friction; which drums their brakes surely hold in a run."""

from __future__ import annotations

import math

import numpy as np

from crane.assembly.drum_supply import hoisted_spans, reeled_of
from crane.assembly.friction import closure_of, springs_of
from crane.assembly.layout import carries_nothing, sags_of
from crane.assembly.loads import load_of, pull, raised
from crane.geometry.reeving import Path
from crane.scene.bodies import Body
from crane.scene.scene import CraneScene, Drum, End, Sheave
from tautline.system.time_functions import bounds_of

CLEARLY = 1.05
"""Pull of a motor over the tension at rest from which it hoists: of less it holds the load."""
MARGIN = 2.0
"""How many times the load at rest holds a drum surely: a load in motion pulls more than that at rest."""


def static_tension(scene: CraneScene, path: Path) -> np.ndarray | None:
    """Tensions that hold the loads or, without a load, the rope, (spans, 2) N; None where they are not known.

    Without friction there is one level all along the rope, but for the weight of what hangs below each point.
    """
    if carries_nothing(scene):
        tension = np.array([sag.tension for sag in sags_of(scene, path)])
        return tension if tension.max() > 0.0 else None
    weight = rope_weight(scene, path)
    level = balance(scene, path, np.ones_like(weight), weight)
    if level is None:
        return None
    tension = level + weight
    return tension if tension.max() > 0.0 else None


def rope_weight(scene: CraneScene, path: Path) -> np.ndarray:
    """What the rope's weight adds to the tension where the spans begin and end, over that at height 0, (spans, 2) N."""
    return scene.rope.mass_per_length * (path.tangents @ -np.array(scene.gravity, float))


def hung(scene: CraneScene, path: Path) -> list[Body]:
    """Bodies whose weight the rope may hold: no spring and no guide does it for them."""
    bodies = [scene.body(name) for name in pull(scene, path)]
    fixed = [body.spring is not None and any(body.spring.stiffness) for body in bodies]
    return [body for body, held in zip(bodies, fixed, strict=True) if not held and set(body.guide) != set("xyz")]


def balance(scene: CraneScene, path: Path, ratio: np.ndarray, offset: np.ndarray) -> float | None:
    """Tension x, N, with which x ratio + offset holds the loads; of several the nearest in least squares.

    Parameters
    ----------
    ratio, offset : (spans, 2) arrays
        Of the tension where each span begins and ends: a share, and N.

    Returns
    -------
    float or None
        None without gravity, or where what x changes bears no load.
    """
    g = np.array(scene.gravity, float)
    size = float(np.linalg.norm(g))
    if size == 0.0:
        return None
    bodies, up = hung(scene, path), -g / size
    share = np.array([lift(scene, path, body, ratio, up) for body in bodies])
    if not (share > 1e-6).any():
        return None
    load = np.array([load_of(scene, body) - lift(scene, path, body, offset, up) for body in bodies])
    return float(share @ load) / float(share @ share)


def lift(scene: CraneScene, path: Path, body: Body, tension: np.ndarray, up: np.ndarray) -> float:
    """Upward force of the rope on a body, N, of tensions where its spans begin and end, (spans, 2) N."""
    total = 0.0
    for i, item in enumerate(scene.path):
        if isinstance(item, (End, Sheave)) and item.body == body.name:
            if i < len(path.spans):
                total += float(path.spans[i].e @ up) * float(tension[i, 0])
            if i > 0:
                total -= float(path.spans[i - 1].e @ up) * float(tension[i - 1, 1])
    return total


def heaviest(scene: CraneScene, path: Path) -> CraneScene:
    """The scene in which water lifts bodies with a height as little as while winches have them highest.

    Where a motor pulls more than the load weighs in the water, it is taken to come out of it.
    """
    if scene.water is None or all(body.height is None for body in scene.bodies):
        return scene
    loose, rise = hoisted_spans(scene), 0.0
    if loose and any(_hoists(scene, path, drum) for drum in scene.drums if not drum.prescribed):
        rise = math.inf
    elif loose:
        rise = max(0.0, float(reeled_of(scene)[2].max())) / len(loose)
    return raised(scene, rise)


def _hoists(scene: CraneScene, path: Path, drum: Drum) -> bool:
    """Whether the motor of a drum ever pulls clearly more than the load at rest, as drawn."""
    tension, end = static_tension(scene, path), scene.solver.end
    if tension is None:
        return True
    pulls = bounds_of(drum.tension, end)[1] if drum.torque is None else bounds_of(drum.torque, end)[1] / drum.radius
    return pulls > CLEARLY * float(tension[(0, 0) if drum is scene.path[0] else (-1, 1)])


def stays_held(scene: CraneScene, path: Path, drum: Drum) -> bool:
    """Whether brake and friction of a drum surely hold it all through a run: they can hold `MARGIN` times the load.

    That is the load at rest, with and without the motor. Friction beside a motor that is on does not count: the motor
    overcomes it. A motor that seeks a tension takes what torque it needs. Where no load is known nothing is sure.
    """
    tension, end = static_tension(heaviest(scene, path), path), scene.solver.end
    if springs_of(drum) == 0 or drum.torque is None or tension is None:
        return False
    motor = bounds_of(drum.torque, end)
    hold = drum.friction_torque if motor == (0.0, 0.0) else 0.0
    if drum.brake is not None:
        hold += drum.brake.torque * min(1.0, max(0.0, bounds_of(closure_of(drum), end)[0]))
    load = drum.radius * float(tension[(0, 0) if drum is scene.path[0] else (-1, 1)])
    return hold >= MARGIN * max(abs(load - torque) for torque in (0.0, *motor))
