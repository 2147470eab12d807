"""Value, rate and second rate of a measured input, from the samples on both sides of an instant.

A polynomial is laid through the samples by least squares (A. Savitzky and M. J. E. Golay, Analytical Chemistry 36,
1964; here for any stamps). Its order is the lowest, from a cubic on, that leaves no more than noise: what moves
smoothly is met to the digits of the sensor, and noise is not taken for motion. Where there are few samples, as beside a
gap, it is a parabola, a line or a constant.
"""

from __future__ import annotations

import numpy as np

FEWEST = 5
"""Samples that a cubic takes."""
ACCEPTED = 1.5
"""Residual of a fit over the noise with which its order is high enough."""
AT_EDGE = 4
"""Highest order where samples are on one side only."""
FIFTH = 252.0**0.5
REST = 1.0
"""Time constant with which a motion comes to rest where samples are missing, s."""


def smooth(times: np.ndarray, values: np.ndarray, at: float, reach: float, noise: float = 0.0) -> np.ndarray:
    """Value, rate and second rate (3,) at an instant.

    Parameters
    ----------
    times, values : (n,)
        Samples in order, s and SI.
    at : float
        s.
    reach : float
        Samples further away than this, s, are left out, as long as there are enough.
    noise : float
        Standard deviation of the samples, SI.

    Returns
    -------
    (3,)
        NaN where there is no sample.
    """
    t = times - at
    near = np.abs(t) <= reach + 1e-9
    if near.sum() < FEWEST and t.size > near.sum():
        near = np.zeros(t.size, bool)
        near[np.argsort(np.abs(t), kind="stable")[:FEWEST]] = True
    t, x = t[near], values[near]
    if t.size == 0:
        return np.full(3, np.nan)
    both = t[0] < 0.0 < t[-1]
    outside = t[0] > 1e-9 or t[-1] < -1e-9
    lowest = min(1 if outside else 3 if both else 2, t.size - (1 if t.size < FEWEST else 2))
    highest = t.size - 1 if both else lowest if outside else max(lowest, min(t.size - 1, AT_EDGE))
    h = max(float(np.abs(t).max()), 1e-9)
    powers = (t / h)[:, None] ** np.arange(highest + 1)
    # The value is subtracted before the fit, so that a large offset costs no digits.
    y = x - x[0]
    for order in range(lowest, highest + 1):
        fit = np.linalg.lstsq(powers[:, : order + 1], y, rcond=None)[0]
        left = y - powers[:, : order + 1] @ fit
        if left @ left <= (ACCEPTED * noise) ** 2 * max(t.size - order - 1, 0):
            break
    found = np.zeros(3)
    found[: min(3, fit.size)] = fit[:3]
    return np.array([found[0] + x[0], found[1] / h, 2.0 * found[2] / h**2])


def noise_of(values: np.ndarray) -> float:
    """Size of the noise that six neighbouring samples show, of which a smooth motion has none.

    The fifth difference of white noise has sqrt(252) times its standard deviation; that of a polynomial of fourth
    order is zero.
    """
    return abs(float(np.diff(values, 5)[-1])) / FIFTH if values.size >= 6 else 0.0


def coming_to_rest(state: np.ndarray, after: float) -> np.ndarray:
    """Value, rate and second rate of what comes to rest from a state (3,), a time after it."""
    left = np.exp(-after / REST)
    return np.array([state[0] + state[1] * REST * (1.0 - left), state[1] * left, -state[1] / REST * left])


def joined(apart: np.ndarray, share: float, over: float) -> np.ndarray:
    """What is left of a difference (3,) that goes to zero over a time, at a share of it.

    A quintic with value, rate and second rate of the difference at its begin and zero at its end.
    """
    if share >= 1.0:
        return np.zeros(3)
    f, g, s = apart[0], apart[1] * over, 0.5 * apart[2] * over**2
    c = np.array([f, g, s, -10.0 * f - 6.0 * g - 3.0 * s, 15.0 * f + 8.0 * g + 3.0 * s, -6.0 * f - 3.0 * g - s])
    k = np.arange(6)
    powers = share**k
    value = c @ powers
    rate = (c[1:] * k[1:]) @ powers[:-1] / over
    second = (c[2:] * k[2:] * k[1:-1]) @ powers[:-2] / over**2
    return np.array([value, rate, second])
