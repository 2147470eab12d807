"""The step of a simulation that is stepped: an explicit one is compared with the critical step where that is due."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from tautline.integrators.explicit_step import ExplicitStep
from tautline.live.frame_clock import CLOSE
from tautline.live.memory import Memory
from tautline.run import Run


class CheckedStep:
    """The longest step from here on; of an explicit method it is looked at, chosen where it may be, and judged.

    Of any other method there is nothing to look at: the step stays that of the scene.

    Parameters
    ----------
    run : Run
        Its model, its state and its watch are taken as they are at each look: a force that is added changes them.
    tolerance : float
        Within which two times are one, s.

    Attributes
    ----------
    step : float
        Longest step from here on, s.
    """

    def __init__(self, run: Run, tolerance: float) -> None:
        self._run, self._tolerance = run, tolerance
        self.step, self._longest = run.model.solver.step, 0.0

    @property
    def explicit(self) -> ExplicitStep | None:
        """The step of an explicit method; None where it is not to be compared with the critical one."""
        return None if self._run.watch is None else self._run.watch.explicit

    def steps(self, span: float) -> int:
        """Number of equal steps that an advance, or a part of it, of ``span``, s, is divided into."""
        return max(1, math.ceil(span / self.step - CLOSE))

    def due(self, time: float, end: float) -> float:
        """Look at the steps from a time to an end, s, if that is due, and choose them where they are chosen.

        Returns when it is due again, s. A step that is given is the one that is taken: the scene's is divided further.
        """
        explicit = self.explicit
        if explicit is None:
            return math.inf
        ahead = self.step if self._chosen else (end - time) / self.steps(end - time)
        self._longest = explicit.follow(self._run.state, time, ahead, self._tolerance)
        if not self._chosen:
            return math.inf
        self.step = explicit.step
        return explicit.due

    @property
    def refused(self) -> tuple[str, str] | None:
        """Where a given step that is longer than the critical one is unstable, by what numbers; None for a good one."""
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
