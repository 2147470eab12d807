"""A twin: a simulation that sensors drive, and that finds what they do not measure."""

from __future__ import annotations

import time as clock
from bisect import bisect_right
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.integrators.status import StoppedEarly
from tautline.live.errors import UnknownName
from tautline.live.simulation import Simulation
from tautline.scene.errors import option_error
from tautline.scene.values.printed import quantity
from tautline.twin.alarms import Alarms, beyond, bound_said
from tautline.twin.family import Blow, Family, steps_to
from tautline.twin.forecast import Forecast, Found, other_speed
from tautline.twin.horizon import Horizon, Sample, mean_of
from tautline.twin.inputs import SLOW, InputTrack
from tautline.twin.map import Alarm, Plan, TwinMap, Unknown, driven_by, names_of, plan_of, read_map
from tautline.twin.operation import Operation
from tautline.twin.rows import Row, Rows
from tautline.twin.sensors import Health
from tautline.twin.waves import Waves

if TYPE_CHECKING:
    from tautline.live.memory import State

CHECKPOINT = 0.5
"""How often states are kept, to begin again from, s."""
CAUGHT_UP = 4
"""Rows of the window that are gone through anew at every sample, while it is linearised elsewhere."""
OBSERVED = 30
"""Rows that are observed at a time when a window is gone through anew."""
CAUGHT_UP_FROM_REST = 12
"""The same of a window that reaches back to where the machine was at rest."""
USUAL = 10.0
"""Usual size of a free motion, in blows."""
WORSE, NOISE = 1.5, 1.0
"""A window gone through anew is taken if what it leaves unexplained is at most so many times what was left before, and
so much more, in variances of the sensor."""
FAR_OFF = 0.25
"""Standard deviations of the start that an estimate has to be away from where it was linearised to begin from rest."""
WILD = 4.0
"""Size of derivatives over their usual one from which on a neighbour is begun anew."""
SLOPES = 200
"""Rows of which the usual size is the median."""
FEWEST = 5
"""Rows that are worth going through anew."""
APART = 0.1
"""How far neighbours are off, over the standard deviation at the start."""
SWINGING = 0.003
"""How far neighbours are off, over the parameter, where a load may bounce: further off they bounce out of step."""
LEAST_APART = 1e-4
"""And at least so much of the parameter."""
MOVED = 2.0
"""Standard deviations of the estimate from the linearisation that call for a new one."""
MOVED_FROM_START = 0.02
"""And standard deviations of the start."""
SETTLING = 1.0
"""Time after which samples count again when an input has been made up for, s."""
FRESH = 3.0
"""Forecasts that an answer of one holds good for."""
RESTRICT_EVERY = 2.0
"""How often the largest speed and heave are looked for, s."""
REPLAYED, PIECE, INTO = 18.0, 0.125, 6.0
"""How much of the ship's motion is gone through once more, larger or smaller, in what pieces, and how long it takes to
go over into it, s: so slowly that the load does not bounce by that."""
TOLD = {
    "TWO_BLOCKED": "two-blocking ahead", "RUN_OUT": "drum empty ahead", "DRUM_FULL": "drum full ahead",
    "OFF_WHEEL": "rope off its sheave ahead", "SLACK_ON_WHEEL": "slack rope on a sheave ahead",
}  # fmt: skip
"""Names of alarms where the simulation cannot go on."""


@dataclass
class Logged:
    """A row as it was given to the simulations, so that it can be gone through again."""

    time: float
    inputs: list[tuple[str, np.ndarray]]
    y: np.ndarray
    use: np.ndarray  # which of them can be believed, whatever the simulations do


@dataclass
class Checkpoint:
    """States of a family at a row."""

    time: float
    states: list[State]


class Twin:
    """A scene with a map, fed with rows of data.

    Parameters
    ----------
    scene : path, text, dict or scene
    map : path, text, dict or TwinMap
    live : bool
        Whether data arrive while they are measured.
    account : Path, optional
        File of what the application keeps over operations: the damage of a rope.

    Raises
    ------
    SceneError
        For a scene or a map that cannot be, with line, key and cure.
    StoppedEarly
        Where the scene has no start.
    """

    def __init__(self, scene: Any, map: Any, *, live: bool = False, account: Path | None = None) -> None:
        from tautline import read
        from tautline.application.installed import Installed

        self.scene = scene if hasattr(scene, "document") else read(scene)
        self.application = Installed().of(self.scene)
        self.map: TwinMap = map if isinstance(map, TwinMap) else read_map(map)
        own = getattr(self.application, "operation", None)
        self.operation: Operation | None = own(self.scene, account) if own else None
        if account is not None and self.operation is None:
            raise option_error("--account", str(account), f"{self.application.name} keeps none", "leave it out")
        # Rows are compared one by one, or as means.
        self._mean = self.operation.mean if self.operation is not None else 0.0
        self.plan = self._planned()
        self._make_simulations()
        plan = self.plan
        self.rows = Rows([one.column for one in plan.channels], plan.delay, live)
        self.health = [Health(one) for one in plan.channels]
        self.tracks = [InputTrack(one, i) for i, one in enumerate(plan.channels) if one.is_input]
        self.waves = {one.name: Waves() for one in plan.inputs if one.waves}
        free = [_as_unknown(one) for one in self.blows]
        self.horizon = Horizon([*plan.unknowns, *free], plan.measured, plan.window, len(free))
        self.horizon.theta0[self._offsets] = 0.0
        self.alarms = Alarms()
        self.log: deque[Logged] = deque()
        self.checkpoints: deque[Checkpoint] = deque()
        self.origin, self.now = np.nan, np.nan
        self.unsettled = -np.inf
        self.data_until = -np.inf
        self.restarts = 0
        self._zeros: dict[int, float] = {}
        self._job: Iterator[None] | None = None
        self._ahead: Iterator[None] | None = None
        self._found: Found | None = None
        self._next_forecast = self._next_restrict = -np.inf
        self._restricted: list[dict[str, Any]] = []
        self.notes: list[str] = []
        self._plain = self._from_rest = False
        self._paused = False
        self._pending: list[Sample] = []
        self._gathered: list[Sample] = []
        self._further: dict[str, dict[str, Any]] = {}
        self._slopes: list[deque[np.ndarray]] = []

    # -- what it is made of --------------------------------------------------------------------------------------------

    def _planned(self) -> Plan:
        """The map, checked against the scene."""
        signals = self.operation.signals if self.operation else {}
        further = self.operation.outputs if self.operation else {}
        try:
            first = Simulation(self.scene, driven_by(self.map), keep=False)
        except UnknownName:
            # Told by the line of the map, beside all else that is wrong with it.
            first = Simulation(self.scene, keep=False)
            plan_of(self.map, names_of(first), {}, signals, further)
            raise
        names = names_of(first)
        self.plan_names = names
        plan = plan_of(self.map, names, {name: first.parameters[name] for name in names.parameters}, signals, further)
        self._first = first
        if self.operation is not None:
            self.operation.built(first)
            if self.map.window is None and self.operation.window is not None:
                plan = plan.model_copy(update={"window": self.operation.window})
        self.units = names.outputs | dict(self.operation.outputs if self.operation else {})
        return plan

    def _make_simulations(self) -> None:
        """A family, a spare one, and one that runs ahead."""
        plan, inputs = self.plan, driven_by(self.map)
        self._parameters = [i for i, one in enumerate(plan.unknowns) if not one.is_offset]
        self._offsets = [i for i, one in enumerate(plan.unknowns) if one.is_offset]
        names = [plan.unknowns[i].target for i in self._parameters]
        start = np.array([plan.unknowns[i].start for i in self._parameters])
        apart = np.array(
            [self._apart(i, plan.unknowns[i].start, APART * plan.unknowns[i].sd) for i in self._parameters]
        )
        made = []
        for i in range(len(names) + 1):
            theta = start.copy()
            if i:
                theta[i - 1] += apart[i - 1]
            given = dict(zip(names, theta.tolist(), strict=True))
            made.append(Simulation(self.scene, inputs, keep=False, parameters=given) if names else self._first)
        free = getattr(self.application, "free_motions", None)
        self.blows = [Blow(*one) for one in free(self.scene)] if free and plan.measured and plan.unknowns else []
        made += [made[0].copy() for _ in self.blows]
        self.family = Family(made, names, self.blows)
        self.family.at, self.family.apart = start, np.append(apart, np.ones(len(self.blows)))
        self._seen = [*self._parameters, *range(len(plan.unknowns), len(plan.unknowns) + len(self.blows))]
        self.spare = Family([sim.copy() for sim in made] if len(made) > 1 else [], names, self.blows)
        bounds = [one for one in plan.alarms if not one.is_residual and one.ahead > 0.0]
        ahead = max([one.ahead for one in bounds], default=0.0) or plan.ahead
        self.forecast = Forecast(made[0].copy(), bounds, ahead) if ahead > 0.0 and inputs else None
        self._begin = self.family.save()
        self._begin_of = Family([], names, self.blows)
        self._begin_of.at, self._begin_of.apart = start.copy(), self.family.apart.copy()
        self.family.strike(0.0)
        self._input_start = {name: float(made[0].inputs[name]) for name in inputs}
        self._read = list(dict.fromkeys([
            *(one.name for one in plan.measured), *(name for name in plan.keep if name in self.plan_names.outputs),
            *(one.target for one in plan.alarms if not one.is_residual and one.target in self.plan_names.outputs),
            *(self.operation.reads if self.operation else ()),
        ]))  # fmt: skip

    def _apart(self, i: int, value: float, width: float) -> float:
        """How far a neighbour is off in its parameter, within the range."""
        one = self.plan.unknowns[i]
        apart = max(width, LEAST_APART * abs(value), 1e-9)
        if value + apart > one.high or not self._can_be(one.target, value + apart):
            return -apart
        return apart

    def _can_be(self, name: str, value: float) -> bool:
        parameter = self._first.parameters._parameter(name)
        return parameter.least < value <= parameter.most

    # -- data ----------------------------------------------------------------------------------------------------------

    def add(self, time: float, values: Mapping[str, float], arrived: float = 0.0) -> list[dict[str, Any]]:
        """Take a record of the source, and give the lines of all rows that it completes."""
        self.rows.add(time, values, arrived)
        return self.answers()

    def answers(self, end: bool = False) -> list[dict[str, Any]]:
        """Lines of all rows that are ready; with `end` of all rows that there are."""
        lines = []
        while (row := self.rows.ready(end)) is not None:
            if (line := self._answer(row)) is not None:
                lines.append(line)
        return lines

    def _answer(self, row: Row) -> dict[str, Any] | None:
        """Go on to a row, and say what is found."""
        if np.isfinite(self.now) and row.time <= self.now:
            return None
        values = self._checked(row)
        use = True
        if self.operation is not None:
            guided = self.operation.before(row.time, self._named(values))
            if guided.paused:
                return self._wait(row, values)
            if guided.scene is not None or self._paused:
                self._go_on(guided.scene)
            use = guided.use
        if self._from_rest:
            self.horizon.begin_again()
            self._rest()
        inputs = self._inputs(row)
        if not np.isfinite(self.origin) and not self._begin_at(row, inputs):
            return None
        try:
            self._advance(row.time, inputs)
        except StoppedEarly as error:
            self._restart(row, inputs, error)
        use = self._used(row, values) & use
        line = self._estimate(row, inputs, values, use)
        self.now = row.time
        self._look_ahead(row, inputs)
        return line

    def _checked(self, row: Row) -> np.ndarray:
        """Values in SI (c,), NaN where a sensor cannot be believed."""
        values = np.full(len(self.plan.channels), np.nan)
        for i, (channel, health) in enumerate(zip(self.plan.channels, self.health, strict=True)):
            reading = row.values[i]
            if channel.zero_first and i not in self._zeros and np.isfinite(reading):
                self._zeros[i] = float(reading)
            zero = self._zeros.get(i, 0.0) if channel.zero_first else channel.zero
            start = self._input_start.get(channel.name, 0.0) if channel.zero_first else 0.0
            values[i] = health.check(row.time, channel.scale * (reading - zero) + start)
        row.values = values
        if np.isfinite(values).any():
            self.data_until = row.time
        return values

    def _named(self, values: np.ndarray) -> dict[str, float]:
        return {one.name: float(v) for one, v in zip(self.plan.channels, values, strict=True)}

    def _in_si(self, row: Row, i: int) -> float:
        """A value of a row that is still to come, as `_checked` will have it."""
        if row.time <= self.rows.reached:
            return row.values[i]
        channel = self.plan.channels[i]
        zero = self._zeros.get(i, row.values[i]) if channel.zero_first else channel.zero
        start = self._input_start.get(channel.name, 0.0) if channel.zero_first else 0.0
        value = channel.scale * (row.values[i] - zero) + start
        health = self.health[i]
        repeated = health.fault in ("stuck", "clipped") and value == health._last
        return value if channel.low <= value <= channel.high and not repeated else np.nan

    def _inputs(self, row: Row) -> list[tuple[str, np.ndarray]]:
        """Inputs and their states (3,) at a row."""
        around = self.rows.around(row)
        reach = self.rows.patience
        if not np.isfinite(reach):
            reach = self.rows.interval if np.isfinite(self.rows.interval) else 1.0
        found = []
        for track in self.tracks:
            if not np.isfinite(track.state).all() and np.isfinite(self.origin):
                track.begin(self._input_start[track.channel.name], row.time)
            values = np.array([self._in_si(one, track.number) for one in around])
            if np.isfinite(self.origin):
                state = track.follow(around, values, row, reach)
            else:
                state = self._first_state(track, around, values, row, reach)
            found.append((track.channel.name, state))
            if track.channel.name in self.waves and not track.missing:
                self.waves[track.channel.name].add(row.time, state)
        return found

    def _first_state(
        self, track: InputTrack, around: Sequence[Row], values: np.ndarray, row: Row, reach: float
    ) -> np.ndarray:
        from tautline.twin.smoothing import smooth

        good = np.isfinite(values)
        times = np.array([one.time for one in around])
        if not good.any():
            return np.array([self._input_start[track.channel.name], 0.0, 0.0])
        return smooth(times[good], values[good], row.time, reach)

    # -- the simulations -----------------------------------------------------------------------------------------------

    def _begin_at(self, row: Row, inputs: list[tuple[str, np.ndarray]]) -> bool:
        """Bring the simulations to where the sensors begin."""
        run_in = 0.0
        for track, (name, state) in zip(self.tracks, inputs, strict=True):
            track.begin(self._input_start[name], row.time)
            if self.operation is not None and self.operation.anywhere and track.channel.zero_first:
                self._count_anew(track, state)
            run_in = max(run_in, track.joining_from_rest(state, self.plan.run_in))
        begin = self.family.time
        self.origin = row.time - begin - run_in
        for track, (_, state) in zip(self.tracks, inputs, strict=True):
            track.state, track.time = state, row.time
        if run_in > 0.0:
            # A quintic from rest, in one advance: the simulation takes its own steps on the way.
            self.family.advance(begin + run_in, inputs)
            self.unsettled = row.time + SETTLING
        self._keep(row.time)
        return True

    def _count_anew(self, track: InputTrack, state: np.ndarray) -> None:
        """Let a position count from where the machine begins anew: it takes up its speed on the way there.

        A block that has fetched a stand is elsewhere than it was. Where its motion is under way already, the simulation
        begins so much before that it reaches the speed by a steady acceleration.
        """
        small = abs(state[1]) < SLOW * track.fastest
        wanted = self._input_start[track.channel.name] + (0.0 if small else 0.5 * state[1] * self.plan.run_in)
        off = wanted - state[0]
        state[:] = wanted, 0.0 if small else state[1], 0.0
        i = track.number
        self._zeros[i] = self._zeros.get(i, 0.0) - off / track.channel.scale
        for row in self.rows.past:
            row.values[i] += off

    def _advance(self, time: float, inputs: list[tuple[str, np.ndarray]]) -> None:
        """Go on to a row; a long gap is gone through in pieces, with inputs that come to rest."""
        target = time - self.origin
        begin = self.family.time
        if target <= begin + 1e-12:
            return
        gap = target - begin > max(4.0 * (self.rows.interval if np.isfinite(self.rows.interval) else 1.0), 0.5)
        if gap and self.tracks:
            for at in steps_to(begin, target)[:-1]:
                # The track stands at the far side already: on the way the inputs hold what they had.
                self.family.advance(at, self._resting(at + self.origin))
        self.family.advance(target, inputs)
        if not self.checkpoints or time - self.checkpoints[-1].time >= CHECKPOINT - 1e-9:
            self._keep(time)

    def _resting(self, time: float) -> list[tuple[str, np.ndarray]]:
        """States of inputs on the way through a gap: what the last row had, coming to rest."""
        from tautline.twin.smoothing import coming_to_rest

        last = self.log[-1] if self.log else None
        if last is None:
            return []
        return [(name, coming_to_rest(state, time - last.time)) for name, state in last.inputs]

    def _keep(self, time: float) -> None:
        """Keep the states at a row, as long as a window can begin there."""
        self.checkpoints.append(Checkpoint(time, self.family.save()))
        self._forget(time)

    def _forget(self, time: float) -> None:
        """Drop what is older than a window that ends at a time."""
        oldest = time - self.plan.window
        while len(self.checkpoints) > 1 and self.checkpoints[1].time <= oldest:
            self.checkpoints.popleft()
        # Rows are kept longer than checkpoints: those of the spare family may lie further back.
        while self.log and self.log[0].time <= oldest - 4.0 * CHECKPOINT:
            self.log.popleft()

    # -- the machine apart from its scene ------------------------------------------------------------------------------

    def _wait(self, row: Row, values: np.ndarray) -> dict[str, Any]:
        """A row while the machine is apart from its scene, such as a string that hangs in slips; its line."""
        if not self._paused:
            self._paused = True
            self._take_in_mean()
        self._ahead = self._found = None
        self._relinearise()
        self._further = {}
        self.now = row.time
        self._judge_sensors(row.time)
        self._judge_operation(row.time)
        y = np.array([values[i] for i, one in enumerate(self.plan.channels) if one.is_output])
        return self._line(row, [], y, {}, np.full(len(y), np.nan))

    def _go_on(self, scene: Any) -> None:
        """Go on from rest after that, with the estimate as it is; a scene is what the machine has become meanwhile."""
        self._paused = False
        while self._job is not None:
            self._relinearise()
        if scene is not None:
            self._become(scene)
        self._rest()

    def _become(self, scene: Any) -> None:
        """Build the simulations of another scene, begun at the estimate."""
        self.scene, h = scene, self.horizon
        self._first = Simulation(scene, driven_by(self.map), keep=False)
        assert self.operation is not None
        self.operation.built(self._first)
        unknowns = [
            one.model_copy(update={"start": float(np.clip(h.mean[i], one.low, one.high))})
            for i, one in enumerate(self.plan.unknowns)
        ]
        self.plan = self.plan.model_copy(update={"unknowns": unknowns})
        self._make_simulations()

    def _restart(self, row: Row, inputs: list[tuple[str, np.ndarray]], error: StoppedEarly) -> None:
        """Begin again from rest, with the estimate as it is."""
        self.restarts += 1
        name = error.status.name
        text = f"the simulation stopped: {error}; it was begun again from rest"
        self.alarms.judge("simulation stopped", True, row.time, text)
        self.notes.append(text)
        self._rest()
        self._found = Found(row.time, stopped=(0.0, name))
        try:
            self._begin_at(row, inputs)
        except StoppedEarly as again:
            raise StoppedEarly(again.status, row.time, "the twin, begun again where the sensors are") from again
        self.unsettled = row.time + max(SETTLING, self.plan.window)

    def _rest(self) -> None:
        """Put the simulations back to rest, with the parameters of the estimate."""
        h = self.horizon
        at = np.clip(h.mean, h.low, h.high)[self._parameters]
        self.family.stand(
            self._begin, self._begin_of, np.append(at - self._begin_of.at, np.zeros(len(self.blows))),
            self._begin_of.apart[: len(at)], self._quarter, np.zeros(len(at), bool),
        )  # fmt: skip
        self._job = self._ahead = self._found = None
        self._pending, self._plain, self._from_rest = [], False, False
        self.log.clear()
        self.checkpoints.clear()
        h.drop_before(np.inf)
        h.theta0[self._parameters] = self.family.at
        self.origin = np.nan

    # -- the estimate --------------------------------------------------------------------------------------------------

    def _used(self, row: Row, values: np.ndarray) -> np.ndarray:
        """Which of the measured outputs count (m,)."""
        poor = any(track.missing or track.joining for track in self.tracks)
        if poor:
            self.unsettled = row.time + SETTLING
        settled = row.time >= self.unsettled
        use = [
            settled and np.isfinite(values[i]) and self.health[i].fault == ""
            for i, channel in enumerate(self.plan.channels) if channel.is_output
        ]  # fmt: skip
        return np.array(use, bool)

    def _estimate(
        self, row: Row, inputs: list[tuple[str, np.ndarray]], values: np.ndarray, use: np.ndarray
    ) -> dict[str, Any]:
        """Compare, estimate, watch; the line of a row."""
        plan = self.plan
        read = dict(zip(self._read, self.family.read(self._read), strict=True))
        y = np.array([values[i] for i, one in enumerate(plan.channels) if one.is_output])
        y0, J = self._compared(self.family, read)
        tells = self._alike(read)
        believed = self._compare_units(row.time, y, y0, J, use, tells) & self._tame(J)
        use = believed & tells
        sample = Sample(row.time, np.where(use, y, np.nan), y0, J, use)
        residual, residual_sd = self.horizon.expected(Sample(row.time, y, y0, J, np.isfinite(y)))
        self._take_in(sample)
        self.log.append(Logged(row.time, inputs, np.where(believed, y, np.nan), believed))
        self._relinearise()
        outputs = self._outputs(row, read, values)
        self._watch(row.time, outputs, values, residual, residual_sd, use)
        self._further = self._found_by_operation(row.time, y, outputs)
        return self._line(row, inputs, y, outputs, residual)

    def _take_in(self, sample: Sample) -> None:
        """Add a row to the window: by itself, or with others as their mean."""
        if not self._mean:
            self.horizon.add(sample)
            return
        if self._pending and not sample.use.any():
            self._take_in_mean()
        if sample.use.any():
            self._pending.append(sample)
            if sample.time - self._pending[0].time >= self._mean - 1e-9:
                self._take_in_mean()

    def _take_in_mean(self) -> None:
        if len(self._pending) >= FEWEST:
            self.horizon.add(mean_of(self._pending))
        self._pending = []

    def _means(self, samples: list[Sample]) -> list[Sample]:
        """Rows of a window as they are taken in."""
        if not self._mean:
            return samples
        found: list[Sample] = []
        begun: list[Sample] = []
        for one in samples:
            if one.use.any():
                begun.append(one)
            if begun and (not one.use.any() or one.time - begun[0].time >= self._mean - 1e-9):
                found += [mean_of(begun)] if len(begun) >= FEWEST else []
                begun = []
        # What is not whole yet goes on to be gathered.
        self._gathered = begun
        return found

    def _alike(self, read: Mapping[str, np.ndarray]) -> np.ndarray:
        """Of which sensors (m,) the differences of simulations are derivatives: all do what the machine does."""
        names = [one.name for one in self.plan.measured]
        return np.ones(len(names), bool) if self.operation is None else self.operation.counts(read, names)

    def _found_by_operation(self, time: float, y: np.ndarray, outputs: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        """Further estimates, such as the weight on the bit."""
        if self.operation is None:
            return {}
        sd = self.horizon.deviations(np.nan_to_num(y)) * np.sqrt(np.clip(self.horizon.spread, 1.0, 9.0))
        measured = {
            one.name: (float(y[m]) if self.health[i].fault == "" else np.nan, float(sd[m]))
            for m, (i, one) in enumerate((i, one) for i, one in enumerate(self.plan.channels) if one.is_output)
        }
        found = self.operation.found(time, measured, outputs, self.family.simulations[0])
        units = self.operation.outputs
        return {name: {"value": one[0], "sd": one[1], "unit": units[name]} for name, one in found.items()}

    def _compared(self, family: Family, read: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Computed values of the sensors (m,), and their derivatives (m, k)."""
        measured = self.plan.measured
        J = np.zeros((len(measured), len(self.horizon.unknowns)))
        if not measured:
            return np.zeros(0), J
        values = np.array([read[one.name] for one in measured]).reshape(len(measured), -1).T
        if self._seen:
            J[:, self._seen] = family.believed(family.derivatives(values))
        for k in self._offsets:
            J[[one.name == self.plan.unknowns[k].target for one in measured], k] = 1.0
        return values[0], J

    def _compare_units(
        self, time: float, y: np.ndarray, y0: np.ndarray, J: np.ndarray, use: np.ndarray, tells: np.ndarray
    ) -> np.ndarray:
        """Leave out what is in another unit, and follow what drifts, of sensors (m,) that tell something now."""
        if not len(y):
            return use
        told = y0 + J @ (self.horizon.mean - self.horizon.theta0)
        sd = self.horizon.deviations(y0)
        use = use.copy()
        numbers = [i for i, one in enumerate(self.plan.channels) if one.is_output]
        settled = self._converged
        for m, i in enumerate(numbers):
            spread = abs(J[m]) @ self.horizon.deviation if self.horizon.unknowns else 0.0
            if (use[m] or self.health[i].fault == "unit") and tells[m]:
                good = self.health[i].compare(time, y[m], told[m], sd[m] + spread, settled and use[m])
                use[m] = use[m] and (good or self._explained(told[m], y[m], J[m]))
        return use

    def _explained(self, told: float, y: float, J: np.ndarray) -> bool:
        """Whether the unknowns could explain a value within their ranges, before they are known."""
        if self._converged or not self.plan.unknowns:
            return False
        h = self.horizon
        low = np.where(J > 0, h.low, h.high) - h.mean
        high = np.where(J > 0, h.high, h.low) - h.mean
        with np.errstate(invalid="ignore"):
            least, most = np.nansum(J * low), np.nansum(J * high)
        return bool(told + least <= y <= told + most)

    @property
    def _converged(self) -> bool:
        """Whether the estimate is known much better than at the start."""
        h = self.horizon
        n = len(self.plan.unknowns)
        return n == 0 or bool(np.any(h.deviation[:n] < 0.1 * h.first_sd[:n]))

    def _relinearise(self) -> None:
        """Go through the window anew where the estimate has left where it was linearised, a few rows at a time."""
        if not self._seen:
            return
        if self._job is None and len(self.log) >= FEWEST and (self.blows or self._has_moved()):
            self._job = self._anew()
        if self._job is not None:
            try:
                for _ in range(CAUGHT_UP_FROM_REST if self._mean else CAUGHT_UP):
                    next(self._job)
            except StopIteration:
                self._job = None
            except StoppedEarly as error:
                self._job = None
                self.notes.append(f"the window could not be gone through anew: {error}")

    def _has_moved(self) -> bool:
        h, p = self.horizon, self._parameters
        moved = np.abs(h.mean - h.theta0)[p]
        return bool(np.any(moved > np.maximum(MOVED * h.linear_deviation[p], MOVED_FROM_START * h.first_sd[p])))

    def _anew(self) -> Iterator[None]:
        """The spare family goes through the window from a state that is extrapolated to the estimate."""
        h, p, spare = self.horizon, self._parameters, self.spare
        if self.blows:
            widths = [SWINGING * max(abs(h.mean[i]), h.first_sd[i]) for i in p]
        else:
            # What sticks and slips is not smooth in the small.
            widths = [APART * h.first_sd[i] for i in p]
        apart = np.array([self._apart(i, h.mean[i], width) for i, width in zip(p, widths, strict=True)])
        self._forget(self.log[-1].time)
        first = self.checkpoints[0]
        late = self._quarter if self.blows else 0.0
        shift, fresh = (h.mean - h.theta0)[self._seen], self._wild()
        spare.stand(first.states, self.family, shift, apart, late, fresh | self._plain, self._plain)
        kept = deque([Checkpoint(first.time, spare.save())])
        samples: list[Sample] = []
        rows: list[Logged] = []
        frames: list[np.ndarray] = []
        reached = first.time
        while True:
            k = bisect_right(self.log, reached + 1e-12, key=lambda one: one.time)
            if k == len(self.log):
                break
            row = self.log[k]
            spare.advance(row.time - self.origin, row.inputs)
            rows.append(row)
            frames.append(spare.frames())
            if row.time - kept[-1].time >= CHECKPOINT - 1e-9:
                kept.append(Checkpoint(row.time, spare.save()))
            reached = row.time
            if len(rows) == OBSERVED:
                samples += self._samples_of(rows, frames)
                rows, frames = [], []
            yield
        samples = self._means(samples + self._samples_of(rows, frames))
        theta0 = h.theta0.copy()
        theta0[p] = spare.at
        # Before the last blow the free motions cannot have any phase.
        begin = max(first.time + late + 1e-6, reached - h.window - 1e-9)
        samples = self._unmixed([one for one in samples if one.time >= begin])
        before = [one for one in h.samples if one.time >= begin]
        if not samples or not self._better(samples, theta0, before):
            # From so far away no state can be extrapolated, neither with the differences nor without: then from rest.
            self._from_rest = self._plain and bool(np.any(np.abs(h.mean - h.theta0)[p] > FAR_OFF * h.first_sd[p]))
            self._plain = not self._plain
            return
        self._plain = False
        h.drop_before(first.time)
        if spare.trust is not None:
            h.rough[:, p] = spare.rough
        self._pending = self._gathered
        h.replaced(samples, theta0)
        self.family, self.spare = spare, self.family
        self.checkpoints = kept

    def _samples_of(self, rows: Sequence[Logged], frames: Sequence[np.ndarray]) -> list[Sample]:
        """Samples of rows that the spare family has gone through, of the frames that it left there."""
        if not rows:
            return []
        names = [*(one.name for one in self.plan.measured), *(self.operation.reads if self.operation else ())]
        all_read = dict(zip(names, self.spare.read_frames(np.array(frames), names), strict=True))
        found = []
        for k, row in enumerate(rows):
            read = {name: values[k] for name, values in all_read.items()}
            y0, J = self._compared(self.spare, read)
            use = row.use & self._alike(read)
            found.append(Sample(row.time, np.where(use, row.y, np.nan), y0, J, use))
        return found

    @property
    def _quarter(self) -> float:
        """A quarter of the period of the free motion, in whole rows, s: of what its derivative shows."""
        row = self.rows.interval if np.isfinite(self.rows.interval) else 0.1
        samples = self.horizon.samples
        if not self.blows or len(samples) < FEWEST:
            return row
        J = np.array([one.J[:, len(self.plan.unknowns)] for one in samples])
        turns = np.count_nonzero(np.diff(np.sign(J), axis=0), axis=0).max(initial=0)
        span = samples[-1].time - samples[0].time
        return row * min(max(1, round(0.5 * span / (turns + 1) / row)), max(1, len(samples) // 4))

    def _better(self, samples: list[Sample], theta0: np.ndarray, before: list[Sample]) -> bool:
        """Whether the window gone through anew explains the data about as well as it was explained before, or better.

        What sticks and slips is not always put right by differences of states; then the first state itself is tried.
        """
        h = self.horizon
        if not np.isfinite([one.y0 for one in samples]).all() or not np.isfinite([one.J for one in samples]).all():
            return False
        old = h.cost(before, h.theta0, False) if before else np.inf
        return h.cost(samples, theta0, True) <= WORSE * old + NOISE

    def _unmixed(self, samples: list[Sample]) -> list[Sample]:
        """The same samples with derivatives that are free of free motion, and those that can be believed."""
        if samples and self.blows and self._parameters:
            J = np.array([one.J[:, self._seen] for one in samples])
            J = self.spare.unmix(J, self.horizon.deviations(samples[-1].y0))
            for one, own in zip(samples, J, strict=True):
                one.J[:, self._seen] = own
        return samples

    def _wild(self) -> np.ndarray:
        """Of which parameters (p,) the derivatives have grown far beyond what they were."""
        h, p = self.horizon, self._parameters
        if not len(h.samples) or not self.blows:
            return np.zeros(len(p), bool)
        J = np.array([one.J[:, p] for one in h.samples])
        usual = np.array([np.median(past, axis=0) for past in self._slopes]) if self._slopes else np.abs(J[0])
        return np.any(np.median(np.abs(J), axis=0) > WILD * usual, axis=0)

    def _tame(self, J: np.ndarray) -> np.ndarray:
        """Which sensors (m,) have derivatives that can be believed; near a slip they tell of a small range only."""
        p = self._parameters
        if not p or not self.blows:
            return np.ones(len(J), bool)
        size = np.abs(J[:, p])
        if not self._slopes:
            self._slopes = [deque(maxlen=SLOPES) for _ in range(len(J))]
        good = np.ones(len(J), bool)
        for m, past in enumerate(self._slopes):
            if len(past) >= FEWEST:
                good[m] = np.all(size[m] <= 2.0 * WILD * np.maximum(np.median(past, axis=0), 1e-12))
            if good[m]:
                past.append(size[m])
        return good

    # -- what comes out ------------------------------------------------------------------------------------------------

    def _outputs(self, row: Row, read: Mapping[str, np.ndarray], values: np.ndarray) -> dict[str, Any]:
        """Outputs at the estimate: name -> (value, standard deviation)."""
        h, p = self.horizon, self._seen
        shift = (h.mean - h.theta0)[p]
        spread = h.covariance[np.ix_(p, p)] if p else np.zeros((0, 0))
        found: dict[str, Any] = {}
        for name in self._read:
            J = self.family.derivatives(read[name])
            found[name] = (read[name][0] + J @ shift, np.sqrt(np.einsum("...i,ij,...j->...", J, spread, J)))
        return found

    def _watch(
        self, time: float, outputs: Mapping[str, Any], values: np.ndarray, residual: np.ndarray,
        residual_sd: np.ndarray, use: np.ndarray,
    ) -> None:  # fmt: skip
        """Judge all alarms."""
        measured = {one.name: values[i] for i, one in enumerate(self.plan.channels) if one.is_output}
        order = [one.name for one in self.plan.measured]
        for one in self.plan.alarms:
            if one.is_residual:
                m = order.index(one.target)
                self._judge_residual(one, time, residual[m], residual_sd[m], bool(use[m]), measured[one.target])
            else:
                self._judge_output(one, time, outputs.get(one.target), measured.get(one.target, np.nan))
        self._judge_sensors(time)
        self._judge_ahead(time)
        self._judge_operation(time)
        self.alarms.judge("simulation stopped", False, time, "")

    def _judge_residual(self, one: Alarm, time: float, r: float, sd: float, use: bool, measured: float) -> None:
        size = abs(r) / sd if one.times_sd else r
        known = np.isfinite(r) and use and (self._converged or not self.plan.unknowns)
        holds = bool(known and (size > one.above or (not one.times_sd and beyond(r, one.above, one.below))))
        text = (
            f"{one.target} is measured {said(measured, one.unit)}, expected {said(measured - r, one.unit)}"
            if known
            else ""
        )
        text += f" (standard deviation {said(sd, one.unit)}): friction, contact or rope path are not as in the scene"
        self.alarms.judge(one.name, holds, time, text, one.lasting)

    def _judge_output(self, one: Alarm, time: float, computed: Any, measured: float) -> None:
        # Before the estimate is known, what is computed is that of a guess.
        known = computed is not None and self._converged
        values = [("computed", extreme_of(computed[0], one) if known else np.nan), ("measured", measured)]
        now = [(word, v) for word, v in values if np.isfinite(v) and beyond(v, one.above, one.below)]
        text, holds = "", bool(now)
        if now:
            text = f"{one.target} {now[0][0]}: {bound_said(now[0][1], one.above, one.below, one.unit)}"
        elif known and self._found is not None and self._fresh(time) and one.name in self._found.first:
            after, value = self._found.first[one.name]
            left = max(0.0, self._found.begun + after - time)
            text = f"{one.target} in {left:.1f} s: {bound_said(value, one.above, one.below, one.unit)}"
            holds = True
        self.alarms.judge(one.name, holds, time, text, one.lasting)

    def _fresh(self, time: float) -> bool:
        assert self._found is not None
        return time - self._found.begun <= FRESH * self.plan.forecast_every

    def _judge_sensors(self, time: float) -> None:
        numbers = [i for i, one in enumerate(self.plan.channels) if one.is_output]
        for i, health in enumerate(self.health):
            column = health.channel.column
            for kind in ("lost", "stuck", "clipped", "out of range", "unit"):
                self.alarms.judge(f"{column} {kind}", health.fault == kind, time, health.text)
            if i in numbers:
                m = numbers.index(i)
                alike = float(self.horizon.correlation[m])
                off = said(health.mean * health.sd, health.channel.unit)
                text = f"{column} is off by {off} on average lately: the sensor, the weight or friction drifts"
                self.alarms.judge(f"{column} drifting", health.drifting(alike) and self._converged, time, text)

    def _judge_operation(self, time: float) -> None:
        """What the application warns of."""
        for name, holds, text, lasting in self.operation.alarms() if self.operation else ():
            self.alarms.judge(name, holds, time, text, lasting)

    def _judge_ahead(self, time: float) -> None:
        """Where the simulation ahead cannot go on, such as with two blocks together."""
        fresh = self._found is not None and self._fresh(time) and self._converged
        stopped = self._found.stopped if fresh and self._found is not None else None
        for status, name in TOLD.items():
            holds = stopped is not None and stopped[1] == status
            left = max(0.0, self._found.begun + stopped[0] - time) if holds and self._found and stopped else 0.0
            self.alarms.judge(name, holds, time, f"{name.removesuffix(' ahead')} in {left:.1f} s if all goes on as now")

    def _line(
        self, row: Row, inputs: list[tuple[str, np.ndarray]], y: np.ndarray, outputs: Mapping[str, Any],
        residual: np.ndarray,
    ) -> dict[str, Any]:  # fmt: skip
        plan, h = self.plan, self.horizon
        estimates = {
            one.name: {"value": float(h.mean[k]), "sd": float(h.deviation[k]), "unit": one.unit}
            for k, one in enumerate(plan.unknowns)
        } | self._further
        names = [one.name for one in plan.measured]
        shown = list(dict.fromkeys([*names, *plan.keep, *(one.target for one in plan.alarms)]))
        lag = clock.monotonic() - row.arrived if self.rows.live else max(0.0, self.rows._newest - row.time)
        return {
            "time": row.time,
            "inputs": {name: float(state[0]) for name, state in inputs},
            "measured": {name: number(v) for name, v in zip(names, y, strict=True)},
            "outputs": {name: number(outputs[name][0]) for name in shown if name in outputs},
            "deviations": {
                name: number(outputs[name][1]) for name in shown if outputs.get(name, (0, None))[1] is not None
            },
            "estimates": estimates,
            "residuals": {name: number(r) for name, r in zip(names, residual, strict=True)},
            "alarms": self.alarms.told(),
            "restrict": self._restricted,
            "not_observable": h.not_observable(),
            "lag": lag,
            "health": self.state_of_health,
            **(self.operation.told() if self.operation else {}),
        }

    @property
    def state_of_health(self) -> str:
        """Good, degraded or lost."""
        lost = [health.fault == "lost" for health in self.health]
        if all(lost) or any(track.missing and self.health[track.number].fault == "lost" for track in self.tracks):
            return "lost"
        poor = any(health.fault for health in self.health) or any(t.missing or t.joining for t in self.tracks)
        return "degraded" if poor or self.now < self.unsettled or not np.isfinite(self.now) else "good"

    # -- ahead ---------------------------------------------------------------------------------------------------------

    def _look_ahead(self, row: Row, inputs: list[tuple[str, np.ndarray]]) -> None:
        """Begin a run ahead where one is due."""
        if self.forecast is None or self._ahead is not None or row.time < self._next_forecast - 1e-9:
            return
        self._next_forecast = row.time + self.plan.forecast_every
        self._ahead = self._run_ahead(row.time, dict(inputs))

    def work(self, seconds: float | None = None) -> bool:
        """Look ahead for at most so many seconds, or to the end; whether something is left."""
        end = np.inf if seconds is None else clock.perf_counter() + seconds
        while self._ahead is not None and clock.perf_counter() < end:
            try:
                next(self._ahead)
            except StopIteration:
                self._ahead = None
        return self._ahead is not None

    def _state_at_estimate(self) -> tuple[Any, dict[str, float]]:
        """The state and the parameters of the estimate."""
        states = self.family.save()
        if not self._seen:
            return states[0], {}
        at = self.horizon.mean[self._parameters]
        weights = (self.horizon.mean - self.horizon.theta0)[self._seen] / self.family.apart
        memory = self.family.simulations[0]._memory
        from dataclasses import replace

        block = memory.combine(states[0].block, [s.block for s in states[1:]], weights)
        return replace(states[0], block=block), dict(zip(self.family.names, at.tolist(), strict=True))

    def _paths(self, inputs: Mapping[str, np.ndarray], winch: float | None = None) -> dict[str, Any]:
        """Paths of all inputs ahead, with another speed of winches where one is given."""
        assert self.forecast is not None
        times = self.forecast.times
        paths = {}
        for name, state in inputs.items():
            if name in self.waves:
                paths[name] = self.waves[name].ahead(times)
            elif winch is not None and name.endswith(".pay_out"):
                paths[name] = other_speed(state, times, winch)
            else:
                paths[name] = other_speed(state, times, state[1])
        return paths

    def _replayed(self, inputs: Mapping[str, np.ndarray], times: np.ndarray, factor: float) -> dict[str, Any]:
        """The same with the ship's motion of the last seconds once more, so many times as large."""
        return {
            name: self.waves[name].replayed(times, REPLAYED, factor, INTO)
            if name in self.waves
            else other_speed(state, times, state[1])
            for name, state in inputs.items()
        }

    def _run_ahead(self, time: float, inputs: dict[str, np.ndarray]) -> Iterator[None]:
        assert self.forecast is not None
        state, parameters = self._state_at_estimate()
        yield from self.forecast.run(time, state, parameters, self._paths(inputs))
        self._found = self.forecast.found
        if self.forecast.bounds and self.plan.restrict and time >= self._next_restrict - 1e-9:
            self._next_restrict = time + RESTRICT_EVERY
            yield from self._find_restrictions(time, state, parameters, inputs)

    def _find_restrictions(
        self, time: float, state: Any, parameters: dict[str, float], inputs: dict[str, np.ndarray]
    ) -> Iterator[None]:
        """The largest hoisting speed and the largest heave with which no bound that is watched ahead is passed."""
        assert self.forecast is not None
        found = []
        winch = next((name for name in inputs if name.endswith(".pay_out")), None)
        if winch is not None:
            now = abs(float(inputs[winch][1]))
            unit_speed = max(now, 0.25)
            yield from self.forecast.largest(
                time, state, parameters, lambda f: self._paths(inputs, -f * unit_speed), self.forecast.bounds
            )
            found.append(self._restriction("hoisting speed", self.forecast.factor * unit_speed, now, "m/s"))
        moved = [self.waves[name] for name in inputs if name in self.waves]
        if moved and all(one.lasting(REPLAYED) for one in moved):
            times = np.arange(PIECE, REPLAYED + 1e-9, PIECE)
            yield from self.forecast.largest(
                time, state, parameters, lambda f: self._replayed(inputs, times, f), self.forecast.bounds, times, INTO
            )
            found.append(self._restriction("ship motion", self.forecast.factor, 1.0, ""))
        self._restricted = [one for one in found if one]

    def _restriction(self, name: str, most: float, now: float, unit: str) -> dict[str, Any]:
        assert self.forecast is not None
        passed = most < now - 1e-9
        free = not self.forecast.limited_by
        by = f", then {self.forecast.limited_by}" if not free else ""
        at_least = "at least " if free else ""
        most_said = f"{most:.3g} {unit}".strip() if unit else f"{most:.2g} times the present"
        text = f"{name} at most {at_least}{most_said}{by}"
        return {
            "name": name,
            "largest": most,
            "now": now,
            "unit": unit,
            "restrict": passed,
            "by": self.forecast.limited_by,
            "text": text,
        }

    # -- at the end ----------------------------------------------------------------------------------------------------

    def finish(self) -> list[dict[str, Any]]:
        """Lines of the rows that are left when the data have ended."""
        return self.answers(end=True)


def _as_unknown(blow: Blow) -> Unknown:
    """A free motion, in blows of the usual size."""
    name = f"free motion of {blow.output}"
    return Unknown(
        name=name,
        target=blow.output,
        is_offset=False,
        unit="",
        start=0.0,
        sd=USUAL,
        low=-np.inf,
        high=np.inf,
        drift=0.0,
    )


def extreme_of(value: Any, bound: Alarm) -> float:
    """Of an output the number that a bound is about."""
    return float(np.max(value) if np.isfinite(bound.above) else np.min(value))


def number(value: Any) -> Any:
    """A float, a list of floats, or None where there is none: JSON knows no NaN."""
    array = np.asarray(value, float)
    if array.ndim == 0:
        return float(array) if np.isfinite(array) else None
    return [number(x) for x in array]


def said(value: float, unit: str) -> str:
    """A quantity in words."""
    return quantity(float(value), unit)
