"""Value, rate and second rate of a measured input, from the samples on both sides of an instant.

A polynomial is laid through the samples by least squares (A. Savitzky and M. J. E. Golay, Analytical Chemistry 36,
1964; here for any stamps). Its order is the lowest, from a cubic on, that leaves no more than noise: what moves
smoothly is met to the digits of the sensor, and noise is not taken for motion. Where there are few samples, as beside a
gap, it is a parabola, a line or a constant.

A machine is moved at steady speeds with short changes between them. A change that takes about as long as rows are apart
is no polynomial: one through the samples on both sides swings about the motion for rows before and after it, and what
is driven by it is shaken near the rate of the rows. There the rate is that of the side on which the motion is steady
(as H. Akima, J. ACM 17, 1970, weighs slopes), and the change is left to the interval that it is in.
"""

from __future__ import annotations

import numpy as np

from tautline.twin.pace import ONE_STAMP

FEWEST = 5
"""Samples that a cubic takes."""
ACCEPTED = 1.5
"""Residual of a fit over the noise with which its order is high enough."""
WIDELY = 2.0
"""The same of a cubic that is laid widely: how large noise is is known to a half only."""
CUBIC = 7
"""And samples that a cubic takes which is laid widely."""
HIGHEST, RESOLVED = 10, 11
"""Highest order that is tried, and so many samples nearest to the instant that no fewer are taken where it is too low:
orders near the number of many samples swing between them, and each costs a decomposition of them all."""
AT_EDGE = 4
"""Highest order where samples are on one side only."""
FEWEST_AT_END = 3
"""Samples that tell with which rate an input leaves its last one, at the least."""
AGREED, BENDS_APART = 0.1, 0.2
"""Share of the range of slopes by which a cubic and a quartic may differ in their rates at the end of samples, where a
change of speed makes more than half of it; and how much less what they differ by in the second rate counts."""
UNRESOLVED = 0.02
"""Change of the rate with the last two orders, over the range of slopes, from which on no polynomial is the motion."""
WILD = 1.0
"""The same of an instant with samples on one side only."""
STEADY = 0.02
"""Bend of three samples, over the largest nearby, below which they are on a line."""
FIFTH = 252.0**0.5
REST = 0.7
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
    near = np.abs(t) <= reach + ONE_STAMP
    if near.sum() < FEWEST and t.size > near.sum():
        near = _nearest(t, FEWEST)
    t, x = t[near], values[near]
    if t.size == 0:
        return np.full(3, np.nan)
    count = t.size
    while True:
        closest = _nearest(t, count)
        found, met = _laid(t[closest], x[closest], noise)
        if met or count <= RESOLVED:
            return found
        count = max(RESOLVED, count // 2)


def _nearest(t: np.ndarray, count: int) -> np.ndarray:
    """Which of the samples (n,) are so many that are nearest to the instant, which is at zero."""
    near = np.zeros(t.size, bool)
    near[np.argsort(np.abs(t), kind="stable")[:count]] = True
    return near


def _laid(t: np.ndarray, x: np.ndarray, noise: float) -> tuple[np.ndarray, bool]:
    """Value, rate, second rate (3,) at zero of a polynomial through samples (n,); and whether it leaves but noise."""
    both = t[0] < 0.0 < t[-1]
    outside = t[0] > ONE_STAMP or t[-1] < -ONE_STAMP
    lowest = min(1 if outside else 3 if both else 2, t.size - (1 if t.size < FEWEST else 2))
    highest = min(t.size - 1, HIGHEST) if both else lowest if outside else max(lowest, min(t.size - 1, AT_EDGE))
    h = max(float(np.abs(t).max()), 1e-9)
    powers = (t / h)[:, None] ** np.arange(highest + 1)
    # The value is subtracted before the fit, so that a large offset costs no digits.
    y = x - x[0]
    rates: list[float] = []
    met = False
    for order in range(lowest, highest + 1):
        fit = np.linalg.lstsq(powers[:, : order + 1], y, rcond=None)[0]
        left = y - powers[:, : order + 1] @ fit
        rates.append(float(fit[1]) / h if order else 0.0)
        met = bool(left @ left <= (ACCEPTED * noise) ** 2 * max(t.size - order - 1, 0))
        if met:
            break
    else:
        k = int(np.argmin(np.abs(t)))
        rate = np.nan
        if abs(t[k]) > ONE_STAMP:
            pass  # the sample at the instant itself is missing
        elif both and _unresolved(t, y, rates, UNRESOLVED):
            rate = _steady_rate(t, y, k, noise)
        elif k == 0 and t.size > 1 and _unresolved(t, y, rates, WILD):
            rate = float((y[1] - y[0]) / (t[1] - t[0]))
        if np.isfinite(rate):
            return np.array([float(y[k] + x[0]), rate, 0.0]), met
    found = np.zeros(3)
    found[: min(3, fit.size)] = fit[:3]
    return np.array([found[0] + x[0], found[1] / h, 2.0 * found[2] / h**2]), met


def smooth_widely(
    times: np.ndarray, values: np.ndarray, at: float, widest: float, narrowest: float, noise: float
) -> np.ndarray | None:
    """Value, rate and second rate (3,) at an instant, from so many samples that noise does not shake a load.

    A cubic is laid through the samples with the weights of a raised cosine, which lets hardly anything through that is
    quicker than half its width. It is as wide as the motion is a cubic but for noise; where samples are mostly on
    one side it is a parabola.

    Parameters
    ----------
    times, values : (n,)
        Samples in order, s and SI.
    at : float
        s.
    widest, narrowest : float
        How far away samples are taken from, s.
    noise : float
        Standard deviation of the samples, SI.

    Returns
    -------
    (3,) or None
        None where there are too few samples.
    """
    wide, found = widest, None
    while wide >= narrowest - 1e-9:
        near = np.abs(times - at) <= wide + ONE_STAMP
        t, x = times[near] - at, values[near]
        if t.size < CUBIC:
            return found
        edge = wide * (1.0 + 2.0 / t.size)
        root = np.cos(0.5 * np.pi * t / edge)
        order = 3 if min(-t[0], t[-1]) > 0.5 * wide else 2
        powers = (t / wide)[:, None] ** np.arange(order + 1)
        fit = np.linalg.lstsq(powers * root[:, None], (x - x[0]) * root, rcond=None)[0]
        left = (x - x[0] - powers @ fit) * root
        found = np.array([fit[0] + x[0], fit[1] / wide, 2.0 * fit[2] / wide**2])
        if left @ left <= (WIDELY * noise) ** 2 * float(root @ root) * (1.0 - (order + 1) / t.size):
            break
        wide *= 0.8
    # What is not met so is a change of speed: the narrowest follows it best, and no noise is laid through.
    return found


def _unresolved(t: np.ndarray, y: np.ndarray, rates: list[float], share: float) -> bool:
    """Whether the rate still changes by a share of the range of slopes with the last two orders of a fit."""
    slopes = np.diff(y) / np.diff(t)
    return max(abs(one - rates[-1]) for one in rates[-3:]) > share * float(np.ptp(slopes))


def _steady_rate(t: np.ndarray, y: np.ndarray, k: int, noise: float) -> float:
    """Rate at the k-th sample by the side, of three samples, on which the motion is steady; NaN where none is.

    Where it is steady on both, the change is at the sample, or far from it: then it is the mean.
    """
    bends = np.abs(np.diff(np.diff(y) / np.diff(t)))
    most = STEADY * float(bends.max(initial=0.0))
    steady = []
    for first in (k - 2, k):
        if first < 0 or first + 3 > t.size:
            continue
        three = slice(first, first + 3)
        width = float(t[first + 2] - t[first])
        # Noise of a sample enters the difference of two slopes by the root of six over the interval.
        if bends[first] <= most + ACCEPTED * 6.0**0.5 * noise / (0.5 * width):
            steady.append(float(np.polyfit(t[three], y[three], 1)[0]))
    return float(np.mean(steady)) if steady else np.nan


def noise_of(values: np.ndarray) -> float:
    """Size of the noise that six neighbouring samples show, of which a smooth motion has none.

    The fifth difference of white noise has sqrt(252) times its standard deviation; that of a polynomial of fourth
    order is zero.
    """
    return abs(float(np.diff(values, 5)[-1])) / FIFTH if values.size >= 6 else 0.0


def bend_of(values: np.ndarray) -> float:
    """Size of the noise that three neighbouring samples show, of which a steady motion has none; as `noise_of`."""
    return abs(float(np.diff(values, 2)[-1])) / 6.0**0.5 if values.size >= 3 else 0.0


def third_of(values: np.ndarray) -> float:
    """Size of the noise by the last third difference of six neighbouring samples; as `noise_of`, with more motion."""
    return abs(float(np.diff(values, 3)[-1])) / 20.0**0.5 if values.size >= 6 else 0.0


def motion_at_end(times: np.ndarray, values: np.ndarray, reach: float, noise: float) -> np.ndarray:
    """Rate and second rate (2,) with which an input leaves the last of samples (n,), behind which no more come.

    Where the last five are a smooth motion it goes on. Else nothing tells of a bend: a polynomial through a change of
    speed, or through noise, has rates at its end that the input never had, and they lead away from all that was
    measured. There it is the rate of a line through the samples of the last reach, and no faster than lines through
    fewer and fewer of them allow, down to the last two: what has stopped stays.
    """
    smooth_one = _smooth_end(times[-FEWEST:], values[-FEWEST:], noise)
    if smooth_one is not None:
        return smooth_one
    near = times >= times[-1] - reach - ONE_STAMP
    count = min(times.size, max(int(near.sum()), FEWEST_AT_END))
    rate = np.nan
    while count > 1:
        t, x = times[-count:] - times[-1], values[-count:] - values[-1]
        t = t - t.mean()
        square = float(t @ t)
        slope, off = float(t @ x) / square, ACCEPTED * noise / square**0.5
        if np.isnan(rate):
            rate = slope
        elif rate > 0.0:
            rate = min(rate, max(slope + off, 0.0))
        else:
            rate = max(rate, min(slope - off, 0.0))
        count -= 1
    return np.array([0.0 if np.isnan(rate) else rate, 0.0])


def _smooth_end(times: np.ndarray, values: np.ndarray, noise: float) -> np.ndarray | None:
    """Rates (2,) at the last of five samples, where a cubic and a quartic agree on them; None where they do not."""
    if times.size < FEWEST:
        return None
    span = float(times[-1] - times[0])
    t, x = (times - times[-1]) / span, values - values[-1]
    range_of_slopes = float(np.ptp(np.diff(x) / np.diff(t)))
    cubic, quartic = (np.polynomial.polynomial.polyfit(t, x, order)[1:3] for order in (AT_EDGE - 1, AT_EDGE))
    # Of samples at equal intervals noise enters the rate of the quartic by 22 times itself over the span.
    apart = abs(quartic - cubic) * [1.0, 2.0 * BENDS_APART] + [22.0 * noise, 0.0]
    if apart.max() > AGREED * range_of_slopes:
        return None
    return np.array([quartic[0] / span, 2.0 * quartic[1] / span**2])


def coming_to_rest(state: np.ndarray, after: float, rest: float = REST) -> np.ndarray:
    """Value, rate and second rate of what comes to rest from a state (3,), a time after it.

    The rate dies away as a critically damped oscillator: the second rate goes on from where it was too, for what jumps
    in it sets off a load that bounces on its rope. A rate alone leads on by twice its product with the time constant.
    """
    left = np.exp(-after / rest)
    change = state[2] + state[1] / rest
    way = rest * state[1] * (1.0 - left) + rest**2 * change * (1.0 - left * (1.0 + after / rest))
    rate = (state[1] + change * after) * left
    return np.array([state[0] + way, rate, change * left - rate / rest])


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
