"""Where an input goes in the next seconds: it goes on at its speed, or, of a ship in waves, as a linear prediction.

The prediction is autoregressive: its coefficients are those that would have predicted the last minutes best (least
squares, the covariance method). A sum of harmonics is predicted without error but for noise; a sea for a few seconds.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from tautline.twin.pace import ONE_STAMP
from tautline.twin.signals.smoothing import coming_to_rest, joined

MEMORY = 180.0
"""Over how long motions are remembered, s."""
STEP = 0.25
"""Interval at which they are, s."""
ORDER = 48
"""Samples that the next one is predicted from."""
FEWEST = 4 * ORDER
FORGOTTEN = 20.0 * STEP
"""Time without a sample after which what was before tells nothing of a motion, s."""
NOISE = 1e-6
"""Share of the variance that is taken for noise, so that the equations can be solved."""


class Waves:
    """One motion, remembered at a fixed interval."""

    def __init__(self) -> None:
        self._values: deque[float] = deque(maxlen=int(MEMORY / STEP))
        self._next = -np.inf
        self._state = np.zeros(3)
        self._time = 0.0
        self._held_from = np.nan
        self._coefficients: np.ndarray | None = None
        self._fitted = 0

    def add(self, time: float, state: np.ndarray, held: bool = False) -> None:
        """Take the motion's value, rate and second rate (3,) at a time, s; held is what no sensor shows now."""
        back = not held and time - self._held_from > FORGOTTEN
        if back or time - self._next > FORGOTTEN or self._next == -np.inf:
            self._values.clear()
            self._next = time
        if not held:
            self._held_from = np.nan
        elif not np.isfinite(self._held_from):
            self._held_from = time
        before, at = self._state, self._time
        while self._next <= time + ONE_STAMP:
            share = (self._next - at) / (time - at) if time > at else 1.0
            self._values.append(float(before[0] + share * (state[0] - before[0])) if share < 1.0 else float(state[0]))
            self._next += STEP
        self._state, self._time = state, time

    def memory(self) -> np.ndarray:
        """What a later process needs to go on: values, when the next is due, and the newest time and state."""
        return np.append(np.array(self._values), [self._next, self._time, *self._state])

    def recall(self, memory: np.ndarray) -> None:
        """Go on from what an earlier process kept."""
        *values, self._next, self._time, a, b, c = memory.tolist()
        self._values.extend(values)
        self._state = np.array([a, b, c])

    def ahead(self, times: np.ndarray) -> np.ndarray:
        """Value, rate and second rate (n, 3) at times ahead (n,), s from the newest on."""
        if np.isfinite(self._held_from):
            return np.array([coming_to_rest(self._state, after) for after in times])
        if len(self._values) < FEWEST:
            return _at_speed(self._state, times)
        x = np.array(self._values)
        mean = x.mean()
        c = self._fit(x - mean)
        n = int(np.ceil((times[-1] + STEP) / STEP)) + 2
        path = list(x[-len(c) :] - mean)
        for _ in range(n):
            path.append(float(np.dot(c, path[: -len(c) - 1 : -1])))
        from scipy.interpolate import CubicSpline

        newest = self._next - STEP - self._time
        grid = newest + STEP * np.arange(1 - len(c), n + 1)
        spline = CubicSpline(grid, np.array(path) + mean)
        found = np.stack([spline(times, k) for k in range(3)], axis=-1)
        # What the prediction is off by now fades within a second.
        off = self._state - np.array([spline(0.0, k) for k in range(3)])
        fades = np.exp(-times)
        found[:, 0] += (off[0] + off[1] * times) * fades
        found[:, 1] += (off[1] - off[0] - off[1] * times) * fades
        found[:, 2] += (off[0] - 2.0 * off[1] + off[1] * times) * fades
        return found

    def lasting(self, span: float) -> bool:
        """Whether so many seconds of the motion are known."""
        return len(self._values) * STEP > span + STEP

    def replayed(self, times: np.ndarray, span: float, factor: float, join: float) -> np.ndarray:
        """The motion of the last seconds once more, times a factor about its mean.

        Parameters
        ----------
        times : (n,)
            Times ahead, up to `span`, s.
        span : float
            How much of the motion that was measured, s.
        factor : float
            Times its size.
        join : float
            Time in which the motion goes over from what it is now, s.

        Returns
        -------
        (n, 3)
            Value, rate and second rate.
        """
        from scipy.interpolate import CubicSpline

        x = np.array(self._values)
        begin = self._next - STEP - self._time - STEP * np.arange(len(x))[::-1]
        spline, mean = CubicSpline(begin + span, x), x.mean()

        def scaled(t: float) -> np.ndarray:
            now = np.array([spline(t, k) for k in range(3)])
            return np.array([mean + factor * (now[0] - mean), factor * now[1], factor * now[2]])

        apart = self._state - scaled(0.0)
        return np.array([scaled(t) + joined(apart, t / join, join) for t in times])

    def _fit(self, x: np.ndarray) -> np.ndarray:
        """Coefficients (ORDER,), found anew every few samples."""
        self._fitted += 1
        if self._coefficients is None or self._fitted % 8 == 0:
            rows = np.lib.stride_tricks.sliding_window_view(x, ORDER + 1)
            past, new = rows[:, ORDER - 1 :: -1], rows[:, ORDER]
            weak = NOISE * float(np.mean(x**2)) * len(rows)
            if weak == 0.0:  # nothing moves
                return np.zeros(ORDER)
            square = past.T @ past + weak * np.eye(ORDER)
            self._coefficients = np.linalg.solve(square, past.T @ new)
        return self._coefficients


def _at_speed(state: np.ndarray, times: np.ndarray) -> np.ndarray:
    """What goes on at its speed."""
    return np.stack([state[0] + state[1] * times, np.full_like(times, state[1]), np.zeros_like(times)], axis=-1)
