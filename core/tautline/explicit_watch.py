"""What a run with an explicit method does about its step: it is looked at, and what it made wrong is done again."""

from __future__ import annotations

import time
from typing import Any, NamedTuple, Protocol

import numpy as np

from tautline.integrators.explicit_step import ExplicitStep
from tautline.integrators.schedule import steps_to
from tautline.integrators.state import MOTION, THROUGHPUT, State
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.time_loop import PART, STEP, Frames, new_frames, record_now
from tautline.results.assessment.balance import STORED_SHARE, Balance
from tautline.results.resumption import ROUNDING
from tautline.scene.methods import explicit_like, method_of
from tautline.system.memory import copied, restore
from tautline.system.model import Model

TRIES = 8
"""Times that a part of a run is gone back over with a shorter step, where it is chosen, until it is unstable."""
UNACCOUNTED = 1.0e-4
"""Share of the energy that went through a run, created or lost without account between two looks, above which steps
were beyond the critical one in between. What grew then is damped by the method once they are shorter."""
HELPS, LOOKS_WITHOUT = 4.0, 20
"""Times, at least, by which half the step makes that share smaller where steps were too long, and looks that go without
it where it does not: friction that lets go within a step, and contacts that close, cost energy at any step.
"""


def explicit_step_of(model: Model) -> ExplicitStep:
    """The step that an explicit method takes for a model, of the scene's method or of one like it."""
    solver = model.solver
    method = method_of(explicit_like(solver.method))
    return ExplicitStep(model.system, method, solver.step, solver.interval, solver.automatic)


class Held(NamedTuple):
    """What a run can go back to: ``done`` frames were made, at ``time`` s, and there was so much energy, J.

    ``energy`` is what there is less the work done and with what was lost: it only grows numerically.
    """

    done: int
    time: float
    energy: float
    memory: dict[str, np.ndarray]


class UnderWay(Protocol):
    """What is asked of a run under way: its clock, its frames and their steps, and what it must remember.

    ``ends`` (m,) s and ``steps`` (m,) of all frames; ``done`` of them were made, ``ahead`` are not stored and
    ``waiting`` belong to a batch that was paused; ``pause`` is where.
    """

    model: Model
    method: Any
    state: State
    ends: np.ndarray
    steps: np.ndarray
    pause: np.ndarray
    done: int
    ahead: int
    waiting: int
    frames: Frames
    balance: Balance
    time: float
    reached: float
    remembered: float
    wall: float
    cpu: float
    memory: dict[str, np.ndarray]

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays of what has a memory, themselves."""

    def most_rows(self) -> int:
        """Frames that may be in memory at once."""

    def step_to(self, frame: int) -> float:
        """Length of the steps to a frame, s."""

    def longest_step(self) -> float:
        """Longest step to any of the frames that are not made, s."""


class ExplicitWatch:
    """The step of a run whose method is explicit, compared with the critical one as the run goes on.

    A step that is given ends the run where it is beyond the critical one. Where it is chosen, the run goes back to the
    last look with a shorter one: contacts may hide how motion grows by opening, and energy that grows for a while only
    may be too little to be seen in the balance of a whole run.
    """

    def __init__(self, run: UnderWay) -> None:
        self.run, self.chooses = run, run.model.solver.automatic
        self.explicit = explicit_step_of(run.model)
        self.held: Held | None = None
        self.tries, self.stopped = TRIES, (Status.DONE, 0.0)
        # Energy not accounted for at the last try of the frames since the last look; and looks that go without it.
        self.missing, self.without = 0.0, 0

    def begin(self) -> None:
        """Look at the step before the first frame.

        Raises
        ------
        StoppedEarly
            Where a step that is given is beyond the critical one, if only before the last frame: that may be the
            longest, and would end the run when its time is spent.
        """
        run = self.run
        step = float((run.ends[run.done] - run.time) / run.steps[run.done])
        self.explicit.begin(run.state, run.time, step)
        self._hold()
        longest = run.longest_step()
        if longest > self.explicit.found and not self.chooses:
            raise self._beyond(longest)

    def frames_until(self, first: int) -> int:
        """Frames, from one on, until the step is looked at again, or until the run ends."""
        held = self.held
        if held is None:
            self.begin()
            return self.frames_until(first)
        span = self.run.ends[first : held.done + max(1, self.run.most_rows() // 2)]
        due = self.explicit.due * (1.0 - ROUNDING)
        return max(1, min(span.size, int(np.searchsorted(span, due)) + 1))

    def holds(self) -> bool:
        """Whether what was run up to now may stay; the run has gone back where it may not.

        Raises
        ------
        StoppedEarly
            Where a step that is given is beyond the critical one, or no shorter one was short enough.
        """
        run = self.run
        if run.done < run.ends.size and self.frames_until(run.done - 1) > 1:
            return True
        before, used = time.perf_counter(), time.thread_time()
        step = run.step_to(run.done - 1)
        self.explicit.look(run.state, run.time, step)
        run.wall += time.perf_counter() - before
        run.cpu += time.thread_time() - used
        leapt = self._has_leapt()
        if self.explicit.share <= 1.0 and not leapt:
            self.tries, self.stopped, self.missing = TRIES, (Status.DONE, 0.0), 0.0
            self._hold()
            return True
        if not self._goes_back(min(self.explicit.step, 0.5 * step) if leapt else self.explicit.step):
            raise self._beyond(step)
        return False

    def _has_leapt(self) -> bool:
        """Whether energy was created or lost since the last look, as by steps that were too long for a while."""
        run, held = self.run, self.held
        if not self.chooses or held is None or self.without:
            self.without = max(0, self.without - 1)
            return False
        kinetic, strain, potential, _, lost = run.frames.energy[run.ahead - 1]
        ledger = run.state.ledger
        through = ledger[THROUGHPUT] + ledger[MOTION] + lost + run.balance.idle
        through += STORED_SHARE * (kinetic + abs(strain) + abs(potential))
        before, self.missing = self.missing, abs(self._energy() - held.energy) / through if through > 0.0 else 0.0
        if not self.missing > UNACCOUNTED:
            return False
        if before and self.missing > before / HELPS:
            self.without = LOOKS_WITHOUT
            return False
        return True

    def _energy(self) -> float:
        """Energy of the last frame less the work done and with what was lost, J."""
        run = self.run
        frames, last = run.frames, run.ahead - 1
        if last < 0:  # a run that is gone on with has no frame yet
            frames, last = new_frames(1, run.model.system.q.size, run.model.own), 0
            record_now(run.method, run.model.system, run.state, run.time, frames.rows[0])
        kinetic, strain, potential, work, lost = frames.energy[last]
        return float(kinetic + strain + potential - work + lost)

    def leave(self) -> None:
        """Have a run that is left before its end end with its last look: frames behind that may be done again."""
        if self.chooses and self.held is not None and (self.may_go_back() or self.run.waiting or self.run.pause[STEP]):
            self._restore(self.held)

    def tries_again(self, status: Status, time: float) -> bool:
        """Whether a run that was stopped at a time, s, has gone back to be done with half the step, which is chosen.

        Motion that grows numerically may end a run in any way: as rope that falls slack does. What stops the run for
        another reason stops it again when it is done with half the step, within two steps of before.
        """
        before, self.stopped = self.stopped, (status, time)
        if before[0] == status and abs(time - before[1]) <= 4.0 * self.explicit.step:
            return False
        return self._goes_back(0.5 * self.explicit.step)

    def may_go_back(self) -> bool:
        """Whether the run may go back over its last frames: they are not stored before they are known to hold."""
        return self.chooses and self.held is not None and self.held.done != self.run.done

    def _hold(self) -> None:
        """Take the state as one to go back to, and divide the next frames by the step that is chosen."""
        run, memory = self.run, {}
        if self.chooses:
            run.steps[run.done :] = steps_to(run.ends[run.done :], run.time, self.explicit.step)
            memory = copied(run.arrays())
        self.held = Held(run.done, run.time, self._energy(), memory)

    def _goes_back(self, step: float) -> bool:
        """Go back to the last look with a shorter step, s, where it is chosen and this was not tried too often."""
        run, held = self.run, self.held
        if held is None or not self.chooses or not self.tries:
            return False
        self.tries -= 1
        self._restore(held)
        self.explicit.shorten(held.time, step)
        run.steps[held.done :] = steps_to(run.ends[held.done :], held.time, step)
        return True

    def _restore(self, held: Held) -> None:
        run = self.run
        restore(held.memory, run.arrays())
        # What it holds is of a later time.
        run.model.system.functions.frames.time[0] = np.nan
        run.ahead -= run.done - held.done
        run.done, run.waiting = held.done, 0
        run.time = run.reached = run.remembered = held.time
        run.memory = held.memory
        run.pause[STEP] = run.pause[PART] = 0

    def _beyond(self, step: float) -> StoppedEarly:
        """What ends a run whose step, s, is beyond the critical one."""
        found = self.explicit
        detail = f"step {step:g} s, critical step {found.found:.4g} s"
        return StoppedEarly(Status.UNSTABLE, self.run.time, self.run.model.system.names[found.worst], detail)
