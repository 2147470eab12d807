"""Damping of oscillations between the nodes of a mesh, which are no motion of the rope.

After slack, nodes fly between slack elements and snap one by one; without damping a few elements then show tensions
that a finer mesh does not. What a mesh of n elements cannot carry is at its highest frequency, 2 sqrt(3) wave speeds
over an element. Stress over the rate of strain, c, damps that by omega c / 2 of critical, and slower motions by less in
proportion to their frequency: the load's bounce by a per cent or so.
"""

from __future__ import annotations

import math

from crane.assembly.loads import added_mass_of, pull
from crane.assembly.tension_at_rest import stays_held
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum, End, Sheave

CRITICAL = 1.0
"""Share of critical damping at the highest frequency of an element."""
BOUNCE = 0.01
"""Largest share of critical damping that the load's bounce may be given."""
HIGHEST = 2.0 * math.sqrt(3.0)
"""Highest angular frequency of linear elements with consistent mass, in wave speeds over their length."""


def damping_of(scene: CraneScene, path: Path) -> list[float]:
    """Damping of the rope in every span, s: as the scene says, or where it says nothing what its mesh needs.

    Every drum with a motor counts with its inertia, held or not: what a rope is must not depend on what brakes do in a
    run, nor on how long it is.
    """
    rope = scene.rope
    if rope.damping is not None:
        return [rope.damping] * len(path.spans)
    drums = [drum.radius**2 / drum.inertia for drum in _driven(scene) if drum.inertia]
    speed, frequency = rope.wave_speed, _frequency(scene, path, drums)
    most = math.inf if frequency is None else 2.0 * BOUNCE / (2.0 * math.pi * frequency)
    return [
        min(most, 2.0 * CRITICAL * float(chord) / count / (HIGHEST * speed))
        for chord, count in zip(path.chords, scene.elements, strict=True)
    ]


def bounce(scene: CraneScene, path: Path) -> float | None:
    """Frequency of the load's bounce, Hz; None where nothing can bounce. It is the highest that there may be.

    A drum that its motor turns is a mass too, I / R^2 with the rope on it; one that is surely held all the time is
    none.
    """
    masses = [
        (drum.inertia or 0.0) / drum.radius**2 + scene.rope.mass_per_length * (drum.rope_on_drum or 0.0)
        for drum in _driven(scene)
        if not stays_held(scene, path, drum)
    ]
    return _frequency(scene, path, [1.0 / mass for mass in masses if mass > 0.0])


def _driven(scene: CraneScene) -> list[Drum]:
    """Drums whose motion follows from torques."""
    return [drum for drum in scene.drums if not drum.prescribed]


def _frequency(scene: CraneScene, path: Path, drums: list[float]) -> float | None:
    """Frequency, Hz, with the whole rope as one spring EA / L: omega^2 = EA / L times what shortens it.

    ``drums`` 1/kg is what each drum that turns adds to `mobility_of` the bodies.
    """
    mobility = mobility_of(scene, path) + sum(drums)
    if mobility == 0.0:
        return None
    return math.sqrt(scene.rope.axial_stiffness / path.length * mobility) / (2.0 * math.pi)


def mobility_of(scene: CraneScene, path: Path) -> float:
    """Acceleration, m/s^2, at which bodies let a tension of 1 N shorten the rope, 1/kg: the sum of pull^2 / mass."""
    rope, mobility = scene.rope, 0.0
    for name, force in pull(scene, path).items():
        body = scene.body(name)
        for c, axis in enumerate("xyz"):
            # A third of the rope's mass on it goes with the load, as with any spring.
            mass = body.mass + added_mass_of(scene, body)[c] + rope.mass_per_length * _hanging(scene, path, name) / 3.0
            # A pull of less is that of a fall a little off plumb: there the load swings, and does not bounce.
            if axis not in body.guide and mass > 0.0 and abs(force[c]) > 0.3:
                mobility += float(force[c]) ** 2 / mass
    return mobility


def _hanging(scene: CraneScene, path: Path, name: str) -> float:
    """Length of the spans that touch a body, m."""
    on = {i for i, item in enumerate(scene.path) if isinstance(item, (End, Sheave)) and item.body == name}
    return sum(span.length for k, span in enumerate(path.spans) if k in on or k + 1 in on)
