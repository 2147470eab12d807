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

INCLINED = {"sinusoidal": 4.0, "helical": 8.0}
"""Factor m of F^2 = m EI N / r."""
VERTICAL = {"sinusoidal": 2.55, "helical": 5.55}
"""Factor of (EI w^2)^(1/3)."""
REAL = 1.0e-7
"""Imaginary part over size up to which a root counts as real."""


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
        Buoyed weight per length, N/m.
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
    found = {}
    across = weight**2 * np.maximum(0.0, 1.0 - down**2)
    for kind, factor in INCLINED.items():
        c = (factor * rigidity / clearance) ** 2
        curved = [
            _least_root(square, c_i, k, w * t)
            for square, c_i, k, w, t in zip(across, c, curvature, weight, turn, strict=True)
        ]
        vertical = VERTICAL[kind] * np.cbrt(rigidity * (weight * down) ** 2)
        found[kind] = np.maximum(curved, vertical)
    return Limits(**found)


def _least_root(across: float, c: float, curvature: float, turn: float) -> float:
    """Least F > 0 of F^4 = c (k^2 F^2 - 2 F w t'_z + w^2 (1 - t_z^2)); 0 where there is none."""
    if curvature == 0.0:
        return float((c * across) ** 0.25)
    # In units of a force that is of the right size, so that the polynomial is well scaled.
    unit = (c * across) ** 0.25 + np.sqrt(c) * curvature
    a, b, d = c * curvature**2 / unit**2, 2.0 * c * turn / unit**3, c * across / unit**4
    roots = np.roots([1.0, 0.0, -a, b, -d])
    real = roots.real[(np.abs(roots.imag) < REAL * np.abs(roots)) & (roots.real > REAL)]
    return float(real.min() * unit) if real.size else 0.0
