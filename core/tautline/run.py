"""A run under way: from its start on, batch by batch of frames, to what is said of it at its end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tautline.explicit_watch import ExplicitWatch, explicit_step_of
from tautline.finer_frames import FinerFrames, on_demand
from tautline.integrators.corrector.newton import advice
from tautline.integrators.explicit_step import SAFE
from tautline.integrators.linearise import start_moving
from tautline.integrators.method import method_for
from tautline.integrators.period import STEPS_PER_PERIOD, lag_of_step
from tautline.integrators.schedule import frame_times, steps_to_frames
from tautline.integrators.state import (
    AT_START,
    FACTORISATIONS,
    HALVINGS,
    ITERATIONS,
    MOTION,
    ROWS,
    STEPS,
    THROUGHPUT,
    WORST,
    State,
    new_state,
    oscillation_frequency,
)
from tautline.integrators.statics.equilibrium import find_equilibrium, refuse_without_number
from tautline.integrators.statics.relaxation import relax, relax_to_stable
from tautline.integrators.statics.stability import Rest, count_negative, find_stable_equilibrium
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.stepping import stepping_with
from tautline.integrators.stops.emptied import status_of_failure
from tautline.integrators.stops.suspects import Instant, blamed_for, hook_of_energy
from tautline.integrators.time_loop import (
    PART,
    STEP,
    WORK_LIMIT,
    Frames,
    loop_of,
    new_frames,
    new_pause,
    run_steps,
)
from tautline.interruption import undisturbed
from tautline.results.assessment.balance import ENERGIES, Balance
from tautline.results.assessment.bounds import judge
from tautline.results.assessment.rounding import without_rounding
from tautline.results.assessment.start import Start, pivots, static_start
from tautline.results.brief_store import BriefStore
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.resumption import (
    MISSING_UNTIL,
    ROUNDING,
    frames_until,
    of_another_build,
    place_of,
    refuse_another,
    refuse_frames_without,
    restart_time,
    truncated_start_warning,
)
from tautline.results.store import FrameStore
from tautline.scene.methods import method_of
from tautline.system.memory import copied, places_of, recall, remember
from tautline.system.model import Model

BATCH = 0.25
"""Wall time, s, after which frames are stored, progress is shown and Ctrl-C is heard."""
TOO_FAST = ", or where what flows is too fast: faster than waves run along a rope, or than a hose bears"
"""A further cause of an unstable equilibrium, where anything flows."""
PATIENCE = 2.0
"""Times that long, by the work of steps so far, after which Ctrl-C is heard in the middle of a frame that takes more
work than those before."""
FIRST_WORK, MORE_WORK = 64, 8
"""Steps, iterations and factorisations of the first batch, and the most that one may do of the last."""
BATCH_NUMBERS, DIGESTED_NUMBERS = 4_000_000, 1_000_000
"""Numbers that a batch of frames may hold in memory; and where statistics are kept, for which it is copied."""
INTERRUPTED = "interrupted"
"""Status of a run that was left before its end by whoever started it."""
GAINED = 0.05
"""Share of the energy that went through a run above which energy created numerically makes its result wrong. What is
lost without account may be what the method is to damp, and is only warned of."""
POOR_BALANCE = 0.05
"""Error of the energy balance from which a run's accuracy is in doubt."""
HUGE_SHARE = 10.0
"""Share of the energy above which it is told as more than that: what went through may be as good as nothing."""
LATE = 0.5 * math.pi
"""Lag of a free oscillation at the end of a run, rad, that is warned of."""
LOOKS = 200
"""Times, about, that a run which is watched is looked at."""

Look = Callable[[State, float, Any], None]


@dataclass
class Brief:
    """How one of many runs is made, of which only some figures are wanted.

    Its result says nothing of the scene, holds no warnings, and cannot be gone on with. The length of batches goes from
    one run to the next, which is of the same kind: it need not be found anew.

    Attributes
    ----------
    names : frozenset of str
        Figures that are wanted; empty for all.
    begin : float
        Time, s, from which on frames count for figures and limits. The first frame tells what was at the start.
    batch, work : int
        Frames, and steps, iterations and factorisations, of the first batch.
    compiled : bool
        Whether one has come to its end: what others lack, if they differ, is compiled when it is met.
    turn : threading.Lock or None
        Held by whoever runs it, and free while it is in its compiled loop. Threads that did their Python side by side
        would take the interpreter from each other at every short kernel, and wait for it.
    """

    names: frozenset[str] = frozenset()
    begin: float = 0.0
    batch: int = 1
    work: int = FIRST_WORK
    compiled: bool = False
    turn: Any = None


class Run:
    """A run under way: the clock, the state, and what of it was stored."""

    def __init__(
        self, model: Model, look: Look | None = None, brief: Brief | None = None, finer: FinerFrames | None = None
    ) -> None:
        self.model, self.look, self.brief, self.finer = model, look, brief, finer
        self.method = method_for(model.system, model.solver)
        self.explicit = method_of(model.solver.method).explicit
        self.state = new_state(model.system)
        self.ends, self.steps = frame_times(model.solver.end, model.solver.interval, model.solver.step)
        self.step = float(self.ends[0] / self.steps[0])
        if finer is not None:
            self.ends, self.steps = finer.divide(self.ends, self.steps)
        self.time, self.wall, self.cpu, self.done, self.batch = 0.0, 0.0, 0.0, 0, 1
        self.reached, self.waiting, self.spent, self.began_at = 0.0, 0, 0.0, 0.0
        self.complete = False
        """Whether all frames are made, and hold."""
        self.pause, self.work, self.at_first, self.since = new_pause(), FIRST_WORK, 0, 0.0
        if brief is not None:
            self.batch, self.work = brief.batch, brief.work
        self.balance = Balance(float(model.system.scale.max(initial=0.0)), model.solver.step_error)
        self.no_energy = ""
        """What is said of energies that are no finite numbers."""
        self.memory: dict[str, np.ndarray] = {}
        self.places: tuple[Any, dict[str, np.ndarray]] = (None, {})
        self.remembered = 0.0
        self.began = Start()
        self.missing_until: float | None = None
        self.ahead, self.stored_at = 0, time.perf_counter()
        """Frames in the room before those of the batch, stored with what follows; and when frames were stored last."""
        self.frames = self._room(1 if brief is None else 1 + min(self.batch, self.ends.size))
        self.watch = ExplicitWatch(self) if self.explicit and model.solver.guarded else None

    def _room(self, rows: int) -> Frames:
        return new_frames(rows, self.model.system.q.size, self.model.own)

    def resume_from(self, earlier: Result) -> dict[str, np.ndarray]:
        """Go on from an earlier result; returns its frames.

        Raises
        ------
        ResultError
            Where the result is of another scene, method or build, holds no state, or nothing is left to run.
        """
        refuse_another(earlier, self.model.solver.method, self.model.attributes)
        if recall(earlier.restart, *self._parts()):
            raise of_another_build(earlier)
        names = tuple(variable.name for variable in self.model.variables)
        refuse_frames_without(earlier, names)
        # The state may stand between two frames: the clock is that of the state, or its own time would be shifted.
        self.time = self.reached = self.remembered = self.began_at = restart_time(earlier)
        frames = frames_until(earlier, self.time, names)
        self.missing_until = earlier.attributes.get(MISSING_UNTIL)
        self.began = Start.of_attribute(earlier.attributes.get("start"))
        self.wall = float(earlier.attributes.get("wall_time", 0.0))
        self.cpu = float(earlier.attributes.get("cpu_time", 0.0))
        later = self.ends > self.time * (1.0 + ROUNDING)
        if not later.any():
            cause = f"ends at {self.time:.6g} s: nothing is left to run of {self.model.solver.end:.6g} s"
            raise ResultError(place_of(earlier), cause, "give a later end of the run (solver.end)")
        self.ends = self.ends[later]
        self.steps = steps_to_frames(self.ends, self.time, self.model.solver.interval, self.model.solver.step)
        self.book(None, frames)
        self.memory = remember(*self._parts())
        return frames

    def _parts(self) -> tuple[Any, Any, Any]:
        """What has a memory: the state, the groups, and the method with its factors."""
        return self.state, self.model.system.groups, self.method

    def start(self) -> None:
        """Find the equilibrium the scene asks for, and set it moving."""
        try:
            self._start()
        except StoppedEarly as stop:
            raise self.blamed_for(stop) from None

    def _start(self) -> None:
        """The same; what stops it may have its cause in a force of others."""
        model = self.model
        if model.start == "static":
            self._start_at_rest()
        elif model.start == "relaxed":
            fresh = remember((), model.system.groups, ())
            self._relax()
            self.method = method_for(model.system, model.solver)
            if np.any(model.system.v):
                # The scene begins in motion: what stuck while it came to rest has let go.
                recall(fresh, (), model.system.groups, ())
        start_moving(self.model.system, self.state, self.step)

    def _start_at_rest(self) -> None:
        """Find an equilibrium, a stable one where there is a choice, and judge it."""
        model, system, drawn = self.model, self.model.system, self.state.q.copy()
        try:
            if model.settle is not None:
                found = model.settle(self.state) or Rest(count_negative(system, self.state))
            elif model.confined:
                find_equilibrium(system, self.state, model.step_limit)
                found = Rest(count_negative(system, self.state))
            else:
                found = find_stable_equilibrium(system, self.state, model.step_limit)
        except StoppedEarly as stop:
            self.state.q[:] = drawn
            refuse_without_number(system, self.state)
            detail = f"{stop.detail}; or take {self._other_start()}" if stop.detail else ""
            raise StoppedEarly(stop.status, stop.time, stop.part, detail) from None
        self._judge_start(found, drawn)

    def _relax(self) -> None:
        """Have the scene come to rest. Friction may hold what a frictionless wall or a straight hole would not."""
        model, step = self.model, self._stable_step()
        if model.confined:
            relax(model.system, self.state, self.method, step, model.own)
            return
        found = relax_to_stable(model.system, self.state, self.method, step, model.step_limit, model.own)
        negative = found.stability.negative
        stable = None if negative < 0 else negative == 0
        self.began = Start("relaxed", stable, pushed=found.pushes > 0, side=found.side, aside=model.aside)

    def _other_start(self) -> str:
        """The way to begin that needs no equilibrium."""
        return f"start: {self.model.other_start}"

    def _judge_start(self, found: Rest, drawn: np.ndarray) -> None:
        """Refuse an equilibrium that the least disturbance would leave, and keep how far it lies from the drawing."""
        names, negative, worst = self.model.system.names, found.negative, found.stability.worst
        if negative > 0 and not self.model.confined:
            dofs = self.model.system.dofs
            flows = bool(np.any(self.state.full_v[dofs.flowing]))
            detail = (
                f"the equilibrium that was found is unstable: the tangent has {pivots(negative)}, as where a rope "
                "without bending stiffness is pressed, a column carries more than Euler's load, or a load stands on "
                f"its head{TOO_FAST if flows else ''}; give positions closer to those at rest, "
                f"{'let it flow more slowly, ' if flows else ''}or take {self._other_start()}"
            )
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, names[worst], detail)
        at_rest = {} if self.model.at_rest is None else self.model.at_rest()
        self.began = replace(
            static_start(names, self.state.q - drawn, self.model.system.places, self.model.system.q, negative),
            pushed=found.pushes > 0,
            side=found.side,
            aside=self.model.aside,
            carried=self.model.carried,
            at_rest={name: np.asarray(values).tolist() for name, values in at_rest.items()},
        )

    def store_first(self, store: FrameStore) -> None:
        """Store the state of t = 0: a frame without steps, for which the loop is compiled if it never was before."""
        system = self.model.system
        none = np.zeros(1, np.int64)
        _, filled, _ = run_steps(self.method, system, self.state, np.zeros(1), none, 0.0, self.frames)
        if not filled or not np.isfinite(self.frames.rows[0]).all():
            raise self.without_start()
        self.ahead = 1
        self._remember()
        if self.look is not None:
            self.look(self.state, self.time, self.method)

    def without_start(self) -> StoppedEarly:
        """What stops a run whose first frame was not found, or holds what is no number."""
        stop, state = StoppedEarly(Status.NOT_FINITE, 0.0, "the state at the start"), self.state
        blamed = self.blamed_for(stop)
        cause = hook_of_energy(self.model.system, [Instant(0.0, state.full_q, state.full_v)])
        return StoppedEarly(Status.NO_FORCE, 0.0, stop.part, cause) if blamed is stop and cause else blamed

    def advance(self, store: FrameStore) -> None:
        """Run one batch of frames, or a part of a frame that takes long; the next is as long as fits into ``BATCH``.

        Ctrl-C waits for its end: what was computed counts, and is kept. One of many runs leaves it to who makes them.
        """
        with undisturbed() if self.brief is None else nullcontext():
            self._advance(store)
            self.complete = self.done == self.ends.size

    def _advance(self, store: FrameStore) -> None:
        under_way, first = self._under_way(), self.done + self.waiting
        most = self.most_rows()
        until = self.ends.size - first if self.watch is None else self.watch.frames_until(first)
        rows = 1 if under_way else min(self.batch, until, max(1, most - self.ahead))
        if self.frames.time.size < self.ahead + rows:
            held, self.frames = self.frames, self._room(max(self.ahead + rows, min(2 * self.ahead + rows, most)))
            self.frames.rows[: self.ahead] = held.rows[: self.ahead]
        system, some = self.model.system, slice(first, first + rows)
        before, used = time.perf_counter(), time.thread_time()
        if not under_way:
            self.at_first, self.since = self._work(), 0.0
        self.pause[WORK_LIMIT] = self._work() + self.work
        with self._turn_of_others():
            status, filled, reached = run_steps(
                self.method, system, self.state,
                self.ends[some], self.steps[some], self.time, self._from(self.ahead + self.waiting), self.pause,
            )  # fmt: skip
        spent = time.perf_counter() - before
        self.wall += spent
        self.cpu += time.thread_time() - used
        self.reached, self.waiting = reached, self.waiting + filled
        if filled:
            self.time = float(self.ends[first + filled - 1])
        self.since += spent
        self._allow(self._work() - self.at_first, self.since)
        self.spent += spent
        stopped = status != Status.DONE
        if stopped and self.watch is not None and self.watch.tries_again(Status(status), reached):
            return
        if self.waiting and (stopped or not self._under_way()):
            made = self._count_waiting()
            if not stopped:
                self._remember()
                if self.watch is not None and not self.watch.holds():
                    return
            if stopped or self._store_is_due():
                self._store(store)
            if self.look is not None:
                self.look(self.state, self.time, self.method)
            self._size_batch(made)
        if stopped:
            end = status_of_failure(self.method, system, self.state, Status(status), reached, self.step)
            end, part, detail = self.model.end_of(self.state, end, int(self.state.counters[WORST]))
            raise self.blamed_for(StoppedEarly(end, reached, part, detail or advice(self.method, end)))

    def blamed_for(self, stop: StoppedEarly) -> StoppedEarly:
        """What stopped the run, with the hook of others that is to blame for it where there is one."""
        return blamed_for(stop, self.model.system, self.state, loop_of(self.method)[1], self.step)

    def _count_waiting(self) -> int:
        """Have frames that wait for the one that is under way be done, to be stored next; returns how many."""
        made, self.waiting = self.waiting, 0
        self.done, self.ahead = self.done + made, self.ahead + made
        return made

    @contextmanager
    def _turn_of_others(self) -> Iterator[None]:
        """Let other threads do what is outside of compiled loops meanwhile, one at a time."""
        turn = None if self.brief is None else self.brief.turn
        if turn is None:
            yield
            return
        turn.release()
        try:
            yield
        finally:
            turn.acquire()

    def _under_way(self) -> bool:
        """Whether the state is in the middle of a frame: none can go on from there, and frames before it wait."""
        return bool(self.pause[STEP] or self.pause[PART])

    def _work(self) -> int:
        return int(self.state.counters[[STEPS, ITERATIONS, FACTORISATIONS]].sum())

    def _from(self, row: int) -> Frames:
        return Frames(*(array[row:] for array in self.frames))

    def _allow(self, work: int, spent: float) -> None:
        """Set the work that the next batch may do from that of the last one and its wall time, s.

        What is left of a batch that was paused counts with what came before: it alone may be next to nothing.
        """
        if work > 0:
            self.work = max(1, int(min(MORE_WORK * work, PATIENCE * BATCH * work / max(spent, 1e-9))))

    def step_to(self, frame: int) -> float:
        """Length of the steps from the frame before, or from where the run began, to a frame, s."""
        begin = self.ends[frame - 1] if frame else self.began_at
        return float((self.ends[frame] - begin) / self.steps[frame])

    def longest_step(self) -> float:
        """Longest step to any of the frames that are not made, s."""
        return float(np.max(np.diff(self.ends[self.done :], prepend=self.time) / self.steps[self.done :]))

    def most_rows(self) -> int:
        """Frames that may be in memory at once."""
        most = BATCH_NUMBERS if self.model.keep is None else DIGESTED_NUMBERS
        return max(1, most // (4 * self.model.system.q.size + self.model.own + 6))

    def _size_batch(self, rows: int) -> None:
        """Set the length of the next batch from the number of frames of the last one and the time that they took."""
        limit = self.most_rows()
        per_frame, self.spent = max(self.spent, 1e-9) / rows, 0.0
        if self.look is not None:
            limit = min(limit, -(-self.ends.size // LOOKS))
        self.batch = int(min(limit, max(1.0, min(4.0 * rows, BATCH / max(per_frame, 1e-9)))))

    def renew_watch(self) -> None:
        """Look at the step of a system that has changed, with what is known of its steps until now."""
        if self.watch is not None:
            beyond = self.watch.explicit.beyond
            self.watch = ExplicitWatch(self)
            self.watch.explicit.beyond = beyond

    def _stable_step(self) -> float:
        """The scene's step, or one that an explicit method can take where it is to be chosen."""
        if not (self.model.solver.automatic and self.explicit):
            return self.step
        return min(self.step, SAFE * explicit_step_of(self.model).critical.search(self.state, self.time)[0])

    def _store_is_due(self) -> bool:
        """Whether frames that wait are to be stored: the first batches are short, and to store them takes longer."""
        if self.watch is not None and self.watch.may_go_back():
            return False
        if self.brief is not None or self.done == self.ends.size:
            return True
        most = self.most_rows() if self.watch is None else self.most_rows() // 2
        return self.ahead >= most or time.perf_counter() - self.stored_at > BATCH

    def _remember(self) -> None:
        """Remember the state, which is that of a frame: a run that has stopped is gone on with from there."""
        if self.brief is not None:
            return
        self.memory, self.remembered = copied(self.arrays()), self.time

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays of what has a memory, themselves."""
        if self.places[0] is not self.method:
            self.places = self.method, places_of(*self._parts())
        return self.places[1]

    @undisturbed()
    def _store(self, store: FrameStore) -> None:
        """Store the frames that wait, all of them or none."""
        part = Frames(*(array[: self.ahead] for array in self.frames))
        stored: Mapping[str, np.ndarray]
        if isinstance(store, BriefStore) and self.model.on_demand is not None:
            # The store keeps the frames: the next batch gets a room of its own.
            self.frames = self._room(0)
            stored = on_demand(self.model, part)
        else:
            part = part if self.finer is None else self.finer.take(part)
            stored = {} if not part.time.size else {"time": part.time.copy(), **self.model.observe(part)}
        if stored:
            self.book(part, stored)
            store.append(stored, self.memory, {} if self.brief is not None else self.progress())
        self.ahead, self.stored_at = 0, time.perf_counter()

    def book(self, frames: Frames | None, stored: Mapping[str, np.ndarray]) -> None:
        """Take note of the energies of frames; of the first one that is no number, where it comes from.

        Of an earlier run there is what it stored, and no `frames`.
        """
        energies = np.column_stack([stored[name] for name in ENERGIES])
        if self.balance.finite and not np.isfinite(energies).all():
            first, column = np.argwhere(~np.isfinite(energies))[0]
            self.no_energy = f"{ENERGIES[column]} is no finite number from {float(stored['time'][first]):.6g} s on"
            if frames is not None:
                seen = slice(max(0, first - 1), first + 1)
                rows = zip(frames.time[seen], frames.q[seen], frames.v[seen], strict=True)
                cause = hook_of_energy(self.model.system, [Instant(float(t), q, v) for t, q, v in rows])
                self.no_energy += f": {cause}" if cause else ""
        self.balance.add(energies)

    def progress(self) -> dict[str, Any]:
        """What a run that is killed must leave beside its state, to be gone on with."""
        return {
            "method": self.model.solver.method, "restart_time": self.remembered, "wall_time": self.wall,
            "cpu_time": self.cpu, "start": self.began.attribute,
            "step": self.reached / max(1, self.state.counters[STEPS]) if self.model.solver.automatic else self.step,
            "steps_alike": not self.model.solver.automatic,
        }  # fmt: skip

    def finish(
        self, store: FrameStore, status: str, further: dict[str, Any] | None = None, warnings: Sequence[str] = ()
    ) -> Result | None:
        """Close the file with what is known at the end, further attributes and warnings; None if it holds nothing."""
        if status == INTERRUPTED:
            if self.watch is not None:
                self.watch.leave()
            self._count_waiting()
        if self.ahead and self.brief is None:
            self._store(store)
        result = store.result
        if result is None:
            return None
        if self.brief is not None and self.done == self.ends.size:
            self.brief.batch, self.brief.work, self.brief.compiled = self.batch, self.work, True
        counters, solver = self.state.counters, self.model.solver
        taken = self.reached / counters[STEPS] if counters[STEPS] else self.step
        counted = self._counted(result)
        headline = without_rounding(self._headline(counted), counted, taken)
        attributes: dict[str, Any] = {
            "status": status,
            "start": self.began.attribute,
            "method": solver.method,
            "step": taken if solver.automatic else self.step,
            **({"longest_step": self.step} if solver.automatic and solver.step_error > 0.0 else {}),
            "end": float(solver.end),
            "wall_time": self.wall,
            "cpu_time": self.cpu,
            "real_time_factor": self.wall / self.reached if self.reached > 0.0 else 0.0,
            "steps": int(counters[STEPS]),
            "newton_iterations": int(counters[ITERATIONS]),
            "equations_solved": int(counters[ROWS]),
            "factorisations": int(counters[FACTORISATIONS]),
            "halvings": int(counters[HALVINGS]),
            "restart_time": self.remembered,
            "energy_error": abs(self.energy_missing()),
            "numerical_dissipation": -self.balance.missing(int(counters[STEPS])),
            "motion_frequency": self.oscillation_frequency() / (2.0 * math.pi),
            "phase_lag": self.phase_lag(taken) if self._tells("phase_lag") else None,
            "warnings": self._all_warnings(result, taken, warnings) if self.brief is None else [],
            "headline": headline,
            "limits": self._limits(counted, headline),
            **(further or {}),
        }
        return store.finish(attributes, restart=self.memory)

    def _all_warnings(self, result: Result, step: float, further: Sequence[str]) -> list[str]:
        """Of the start, of the accuracy with a mean step, s, of what the application sees in the run, and further."""
        remarks = self.model.remarks(result) if self.model.remarks is not None else []
        steps = self.model.of_step(step) if self.model.of_step is not None else []
        late = [] if self.missing_until is None else [truncated_start_warning(self.missing_until)]
        return [*self.began.warnings, *self.warnings(step), *steps, *remarks, *further, *late]

    def _tells(self, name: str) -> bool:
        """Whether an attribute is wanted."""
        return self.brief is None or name in self.brief.names

    def _counted(self, result: Result) -> Result:
        """The frames that count, of a result that has all of them; statistics know theirs by themselves."""
        if self.brief is None or self.brief.begin <= 0.0 or self.model.keep is not None:
            return result
        return result.from_time(self.brief.begin)

    def _headline(self, result: Result) -> dict[str, dict[str, Any]]:
        """The application's figures, or those of them that are wanted."""
        if self.brief is not None and self.brief.names and self.model.figures is not None:
            judged = {bound.output for bound in self.model.bounds if not bound.of_frames}
            return self.model.figures(result, self.brief.names | judged)
        return self.model.headline(result)

    def _limits(self, result: Result, headline: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
        """Records of the application's limits, and then of those that the scene gives itself."""
        of_application = self.model.limits(result) if self.model.limits is not None else []
        tallies = getattr(result, "tallies", None)
        if tallies is not None:
            # Most frames are gone: the limits were looked at as these came.
            return [*of_application, *(tally.record(headline) for tally in tallies)]
        return [*of_application, *judge(self.model.bounds, result, headline)]

    def energy_gained(self) -> float:
        """Energy created numerically, over what went through the system; steady motion is left out of that.

        What the method had set aside at the start is no fault of the run: it is judged without.
        """
        ledger = self.state.ledger
        return self.balance.gained(float(ledger[THROUGHPUT]), self._set_aside(), float(ledger[MOTION]))

    def energy_missing(self) -> float:
        """The same with what the method had set aside at the start, as the energy that is told in J beside it."""
        ledger = self.state.ledger
        return self.balance.gained(float(ledger[THROUGHPUT]), motion=float(ledger[MOTION]))

    def energy_created(self) -> float:
        """What was gained with steady motion counted."""
        return self.balance.gained(float(self.state.ledger[THROUGHPUT]), self._set_aside())

    def _set_aside(self) -> float:
        """Energy that the method had set aside at the start, J."""
        return stepping_with(self.method).set_aside(self.method, self.step, float(self.state.ledger[AT_START]))

    def end_status(self) -> Status:
        """Status of a run that has come to its end, all of its frames stored.

        Ringing that the step cannot follow, as of a stiff hose that its flow has just begun to pull, may be all the
        motion there is, and wrong, while what the run is for is right. Against a steady flow it is warned of only.
        """
        if not self.balance.finite:
            return Status.NO_BALANCE
        return Status.IMBALANCE if self.energy_created() > GAINED else Status.DONE

    def oscillation_frequency(self) -> float:
        """Angular frequency of the motion as a whole, rad/s; zero where there is none beyond rounding."""
        return oscillation_frequency(self.state) if self.balance.moves(float(self.state.ledger[MOTION])) else 0.0

    def phase_lag(self, step: float) -> float:
        """By how much the method lets an oscillation as fast as the motion fall behind by the end, rad.

        An estimate for free vibration; what is driven keeps the phase of its drive.
        """
        omega = self.oscillation_frequency()
        return abs(lag_of_step(self.method, omega * step)) * self.time / step if step > 0.0 else 0.0

    def warnings(self, step: float) -> list[str]:
        """What a reader of the result should know of its accuracy; `step` is the mean one, s."""
        found = []
        gained, omega, lag = self.energy_gained(), self.oscillation_frequency(), self.phase_lag(step)
        if not self.balance.finite:
            found.append(f"the energy has no value, so that it is not known whether it balances: {self.no_energy}")
        if abs(gained) > POOR_BALANCE:
            share = (
                f"{100.0 * abs(gained):.2g} %" if abs(gained) < HUGE_SHARE else f"More than {100.0 * HUGE_SHARE:g} %"
            )
            found.append(f"{share} of the energy is unaccounted for: take a smaller step and compare")
        steps = 2.0 * math.pi / (omega * step) if omega * step > 0.0 else math.inf
        if steps < STEPS_PER_PERIOD:
            # A coarse mesh may make its own fastest motions grow, which no step mends.
            mesh = "element" in self.model.coordinates
            fine = ". Compare with more elements too: so fast a motion may be that of single elements" if mesh else ""
            found.append(
                f"the motion oscillates at about {omega / (2.0 * math.pi):.3g} Hz. A step of {step:.3g} s gives "
                f"{steps:.2g} steps per period, and {STEPS_PER_PERIOD:g} are needed to follow it: take a step of "
                f"{2.0 * math.pi / (STEPS_PER_PERIOD * omega):.2g} s and compare{fine}"
            )
        elif lag > LATE:
            found.append(
                f"the phase error of free vibration at {omega / (2.0 * math.pi):.3g} Hz has grown to about "
                f"{lag:.2g} rad at the end, by the period error of the method: take a step of "
                f"{step * math.sqrt(LATE / lag):.2g} s where phase matters"
            )
        return found
