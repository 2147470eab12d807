"""When what is computed can be judged again, after inputs that were missing, stuck or set back.

While an input comes to rest, or joins its sensor again, the simulation moves as the machine does not, and a load that
it has set bouncing bounces on after that. Until it agrees with what is measured, its overloads are its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

AGREED = 1.0
"""For how long what is computed has to agree with what is measured, s."""
SMALL, SHARE = 4.0, 0.05
"""Residual that agrees: in standard deviations, or as a share of what is measured; the larger counts."""


class Settling:
    """Whether the machine's motion is followed, and since when.

    Attributes
    ----------
    since : float
        Time from which on what is computed can be judged, s; infinite while it cannot.
    moved_at : float
        Time at which an input was last led by something else than its sensor, s; minus infinity.
    """

    def __init__(self) -> None:
        self.since = self.moved_at = -np.inf
        self._agreed_from = np.nan

    @property
    def catching_up(self) -> bool:
        """Whether what is computed cannot be judged yet."""
        return not np.isfinite(self.since) and self.since > 0.0

    def disturb(self, time: float) -> None:
        """Take notice that an input does not go as its sensor says."""
        self.since, self.moved_at, self._agreed_from = np.inf, time, np.nan

    def follow(self, time: float, residuals: np.ndarray, sds: np.ndarray, measured: np.ndarray) -> None:
        """Take the residuals (m,) of a row, with their standard deviations (m,) and what is measured (m,).

        NaN is what is not compared; where nothing is, time alone counts.
        """
        if not self.catching_up or time <= self.moved_at:
            return
        known = np.isfinite(residuals)
        small = np.maximum(SMALL * sds, SHARE * np.abs(measured))[known]
        if np.any(np.abs(residuals[known]) > small):
            self._agreed_from = np.nan
        elif not np.isfinite(self._agreed_from):
            self._agreed_from = time
        elif time - self._agreed_from >= AGREED - 1e-9:
            self.since = time

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {"since": self.since, "moved_at": self.moved_at, "agreed_from": self._agreed_from}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self.since, self.moved_at = float(memory["since"]), float(memory["moved_at"])
        self._agreed_from = float(memory["agreed_from"])
