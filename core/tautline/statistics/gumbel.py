"""Extremes from the maxima of independent runs or blocks: Gumbel's distribution with exact confidence intervals.

The largest of many independent peaks of a process whose peaks have an exponential tail tends to Gumbel's distribution,
F(x) = exp(-exp(-(x - mu) / beta)). It stays one when the duration changes: of a duration T in place of T0 the location
is mu + beta ln(T / T0), the scale is the same.

Estimates are those of maximum likelihood. They are equivariant: of a sample a + b x they are a + b times those of x.
So the distribution of (mu - mu^) / beta^ depends on the number of maxima alone. It is sampled here, and the intervals
are exact for a sample of any size, but for the error of that sampling (Lawless 2003, section 5.1).
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np

from tautline.errors import ArgumentError

SAMPLES = 20_000
"""Samples by which the distribution of the estimates is known."""
ITERATIONS, SETTLED = 200, 1.0e-12
FARTHEST = 1.0e200
"""Reduced variate beyond which nothing is told apart."""
FEWEST = 3
"""Maxima below which no interval is of use."""


class Estimate(NamedTuple):
    """A number with its confidence interval."""

    value: float
    low: float
    high: float


class Gumbel(NamedTuple):
    """Gumbel's distribution of the maxima of a duration, as fitted.

    Attributes
    ----------
    location, scale : float
        mu and beta.
    count : int
        Number of maxima that it was fitted to.
    ratio : float
        Duration that is asked about over that of the maxima.
    """

    location: float
    scale: float
    count: int
    ratio: float = 1.0

    def most_probable(self, confidence: float = 0.9) -> Estimate:
        """The mode of the largest in the duration.

        Raises
        ------
        ArgumentError
            Where `confidence` does not lie between 0 and 1.
        """
        return self._at(math.log(self.ratio), confidence)

    def percentile(self, share: float, confidence: float = 0.9) -> Estimate:
        """What the largest in the duration does not exceed with the probability `share`.

        Raises
        ------
        ArgumentError
            Where `share` or `confidence` does not lie between 0 and 1.
        """
        check_share("share", share)
        return self._at(-math.log(-math.log(share)) + math.log(self.ratio), confidence)

    def exceedance(self, level: float, confidence: float = 0.9) -> Estimate:
        """Probability that the largest in the duration exceeds a level.

        Raises
        ------
        ArgumentError
            Where `confidence` does not lie between 0 and 1.
        """
        tails = _tails(confidence)
        if self.scale == 0.0:
            certain = float(level < self.location)
            return Estimate(certain, certain, certain)
        # What is farther off than a number can tell has the probability 0 or 1 all the same.
        with np.errstate(over="ignore"):
            z = float(np.clip(np.subtract(level, self.location) / self.scale, -FARTHEST, FARTHEST))
        a, b = _pivots(self.count)
        bounds = np.quantile(a + z * b, tails)
        high, low = (_beyond(float(q) - math.log(self.ratio)) for q in bounds)
        return Estimate(_beyond(z - math.log(self.ratio)), low, high)

    def _at(self, reduced: float, confidence: float) -> Estimate:
        """The value of a reduced variate (x - mu) / beta."""
        a, b = _pivots(self.count)
        low, high = np.quantile((reduced - a) / b, _tails(confidence))
        value, scale = self.location, self.scale
        return Estimate(value + scale * reduced, value + scale * float(low), value + scale * float(high))


def fit_gumbel(maxima: np.ndarray, ratio: float = 1.0, bound: float = math.inf) -> Gumbel:
    """Fit Gumbel's distribution to maxima by maximum likelihood.

    Maxima at the bound are censored: of them it is known that they would be as large at least, and no more (Lawless
    2003, section 2.2). The intervals are those of a complete sample of the others.

    Parameters
    ----------
    maxima : (n,) array
        Of independent runs or blocks of equal duration. Of minima take the negative.
    ratio : float
        Duration that is asked about over that of the maxima.
    bound : float
        What no maximum can pass, for a reason that has nothing to do with chance: a rope has no less than no tension.
        With fewer than two maxima below it the scale is 0, and the location is the bound.

    Raises
    ------
    ArgumentError
        For fewer than three maxima, a number that is not finite or above the bound, and a ratio that is not above 0.
    """
    maxima = np.asarray(maxima, float)
    if maxima.ndim != 1 or maxima.size < FEWEST:
        raise ArgumentError(f"maxima: shape {maxima.shape}; {FEWEST} at least are needed")
    if not np.isfinite(maxima).all():
        raise ArgumentError("maxima: not all are finite")
    if float(maxima.max()) > bound:
        raise ArgumentError(f"maxima: {maxima.max():g} is above the bound, {bound:g}")
    if not (math.isfinite(ratio) and ratio > 0.0):
        raise ArgumentError(f"ratio = {ratio}: must be finite and above 0")
    # A power of two loses no digit: numbers near the ends of the range of floats are fitted as others are.
    power = math.frexp(float(np.abs(maxima).max()))[1]
    # Beside tiny maxima a bound may be more than a number can be: it is then out of reach, as if there were none.
    with np.errstate(over="ignore", under="ignore"):
        maxima, bound = np.ldexp(maxima, -power), float(np.ldexp(bound, -power))
    location, scale, count = _fit(maxima, bound)
    return Gumbel(float(np.ldexp(location, power)), float(np.ldexp(scale, power)), count, ratio)


def _fit(maxima: np.ndarray, bound: float) -> tuple[float, float, int]:
    """Location and scale of maxima (n,) up to a bound, and the number of those that the intervals are of."""
    if float(np.ptp(maxima)) <= 1e-12 * float(np.abs(maxima).max()):
        # All the same: nothing is random.
        return float(maxima[0]), 0.0, maxima.size
    free = maxima[maxima < bound]
    if free.size < 2:
        return bound, 0.0, maxima.size
    if free.size < maxima.size:
        return *_likeliest_censored(free, bound, maxima.size - free.size), max(free.size, FEWEST)
    location, scale = _likeliest(maxima[None])
    return float(location[0]), float(scale[0]), maxima.size


def _likeliest(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Location and scale of each row of (m, n) samples: beta = mean x - sum x e^(-x/beta) / sum e^(-x/beta)."""
    mean = samples.mean(axis=1)
    x = samples - mean[:, None]
    beta = np.maximum(x.std(axis=1) * math.sqrt(6.0) / math.pi, 1e-300)
    for _ in range(ITERATIONS):
        weight = np.exp(-(x - x.min(axis=1, keepdims=True)) / beta[:, None])
        total = weight.sum(axis=1)
        first, second = (x * weight).sum(axis=1) / total, (x * x * weight).sum(axis=1) / total
        # Newton's method on g(beta) = beta + <x>_w, of which the slope is 1 + var_w(x) / beta^2 > 0.
        step = (beta + first) / (1.0 + (second - first**2) / beta**2)
        new = np.where(beta - step > 0.0, beta - step, 0.5 * beta)
        change, beta = np.abs(new - beta), new
        if bool((change <= SETTLED * beta).all()):
            break
    least = x.min(axis=1)
    total = np.exp(-(x - least[:, None]) / beta[:, None]).mean(axis=1)
    return mean + least - beta * np.log(total), beta


def _likeliest_censored(free: np.ndarray, bound: float, censored: int) -> tuple[float, float]:
    """Location and scale of maxima below a bound (n,), with some more of which it is known that they are not below."""
    from scipy.optimize import minimize

    span = bound - float(free.min())

    def unlikeliness(x: np.ndarray) -> float:
        beta = math.exp(float(x[1]))
        z = ((free - bound) / span - x[0]) / beta
        # 1 - F at the bound, without loss of digits.
        beyond = -math.expm1(-math.exp(min(float(x[0]) / beta, 700.0)))
        if beyond == 0.0:
            return math.inf
        return float((x[1] + z + np.exp(np.minimum(-z, 700.0))).sum()) - censored * math.log(beyond)

    begin = np.array([0.0, math.log(0.5)])
    options = {"xatol": 1e-10, "fatol": 1e-12, "maxiter": 4000, "maxfev": 4000}
    found = minimize(unlikeliness, begin, method="Nelder-Mead", options=options)
    return bound + span * float(found.x[0]), span * math.exp(float(found.x[1]))


@functools.lru_cache(maxsize=16)
def _pivots(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Estimates of location and scale of samples of the standard distribution, sorted nowhere."""
    generator = np.random.default_rng(20_240_601)
    rows = max(1, min(SAMPLES, 4_000_000 // count))
    parts = [
        _likeliest(-np.log(generator.standard_exponential((min(2000, rows - k), count)))) for k in range(0, rows, 2000)
    ]
    return np.concatenate([one for one, _ in parts]), np.concatenate([two for _, two in parts])


def check_share(name: str, value: float) -> None:
    """Refuse a probability that is none.

    Raises
    ------
    ArgumentError
        Where it does not lie between 0 and 1.
    """
    if not 0.0 < value < 1.0:
        raise ArgumentError(f"{name} = {value}: must lie between 0 and 1")


def _tails(confidence: float) -> tuple[float, float]:
    check_share("confidence", confidence)
    return 0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)


def _beyond(reduced: float) -> float:
    """Probability of more than a reduced variate, without loss of digits where it is small."""
    return -math.expm1(-math.exp(min(-reduced, 700.0)))
