"""Compression at which a string in a hole buckles, into a sine along the low side and into a helix.

In a straight inclined hole the low side holds the string: R. Dawson and P. R. Paslay, "Drill pipe buckling in inclined
holes", JPT 36(10), 1984, give F = 2 sqrt(EI w sin(i) / r) for the sine, and Y.-C. Chen, Y.-H. Lin and J. B. Cheatham,
"Tubing and casing buckling in horizontal wells", JPT 42(2), 1990, sqrt(2) times as much for the helix. In a curved hole
the side force of curvature takes the place of w sin(i): X. He and A. Kyllingstad, "Helical buckling and lock-up
conditions for coiled tubing in curved wells", SPE Drilling & Completion 10(1), 1995:

    F^2 = m EI N(F) / r,    m = 4 (sine), 8 (helix),    N(F) = |-F t' + w (e_z - (e_z.t) t)|,

so the compression that buckles the string also presses it onto the wall, or off it where the hole drops. The limit is
the least F that satisfies this. In a vertical hole N is zero and the string's own weight holds it: the limits are
nowhere less than 2.55 and 5.55 (EI w^2)^(1/3), of J. Wu, H. C. Juvkam-Wold and R. Lu, "Helical buckling of pipes in
extended reach and horizontal wells, part 1", J. Energy Resources Technology 115, 1993, with w's part along the hole.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drillstring.string.lumps import Tube
from drillstring.well.wellbore import Wellbore

INCLINED = {"sinusoidal": 4.0, "helical": 8.0}
"""Factor m of F^2 = m EI N / r."""
VERTICAL = {"sinusoidal": 2.55, "helical": 5.55}
"""Factor of (EI w^2)^(1/3)."""
ROUNDING = 1.0e-7
"""Part of the weight across the hole, or out of the plane in which it curves, up to which that is rounding."""
PASSES = 100
"""Tangents at most on the way to a root. Fifteen do, but where two roots all but meet."""


class Limits(NamedTuple):
    """Compressions, positive, N, at which the string buckles; (n,) each, infinite where the pipe fills the hole."""

    sinusoidal: np.ndarray
    helical: np.ndarray


def limits(
    rigidity: np.ndarray,
    clearance: np.ndarray,
    weight: np.ndarray,
    down: np.ndarray,
    turn: np.ndarray,
    curvature: np.ndarray,
) -> Limits:
    """Buckling limits at n places.

    Parameters
    ----------
    rigidity : (n,) array
        Bending stiffness EI, N m^2.
    clearance : (n,) array
        Radial clearance r, m.
    weight : (n,) array
        Buoyed weight per length, N/m, negative where the string floats.
    down : (n,) array
        Vertical component of the tangent, t_z: the cosine of the inclination.
    turn : (n,) array
        Vertical component of t', positive where the hole steepens, 1/m.
    curvature : (n,) array
        |t'|, 1/m.

    Returns
    -------
    Limits
    """
    return Limits(*(limit(kind, rigidity, clearance, weight, down, turn, curvature) for kind in Limits._fields))


def limit(
    kind: str,
    rigidity: np.ndarray,
    clearance: np.ndarray,
    weight: np.ndarray,
    down: np.ndarray,
    turn: np.ndarray,
    curvature: np.ndarray,
) -> np.ndarray:
    """Buckling limits of one kind, sinusoidal or helical, at n places (n,), N; see `limits`."""
    sine = np.sqrt(np.maximum(0.0, 1.0 - down**2))
    # A string that floats lies on the high side, which holds it as the low side holds one that sinks.
    across = np.abs(weight) * np.where(sine > ROUNDING, sine, 0.0)
    found = np.full(np.shape(across), np.inf)
    free = np.asarray(clearance) > 0.0
    # F^2 over N(F).
    ratio = INCLINED[kind] * rigidity[free] / clearance[free]
    curved = _least_roots(np.abs(weight[free]), across[free], ratio, curvature[free], (weight * turn)[free])
    found[free] = np.maximum(curved, VERTICAL[kind] * np.cbrt(rigidity * (weight * down) ** 2)[free])
    return found


def limits_at(
    well: Wellbore, place: np.ndarray, tubes: list[Tube], weight: np.ndarray, clearance: np.ndarray
) -> Limits:
    """Buckling limits of the hole at places.

    Parameters
    ----------
    well : Wellbore
    place : (n,) array
        Measured depths, m.
    tubes : list of n Tube
        The string there.
    weight, clearance : (n,) array
        Its buoyed weight per length N/m, and radial clearance m.
    """
    rigidity = np.array([tube.youngs_modulus * tube.second_moment for tube in tubes])
    return Limits(*(limit_at(kind, well, place, rigidity, weight, clearance) for kind in Limits._fields))


def limit_at(
    kind: str, well: Wellbore, place: np.ndarray, rigidity: np.ndarray, weight: np.ndarray, clearance: np.ndarray
) -> np.ndarray:
    """Buckling limits of one kind, sinusoidal or helical, at measured depths m of a hole (n,), N.

    The string there has a bending stiffness N m^2, a buoyed weight per length N/m and a radial clearance m, (n,) each.
    """
    m1, m2, t = well.frame(place)
    k1, k2 = well.curvature(place)
    turn = k1 * m1[:, 2] + k2 * m2[:, 2]
    return limit(kind, rigidity, clearance, weight, t[:, 2], turn, np.hypot(k1, k2))


def _least_roots(
    weight: np.ndarray, across: np.ndarray, ratio: np.ndarray, curvature: np.ndarray, turn: np.ndarray
) -> np.ndarray:
    """Least F > 0 of F^2 = c N(F), N^2 = k^2 F^2 - 2 F w t'_z + w^2 (1 - t_z^2), of n places at once (n,).

    ``weight`` is |w| and ``across`` its part across the hole, while ``turn`` is w t'_z with its sign.

    N is the length of a vector that goes straight with F, so it is convex, and nowhere below its tangent. From an F
    that is below the root, the place where F^2 meets the tangent is therefore never beyond the root, and the next F.
    """
    # With the weight or the curvature alone this is the root.
    root = np.sqrt(ratio * across) + ratio * curvature
    both = np.flatnonzero((curvature > 0.0) & (across > 0.0))
    # In units of that: N = hypot(slope (F - least), aside), without a difference of large numbers where the hole drops
    # and the wall all but loses the string.
    unit, c, k, w = root[both], ratio[both], curvature[both], across[both]
    slope, lift = c * k / unit, turn[both] / k
    least, aside = lift / (k * unit), np.sqrt(np.maximum(0.0, w**2 - lift**2))
    aside = np.where(aside > ROUNDING * weight[both], aside, 0.0) * c / unit**2
    force = np.zeros(both.size)
    for _ in range(PASSES):
        side = np.hypot(slope * (force - least), aside)
        growth = np.divide(slope**2 * (force - least), side, out=np.zeros_like(side), where=side > 0.0)
        # (F + step)^2 = side + growth step
        half, short = force - 0.5 * growth, np.maximum(0.0, side - force**2)
        far = np.abs(half) + np.sqrt(half**2 + short)
        step = np.where(half > 0.0, np.divide(short, far, out=np.zeros_like(far), where=far > 0.0), far)
        force += step
        if not np.any(step > np.finfo(float).eps * force):
            break
    root[both] = force * unit
    return root
