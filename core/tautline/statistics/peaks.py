"""Extremes from all peaks over a threshold: clusters, and the generalised Pareto distribution.

Peaks above a threshold come in clusters, of which the largest is taken. Clusters come as a Poisson process. What they
exceed the threshold by follows the generalised Pareto distribution, 1 - G(y) = (1 + xi y / sigma)^(-1/xi), and
exp(-y / sigma) for xi = 0 (Coles 2001, chapters 4 and 5). The largest of a duration is then below x with probability
exp(-rate duration (1 - G(x - u))).

Shapes are looked for within `SHAPES`. Below -1 the likelihood has no largest value: it grows without end as the end of
the distribution comes to the largest peak, and from -1 to -1/2 its estimates are not those of the usual theory (Smith
1985). A fit to few clusters runs there often, and its extreme of any duration is then the largest peak itself.

Intervals are those of the profile likelihood of rate, scale and shape together. The signed root of its deviance is
nearly normal, but neither around 0 nor of the variance 1: without more the truth lies above the interval twice as often
as it may. Both are put right by what was found by simulation (`python -m benchmarks.accuracy.pareto`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tautline.errors import ArgumentError
from tautline.statistics.gumbel import Estimate, check_share

FEWEST = 10
"""Clusters below which nothing is fitted."""
SHAPES = (-0.5, 0.5)
"""Between which a shape is looked for. Above -1/2 the usual theory of estimates holds; real tensions lie between."""
REACH, LOOKED_AT = 6.0, 41
"""How far around the estimate shapes are looked at for an interval, in their standard deviations, and how many."""
RATES = (-3.0, 3.0, 25)
"""Rates that are looked at, in standard deviations of their logarithm."""
SHIFT, SPREAD, MORE = 3.15, 0.33, 34.0
"""The signed root of the deviance of n clusters has the mean -SHIFT / s and the deviation 1 + SPREAD / s.

Here s^2 = n + MORE.
Measured for shapes from -0.3 to 0.1, 20 to 200 clusters, and durations of 0.3 and 3 times the record.
"""
SMALL = 1.0e-6


class Peaks(NamedTuple):
    """The largest of each cluster over a threshold.

    Attributes
    ----------
    threshold : float
    duration : float
        Of the record, s.
    time, value : (n,) array
    """

    threshold: float
    duration: float
    time: np.ndarray
    value: np.ndarray


class Pareto(NamedTuple):
    """Clusters over a threshold, as fitted.

    Attributes
    ----------
    peaks : Peaks
    scale, shape : float
        sigma and xi.
    fixed : bool
        Whether the shape was given.
    """

    peaks: Peaks
    scale: float
    shape: float
    fixed: bool

    @property
    def rate(self) -> float:
        """Clusters in a second."""
        return len(self.peaks.value) / self.peaks.duration

    @property
    def bounded(self) -> bool:
        """Whether the shape is one of the ends of `SHAPES`: the peaks alone would ask for one beyond it."""
        return not self.fixed and min(abs(self.shape - end) for end in SHAPES) < SMALL

    def most_probable(self, duration: float, confidence: float = 0.9) -> Estimate:
        """The mode of the largest in a duration, s.

        The largest follows the generalised extreme value distribution, whose mode has F = exp(-(1 + xi)).

        Raises
        ------
        ArgumentError
            As `percentile`.
        """
        return self._at(_duration(duration), lambda shape: 1.0 + shape, confidence)

    def percentile(self, duration: float, share: float, confidence: float = 0.9) -> Estimate:
        """What the largest in a duration, s, does not exceed with the probability `share`.

        Raises
        ------
        ArgumentError
            Where `share` or `confidence` does not lie between 0 and 1, for a duration that is not above zero, and for
            one so short that the value lies below the threshold, of which nothing is known.
        """
        check_share("share", share)
        return self._at(_duration(duration), lambda shape: -math.log(share), confidence)

    def exceedance(self, duration: float, level: float) -> float:
        """Probability that the largest in a duration, s, exceeds a level above the threshold.

        Raises
        ------
        ArgumentError
            Where the level is not above the threshold, or the duration not above zero.
        """
        beyond = level - self.peaks.threshold
        if not beyond >= 0.0:
            raise ArgumentError(f"level = {level}: is below the threshold {self.peaks.threshold}")
        return -math.expm1(-self.rate * _duration(duration) * self._tail(beyond))

    def _tail(self, beyond: float) -> float:
        if abs(self.shape) < SMALL:
            return math.exp(-beyond / self.scale)
        inner = 1.0 + self.shape * beyond / self.scale
        return inner ** (-1.0 / self.shape) if inner > 0.0 else 0.0

    def _at(self, duration: float, reduced: Callable[[float], float], confidence: float) -> Estimate:
        """The value that the largest passes so often that -ln F is `reduced`, a function of the shape."""
        check_share("confidence", confidence)
        number = self.rate * duration / reduced(self.shape)
        if number <= 1.0:
            raise ArgumentError(
                f"duration = {duration:g} s: the value lies below the threshold {self.peaks.threshold:g}, and of what "
                f"is below it nothing is known; ask for more than {duration / number:.3g} s, or take a lower threshold"
            )
        over = self.scale * _growth(number, self.shape)
        low, high = self._profile(duration, reduced, over, confidence)
        return Estimate(self.peaks.threshold + over, self.peaks.threshold + low, self.peaks.threshold + high)

    def _profile(
        self, duration: float, reduced: Callable[[float], float], over: float, confidence: float
    ) -> tuple[float, float]:
        """Values above the threshold whose likelihood, at the best of the other parameters, is not too far down."""
        from scipy.optimize import brentq
        from scipy.stats import norm

        beyond = self.peaks.value - self.peaks.threshold
        n = len(beyond)
        rates = self.rate * np.exp(np.linspace(*RATES) / math.sqrt(n))
        arrivals = n * np.log(rates) - rates * self.peaks.duration
        shapes = self._shapes(n)
        grown = [_growths(rates * duration / reduced(shape), shape) for shape in shapes]

        def likelihood(x: float) -> float:
            each = (arrivals + _likelihood(beyond, x / g, shape) for g, shape in zip(grown, shapes, strict=True))
            return max(float(np.max(one)) for one in each)

        best = likelihood(over)
        # With the shape known nothing has to be put right.
        few = 0.0 if self.fixed else 1.0 / math.sqrt(n + MORE)
        root, shift = float(norm.isf(0.5 - 0.5 * confidence)) * (1.0 + SPREAD * few), SHIFT * few

        def side(factor: float, root: float) -> float:
            end, deep = over, best - 0.5 * max(root, 0.0) ** 2
            for _ in range(60 if root > 0.0 else 0):
                end *= factor
                if likelihood(end) < deep:
                    return float(brentq(lambda x: likelihood(x) - deep, end / factor, end, xtol=1e-4 * over))
            return end

        return side(1.0 / 1.15, root - shift), side(1.15, root + shift)

    def _shapes(self, n: int) -> list[float]:
        """Shapes that are looked at for an interval, the estimate among them."""
        if self.fixed:
            return [self.shape]
        reach = REACH * (1.0 + self.shape) / math.sqrt(n)
        around = np.linspace(max(SHAPES[0], self.shape - reach), min(SHAPES[1], self.shape + reach), LOOKED_AT)
        return [self.shape, *around.tolist()]


def _duration(duration: float) -> float:
    if not 0.0 < duration < math.inf:
        raise ArgumentError(f"duration = {duration}: must be finite and above 0")
    return duration


def _likelihood(beyond: np.ndarray, scale: np.ndarray, shape: float) -> np.ndarray:
    """Logarithm of the likelihood of what peaks (n,) exceed the threshold by, for each scale (m,) and one shape."""
    n = len(beyond)
    with np.errstate(invalid="ignore", divide="ignore"):
        if abs(shape) < SMALL:
            found = -n * np.log(scale) - beyond.sum() / scale
        else:
            logs = np.log(1.0 + (shape / scale)[:, None] * beyond).sum(axis=-1)
            found = -n * np.log(scale) - (1.0 + 1.0 / shape) * logs
    return np.where(np.isfinite(found), found, -np.inf)


def _growths(numbers: np.ndarray, shape: float) -> np.ndarray:
    """`_growth` of each number; NaN where less than one cluster is expected, and the value is below the threshold."""
    return np.array([_growth(float(number), shape) if number > 1.0 else math.nan for number in numbers])


def _growth(number: float, shape: float) -> float:
    """(N^xi - 1) / xi, ln N for xi = 0."""
    return math.log(number) if abs(shape) < SMALL else math.expm1(shape * math.log(number)) / shape


def peaks_over(time: np.ndarray, values: np.ndarray, threshold: float, apart: float) -> Peaks:
    """The largest value of each cluster over a threshold.

    Parameters
    ----------
    time : (m,) array
        s, increasing.
    values : (m,) array
    threshold : float
    apart : float
        Exceedances nearer to each other than this, s, are one cluster. Some periods of the process.

    Raises
    ------
    ArgumentError
        For fewer than two values, a number that is not finite, times that do not increase, and a negative `apart`.
    """
    time, values = np.asarray(time, float), np.asarray(values, float)
    if time.ndim != 1 or time.shape != values.shape or time.size < 2:
        raise ArgumentError(f"time, values: shapes {time.shape} and {values.shape}; of one length, 2 at least")
    if not (np.isfinite(time).all() and np.isfinite(values).all()):
        raise ArgumentError("time, values: not all are finite; a gap in a record is two records")
    if not np.all(np.diff(time) > 0.0):
        raise ArgumentError("time: does not increase")
    if not (math.isfinite(threshold) and apart >= 0.0):
        raise ArgumentError(f"threshold = {threshold}, apart = {apart}: must be finite, and apart not below 0")
    above = np.flatnonzero(values > threshold)
    duration = float(time[-1] - time[0])
    if above.size == 0:
        return Peaks(threshold, duration, np.empty(0), np.empty(0))
    begins = np.concatenate(([0], np.flatnonzero(np.diff(time[above]) > apart) + 1))
    chosen = [part[np.argmax(values[part])] for part in np.split(above, begins[1:])]
    return Peaks(threshold, duration, time[chosen], values[chosen])


def fit_pareto(peaks: Peaks, shape: float | None = None) -> Pareto:
    """Fit the generalised Pareto distribution by maximum likelihood, with a shape within `SHAPES`.

    Parameters
    ----------
    peaks : Peaks
    shape : float, optional
        Where it is known: 0 for an exponential tail.

    Raises
    ------
    ArgumentError
        For fewer than ten clusters, peaks that are not above the threshold, a record without a duration, and a shape
        beyond `SHAPES`.
    """
    beyond = peaks.value - peaks.threshold
    if beyond.size < FEWEST:
        raise ArgumentError(
            f"{beyond.size} clusters over {peaks.threshold:g}: {FEWEST} at least; take a lower threshold"
        )
    if not (np.isfinite(beyond).all() and beyond.min() > 0.0):
        raise ArgumentError(f"peaks: not all are finite and above the threshold {peaks.threshold:g}")
    _duration(peaks.duration)
    if shape is None:
        return Pareto(peaks, *_likeliest(beyond), False)
    if not SHAPES[0] <= shape <= SHAPES[1]:
        raise ArgumentError(f"shape = {shape}: must lie between {SHAPES[0]:g} and {SHAPES[1]:g}")
    exact = 0.0 if abs(shape) < SMALL else shape
    return Pareto(peaks, _scale(beyond, exact), exact, True)


def _likeliest(beyond: np.ndarray) -> tuple[float, float]:
    """Scale and shape of the largest likelihood."""
    from scipy.optimize import minimize_scalar

    def unlikeliness(shape: float) -> float:
        return -float(_likelihood(beyond, np.array([_scale(beyond, shape)]), shape)[0])

    shapes = np.linspace(*SHAPES, 21)
    k = int(np.argmin([unlikeliness(shape) for shape in shapes]))
    ends = float(shapes[max(k - 1, 0)]), float(shapes[min(k + 1, len(shapes) - 1)])
    inner = float(minimize_scalar(unlikeliness, bounds=ends, method="bounded", options={"xatol": 1e-8}).x)
    # The method comes near to an end of its bounds and never to it.
    shape = min((inner, float(shapes[k])), key=unlikeliness)
    return _scale(beyond, shape), shape


def _scale(beyond: np.ndarray, shape: float) -> float:
    """The scale of the largest likelihood for a shape above -1: where sum (1 + xi) y / (sigma + xi y) = n.

    The sum falls with sigma, from more than n to less between the two ends here.
    """
    from scipy.optimize import brentq

    mean, largest = float(beyond.mean()), float(beyond.max())
    if abs(shape) < SMALL:
        return mean
    low = max(0.0, -shape * largest)

    def lacking(over: float) -> float:
        return float(((1.0 + shape) * beyond / (low + over + shape * beyond)).mean()) - 1.0

    end = (1.0 + shape) * mean
    return low + float(brentq(lacking, 1e-12 * end, 1.000001 * end, xtol=1e-14 * end, rtol=1e-14))
