"""How long the elements of a string may be, and how many are enough."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drillstring.model.prepared import Prepared, prepared
from drillstring.scene.scene import BEAM, DrillstringScene
from drillstring.string.lumps import Lumps, Tube, cut
from drillstring.well.wellbore import Wellbore
from tautline.scene.errors import SceneWarning
from tautline.scene.values.printed import shown

ELEMENTS = "model.elements"
"""Where a warning of a mesh stands."""
SIDE_FORCE, HOOK_LOAD, NOTHING = 0.25, 1.9, 7.0
"""How far, m, the hole may leave a straight line between points of contact until side force or hook load may be off by
more than 1 per cent, and until there may be no equilibrium at all."""
PLACES = 8
"""Of each element, at which the hole's curvature is taken."""
MOST_ELEMENTS = 2000
"""Elements up to which a mesh that follows the hole is looked for."""
COARSE, LONG = 0.25, 500.0
"""Share of a string that one element may be, and the length of string, m, from which that counts."""


class Cure(NamedTuple):
    """Words that ask for a number of elements, for more of them, and for the lumped model."""

    elements: str
    more: str
    lumped: str


OF_SCENE = Cure("take {} elements", "take more elements", "kind: lumped")
"""As the keys of a scene have it."""
OF_OPTIONS = Cure("give --elements {}", "give a larger --elements", "give --model lumped")
"""As the options of a verb have it, which count more than the scene."""


def mesh_warnings(scenes: Iterable[DrillstringScene]) -> list[SceneWarning]:
    """Warnings of the meshes that a verb computes, each a scene with its kind of model and number of elements.

    Raises
    ------
    SceneError
        Where well and string do not fit.
    """
    found: dict[str, str] = {}
    meshes = list(scenes)
    for scene in meshes:
        if text := too_long(scene, prepared(scene), OF_OPTIONS):
            found[f"{scene.model.kind}, {scene.model.elements} elements: "] = text
    return [SceneWarning(ELEMENTS, text if len(meshes) == 1 else mesh + text) for mesh, text in found.items()]


def too_long(scene: DrillstringScene, ready: Prepared, cure: Cure = OF_SCENE) -> str:
    """What is wrong with a mesh whose elements are too long for the hole or the string, and the cure; else nothing."""
    lumps = ready.lumps
    if scene.model.kind == BEAM and (text := _beam_off_the_line(scene, ready, cure)):
        return text
    longest = float(lumps.length.max())
    if longest <= COARSE * lumps.total or lumps.total <= LONG:
        return ""
    return (
        f"an element is {longest:.0f} m long, {100 * longest / lumps.total:.0f} % of the string: friction and "
        f"curvature are coarse; {cure.more}"
    )


def off_the_line(well: Wellbore, lumps: Lumps) -> np.ndarray:
    """How far the hole leaves a straight line between the points of contact of each element, (n,) m.

    An element is a cubic that touches the wall in the middles of its halves. Between two of these points the hole
    leaves the straight line by about phi h / 32, phi being what it turns by over the length h of the element:
    h^2 / (32 R) in an arc. Where that is decimetres a beam cuts across the hole's bends and their ends.

    Measured with friction 0.2, picking up, slacking off and turning, in the wells of jwell, iscwsa, field_well and
    tripping, on arcs of 300 m and of 100 m to the horizontal and of 600 m to 45 deg, with 2 to 96 elements beside 160:
    up to 0.25 m the wall's side force in all differs by 0.6 % at most, from 0.28 m on by up to 1.6 %, at 1 m by up to
    4 %. Hook loads differ by 0.7 % at most up to 1.9 m, and by up to 2.8 % at 6 m; above 7 m half of the strings found
    no equilibrium, or were tens of per cent off.
    """
    share = (np.arange(PLACES) + 0.5) / PLACES
    places = lumps.measured_depth[:-1, None] + lumps.length[:, None] * share
    k1, k2 = well.curvature(places.ravel())
    turn = np.hypot(k1, k2).reshape(places.shape).mean(axis=1) * lumps.length
    return turn * lumps.length / 32.0


def _beam_off_the_line(scene: DrillstringScene, ready: Prepared, cure: Cure) -> str:
    """What is wrong with a beam that is too coarse for its hole, and with how many elements it is not; else nothing."""
    if scene.well.wall is None:
        return ""
    lumps = ready.lumps
    off = off_the_line(ready.well, lumps)
    worst = int(np.argmax(off))
    if off[worst] <= SIDE_FORCE:
        return ""
    length, away = (shown(float(value), "m", scene.units) for value in (lumps.length[worst], off[worst]))
    cause = f"an element of {length} is long for its hole, which leaves the straight line between the element's points"
    cause += f" of contact by {away}"
    if off[worst] > NOTHING:
        wrong = "there may be no equilibrium, or one that is tens of per cent off"
    elif off[worst] > HOOK_LOAD:
        wrong = "hook loads may be off by more than 1 %, the side force by more than 5 %"
    else:
        wrong = "the side force of the wall may be off by more than 1 %, hook loads by less"
    return f"{cause}: {wrong}; {_finer(lumps.tubes, ready.well, lumps.length.size, cure)}"


def _finer(tubes: tuple[Tube, ...], well: Wellbore, now: int, cure: Cure) -> str:
    free = [replace(tube, elements=None) for tube in tubes]
    count = now
    while count < MOST_ELEMENTS and off_the_line(well, cut(free, count)).max() > SIDE_FORCE:
        count += max(1, count // 50)
    if count >= MOST_ELEMENTS:
        return f"take shorter elements where the hole bends, or {cure.lumped}"
    stated = any(tube.elements for tube in tubes)
    shared = " and let the sections share them" if stated else ""
    return f"{cure.elements.format(count)}{shared}, or {cure.lumped}"
