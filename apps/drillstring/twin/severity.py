"""Stick-slip of the bit, told from torque and rotary speed at the surface.

Over the last few periods the torque at the top of the string is fitted by a constant, a slope and harmonics of one
frequency, which is looked for near the string's first torsional one; so is the rotary speed. Each harmonic is taken
down the string by the torsional line (torsional_line.py), and their sum is the rotary speed of the bit over a period.
Severity is (max - min) / (2 mean) of it; from one on the bit comes to rest, or nearly so.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import ceil, isfinite, pi, sqrt
from typing import NamedTuple

import numpy as np

from drillstring.twin.torsional_line import TorsionalLine

PHASES = 128
"""Points of a period at which the bit's speed is found."""
CLEAR = 2.5
"""Standard deviations from which a higher harmonic counts: those of noise alone would make a severity of their own."""
FOUND = 4.0
"""Standard deviations of noise from which the torque's oscillation counts as seen: the largest of some frequencies."""


class StickSlip(NamedTuple):
    """Of the last few periods, at a time, s.

    Severity and its standard deviation; frequency of the oscillation, Hz; least, largest and mean rotary speed of the
    bit, rad/s; share of the torque's variance that the harmonics explain: near one of stick-slip, small of noise.
    """

    time: float
    severity: float
    sd: float
    frequency: float
    least: float
    largest: float
    mean: float
    periodic: float


@dataclass(frozen=True)
class Settings:
    """How the oscillation is looked for.

    Attributes
    ----------
    periods : float
        Of the string's first torsional oscillation, that are looked at.
    lowest, highest : float
        Frequencies looked at, over that one: a bit that sticks makes the period longer, a soft drive may change it.
    harmonics : int
        Most of them; fewer where samples are too far apart for them.
    damping_sd : float
        Relative standard deviation of the damping along the string, which is in the stated deviation.
    torque_of_drive : bool
        Whether the torque is that of the motor, which also turns the drive's inertia, and not the string's.
    speed_measured : bool
        Whether the rotary speed is measured; else it is the one wanted, and the drive's gains tell how it swings.
    """

    periods: float = 5.0
    lowest: float = 0.5
    highest: float = 1.3
    harmonics: int = 5
    damping_sd: float = 0.3
    torque_of_drive: bool = True
    speed_measured: bool = True


class Severity:
    """Collects surface torque and rotary speed, and tells the stick-slip of the bit when asked.

    Parameters
    ----------
    line : TorsionalLine
        The string; a longer one can be set at any time.
    settings : Settings
    """

    MADE_ANEW = ("settings", "_line", "_first")

    def __init__(self, line: TorsionalLine, settings: Settings | None = None) -> None:
        self.settings = settings or Settings()
        self._samples: deque[tuple[float, float, float]] = deque()
        self.line = line

    @property
    def line(self) -> TorsionalLine:
        """The string."""
        return self._line

    @line.setter
    def line(self, line: TorsionalLine) -> None:
        self._line, self._first = line, line.frequency

    @property
    def span(self) -> float:
        """Time that is looked at, s."""
        return self.settings.periods / self._first

    def add(self, time: float, torque: float, speed: float) -> None:
        """One more sample: s, N m, rad/s. One that is not later than the last, or lacks a number, is passed over."""
        if not (isfinite(time) and isfinite(torque) and isfinite(speed)):
            return
        if self._samples and time <= self._samples[-1][0]:
            return
        self._samples.append((time, torque, speed))
        while time - self._samples[0][0] > self.span:
            self._samples.popleft()

    def clear(self) -> None:
        """Forget the samples, as after a connection."""
        self._samples.clear()

    def stick_slip(self) -> StickSlip | None:
        """What the samples tell; None while they span less than three periods, or the string does not turn."""
        if len(self._samples) < 12:
            return None
        data = np.array(self._samples)
        time, torque, speed = data.T
        if time[-1] - time[0] < min(3.0, self.settings.periods) / self._first:
            return None
        mean = float(speed.mean())
        spacing = float(np.median(np.diff(time)))
        count = min(self.settings.harmonics, int(0.4 / (spacing * self.settings.highest * self._first)))
        if abs(mean) < 1e-3 or count < 1:
            return None
        omega = self._find(time, torque)
        fits = [_Fit.of(time, values, omega, count) for values in (torque, speed)]
        # The constant of the fit is the mean of whole periods; the bit turns as often as the drive.
        return self._stick_slip_estimate(time, omega, fits[1].mean, *fits)

    def _grid(self, time: np.ndarray) -> np.ndarray:
        """Angular frequencies, rad/s, at which the oscillation is looked for: four to a period more or less."""
        step = 0.25 / (self._first * (time[-1] - time[0]))
        low, high = self.settings.lowest, self.settings.highest
        return 2.0 * pi * self._first * np.linspace(low, high, ceil((high - low) / step) + 1)

    def _find(self, time: np.ndarray, torque: np.ndarray) -> float:
        """Angular frequency of the torque's oscillation, rad/s.

        The strongest single line is near it, for half of the frequency has no line of its own. With a second harmonic
        it is found better: what is left has its least, that of a parabola, between its neighbours.
        """
        grid = self._grid(time)
        near = grid[int(np.argmin([_Fit.of(time, torque, omega, 1).left for omega in grid]))]
        step = grid[1] - grid[0]
        fine = near + step * np.arange(-1.0, 1.01, 0.5)
        left = [_Fit.of(time, torque, omega, 2).left for omega in fine]
        best = min(max(int(np.argmin(left)), 1), fine.size - 2)
        a, b, c = left[best - 1 : best + 2]
        bend = a - 2.0 * b + c
        off = min(1.0, max(-1.0, 0.5 * (a - c) / bend)) if bend > 0.0 else 0.0
        return float(fine[best] + off * (fine[1] - fine[0]))

    def _stick_slip_estimate(self, time: np.ndarray, omega: float, mean: float, torque: _Fit, speed: _Fit) -> StickSlip:
        deviations = self._by_noise(omega, torque, speed)
        clear = np.abs(self._at_bit(omega, torque.waves, speed.waves)) > CLEAR * deviations
        clear[0] = True
        if abs(torque.waves[0]) < FOUND * torque.wave_sd:
            # An oscillation that is not seen may have any of the frequencies: that which would mean most for the bit.
            deviations[0] = max(self._by_noise(w, torque, speed)[0] for w in self._grid(time))

        def swing(damped: float, kept: np.ndarray) -> tuple[float, float, float]:
            return _swing(np.where(kept, self._at_bit(omega, torque.waves, speed.waves, damped), 0.0), mean)

        severity, low, high = swing(1.0, clear)
        fewer = clear.copy()
        fewer[np.flatnonzero(clear)[-1]] = clear.sum() == 1
        parts = (
            # The largest and the least value lie about half a period apart: there odd harmonics count twice.
            sqrt(float((deviations[clear] ** 2).sum())) / abs(mean),
            swing(1.0, fewer)[0] - severity,
            swing(1.0 + self.settings.damping_sd, clear)[0] - severity,
        )
        sd = sqrt(sum(part**2 for part in parts))
        return StickSlip(
            float(time[-1]), severity, sd, omega / (2.0 * pi), mean + low, mean + high, mean,
            torque.explained,
        )  # fmt: skip

    def _at_bit(self, omega: float, torque: np.ndarray, speed: np.ndarray, damped: float = 1.0) -> np.ndarray:
        """Complex amplitudes (k,) of the bit's speed from those of torque and speed at the surface."""
        orders = omega * np.arange(1, torque.size + 1)
        from_torque, from_speed = self._factors(orders, damped)
        return from_torque * torque + from_speed * speed

    def _factors(self, orders: np.ndarray, damped: float) -> tuple[np.ndarray, np.ndarray]:
        """By what torque and speed measured at the surface (k,) make the bit's speed."""
        down = self.line.down(orders, damped)
        of_speed, of_torque = down[:, 0, 0], down[:, 0, 1]
        turning = 1j * orders * self.line.inertia
        if not self.settings.speed_measured:
            # The drive's own law gives the speed: T = -(P + I / (i omega)) Omega, of the string less its inertia's.
            answer = self.line.drive_impedance(orders)
            if self.settings.torque_of_drive:
                answer = answer - turning
            swing = -1.0 / answer
            string = 1.0 - turning * swing if self.settings.torque_of_drive else 1.0
            return of_torque * string + of_speed * swing, np.zeros_like(of_speed)
        if self.settings.torque_of_drive:
            return of_torque, of_speed - of_torque * turning
        return of_torque, of_speed

    def _by_noise(self, omega: float, torque: _Fit, speed: _Fit) -> np.ndarray:
        """Standard deviations (k,) of the amplitudes of the bit's speed, rad/s, by what the fits leave."""
        factors = self._factors(omega * np.arange(1, torque.waves.size + 1), 1.0)
        parts = [fit.wave_sd * np.abs(factor) for fit, factor in zip((torque, speed), factors, strict=True)]
        return np.hypot(*parts)


class _Fit(NamedTuple):
    """Mean of a signal in the middle of its samples, harmonics (k,) as complex amplitudes, their standard deviation (of
    either part), what the fit leaves as a variance, and the share of the variance it explains.
    """

    mean: float
    waves: np.ndarray
    wave_sd: float
    left: float
    explained: float

    @classmethod
    def of(cls, time: np.ndarray, values: np.ndarray, omega: float, count: int) -> _Fit:
        """By least squares, with phases that count from the last sample."""
        t = time - time[-1]
        angles = omega * np.outer(t, np.arange(1, count + 1))
        basis = np.hstack([np.ones((t.size, 1)), t[:, None], np.cos(angles), np.sin(angles)])
        found, *_ = np.linalg.lstsq(basis, values, rcond=None)
        off = values - basis @ found
        steady = values - basis[:, :2] @ np.linalg.lstsq(basis[:, :2], values, rcond=None)[0]
        left = float((off**2).sum()) / max(1, t.size - basis.shape[1])
        whole = float((steady**2).sum()) / max(1, t.size - 2)
        waves = found[2 : 2 + count] - 1j * found[2 + count :]
        mean = float(found[0] + found[1] * t.mean())
        return cls(mean, waves, sqrt(2.0 * left / t.size), left, 1.0 - left / whole if whole > 0.0 else 0.0)


def _shape(waves: np.ndarray) -> np.ndarray:
    """Sum of harmonics (k,) over a period (PHASES,)."""
    phase = 2.0 * pi / PHASES * np.arange(PHASES)
    return (waves * np.exp(1j * np.outer(phase, np.arange(1, waves.size + 1)))).sum(axis=1).real


def _swing(waves: np.ndarray, mean: float) -> tuple[float, float, float]:
    """Severity, and the least and the largest deviation from the mean.

    A bit that some harmonics alone would have turn backwards stands still: the torque that resists it changes its sign
    there, and the harmonics left out are those of the corner.
    """
    shape = _shape(waves) * (1.0 if mean > 0.0 else -1.0)
    low, high = max(float(shape.min()), -abs(mean)), float(shape.max())
    ends = (low, high) if mean > 0.0 else (-high, -low)
    return (high - low) / (2.0 * abs(mean)), *ends
