"""Strings and sections that float: lighter, with what is inside them, than the mud that they displace."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Tube
from tautline.scene.errors import SceneError
from tautline.scene.reading.document import Path_, join_key
from tautline.scene.values.ranges import RANGES, sized

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene

STEEL = "see whether the density of the steel is what was meant: 7850 kg/m^3 is usual"
CURE = "give the mud's density, such as 12.5 ppg, or fill the string (`mud.inside: true`)"


NOTHING = 1.0e-9
"""Share of a string's mass that is no weight: what rounding leaves of two equal densities."""


def check_weight(scene: DrillstringScene, tubes: list[Tube]) -> None:
    """Refuse a string that floats as a whole: it would hang upwards from the drive, or, without weight, from nothing.

    Raises
    ------
    SceneError
        At ``mud.density``, or at a density of the pipe that is none of any pipe. It names both.
    """
    mass = sum(buoyed_mass(scene, tube) * tube.length for tube in tubes)
    steel = sum(tube.mass_per_length * tube.length for tube in tubes)
    if scene.mud is not None and mass <= NOTHING * steel:
        much = "as heavy as" if abs(mass) <= NOTHING * steel else f"{sized(-mass, 'kg')} lighter than"
        cause = f"the string would float: with what is inside it is {much} the mud it displaces"
        key, density = _lightest(scene)
        cause += f" ({join_key(key)} is {density:.4g} kg/m^3, mud.density {scene.mud.density:.4g} kg/m^3)"
        odd = not RANGES["pipe density"].holds(density)
        at, cure = (key, STEEL) if odd else (("mud", "density"), CURE)
        raise SceneError([scene.problem(at, cause, cure)])


def _lightest(scene: DrillstringScene) -> tuple[Path_, float]:
    """Key and value of the least density of the pipe, kg/m^3: of a section that has its own, or of the material."""
    own = {("string", i, "density"): one.density for i, one in enumerate(scene.string) if one.density is not None}
    given: dict[Path_, float] = {**own}
    if len(own) < len(scene.string):
        given["material", "density"] = scene.material.density
    key = min(given, key=given.__getitem__)
    return key, given[key]


def buoyed_mass(scene: DrillstringScene, tube: Tube) -> float:
    """Steel and contents of a section less the mud that it displaces, kg/m."""
    return weight_in(fluid_of(scene.mud), tube, 1.0)


def buoyed_weight(scene: DrillstringScene, tubes: Sequence[Tube]) -> float:
    """Buoyed weight of a whole string, N."""
    return float(sum(weight_in(fluid_of(scene.mud), tube, scene.gravity) * tube.length for tube in tubes))
