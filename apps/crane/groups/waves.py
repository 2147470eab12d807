"""Long-crested waves on the water, as what is in them finds them: the surface, and how the water below it moves.

Linear theory (Airy) of waves a sin(theta), theta = w t + phi - k s, s being the distance from the origin along their
direction. Over water of a depth d their velocity and acceleration at z below the level of the surface are

    along:  a w C sin(theta),  a w^2 C cos(theta)      C = cosh(k (d + z)) / sinh(k d)
    up:     a w S cos(theta), -a w^2 S sin(theta)      S = sinh(k (d + z)) / sinh(k d)

and both C and S are exp(k z) over deep water. Above the level of the surface this would grow without a bound. So z is
stretched (Wheeler, Method for calculating forces produced by irregular waves, 1970): what lies D below the surface as
it is moves as linear theory has it D d / (d + eta) below the level. Terms of second order in the waves' steepness are
left out, that by which a particle is carried along among them.

While waves grow from nothing by a factor r(t), the velocity is r u and the acceleration its rate, r a + r. u.
"""

from __future__ import annotations

from math import cos, exp, inf, sin
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel
from tautline.system.records import records
from tautline.system.waves import Waves

WAVE = np.dtype([("amplitude", "f8"), ("frequency", "f8"), ("phase", "f8"), ("number", "f8")])
"""A wave: m, rad/s, rad and rad/m."""
X, Y, Z = range(3)
VELOCITY, ACCELERATION = range(2)
THINNEST = 0.1
"""Share of the depth that is always left of it under a trough."""


class Sea(NamedTuple):
    """Waves (n,) of ``WAVE`` that run along ``way`` (2,) from ``origin`` (2,) m, over water ``depth`` m deep.

    They grow from nothing within ``ramp`` s. Scratch: ``parts`` (n, 2), a sin and a cos of every wave at a place, and
    ``moves`` (2, 3), the velocity and the acceleration of the water there.
    """

    rows: np.recarray
    way: np.ndarray
    origin: np.ndarray
    ramp: float
    depth: float
    parts: np.ndarray
    moves: np.ndarray


def new_sea(waves: Waves | None) -> Sea:
    """Waves with their scratch; without any the water is still."""
    if waves is None:
        return Sea(records(0, WAVE), np.array([1.0, 0.0]), np.zeros(2), 0.0, inf, np.zeros((0, 2)), np.zeros((2, 3)))
    n = len(waves.amplitude)
    rows = records(
        n, WAVE, amplitude=waves.amplitude, frequency=waves.frequency, phase=waves.phase, number=waves.number
    )
    way, origin = np.array(waves.direction, float), np.array(waves.origin, float)
    return Sea(rows, way, origin, float(waves.ramp), float(waves.depth), np.zeros((n, 2)), np.zeros((2, 3)))


@kernel
def grown(sea, t):
    """Share of their height that waves have, a quintic of time, and its rate, 1/s."""
    if sea.ramp <= 0.0 or t >= sea.ramp:
        return 1.0, 0.0
    x = max(t, 0.0) / sea.ramp
    return x**3 * (10.0 - 15.0 * x + 6.0 * x * x), 30.0 * (x * (1.0 - x)) ** 2 / sea.ramp


@kernel
def look(sea, t, x, y):
    """The surface at a place: its height above its level, m, the rate of that, m/s, and its slope along the waves."""
    s = (x - sea.origin[X]) * sea.way[X] + (y - sea.origin[Y]) * sea.way[Y]
    eta = rate = slope = 0.0
    for n in range(sea.rows.size):
        w = sea.rows[n]
        theta = w.frequency * t + w.phase - w.number * s
        sea.parts[n, 0], sea.parts[n, 1] = w.amplitude * sin(theta), w.amplitude * cos(theta)
        eta += sea.parts[n, 0]
        rate += w.frequency * sea.parts[n, 1]
        slope -= w.number * sea.parts[n, 1]
    r, r_t = grown(sea, t)
    return r * eta, r * rate + r_t * eta, r * slope


@kernel
def stir(sea, t, eta, deep):
    """Write velocity and acceleration of the water at a depth, m, below the surface where :func:`look` has looked."""
    sea.moves.fill(0.0)
    if sea.rows.size == 0:
        return
    stretched = deep
    if sea.depth < inf:
        stretched = deep / max(1.0 + eta / sea.depth, THINNEST)
    along = up = along_t = up_t = 0.0
    for n in range(sea.rows.size):
        w = sea.rows[n]
        c = s = exp(-w.number * stretched)
        if sea.depth < inf:
            back = exp(-2.0 * w.number * (sea.depth - stretched))
            whole = 1.0 - exp(-2.0 * w.number * sea.depth)
            c, s = c * (1.0 + back) / whole, s * (1.0 - back) / whole
        along += w.frequency * c * sea.parts[n, 0]
        up += w.frequency * s * sea.parts[n, 1]
        along_t += w.frequency**2 * c * sea.parts[n, 1]
        up_t -= w.frequency**2 * s * sea.parts[n, 0]
    r, r_t = grown(sea, t)
    for c in (X, Y):
        sea.moves[VELOCITY, c] = r * along * sea.way[c]
        sea.moves[ACCELERATION, c] = (r * along_t + r_t * along) * sea.way[c]
    sea.moves[VELOCITY, Z] = r * up
    sea.moves[ACCELERATION, Z] = r * up_t + r_t * up
