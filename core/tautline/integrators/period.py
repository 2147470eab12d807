"""By how much a step of a method turns an oscillation too little: its own period error, from its amplification."""

from __future__ import annotations

import cmath

import numpy as np

from tautline.integrators.generalized_alpha import GeneralizedAlpha
from tautline.integrators.rk4 import RungeKutta4

STEPS_PER_PERIOD = 10.0
"""Steps that a decent picture of an oscillation takes (thesis section 2.5)."""


def lag_of_step(method: GeneralizedAlpha | RungeKutta4, turn: float) -> float:
    """Phase by which q.. + omega^2 q = 0 falls behind in one step of h, rad; negative where it runs ahead.

    Parameters
    ----------
    turn : float
        omega h, rad.
    """
    if turn <= 0.0:
        return 0.0
    factor = _of_rk4(turn) if isinstance(method, RungeKutta4) else _of_generalized_alpha(method, turn)
    if turn > cmath.pi:
        return turn - abs(cmath.phase(factor))
    return -cmath.phase(factor * cmath.exp(-1j * turn))


def _of_rk4(turn: float) -> complex:
    """What a step multiplies exp(i omega t) by: the exponential series up to its fourth power."""
    z = 1j * turn
    return 1.0 + z * (1.0 + z * (0.5 + z * (1.0 / 6.0 + z / 24.0)))


def _of_generalized_alpha(m: GeneralizedAlpha, turn: float) -> complex:
    """The principal root of the amplification of (q, h v, h^2 a*), a* the auxiliary acceleration of eq. 2.86."""
    x = turn * turn
    inertia = 1.0 - m.alpha_m + x * (1.0 - m.alpha_f) * m.beta
    late = x * (1.0 - m.alpha_f)
    new = -np.array([x * m.alpha_f + late, late, m.alpha_m + late * (0.5 - m.beta)]) / inertia
    way = np.array([1.0, 1.0, 0.5 - m.beta]) + m.beta * new
    speed = np.array([0.0, 1.0, 1.0 - m.gamma]) + m.gamma * new
    roots = np.linalg.eigvals(np.array([way, speed, new]))
    turning = [complex(root) for root in roots if root.imag > 0.0]
    # Of a step longer than half a period no root is near: the pair that turns is the principal one.
    return max(turning, key=abs, default=-1.0 + 0.0j) if turning else complex(max(roots, key=abs))
