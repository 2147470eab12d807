"""Soft-string torque and drag (Johancsik 1984, 3-D form) and its closed forms in a slant hole and in an arc.

Measured depth s downwards, unit tangent t(s), T = EFFECTIVE tension (mud equal inside and outside), T = 0 at the bit,
w = rho_s A g (1 - rho_m/rho_s) [N/m], e_z down.  Load of the string on the wall per length and tension from the bit up:

    q = T t' + w (e_z - (e_z.t) t),  N = |q|,     dT/ds = -w e_z.t - eps mu N
    eps = +1 pick_up (friction pulls the string down), -1 slack_off, 0 rotating;   torque = integral N (od/2) m ds,
    m = mu/sqrt(1 + mu^2) for a string that has climbed the wall (the friction balances its weight), mu otherwise.

With a clearance the string lies off the axis by delta e, e = q/N: its curvature is t'/b and its length b ds,
b = 1 - delta t'.e.  Both are of the order k delta (4e-5 in the J-well).  The string's stretch is not counted.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

EPS = {"pick_up": 1.0, "slack_off": -1.0, "rotating": 0.0}
DOWN = np.array([0.0, 0.0, 1.0])  # north, east, down


@dataclass
class Well:
    """tangent(s) and curvature(s) = t' as callables of measured depth [m], their breaks, and the length [m]."""

    tangent: callable
    curvature: callable
    length: float
    breaks: tuple = ()


@dataclass
class String:
    """Sections (length, od, id) from the surface to the bit [m]; densities [kg/m^3]; gravity [m/s^2]."""

    sections: list
    density: float = 7850.0
    mud: float = 1840.0
    gravity: float = 9.81

    def weight(self, od, bore):
        """Buoyed weight per length [N/m]."""
        return (self.density - self.mud) * np.pi / 4 * (od**2 - bore**2) * self.gravity


def angles_to_tangent(inc, azi):
    """Unit tangent (north, east, down) of inclination and azimuth [rad]."""
    return np.array([np.sin(inc) * np.cos(azi), np.sin(inc) * np.sin(azi), np.cos(inc)])


def well_from_angles(inc, azi, length, breaks=(), step=1e-2):
    """A well given as callables inc(s), azi(s) [rad]; t' by central differences of `step` metres."""

    def tangent(s):
        return angles_to_tangent(inc(s), azi(s))

    return Well(tangent, lambda s: (tangent(s + step) - tangent(s - step)) / (2 * step), length, tuple(breaks))


def well_from_survey(md, inc, azi):
    """Minimum-curvature well (a circular arc per interval) through stations md [m], inc, azi [rad], from md = 0."""
    md = np.asarray(md, float)
    ends = [angles_to_tangent(i, a) for i, a in zip(inc, azi, strict=True)]

    def arc(s):
        j = int(np.clip(np.searchsorted(md, s, side="right") - 1, 0, len(md) - 2))
        a, b = ends[j], ends[j + 1]
        sine = b - (a @ b) * a  # normal of the arc at its start, times sin(dogleg)
        dogleg = np.arctan2(np.linalg.norm(sine), a @ b)
        k = dogleg / (md[j + 1] - md[j])
        normal = sine / np.linalg.norm(sine) if dogleg > 1e-14 else np.zeros(3)
        x = k * (s - md[j])
        return np.cos(x) * a + np.sin(x) * normal, k * (np.cos(x) * normal - np.sin(x) * a)

    return Well(lambda s: arc(s)[0], lambda s: arc(s)[1], md[-1], tuple(md[1:-1]))


def jwell():
    """The thesis' J-well: 2200 m vertical, R = 1000 m to 90 deg, MD 3770.796 m; and its string."""
    end = 2200.0 + 500.0 * np.pi
    well = well_from_survey([0.0, 2200.0, end], [0.0, 0.0, np.pi / 2], [0.0, 0.0, 0.0])
    return well, String([(end - 240.0, 0.127, 0.1086), (240.0, 0.165, 0.0572)])


def tension(well, string, mu, direction, factor=0.0, hole=None):
    """Tension at the surface [N] and integral of factor N od/2 ds [N m]; hole: diameter [m] for the clearance path."""
    eps = EPS[direction]
    bottom, state = well.length, np.zeros(2)
    for length, od, bore in reversed(string.sections):
        w, delta = string.weight(od, bore), 0.0 if hole is None else (hole - od) / 2
        top = max(bottom - length, 0.0)
        cuts = [bottom, *sorted((b for b in well.breaks if top < b < bottom), reverse=True), top]
        for start, stop in pairwise(cuts):
            inside = 1e-9 * (start - stop)

            def rate(s, y, w=w, delta=delta, od=od, low=stop + inside, high=start - inside):
                s = min(max(s, low), high)  # stay on this side of the breaks
                t, turn = well.tangent(s), well.curvature(s)
                b, across = 1.0, w * (DOWN - (DOWN @ t) * t)
                q = y[0] * turn + across
                if delta and np.linalg.norm(q):
                    b = 1 - delta * (turn @ q) / np.linalg.norm(q)
                    q = y[0] * turn / b + across
                n = np.linalg.norm(q)
                return b * np.array([-w * (DOWN @ t) - eps * mu * n, -factor * n * od / 2])

            run = solve_ivp(rate, (start, stop), state, rtol=1e-10, atol=1e-6, max_step=20.0)
            state = run.y[:, -1]
        bottom = top
    return state


def hook_load(well, string, mu, direction, hole=None):
    """Effective tension at the surface [N] for 'pick_up', 'slack_off' or 'rotating'."""
    return tension(well, string, mu, direction, hole=hole)[0]


def rotating_torque(well, string, mu, climbing=True, hole=None):
    """Surface torque of the string rotating off bottom [N m]."""
    return tension(well, string, 0.0, "rotating", mu / np.hypot(1, mu) if climbing else mu, hole)[1]


def strokes(well, string, mu, modulus=200e9, hole=None):
    """Strokes of the block [m] that move a stuck bit: up from rest, and down from rest.

    The steel between table and bit is what it was: int b/(1 + T/EA) ds, from the top's place to the bit's, does not
    change while the bit stays. So the top has moved by the integral's difference between friction `mu` and none.
    """
    bottom, state = well.length, np.zeros(6)
    for length, od, bore in reversed(string.sections):
        w, delta = string.weight(od, bore), 0.0 if hole is None else (hole - od) / 2
        stiffness = modulus * np.pi / 4 * (od**2 - bore**2)
        top = max(bottom - length, 0.0)
        cuts = [bottom, *sorted((b for b in well.breaks if top < b < bottom), reverse=True), top]
        for start, stop in pairwise(cuts):
            inside = 1e-9 * (start - stop)

            def rate(s, y, w=w, delta=delta, stiffness=stiffness, low=stop + inside, high=start - inside):
                s = min(max(s, low), high)
                t, turn = well.tangent(s), well.curvature(s)
                across = w * (DOWN - (DOWN @ t) * t)
                out = np.zeros(6)
                for k, eps in enumerate((0.0, 1.0, -1.0)):
                    b, q = 1.0, y[k] * turn + across
                    if delta and np.linalg.norm(q):
                        b = 1 - delta * (turn @ q) / np.linalg.norm(q)
                        q = y[k] * turn / b + across
                    out[k] = b * (-w * (DOWN @ t) - eps * mu * np.linalg.norm(q))
                    out[3 + k] = -b / (1 + y[k] / stiffness)
                return out

            state = solve_ivp(rate, (start, stop), state, rtol=1e-10, atol=1e-7, max_step=10.0).y[:, -1]
        bottom = top
    free, up, down = state[3:]
    return free - up, down - free


def slant_hook_load(w, length, inc, mu, direction):
    """Straight hole at inclination inc: T = w L (cos inc + eps mu sin inc)."""
    return w * length * (np.cos(inc) + EPS[direction] * mu * np.sin(inc))


def arc_tension(start, stop, tension, w, radius, mu, direction):
    """Exact tension after going up a build arc in a vertical plane from inclination `start` to `stop` < `start` [rad].

    With a = inclination, c = +1 on the high side (T > w R sin a) or -1 on the low side, m = eps c mu:
    dT/da = -w R cos a - m (T - w R sin a), whose solution is
    T = w R [(m^2 - 1) sin a - 2 m cos a]/(1 + m^2) + C exp(-m a);  c changes where T = w R sin a.
    """

    def branch(a, m):
        return w * radius * ((m * m - 1) * np.sin(a) - 2 * m * np.cos(a)) / (1 + m * m)

    while start > stop:
        lift = tension - w * radius * np.sin(start)
        # d(lift)/da = -2 w R cos a where lift = 0, so lift grows on the way up
        side = 1.0 if lift > -1e-9 * w * radius else -1.0
        m = EPS[direction] * side * mu
        free = (tension - branch(start, m)) * np.exp(m * start)

        def lifted(a, m=m, free=free):
            return branch(a, m) + free * np.exp(-m * a) - w * radius * np.sin(a)

        grid = np.linspace(start, stop, 400)
        crossed = [] if side > 0 else [j for j, a in enumerate(grid) if lifted(a) > 0]
        end = brentq(lifted, grid[crossed[0] - 1], grid[crossed[0]], xtol=1e-14) if crossed else stop
        tension = lifted(end) + w * radius * np.sin(end)
        start = end
    return tension


def jwell_hook_load(mu, direction):
    """Closed form for the J-well: arc of BHA, arc of pipe, vertical pipe."""
    _, string = jwell()
    (_, *pipe), (bha_length, *bha) = string.sections
    change = np.pi / 2 - bha_length / 1000.0
    t = arc_tension(np.pi / 2, change, 0.0, string.weight(*bha), 1000.0, mu, direction)
    t = arc_tension(change, 0.0, t, string.weight(*pipe), 1000.0, mu, direction)
    return t + 2200.0 * string.weight(*pipe)
