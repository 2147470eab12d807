"""Extremes of a Gaussian process, in closed form.

Rice (1945): a level is up-crossed nu0 exp(-x^2 / 2 m0) times a second, with nu0 = sqrt(m2 / m0) / 2 pi for a spectrum
over angular frequency. Peaks of a narrow-banded process are Rayleigh distributed, and the most probable largest of N of
them is sqrt(2 m0 ln N). See also DNV-RP-C205, sections 2.3 and 3.5.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import trapezoid

from tautline.errors import ArgumentError
from tautline.statistics.gumbel import check_share


def moments(frequency: np.ndarray, density: np.ndarray) -> tuple[float, float, float]:
    """Moments m0, m2, m4 of a one-sided spectrum over angular frequency, by the trapezoidal rule.

    Parameters
    ----------
    frequency : (n,) array
        rad/s, increasing.
    density : (n,) array
        Unit squared times s/rad.
    """
    found = [float(trapezoid(density * frequency**k, frequency)) for k in (0, 2, 4)]
    return found[0], found[1], found[2]


def upcrossing_rate(m0: float, m2: float, level: float = 0.0) -> float:
    """Up-crossings of a level above the mean in a second.

    Raises
    ------
    ArgumentError
        Where `m0` is not above 0.
    """
    _check_moment(m0)
    return math.sqrt(m2 / m0) / (2.0 * math.pi) * math.exp(-0.5 * level**2 / m0)


def most_probable_maximum(m0: float, cycles: float) -> float:
    """Most probable largest above the mean of so many cycles, sqrt(2 m0 ln N).

    Raises
    ------
    ArgumentError
        Where `m0` is not above 0, or `cycles` is less than 1.
    """
    _check_moment(m0)
    if not cycles >= 1.0:
        raise ArgumentError(f"cycles = {cycles}: must be 1 at least")
    return math.sqrt(2.0 * m0 * math.log(cycles))


def maximum_percentile(m0: float, cycles: float, share: float) -> float:
    """What the largest of so many cycles does not exceed with the probability `share`: up-crossings are Poisson's.

    Raises
    ------
    ArgumentError
        Where `m0` or `cycles` is not above 0, `share` does not lie between 0 and 1, or `share` is below exp(-N): with
        that probability none of N cycles rises above the mean.
    """
    _check_moment(m0)
    check_share("share", share)
    if not cycles > 0.0:
        raise ArgumentError(f"cycles = {cycles}: must be above 0")
    if cycles < -math.log(share):
        none = f"with the probability {math.exp(-cycles):.3g} no cycle rises above the mean"
        raise ArgumentError(f"share = {share}: {none}; ask for a larger share")
    return math.sqrt(2.0 * m0 * math.log(cycles / -math.log(share)))


def exceedance(m0: float, m2: float, duration: float, level: float) -> float:
    """Probability that a level is exceeded in a duration, s.

    Raises
    ------
    ArgumentError
        Where `m0` is not above 0.
    """
    return -math.expm1(-duration * upcrossing_rate(m0, m2, level))


def _check_moment(m0: float) -> None:
    if not m0 > 0.0:
        raise ArgumentError(f"m0 = {m0}: the variance of the process must be above 0")
