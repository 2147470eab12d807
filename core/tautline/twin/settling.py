"""When what is computed can be judged again, after inputs that were missing, stuck or set back.

While an input comes to rest, or joins its sensor again, the simulation moves as the machine does not, and a load that
it has set bouncing bounces on after that. Until it agrees with what is measured, its overloads are its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from tautline.twin.pace import ONE_STAMP

AGREED = 1.0
"""For how long what is computed has to agree with what is measured, s."""
SMALL, SHARE = 4.0, 0.05
"""Residual that agrees: in standard deviations, or as a share of what is measured; the larger counts."""

SPREAD = 2.0
"""And in standard deviations of the residuals before: what a wrong weight leaves swings as the load does."""
USUAL = 3.0
"""Time over which the residual that stands is taken, s: that of a sensor that is off is not the input's."""
LATEST, BOUNCES = 4.0, 5.0
"""How long after an input has joined its sensor all is judged again in any case: s, and periods of a load's bounce; the
larger counts."""


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
        self._agreed_from, self._followed = np.nan, np.nan
        self._usual = self._square = np.zeros(0)

    @property
    def catching_up(self) -> bool:
        """Whether what is computed cannot be judged yet."""
        return not np.isfinite(self.since) and self.since > 0.0

    def disturb(self, time: float) -> None:
        """Take notice that an input does not go as its sensor says."""
        self.since, self.moved_at, self._agreed_from = np.inf, time, np.nan

    def follow(
        self, time: float, residuals: np.ndarray, sds: np.ndarray, measured: np.ndarray, bounce: float = 0.0
    ) -> None:
        """Take the residuals (m,) of a row, with their standard deviations (m,) and what is measured (m,).

        NaN is what is not compared; where nothing is, time alone counts.

        Parameters
        ----------
        bounce : float
            Period in which a load bounces, s; 0 where none does.
        """
        if not self.catching_up:
            self._keep(time, residuals)
            return
        if time <= self.moved_at:
            return
        if time - self.moved_at >= max(LATEST, BOUNCES * bounce) - ONE_STAMP:
            self.since = time
            return
        known = np.isfinite(residuals)
        if self._usual.shape != residuals.shape:
            self._usual, self._square = np.full(residuals.shape, np.nan), np.zeros(residuals.shape)
        # A sensor that was off before is off still, or has been put right meanwhile.
        off = np.fmin(np.abs(residuals), np.abs(residuals - self._usual))
        small = np.maximum(np.maximum(SMALL * sds, SHARE * np.abs(measured)), SPREAD * np.sqrt(self._square))[known]
        if np.any(off[known] > small):
            self._agreed_from = np.nan
        elif not np.isfinite(self._agreed_from):
            self._agreed_from = time
        elif time - self._agreed_from >= AGREED - ONE_STAMP:
            self.since = time

    def _keep(self, time: float, residuals: np.ndarray) -> None:
        """Follow the residuals (m,) that stand while inputs go as their sensors say."""
        if self._usual.shape != residuals.shape:
            self._usual, self._square = np.full(residuals.shape, np.nan), np.zeros(residuals.shape)
        passed = time - self._followed if np.isfinite(self._followed) else 0.0
        keep, before = np.exp(-passed / USUAL), np.where(np.isfinite(self._usual), self._usual, residuals)
        self._usual = np.where(np.isfinite(residuals), keep * before + (1.0 - keep) * residuals, self._usual)
        square = keep * self._square + (1.0 - keep) * (residuals - self._usual) ** 2
        self._square = np.where(np.isfinite(residuals), square, self._square)
        self._followed = time

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        usual = {"usual": self._usual.tolist(), "square": self._square.tolist(), "followed": self._followed}
        return {"since": self.since, "moved_at": self.moved_at, "agreed_from": self._agreed_from, **usual}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self.since, self.moved_at = float(memory["since"]), float(memory["moved_at"])
        self._agreed_from = float(memory["agreed_from"])
        self._usual = np.array(memory.get("usual", []), float)
        self._square = np.array(memory.get("square", []), float)
        self._followed = float(memory.get("followed", np.nan))
