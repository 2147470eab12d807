"""The estimate: a family of simulations that is held against the sensors over a window.

Derivatives hold near the parameters that the family was made with. Where the estimate has left them, a spare family
goes through the window again from a state that is extrapolated to the estimate, a few rows at a time. It takes the
place of the first if it explains the data about as well.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tautline.integrators.status import StoppedEarly
from tautline.live.errors import SimulationError
from tautline.live.simulation import Simulation
from tautline.twin.estimation.bounce import first_bounce
from tautline.twin.estimation.family import Blow, Family, steps_to
from tautline.twin.estimation.horizon import BENT, Horizon, Sample, mean_of
from tautline.twin.estimation.log import Checkpoint, Log, Logged
from tautline.twin.estimation.passage import Passage
from tautline.twin.map.plan import Plan, Unknown
from tautline.twin.operation import Blur, Operation
from tautline.twin.pace import ONE_STAMP
from tautline.twin.signals.rows import Rows

if TYPE_CHECKING:
    from tautline.live.memory import State

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
DOUBTFUL = 0.1
"""The same from which on what is computed of a machine that sticks and slips is in doubt."""
WILD = 4.0
"""Size of derivatives over their usual one from which on a neighbour is begun anew."""
SLIGHT = 0.01
"""Share of a sensor's deviation that a parameter changes within its own, below which a reading tells nothing of it."""
LASTS = 0.6
"""Share of the rows of a window that were wild from which on they are no exceptions."""
NOT_SHOWN = 0.5
"""Standard deviation of an unknown, over that at the start, from which on the data have not shown it."""
KNOWN, TENTH = 0.25, 0.1
"""The same from which on a parameter is not known well, where it is more than so much of the parameter as well."""
SLOPES = 200
"""Rows of which the usual size is the median."""
LATE = 8
"""Means of rows that are held against all others of a window."""
FEWEST = 5
"""Rows that are worth going through anew."""
ASTRAY, ASTRAY_SD, ASTRAY_SHARE = 2.0, 5.0, 0.6
"""What the best estimate leaves of a window, over what the readings swing about a line, and over the sensor's noise,
from which on the simulation bounces by itself, as the machine does not; and share of the window that has to tell."""
SAME_BOUNCE = 0.2
"""Share by which a period that is found anew may be another without counting as one."""
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


class Machine(NamedTuple):
    """What stands for the machine.

    Attributes
    ----------
    scene : scene
    inputs : list of str
        Those that the map drives.
    blows : sequence of Blow
        What sets free motions off.
    first : Simulation
        The scene at its start, with the parameters that it has.
    """

    scene: Any
    inputs: list[str]
    blows: Sequence[Blow]
    first: Simulation


BELIEVED = 0.5
"""Share of a derivative beside its steady part from which on it is believed."""


class Estimate:
    """What is not known of a machine, from what its sensors show.

    Parameters
    ----------
    plan : Plan
        Unknowns, sensors and window.
    machine : Machine
        The scene as it is.
    operation : Operation or None
        What the application knows of the work.
    rows : Rows
        Whose sample interval counts.

    Attributes
    ----------
    family : Family
        The simulations that stand at the newest row.
    horizon : Horizon
        The estimate itself, with its window.
    log : Log
        What the simulations were given.
    notes : list of str
        What could not be done.
    begin : Family
        What the simulations differed in where they began; it has no simulations.
    from_rest : bool
        Whether the window could not be gone through from where it began: it has to be begun again from rest.
    """

    def __init__(self, plan: Plan, machine: Machine, operation: Operation | None, rows: Rows) -> None:
        self.operation, self.rows = operation, rows
        # Rows are compared one by one, or as means.
        self._mean = operation.mean if operation is not None else 0.0
        self.log = Log(plan.window)
        self.notes: list[str] = []
        self.from_rest = self._plain = False
        self._passage: Passage | None = None
        self._pending: list[Sample] = []
        self._gathered: list[Sample] = []
        self._slopes: list[deque[np.ndarray]] = []
        self._bounce = 0.0
        self.build(plan, machine)
        free = [_as_unknown(one) for one in self.blows]
        late = LATE if self._mean else 0
        self.horizon = Horizon([*plan.unknowns, *free], plan.measured, plan.window, len(free), late)
        self.horizon.theta0[self._offsets] = 0.0
        sizes = operation.sizes() if operation is not None else {}
        self.horizon.largest = np.array([sizes.get(one.name, 0.0) for one in plan.measured])

    # -- the simulations -----------------------------------------------------------------------------------------------

    def build(self, plan: Plan, machine: Machine) -> None:
        """Make a family of a machine, and a spare one; the estimate stays as it is."""
        self.plan, self._machine, self._first, self.blows = plan, machine, machine.first, list(machine.blows)
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
            at = Simulation(machine.scene, machine.inputs, keep=False, parameters=given) if names else machine.first
            made.append(at)
        made += [made[0].copy() for _ in self.blows]
        self.family = Family(made, names, self.blows)
        self.family.at, self.family.apart = start, np.append(apart, np.ones(len(self.blows)))
        self._held: dict[str, float] = {}
        self._without_start = np.full(len(names), np.inf)  # parameters at which the scene has no start
        self._steep: dict[str, np.ndarray] = {}
        self._steep_at = self.family.time
        self._seen = [*self._parameters, *range(len(plan.unknowns), len(plan.unknowns) + len(self.blows))]
        self.spare = Family([sim.copy() for sim in made] if len(made) > 1 else [], names, self.blows)
        self._begin = self.family.save()
        self.begin = Family([], names, self.blows)
        self.begin.at, self.begin.apart = start.copy(), self.family.apart.copy()
        self.family.strike(0.0)

    def _apart(self, i: int, value: float, width: float) -> float:
        """How far a neighbour is off in its parameter, within the range."""
        one = self.plan.unknowns[i]
        apart = max(width, LEAST_APART * abs(value), 1e-9)
        if value + apart > one.high or not self._can_be(one.target, value + apart):
            return -apart
        return apart

    def _can_be(self, name: str, value: float) -> bool:
        parameter = self._first.parameters.handle(name)
        return parameter.least < value <= parameter.most

    def advance(self, time: float, inputs: list[tuple[str, np.ndarray]]) -> None:
        """Go on to a row; a long gap is gone through in pieces, with inputs that come to rest."""
        target = time - self.log.origin
        begin = self.family.time
        if target <= begin + 1e-12:
            return
        gap = target - begin > max(4.0 * (self.rows.interval if np.isfinite(self.rows.interval) else 1.0), 0.5)
        if gap and inputs:
            for at in steps_to(begin, target)[:-1]:
                # The inputs stand at the far side already: on the way they hold what they had.
                self.family.advance(at, self.log.resting(at + self.log.origin))
        self.family.advance(target, inputs)
        if self.log.is_due(time):
            self.log.keep(time, self.family.save())

    def rest(self) -> None:
        """Put the simulations back to rest, with the parameters of the estimate."""
        h = self.horizon
        at = np.clip(h.mean, h.low, h.high)[self._parameters]
        self._stand_at_rest(self.family, at, self.begin.apart[: len(at)])
        self._passage = None
        self._pending, self._plain, self.from_rest = [], False, False
        self.log.clear()
        h.drop_before(np.inf)
        h.theta0[self._parameters] = self.family.at

    def _stand_at_rest(self, family: Family, at: np.ndarray, apart: np.ndarray) -> None:
        """Let a family stand where the scene begins, with parameters (p,) and neighbours that far off in them (p,)."""
        moved, off = (
            np.max(np.abs(at - one) / self.horizon.first_sd[self._parameters], initial=0.0)
            for one in (self.begin.at, self._without_start)
        )
        if self.blows and moved > MOVED_FROM_START and not off <= MOVED_FROM_START:
            self._find_rest(at, apart)
        self._stand(family, at, apart)

    def stand_still(self) -> None:
        """Let inputs be at rest where the simulations begin: from there they go to a machine that is elsewhere.

        A speed or a second rate with which the scene sets off would be carried on into a way of many seconds, which
        then leads metres beyond its end. The start is found anew, so that nothing is shaken.
        """
        first, names = self.family.simulations[0], self._machine.inputs
        if self._held or not any(np.any(first.inputs.motion(name)[1:]) for name in names):
            return
        self._held = {name: float(first.inputs[name]) for name in names}
        at, apart = self.family.at.copy(), self.family.apart[: self.family.at.size].copy()
        if self._find_rest(at, apart):
            self._stand(self.family, at, apart)
        else:
            self._held = {}

    def _stand(self, family: Family, at: np.ndarray, apart: np.ndarray) -> None:
        """The same, where the start as it was found last is near enough."""
        still = np.zeros(len(self.blows))
        shift, fresh = np.append(at - self.begin.at, still), np.zeros(len(at), bool)
        family.stand(self._begin, self.begin, shift, apart, self._quarter, fresh)

    def _find_rest(self, at: np.ndarray, apart: np.ndarray) -> bool:
        """Find the start of the scene anew with parameters (p,), and for neighbours that are that far off in them (p,).

        The sag of a rope is not in proportion to the load: put there by differences from a load of another weight, the
        rope swings, hardly damped, in the first simulation and in what its neighbours tell of the weight. Where there
        is no start with such parameters, what there was before stays, and it gives False.
        """
        begin = Family([], self.family.names, self.blows)
        begin.at, begin.apart = at.copy(), np.append(apart, np.ones(len(self.blows)))
        states = []
        try:
            for i in range(len(at) + 1):
                given = dict(zip(begin.names, begin.parameters_of(i).tolist(), strict=True))
                machine = self._machine
                found = Simulation(machine.scene, machine.inputs, keep=False, parameters=given, initial=self._held)
                states.append(found.save())
        except (StoppedEarly, SimulationError):
            self._without_start = at.copy()
            return False
        self._begin, self.begin = [*states, *([states[0]] * len(self.blows))], begin
        return True

    def state(self) -> tuple[State, dict[str, float]]:
        """The state and the parameters of the estimate."""
        states = self.family.save()
        if not self._seen:
            return states[0], {}
        at = self.horizon.mean[self._parameters]
        moved = (self.horizon.mean - self.horizon.theta0)[self._seen]
        p = len(self._parameters)
        # What free motion the difference of the neighbours holds is no part of their derivative.
        moved[p:] -= self.family.mixed @ moved[:p]
        weights = moved / self.family.apart
        memory = self.family.simulations[0].parts.memory
        block = memory.combine(states[0].block, [s.block for s in states[1:]], weights)
        return replace(states[0], block=block), dict(zip(self.family.names, at.tolist(), strict=True))

    def departing(self) -> tuple[State, dict[str, float], bool]:
        """The same, and whether the estimate is known: where a run ahead begins."""
        return (*self.state(), self.converged)

    # -- what is compared ----------------------------------------------------------------------------------------------

    def compared(self, read: Mapping[str, np.ndarray], family: Family | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Computed values of the sensors (m,), and their derivatives (m, k); of the family, where no other is given."""
        family = family or self.family
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

    def alike(self, read: Mapping[str, np.ndarray]) -> np.ndarray:
        """Of which sensors (m,) the differences of simulations are derivatives: all do what the machine does."""
        names = [one.name for one in self.plan.measured]
        return np.ones(len(names), bool) if self.operation is None else self.operation.counts(read, names)

    def blurred(self, read: Mapping[str, np.ndarray]) -> Blur:
        """What nobody measures makes of the sensors now; rows weigh by that from here on."""
        measured, h = self.plan.measured, self.horizon
        sensors = {one.name: one.unit for one in measured}
        found = Blur(np.zeros(len(measured))) if self.operation is None else self.operation.blurred(read, sensors)
        h.blur = found.sds
        h.blurs = max(1.0, found.lasts / self.rows.interval) if np.isfinite(self.rows.interval) else 1.0
        return found

    def tame(self, J: np.ndarray) -> np.ndarray:
        """Which sensors (m,) have derivatives that can be believed; near a slip they tell of a small range only."""
        p = self._parameters
        if not p or not self.blows:
            return np.ones(len(J), bool)
        h, size = self.horizon, np.abs(J[:, p])
        if not self._slopes:
            self._slopes = [deque(maxlen=SLOPES) for _ in range(len(J))]
        # Below this one reading tells next to nothing of a parameter, however much the derivative grows.
        least = SLIGHT * h.deviations(h.largest)[:, None] / h.first_sd[p]
        good = np.ones(len(J), bool)
        for m, past in enumerate(self._slopes):
            if h.wild > LASTS:
                past.clear()  # what has been wild for so long is what is usual now
            if len(past) >= FEWEST:
                good[m] = np.all(size[m] <= 2.0 * WILD * np.maximum(np.median(past, axis=0), least[m]))
            if good[m]:
                past.append(size[m])
        return good

    def explains(self, told: float, y: float, J: np.ndarray) -> bool:
        """Whether the unknowns could explain a value within their ranges, before they are known."""
        if self.converged or not self.plan.unknowns:
            return False
        h = self.horizon
        low = np.where(J > 0, h.low, h.high) - h.mean
        high = np.where(J > 0, h.high, h.low) - h.mean
        with np.errstate(invalid="ignore"):
            least, most = np.nansum(J * low), np.nansum(J * high)
        return bool(told + least <= y <= told + most)

    def outputs(self, read: Mapping[str, np.ndarray]) -> dict[str, Any]:
        """Outputs at the estimate: name -> (value, standard deviation)."""
        h, p = self.horizon, self._seen
        shift = (h.mean - h.theta0)[p]
        spread = h.covariance[np.ix_(p, p)] if p else np.zeros((0, 0))
        keep, self._steep_at = self._kept_steep(), self.family.time
        found: dict[str, Any] = {}
        for name, values in read.items():
            J = self.family.derivatives(values)
            value = values[0] + J @ shift
            if self.operation is not None and name in self.operation.pulled and np.min(values) >= 0.0:
                # None of the simulations has it: a rope is slack before it pushes.
                value = np.maximum(value, 0.0)
            sd = np.sqrt(np.einsum("...i,ij,...j->...", J, spread, J))
            if self._mean and p:
                self._steep[name] = np.maximum(np.abs(J), keep * self._steep.get(name, 0.0))
                sd = np.hypot(sd, BENT * (self._steep[name] @ np.abs(shift)))
            found[name] = (value, sd)
        return found

    def _kept_steep(self) -> float:
        """Share that is kept of the steepest derivatives since the last row.

        What swings has another phase with another friction: its derivative passes through zero, and what it may be off
        by, until it is linearised where the estimate is, does not. So the steepest of a mean's time counts.
        """
        passed = self.family.time - self._steep_at if self._mean else 0.0
        return float(np.exp(-passed / self._mean)) if passed >= 0.0 and self._mean else 0.0

    def moved_since(self, read: Mapping[str, np.ndarray], parameters: Mapping[str, float]) -> dict[str, np.ndarray]:
        """By how much outputs are more than they would be with other parameters than those of the estimate, by name.

        Parameters
        ----------
        parameters : mapping
            Such as those of an earlier estimate; one that is not there is as in the estimate.
        """
        p = len(self._parameters)
        now = self.horizon.mean[self._parameters]
        off = now - np.array([parameters.get(name, now[i]) for i, name in enumerate(self.family.names)])
        return {name: self.family.derivatives(values)[..., :p] @ off for name, values in read.items()}

    def swung(self, read: Mapping[str, np.ndarray], missed: Mapping[str, float]) -> dict[str, np.ndarray]:
        """Deviations of outputs by a free motion that makes measured ones as wrong as they are seen to be.

        What inputs and the model get wrong shows where something is measured: as a free motion, of which the two blows
        have the phases a quarter of a period apart. Whatever else is computed swings with it.

        Parameters
        ----------
        missed : dict of str to float
            By how much measured outputs are missed, as standard deviations.
        """
        b = len(self.blows)
        if b == 0:
            return {}
        by_blows = {name: np.linalg.norm(self.family.derivatives(x)[..., -b:], axis=-1) for name, x in read.items()}
        sizes = [sd / float(by_blows[name]) for name, sd in missed.items() if by_blows.get(name, 0.0) > 0.0]
        blow = float(np.sqrt(np.mean(np.square(sizes)))) if sizes else 0.0
        return {name: blow * size for name, size in by_blows.items()}

    @property
    def converged(self) -> bool:
        """Whether the estimate is a guess no more, and simulated where it stands."""
        return not self.plan.unknowns or (self.horizon.found and not self.horizon.is_far)

    @property
    def shown(self) -> bool:
        """Whether the data have shown something of every unknown."""
        h, n = self.horizon, len(self.plan.unknowns)
        return bool(np.all(h.deviation[:n] < NOT_SHOWN * h.first_sd[:n]))

    @property
    def known(self) -> bool:
        """Whether each parameter of a load that bounces is known: much better than at the start, or to a tenth."""
        h, p = self.horizon, self._parameters
        sd = h.deviation[p]
        return not self.blows or bool(np.all((sd < KNOWN * h.first_sd[p]) | (sd < TENTH * np.abs(h.mean[p]))))

    @property
    def extrapolated(self) -> bool:
        """Whether what is computed at the estimate is in doubt: it is far from the parameters of the simulations."""
        return self._is_far(DOUBTFUL)

    def _is_far(self, share: float) -> bool:
        """Whether any parameter is further from that of the simulations than a share of its deviation at the start."""
        h, p = self.horizon, self._parameters
        return bool(np.any(np.abs(h.mean - h.theta0)[p] > share * h.first_sd[p]))

    def take_in(self, sample: Sample) -> None:
        """Add a row to the window: by itself, or with others as their mean."""
        if not self._mean:
            self.horizon.add(sample)
            return
        if self._pending and not sample.use.any():
            self.take_in_mean()
        if sample.use.any():
            self._pending.append(sample)
            if sample.time - self._pending[0].time >= self._mean - ONE_STAMP:
                self.take_in_mean()

    def take_in_mean(self) -> None:
        """Add the mean of what has been gathered, where that is enough."""
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
            if begun and (not one.use.any() or one.time - begun[0].time >= self._mean - ONE_STAMP):
                found += [mean_of(begun)] if len(begun) >= FEWEST else []
                begun = []
        # What is not whole yet goes on to be gathered.
        self._gathered = begun
        return found

    # -- the window gone through anew ----------------------------------------------------------------------------------

    def relinearise(self) -> None:
        """Go through the window anew where the estimate has left where it was linearised, a few rows at a time."""
        if not self._seen:
            return
        try:
            if self._passage is None and len(self.log.rows) >= FEWEST and (self.blows or self._has_moved()):
                self._passage = self._begun_anew()
            for _ in range(CAUGHT_UP_FROM_REST if self._mean else CAUGHT_UP):
                if self._passage is not None and not self._go_through(self._passage):
                    self._passage = None
        except StoppedEarly:
            # Only from where the estimate would put it the simulation cannot go on: no accident of the machine, and
            # nothing that anybody could do. What was found before stays.
            self._passage = None

    @property
    def relinearising(self) -> bool:
        """Whether a window is being gone through anew."""
        return self._passage is not None

    @property
    def astray(self) -> bool:
        """Whether a load that does not swing at all would explain the readings better than the simulation does.

        Its bounce is then its own: from noise of inputs before that was known, or from a blow that was guessed wrong.
        A bounce that large is no longer in proportion to blows, and dies away within minutes only. Of what sticks and
        slips, and of means of rows, this says nothing.
        """
        h = self.horizon
        if not self.blows or self._mean or not h.samples:
            return False
        if h.samples[-1].time - h.samples[0].time < ASTRAY_SHARE * h.window:
            return False
        use = np.isfinite([one.y for one in h.samples])
        if not np.all(use.sum(axis=0) >= ASTRAY_SHARE * len(h.samples)):
            return False
        time = np.array([one.time for one in h.samples])
        line = np.stack([np.ones(time.size), time - time.mean()], axis=1)
        y, y0 = np.array([one.y for one in h.samples]), np.array([one.y0 for one in h.samples])
        told = y0 + np.array([one.J for one in h.samples]) @ (h.mean - h.theta0)
        worse = []
        for m, sd in enumerate(h.deviations(h.samples[-1].y0)):
            own, measured, basis = told[use[:, m], m], y[use[:, m], m], line[use[:, m]]
            swung = measured - basis @ np.linalg.lstsq(basis, measured, rcond=None)[0]
            left = measured - own - np.mean(measured - own)
            worse.append(left @ left > max(ASTRAY**2 * (swung @ swung), left.size * (ASTRAY_SD * sd) ** 2))
        return bool(worse) and all(worse)

    def _has_moved(self) -> bool:
        h, p = self.horizon, self._parameters
        moved = np.abs(h.mean - h.theta0)[p]
        return bool(np.any(moved > np.maximum(MOVED * h.linear_deviation[p], MOVED_FROM_START * h.first_sd[p])))

    def _begun_anew(self) -> Passage:
        """Let the spare family stand at the begin of the window, in a state that is extrapolated to the estimate."""
        h, p, spare = self.horizon, self._parameters, self.spare
        if self.blows:
            widths = [SWINGING * max(abs(h.mean[i]), h.first_sd[i]) for i in p]
        else:
            # What sticks and slips is not smooth in the small.
            widths = [APART * h.first_sd[i] for i in p]
        apart = np.array([self._apart(i, h.mean[i], width) for i, width in zip(p, widths, strict=True)])
        self.log.forget(self.log.rows[-1].time)
        first = self.log.checkpoints[0]
        late = self._quarter if self.blows else 0.0
        run_in = first.time - self.log.origin - self._first.time
        if self.blows and self.log.reaches_begin and run_in <= self.log.window:
            self._stand_at_rest(spare, h.mean[p], apart)
            if run_in > 0.0:
                # Blows fall where the window begins.
                spare.blows_due = []
                spare.advance(first.time - self.log.origin, self.log.rows[0].inputs)
                spare.strike(late)
        else:
            shift, fresh = (h.mean - h.theta0)[self._seen], self._wild()
            spare.stand(first.states, self.family, shift, apart, late, fresh | self._plain, self._plain)
        return Passage(first.time, first.time, late, deque([Checkpoint(first.time, spare.save())]))

    def _go_through(self, passage: Passage) -> bool:
        """Go on to the next row of the window; at its end take what was found, and give False."""
        spare, row = self.spare, self.log.after(passage.reached)
        if row is None:
            self._take_over(passage)
            return False
        spare.advance(row.time - self.log.origin, row.inputs)
        passage.rows.append(row)
        passage.frames.append(spare.frames())
        if row.time - passage.kept[-1].time >= self.log.every - ONE_STAMP:
            passage.kept.append(Checkpoint(row.time, spare.save()))
        passage.reached = row.time
        if len(passage.rows) == OBSERVED:
            passage.samples += self._samples_of(passage.rows, passage.frames)
            passage.rows, passage.frames = [], []
        return True

    def _take_over(self, passage: Passage) -> None:
        """Let the spare family take the place of the first, if it explains the window about as well."""
        h, p, spare = self.horizon, self._parameters, self.spare
        samples = self._means(passage.samples + self._samples_of(passage.rows, passage.frames))
        theta0 = h.theta0.copy()
        theta0[p] = spare.at
        # Before the last blow the free motions cannot have any phase.
        begin = max(passage.begin + passage.late + 1e-6, passage.reached - h.window - ONE_STAMP, h.since)
        samples = self._unmixed([one for one in samples if one.time >= begin])
        before = [one for one in h.samples if one.time >= begin]
        if not samples or self._is_wild_alone() or not self._better(samples, theta0, before):
            # From so far away no state can be extrapolated, neither with the differences nor without: then from rest.
            self.from_rest = self._plain and self._is_far(FAR_OFF)
            self._plain = not self._plain
            return
        self._plain = False
        h.drop_before(passage.begin)
        if spare.trust is not None:
            h.rough[:, p] = spare.rough
        self._pending = self._gathered
        h.replaced(samples, theta0)
        self.family, self.spare = spare, self.family
        self.log.checkpoints = passage.kept

    def _samples_of(self, rows: Sequence[Logged], frames: Sequence[np.ndarray]) -> list[Sample]:
        """Samples of rows that the spare family has gone through, of the frames that it left there."""
        if not rows:
            return []
        names = [*(one.name for one in self.plan.measured), *(self.operation.reads if self.operation else ())]
        all_read = dict(zip(names, self.spare.read_frames(np.array(frames), names), strict=True))
        found = []
        for k, row in enumerate(rows):
            read = {name: values[k] for name, values in all_read.items()}
            y0, J = self.compared(read, self.spare)
            use = row.use & self.alike(read)
            found.append(Sample(row.time, row.y, y0, J, use))
        return found

    def bounce(self) -> float:
        """Period of the free motion, s, as its derivative shows; 0 where there is none, or none is known yet."""
        samples = self.horizon.samples
        if self.blows and self._bounce == 0.0:
            self._bounce = first_bounce(self._first, self.blows[0])
        if self.blows and len(samples) >= 2 * FEWEST:
            J = np.array([one.J[:, len(self.plan.unknowns) :] for one in samples])
            turns = int(np.count_nonzero(np.diff(np.sign(J), axis=0), axis=0).max(initial=0))
            found = 2.0 * (samples[-1].time - samples[0].time) / turns if turns >= 2 else 0.0
            if found and abs(found - self._bounce) > SAME_BOUNCE * self._bounce:
                self._bounce = found
        return self._bounce

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

    def _is_wild_alone(self) -> bool:
        """Whether the window gone through anew has derivatives that cannot be believed, and those of before can be.

        A difference of simulations near a slip is none of a parameter. Free motions then explain any few readings.
        """
        new, old = self.spare.trust, self.family.trust
        return new is not None and bool(np.any((new < BELIEVED) & (old is None or old > BELIEVED)))

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
        last = list(h.samples)[-max(FEWEST, len(h.samples) // 4) :]
        J = np.array([one.J[:, p] for one in last])
        usual = np.array([np.median(past, axis=0) for past in self._slopes]) if self._slopes else np.abs(J[0])
        return np.any(np.median(np.abs(J), axis=0) > WILD * usual, axis=0)


def _as_unknown(blow: Blow) -> Unknown:
    """A free motion, in blows of the usual size."""
    name = f"free motion of {blow.output}"
    free = {"low": -np.inf, "high": np.inf, "drift": 0.0}
    return Unknown(name=name, target=blow.output, is_offset=False, unit="", start=0.0, sd=USUAL, **free)
