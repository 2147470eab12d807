"""Whether a winch that holds a tension swings up by itself: its integral against what damps the rope.

The rope is one spring k = EA/L with the damping c of eq. 2.49. Each drum that turns is a mass m = I/R^2 at its rim, and
bodies on the rope have a mobility b, 1/kg. With the torque R (T0 + P e + J times the integral of e), e = T0 - T, the
stretch of the rope goes by exp(s t), with

    s^3 + (k + c k s) (a s + j) = 0,   a = sum of (1 + P)/m, and b,   j = sum of J/m.

By Routh it does not grow while a c (a + j c) k exceeds j.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.friction import closure_of
from crane.assembly.loads import pull
from crane.assembly.mesh_damping import damping_of, mobility_of
from crane.assembly.tension_at_rest import stays_held
from crane.scene.keys import where
from crane.scene.scene import Drum
from tautline.scene.values.printed import rounded
from tautline.system.time_functions import bounds_of

SEEN = 1.0
"""Growth over the run, as a power of e, from which it is told."""


class Loop(NamedTuple):
    """The loop of a drum: its rim mass m kg, k N/m, c k N s/m, and what is beside it of a, 1/kg, and j, 1/(kg s)."""

    m: float
    k: float
    ck: float
    a: float
    j: float

    def growth(self, proportional: float, integral: float) -> float:
        """Largest real part of the roots for s, 1/s; see the head of this file."""
        a, j = (1.0 + proportional) / self.m + self.a, integral / self.m + self.j
        return float(np.roots([1.0, a * self.ck, a * self.k + j * self.ck, j * self.k]).real.max())

    def largest_integral(self, proportional: float) -> float:
        """Integral, 1/s, up to which nothing grows: j (1 - a c c k) = a a c k; no more than zero where others do it."""
        a = (1.0 + proportional) / self.m + self.a
        left = 1.0 - a * self.ck * self.ck / self.k
        return self.m * (a * a * self.ck / left - self.j) if left > 0.0 else math.inf

    def least_proportional(self, integral: float) -> float:
        """Proportional gain from which on nothing grows; infinite without damping: a a + a j c = j/(c k)."""
        if self.ck == 0.0:
            return math.inf
        j = integral / self.m + self.j
        half = 0.5 * j * self.ck / self.k
        return (math.sqrt(half * half + j / self.ck) - half - self.a) * self.m - 1.0


def control_warnings(found: Estimate) -> Iterator[tuple[str, str]]:
    """Key and text of every winch whose tension swings more and more by its integral."""
    scene = found.scene
    for drum in scene.drums:
        gains, loop = drum.gains, loop_of(found, drum)
        if gains is None or gains.integral == 0.0 or loop is None:
            continue
        growth = loop.growth(gains.proportional, gains.integral)
        if growth * scene.solver.end <= SEEN:
            continue
        held = f" once it is {drum.friction_torque / drum.radius:.3g} N off" if drum.friction_torque else ""
        text = (
            f"the tension that {drum.name} holds swings more and more{held}, twice as much every "
            f"{math.log(2.0) / growth:.3g} s: the integral puts in more than the rope's damping takes out. "
            f"{_cure(loop, gains.proportional, gains.integral)}"
        )
        yield where(scene, drum, "gains.integral"), text


def loop_of(found: Estimate, drum: Drum) -> Loop | None:
    """The loop of a drum with all that turns beside it; None where its own brake holds it, or what holds a load is
    a spring of its own.
    """
    scene, path = found.scene, found.path
    if drum.prescribed or _held(found, drum) or any(scene.body(name).spring for name in pull(scene, path)):
        return None
    others = [one for one in scene.drums if one is not drum and not one.prescribed and not _held(found, one)]
    a, j = mobility_of(scene, path), 0.0
    for one in others:
        proportional, integral = (one.gains.proportional, one.gains.integral) if one.gains else (0.0, 0.0)
        a += (1.0 + proportional) / _rim_mass(one)
        j += integral / _rim_mass(one)
    k = scene.rope.axial_stiffness / path.length
    damping = float(np.average(damping_of(scene, path), weights=path.chords))
    return Loop(_rim_mass(drum), k, damping * k, a, j)


def _held(found: Estimate, drum: Drum) -> bool:
    """Whether a brake holds a drum all the time: surely enough, or closed beside a motor that asks for a tension."""
    scene = found.scene
    if drum.brake is not None and drum.tension is not None:
        return bounds_of(closure_of(drum), scene.solver.end)[0] > 0.0
    return stays_held(scene, found.path, drum)


def _rim_mass(drum: Drum) -> float:
    """Inertia of a drum at its rim, kg."""
    return float(drum.inertia or 0.0) / float(drum.radius) ** 2


def _cure(loop: Loop, proportional: float, integral: float) -> str:
    """What to do: the gains that do, as far as this drum's own can."""
    if loop.ck == 0.0:
        return "Give the rope a `damping:`; without one any integral does it"
    least, most = loop.least_proportional(integral), loop.largest_integral(proportional)
    ways = [f"`proportional: {rounded(least, 2, up=True):g}` or more"]
    if most > 0.0:
        ways.append(f"`integral: {rounded(most, 2):g}` or less")
    return f"Give {', or '.join(ways)}"
