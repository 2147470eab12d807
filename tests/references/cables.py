"""Cables, ropes, bars and strings: closed forms and independent integrations to compare the cable program with.

Written from the sources named, without the cable program.  SI units; weights, masses and the coordinate along a cable
are per and in unstretched metres.  `strain` is 'engineering' (N = EA (stretch - 1)) or 'green'
(N = EA stretch (stretch^2 - 1)/2, the force of the element of the thesis, eq. 2.52).
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import brentq, root
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc, j0, jn_zeros

FINEST = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}


def stretch_of(force, EA, strain="engineering"):
    """Stretch under an axial force [N]."""
    if strain == "engineering":
        return 1 + np.asarray(force) / EA
    stretch = 1 + np.asarray(force) / EA
    for _ in range(60):  # Newton's method on the cubic, from above or next to the root
        stretch = stretch - (stretch**3 - stretch - 2 * np.asarray(force) / EA) / (3 * stretch**2 - 1)
    return stretch


def force_of(stretch, EA, strain="engineering"):
    """Axial force [N] at a stretch."""
    return EA * (stretch - 1) if strain == "engineering" else EA * stretch * (stretch**2 - 1) / 2


# statics
@dataclass(frozen=True)
class Catenary:
    """A hanging cable from A (s = 0) at the origin to B (s = length), z up.

    The cable pulls A with (horizontal, vertical) and B with (-horizontal, -vertical - weight of the cable).
    """

    horizontal: float
    vertical: float  # of the tension at A, positive if the cable rises from A
    length: float
    EA: float
    weight: float  # per unstretched metre
    strain: str

    def tension(self, s):
        return np.hypot(self.horizontal, self.vertical + self.weight * np.asarray(s))

    def shape(self, s):
        """Positions x and z, shape (2, len(s)), of the particles s."""
        s = np.asarray(s, dtype=float)
        if self.strain == "engineering":
            return _catenary_at(s, self.horizontal, self.vertical, self.EA, self.weight)
        # in y with vertical = H sinh(y) the integrands are smooth however deep the sag
        x, w = leggauss(60)
        span = _asinh_step(self.vertical / self.horizontal, self.weight * s / self.horizontal)[..., None]
        y = np.arcsinh(self.vertical / self.horizontal) + span * (1 + x) / 2
        stretch = stretch_of(self.horizontal * np.cosh(y), self.EA, self.strain)
        share = span * w / 2 * stretch * self.horizontal / self.weight
        return np.stack([np.sum(share, -1), np.sum(share * np.sinh(y), -1)])

    @property
    def end_forces(self):
        """Forces of the supports on the cable at A and at B, rows of (x, z)."""
        top = self.vertical + self.weight * self.length
        return np.array([[-self.horizontal, -self.vertical], [self.horizontal, top]])


def _asinh_step(a, step):
    """asinh(a + step) - asinh(a) without the cancellation that a taut cable would suffer."""
    b = a + step
    roots = np.hypot(1, a), np.hypot(1, b)
    gap = np.where(a * b > 0, (1 + a**2 + b**2) / (roots[0] * roots[1] + np.abs(a * b)), roots[0] * roots[1] - a * b)
    return 2 * np.arcsinh(step / (roots[0] + roots[1]) * np.sqrt((1 + gap) / 2))


def _catenary_at(s, H, V, EA, w):
    x = H * s / EA + H / w * _asinh_step(V / H, w * s / H)
    z = s * (V + w * s / 2) * (1 / EA + 2 / (np.hypot(H, V + w * s) + np.hypot(H, V)))
    return np.stack([x, z])


def catenary(span, rise, length, EA, weight, strain="engineering"):
    """Elastic catenary between supports at (0, 0) and (span, rise), span > 0.

    Source: H. M. Irvine, Cable Structures (1981), the elastic catenary (engineering strain, mass per
    unstretched length).  Green strain has no closed form: the same integrals with its stretch, by 60 Gauss points.
    """
    straight = np.hypot(span, rise)
    # first guess as usual in mooring: the slack catenary's parabola, or the straight cable's pull where it is stretched
    parameter = 0.2 if length <= straight else np.sqrt(3 * ((length**2 - rise**2) / span**2 - 1))
    horizontal = max(weight * span / (2 * parameter), EA * (straight / length - 1) * span / straight)
    vertical = weight / 2 * (rise / np.tanh(parameter) - length)
    if length <= straight:
        vertical = horizontal * rise / span - weight * length / 2

    def miss(unknown):
        candidate = Catenary(np.exp(unknown[0]), unknown[1] * weight * length, length, EA, weight, strain)
        return (candidate.shape(length) - [span, rise]) / straight

    found = root(miss, [np.log(horizontal), vertical / (weight * length)], tol=1e-14)
    if not np.abs(miss(found.x)).max() < 1e-11:  # also where it is not a number
        raise ValueError(f"no catenary found: span {span}, rise {rise}, length {length}, EA {EA}, weight {weight}")
    return Catenary(float(np.exp(found.x[0])), float(found.x[1] * weight * length), length, EA, weight, strain)


def hanging_rope(s, length, EA, weight, tip_load=0.0, strain="engineering"):
    """Depth below the support [m] and force [N] of the particles s of a rope that hangs straight down.

    Integral of the stretch under the weight below; engineering: s + (tip_load s + weight (length s - s^2/2))/EA.
    """
    s = np.asarray(s, dtype=float)
    force = tip_load + weight * (length - s)
    if strain == "engineering":
        return s + (tip_load * s + weight * (length * s - s**2 / 2)) / EA, force
    x, w = leggauss(40)
    at = s[..., None] * (1 + x) / 2
    stretch = stretch_of(tip_load + weight * (length - at), EA, strain)
    return np.sum(s[..., None] / 2 * w * stretch, -1), force


@dataclass(frozen=True)
class Tip:
    """Tip of a bent cantilever: forward x, sideways y [m], slope [rad], and the moment at the clamp [N m]."""

    x: float
    y: float
    slope: float
    moment: float


def elastica(load, length, EI):
    """Inextensible cantilever with a dead transverse load [N] at its tip, by elliptic integrals.

    Source: K. E. Bisshopp and D. C. Drucker, Large deflection of cantilever beams, Quart. Appl. Math. 3 (1945) 272-275.
    """
    similarity = np.sqrt(load * length**2 / EI)

    def amplitude(m):
        return np.arcsin(1 / np.sqrt(2 * m))

    m = brentq(
        lambda m: ellipk(m) - ellipkinc(amplitude(m), m) - similarity, 0.5 + 1e-15, 1 - 1e-14, xtol=1e-16, rtol=1e-15
    )
    y = length * (1 - 2 / similarity * (ellipe(m) - ellipeinc(amplitude(m), m)))
    x = length * np.sqrt(2 * (2 * m - 1)) / similarity
    return Tip(float(x), float(y), float(np.arcsin(2 * m - 1)), float(load * x))


def extensible_cantilever(load, length, EA, EI, strain="green", curvature="geometric"):
    """Cantilever with a dead transverse load [N] at its tip that stretches as well as bends, by shooting.

    Stationary potential of a plane rod r' = stretch (cos theta, sin theta) with the energy per unstretched metre
    EA eps^2/2 + EI kappa^2/2; with the force F = (0, load) of all sections and the moment M = d energy/d theta':

        M' = -stretch F.n,  d energy/d stretch = F.t,  theta(0) = 0,  M(length) = 0.

    curvature 'geometric': kappa = theta'/stretch, thesis eq. 2.55, so theta' = M stretch^2/EI and bending feeds back on
    the axial force; 'material': kappa = theta' (the extensible elastica of Antman, Nonlinear Problems of Elasticity,
    chapter 4).
    """
    bends = curvature == "geometric"

    def stretched(theta, moment):
        pull, softer = load * np.sin(theta), moment**2 / EI if bends else 0.0
        stretch = 1.0
        for _ in range(30):
            stiffness = EA if strain == "engineering" else EA * (3 * stretch**2 - 1) / 2
            step = (force_of(stretch, EA, strain) - softer * stretch - pull) / (stiffness - softer)
            stretch -= step
            if abs(step) < 1e-15:
                break
        return stretch

    def rates(_, state):
        theta, moment = state[:2]
        stretch = stretched(theta, moment)
        turn = moment / EI * (stretch**2 if bends else 1.0)
        return [turn, -stretch * load * np.cos(theta), stretch * np.cos(theta), stretch * np.sin(theta)]

    def back(slope):
        return solve_ivp(rates, (length, 0.0), [slope, 0.0, 0.0, 0.0], **FINEST).y[:, -1]

    slope = brentq(lambda s: back(s)[0], 0.0, np.pi / 2, xtol=1e-14, rtol=1e-14)
    _, moment, x, y = back(slope)
    return Tip(float(-x), float(-y), float(slope), float(moment))


# frequencies of continua
def axial_frequencies(EA, rhoA, length, count, ends="clamped-free"):
    """Axial frequencies [Hz] of a bar, clamped-free or clamped-clamped (S. S. Rao, Mechanical Vibrations)."""
    half_waves = np.arange(1, count + 1) - (0.5 if ends == "clamped-free" else 0.0)
    return half_waves / (2 * length) * np.sqrt(EA / rhoA)


def hanging_chain_frequencies(length, gravity, count):
    """Frequencies [Hz] of the small swings of a chain hung at one end: zeros of J0 (D. Bernoulli 1738; H. Lamb)."""
    return jn_zeros(0, count) / 2 * np.sqrt(gravity / length) / (2 * np.pi)


def hanging_chain_mode(n, below):
    """Shape J0(j_n sqrt(z/L)) of mode n (from 1), one at the free end; `below` is z/L above the free end, 0 to 1."""
    return j0(jn_zeros(0, n)[-1] * np.sqrt(below))


def string_frequencies(tension, EI, rhoA, length, count, ends="pinned"):
    """Lateral frequencies [Hz] of a taut string or tie rod with bending stiffness: EI w'''' - T w'' = rhoA omega^2 w.

    pinned: omega = (n pi/L) sqrt(T/rhoA) sqrt(1 + n^2 pi^2 EI/(T L^2)).  clamped: with EI (a^2 - b^2) = T and
    EI a^2 b^2 = rhoA omega^2, even modes a tanh(a l) = -b tan(b l), odd modes b tanh(a l) = a tan(b l), l = L/2
    (e.g. Timoshenko, Young and Weaver, Vibration Problems in Engineering, beams with axial force).  For a cable
    stretched by lambda, in unstretched metres: tension EA eps (Green) or N/lambda, EI/lambda^4.
    """
    n = np.arange(1, count + 1)
    if ends == "pinned":
        wave = n * np.pi / length
        return wave * np.sqrt((tension + EI * wave**2) / rhoA) / (2 * np.pi)
    half = length / 2

    def decay(b):
        return np.sqrt(b**2 + tension / EI)

    def even(b):  # times cos, so that there is no pole
        a = decay(b)
        return a * np.tanh(a * half) * np.cos(b * half) + b * np.sin(b * half)

    def odd(b):
        a = decay(b)
        return b * np.tanh(a * half) * np.cos(b * half) - a * np.sin(b * half)

    waves = np.array(
        [brentq(even if k % 2 else odd, k * np.pi / length, (k + 1) * np.pi / length, rtol=1e-15) for k in n]
    )
    return decay(waves) * waves * np.sqrt(EI / rhoA) / (2 * np.pi)


# motions
def sliding_rope(t, angle, gravity):
    """Travel [m] of an inextensible rope along a frictionless straight line at `angle` below the horizontal, from rest.

    Newton's law along the line: s = g sin(angle) t^2/2.  p of a node at rest falls by it: s = -(p - p0) where p
    increases down the line.
    """
    return gravity * np.sin(angle) * np.asarray(t) ** 2 / 2


def table_rope(t, overhang, length, gravity):
    """Overhang [m] of an inextensible rope sliding off a frictionless table from rest: overhang cosh(t sqrt(g/L))."""
    return overhang * np.cosh(np.asarray(t) * np.sqrt(gravity / length))


def elastic_pendulum(times, length, EA, tip_mass, rhoA, gravity, angle, stretch=1.0, strain="green"):
    """Positions (2, times) of the tip, x and z from the support, of a pendulum on a straight extensible cable.

    The cable stretches uniformly, which is the linear element exactly: a third of its mass moves with the tip and half
    of its weight hangs there.  Lagrange's equations in polar coordinates, starting at rest with the angle from the
    plumb line and the stretch given; DOP853 to 1e-13.
    """
    mass, weight = tip_mass + rhoA * length / 3, (tip_mass + rhoA * length / 2) * gravity

    def rates(_, state):
        radius, swing, radial, spin = state
        pull = force_of(radius / length, EA, strain)
        return [
            radial,
            spin,
            radius * spin**2 + (weight * np.cos(swing) - pull) / mass,
            (-2 * radial * spin - weight * np.sin(swing) / mass) / radius,
        ]

    start = [length * stretch, angle, 0.0, 0.0]
    radius, swing = solve_ivp(rates, (0.0, np.max(times)), start, t_eval=times, **FINEST).y[:2]
    return np.stack([radius * np.sin(swing), -radius * np.cos(swing)])


# the axial bar of cubic elements (thesis section 2.5)
def hermite_bar(elements, EA, rhoA, length):
    """Stiffness and consistent mass of an axial bar of equal cubic Hermite elements, unknowns (u, u') node by node.

    The integrals of the polynomials are exact.  The bar is free: delete the rows of what is held.
    """
    h = length / elements
    shapes = [
        Polynomial([1, 0, -3 / h**2, 2 / h**3]),
        Polynomial([0, 1, -2 / h, 1 / h**2]),
        Polynomial([0, 0, 3 / h**2, -2 / h**3]),
        Polynomial([0, 0, -1 / h, 1 / h**2]),
    ]

    def products(functions):
        return np.array([[(f * g).integ()(h) for g in functions] for f in functions])

    k, m = EA * products([f.deriv() for f in shapes]), rhoA * products(shapes)
    stiffness, mass = np.zeros((2, 2 * elements + 2, 2 * elements + 2))
    for e in range(elements):
        part = slice(2 * e, 2 * e + 4)
        stiffness[part, part] += k
        mass[part, part] += m
    return stiffness, mass


def hermite_bar_frequencies(elements, EA, rhoA, length, held=(0,)):
    """Frequencies [Hz], ascending, of `hermite_bar` with the unknowns `held`; (0,) clamps u and leaves the slope."""
    stiffness, mass = hermite_bar(elements, EA, rhoA, length)
    free = np.setdiff1d(np.arange(len(mass)), held)
    squares = eigh(stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(np.abs(squares)) / (2 * np.pi)


def effective_lengths():
    """Effective lengths L_eff/L_e = 2 c/(omega L_e) of one cubic element, ascending, rigid modes left out.

    Keys: the supports 'f/f', 'p/f', 'p/p' and the patterns '+/-' (eq. 2.152), '+/+' (eq. 2.153); thesis Table 2.1.
    """
    stiffness, mass = hermite_bar(1, 1.0, 1.0, 1.0)
    unit = np.eye(4)
    bases = {
        "f/f": unit,
        "p/f": unit[:, 1:],
        "p/p": unit[:, [1, 3]],
        "+/-": np.vstack([unit[:2, :2], -unit[:2, :2]]),
        "+/+": np.vstack([unit[:2, :2], unit[:2, :2]]),
    }
    lengths = {}
    for name, basis in bases.items():
        squares = eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis, eigvals_only=True)
        lengths[name] = np.sort(2 / np.sqrt(squares[squares > 1e-9]))
    return lengths


def mesh_highest_frequency(elements, EA=1.0, rhoA=1.0, length=1.0, ends="pinned-free"):
    """Highest angular frequency [rad/s] of `hermite_bar`, pinned-free or pinned-pinned, all slopes free."""
    held = (0,) if ends == "pinned-free" else (0, 2 * elements)
    return 2 * np.pi * hermite_bar_frequencies(elements, EA, rhoA, length, held)[-1]


@dataclass(frozen=True)
class Hammer:
    """Small motion of the clamped bar of cubic elements after a force on its tip for a time, by modes.

    Unknowns (u0', u1, u1', ..., un, un'); `modes` are its columns, of unit modal mass.
    """

    frequencies: np.ndarray  # [Hz]
    modes: np.ndarray
    force: float
    duration: float

    def _modal(self, t):
        omega = 2 * np.pi * self.frequencies
        t = np.asarray(t, dtype=float)[..., None]
        after = np.maximum(t - self.duration, 0.0)
        return self.force * self.modes[-2] * (np.cos(omega * after) - np.cos(omega * t)) / omega**2

    def response(self, t):
        """All unknowns at the times t, shape (..., unknowns)."""
        return self._modal(t) @ self.modes.T

    def tip(self, t):
        """Displacement of the tip [m]."""
        return self.response(t)[..., -2]

    def lines(self, unknown=-2):
        """Amplitudes of the spectral lines of an unknown (default the tip) once the force is gone [m]."""
        omega = 2 * np.pi * self.frequencies
        push = 2 * self.force * self.modes[-2] / omega**2 * np.abs(np.sin(omega * self.duration / 2))
        return np.abs(push * self.modes[unknown])


def hammer(elements=2, EA=1.0, rhoA=1.0, length=1.0, force=0.01, duration=1.0):
    """The hammer test of the thesis (Figs. 2.20 to 2.22), linear strain: exact modal superposition of the mesh."""
    stiffness, mass = (matrix[1:, 1:] for matrix in hermite_bar(elements, EA, rhoA, length))
    squares, modes = eigh(stiffness, mass)
    return Hammer(np.sqrt(squares) / (2 * np.pi), modes, force, duration)


def hammer_green(times, elements=2, EA=1.0, rhoA=1.0, length=1.0, force=0.01, duration=1.0, points=8, gravity=0.0):
    """Unknowns (times, unknowns) of the same bar with Green strain, DOP853 to 1e-13: (u0', u1, u1', ...) as `Hammer`.

    Force of the strain energy: integral of EA stretch (stretch^2 - 1)/2 times the derivative of the shape functions,
    by `points` Gauss points (5 integrate it exactly); `gravity` along the bar towards the free end.
    """
    h = length / elements
    mass = hermite_bar(elements, EA, rhoA, length)[1][1:, 1:]
    x, w = leggauss(points)
    x = (1 + x) / 2
    slopes = np.stack([(6 * x**2 - 6 * x) / h, 3 * x**2 - 4 * x + 1, (6 * x - 6 * x**2) / h, 3 * x**2 - 2 * x])
    weighted = slopes * w * h / 2
    inverse = np.linalg.inv(mass)
    uniform = np.zeros(2 * elements + 2)
    for e in range(elements):
        uniform[2 * e : 2 * e + 4] += rhoA * gravity * h * np.array([1 / 2, h / 12, 1 / 2, -h / 12])
    half = len(mass)

    def rates(_, state, push):
        unknown = np.concatenate([[0.0], state[:half]])
        resistance = np.zeros_like(unknown)
        for e in range(elements):
            part = slice(2 * e, 2 * e + 4)
            resistance[part] += weighted @ force_of(1 + unknown[part] @ slopes, EA, "green")
        total = (uniform - resistance)[1:]
        total[-2] += push
        return np.concatenate([state[half:], inverse @ total])

    times = np.asarray(times, dtype=float)
    during, after = times[times < duration], times[times >= duration]
    hit = solve_ivp(rates, (0.0, duration), np.zeros(2 * half), t_eval=[*during, duration], args=(force,), **FINEST).y
    parts = [hit[:half, : len(during)]]
    if len(after):
        swing = solve_ivp(rates, (duration, after[-1] + 1e-9), hit[:, -1], t_eval=after, args=(0.0,), **FINEST)
        parts.append(swing.y[:half])
    return np.hstack(parts).T
