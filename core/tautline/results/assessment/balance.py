"""The energy balance of a run: what went in, what was lost, and what nobody can account for."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tautline.results.assessment.rounding import unrounded

ENERGIES = ("kinetic_energy", "strain_energy", "potential_energy", "external_work", "dissipated_energy")
"""Variables that every application stores, J, in the order of a frame's energies."""
STORED_SHARE = 1.0e-6
"""Share of the energy there is that counts as going through the system."""
ROUNDING = 1.0e-14
"""Way, m, through which the largest force does work that is rounding."""

NOTHING = 1.0e-12
"""Share of the stored energy below which kinetic energy is rounding."""

SMALL = 1.0e-6
"""Share of what went through that is left of it at least, where nearly all of it was created numerically."""


class Balance:
    """Energies of the frames as they come.

    Parameters
    ----------
    force : float
        Largest force that counts, N.
    step_error : float
        Way, m, that a step may be wrong by; 0 where that is not bounded.
    """

    def __init__(self, force: float, step_error: float) -> None:
        self.idle = (ROUNDING + step_error) * force
        self._rows: list[np.ndarray] = []
        self._before: np.ndarray | None = None
        self._gained: tuple[Any, float] = None, 0.0
        self.finite = True
        """Whether all energies are finite numbers: of others no sum says whether they balance."""

    def add(self, energies: np.ndarray) -> None:
        """Take note of frames (m, 5), J, in the order of `ENERGIES`.

        Work and losses are summed from the start of the scene, of which the frame may not be kept: they are taken from
        the first frame that there is.
        """
        if self._before is None and len(energies):
            self._before = np.array([0.0, 0.0, 0.0, *energies[0, 3:]])
        self._rows.append(energies if self._before is None else energies - self._before)
        self._gained = None, 0.0
        self.finite = self.finite and bool(np.isfinite(energies).all())

    def missing(self, steps: int = 0) -> float:
        """Energy created numerically since the start, J; negative where it is lost without account.

        A method that damps what its step cannot follow loses energy so: its numerical dissipation. Of a run of so many
        `steps` it is 0 where it is no more than the rounding of as many sums of the energy that is stored. A loss that
        is given back, by a damper or friction that pushes the way it moves, is energy created numerically too.
        """
        if not self._rows:
            return 0.0
        if not self.finite:
            return math.nan
        first, last = self._rows[0][0], self._rows[-1][-1]
        stored = max(np.abs(first[:3]).max(), np.abs(last[:3]).max())
        lost = max(float(rows[:, 4].max()) for rows in self._rows)
        return unrounded(float(last[:3].sum() - first[:3].sum() - (last[3] - lost)), steps * float(stored))

    def moves(self, motion: float | None = None) -> bool:
        """Whether there is motion beyond rounding; `motion` J as `gained` takes it."""
        kinetic, strain, potential, _, _ = np.concatenate(self._rows).T if self._rows else np.zeros((5, 1))
        most = kinetic.max() if motion is None else motion
        return bool(most > self.idle + NOTHING * (strain.max() + np.abs(potential).max()))

    def gained(self, throughput: float, aside: float = 0.0, motion: float | None = None) -> float:
        """Energy created numerically over what went through the system; `throughput` J is the work without sign.

        It is NaN where an energy is no finite number.

        Of what was gained, `aside` J is what the method had set aside at the start.

        `motion` J is the largest kinetic energy without the steady motion: what flows through a hose, and what moves as
        it did at the start. Energy of that is not exchanged with anything. Without `motion` all kinetic energy counts.

        The most that was created at any frame counts, if that is more than what is lost without account at the end.
        What was created numerically is not counted among what went through, or it would be its own excuse.

        Energy that is merely there counts a little, or a string at rest would have its rounding divided by nothing; and
        the largest force through the way that is rounding, or that a step may be wrong by, does no work to speak of.
        """
        given = throughput, aside, motion
        if self._gained[0] != given:
            # A run is asked at its end both for its attributes and for whether it may be believed.
            self._gained = given, self._found(throughput, aside, motion)
        return self._gained[1]

    def _found(self, throughput: float, aside: float, motion: float | None) -> float:
        if not self._rows:
            return 0.0
        if not self.finite:
            return math.nan
        kinetic, strain, potential, work, lost = np.concatenate(self._rows).T
        lost = np.maximum.accumulate(lost)
        total = kinetic + strain + potential
        most = float((total - total[0] - (work - lost)).max())
        moved = kinetic.max() if motion is None else motion
        through = throughput + lost[-1] + moved + np.ptp(strain) + self.idle
        through += STORED_SHARE * float(max(0.0, kinetic.max() - moved) + strain.max() + np.abs(potential).max())
        if through <= 0.0:
            return 0.0
        missing = self.missing()
        if most < abs(missing):
            return missing / through
        return max(0.0, most - aside) / max(through - most, SMALL * through)
