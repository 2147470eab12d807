"""How long the elements of a string may be, and how many are enough."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drillstring.model.prepared import Prepared, prepared
from drillstring.results.limits import SNUG
from drillstring.scene.scene import BEAM, DrillstringScene
from drillstring.string.lumps import Lumps, Tube, cut
from drillstring.well.followed import Followed, followed
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
MISSED, LEFT, BESIDE = 0.05, 0.025, 0.1
"""Share of a string's bend that its elements may not feel before that is said, the share that a finer mesh may leave,
and how far beside the clearance the hole leaves an arc where that counts: scatter of a survey of less than a tenth of
the clearance moves no pipe.

Wells of sections, and the surveys of smooth ones, miss less than 1.5 % with 100 links. What a mesh that leaves `LEFT`
is off by is in docs/torque_drag.md.
"""
SCATTER, FINE = 0.2, 10.0
"""Share of a hole's bend that is to and fro within `FINE` m, and by less than `BESIDE` of the clearance, from which a
survey is said to scatter."""
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
    if text := _bends_within(scene, ready, cure):
        return text
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


class Missed(NamedTuple):
    """Where a mesh misses bends of the hole: from and to which depth, by how much the hole leaves the arcs, clearance.

    All in m; ``share`` is that of the string's bend which is missed.
    """

    top: float
    bottom: float
    off: float
    clearance: float
    share: float


def missed(scene: DrillstringScene, well: Wellbore, lumps: Lumps, little: float = MISSED) -> Missed | None:
    """What the elements of a string miss of the bends of its hole; None where that is little, or there is no wall."""
    if scene.well.wall is None or lumps.length.size < 2:
        return None
    places, room = _contacts(scene, lumps)
    found = followed(well, places)
    total = float(found.bend.sum())
    counts = (found.missed > MISSED * found.bend) & (found.off > BESIDE * room)
    share = float(found.missed[counts].sum()) / total if total > 0.0 else 0.0
    if share <= little:
        return None
    depth, worst = found.depth[counts], int(np.argmax(np.where(counts, found.off, 0.0)))
    return Missed(float(depth[0]), float(depth[-1]), float(found.off[worst]), float(room[worst]), share)


def _contacts(scene: DrillstringScene, lumps: Lumps) -> tuple[np.ndarray, np.ndarray]:
    """Where a string touches, (n + 2,) m of measured depth, and the clearance (n,) m of all but the outer two of them.

    A lump touches at its place, an element of a beam in the middles of its halves; the bit touches too. A stabiliser
    fits the hole, and has the clearance that it is taken to have elsewhere.
    """
    ends, size = lumps.measured_depth, lumps.of_links(lambda tube: tube.contact_od)
    if scene.model.kind == BEAM:
        middles = ends[:-1, None] + lumps.length[:, None] * np.array([0.25, 0.75])
        ends, size = np.append(middles.ravel(), ends[-1]), np.repeat(size, 2)
    size = np.maximum(size[1:], size[:-1])[: ends.size - 2]
    return ends, np.maximum(0.5 * (scene.well.diameter - size), SNUG * scene.well.diameter)


def enough(scene: DrillstringScene, well: Wellbore, tubes: Iterable[Tube], now: int) -> int:
    """Elements, ``now`` at least and `MOST_ELEMENTS` at most, that feel the bends of the hole, shared by length."""
    free = [replace(tube, elements=None) for tube in tubes]
    count, little = now, MISSED
    while count < MOST_ELEMENTS and not _follows(scene, well, cut(free, count), little):
        little = LEFT
        count += max(1, count // 50)
    return min(count, max(now, MOST_ELEMENTS))


def follows_hole(scene: DrillstringScene) -> bool:
    """Whether the string of a scene feels the bends of its hole; raises SceneError where the two do not fit."""
    ready = prepared(scene)
    return missed(scene, ready.well, ready.lumps) is None


def _follows(scene: DrillstringScene, well: Wellbore, lumps: Lumps, little: float) -> bool:
    if scene.model.kind == BEAM and off_the_line(well, lumps).max() > SIDE_FORCE:
        return False
    return missed(scene, well, lumps, little) is None


def _bends_within(scene: DrillstringScene, ready: Prepared, cure: Cure) -> str:
    """That the hole bends to and fro within the elements, what is wrong then, and how many feel it; else nothing."""
    lumps = ready.lumps
    found = missed(scene, ready.well, lumps)
    if found is None:
        return ""
    top, bottom, off, room, length = (
        shown(float(x), "m", scene.units)
        for x in (found.top, found.bottom, found.off, found.clearance, lumps.length.max())
    )
    where = f"at {top}" if top == bottom else f"from {top} to {bottom}"
    cause = (
        f"{where} the hole bends to and fro within elements of {length}: it leaves their arcs by up to "
        f"{off}, and the clearance is {room}. The string does not feel {100.0 * found.share:.0f} % of the hole's bends"
    )
    wrong = "side force, friction, hook load and torque are wrong, mostly too low"
    return f"{cause}, and {wrong}; {_finer(scene, lumps.tubes, ready.well, lumps.length.size, cure)}"


def scatter(scene: DrillstringScene, well: Wellbore) -> list[SceneWarning]:
    """A warning of a survey whose stations scatter by less than a string follows, where the soft string follows it.

    What that makes of the loads is for the caller to see: a hole that hardly bends may scatter as it will.
    """
    if scene.well.survey is None or scene.well.wall is None or well.length < 3.0 * FINE:
        return []
    spacing = float(np.median(np.diff(well.md)))
    if spacing >= FINE * (1.0 - 1e-9):
        # The bends are those of the survey itself, to and fro over more than `FINE`.
        return []
    found: Followed = followed(well, np.linspace(0.0, well.length, round(well.length / FINE) + 1))
    size = max(tube.contact_od for tube in prepared(scene).lumps.tubes)
    room = max(0.5 * (scene.well.diameter - size), SNUG * scene.well.diameter)
    total, hidden = float(found.bend.sum()), found.off <= BESIDE * room
    share = float(found.missed[hidden].sum()) / total if total > 0.0 else 0.0
    if share <= SCATTER:
        return []
    apart, fine, within = (shown(x, "m", scene.units) for x in (spacing, FINE, BESIDE * room))
    text = (
        f"the stations are {apart} apart and scatter: {100.0 * share:.0f} % of the hole's bends go to and fro within "
        f"{fine} and by less than {within}. A pipe is too stiff to follow them, but the soft string follows them all, "
        f"and its side force, hook loads and torque are too large. Keep one station in {fine} or more, or smooth the "
        "survey; do not go by the soft string"
    )
    return [SceneWarning("well.survey", text)]


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
    return f"{cause}: {wrong}; {_finer(scene, lumps.tubes, ready.well, lumps.length.size, cure, lumped=True)}"


def _finer(
    scene: DrillstringScene, tubes: tuple[Tube, ...], well: Wellbore, now: int, cure: Cure, lumped: bool = False
) -> str:
    """How many elements feel the bends of the hole, or, for a beam off the line, lumps."""
    count = enough(scene, well, tubes, now)
    # Lumps are no cure where their links are too long too.
    other = f", or {cure.lumped}" if lumped else ""
    if count >= MOST_ELEMENTS:
        return "take shorter elements where the hole bends" + other
    stated = any(tube.elements for tube in tubes)
    shared = " and let the sections share them" if stated else ""
    return f"{cure.elements.format(count)}{shared}{other}"
