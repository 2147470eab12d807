"""How far apart the readings of each input come, and how long rows wait for that.

An input is known between two of its readings, so a row waits for the next one. Where the map gives no delay, rows wait
three sample intervals, and that is less than the pause of an input that comes more rarely than what is measured beside
it, such as a flow at 5 Hz beside a position at 50 Hz.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from tautline.twin.pace import ONE_STAMP

DELAY = 3.0
"""Sample intervals that a row waits where no delay is given; of an input that comes more rarely, its own."""
SHOWN_IN = 1.0
"""Longest that the first row waits for others that show the noise of inputs, and how often they come, s."""
RARER = 2.5
"""Sample intervals between readings of an input from which on rows wait for it: others lose some of theirs. And
intervals of its own behind which it has stopped: it may lose one reading, too."""
STEPS, FEWEST, ALIKE = 5, 3, 1.5
"""Last pauses of which the median is that of an input; and how many tell it, no more than so many times off it."""
MOST_WAITED = 3.0
"""Longest that rows wait for an input where no delay is given, s: an alarm comes later by that."""


class Spacing:
    """Follows how far apart readings of each column come, by their stamps.

    What has stopped coming keeps the pause that it had, and rows wait for it no more until it comes again.

    Parameters
    ----------
    count : int
        Of the columns.

    Attributes
    ----------
    inputs : sequence of int
        Numbers of the columns that are waited for.
    """

    MADE_ANEW = ("inputs",)

    def __init__(self, count: int) -> None:
        self.inputs: Sequence[int] = ()
        self._last = np.full(count, np.nan)
        self._late = np.zeros(count)  # by how much the last of each column came behind others
        self._newest = -np.inf
        self._steps: list[deque[float]] = [deque(maxlen=STEPS) for _ in range(count)]

    def take(self, time: float, values: np.ndarray, newest: float = -np.inf) -> None:
        """Take notice of a row with readings (c,), NaN is none, and of when the newest row before it was."""
        self._newest = max(time, newest)
        for i in self.inputs:
            if np.isnan(values[i]):
                continue
            if time > self._last[i] + ONE_STAMP:
                self._steps[i].append(float(time - self._last[i]))
            self._late[i] = self._newest - time
            self._last[i] = time  # also of one out of order: the one before it may be from the future

    def of(self, i: int) -> float:
        """Time between readings of a column, s; 0 where it is not known, or where they come now and then."""
        if len(self._steps[i]) < FEWEST:
            return 0.0
        usual = float(np.median(self._steps[i]))
        alike = sum(usual / ALIKE <= one <= usual * ALIKE for one in self._steps[i])
        return usual if alike >= FEWEST else 0.0

    def has_stopped(self, i: int) -> bool:
        """Whether readings of a column were to come, and have not: not even as late as the last one came."""
        usual = self.of(i)
        return usual > 0.0 and self._newest - self._last[i] > RARER * usual + self._late[i] + ONE_STAMP

    @property
    def known(self) -> bool:
        """Whether it is known of each input."""
        return all(len(self._steps[i]) >= FEWEST for i in self.inputs)

    def wait(self, i: int, interval: float) -> float:
        """How long rows are to wait for a column that comes, s; 0 where it comes about as often as they, `interval` s
        apart."""
        own = self.of(i)
        return DELAY * own if own > RARER * interval else 0.0

    def waited(self, interval: float) -> float:
        """How long rows wait for inputs that come more rarely than they do, s, where the map gives no delay."""
        waits = [self.wait(i, interval) for i in self.inputs if not self.has_stopped(i)]
        return max([one for one in waits if one <= MOST_WAITED], default=0.0)
