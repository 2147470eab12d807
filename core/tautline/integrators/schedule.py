"""When frames are due, and the steps to each of them."""

from __future__ import annotations

import functools

import numpy as np

from tautline.scene.solver import divided, frames_to

PART = 1.0e-6
"""Share of the output interval by which a frame is nearer than a whole one, at least, to be a part of one."""


def frame_times(end: float, interval: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Output times (m,) s, and the number of steps before each, as `steps_to_frames` counts them."""
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
    return ends, steps_to_frames(ends, 0.0, interval, step)


def steps_to_frames(ends: np.ndarray, begin: float, interval: float, step: float) -> np.ndarray:
    """Number of equal steps (m,) to each frame from the one before, or from ``begin`` s: none longer than ``step``, s.

    Nor are those to a frame that is less than an ``interval``, s, away longer than those of whole intervals: that
    alone may be what keeps an explicit method below its critical step.
    """
    steps = steps_to(ends, begin, step)
    if ends.size and interval <= ends[-1] * (1.0 + PART):
        parts = np.diff(ends, prepend=begin) < interval * (1.0 - PART)
        steps[parts] = steps_to(ends, begin, divided(interval, step))[parts]
    return steps


def steps_to(ends: np.ndarray, begin: float, step: float) -> np.ndarray:
    """Number of steps (m,) to each frame from the one before, or from ``begin`` s: none longer than ``step``, s."""
    return np.maximum(1, np.ceil(np.diff(ends, prepend=begin) / step - 1e-9)).astype(np.int64)
