"""What to tell of a string's beam whose elements are too long to follow its hole.

An element is a cubic that touches the wall in the middles of its halves. Between two of these points the hole leaves
the straight line by about phi h / 32, phi being what it turns by over the length h of the element: h^2 / (32 R) in an
arc. Where that is decimetres a beam cuts across the hole's bends and their ends.

Measured with friction 0.2, picking up, slacking off and turning, in the wells of jwell, iscwsa, field_well and
tripping, on arcs of 300 m and of 100 m to the horizontal and of 600 m to 45 deg, with 2 to 96 elements beside 160: up
to 0.25 m the wall's side force in all differs by 0.6 % at most, from 0.28 m on by up to 1.6 %, at 1 m by up to 4 %.
Hook loads differ by 0.7 % at most up to 1.9 m, and by up to 2.8 % at 6 m; above 7 m half of the strings found no
equilibrium, or were tens of per cent off.
"""

from __future__ import annotations

import numpy as np

from drillstring.model.prepared import tubes_of
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import Lumps, cut
from drillstring.well.wellbore import Wellbore
from tautline.scene.errors import SceneWarning
from tautline.scene.values.printed import shown

SIDE_FORCE, HOOK_LOAD, NOTHING = 0.25, 1.9, 7.0
"""How far, m, the hole may leave a straight line between points of contact until side force or hook load may be off by
more than 1 per cent, and until there may be no equilibrium at all."""
PLACES = 8
"""Of each element, at which the hole's curvature is taken."""
MOST = 2000
"""Elements up to which a mesh that follows the hole is looked for."""


def off_the_line(well: Wellbore, lumps: Lumps) -> np.ndarray:
    """How far the hole leaves a straight line between the points of contact of each element, (n,) m."""
    share = (np.arange(PLACES) + 0.5) / PLACES
    places = lumps.measured_depth[:-1, None] + lumps.length[:, None] * share
    k1, k2 = well.curvature(places.ravel())
    turn = np.hypot(k1, k2).reshape(places.shape).mean(axis=1) * lumps.length
    return turn * lumps.length / 32.0


def mesh_warnings(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of a beam in a hole that is too coarse for it, with how many elements are not."""
    if scene.well.wall is None:
        return []
    off = off_the_line(well, lumps)
    worst = int(np.argmax(off))
    if off[worst] <= SIDE_FORCE:
        return []
    length, away = (shown(float(value), "m", scene.units) for value in (lumps.length[worst], off[worst]))
    cause = f"an element of {length} is long for its hole, which leaves the straight line between the element's points"
    cause += f" of contact by {away}"
    if off[worst] > NOTHING:
        wrong = "there may be no equilibrium, or one that is tens of per cent off"
    elif off[worst] > HOOK_LOAD:
        wrong = "hook loads may be off by more than 1 %, the side force by more than 5 %"
    else:
        wrong = "the side force of the wall may be off by more than 1 %, hook loads by less"
    return [SceneWarning("model.elements", f"{cause}: {wrong}; {_cure(scene, well, lumps.length.size)}")]


def _cure(scene: DrillstringScene, well: Wellbore, now: int) -> str:
    free = scene.model_copy(update={"string": tuple(s.model_copy(update={"elements": None}) for s in scene.string)})
    tubes = tubes_of(free, well.length)
    count = now
    while count < MOST and off_the_line(well, cut(tubes, count)).max() > SIDE_FORCE:
        count += max(1, count // 50)
    stated = any(section.elements for section in scene.string)
    if count >= MOST:
        return "take shorter elements where the hole bends, or kind: lumped"
    return f"take {count} elements" + (" and let the sections share them" if stated else "") + ", or kind: lumped"
