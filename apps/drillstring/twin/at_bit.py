"""Weight and torque at the bit, from what the surface shows beside a simulation of the string off bottom.

What the hook lacks of the computed load, and what the drive has more of torque, are averaged. A soft string with a
weight at its bit says which weight lets the hook lack so much, and what of the friction torque that weight takes away
(loaded_string.py).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from itertools import pairwise
from math import hypot, inf, nan, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from drillstring.drilling.impedance import torsional_frequency
from drillstring.scene.scene import DrillstringScene
from drillstring.statics.motion import MOTIONS, Motion
from drillstring.string.factors import Factors, factors_of
from drillstring.twin.loaded_string import Loaded, LoadedString, Tables

UNEVEN = 0.15
"""Share of a swing that is left in the mean over a period that is known to so much."""
MODEL = 0.07
"""Relative standard deviation of what the soft string says of a weight's friction, beside runs of the model."""
UNLIKE = 0.15
"""Relative standard deviation of the axial friction of a string that turns: as its weight changes, the bit goes down
faster or slower than the block, and all between at speeds of their own."""
RESOLVED = 0.25
"""Interval of rows, over the period of a swing, above which they do not show it: each has it in a phase of its own."""
FEWEST, LEAST = 5, 3
"""Rows of a mean, as far as there are so many on bottom; and those without which nothing is told."""
LONGEST = 30.0
"""Time, s, that a mean is not longer than, unless the fewest rows that tell anything are further apart."""
SLOWEST_TURN = 0.1
"""Rotary speed below which the string does not turn, rad/s."""
NAMES = {
    "wall.friction": "open", "wall.friction.kinetic": "open", "casing.friction": "cased",
    "casing.friction.kinetic": "cased",
}  # fmt: skip
"""Parameters that are friction factors of a string that slips."""
LITTLE = 1e-6
"""Friction force N, or torque N m, over the weight of the string, N, that counts as none."""
TOO_FEW = (
    f"bit.weight, bit.torque and bit.depth: at least {LEAST} rows on bottom without a gap are needed, and there are "
    "fewer so far"
)
LOCKED_ROTARY = "bit.torque: the string does not turn, and the wall may hold any torque of the bit"
NO_WEIGHT = "bit.torque: the weight on the bit is not known, and the friction torque depends on it"
NO_HOOK_LOAD = "bit.weight: the hook load is not measured now, or its readings are not believed"
NO_DEPTH = "bit.depth: the weight on the bit is not known, and the string is shorter by it"
LOCKED_UP = (
    "bit.weight: the string nearly locks up with so much weight, and hardly any more of it would be seen at the hook"
)


class AtSurface(NamedTuple):
    """A row: time s; position of the block, m, and rotary speed, rad/s; hook load N and torque N m off bottom, as they
    are computed; what the hook lacks of that, N, and what the torque is more than that, N m; NaN where it is not known.
    """

    time: float
    block: float
    rotary: float
    hook_load: float = nan
    torque: float = nan
    lacking: float = nan
    excess: float = nan


class Known(NamedTuple):
    """Standard deviations of a sensor by its noise, and of what is computed in its place off bottom."""

    noise: float
    computed: float


class _Mean(NamedTuple):
    """Mean of some rows, and its variance by noise and by what swings."""

    value: float
    variance: float


def mean_time(interval: float, mean_over: float) -> float:
    """Time, s, over which weight and torque are averaged of rows an interval, s, apart, where `mean_over` is asked for.

    As `AtBit` keeps its rows.
    """
    rows = min(FEWEST, max(LEAST, int(LONGEST / interval) + 1))
    return max(mean_over, (rows - 1) * interval)


class AtBit:
    """Finds weight and torque at the bit as means over the last seconds.

    Parameters
    ----------
    scene : DrillstringScene
        Off bottom.
    mean_over : float
        s; longer where rows are so far apart that there are fewer than `FEWEST` in it.

    Attributes
    ----------
    axial, torsional : float
        Longest periods, s, in which hook load and torque swing.
    lost : list of str
        What cannot be told now, and why.
    shorter : tuple of float
        By how much the weight shortens the string, m, and its standard deviation; NaN where that is not known.
    """

    MADE_ANEW = ("_wall", "mean_over", "torsional", "axial")

    def __init__(self, scene: DrillstringScene, mean_over: float) -> None:
        self._wall, self.mean_over = scene.well.wall, mean_over
        self._string = LoadedString(scene)
        self.torsional = 1.0 / torsional_frequency(self._string.tubes)
        pipe = self._string.tubes[0]
        self.axial = self.torsional * sqrt(pipe.shear_modulus / pipe.youngs_modulus)
        self._rows: deque[AtSurface] = deque()
        self.lost: list[str] = []
        self.shorter = nan, nan

    def clear(self) -> None:
        """Forget the rows, as off bottom."""
        self._rows.clear()
        self.lost, self.shorter = [], (nan, nan)

    def add(self, row: AtSurface) -> None:
        """One more row on bottom."""
        self._rows.append(row)
        while (span := row.time - self._rows[0].time) > self.mean_over:
            # Rows that come slowly stay until there are enough; what was before a gap does not.
            shortest = min(b.time - a.time for a, b in pairwise(self._rows)) if len(self._rows) <= FEWEST else 0.0
            longest = LONGEST if len(self._rows) > LEAST else inf
            if span <= min(longest, FEWEST * shortest):
                break
            self._rows.popleft()

    def told(
        self, hook_load: Known | None, torque: Known | None, friction: Mapping[str, tuple[float, float]]
    ) -> dict[str, tuple[float, float]]:
        """Weight, N, and torque, N m, with standard deviations.

        Parameters
        ----------
        hook_load, torque : Known or None
            Of the sensors; None where there is none.
        friction : mapping
            Parameter -> estimate and standard deviation.
        """
        self.lost, self.shorter = [], (nan, nan)
        if len(self._rows) < LEAST:
            self.lost.append(TOO_FEW)
            return {}
        rows = np.array(self._rows)
        motion = _motion(rows)
        lacking = _mean(rows[:, (0, 5)], hook_load, self.axial)
        excess = _mean(rows[:, (0, 6)], torque, self.torsional) if motion.rotary else None
        if torque is not None and not motion.rotary:
            self.lost.append(LOCKED_ROTARY)
        factors, apart = self._friction(friction)
        if hook_load is not None and lacking is None:
            self.lost.append(NO_HOOK_LOAD)
        tables = self._string.tables(factors, apart, motion, lacking.value if lacking else 0.0)
        locks = tables is None or (lacking is not None and tables.middle.locks and lacking.value > tables.middle.most)
        if locks and lacking is not None:
            self.lost.append(LOCKED_UP)
        told: dict[str, tuple[float, float]] = {}
        if tables is not None and not locks and lacking is not None and hook_load is not None:
            share = _sliding(rows, tables, bool(motion.rotary))
            if motion.rotary:
                axial = UNLIKE * (tables.without - tables.middle.hook_load)
                lacking = lacking._replace(variance=lacking.variance + axial**2)
            at, sd = self._loaded(tables, apart, lacking, share, hook_load.computed, torque)
            told["bit.weight"], self.shorter = (at.weight, sd.weight), (at.shorter, sd.shorter)
            if excess is not None:
                told["bit.torque"] = excess.value + at.torque, hypot(sqrt(excess.variance), sd.torque)
        elif excess is not None and torque is not None:
            if tables is None or np.abs(tables.middle.rows[:, 2]).max() > torque.noise:
                self.lost.append(NO_WEIGHT)
            else:
                told["bit.torque"] = excess.value, hypot(sqrt(excess.variance), torque.computed)
        if "bit.weight" not in told:
            self.lost.append(NO_DEPTH)
        return told

    def _friction(self, friction: Mapping[str, tuple[float, float]]) -> tuple[Factors, dict[str, float]]:
        """Friction factors as they are estimated, and the standard deviations of those that are."""
        factors = Factors(0.0, 0.0) if self._wall is None else factors_of(self._wall, "kinetic")
        found = {NAMES[name]: one for name, one in friction.items() if name in NAMES}
        factors = factors._replace(**{name: max(0.0, value) for name, (value, _) in found.items()})
        return factors, {name: sd for name, (_, sd) in found.items() if name == "open" or factors.several}

    def _loaded(
        self, tables: Tables, apart: Mapping[str, float], lacking: _Mean, sliding: float, computed: float,
        torque: Known | None,
    ) -> tuple[Loaded, Loaded]:  # fmt: skip
        """What the soft string says where so much is lacking, and standard deviations.

        A friction factor that is a little larger changes what is computed off bottom, and what a weight changes. Both
        count together: the one may take away much of the other. What else is unknown off bottom counts as it is.
        """
        middle = tables.middle
        at, slope = middle.at(lacking.value), middle.slope(lacking.value)
        of_load, of_torque = computed**2, torque.computed**2 if torque is not None else 0.0
        variance = np.zeros(4)
        for name, (table, off) in tables.apart.items():
            part = apart[name] / off
            load, turning = table.hook_load - middle.hook_load, table.torque - middle.torque
            change = np.array(table.at(lacking.value + load)) - np.array(at)
            change[2] -= turning
            variance += (part * change) ** 2
            of_load, of_torque = of_load - (part * load) ** 2, of_torque - (part * turning) ** 2
        variance += np.array(slope) ** 2 * (lacking.variance + max(0.0, of_load))
        variance[2] += max(0.0, of_torque)
        # Where the string of the simulation does not slide as a whole, the soft string's weight may count for less.
        share = hypot(MODEL, 1.0 - sliding)
        wall = at.weight - lacking.value
        variance += (share * np.array([wall, 0.0, at.torque, wall * slope.shorter])) ** 2
        return at, Loaded(*np.sqrt(variance).tolist())


def _mean(rows: np.ndarray, known: Known | None, period: float) -> _Mean | None:
    """Mean of the values that there are of rows (n, 2) of times and values, which swing in a period, s.

    Where rows show the swing, it goes out of the mean of about a period up to some share. Where they are too far apart
    for that, each is off by itself. Then it goes out as noise does, and how large it is, is known of few rows only
    (Student's distribution).
    """
    rows = rows[np.isfinite(rows[:, 1])]
    n, values = len(rows), rows[:, 1]
    if known is None or not n:
        return None
    if n < LEAST or np.median(np.diff(rows[:, 0])) <= RESOLVED * period:
        swings = UNEVEN * sqrt(max(0.0, float(values.var()) - known.noise**2))
        return _Mean(float(values.mean()), known.noise**2 / n + swings**2)
    # What changes slowly counts too: a swing near the rate of the rows looks like that.
    variance = float(((values - values.mean()) ** 2).sum()) / max(n - 3, 0.25)
    # Of a wave, n samples in steps of the phase have a mean of at most this share of its amplitude (a geometric sum).
    step = float(np.median(np.diff(rows[:, 0]))) / period
    part = 1.0 / n if step > 1.0 - RESOLVED else min(1.0 / n, 1.0 / (n * sin(pi * step)) ** 2)
    return _Mean(float(values.mean()), known.noise**2 / n + variance * part)


def _motion(rows: np.ndarray) -> Motion:
    """How the string moves on bottom: it is turned, or slides down as it is fed or as its weight is drilled off."""
    turned = rows[np.isfinite(rows[:, 2]), 2]
    rotary = float(turned.mean()) if turned.size else 0.0
    if abs(rotary) < SLOWEST_TURN:
        return MOTIONS["slack_off"]
    time, block = rows[np.isfinite(rows[:, 1]), :2].T
    passed = float(time[-1] - time[0]) if time.size else 0.0
    return Motion(float(block[-1] - block[0]) / passed if passed > 0.0 else 0.0, rotary)


def _sliding(rows: np.ndarray, tables: Tables, turns: bool) -> float:
    """Share of the soft string's friction that the simulation has off bottom: one where all of the string slides."""
    has, whole = rows[:, 4].mean(), tables.middle.torque
    if not turns:
        has, whole = tables.without - rows[:, 3].mean(), tables.without - tables.middle.hook_load
    if not np.isfinite(has) or abs(whole) < LITTLE * max(1.0, abs(tables.without)):
        return 1.0
    return float(min(1.0, max(0.0, has / whole)))
