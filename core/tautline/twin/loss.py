"""What is known while no simulation goes on where the sensors are: why, when that is tried again, and when it ends."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.errors import TautlineError
from tautline.integrators.status import StoppedEarly
from tautline.twin.forecast import Found

PAUSE = 5.0
"""Time between two tries to begin a simulation that has stopped, s: a try may take as long as many rows."""


class SceneEnded(TautlineError):
    """A row later than what the scene moves by itself; ``time`` is its stamp, s."""

    def __init__(self, time: float, until: float, key: str) -> None:
        self.time = time
        cause = f"the scene moves `{key}` by itself, and it is known up to {until:g} s only"
        super().__init__(f"{cause}; give it a sensor, or the scene a later solver.end")


class Loss:
    """That no simulation goes on.

    Attributes
    ----------
    text : str
        What is told of it; empty where a simulation goes on.
    next_try : float
        Time from which on a simulation that has stopped may be begun again, s.
    begun : bool
        Whether a simulation has ever gone on.
    """

    def __init__(self) -> None:
        self.text, self.next_try = "", -np.inf
        self._status = self._told = self._where = self._cure = ""
        self.begun = False

    def waits(self, time: float) -> bool:
        """Whether it is too early to try again."""
        return time < self.next_try

    def put_off(self, time: float) -> None:
        """Let the next try be a pause later."""
        self.next_try = time + PAUSE

    @property
    def of_all(self) -> str:
        """Why nothing was ever simulated; empty where something was, or nothing has stopped."""
        return "" if self.begun or not self.text else f"{self._where}{self._cure}"

    def lose(self, error: StoppedEarly, of_machine: bool, columns: Sequence[str] = ()) -> None:
        """Take notice of what stopped the simulation: where the sensors are, or on a way that was made up.

        Parameters
        ----------
        columns : sequence of str
            Which say where the machine stands. As long as nothing was simulated they are the first to be doubted.
        """
        self._status = error.status.name if of_machine else ""
        where = "the simulation stopped where the sensors are" if of_machine else "the simulation stopped again"
        self._where = f"{where} ({why(error)})"
        self._cure = f". Check zero, sign and unit of {' and '.join(columns)}" if columns and not self.begun else ""
        self.text = (
            f"{self._where}. Nothing is computed or foreseen. Estimates are kept, and what is measured is watched. "
            f"Every {PAUSE:g} s the twin tries to begin the simulation again{self._cure}"
        )

    def news(self) -> list[str]:
        """What is to be told of it: nothing where the same was told already, as it may last for a night."""
        if self.text == self._told:
            return []
        self._told = self.text
        return [self.text]

    def end(self) -> None:
        """Take notice that a simulation goes on."""
        self.text = self._status = self._told = ""
        self.begun = True

    def ahead(self, time: float) -> Found | None:
        """What a run ahead would come to at a time: the stop, where it is one of the machine."""
        return Found(time, stopped=(0.0, self._status)) if self._status else None


def why(error: StoppedEarly) -> str:
    """Where a simulation stopped, and what it means, without its own clock and without what to do."""
    return f"{error.part}: {error.sentence.partition('. ')[0]}"
