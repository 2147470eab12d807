"""Extremes from all peaks over a threshold: clusters, and the generalised Pareto distribution.

Peaks above a threshold come in clusters, of which the largest is taken. Clusters come as a Poisson process. What they
exceed the threshold by follows the generalised Pareto distribution, 1 - G(y) = (1 + xi y / sigma)^(-1/xi), and
exp(-y / sigma) for xi = 0 (Coles 2001, chapters 4 and 5). The largest of a duration is then below x with probability
exp(-rate duration (1 - G(x - u))).

Intervals are those of the profile likelihood of rate, scale and shape together.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tautline.errors import ArgumentError
from tautline.statistics.gumbel import Estimate, check_share

FEWEST = 10
"""Clusters below which nothing is fitted."""
SHAPES = (-0.6, 0.6, 61)
"""Shapes that are looked at: from, to, number. Real processes of tension lie between."""
RATES = (-3.0, 3.0, 13)
"""Rates that are looked at, in standard deviations of their logarithm."""
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

    def most_probable(self, duration: float, confidence: float = 0.9) -> Estimate:
        """The mode of the largest in a duration, s.

        The largest follows the generalised extreme value distribution, whose mode has F = exp(-(1 + xi)).

        Raises
        ------
        ArgumentError
            Where `confidence` does not lie between 0 and 1.
        """
        return self.percentile(duration, math.exp(-(1.0 + self.shape)), confidence)

    def percentile(self, duration: float, share: float, confidence: float = 0.9) -> Estimate:
        """What the largest in a duration, s, does not exceed with the probability `share`.

        Raises
        ------
        ArgumentError
            Where `share` or `confidence` does not lie between 0 and 1.
        """
        check_share("share", share)
        check_share("confidence", confidence)
        number = duration / -math.log(share)
        value = self._value(number)
        low, high = self._profile(number, value, confidence)
        return Estimate(value, low, high)

    def exceedance(self, duration: float, level: float) -> float:
        """Probability that the largest in a duration, s, exceeds a level above the threshold.

        Raises
        ------
        ArgumentError
            Where the level is below the threshold.
        """
        beyond = level - self.peaks.threshold
        if beyond < 0.0:
            raise ArgumentError(f"level = {level}: is below the threshold {self.peaks.threshold}")
        return -math.expm1(-self.rate * duration * self._tail(beyond))

    def _tail(self, beyond: float) -> float:
        if abs(self.shape) < SMALL:
            return math.exp(-beyond / self.scale)
        inner = 1.0 + self.shape * beyond / self.scale
        return inner ** (-1.0 / self.shape) if inner > 0.0 else 0.0

    def _value(self, number: float) -> float:
        return self.peaks.threshold + self.scale * _growth(self.rate * number, self.shape)

    def _profile(self, number: float, value: float, confidence: float) -> tuple[float, float]:
        """Values whose likelihood, at the best of the other parameters, is not too far below the largest."""
        from scipy.optimize import brentq
        from scipy.stats import chi2

        beyond = self.peaks.value - self.peaks.threshold
        n, over = len(beyond), value - self.peaks.threshold
        shapes = np.array([self.shape]) if self.fixed else np.linspace(*SHAPES)
        shapes = np.where(np.abs(shapes) < SMALL, SMALL, shapes)[:, None]
        rates = self.rate * np.exp(np.linspace(*RATES) / math.sqrt(n))[None, :]
        grown = np.where(rates * number > 1.0, ((rates * number) ** shapes - 1.0) / shapes, np.nan)
        arrivals = n * np.log(rates) - rates * self.peaks.duration

        def likelihood(x: float) -> float:
            sigma = x / grown
            inner = 1.0 + (shapes / sigma)[..., None] * beyond
            with np.errstate(invalid="ignore", divide="ignore"):
                logs = np.log(inner).sum(axis=-1)
            found = arrivals - n * np.log(sigma) - (1.0 + 1.0 / shapes) * logs
            return float(np.nanmax(np.where(np.isfinite(found), found, -np.inf)))

        best = max(likelihood(over * f) for f in np.linspace(0.9, 1.1, 21))
        deep = best - 0.5 * float(chi2.ppf(confidence, 1))

        def side(factor: float) -> float:
            end = over
            for _ in range(60):
                end *= factor
                if likelihood(end) < deep:
                    return float(brentq(lambda x: likelihood(x) - deep, end / factor, end, xtol=1e-4 * over))
            return end

        return self.peaks.threshold + side(1.0 / 1.15), self.peaks.threshold + side(1.15)


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
    """
    time, values = np.asarray(time, float), np.asarray(values, float)
    above = np.flatnonzero(values > threshold)
    duration = float(time[-1] - time[0])
    if above.size == 0:
        return Peaks(threshold, duration, np.empty(0), np.empty(0))
    begins = np.concatenate(([0], np.flatnonzero(np.diff(time[above]) > apart) + 1))
    chosen = [part[np.argmax(values[part])] for part in np.split(above, begins[1:])]
    return Peaks(threshold, duration, time[chosen], values[chosen])


def fit_pareto(peaks: Peaks, shape: float | None = None) -> Pareto:
    """Fit the generalised Pareto distribution by maximum likelihood.

    Parameters
    ----------
    peaks : Peaks
    shape : float, optional
        Where it is known: 0 for an exponential tail.

    Raises
    ------
    ArgumentError
        For fewer than ten clusters.
    """
    beyond = peaks.value - peaks.threshold
    if beyond.size < FEWEST:
        raise ArgumentError(
            f"{beyond.size} clusters over {peaks.threshold:g}: {FEWEST} at least; take a lower threshold"
        )
    if shape is not None and abs(shape) < SMALL:
        return Pareto(peaks, float(beyond.mean()), 0.0, True)
    from scipy.stats import genpareto

    known = {} if shape is None else {"fc": shape}
    xi, _, sigma = genpareto.fit(beyond, floc=0.0, **known)
    return Pareto(peaks, float(sigma), float(xi), shape is not None)
