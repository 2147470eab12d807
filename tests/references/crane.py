"""Closed forms of reeving: Atwood's machine, the capstan, blocks of n falls, bounce and axial modes.

Derived from the momentum and energy of rope, masses and sheaves, without the crane program.  SI units; `friction` is
Coulomb's coefficient, `mass_per_length` that of unstretched rope.  Atwood's machine: two masses hang from the two
sides of one fixed sheave; x [m] is how far mass_2 hangs below, and mass_1 above, the place of equal sides.
Accuracy: rounding (1e-14), but for `FrictionAtwood`, which is integrated to 1e-11.
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def speed_ramp(time, speed, over):
    """Travel, speed and acceleration of a start from rest: speed times the quintic 10 r^3 - 15 r^4 + 6 r^5, r = t/over.

    The acceleration is continuous and has a continuous rate inside (C2 speed); arrays of one shape.
    """
    r = np.clip(np.asarray(time, dtype=float) / over, 0, 1)
    travel = over * r**4 * (2.5 - 3 * r + r * r) + np.maximum(time - over, 0)
    return speed * travel, speed * r**3 * (10 - 15 * r + 6 * r * r), speed / over * 30 * r**2 * (1 - r) ** 2


# ----------------------------------------------------------------------------------------------------------------------
# Atwood's machine
# ----------------------------------------------------------------------------------------------------------------------
def atwood(mass_1, mass_2, inertia=0.0, radius=1.0, gravity=9.81):
    """Acceleration (m_2 - m_1) g/(m_1 + m_2 + I/R^2) and tensions m_1 (g + a), m_2 (g - a); weightless rope, no slip.

    Returns
    -------
    acceleration [m/s^2], tension_1, tension_2 [N]
    """
    a = (mass_2 - mass_1) * gravity / (mass_1 + mass_2 + inertia / radius**2)
    return a, mass_1 * (gravity + a), mass_2 * (gravity - a)


def heavy_atwood(time, mass_1, mass_2, mass_per_length, length, inertia, radius, x0, v0=0.0, gravity=9.81):
    """The same with an inextensible rope of weight: x - x* = (x0 - x*) cosh kt + (v0/k) sinh kt.

    All of the rope moves with speed x', also the arc pi R on the sheave, whose weight does no work: with
    l_1 = (length - pi R)/2 - x, l_2 = (length - pi R)/2 + x and M = m_1 + m_2 + rho length + I/R^2 the energy
    M x'^2/2 - g (m_2 - m_1) x - rho g x^2 is constant, so k^2 = 2 rho g/M, x* = -(m_2 - m_1)/(2 rho).

    Parameters
    ----------
    time : array (n,) [s]
    length : the rope's, with the arc on the sheave [m]

    Returns
    -------
    namespace of arrays (n,): x, v, a, and the tensions where the rope touches the sheave, tension_1 and tension_2 [N]
    """
    time = np.asarray(time, dtype=float)
    total = mass_1 + mass_2 + mass_per_length * length + inertia / radius**2
    k = np.sqrt(2 * mass_per_length * gravity / total)
    centre = -(mass_2 - mass_1) / (2 * mass_per_length)
    cosh, sinh = np.cosh(k * time), np.sinh(k * time)
    x = centre + (x0 - centre) * cosh + v0 / k * sinh
    v, a = k * (x0 - centre) * sinh + v0 * cosh, k**2 * (x - centre)
    side = (length - np.pi * radius) / 2
    tension_1 = (mass_1 + mass_per_length * (side - x)) * (gravity + a)
    tension_2 = (mass_2 + mass_per_length * (side + x)) * (gravity - a)
    return SimpleNamespace(x=x, v=v, a=a, tension_1=tension_1, tension_2=tension_2)


# ----------------------------------------------------------------------------------------------------------------------
# capstan
# ----------------------------------------------------------------------------------------------------------------------
def capstan_ratio(friction, wrap, groove=None):
    """exp(mu theta) of Euler and Eytelwein; a V groove of full angle `groove` [rad] has mu/sin(groove/2) for mu."""
    return np.exp(_in_groove(friction, groove) * wrap)


def _in_groove(friction, groove):
    return friction if groove is None else friction / np.sin(groove / 2)


def capstan_tension(tension_in, friction, wrap, momentum=0.0, groove=None):
    """Tension where a rope leaves a sheave it slips over: q + (T - q) exp(mu theta), q = rho u^2 its momentum flux [N].

    The rope presses with (T - q)/R per length: u^2/R is its centripetal acceleration.
    """
    return momentum + (tension_in - momentum) * capstan_ratio(friction, wrap, groove)


def capstan_arc(friction, wrap, radius, mass_per_length, speed, acceleration, gravity=9.81):
    """The same with weight and inertia of the rope on the sheave: T_out = slope T_in + offset; locked sheave, exact.

    theta runs over the top from where the rope comes up (vertical there, theta = 0) towards where it slips to.  Per
    angle, rho R a = T' - rho g R cos(theta) - mu (T - q + rho g R sin(theta)); with G = rho g R and tau = T - q,
    tau' = mu tau + rho R a + G (mu sin + cos), so
    tau = C exp(mu theta) + [(1 - mu^2) sin - 2 mu cos] G/(1 + mu^2) - rho R a/mu.

    Returns
    -------
    slope, offset [N] : offset holds the speed's and the acceleration's share
    """
    q, G, ratio = mass_per_length * speed**2, mass_per_length * gravity * radius, np.exp(friction * wrap)
    weight_in = -2 * friction * G / (1 + friction**2)
    weight_out = ((1 - friction**2) * np.sin(wrap) - 2 * friction * np.cos(wrap)) * G / (1 + friction**2)
    # (exp(mu theta) - 1)/mu, which is theta without friction
    inertia = mass_per_length * radius * acceleration * (np.expm1(friction * wrap) / friction if friction else wrap)
    return ratio, q * (1 - ratio) + weight_out - ratio * weight_in + inertia


def slipping_atwood(mass_1, mass_2, friction, wrap=np.pi, gravity=9.81, groove=None):
    """Weightless rope slipping over a locked sheave towards mass_2: T_2 = e T_1, e = exp(mu theta).

    a = g (m_2 - e m_1)/(m_2 + e m_1), T_1 = 2 m_1 m_2 g/(m_2 + e m_1).  It starts from rest if m_2 > e m_1.

    Returns
    -------
    acceleration [m/s^2], tension_1, tension_2 [N]
    """
    e = capstan_ratio(friction, wrap, groove)
    a = gravity * (mass_2 - e * mass_1) / (mass_2 + e * mass_1)
    return a, mass_1 * (gravity + a), mass_2 * (gravity - a)


@dataclass(frozen=True)
class FrictionAtwood:
    """Atwood's machine with dry friction between rope and sheave (180 deg of wrap), free or locked (inertia = inf).

    Rope on the sides and on the sheave has mass; rope on the sheave obeys `capstan_arc` while it slips, and limits
    friction by it while it sticks.  State: x, v of the rope and s, w of the rim [m, m/s]; slip = sign of v - w.
    """

    mass_1: float
    mass_2: float
    friction: float
    inertia: float = np.inf
    radius: float = 0.5
    mass_per_length: float = 0.0
    length: float = 10.0
    gravity: float = 9.81

    def forces(self, x, v, slip):
        """Rope's and rim's acceleration, tensions T_1, T_2 and the friction force on the rim towards side 2."""
        g, rho, side = self.gravity, self.mass_per_length, (self.length - np.pi * self.radius) / 2
        m1, m2 = self.mass_1 + rho * (side - x), self.mass_2 + rho * (side + x)
        arc, rim = rho * np.pi * self.radius, self.inertia / self.radius**2
        if slip == 0:
            a = (m2 - m1) * g / (m1 + m2 + arc + rim) if np.isfinite(rim) else 0.0
        else:  # m_out (g - b) = slope m_in (g + b) + offset + push b, b the acceleration in the sense of slip
            m_in, m_out = (m1, m2)[::slip]
            slope, offset = self._arc(v, 0.0)
            push = self._arc(v, 1.0)[1] - offset
            a = slip * (g * (m_out - slope * m_in) - offset) / (m_out + slope * m_in + push)
        T1, T2 = m1 * (g + a), m2 * (g - a)
        force = T2 - T1 - arc * a
        return a, (a if slip == 0 else force / rim), T1, T2, force

    def _arc(self, speed, acceleration):
        return capstan_arc(self.friction, np.pi, self.radius, self.mass_per_length, speed, acceleration, self.gravity)

    def spare(self, x, v, slip):
        """Tension still missing to slipping in the sense `slip` = +-1 while the rope sticks [N]; < 0: it slips."""
        a, _, T1, T2, _ = self.forces(x, v, 0)
        T_in, T_out = (T1, T2)[::slip]
        slope, offset = self._arc(v, slip * a)
        return slope * T_in + offset - T_out

    def start(self, x, v, w):
        """The sense of slip in which the motion goes on: +1, -1, or 0 for sticking."""
        if v != w:
            return 1 if v > w else -1
        return next((slip for slip in (1, -1) if self.spare(x, v, slip) < 0), 0)

    def simulate(self, times, x0=0.0, v0=0.0, w0=0.0):
        """Motion from x0, v0, w0, events of slip and stick located to rounding (DOP853, 1e-12).

        Returns
        -------
        namespace of arrays (n,) x, v, s, w, T1, T2, `heat` [J], slip; events: list of (time, new sense of slip)
        """
        times = np.asarray(times, dtype=float)
        state, at, slip = np.array([x0, v0, 0.0, w0, 0.0]), times[0], self.start(x0, v0, w0)
        events, rows = [], np.empty((len(times), 8))
        rows[0] = self._row(state, slip)
        while at < times[-1]:
            done = self._phase(at, times[-1], state, slip)
            inside = (times > at) & (times <= done.t[-1])
            for i in np.flatnonzero(inside):
                rows[i] = self._row(done.sol(times[i]), slip)
            at, state = done.t[-1], done.y[:, -1].copy()
            if done.status == 1:
                slip = self._after(state, slip, done)
                events.append((float(at), slip))
        names = ("x", "v", "s", "w", "T1", "T2", "heat", "slip")
        return SimpleNamespace(time=times, events=events, **dict(zip(names, rows.T, strict=True)))

    def _phase(self, start, end, state, slip):
        def rate(_, y):
            a, b, _, _, force = self.forces(y[0], y[1], slip)
            return [y[1], a, y[3], b, force * (y[1] - y[3])]

        if slip:
            stops = [lambda _, y: y[1] - y[3]]
        else:
            stops = [lambda _, y, sense=sense: self.spare(y[0], y[1], sense) for sense in (1, -1)]
        for stop in stops:
            stop.terminal, stop.direction = True, -slip or -1
        return solve_ivp(
            rate, (start, end), state, "DOP853", rtol=1e-12, atol=1e-13, events=stops, dense_output=True, max_step=0.05
        )

    def _after(self, state, slip, done):
        if slip == 0:
            return 1 if len(done.t_events[0]) else -1
        state[1] = state[3] = state[1] if np.isfinite(self.inertia) else 0.0
        return self.start(state[0], state[1], state[3])

    def _row(self, y, slip):
        _, _, T1, T2, _ = self.forces(y[0], y[1], slip)
        return [*y[:4], T1, T2, y[4], slip]

    def energy(self, motion):
        """Kinetic and potential energy of masses, rope and sheave [J]; with `heat` it is constant."""
        rho, g = self.mass_per_length, self.gravity
        rim = self.inertia / self.radius**2 * motion.w**2 / 2 if np.isfinite(self.inertia) else 0.0
        moving = (self.mass_1 + self.mass_2 + rho * self.length) * motion.v**2 / 2
        return moving + rim - g * (self.mass_2 - self.mass_1) * motion.x - rho * g * motion.x**2


def slip_of_free_sheave(mass_1, mass_2, inertia, radius, friction, speed, wrap=np.pi, gravity=9.81):
    """Weightless rope at `speed` > 0 thrown over a free sheave at rest: slips until the rim has its speed, then sticks.

    Rope: a of `slipping_atwood`; rim: R^2 (T_2 - T_1)/I with T_2 = e T_1, both constant.

    Returns
    -------
    time of sticking [s] (inf if the rim never catches up), speed then [m/s], heat [J]
    """
    a, T1, T2 = slipping_atwood(mass_1, mass_2, friction, wrap, gravity)
    rim = radius**2 * (T2 - T1) / inertia
    if rim <= a:
        return np.inf, np.inf, np.inf
    time = speed / (rim - a)
    return time, speed + a * time, (T2 - T1) * speed * time / 2


# ----------------------------------------------------------------------------------------------------------------------
# blocks
# ----------------------------------------------------------------------------------------------------------------------
def falls(count, load, efficiency=1.0, hoisting=True):
    """Tensions in a block of `count` parallel falls under a load [N], and the block's mechanical advantage.

    Over each sheave T_out = T_in/eta in the rope's travel.  Hoisting, the rope runs to the drum: the fall
    next to it T_1 = W/(1 + eta + ... + eta^(n-1)), fall i + 1 has eta T_i, the lead line beyond the top sheave T_1/eta.
    Lowering is the same with 1/eta for eta.

    Returns
    -------
    namespace: tensions (count,) from the drum's fall to the dead end [N], lead [N], advantage = load/lead,
    efficiency = power at the load over power at the drum hoisting (the inverse lowering), speed_ratio = rope/block
    """
    eta = efficiency if hoisting else 1 / efficiency
    tensions = load * eta ** np.arange(count) / np.sum(eta ** np.arange(count))
    lead = tensions[0] / eta
    share = load / (count * lead)
    return SimpleNamespace(
        tensions=tensions,
        lead=lead,
        advantage=load / lead,
        efficiency=share if hoisting else 1 / share,
        speed_ratio=float(count),
    )


def bearing_efficiency(friction, bearing_radius, radius, wrap=np.pi):
    """T_in/T_out of a sheave on a bearing with friction torque mu_b r_b |F|, F the load of both sides.

    (T_out - T_in) R = mu_b r_b |F|, |F|^2 = T_in^2 + T_out^2 - 2 T_in T_out cos(wrap) (the angle of the forces is
    pi - wrap); at 180 deg (R - mu_b r_b)/(R + mu_b r_b).  With rope mass, T less q = rho u^2 on both sides.
    """
    m = (friction * bearing_radius / radius) ** 2
    # x = T_out/T_in: (x - 1)^2 = m (1 + x^2 - 2 x cos(wrap))
    half, rest = 1 - m * np.cos(wrap), 1 - m
    x = (half + np.sqrt(half**2 - rest**2)) / rest
    return 1 / x


# ----------------------------------------------------------------------------------------------------------------------
# axial vibration
# ----------------------------------------------------------------------------------------------------------------------
def stretch_under(tension, axial_stiffness):
    """lambda of N = EA lambda (lambda^2 - 1)/2 [-], by Newton's method."""
    ratio = np.asarray(tension, dtype=float) / axial_stiffness
    e = ratio.copy()  # lambda - 1: e (1 + e) (1 + e/2) = N/EA without loss of digits
    for _ in range(30):
        e = e - (e * (1 + e) * (1 + e / 2) - ratio) / (1 + 3 * e + 1.5 * e * e)
    return 1 + e


def tangent_stiffness(stretch, axial_stiffness):
    """dN/d lambda = EA (3 lambda^2 - 1)/2 [N]."""
    return axial_stiffness * (3 * stretch**2 - 1) / 2


def bounce_frequency(count, axial_stiffness, length, mass, gravity=None):
    """(n/2 pi) sqrt(EA/(L0 M)) [Hz]: weightless rope of unstretched length L0 from the drum to the dead end, n falls.

    The block's travel y lengthens the rope by n y and is opposed by n times its tension: stiffness n^2 EA/L0.
    With `gravity` EA becomes the tangent stiffness at the stretch under M g/n (Green's law).
    """
    stiffness = axial_stiffness
    if gravity is not None:
        stiffness = tangent_stiffness(stretch_under(mass * gravity / count, axial_stiffness), axial_stiffness)
    return count / (2 * np.pi) * np.sqrt(stiffness / (length * mass))


def bar_frequencies(axial_stiffness, mass_per_length, length, mass, count=4, stretch=1.0):
    """First `count` frequencies [Hz] of a fixed bar with a mass at its end: beta tan(beta) = rho L/M, beta = omega L/c.

    c^2 = (dN/d lambda)/rho at a uniform `stretch`, L unstretched.
    """
    ratio, c = mass_per_length * length / mass, np.sqrt(tangent_stiffness(stretch, axial_stiffness) / mass_per_length)
    # x sin x - ratio cos x has one zero in each (k pi, k pi + pi/2)
    roots = [
        brentq(lambda x: x * np.sin(x) - ratio * np.cos(x), k * np.pi, (k + 0.5) * np.pi, xtol=1e-15, rtol=1e-15)
        for k in range(count)
    ]
    return np.array(roots) * c / (2 * np.pi * length)
