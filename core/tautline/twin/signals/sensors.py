"""Whether a sensor can be believed: lost, stuck, clipped, outside its range, in another unit, drifting, jumping.

A value that does not change is no fault by itself: a winch that stands has none. It is one where the sensor has noise,
so that its values always change, or where the motion stopped more abruptly than it ever changed before.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tautline.scene.values.moments import stamp_said
from tautline.scene.values.printed import digits_apart
from tautline.twin.alarms import CLEAR
from tautline.twin.map.plan import Channel
from tautline.twin.pace import ONE_STAMP
from tautline.twin.signals.knocks import is_knock
from tautline.twin.signals.smoothing import FIFTH

SAME = 5
"""Values that are exactly alike from which on a sensor may be stuck."""
SHORTEST = 0.4
"""Over how long they have to be so at least, s."""
STILL = 1.5
"""How long a motion in waves may be exactly still, s."""
HISTORY = 400
"""Values that are looked back on."""
NOISY = 0.1
"""Noise, over the usual change from value to value, from which on values change at random."""
ROUNDING = 1e-9
"""Noise, over the largest value seen, that is rounding."""
SET_ROUNDING = 1e-3
"""The same of what a machine is set to: it may ripple before it stands at its set point."""
ENOUGH = 40
"""Values after which that is judged."""
GAP = 4.0
"""Time since the last value, over that before it, that is a gap."""
ABRUPT = 4.0
"""Change of the step from value to value, over the largest seen, that no motion makes."""
UNSEEN = 2.0
"""The same of a place that is back on its way in the next rows, by which it is no beginning of a motion."""
LEAP = 4.0
"""Speed from value to value, SI, from which on a place that moves `ABRUPT` times as far as ever has been set by no
machine. If it stands there, such as at the zero of a wire that has come off, its sensor is stuck."""
BRAKED = 2.0
"""Change of speed in an interval that a machine stops with, m/s2; between rows that come slowly any may stop."""
EDGE = 1e-6
TEN = (8.0, 12.5)
"""Ratio of measured and computed value that looks like a slip of a unit by 10."""
THOUSAND = (800.0, 1250.0)
DRIFT_TIME = 20.0
"""Time constant of the mean residual, s."""
FAR = 3.0
"""Residuals beyond count as this many standard deviations: a knock is no drift."""
DRIFTING = 5.0
"""Standard deviations of the mean residual from which on a sensor drifts."""
OFF_TIME = 10.0
"""Time constant of the mean that tells whether sensor and simulation contradict each other, s."""
DOZENS, WORST = 24.0, 100.0
"""Standard deviations of that mean from which on they do; and those that a residual counts as at most."""
AWAY, BACK = 2, 3.0
"""Readings after one that jumped among which one is back; and how much nearer that is to the one before."""
AWAY_TIME = 0.5
"""From the reading before a jump to the one that is back at most, s: a machine may swing out and back in longer."""
AS_MUCH = 0.5
"""Share of a jump from which on a change of what is computed is as large: then the machine did it."""
DIGITS = 4.0
"""Last digits of a sensor that is coarser than its `sd` that its readings may go away and back by."""
USUAL, SHARE = 4.0, 0.9
"""Changes from reading to reading, of which so many are smaller, that a jump is beyond."""
RECENT = 40
"""Readings of which those are the changes, and whose intervals are the usual ones."""
FLOOR, TINY = 0.1, 1e-6
"""Share of the largest value seen, and a value in SI, that a deviation is a share of at least."""
JUMPING = 10.0
"""For how long a jump is told, s."""
LONGEST_PASSED = 1.0
"""Time that a residual counts for at most, s: what was between it and the one before is not known."""
BETWEEN = 2.5
"""Usual intervals of a sensor for which its last reading stands, `CLEAR` at least: rows of faster sensors come between
two of its own, and single readings may be missing."""
OFTEN, LATELY = 3, 60.0
"""Silences longer than `CLEAR`, as between packets of a radio, and the last seconds in which so many make one usual."""
LONGER, LONGEST = 1.25, 10.0
"""What a silence may last to be one of the usual ones, over the third longest of them; and at most, s: no reading is
known to hold for longer, for a machine does much in that time."""
SPEAKING = ("clipped", "out of range", "unit")
"""Faults of which the reading is wrong, but says on which side of a bound the machine may be."""


class Health:
    """What is known of one sensor.

    Attributes
    ----------
    fault : str
        lost, stuck, clipped, out of range, unit, or empty.
    jumps : int
        Readings that jumped away from those before and after: they are left out.
    left_out : float
        The last reading, SI, where it was one of them; else NaN.
    shown : float
        The last reading, SI, whether it can be believed or not; NaN before there is any.
    believed : bool
        Whether there was a reading at the last row, without a fault; one that jumped is none.
    """

    MADE_ANEW = ("channel",)

    def __init__(self, channel: Channel) -> None:
        self.channel = channel
        self.fault, self.text = "", ""
        self.seen = np.nan
        self.begun = np.nan
        self.shown, self.believed = np.nan, False
        self._intervals: deque[float] = deque(maxlen=RECENT)
        self._silences: deque[tuple[float, float]] = deque()  # of `LATELY`: begin, and how long
        self._values: deque[float] = deque(maxlen=HISTORY)
        self._changes: deque[float] = deque(maxlen=HISTORY)
        self._same, self._same_from, self._abrupt, self._stopped = 1, np.nan, False, False
        self._last, self._last_at, self._step, self._took = np.nan, np.nan, np.nan, np.nan
        self._leapt, self._furthest = False, 0.0
        self._until, self.sd = -np.inf, 0.0
        self._ten = 0
        self.mean, self.weight = 0.0, 0.0
        self._residual, self._known = 0.0, 0.0
        self.off, self.contradicts = 0.0, False
        self._off_for, self._off_at = 0.0, np.nan
        self._before, self._passed, self._largest = np.nan, np.nan, 0.0
        self.jumps, self.left_out, self._jumped, self.jump = 0, np.nan, -np.inf, ""
        self._jumps_before = self.jumps, self._jumped, self.jump
        self._computed: deque[tuple[float, float]] = deque()

    def check(
        self, time: float, reading: float, following: Sequence[float] = (), stamps: Sequence[float] = ()
    ) -> float:
        """The value in SI, NaN where it is not to be used.

        Parameters
        ----------
        reading : float
            In SI already; NaN where there is none.
        following : sequence of float
            Readings that come after it, as far as they are known.
        stamps : sequence of float
            Their times, s; without them they come as fast as the last did.
        """
        value = self._checked(time, reading, following, stamps)
        self.believed = bool(np.isfinite(value)) and self.fault == ""
        return value

    def _checked(self, time: float, reading: float, following: Sequence[float], stamps: Sequence[float]) -> float:
        """The same, as the fault that it finds is kept."""
        self.left_out = np.nan
        if not np.isfinite(self.begun):
            self.begun = time
        if not np.isfinite(reading):
            since = self.seen if np.isfinite(self.seen) else self.begun
            if time - since >= self.channel.lost_after - ONE_STAMP:
                self._set("lost", f"no value of {self.channel.column} since {stamp_said(since)}")
            return np.nan
        passed, self.seen, self.shown = time - self.seen, time, reading
        if np.isfinite(passed):
            self._spoken(time, passed)
        if passed > GAP * self._passed:
            # What was before a gap tells nothing of a motion that stops.
            self._last = self._step = np.nan
        self._passed = passed
        if self.fault == "lost":
            self._set("", "")
        low, high = self.channel.low, self.channel.high
        width = EDGE * (high - low) if np.isfinite(high - low) else 0.0
        if reading < low - width or reading > high + width:
            allowed = f"{self.channel.told(low)} to {self.channel.told(high)}"
            text = f"{self.channel.column} shows {self.channel.told(reading)}, outside its range of {allowed}"
            self._set("out of range", text)
            return np.nan
        if self.fault == "out of range":
            self._set("", "")
        coming = stamps or [time + (k + 1) * passed for k in range(AWAY)]
        way = self._knocked(time, reading, following, coming) if self.is_place else np.nan
        if np.isfinite(way) or self._jumps_away(reading, following, coming):
            self._jumps_before = self.jumps, self._jumped, self.jump
            self.jumps, self.left_out, self._jumped = self.jumps + 1, reading, time
            digits = digits_apart(self._last, reading)
            told = f"from {self.channel.told(self._last, digits)} to {self.channel.told(reading, digits)} and back"
            self.jump = f"{self.channel.column} jumped {told} at {stamp_said(time)}; left out so far: {self.jumps}"
            if np.isfinite(way):
                self._last, self._last_at = way, time  # where it was on its way to: the next reading goes on from there
            return np.nan
        return self._repeated(time, reading, low, high, width)

    def _spoken(self, time: float, passed: float) -> None:
        """Take notice that a reading came, so long after the one before it, s."""
        self._intervals.append(passed)
        if passed > CLEAR:
            self._silences.append((time - passed, passed))
        while self._silences and self._silences[0][0] < time - LATELY:
            self._silences.popleft()

    def is_recent(self, time: float) -> bool:
        """Whether the last reading is of a time, s, or the next one is not missed yet: of a slower sensor, or one of
        which single readings are missing."""
        passed = time - self.seen
        if passed <= CLEAR * (1.0 + EDGE) or not self._intervals:
            return bool(passed <= CLEAR * (1.0 + EDGE))
        # One short interval, or a gap, changes nothing of what is usual.
        return bool(passed <= BETWEEN * np.median(self._intervals) * (1.0 + EDGE))

    def is_awaited(self, time: float) -> bool:
        """Whether a sensor that shows nothing at a time, s, is silent as it often is: its next reading is to come.

        Of readings that come in bursts the median interval tells only how fast those of one burst are, and so does any
        other share of them: the more readings a burst has, the smaller is the share of the silences.
        """
        if self.is_recent(time):
            return True
        silences = sorted((long for _, long in self._silences), reverse=True)
        if len(silences) < OFTEN:
            return False
        return bool(time - self.seen <= min(LONGER * silences[OFTEN - 1], LONGEST))

    @property
    def forgotten_after(self) -> float:
        """For how long it may be silent for what it shows then to go on with what it showed before, s."""
        return max(LONGEST, self.channel.lost_after, self.patience) * (1.0 + EDGE)

    @property
    def patience(self) -> float:
        """Time to the next reading that is nothing unusual, s."""
        return BETWEEN * float(np.median(self._intervals)) if self._intervals else 0.0

    def side(self, time: float) -> float:
        """The reading, SI, that tells on which side of a bound the machine is at a time, s; NaN where none does.

        It need not be one that is believed: what is beyond the range of its sensor is still above or below a bound.
        """
        return self._telling() if self.is_recent(time) else np.nan

    def last_side(self, time: float) -> float:
        """The same of a sensor that is silent as it often is: nothing tells that it would show another side now."""
        return self._telling() if self.is_awaited(time) else np.nan

    def _telling(self) -> float:
        """The last reading, SI; NaN where its fault is one by which it tells nothing."""
        return self.shown if self.fault == "" or self.fault in SPEAKING else np.nan

    def jumping(self, time: float) -> bool:
        """Whether a reading jumped away and back lately."""
        return time - self._jumped < JUMPING

    def _jumps_away(self, reading: float, following: Sequence[float], stamps: Sequence[float]) -> bool:
        """Whether a reading is dozens of standard deviations off the one before it, and the next are not.

        All of it takes no longer than `AWAY_TIME`, so at two readings a second and slower nothing jumps. Of a place
        that drives the scene `_knocked` tells. Where no motion is as fast, it and a speed break, which is seen to
        elsewhere.
        """
        if self.channel.is_input or not np.isfinite(self._last):
            return False
        jump = abs(reading - self._last)
        until = self._last_at + AWAY_TIME * (1.0 + EDGE)
        known = [(one, at) for one, at in zip(following, stamps, strict=False) if np.isfinite(one)][:AWAY]
        if not any(abs(one - self._last) < jump / BACK and at <= until for one, at in known):
            return False
        recent = np.array(self._values)[-RECENT:]
        if recent.size < SAME:
            return False
        # What swings from reading to reading is no jump, however little noise the sensor has.
        if jump <= USUAL * np.quantile(np.abs(np.diff(recent)), SHARE):
            return False
        # A share of nothing is nothing: what a sensor shows that stands at zero is rounding.
        size = max(np.max(np.abs(recent)), FLOOR * self._largest, TINY)
        sd, digit = self.channel.sd * (size if self.channel.relative else 1.0), self._digit()
        if not np.isfinite(sd):
            sd = max(np.median(np.abs(np.diff(recent, 2))) / 1.65, digit)
            # What never changed tells nothing of what a change is.
            return bool(sd > 0.0 and jump > max(DOZENS * sd, TINY))
        return bool(jump > max(DOZENS * sd, DIGITS * digit, TINY))

    @property
    def unseen_bend(self) -> float:
        """Change of a place from one interval to the next, SI, that its motion never came near; infinite till known."""
        # While it stands its readings count; what never changed tells nothing of what a change is.
        if len(self._values) < ENOUGH or len(self._changes) < SAME:
            return np.inf
        return max(UNSEEN * max(self._changes), DIGITS * self._digit())

    def _knocked(self, time: float, reading: float, following: Sequence[float], stamps: Sequence[float]) -> float:
        """Where a place was on its way to, SI, where its reading was knocked away from there; else NaN."""
        speed = 0.0 if self._same > 1 else self._step / self._took
        if not np.isfinite(speed):
            return np.nan
        known = [(at, one) for one, at in zip(following, stamps, strict=False) if np.isfinite(one)]
        if not is_knock((self._last_at, self._last), speed, time, reading, known, self.unseen_bend):
            return np.nan
        return float(self._last + speed * (time - self._last_at))

    def explained(self, time: float, computed: float) -> bool:
        """Whether the reading that was just left out is what the machine does, for what is computed jumps as well.

        Loads that snap again and again come so. To be called for every reading, with what is computed then, SI.
        """
        while self._computed and self._computed[0][0] < time - AWAY_TIME * (1.0 + EDGE):
            self._computed.popleft()
        self._computed.append((time, computed))
        if not np.isfinite(self.left_out):
            return False
        jump = self.left_out - self._last
        lately = np.sign(jump) * np.array([one for _, one in self._computed])
        if not np.max(lately - np.minimum.accumulate(lately)) >= AS_MUCH * abs(jump):
            return False
        self.jumps, self._jumped, self.jump = self._jumps_before
        return True

    def _digit(self) -> float:
        """The smallest difference of readings so far: the last digit of a sensor that shows round numbers; else 0."""
        steps = np.diff(np.unique(self._values))
        steps = steps[steps > ROUNDING * self._largest]
        return float(steps.min()) if steps.size else 0.0

    def repeats(self, reading: float) -> bool:
        """Whether a reading to come, in SI, is the one that a sensor is stuck or clipped at."""
        return self.fault in ("stuck", "clipped") and reading == self._last

    def _repeated(self, time: float, reading: float, low: float, high: float, width: float) -> float:
        """Judge values that are exactly alike."""
        same = reading == self._last
        if same:
            self._same += 1
        else:
            step = reading - self._last
            self._leap(step)
            if np.isfinite(step) and np.isfinite(self._step) and self._same == 1:
                self._changes.append(abs(step - self._step))
            self._same, self._same_from, self._step, self._took = 1, time, step, time - self._last_at
            if self.fault in ("stuck", "out of range") or (self.fault == "clipped" and time >= self._until):
                self._set("", "")
        if same and self._same == 2:
            # A speed may be held from one sample to the next; a place may not.
            self._abrupt = not self.channel.is_set and self._is_abrupt(self._step)
            self._stopped = self.stops(self._step, self._passed)
        self._values.append(reading)
        self._last, self._last_at, self._largest = reading, time, max(self._largest, abs(reading))
        long = self._same >= SAME and time - self._same_from >= SHORTEST
        # A slack rope, or a string that stands, shows zero for as long as it likes; a depth of the hole is no motion.
        still = reading == 0.0 and not self._leapt
        if not long or still or not (self.channel.is_input or self.channel.is_output):
            return reading if self.fault != "clipped" and not self.stands else np.nan
        at_edge = np.isfinite(width) and width > 0.0 and (reading <= low + width or reading >= high - width)
        # A ship never stands still to the last digit.
        ship = self.channel.waves and time - self._same_from >= STILL and np.ptp(self._values) > 0.0
        if not (at_edge or self._abrupt or self._leapt or ship or self._has_noise()):
            return reading
        extreme = reading >= max(self._values) or reading <= min(self._values)
        cut = extreme and len(self._values) >= ENOUGH and not self.channel.is_set and not self._leapt
        kind = "clipped" if at_edge or cut else "stuck"
        since = stamp_said(self._same_from)
        self._set(kind, f"{self.channel.column} has shown {self.channel.told(reading)} since {since}")
        return np.nan

    @property
    def is_place(self) -> bool:
        """Whether it drives the simulation, and is no speed or torque that a machine is set to."""
        return self.channel.is_input and not self.channel.is_set

    @property
    def last(self) -> float:
        """The last reading, in SI."""
        return self._last

    @property
    def still_since(self) -> float:
        """Since when it has shown the same, s."""
        return self._same_from

    @property
    def stands(self) -> bool:
        """Whether a place has stopped as no motion does: it is stuck, or will be seen not to be."""
        stopped = self._leapt or (self._stopped and self._last != 0.0)
        return self.is_place and stopped and self._same >= 2

    def count_anew(self, off: float) -> None:
        """Take notice that places count from elsewhere: so much, SI, is added to all from now on."""
        self._last += off
        self._values = deque((one + off for one in self._values), maxlen=HISTORY)

    def _leap(self, step: float) -> None:
        """Take notice of a step to another value: whether a place has leapt as no machine moves.

        The leap back, from where it stood after one, is none: it is where the machine is.
        """
        if not np.isfinite(step):
            self._leapt = False
            return
        far = len(self._changes) >= ENOUGH and abs(step) > max(LEAP * self._passed, ABRUPT * self._furthest)
        self._leapt = bool(self.is_place and far and not self._leapt)
        if not far:
            self._furthest = max(self._furthest, abs(step))

    def stops(self, step: float, interval: float) -> bool:
        """Whether a motion that goes so far from value to value, in an interval, s, cannot stop at the next one."""
        if not abs(step) > BRAKED * interval**2:
            return False
        if self._is_abrupt(step):
            return True
        # Where noise never let two values be alike, no motion does.
        never = bool(np.diff(list(self._values)[: -self._same]).all())
        return never and len(self._changes) >= ENOUGH and self._has_noise()

    def _is_abrupt(self, step: float) -> bool:
        """Whether a step from value to value is so large that one to nothing was never seen."""
        enough = len(self._changes) >= ENOUGH and np.isfinite(step)
        return bool(enough and abs(step) > ABRUPT * max(self._changes))

    def _has_noise(self) -> bool:
        """Whether values used to change at random, before the last that are alike."""
        before = np.array(self._values)[: -self._same]
        if before.size < ENOUGH:
            return False
        noise = np.median(np.abs(np.diff(before, 5))) / FIFTH
        rounding = (SET_ROUNDING if self.channel.is_set else ROUNDING) * self._largest
        return bool(noise > max(NOISY * np.median(np.abs(np.diff(before))), rounding))

    def compare(self, time: float, measured: float, computed: float, sd: float, settled: bool) -> bool:
        """Compare with what is computed; False where the measured value is in another unit."""
        self.sd = sd
        small = max(6.0 * sd, 1e-12)
        if not np.isfinite(measured) or abs(computed) < small:
            return self.fault != "unit"
        ratio = measured / computed
        slip = None
        for times, (low, high) in ((10.0, TEN), (1000.0, THOUSAND)):
            if low < ratio < high or low < 1.0 / ratio < high if ratio else False:
                slip = times if ratio > 1.0 else 1.0 / times
        if slip is not None:
            self._ten += 1
            if self._ten >= SAME:
                self._set("unit", f"{self.channel.column} shows {slip:g} times what is computed: is its unit right?")
        else:
            self._ten = 0
            if self.fault == "unit":
                self._set("", "")
        if settled and slip is None:
            self._drift(time, measured - computed)
        return slip is None

    def _drift(self, time: float, residual: float) -> None:
        """Follow the mean residual, and how alike neighbours are."""
        passed = time - self._before if np.isfinite(self._before) else 0.0
        self._before = time
        keep = np.exp(-passed / DRIFT_TIME)
        e = float(np.clip(residual / self.sd, -FAR, FAR))
        self.mean = keep * self.mean + (1.0 - keep) * e
        # What is judged is of clipped residuals, and rises from zero. What is told is the mean itself.
        self._residual = keep * self._residual + (1.0 - keep) * residual
        self._known = keep * self._known + (1.0 - keep)
        self.weight = keep**2 * self.weight + (1.0 - keep) ** 2

    @property
    def mean_residual(self) -> float:
        """Mean of the residuals of about the last `DRIFT_TIME`, SI."""
        return self._residual / self._known if self._known > 0.0 else 0.0

    def drifting(self, alike: float, sds: float = DRIFTING) -> bool:
        """Whether the mean residual is beyond what noise makes, with so many samples counting as one."""
        return self.weight > 0.0 and bool(abs(self.mean) > sds * np.sqrt(self.weight * max(alike, 1.0)))

    def contradict(self, time: float, residual: float, sd: float) -> None:
        """Follow a residual over its standard deviation: one of dozens of them that lasts is no noise and no drift.

        Where the estimate explains a wrong zero, a wrong weight or a wrong unit in part, the rest stays.
        """
        if not np.isfinite(residual):
            return
        passed = min(time - self._off_at, LONGEST_PASSED) if np.isfinite(self._off_at) else 0.0
        self._off_at = time
        keep = np.exp(-passed / OFF_TIME)
        self.off = float(keep * self.off + (1.0 - keep) * np.clip(residual / sd, -WORST, WORST))
        self._off_for = self._off_for + passed if abs(self.off) > DOZENS else 0.0
        self.contradicts = self._off_for >= OFF_TIME or (self.contradicts and self._off_for > 0.0)

    def _set(self, fault: str, text: str) -> None:
        self.fault, self.text = fault, text

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {
            "fault": self.fault, "text": self.text, "seen": self.seen, "values": list(self._values),
            "changes": list(self._changes), "mean": self.mean, "weight": self.weight, "before": self._before,
            "residual": [self._residual, self._known],
            "furthest": self._furthest, "largest": self._largest, "passed": self._passed, "leapt": self._leapt,
            "same": [self._same, self._same_from, self._abrupt, self._stopped],
            "last": [self._last, self._last_at, self._step, self._took],
            "off": [self.off, self._off_for, self._off_at], "jumps": [self.jumps, self._jumped, self.jump],
        }  # fmt: skip

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on from what an earlier process kept."""
        self.fault, self.text, self.seen = memory["fault"], memory["text"], float(memory["seen"])
        self._values.extend(memory["values"])
        self._changes.extend(memory["changes"])
        self.mean, self.weight, self._before = memory["mean"], memory["weight"], memory["before"]
        self._residual, self._known = memory.get("residual", [0.0, 0.0])
        self._furthest, self._leapt = memory["furthest"], memory["leapt"]
        self._largest, self._passed = memory["largest"], memory["passed"]
        self._same, self._same_from, self._abrupt, self._stopped = memory["same"]
        self._last, self._last_at, self._step, self._took = [*memory["last"], np.nan][:4]  # earlier ones kept three
        self.off, self._off_for, self._off_at = memory["off"]
        self.contradicts = self._off_for >= OFF_TIME
        self.jumps, self._jumped, self.jump = memory.get("jumps", [0, -np.inf, ""])
