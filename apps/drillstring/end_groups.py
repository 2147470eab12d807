"""From a scene to the groups that act at the string's ends, whichever model the string between them has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drillstring.ends import Controller
from drillstring.top_drive import TopDrive
from tautline.elements.load import Loads
from tautline.kernels.time_function import TimeFunctions

if TYPE_CHECKING:
    from drillstring.scene import DrillstringScene

BLOCK, ROTATION = 0, 1
"""Functions of time of a scene: the block's position m, and the angle of the rotary rad."""


class Along(NamedTuple):
    """A coordinate along the hole, ``datum + sum(direction q[places])`` m of measured depth.

    ``places`` (k,) are full degrees of freedom and ``direction`` (k,) the hole's tangent on them: a lump's own
    coordinate and 1, or a point's three and their cosines.
    """

    places: np.ndarray
    direction: np.ndarray
    datum: float


def is_driven(scene: DrillstringScene) -> bool:
    """Whether a controller turns the string, not a prescribed speed."""
    return isinstance(scene.top.rotation, Controller)


def groups_at_ends(
    scene: DrillstringScene, functions: TimeFunctions, drive: int, bit: Along, bit_turn: int
) -> list[Any]:
    """Groups at both ends of a string.

    Parameters
    ----------
    scene : DrillstringScene
        The scene.
    functions : TimeFunctions
        With the block's position and the rotary's angle at BLOCK and ROTATION.
    drive, bit_turn : int
        Full degrees of freedom of rotation at the drive and at the bit.
    bit : Along
        The bit's measured depth.
    """
    groups: list[Any] = []
    if scene.bit.force != 0.0:
        groups.append(Loads(bit.places, scene.bit.force * bit.direction))
    rotation = scene.top.rotation
    if isinstance(rotation, Controller):
        limit = rotation.torque_limit if rotation.torque_limit is not None else np.inf
        groups.append(
            TopDrive(
                functions,
                ROTATION,
                drive,
                rotation.inertia,
                rotation.proportional,
                rotation.integral,
                limit,
                np.zeros(1),
            )
        )
    return groups
