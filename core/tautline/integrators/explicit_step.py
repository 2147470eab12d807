"""The step of an explicit run beside the critical one, which is looked for again as the run goes on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.integrators.state import State
from tautline.integrators.vibration.critical_step import CriticalStep
from tautline.scene.methods import Method
from tautline.system.system import System

SAFE = 0.8
"""Share of the critical step that is taken where the step is chosen."""
LONGER = 1.25
"""Times, at most, that a chosen step gets longer at one look: what opened, as a contact, may close again."""
ALMOST = 0.95
"""Share of the critical step that the next look is to find, at most."""
STEADY = 0.005
"""Change of that share between two looks that is none."""
FEWEST_STEPS, MOST_STEPS, MOST_FAR = 100, 1000, 20_000
"""Steps between two looks at least, at most, and at most where the step is far from the critical one.

A look takes about a millisecond, which is hundreds of steps of a small scene. What falls and rises again between two
looks is not seen.
"""
FAR = 0.25
"""Share of the critical step below which a step is far from it."""
CLOSE = 0.5
"""Share of the critical step above which a run that cannot go back looks after the fewest steps."""
REMEMBERED = ("step", "due", "share", "worst", "taken", "_span", "_found", "_before", "_looked", "_begun", "beyond")
"""Numbers with which a look goes on where another one has ended."""


class ExplicitStep:
    """The longest step that an explicit run takes, and when it is looked at again.

    It is looked at after spans of simulated time, which follow from the motion alone: a run takes the same steps on
    every machine, however busy it is. A span is half as long as the last one where the step came near to the critical
    one, and twice as long where it stays far from it.

    Attributes
    ----------
    step : float
        Longest step from here on, s.
    due : float
        When it is to be looked at again, s.
    share : float
        Step taken up to the last look over the critical one that it found.
    critical : CriticalStep
        What looks for it.
    worst : int
        Unknown that has most of the mode that sets it.
    taken : float
        Of a run that cannot go back: the longest step since the last look, with those ahead, s.
    beyond : float
        Until when steps of a run that cannot go back may have been beyond the critical one, s; minus infinity.
    """

    def __init__(self, system: System, method: Method, step: float, interval: float, automatic: bool) -> None:
        self.critical = CriticalStep(system, method)
        self.step, self.due, self.share, self.worst = step, 0.0, 0.0, 0
        self._longest, self._interval, self._automatic = step, interval, automatic
        self.taken, self._span, self._found, self._before = 0.0, 0.0, 0.0, 0.0
        self._begun, self._looked, self.beyond = False, -np.inf, -np.inf

    @property
    def found(self) -> float:
        """Critical step of the last look, s."""
        return self._found

    def begin(self, state: State, time: float, taken: float) -> None:
        """Look at the step at the start of a run, or where the state was changed from outside.

        Unless the step is chosen, the one ``taken``, s, is judged: frames may divide it further than the scene says.
        """
        self._found, self.worst = self.critical.search(state, time)
        if self._automatic:
            self.step = taken = min(self._longest, SAFE * self._found)
        self.share = self._before = taken / self._found
        self._span, self._looked = 0.0, time
        self._go_on(time)

    def look(self, state: State, time: float, taken: float) -> None:
        """Look at the step that was taken up to now, s, and choose the next where it is to be chosen."""
        self._found, self.worst = self.critical.search(state, time)
        self.share = taken / self._found
        if self._automatic:
            self.step = min(self._longest, SAFE * self._found, LONGER * self.step)
        rise, ahead = max(0.0, self.share - self._before), (self.step if self._automatic else taken) / self._found
        if rise > STEADY and ahead + rise > ALMOST:
            self._span *= 0.5
        elif ahead + 2.0 * rise <= ALMOST or rise <= STEADY:
            self._span *= 2.0
        self._before, self._looked = ahead, time
        self._go_on(time)

    def beyond_critical(self, state: State, time: float, ahead: float) -> tuple[float, int] | None:
        """The critical step, s, and the unknown that sets it, where steps of ``ahead``, s, would be longer; else None.

        These are refused by who asks, and never taken. So what is known of the steps up to now stays as it is.
        """
        if not self._begun:
            self.begin(state, time, ahead)
            # Steps before the state was changed say nothing of those from here on.
            self._begun, self.taken = ahead <= self._found, 0.0
            return None if self._begun else (self._found, self.worst)
        if ahead <= self._found:
            return None
        found, worst = self.critical.search(state, time)
        # Steps that were beyond it have been taken: they are for `follow` to find.
        return None if ahead <= found or self.taken > found else (found, worst)

    def follow(self, state: State, time: float, ahead: float, tolerance: float) -> float:
        """Look at the step where it is due, of a run that cannot go back and takes steps of ``ahead``, s, from here on.

        Returns
        -------
        float
            The longest step that is to be compared with the critical one of the last look, s.
        """
        # Advances of different lengths are divided into different steps: the longest of them is judged.
        longest = max(self.taken, ahead) if self._begun and not self._automatic else ahead
        # Of steps that become longer the last look has said nothing, neither how far they are from the critical one nor
        # when to look again.
        judged = min(1.0, (1.0 + STEADY) * self._before) * self._found
        looks = not self._begun or time >= self.due - tolerance or (not self._automatic and ahead > judged)
        if not self._begun:
            self.begin(state, time, longest)
            self._begun = True
        elif looks:
            self.look(state, time, longest)
            if self.share > 1.0 and self._automatic:
                self.beyond = time
        before = 0.0 if looks else self.taken
        # Given steps beyond the critical one are refused by who asks, and never taken.
        self.taken = self.step if self._automatic else max(before, ahead) if ahead <= self._found else before
        if self._automatic and self._before > CLOSE:
            self.due = min(self.due, time + FEWEST_STEPS * self.step)
        return longest

    def judge(self, state: State, time: float) -> None:
        """See whether the steps since the last look were beyond the critical one; none is chosen by that.

        Of a run that cannot go back: where it ends, where its result is read, and before it is changed from outside.
        Of fewer than ``FEWEST_STEPS`` nothing is asked: a look costs as much as hundreds of steps.
        """
        if not self._begun or time < self._looked + FEWEST_STEPS * self.taken:
            return
        if self.taken > self.critical.search(state, time)[0]:
            self.beyond = time

    def doubt(self, time: float) -> None:
        """Take note that chosen steps up to a time, s, may have been too long: motion has grown."""
        if self._automatic:
            self.beyond = time

    def forget(self) -> None:
        """Have `follow` look at the step anew: the state is another one."""
        self._begun = False

    def memory(self) -> tuple[float, ...]:
        """What it needs, beside `critical.modes`, to go on with the same steps."""
        return tuple(float(getattr(self, name)) for name in REMEMBERED)

    def recall(self, memory: Sequence[float]) -> None:
        """Go on from what `memory` gave; of anything else the step is looked at anew."""
        self.forget()
        if len(memory) == len(REMEMBERED):
            for name, value in zip(REMEMBERED, memory, strict=True):
                setattr(self, name, float(value))
            self.worst, self._begun = int(self.worst), bool(self._begun)

    @property
    def warnings(self) -> list[str]:
        """What the reader of a result should know of steps that were beyond the critical one."""
        if not np.isfinite(self.beyond):
            return []
        which = "that was chosen" if self._automatic else "that was given"
        return [
            f"the step {which} may have been longer than the critical one up to t = {self.beyond:.6g} s. "
            "Outputs shortly before that may be wrong: give a shorter step (solver.step), or take the method "
            "generalized-alpha"
        ]

    def shorten(self, time: float, step: float) -> None:
        """Go on from an earlier time with a shorter step, s, and look at it sooner."""
        self.step, self._span = step, 0.5 * self._span
        self._before = SAFE
        self._go_on(time)

    def _go_on(self, time: float) -> None:
        # Advances and frames may divide a step that is given much further: steps are counted by those that are taken.
        step = self.step if self._automatic else self._before * self._found
        fewest = max(self._interval, FEWEST_STEPS * step)
        most = max(self._interval, (MOST_FAR if self._before < FAR else MOST_STEPS) * step)
        self._span = min(max(self._span, fewest), most)
        self.due = time + self._span
