"""Whether a winch that holds a tension swings up by itself: its integral against what damps the rope.

The rope is one spring k = EA/L with the damping c of eq. 2.49, the drum a mass m = I/R^2 at its rim, and whatever ends
or bends the rope elsewhere a mobility b, 1/kg: bodies, and drums that are driven by a torque. With e = T0 - T and the
torque R (T0 + P e + J times the integral of e) the stretch of the rope goes by exp(s t), with

    s^3 + (k + c k s) (a s + J/m) = 0,   a = (1 + P)/m + b.

By Routh it does not grow while a c (a + J c/m) k exceeds J/m.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.mesh_damping import damping_of, mobility_of
from crane.scene.keys import where
from crane.scene.scene import Drum

SEEN = 1.0
"""Growth over the run, as a power of e, from which it is told."""


def control_warnings(found: Estimate) -> Iterator[tuple[str, str]]:
    """Key and text of every winch whose tension swings more and more by its integral."""
    scene = found.scene
    for drum in scene.drums:
        gains = drum.gains
        if gains is None or gains.integral == 0.0:
            continue
        growth = growth_of(found, drum, gains.proportional, gains.integral)
        if growth * scene.solver.end <= SEEN:
            continue
        cure = f"give `integral: {_rounded(_largest_integral(found, drum)):g}` or less"
        if (least := _least_proportional(found, drum)) is not None:
            cure = f"give `proportional: {_rounded(least, up=True):g}` or more, or {cure[5:]}"
        if scene.rope.damping == 0.0:
            cure = "give the rope a `damping:`; without one any integral does it"
        text = (
            f"the tension that {drum.name} holds swings more and more, {math.exp(growth):.3g} times a second: the "
            f"integral puts in more than the rope's damping takes out, but for friction; {cure}"
        )
        yield where(scene, drum, "gains.integral"), text


def growth_of(found: Estimate, drum: Drum, proportional: float, integral: float) -> float:
    """Largest real part of the roots for s, 1/s; see the head of this file."""
    m, b, k, ck = _loop(found, drum)
    a, j = (1.0 + proportional) / m + b, integral / m
    return float(np.roots([1.0, a * ck, a * k + j * ck, j * k]).real.max())


def _loop(found: Estimate, drum: Drum) -> tuple[float, float, float, float]:
    """m kg, b 1/kg, k N/m and c k N s/m."""
    scene, path = found.scene, found.path
    k = scene.rope.axial_stiffness / path.length
    damping = float(np.average(damping_of(scene, path), weights=path.chords))
    others = sum(1.0 / _rim_mass(one) for one in scene.drums if one is not drum and not one.prescribed)
    return _rim_mass(drum), mobility_of(scene, path) + others, k, damping * k


def _rim_mass(drum: Drum) -> float:
    """Inertia of a drum at its rim, kg."""
    return float(drum.inertia or 0.0) / float(drum.radius) ** 2


def _largest_integral(found: Estimate, drum: Drum) -> float:
    """Integral, 1/s, from which on the tension swings up, with the gain that the scene has."""
    m, b, k, ck = _loop(found, drum)
    gains = drum.gains
    a = (1.0 + (gains.proportional if gains else 0.0)) / m + b
    left = 1.0 - a * ck * ck / k
    return m * a * a * ck / left if left > 0.0 else math.inf


def _least_proportional(found: Estimate, drum: Drum) -> float | None:
    """Proportional gain up to which the tension swings up; None where no gain helps."""
    m, b, k, ck = _loop(found, drum)
    if ck == 0.0 or drum.gains is None:
        return None
    # a^2 + a J c/m = J/(m c k)
    half, right = 0.5 * drum.gains.integral * ck / (k * m), drum.gains.integral / (m * ck)
    return (math.sqrt(half * half + right) - half - b) * m - 1.0


def _rounded(x: float, up: bool = False) -> float:
    """Two digits, towards the side on which it holds."""
    if x <= 0.0 or not math.isfinite(x):
        return x
    unit = 10.0 ** (math.floor(math.log10(x)) - 1)
    return (math.ceil if up else math.floor)(x / unit) * unit
