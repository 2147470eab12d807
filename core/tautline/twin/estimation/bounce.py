"""The period with which a load bounces, of a scene at its start that is struck and left alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from tautline.live.simulation import Simulation
    from tautline.twin.estimation.family import Blow

STEP, AT_A_TIME, MOST = 0.02, 150, 1500
"""Interval, s, and number of looks at a load that was struck, to see how fast it bounces: as a rule, and at most."""
LARGE = 0.1
"""Share of the largest from which on the motion of a load counts: what is smaller is a ripple in its rope."""


def first_bounce(first: Simulation, blow: Blow) -> float:
    """Period of the free motion, s, before there are rows; 0 where the load stays where it is."""
    calm, struck = first.copy(), first.copy()
    struck.displace(blow.output, blow.by)
    found: list[float] = []
    period = 0.0
    # Where the load itself is: at the far end of a long rope a ripple is all there is until the wave has come.
    for k in range(1, MOST + 1):
        for sim in (calm, struck):
            sim.advance_heard(first.time + STEP * k, None)
        found.append(float(np.ravel(blow.by) @ (np.ravel(struck[blow.output]) - np.ravel(calm[blow.output]))))
        if k % AT_A_TIME == 0 and (period := period_of(np.array(found))) > 0.0:
            break
    return period


def period_of(motion: np.ndarray) -> float:
    """Period of a motion (n,) after a blow, s, by its turns beyond a tenth of the largest; 0 before two of them."""
    large = np.flatnonzero(np.abs(motion) > LARGE * np.abs(motion).max())
    turns = large[1:][np.diff(np.sign(motion[large])) != 0.0]
    return 2.0 * STEP * float(turns[-1] - turns[0]) / (turns.size - 1) if turns.size >= 2 else 0.0
