"""The step of a simulation that is stepped: an explicit one is compared with the critical step where that is due."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from tautline.integrators.explicit_step import ExplicitStep
from tautline.live.errors import SimulationError
from tautline.live.frame_clock import CLOSE, FrameClock
from tautline.live.memory import Memory
from tautline.run import Run
from tautline.scene.values.printed import rounded


class CheckedStep:
    """The longest step from here on; of an explicit method it is looked at, chosen where it may be, and judged.

    Of any other method there is nothing to look at: the step stays that of the scene.

    Parameters
    ----------
    run : Run
        Its model, its state and its watch are taken as they are at each look: a force that is added changes them.
    frames : FrameClock
        What divides advances.

    Attributes
    ----------
    step : float
        Longest step from here on, s.
    """

    def __init__(self, run: Run, frames: FrameClock) -> None:
        self._run, self._frames = run, frames
        self.step, self._longest = run.model.solver.step, 0.0

    @property
    def explicit(self) -> ExplicitStep | None:
        """The step of an explicit method; None where it is not to be compared with the critical one."""
        return None if self._run.watch is None else self._run.watch.explicit

    def steps(self, begin: float, end: float) -> int:
        """Number of equal steps that an advance, or a part of it, from one time to another, s, is divided into."""
        step = min(self.step, self._frames.longest_step(begin, end))
        return max(1, math.ceil((end - begin) / step - CLOSE))

    def allow(self, begin: float, end: float) -> None:
        """Have an advance from one time to another, s, refused where any step of it is longer than the critical one.

        Nothing has run with these steps, and nothing will: what the state is and what is known of it stays.

        Raises
        ------
        SimulationError
            Of a step that is given; one that is chosen follows the critical one.
        """
        explicit = self.explicit
        if explicit is None or self._chosen:
            return
        step = max((b - a) / self.steps(a, b) for a, b in self._frames.parts(begin, end))
        if beyond := explicit.beyond_critical(self._run.state, begin, step):
            raise self._too_long(begin, end, step, *beyond)

    def due(self, time: float, end: float) -> float:
        """Look at the steps from a time to an end, s, if that is due, and choose them where they are chosen.

        Returns when it is due again, s. A step that is given is the one that is taken: the scene's is divided further.

        Raises
        ------
        SimulationError
            Where the critical step has fallen below a given one that is longer than those before it.
        """
        explicit = self.explicit
        if explicit is None:
            return math.inf
        ahead = self.step if self._chosen else (end - time) / self.steps(time, end)
        taken = explicit.taken
        self._longest = explicit.follow(self._run.state, time, ahead, self._frames.tolerance)
        if self._chosen:
            self.step = explicit.step
            return explicit.due
        if ahead > explicit.found >= taken:
            explicit.forget()
            raise self._too_long(time, end, ahead, explicit.found, explicit.worst)
        return math.inf

    def _too_long(self, begin: float, end: float, step: float, found: float, worst: int) -> SimulationError:
        """What refuses an advance for a step, s, that is longer than the critical one, by which unknown that is set."""
        name, method = self._run.model.system.names[worst], self._run.model.solver.method
        return SimulationError(
            f"cannot advance from {begin:.6g} s to {end:.6g} s: that is divided into steps of up to {step:.6g} s, and "
            f"the critical step of {method} is {found:.4g} s ({name})",
            f"advance by {rounded(found, 3, within=0.0):g} s at most, give a smaller solver.step, or take the method "
            "generalized-alpha",
        )

    @property
    def refused(self) -> tuple[str, str] | None:
        """Where given steps that were taken are unstable, by what numbers; None for good ones."""
        explicit = self.explicit
        if explicit is None or self._chosen or not self._longest > explicit.found:
            return None
        names = self._run.model.system.names
        return names[explicit.worst], f"step {self._longest:g} s, critical step {explicit.found:.4g} s"

    def judge(self, time: float, memory: Memory) -> None:
        """See whether the steps up to a time, s, were beyond the critical one, where nothing looks at them later."""
        if (explicit := self.explicit) is None:
            return
        # Forces that are evaluated leave their mark in the memory of groups: to look at a run must not change it.
        block = memory.read()
        explicit.judge(self._run.state, time)
        memory.write(block)
        self._run.model.system.functions.frames.time[0] = np.nan

    def doubt(self, time: float) -> None:
        """Take note that chosen steps up to a time, s, may have been too long: motion has grown."""
        if (explicit := self.explicit) is not None:
            explicit.doubt(time)

    def forget(self) -> None:
        """Have the step looked at anew: the state is another one."""
        if (explicit := self.explicit) is not None:
            explicit.forget()

    @property
    def warnings(self) -> list[str]:
        """What the reader of a result should know of steps that were beyond the critical one."""
        return [] if (explicit := self.explicit) is None else explicit.warnings

    def arrays(self) -> list[tuple[str, np.ndarray]]:
        """What a saved state holds of it, by name, beside `memory`."""
        return [] if (explicit := self.explicit) is None else [("modes", explicit.critical.modes)]

    def memory(self) -> tuple[float, ...]:
        """Numbers with which `recall` goes on with the same steps."""
        return () if (explicit := self.explicit) is None else explicit.memory()

    def recall(self, memory: Sequence[float]) -> None:
        """Go on from what `memory` gave; of anything else the step is looked at anew."""
        if (explicit := self.explicit) is None:
            return
        explicit.recall(memory)
        if self._chosen:
            self.step = explicit.step

    @property
    def _chosen(self) -> bool:
        return self._run.model.solver.automatic
