"""Rough estimates of a crane before it runs: tensions at rest, the load's bounce, which step of RK4 is stable."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crane.assembly.friction import held_stiffness, springs_of
from crane.assembly.layout import Layout, lay_out
from crane.assembly.mesh_damping import HIGHEST, bounce
from crane.assembly.tension_at_rest import heaviest, static_tension
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum
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
        Of the load's bounce on the whole rope as one spring, the highest that there may be, Hz; None where nothing can
        bounce.
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

    def bounce_of(self, rate: float) -> float:
        """Tension, N, that the load's bounce adds and takes where a sudden rate, m/s, begins to lengthen the rope.

        The load is at rest and the rope a spring k = EA/L: a mass M on one fall is swung with v sqrt(k M). On n falls
        it has M/n^2 of the rope's own speed.
        """
        if self.frequency is None:
            return 0.0
        return abs(rate) * self.scene.rope.axial_stiffness / self.path.length / (2.0 * math.pi * self.frequency)

    @property
    def largest_tension(self) -> float:
        """At rest, N; 0 where it is not known."""
        return 0.0 if self.tension is None else float(self.tension.max())

    @property
    def heaviest_tension(self) -> float:
        """The same with loads as far out of the water as winches hoist them, N."""
        heavy = heaviest(self.scene, self.path)
        tension = self.tension if heavy is self.scene else static_tension(heavy, self.path)
        return 0.0 if tension is None else float(tension.max())


def estimate(scene: CraneScene) -> Estimate:
    """Lay a scene out and estimate it, once; raises SceneError for a path that no rope can take."""
    return scene.once("estimate", (scene, stamps(scene.vessel, scene.folder)), lambda: _estimate(scene))


def _estimate(scene: CraneScene) -> Estimate:
    layout = lay_out(scene)
    return Estimate(scene, layout, static_tension(scene, layout.path), bounce(scene, layout.path))


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
