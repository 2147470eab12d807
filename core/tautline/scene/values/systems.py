"""Systems of units in which figures are printed; what is stored, and what ``--json`` prints, stays SI."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from tautline.scene.values.units import read_unit

SYSTEMS: Mapping[str, Mapping[str, tuple[str, ...]]] = {
    "si": {},
    "metric": {
        "m": ("m", "mm"),
        "m^3/s": ("l/min",),
        "rad": ("deg",),
        "rad/s": ("rpm",),
        "1/m": ("deg/30 m",),
        "kg": ("t", "kg"),
        "kg/m^3": ("sg",),
        "N": ("kN", "N"),
        "N m": ("kN m", "N m"),
        "N/m": ("kN/m", "N/m"),
        "J": ("kJ", "J"),
        "W": ("kW", "W"),
        "Pa": ("MPa", "kPa"),
    },
    "field": {
        "m": ("ft", "in"),
        "m^3/s": ("gal/min",),
        "mm": ("in",),
        "m/s": ("ft/s",),
        "m/h": ("ft/h",),
        "m^2": ("in^2",),
        "m^3": ("bbl",),
        "rad": ("deg",),
        "rad/s": ("rpm",),
        "1/m": ("deg/100 ft",),
        "kg": ("lbm",),
        "kg/m": ("lbm/ft",),
        "kg/m^3": ("ppg",),
        "N": ("kip", "lbf"),
        "N m": ("kft-lbf", "ft-lbf"),
        "N/m": ("kip/ft", "lbf/ft"),
        "J": ("kft-lbf", "ft-lbf"),
        "W": ("hp",),
        "Pa": ("ksi", "psi"),
    },
}
"""System -> unit of a figure -> what engineers write, the largest first: a figure takes the first of which it is at
least one (of a length, a tenth). What a system does not name it leaves as it is."""
SHORT = 0.1
"""Metres, or feet, below which a length is in mm, or in inches."""
SMALL_PRESSURE = 10_000.0
"""Pressures up to so many psi are written in psi: a pump's 3500 psi is not 3.5 ksi to anyone."""


def usual_unit(unit: str, system: str) -> str:
    """The unit that a system writes for one of SI, the largest of several; empty where that is no other."""
    first = SYSTEMS[system].get(unit, (unit,))[0]
    return first if first != unit else ""


def in_system(value: float, unit: str, system: str) -> tuple[float, str]:
    """Convert a figure for display.

    Parameters
    ----------
    value : float
    unit : str
        Its unit: of SI, or one of those that figures have besides (``mm``, ``m/h``).
    system : str
        A key of `SYSTEMS`.

    Returns
    -------
    tuple
        Value and unit as the system writes them; both as they were where it names none (seconds, shares).
    """
    choices = SYSTEMS[system].get(unit)
    if choices is None:
        return value, unit
    least, scale = _least(unit, choices), read_unit(unit).si(Fraction(1))
    for name in choices:
        converted = value * scale / read_unit(name).si(Fraction(1))
        if abs(converted) >= least or name == choices[-1] or value == 0.0:
            return converted, name
    raise AssertionError("a unit without a choice")


def choices_of(unit: str, system: str) -> list[tuple[float, float, str]]:
    """What `in_system` chooses from, the largest unit first: each with the size from which on it is taken, and factor.

    Sizes are in `unit`; the last one takes all that is smaller, so its size is 0. Empty where the system names none.
    """
    choices = SYSTEMS[system].get(unit, ())
    scale = read_unit(unit).si(Fraction(1)) if choices else 1.0
    factors = [scale / read_unit(name).si(Fraction(1)) for name in choices]
    last = len(choices) - 1
    return [
        (0.0 if k == last else _least(unit, choices) / factor, factor, name)
        for k, (factor, name) in enumerate(zip(factors, choices, strict=True))
    ]


def _least(unit: str, choices: tuple[str, ...]) -> float:
    """Figure from which on a unit of several is taken."""
    return SMALL_PRESSURE / 1000.0 if choices[0] == "ksi" else SHORT if unit == "m" else 1.0


def length_unit(system: str) -> tuple[float, str]:
    """Length in m of the unit of lengths of a system, and its name."""
    name = SYSTEMS[system].get("m", ("m",))[0]
    return read_unit(name).si(Fraction(1)), name
