"""Fits to few peaks keep a shape of which theory holds, and their intervals miss the truth as seldom as they say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binom, genpareto

from benchmarks.accuracy import pareto
from tautline.errors import ArgumentError
from tautline.statistics.peaks import SHAPES, Peaks, fit_pareto, peaks_over

HOURS3 = 10800.0


def peaks_of(excess, threshold=5.0):
    excess = np.asarray(excess, float)
    return Peaks(threshold, 3600.0, np.arange(excess.size) * 10.0, threshold + excess)


@pytest.mark.parametrize("shape", [-0.3, 0.0, 0.2])
def test_the_fit_to_many_peaks_is_that_of_scipy(shape):
    excess = genpareto.rvs(shape, scale=3.0, size=400, random_state=7)
    expected, _, scale = genpareto.fit(excess, floc=0.0)
    found = fit_pareto(peaks_of(excess))
    assert (found.shape, found.scale) == (pytest.approx(expected, abs=1e-4), pytest.approx(scale, rel=1e-4))
    assert not found.bounded


def test_equal_peaks_have_the_least_shape_and_the_scale_of_their_excess():
    # By hand: -n ln s + n ln(1 - y / 2 s), the likelihood of the shape -1/2, is largest at s = y.
    found = fit_pareto(peaks_of(np.full(19, 1.7)))
    assert (found.shape, found.scale) == (-0.5, pytest.approx(1.7, rel=1e-9))
    assert found.bounded and not fit_pareto(peaks_of(np.full(19, 1.7)), -0.5).bounded
    assert found.percentile(HOURS3, 0.9).value > 5.0 + 1.7 * 1.5


def test_the_extreme_of_three_times_the_record_is_above_the_largest_peak_however_few_there_are():
    # Of exponential peaks, the likelihood of a shape below -1 has no largest value, and a third of fits ran there.
    generator = np.random.default_rng(8)
    for excess in generator.standard_exponential((8, 10)):
        fit = fit_pareto(peaks_of(excess))
        assert SHAPES[0] <= fit.shape <= SHAPES[1]
        number = 10.0 * HOURS3 / 3600.0
        expected = 5.0 + genpareto.ppf(1.0 + math.log(0.9) / number, fit.shape, scale=fit.scale)
        found, mode = fit.percentile(HOURS3, 0.9), fit.most_probable(HOURS3)
        assert found.value == pytest.approx(expected, rel=1e-9)
        assert found.low <= found.value <= found.high and mode.low <= mode.value <= mode.high
        assert found.value > 5.0 + excess.max()


SEEN = [
    1.906, 0.028, 0.657, 1.541, 0.691, 0.75, 1.613, 1.902, 0.456, 1.241, 1.691, 0.464, 0.661, 0.749, 0.4, 1.371, 1.316,
    0.808, 1.24,
]  # fmt: skip
"""Excesses of a shape of -0.2 whose estimate was -1.5, and whose interval a traceback."""


def test_an_interval_holds_its_value_where_the_peaks_ask_for_a_shape_below_the_least():
    found = fit_pareto(peaks_of(SEEN)).percentile(HOURS3, 0.9)
    assert found.low < found.value < found.high
    # The shape and scale that they were drawn with are -0.2 and 1, with 20 clusters in the record.
    number = 20.0 * HOURS3 / 3600.0 / -math.log(0.9)
    assert found.low < 5.0 - math.expm1(-0.2 * math.log(number)) / 0.2 < found.high


@pytest.mark.parametrize(
    ("call", "cause"),
    [
        (lambda fit: fit.percentile(1.0, 0.9), "below the threshold"),
        (lambda fit: fit.most_probable(50.0), "below the threshold"),
        (lambda fit: fit.percentile(-1.0, 0.9), "duration = -1"),
        (lambda fit: fit.percentile(math.nan, 0.9), "duration = nan"),
        (lambda fit: fit.exceedance(0.0, 6.0), "duration = 0"),
        (lambda fit: fit.exceedance(HOURS3, math.nan), "level = nan"),
        (lambda fit: fit_pareto(peaks_of(SEEN), -0.8), "shape = -0.8"),
        (lambda fit: fit_pareto(peaks_of([*SEEN, math.nan])), "not all are finite"),
        (lambda fit: fit_pareto(peaks_of([*SEEN, 0.0])), "above the threshold"),
        (lambda fit: fit_pareto(peaks_of(SEEN)._replace(duration=0.0)), "duration = 0"),
    ],
)
def test_what_a_fit_cannot_tell_is_refused_by_name(call, cause):
    with pytest.raises(ArgumentError, match=cause):
        call(fit_pareto(peaks_of(SEEN)))


@pytest.mark.parametrize(
    ("time", "values", "more", "cause"),
    [
        ([], [], (0.5, 1.0), "2 at least"), ([0.0, 1.0], [1.0], (0.5, 1.0), "of one length"),
        ([0.0, 1.0, 2.0], [1.0, math.nan, 2.0], (0.5, 1.0), "finite"),
        ([0.0, 2.0, 1.0], [1.0, 2.0, 2.0], (0.5, 1.0), "increase"),
        ([0.0, 1.0], [1.0, 2.0], (math.nan, 1.0), "threshold = nan"),
        ([0.0, 1.0], [1.0, 2.0], (0.5, -1.0), "apart = -1"),
    ],
)  # fmt: skip
def test_records_that_are_none_are_refused(time, values, more, cause):
    with pytest.raises(ArgumentError, match=cause):
        peaks_over(np.array(time), np.array(values), *more)


@pytest.mark.study
@pytest.mark.parametrize("clusters", [20, 80, 200])
@pytest.mark.parametrize("shape", [-0.1, 0.0])
def test_the_truth_lies_above_the_interval_no_more_often_than_in_a_twentieth_of_the_records(clusters, shape):
    trials = 500
    held = pareto.coverage(clusters, shape, trials=trials, seed=3)
    # Out of which one of a thousand honest intervals falls.
    assert held.below * trials <= binom.ppf(0.999, trials, 0.05)
    assert held.above * trials <= binom.ppf(0.999, trials, 0.05)


def test_the_table_of_coverage_is_counted_on_the_side_that_it_names():
    # With the shape known an interval of 90 % is one within the binomial error of few trials.
    held = pareto.coverage(20, 0.0, known=True, trials=40)
    assert held.inside == pytest.approx(1.0 - held.below - held.above) and held.inside > 0.7
    # Told an exponential tail, a fit to a heavier one stays too low.
    held = pareto.coverage(200, 0.4, known=True, trials=10)
    assert held == (0.0, 1.0, 0.0)
