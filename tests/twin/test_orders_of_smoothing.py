"""Smoothing over many samples: as exact as over few, and no dearer than a row can cost."""

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


def test_samples_of_a_long_delay_take_few_decompositions(monkeypatch):
    """A delay of 10 s at ten rows a second: orders up to 200, each with a decomposition, took seconds a row."""
    taken, own = [], np.linalg.lstsq
    monkeypatch.setattr(np.linalg, "lstsq", lambda a, *given, **more: taken.append(a.shape) or own(a, *given, **more))
    t = 0.1 * np.arange(-100, 101)
    smooth(t, motion(t), 0.0, 10.0)
    assert 0 < len(taken) < 60
    assert max(columns for _, columns in taken) <= 11


def test_noise_is_averaged_over_all_samples_that_are_waited_for():
    """Of rows at 100 Hz and 0.5 s to either side, in both rates; a cubic's own error is far below (closed form)."""
    t, noise = 0.01 * np.arange(-50, 51), 1e-3
    rng, found = np.random.default_rng(1), []
    for _ in range(40):
        x = np.sin(2.0 * np.pi * 0.1 * t) + noise * rng.standard_normal(t.size)
        found.append(smooth(t, x, 0.0, 0.5, noise)[1:])
    speed, acceleration = np.sqrt(np.mean((np.array(found) - [2.0 * np.pi * 0.1, 0.0]) ** 2, axis=0))
    # Of a cubic through n samples over 2 h the sd of the rate is sqrt(75 / 4 n) sd / h, of the second rate
    # sqrt(180 / n) sd / h^2.
    assert speed < 2.0 * np.sqrt(75.0 / (4.0 * t.size)) * noise / 0.5
    assert acceleration < 2.0 * np.sqrt(180.0 / t.size) * noise / 0.25
