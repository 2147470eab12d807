"""Whether a run of the map was long enough: a swing of the bit that still falls is left of the start."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drillstring.results.drilling import last_part, swing_of

CYCLES = 20.0
"""Length of a run that is not asked for, over the period of the string's first torsional mode: half of it tells."""
SHORTEST = 4.0
"""Length over that period below which a quarter of a run holds no whole swing: two of them cannot be compared."""
STEADY = 0.9
"""Swing in a run's last quarter over that in the one before, below which it still falls: of a bit that goes on to
stick and slip it is 0.99 and more."""
FEWEST = 4
"""Frames of a quarter of a run below which what lies between them may be missed."""
FAINT = 0.05
"""Severity that is as good as none: it is given even where it still falls."""


class DyingOut(NamedTuple):
    """Of a swing that still falls: severity in the last quarter of the run; length of run, s, that is enough."""

    severity: float
    enough: float


def brief(time: np.ndarray, period: float) -> bool:
    """Whether a run is too short for its quarters to hold a whole swing: then they differ by their phase alone."""
    return bool(time[-1] - time[0] < SHORTEST * period)


def dying_out(time: np.ndarray, spin: np.ndarray, period: float, creep: float = 0.0) -> DyingOut | None:
    """What the last two quarters of a run tell of a bit's rotary speed (m,) rad/s, where its swing still falls.

    None where the swing is steady or faint, and where the bit sticks to the end: then it does not come to turn
    steadily. None, too, where two quarters cannot be compared: the run is brief, or has few frames. ``period`` is that
    of the string's first torsional mode, s; ``creep`` is as for `stick_slip`.
    """
    last = last_part(time)
    half_time, half = time[last], spin[last]
    late = last_part(half_time)
    if brief(time, period) or min(np.count_nonzero(late), np.count_nonzero(~late)) < FEWEST:
        return None
    whole = swing_of(half, creep)
    before, after = swing_of(half[~late], creep), swing_of(half[late], creep)
    falls = after["swing"] < STEADY * before["swing"]
    if after["stuck"] > 0.0 or not falls or not whole["severity"] > FAINT:
        return None
    enough = _enough(float(time[-1] - time[0]), before["swing"], after["swing"], whole["mean"])
    return DyingOut(after["severity"], max(CYCLES * period, enough))


def _enough(length: float, before: float, after: float, mean: float) -> float:
    """Length of run, s, of which the last half begins when a swing that falls as the two quarters show is faint."""
    rate = math.log(before / max(after, 1e-6 * before)) / (0.25 * length)
    return length + 2.0 * max(0.0, math.log(before / (FAINT * abs(mean)))) / rate
