"""How many links the statics of torque and drag take where nobody says: as many as feel the bends of the hole.

A smooth hole is felt by `ELEMENTS` links. Where a hole bends to and fro within them, there are as many as
`drillstring.mesh.enough` says. Whether these do is not known before the loads are, for the string passes some of the
bends through its clearance. So they are doubled until hook loads and torque stay as they are. The same is done in any
hole where the string is a helix: its friction grows with the square of the compression, and links see that in steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import NamedTuple

import numpy as np

from drillstring.mesh import MOST_ELEMENTS, enough
from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.helix import LockedUp
from drillstring.statics.motion import MOTIONS
from drillstring.statics.soft_string import SoftString, StringInHole
from drillstring.statics.statics import Profile, Statics, shortened, weight_per_length
from drillstring.string.buckling import limits_at
from drillstring.string.factors import Factors
from drillstring.string.lumps import Tube, cut
from tautline.integrators.status import StoppedEarly

ELEMENTS = 100
"""Links or elements of the string where they are not given and the hole is smooth. Hook loads of the J-well and of the
ISCWSA well err by 2e-4 so; that of lumps in a well in which the string passes from one side to the other at a jump of
the curvature by 5e-3, for one lump lies on both. Those of a beam err by 2e-4 at half as many elements.
"""
SETTLED = 0.01
"""Change of a hook load or the torque by twice the links, over its size, below which they are not doubled again."""
MOST_DOUBLED = 2 * MOST_ELEMENTS
"""Links up to which they are doubled."""
NOTHING = 1.0
"""Hook load, N, or torque, N m, below which a change is no share of it."""
PART = 0.5
"""Of the hook load picking up, below which that slacking off is not the measure of its own changes."""


class Doubling(NamedTuple):
    """The last time that links were doubled: how many there are now, and what it changed.

    ``hook_load`` is the change picking up over the hook load, ``torque`` that of the surface torque over the torque,
    ``slack_off`` that slacking off over `size_lowered`. All have a sign, and are None where one of the two loads was
    not found. They are of ``friction`` and of the bit at a ``depth``, m.
    ``bends`` says whether the bends of the hole asked for links; else a helix did.
    """

    links: int
    hook_load: float | None
    torque: float | None
    slack_off: float | None
    friction: Factors
    depth: float
    bends: bool

    @property
    def changes(self) -> dict[str, float | None]:
        """By motion."""
        return {"pick_up": self.hook_load, "slack_off": self.slack_off, "rotating": self.torque}

    @property
    def settled(self) -> bool:
        """Whether it changed no more than is promised, of what was found."""
        known = [abs(change) for change in self.changes.values() if change is not None]
        return bool(known) and max(known) <= SETTLED

    def settles(self, motion: str) -> bool:
        """Whether the loads of one motion are known to stay as they are."""
        change = self.changes.get(motion)
        return change is not None and abs(change) <= SETTLED


def links(scene: DrillstringScene, depths: Sequence[float], unit: str | None = None, least: int | None = None) -> int:
    """Links of the string where they are not given, at the deepest of its depths: the scene's, if it has more.

    There are ``least`` at least, if that is given.

    Raises
    ------
    SceneError
        For a depth at which the string does not fit the well, told in the ``unit``.
    """
    now, well = max(ELEMENTS, scene.model.elements) if least is None else least, well_of(scene)
    hung = shortened(scene, well.length, max(depths), now, unit=unit)
    return enough(hung, well, tubes_of(hung, min(max(depths), well.length)), now)


def links_at(depth: float, deepest: float, count: int, least: int) -> int:
    """Links of a string with its bit at a depth, m, as long as ``count`` of the deepest are; ``least`` at least."""
    return max(min(count, least), ceil(count * min(depth, deepest) / deepest))


def settled_links(
    scene: DrillstringScene, depths: Sequence[float], frictions: Sequence[Factors], unit: str | None = None
) -> tuple[int, Doubling | None]:
    """Links of the string where they are not given, and what doubling them changed; None where none were doubled.

    The string at the deepest depth and with the largest friction decides: its links are the longest. Slacking off it is
    the largest with which the string does not lock up. Without friction no load hangs on the wall, nor on its bends.

    Raises
    ------
    SceneError
        As `links` does.
    """
    count, deepest = links(scene, depths, unit), max(depths)
    bends = count > max(ELEMENTS, scene.model.elements)
    friction = max(frictions, key=lambda one: one.largest)
    if friction.largest == 0.0:
        return count, None
    lowered, helix = _lowered(scene, deepest, frictions, count, unit)
    if not bends and not helix:
        return count, None
    before = _loads(scene, deepest, friction, lowered, count)
    while True:
        if all(load is None for load in before):
            # What was not found is told of the string that is computed with so many.
            return count, Doubling(count, None, None, None, friction, deepest, bends)
        count *= 2
        found = _loads(scene, deepest, friction, lowered, count)
        last = Doubling(count, *_changes(before, found), friction, deepest, bends)
        if last.settled or 2 * count > MOST_DOUBLED:
            return count, last
        before = found


def _lowered(
    scene: DrillstringScene, depth: float, frictions: Sequence[Factors], count: int, unit: str | None
) -> tuple[Factors | None, bool]:
    """The largest friction with which the soft string goes down, None if there is none, and whether it is a helix."""
    well = well_of(scene)
    hung = shortened(scene, well.length, depth, count, unit=unit)
    tubes = tubes_of(hung, min(depth, well.length))
    weight = weight_per_length(hung, tubes)
    string = StringInHole(well, tubes, weight, scene.well.diameter)
    for friction in sorted(frictions, key=lambda one: one.largest, reverse=True):
        soft = string.solved(friction, MOTIONS["slack_off"], scene.bit.load)
        if soft.locked is None:
            return friction, _is_helix(scene, soft, tubes, weight, count)
    return None, False


def _is_helix(scene: DrillstringScene, soft: SoftString, tubes: list[Tube], weight: np.ndarray, count: int) -> bool:
    """Whether a soft string is pushed beyond the limit of a helix in the middle of any link."""
    if soft.tension.min() >= 0.0:
        return False
    lumps = cut(tubes, count)
    pipes, middle = [tubes[k] for k in lumps.section], lumps.measured_depth[:-1] + 0.5 * lumps.length
    clearance = 0.5 * (scene.well.diameter - np.array([tube.contact_od for tube in pipes]))
    limits = limits_at(well_of(scene), middle, pipes, weight[lumps.section], clearance)
    return bool(np.any(-np.interp(middle, soft.measured_depth, soft.tension) >= limits.helical))


Loads = tuple[float | None, float | None, float | None]
"""Hook load picking up, N, torque turning, N m, and hook load slacking off, N; None of what was not found."""


def _loads(scene: DrillstringScene, depth: float, friction: Factors, lowered: Factors | None, count: int) -> Loads:
    statics = Statics(scene, depth, count)
    up, turned = _solved(statics, friction, "pick_up"), _solved(statics, friction, "rotating")
    down = None if lowered is None else _solved(statics, lowered, "slack_off")
    return (
        None if up is None else up.hook_load,
        None if turned is None else turned.surface_torque,
        None if down is None else down.hook_load,
    )


def _solved(statics: Statics, friction: Factors, motion: str) -> Profile | None:
    try:
        return statics.solve(friction, motion)
    except (StoppedEarly, LockedUp):
        return None


def size_lowered(up: float, down: float) -> float:
    """Measure of a change of the hook load slacking off, N: the load, or `PART` of the other if that is more."""
    return max(abs(down), PART * abs(up))


def _changes(before: Loads, after: Loads) -> Loads:
    """What a doubling changed, of hook load, torque and slacking off, each as a share."""
    up, torque, down = (abs(load) if load is not None else 0.0 for load in after)
    made = [
        None if a is None or b is None else (b - a) / max(size, NOTHING)
        for a, b, size in zip(before, after, (up, torque, size_lowered(up, down)), strict=True)
    ]
    return made[0], made[1], made[2]
