"""Wall force that a string lacks where it crosses the hole from one side to another.

A soft string without clearance presses on the wall everywhere, with the force per length q of soft_string.py. Where
the direction of q changes at once, a string with clearance has a way to go, and there it presses less or not at all.
Picking up, tension holds it on the upper side of a build (T k > w sin i), and in the slant below it lies on the lower
side. Between them it hangs free. With tension T, q1 above and q2 below, across the distance D = 2r, the free span is
two parabolas, each of which leaves its wall without a kink,

    T y'' = q1 over a1,  T y'' = -q2 over a2,  q1 a1 = q2 a2,  D = (q1 a1^2 + q2 a2^2)/2T,

so that a1 + a2 = sqrt(2DT(1/q1 + 1/q2)), and each wall lacks q1 a1 = q2 a2 = sqrt(2DT/(1/q1 + 1/q2)) of force.

Where the direction turns by an angle th that is small, the string slides around the wall and stays on it. It is then a
pendulum in s, T r d'' = q sin d with d the angle from the direction of q, and presses with q cos d - T r d'^2. From
d'^2 = 2q(1 - cos d)/(T r) each side lacks 6 sqrt(q T r)(1 - cos(d/2)), with sqrt(q1) sin(d1/2) = sqrt(q2) sin(d2/2) and
d1 + d2 = th. This holds until the wall is left, at cos d = 2/3; between there and th = pi the two are blended. Where q
passes through zero within an arc, q = q's, the free span is 2a with a^3 = 3DT/2q', and each side lacks q'a^2/2.

A string in compression is given no correction: bending, and not tension, takes it across.
"""

from __future__ import annotations

import numpy as np

LEAVES = 2.0 * np.arccos(2.0 / 3.0)
"""Turn of the side force, rad, up to which a string with the same force on both sides stays on the wall."""


def lost_at_turns(
    tension: np.ndarray, clearance: np.ndarray, above: np.ndarray, below: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Wall force that is lacking above and below n places where the side force changes at once, (n,) N each.

    Parameters
    ----------
    tension : (n,) array
        Effective tension there, N.
    clearance : (n,) array
        Radial clearance r, m.
    above, below : (n, 3) array
        Force per length on the wall, N/m, just above and just below.
    """
    q1, q2 = np.linalg.norm(above, axis=1), np.linalg.norm(below, axis=1)
    both = (q1 > 0.0) & (q2 > 0.0) & (tension > 0.0)
    q1, q2, pull = (np.where(both, x, 1.0) for x in (q1, q2, tension))
    turn = np.arccos(np.clip((above * below).sum(axis=1) / (q1 * q2), -1.0, 1.0))
    a, b = np.sqrt(q1), np.sqrt(q2)
    first = np.arctan2(b * np.sin(0.5 * turn), a + b * np.cos(0.5 * turn))
    free = np.sqrt(4.0 * clearance * pull / (1.0 / q1 + 1.0 / q2))
    share = np.clip((turn - LEAVES) / (np.pi - LEAVES), 0.0, 1.0)
    found = []
    for root, angle in ((a, first), (b, 0.5 * turn - first)):
        sliding = 6.0 * root * np.sqrt(pull * clearance) * (1.0 - np.cos(angle))
        found.append(np.where(both, (1.0 - share) * sliding + share * free, 0.0))
    return found[0], found[1]


def lost_at_zero(tension: np.ndarray, clearance: np.ndarray, growth: np.ndarray) -> np.ndarray:
    """Wall force that is lacking on each side of n places where the side force passes through zero, (n,) N.

    Parameters
    ----------
    tension, clearance : (n,) array
        As for :func:`lost_at_turns`.
    growth : (n,) array
        Change of the side force per length, N/m^2, above zero.
    """
    way = np.cbrt(3.0 * clearance * np.maximum(0.0, tension) / growth)
    found: np.ndarray = 0.5 * growth * way**2
    return found
