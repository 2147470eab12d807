"""How many links the statics of torque and drag take where nobody says: as many as feel the bends of the hole.

A hole of sections, or a smooth survey, is felt by `ELEMENTS` links. Where a survey bends to and fro within them, there
are as many as `drillstring.mesh.enough` says. Whether these do is not known before the loads are, for the string passes
some of the bends through its clearance. So they are doubled until hook load and torque stay as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from drillstring.mesh import MOST_ELEMENTS, enough
from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.helix import LockedUp
from drillstring.statics.statics import Statics, shortened
from drillstring.string.factors import Factors
from tautline.integrators.status import StoppedEarly

ELEMENTS = 100
"""Links or elements of the string where they are not given and the hole is smooth. Hook loads of the J-well and of the
ISCWSA well err by 2e-4 so; that of lumps in a well in which the string passes from one side to the other at a jump of
the curvature by 5e-3, for one lump lies on both. Those of a beam err by 2e-4 at half as many elements.
"""
SETTLED = 0.01
"""Change of hook load or torque by twice the links, over its size, below which they are not doubled again."""
MOST_DOUBLED = 2 * MOST_ELEMENTS
"""Links up to which they are doubled."""


class Doubling(NamedTuple):
    """The last time that links were doubled: how many there are now, and what it changed.

    ``hook_load`` is the change picking up over the hook load, ``torque`` that of the surface torque over the torque,
    both with a sign.
    """

    links: int
    hook_load: float
    torque: float

    @property
    def settled(self) -> bool:
        """Whether it changed no more than is promised."""
        return max(abs(self.hook_load), abs(self.torque)) <= SETTLED


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


def settled_links(
    scene: DrillstringScene, depths: Sequence[float], frictions: Sequence[Factors], unit: str | None = None
) -> tuple[int, Doubling | None]:
    """Links of the string where they are not given, and what doubling them changed; None where `ELEMENTS` will do.

    The string at the deepest depth and with the largest friction decides: its links are the longest.

    Raises
    ------
    SceneError
        As `links` does.
    """
    count = links(scene, depths, unit)
    if count == max(ELEMENTS, scene.model.elements):
        return count, None
    friction = max(frictions, key=lambda one: one.largest)
    try:
        before = _loads(scene, max(depths), friction, count)
        while True:
            count *= 2
            found = _loads(scene, max(depths), friction, count)
            last = Doubling(count, *(_change(a, b) for a, b in zip(before, found, strict=True)))
            if last.settled or 2 * count > MOST_DOUBLED:
                return count, last
            before = found
    except (StoppedEarly, LockedUp):
        # What was not found is told of the string that is computed with so many.
        return count, None


def _loads(scene: DrillstringScene, depth: float, friction: Factors, count: int) -> tuple[float, float]:
    """Hook load picking up, N, and torque turning, N m."""
    statics = Statics(scene, depth, count)
    return statics.solve(friction, "pick_up").hook_load, statics.solve(friction, "rotating").surface_torque


def _change(before: float, after: float) -> float:
    return after / before - 1.0 if before else 0.0
