"""The watch: which alarms of a plan hold at a row, and what is said of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from tautline.scene.values.printed import Teller, in_words, quantity, shown
from tautline.twin.alarms import CLEAR, NOT_KNOWN, Alarms, beyond, bound_said
from tautline.twin.forecast import Found, extreme
from tautline.twin.map.plan import Alarm, Plan
from tautline.twin.operation import Operation
from tautline.twin.signals.sensors import EDGE, Health

TOLD = {
    "TWO_BLOCKED": "two-blocking ahead", "RUN_OUT": "drum empty ahead", "DRUM_FULL": "drum full ahead",
    "OFF_WHEEL": "rope off its sheave ahead", "SLACK_ON_WHEEL": "slack rope on a sheave ahead",
}  # fmt: skip
"""Names of alarms where the simulation cannot go on."""
BY_PLACE = ("TWO_BLOCKED", "RUN_OUT", "DRUM_FULL")
"""Those that come by where a winch is, even while a load bounces as the machine's does not."""
FAULTS = ("lost", "stuck", "clipped", "out of range", "unit")
"""Faults of a sensor, each with an alarm of its own: ``COLUMN lost``."""
SIGNS = ("jumping", "drifting", "far off")
"""And what else is judged of a sensor."""
CATCHING_UP = "catching up"
"""Name of the alarm that what is computed is not judged."""
NOT_AHEAD = "cannot look ahead"
"""Name of the alarm that nothing is foreseen: the simulation stops on the way ahead, and not because of what the
machine does, an input that the driver moves is not measured, or the computer has no time."""
SURE = 2.0
"""Standard deviations by which a computed value is beyond its bound for sure."""
FAR_OFF = 10.0
"""Standard deviations by which a residual is beyond its bound for sure, even where what is computed is in doubt."""
UNSEEN = 1.0
"""For how long an input that the driver moves is not measured before that is told as `NOT_AHEAD`, s."""
BEHIND = "behind the machine"
"""Name of the alarm that rows wait for their answers."""
STOPPED = "simulation stopped"
"""Name of the alarm that the simulation was begun again, or could not be."""
WHY_OFF = "zero and unit of the sensor, or the scene's weights, are not right, and no estimate makes up for it"
"""Cause of a residual of dozens of standard deviations that stays."""
CHANGED, SHOWN = "changed", 30.0
"""Name of the alarm that the machine is no longer what it was, and for how long it is shown, s."""


class Watched(NamedTuple):
    """What an alarm is about, whatever its name: an output or its residual, and its bounds; None for a side of none."""

    target: str
    is_residual: bool
    above: float | None
    below: float | None

    @classmethod
    def by(cls, one: Alarm) -> Watched:
        """What an alarm of a plan is about."""
        above, below = (float(bound) if np.isfinite(bound) else None for bound in (one.above, one.below))
        return cls(one.target, one.is_residual, above, below)

    def is_as(self, other: Watched) -> bool:
        """Whether two are about one thing: what is beyond the bound of one may be beyond that of the other."""
        return self.off(other) < np.inf

    def off(self, other: Watched) -> float:
        """How far the bounds of two are from one another; infinite where they are about two things."""
        if (self.target, self.is_residual) != (other.target, other.is_residual):
            return np.inf
        sides = ((self.above, other.above), (self.below, other.below))
        return min((abs(a - b) for a, b in sides if a is not None and b is not None), default=np.inf)


@dataclass(frozen=True)
class Compared:
    """A row, and what is known there.

    Attributes
    ----------
    values : (c,)
        Of all channels.
    outputs : mapping
        Name -> value at the estimate, and standard deviation.
    residual, residual_sd, use : (m,)
        Measured less expected, its standard deviation, and which of them count.
    correlation : (m,)
        How many rows of a sensor count as one.
    converged : bool
        Whether the estimate is known: it is a guess no more. Before that only what its deviation does not reach is
        told.
    ahead : Found or None
        What will come, if that was found lately.
    moved : mapping
        Output -> by how much it is more than at the estimate that `ahead` was begun with.
    changed : float
        How long ago the last readings contradicted all others, s; infinite where they have not.
    judged_from : float
        Time from which on what is computed, or foreseen, is judged, s; infinite while inputs are caught up with.
    led_until : float
        Time until which an input did not go as its sensor says, s.
    blind : bool
        Whether an input that the machine's driver moves is not measured.
    late : bool
        Whether the computer has no time to look ahead.
    unsure : bool
        Whether what is computed is in doubt, and health is degraded by that: nothing foreseen is certain then.
    put_down : bool
        Whether every load stands on the ground, on a slack rope, in all simulations.
    lost : str
        Why no simulation goes on, in words; empty where one does.
    far : bool
        Whether the estimate has left what was simulated: nothing that is computed is judged until that has followed.
    suspect : str
        What else may not be as in the scene, beside friction, contact and rope path; empty for nothing.
    """

    time: float
    values: np.ndarray
    outputs: Mapping[str, Any]
    residual: np.ndarray
    residual_sd: np.ndarray
    use: np.ndarray
    correlation: np.ndarray
    converged: bool
    ahead: Found | None
    changed: float = np.inf
    judged_from: float = -np.inf
    led_until: float = -np.inf
    blind: bool = False
    late: bool = False
    moved: Mapping[str, Any] = field(default_factory=dict)
    unsure: bool = False
    put_down: bool = False
    lost: str = ""
    far: bool = False
    suspect: str = ""

    @property
    def foreseen(self) -> Found | None:
        """What will come, of a run ahead that began where the machine is."""
        ahead = self.ahead
        return ahead if ahead is not None and ahead.begun >= self.judged_from else None

    def tells(self, value: float, sd: float, bound: Alarm) -> bool:
        """Whether it tells something that what is computed is beyond a bound: that of a guess does where it is sure."""
        guess_is_sure = np.isfinite(sd) and not self.unsure and surely_beyond(value, sd, bound)
        return not self.far and (self.converged or bool(guess_is_sure))

    def off(self, size: float, sd: float, bound: Alarm) -> bool:
        """Whether it tells something that a residual is beyond a bound: also one in doubt does that is far beyond it.

        What makes the computed value doubtful may be just what the residual shows.
        """
        followed = not self.far and self.time >= self.judged_from
        return self.tells(size, sd, bound) or bool(
            followed and np.isfinite(sd) and surely_beyond(size, sd, bound, FAR_OFF)
        )


def surely_beyond(value: float, sd: float, bound: Alarm, by: float = SURE) -> bool:
    """Whether a computed value is beyond a bound by so many standard deviations; by itself, where none is known."""
    off = by * sd if np.isfinite(sd) else 0.0
    return value - off > bound.above or value + off < bound.below


def surely_within(value: float, sd: float, bound: Alarm) -> bool:
    """Whether a computed value is within a bound by `SURE` standard deviations; by itself, where none is known."""
    off = SURE * sd if np.isfinite(sd) else 0.0
    return bound.below <= value - off and value + off <= bound.above


def no_reading(sensor: Health) -> str:
    """Why a sensor does not show what a bound is about."""
    if sensor.fault:
        return sensor.text
    if np.isfinite(sensor.left_out):
        return f"{sensor.channel.column} shows {sensor.channel.told(sensor.left_out)} now, which is not believed yet"
    return f"{sensor.channel.column} shows nothing now"


def largest_known(sd: Any) -> float:
    """The largest standard deviation of all places of an output, whichever of them the bound is about; or NaN."""
    known = np.abs(np.ravel(sd))
    known = known[np.isfinite(known)]
    return float(known.max()) if known.size else np.nan


class Watch:
    """Judges the alarms of a plan, of its sensors and of the application, row by row.

    Parameters
    ----------
    plan : Plan
    health : sequence of Health
        Of all channels (c,).
    operation : Operation or None
    system : str
        The scene's ``units``, in which values are told; those of a sensor are in the unit of its column.
    """

    def __init__(self, plan: Plan, health: Sequence[Health], operation: Operation | None, system: str = "si") -> None:
        self.system = system
        self.plan, self.health, self.operation = plan, health, operation
        self.alarms = Alarms()
        self._told_ahead: set[str] = set()
        # By alarm: what a sensor has shown beyond the bound, and whether what is computed ever was so too.
        self._seen: dict[str, tuple[str, bool]] = {}
        # Alarms of which what is computed was beyond the bound before it began again from rest.
        self._seen_before_rest: set[str] = set()
        self._down_from = np.inf
        self._irregular: dict[str, str] = {}
        self._before = -np.inf

    def judge(self, row: Compared) -> None:
        """Judge all alarms."""
        measured = {one.name: row.values[i] for i, one in enumerate(self.plan.channels) if one.is_output}
        sensors = {one.channel.name: one for one in self.health if one.channel.is_output}
        order = [one.name for one in self.plan.measured]
        self._follow_again(row)
        for one in self.plan.alarms:
            sensor = sensors.get(one.shown_by)
            if one.is_residual and sensor is not None:
                self._judge_residual(one, row, order.index(one.shown_by), measured[one.shown_by], sensor)
            else:
                self._judge_output(one, row, sensor, measured.get(one.shown_by, np.nan))
        self.judge_sensors(row.time, row.correlation, row.converged)
        self._judge_ahead(row)
        self.judge_operation(row.time)
        text = "the last readings contradict those before: friction, weight or path is another now, and estimated anew"
        self.alarms.judge(CHANGED, row.changed < SHOWN, row.time, text)
        self.alarms.judge(STOPPED, bool(row.lost), row.time, row.lost)
        text = "an input was made up for a while: only what is measured is judged until what is computed agrees"
        self.alarms.judge(CATCHING_UP, row.time < row.judged_from, row.time, text)
        self._before = row.time

    def names(self) -> list[str]:
        """All alarms that can come: of the map, of sensors, of the twin itself, of the application."""
        of_sensors = [f"{one.channel.column} {kind}" for one in self.health for kind in (*FAULTS, *SIGNS)]
        own = [*TOLD.values(), NOT_AHEAD, CATCHING_UP, CHANGED, STOPPED, BEHIND]
        of_work = [name for name, *_ in self.operation.alarms()] if self.operation else []
        return list(dict.fromkeys([*(one.name for one in self.plan.alarms), *of_sensors, *own, *of_work]))

    def watched(self) -> dict[str, Watched]:
        """What each alarm of the plan is about, by name."""
        return {one.name: Watched.by(one) for one in self.plan.alarms}

    def go_on_from(self, before: Mapping[str, Watched]) -> list[str]:
        """Put what was recalled of the alarms of another plan to those of this one; gives what is said of the others.

        An alarm under another name goes on: a new name shows nothing of whether it is over. One that this plan does not
        watch any more ends: nothing would ever judge it.

        Parameters
        ----------
        before : mapping
            `watched` of the other plan.
        """
        now = self.watched()
        gone = [name for name, one in before.items() if name not in now or not one.is_as(now[name])]
        ended = {name: active.text for name in gone if (active := self.alarms.active.get(name)) is not None}
        since = {name: self.alarms.active[name].since for name in ended}
        held = {name: self._taken(name) for name in gone}
        free = [name for name in now if name in gone or name not in before]
        pairs = [(before[one].off(now[name]), one, name) for one in gone for name in free]
        # One goes on as one: what is active first, and with the bound that is nearest.
        for off, source, name in sorted(pairs, key=lambda pair: (pair[1] not in since, pair[0])):
            if off < np.inf and source in held and name in free:
                self._given(name, *held.pop(source))
                free.remove(name)
                ended.pop(source, None)
        why = "is not watched any more by this map; it was active since"
        return [f"{name} {why} {since[name]:.10g} s: {text}" for name, text in ended.items()]

    def _taken(self, name: str) -> tuple[list[Any], list[bool]]:
        """All that is held of an alarm, which is forgotten."""
        told = [name in one for one in self._told_of()]
        for one in self._told_of():
            one.discard(name)
        return [one.pop(name, None) for one in self._by_name()], told

    def _given(self, name: str, values: Sequence[Any], told: Sequence[bool]) -> None:
        """Hold of an alarm what `_taken` gave of another."""
        for one, value in zip(self._by_name(), values, strict=True):
            if value is not None:
                one[name] = value
        for names, holds in zip(self._told_of(), told, strict=True):
            names |= {name} if holds else set()

    def _by_name(self) -> tuple[dict[str, Any], ...]:
        return *self.alarms.by_name(), self._seen, self._irregular

    def _told_of(self) -> tuple[set[str], set[str]]:
        return self._told_ahead, self._seen_before_rest

    def stopped(self, time: float, text: str) -> None:
        """Take notice that the simulation was begun again."""
        self.alarms.judge(STOPPED, True, time, text)

    def begun_again(self) -> None:
        """Take notice that what is computed begins again from rest: it has followed nothing of what sensors showed."""
        self._seen_before_rest |= {name for name, (_, followed) in self._seen.items() if followed}
        self._seen = {name: (text, False) for name, (text, _) in self._seen.items()}
        self._down_from = np.inf  # of simulations that are no more

    def _follow_again(self, row: Compared) -> None:
        """Follow whether what is computed is as the machine is again, whatever it has missed since it was at rest.

        What it misses is how the load bounced then. A load that has stood on the ground, on a slack rope, for `CLEAR`
        has no more of that; one that touches it in the trough of a wave still has. The load itself is in the estimate
        where what is computed was beyond the bound before.
        """
        if not (row.put_down and row.converged and row.time >= row.judged_from and not row.unsure):
            self._down_from = np.inf
            return
        self._down_from = min(self._down_from, row.time)
        if row.time - self._down_from < CLEAR * (1.0 - EDGE):
            return
        for name in self._seen_before_rest & self._seen.keys():
            self._seen[name] = self._seen[name][0], True
        self._seen_before_rest.clear()

    def _judge_residual(self, one: Alarm, row: Compared, m: int, measured: float, sensor: Health) -> None:
        r, sd = row.residual[m], row.residual_sd[m]
        if not sensor.believed and one.name in self._irregular:
            self._judge_irregular_unseen(one, row.time, sensor)
            return
        # As a multiple of its deviation it has one of 1.
        size, off = (abs(r) / sd, 1.0) if one.times_sd else (r, sd)
        known = bool(np.isfinite(r) and row.use[m] and row.off(size, off, one))
        holds = known and beyond(size, one.above, one.below)
        tell = self._teller(one)
        text = f"{one.asked} is measured {tell(measured)}, expected {tell(measured - r)}" if known else ""
        others = f"{row.suspect}, " * bool(row.suspect) + "friction, contact or rope path"
        text += f" (standard deviation {tell(sd)}): {others} are not as in the scene"
        self._irregular.pop(one.name, None)
        if holds:
            self._irregular[one.name] = text
        self.alarms.judge(one.name, holds, row.time, text, one.lasting, forgotten_after=sensor.forgotten_after)

    def _judge_irregular_unseen(self, one: Alarm, time: float, sensor: Health) -> None:
        """Judge a residual that was beyond its bound: without a reading nothing shows whether that is over."""
        if one.name not in self.alarms.active and (sensor.fault or not sensor.is_recent(time)):
            return  # as of `_judge_unseen`
        text, known = self._irregular[one.name], sensor.fault == "" and sensor.is_awaited(time)
        told = text if known else f"{NOT_KNOWN}: {text}. {no_reading(sensor)}"
        self.alarms.judge(one.name, True, time, told, one.lasting, known, sensor.seen, sensor.forgotten_after)

    def _judge_output(self, one: Alarm, row: Compared, sensor: Health | None, measured: float) -> None:
        computed = row.outputs.get(one.target)
        known = computed is not None and not row.far and row.time >= row.judged_from
        value = extreme(computed[0], one) if known and computed is not None else np.nan
        sd = largest_known(computed[1]) if computed is not None else np.nan
        # A peak that lasts one reading says nothing of the machine, but may be true: bounds see what is left out.
        if sensor is not None and not np.isfinite(measured):
            measured = sensor.side(row.time)
        seen, computed_too = (bool(np.isfinite(v) and beyond(v, one.above, one.below)) for v in (measured, value))
        computed_too &= row.tells(value, sd, one)
        if sensor is not None:
            within = known and row.converged and not row.unsure and surely_within(value, sd, one)
            self._follow_seen(one, sensor, measured if seen else np.nan, computed_too, within)
        ahead = self._coming(one, row, sd) if known and not (seen or computed_too) else None
        against = ahead is not None and sensor is not None and self._speaks_against(row, sensor)
        if seen and sensor is not None:
            said = self._said_measured(one, sensor, computed_too and surely_beyond(value, sd, one))
        elif computed_too:
            believed = sensor is not None and sensor.fault == ""
            said = self._said_computed(one, value, sd, measured if believed else np.nan)
        elif ahead is not None:
            said = self._said_coming(one, row, sd, ahead, measured if against else np.nan)
        else:
            self._judge_unseen(one, row, sensor)
            return
        (self._told_ahead.add if ahead is not None else self._told_ahead.discard)(one.name)
        read = sensor.seen if seen and sensor is not None and not computed_too else np.inf
        forgotten_after = sensor.forgotten_after if sensor is not None else np.inf
        if sensor is not None and not seen:
            # What is computed is known at each row: rows within the bound lie between.
            forgotten_after = max(CLEAR, sensor.patience, row.time - self._before) * (1.0 + EDGE)
        # A doubt of all that is computed, or of where the estimate is, is none that the next row may end.
        flutters = ahead is None or bool(np.isfinite(ahead[3]) and not row.unsure and not against)
        # Nor is that of a sensor which has shown it, and shows nothing now or is not believed.
        shows = sensor is not None and sensor.fault == "" and bool(np.isfinite(measured))
        flutters &= one.name not in self._seen or shows
        self.alarms.judge(one.name, True, row.time, said[0], one.lasting, said[1], read, forgotten_after, flutters)

    def _judge_unseen(self, one: Alarm, row: Compared, sensor: Health | None) -> None:
        """Judge a bound that nothing shows to be passed now: what was seen is over only where something shows that."""
        if row.late and one.name in self._told_ahead:
            text = f"{NOT_KNOWN}: this was foreseen, and the computer has no time to look again"
            self.alarms.judge(one.name, True, row.time, text, one.lasting, False)
            return
        self._told_ahead.discard(one.name)
        if sensor is None or one.name not in self._seen:
            self.alarms.judge(one.name, False, row.time, "", one.lasting)
        elif one.name in self.alarms.active:
            said = self._said_silent(one, row.time, sensor)
            self.alarms.judge(one.name, True, row.time, said[0], one.lasting, said[1])
        # Else what has not lasted yet waits: silence raises nothing, nor does it let the time of the bound begin anew.
        # A sensor that is silent now and then, before that time is over, would never raise its alarm otherwise. Behind
        # a silence longer than `Health.forgotten_after` it does begin anew.

    def _follow_seen(self, one: Alarm, sensor: Health, measured: float, computed_too: bool, within: bool) -> None:
        """Follow whether the last that a sensor has shown is beyond a bound.

        Parameters
        ----------
        measured : float
            The reading of now, SI, that is beyond the bound; else NaN.
        computed_too : bool
            Whether what is computed is beyond it as well.
        within : bool
            Whether what is computed is within it for sure. That shows nothing where it never followed what the sensor
            has shown: such as of a load that was picked up as its cell broke.
        """
        text, followed = self._seen.get(one.name, ("", False))
        if np.isfinite(measured):
            text = f"{one.asked} measured: {bound_said(measured, one.above, one.below, self._teller(one))}"
        elif not text or sensor.believed or (within and followed):
            self._seen.pop(one.name, None)
            self._seen_before_rest.discard(one.name)
            return
        self._seen[one.name] = text, followed or computed_too

    def _said_measured(self, one: Alarm, sensor: Health, computed_too: bool) -> tuple[str, bool]:
        """What is said of a reading beyond a bound, and whether that is certain.

        A reading that is not believed, such as one beyond the range, goes on with what was certain before it. By itself
        it may be that of a broken wire.
        """
        text, active = self._seen[one.name][0], self.alarms.active.get(one.name)
        if sensor.fault == "":
            return text, True
        certain = computed_too or (active is not None and active.known)
        ending = "" if sensor.text.endswith("?") else "."
        return f"{text}. {sensor.text}" + f"{ending} That is not certain" * (not certain), certain

    def _said_silent(self, one: Alarm, time: float, sensor: Health) -> tuple[str, bool]:
        """What is said of a bound that was passed, of whose sensor nothing shows now whether that is over; and whether
        it is certain: in a silence that is usual for the sensor the last reading holds."""
        last = sensor.last_side(time)
        if np.isfinite(last) and beyond(last, one.above, one.below):
            return self._said_measured(one, sensor, False)
        return f"{NOT_KNOWN}: {self._seen[one.name][0]}. {no_reading(sensor)}", False

    def _said_computed(self, one: Alarm, value: float, sd: float, measured: float) -> tuple[str, bool]:
        """What is said of a computed value beyond a bound, and whether that is certain beside what is measured."""
        text = f"{one.asked} computed: {bound_said(value, one.above, one.below, self._teller(one))}"
        certain, doubt = surely_beyond(value, sd, one), "The standard deviation"
        if certain and np.isfinite(measured):
            certain, doubt, sd = False, "What is measured", measured
        return text + self._doubt(one, doubt, sd) * (not certain), certain

    def _said_coming(
        self, one: Alarm, row: Compared, sd: float, coming: tuple[float, float, float, float], against: float
    ) -> tuple[str, bool]:
        """What is said of a bound that will be passed, and whether that is certain: not where a reading is against it.

        NaN is none.
        """
        left, value, worst, away = coming
        text = f"{one.asked} in {left:.1f} s: {bound_said(value, one.above, one.below, self._teller(one))}"
        if away != 0.0:
            sd = float(np.hypot(sd, away)) if np.isfinite(sd) else away
        # A load that bounces in the simulation alone would be a danger by far more than its deviation.
        certain = bool(np.isfinite(away)) and surely_beyond(worst, sd, one) and not row.unsure
        if certain and np.isfinite(against):
            return text + self._doubt(one, "What is measured now", against), False
        doubt = self._doubt(one, "The standard deviation", sd) + ", and what is computed is in doubt" * row.unsure
        return text + doubt * (not certain), certain

    def _speaks_against(self, row: Compared, sensor: Health) -> bool:
        """Whether a sensor shows that a guess is wrong, and by that what it foresees: by more than its deviation."""
        m = [one.name for one in self.plan.measured].index(sensor.channel.name)
        off, sd = abs(row.residual[m]), row.residual_sd[m]
        return not row.converged and sensor.believed and bool(off > SURE * sd)

    def _doubt(self, one: Alarm, doubt: str, value: float) -> str:
        return f". That is not certain. {doubt} is {self._teller(one)(value) if np.isfinite(value) else 'not known'}"

    def _coming(self, one: Alarm, row: Compared, sd: float) -> tuple[float, float, float, float] | None:
        """How long ahead a bound is passed, s, the value there, the worst one, and how far the estimate has moved away.

        That is by how much outputs are farther from beyond the bound now, at the place where it is most; NaN where that
        is not known. What was to come before the last row has come, or has not: that row shows it. A run ahead that was
        begun with a guess says nothing of what would not be passed at the estimate of now, at any place.
        """
        ahead = row.foreseen
        coming = ahead.coming(one.name, self._before) if ahead is not None else []
        if ahead is None or not coming:
            return None
        at, value = coming[0]
        worst = max((other for _, other in coming), key=lambda other: max(other - one.above, one.below - other))
        side = 1.0 if worst > one.above else -1.0
        toward = side * np.ravel(row.moved.get(one.target, 0.0))
        if not ahead.known and not np.isnan(toward).any():
            if not beyond(worst + side * float(toward.max()), one.above, one.below):
                return None
        away = float(np.maximum(-toward.min(), 0.0))
        if not row.tells(worst, float(np.hypot(sd, away)), one):
            return None
        return max(0.0, at - row.time), value, worst, away

    def judge_sensors(self, time: float, correlation: np.ndarray, converged: bool) -> None:
        """Judge what is wrong with sensors."""
        numbers = [i for i, one in enumerate(self.plan.channels) if one.is_output]
        contradicted = self.contradicted()
        for i, health in enumerate(self.health):
            column = health.channel.column
            for kind in FAULTS:
                self.alarms.judge(f"{column} {kind}", health.fault == kind, time, health.text)
            self.alarms.judge(f"{column} jumping", health.jumping(time), time, health.jump)
            if i in numbers:
                alike = float(correlation[numbers.index(i)])
                off = health.channel.told(health.mean_residual)
                text = f"{column} is off by {off} on average lately: the sensor, the weight or friction drifts"
                self.alarms.judge(f"{column} drifting", health.drifting(alike) and converged, time, text)
                side = "above" if health.off > 0.0 else "below"
                text = f"{column} stays dozens of standard deviations {side} what is expected: {WHY_OFF}"
                self._judge_far(health, contradicted.get(health.channel.name), text, time)
            elif not health.channel.is_input:
                self._judge_far(health, contradicted.get(health.channel.name), "", time)

    def _judge_far(self, health: Health, against: str | None, text: str, time: float) -> None:
        """Judge whether a sensor stays far off what is expected, or the application finds what speaks against it."""
        holds = against is not None or health.contradicts
        self.alarms.judge(f"{health.channel.column} far off", holds, time, against or text)

    def contradicted(self) -> dict[str, str]:
        """Outputs whose sensors the application finds to be wrong, and why."""
        found = self.operation.contradicted() if self.operation is not None else {}
        return {name: in_words(text, self.system) for name, text in found.items()}

    def judge_backlog(self, time: float, seconds: float, behind: bool, held_up: bool = False) -> None:
        """Judge whether rows wait so long for their answers that these are of a time gone by."""
        why = (
            "the twin has begun late, or was held up, and catches up"
            if held_up
            else "rows wait, as this computer does not keep up"
        )
        text = f"what is shown is {seconds:.1f} s behind the machine: {why}"
        self.alarms.judge(BEHIND, behind, time, text)

    def judge_operation(self, time: float) -> None:
        """Judge what the application warns of."""
        for name, holds, text, lasting in self.operation.alarms() if self.operation else ():
            self.alarms.judge(name, holds, time, in_words(text, self.system), lasting)

    def _teller(self, one: Alarm) -> Teller:
        """How values of an alarm are said: in the unit of the sensor that measures it, or of the scene."""
        channel = next((c for c in self.plan.measured if c.name == one.shown_by and c.column_unit), None)
        return channel.told if channel is not None else lambda x, digits=4: said(x, one.unit, self.system, digits)

    def _judge_ahead(self, row: Compared) -> None:
        """Where the simulation ahead cannot go on, such as with two blocks together."""
        ahead = row.ahead
        stopped = ahead.stopped if ahead is not None else None
        if stopped is not None and not self._believes(row, stopped[1]):
            stopped = None
        unknown = row.blind or row.late or row.time <= row.led_until
        why = "the computer has no time to look again" if row.late else "an input is not followed now"
        for status, name in TOLD.items():
            holds = stopped is not None and stopped[1] == status
            left = max(0.0, ahead.begun + stopped[0] - row.time) if holds and ahead and stopped else 0.0
            what = name.removesuffix(" ahead")
            text, known = f"in {left:.1f} s, if the inputs go on as now", True
            if not holds and unknown and name in self.alarms.active:
                # Where nothing shows where the machine goes, a danger that was seen is not over.
                holds, known = True, False
                text = f"{NOT_KNOWN}: {what} was foreseen, and {why}"
            self.alarms.judge(name, holds, row.time, text, known=known)
        cut = stopped is not None and stopped[1] not in TOLD
        text, lasting = "an input that the driver moves is not measured: nothing shows where the machine goes", UNSEEN
        if stopped is not None and cut:
            why, lasting = stopped[1].lower().replace("_", " "), 0.0
            text = f"the simulation stops {stopped[0]:.2g} s ahead ({why}): what comes after that is not foreseen"
        elif row.late and not row.blind:
            text = (
                "the last look ahead is too old: the computer has no time for another. Dangers ahead are not seen now"
            )
            lasting = 0.0
        self.alarms.judge(NOT_AHEAD, cut or row.blind or row.late, row.time, text, lasting)

    def _believes(self, row: Compared, status: str) -> bool:
        """Whether a stop ahead is one of the machine: by its place also while that is caught up with."""
        # Nor does it wait for an estimate: a load that is not known hangs at the same place.
        found = row.foreseen if row.converged else None
        return status in BY_PLACE or (found is not None and found.begun > row.led_until)


def said(value: float, unit: str, system: str = "si", digits: int = 4) -> str:
    """A quantity in words, in the units of a system."""
    return quantity(float(value), unit, digits) if system == "si" else shown(float(value), unit, system, digits)
