"""What the sensors say at a row: values in SI as far as they can be believed, and states of the inputs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

import numpy as np

from tautline.errors import ArgumentError
from tautline.scene.values.printed import quantity
from tautline.twin.map.plan import Channel, Plan
from tautline.twin.pace import ONE_STAMP
from tautline.twin.signals.inputs import SLOW, InputTrack
from tautline.twin.signals.knocks import knocked
from tautline.twin.signals.row import Row
from tautline.twin.signals.rows import LONGEST_DELAY, Rows
from tautline.twin.signals.sensors import Health
from tautline.twin.signals.smoothing import smooth, smooth_widely
from tautline.twin.signals.spacing import ALIKE, DELAY, MOST_WAITED
from tautline.twin.signals.waves import Waves

SMOOTHED = 2.0
"""Periods of the bounce, before a row and after it, that noisy inputs are smoothed over."""
OFTEN = 1.5
"""Sample intervals between readings of an input that comes as often as rows, at most."""
STILL = ("stuck", "clipped")
"""Faults of a sensor that shows one value for a while."""
JUMPED = "with a reading that jumped away and back"
"""Kind of rows that are counted so."""


class Readings:
    """Sensors of a plan: their rows, their health, and the motion of the inputs that they show.

    Parameters
    ----------
    plan : Plan
        Whose channels are read.
    start : mapping
        Input -> its value at the start of the scene.
    live : bool
        Whether data arrive while they are measured.

    Attributes
    ----------
    zeros : dict
        Number of a channel with ``zero: first`` -> the reading that counts as zero.
    far : dict
        Input -> where it began, SI, so far from the scene's start that they hardly count from the same place.
    stepped : set of int
        Numbers of the channels that were seen to be told in steps.
    step_found : bool
        Whether at the last row an input was first seen to be told in steps.
    rare : dict
        Number of an input that rows do not wait for -> how often it comes, in words.
    rare_told : set of int
        Numbers of the inputs of which it was said how often they come.
    """

    def __init__(self, plan: Plan, start: Mapping[str, float], live: bool) -> None:
        self.channels, self.run_in, self.start = plan.channels, plan.run_in, start
        self.rows = Rows([one.column for one in plan.channels], plan.delay, live)
        self.rows.scales = np.array([abs(one.scale) for one in plan.channels])
        self.rows.bounds = [one.shown for one in plan.channels]
        self.health = [Health(one) for one in plan.channels]
        self.tracks = [InputTrack(one, i) for i, one in enumerate(plan.channels) if one.is_input]
        self.rows.spacing.inputs = [one.number for one in self.tracks]
        self.rare: dict[int, str] = {}
        self.rare_told: set[int] = set()
        self.waves = {one.name: Waves() for one in plan.inputs if one.waves}
        self.zeros: dict[int, float] = {}
        self.far: dict[str, float] = {}
        self._old_zeros: dict[int, float] = {}
        self._remarks: list[str] = []
        self.stepped: set[int] = set()
        self.step_found = False

    @property
    def columns(self) -> list[str]:
        """Columns of the sensors, in the order of the map."""
        return [one.column for one in self.channels]

    def by_column(self, values: Mapping[str, Any] | Sequence[float] | np.ndarray) -> dict[str, float]:
        """Readings of a row by column."""
        if not isinstance(values, Mapping):
            given = list(np.ravel(values))
            if len(given) != len(self.columns):
                columns = ", ".join(self.columns)
                raise ArgumentError(f"a row has {len(given)} readings. The map has {len(self.columns)}: {columns}")
            values = dict(zip(self.columns, given, strict=True))
        found = {}
        for name in self.columns:
            reading = values.get(name)
            try:
                found[name] = np.nan if reading is None else float(reading)
            except (TypeError, ValueError):
                raise ArgumentError(f"the reading of {name} is {reading!r}, and that is no number") from None
        return found

    def checked(self, row: Row) -> np.ndarray:
        """Values in SI (c,), NaN where a sensor cannot be believed."""
        if row.begins:  # what was shown long ago is not where the machine stands
            self._old_zeros, self.zeros = self.zeros, {}
            self.far.clear()
        values = np.full(len(self.channels), np.nan)
        coming = list(takewhile(lambda one: not one.after_gap, self.rows.waiting))
        stamps = [one.time for one in coming]
        for i, (channel, health) in enumerate(zip(self.channels, self.health, strict=True)):
            reading = row.values[i]
            if channel.zero_first and i not in self.zeros and np.isfinite(reading):
                self.zeros[i] = float(reading)
                self._tell_zero(channel, i)
            zero = self.zeros.get(i, 0.0) if channel.zero_first else channel.zero
            start = self.start.get(channel.name, 0.0) if channel.zero_first else 0.0
            following = [channel.scale * (one.values[i] - zero) + start for one in coming]
            before = health.fault
            values[i] = health.check(row.time, channel.scale * (reading - zero) + start, following, stamps)
            if np.isfinite(health.left_out):
                self.rows.counts[JUMPED] += 1
            if channel.is_input and health.fault in STILL and before not in STILL:
                # What it showed since it stands was believed until now.
                for one in self.rows.past:
                    if one.time > health.still_since:
                        one.values[i] = np.nan
                for track in self.tracks:
                    if track.number == i:
                        track.part(row.time)
        row.values = values
        return values

    def _tell_zero(self, channel: Channel, i: int) -> None:
        """Say from what a sensor counts now, where it has counted from an old reading before."""
        if i in self._old_zeros:
            now, before = (channel.told(channel.scale * zero) for zero in (self.zeros[i], self._old_zeros.pop(i)))
            counts = f"{channel.column} counts from {now} now (before: from {before})"
            self._remarks.append(f"the first rows were old when they came: {counts}")

    def take_back(self, time: float, computed: Mapping[str, float]) -> None:
        """Call readings no jumps where what is computed, SI by name, jumps as well.

        They stay out of the estimate: how large a snap is at an instant hangs on when it came.
        """
        for channel, health in zip(self.channels, self.health, strict=True):
            if channel.is_output and health.explained(time, computed[channel.name]):
                self.rows.counts[JUMPED] -= 1
                self.rows.counts += Counter()  # what is counted no more is not told

    def named(self, values: np.ndarray) -> dict[str, float]:
        """Values (c,) by the names of their channels."""
        return {one.name: float(v) for one, v in zip(self.channels, values, strict=True)}

    def measured(self, values: np.ndarray) -> np.ndarray:
        """Of values (c,) those of the outputs (m,)."""
        return np.array([values[i] for i, one in enumerate(self.channels) if one.is_output])

    def believed(self, values: np.ndarray) -> np.ndarray:
        """Which of the outputs (m,) have a value, of a sensor without a fault."""
        use = [
            np.isfinite(values[i]) and self.health[i].fault == ""
            for i, channel in enumerate(self.channels) if channel.is_output
        ]  # fmt: skip
        return np.array(use, bool)

    @property
    def made_up(self) -> bool:
        """Whether an input is not measured now, or is on its way back to what is."""
        return any(track.missing or track.joining for track in self.tracks)

    @property
    def led(self) -> bool:
        """Whether an input moves by something else than its sensor."""
        # A machine may set another speed at once.
        return any(track.led and (track.missing or self.health[track.number].is_place) for track in self.tracks)

    @property
    def shown(self) -> dict[str, np.ndarray]:
        """Inputs that are on their way back to their sensors -> the states (3,) that these show."""
        return {track.channel.name: track.shown for track in self.tracks if track.joining and not track.missing}

    @property
    def blind(self) -> bool:
        """Whether an input that the machine's driver moves is not measured now."""
        return any(track.missing and not track.channel.waves for track in self.tracks)

    def remarks(self) -> list[str]:
        """Sentences on what the first readings show, each of them given once."""
        said, self._remarks = self._remarks, []
        return said

    # -- inputs --------------------------------------------------------------------------------------------------------

    def inputs(self, row: Row, begun: bool, bounce: float = 0.0) -> list[tuple[str, np.ndarray]]:
        """Inputs and their states (3,) at a row.

        Parameters
        ----------
        begun : bool
            Whether the simulations stand where the data are, so that a motion has to go on from where it was.
        bounce : float
            Period in which a load bounces on its rope, s; 0 as long as none is known.
        """
        around = self.rows.around(row)
        # A sensor is not smoothed over more as another one comes more rarely.
        widest = self.rows.smoothed if self.rows.delay is None else self.rows.delay
        # Where no sample is waited for, those of the past alone tell of a rate.
        few = self.rows.delay is None or widest < self.rows.interval
        reach = DELAY * self.rows.interval if few else widest
        if not np.isfinite(reach):
            reach = self.rows.interval if np.isfinite(self.rows.interval) else 1.0
        found = []
        self._look_for_rare()
        self.step_found = False
        for track in self.tracks:
            track.bounce = bounce
            if not np.isfinite(track.state).all() and begun:
                track.begin(self.start[track.channel.name], row.time)
            values = np.array([self._in_si(one, track.number) for one in around])
            if self.health[track.number].is_place:
                values = self._without_knocks(np.array([one.time for one in around]), values, row, track.number)
                values = self._without_stops(np.array([one.time for one in around]), values, self.health[track.number])
                self._look_for_steps(track, np.array([one.time for one in around]), values)
            own = max(reach, self._waited(track.number))
            if begun:
                state = track.follow(around, values, row, own, max(own, widest))
            else:
                state = self._first_state(track, around, values, row, own)
            found.append((track.channel.name, state))
            if track.channel.name in self.waves:
                # What is held too: a run ahead begins where the simulation stands, or its first step is a jump.
                self.waves[track.channel.name].add(row.time, state, track.missing)
        self.rows.wanted = SMOOTHED * bounce if self.shaken else 0.0
        return found

    def _waited(self, i: int) -> float:
        """How long rows wait for an input as it comes more rarely than they do, s; 0 where they do not.

        Of one that has stopped they waited so long: its readings of then have rows between them still.
        """
        wait = self.rows.spacing.wait(i, self.rows.interval)
        return wait if self.rows.delay is None and wait <= MOST_WAITED else 0.0

    def _look_for_rare(self) -> None:
        """See which inputs come so rarely that rows do not wait for their next readings; say once what rows do."""
        rows = self.rows
        self.rare.clear()
        for i in rows.spacing.inputs:
            column, regular = self.channels[i].column, rows.spacing.is_regular(i)
            every = rows.spacing.of(i) if regular else rows.spacing.longest(i)
            # Each row has a reading where inputs come as often as rows.
            often = every <= OFTEN * rows.interval
            if often or rows.spacing.has_stopped(i) or not (np.isfinite(rows.interval) and np.isfinite(rows.patience)):
                continue
            comes = (
                f"{column} comes every {every:.2g} s"
                if regular
                else f"{column} comes with pauses of up to {every:.2g} s"
            )
            too_soon = rows.patience < every - ONE_STAMP
            if too_soon:
                self.rare[i] = f"{comes}, and rows wait {rows.patience:.2g} s only"
            if i in self.rare_told or not rows.spacing.is_told(i) or not (too_soon or self._waited(i)):
                continue
            self.rare_told.add(i)
            longer = np.ceil(10.0 * (DELAY if regular else ALIKE) * every - ONE_STAMP) / 10.0
            cure = (
                f"Write `delay: {longer:.1f} s` in the map" if longer <= LONGEST_DELAY else "Let it be sent more often"
            )
            if too_soon:
                text = f"rows are answered after {rows.patience:.2g} s, before its next reading is there. {cure}"
            else:
                text = (
                    f"while it does so, rows are answered after {rows.patience:.2g} s. "
                    "Write `delay` in the map for another time"
                )
            self._remarks.append(f"{comes}: {text}")

    def _look_for_steps(self, track: InputTrack, times: np.ndarray, values: np.ndarray) -> None:
        """See whether a place is told in steps, and say so once."""
        seen = np.isfinite(values)
        track.steps.look(times[seen], values[seen])
        if track.stepped and track.number not in self.stepped:
            self.stepped.add(track.number)
            self.step_found = True
            step = track.channel.told(track.steps.step)
            later = ""
            if self.rows.delay is None:
                waits = SMOOTHED * track.bounce, DELAY * self.rows.interval
                later = f", so results come later ({waits[0]:.2g} s instead of {waits[1]:.2g} s)" * (
                    waits[0] > waits[1]
                )
            told = f"The sensor {track.channel.column} changes in steps of {step}."
            self._remarks.append(f"{told} It is smoothed like a noisy sensor{later}.")

    @property
    def shaken(self) -> bool:
        """Whether an input is so noisy that a load would bounce by that."""
        return any(track.shakes for track in self.tracks)

    def _in_si(self, row: Row, i: int) -> float:
        """A value of a row that is still to come, as `checked` will have it."""
        if row.time <= self.rows.reached:
            return row.values[i]
        channel = self.channels[i]
        zero = self.zeros.get(i, row.values[i]) if channel.zero_first else channel.zero
        start = self.start.get(channel.name, 0.0) if channel.zero_first else 0.0
        value = channel.scale * (row.values[i] - zero) + start
        health = self.health[i]
        repeated = health.repeats(value)
        return value if channel.low <= value <= channel.high and not repeated else np.nan

    def _without_knocks(self, times: np.ndarray, values: np.ndarray, row: Row, i: int) -> np.ndarray:
        """Values (n,) without those to come that their sensor was knocked away by.

        Of the last no row behind it tells; it is not looked at where another one does, for until then it may be one.
        """
        sure, doubtful = knocked(times, values, self.health[i].unseen_bend)
        coming = times > self.rows.reached
        values = np.where(sure & coming, np.nan, values)
        others = np.isfinite(values) & ~doubtful
        if others[times >= row.time - ONE_STAMP].any() and others[times <= row.time + ONE_STAMP].any():
            values = np.where(doubtful & coming, np.nan, values)
        return values

    def _without_stops(self, times: np.ndarray, values: np.ndarray, health: Health) -> np.ndarray:
        """Values (n,) without those to come that stand still more abruptly than the motion ever changed."""
        values = values.copy()
        still, last = health.stands, health.last
        for k in range(2, len(values)):
            if times[k] <= self.rows.reached:
                continue
            if still:
                still = bool(values[k] == last)
            else:
                last = values[k - 1]
                still = bool(
                    values[k] == last != 0.0 and health.stops(values[k - 1] - values[k - 2], times[k] - times[k - 1])
                )
            if still:
                values[k] = np.nan
        return values

    def _first_state(
        self, track: InputTrack, around: Sequence[Row], values: np.ndarray, row: Row, reach: float
    ) -> np.ndarray:
        good = np.isfinite(values)
        times = np.array([one.time for one in around])
        if not good.any():
            # The last place that it has shown is where the machine was; the scene's start may be far from there.
            known = self._moves(track) and np.isfinite(track.shown).all() and not track.channel.zero_first
            return np.array([track.shown[0] if known else self.start[track.channel.name], 0.0, 0.0])
        found = None
        if track.bounce > 0.0:
            track.look(values[good])
        if track.shakes:
            widest = SMOOTHED * track.bounce
            narrowest = track.narrowest(widest, reach)
            found = smooth_widely(times[good], values[good], row.time, widest, narrowest, track.noise)
        return smooth(times[good], values[good], row.time, reach) if found is None else found

    def begin(self, row: Row, inputs: Sequence[tuple[str, np.ndarray]], anywhere: bool, first: bool = True) -> float:
        """Let motions begin at a row; gives how long the simulations need to come to them from rest, s.

        Parameters
        ----------
        anywhere : bool
            Whether positions with ``zero: first`` count from where the machine stands.
        first : bool
            Whether the data begin here; where the simulation is begun again the machine has been moved meanwhile.
        """
        run_in = 0.0
        for track, (name, state) in zip(self.tracks, inputs, strict=True):
            track.begin(self.start[name], row.time)
            begun_far = abs(float(state[0]) - self.start[name]) * 1.875 > track.fastest * self.run_in
            place = self.health[track.number].is_place and not track.channel.zero_first and not anywhere
            if first and begun_far and place and name not in self.far:
                self.far[name] = float(state[0])
                self._remarks.append(_far_said(track.channel, float(state[0]), self.start[name]))
            if anywhere and track.channel.zero_first:
                self._count_anew(track, state)
            run_in = max(run_in, track.joining_from_rest(state, self.run_in))
        for track, (_, state) in zip(self.tracks, inputs, strict=True):
            track.state = track.shown = state
            track.time = row.time
        return run_in

    @property
    def seen(self) -> list[tuple[str, np.ndarray]]:
        """Inputs and the states (3,) that their sensors show now, or have shown last: nothing that was made up."""
        return [(track.channel.name, track.seen) for track in self.tracks]

    @property
    def placing(self) -> list[str]:
        """Columns that say where the machine stands: those that begin far from the scene, or else all of them."""
        places = [track.channel for track in self.tracks if self._moves(track)]
        return [one.column for one in places if one.name in self.far] or [one.column for one in places]

    def resting(self, inputs: Sequence[tuple[str, np.ndarray]]) -> list[tuple[str, np.ndarray]]:
        """The same inputs at rest where they are; a speed or a torque that is set stays as it is."""
        both = zip(self.tracks, inputs, strict=True)
        return [(name, np.array([s[0], 0.0, 0.0]) if self._moves(track) else s.copy()) for track, (name, s) in both]

    def join_from_rest(self, inputs: Sequence[tuple[str, np.ndarray]]) -> None:
        """Let places join the motion that sensors show from where they stand at rest."""
        for track, (_, state) in zip(self.tracks, inputs, strict=True):
            if self._moves(track):
                track.join_from_rest(state)

    def _moves(self, track: InputTrack) -> bool:
        return self.health[track.number].is_place

    def _count_anew(self, track: InputTrack, state: np.ndarray) -> None:
        """Let a position count from where the machine begins anew: it takes up its speed on the way there.

        A block that has fetched a stand is elsewhere than it was. Where its motion is under way already, the simulation
        begins so much before that it reaches the speed by a steady acceleration.
        """
        small = abs(state[1]) < SLOW * track.fastest
        wanted = self.start[track.channel.name] + (0.0 if small else 0.5 * state[1] * self.run_in)
        off = wanted - state[0]
        state[:] = wanted, 0.0 if small else state[1], 0.0
        i = track.number
        self.zeros[i] = self.zeros.get(i, 0.0) - off / track.channel.scale
        for row in self.rows.past:
            row.values[i] += off
        self.health[i].count_anew(off)


def _far_said(channel: Channel, begins: float, start: float) -> str:
    """A sensor and its scene that begin at different places, in words, and what to do."""
    there, here = quantity(begins, channel.unit), quantity(start, channel.unit)
    return (
        f"{channel.column} begins at {there}; the scene begins at {here}: write `zero: first` where the machine stands "
        f"as in the scene, or give its `zero`, or the scene's start. Until then health is degraded at best"
    )
