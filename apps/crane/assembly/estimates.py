"""Rough estimates of a crane before it runs: tensions at rest, the load's bounce, which step of RK4 is stable."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crane.assembly.friction import held_stiffness, springs_of
from crane.assembly.layout import Layout, carries_nothing, lay_out, sags_of
from crane.assembly.loads import load_of, pull
from crane.assembly.mesh_damping import HIGHEST, bounce
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum, End, Sheave
from tautline.scene.reading.files import stamps

REAL_LIMIT = 2.785294
"""Decay rate times step beyond which RK4 is unstable: 1 - x + x^2/2 - x^3/6 + x^4/24 = 1."""
IMAGINARY_LIMIT = 2.0 * math.sqrt(2.0)
"""Angular frequency times step beyond which RK4 is unstable."""
REACH = 2.8
"""Angular frequency times step that a run of RK4 allows (thesis, eq. 2.137)."""


@dataclass(frozen=True, eq=False)
class Estimate:
    """A scene as drawn, at t = 0.

    Attributes
    ----------
    scene : CraneScene
    layout : Layout
    tension : (spans, 2) array or None
        At rest at both ends of every span, N, without friction; of a rope that holds no body what its own weight and
        its ends make of it. None where a body is held by something else.
    frequency : float or None
        Of the load's bounce on the whole rope as one spring, Hz; None where nothing can bounce.
    """

    scene: CraneScene
    layout: Layout
    tension: np.ndarray | None
    frequency: float | None

    @property
    def path(self) -> Path:
        """The path of the rope."""
        return self.layout.path

    @property
    def impedance(self) -> float:
        """Tension that a sudden metre a second at an end makes, N s/m: sqrt(EA rho)."""
        return math.sqrt(self.scene.rope.axial_stiffness * self.scene.rope.mass_per_length)

    @property
    def largest_tension(self) -> float:
        """At rest, N; 0 where it is not known."""
        return 0.0 if self.tension is None else float(self.tension.max())


def estimate(scene: CraneScene) -> Estimate:
    """Lay a scene out and estimate it, once; raises SceneError for a path that no rope can take."""
    return scene.once("estimate", (scene, stamps(scene.vessel, scene.folder)), lambda: _estimate(scene))


def _estimate(scene: CraneScene) -> Estimate:
    layout = lay_out(scene)
    return Estimate(scene, layout, static_tension(scene, layout.path), bounce(scene, layout.path))


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


def rk4_limit(scene: CraneScene, length: float, damping: float) -> float:
    """Longest step of RK4, s, by rope elements of a length, m, and the damping of their span, s."""
    omega = HIGHEST * scene.rope.wave_speed / length
    ratio = 0.5 * damping * omega
    if ratio <= 1.0:
        return IMAGINARY_LIMIT / omega
    return REAL_LIMIT / (omega * (ratio + math.sqrt(ratio * ratio - 1.0)))


def held_limit(scene: CraneScene, drum: Drum, length: float) -> float:
    """Longest step of RK4, s, by a drum that its brake or its friction holds, with an element of a length, m, at it.

    The rope on the drum turns with it. How much there is later, a drum that goes by its torque does not tell before it
    runs: what there is at the start counts.
    """
    rope = scene.rope
    mass = (drum.inertia or 0.0) / drum.radius**2 + rope.mass_per_length * ((drum.rope_on_drum or 0.0) + length / 3.0)
    return REACH * math.sqrt(mass / (springs_of(drum) * held_stiffness(rope.axial_stiffness, drum)))
