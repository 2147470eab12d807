"""Figures in oilfield units for people to read; what is stored and what ``--json`` prints stays SI."""

from __future__ import annotations

from fractions import Fraction

from tautline.scene.units import read_unit

FIELD: dict[str, tuple[str, ...]] = {
    "m": ("ft",),
    "m/s": ("ft/s",),
    "m^2": ("in^2",),
    "m^3": ("bbl",),
    "rad": ("deg",),
    "rad/s": ("rpm",),
    "1/m": ("1/ft",),
    "kg": ("lbm",),
    "kg/m": ("lbm/ft",),
    "kg/m^3": ("ppg",),
    "N": ("kip", "lbf"),
    "N m": ("kft-lbf", "ft-lbf"),
    "N/m": ("kip/ft", "lbf/ft"),
    "J": ("kft-lbf", "ft-lbf"),
    "Pa": ("ksi", "psi"),
}
"""SI unit -> what a driller writes, the largest first: a figure takes the first of which it is at least one."""
SMALL_PRESSURE = 10_000.0
"""Pressures up to so many psi are written in psi: a pump's 3500 psi is not 3.5 ksi to anyone."""


def in_field_units(value: float, unit: str) -> tuple[float, str]:
    """Convert a figure for display.

    Parameters
    ----------
    value : float
        In SI.
    unit : str
        Its SI unit, as in a headline.

    Returns
    -------
    tuple
        Value and unit as the oilfield writes them; both as they were where it has no unit of its own (seconds, shares).
    """
    choices = FIELD.get(unit)
    if choices is None:
        return value, unit
    least = 1.0
    if unit == "Pa":
        least = SMALL_PRESSURE / 1000.0
    for name in choices:
        converted = value / read_unit(name).si(Fraction(1))
        if abs(converted) >= least or name == choices[-1]:
            return converted, name
    raise AssertionError("a unit without a choice")
