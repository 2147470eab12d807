"""What a rope bears."""

from __future__ import annotations

import math

from crane.scene.scene import CraneScene
from tautline.results.assessment.limits import STEEL, STEEL_STRAIN, STRAIN


def strain_bound(scene: CraneScene) -> float:
    """Strain that the rope cannot bear: where a diameter tells that it is of steel, that of steel."""
    rope = scene.rope
    if rope.diameter is None:
        return STRAIN
    return STEEL_STRAIN if rope.axial_stiffness / (0.25 * math.pi * rope.diameter**2) > STEEL else STRAIN


def longest_strain(scene: CraneScene) -> float:
    """Strain to which a rope can be pulled before it parts: that of its breaking load where that is less."""
    rope, bound = scene.rope, strain_bound(scene)
    return bound if rope.breaking_load is None else min(bound, rope.breaking_load / rope.axial_stiffness)
