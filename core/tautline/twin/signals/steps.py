"""The step in which a sensor tells a place, such as an encoder that counts a few marks a turn.

Where most rows are alike, or go on by the same number of steps, no difference of samples shows noise, and what is laid
through such a staircase follows its treads. Rounding to a step adds what uniform noise of its width does: a standard
deviation of the step over the root of twelve (W. R. Bennett, Bell System Technical Journal 27, 1948).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np

CHANGES = 201
"""Differences of neighbouring samples that are looked at."""
GAPS = 24
"""Widest gaps between sizes of differences that may be the step."""
OFF = 0.05
"""How far a difference may be off a multiple, in steps."""
ROUNDING = 1e-9
"""Differences that are alike, over the largest value: digits of a float."""
TURNS = 5
"""How often the acceleration has to turn from growing to falling, or back: a steady speed shows no step, nor does a
steady acceleration, and one that sets in and stays turns once. A rounded motion turns all the time, also where it only
speeds up."""
PLACES = 6
"""Different places that have to be seen."""
SEVERAL = 3
"""Differences in a row that are off a known step: fewer are a new zero, and no other step."""
LARGEST = 40.0
"""Largest difference, in steps: a sensor that tells more of them is a fine one."""
SIZES = 100
"""Different sizes of differences from which on it is a fine one too, whatever rounding has made of each."""
UNIFORM = 12.0**0.5
"""Width over standard deviation of a uniform distribution."""


class Steps:
    """Finds the step of a sensor from its samples.

    Attributes
    ----------
    step : float
        Step in which the sensor is told, SI; 0 where none is seen.
    """

    def __init__(self) -> None:
        self._changes: deque[float] = deque(maxlen=CHANGES)
        self._largest, self._seen = 0.0, -np.inf
        self.step = 0.0
        self._off: list[float] = []

    @property
    def noise(self) -> float:
        """Standard deviation of what rounding to the step adds, SI."""
        return self.step / UNIFORM

    def look(self, times: np.ndarray, values: np.ndarray) -> None:
        """See samples (n,) in order, SI, with their times (n,), s; those that were seen before do not count again."""
        new = np.flatnonzero(times[1:] > self._seen)
        if not new.size:
            return
        changes = np.diff(values)[new]
        self._seen = float(times[-1])
        self._largest = max(self._largest, float(np.abs(values).max()))
        alike = ROUNDING * self._largest
        if not self.step:
            self._changes.extend(changes.tolist())
            self.step = step_of(np.array(self._changes), alike)
            return
        # A steady speed shows no step, and does not speak against one that was seen; nor does a new zero.
        for change in changes.tolist():
            if self.step and _off(np.array([change]), self.step) <= OFF * self.step + alike:
                self._off.clear()
                self._changes.append(change)
                continue
            self._off.append(change)
            if len(self._off) >= SEVERAL:
                self._changes.extend(self._off)
                self._off.clear()
                self.step = step_of(np.array(self._changes), alike)

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {"changes": list(self._changes), "largest": self._largest, "seen": self._seen, "step": self.step}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self._changes = deque(np.asarray(memory["changes"], float).tolist(), maxlen=CHANGES)
        self._largest, self._seen = float(memory["largest"]), float(memory["seen"])
        self.step = float(memory["step"])


def step_of(changes: np.ndarray, alike: float) -> float:
    """Largest step of which all differences of neighbouring samples are multiples; 0 where there is none.

    Parameters
    ----------
    changes : (n,)
        Differences, SI.
    alike : float
        How far differences may be apart that count as the same, SI.
    """
    sizes = np.unique(np.append(0.0, np.abs(changes)))
    if sizes.size > SIZES:
        return 0.0
    gaps = np.unique(np.diff(sizes))[::-1]
    for gap in gaps[gaps > alike][:GAPS].tolist():
        if not sizes[-1] < (LARGEST + 1.0) * gap:  # most gaps are so small: no more is asked of them
            continue
        counts = np.round(changes / gap)
        largest = float(np.abs(counts).max())
        if not 0.0 < largest <= LARGEST or float(np.abs(changes - gap * counts).max()) > OFF * gap * (1.0 + largest):
            continue
        # What was rounded when it was written is met best by the mean of all multiples.
        step = float(changes @ counts) / float(counts @ counts)
        counts = np.round(changes / step)
        if _off(changes, step) > OFF * step + alike:
            continue
        grows = np.sign(np.diff(counts, 2))
        turns = np.count_nonzero(np.diff(grows[grows != 0.0]))
        enough = turns >= TURNS and np.unique(np.cumsum(counts)).size >= PLACES
        return step if enough else 0.0
    return 0.0


def _off(changes: np.ndarray, step: float) -> float:
    """How far the worst of some differences is off a multiple of a step."""
    return float(np.abs(changes - step * np.round(changes / step)).max())
