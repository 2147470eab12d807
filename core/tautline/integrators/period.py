"""By how much a step of a method turns an oscillation too little: its own period error, from its amplification."""

from __future__ import annotations

import cmath
from typing import Any

from tautline.integrators.stepping import stepping_with

STEPS_PER_PERIOD = 10.0
"""Steps that a decent picture of an oscillation takes (thesis section 2.5)."""


def lag_of_step(method: Any, turn: float) -> float:
    """Phase by which q.. + omega^2 q = 0 falls behind in one step of h, rad; negative where it runs ahead.

    Parameters
    ----------
    method : NamedTuple
        Scratch of the method.
    turn : float
        omega h, rad.
    """
    if turn <= 0.0:
        return 0.0
    factor = stepping_with(method).amplification(method, turn)
    if turn > cmath.pi:
        return turn - abs(cmath.phase(factor))
    return -cmath.phase(factor * cmath.exp(-1j * turn))
