"""Payload on a weightless inextensible rope of changing length: plane, space, and from a sheave of finite radius.

Second-order equations integrated with DOP853 to 1e-12 (results to about 1e-11 of the amplitude).  z upwards, g > 0.
`length(t)` returns the free length, its rate and its second rate [m, m/s, m/s^2].
"""

from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp

from .crane import speed_ramp

# the steps are short for the sake of the interpolation between them
TOLERANCE = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14, "max_step": 0.05}


def hoisted(length, speed, over):
    """`length(t)` of a rope of `length` paid out with `speed_ramp`; hoisting has speed < 0."""

    def at(time):
        travel, rate, change = speed_ramp(time, speed, over)
        return length + travel, rate, change

    return at


def fixed(*point):
    """`pivot(t)` of a point at rest: position, velocity and acceleration (3,)."""
    return lambda _: (np.array(point, dtype=float), np.zeros(3), np.zeros(3))


def planar(times, length, angle, rate=0.0, radius=0.0, gravity=9.81, mass=1.0):
    """Pendulum in the plane of a fixed sheave: s th'' + 2 l' th' + R th'^2 + g sin th = 0, s = l + R th.

    th [rad] from the vertical, positive outwards, away from the sheave's centre; l the free length at th = 0.  The
    rope leaves the sheave at R n, n = (cos th, sin th), along e = (sin th, -cos th), and swinging outwards unwinds it:
    s = l + R th.  With n' = -th' e, e' = th' n the payload R n + s e has the velocity l' e + s th' n (the shift of the
    tangent point and the unwinding cancel) and the acceleration (l'' - s th'^2) e + (s th'' + 2 l' th' + R th'^2) n.
    Tension m (g cos th + s th'^2 - l'').  R = 0: l th'' + 2 l' th' + g sin th = 0 about a point.

    Returns
    -------
    namespace of arrays (n,): angle, rate, x, z [m] from the sheave's centre, tension [N], free length s [m]
    """

    def turn(time, y):
        l, v, _ = length(time)
        return [y[1], -(2 * v * y[1] + radius * y[1] ** 2 + gravity * np.sin(y[0])) / (l + radius * y[0])]

    done = solve_ivp(turn, (times[0], times[-1]), [angle, rate], t_eval=times, **TOLERANCE)
    th, thdot = done.y
    l, _, a = np.array([length(t) for t in times]).T
    s, sin, cos = l + radius * th, np.sin(th), np.cos(th)
    tension = mass * (gravity * cos + s * thdot**2 - a)
    return SimpleNamespace(
        angle=th, rate=thdot, x=radius * cos + s * sin, z=radius * sin - s * cos, tension=tension, free=s
    )


def spherical(times, length, direction, rate, pivot, gravity=9.81, mass=1.0):
    """Pendulum in space on a moving point: e'' = -|e'|^2 e - 2 (l'/l) e' + [G - (G.e) e]/l, G = -g k - pivot''.

    Payload pivot + l e, |e| = 1; tension m (G.e + l |e'|^2 - l'').

    Parameters
    ----------
    direction, rate : (3,) e, normalised here, and e' at the start, made normal to e
    pivot : function of time to position, velocity and acceleration (3,)

    Returns
    -------
    namespace of arrays: position, velocity, direction (n, 3), tension (n,) [N]
    """
    e = np.array(direction, dtype=float) / np.linalg.norm(direction)
    w = np.array(rate, dtype=float)
    down = np.array([0, 0, -gravity])

    def turn(time, y):
        l, v, _ = length(time)
        e, w = y[:3], y[3:]
        G = down - pivot(time)[2]
        return np.concatenate([w, -(w @ w) * e - 2 * v / l * w + (G - (G @ e) * e) / l])

    start = np.concatenate([e, w - (w @ e) * e])
    done = solve_ivp(turn, (times[0], times[-1]), start, t_eval=times, **TOLERANCE)
    e, w = done.y[:3].T, done.y[3:].T
    l, v, a = (row[:, None] for row in np.array([length(t) for t in times]).T)
    point, speed, change = np.array([pivot(t) for t in times]).transpose(1, 0, 2)
    tension = np.sum((down - change) * e, 1) + (l * np.sum(w * w, 1, keepdims=True) - a)[:, 0]
    return SimpleNamespace(position=point + l * e, velocity=speed + v * e + l * w, direction=e, tension=mass * tension)


def slewing(radius, height, rate, over):
    """`pivot(t)` of a boom tip at `radius` from a vertical axis, slewing from rest, its rate a `speed_ramp`."""

    def at(time):
        angle, w, change = speed_ramp(time, rate, over)
        out, along = (np.array([np.cos(angle), np.sin(angle), 0.0]), np.array([-np.sin(angle), np.cos(angle), 0.0]))
        centre = np.array([0, 0, height])
        return radius * out + centre, radius * w * along, radius * (change * along - w * w * out)

    return at
