"""The integrators by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tautline.integrators.generalized_alpha import GeneralizedAlpha, coefficients
from tautline.integrators.newton import corrector
from tautline.integrators.rk4 import RungeKutta4, runge_kutta_4
from tautline.system.model import SolverSettings
from tautline.system.system import System

HALVINGS_OF_AUTO = 24
"""Times that a step may be halved at least where the longest is as long as an output interval."""


def generalized_alpha(system: System, settings: SolverSettings) -> GeneralizedAlpha:
    """Generalized-alpha with the parameters of the settings."""
    return _implicit(system, settings, settings.alpha_m, settings.alpha_f)


def newmark(system: System, settings: SolverSettings) -> GeneralizedAlpha:
    """Newmark-beta, the average acceleration: generalized-alpha with alpha_m = alpha_f = 0, eqs 2.65-2.70."""
    return _implicit(system, settings, 0.0, 0.0)


def _implicit(system: System, settings: SolverSettings, alpha_m: float, alpha_f: float) -> GeneralizedAlpha:
    beta, gamma = coefficients(alpha_m, alpha_f)
    halvings = max(settings.max_halvings, HALVINGS_OF_AUTO) if settings.automatic else settings.max_halvings
    by_energy = settings.criterion == "energy"
    iteration = corrector(
        system,
        settings.tolerance,
        by_energy,
        settings.max_iterations,
        settings.energy_unit,
        settings.contraction,
        full=settings.newton == "full",
    )
    # A row's moment over the force that counts as large is the length by which its unknown counts.
    length = system.scale / (system.force or system.scale.max(initial=1.0))
    length[system.algebraic] = 0.0
    return GeneralizedAlpha(
        alpha_m, alpha_f, beta, gamma, halvings, iteration, np.zeros(2), np.zeros(1), system.algebraic,
        settings.step_error, length, np.array([0.0, 1.0]),
        np.zeros((2, system.size)), np.zeros(1, np.int64),
    )  # fmt: skip


METHODS: dict[str, Callable[[System, SolverSettings], GeneralizedAlpha | RungeKutta4]] = {
    "generalized-alpha": generalized_alpha,
    "newmark": newmark,
    "rk4": lambda system, settings: runge_kutta_4(system, settings.projection, settings.stabilise),
}
"""Makers of a method's scratch; the order test runs over all of them."""


def method_for(system: System, settings: SolverSettings) -> GeneralizedAlpha | RungeKutta4:
    """The method that the settings name."""
    return METHODS[settings.method](system, settings)
