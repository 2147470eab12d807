"""The curve through the rows of a table: what a run follows, and what a reader judges the rows by.

The natural cubic spline, but where it would leave monotone data. Slopes there as in Fritsch and Butland, "A method for
constructing local monotone piecewise cubic interpolants", SIAM J. Sci. Stat. Comput. 5 (1984) 300-304.
"""

from __future__ import annotations

import numpy as np

PLACES = 201
"""Places of an interval at which the curve is looked at."""


def slopes(time: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slope and second derivative at each time, for quintic Hermite pieces that are C2 everywhere.

    They are the natural cubic spline's, so the curve is that spline, but for knots beside an interval in which the
    data are monotone and the spline is not: there the slope is a limited harmonic mean (as in pchip) and the second
    derivative is zero. Such a quintic is monotone if both slopes are at most twice the secant's, so that monotone
    data are never overshot. Beside a crest of the data the spline may rise above them, as a sampled wave should.

    Parameters
    ----------
    time, value : float64 (rows,)
        At least two, the times growing, s.

    Returns
    -------
    slope, second : float64 (rows,)
        First and second derivative.
    """
    h, secant = np.diff(time), np.diff(value) / np.diff(time)
    n = len(time)
    second = np.zeros(n)
    if n > 2:
        from scipy.linalg import solve_banded

        band = np.zeros((3, n - 2))
        band[0, 1:], band[1], band[2, :-1] = h[1:-1], 2.0 * (h[:-1] + h[1:]), h[1:-1]
        second[1:-1] = solve_banded((1, 1), band, 6.0 * np.diff(secant))
    slope = np.append(secant - h * (2.0 * second[:-1] + second[1:]) / 6.0, 0.0)
    slope[-1] = secant[-1] + h[-1] * second[-2] / 6.0

    sign = np.sign(secant)
    around = np.column_stack((np.append(sign[0], sign[:-1]), sign, np.append(sign[1:], sign[-1])))
    monotone = (around.min(axis=1) >= 0.0) | (around.max(axis=1) <= 0.0) | (sign == 0.0)
    safe = np.concatenate((secant[:1], _limited(h, secant), secant[-1:]))
    changed = np.zeros(n, dtype=bool)
    x = np.linspace(0.0, 1.0, 33)
    while True:
        rows = hermite(h, value, slope, second)
        rate = sum(k * rows[:, k, None] * (x * h[:, None]) ** (k - 1) for k in range(1, 6))
        scale = 1e-9 * np.abs(secant) + 1e-300
        wrong = np.where(sign == 0.0, np.abs(rate).max(axis=1), -(rate * sign[:, None]).min(axis=1)) > scale
        spread = np.zeros(n, dtype=bool)
        spread[:-1] |= wrong & monotone
        spread[1:] |= wrong & monotone
        if not np.any(spread & ~changed):
            return slope, second
        changed |= spread
        slope[changed], second[changed] = safe[changed], 0.0


def _limited(h: np.ndarray, secant: np.ndarray) -> np.ndarray:
    """Harmonic mean of the secants on both sides of each inner knot, at most twice the smaller; 0 at a crest."""
    before, after = secant[:-1], secant[1:]
    same = before * after > 0.0
    weight = h[:-1] + 2.0 * h[1:], 2.0 * h[:-1] + h[1:]
    # A secant of next to nothing has a weight of infinity, and a mean of nothing.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        mean = (weight[0] + weight[1]) / (weight[1] / before + weight[0] / after)
    most = 2.0 * np.minimum(np.abs(before), np.abs(after))
    return np.where(same, np.clip(np.where(same, mean, 0.0), -most, most), 0.0)


def hermite(h: np.ndarray, f: np.ndarray, df: np.ndarray, ddf: np.ndarray) -> np.ndarray:
    """Quintics (n, 6) through values, slopes and second derivatives (n + 1,) at the ends of intervals h (n,).

    Coefficients stand in the order of powers of the time since the begin of the interval.
    """
    d = f[1:] - f[:-1] - h * (df[:-1] + 0.5 * h * ddf[:-1])
    e = h * (df[1:] - df[:-1] - h * ddf[:-1])
    g = 0.5 * h * h * (ddf[1:] - ddf[:-1])
    third = (10.0 * d - 4.0 * e + g) / h**3
    fourth = (-15.0 * d + 7.0 * e - 2.0 * g) / h**4
    fifth = (6.0 * d - 3.0 * e + g) / h**5
    return np.column_stack((f[:-1], df[:-1], 0.5 * ddf[:-1], third, fourth, fifth))


def beyond(time: np.ndarray, value: np.ndarray, intervals: np.ndarray) -> np.ndarray:
    """How far the curve goes beyond the two rows around an interval, in the unit of the value.

    Parameters
    ----------
    time, value : float64 (rows,)
    intervals : int64 (n,)
        Number of the row before each.

    Returns
    -------
    float64 (n,)
        Zero where the curve stays between the two values.
    """
    h = np.diff(time)
    rows, x = hermite(h, value, *slopes(time, value))[intervals], np.linspace(0.0, 1.0, PLACES)
    inside = sum(rows[:, k, None] * (x * h[intervals, None]) ** k for k in range(rows.shape[1]))
    above = inside.max(axis=1) - np.maximum(value[intervals], value[intervals + 1])
    below = np.minimum(value[intervals], value[intervals + 1]) - inside.min(axis=1)
    return np.maximum(np.maximum(above, below), 0.0)
