"""Tension of a string at rest, without friction."""

from __future__ import annotations

import numpy as np

from drillstring.scene.scene import DrillstringScene
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore


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
