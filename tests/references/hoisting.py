"""Payload on one vertical elastic rope with mass that is paid out or hauled in: a fine axial reference.

Rope of unstretched length l(t) between a point above, where it is fed at the unstretched speed l', and the payload.
Material coordinate s [m unstretched] upwards from the payload; depth below the point x(s, t) = l - s + U(s, t).

    rho x_tt = rho g - N_s,   M x_tt = M g - N at s = 0,   U = 0 at s = l(t),
    N = EA lambda (eps + c eps_t), lambda = 1 - U_s, eps = (lambda^2 - 1)/2 (Green); rates at fixed s.

One Legendre-Gauss-Lobatto mesh xi = s/l in [0, 1] moves with l (ALE): with w = xi l'/l, at fixed s
x_tt = U_tt - 2 w U_txi + w^2 U_xixi + xi (2 l'^2/l^2 - l''/l) U_xi + l'', and the weak form
sum_q W_q N_q D_qi + m_i (g - x_tt,i) = 0, m_i = rho l W_i + M delta_i0.  Spectral in space; Radau in time, or DOP853
without damping.  Tension acts both ways (no slack).  Accuracy of the peaks stored, of the greatest tension: 1e-6, and
1e-5 from 100 m to 1 m without damping.  `drum` is the axial force N just below the drum point.
Run as a program, the module rewrites hoisting.json beside it.
"""

import json
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp

from .crane import speed_ramp, stretch_under

FILE = Path(__file__).parent / "hoisting.json"


def lobatto(count):
    """Nodes, weights and differentiation matrix of `count` Legendre-Gauss-Lobatto points on [0, 1]."""
    leading = np.eye(count)[-1]
    z = np.concatenate([[-1.0], np.sort(legendre.legroots(legendre.legder(leading)).real), [1.0]])
    P = legendre.legval(z, leading)
    gaps = z[:, None] - z
    np.fill_diagonal(gaps, 1.0)
    D = P[:, None] / P / gaps
    np.fill_diagonal(D, 0.0)
    np.fill_diagonal(D, -D.sum(1))
    return (1 + z) / 2, 1 / (count * (count - 1) * P**2), 2 * D


@dataclass(frozen=True)
class Hoist:
    """One vertical fall; speed [m/s] of pay-out (< 0 hoists) is reached with `speed_ramp` over `over` [s].

    `remaining`: the mass the payload has from t = 0 on, the start being the rest under `mass` (load loss); None: all.
    `green` = 0 makes the law linear, N = EA (lambda - 1 + c lambda_t), to compare with waves in closed form.
    """

    axial_stiffness: float = 8.0e7
    mass_per_length: float = 6.5
    mass: float = 5000.0
    damping: float = 1.0e-4
    length: float = 25.0
    speed: float = -2.0
    over: float = 1.0
    gravity: float = 9.81
    remaining: float | None = None
    green: float = 1.0
    nodes: int = 16

    @cached_property
    def mesh(self):
        """xi, W, D and D D."""
        x, W, D = lobatto(self.nodes)
        return x, W, D, D @ D

    def feed(self, time):
        """l, l', l'' at a time."""
        travel, rate, change = speed_ramp(time, self.speed, self.over)
        return self.length + travel, rate, change

    def masses(self, length):
        """The lumped (by Lobatto's rule: exact to degree 2 n - 3) mass of the nodes (n,)."""
        m = self.mass_per_length * length * self.mesh[1]
        m[0] += self.mass if self.remaining is None else self.remaining
        return m

    def strain(self, time, y):
        """lambda - 1 and its material rate at the nodes (n,), with what they come from."""
        x, _, D, D2 = self.mesh
        free = self.nodes - 1
        l, v, a = self.feed(time)
        U, V, w = np.append(y[:free], 0.0), np.append(y[free:], 0.0), x * v / l
        slope, bend, turn = D @ U, D2 @ U, D @ V
        e, rate = -slope / l, (-turn + slope * v / l + w * bend) / l
        carried = a - 2 * w * turn + w * w * bend + x * (2 * v * v / l - a) / l * slope  # x_tt - U_tt
        return SimpleNamespace(length=l, speed=v, change=a, w=w, e=e, rate=rate, carried=carried)

    def tension(self, e, rate):
        """N = EA lambda (eps + c lambda lambda_t) [N]."""
        factor = 1 + self.green * e
        return self.axial_stiffness * factor * (e + self.green * e * e / 2 + self.damping * factor * rate)

    def slope(self, time, y):
        """Rate of the state: displacements U then rates U_t of the nodes below the upper end."""
        _, W, D, _ = self.mesh
        at = self.strain(time, y)
        acceleration = self.gravity - at.carried + D.T @ (W * self.tension(at.e, at.rate)) / self.masses(at.length)
        return np.append(y[self.nodes - 1 :], acceleration[:-1])

    def jacobian(self, time, y):
        """Derivative of `slope` by the state."""
        x, W, D, D2 = self.mesh
        free, c, EA = self.nodes - 1, self.damping, self.axial_stiffness
        at = self.strain(time, y)
        l, v = at.length, at.speed
        factor = 1 + self.green * at.e
        by_e = EA * (1.5 * factor**2 - 0.5 + 2 * c * self.green * factor * at.rate)
        by_rate = EA * c * factor**2
        by_U = (-by_e[:, None] * D + by_rate[:, None] * (v / l * D + at.w[:, None] * D2)) / l
        by_V = -by_rate[:, None] * D / l
        spread = (D.T * W) / self.masses(l)[:, None]
        matrix = np.zeros((2 * free, 2 * free))
        matrix[:free, free:] = np.eye(free)
        carried = (at.w**2)[:, None] * D2 + (x * (2 * v * v / l - at.change) / l)[:, None] * D
        matrix[free:, :free] = (spread @ by_U - carried)[:free, :free]
        matrix[free:, free:] = (spread @ by_V + 2 * at.w[:, None] * D)[:free, :free]
        return matrix

    def rest(self):
        """The state in equilibrium under `mass` at t = 0, by Newton's method from N = M g + rho g s."""
        x, _, D, _ = self.mesh
        free, whole = self.nodes - 1, replace(self, remaining=None)
        weight = (self.mass + self.mass_per_length * self.length * x) * self.gravity
        slope = -(stretch_under(weight, self.axial_stiffness) - 1) * self.length
        y = np.append(np.linalg.lstsq(D[:, :free], slope, rcond=None)[0], np.zeros(free))
        for _ in range(4):
            y[:free] -= np.linalg.solve(whole.jacobian(0.0, y)[free:, :free], whole.slope(0.0, y)[free:])
        return y

    def solve(self, end, tolerance=1e-8, method=None):
        """The motion from rest as scipy's solution with dense output."""
        free = self.nodes - 1
        method = method or ("Radau" if self.damping else "DOP853")
        more = {"jac": self.jacobian} if method == "Radau" else {}
        scale = tolerance * np.repeat([1e-2, 1e-1], free)
        return solve_ivp(
            self.slope, (0, end), self.rest(), method, rtol=tolerance, atol=scale, dense_output=True, **more
        )

    def history(self, solution, times):
        """Payload's depth and velocity downwards, N at the drum point and at the hook, at `times` (n,)."""
        free = self.nodes - 1
        columns = np.empty((4, len(times)))
        for i, (t, y) in enumerate(zip(times, solution.sol(times).T, strict=True)):
            at = self.strain(t, y)
            N = self.tension(at.e, at.rate)
            columns[:, i] = at.length + y[0], at.speed + y[free], N[-1], N[0]
        return dict(zip(("depth", "velocity", "drum", "hook"), columns, strict=True))

    def peak(self, solution, where="drum", sign=1, start=0.0, end=None, step=1e-3):
        """Time [s] and value [N] of the greatest (sign -1: least) tension, `step` refined by three finer grids."""
        end = end or solution.t[-1]
        times = np.linspace(start, end, 1 + round((end - start) / step))
        for _ in range(4):
            N = self.history(solution, times)[where]
            best = int(np.argmax(sign * N))
            found = float(times[best]), float(N[best])
            times = np.linspace(times[max(best - 1, 0)], times[min(best + 1, len(times) - 1)], 21)
        return found

    def energies(self, time, y):
        """Kinetic, elastic and potential energy [J]; power of the feed, less what damping takes [W].

        dE/dt = l' (rho v^2/2 + EA eps^2/2 - lambda N) - integral EA c eps_t^2 ds at s = l, where v = lambda l'.
        """
        x, W, _, _ = self.mesh
        free, rho, EA = self.nodes - 1, self.mass_per_length, self.axial_stiffness
        at = self.strain(time, y)
        l, v, lam = at.length, at.speed, 1 + at.e
        V = np.append(y[free:], 0.0) + v + at.w * l * at.e  # x_t at fixed s: U_t - w U_xi + l'
        eps, flow = at.e + self.green * at.e**2 / 2, (1 + self.green * at.e) * at.rate
        m = self.masses(l)
        kinetic, elastic = m @ V**2 / 2, l * W @ (EA * eps**2 / 2)
        potential = -self.gravity * m @ (l * (1 - x) + np.append(y[:free], 0.0))
        N = self.tension(at.e, at.rate)[-1]
        power = v * (rho * V[-1] ** 2 / 2 + EA * eps[-1] ** 2 / 2 - lam[-1] * N)
        return kinetic, elastic, potential, power, l * W @ (EA * self.damping * flow**2)


LOWERING = Hoist(4.0e8, 33.0, 1.0e5, 1.0e-2, 2000.0, 5.0, 2.0, nodes=20)
# name: scene, end [s], interval of the histories [s]
CASES = {
    "hoist": (Hoist(), 12.0, 0.02),  # the fall of hoist.yaml without vessel and boom: 25 m -> 2 m
    "long_hoist": (Hoist(length=100.0, nodes=12), 50.0, 0.05),  # 100 m -> 1 m
    "long_hoist_undamped": (Hoist(length=100.0, damping=0.0, nodes=10), 50.0, 0.05),  # ends when the hook goes slack
    "lowering": (LOWERING, 30.0, 0.05),  # 2000 m -> 2145 m
    "lowering_undamped": (replace(LOWERING, damping=0.0, nodes=32), 30.0, 0.05),
    "load_loss_to_0": (Hoist(speed=0.0, remaining=0.0, nodes=64), 0.3, 0.001),
    "load_loss_to_50": (Hoist(speed=0.0, remaining=50.0, nodes=64), 0.3, 0.001),
    "load_loss_to_1000": (Hoist(speed=0.0, remaining=1000.0, nodes=64), 0.3, 0.001),
}


def first_slack(hoist, solution):
    """Time [s] at which the hook's tension first vanishes, or the end."""
    end = solution.t[-1]
    times = np.linspace(0, end, 1 + round(end / 1e-3))
    slack = np.flatnonzero(hoist.history(solution, times)["hook"] <= 0)
    return float(times[slack[0] - 1]) if len(slack) else end


def summary(hoist, end, tolerance):
    """Greatest and least tensions with their times; the solution; and the time the hook stays loaded."""
    solution = hoist.solve(end, tolerance)
    start, step = 0.0, 1e-3
    if hoist.remaining is None:
        end = first_slack(hoist, solution)
    else:  # the jump of the first instant is not resolved, 25 m away nothing is felt for 7 ms
        start, step = 1e-3, 1e-4
    peaks = {
        f"{name}_{where}": hoist.peak(solution, where, sign, start, end, step)
        for name, sign in (("greatest", 1), ("least", -1))
        for where in ("drum", "hook")
    }
    return peaks, solution, end


def write_file(names=tuple(CASES)):
    """Rewrite hoisting.json: parameters, peaks (also on a coarser mesh at a coarser tolerance) and histories."""
    found = json.loads(FILE.read_text()) if FILE.exists() else {}
    for name in names:
        hoist, end, interval = CASES[name]
        tolerance = 1e-8 if hoist.damping else 1e-9
        peaks, solution, until = summary(hoist, end, tolerance)
        coarser, _, _ = summary(replace(hoist, nodes=hoist.nodes * 3 // 4), end, 10 * tolerance)
        times = np.arange(0, until + 1e-9, interval)
        history = hoist.history(solution, times)
        digits = {"depth": 8, "velocity": 6, "drum": 2, "hook": 2}
        found[name] = {
            "parameters": asdict(hoist),
            "end": until,
            "peaks": peaks,
            "peaks_coarser": coarser,
            "interval": interval,
            **{key: [round(float(v), digits[key]) for v in column] for key, column in history.items()},
        }
        FILE.write_text(json.dumps({key: found[key] for key in CASES if key in found}, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    write_file()
