"""How near a string is to the yield of its pipe, at rest and without friction."""

from __future__ import annotations

import numpy as np

from drillstring.scene.scene import DrillstringScene
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.scene.errors import SceneWarning
from tautline.scene.values.printed import shown

LARGEST_SHARE = 0.8
"""Share of the yield load above which a string at rest is warned of: what is left is the margin of overpull."""


def tension_at_rest(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> np.ndarray:
    """Effective tension at the upper end of each section without friction, (sections,) N.

    A frictionless wall does no work along the hole, so from the bit's force on the tension grows by the buoyed weight
    of a metre for every metre of *vertical* depth, whatever the hole's course (C. A. Johancsik et al., 1984).
    """
    fluid = fluid_of(scene.mud)
    ends = np.cumsum([0.0] + [tube.length for tube in lumps.tubes])
    depth = np.diff(well.tvd(ends))
    weight = [weight_in(fluid, tube, scene.gravity) for tube in lumps.tubes]
    return np.cumsum((np.array(weight) * depth)[::-1])[::-1] + scene.bit.load


def yield_warnings(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of sections whose tension at rest is more than `LARGEST_SHARE` of their yield load."""
    tension = tension_at_rest(scene, well, lumps)
    found = []
    for i, section in enumerate(scene.string):
        if section.yield_load is None:
            continue
        largest = float(tension[i])
        share = largest / section.yield_load
        if share > LARGEST_SHARE:
            carried, most = (shown(force, "N", scene.units) for force in (largest, section.yield_load))
            found.append(
                SceneWarning(
                    f"string[{i}].yield_load",
                    f"{section.name} carries {carried} at rest, {100.0 * share:.0f} % of its yield load of {most}; "
                    "take a higher grade, a heavier pipe, or a lighter string below it",
                )
            )
    return found
