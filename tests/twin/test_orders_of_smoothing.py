"""Smoothing over many samples: as exact as over few, and no dearer than a row can cost."""

import time

import numpy as np
import pytest

from tautline.twin.signals.smoothing import smooth


def motion(t):
    return 4.0 * np.sin(0.3 * t) + 0.5 * np.sin(0.8 * t + 1.0)


RATE = 4.0 * 0.3 + 0.5 * 0.8 * np.cos(1.0)


@pytest.mark.parametrize("count", [3, 5, 10, 100, 1000])
@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_the_rate_of_a_motion_is_met_however_far_samples_reach(count, noise):
    t = 0.1 * np.arange(-count, count + 1)
    x = motion(t) + noise * np.random.default_rng(0).standard_normal(t.size)
    rate = smooth(t, x, 0.0, 1e9, noise)[1]
    assert rate == pytest.approx(RATE, abs=1e-8 + 15.0 * noise)


def test_samples_of_a_long_delay_cost_no_more_than_milliseconds():
    """A delay of 10 s at ten rows a second: orders up to 200, each with a decomposition, took seconds a row."""
    t = 0.1 * np.arange(-100, 101)
    begun = time.process_time()
    for _ in range(10):
        smooth(t, motion(t), 0.0, 10.0)
    assert time.process_time() - begun < 1.0
