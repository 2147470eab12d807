"""What to tell of a wall that is too soft for its string: a slip of a unit, more often than not.

No stiffness is implausible by itself: a rod of the laboratory lies in a soft tube. It is the depth to which the string
presses itself into the wall, over the gap that it has there, that tells.
"""

from __future__ import annotations

import numpy as np

from drillstring.results.limits import SNUG
from drillstring.scene.scene import DrillstringScene
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.string.strength import tension_at_rest
from drillstring.well.wellbore import Wellbore
from tautline.scene.doubts import meant, units_that_fit
from tautline.scene.errors import SceneWarning
from tautline.scene.values.printed import shown
from tautline.scene.values.ranges import RANGES

DEEP = 0.5
"""Depth in the wall over the clearance that is warned of; a stabiliser's clearance is taken as `SNUG` at least."""
LEANING = 0.01
"""Sine of the inclination that a vertical hole is taken to have: none is straight."""


def wall_warnings(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of a wall into which the string at rest sinks by its weight, and its tension in bends.

    Weight across the hole and tension over the hole's radius press a metre of string on the wall. Both grow with the
    length of a lump, as the stiffness of its contact does (`drillstring.scene.hole.Wall`), so that the mesh does not
    count.
    """
    wall = scene.well.wall
    if wall is None:
        return []
    places = lumps.measured_depth[1:] - 0.5 * lumps.length
    tubes = [lumps.tubes[k] for k in lumps.section]
    weight = np.array([abs(weight_in(fluid_of(scene.mud), tube, scene.gravity)) for tube in tubes])
    tension = np.abs(tension_at_rest(scene, well, lumps))[lumps.section]
    side = weight * np.maximum(np.sin(well.inclination(places)), LEANING)
    side = np.maximum(side, tension * np.hypot(*well.curvature(places)))
    diameter = np.array([tube.contact_od for tube in tubes])
    # Of a metre of wall: that of a lump of `wall.lumps` in all, by the largest diameter.
    stiffness = wall.stiffness * diameter / diameter.max() / (lumps.total / wall.lumps)
    clearance = 0.5 * (scene.well.diameter - diameter)
    room = np.maximum(clearance, SNUG * scene.well.diameter)
    depth = side / stiffness
    worst = int(np.argmax(depth / room))
    if depth[worst] <= DEEP * room[worst]:
        return []
    enough = wall.stiffness * float(depth[worst] / room[worst]) / DEEP
    far, gap, place = (shown(float(x), "m", scene.units) for x in (depth[worst], clearance[worst], places[worst]))
    text = (
        f"{shown(wall.stiffness, 'N/m', scene.units)} is soft: weight and tension at rest press {tubes[worst].name} by "
        f"about {far} into the wall at {place}, and its clearance is {gap}. {_cure(scene, wall.stiffness, enough)}"
    )
    return [SceneWarning("well.wall.stiffness", text)]


def _cure(scene: DrillstringScene, stiffness: float, enough: float) -> str:
    """What would be stiff enough, with the unit that was perhaps meant."""
    written = None if scene.document is None else scene.document.written("well.wall.stiffness")
    row = RANGES["contact stiffness"]
    fitting = units_that_fit(written or "", row.unit, row, scene.units, lambda value: value >= enough)
    asked = f"{meant(written, fitting[:1], row.unit)}. Else give" if written and fitting else "Give"
    return f"{asked} {shown(enough, 'N/m', scene.units)} or more; 1.0e9 N/m is usual"
