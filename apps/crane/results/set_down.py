"""Loads that a static start has set down on the ground otherwise than they are drawn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from crane.geometry.quaternion import quaternion_of, rotation_of
from crane.scene.scene import CraneScene
from tautline.results.variable import at_start

ASKEW = 0.5
"""Angle, deg, by which a load on the ground is turned from its drawing that is told.

One that is held is turned by none."""
CARRIED = 0.01
"""Share of its weight from which on the ground carries a load: one that is drawn touching it may hang as high."""


def set_down_askew(result: Any, scene: CraneScene) -> list[str]:
    """Sentences on rigid bodies that begin on the ground and are turned there.

    The ground gives no moment: one that a short rope does not let stand as drawn turns freely, and sinks back onto the
    ground as its rope becomes slack. Where the rope's length is not given the start finds one by which the load hangs.
    """
    may_stand = scene.rope.length is not None and scene.start == "static"
    if scene.ground is None or not may_stand or "body_turn" not in result or "body_position" not in result:
        return []
    turns, places = (np.asarray(at_start(result, name)) for name in ("body_turn", "body_position"))
    told = []
    for body, turn, place in zip(scene.bodies, turns, places, strict=True):
        push = scene.ground.stiffness * (scene.ground.level - (place[2] - body.bottom))
        weight = body.mass * float(np.linalg.norm(scene.gravity))
        if body.inertia is None or not push > CARRIED * weight:
            continue
        changed = rotation_of(turn) @ rotation_of(quaternion_of(body.orientation)).T
        angle = math.degrees(math.acos(min(1.0, max(-1.0, 0.5 * (float(np.trace(changed)) - 1.0)))))
        aside = float(np.linalg.norm((place - body.position)[:2]))
        if angle > ASKEW:
            told.append(
                f"{body.name} begins on the ground, turned by {angle:.3g} deg and {aside:.3g} m aside from its "
                "drawing: its rope is too short to let it stand so, and too long to lift it. Give more rope.length for "
                "a load that stands, or less for one that hangs"
            )
    return told
