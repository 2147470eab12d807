"""Modes of a linear model that grow and are too fast for the steps of a run, which then shows nothing of them."""

from __future__ import annotations

import math

import numpy as np

from tautline.constraints.penalty import Penalties
from tautline.system.system import System

FOLLOWED = math.pi
"""Frequency times step, rad, above which a step follows no swing: it takes less than two of them."""
ROUNDED = 1.0e-8
"""Share of the largest eigenvalue that the real part of one may have by rounding."""


def growth_said(a: np.ndarray, system: System, step: float) -> list[str]:
    """A warning of modes of A that grow and are too fast for steps of ``step`` s; none where there are none.

    Only what flows feeds such modes: for all else eigenvalues, which take long of thousands of states, are not asked.
    """
    if not system.dofs.flowing.size:
        return []
    values = np.linalg.eigvals(a)
    size = np.abs(values)
    grows = (values.real > ROUNDED * size.max(initial=0.0)) & (size * step > FOLLOWED)
    if not grows.any():
        return []
    rate, frequency = values.real[grows].max(), size[grows].min() / (2.0 * math.pi)
    said = (
        f"the linear model has modes that grow by up to {rate:.3g} 1/s, at {frequency:.3g} Hz and more. Steps of "
        f"{step:g} s do not follow them: a run does not show that they grow"
    )
    return [f"{said}. {_cause(system)}"]


def _cause(system: System) -> str:
    """Where such modes come from, and what to do."""
    if any(isinstance(g, Penalties) for g in system.groups):
        return (
            "They are of the springs of a coupling by penalty: what flows in at such a spring feeds it. Take another "
            "coupling: linear, lagrange or augmented"
        )
    return "They are of a mesh that is too coarse for its flow, or of a force that feeds motion: take more elements"
