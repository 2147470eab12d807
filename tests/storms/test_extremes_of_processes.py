"""Extremes are right where they are known: Gumbel's own samples, exponential peaks, Rayleigh maxima, Rice's formula."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from of_the_suite import studies
from references.gaussian import exceedance, maximum_percentile, moments, most_probable_maximum, upcrossing_rate
from scipy.stats import CensoredData, binom, genpareto, gumbel_r

from tautline.errors import ArgumentError
from tautline.statistics.gumbel import Gumbel, fit_gumbel
from tautline.statistics.peaks import Peaks, fit_pareto, peaks_over

HOURS3 = 10800.0


def band(trials, confidence=0.9, miss=1e-3):
    """Numbers of intervals that hold, outside of which one of a thousand honest tests falls."""
    return binom.ppf(0.5 * miss, trials, confidence), binom.ppf(1.0 - 0.5 * miss, trials, confidence)


def test_the_fit_is_that_of_scipy():
    sample = gumbel_r.rvs(40.0, 3.0, size=25, random_state=3)
    found = fit_gumbel(sample)
    assert (found.location, found.scale) == pytest.approx(gumbel_r.fit(sample), rel=1e-5)


@pytest.mark.parametrize("bound", [38.0, 41.0, 46.0])
def test_the_fit_to_maxima_of_which_some_are_at_a_bound_is_that_of_scipy_to_censored_data(bound):
    """40 maxima around 41: most, half or a few of them are at the bound."""
    sample = gumbel_r.rvs(40.0, 3.0, size=40, random_state=5)
    free, censored = sample[sample < bound], int((sample >= bound).sum())
    found = fit_gumbel(np.minimum(sample, bound), bound=bound)
    expected = gumbel_r.fit(CensoredData(uncensored=free, right=np.full(censored, bound)))
    assert (found.location, found.scale) == pytest.approx(expected, rel=1e-3)
    assert found.count == free.size


def test_maxima_that_are_all_at_a_bound_tell_nothing_but_that_it_is_reached():
    for sample in (np.full(5, 7.0), np.array([7.0, 7.0, 6.0, 7.0])):
        found = fit_gumbel(sample, bound=7.0)
        assert (found.location, found.scale) == (7.0, 0.0)
        assert found.exceedance(6.9).value == 1.0


LOCATION, SCALE, RATIO, TRIALS = 52.0, 4.0, 6.0, 750


@cache
def fits(count):
    """Fits of so many trials: the mode and a percentile are asked of the same ones."""
    generator = np.random.default_rng(11 + count)
    samples = LOCATION + SCALE * -np.log(generator.standard_exponential((TRIALS, count)))
    return [fit_gumbel(sample, RATIO) for sample in samples]


@pytest.mark.parametrize("count", [5, 40, *studies(10)])
@pytest.mark.parametrize("share", [None, 0.9])
def test_ninety_percent_of_the_intervals_hold_for_samples_of_gumbels_distribution(count, share):
    reduced = 0.0 if share is None else -math.log(-math.log(share))
    truth = LOCATION + SCALE * (math.log(RATIO) + reduced)
    held = 0
    for fitted in fits(count):
        found = fitted.most_probable() if share is None else fitted.percentile(share)
        held += found.low <= truth <= found.high
    low, high = band(TRIALS)
    assert low <= held <= high


def test_ninety_percent_of_the_intervals_of_the_exceedance_hold():
    trials, level = 750, 60.0
    generator = np.random.default_rng(5)
    truth = gumbel_r.sf(level, 52.0, 4.0)
    held = 0
    for sample in 52.0 + 4.0 * -np.log(generator.standard_exponential((trials, 10))):
        found = fit_gumbel(sample).exceedance(level)
        held += found.low <= truth <= found.high
        assert found.low <= found.value <= found.high
    low, high = band(trials)
    assert low <= held <= high


@pytest.mark.parametrize("shape", [0.0, -0.15])
def test_ninety_percent_of_the_intervals_over_a_threshold_hold(shape):
    # Clusters of a Poisson process whose excess is exponential, or generalised Pareto: intervals are asymptotic, so
    # they are asked of 80 clusters and more.
    trials, rate, scale, threshold, duration = 60, 0.01, 3.0, 50.0, 10000.0
    generator = np.random.default_rng(8)
    number = rate * HOURS3 / -math.log(0.9)
    grown = math.log(number) if shape == 0.0 else (number**shape - 1.0) / shape
    truth, held = threshold + scale * grown, 0
    for _ in range(trials):
        count = generator.poisson(rate * duration)
        beyond = genpareto.rvs(shape, scale=scale, size=count, random_state=generator)
        peaks = Peaks(threshold, duration, np.sort(generator.uniform(0.0, duration, count)), threshold + beyond)
        found = fit_pareto(peaks, 0.0 if shape == 0.0 else None).percentile(HOURS3, 0.9)
        held += found.low <= truth <= found.high
    low, high = band(trials)
    assert low <= held <= high


def narrow(seeds, step, duration, sigma=2.0, centre=0.8, width=0.3, waves=400, rng=1):
    """Gaussian records of a spectrum that is flat over a band, one a row; and its moments."""
    generator = np.random.default_rng(rng)
    edges = np.linspace(centre - width, centre + width, waves + 1)
    time = np.arange(0.0, duration, step)
    rows = []
    for _ in range(seeds):
        w = edges[:-1] + np.diff(edges) * generator.random(waves)
        a, b = sigma / math.sqrt(waves) * generator.standard_normal((2, waves))
        rows.append(_sum(a, b, w, time))
    fine = np.linspace(centre - width, centre + width, 2001)
    return time, np.array(rows), moments(fine, np.full(fine.size, sigma**2 / (2.0 * width)))


def _sum(a, b, w, time, block=50):
    """The sum of a cos(w t) + b sin(w t) at equally spaced times.

    exp(i w t) of a time is that of the begin of its block times that of the place in it: few of them have to be found.
    """
    begin, within = np.exp(1j * np.outer(time[::block], w)), np.exp(1j * np.outer(time[:block], w))
    return ((begin * (a - 1j * b)) @ within.T).real.ravel()[: time.size]


def test_maxima_of_a_narrow_banded_process_are_those_of_rayleigh_and_rice():
    # 60 records of 1500 s. Closed form: sqrt(2 m0 ln N) within the interval of the fit; that its intervals hold is
    # shown by the tests above, here is one draw, at 99 % so that it is no matter of luck.
    duration = 1500.0
    _, rows, (m0, m2) = narrow(60, 0.4, duration)
    cycles = duration * upcrossing_rate(m0, m2)
    fitted = fit_gumbel(rows.max(axis=1))
    found = fitted.most_probable(0.99)
    # The mode of the largest of clustered peaks lies a little below that of independent ones.
    assert found.low <= most_probable_maximum(m0, cycles) <= found.high + 0.03 * math.sqrt(m0)
    assert fitted.percentile(0.9).value == pytest.approx(maximum_percentile(m0, cycles, 0.9), rel=0.06)
    level = maximum_percentile(m0, cycles, 0.7)
    chance = fitted.exceedance(level, 0.99)
    assert chance.low - 0.05 <= exceedance(m0, m2, duration, level) <= chance.high
    crossings = ((rows[:, 1:] > m0**0.5) & (rows[:, :-1] <= m0**0.5)).sum() / (60 * duration)
    assert crossings == pytest.approx(upcrossing_rate(m0, m2, m0**0.5), rel=0.05)


def test_most_probable_maximum_is_that_of_rayleigh_peaks():
    # Independent Rayleigh peaks: the mode of the largest of N, by its own density, which no formula here made.
    sigma, count = 3.0, 1000
    x = np.linspace(0.0, 8.0 * sigma, 400_001)
    log_density = (
        (count - 1) * np.log1p(-np.exp(-0.5 * (x[1:] / sigma) ** 2)) + np.log(x[1:]) - 0.5 * (x[1:] / sigma) ** 2
    )
    mode = x[1:][np.argmax(log_density)]
    assert most_probable_maximum(sigma**2, count) == pytest.approx(mode, rel=0.012)


def test_clusters_are_counted_once_and_keep_their_largest():
    time = np.arange(0.0, 100.0)
    values = np.zeros(100)
    values[[10, 12, 14, 50, 90]] = [3.0, 5.0, 4.0, 2.0, 6.0]
    found = peaks_over(time, values, 1.0, 5.0)
    assert found.time.tolist() == [12.0, 50.0, 90.0]
    assert found.value.tolist() == [5.0, 2.0, 6.0]


def test_the_mode_of_an_exponential_tail_is_the_threshold_and_the_log_of_the_number():
    generator = np.random.default_rng(2)
    beyond = generator.exponential(3.0, 200)
    fitted = fit_pareto(Peaks(50.0, 20000.0, np.arange(200.0), 50.0 + beyond), 0.0)
    found = fitted.most_probable(HOURS3)
    assert found.value == pytest.approx(50.0 + beyond.mean() * math.log(0.01 * HOURS3), rel=1e-12)
    assert fitted.exceedance(HOURS3, found.value) == pytest.approx(1.0 - math.exp(-1.0), rel=1e-9)


def test_what_cannot_be_fitted_is_refused():
    with pytest.raises(ValueError, match="3 at least"):
        fit_gumbel(np.array([1.0, 2.0]))
    with pytest.raises(ValueError, match="finite"):
        fit_gumbel(np.array([1.0, 2.0, math.nan]))
    with pytest.raises(ValueError, match="lower threshold"):
        fit_pareto(Peaks(1.0, 10.0, np.zeros(3), np.array([2.0, 3.0, 4.0])))


@pytest.mark.parametrize("scale", [0.0, 1.0])
@pytest.mark.parametrize("confidence", [0.0, 1.0, 5.0, math.nan])
def test_a_confidence_that_is_no_probability_is_refused_whether_the_maxima_differ_or_not(scale, confidence):
    of = Gumbel(1.0, scale, 5)
    for asked in (lambda: of.exceedance(2.0, confidence), lambda: of.percentile(0.5, confidence)):
        with pytest.raises(ArgumentError, match="confidence = "):
            asked()
    of = fit_pareto(Peaks(0.0, 1000.0, np.arange(20.0), np.linspace(0.1, 3.0, 20)), 0.0)
    with pytest.raises(ArgumentError, match="confidence = "):
        of.percentile(HOURS3, 0.5, confidence)


def test_the_python_of_the_page_runs_as_it_stands():
    page = (Path(__file__).parents[2] / "docs" / "operability.md").read_text()
    block = page.split("```python\n")[1].split("```")[0]
    names = {}
    exec(block, names)
    assert names["fit"].percentile(0.9).value > names["fit"].most_probable().value > 52.0


@pytest.mark.parametrize("bound", [np.inf, 3.0])
@pytest.mark.parametrize("power", [-1000, 1, 1000])
def test_maxima_near_the_ends_of_the_range_of_numbers_are_fitted_as_any_others(power, bound):
    """The estimates are equivariant: of 2^k x they are 2^k times those of x, to the last digit."""
    maxima = np.array([1.0, 2.0, 3.0, 2.5, 3.0])
    one = fit_gumbel(maxima, bound=bound)
    other = fit_gumbel(np.ldexp(maxima, power), bound=float(np.ldexp(bound, power)))
    assert (other.location, other.scale) == (np.ldexp(one.location, power), np.ldexp(one.scale, power))
    assert one.scale > 0.0 and other.count == one.count
