"""What drives the simulation: measured inputs, without jumps whatever the sensors do.

Where samples are missing a motion comes to rest. Where they come back, or begin elsewhere than the simulation stands,
the difference is made up for by a quintic: the simulation never jumps, and stands where the sensor says soon after.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from tautline.twin.map.plan import Channel
from tautline.twin.pace import ONE_STAMP
from tautline.twin.signals.row import Row
from tautline.twin.signals.smoothing import (
    REST,
    bend_of,
    coming_to_rest,
    joined,
    motion_at_end,
    noise_of,
    smooth,
    smooth_widely,
    third_of,
)
from tautline.twin.signals.steps import Steps

JOIN = 3.0
"""Shortest time in which a difference is made up for, s."""
BOUNCES = 5.0
"""And at least in so many periods in which a load bounces: so slowly that it does not bounce by that."""
INSTANTS = 51
"""Instants at which it is looked how far a way leads: the time of a join for rates is a few of them at the least."""
SPEED = 1.0
"""Speed at which a large difference is made up for where nothing faster was measured, SI."""
SAME = 1e-9
SLOW = 0.02
"""Speed over the fastest at which a motion may be joined at once."""
NOISES = 101
"""Samples of which the noise is the median."""
ENOUGH, UNKNOWN = 7, 4
"""Bends from which on they tell of the noise by themselves; and how many without noise count beside fewer of them.

A machine that sets off at once must not pass for noise: a change of speed that takes two intervals bends three times
three samples, which are the minority of seven."""
LEARNED = ("_noises", "_bends", "_thirds")
"""Names of what is known of the noise."""
FAR = 2.0
"""Delays from an instant within which samples are looked at."""
JUMP = 3.0
"""Speed from sample to sample, over the fastest seen, that is no motion but a break of the sensor."""
LIKE_NOISE = 0.4
"""Noise of fifth differences, over that of third ones, from which on it is noise and no motion."""
SHAKEN = 0.02
"""Second rate of a noise at the frequency of a bounce from which on it shakes a load, SI."""
SUDDEN = 10.0
"""Change of speed in the interval of two samples that a machine may begin with, m/s2 (of an angle rad/s2)."""
MOST_AT_ONCE = 4.0
"""Fastest that a machine may move when it is first seen, SI."""
LASTING, ALIKE = 4, 1.5
"""Intervals in a row, and how far their speeds may differ as a factor, from which on a motion is no break."""
DROPPED, ALIKE_SPEEDS = 2.0, 0.1
"""Time within which no drive goes to another speed and back, s, and the difference of the speeds before and after that,
over the way there, up to which it is back."""
GLITCH = 3
"""Samples that a sensor may be wrong by in a row, and how many times as far away as they are fast they are then."""
NOISE_APART = 8.0
"""Standard deviations of the noise that two samples may be apart by."""

LEADS = 0.1
"""Longest time constant with which what is set comes to rest where samples are missing, s: half of a pause of 0.2 s."""


class InputTrack:
    """One input: its state (value, rate, second rate) from row to row.

    Attributes
    ----------
    state : (3,)
        As given to the simulation at the last row.
    shown : (3,)
        As its sensor shows it there: the same, but for what is being made up for.
    missing : bool
        Whether there is no sample of it near.
    joining : bool
        Whether a difference is being made up for.
    bounce : float
        Period in which a load bounces on its rope, s; 0 as long as none is known.
    steps : Steps
        The step in which its sensor tells it.
    """

    MADE_ANEW = ("channel", "number")

    def __init__(self, channel: Channel, number: int) -> None:
        self.channel, self.number = channel, number
        self.state = self.shown = np.full(3, np.nan)
        self.time = np.nan
        self.missing = False
        self.fastest = SPEED
        self.bounce = 0.0
        self._apart, self._from, self._over, self._soon = np.zeros(3), -np.inf, 1.0, 1.0
        self._held, self._held_at = np.full(3, np.nan), np.nan
        self._noises: deque[float] = deque(maxlen=NOISES)
        self._bends: deque[float] = deque(maxlen=NOISES)
        self._thirds: deque[float] = deque(maxlen=NOISES)
        self.steps = Steps()
        self._rest = REST  # time constant with which it comes to rest
        self._break = np.nan
        self._seen, self.noise = 0.0, 0.0

    @property
    def joining(self) -> bool:
        """Whether a difference is being made up for."""
        return self.time < self._from + self._over

    @property
    def led(self) -> bool:
        """Whether it moves by something else than its sensor: on its way to rest, or back to what is measured."""
        return self.joining or (self.missing and abs(float(self.state[1])) > SLOW * self.fastest)

    @property
    def shakes(self) -> bool:
        """Whether its noise would make a load bounce: by its size, at the frequency of the bounce."""
        if self.stepped:
            return True
        if not self.bounce > 0.0 or not self.noise * (2.0 * np.pi / self.bounce) ** 2 > SHAKEN:
            return False
        if not self._noises:  # a noise that the map states, before any has been seen
            return False
        # A motion changes less from the third difference to the fifth; noise is the same in all of them.
        return _median(self._noises) > LIKE_NOISE * _median(self._thirds)

    @property
    def stepped(self) -> bool:
        """Whether the step in which it is told would make a load bounce."""
        return self.bounce > 0.0 and self.steps.noise * (2.0 * np.pi / self.bounce) ** 2 > SHAKEN

    def narrowest(self, widest: float, reach: float) -> float:
        """How narrowly noise may be smoothed, s: not at all where it is a step's.

        A step lets a fit be off by itself, at any width. A width that changes from row to row shakes the load.
        """
        return widest if self.stepped else reach

    def part(self, time: float) -> None:
        """Take notice that what was followed until a time is not believed: the input has to join its sensor anew."""
        self._break = time

    def begin(self, value: float, time: float) -> None:
        """Stand at rest at a value: where the simulation begins. Nothing is made up for any more."""
        self.missing, self._from = False, -np.inf
        self.state, self.time = np.array([value, 0.0, 0.0]), time

    def follow(
        self, rows: Sequence[Row], values: np.ndarray, row: Row, reach: float, widest: float = 0.0
    ) -> np.ndarray:
        """State (3,) at a row, from the samples around it.

        Parameters
        ----------
        reach : float
            How far away from the row samples are taken, s.
        widest : float
            The same of a sensor whose noise would shake the load, s.
        """
        times = np.array([one.time for one in rows])
        good = np.isfinite(values) & self._one_side(times, values, row.time)
        slope = _slope_to(times[good], values[good], row.time)
        good &= np.abs(times - row.time) <= max(FAR * reach, widest) + ONE_STAMP
        near = times[good & (np.abs(times - row.time) <= reach + ONE_STAMP)] - row.time
        # Nothing is extrapolated: there is a sample on either side, or at the instant itself.
        if near.size == 0 or near[0] > ONE_STAMP or near[-1] < -ONE_STAMP:
            if not self.missing:
                self._end(times[good], values[good], reach)
            return self.hold(row.time)
        self.look(values[good])
        found = None
        if self.shakes and widest > reach:
            narrowest = self.narrowest(widest, reach)
            found = smooth_widely(times[good], values[good], row.time, widest, narrowest, self.noise)
        if found is None:
            found = smooth(times[good], values[good], row.time, reach, self.noise)
        # Rows have come since, and none with a reading; or this is the first one for a while.
        if near[-1] <= ONE_STAMP and (self.missing or float(times[-1]) > row.time + ONE_STAMP):
            found = np.array([found[0], *motion_at_end(times[good], values[good], reach, self.noise)])
        if row.after_gap or self._break == row.time or self.missing:
            # What made do without samples went on until now: it has not stood since the row before.
            self._join(found, self.hold(row.time))
        self.missing, self.shown = False, found
        if row.time < self._from + self._over:
            found = found + self._left(row.time - self._from)
        else:
            # Where nothing is there but the sample itself its rate is not known, and what it has moved since the one
            # before tells.
            self._seen = max(self._seen, abs(float(found[1])) if near.size > 1 else slope)
            self.fastest = max(SPEED, self._seen)
        self.state, self.time = found, row.time
        return found

    def _one_side(self, times: np.ndarray, values: np.ndarray, at: float) -> np.ndarray:
        """Samples (n,) that no break parts from an instant; no motion is as fast as a sensor that jumps.

        A speed may be set as quickly as a machine likes: a rotary table turns at full speed one or two rows later.
        """
        if self.channel.is_set:
            return _without_dropouts(times, values)
        keep = np.ones(len(values), bool)
        finite = np.flatnonzero(np.isfinite(values))
        # Rows that come close together: a stamp may be off by as much as they are apart, and a last digit is no speed.
        passed = np.maximum(np.diff(times[finite]), float(np.median(np.diff(times))) if times.size > 2 else 1e-9)
        speeds = np.abs(np.diff(values[finite])) / passed
        # Before rows have shown how an input moves it may begin with any usual speed.
        known = len(self._bends) >= ENOUGH and times.size > 1
        floor = min(SPEED, SUDDEN * float(np.median(np.diff(times)))) if known else SPEED
        spread = NOISE_APART * self.noise / passed
        lasts = _lasting(np.diff(values[finite]) / passed)
        for i in np.flatnonzero(speeds > JUMP * max(self._seen, floor) + spread):
            if lasts[i] and (self.joining or self._seen == 0.0) and speeds[i] <= MOST_AT_ONCE:
                # It was on its way before the first row, or while it was being joined. What is followed does not set
                # off like this: a sensor whose mean is taken over some rows leaps as a ramp.
                self._seen = max(self._seen, float(speeds[i]))
                continue
            cut = times[finite[i + 1]]
            keep &= (times < cut) == (at < cut)
            if at == cut:
                self._break = at
        return keep

    def look(self, values: np.ndarray) -> None:
        """See how much noise samples (n,) have, the newest last."""
        # Where most steps are alike no difference shows them.
        self.noise = max(self._noise(values), self.steps.noise)

    def _noise(self, values: np.ndarray) -> float:
        """Standard deviation of the sensor: as the map says, or as the samples show.

        Motion enters both estimates: a wave that of three samples, and a change of speed that of six, for as many rows.
        """
        # At the first row all samples that are there tell, and later each that is new.
        for end in range(values.size if self._noises else min(values.size, 6), values.size + 1):
            self._noises.append(noise_of(values[:end]))
            self._thirds.append(third_of(values[:end]))
        for end in range(values.size if self._bends else min(values.size, 3), values.size + 1):
            self._bends.append(bend_of(values[:end]))
        unknown = UNKNOWN * [0.0] if len(self._bends) < ENOUGH else []
        found = min(_median(self._noises), _median([*self._bends, *unknown])) / 0.6745
        return found if not np.isfinite(self.channel.sd) else max(found, self.channel.sd)

    def _end(self, times: np.ndarray, values: np.ndarray, reach: float) -> None:
        """Take up what is known of the motion behind the last of samples (n,): none has come since.

        A place comes to rest as a machine does. A speed that is set stays: it leads on by no more than it has changed
        between its last two readings, and much less where these are far apart, for what was set next nobody knows.
        """
        past = times <= self.time + ONE_STAMP
        t, x = times[past], values[past]
        if t.size == 0 or t[-1] < self.time - ONE_STAMP:  # what it has shown since then is not believed any more
            return
        left = self.state - self.shown if self.joining else np.zeros(3)
        self.state = np.array([self.state[0], *(motion_at_end(t, x, reach, self.noise) + left[1:])])
        self._rest = min(LEADS, 0.5 * float(t[-1] - t[-2])) if self.channel.is_set and t.size > 1 else REST

    def hold(self, time: float) -> np.ndarray:
        """State (3,) where there is no sample: what moves comes to rest."""
        if not self.missing:
            self.missing, self._held, self._held_at = True, self.state, self.time
        self.state, self.time = coming_to_rest(self._held, time - self._held_at, self._rest), time
        return self.state

    def _join(self, found: np.ndarray, held: np.ndarray) -> None:
        """Begin to make up for the difference between where the simulation stands (3,) and what is measured (3,)."""
        self._apart = held - found
        self._from = self.time
        slowly = max(JOIN, BOUNCES * self.bounce)
        far = 0.0 if self.channel.is_set else 1.875 * abs(float(self._apart[0])) / self.fastest
        self._over, self._soon = max(slowly, far), slowly
        if slowly < self._over:
            split, self._soon = self._beyond(), self._over
            if split < self._beyond():
                self._soon = slowly

    def _beyond(self) -> float:
        """How far what is left of a difference leads beyond both of its places."""
        left = [float(self._left(passed)[0]) for passed in np.linspace(0.0, self._over, INSTANTS)]
        place = float(self._apart[0])
        return max(max(left) - max(0.0, place), min(0.0, place) - min(left))

    def _left(self, passed: float) -> np.ndarray:
        """What is left of a difference (3,) a time after it began to be made up for.

        Its rates may go as soon as a motion comes to rest by itself: kept up over the time that a large difference of
        place takes, those of a leap at speed would lead metres beyond both places. What swings has rates that lead
        back, and there one quintic goes less far.
        """
        if self._soon >= self._over:
            return joined(self._apart, passed / self._over, self._over)
        place, rates = self._apart * [1.0, 0.0, 0.0], self._apart * [0.0, 1.0, 1.0]
        return joined(place, passed / self._over, self._over) + joined(rates, passed / self._soon, self._soon)

    @property
    def seen(self) -> np.ndarray:
        """State (3,) that its sensor shows now; the place that it has shown last, at rest, where it shows nothing."""
        shown = self.shown if np.isfinite(self.shown).all() else self.state
        return shown * [1.0, 0.0, 0.0] if self.missing else shown.copy()

    def join_from_rest(self, shown: np.ndarray) -> None:
        """Begin to take up the motion that its sensor shows (3,) from where the simulation stands.

        It stays behind the machine until it has caught up, and never is where the machine was not.
        """
        self.shown = shown
        self._join(shown, self.state)

    def joining_from_rest(self, found: np.ndarray, run_in: float) -> float:
        """How long the simulation runs before the first row, s: nothing where it stands where the sensor says."""
        apart = found - self.state
        small = SAME + 1e-6 * max(1.0, abs(float(found[0])))
        if abs(apart[0]) < small and abs(apart[1]) < SLOW * self.fastest:
            return 0.0
        return max(run_in, 1.875 * abs(float(apart[0])) / self.fastest)

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        state = ("state", "time", "missing", "fastest", "_seen", "noise")
        names = (*state, "_apart", "_from", "_over", "_soon", "shown", "_held", "_held_at", "_rest", *LEARNED)
        return {name: np.asarray(getattr(self, name)).tolist() for name in names} | {"steps": self.steps.memory()}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self._soon = float(memory.get("_over", self._soon))  # states of earlier versions know one time only
        for name, value in memory.items():
            if name == "steps":
                self.steps.recall(value)
                continue
            if name in LEARNED:
                setattr(self, name, deque(value, maxlen=NOISES))
                continue
            setattr(self, name, np.array(value, float) if isinstance(value, list) else value)


def _median(values: Collection[float]) -> float:
    """The median of some finite numbers; of so few plain floats are four times as quick as an array."""
    ordered, half = sorted(values), len(values) // 2
    return ordered[half] if len(values) % 2 else 0.5 * (ordered[half - 1] + ordered[half])


def _without_dropouts(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Which samples (n,) of a speed count: all but those that are away from both neighbours, which are alike.

    One by itself may be anything; a few are left out only where they are far faster than both.
    """
    keep = np.ones(len(values), bool)
    finite = np.flatnonzero(np.isfinite(values))
    x, t = values[finite], times[finite]
    for count in range(1, GLITCH + 1):
        for first in range(1, x.size - count):
            one, other, between = x[first - 1], x[first + count], x[first : first + count]
            away = min(float(np.min(np.abs(between - one))), float(np.min(np.abs(between - other))))
            if not abs(one - other) < ALIKE_SPEEDS * away:
                continue
            single = count == 1 and t[first + 1] - t[first - 1] <= DROPPED + ONE_STAMP
            if single or away > GLITCH * max(abs(one), abs(other)) > 0.0:
                keep[finite[first : first + count]] = False
    return keep


def _lasting(speeds: np.ndarray) -> np.ndarray:
    """Which of the speeds (n,) from sample to sample go on: a sensor that jumps does so once, or back again."""
    lasts = np.zeros(len(speeds), bool)
    if len(speeds) < LASTING:
        return lasts
    rows = sliding_window_view(speeds, LASTING)
    sizes = np.abs(rows)
    one_way = np.all(rows > 0.0, axis=1) | np.all(rows < 0.0, axis=1)
    alike = one_way & (sizes.max(axis=1) <= ALIKE * sizes.min(axis=1))
    for k in range(LASTING):
        lasts[k : k + alike.size] |= alike
    return lasts


def _slope_to(times: np.ndarray, values: np.ndarray, at: float) -> float:
    """Speed from the sample before to that of an instant, of samples (n,) in order; 0 where one is missing."""
    k = int(np.searchsorted(times, at - ONE_STAMP))
    if k == 0 or k == times.size or times[k] > at + ONE_STAMP:
        return 0.0
    return abs(float(values[k] - values[k - 1])) / max(float(times[k] - times[k - 1]), 1e-9)
