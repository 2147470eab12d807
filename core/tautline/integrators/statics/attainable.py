"""What a tolerance of Newton's method can reach: a residual is known no better than the numbers that it is made of."""

from __future__ import annotations

import math
from collections import ChainMap
from collections.abc import MutableMapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

from tautline.integrators.generalized_alpha import coefficients
from tautline.integrators.linearise import evaluate
from tautline.integrators.newton_at_rest import ROUNDING
from tautline.integrators.state import State, new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.status import StoppedEarly
from tautline.kernels.matrix import Factors, factorise_matrix, new_factors, sizes_of_rows, solve_matrix
from tautline.scene.methods import method_of
from tautline.system.model import Model, SolverSettings
from tautline.system.system import System

EXAMINED = 1.0e-9
"""Tolerance below which it is asked whether it can be reached; what applications choose themselves is above."""
MANY = 30_000
"""Unknowns from which it is asked of any tolerance where rounding grows with their number: short elements are stiff."""
SAMPLES = 8
"""Times that the signs of what rounding leaves are drawn, for its energy."""


def within_rounding(model: Model, key: str = "solver.tolerance", many: float = math.inf, known: float = 0.0) -> Model:
    """The model with a tolerance that its numbers can reach, and a note where the scene asks for less.

    Iterations that seek less than rounding leaves are all in vain, and then the step is halved in vain too. It is asked
    of small tolerances, and of all where there are ``many`` unknowns. ``known`` is what the application itself knows
    rounding to leave, by the settings' criterion: the larger of the two counts, and is told alone.
    """
    settings = model.solver
    if method_of(settings.method).explicit:
        return model
    asked = max(settings.tolerance, known) < EXAMINED or model.system.size >= many
    found = attainable(model.system, settings, model.step_limit) if asked else 0.0
    # A tolerance of one or more is none.
    return _loosened(model, max((least for least in (known, found) if least < 1.0), default=0.0), key)


def _loosened(model: Model, least: float, key: str) -> Model:
    """The model with the tolerance ``least``, and a note, where the scene asks for less."""
    settings = model.solver
    if not settings.tolerance < least:
        return model
    note = (
        f"{key} = {settings.tolerance:g} is below what the rounding of numbers leaves in this scene, {least:.1e}. "
        f"The run uses {least:.1e}"
    )
    attributes = ChainMap({"tolerance": least}, cast("MutableMapping[str, Any]", model.attributes))
    return replace(model, solver=replace(settings, tolerance=least), notes=[*model.notes, note], attributes=attributes)


def attainable(system: System, settings: SolverSettings, step_limit: float = math.inf) -> float:
    """Least tolerance, by the settings' criterion, that rounding lets the iteration reach; zero where nothing moves.

    A row's force is the sum of stiffnesses times positions, each of sixteen digits, as the drawing has them. Where the
    unknowns are displacements from it, as those of lumps, they are zero there, and those at rest are taken: a search
    for them may change an unknown by ``step_limit`` (m or rad) at once. Where there is no rest nothing is known: zero.
    """
    state = new_state(system)
    if not system.size:
        return 0.0
    if not state.q.any():
        try:
            find_equilibrium(system, state, step_limit)
        except StoppedEarly:
            return 0.0
    # Room for the stiffness, and then for the tangent of a step: of many unknowns each takes hundreds of megabytes.
    factors = new_factors(system.size, system.bandwidth, system.border)
    with np.errstate(all="ignore"):
        evaluate(system, state, 0.0, 0.0, False, 0.0, 0.0, 1.0, factors.matrix, np.zeros(system.size))
        left = ROUNDING * sizes_of_rows(factors.matrix, state.q)
        left[system.algebraic] = 0.0
        if settings.criterion == "energy":
            least = _energy(system, settings, state, left, factors)
        else:
            least = float((left / system.scale).max())
    return least if np.isfinite(least) else 0.0


def _energy(system: System, settings: SolverSettings, state: State, left: np.ndarray, factors: Factors) -> float:
    """Error of eq. 2.78 of increments that solve for what rounding leaves: the largest of some draws of its signs."""
    alpha_m, alpha_f = (settings.alpha_m, settings.alpha_f) if method_of(settings.method).has_alphas else (0.0, 0.0)
    beta, gamma = coefficients(alpha_m, alpha_f)
    h = min(settings.step, settings.interval)
    mass = (1.0 - alpha_m) / (beta * h * h * (1.0 - alpha_f))
    evaluate(system, state, 0.0, 0.0, False, mass, gamma / (beta * h), 1.0, factors.matrix, np.zeros(system.size))
    if factorise_matrix(factors):
        return 0.0
    draws, largest = np.random.default_rng(0), 0.0
    for _ in range(SAMPLES):
        force = left * draws.choice([-1.0, 1.0], left.size)
        increment = force.copy()
        solve_matrix(factors, increment)
        largest = max(largest, abs(float(force @ increment)))
    unit = settings.energy_unit or float(system.scale.max(initial=0.0)) or 1.0
    return float(np.sqrt(largest / unit))
