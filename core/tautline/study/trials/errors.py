"""How far a run is from a reference: in position, force, twist and phase, and by the thesis' eq. 2.173.

All but the last are relative: to the largest way of the point, to the force's amplitude, to what the twist varies by,
to a radian.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.study.trials.history import RESTING, History, twists

PERIODS = 2.0
"""Periods of a mode that a record must hold for its phase to mean something."""
HARDLY = 0.01
"""Amplitude of a force, over its largest value, that errors are related to at least: one of 0.4 N in 5 kN counts as
little where that force hardly varies as where it does."""
SHOWN = 0.2
"""Share of its motion that a mode must make up for its phase to mean something."""


class Errors(NamedTuple):
    """Errors of a run; None where a scene has nothing of the kind.

    Attributes
    ----------
    position : float
        Largest distance of the point from where it should be, over the largest way that it goes.
    force : float or None
        Difference of the axial force's amplitude (half of its range), over that amplitude, or over `HARDLY` of the
        largest force where that is more.
    phase : float or None
        Mean lag of the motion's first mode, rad.
    rmse : float
        Root of the mean square of the difference in the point's distance from the origin, m: eqs 2.172 and 2.173.
    twist : float or None
        Largest difference of a string's twist, over what that varies by.
    """

    position: float
    force: float | None
    phase: float | None
    rmse: float
    twist: float | None = None


def compare(run: History, reference: History, extent: float) -> Errors:
    """Errors of a run against a reference that covers its time.

    Parameters
    ----------
    run, reference : History
        Frames may be at other times; those of the reference are joined by a cubic spline.
    extent : float
        Size of the scene, m, against which a point that rests is judged.
    """
    exact = at_times(reference, run.time)
    _, position, force = apart(run, exact, extent)
    norms = np.linalg.norm(run.position, axis=1) - np.linalg.norm(exact.position, axis=1)
    rmse = float(np.sqrt(np.mean(norms**2)))
    return Errors(position, force, _phase(run, exact), rmse, twist_apart(run, exact))


def apart(run: History, exact: History, extent: float) -> tuple[float, float, float | None]:
    """How far two histories of the same times are apart: largest distance, m, and that of position and of force.

    The last two are relative, as in :class:`Errors`. Of a string that turns in place, what its point does within what
    counts as rest is left by iterations: the position is right.
    """
    distance, size = float(np.linalg.norm(run.position - exact.position, axis=1).max()), motion(exact, extent)
    rests = twists(exact.twist) and max(distance, size) <= RESTING * extent
    return distance, 0.0 if rests else distance / size, _force(run.force, exact.force)


def twist_apart(run: History, exact: History) -> float | None:
    """Largest difference of the twist of a string, over what it varies by; None where it hardly varies."""
    if not run.twist.size or not twists(exact.twist):
        return None
    return float(np.abs(run.twist - exact.twist).max() / np.ptp(exact.twist))


def ends_apart(run: np.ndarray, exact: np.ndarray) -> float:
    """By how much the highest and the lowest value of a force are off together, over its range.

    It is no less than the error of the amplitude, in which both may cancel.
    """
    top, bottom = float(exact.max()), float(exact.min())
    size = 2.0 * force_size(exact)
    apart_by = abs(float(run.max()) - top) + abs(float(run.min()) - bottom)
    if size == 0.0:
        return 0.0 if apart_by == 0.0 else float("inf")
    return apart_by / size


def force_size(force: np.ndarray) -> float:
    """What errors of a force are related to, N: its amplitude, and no less than `HARDLY` of its largest value."""
    return max(0.5 * float(np.ptp(force)), HARDLY * float(np.abs(force).max()))


def motion(history: History, extent: float) -> float:
    """The largest distance that a point moves, m, and no less than what counts as rest in a scene of that extent."""
    moved = np.linalg.norm(history.position - history.position[0], axis=1).max()
    return max(float(moved), RESTING * extent) or 1.0


def at_times(history: History, time: np.ndarray) -> History:
    """A history at other times within its own."""
    if history.time.size == time.size and np.allclose(history.time, time, rtol=0.0, atol=1e-12 * max(1.0, time[-1])):
        return history
    if history.time.size < 4:
        columns = [np.interp(time, history.time, column) for column in history.position.T]
        scalars = (np.interp(time, history.time, x) if x.size else x for x in (history.force, history.twist))
        return History(time, np.stack(columns, axis=1), *scalars)
    from scipy.interpolate import CubicSpline

    scalars = (CubicSpline(history.time, x)(time) if x.size else x for x in (history.force, history.twist))
    return History(time, CubicSpline(history.time, history.position)(time), *scalars)


def _force(run: np.ndarray, exact: np.ndarray) -> float | None:
    if not exact.size:
        return None
    amplitude = 0.5 * float(np.ptp(exact))
    size = force_size(exact)
    if size == 0.0:
        return 0.0 if not run.any() else float("inf")
    return abs(0.5 * float(np.ptp(run)) - amplitude) / size


def _phase(run: History, exact: History) -> float | None:
    """Lag of the first mode: by how much its part of the motion is turned in the complex plane."""
    centred = exact.position - exact.position.mean(axis=0)
    if exact.time.size < 8 or not centred.any():
        return None
    direction = np.linalg.svd(centred, full_matrices=False)[2][0]
    true, seen = centred @ direction, (run.position - exact.position.mean(axis=0)) @ direction
    omega = first_mode(exact.time, true)
    if omega is None:
        return None
    part, other = (_part(exact.time, x, omega) for x in (true, seen))
    return abs(float(np.angle(other / part))) if part and other else None


def first_mode(time: np.ndarray, motion: np.ndarray) -> float | None:
    """Angular frequency of the strongest line of a motion (m,), rad/s; None where none stands out or lasts."""
    span = float(time[-1] - time[0])
    even = np.linspace(time[0], time[-1], time.size)
    x = np.interp(even, time, motion - motion.mean())
    size = np.abs(np.fft.rfft(x * np.hanning(x.size), 4 * x.size))
    frequency = np.fft.rfftfreq(4 * x.size, even[1] - even[0])
    lasting = frequency * span >= PERIODS
    if not lasting[:-1].any() or not size.any():
        return None
    peak = int(np.where(lasting, size, 0.0).argmax())
    if size[peak] < size[max(peak - 1, 0)]:
        return None  # the flank of something slower, which does not last
    from scipy.optimize import minimize_scalar

    bounds = tuple(2.0 * np.pi * frequency[np.clip([peak - 2, peak + 2], 1, frequency.size - 1)])
    best = minimize_scalar(lambda w: -abs(_part(time, motion, w)), bounds=bounds, method="bounded")
    share = 2.0 * abs(_part(time, motion, best.x)) / max(0.5 * float(np.ptp(motion)), 1e-300)
    return float(best.x) if share >= SHOWN else None


def _part(time: np.ndarray, motion: np.ndarray, omega: float) -> complex:
    """Complex amplitude, by halves, of a frequency in a motion, under Hann's window."""
    window = np.sin(np.pi * (time - time[0]) / (time[-1] - time[0])) ** 2
    window /= window.sum()
    return complex(np.sum(window * (motion - np.sum(window * motion)) * np.exp(-1j * omega * time)))
