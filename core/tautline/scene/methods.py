"""Time integrators by name: what is known of each without its compiled code.

A method is one record. Readers of scenes, warnings and studies ask the record, never the name; what steps is loaded
where a run needs it. :func:`register` adds a method.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from tautline.entry_points import module_of_caller
from tautline.errors import ArgumentError

GROWS = 1.0e-6
"""Growth in one step that is rounding of the boundary of stability."""
FARTHEST = 4.0
"""Distance from the origin to which a boundary of stability is looked for, and beyond which no step is taken."""
FINENESS = 4000
"""Points on the way there."""


@dataclass(frozen=True)
class Method:
    """What is known of a time integrator.

    Attributes
    ----------
    name : str
        The word of scenes, options and results.
    stepping : str or object
        What steps: a ``tautline.integrators.stepping.Stepping``, or where it is, as ``module:name``.
    order : int
        Power of the step with which the error of a smooth motion falls.
    polynomial : tuple of float
        Of an explicit method: what one step multiplies y by for y. = lambda y, by rising powers of z = h lambda. Empty
        for an implicit one.
    limit : float or None
        omega h on the imaginary axis beyond which an explicit method is not used; None for where the polynomial grows.
    has_alphas : bool
        Whether it takes ``rho_inf`` or ``alpha_m`` and ``alpha_f``.
    aliases : tuple of str
        Other spellings of the name.
    """

    name: str
    stepping: Any
    order: int
    polynomial: tuple[float, ...] = ()
    limit: float | None = None
    has_alphas: bool = False
    aliases: tuple[str, ...] = ()

    @property
    def explicit(self) -> bool:
        """Whether it steps without solving equations; such a method has a critical step, and no control of its error.

        An implicit one is stable with any step, and controls the error of its steps where a scene asks for it.
        """
        return bool(self.polynomial)

    def factor(self, z: complex) -> complex:
        """What a step of an explicit method multiplies y by, z = h lambda."""
        return complex(np.polynomial.polynomial.polyval(z, self.polynomial))

    def reach(self, angle: float) -> float:
        """How far |h lambda| may go in a direction of the complex plane, an angle in rad, for a step to be stable."""
        return _reach(self.polynomial, self.limit, angle)

    @property
    def reach_of_vibration(self) -> float:
        """omega h up to which undamped vibration is stable: on the imaginary axis."""
        return self.reach(0.5 * math.pi)


@cache
def _reach(polynomial: tuple[float, ...], limit: float | None, angle: float) -> float:
    r = np.linspace(1e-3, FARTHEST, FINENESS)
    grows = np.abs(np.polynomial.polynomial.polyval(r * np.exp(1j * angle), polynomial)) > 1.0 + GROWS
    found = float(r[np.argmax(grows)]) if grows.any() else FARTHEST
    return found if limit is None else min(found, limit)


_known: dict[str, Method] = {}
_modules: dict[str, str] = {}
"""Which module has registered a method."""


def register(method: Method) -> Method:
    """Make a method known to scenes, options and studies; returns it.

    One from the same module takes the place of an earlier one, as in a notebook.

    Raises
    ------
    ArgumentError
        If another method goes by one of its names, or another module has registered one of its name.
    """
    module = module_of_caller()
    if _modules.get(method.name, module) != module and _known[method.name] is not method:
        raise ArgumentError(f"{_modules[method.name]} has registered a method {method.name}; choose another name")
    names = {_folded(name) for name in (method.name, *method.aliases)}
    for other in _known.values():
        if other.name != method.name and names & {_folded(name) for name in (other.name, *other.aliases)}:
            raise ArgumentError(f"a method goes by the name {method.name} already")
    _known[method.name], _modules[method.name] = method, module
    return method


def _folded(name: str) -> str:
    return name.lower().replace("_", "-").replace(" ", "-")


def names() -> tuple[str, ...]:
    """Names of all methods, in the order of their registration."""
    return tuple(_known)


def aliases() -> dict[str, str]:
    """Other spellings -> name."""
    return {alias: method.name for method in _known.values() for alias in method.aliases}


def method_of(name: str) -> Method:
    """The record of a method; KeyError for a name that nobody has registered."""
    return _known[name]


def named(word: str) -> str:
    """Name of the method that a word means: capitals, spaces and underscores do not matter.

    Raises
    ------
    ValueError
        For a word that means none.
    """
    for method in _known.values():
        if _folded(word) in {_folded(name) for name in (method.name, *method.aliases)}:
            return method.name
    raise ValueError(f"is not one of {', '.join(names())}")


def explicit_like(name: str) -> str:
    """The method itself if it is explicit, else the explicit one that is set beside implicit ones."""
    return name if method_of(name).explicit else RK4.name


def implicit_like(name: str) -> str:
    """The method itself if it is implicit, else the implicit one that is set beside explicit ones."""
    return GENERALIZED_ALPHA.name if method_of(name).explicit else name


GENERALIZED_ALPHA = register(
    Method(
        "generalized-alpha",
        "tautline.integrators.generalized_alpha:GENERALIZED_ALPHA",
        order=2,
        has_alphas=True,
        aliases=("G-alpha", "generalised-alpha"),
    )
)
"""Chung and Hulbert's method in the form of Arnold and Bruels (2007), eqs 2.79-2.89."""
NEWMARK = register(Method("newmark", "tautline.integrators.generalized_alpha:NEWMARK", order=2))
"""Newmark-beta, the average acceleration, eqs 2.65-2.70."""
RK4 = register(
    Method(
        "rk4",
        "tautline.integrators.rk4:RK4",
        order=4,
        polynomial=(1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0),
        limit=2.8,
        aliases=("runge-kutta",),
    )
)
"""The classical Runge-Kutta method (Fig. 2.7); its limit is that of eq. 2.137, 1 % below 2 sqrt 2."""
