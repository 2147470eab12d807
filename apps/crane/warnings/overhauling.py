"""Loads that are too light to pull the rope over a wheel: of a span that rises far, the rope runs back and goes slack.

At rest and without friction a rope that may pass its upper end freely needs there what a catenary of the span needs.
With w the weight per length, X and Z the level and the upright distance of its ends, and a = H/w,

    T = w a cosh(u + X/2a),   sinh(u) = Z/(2 a sinh(X/2a)),

which no a makes less than some tension. Below it no length of rope in the span is at rest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.layout import carries_nothing
from crane.assembly.loads import pull
from crane.scene.scene import CraneScene, Sheave
from tautline.scene.values.printed import quantity

HARDLY = 1.05
"""Tension over the least one up to which no rest is relied on: so low a rope leaves its wheels elsewhere than drawn."""
STEEPEST = 600.0
"""Of X/2a: beyond it the hyperbolic functions are no numbers."""


def least_tension(across: float, rise: float, weight: float) -> float:
    """Least tension at the upper end of a rope that is at rest between two places, N; see the head of this file.

    Parameters
    ----------
    across, rise : float
        Level and upright distance of its ends, m; zero or more, and not both zero.
    weight : float
        Per length, N/m.
    """
    from scipy.optimize import minimize_scalar

    size = math.hypot(across, rise)
    if across <= 1.0e-9 * size:
        return weight * rise

    def tension(logarithm: float) -> float:
        a = math.exp(logarithm)
        half = across / (2.0 * a)
        return a * math.cosh(math.asinh(rise / (2.0 * a * math.sinh(half))) + half)

    low = math.log(across / (2.0 * STEEPEST))
    return weight * float(minimize_scalar(tension, bounds=(low, math.log(10.0 * size)), method="bounded").fun)


def too_light(found: Estimate) -> Iterator[tuple[str, str]]:
    """Warnings of loads at rest that do not hold the rope of a span: their key and a sentence."""
    scene, path = found.scene, found.path
    gravity = np.array(scene.gravity, float)
    size = float(np.linalg.norm(gravity))
    bar = scene.rope.compression == "elastic" and scene.rope.bending_stiffness > 0.0
    if found.tension is None or size == 0.0 or bar or carries_nothing(scene):
        return
    weight = scene.rope.mass_per_length * size
    for k, span in enumerate(path.spans):
        if any(getattr(item, "body", None) is not None for item in scene.path[k : k + 2]):
            continue  # it hangs with the load, which pulls it straight
        rise = abs(float(span.e @ gravity)) / size * span.length
        across = math.sqrt(max(0.0, span.length**2 - rise**2))
        lacking = HARDLY * least_tension(across, rise, weight) - float(found.tension[k].max())
        if span.length > 0.0 and lacking > 0.0:
            yield _sentence(found, k, lacking)
            return


def _sentence(found: Estimate, k: int, lacking: float) -> tuple[str, str]:
    """Key and words of span k, whose upper end lacks a tension, N."""
    scene = found.scene
    low, high = (k, k + 1) if float(found.path.spans[k].e @ np.array(scene.gravity)) < 0.0 else (k + 1, k)
    # A rope runs over wheels that turn freely: of a winch nothing hangs on the other side.
    wheel = scene.path[high if isinstance(scene.path[high], Sheave) else low].name
    place, more = _heavier(scene, found, lacking)
    length = quantity(found.path.spans[k].length, "m", 3)
    rest = ", and `start: static` finds no rest" if scene.start == "static" else ""
    return place, (
        f"the load is too light for the rope. The {length} of rope from {scene.path[low].name} to "
        f"{scene.path[high].name} pull harder than what hangs beyond {wheel}: at rest, without friction, the rope runs "
        f"back{rest}. {more}"
    )


def _heavier(scene: CraneScene, found: Estimate, lacking: float) -> tuple[str, str]:
    """Key of the mass to change, and by how much; of several loads only that they are to be heavier."""
    size = float(np.linalg.norm(scene.gravity))
    held = {name: abs(float(force @ np.array(scene.gravity))) / size for name, force in pull(scene, found.path).items()}
    hung = [(i, held[body.name]) for i, body in enumerate(scene.bodies) if held.get(body.name, 0.0) > 0.0]
    if len(hung) != 1:
        return "bodies", "Give heavier loads, such as hooks with their weights"
    i, share = hung[0]
    mass = scene.bodies[i].mass + lacking * share / size
    return f"bodies[{i}].mass", f"It needs {quantity(mass, 'kg', 3)} at least, such as a hook with its weight"
