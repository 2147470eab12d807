"""How well conditioned the matrix of an implicit step is, with the scaling of eqs 2.90-2.93 and without."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.constraints.multiplier import Multipliers
from tautline.integrators.generalized_alpha import GeneralizedAlpha
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.kernels.matrix import dense, new_matrix
from tautline.study.trials.trial import Setting, Subject, run_model
from tautline.system.system import System
from tautline.threads import one_thread

MOST = 600
"""Unknowns up to which the condition number is worked out."""
SHORTER = (1.0, 0.1, 0.01)
"""Steps over the scene's."""


class Condition(NamedTuple):
    """Condition numbers (2-norm) at a step, s; ``unscaled`` is None where there are no multipliers to scale."""

    step: float
    scaled: float
    unscaled: float | None


def conditioning(subject: Subject) -> list[Condition]:
    """Condition numbers of S_T at the scene's step and shorter ones; empty for a scene too large, or that cannot be.

    Raises
    ------
    SceneError
        For a scene that an implicit method cannot take.
    """
    model = subject.model(Setting(subject.implicit))
    found: list[Condition] = []

    def look(state: State, t: float, method: GeneralizedAlpha) -> None:
        if not found and method.last_step[0] > 0.0:
            found.extend(_conditions(model.system, state, t, method))

    if 0 < model.system.size <= MOST:
        run_model(model, Setting(subject.implicit), announce=subject.announce, look=look)
    return found


@one_thread()
def _conditions(system: System, state: State, t: float, method: GeneralizedAlpha) -> list[Condition]:
    """Of the state after a step: M, C and K are those of the groups as that step has left them."""
    kept = state.residual.copy()
    parts = []
    for part in np.eye(3):
        matrix = new_matrix(system.size, system.bandwidth, system.border)
        evaluate(system, state, t, 0.0, False, *part, matrix, np.zeros(system.size))
        parts.append(dense(matrix))
    state.residual[:] = kept
    mass, damping, stiffness = parts
    ties = next((g for g in system.groups if isinstance(g, Multipliers)), None)
    rows = system.algebraic
    last = _betas(method, float(method.last_step[0]))[0]
    found = []
    for share in SHORTER:
        h = share * float(method.last_step[0])
        beta, gamma = _betas(method, h)
        tangent = beta * mass + gamma * damping + stiffness
        # The multipliers' rows hold the beta' of the step that was made: eq. 2.92 takes that of the step at hand.
        tangent[rows] = stiffness[rows] * beta / last
        unscaled = None
        if ties is not None and rows.size:
            plain = tangent.copy()
            plain[rows] /= beta * ties.weight
            plain[:, rows] /= beta * ties.weight
            unscaled = float(np.linalg.cond(plain))
        found.append(Condition(h, float(np.linalg.cond(tangent)), unscaled))
    return found


def _betas(method: GeneralizedAlpha, h: float) -> tuple[float, float]:
    """beta' and gamma' of eqs 2.88 and 2.89."""
    return (1.0 - method.alpha_m) / (method.beta * h * h * (1.0 - method.alpha_f)), method.gamma / (method.beta * h)
