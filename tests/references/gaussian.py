"""Extremes of a Gaussian process, in closed form.

Rice (1945): a level is up-crossed nu0 exp(-x^2 / 2 m0) times a second, with nu0 = sqrt(m2 / m0) / 2 pi for a spectrum
over angular frequency. Peaks of a narrow-banded process are Rayleigh distributed, and the most probable largest of N of
them is sqrt(2 m0 ln N). See also DNV-RP-C205, sections 2.3 and 3.5.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import trapezoid


def moments(frequency: np.ndarray, density: np.ndarray) -> tuple[float, float]:
    """Moments m0 and m2 of a one-sided spectrum over angular frequency, rad/s, by the trapezoidal rule."""
    return float(trapezoid(density, frequency)), float(trapezoid(density * frequency**2, frequency))


def upcrossing_rate(m0: float, m2: float, level: float = 0.0) -> float:
    """Up-crossings of a level above the mean in a second."""
    return math.sqrt(m2 / m0) / (2.0 * math.pi) * math.exp(-0.5 * level**2 / m0)


def most_probable_maximum(m0: float, cycles: float) -> float:
    """Most probable largest above the mean of so many cycles, sqrt(2 m0 ln N)."""
    return math.sqrt(2.0 * m0 * math.log(cycles))


def maximum_percentile(m0: float, cycles: float, share: float) -> float:
    """What the largest of so many cycles does not exceed with the probability `share`: up-crossings are Poisson's."""
    return math.sqrt(2.0 * m0 * math.log(cycles / -math.log(share)))


def exceedance(m0: float, m2: float, duration: float, level: float) -> float:
    """Probability that a level is exceeded in a duration, s."""
    return -math.expm1(-duration * upcrossing_rate(m0, m2, level))
