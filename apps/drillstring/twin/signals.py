"""Two things that are learned of a sampled signal as it comes: how much it is disturbed, and how fast it changes now.

Both look back only. Neither assumes a sampling rate: times are those of the samples.
"""

from __future__ import annotations

from collections import deque
from math import sqrt

import numpy as np

NORMAL = 0.6745
"""Median absolute value of a normal deviate of unit standard deviation."""
REMEMBERED = 240
"""Second differences of which the noise is the median."""
RENEWED = 10
"""Samples after which that median is taken anew."""
WINDOWS = (2, 3, 4, 6, 8, 12, 16, 24, 32)
"""Numbers of samples over which a line is tried."""
STRAIGHT = 3.5
"""Standard deviations of the noise that a sample may be off a line."""


class Noise:
    """Standard deviation of what disturbs a signal from sample to sample.

    It is found from second differences, x[k] - 2 x[k-1] + x[k-2], which a steady change does not enter: their variance
    is six times that of white noise. The median keeps jumps out. Of a signal that lags, whose noise is smoothed, less
    than the noise is found.
    """

    def __init__(self, floor: float = 0.0) -> None:
        self.floor = floor
        self._last: deque[float] = deque(maxlen=3)
        self._differences: deque[float] = deque(maxlen=REMEMBERED)
        self._count = 0
        self.deviation = floor

    def add(self, value: float) -> float:
        """The standard deviation with one more sample; at least the floor."""
        self._last.append(value)
        if len(self._last) < 3:
            return self.deviation
        a, b, c = self._last
        self._differences.append(abs(c - 2.0 * b + a))
        self._count += 1
        if self._count <= RENEWED or self._count % RENEWED == 0:
            median = float(np.median(self._differences))
            self.deviation = max(self.floor, median / (NORMAL * sqrt(6.0)))
        return self.deviation


class Trend:
    """Rate of change of a signal now, over the longest stretch in which it has changed steadily.

    A line is fitted to the last 2, 3, 4, ... samples, as long as no sample is further off it than noise makes it: where
    a motion begins or ends the stretch becomes short at once, and grows again. So a steady slow motion is told from
    noise, and a stop is not hidden by the motion before it.
    """

    def __init__(self, longest: float) -> None:
        self.longest = longest
        self._samples: deque[tuple[float, float]] = deque(maxlen=WINDOWS[-1])
        self.rate = 0.0
        self.deviation = float("inf")

    def add(self, time: float, value: float, noise: float) -> float:
        """The rate, per s, with one more sample disturbed by ``noise``; ``deviation`` is its standard deviation."""
        self._samples.append((time, value))
        ages = [t - time for t, _ in self._samples]
        values = [x - value for _, x in self._samples]
        found = 0.0, float("inf")
        # Few numbers at a time: plain floats take half the time of arrays.
        for count in WINDOWS:
            if count > len(ages) or (count > 2 and -ages[-count] > self.longest):
                break
            t, x = ages[-count:], values[-count:]
            middle, level = sum(t) / count, sum(x) / count
            off_middle = [one - middle for one in t]
            spread = sum([one * one for one in off_middle])
            rate = sum([one * y for one, y in zip(off_middle, x, strict=True)]) / spread
            if max([abs(y - level - rate * one) for one, y in zip(off_middle, x, strict=True)]) > STRAIGHT * noise:
                break
            found = rate, noise / sqrt(spread)
        self.rate, self.deviation = found
        return self.rate

    def clear(self) -> None:
        """Forget the samples, as after a gap."""
        self._samples.clear()
        self.rate, self.deviation = 0.0, float("inf")
