"""Amplitude spectra of histories. Nothing here draws: an application may ask for a frequency while it runs."""

from __future__ import annotations

import numpy as np

HANN = (0.5, 0.5)
BLACKMAN_HARRIS = (0.35875, 0.48829, 0.14128, 0.01168)
"""Windows by their cosines. Of a drift the first leaves side lobes of a few hundredths, the second of 3e-5; a line is
four steps of frequency wide with the first, eight with the second (F. J. Harris, Proc. IEEE 66, 1978, 51-83)."""
WINDOWS, SHORTEST, LONGEST = 12, 32, 512
"""Windows that a run is cut into for spectra against time, and the least and most frames of one."""
FINENESS = 4
"""Steps of a spectrum's frequency in what the run's length allows."""
LOBE = 4 * FINENESS
"""Steps to either side over which a line with the second window reaches: the highest peak there alone is a line."""
LEAST_OF_LARGEST = 0.01
"""Share of the largest amplitude below which what is highest beside it is not named."""


def spectrum(time: np.ndarray, signal: np.ndarray, cosines: tuple[float, ...] = HANN) -> tuple[np.ndarray, np.ndarray]:
    """Amplitude spectrum of a signal about its mean, with a window: a sum of cosines, by turns minus and plus.

    Parameters
    ----------
    time : (m,) array
        Rising; at uneven intervals the signal is interpolated, s.
    signal : (m,) array
    cosines : tuple of float
        Of the window, `HANN` or `BLACKMAN_HARRIS`.

    Returns
    -------
    frequency : (k,) array
        Hz; from 0 to half the frame rate, four times as fine as the run's length allows so that a line between two
        of its frequencies keeps its height to 1 %. Empty for fewer than four frames.
    amplitude : (k,) array
        A sine shows with its amplitude.
    """
    time, signal = np.asarray(time, float), np.asarray(signal, float)
    count = len(time)
    if count < 4 or time[-1] <= time[0]:
        return np.zeros(0), np.zeros(0)
    even = np.linspace(time[0], time[-1], count)
    if not np.allclose(time, even, rtol=0.0, atol=1e-6 * (time[-1] - time[0]) / count):
        from scipy.interpolate import CubicSpline

        signal = CubicSpline(time, signal)(even)
    turn = 2.0 * np.pi * np.arange(count) / count
    window = sum((-1.0) ** k * share * np.cos(k * turn) for k, share in enumerate(cosines))
    mean = (window * signal).sum() / window.sum()
    lines = np.abs(np.fft.rfft((signal - mean) * window, FINENESS * count)) * 2.0 / window.sum()
    return np.fft.rfftfreq(FINENESS * count, even[1] - even[0]), lines


def late_spectrum(time: np.ndarray, signal: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Spectrum of the last `share` of a run about a straight line: what drifts, as a load that is hoisted, is no line.

    What is left of a drift that is no straight line shows below its own frequency only: the window leaves nothing
    beside it. Parameters and returns as of `spectrum`.
    """
    late = time >= time[-1] - share * (time[-1] - time[0])
    time, signal = np.asarray(time, float)[late], np.asarray(signal, float)[late]
    if len(time) < 4:
        return np.zeros(0), np.zeros(0)
    return spectrum(time, signal - np.polynomial.Polynomial.fit(time, signal, 1)(time), BLACKMAN_HARRIS)


def largest_line(size: np.ndarray) -> int | None:
    """Place of the largest line in a spectrum by `late_spectrum`.

    What is left of a drift stands at the slow end, and its lobe reaches as far as that of a line. A peak within a lobe
    of a higher peak belongs to that; one that only has the slope of a higher one beside it is a line of its own.

    Parameters
    ----------
    size : (k,) array
        Amplitudes.

    Returns
    -------
    int or None
        None where all that stands out is too slow for the time looked at to tell it from a drift.
    """
    from scipy.ndimage import maximum_filter1d

    beside = np.pad(size, 1, constant_values=-np.inf)
    peak = np.where((size >= beside[:-2]) & (size >= beside[2:]), size, 0.0)
    highest = peak == maximum_filter1d(peak, 2 * LOBE + 1, mode="nearest")
    highest[: LOBE + 1] = highest[-1:] = False
    highest &= (peak > 0.0) & (size >= LEAST_OF_LARGEST * size.max(initial=0.0))
    return int(np.where(highest, size, 0.0).argmax()) if highest.any() else None


def full_spectra(time: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Spectra of a way around something, window by window.

    Parameters
    ----------
    time : (m,) array
        Even, s.
    offset : (m,) complex array
        Its two coordinates, m.

    Returns
    -------
    middle : (w,) array
        Time of the windows, s; empty where there are too few frames.
    frequency : (k,) array
        Hz, rising; positive where the way turns from the real axis to the imaginary one.
    amplitude : (k, w) array
        A circle shows with its radius, m; Hann windows, which overlap by three quarters.
    """
    count = int(np.clip(len(time) // WINDOWS, SHORTEST, LONGEST))
    if len(time) < 2 * count:
        return np.zeros(0), np.zeros(0), np.zeros((0, 0))
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    first = np.arange(0, len(time) - count + 1, max(1, count // 4))
    pieces = offset[first[:, None] + np.arange(count)] * window
    amplitude = np.abs(np.fft.fftshift(np.fft.fft(pieces, 2 * count, axis=1), axes=1)).T / window.sum()
    step = (time[-1] - time[0]) / (len(time) - 1)
    return time[first] + 0.5 * count * step, np.fft.fftshift(np.fft.fftfreq(2 * count, step)), amplitude
