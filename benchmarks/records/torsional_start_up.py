"""Start-up of a string off bottom, after Aarsnes and Shor (2018): the scene of their well, laid out as their model is.

Their model is a torsional line: friction on a length is `mu rho g A r sin(inclination)`, without the side force of
tension in the build and without a pipe that climbs the wall. So that the same friction acts here, their well is laid
into a straight hole of 60 degrees, where tension presses nothing on the wall: the mass per length of each stretch is
that of the string times sin(inclination)/sin(60 deg). Inertia and stiffness in torsion are not of that mass, they stay.
A pipe that turns climbs the wall until the angle's tangent is the friction factor, so that its torque is the sine of
that angle times weight times radius: the factors of the scene are the tangents of the angles that have theirs as sines.
"""

from __future__ import annotations

from itertools import pairwise
from math import asin, exp, pi, radians, sin, tan
from typing import Any

import numpy as np

DEPTH, BHA = 2500.0, 230.0
"""Measured depth of the bit and length of the assembly, m."""
FACTOR, RATIO = 0.3, 0.65
"""Static friction factor, and the kinetic one over it."""
OUTER, INNER = 0.146529, 0.123024
"""Diameters of the pipe, m."""
DENSITY, SHEAR_PIPE, SHEAR_BHA = 7850.0, 61e9, 67e9
SPEED, DELAY = 40.0 * pi / 30.0, 1.0
"""Rotary speed that is reached, rad/s, and time constant of the speed wanted, s."""
PROPORTIONAL, INTEGRAL, INERTIA = 38e3, 100e3, 2900.0
"""Of the top drive: N m s/rad, N m/rad, kg m^2."""
DAMPING = 2.0 * 50.0 * 0.01 / 12.0
"""Viscous damping, 1/s. Their coefficient of 50 is taken times the inner time step, of which 12 make one of 0.01 s."""
PIECES = np.array(
    [[48.7, 0.150473, 0.096207], [114.8, 0.187322, 0.098912], [56.7, 0.20955, 0.071438], [38.88, 0.24728, 0.123391]]
)
"""Length, outer and inner diameter of the pieces whose mean the assembly is, m."""
STEEPEST = radians(60.0)
STRETCH = 100.0
"""Length of a stretch of the build that has one mass, m."""
LIGHT = 1.0
"""Mass per length of the pipe where nothing presses it on the wall, kg/m."""


def assembly() -> tuple[float, float, float]:
    """Cross-section m^2, polar moment m^4 and radius m of the assembly as their program has them.

    The polar moment there contains pi twice; it is kept, for the curve was made with it.
    """
    length, outer, inner = PIECES.T
    share = length / length.sum()
    area = float((share * pi / 4.0 * (outer**2 - inner**2)).sum())
    polar = float(pi * (share * pi * (outer**4 - inner**4) / 32.0).sum())
    return area, polar, float((share * outer / 2.0).sum())


def inclination(depth: float) -> float:
    """Inclination at a measured depth, rad: none to 500 m, 60 degrees from 1600 m on, linear between."""
    return STEEPEST * float(np.clip((depth - 500.0) / 1100.0, 0.0, 1.0))


def _mean_sine(top: float, bottom: float) -> float:
    return float(np.mean([sin(inclination(s)) for s in np.linspace(top, bottom, 201)]))


def scene(
    elements: int = 60, step: float = 2e-3, end: float = 13.0, law: dict[str, Any] | None = None
) -> dict[str, Any]:
    """The scene as a document; ``law`` are further keys of the friction."""
    area, polar, radius = assembly()
    pipe = pi / 4.0 * (OUTER**2 - INNER**2)
    edges = [0.0, 500.0, *np.arange(500.0 + STRETCH, 1600.1, STRETCH), DEPTH - BHA]
    string: list[dict[str, Any]] = []
    for top, bottom in pairwise(edges):
        mass = max(LIGHT, DENSITY * pipe * _mean_sine(top, bottom) / sin(STEEPEST))
        string.append({
            "name": f"pipe at {top:g} m", "length": float(bottom - top), "od": OUTER, "id": INNER,
            "mass_per_length": mass, "shear_modulus": SHEAR_PIPE,
        })  # fmt: skip
    bore = 2.0 * (radius**2 - area / pi) ** 0.5
    # The program takes the polar moment of the section from its diameters: stiffness and inertia make up for the rest.
    times_polar = polar / (pi / 32.0 * ((2.0 * radius) ** 4 - bore**4))
    string.append({
        "name": "assembly", "length": BHA, "od": 2.0 * radius, "id": bore, "mass_per_length": DENSITY * area,
        "density": DENSITY * times_polar, "shear_modulus": SHEAR_BHA * times_polar,
    })  # fmt: skip
    static, kinetic = (tan(asin(factor)) for factor in (FACTOR, RATIO * FACTOR))
    friction = {"static": static, "kinetic": kinetic} | (law or {})
    times = [round(0.1 * k, 3) for k in range(80)] + [8.0, 10.0, 1e3]
    wanted = [SPEED * (1.0 - exp(-t / DELAY)) for t in times]
    return {
        "title": "Torsional start-up off bottom",
        "well": {
            "inclination": STEEPEST, "sections": [{"hold": DEPTH + 20.0}], "diameter": 0.21,
            "wall": {"stiffness": 1e8, "damping": 1e6, "friction": friction},
        },
        "string": string,
        "material": {"youngs_modulus": 206e9, "shear_modulus": SHEAR_PIPE, "density": DENSITY},
        "damping": {"mass_proportional": DAMPING},
        "top": {
            "block": 0.0,
            "rotation": {"controller": {
                "kind": "pi", "speed": {"table": {"time": times, "value": wanted}},
                "proportional": PROPORTIONAL, "integral": INTEGRAL, "inertia": INERTIA,
            }},
        },
        "model": {"kind": "lumped", "elements": elements},
        "solver": {"method": "generalized-alpha", "rho_inf": 0.5, "step": step, "end": end},
        "output": {"interval": 0.01},
    }  # fmt: skip


def as_it_lies(elements: int = 60, step: float = 2e-3, law: dict[str, Any] | None = None) -> dict[str, Any]:
    """The scene of the well as it lies: its build, tension that presses the string on the wall, masses as they are."""
    document = scene(elements, step, law=law)
    pipe = document["string"][0] | {"name": "pipe", "length": DEPTH - BHA}
    del pipe["mass_per_length"]
    document["string"] = [pipe, document["string"][-1]]
    build = {"radius": 1100.0 / STEEPEST, "to": STEEPEST}
    document["well"] |= {"inclination": 0.0, "sections": [{"hold": 500.0}, {"build": build}, {"hold": 920.0}]}
    document["well"]["wall"]["friction"] |= {"static": FACTOR, "kinetic": RATIO * FACTOR}
    return document
