"""Strings and sections that float: lighter, with what is inside them, than the mud that they displace."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Tube
from tautline.scene.errors import SceneError

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene

CURE = "give the mud's density, such as 12.5 ppg, or fill the string (`mud.inside: true`)"


NOTHING = 1.0e-9
"""Share of a string's mass that is no weight: what rounding leaves of two equal densities."""


def check_weight(scene: DrillstringScene, tubes: list[Tube]) -> None:
    """Refuse a string that floats as a whole: it would hang upwards from the drive, or, without weight, from nothing.

    Raises
    ------
    SceneError
        At ``mud.density``.
    """
    mass = sum(buoyed_mass(scene, tube) * tube.length for tube in tubes)
    steel = sum(tube.mass_per_length * tube.length for tube in tubes)
    if scene.mud is not None and mass <= NOTHING * steel:
        much = "as heavy as" if abs(mass) <= NOTHING * steel else f"{-mass:.4g} kg lighter than"
        cause = f"the string would float: with what is inside it is {much} the mud it displaces"
        raise SceneError([scene.problem(("mud", "density"), cause, CURE)])


def buoyed_mass(scene: DrillstringScene, tube: Tube) -> float:
    """Steel and contents of a section less the mud that it displaces, kg/m."""
    return weight_in(fluid_of(scene.mud), tube, 1.0)
