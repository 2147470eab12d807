"""Swings and cycles of a signal: extremes between which it goes to and fro, ripple left out, and what repeats of them.

A *swing* goes from one extreme of the signal to the next; swings smaller than a share of the motion around them are
ripple, and merged. A *cycle* goes from one passage of the mean to the next in the same sense. Where two, three or four
swings up and down take turns, as harmonics or a doubled period make them, they are one cycle together.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gardenhose.motion.curves import Trace
from tautline.view.figures.spectrum import spectrum

STEADY = 0.01
"""Amplitudes of cycles that differ by less, relatively, are equal: the motion is settled."""
FEWEST = 3
"""Whole cycles that it takes to call a motion settled."""
RIPPLE = 0.25
"""Share of the range of motion within half a period on either side below which a swing is ripple."""
CLEAN = 1.0e-7
"""Scatter of amplitudes, relative, that is not worth leaving cycles out for."""
MOST_LOOPS = 4
"""Swings up and down that may take turns within one cycle."""


class Swings(NamedTuple):
    """Extremes of a signal between which it swings, ripple left out: maximum and minimum in turn."""

    time: np.ndarray
    """(n,) s."""
    value: np.ndarray
    """(n,), the unit of the signal."""


class Cycles(NamedTuple):
    """Cycles of a signal: n of them between n + 1 crossings; times s, extremes in the unit of the signal."""

    crossings: np.ndarray
    top: np.ndarray
    bottom: np.ndarray

    @property
    def amplitude(self) -> np.ndarray:
        """Half of peak to peak, (n,)."""
        return 0.5 * (self.top - self.bottom)


NONE = Cycles(*np.zeros((3, 0)))


def swings(time: np.ndarray, value: np.ndarray, rate: np.ndarray) -> Swings:
    """Extremes of a signal, ripple left out.

    Parameters
    ----------
    time, value, rate : (m,) array
        Times of the frames, s, the signal and its derivative by time.
    """
    if len(time) < 3:
        return Swings(np.zeros(0), np.zeros(0))
    trace = Trace(*(np.asarray(array, float) for array in (time, value, rate)))
    at, extremes = trace.extrema()
    kept = _turns(trace, at, extremes)
    return Swings(at[kept], extremes[kept])


def find_cycles(time: np.ndarray, value: np.ndarray, rate: np.ndarray, least: float, centred: bool = False) -> Cycles:
    """All cycles of a signal, without those smaller than `least`; crossings of zero, if `centred`, where possible."""
    if len(time) < 4:
        return NONE
    trace = Trace(time, value, rate)
    extremes = Swings(*trace.extrema())
    turns = np.array(_turns(trace, *extremes), int)
    senses = [_one_way(trace, extremes, turns, sign, least, centred) for sign in (1.0, -1.0)]
    # Both senses count the same cycles; at the ends of the run one may have a cycle more.
    return max(senses, key=lambda one: (len(one.crossings), one.crossings[-1:].sum()))


def _one_way(trace: Trace, extremes: Swings, turns: np.ndarray, sign: float, least: float, centred: bool) -> Cycles:
    """Cycles between the crossings upwards (sign 1) or downwards (-1, for which top and bottom are of the negative)."""
    value = sign * extremes.value
    rising = np.flatnonzero(np.diff(value[turns]) > 0.0)
    if len(rising) < 2:
        return NONE
    first, last = turns[rising], turns[rising + 1]
    low, high = value[first], value[last]
    level = np.where(centred & (low < 0.0) & (high > 0.0), 0.0, 0.5 * (low + high))
    # Ripple may pass the level several times: the last passage before the top is meant.
    below = [i + int(np.flatnonzero(value[i:j] <= at)[-1]) for i, j, at in zip(first, last, level, strict=True)]
    crossings = trace.root(extremes.time[below], extremes.time[np.add(below, 1)], sign * level)
    cycles = Cycles(crossings, high[:-1], low[1:])
    counts = np.flatnonzero(cycles.amplitude > least)
    if counts.size == 0:
        return NONE
    # The last ones that count, one after the other: after them the motion has died out.
    gaps = np.flatnonzero(np.diff(counts) > 1)
    start, stop = counts[gaps[-1] + 1 if gaps.size else 0], counts[-1] + 1
    return Cycles(crossings[start : stop + 1], cycles.top[start:stop], cycles.bottom[start:stop])


def _turns(trace: Trace, at: np.ndarray, extremes: np.ndarray) -> list[int]:
    """Which of all extremes of a signal, (n,) times and values, bound swings that are no ripple."""
    time, value = trace.time, trace.value
    if at.size == 0:
        return []
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    half = max(1, math.ceil(0.5 * _dominant_period(time, trace.rate) / float(np.median(np.diff(time)))))
    width = min(2 * half + 1, 2 * len(time) + 1)
    around = maximum_filter1d(value, width, mode="nearest") - minimum_filter1d(value, width, mode="nearest")
    least = RIPPLE * around[np.clip(np.searchsorted(time, at), 0, len(time) - 1)]
    kept: list[int] = []
    low = high = 0
    for i in range(at.size):
        if not kept:
            low = i if extremes[i] < extremes[low] else low
            high = i if extremes[i] > extremes[high] else high
            if extremes[high] - extremes[low] >= least[i] and high != low:
                kept = sorted((low, high))
        elif (extremes[i] - extremes[kept[-1]]) * (extremes[kept[-1]] - extremes[kept[-2]]) > 0.0:
            kept[-1] = i
        elif abs(extremes[i] - extremes[kept[-1]]) >= least[i]:
            kept.append(i)
    return kept


def _dominant_period(time: np.ndarray, rate: np.ndarray) -> float:
    """Rough period of the second half of a signal; from its rate, in which a drift of the mean weighs little."""
    late = time >= 0.5 * (time[0] + time[-1])
    frequency, lines = spectrum(time[late], rate[late])
    if lines.size < 2 or not lines.any():
        return float(time[-1] - time[0])
    return 1.0 / float(frequency[max(int(lines.argmax()), 1)])


def steady(amplitude: np.ndarray) -> int:
    """How many of the last amplitudes agree with their mean within `STEADY`."""
    count = np.arange(1, len(amplitude) + 1)
    last = amplitude[::-1]
    mean = np.cumsum(last) / count
    apart = np.maximum(np.maximum.accumulate(last) / mean - 1.0, 1.0 - np.minimum.accumulate(last) / mean)
    unequal = np.flatnonzero(apart > STEADY)
    return int(unequal[0]) if unequal.size else len(amplitude)


def grouped(cycles: Cycles) -> tuple[Cycles, int]:
    """Cycles in groups that repeat, and how many there are to a group."""
    crossings, top, bottom = cycles
    if steady(cycles.amplitude) >= FEWEST:
        return cycles, 1
    duration = np.diff(crossings)
    for loops in range(2, MOST_LOOPS + 1):
        if len(top) < FEWEST * loops:
            break
        last, before = slice(-2 * loops, None), slice(-3 * loops, -loops)
        height = top[-loops:].max() - bottom[-loops:].min()
        repeats = [
            np.abs(values[last] - values[before]).max() <= STEADY * size
            for values, size in ((top, height), (bottom, height), (duration, duration[-loops:].sum()))
        ]
        if all(repeats):
            start = len(top) % loops
            tops, bottoms = top[start:].reshape(-1, loops).max(axis=1), bottom[start:].reshape(-1, loops).min(axis=1)
            return Cycles(crossings[start::loops], tops, bottoms), loops
    return cycles, 1


def cycles_used(cycles: Cycles) -> int:
    """How many of the last cycles stand for the motion at the end."""
    used = steady(cycles.amplitude)
    if used < FEWEST:
        return min(FEWEST, len(cycles.top))
    while used >= 2 * FEWEST:
        # The remainder of a transient is in the earlier half; noise is in both.
        late = (used + 1) // 2
        if scatter(cycles.amplitude[-used:]) < max(3.0 * scatter(cycles.amplitude[-late:]), CLEAN):
            break
        used = late
    return used


def scatter(amplitude: np.ndarray) -> float:
    """Largest difference of an amplitude from their mean, relative."""
    return float(np.abs(amplitude / amplitude.mean() - 1.0).max())
