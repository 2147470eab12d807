"""When frames of the output are due in a simulation that is stepped, also after the end of its scene."""

from __future__ import annotations

import math

import numpy as np

from tautline.integrators.schedule import frame_times
from tautline.scene.solver import divided, frames_to
from tautline.system.model import SolverSettings

CLOSE = 1.0e-9
"""Share of the output interval within which an advance ends at a frame."""


class FrameClock:
    """Times of the frames after the first, and which is the next.

    Parameters
    ----------
    solver : SolverSettings

    Attributes
    ----------
    next : float
        Time of the next frame, s.
    tolerance : float
        Within which two times are one, s.
    """

    def __init__(self, solver: SolverSettings) -> None:
        self._grid, _ = frame_times(solver.end, solver.interval, solver.step)
        self._interval, self.tolerance = solver.interval, CLOSE * solver.interval
        self._number, self.next = 0, self._time(0)
        whole, rest = frames_to(solver.end, solver.interval)
        self._left = whole * solver.interval if whole and rest else math.inf
        self._whole_step = divided(solver.interval, solver.step)

    def longest_step(self, begin: float, end: float) -> float:
        """Longest step, s, that the frames allow between two times, s, with no frame in between.

        In what is left of the run after its last whole interval that is the step of whole ones, as in `frame_times`.
        """
        left = begin >= self._left - self.tolerance and end <= self._grid[-1] + self.tolerance
        return self._whole_step if left else math.inf

    def parts(self, begin: float, end: float) -> list[tuple[float, float]]:
        """Begin and end, s, of each different part that the frames divide an advance into."""
        if end <= self.next + self.tolerance:
            return [(begin, end)]
        last = self._number_before(end)
        found = [(begin, self.next), (self._time(last), end)]
        # Of frames in between all are a whole interval apart but the one at the end of the scene.
        numbers = {self._number + 1, self._number + 2, self._grid.size - 1}
        found += [(self._time(k - 1), self._time(k)) for k in numbers if self._number < k <= last]
        return found

    def _number_before(self, time: float) -> int:
        """Number of the last frame before a time, s."""
        before = time - self.tolerance
        k = int(np.searchsorted(self._grid, before)) - 1
        if k < self._grid.size - 1:
            return k
        return k + math.floor((before - self._grid[-1]) / self._interval)

    def _time(self, k: int) -> float:
        """Time of the k-th frame after the first; they go on after the scene's end."""
        last = self._grid.size - 1
        return float(self._grid[k] if k <= last else self._grid[last] + (k - last) * self._interval)

    def snapped(self, time: float) -> float:
        """A time ahead, s, or that of a frame which is the same but for rounding."""
        near = self._time(self._number + max(0, round((time - self.next) / self._interval)))
        return near if abs(time - near) <= self.tolerance else time

    def passed(self) -> None:
        """The next frame was kept: the one after it is due."""
        self._number += 1
        self.next = self._time(self._number)

    def stand_at(self, time: float) -> None:
        """Find the next frame after a time, s, that was restored."""
        reached = time + self.tolerance
        k = int(np.searchsorted(self._grid, reached, side="right"))
        if k == self._grid.size:
            k += math.floor((reached - self._grid[-1]) / self._interval)
        while self._time(k) <= reached:
            k += 1
        self._number, self.next = k, self._time(k)
