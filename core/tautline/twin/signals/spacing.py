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
"""Longest that the first row waits for others that show the noise of inputs, and how often they come, s; for an input
that was seen to come twice it waits for its next reading too, up to `MOST_WAITED`."""
RARER = 2.5
"""Sample intervals between readings of an input from which on rows wait for it: others lose some of theirs. And
intervals of its own behind which it has stopped: it may lose one reading, too."""
STEPS, FEWEST, ALIKE = 5, 2, 1.5
"""Last pauses of which the median is that of an input; how many tell it at the least, more than half of those that are
there; and how many times off it they are at most."""
REMEMBERED = 12
"""Last pauses of which the longest but one is waited for, and `ALIKE` times of it: one alone may be a stop."""
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
        self._irregular = [0] * count  # readings in a row at which no interval was known
        self._steps: list[deque[float]] = [deque(maxlen=REMEMBERED) for _ in range(count)]

    def take(self, time: float, values: np.ndarray, newest: float = -np.inf) -> None:
        """Take notice of a row with readings (c,), NaN is none, and of when the newest row before it was."""
        self._newest = max(time, newest)
        for i in self.inputs:
            if np.isnan(values[i]):
                continue
            if time > self._last[i] + ONE_STAMP:
                self._steps[i].append(float(time - self._last[i]))
            self._irregular[i] = 0 if self.is_regular(i) else self._irregular[i] + 1
            self._late[i] = self._newest - time
            self._last[i] = time  # also of one out of order: the one before it may be from the future

    def of(self, i: int) -> float:
        """Time between readings of a column, s; 0 where it is not known, or where they come now and then."""
        last = list(self._steps[i])[-STEPS:]
        if len(last) < FEWEST:
            return 0.0
        usual = float(np.median(last))
        alike = sum(usual / ALIKE <= one <= usual * ALIKE for one in last)
        return usual if alike > len(last) // 2 else 0.0

    def longest(self, i: int) -> float:
        """Longest pause but one of a column, of the last ones, s; 0 where it is not known."""
        return sorted(self._steps[i])[-2] if len(self._steps[i]) >= FEWEST else 0.0

    def is_regular(self, i: int) -> bool:
        """Whether readings of a column come at equal intervals, but for some that are lost."""
        usual = self.of(i)
        shorter = sum(one < usual / ALIKE for one in list(self._steps[i])[-STEPS:])
        return 0.0 < self.longest(i) <= RARER * usual and shorter <= 1

    def is_told(self, i: int) -> bool:
        """Whether it may be said how a column comes: what changes to another interval is irregular for a while."""
        return self.is_regular(i) or self._irregular[i] >= REMEMBERED

    def has_stopped(self, i: int) -> bool:
        """Whether readings of a column were to come, and have not: not even as late as the last one came."""
        usual = max(RARER * self.of(i), ALIKE * self.longest(i))
        return usual > 0.0 and self._newest - self._last[i] > usual + self._late[i] + ONE_STAMP

    def has_come_since(self, i: int, time: float) -> bool:
        """Whether there is a reading of a column from behind a time."""
        return bool(self._last[i] > time + ONE_STAMP)

    @property
    def known(self) -> bool:
        """Whether it is known of each input."""
        return all(len(self._steps[i]) >= FEWEST for i in self.inputs)

    def shows_too_little(self, span: float) -> bool:
        """Whether the first row waits until it is known, after rows over a time, s: longer where an input has come."""
        comes = any(0 < len(self._steps[i]) < FEWEST for i in self.inputs)
        return not self.known and span < (MOST_WAITED if comes else SHOWN_IN)

    def wait(self, i: int, interval: float) -> float:
        """How long rows are to wait for a column that comes, s; 0 where it comes about as often as they, `interval` s
        apart."""
        own, longest = self.of(i), self.longest(i)
        if max(own, longest) <= RARER * interval:
            return 0.0
        # An input of which some pauses are too long is waited for over the others.
        irregular = ALIKE * longest if ALIKE * longest <= MOST_WAITED else 0.0
        return max(DELAY * own * (own > RARER * interval), irregular)

    def waited(self, interval: float) -> float:
        """How long rows wait for inputs that come more rarely than they do, s, where the map gives no delay."""
        waits = [self.wait(i, interval) for i in self.inputs if not self.has_stopped(i)]
        return max([one for one in waits if one <= MOST_WAITED], default=0.0)
