"""When frames are due, and the steps to each of them."""

from __future__ import annotations

import functools

import numpy as np

from tautline.scene.solver import frames_to


def frame_times(end: float, interval: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Output times (m,) s, and the number of steps before each: equal, and no longer than ``step``."""
    ends, steps = _frame_times(end, interval, step)
    return ends.copy(), steps.copy()


@functools.lru_cache(maxsize=2)
def _frame_times(end: float, interval: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """The same, found once for runs that differ in other things."""
    whole, rest = frames_to(end, interval)
    ends = interval * np.arange(1, whole + 1)
    if rest:
        ends = np.append(ends, end)
    elif ends.size:
        ends[-1] = end
    return ends, steps_to(ends, 0.0, step)


def steps_to(ends: np.ndarray, begin: float, step: float) -> np.ndarray:
    """Number of steps (m,) to each frame from the one before, or from ``begin`` s: none longer than ``step``, s."""
    return np.maximum(1, np.ceil(np.diff(ends, prepend=begin) / step - 1e-9)).astype(np.int64)
