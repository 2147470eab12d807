"""What a winch gives to the rope and takes back: power, energy, the largest and the mean."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.rope_life.events import checked
from tautline.errors import ArgumentError


class WinchEnergy(NamedTuple):
    """Energy of a winch over a run, at the rope: losses of gear and drive are not in it."""

    hoisted: float
    """Given to the rope, J, >= 0."""
    regenerated: float
    """Taken back from the rope, or burnt in a brake, J, >= 0."""
    net: float
    """hoisted - regenerated, J."""
    peak: float
    """Largest power given to the rope at a frame, W; 0 where it never gives any."""
    peak_time: float
    """s."""
    regenerated_peak: float
    """Largest power taken back, W, >= 0."""
    regenerated_peak_time: float
    """s."""
    mean: float
    """net over the duration of the run, W."""
    hoisting_mean: float
    """hoisted over the time in which power is given, W."""
    hoisting_time: float
    """s."""


def winch_power(tension: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Power that a winch gives to the rope at its lead point.

    Parameters
    ----------
    tension : (m,) array
        Of the rope where it leaves the drum, N.
    speed : (m,) array
        Of the rope there, m/s, positive onto the drum (hoisting): the opposite of a pay-out. That of the stretched
        rope is the rim's; that of the unstretched differs from it by the strain.

    Returns
    -------
    (m,) array
        W; negative where the rope drives the winch.
    """
    return np.asarray(tension, float) * np.asarray(speed, float)


def winch_energy(time: np.ndarray, tension: np.ndarray, speed: np.ndarray) -> WinchEnergy:
    """Energy and power of a winch over a run; exact where tension and speed are straight lines between frames.

    Parameters
    ----------
    time : (m,) array
        s.
    tension, speed : (m,) array
        As `winch_power` takes them.

    Raises
    ------
    ArgumentError
        Where there is no frame, times fall, lengths differ, or a number is not finite.
    """
    time, tension, speed = checked(time, tension=tension, speed=speed)
    power = winch_power(tension, speed)
    if power.ndim != 1:
        raise ArgumentError(f"tension: shape {tension.shape}; a winch has one history, (m,)")
    most, least = int(np.argmax(power)), int(np.argmin(power))
    at, force, pace = _split(time, tension, speed)
    step = np.diff(at)
    # Simpson's rule is exact for a product of two straight lines, which between zeros of either has one sign.
    middle = (force[:-1] + force[1:]) * (pace[:-1] + pace[1:])
    work = step / 6.0 * (force[:-1] * pace[:-1] + middle + force[1:] * pace[1:])
    hoisted, regenerated = float(work[work > 0.0].sum()), float(-work[work < 0.0].sum())
    duration, hoisting_time = float(time[-1] - time[0]), float(step[work > 0.0].sum())
    return WinchEnergy(
        hoisted=hoisted,
        regenerated=regenerated,
        net=hoisted - regenerated,
        peak=max(0.0, float(power[most])),
        peak_time=float(time[most]),
        regenerated_peak=max(0.0, -float(power[least])),
        regenerated_peak_time=float(time[least]),
        mean=(hoisted - regenerated) / duration if duration > 0.0 else 0.0,
        hoisting_mean=hoisted / hoisting_time if hoisting_time > 0.0 else 0.0,
        hoisting_time=hoisting_time,
    )


def _split(time: np.ndarray, *lines: np.ndarray) -> tuple[np.ndarray, ...]:
    """Histories with a frame added wherever one of them passes zero between two; (k,) each, time first."""
    zeros = []
    for line in lines:
        # A jump, two frames at one time, passes zero without work.
        k = np.flatnonzero((line[:-1] * line[1:] < 0.0) & (time[:-1] < time[1:]))
        zeros.append(time[k] + (time[k + 1] - time[k]) * line[k] / (line[k] - line[k + 1]))
    added = np.concatenate(zeros)
    order = np.argsort(np.concatenate([time, added]), kind="stable")
    at = np.concatenate([time, added])[order]
    return at, *(np.concatenate([line, np.interp(added, time, line)])[order] for line in lines)
