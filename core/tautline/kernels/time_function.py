"""Functions of time inside compiled code: piecewise polynomials, sines, and the places of frames that these move.

A function is the sum of its tracks and its waves. A track is a polynomial on each side of every break; a wave is
``A E(t) sin(w t + c t^2 + phi)``, where E is one, or a quintic that grows from 0 to 1 over the first seconds. Or it is
one of the twelve numbers that place a frame, made of the frame's motions when it is asked for. An input has one more
track, which is written while a run goes on and then stands for the whole function.
"""

from __future__ import annotations

from types import FunctionType
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import entry, kernel
from tautline.kernels.memory import form_of
from tautline.kernels.moving_frame import (
    ENTRIES,
    MOTIONS,
    Lifts,
    MovingFrames,
    clear_place,
    height,
    new_frames,
    place_frame,
    places_of,
)
from tautline.kernels.separate import code_of, separate

DEGREES = 8
"""Coefficients kept of a polynomial: up to degree 7, the integral of a ramp's rate."""
MANY = 5_000
"""Polynomials and sines from which sampling is compiled, which may take a second; so many take Python 50 ms at most."""


TERMS = 14
"""Terms of the Taylor series that stands for many waves: of what turns by half a radian the next is 1e-15."""


class LongSums(NamedTuple):
    """Functions that are sums of many plain waves, each as its Taylor series about the middle of a short span of time.

    The spans follow one another from t = 0, so that what a function is depends on the time alone.

    Attributes
    ----------
    row : int64 (n,)
        Of function i in the following, or -1.
    span : float64 (k,)
        Length of a span, s: the fastest wave turns by one radian.
    begin : float64 (k,)
        Time from which all waves have their full size, s.
    number : float64 (k,)
        Which span the series is for.
    series : float64 (k, 14)
        Coefficients of rising powers of time since the middle of the span.
    """

    row: np.ndarray
    span: np.ndarray
    begin: np.ndarray
    number: np.ndarray
    series: np.ndarray


class TimeFunctions(NamedTuple):
    """All functions of a scene, one after another.

    Attributes
    ----------
    track_from, track_to : int64 (n,)
        Tracks of function i are ``track_from[i]`` to ``track_to[i]``, the last not counted.
    break_from : int64 (tracks + 1,)
        Breaks of track j likewise; its pieces, one more than breaks, begin at ``break_from[j] + j``.
    breaks : float64 (breaks,)
        Times, s; a piece begins at its break.
    origins : float64 (pieces,)
        Times that the polynomials are written about, s.
    coefficients : float64 (pieces, 8)
        Of rising powers of time since the origin.
    wave_from, wave_to : int64 (n,)
        Waves of function i.
    waves : float64 (waves, 5)
        Amplitude, w (rad/s), c (rad/s^2), phi (rad), and how long the envelope grows (s, 0: no envelope).
    entry : int64 (n,)
        Which number of which frame function i is, ``12 frame + number``; -1 where it is written as tracks and waves,
        and ``-2 - k`` where it is lift k.
    live : int64 (n,)
        The track of function i that is written while a run goes on, or -1: it is no input.
    frames : MovingFrames
        The frames that functions place.
    sums : LongSums
        Those of many waves.
    lifts : Lifts
        What frames lift.
    """

    track_from: np.ndarray
    track_to: np.ndarray
    break_from: np.ndarray
    breaks: np.ndarray
    origins: np.ndarray
    coefficients: np.ndarray
    wave_from: np.ndarray
    wave_to: np.ndarray
    waves: np.ndarray
    entry: np.ndarray
    live: np.ndarray
    frames: MovingFrames
    sums: LongSums
    lifts: Lifts


def no_functions() -> TimeFunctions:
    """A scene's functions of time where it has none."""
    none, ends = np.zeros(0), np.zeros(0, np.int64)
    return TimeFunctions(
        ends, ends, np.zeros(1, np.int64), none, none, np.zeros((0, DEGREES)), ends, ends, np.zeros((0, 5)), ends, ends,
        new_frames(ends, none, ends), LongSums(ends, none, none, none, np.zeros((0, TERMS))),
        Lifts(ends, ends, np.zeros((0, 3)), none, none, none),
    )  # fmt: skip


def copy_of(functions: TimeFunctions) -> TimeFunctions:
    """The same functions in memory of their own: inputs and long sums are written while a run goes on."""
    parts = (
        type(part)(*(one.copy() for one in part)) if isinstance(part, tuple) else part.copy() for part in functions
    )  # fmt: skip
    return TimeFunctions(*parts)


FUNCTIONS = form_of(no_functions())
"""The form of :class:`TimeFunctions`."""
THREE = (tuple, float, float, float)


@kernel
def evaluate(functions, i, t):
    """Return ``(f, df, ddf)`` of function `i` at time `t`: its value, rate and second rate.

    Either kind of function is compiled apart from its callers. What moves with a frame, or is a sum of many waves, most
    scenes do not have, and do not compile.
    """
    if functions.entry[i] != -1 or functions.sums.row[i] >= 0:
        return evaluate_any(functions, i, t)
    if functions.track_from[i] == functions.track_to[i] and functions.wave_from[i] == functions.wave_to[i]:
        return 0.0, 0.0, 0.0  # of nothing, such as the rotation of a string that is held
    return evaluate_written(functions, i, t)


@separate(THREE, FUNCTIONS, int, float)
def evaluate_written(functions, i, t):
    """The same of a function that is tracks and a few waves."""
    return _written(functions, i, t)


@separate(THREE, FUNCTIONS, int, float, late=True)
def evaluate_any(functions, i, t):
    """The same of any function."""
    number = functions.entry[i]
    if number == -1:
        return _summed(functions, i, t)
    if number < -1:
        return _lift(functions, -2 - number, t)
    frames = functions.frames
    if frames.time[0] != t:
        _place(functions, t, -1)
    k, j = number // ENTRIES, number % ENTRIES
    return frames.placed[k, 0, j], frames.placed[k, 1, j], frames.placed[k, 2, j]


def code_for(functions):
    """What evaluating a scene's functions comes to, as :func:`tautline.kernels.separate.code_of` has it."""
    plain = np.all(functions.entry == -1) and np.all(functions.sums.row < 0)
    return [code_of(each) for each in ((evaluate_written,) if plain else (evaluate_any, evaluate_written))]


@kernel
def _lift(functions, n, t):
    """Value, rate and second rate of a lift."""
    lifts, frames = functions.lifts, functions.frames
    k, point, gain = lifts.frame[n], lifts.point[n], lifts.gain[n]
    then = max(t - lifts.delay[n], 0.0)
    _place(functions, then, -1)
    f, df, ddf = height(frames, k, point, 0), height(frames, k, point, 1), height(frames, k, point, 2)
    _place(functions, then, lifts.still[n])
    f -= height(frames, k, point, 0)
    df -= height(frames, k, point, 1)
    ddf -= height(frames, k, point, 2)
    frames.time[0] = np.nan
    if t < lifts.delay[n]:
        df, ddf = 0.0, 0.0
    return gain * f + lifts.offset[n], gain * df, gain * ddf


@kernel
def _place(functions, t, still):
    """Place all frames at a time, parents before children; one of them may stay as it is drawn."""
    frames = functions.frames
    for k in range(frames.parent.size):
        clear_place(frames)
        for c in range(MOTIONS):
            i = frames.motion[k, c]
            if i >= 0 and k != still:
                frames.moved[c, 0], frames.moved[c, 1], frames.moved[c, 2] = _summed(functions, i, t)
        place_frame(frames, k)
    frames.time[0] = t


@kernel
def _summed(functions, i, t):
    """What `_written` gives; of many waves by their series."""
    sums, row = functions.sums, functions.sums.row[i]
    if row < 0 or functions.wave_to[i] == functions.wave_from[i] or t < sums.begin[row]:
        return _written(functions, i, t)
    number = np.floor(t / sums.span[row])
    if number != sums.number[row]:
        _expand(functions, i, row, number)
    f, df, ddf = _tracks(functions, i, t)
    x = t - (number + 0.5) * sums.span[row]
    p, dp, half = 0.0, 0.0, 0.0
    for k in range(TERMS - 1, -1, -1):
        half = half * x + dp
        dp = dp * x + p
        p = p * x + sums.series[row, k]
    return f + p, df + dp, ddf + 2.0 * half


@kernel
def _expand(functions, i, row, number):
    """Make the series of a sum of waves for a span of time."""
    sums = functions.sums
    middle = (number + 0.5) * sums.span[row]
    for k in range(TERMS):
        sums.series[row, k] = 0.0
    for j in range(functions.wave_from[i], functions.wave_to[i]):
        a, w = functions.waves[j, 0], functions.waves[j, 1]
        angle = functions.waves[j, 3] + w * middle
        sine, cosine = a * np.sin(angle), a * np.cos(angle)
        for k in range(TERMS):
            sums.series[row, k] += sine
            # The next derivative by time, over one factor more of the factorial.
            sine, cosine = w * cosine / (k + 1.0), -w * sine / (k + 1.0)
    sums.number[row] = number


@kernel
def _tracks(functions, i, t):
    """The part of a function that is written as tracks."""
    f, df, ddf = 0.0, 0.0, 0.0
    for track in range(functions.track_from[i], functions.track_to[i]):
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
    return f, df, ddf


@kernel
def _written(functions, i, t):
    """Value, rate and second rate of a function that is written as tracks and waves."""
    f, df, ddf = _tracks(functions, i, t)
    for j in range(functions.wave_from[i], functions.wave_to[i]):
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


def _in_python(function, **others):
    """A kernel as Python runs it, and with it those that it calls."""
    plain = getattr(function, "py_func", function)
    return FunctionType(plain.__code__, {**plain.__globals__, **others}, plain.__name__)


_interpreted = _in_python(_written, _tracks=_in_python(_tracks))


def value_at(functions, i, t):
    """``(f, df, ddf)`` of function `i` at time `t`, s: what :func:`evaluate` computes, for callers in Python."""
    if functions.entry[i] != -1:
        return tuple(float(x) for x in sample(functions, i, np.array([float(t)]))[0])
    f, df, ddf = _interpreted(functions, i, t)
    return float(f), float(df), float(ddf)


def sample(functions, i, times):
    """Value, rate and second rate of function `i` at many times (m,) s, as an array (m, 3)."""
    return sample_all(functions, [i], times)[0]


def sample_all(functions, numbers, times):
    """The same of several functions, (len(numbers), m, 3); frames are placed once for all of them."""
    out = np.empty((len(numbers), times.size, 3))
    placed = None
    for row, i in zip(out, numbers, strict=True):
        entry_ = int(functions.entry[i])
        if entry_ == -1:
            _sample_written(functions, int(i), times, row)
            continue
        if entry_ < -1:
            row[:] = _sample_lift(functions, -2 - entry_, times)
            continue
        if placed is None:
            placed = _sample_frames(functions, times)
        row[:] = placed[:, :, entry_ // ENTRIES, entry_ % ENTRIES].T
    return out


def _sample_written(functions, i, times, out):
    waves = functions.waves[functions.wave_from[i] : functions.wave_to[i]]
    terms = functions.track_to[i] - functions.track_from[i] + len(waves)
    if terms == 0:
        out[:] = 0.0
    elif times.size * terms >= MANY:
        _sample(functions, i, times, out)
    elif waves[:, 4].any():
        for k, t in enumerate(times.tolist()):
            out[k] = _interpreted(functions, i, t)
    else:
        out[:] = _written_at(functions, i, times, waves).T


def _written_at(functions, i, times, waves):
    """What :func:`_written` computes of tracks and waves that do not grow, for many times at once (3, m).

    The same numbers to the bit: where few are wanted, no code is compiled or loaded for them.
    """
    total = np.zeros((3, times.size))
    for track in range(functions.track_from[i], functions.track_to[i]):
        first, last = functions.break_from[track], functions.break_from[track + 1]
        piece = first + track + np.searchsorted(functions.breaks[first:last], times, side="right")
        x = times - functions.origins[piece]
        p, dp, half = np.zeros_like(total)
        for k in reversed(range(DEGREES)):
            half = half * x + dp
            dp = dp * x + p
            p = p * x + functions.coefficients[piece, k]
        total += p, dp, 2.0 * half
    for a, w, c, phase, _ in waves:
        angle, rate = phase + times * (w + c * times), w + 2.0 * c * times
        g, cosine = a * np.sin(angle), a * np.cos(angle)
        total += np.where(times >= 0.0, (g, cosine * rate, 2.0 * c * cosine - g * rate * rate), 0.0)
    return total


def _sample_lift(functions, n, times):
    """Value, rate and second rate (m, 3) of a lift at many times."""
    lifts = functions.lifts
    then = np.maximum(times - lifts.delay[n], 0.0)
    moved, at_rest = (_sample_frames(functions, then, still)[:, :, lifts.frame[n]] for still in (-1, lifts.still[n]))
    along, arm = moved - at_rest, lifts.point[n] - functions.frames.pivot[lifts.frame[n]]
    found = (along[..., 2] + along[..., [5, 8, 11]] @ arm).T * lifts.gain[n]
    found[times < lifts.delay[n], 1:] = 0.0
    found[:, 0] += lifts.offset[n]
    return found


def _sample_frames(functions, times, still=-1):
    """Places of all frames at many times, (3, m, frames, 12); one of them may stay as it is drawn."""
    frames = functions.frames
    moved = np.zeros((frames.parent.size, MOTIONS, times.size, 3))
    for k, c in np.argwhere(frames.motion >= 0):
        if k == still:
            continue
        _sample_written(functions, int(frames.motion[k, c]), times, moved[k, c])
    return np.stack(places_of(frames.parent, frames.pivot, moved))


@entry
def _sample(functions, i, times, out):
    for k in range(times.size):
        out[k, 0], out[k, 1], out[k, 2] = _written(functions, i, times[k])
