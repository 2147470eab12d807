"""Pipes conveying fluid: stability, statics and large planar motion to compare the hose program with.

Derived from the strong and the virtual-work form of the equations of motion, without the hose program and without
finite elements.  Three parts:

1. the straight inextensible cantilever of R. W. Gregory and M. P. Paidoussis, Unstable oscillation of tubular
   cantilevers conveying fluid, Proc. R. Soc. A 293 (1966) 512-542: exact characteristic determinant, dimensionless;
2. the extensible hose bent by its weight in a steady flow: a one-parameter shooting problem, SI units;
3. the same hose in large planar motion: global polynomials in arc length (spectral Galerkin), SI units.

Dimensionless quantities of part 1: u = U L sqrt(M/EJ), beta = M/(m + M), time in L^2 sqrt((m + M)/EJ),
alpha = c/(unit of time) with c the Kelvin-Voigt damping time, gamma = (m + M) g L^3/EJ (> 0: the pipe hangs).
Run as a program, the module rewrites hose_tip.csv and hose_cycles.json beside it.
"""

import csv
import json
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.integrate import Radau, solve_ivp
from scipy.linalg import eigvals
from scipy.optimize import brentq
from scipy.special import eval_jacobi

HERE = Path(__file__).parent

# u at which a supported pipe buckles (the flow then does no work in a cycle: it acts as a dead thrust M U^2)
PINNED_PINNED = np.pi
CLAMPED_CLAMPED = 2 * np.pi
CLAMPED_PINNED = brentq(lambda u: np.sin(u) - u * np.cos(u), 4.4, 4.6, xtol=1e-15)


# ----------------------------------------------------------------------------------------------------------------------
# 1. the straight cantilever
# ----------------------------------------------------------------------------------------------------------------------
def characteristic(eigenvalue, u, beta, alpha=0.0):
    """The boundary determinant of the cantilever at w = exp(eigenvalue t) sum_j A_j exp(p_j x), arrays broadcast.

    (1 + alpha lambda) p^4 + u^2 p^2 + 2 sqrt(beta) u lambda p + lambda^2 = 0; rows w(0) = w'(0) = 0,
    w''(1) = w'''(1) = 0.  Divided by Vandermonde's determinant of the p_j, it does not depend on their order and
    has no zeros where two of them meet; scaled by a positive number, so its phase is that of an entire function.
    """
    lam, u, beta = np.broadcast_arrays(np.asarray(eigenvalue, dtype=complex), u, beta)
    companion = np.zeros((*lam.shape, 4, 4), dtype=complex)
    companion[..., [1, 2, 3], [0, 1, 2]] = 1
    stiffness = 1 + alpha * lam
    companion[..., 0, 3] = -(lam**2) / stiffness
    companion[..., 1, 3] = -2 * np.sqrt(beta) * u * lam / stiffness
    companion[..., 2, 3] = -(u**2) / stiffness
    p = np.moveaxis(np.linalg.eigvals(companion), -1, 0)
    # Laplace's expansion: columns i, j in the first two rows and k, l in the last two
    split = [(0, 1, 2, 3, 1), (0, 2, 1, 3, -1), (0, 3, 1, 2, 1), (1, 2, 0, 3, 1), (1, 3, 0, 2, -1), (2, 3, 0, 1, 1)]
    scale = np.max([(p[k] + p[l]).real for _, _, k, l, _ in split], axis=0)
    total, vandermonde = 0, 1
    for i, j, k, l, sign in split:
        minors = (p[j] - p[i]) * (p[k] * p[l]) ** 2 * (p[l] - p[k])
        total = total + sign * minors * np.exp(p[k] + p[l] - scale)
        vandermonde = vandermonde * (p[j] - p[i])
    return total / vandermonde


class Pipe:
    """Galerkin's method for the same cantilever with polynomials: x^2 times Jacobi polynomials (0, 4) on (0, 1).

    They are orthogonal with this factor, satisfy w(0) = w'(0) = 0, and the free end's conditions are natural.
    """

    def __init__(self, modes=32):
        x, weights = leggauss(modes + 8)
        x, weights = (1 + x) / 2, weights / 2
        w, slope, bend = _orthonormal(x, modes, 2)
        self.modes = modes
        self.bend = np.einsum("qi,qj,q->ij", bend, bend, weights)
        self.thrust = np.einsum("qi,qj,q->ij", w, bend, weights)
        self.coriolis = np.einsum("qi,qj,q->ij", w, slope, weights)
        self.hang = np.einsum("qi,qj,q->ij", slope, slope, weights * (1 - x))

    def matrices(self, u, beta, alpha=0.0, gamma=0.0):
        """Stiffness and damping matrix; the mass matrix is the identity."""
        return (
            self.bend + u**2 * self.thrust + gamma * self.hang,
            alpha * self.bend + 2 * np.sqrt(beta) * u * self.coriolis,
        )

    def eigenvalues(self, u, beta, alpha=0.0, gamma=0.0):
        """All 2 modes eigenvalues, by magnitude; about the lower half of them mean something."""
        stiffness, damping = self.matrices(u, beta, alpha, gamma)
        n = self.modes
        found = eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]))
        return found[np.argsort(np.abs(found))]

    def phase(self, omega, u, beta, alpha=0.0, gamma=0.0):
        """The determinant of the dynamic stiffness at i omega over its magnitude; omega and u of one shape."""
        stiffness, damping = self.bend + gamma * self.hang, alpha * self.bend
        result = np.empty(u.shape, dtype=complex)
        for at in np.ndindex(u.shape[0]):  # a row at a time, for the memory
            row, w = u[at][..., None, None], omega[at][..., None, None]
            matrix = stiffness + row**2 * self.thrust - w**2 * np.eye(self.modes)
            matrix = matrix + 1j * w * (damping + 2 * np.sqrt(beta) * row * self.coriolis)
            result[at] = np.linalg.slogdet(matrix)[0]
        return result


def _orthonormal(x, count, power):
    """x^power P_n(x), n < count, orthonormal on (0, 1), and its first two derivatives, each (len(x), count)."""
    n = np.arange(count)
    b = 2 * power
    y, x = 2 * x[:, None] - 1, x[:, None]
    values = eval_jacobi(n, 0, b, y)
    first = np.where(n > 0, (n + b + 1) * eval_jacobi(np.maximum(n - 1, 0), 1, b + 1, y), 0)
    second = np.where(n > 1, (n + b + 1) * (n + b + 2) * eval_jacobi(np.maximum(n - 2, 0), 2, b + 2, y), 0)
    scale = np.sqrt(2 * n + b + 1)
    down1 = power * x ** max(power - 1, 0)
    down2 = power * (power - 1) * x ** max(power - 2, 0)
    return (
        scale * x**power * values,
        scale * (x**power * first + down1 * values),
        scale * (x**power * second + 2 * down1 * first + down2 * values),
    )


def eigenvalues(u, beta, count=4, alpha=0.0):
    """The first `count` eigenvalues of the cantilever with non-negative imaginary part, by frequency.

    Newton's method on the exact determinant from Galerkin's values.
    """
    guesses = Pipe(24 + 2 * count).eigenvalues(u, beta, alpha)
    guesses = guesses[guesses.imag >= 0][: count + 2]
    found = np.array([_newton_eigenvalue(guess, u, beta, alpha) for guess in guesses])
    return found[np.argsort(np.abs(found.imag), kind="stable")][:count]


def _newton_eigenvalue(guess, u, beta, alpha):
    for _ in range(20):
        h = 1e-5 * max(1, abs(guess))
        f, ahead, behind = characteristic(guess + np.array([0, h, -h]), u, beta, alpha)
        # the scale factor depends on the eigenvalue: harmless, as the product of f with it stays small
        step = f / ((ahead - behind) / (2 * h))
        guess = guess - step
        if abs(step) < 1e-12 * abs(guess):
            break
    return guess


@dataclass(frozen=True)
class Crossing:
    """A speed u at which an eigenvalue is i omega, and where it goes as u rises."""

    u: float
    omega: float
    becomes: str  # 'unstable' or 'stable'


def critical_speeds(beta, alpha=0.0, gamma=0.0, upto=18.0, modes=32):
    """Every crossing of the imaginary axis by an eigenvalue of the cantilever for u in (0.05, upto], u increasing.

    The determinant at i omega as a map of the (u, sqrt(omega)) plane to the complex one has a simple zero at a
    crossing.  A loop about it winds once round the origin, one way if the eigenvalue leaves to the right and the other
    way if to the left.  Cells of a grid are examined for winding, subdivided where the phase turns fast, and the
    zeros found are polished.  gamma = 0: the exact determinant; else that of Galerkin's method with `modes` functions.

    Returns
    -------
    list of Crossing
    """
    if gamma == 0:

        def phase(u, root):
            return characteristic(1j * root**2, u, beta, alpha)
    else:
        pipe = Pipe(modes)

        def phase(u, root):
            return pipe.phase(root**2, u, beta, alpha, gamma)

    # beyond sqrt(omega) = 1.8 u + 8 the pipe is a beam, damped by Coriolis' force
    cells = _winding_cells(phase, np.linspace(0.05, upto, 1 + round(10 * upto)), np.linspace(0.2, 1.8 * upto + 8, 260))
    found = []
    for u, root, winding in cells:
        if gamma == 0:
            u, omega = _polish(u, root**2, beta, alpha)
        else:
            u, omega = _polish_galerkin(pipe, u, root**2, beta, alpha, gamma)
        found.append(Crossing(u, omega, "unstable" if winding < 0 else "stable"))
    return sorted((c for c in found if c.u <= upto), key=lambda c: c.u)


def _winding_cells(phase, us, roots, depth=0):
    """Centres of the cells of the grid (us, roots) round which the phase winds, and the winding."""
    values = phase(*np.meshgrid(us, roots, indexing="ij"))
    along = np.angle(values[1:] / values[:-1])  # of edges in u
    across = np.angle(values[:, 1:] / values[:, :-1])
    total = along[:, :-1] + across[1:] - along[:, 1:] - across[:-1]
    winding = np.rint(total / (2 * np.pi)).astype(int)
    fast = np.maximum(np.maximum(abs(along[:, :-1]), abs(along[:, 1:])), np.maximum(abs(across[1:]), abs(across[:-1])))
    found = []
    for i, j in np.argwhere((winding != 0) | (fast > 1.2)):
        if depth < 4 and (depth < 1 or fast[i, j] > 1.2):
            finer = np.linspace(us[i], us[i + 1], 5), np.linspace(roots[j], roots[j + 1], 5)
            found += _winding_cells(phase, *finer, depth + 1)
        elif winding[i, j] != 0:
            found.append(((us[i] + us[i + 1]) / 2, (roots[j] + roots[j + 1]) / 2, winding[i, j]))
    return found


def _polish(u, omega, beta, alpha):
    """Newton's method for the exact crossing near (u, omega)."""
    for _ in range(30):
        h = 1e-6 * np.array([u, omega])
        at = np.array([[u, omega], [u + h[0], omega], [u - h[0], omega], [u, omega + h[1]], [u, omega - h[1]]])
        d = characteristic(1j * at[:, 1], at[:, 0], beta, alpha)
        du, dw = (d[1] - d[2]) / (2 * h[0]), (d[3] - d[4]) / (2 * h[1])
        step = np.linalg.solve([[du.real, dw.real], [du.imag, dw.imag]], [d[0].real, d[0].imag])
        step *= min(1, 0.1 / abs(step[0] + 1e-300))
        u, omega = u - step[0], omega - step[1]
        if abs(step[0]) < 1e-13 * u:
            break
    return float(u), float(omega)


def _polish_galerkin(pipe, u, omega, beta, alpha, gamma):
    def nearest(speed, target):
        all_ = pipe.eigenvalues(speed, beta, alpha, gamma)
        return all_[np.argmin(abs(all_ - target))]

    target = 1j * omega
    for _ in range(40):
        h = 1e-4
        target = nearest(u, target)
        slope = (nearest(u + h, target).real - nearest(u - h, target).real) / (2 * h)
        step = target.real / slope
        u -= np.clip(step, -0.05, 0.05)
        if abs(step) < 1e-11:
            break
    return float(u), float(abs(target.imag))


def boundary_curve(alpha=0.0, step=0.02, lowest=0.002, highest=0.995, start=(0.2, 5.6, 13.5)):
    """The boundary of flutter as one continuous curve, S-shaped jumps included.

    Followed in both directions by its arc length in (beta, u/10, omega/50) with Newton corrections.

    Returns
    -------
    beta, u, omega : arrays (n,)
    """
    scale = np.array([1, 10, 50.0])

    def equations(point):
        beta, u, omega = point * scale
        d = characteristic(1j * omega, u, beta, alpha)
        return np.array([d.real, d.imag])

    def jacobian(point):
        h = 1e-6
        return np.column_stack([(equations(point + e) - equations(point - e)) / (2 * h) for e in h * np.eye(3)])

    def correct(point, tangent):
        target = tangent @ point
        for _ in range(12):
            if not 1e-5 < point[0] < 1:
                return None
            matrix = np.vstack([jacobian(point), tangent])
            size = np.linalg.norm(matrix[:2], axis=1)[:, None]  # equilibrated: the determinant has no scale
            residual = np.append(equations(point) / size[:, 0], tangent @ point - target)
            matrix[:2] /= size
            change = np.linalg.solve(matrix, residual)
            point = point - change
            if np.abs(change).max() < 1e-13:
                return point
        return point if np.abs(change).max() < 1e-9 and 0 < point[0] < 1 else None

    first = correct(np.array(start) / scale, np.array([1.0, 0, 0]))
    halves = []
    for sign in (-1, 1):
        points, tangent, length = [first], sign * np.array([1.0, 0, 0]), step
        while lowest < points[-1][0] < highest and len(points) < 20000:
            rows = jacobian(points[-1])
            normal = np.cross(rows[0] / np.linalg.norm(rows[0]), rows[1] / np.linalg.norm(rows[1]))
            normal /= np.linalg.norm(normal)
            forward = normal if normal @ tangent > 0 else -normal
            attempt = correct(points[-1] + length * forward, forward)
            chord = None if attempt is None else (attempt - points[-1]) / np.linalg.norm(attempt - points[-1])
            if chord is None or chord @ forward < 0.995:
                length /= 2
                if length < 1e-7:
                    break
                continue
            points.append(attempt)
            tangent, length = forward, min(step, 1.5 * length)
        halves.append(points)
    curve = np.array(halves[0][:0:-1] + halves[1]) * scale
    return curve.T


def boundary(u, curve=None, alpha=0.0):
    """All (beta, omega) on the boundary curve at a speed u, by increasing beta; shape (n, 2)."""
    betas, speeds, omegas = boundary_curve(alpha) if curve is None else curve
    found = []
    for i in np.flatnonzero((speeds[:-1] - u) * (speeds[1:] - u) <= 0):
        share = (u - speeds[i]) / (speeds[i + 1] - speeds[i])
        beta, omega = betas[i] + share * (betas[i + 1] - betas[i]), omegas[i] + share * (omegas[i + 1] - omegas[i])
        for _ in range(20):
            h = 1e-6 * beta, 1e-6 * omega
            d = characteristic(
                1j * (omega + h[1] * np.array([0, 0, 0, 1, -1])), u, beta + h[0] * np.array([0, 1, -1, 0, 0]), alpha
            )
            db, dw = (d[1] - d[2]) / (2 * h[0]), (d[3] - d[4]) / (2 * h[1])
            step = np.linalg.solve([[db.real, dw.real], [db.imag, dw.imag]], [d[0].real, d[0].imag])
            beta, omega = beta - step[0], omega - step[1]
        found.append((beta, omega))
    return np.array(sorted(found)).reshape(-1, 2)


# ----------------------------------------------------------------------------------------------------------------------
# 2. the extensible hose in a steady flow
# ----------------------------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Parameters:
    """A hose with flow in a vertical plane, clamped at the origin and free at the other end; lengths unstretched.

    Energy per ds: EA strain^2/2 + EJ kappa^2/2 with the geometric curvature kappa, and strain = (|r'|^2 - 1)/2
    ('green') or |r'| - 1 ('engineering').  Dissipation per ds: damping (EA strain-dot^2 + EJ kappa-dot^2)/2, the second
    term times kappa^2/(kappa^2 + smoothing^2): the law in space, (k . k-dot)^2/(k . k + smoothing^2), in the plane.
    """

    length: float = 0.5  # m
    EA: float = 10.0  # N
    EJ: float = 0.00108  # N m^2
    mass: float = 0.0031316  # kg/m of the hose alone
    water: float = 0.0007854  # kg/m
    damping: float = 0.0031316  # s
    gravity: float = 9.81  # m/s^2, downwards
    angle: float = 0.0  # of the clamp above the horizontal, rad
    clamp: str = "direction"  # or 'slope': r' = (cos angle, sin angle) at the root
    strain: str = "green"
    smoothing: float = 0.0  # 1/m

    @property
    def weight(self):
        """N/m of hose and water."""
        return (self.mass + self.water) * self.gravity

    @property
    def beta(self):
        return self.water / (self.mass + self.water)

    @property
    def time(self):
        """The unit of the dimensionless time, s."""
        return self.length**2 * np.sqrt((self.mass + self.water) / self.EJ)

    def dimensionless_speed(self, U):
        return U * self.length * np.sqrt(self.water / self.EJ)


@dataclass(frozen=True)
class StaticShape:
    """s, x, z [m], angle [rad], moment [N m] = dW/d(angle'), stretch, from the root to the free end."""

    s: np.ndarray
    x: np.ndarray
    z: np.ndarray
    angle: np.ndarray
    moment: np.ndarray
    stretch: np.ndarray

    @property
    def tip(self):
        return np.array([self.x[-1], self.z[-1]])


def static_shape(parameters, U=0.0, points=201):
    """The hose at rest in a steady flow U [m/s]: one-parameter shooting from the free end, tolerance 1e-12.

    r' = lambda t(theta): the energy per ds is EA strain^2/2 + EJ theta'^2/(2 lambda^2), as kappa = theta'/lambda.
    Its variation is N d(lambda) + Q lambda d(theta) with N = dW/d(lambda) = EA strain dstrain/dlambda
    - EJ theta'^2/lambda^3 along the tangent, G = dW/d(theta') = EJ theta'/lambda^2 and G' = -lambda Q.  The force
    obeys F' = M U^2 r'' + weight e_z; with F = 0 at the free end F = M U^2 (r'(s) - r'(L)) - weight (L - s) e_z.
    There G = 0, too, so theta' = 0, so N = 0 means lambda(L) = 1 whatever the flow.  At each s the tangential
    component of F is an algebraic equation for lambda.  (The component of the clamp's reaction along its direction
    and its moment are free, hence no condition but theta(0) = angle; a clamp that holds the slope cannot be met: the
    energy has no derivative of lambda, so lambda jumps at the clamp.  Both clamps have this one shape.)
    """
    p = parameters
    thrust = p.water * U**2

    def stretch(theta, G, s, end):
        force = -thrust * np.cos(theta - end) - p.weight * (p.length - s) * np.sin(theta)
        value = 1.0
        for _ in range(50):
            value2 = value * value
            if p.strain == "green":
                N, slope = p.EA / 2 * value * (value2 - 1), p.EA / 2 * (3 * value2 - 1)
            else:
                N, slope = p.EA * (value - 1), p.EA
            change = (N - (G**2 / p.EJ + thrust) * value - force) / (slope - G**2 / p.EJ - thrust)
            value = value - change
            if np.all(np.abs(change) < 1e-15):
                break
        return value

    def derivative(s, state, end):
        theta, G = state[:2]
        value = stretch(theta, G, s, end)
        # the component of F along the normal (-sin, cos)
        Q = -thrust * np.sin(end - theta) - p.weight * (p.length - s) * np.cos(theta)
        return [G * value**2 / p.EJ, -value * Q, value * np.cos(theta), value * np.sin(theta)]

    def shoot(end, at=None, tolerance=3e-14):
        start, span = [end, 0, 0, 0], (p.length, 0)
        return solve_ivp(derivative, span, start, "DOP853", at, args=(end,), rtol=tolerance, atol=tolerance / 30).y

    def miss(end, tolerance=3e-14):
        return shoot(end, tolerance=tolerance)[0, -1] - p.angle

    # of several equilibria (long, slack hoses that have snapped over) the one whose tip turns least
    candidates = p.angle + np.linspace(-0.5, 0.5, 81) * np.pi
    misses = np.array([miss(end, 1e-6) for end in candidates])
    changes = np.flatnonzero(misses[:-1] * misses[1:] <= 0)
    if not len(changes):
        raise ValueError(f"no equilibrium found at U = {U}")
    middle = (candidates[changes] + candidates[changes + 1]) / 2
    best = changes[np.argmin(np.abs(middle - p.angle))]
    end = brentq(miss, candidates[best], candidates[best + 1], xtol=1e-15, rtol=1e-14)
    s = np.linspace(p.length, 0, points)
    theta, G, x, z = shoot(end, s)
    value = stretch(theta, G, s, end)
    shape = np.array([s, x - x[-1], z - z[-1], theta, G, value])[:, ::-1]
    return StaticShape(*shape)


# ----------------------------------------------------------------------------------------------------------------------
# 3. large planar motion
# ----------------------------------------------------------------------------------------------------------------------
class Hose:
    """Spectral Galerkin model of the hose of `Parameters`: r(s, t) polynomial in s, `modes` unknowns a component.

    In axes along and across the clamp r = s e + sum of q_i phi_i(s) for each component; phi = s^power times
    Jacobi polynomials, power 1 along (the stretch at the clamp is free) and 2 across, orthonormal over the length.
    Virtual work at every Gauss point; the fluid's d'Alembert force does its work on the test functions as it is,
    so that a free end has neither force nor moment.  The mass matrix is mass_per_length times the identity.

    State: coefficients along, across, then their rates; shape (4 modes,).
    """

    def __init__(self, parameters, modes=14, points=None):
        p = self.parameters = parameters
        n = self.modes = modes
        x, weights = leggauss(points or 2 * modes + 12)
        x, self.weights = (1 + x) / 2, weights / 2 * p.length
        self.s = x * p.length
        powers = (1 if p.clamp == "direction" else 2), 2
        unit = 1 / np.sqrt(p.length)
        basis = [[unit * part / p.length**k for k, part in enumerate(_orthonormal(x, n, power))] for power in powers]
        zero = np.zeros_like(basis[0][0])

        def both(order):
            return np.stack([np.hstack([basis[0][order], zero]), np.hstack([zero, basis[1][order]])])

        self.place, slope, bend = both(0), both(1), both(2)
        self.B = np.concatenate([slope, bend])  # (x', z', x'', z''), Gauss point, unknown
        self.offset = np.zeros((4, 1))
        self.offset[0] = 1
        self.Bflat = self.B.reshape(-1, 2 * n)
        rho = p.mass + p.water
        weighted = self.place * self.weights[:, None]
        self.coriolis = 2 * p.water / rho * np.einsum("aqi,aqj->ij", weighted, slope)
        self.centrifugal = p.water / rho * np.einsum("aqi,aqj->ij", weighted, bend)
        # U-dot r_s of the straight hose's own slope, and the weight in the axes of the clamp
        self.along = np.einsum("qi,q->i", self.place[0], self.weights)
        self.surge = p.water / rho * np.einsum("aqi,aqj->ij", weighted, slope)
        down = -p.gravity * np.array([np.sin(p.angle), np.cos(p.angle)])
        self.pull = np.einsum("aqi,a,q->i", self.place, down, self.weights)
        self.rho = rho
        ends = np.array([1.0])
        tips = [unit * _orthonormal(ends, n, power)[0][0] for power in powers]
        self.tip_basis = np.block([[tips[0], np.zeros(n)], [np.zeros(n), tips[1]]])
        self.axes = np.array([[np.cos(p.angle), -np.sin(p.angle)], [np.sin(p.angle), np.cos(p.angle)]])

    # kinematics at the Gauss points: p = (x', z', x'', z''), rows of arrays (points,)
    def _strain(self, p):
        """Strain, gradient (4, points) and Hessian (4, 4, points)."""
        square = p[0] ** 2 + p[1] ** 2
        tangent = np.array([p[0], p[1], 0 * p[0], 0 * p[0]])
        flat = np.zeros((4, 4, 1))
        flat[0, 0] = flat[1, 1] = 1
        if self.parameters.strain == "green":
            return (square - 1) / 2, tangent, flat
        stretch = np.sqrt(square)
        tangent = tangent / stretch
        return stretch - 1, tangent, (flat - tangent[:, None] * tangent[None]) / stretch

    @staticmethod
    def _curvature(p, second=True):
        """Curvature (x' z'' - z' x'')/|r'|^3, gradient and, if wanted, Hessian."""
        x, z, xx, zz = p
        zero = 0 * x
        inverse = 1 / (x**2 + z**2)
        cube = inverse * np.sqrt(inverse)
        C = x * zz - z * xx
        c, a = np.array([zz, -xx, -z, x]), np.array([x, z, zero, zero])
        gradient = cube * (c - 3 * C * inverse * a)
        if not second:
            return C * cube, gradient, None
        ca = c[:, None] * a[None]
        hessian = 15 * C * inverse**2 * a[:, None] * a[None] - 3 * inverse * (ca + ca.transpose(1, 0, 2))
        hessian[0, 0] -= 3 * C * inverse
        hessian[1, 1] -= 3 * C * inverse
        hessian[0, 3] += 1
        hessian[3, 0] += 1
        hessian[1, 2] -= 1
        hessian[2, 1] -= 1
        return C * cube, gradient, cube * hessian

    def _at_points(self, q):
        return (self.Bflat @ q).reshape(4, -1)

    def _internal(self, q, rate, derivative=False):
        """Internal generalised force and, if wanted, its derivatives for q and for the rate."""
        P = self.parameters
        p, v = self._at_points(q) + self.offset, self._at_points(rate)
        force, dp, dv = 0, 0, 0
        for stiffness, (value, gradient, hessian) in ((P.EA, self._strain(p)), (P.EJ, self._curvature(p, derivative))):
            speed = np.sum(gradient * v, 0)
            share, turn = 1.0, 0.0
            if stiffness == P.EJ and P.smoothing:
                share = value**2 / (value**2 + P.smoothing**2)
                turn = 2 * value * P.smoothing**2 / (value**2 + P.smoothing**2) ** 2
            stress = stiffness * (value + P.damping * share * speed)
            force = force + stress * gradient
            if derivative:
                spin = np.einsum("abp,bp->ap", hessian * np.ones_like(speed), v)
                outer = gradient[:, None] * gradient[None]
                dp = dp + stress * hessian + stiffness * (1 + P.damping * turn * speed) * outer
                dp = dp + stiffness * P.damping * share * gradient[:, None] * spin[None]
                dv = dv + stiffness * P.damping * share * outer
        n = 2 * self.modes
        result = self.Bflat.T @ (self.weights * force).ravel()
        if not derivative:
            return result
        matrices = []
        for block in (dp, dv):
            # sum over b at every Gauss point, as products of stacked matrices
            product = (block * self.weights).transpose(2, 0, 1) @ self.B.transpose(1, 0, 2)
            matrices.append(self.Bflat.T @ product.transpose(1, 0, 2).reshape(-1, n))
        return result, *matrices

    def acceleration(self, q, rate, U, Udot=0.0):
        fluid = self.coriolis @ rate * U + self.centrifugal @ q * U**2
        if Udot:
            fluid = fluid + Udot * (self.surge @ q + self.parameters.water / self.rho * self.along)
        return self.pull - self._internal(q, rate) / self.rho - fluid

    def jacobian(self, q, rate, U, Udot=0.0):
        """Of the state's rate for the state, (4 modes, 4 modes)."""
        n = 2 * self.modes
        _, stiffness, damping = self._internal(q, rate, True)
        result = np.zeros((2 * n, 2 * n))
        result[:n, n:] = np.eye(n)
        result[n:, :n] = -stiffness / self.rho - U**2 * self.centrifugal - Udot * self.surge
        result[n:, n:] = -damping / self.rho - U * self.coriolis
        return result

    def tip(self, state):
        """Position [m] of the free end for states (..., 4 modes); shape (..., 2)."""
        n = 2 * self.modes
        straight = np.array([self.parameters.length, 0])
        return (straight + state[..., :n] @ self.tip_basis.T) @ self.axes.T

    def tip_velocity(self, state):
        n = 2 * self.modes
        return state[..., n:] @ self.tip_basis.T @ self.axes.T

    def energies(self, state):
        """Kinetic (without the flow's U), strain and potential energy [J]; dissipation [W]."""
        P, n = self.parameters, 2 * self.modes
        q, rate = state[:n], state[n:]
        p, v = self._at_points(q) + self.offset, self._at_points(rate)
        strain, dstrain, _ = self._strain(p)
        bend, dbend, _ = self._curvature(p)
        share = bend**2 / (bend**2 + P.smoothing**2) if P.smoothing else 1.0
        return (
            self.rho / 2 * rate @ rate,
            self.weights @ (P.EA * strain**2 + P.EJ * bend**2) / 2,
            -self.rho * self.pull @ q,
            P.damping * self.weights @ (P.EA * np.sum(dstrain * v, 0) ** 2 + P.EJ * share * np.sum(dbend * v, 0) ** 2),
        )

    # statics and small motion
    def equilibrium(self, U=0.0):
        """State at rest in a steady flow, by Newton's method with the weight walked up."""
        n = 2 * self.modes
        q, zero = np.zeros(n), np.zeros(n)
        for share in np.linspace(0.1, 1, 10):
            for _ in range(40):
                force, stiffness, _ = self._internal(q, zero, True)
                residual = share * self.pull - force / self.rho - U**2 * self.centrifugal @ q
                change = np.linalg.solve(stiffness / self.rho + U**2 * self.centrifugal, residual)
                q = q + change
                if np.abs(change).max() < 1e-13:
                    break
            else:
                raise ValueError(f"no equilibrium found at U = {U}")
        return np.append(q, zero)

    def eigenvalues(self, U):
        """Of small in-plane motion about the equilibrium [1/s], rightmost first."""
        n = 2 * self.modes
        at = self.equilibrium(U)
        found = eigvals(self.jacobian(at[:n], at[n:], U))
        return found[np.argsort(-found.real)]

    def lateral_matrices(self, U):
        """Stiffness and damping over mass per length of small motion v(s, t) out of the plane about the equilibrium.

        Second variation in space: |r'|^2 grows by v'^2 and |r' x r''|^2 by |v'' a - v' b|^2 (a = r', b = r'' of the
        equilibrium), so the energy per ds is EA strain v'^2/2 + EJ (|v'' a - v' b|^2/|a|^6 - 3 kappa^2 v'^2/|a|^2)/2.
        Both rates of dissipation, strain-dot and k . k-dot, are of second order in v: no damping in the first order,
        whatever the smoothing.  (An unsmoothed |k-dot|^2 would damp.)  Weight acts through the equilibrium only.
        """
        P, n = self.parameters, self.modes
        p = self._at_points(self.equilibrium(U)[: 2 * n]) + self.offset
        a, b = p[:2], p[2:]
        strain = self._strain(p)[0]
        kappa, square = self._curvature(p)[0], a[0] ** 2 + a[1] ** 2
        force = P.EA * strain * (1 if P.strain == "green" else 1 / np.sqrt(square))
        ss = force + P.EJ * (np.sum(b**2, 0) / square**3 - 3 * kappa**2 / square)
        sb = -P.EJ * np.sum(a * b, 0) / square**3
        bb = P.EJ / square**2
        slope, bend = self.B[1][:, n:], self.B[3][:, n:]

        def integral(left, factor, right):
            return np.einsum("qi,q,qj->ij", left, self.weights * factor, right)

        cross = integral(slope, sb, bend)
        stiffness = integral(slope, ss, slope) + cross + cross.T + integral(bend, bb, bend)
        return stiffness / self.rho + U**2 * self.centrifugal[n:, n:], U * self.coriolis[n:, n:]

    def lateral_eigenvalues(self, U):
        """Of small motion out of the plane about the equilibrium [1/s], rightmost first."""
        n = self.modes
        stiffness, damping = self.lateral_matrices(U)
        found = eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]))
        return found[np.argsort(-found.real)]

    def critical_speed(self, low, high, lateral=False, count=20):
        """First speed [m/s] in (low, high) at which small motion turns unstable, and its angular frequency [1/s].

        Raises ValueError if none is found on `count` intervals.
        """
        spectrum = self.lateral_eigenvalues if lateral else self.eigenvalues

        def rightmost(U):
            # undamped modes of high order scatter about the axis by round-off
            found = spectrum(U)
            return found[np.abs(found.imag) < 0.2 * np.abs(found.imag).max()][0] if lateral else found[0]

        speeds = np.linspace(low, high, count + 1)
        growth = [rightmost(U).real for U in speeds]
        for (left, before), (right, after) in pairwise(zip(speeds, growth, strict=True)):
            if before < 0 <= after:
                U = brentq(lambda U: rightmost(U).real, left, right, xtol=1e-12)
                return float(U), float(abs(rightmost(U).imag))
        raise ValueError(f"no loss of stability between {low} and {high} m/s")


@dataclass(frozen=True)
class History:
    """Tip at `times` [s]: position and velocity (n, 2) as (x, z) [m, m/s]; the states (n, 4 modes); steps taken."""

    times: np.ndarray
    tip: np.ndarray
    tip_velocity: np.ndarray
    states: np.ndarray
    steps: int


def simulate(hose, speed, times, tolerance=1e-9, start=None, tip_rate=0.0):
    """Motion from rest, straight (or from the state `start`), with flow `speed(t)` -> (U, U-dot), or a constant U.

    Radau's method of order 5 with the exact Jacobian; `tolerance` relative and, times 0.1, absolute in the
    coefficients [m^1.5].  tip_rate [m/s] adds a velocity across, growing as (s/L)^2.
    """
    n = 2 * hose.modes
    flow = speed if callable(speed) else (lambda t: (speed, 0.0))
    state = np.zeros(2 * n) if start is None else np.array(start, dtype=float)
    if tip_rate:
        profile = tip_rate * (hose.s / hose.parameters.length) ** 2
        state[n:] += np.einsum("qi,q->i", hose.place[1], hose.weights * profile)
    times = np.asarray(times, dtype=float)

    def rate(t, y):
        return np.concatenate([y[n:], hose.acceleration(y[:n], y[n:], *flow(t))])

    def jacobian(t, y):
        return hose.jacobian(y[:n], y[n:], *flow(t))

    solver = Radau(rate, 0.0, state, times[-1], rtol=tolerance, atol=0.1 * tolerance, jac=jacobian)
    states, at, steps = np.empty((len(times), 2 * n)), 0, 0
    while at < len(times) and times[at] <= 0:
        states[at], at = state, at + 1
    while solver.status == "running":
        solver.step()
        steps += 1
        if solver.status == "failed":
            raise RuntimeError(f"integration failed at t = {solver.t}")
        upto = np.searchsorted(times, solver.t, side="right")
        if upto > at:
            states[at:upto] = solver.dense_output()(times[at:upto]).T
            at = upto
    return History(times, hose.tip(states), hose.tip_velocity(states), states, steps)


@dataclass(frozen=True)
class Cycle:
    """The last second of a motion: ranges and means of the tip's x and z [m] over whole periods, frequency [Hz].

    Fundamental frequency from the upward passages of z through the middle of its range; scatter_of_period is the
    largest difference of a period from their mean over that mean, drift the largest difference between the peaks of z
    over the range of z: both are tiny if and only if the motion is periodic.
    """

    frequency: float
    z_range: float
    z_mean: float
    x_range: float
    x_mean: float
    tip_speed: float  # the largest, m/s
    z_top: float
    scatter_of_period: float
    drift: float


def cycle_of(times, tip, velocity):
    """`Cycle` of a history sampled evenly and densely (n,), (n, 2), (n, 2)."""
    z, dt = tip[:, 1], times[1] - times[0]
    z_top, tops = _extremes(z)
    x_top, _ = _extremes(tip[:, 0])
    z_low, x_low = -_extremes(-z)[0], -_extremes(-tip[:, 0])[0]
    speed_top, _ = _extremes(np.hypot(*velocity.T))
    level = z - (z_top + z_low) / 2
    before = np.flatnonzero((level[:-1] < 0) & (level[1:] >= 0))
    share = level[before] / (level[before] - level[before + 1])
    passages = times[before] + share * dt
    periods = np.diff(passages)
    first, last = before[0] + 1, before[-1] + 1
    span = times[last] - times[first]
    means = [np.trapezoid(c[first : last + 1], dx=dt) / span for c in tip.T]
    tops = tops[tops > (z_top + z_low) / 2 + 0.4 * (z_top - z_low)]
    return Cycle(
        float(1 / periods.mean()),
        float(z_top - z_low),
        float(means[1]),
        float(x_top - x_low),
        float(means[0]),
        float(speed_top),
        float(z_top),
        float(np.ptp(periods) / periods.mean()),
        float(np.ptp(tops) / (z_top - z_low)),
    )


def _extremes(values):
    """The maximum and all local maxima, by parabolas through the samples."""
    left, middle, right = values[:-2], values[1:-1], values[2:]
    at = np.flatnonzero((middle >= left) & (middle > right))
    left, middle, right = left[at], middle[at], right[at]
    tops = middle + (left - right) ** 2 / (8 * (2 * middle - left - right))
    return max(tops.max(initial=-np.inf), values.max()), tops


def limit_cycle(hose, U, settle, tolerance=1e-6, interval=1e-4):
    """`Cycle` in the second after `settle` s of the motion from rest, straight, with U m/s from t = 0 on."""
    times = settle + np.arange(0, 1 + interval / 2, interval)
    history = simulate(hose, U, times, tolerance)
    return cycle_of(times, history.tip, history.tip_velocity)


SETTLING = {15: 6.0, 25: 3.0, 35: 3.0}  # s until successive periods agree to 1e-6


def write_files(modes=24, coarser=18, smoothing=0.2, to=HERE):
    """Write hose_tip.csv (U = 15 m/s, every 0.02 s) and hose_cycles.json (cycles, critical speeds).

    Each of the motions and cycles also with the smoothed dissipation, and the cycles with fewer modes to show how far
    they have converged (with the smoothing, algebraically: every zero of the curvature is a kink of the damping).
    """
    start = Parameters()
    smooth = replace(start, smoothing=smoothing)
    times = np.arange(51) * 0.02
    histories = [simulate(Hose(p, modes), 15.0, times, tol) for p, tol in ((start, 1e-9), (smooth, 1e-7))]
    columns = histories[0].tip, histories[0].tip_velocity, histories[1].tip
    with open(to / "hose_tip.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["t", "x", "z", "vx", "vz", "x_smoothed", "z_smoothed"])
        for t, row in zip(times, np.hstack(columns), strict=True):
            writer.writerow([f"{t:.2f}", *(f"{value:.9f}" for value in row)])
    fine = Hose(start, modes)
    result = {
        "parameters": asdict(start),
        "smoothing": smoothing,
        "settling": SETTLING,
        "modes": modes,
        "coarser_modes": coarser,
        "critical": {  # U [m/s], angular frequency [1/s]
            "in_plane": fine.critical_speed(5, 30),
            "in_plane_smoothed": Hose(smooth, modes).critical_speed(5, 30),
            "out_of_plane": fine.critical_speed(5, 30, lateral=True),
            "weightless": Hose(replace(start, gravity=0.0), modes).critical_speed(5, 30),
        },
    }
    for name, p, n in (
        ("cycles", start, modes),
        ("cycles_coarser", start, coarser),
        ("cycles_smoothed", smooth, modes),
        ("cycles_smoothed_coarser", smooth, coarser),
    ):
        result[name] = {
            str(U): asdict(limit_cycle(Hose(p, n), U, settle, 1e-5 if p.smoothing else 1e-6))
            for U, settle in SETTLING.items()
        }
        with open(to / "hose_cycles.json", "w") as file:
            json.dump(result, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    write_files()
