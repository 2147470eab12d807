"""Strings and sections that float: lighter, with what is inside them, than the mud that they displace."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Tube
from tautline.scene.errors import SceneError

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene

CURE = "give the mud's density, such as 12.5 ppg, or fill the string (`mud.inside: true`)"


def check_weight(scene: DrillstringScene, tubes: list[Tube]) -> None:
    """Refuse a string that floats as a whole: it would hang upwards from the drive.

    Raises
    ------
    SceneError
        At ``mud.density``.
    """
    mass = sum(buoyed_mass(scene, tube) * tube.length for tube in tubes)
    if scene.mud is not None and mass <= 0.0:
        cause = f"the string would float: with what is inside it is {-mass:.4g} kg lighter than the mud it displaces"
        raise SceneError([scene.problem(("mud", "density"), cause, CURE)])


def buoyed_mass(scene: DrillstringScene, tube: Tube) -> float:
    """Steel and contents of a section less the mud that it displaces, kg/m."""
    return weight_in(fluid_of(scene.mud), tube, 1.0)
