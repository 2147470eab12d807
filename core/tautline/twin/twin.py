"""A twin: a simulation that sensors drive, and that finds what they do not measure.

It leads the parts that know more: the readings of the sensors, the estimate with its simulations, the watch over
alarms, the outlook, and what the application knows of the work.
"""

from __future__ import annotations

import secrets
import time as clock
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tautline.integrators.status import StoppedEarly
from tautline.live.simulation import Simulation
from tautline.scene.errors import option_error
from tautline.scene.values.moments import stamp_said
from tautline.twin.condition import FAR, MISSES, NOT_KNOWN_YET, SHAKEN, SHOWS_LITTLE, STARVES, condition_of, not_shown
from tautline.twin.estimation.estimate import Estimate, Machine
from tautline.twin.estimation.family import Blow
from tautline.twin.estimation.horizon import MISSED, SEEN_OFF, Sample
from tautline.twin.estimation.log import Logged
from tautline.twin.forecast import EARLY, Forecast, Found
from tautline.twin.loss import Loss, SceneEnded, why
from tautline.twin.map.check import bare_bounds, checked
from tautline.twin.map.file import TwinMap, driven_by, read_map
from tautline.twin.map.plan import Plan
from tautline.twin.operation import Blur, Operation, findings
from tautline.twin.pace import LONG_GAP
from tautline.twin.restrictions import Outlook
from tautline.twin.settling import Settling
from tautline.twin.signals.backlog import LIMIT, Backlog
from tautline.twin.signals.readings import Readings
from tautline.twin.signals.row import Row
from tautline.twin.signals.sensors import Health
from tautline.twin.sources.stated_units import Stated
from tautline.twin.watch import Compared, Watch, said

MANY = 5.0
"""Standard deviations of a sensor from which on a computed value is not known well, and health is degraded."""
LONG_MISSED = 10.0
"""The same of what rows have missed in the last seconds, where inputs are noisy."""
NOISE_SHOWN = 12
"""Rows that show how much noise inputs have before a load is moved by them."""
RESTED = 0.5
"""Time over which it is averaged by how much rows of a machine at rest miss what is computed, s: slips let go
of a string within seconds."""
BEYOND, NO_LONGER_BEYOND = 5.0, 1.0
"""Standard deviations that an estimate would stand beyond its range, from which on range or data are wrong; and at
which they are right again."""
SETTLING = 1.0
"""Time after which samples count again when an input has been made up for, s."""


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
        self.plan, first = self._planned()
        self.readings = Readings(self.plan, {}, live)
        self.estimate = Estimate(self.plan, self._machine(first), self.operation, self.readings.rows)
        if self.estimate.blows and self.plan.inputs:
            self.readings.rows.fewest = NOISE_SHOWN
        self.watch = Watch(self.plan, self.readings.health, self.operation, getattr(self.scene, "units", "si"))
        aheads = [one.ahead for one in self.plan.alarms if one.ahead > 0.0]
        self.backlog = Backlog(min(aheads, default=LIMIT)) if live else None
        self.outlook = Outlook(self.plan, self.readings.waves, self.estimate.departing)
        self._begin_anew()
        self._read = list(dict.fromkeys([
            *(one.name for one in self.plan.measured),
            *(name for name in self.plan.keep if name in self.plan_names.outputs),
            *(one.target for one in self.plan.alarms if not one.is_residual and one.target in self.plan_names.outputs),
            *(self.operation.reads if self.operation else ()),
        ]))  # fmt: skip
        self.now, self.unsettled = np.nan, -np.inf
        self.settling, self.unsure, self.rests, self.starved = Settling(), False, False, False
        self.doubts: list[str] = []  # why what is computed is in doubt
        self.blur = Blur(np.zeros(len(self.plan.measured)))
        self._ends, self._ends_told = dict[str, float](), set[str]()
        self.restarts = 0
        # No other operation has it: what it keeps in files is known by it.
        self.mark = secrets.token_hex(8)
        self.loss = Loss()
        self.heard: dict[str, Any] = {}  # what was read of a source that is read once more from its begin
        self.stated: Stated = {}  # units that were stated with readings, and hold until others are
        self.notes = self.estimate.notes  # one list
        self.notes += bare_bounds(self.map, self.plan)
        self.notes += self.operation.doubts(self.plan) if self.operation else []
        until, key = self._known_with_sensors()
        if np.isfinite(until):
            cure = f"give `{key}` a sensor, or the scene a later solver.end"
            self.notes.append(
                f"`{key}` has no sensor, and is known up to {until:g} s only: the twin ends there; {cure}"
            )
        self.paused = False
        self._further: dict[str, dict[str, Any]] = {}

    # -- what it is made of --------------------------------------------------------------------------------------------

    def _planned(self) -> tuple[Plan, Simulation]:
        """The map, checked against the scene, and a simulation of the scene."""
        signals = self.operation.signals if self.operation else {}
        plan, names, first = checked(self.map, self.scene, signals, findings(self.operation))
        self.plan_names = names
        if self.operation is not None:
            self.operation.built(first)
            if self.map.window is None and self.operation.window is not None:
                plan = plan.model_copy(update={"window": self.operation.window})
        self.units = names.outputs | dict(self.operation.outputs if self.operation else {})
        return plan, first

    def _machine(self, first: Simulation) -> Machine:
        """What stands for the machine, with the free motions that matter."""
        free = getattr(self.application, "free_motions", None)
        wanted = self.plan.measured and self.plan.unknowns
        blows = [Blow(*one) for one in free(self.scene)] if free is not None and wanted else []
        return Machine(self.scene, driven_by(self.map), blows, first)

    def _begin_anew(self) -> None:
        """Let inputs and forecasts begin where the simulations of the estimate do."""
        plan, first = self.plan, self.estimate.family.simulations[0]
        inputs = driven_by(self.map)
        self.readings.start = {name: float(first.inputs[name]) for name in inputs}
        bounds = [one for one in plan.alarms if not one.is_residual and one.ahead > 0.0]
        ahead = max([one.ahead for one in bounds], default=0.0) or plan.ahead
        self.outlook.forecast = Forecast(first.copy(), bounds, ahead) if ahead > 0.0 and inputs else None

    # -- data ----------------------------------------------------------------------------------------------------------

    @property
    def known_until(self) -> tuple[float, str]:
        """How long after its start the scene moves by itself what no sensor drives, s, and the key of that."""
        return self.estimate.family.simulations[0].known_until

    def _known_with_sensors(self) -> tuple[float, str]:
        """The same as it will be when the sensors have given their first readings."""
        sim = self.estimate.family.simulations[0].copy()
        for name in driven_by(self.map):
            sim.inputs[name] = float(sim.inputs[name])
        return sim.known_until

    @property
    def columns(self) -> list[str]:
        """Columns of the sensors, in the order of the map."""
        return self.readings.columns

    def add(
        self, time: float, values: Mapping[str, float] | Sequence[float] | np.ndarray, arrived: float = 0.0,
        repeated: Collection[str] = (),
    ) -> list[dict[str, Any]]:  # fmt: skip
        """Take a row of data, and give the lines of all rows that it completes.

        Parameters
        ----------
        time : float
            Its stamp, s.
        values : mapping, or (c,)
            Readings in the units of the map's columns: by column, or in the order of `columns`. NaN or None, or a
            column that is not there, is a reading that is missing. Columns that the map does not name do not count.
        arrived : float
            When it arrived, by this computer's clock, s.
        repeated : collection of str, optional
            Columns that were not measured at this stamp, and whose last readings hold: true ones that come yet count.

        Raises
        ------
        ArgumentError
            For a list of another length than `columns`, and for what is no number.
        SceneEnded
            For a row later than what the scene moves by itself.
        """
        self.readings.rows.add(float(time), self.readings.by_column(values), arrived, repeated)
        if self.backlog is None:
            return self.answers()
        self.backlog.take(self.readings.rows.newest, arrived)
        lines = self.answers()
        self.backlog.none_waits()  # rows that are answered in a silence, or at the end, wait for other rows only
        return lines

    def answers(self, end: bool = False, silent: bool = False) -> list[dict[str, Any]]:
        """Lines of all rows that are ready; with `silent`, as none comes now, of all that are known to be of now.

        With `end` none comes any more: rows of which it is not known what they are are left out, and told.
        """
        lines = []
        while (row := self.readings.rows.ready(end, silent)) is not None:
            if (line := self._answer(row)) is not None:
                lines.append(line)
        return lines

    def work(self, seconds: float | None = None) -> bool:
        """Look ahead for at most so many seconds, or to the end; whether something is left."""
        return self.outlook.work(seconds)

    def finish(self) -> list[dict[str, Any]]:
        """Lines of the rows that are left when the data have ended."""
        return self.answers(end=True)

    def _answer(self, row: Row) -> dict[str, Any] | None:
        """Go on to a row, and say what is found."""
        if np.isfinite(self.now) and row.time <= self.now:
            return None
        values = self.readings.checked(row)
        use = True
        if self.operation is not None:
            guided = self.operation.before(row.time, self.readings.named(values))
            self.notes += self.operation.remarks()
            if guided.paused:
                self.rests = False
                return self._wait(row, values)
            if guided.scene is not None or self.paused:
                self._go_on(guided.scene)
            use = guided.use
            if guided.rests and not self.rests:
                self.estimate.horizon.miss_anew(self.now)
            self.rests = guided.rests
        if self._is_astray(row.time):
            self._leave_bounce(row.time)
        if self.estimate.from_rest:
            self.estimate.horizon.begin_again()
            # What rows missed was missed by a simulation that is given up.
            self.estimate.horizon.miss_anew(self.now)
            self._rest()
        if (self.estimate.log.begun or self.loss.text) and (
            row.begins or (row.after_gap and row.time - self.now > LONG_GAP)
        ):
            self._pass_over(row)
        inputs = self.readings.inputs(row, self.estimate.log.begun, self.estimate.bounce())
        self.notes += self.readings.remarks()
        if self.readings.step_found and self.estimate.log.begun:
            # What was laid through the treads has set the load bouncing.
            self.estimate.from_rest = True
        if not self.estimate.log.begun:
            if (begun := self._begin(row, inputs)) is None:
                return self._go_without(row, values)
            inputs = begun
        if self.estimate.log.origin + self.known_until[0] + EARLY < row.time:
            until, key = self.known_until
            raise SceneEnded(row.time, until, key)
        try:
            self.estimate.advance(row.time, inputs)
        except StoppedEarly as error:
            if (begun := self._restart(row, error)) is None:
                return self._go_without(row, values)
            inputs = begun
        read = dict(zip(self._read, self.estimate.family.read(self._read), strict=True))
        self.readings.take_back(row.time, {one.name: float(read[one.name][0]) for one in self.plan.measured})
        line = self._compare(row, inputs, values, read, self._used(row, values) & use, use)
        self.now = row.time
        self.outlook.foresee(row.time, dict(inputs), self.readings.shown)
        return line

    # -- the machine begins, waits and goes on -------------------------------------------------------------------------

    def _begin(self, row: Row, inputs: list[tuple[str, np.ndarray]]) -> list[tuple[str, np.ndarray]] | None:
        """Bring the simulations to where the sensors are; gives the inputs they have there, or None where they stop.

        Where they stop on the way to the machine's speed they come to rest at its place, and join its motion from
        there: on that way they are nowhere where the machine was not. Else it is tried again at a later row.
        """
        lost = bool(self.loss.text)
        if lost and self.loss.waits(row.time):
            return None
        for at_rest in (False, True):
            try:
                begun = self._begin_at(row, inputs, at_rest)
            except StoppedEarly as error:
                self.estimate.rest()
                self.loss.lose(error, of_machine=True, columns=self.readings.placing)
            else:
                self.loss.end()
                if lost:
                    self.notes.append(f"at {stamp_said(row.time)} the simulation began again where the sensors are")
                    self._disturbed(row.time)
                return begun
        self.loss.put_off(row.time)
        self.notes += [f"at {stamp_said(row.time)} {news}" for news in self.loss.news()]
        return None

    def _begin_at(
        self, row: Row, inputs: list[tuple[str, np.ndarray]], at_rest: bool = False
    ) -> list[tuple[str, np.ndarray]]:
        """Bring the simulations to where the sensors begin: as they move there, or at rest; gives their inputs."""
        shown = inputs
        if at_rest:
            inputs = self.readings.resting(shown)
        anywhere = self.operation is not None and self.operation.anywhere
        run_in = self.readings.begin(row, inputs, anywhere, first=row.begins or not np.isfinite(self.now))
        self.notes += self.readings.remarks()
        family, log = self.estimate.family, self.estimate.log
        if run_in > 0.0 and not anywhere:
            self.estimate.stand_still()
        begin = family.time
        log.origin = row.time - begin - run_in
        if run_in > 0.0:
            # A quintic from rest, in one advance: the simulation takes its own steps on the way.
            family.advance(begin + run_in, inputs)
            self.unsettled = row.time + SETTLING
        log.begin(row.time, family.save())
        if at_rest:
            self.readings.join_from_rest(shown)
        return inputs

    def _wait(self, row: Row, values: np.ndarray) -> dict[str, Any]:
        """A row while the machine is apart from its scene, such as a string that hangs in slips; its line."""
        if not self.paused:
            self.paused = True
            self.estimate.take_in_mean()
        self.outlook.drop()
        self.estimate.relinearise()
        self._further = {}
        self.now = row.time
        self.watch.judge_sensors(row.time, self.estimate.horizon.correlation, self.estimate.converged)
        self.watch.judge_operation(row.time)
        y = self.readings.measured(values)
        return self._line(row, [], y, {}, np.full(len(y), np.nan))

    def _go_on(self, scene: Any) -> None:
        """Go on from rest after that, with the estimate as it is; a scene is what the machine has become meanwhile."""
        self.paused = False
        while self.estimate.relinearising:
            self.estimate.relinearise()
        if scene is not None:
            self.become(scene)
        self._rest()

    def become(self, scene: Any) -> None:
        """Build the simulations of another scene, begun at the estimate."""
        self.scene, h = scene, self.estimate.horizon
        first = Simulation(scene, driven_by(self.map), keep=False)
        assert self.operation is not None
        self.operation.built(first)
        unknowns = [
            one.model_copy(update={"start": float(np.clip(h.mean[i], one.low, one.high))})
            for i, one in enumerate(self.plan.unknowns)
        ]
        self.plan = self.plan.model_copy(update={"unknowns": unknowns})
        self.estimate.build(self.plan, self._machine(first))
        self._begin_anew()

    def _restart(self, row: Row, error: StoppedEarly) -> list[tuple[str, np.ndarray]] | None:
        """Begin again from rest where the sensors are, with the estimate as it is; as `_begin`.

        What stopped the simulation on a way that was made up, such as an input that comes to rest while its sensor
        shows nothing, says nothing of the machine.
        """
        self.restarts += 1
        self.loss.begun = True  # states of earlier versions do not tell it
        made_up, seen = self.readings.made_up, self.readings.seen
        own = ". An input was on a way of its own, as its sensor had shown nothing for a while" if made_up else ""
        text = f"the simulation stopped ({why(error)}{own}); it was begun again from rest where the sensors are"
        self._rest()
        self.outlook.drop(None if made_up else Found(row.time, stopped=(0.0, error.status.name)))
        if self.loss.waits(row.time):
            self.loss.lose(error, of_machine=not made_up)
            return None
        self.loss.put_off(row.time)
        begun = self._begin(row, seen)
        if begun is not None:
            self.watch.stopped(row.time, text)
            self.notes.append(f"at {stamp_said(row.time)} {text}")
            self._disturbed(row.time)
        return begun

    def _disturbed(self, time: float) -> None:
        """Let nothing be judged by what is computed until that has followed the sensors for a while."""
        self.unsettled = time + max(SETTLING, self.plan.window)
        self.settling.disturb(time)

    def _go_without(self, row: Row, values: np.ndarray) -> dict[str, Any]:
        """A row while no simulation goes on: what is measured is watched all the same; its line."""
        self._further = {}
        self.now = row.time
        y, horizon = self.readings.measured(values), self.estimate.horizon
        nothing = np.full(len(y), np.nan)
        self.watch.judge(Compared(
            row.time, values, {}, nothing, nothing, np.zeros(len(y), bool), horizon.correlation,
            self.estimate.converged, self.loss.ahead(row.time), led_until=row.time, blind=self.readings.blind,
            lost=self.loss.text,
        ))  # fmt: skip
        return self._line(row, [], y, {}, nothing)

    def _is_astray(self, time: float) -> bool:
        """Whether the load bounces in the simulation as the machine's does not, with inputs that go as measured."""
        follows = time >= self.unsettled and not self.settling.catching_up and not self.readings.made_up
        # Without noise of the inputs it is the guess of the weight that sets it bouncing, and that is being found. A
        # bounce by noise may keep the weight from being found: then for a whole window at most.
        found = self.estimate.converged or (self.readings.shaken and self.estimate.horizon.is_full)
        return follows and self._moved_wrongly and found and self.estimate.astray

    @property
    def _moved_wrongly(self) -> bool:
        """Whether inputs shake a load: by noise that is seen in them, or in the residuals alone."""
        return self.readings.shaken or bool(np.any(self.estimate.horizon.spread > MANY**2))

    def _leave_bounce(self, time: float) -> None:
        """Begin again from rest, and know nothing for certain until the window is full anew."""
        self.restarts += 1
        self.notes.append(
            f"At {stamp_said(time)} the simulated load bounced otherwise than the real one. "
            + f"That may be by {self.blur.suspect}. " * bool(self.blur.suspect)
            + "The simulation started again from rest."
        )
        self.estimate.from_rest = True

    def go_on_from_rest(self) -> None:
        """Begin again from rest, with an estimate of another version of the program: it simulated other things."""
        self.restarts += 1
        self.notes.append(
            "the state was written by another version of the program: the twin goes on with its estimates, and the "
            "simulation begins again from rest"
        )
        self._rest()
        self.settling.disturb(self.now)

    def _pass_over(self, row: Row) -> None:
        """Begin again from rest behind a long gap, with the estimate as it is: an hour at rest is not simulated.

        Behind rows that were old when they came, too.
        """
        self.restarts += 1
        why = f"no rows came for {row.time - self.now:.0f} s, or the clock was set forward"
        if row.time - self.now <= LONG_GAP:
            why = "rows come as they are measured from now on"
        else:
            self.watch.alarms.pass_over()
        self.notes.append(f"{why}: the simulation was begun again from rest at {stamp_said(row.time)}")
        self._rest()
        self.settling.disturb(row.time)

    def _rest(self) -> None:
        """Put the simulations back to rest, with the parameters of the estimate."""
        self.estimate.rest()
        self.outlook.drop()
        self.watch.begun_again()

    # -- the estimate --------------------------------------------------------------------------------------------------

    def _used(self, row: Row, values: np.ndarray) -> np.ndarray:
        """Which of the measured outputs count (m,)."""
        if self.readings.made_up:
            self.unsettled = row.time + SETTLING
        if self.readings.led:
            self.settling.disturb(row.time)
        return self.readings.believed(values) & (row.time >= self.unsettled)

    def _compare(
        self, row: Row, inputs: list[tuple[str, np.ndarray]], values: np.ndarray, read: dict[str, np.ndarray],
        use: np.ndarray, says: bool,
    ) -> dict[str, Any]:  # fmt: skip
        """Compare with what is ``read`` of the simulations, estimate, watch.

        Gives the line of a row, which ``says`` something of what is estimated, or does not.
        """
        estimate, horizon = self.estimate, self.estimate.horizon
        y = self.readings.measured(values)
        horizon.shaken, self.blur = self.readings.shaken, estimate.blurred(read)
        y0, J = estimate.compared(read)
        tells = estimate.alike(read)
        told = self._compare_units(row.time, y, y0, J, use, tells)
        believed = told & estimate.tame(J)
        use = believed & tells
        if (told & tells).any():
            horizon.follow_wild(row.time, not use.any())
            if horizon.starves and not self.starved:
                self.notes.append(
                    f"from {stamp_said(row.time)} on most readings cannot be used: what is simulated moves out of step "
                    "with the machine. Estimates stand still, and health is not good until that is over"
                )
            self.starved = horizon.starves
        residual, residual_sd = horizon.expected(Sample(row.time, y, y0, J, np.isfinite(y)))
        followed = self.readings.believed(values) if self.rests else use & estimate.converged
        horizon.miss(row.time, np.where(followed, residual, np.nan), y0, RESTED if self.rests else MISSED)
        if says and row.time >= self.unsettled:
            # By the sensor's own noise: what nothing explains must not pass for noise. Before anything is found, by
            # what may be wrong at the start as well.
            sds = horizon.own(residual_sd, y0) if estimate.converged else residual_sd
            for (_, health), off, sd in zip(self._health_of_outputs(), residual, sds, strict=True):
                health.contradict(row.time, off if health.fault == "" else np.nan, sd)
        # A row of what is compared as means tells nothing by itself.
        alone = self.operation is None or self.operation.mean == 0.0
        off = np.where(self.readings.believed(values), residual, np.nan) if alone else np.full_like(residual, np.nan)
        self.settling.follow(row.time, off, residual_sd, y, estimate.bounce())
        # What is not used is kept as well: it shows whether the load swings.
        kept = y if says and row.time >= self.unsettled else np.full_like(y, np.nan)
        estimate.take_in(Sample(row.time, kept, y0, J, use))
        estimate.log.rows.append(Logged(row.time, inputs, kept, believed))
        family = estimate.family
        estimate.relinearise()
        if estimate.family is not family:
            # Other simulations go on from here, with other values and derivatives.
            read = dict(zip(self._read, estimate.family.read(self._read), strict=True))
        outputs = self._with_noise_of_inputs(estimate.outputs(read), read, y0)
        ahead = self.outlook.fresh(row.time)
        moved = estimate.moved_since(read, ahead.parameters) if ahead is not None else {}
        self.watch.judge(Compared(
            row.time, values, outputs, residual, residual_sd, use, horizon.correlation, estimate.converged,
            ahead, row.time - horizon.changed, self.settling.since, self.settling.moved_at,
            self.readings.blind, self.outlook.is_overdue(row.time), moved, self.unsure,
            self.operation is not None and self.operation.put_down(read), far=horizon.is_far,
            suspect=self.blur.suspect,
        ))  # fmt: skip
        self._further = self._found_by_operation(row.time, y, outputs)
        return self._line(row, inputs, y, outputs, residual)

    def _with_noise_of_inputs(
        self, outputs: dict[str, Any], read: Mapping[str, np.ndarray], y0: np.ndarray
    ) -> dict[str, Any]:
        """Outputs with what residuals show beyond the sensor's noise added to their deviations."""
        horizon, more = self.estimate.horizon, dict(outputs)
        sds, self.doubts = horizon.deviations(y0), []
        # Means of rows say nothing of what a row of its own is off by. A machine at rest shows it.
        alone = self.operation is None or self.operation.mean == 0.0
        both = zip(horizon.of_inputs(y0), horizon.of_rows(y0) * (alone or self.rests), horizon.left, strict=True)
        beyond = {}
        for one, sd, blur, (shaken, missed, left) in zip(self.plan.measured, sds, horizon.blur, both, strict=True):
            value, own = outputs[one.name]
            beyond[one.name] = max(shaken, missed, blur)
            more[one.name] = value, np.hypot(own, beyond[one.name])
            self._doubt(blur**2 > 0.5 * sd**2, self.blur.why)
            # A parameter that is not known and makes nothing of the sensors uncertain does not matter.
            self._doubt(not self.estimate.known and own > MANY * sd, f"{one.name}: {NOT_KNOWN_YET}")
            # What rows have missed is remembered for seconds, also of a first guess that shook the load by little.
            if self.readings.shaken:
                noisy = np.hypot(own, shaken) > MANY * sd or missed > LONG_MISSED * sd
                self._doubt(noisy, f"{one.name}: {SHAKEN}")
            # A step that is not recognised, or a sensor that is off, shows in what rows miss, and in what the estimate
            # leaves of the window: a single snap that comes a little later than computed is missed by more.
            self._doubt(missed > MANY * sd and (self.rests or left > MANY**2), f"{one.name}: {MISSES}")
            # Of means no single row shows it.
            self._doubt(not alone and own > MANY * sd, f"{one.name}: {NOT_KNOWN_YET}")
            self._doubt(not alone and self.estimate.extrapolated, FAR)
        for name, swung in self.estimate.swung(read, beyond).items():
            if name not in beyond:
                more[name] = outputs[name][0], np.hypot(outputs[name][1], swung)
        self._doubt(self._moved_wrongly and not self.estimate.shown, SHOWS_LITTLE)
        for name in self._at_an_end():
            self._doubt(True, f"{name} stands at the end of its range, and the sensors ask for a value far beyond")
        self._doubt(horizon.starves, STARVES)
        self.unsure = bool(self.doubts)
        return more

    def _doubt(self, holds: Any, why: str) -> None:
        """Keep a reason why what is computed is in doubt, where it holds."""
        if holds and why not in self.doubts:
            self.doubts.append(why)

    def _at_an_end(self) -> list[str]:
        """Which estimates have wanted to leave their ranges for a second, far beyond their deviation; told once."""
        lasting, units = list[str](), getattr(self.scene, "units", "si")
        for one, beyond, mean in zip(
            self.plan.unknowns, self.estimate.horizon.beyond, self.estimate.horizon.mean, strict=False
        ):
            # The longer it stands there, the less a simulation at the wrong value tells of how far beyond it would be.
            if not beyond > (NO_LONGER_BEYOND if one.name in self._ends else BEYOND):
                self._ends.pop(one.name, None)
                continue
            begun = self._ends.setdefault(one.name, self.now)
            if self.now - begun < SETTLING:
                continue
            lasting.append(one.name)
            if one.name not in self._ends_told:
                self._ends_told.add(one.name)
                self.notes.append(
                    f"{one.name} stands at the end of its range, {said(float(mean), one.unit, units)}, and the sensors "
                    "ask for a value far beyond. Check units and zero of the sensors, or make `range` wider in the map"
                )
        return lasting

    def _health_of_outputs(self) -> list[tuple[str, Health]]:
        """Names and health of the measured outputs (m,)."""
        both = zip(self.plan.channels, self.readings.health, strict=True)
        return [(one.name, health) for one, health in both if one.is_output]

    def _compare_units(
        self, time: float, y: np.ndarray, y0: np.ndarray, J: np.ndarray, use: np.ndarray, tells: np.ndarray
    ) -> np.ndarray:
        """Leave out what is in another unit, and follow what drifts, of sensors (m,) that tell something now."""
        if not len(y):
            return use
        horizon, health = self.estimate.horizon, self.readings.health
        told = y0 + J @ (horizon.mean - horizon.theta0)
        sd = horizon.deviations(y0)
        use = use.copy()
        numbers = [i for i, one in enumerate(self.plan.channels) if one.is_output]
        settled = self.estimate.converged
        alone = self.operation is None or self.operation.mean == 0.0
        for m, i in enumerate(numbers):
            spread = abs(J[m]) @ horizon.deviation if horizon.unknowns else 0.0
            if (use[m] or health[i].fault == "unit") and tells[m]:
                good = health[i].compare(time, y[m], told[m], sd[m] + spread, settled and use[m])
                use[m] = use[m] and (good or self.estimate.explains(told[m], y[m], J[m]))
            drifts = settled and alone and health[i].drifting(float(horizon.correlation[m]), SEEN_OFF)
            horizon.drift[m] = health[i].mean_residual / sd[m] if drifts else 0.0
        return use

    def _found_by_operation(self, time: float, y: np.ndarray, outputs: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
        """Further estimates, such as the weight on the bit."""
        if self.operation is None:
            return {}
        horizon = self.estimate.horizon
        sd = horizon.deviations(np.nan_to_num(y)) * np.sqrt(np.clip(horizon.spread, 1.0, 9.0))
        measured = {
            name: (float(y[m]) if health.fault == "" else np.nan, float(sd[m]))
            for m, (name, health) in enumerate(self._health_of_outputs())
        }
        estimates = {
            one.name: (float(horizon.mean[k]), float(horizon.stated[k])) for k, one in enumerate(self.plan.unknowns)
        }
        found = self.operation.found(time, measured, outputs, estimates, self.estimate.family.simulations[0])
        units = self.operation.outputs
        return {name: {"value": one[0], "sd": one[1], "unit": units[name]} for name, one in found.items()}

    # -- what comes out ------------------------------------------------------------------------------------------------

    def _line(
        self, row: Row, inputs: list[tuple[str, np.ndarray]], y: np.ndarray, outputs: Mapping[str, Any],
        residual: np.ndarray,
    ) -> dict[str, Any]:  # fmt: skip
        plan, h, rows = self.plan, self.estimate.horizon, self.readings.rows
        sds = h.stated
        estimates = {
            one.name: {"value": float(h.mean[k]), "sd": float(sds[k]), "unit": one.unit}
            for k, one in enumerate(plan.unknowns)
        } | self._further
        names = [one.name for one in plan.measured]
        shown = list(dict.fromkeys([*names, *plan.keep, *(one.target for one in plan.alarms)]))
        self._judge_backlog(row.time)
        lag = clock.monotonic() - row.arrived if rows.live else max(0.0, rows.newest - row.time)
        health, causes = condition_of(self)
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
            "alarms": self.watch.alarms.told(),
            "restrict": self.outlook.restricted,
            "not_observable": not_shown(self),
            "lag": lag,
            "health": health,
            "causes": causes,
            **(self.operation.told() if self.operation else {}),
        }

    def _judge_backlog(self, time: float) -> None:
        """Warn where rows wait longer for their answers than what is foreseen is of use."""
        if self.backlog is None:
            self.watch.judge_backlog(time, 0.0, False)  # a state may have brought that alarm of a live source
            return
        seconds, tell = self.backlog.judge()
        self.watch.judge_backlog(time, seconds, self.backlog.behind, self.backlog.held_up)
        if tell:
            self.notes.append(
                f"the twin is {seconds:.1f} s behind the machine, as this computer does not keep up with the rows. "
                "Fewer rows a second help, and so do fewer elements in the scene"
            )


def number(value: Any) -> Any:
    """A float, a list of floats, or None where there is none: JSON knows no NaN."""
    array = np.asarray(value, float)
    if array.ndim == 0:
        return float(array) if np.isfinite(array) else None
    return [number(x) for x in array]
