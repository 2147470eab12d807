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
ALONG, DEEPER = range(2)
"""Places in ``by``."""
RATE, SLOPE = range(2)
"""Places in ``bends``."""
THINNEST = 0.1
"""Share of the depth that is always left of it under a trough."""


class Sea(NamedTuple):
    """Waves (n,) of ``WAVE`` that run along ``way`` (2,) from ``origin`` (2,) m, over water ``depth`` m deep.

    They grow from nothing within ``ramp`` s. Scratch: ``parts`` (n, 2), a sin and a cos of every wave at a place,
    ``moves`` (2, 3), the velocity and the acceleration of the water there, ``by`` (2, 2, 3), how these change along the
    waves and with the depth, 1/m, and ``bends`` (2,), how the rate of the surface, 1/s, and its slope, 1/m, change
    along the waves.
    """

    rows: np.recarray
    way: np.ndarray
    origin: np.ndarray
    ramp: float
    depth: float
    parts: np.ndarray
    moves: np.ndarray
    by: np.ndarray
    bends: np.ndarray


def new_sea(waves: Waves | None) -> Sea:
    """Waves with their scratch; without any the water is still."""
    scratch = np.zeros((2, 3)), np.zeros((2, 2, 3)), np.zeros(2)
    if waves is None:
        return Sea(records(0, WAVE), np.array([1.0, 0.0]), np.zeros(2), 0.0, inf, np.zeros((0, 2)), *scratch)
    n = len(waves.amplitude)
    rows = records(
        n, WAVE, amplitude=waves.amplitude, frequency=waves.frequency, phase=waves.phase, number=waves.number
    )
    way, origin = np.array(waves.direction, float), np.array(waves.origin, float)
    return Sea(rows, way, origin, float(waves.ramp), float(waves.depth), np.zeros((n, 2)), *scratch)


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
def stretched_of(sea, eta, deep):
    """Depth at which linear theory is taken for one below the surface, m, and how it changes with both."""
    if not sea.depth < inf:
        return deep, 1.0, 0.0
    share = 1.0 + eta / sea.depth
    if share <= THINNEST:
        return deep / THINNEST, 1.0 / THINNEST, 0.0
    return deep / share, 1.0 / share, -deep / (share * share * sea.depth)


@kernel
def at_depth(sea, number, stretched):
    """C and S of a wave, see above."""
    c = s = exp(-number * stretched)
    if sea.depth < inf:
        back = exp(-2.0 * number * (sea.depth - stretched))
        whole = 1.0 - exp(-2.0 * number * sea.depth)
        c, s = c * (1.0 + back) / whole, s * (1.0 - back) / whole
    return c, s


@kernel
def stir(sea, t, eta, deep):
    """Write velocity and acceleration of the water at a depth, m, below the surface where :func:`look` has looked."""
    sea.moves.fill(0.0)
    if sea.rows.size == 0:
        return
    stretched, _, _ = stretched_of(sea, eta, deep)
    along = up = along_t = up_t = 0.0
    for n in range(sea.rows.size):
        w = sea.rows[n]
        c, s = at_depth(sea, w.number, stretched)
        along += w.frequency * c * sea.parts[n, 0]
        up += w.frequency * s * sea.parts[n, 1]
        along_t += w.frequency**2 * c * sea.parts[n, 1]
        up_t -= w.frequency**2 * s * sea.parts[n, 0]
    write_moves(sea, t, along, up, along_t, up_t, sea.moves)


@kernel
def write_moves(sea, t, along, up, along_t, up_t, moves):
    """Velocity and acceleration (2, 3) of waves that grow, from those of waves that are grown."""
    r, r_t = grown(sea, t)
    for c in (X, Y):
        moves[VELOCITY, c] = r * along * sea.way[c]
        moves[ACCELERATION, c] = (r * along_t + r_t * along) * sea.way[c]
    moves[VELOCITY, Z] = r * up
    moves[ACCELERATION, Z] = r * up_t + r_t * up


@kernel
def vary(sea, t, eta, deep):
    """Write how all that changes along the waves, at one depth below the level, and with that depth.

    A sin and a cos change by -k times the other along the waves, and C and S by -k times the other with the depth.
    """
    stretched, _, _ = stretched_of(sea, eta, deep)
    sea.bends.fill(0.0)
    r, r_t = grown(sea, t)
    u = w_up = u_t = up_t = u_deep = up_deep = u_t_deep = up_t_deep = 0.0
    for n in range(sea.rows.size):
        w = sea.rows[n]
        k, frequency = w.number, w.frequency
        sine, cosine = sea.parts[n, 0], sea.parts[n, 1]
        c, s = at_depth(sea, k, stretched)
        u -= frequency * c * k * cosine
        w_up += frequency * s * k * sine
        u_t += frequency**2 * c * k * sine
        up_t += frequency**2 * s * k * cosine
        u_deep -= frequency * k * s * sine
        up_deep -= frequency * k * c * cosine
        u_t_deep -= frequency**2 * k * s * cosine
        up_t_deep += frequency**2 * k * c * sine
        sea.bends[RATE] += r * frequency * k * sine - r_t * k * cosine
        sea.bends[SLOPE] -= r * k * k * sine
    write_moves(sea, t, u, w_up, u_t, up_t, sea.by[ALONG])
    write_moves(sea, t, u_deep, up_deep, u_t_deep, up_t_deep, sea.by[DEEPER])
