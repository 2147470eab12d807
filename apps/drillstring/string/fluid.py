"""The mud around and inside a string: what it takes from the weight, and what mass it adds."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

from drillstring.string.lumps import Tube


@dataclass(frozen=True)
class Fluid:
    """Mud around and inside the string; densities kg/m^3.

    ``added_mass`` is the coefficient C_a, or ``annular``: that of a cylinder in a hole; ``inside_density`` is 0 where
    the pipe is empty.
    """

    density: float = 0.0
    inside_density: float = 0.0
    added_mass: float | str = 0.0
    drag: float = 0.0


def fluid_of(mud: Any) -> Fluid:
    """The fluid of a scene's mud; a pipe that is not filled has nothing inside."""
    if mud is None:
        return Fluid()
    return Fluid(mud.density, (mud.inside_density or mud.density) if mud.inside else 0.0, mud.added_mass, mud.drag)


def weight_in(fluid: Fluid, tube: Tube, gravity: float) -> float:
    """Buoyed weight of a tube, N/m: steel, plus the mud inside it, minus the mud that both displace.

    With the same mud inside and outside it is ``m g (1 - rho_m / rho_s)``; a section's mass per length that is not
    that of its round tube (tool joints) displaces in proportion.
    """
    steel_area = tube.mass_per_length / tube.density
    bore = pi / 4.0 * tube.id**2
    return gravity * (tube.mass_per_length + fluid.inside_density * bore - fluid.density * (steel_area + bore))


def mass_beside(fluid: Fluid, tube: Tube, hole_diameter: float) -> float:
    """Mass that follows a tube's lateral motion beside its steel, kg/m: added mass outside, and the mud inside."""
    if fluid.added_mass == "annular":
        coefficient = (hole_diameter**2 + tube.od**2) / (hole_diameter**2 - tube.od**2)
    else:
        coefficient = float(fluid.added_mass)
    return pi / 4.0 * (coefficient * fluid.density * tube.od**2 + fluid.inside_density * tube.id**2)
