"""Functions of time inside compiled code: piecewise polynomials and sines, with two derivatives.

Function ``i`` is the sum of its tracks and its waves. A track is a polynomial on each side of every break; a wave is
``A E(t) sin(w t + c t^2 + phi)``, where E is one, or a quintic that grows from 0 to 1 over the first seconds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import entry, kernel

DEGREES = 8
"""Coefficients kept of a polynomial: up to degree 7, the integral of a ramp's rate."""
MANY = 5_000
"""Polynomials and sines from which sampling is compiled, which may take a second; so many take Python 50 ms at most."""


class TimeFunctions(NamedTuple):
    """All functions of a scene, one after another.

    Attributes
    ----------
    track_from : int64 (n + 1,)
        Tracks of function i are ``track_from[i]`` to ``track_from[i + 1]``.
    break_from : int64 (tracks + 1,)
        Breaks of track j likewise; its pieces, one more than breaks, begin at ``break_from[j] + j``.
    breaks : float64 (breaks,)
        Times, s; a piece begins at its break.
    origins : float64 (pieces,)
        Times that the polynomials are written about, s.
    coefficients : float64 (pieces, 8)
        Of rising powers of time since the origin.
    wave_from : int64 (n + 1,)
        Waves of function i.
    waves : float64 (waves, 5)
        Amplitude, w (rad/s), c (rad/s^2), phi (rad), and how long the envelope grows (s, 0: no envelope).
    """

    track_from: np.ndarray
    break_from: np.ndarray
    breaks: np.ndarray
    origins: np.ndarray
    coefficients: np.ndarray
    wave_from: np.ndarray
    waves: np.ndarray


@kernel
def evaluate(functions, i, t):
    """Return ``(f, df, ddf)`` of function `i` at time `t`: its value, rate and second rate."""
    f, df, ddf = 0.0, 0.0, 0.0
    for track in range(functions.track_from[i], functions.track_from[i + 1]):
        first, low, high = functions.break_from[track], functions.break_from[track], functions.break_from[track + 1]
        while low < high:
            middle = (low + high) // 2
            if functions.breaks[middle] <= t:
                low = middle + 1
            else:
                high = middle
        piece = first + track + (low - first)
        x = t - functions.origins[piece]
        p, dp, half = 0.0, 0.0, 0.0
        for k in range(DEGREES - 1, -1, -1):
            half = half * x + dp
            dp = dp * x + p
            p = p * x + functions.coefficients[piece, k]
        f += p
        df += dp
        ddf += 2.0 * half
    for j in range(functions.wave_from[i], functions.wave_from[i + 1]):
        a, w, c = functions.waves[j, 0], functions.waves[j, 1], functions.waves[j, 2]
        angle = functions.waves[j, 3] + t * (w + c * t)
        rate = w + 2.0 * c * t
        g = a * np.sin(angle)
        cosine = a * np.cos(angle)
        dg = cosine * rate
        ddg = 2.0 * c * cosine - g * rate * rate
        grows = functions.waves[j, 4]
        if t >= grows:
            f += g
            df += dg
            ddf += ddg
        elif t > 0.0:
            x = t / grows
            e = x * x * x * (10.0 + x * (6.0 * x - 15.0))
            de = 30.0 * (x * (1.0 - x)) ** 2 / grows
            dde = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (grows * grows)
            f += e * g
            df += de * g + e * dg
            ddf += dde * g + 2.0 * de * dg + e * ddg
    return f, df, ddf


_interpreted = getattr(evaluate, "py_func", evaluate)


def value_at(functions, i, t):
    """``(f, df, ddf)`` of function `i` at time `t`, s: what :func:`evaluate` computes, for callers in Python."""
    f, df, ddf = _interpreted(functions, i, t)
    return float(f), float(df), float(ddf)


def sample(functions, i, times):
    """Value, rate and second rate of function `i` at many times (m,) s, as an array (m, 3)."""
    out = np.empty((times.size, 3))
    terms = functions.track_from[i + 1] - functions.track_from[i] + functions.wave_from[i + 1] - functions.wave_from[i]
    if times.size * terms < MANY:
        for k, t in enumerate(times.tolist()):
            out[k] = _interpreted(functions, i, t)
    else:
        _sample(functions, i, times, out)
    return out


@entry
def _sample(functions, i, times, out):
    for k in range(times.size):
        out[k, 0], out[k, 1], out[k, 2] = evaluate(functions, i, times[k])
