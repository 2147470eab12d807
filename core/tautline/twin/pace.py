"""Whether rows of a source were written before, or are measured while they come: seen as they come, not when taken."""

from __future__ import annotations

from collections import deque

import numpy as np

LONG_GAP = 120.0
"""Step of stamps that is a gap however little is known of the sample interval, s: it is not simulated."""
AT_ONCE, TOLD_BY = 2.0, 1.0
"""Stamps that go by so many times as fast as rows come are of rows that were written before; and the time after which
that is told, s."""


class Pace:
    """Follows stamps and arrivals of a source at the moment that its records come in.

    A machine is beside its twin as soon as one row has come as it was measured, also while many others wait to be taken
    before it. The thread that hears the source takes, any other may look.

    Attributes
    ----------
    is_record : bool
        Whether all rows so far were written before, so that nobody waits for their answers. What a link gives at once
        after it has stalled is none: its machine goes on.
    """

    def __init__(self) -> None:
        self._came: deque[tuple[float, float]] = deque()
        self._has_paced, self.is_record = False, False

    def take(self, stamp: float, arrived: float) -> None:
        """Take notice of a record by its stamp, and of when it came, s; one that is not the newest shows nothing."""
        if self._has_paced or not np.isfinite(stamp):
            return
        back = self._came[-1][0] - stamp if self._came else 0.0
        if back > LONG_GAP:
            self._came.clear()  # the first row was from the future, or the clock was set back
        elif back > 0.0:
            return
        self._came.append((stamp, arrived))
        while len(self._came) > 1 and self._came[1][1] <= arrived - TOLD_BY:
            self._came.popleft()
        stamps, passed = stamp - self._came[0][0], arrived - self._came[0][1]
        self._has_paced = passed >= TOLD_BY and stamps <= AT_ONCE * passed
        self.is_record = not self._has_paced and (self.is_record or stamps > AT_ONCE * passed)
