"""Slack rope that turns round between fixed places in a bight that is narrower than the elements of its mesh.

A straight element hangs half of its weight on either end. At the node in the fold hangs the weight of one element, and
where the legs lie side by side the tauter one of them carries all of it. In truth each leg carries itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.layout import carries_nothing
from crane.geometry.sagging import foot_of_catenary
from tautline.scene.values.ranges import sized

TOLD = 0.02
"""Share of the tension at an end by which it may be off without a word."""
NARROWEST = 1.0e-9
"""Share of its length by which the ends of a rope lie apart where they are plumb above one another."""
LEAST, MOST = 1.0e-12, 1.0e4
"""Level forces between which that of a bight lies, by the weight of the rope."""


def narrow_bights(found: Estimate) -> Iterator[tuple[str, str]]:
    """Key and text of a rope between two fixed places whose tensions at rest are off by its elements; one or none."""
    scene, path, length = found.scene, found.path, found.scene.rope.length
    up = -np.array(scene.gravity, float)
    size = float(np.linalg.norm(up))
    if length is None or size == 0.0 or len(scene.elements) != 1 or not carries_nothing(scene):
        return
    if scene.water is not None or scene.rope.bending_stiffness:
        return  # buoyancy changes along it, and what bends is no polygon
    ends, weight, elements = path.tangents[0], scene.rope.mass_per_length * size, scene.elements[0]
    # What of the rope lies on wheels and drums is taut.
    free = length - float(path.chords.sum()) + path.spans[0].length
    side = int(ends[1] @ up < ends[0] @ up)
    rise = abs(float((ends[1] - ends[0]) @ up)) / size
    level = float(np.linalg.norm(np.cross(ends[1] - ends[0], up))) / size
    across = max(level, NARROWEST * free)
    if free <= math.hypot(across, rise) or across > 0.5 * free:
        return
    stiffness = scene.rope.axial_stiffness
    foot = foot_of_catenary(across, rise, free, weight, stiffness)
    true = np.array([foot, foot + weight * rise])
    meshed = ends_of_polygon(across, rise, free, weight, stiffness, elements)
    if meshed[0] <= 0.5 * weight * free / elements:  # a slack foot, which is told by itself
        return
    off = meshed - true
    if (np.abs(off) <= TOLD * true).all():
        return
    names = [scene.path[side].name, scene.path[1 - side].name]
    told = " and ".join(
        f"the tension at {name} is {sized(abs(by), 'N')} too {'high' if by > 0.0 else 'low'}, "
        f"{100.0 * abs(by) / of:.2g} % of it"
        for name, by, of in zip(names, off, true, strict=True)
    )
    enough = max(elements + 1, math.ceil(0.5 * weight * free / (TOLD * foot)))
    yield (
        "mesh.elements_per_span",
        "the rope turns round in a bight that is narrower than its elements, and one leg carries all of the element at "
        f"the fold. At rest {told}. Take {enough} elements or more, where {elements} are taken",
    )


def ends_of_polygon(
    across: float, rise: float, length: float, weight: float, stiffness: float, elements: int
) -> np.ndarray:
    """Tensions at the lower and the upper end of equal straight elements whose weight hangs on their nodes (2,), N.

    Parameters
    ----------
    across, rise : float
        Level and upright distance of the ends, m.
    length : float
        Unstretched, m.
    weight : float
        N/m.
    stiffness : float
        EA, N.
    elements : int
    """
    from scipy.optimize import brentq

    step, whole = length / elements, weight * length
    hung = (np.arange(elements) + 0.5) * weight * step

    def way(level: float, foot: float) -> np.ndarray:
        """Where the upper end is by the level force and the upright one at the lower end, (across, up)."""
        upright = foot + hung
        along = step * (1.0 / np.hypot(level, upright) + 1.0 / stiffness)
        return np.array([level * along.sum(), along @ upright])

    def foot_at(level: float) -> float:
        far = 2.0 * whole + MOST * level
        return float(brentq(lambda foot: float(way(level, foot)[1]) - rise, -far, far, xtol=1e-13 * whole))

    def lacking(power: float) -> float:
        level = math.exp(power) * whole
        return float(way(level, foot_at(level))[0]) - across

    low, high = math.log(LEAST), math.log(MOST)
    # Where an element is slack in the fold nothing pulls across: it lies as the ends let it.
    power = low if lacking(low) >= 0.0 else float(brentq(lacking, low, high, xtol=1e-9))
    level = math.exp(power) * whole
    foot = foot_at(level)
    return np.array([math.hypot(level, foot), math.hypot(level, foot + whole)])
