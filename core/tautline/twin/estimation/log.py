"""The last rows as the simulations were given them, and states from which they can be gone through again."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tautline.twin.pace import ONE_STAMP
from tautline.twin.signals.smoothing import coming_to_rest

if TYPE_CHECKING:
    from tautline.live.memory import State

CHECKPOINT, MOST = 0.5, 30
"""How often states are kept, to begin again from, s; and how many of them in a window: of one that lasts minutes they
come less often, or they would be a hundred megabytes in memory and in every saved state."""


@dataclass
class Logged:
    """A row as it was given to the simulations, so that it can be gone through again.

    Attributes
    ----------
    inputs : list
        Name and state (3,) of each input.
    y : (m,)
        What the sensors showed; NaN where they showed nothing, or nothing that is compared.
    use : (m,) of bool
        Which of them can be believed, whatever the simulations do.
    """

    time: float
    inputs: list[tuple[str, np.ndarray]]
    y: np.ndarray
    use: np.ndarray


@dataclass
class Checkpoint:
    """States of a family at a row."""

    time: float
    states: list[State]


class Log:
    """Rows and checkpoints, as long as a window can begin there.

    Parameters
    ----------
    window : float
        Of the estimate, s.

    Attributes
    ----------
    every : float
        How often states are kept, s.
    origin : float
        Time of the data at which the simulations' own time is zero, s; NaN before they have begun.
    began : float
        Time of the row at which they began, s; NaN where it is not known, as of a state of an earlier version.
    """

    MADE_ANEW = ("window", "every")

    def __init__(self, window: float) -> None:
        self.window, self.every = window, max(CHECKPOINT, window / MOST)
        self.rows: deque[Logged] = deque()
        self.checkpoints: deque[Checkpoint] = deque()
        self.origin = self.began = np.nan

    @property
    def begun(self) -> bool:
        """Whether the simulations stand where the data are."""
        return bool(np.isfinite(self.origin))

    @property
    def reaches_begin(self) -> bool:
        """Whether the window goes back to where the simulations began."""
        return bool(self.rows and self.checkpoints) and self.rows[0].time == self.checkpoints[0].time == self.began

    def begin(self, time: float, states: list[State]) -> None:
        """Keep the states with which the simulations begin, at a row."""
        self.began = time
        self.keep(time, states)

    def is_due(self, time: float) -> bool:
        """Whether states should be kept at a time."""
        return not self.checkpoints or time - self.checkpoints[-1].time >= self.every - ONE_STAMP

    def keep(self, time: float, states: list[State]) -> None:
        """Keep states at a row."""
        self.checkpoints.append(Checkpoint(time, states))
        self.forget(time)

    def forget(self, time: float) -> None:
        """Drop what is older than a window that ends at a time."""
        oldest = time - self.window
        while len(self.checkpoints) > 1 and self.checkpoints[1].time <= oldest:
            self.checkpoints.popleft()
        # Rows are kept longer than checkpoints: those of the spare family may lie further back.
        while self.rows and self.rows[0].time <= oldest - 4.0 * self.every:
            self.rows.popleft()

    def after(self, time: float) -> Logged | None:
        """The first row after a time."""
        k = bisect_right(self.rows, time + 1e-12, key=lambda one: one.time)
        return self.rows[k] if k < len(self.rows) else None

    def resting(self, time: float) -> list[tuple[str, np.ndarray]]:
        """States of inputs on the way through a gap: what the last row had, coming to rest."""
        last = self.rows[-1] if self.rows else None
        if last is None:
            return []
        return [(name, coming_to_rest(state, time - last.time)) for name, state in last.inputs]

    def clear(self) -> None:
        """Forget all: the simulations are put back to rest."""
        self.rows.clear()
        self.checkpoints.clear()
        self.origin = self.began = np.nan
