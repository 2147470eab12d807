"""What a heave is made of: how large and how fast it gets, found without regard to how long a run is.

What is computed ahead of a run goes by this. A run that ends later then has the same motion for as long as both last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from tautline.kernels.time_function import TimeFunctions, sample

PERIODS = 100.0
"""Longest periods of its waves over which a heave is looked at."""
PER_PERIOD, FEWEST, MOST = 16.0, 1_000, 100_000
"""Times at which it is looked at: so many in the shortest period, and of all."""
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Golden section: no period fits its multiples, so that a motion which is nothing at all of them is nothing."""
CHUNK = 20_000
"""Times for which frames are placed at once."""


@dataclass(frozen=True, eq=False)
class Content:
    """Sizes of a function of time.

    Attributes
    ----------
    size : float64 (3,)
        Largest value, rate and second rate, without their signs.
    period : float
        That of a wave with the same range and rate, s; 0 of what does not move.
    """

    size: np.ndarray
    period: float


def content_of(functions: TimeFunctions, reach: float, end: float) -> Content:
    """Look at a function of time: where its formula changes, and over many periods of its waves.

    Parameters
    ----------
    functions : TimeFunctions
        Function 0, and those that it is made of.
    reach : float
        Time up to which it is known, s.
    end : float
        Time to which the run goes, s. It counts for chirps alone, whose frequency grows for ever.
    """
    waves = functions.waves[functions.waves[:, 0] != 0.0]
    frequency = np.abs(waves[:, 1] + 2.0 * waves[:, 2] * end)
    frequency = frequency[frequency > 0.0]
    breaks = np.unique(functions.breaks[(functions.breaks >= 0.0) & (functions.breaks <= reach)])
    last = max(breaks.max(initial=0.0), waves[:, 4].max(initial=0.0), end if np.any(waves[:, 2]) else 0.0)
    window, count = last, FEWEST
    if frequency.size:
        window = last + PERIODS * 2.0 * math.pi / float(frequency.min())
        count = int(np.clip(PER_PERIOD * window * frequency.max() / (2.0 * math.pi), FEWEST, MOST))
    spread = min(window, reach) * (np.arange(count) * GOLDEN % 1.0)
    time = np.concatenate((breaks, breaks[:-1] + GOLDEN * np.diff(breaks), spread))
    found = sampled(functions, time)
    size = np.abs(found).max(axis=0)
    period = math.pi * float(np.ptp(found[:, 0])) / size[1] if size[1] > 0.0 else 0.0
    return Content(size, period)


def sampled(functions: TimeFunctions, time: np.ndarray) -> np.ndarray:
    """Value, rate and second rate (n, 3) of function 0 at any number of times."""
    parts = [sample(functions, 0, time[k : k + CHUNK]) for k in range(0, time.size, CHUNK)]
    return np.concatenate(parts) if parts else np.zeros((0, 3))
