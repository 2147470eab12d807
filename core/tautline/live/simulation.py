"""A simulation that is stepped by whoever made it."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.application.installed import Installed
from tautline.integrators.corrector.newton import advice
from tautline.integrators.method import method_for
from tautline.integrators.state import FACTORISATIONS, ITERATIONS, STEPS, WORST
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.integrators.stops.emptied import status_of_failure
from tautline.integrators.time_loop import (
    PART,
    STEP,
    WORK_LIMIT,
    compile_for,
    frames_of,
    loop_of,
    new_frames,
    new_pause,
)
from tautline.interruption import Ear, listening
from tautline.kernels.bound import Bound
from tautline.kernels.dofs import expand_now
from tautline.live.arguments import displacement_of, names_of, span_of, values_of
from tautline.live.checked_step import CheckedStep
from tautline.live.equations import Equations
from tautline.live.errors import SimulationError, check_length, seconds, unknown
from tautline.live.forces import Force, Group, force_of, places_of
from tautline.live.frame_clock import FrameClock
from tautline.live.inputs import Inputs
from tautline.live.kept import Kept
from tautline.live.look import Look, Ties, book_change, disturb, look_at
from tautline.live.memory import Memory, Parts, State, check
from tautline.live.readings import Outputs, Parameters, handles_of
from tautline.live.turn import Turn
from tautline.results.assessment.balance import Balance
from tautline.results.assessment.start import Start
from tautline.results.result import Result
from tautline.results.resumption import FRAMES_TOLD, moved_by
from tautline.results.store import Store
from tautline.run import Run
from tautline.system.memory import arrays_of, recall, remember
from tautline.system.model import Model
from tautline.version import __version__

if TYPE_CHECKING:
    from tautline.live.plant import Plant

WALL, CPU = range(2)
BEGIN = 7
"""Place of the time of the last frame among the arguments of a loop."""
SHORTEST = 1e-9
"""Shortest advance, over the interval of frames: what is shorter is the rounding of a sum of times."""
LONG = 200_000
"""Steps, iterations and factorisations after which Ctrl-C is heard in the middle of an advance."""


class Simulation:
    """A scene that runs in the hands of whoever made it.

    Parameters
    ----------
    scene : path, YAML text, dict or scene
    inputs : sequence of str, optional
        Names of what is to be driven: ``["winch.pay_out", "vessel.heave"]``. What moves in the scene can be driven
        without being named here; what it holds still has to be named.
    keep : bool or float
        Frames that are kept for `result`: all, none, or those of the last so many seconds.
    parameters : mapping, optional
        Values of parameters by name, with which the start is found.
    initial : mapping, optional
        Values of inputs by name, at which they are held from the start on, until others are given. The start is found
        with them. A speed is there at once, as a constant speed of the scene's own is.

    Raises
    ------
    SceneError
        For bad input.
    UnknownName
        For an input that the scene cannot have, and for a name in `parameters` or `initial` that there is not.
    SimulationError
        For a value that a parameter or an input cannot have.
    ArgumentTypeError
        For `parameters` or `initial` that are no mapping.
    StoppedEarly
        Where no start is found.
    """

    def __init__(
        self,
        scene: Any,
        inputs: Sequence[str] | None = None,
        *,
        keep: bool | float = True,
        parameters: Mapping[str, Any] | None = None,
        initial: Mapping[str, Any] | None = None,
    ) -> None:
        from tautline import read

        self.scene = scene if hasattr(scene, "document") else read(scene)
        self._application = Installed().of(self.scene)
        self._named = names_of(inputs)
        self._keep = keep if isinstance(keep, bool) else span_of(keep)
        begin, held = values_of(parameters, "parameters"), values_of(initial, "initial")
        model = self._application.build(self._application.driven(self.scene, self._named))
        self._prepare(model)
        self.inputs.begin_all(held)
        if held and model.anew is not None:
            self._prepare(model.anew(model.system.functions))
            self.inputs.begin_all(held)
        for name, value in begin.items():
            self.parameters[name] = value
        self.parameters.check()
        self._start()

    def _prepare(self, model: Model) -> None:
        """Lay out all that the loop needs of a model."""
        self.model = model
        handles = handles_of(model)
        for name in self._named:
            if name not in handles.inputs and f"{name}[0]" not in handles.inputs:
                raise unknown("input", name, handles.inputs)
        run = self._run = Run(model)
        system, self._state = model.system, run.state
        self._frames = new_frames(1, system.q.size, model.own)
        self._forces: list[Force | Group] = []
        self._turn = Turn(self._forces)
        self._ends, self._steps, self._pause = np.zeros(1), np.zeros(1, np.int64), new_pause()
        self._time, self._stopped, self._status = 0.0, "", ""
        self._mark = (
            f"{model.attributes.get('application', '')} {model.attributes.get('model_hash', '')} {model.solver.method}"
        )
        self._frame_clock = FrameClock(model.solver)
        self._tolerance = self._frame_clock.tolerance
        self._checked = CheckedStep(run, self._frame_clock)
        self._clock = np.zeros(2)
        self.inputs = Inputs(handles.inputs, system.functions, lambda: self._time, self._turn)
        vectors = {"q": self._state.full_q, "v": self._state.full_v}
        self.outputs = Outputs(handles.outputs, self._observe, lambda: self._observed, vectors, self._turn)
        self.parameters = Parameters(handles.parameters, self._parameter_change, handles.lacking)
        self._prepared = handles.prepared
        self._begun = False
        self._changed: set[str] = set()
        self._given: set[str] = set()
        self._displaced: set[str] = set()
        self._ties = Ties()
        self._observed: Mapping[str, np.ndarray] | None = None
        span = math.inf if self._keep is True else float(self._keep)
        self._kept = Kept(self._frames.rows.shape[1], span, self._tolerance)

    def _start(self) -> None:
        """Compile what is missing, find the start, and keep the first frame."""
        run = self._run
        compile_for(run.method, self.model.system, run.state, at_rest=self.model.start == "static")
        run.start()
        self._bind()
        self._steps[0], self._ends[0] = 0, 0.0
        _, filled, _ = self._call(0.0)
        if not filled or not np.isfinite(self._frames.rows[0]).all():
            raise run.without_start()
        self._begun = True
        self._kept.begin(self._frames.rows[0])
        self._starts = {self._kept.mark: run.began}

    def _bind(self) -> None:
        """Bind the loop to its arguments, and list what a state is made of."""
        run, system = self._run, self.model.system
        loop, sums = loop_of(run.method)
        self._loop = Bound(
            loop, run.method, system.link(sums), system.dofs, system.functions, run.state, self._ends, self._steps,
            0.0, self._frames.rows, self._pause,
        )  # fmt: skip
        arrays = [
            *(pair for name, thing in self._memorable() for pair in arrays_of(thing, name)),
            *((f"input.{k}", array) for k, array in enumerate(self.inputs.arrays())),
            *((f"model.{name}", array) for name, array in self.model.memory.items()),
            ("frame", self._frames.rows), ("clock", self._clock),
            *self._checked.arrays(),
        ]  # fmt: skip
        told = str(self.model.attributes.get(FRAMES_TOLD, ""))
        self._memory = Memory(arrays, [force.name for force in self._forces], told)
        # Functions of the user's are called by steps alone: what looks at a state between two of them goes without.
        own = system.groups[: len(system.groups) - len(self._forces)]
        self._scene_alone = replace(system, groups=own, linked={}) if self._forces else system

    def _memorable(self) -> list[tuple[str, Any]]:
        return [("state", self._state), ("groups", self.model.system.groups), ("method", self._run.method)]

    # -- time ----------------------------------------------------------------------------------------------------------

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._time

    @property
    def wall_time(self) -> float:
        """What the compiled steps have taken, s."""
        return float(self._clock[WALL])

    @property
    def stopped(self) -> str:
        """Why the simulation cannot go on; empty where it can."""
        return self._stopped

    def advance(self, duration: float | str) -> None:
        """Go on by so many seconds, or a text with its unit (``"100 ms"``); as `advance_to`, whose errors it raises.

        SimulationError is raised, too, for a time that is not above zero.
        """
        if not (duration := seconds(duration)) > 0.0:
            raise SimulationError(f"cannot advance by {duration} s", "give a time above zero; restore() goes back")
        check_length(duration, max(SHORTEST * self.model.solver.interval, 8.0 * math.ulp(self._time)))
        self.parameters.check()
        with self._turn.change:
            self._advance_to(self._time + duration)

    def advance_to(self, time: float | str) -> None:
        """Go on to a time, in steps as the scene's solver takes them.

        Inputs that were given since the last advance are reached at its end. At the times of the scene's output a frame
        is kept for `result`.

        Parameters
        ----------
        time : float or str
            s, or a text with its unit: ``"2 min"``.

        Raises
        ------
        SimulationError
            For a time that is not ahead or beyond what is prepared, where the simulation has stopped before, where
            parameters cannot be beside one another, where steps of `rk4` would be longer than the critical one, where
            what is tied was displaced by itself, and where another thread advances it.
        StoppedEarly
            Where a step fails. Time and outputs are then those of the last step that did not, and frames are kept.
        Interrupted
            On Ctrl-C, after the step under way.
        """
        self.parameters.check()
        self.advance_heard(seconds(time), None)

    def advance_heard(self, time: float, ear: Ear | None) -> None:
        """Go on to a time, s, as `advance_to` does; on a thread that cannot hear Ctrl-C, with the ear of one that can.

        Parameters are taken as they are: whoever estimates them tries values on both sides of a bound.

        Raises
        ------
        SimulationError, StoppedEarly, Interrupted
            As `advance_to` does.
        """
        with self._turn.change:
            self._advance_to(time, ear)

    def _advance_to(self, time: float, ear: Ear | None = None) -> None:
        """Go on to a time, s; see `advance_to`. Whoever listens for Ctrl-C on behalf of several gives the ear."""
        begin = self._time
        if abs(time - begin) <= 4.0 * math.ulp(begin):
            raise SimulationError(f"cannot advance to {time:g} s: it is the time now", "give a later time")
        if not begin < time < math.inf:
            cause = f"cannot advance to {time:g} s from {begin:g} s"
            raise SimulationError(cause, "give a later time; restore() goes back")
        check_length(time - begin, SHORTEST * self.model.solver.interval)
        if self._stopped:
            cause = f"the simulation has stopped: {self._stopped}"
            raise SimulationError(cause, "restore a state that was saved before")
        self._ties.check(self.model.system)
        time = self._frame_clock.snapped(time)
        until, key = self.known_until
        if time > until + self._tolerance:
            cause = f"cannot advance to {time:g} s: {key} is known up to {until:g} s only"
            raise SimulationError(cause, "give the scene a later solver.end; a record has to last as long")
        self._checked.allow(begin, time)
        # Between two calls of the loop time, frames and inputs are brought in line: that is not to be left half done.
        with listening(patient=True) if ear is None else nullcontext(ear) as ear:
            self._turn.begin_advance()
            try:
                self.inputs.write(begin, time)
                self._observed = None
                while begin < time:
                    end = min(self._frame_clock.next, time)
                    if (due := self._due(end)) < end - self._tolerance:
                        end = due
                    self._go(begin, end, ear)
                    begin = end
            finally:
                self._turn.end_advance()
                self._observed = None  # a force may have read the outputs of the frame before
        if ear.heard:
            raise Interrupted(self._time, self._so_far("interrupted"))

    @property
    def known_until(self) -> tuple[float, str]:
        """Until when it is known what the scene moves by itself, s, infinite where without end; and the key of that."""
        ends = ((one.until, one.key) for one in self._prepared if not self.inputs.steers(one.function))
        return min(ends, default=(math.inf, ""))

    def _go(self, begin: float, end: float, ear: Ear) -> None:
        """Take the steps from one time to the next; raises Interrupted where Ctrl-C was heard meanwhile."""
        self._steps[0] = self._checked.steps(begin, end)
        self._ends[0] = end
        counters = self._state.counters
        try:
            while True:
                done = counters[STEPS] + counters[ITERATIONS] + counters[FACTORISATIONS]
                self._pause[WORK_LIMIT] = done + LONG
                status, filled, reached = self._call(begin)
                # What a force raised in the last of its calls comes too late for a step to fail by it.
                if status != 0 or any(force.failed is not None for force in self._forces):
                    self._stop(reached, Status(status))
                if ear.heard:
                    raise KeyboardInterrupt
                if filled:
                    break
        except KeyboardInterrupt:
            if self._stopped:  # a force raised it
                raise
            if self._loop.found[1]:
                self._arrive(end)
            else:
                self._stand_at(self._loop.found[2])
            raise Interrupted(self._time, self._so_far("interrupted")) from None
        self._arrive(end)

    def _arrive(self, end: float) -> None:
        """Stand at the end of an advance, or of a part of it, and keep the frame where it is one of the output."""
        # A force reads outputs while it advances: those of one frame, which is now another one.
        self._time, self._observed = end, None
        if end == self._frame_clock.next:
            self._kept.add(self._frames.rows[0])
            self._frame_clock.passed()

    def _call(self, begin: float) -> tuple[int, int, float]:
        """Run the compiled loop, and keep the time it took."""
        for force in self._forces:
            force.begin()
        self._loop.set_float(BEGIN, begin)
        before, used = clock.perf_counter(), clock.thread_time()
        found = self._loop()
        self._clock[WALL] += clock.perf_counter() - before
        self._clock[CPU] += clock.thread_time() - used
        return found

    def _due(self, end: float) -> float:
        """When an explicit step that is chosen is to be looked at again, s: now, where it is due."""
        due = self._checked.due(self._time, end)
        if refused := self._checked.refused:
            self._stopped, self._status = "the explicit method is unstable at this step", Status.UNSTABLE.word
            raise StoppedEarly(Status.UNSTABLE, self._time, *refused, self._so_far())
        return due

    def _judge_step(self) -> None:
        """See whether the explicit steps up to now were beyond the critical one, where nothing looks at them later."""
        # A function of the user's is called by steps alone: it may remember what it was asked. Before it has begun,
        # where parameters are given for the start, there were no steps.
        if self._begun and not self._forces:
            self._checked.judge(self._time, self._memory)

    def _stop(self, reached: float, status: Status) -> None:
        """Take notice of a step that failed; raises StoppedEarly, or what a force of the user's raised."""
        for force in self._forces:
            if force.failed is not None:
                error, force.failed = force.failed, None
                self._stopped, self._status = f"a force raised {type(error).__name__} at {reached:.6g} s", "stopped"
                self._stand_at(reached)
                raise error
        step = float((self._ends[0] - self._time) / self._steps[0])
        self._stand_at(reached)
        self._judge_step()
        if status in (Status.UNSTABLE, Status.NOT_FINITE):
            self._checked.doubt(reached)
        status = status_of_failure(self._run.method, self.model.system, self._state, status, reached, step)
        status, part, detail = self.model.end_of(self._state, status, int(self._state.counters[WORST]))
        blamed = next((force for force in self._forces if force.fault), None)
        if blamed is not None and status in (Status.NOT_FINITE, Status.NOT_CONVERGED, Status.SINGULAR):
            status, part, detail = Status.NO_FORCE, f"force {blamed.name}", blamed.fault
        stop = StoppedEarly(status, reached, part, detail or advice(self._run.method, status))
        if blamed is None:
            stop = self._run.blamed_for(stop)
        self._stopped, self._status = f"{stop.status.name} at {reached:.6g} s", stop.status.word
        stop.result = self._so_far()
        raise stop

    def _stand_at(self, time: float) -> None:
        """Make the outputs those of the state as it is, at a time that is no end of an advance."""
        self._pause[STEP] = self._pause[PART] = 0
        self._time = float(time)
        self._record_anew()

    def _record_anew(self) -> None:
        """Write the frame of the state as it is; accelerations are those of the last step.

        So are reactions where forces were added: steps alone ask for these.
        """
        before, row = self._frames.rows[0].copy(), self._frames.rows[0]
        look = self._look()
        row[:] = look.row
        # A force that raised, and is no number then, leaves its places without a reaction.
        size = self.model.system.q.size
        now, last = (frames_of(rows, size).residual[0] for rows in (row[None], before[None]))
        now[:] = self._state.residual if self._forces else look.residual
        np.copyto(now, last, where=~np.isfinite(now))
        if not np.isfinite(row).all():
            # What the inputs ask for from here on cannot be: the last frame is all that is known.
            row[:] = before
        self._observed = None

    def _look(self) -> Look:
        """The state as it is, without forces that were added."""
        width = self._frames.rows.shape[1]
        return look_at(self._run.method, self._scene_alone, self._state, self._time, width)

    @property
    def parts(self) -> Parts:
        """What it works with, for what stands beside it: a linearisation, a twin. To change it is to change the run."""
        return Parts(self._state, self._run.method, self._frames, self._memory, self._forces)

    @property
    def driven_scene(self) -> Any:
        """The scene that runs: with what is named free to be driven."""
        return self._application.driven(self.scene, self._named)

    # -- what there is to read -----------------------------------------------------------------------------------------

    def _observe(self) -> Mapping[str, np.ndarray]:
        if self._observed is None:
            self._observed = self.model.seen(self._frames)
        return self._observed

    @contextmanager
    def _parameter_change(self, name: str) -> Iterator[None]:
        """While a parameter changes; its name is kept, for what the result says of the scene and by the start."""
        with self._turn.change, self._parameter_changes():
            (self._changed if self._begun else self._given).add(name)
            yield

    @contextmanager
    def _parameter_changes(self) -> Iterator[None]:
        """While a parameter changes, or a blow falls: what the system has more of it then was put in from outside.

        The start is found with what was given before it: nothing is put in then.
        """
        counts = self._begun
        self._judge_step()
        before = self._look() if counts else None
        yield
        self._checked.forget()
        if before is not None:
            book_change(self._run.method, self._state, before, self._look())
            self._record_anew()
        self._observed = None

    def __repr__(self) -> str:
        if not getattr(self, "_begun", False):  # one whose start was not found
            return "Simulation(not begun)"
        title, kept = getattr(self.scene, "title", "") or "no title", self._kept.rows.shape[0]
        head = f"Simulation({title!r}, at {self._time:.6g} s, {kept} frame{'s' * (kept != 1)} kept"
        return f"{head}, stopped: {self._stopped})" if self._stopped else f"{head})"

    def __getitem__(self, name: str) -> Any:
        """An output by its name; raises UnknownName."""
        return self.outputs[name]

    def __contains__(self, name: object) -> bool:
        return name in self.outputs

    def __iter__(self) -> Iterator[str]:
        return iter(self.outputs)

    def _so_far(self, status: str = "") -> Result | None:
        """The result, where frames were kept."""
        return self._result(status) if self._kept.rows.size else None

    @property
    def result(self) -> Result:
        """The frames kept so far, as `tautline.simulate` gives them."""
        with self._turn.look:
            return self._result()

    def _result(self, status: str = "") -> Result:
        """The frames kept so far; with a status, where it is not that of the simulation."""
        run, rows = self._run, self._kept.rows
        if not rows.size:
            cure = "advance it to a frame: those that were kept are later than the state that was restored"
            raise SimulationError("no frame was kept", cure if self._keep else "make the simulation with keep=True")
        model = self.model
        about = {**model.attributes, "version": __version__, "start": run.began.attribute, **self._moved_by()}
        stored = Store(None, model.variables, model.coordinates, about)
        frames = frames_of(rows.copy(), model.system.q.size)
        found = {"time": frames.time.copy(), **model.observe(frames)}
        run.balance = Balance(float(model.system.scale.max(initial=0.0)), model.solver.step_error)
        run.book(frames, found)
        stored.append(found)
        if self._kept.start is not None and self._kept.start[0, 0] < rows[0, 0]:
            start = frames_of(self._kept.start.copy(), model.system.q.size)
            stored.start = {"time": start.time.copy(), **model.observe(start)}
        run.time = run.reached = self._time
        run.wall, run.cpu, run.remembered = float(self._clock[WALL]), float(self._clock[CPU]), self._time
        run.memory = remember(*(thing for _, thing in self._memorable()))
        status = status or self._status or run.end_status().word
        self._judge_step()
        run.missing_until = self._kept.joined
        made = run.finish(stored, status, {"end": self._time}, self._checked.warnings)
        assert made is not None
        return made

    def _moved_by(self) -> dict[str, Any]:
        """What has moved the scene beside itself, and until when frames are missing, as attributes of a result."""
        added = [force.name for force in self._forces]
        found = moved_by(self._given, self._changed, self.inputs.driven, added, self._displaced, self._kept.joined)
        return found | self._ties.attribute(self.model.system)

    # -- to and fro ----------------------------------------------------------------------------------------------------

    def save(self) -> State:
        """The simulation as it stands. It can be pickled, and restored in another process."""
        with self._turn.look:
            return State(
                self._time, self._mark, self._memory.layout, self._memory.read(), self._kept.count,
                tuple(sorted(self._changed)), tuple(sorted(self._given)), (self._stopped, self._status),
                self._checked.memory(), self._kept.mark, self._kept.last, tuple(sorted(self._displaced)),
                self._ties.memory(),
            )  # fmt: skip

    def restore(self, state: State) -> None:
        """Stand where a state was saved: everything goes on from there to the bit. Frames after it are dropped.

        So are those before it, where another run has made the state; a warning of the result says then from when on
        there are frames. That of the start stays where both began the same.

        Raises
        ------
        SimulationError
            For a state of another scene, or of a simulation with other inputs or forces, which are told by their names
            and their order; nothing is changed then.
        """
        check(state, self._mark, self._memory.layout, self._memory.size)
        with self._turn.change:
            self._restore(state)

    def _restore(self, state: State) -> None:
        self._memory.write(state.block)
        self._time, self._observed, self._begun = state.time, None, True
        self._ties.recall(state.ties)
        self._changed, self._given, self._displaced = set(state.changed), set(state.given), set(state.displaced)
        self._stopped, self._status = state.stopped
        self.model.system.functions.frames.time[0] = np.nan
        self.inputs.recalled()
        self.parameters.recalled()
        self._kept.go_back(state, self._frames.rows[0], self._tolerance)
        self._run.began = self._starts.get(state.start, Start()) if state.start else self._run.began
        self._frame_clock.stand_at(state.time)
        self._checked.recall(state.explicit)

    def displace(self, name: str, by: Sequence[float]) -> None:
        """Add to a position or a velocity of a thing, as a blow does: ``displace("payload.velocity", [0, 0, 0.1])``.

        What is prescribed or held in a direction stays as it is in that. What is tied to the thing goes along at once,
        such as the end of the rope at a load; by multipliers not: both are to be displaced. Outputs are then of the
        state as it is, forces with the accelerations of the last step.

        Raises
        ------
        UnknownName, SimulationError
            For what is no position or velocity of a thing, what is no vector of its size, what goes along with other
            things alone, such as the end of the rope at a load that turns, and where nothing would move.
        """
        dofs, outputs = self.model.system.dofs, self.outputs
        vector, places, unknowns, more = displacement_of(name, by, outputs.handles, outputs.handle(name), dofs)
        full, reduced = (getattr(self._state, prefix + vector) for prefix in ("full_", ""))
        with self._turn.change, self._parameter_changes():
            self._displaced.add(name)
            self._ties.displace(vector, places, unknowns, more, self.model.system, self._state.full_q)
            full[places] += more
            reduced[unknowns] += more
            expand_now(dofs, reduced, full)

    def copy(self) -> Simulation:
        """Another simulation that stands at the same place and goes on by itself."""
        with self._turn.look:
            return self._copy()

    def _copy(self) -> Simulation:
        other = Simulation.__new__(Simulation)
        other.scene, other._application = self.scene, self._application
        other._named, other._keep = self._named, self._keep
        other._prepare(self._application.build(self._application.driven(self.scene, self._named)))
        other._starts = dict(self._starts)
        other._bind()
        for force in self._forces:
            other._add(force.copy())
        other.restore(self.save())
        other._kept = self._kept.copy()
        return other

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Simulation:
        return self.copy()

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise SimulationError("a simulation cannot be pickled", "pickle `save()`, and restore it in another process")

    # -- for others --------------------------------------------------------------------------------------------------

    @property
    def equations(self) -> Equations:
        """The equations of motion, at the state as it is, for integrators of others; refused as an advance is."""
        other = self.copy()
        other._ties.check(other.model.system)
        return Equations(other.model, other._time, other._state, other._forces)

    def add_force(self, force: Any, on: str | Sequence[int] | None = None) -> None:
        """Add a force to the scene, from now on.

        Parameters
        ----------
        force : function or group
            A Python function of (t, q, v) that returns the force; a function compiled by numba of (t, q, v, force) that
            writes it; or a group of a registered kind.
        on : str or sequence of int, optional
            What it acts on: an output that is a position (``"payload.position"``), or numbers of full degrees of
            freedom; q, v and the force are vectors of these. By default of all of them; then the tangent of the steps
            has none of its derivatives, and a stiff force takes small steps. Nor has it those between places that are
            far apart in the scene. `linearise` and `equations` have all of them.

        Raises
        ------
        UnknownName, SimulationError
            For what is no force, and places that there are not.
        """
        places = None
        if isinstance(on, str):
            found = self.outputs.handle(on).places
            if found is None or found[0] != "q":
                raise SimulationError(f"{on} is not the position of a thing", "give one, such as payload.position")
            places = np.atleast_1d(found[1])
        elif on is not None:
            places = places_of(on)
        with self._turn.change:
            now = self._time, self._state.full_q, self._state.full_v
            self._add(force_of(force, places, self.model.system, now))

    def _add(self, force: Force | Group) -> None:
        """Take a further group into the system, with the state as it is."""
        self._judge_step()
        run, old = self._run, self._run.method
        system = replace(self.model.system, groups=(*self.model.system.groups, force.group), linked={})
        self.model = run.model = replace(self.model, system=system)
        method = method_for(system, self.model.solver)
        recall(remember((), (), old), (), (), method)
        run.method = method
        disturb(method)
        run.renew_watch()
        self._forces.append(force)
        compile_for(method, system, run.state)
        self._bind()

    def linearise(self, inputs: Sequence[str], outputs: Sequence[str]) -> Plant:
        """Linearise about the state as it is: ``x. = A x + B u``, ``y = C x + D u``.

        A is made of exact tangents, also where the state moves; contacts and friction hold as they do now. In C and D
        positions and velocities of points are exact. How the equations follow inputs and integrals, and all other
        outputs, are found by differences of fourth order: central ones, and one-sided ones where a central step would
        pass the least or the most that an input may be given. Where the slopes of both sides differ, as at the limit of
        a drive, the smaller one is taken.

        Parameters
        ----------
        inputs, outputs : sequence of str
            Names; of a vector all components are taken.

        Raises
        ------
        UnknownName
            For a name that there is not.
        SimulationError
            For an input or output that is given twice, for two inputs that drive the same, and where an output follows
            the rate of an input at once: then its speed has to be the input.
        """
        from tautline.live.plant import linearise

        with self._turn.look:
            return linearise(self, inputs, outputs)
