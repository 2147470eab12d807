"""Slack and snap of a weightless rope: a payload dropped on it, and a crane tip that heaves so that it goes slack.

Tip at the depth u(t), payload at x below it by x - u, rope of unstretched length L:
N = EA lambda max(0, eps + c eps_t), lambda = (x - u)/L, eps = (lambda^2 - 1)/2 (docs/crane.md; Green), or linear
N = EA max(0, eps + c eps_t), eps = lambda - 1.  M x'' = M g - N.  Depths downwards [m].  With damping the force
begins a little before the rope is straight, where eps + c eps_t = 0, and ends before it is unstretched.
Accuracy: closed forms to rounding; motion with its events to 1e-10 while it is not chaotic.
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .crane import speed_ramp


def snap_tension(mass, stiffness, speed, gravity=9.81):
    """M g + sqrt((M g)^2 + k M v^2): greatest tension as a payload at `speed` [m/s] takes up a slack linear spring.

    Energy: M v^2/2 + M g d = k d^2/2 at the lowest point; for k M v^2 >> (M g)^2 it is v sqrt(k M).
    """
    weight = mass * gravity
    return weight + np.sqrt(weight**2 + stiffness * mass * speed**2)


def snap_tension_green(mass, axial_stiffness, length, speed, gravity=9.81):
    """The same with Green's law: M v^2/2 + M g L e = L EA eps^2/2, eps = e + e^2/2, N = EA eps (1 + e)."""

    def balance(e):
        return length * axial_stiffness * (e + e * e / 2) ** 2 / 2 - mass * (speed**2 / 2 + gravity * length * e)

    most = snap_tension(mass, axial_stiffness / length, speed, gravity) / axial_stiffness  # a bound: eps > e
    e = brentq(balance, most / 10, most * 1.001, xtol=1e-17, rtol=1e-15)
    return axial_stiffness * (e + e * e / 2) * (1 + e)


@dataclass(frozen=True)
class Snap:
    """Payload on a weightless rope under a tip that heaves by u = -amplitude sin(2 pi t/period), upwards at first.

    `ramp` [s] > 0: times the quintic envelope of `speed_ramp`.  `green` False: the linear law.
    """

    mass: float = 5000.0
    axial_stiffness: float = 8.0e7
    length: float = 25.0
    damping: float = 1.0e-2
    amplitude: float = 0.0
    period: float = 2.0
    ramp: float = 0.0
    gravity: float = 9.81
    green: bool = True

    def tip(self, time):
        """Depth of the tip and its rate [m, m/s]."""
        omega = 2 * np.pi / self.period
        sine, cosine = np.sin(omega * time), np.cos(omega * time)
        share, rate = 1.0, 0.0
        if self.ramp:
            _, share, rate = speed_ramp(time, 1.0, self.ramp)
        return -self.amplitude * share * sine, -self.amplitude * (share * omega * cosine + rate * sine)

    def strain(self, time, x, v):
        """Stretch, strain and strain rate [-, -, 1/s]."""
        u, rate = self.tip(time)
        stretch, speed = (x - u) / self.length, (v - rate) / self.length
        if self.green:
            return stretch, (stretch**2 - 1) / 2, stretch * speed
        return stretch, stretch - 1, speed

    def tension(self, time, x, v):
        """N [N], not negative."""
        stretch, strain, rate = self.strain(time, x, v)
        stress = self.axial_stiffness * np.maximum(0, strain + self.damping * rate)
        return stress * stretch if self.green else stress

    def energy(self, time, x, v):
        """Kinetic, elastic (of the stretched rope) and potential energy [J]."""
        _, strain, _ = self.strain(time, x, v)
        elastic = self.length * self.axial_stiffness * np.maximum(strain, 0) ** 2 / 2
        return self.mass * v**2 / 2 + elastic - self.mass * self.gravity * x

    def rest(self):
        """Depth of the payload in equilibrium with the tip at 0."""
        ratio = self.mass * self.gravity / self.axial_stiffness
        e = brentq(lambda e: (e + e * e / 2) * (1 + e) - ratio if self.green else e - ratio, 0, 1, xtol=1e-17)
        return self.length * (1 + e)

    def simulate(self, end, x0, v0=0.0, taut=None, tolerance=1e-12):
        """Phases of taut and slack rope, DOP853, each change located to rounding.

        Returns
        -------
        namespace: phases, a list of (taut, scipy solution of x, v, work of the tip and heat); changes (n,) [s];
        peaks, a list of (time, tension) of the local maxima of N
        """
        at, y = 0.0, np.array([x0, v0, 0.0, 0.0])
        if taut is None:
            taut = self.tension(at, x0, v0) > 0
        phases, changes, peaks = [], [], []
        while at < end:
            solution = self._phase(at, end, y, taut, tolerance)
            phases.append((taut, solution))
            if taut:
                peaks += self._peaks(solution)
            at, y = solution.t[-1], solution.y[:, -1]
            if solution.status == 1:
                changes.append(at)
                taut = not taut
        return SimpleNamespace(phases=phases, changes=np.array(changes), peaks=peaks)

    def _phase(self, start, end, y, taut, tolerance):
        EA, L, c = self.axial_stiffness, self.length, self.damping

        def rate(t, y):
            stretch, strain, strain_rate = self.strain(t, y[0], y[1])
            stress = EA * (strain + c * strain_rate) if taut else 0.0
            N = stress * stretch if self.green else stress
            # what the rope takes up less what it stores
            heat = L * (stress - EA * max(strain, 0.0)) * strain_rate
            return [y[1], self.gravity - N / self.mass, -N * self.tip(t)[1], heat]

        def change(t, y):
            _, strain, strain_rate = self.strain(t, y[0], y[1])
            return strain + c * strain_rate

        change.terminal, change.direction = True, -1 if taut else 1
        step = 0.05 * np.sqrt(self.mass * L / EA) * 2 * np.pi  # no change of sign hides inside
        return solve_ivp(
            rate,
            (start, end),
            y,
            "DOP853",
            rtol=tolerance,
            atol=tolerance * np.array([1, 1, 1e4, 1e4]),
            max_step=step,
            events=change,
            dense_output=True,
        )

    def _peaks(self, solution):
        """Local maxima of the tension in a taut phase, by bounded parabolas through three points of fine grids."""
        times = np.linspace(solution.t[0], solution.t[-1], 8 * len(solution.t))
        N = self.tension(times, *solution.sol(times)[:2])
        found = []
        for i in np.flatnonzero((N[1:-1] >= N[:-2]) & (N[1:-1] > N[2:])) + 1:
            low, high = times[i - 1], times[i + 1]
            for _ in range(6):
                fine = np.linspace(low, high, 11)
                values = self.tension(fine, *solution.sol(fine)[:2])
                best = int(np.argmax(values))
                low, high = fine[max(best - 1, 0)], fine[min(best + 1, 10)]
            found.append((float(fine[best]), float(values[best])))
        return found

    def at(self, motion, times):
        """x, v, tip's work, heat and tension (5, n) at `times`."""
        ends = np.array([solution.t[-1] for _, solution in motion.phases])
        rows = []
        for t in times:
            taut, solution = motion.phases[min(int(np.searchsorted(ends, t)), len(ends) - 1)]
            y = solution.sol(t)
            rows.append([*y, float(self.tension(t, y[0], y[1])) if taut else 0.0])
        return np.array(rows).T
