"""Pipes conveying fluid: stability, statics and large planar motion to compare the hose program with.

Derived from the strong and the virtual-work form of the equations of motion, without the hose program and without
finite elements.  Five parts:

1. the straight inextensible cantilever of R. W. Gregory and M. P. Paidoussis, Unstable oscillation of tubular
   cantilevers conveying fluid, Proc. R. Soc. A 293 (1966) 512-542: exact characteristic determinant, dimensionless;
2. the extensible hose bent by its weight in a steady flow: a one-parameter shooting problem, SI units;
3. the same hose in large planar motion: global polynomials in arc length (spectral Galerkin), SI units;
4. the same in space;
5. straight inextensible hoses of several pieces, SI units.

Dimensionless quantities of part 1: u = U L sqrt(M/EJ), beta = M/(m + M), time in L^2 sqrt((m + M)/EJ),
alpha = c/(unit of time) with c the Kelvin-Voigt damping time, gamma = (m + M) g L^3/EJ (> 0: the pipe hangs),
mu = (mass at the free end)/((m + M) L), jet = speed of the jet at the free end over the speed in the pipe (a nozzle).
Run as a program, the module rewrites hose_tip.csv, hose_cycles.json and hose_space.json beside it.
"""

import csv
import json
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.integrate import Radau, solve_ivp
from scipy.linalg import eigvals, null_space
from scipy.optimize import brentq
from scipy.special import eval_jacobi, gammaln

HERE = Path(__file__).parent

# u at which a supported pipe buckles (the flow then does no work in a cycle: it acts as a dead thrust M U^2)
PINNED_PINNED = np.pi
CLAMPED_CLAMPED = 2 * np.pi
CLAMPED_PINNED = brentq(lambda u: np.sin(u) - u * np.cos(u), 4.4, 4.6, xtol=1e-15)


# ----------------------------------------------------------------------------------------------------------------------
# 1. the straight cantilever
# ----------------------------------------------------------------------------------------------------------------------
def characteristic(eigenvalue, u, beta, alpha=0.0, mu=0.0, jet=1.0):
    """The boundary determinant of the cantilever at w = exp(eigenvalue t) sum_j A_j exp(p_j x), arrays broadcast.

    (1 + alpha lambda) p^4 + jet u^2 p^2 + 2 sqrt(beta) u lambda p + lambda^2 = 0; rows w(0) = w'(0) = 0,
    w''(1) = 0, (1 + alpha lambda) w'''(1) = mu lambda^2 w(1).  Divided by Vandermonde's determinant of the p_j, it
    does not depend on their order and has no zeros where two of them meet; scaled by a positive number, so its phase
    is that of an entire function.

    The nozzle's force on the end, -u^2 (jet - 1) w', compresses all the pipe by P = u^2 (jet - 1): P w'' joins u^2 w''.
    At the end the shear force -w''' - P w' balances mu w_tt and the nozzle's force -P w': P cancels there.  So
    the pipe with a nozzle is the plain one of the mass ratio beta/jet, the speed u sqrt(jet) and the same mu.
    """
    lam, u, beta = np.broadcast_arrays(np.asarray(eigenvalue, dtype=complex), u, beta)
    companion = np.zeros((*lam.shape, 4, 4), dtype=complex)
    companion[..., [1, 2, 3], [0, 1, 2]] = 1
    stiffness = 1 + alpha * lam
    companion[..., 0, 3] = -(lam**2) / stiffness
    companion[..., 1, 3] = -2 * np.sqrt(beta) * u * lam / stiffness
    companion[..., 2, 3] = -jet * u**2 / stiffness
    p = np.moveaxis(np.linalg.eigvals(companion), -1, 0)
    # Laplace's expansion: columns i, j in the first two rows and k, l in the last two
    split = [(0, 1, 2, 3, 1), (0, 2, 1, 3, -1), (0, 3, 1, 2, 1), (1, 2, 0, 3, 1), (1, 3, 0, 2, -1), (2, 3, 0, 1, 1)]
    scale = np.max([(p[k] + p[l]).real for _, _, k, l, _ in split], axis=0)
    total, vandermonde = 0, 1
    for i, j, k, l, sign in split:
        minors = (p[j] - p[i]) * ((p[k] * p[l]) ** 2 + mu * lam**2 / stiffness * (p[k] + p[l])) * (p[l] - p[k])
        total = total + sign * minors * np.exp(p[k] + p[l] - scale)
        vandermonde = vandermonde * (p[j] - p[i])
    return total / vandermonde


class Pipe:
    """Galerkin's method for the same cantilever with polynomials: x^2 times Jacobi polynomials (0, 4) on (0, 1).

    They are orthogonal with this factor, satisfy w(0) = w'(0) = 0, and the free end's conditions are natural.
    Supported pipes: x^root (1 - x)^end times Jacobi polynomials; root, end are 2 clamped, 1 pinned, 0 free.
    """

    def __init__(self, modes=32, root=2, end=0):
        x, weights = leggauss(modes + 8)
        x, weights = (1 + x) / 2, weights / 2
        w, slope, bend = _orthonormal(x, modes, root, end)
        self.modes = modes
        self.bend = np.einsum("qi,qj,q->ij", bend, bend, weights)
        self.thrust = np.einsum("qi,qj,q->ij", w, bend, weights)
        self.coriolis = np.einsum("qi,qj,q->ij", w, slope, weights)
        self.hang = np.einsum("qi,qj,q->ij", slope, slope, weights * (1 - x))
        self.pull = np.einsum("qi,qj,q->ij", slope, slope, weights)
        self.tip = _orthonormal(np.ones(1), modes, root, end)[0][0]

    def matrices(self, u, beta, alpha=0.0, gamma=0.0, mu=0.0, jet=1.0):
        """Mass matrix to the power -1 times stiffness and damping matrix."""
        stiffness = self.bend + jet * u**2 * self.thrust + gamma * (self.hang + mu * self.pull)
        damping = alpha * self.bend + 2 * np.sqrt(beta) * u * self.coriolis
        if not mu:
            return stiffness, damping
        # the mass matrix is the identity and, from the end, mu tip tip^T
        share = mu / (1 + mu * self.tip @ self.tip) * self.tip
        return tuple(matrix - np.outer(share, self.tip @ matrix) for matrix in (stiffness, damping))

    def eigenvalues(self, u, beta, alpha=0.0, gamma=0.0, mu=0.0, jet=1.0):
        """All 2 modes eigenvalues, by magnitude; about the lower half of them mean something."""
        stiffness, damping = self.matrices(u, beta, alpha, gamma, mu, jet)
        n = self.modes
        found = eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]))
        return found[np.argsort(np.abs(found))]

    def phase(self, omega, u, beta, alpha=0.0, gamma=0.0, mu=0.0, jet=1.0):
        """The determinant of the dynamic stiffness at i omega over its magnitude; omega and u of one shape."""
        stiffness, damping = self.bend + gamma * (self.hang + mu * self.pull), alpha * self.bend
        mass = np.eye(self.modes) + mu * np.outer(self.tip, self.tip)
        result = np.empty(u.shape, dtype=complex)
        for at in np.ndindex(u.shape[0]):  # a row at a time, for the memory
            row, w = u[at][..., None, None], omega[at][..., None, None]
            matrix = stiffness + jet * row**2 * self.thrust - w**2 * mass
            matrix = matrix + 1j * w * (damping + 2 * np.sqrt(beta) * row * self.coriolis)
            result[at] = np.linalg.slogdet(matrix)[0]
        return result


def _orthonormal(x, count, power, end=0):
    """x^power (1 - x)^end P_n(x), n < count, orthonormal on (0, 1), and its first two derivatives, (len(x), count)."""
    n = np.arange(count)
    a, b = 2 * end, 2 * power
    y, x = 2 * x[:, None] - 1, x[:, None]
    values = eval_jacobi(n, a, b, y)
    first = np.where(n > 0, (n + a + b + 1) * eval_jacobi(np.maximum(n - 1, 0), a + 1, b + 1, y), 0)
    rise = (n + a + b + 1) * (n + a + b + 2)
    second = np.where(n > 1, rise * eval_jacobi(np.maximum(n - 2, 0), a + 2, b + 2, y), 0)
    square = gammaln(n + 1) + gammaln(n + a + b + 1) - gammaln(n + a + 1) - gammaln(n + b + 1)
    scale = np.sqrt((2 * n + a + b + 1) * np.exp(square if end else 0 * n))
    # the factor at either end and its derivatives, by Leibniz' rule
    left, right = ([_power(z, k, order) for order in range(3)] for z, k in ((x, power), (1 - x, end)))
    factor = left[0] * right[0]
    down1 = left[1] * right[0] - left[0] * right[1]
    down2 = left[2] * right[0] - 2 * left[1] * right[1] + left[0] * right[2]
    return (
        scale * factor * values,
        scale * (factor * first + down1 * values),
        scale * (factor * second + 2 * down1 * first + down2 * values),
    )


def _power(z, exponent, order):
    """The derivative of some order <= 2 of z^exponent."""
    factor = (1, exponent, exponent * (exponent - 1))[order]
    return factor * z ** max(exponent - order, 0)


def eigenvalues(u, beta, count=4, alpha=0.0, mu=0.0, jet=1.0):
    """The first `count` eigenvalues of the cantilever with non-negative imaginary part, by frequency.

    Newton's method on the exact determinant from Galerkin's values.
    """
    guesses = Pipe(24 + 2 * count).eigenvalues(u, beta, alpha, 0.0, mu, jet)
    guesses = guesses[guesses.imag >= 0][: count + 2]
    found = np.array([_newton_eigenvalue(guess, u, beta, alpha, mu, jet) for guess in guesses])
    return found[np.argsort(np.abs(found.imag), kind="stable")][:count]


def _newton_eigenvalue(guess, u, beta, *more):
    for _ in range(20):
        h = 1e-5 * max(1, abs(guess))
        f, ahead, behind = characteristic(guess + np.array([0, h, -h]), u, beta, *more)
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


def critical_speeds(beta, alpha=0.0, gamma=0.0, upto=18.0, modes=32, mu=0.0, jet=1.0):
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
            return characteristic(1j * root**2, u, beta, alpha, mu, jet)
    else:
        pipe = Pipe(modes)

        def phase(u, root):
            return pipe.phase(root**2, u, beta, alpha, gamma, mu, jet)

    # beyond sqrt(omega) = 1.8 u + 8 the pipe is a beam, damped by Coriolis' force
    roots = np.linspace(0.2, 1.8 * np.sqrt(jet) * upto + 8, 260)
    cells = _winding_cells(phase, np.linspace(0.05, upto, 1 + round(10 * upto)), roots)
    found = []
    for u, root, winding in cells:
        if gamma == 0:
            u, omega = _polish(u, root**2, beta, alpha, mu, jet)
        else:
            u, omega = _polish_galerkin(pipe, u, root**2, beta, alpha, gamma, mu, jet)
        found.append(Crossing(u, omega, "unstable" if winding < 0 else "stable"))
    return sorted((c for c in found if c.u <= upto), key=lambda c: c.u)


def _winding_cells(phase, us, roots):
    """Centres of the cells of the grid (us, roots) round which the phase winds, and the winding.

    Cells that need it are divided into 16, all of a size at once: points of patches (patch, u), (patch, root).
    """
    found, us, roots = [], us[None], roots[None]
    for depth in range(5):
        shape = (len(us), us.shape[1], roots.shape[1])
        u, root = np.broadcast_to(us[:, :, None], shape), np.broadcast_to(roots[:, None, :], shape)
        rows = max(shape[:2])
        values = phase(u.reshape(rows, -1), root.reshape(rows, -1)).reshape(shape)
        along = np.angle(values[:, 1:] / values[:, :-1])  # of edges in u
        across = np.angle(values[:, :, 1:] / values[:, :, :-1])
        total = along[:, :, :-1] + across[:, 1:] - along[:, :, 1:] - across[:, :-1]
        winding = np.rint(total / (2 * np.pi)).astype(int)
        fast = np.maximum(
            np.maximum(abs(along[:, :, :-1]), abs(along[:, :, 1:])), np.maximum(abs(across[:, 1:]), abs(across[:, :-1]))
        )
        finer = (winding != 0) | (fast > 1.2) if depth < 1 else (fast > 1.2) & (depth < 4)
        for k, i, j in np.argwhere((winding != 0) & ~finer):
            found.append(((us[k, i] + us[k, i + 1]) / 2, (roots[k, j] + roots[k, j + 1]) / 2, winding[k, i, j]))
        k, i, j = np.nonzero(finer)
        us, roots = (np.linspace(x[k, n], x[k, n + 1], 5, axis=-1) for x, n in ((us, i), (roots, j)))
        if not k.size:
            break
    return found


def _polish(u, omega, beta, *more):
    """Newton's method for the exact crossing near (u, omega)."""
    for _ in range(30):
        h = 1e-6 * np.array([u, omega])
        at = np.array([[u, omega], [u + h[0], omega], [u - h[0], omega], [u, omega + h[1]], [u, omega - h[1]]])
        d = characteristic(1j * at[:, 1], at[:, 0], beta, *more)
        du, dw = (d[1] - d[2]) / (2 * h[0]), (d[3] - d[4]) / (2 * h[1])
        step = np.linalg.solve([[du.real, dw.real], [du.imag, dw.imag]], [d[0].real, d[0].imag])
        step *= min(1, 0.1 / abs(step[0] + 1e-300))
        u, omega = u - step[0], omega - step[1]
        if abs(step[0]) < 1e-13 * u:
            break
    return float(u), float(omega)


def _polish_galerkin(pipe, u, omega, beta, *more):
    def nearest(speed, target):
        all_ = pipe.eigenvalues(speed, beta, *more)
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
    ('green') or |r'| - 1 ('engineering').  Power dissipated per ds: damping (EA strain-dot^2 + EJ |k-dot|^2), where
    k is kappa times the principal normal and its rate is that in axes turning with the tangent without spin about
    it; in the plane kappa-dot^2.  With smoothing the older law (k . k-dot)^2/(k . k + smoothing^2) instead, in
    the plane kappa-dot^2 kappa^2/(kappa^2 + smoothing^2).

    A mass at the free end moves with it and has weight; a nozzle there makes the jet `outlet` times as fast as
    the flow in the hose: the force -water U^2 (outlet - 1) r' on the end.
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
    tip_mass: float = 0.0  # kg
    outlet: float = 1.0  # speed of the jet over that in the hose

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
    There G = 0, too, so theta' = 0, so N = 0 means lambda(L) = 1 whatever the flow.  With a nozzle and a mass at the
    end F(L) = -M U^2 (outlet - 1) r'(L) - tip_mass g e_z, which gives lambda(L).  At each s the tangential
    component of F is an algebraic equation for lambda.  (The component of the clamp's reaction along its direction
    and its moment are free, hence no condition but theta(0) = angle; a clamp that holds the slope cannot be met: the
    energy has no derivative of lambda, so lambda jumps at the clamp.  Both clamps have this one shape.)
    """
    p = parameters
    thrust, hung = p.water * U**2, p.tip_mass * p.gravity

    def solve_stretch(linear, force):
        """N - linear lambda = force for lambda, N the part of the axial force that comes of the strain."""
        value = 1.0
        for _ in range(50):
            value2 = value * value
            if p.strain == "green":
                N, slope = p.EA / 2 * value * (value2 - 1), p.EA / 2 * (3 * value2 - 1)
            else:
                N, slope = p.EA * (value - 1), p.EA
            change = (N - linear * value - force) / (slope - linear)
            value = value - change
            if np.all(np.abs(change) < 1e-15):
                break
        return value

    def down(s):
        return p.weight * (p.length - s) + hung

    def jet(end):
        """What F has of r'(L): the thrust of the jet."""
        return p.outlet * thrust * solve_stretch(-(p.outlet - 1) * thrust, -hung * np.sin(end))

    def stretch(theta, G, s, end, jet):
        return solve_stretch(G**2 / p.EJ + thrust, -jet * np.cos(theta - end) - down(s) * np.sin(theta))

    def derivative(s, state, end, jet):
        theta, G = state[:2]
        value = stretch(theta, G, s, end, jet)
        # the component of F along the normal (-sin, cos)
        Q = -jet * np.sin(end - theta) - down(s) * np.cos(theta)
        return [G * value**2 / p.EJ, -value * Q, value * np.cos(theta), value * np.sin(theta)]

    def shoot(end, at=None, tolerance=3e-14):
        start, span, more = [end, 0, 0, 0], (p.length, 0), (end, jet(end))
        return solve_ivp(derivative, span, start, "DOP853", at, args=more, rtol=tolerance, atol=tolerance / 30).y

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
    value = stretch(theta, G, s, end, jet(end))
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
    so that a free end has neither force nor moment but those of a nozzle and a mass there.  The mass matrix is
    mass_per_length times the identity: a mass at the end makes the functions orthonormal with it.

    State: coefficients along, across, then their rates; shape (4 modes,).
    """

    dimension = 2

    def __init__(self, parameters, modes=14, points=None):
        p = self.parameters = parameters
        n = self.modes = modes
        self.unknowns = self.dimension * n
        x, weights = leggauss(points or 2 * modes + 12)
        x, self.weights = (1 + x) / 2, weights / 2 * p.length
        self.s = x * p.length
        self.rho = rho = p.mass + p.water
        bases, tips = [], []
        for power in ((1 if p.clamp == "direction" else 2), 2, 2)[: self.dimension]:
            unit = [p.length ** -(0.5 + order) for order in range(3)]
            basis = [c * part for c, part in zip(unit, _orthonormal(x, n, power), strict=True)]
            tip = [c * part[0] for c, part in zip(unit, _orthonormal(np.ones(1), n, power), strict=True)]
            # the mass matrix 1 + (tip_mass/rho) tip tip^T to the power -1/2
            square = tip[0] @ tip[0]
            share = (1 / np.sqrt(1 + p.tip_mass / rho * square) - 1) / square
            turn = np.eye(n) + share * np.outer(tip[0], tip[0])
            bases.append([part @ turn for part in basis])
            tips.append([part @ turn for part in tip])

        def all_components(order):
            result = np.zeros((self.dimension, len(x), self.unknowns))
            tip = np.zeros((self.dimension, self.unknowns))
            for k in range(self.dimension):
                result[k, :, k * n : (k + 1) * n], tip[k, k * n : (k + 1) * n] = bases[k][order], tips[k][order]
            return result, tip

        (self.place, self.tip_basis), (slope, tip_slope), (bend, _) = (all_components(order) for order in range(3))
        self.B = np.concatenate([slope, bend])  # (x', z', x'', z''), Gauss point, unknown
        self.offset = np.zeros((2 * self.dimension, 1))
        self.offset[0] = 1
        self.Bflat = self.B.reshape(-1, self.unknowns)
        weighted = self.place * self.weights[:, None]
        nozzle = p.water / rho * (p.outlet - 1)
        self.coriolis = 2 * p.water / rho * np.einsum("aqi,aqj->ij", weighted, slope)
        self.centrifugal = p.water / rho * np.einsum("aqi,aqj->ij", weighted, bend)
        self.centrifugal += nozzle * self.tip_basis.T @ tip_slope
        self.jet = nozzle * self.tip_basis[0]
        # U-dot r_s of the straight hose's own slope, and the weight in the axes of the clamp
        self.along = np.einsum("qi,q->i", self.place[0], self.weights)
        self.surge = p.water / rho * np.einsum("aqi,aqj->ij", weighted, slope)
        down = -p.gravity * np.array([np.sin(p.angle), np.cos(p.angle), 0])[: self.dimension]
        self.pull = np.einsum("aqi,a,q->i", self.place, down, self.weights)
        self.pull += p.tip_mass / rho * down @ self.tip_basis
        # columns: along, across, out of the plane; rows: x, (y,) z
        self.axes = np.array([[np.cos(p.angle), -np.sin(p.angle)], [np.sin(p.angle), np.cos(p.angle)]])
        if self.dimension == 3:
            self.axes = np.insert(np.insert(self.axes, 1, 0, 0), 2, [0, 1, 0], 1)

    def across(self, tip_rate, component=1):
        """Coefficients of the velocity tip_rate (s/L)^2 of one component."""
        p = self.parameters
        profile = tip_rate * (self.s / p.length) ** 2
        ends = p.tip_mass / self.rho * tip_rate * self.tip_basis[component]
        return np.einsum("qi,q->i", self.place[component], self.weights * profile) + ends

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
        return (self.Bflat @ q).reshape(2 * self.dimension, -1)

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
        result = self.Bflat.T @ (self.weights * force).ravel()
        return (result, *self._assemble(dp, dv)) if derivative else result

    def _assemble(self, *blocks):
        """Matrices of the unknowns of blocks (component, component, Gauss point)."""
        matrices = []
        for block in blocks:
            # sum over the second component at every Gauss point, as products of stacked matrices
            product = (block * self.weights).transpose(2, 0, 1) @ self.B.transpose(1, 0, 2)
            matrices.append(self.Bflat.T @ product.transpose(1, 0, 2).reshape(-1, self.unknowns))
        return matrices

    def acceleration(self, q, rate, U, Udot=0.0):
        fluid = self.coriolis @ rate * U + (self.centrifugal @ q + self.jet) * U**2
        if Udot:
            fluid = fluid + Udot * (self.surge @ q + self.parameters.water / self.rho * self.along)
        return self.pull - self._internal(q, rate) / self.rho - fluid

    def jacobian(self, q, rate, U, Udot=0.0):
        """Of the state's rate for the state, (4 modes, 4 modes)."""
        n = self.unknowns
        _, stiffness, damping = self._internal(q, rate, True)
        result = np.zeros((2 * n, 2 * n))
        result[:n, n:] = np.eye(n)
        result[n:, :n] = -stiffness / self.rho - U**2 * self.centrifugal - Udot * self.surge
        result[n:, n:] = -damping / self.rho - U * self.coriolis
        return result

    def tip(self, state):
        """Position [m] of the free end for states (..., 4 modes); shape (..., 2)."""
        n = self.unknowns
        straight = np.array([self.parameters.length, 0, 0])[: self.dimension]
        return (straight + state[..., :n] @ self.tip_basis.T) @ self.axes.T

    def tip_velocity(self, state):
        n = self.unknowns
        return state[..., n:] @ self.tip_basis.T @ self.axes.T

    def energies(self, state):
        """Kinetic (without the flow's U), strain and potential energy [J]; dissipation [W]."""
        P, n = self.parameters, self.unknowns
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
        n = self.unknowns
        q, zero = np.zeros(n), np.zeros(n)
        for share in np.linspace(0.1, 1, 10):
            for _ in range(40):
                force, stiffness, _ = self._internal(q, zero, True)
                residual = share * self.pull - force / self.rho - U**2 * (self.centrifugal @ q + self.jet)
                change = np.linalg.solve(stiffness / self.rho + U**2 * self.centrifugal, residual)
                q = q + change
                if np.abs(change).max() < 1e-13:
                    break
            else:
                raise ValueError(f"no equilibrium found at U = {U}")
        return np.append(q, zero)

    def eigenvalues(self, U):
        """Of small motion (of `Hose`, in the plane) about the equilibrium [1/s], rightmost first."""
        n = self.unknowns
        at = self.equilibrium(U)
        found = eigvals(self.jacobian(at[:n], at[n:], U))
        return found[np.argsort(-found.real)]

    def lateral_matrices(self, U, damped=None):
        """Stiffness and damping over mass per length of small motion v(s, t) out of the plane about the equilibrium.

        Second variation in space: |r'|^2 grows by v'^2 and |r' x r''|^2 by |v'' a - v' b|^2 (a = r', b = r'' of the
        equilibrium), so the energy per ds is EA strain v'^2/2 + EJ (|v'' a - v' b|^2/|a|^6 - 3 kappa^2 v'^2/|a|^2)/2.

        Damping: the tangent t turns by v'/|a| out of the plane and k = t'/|r'|, so k's rate out of the plane is
        (v-dot'/|a|)'/|a| = v-dot''/|a|^2 - (a . b) v-dot'/|a|^4 and EJ damping times its square is the power (the
        components in the plane are of second order, and so is strain-dot).  Without damping (`damped` False, the
        default with smoothing): k . k-dot of the smoothed law is of second order.  Weight acts through the
        equilibrium only, a nozzle's force also through v' at the end.
        """
        P, n, d = self.parameters, self.modes, self.dimension
        damped = not P.smoothing if damped is None else damped
        p = self._at_points(self.equilibrium(U)[: self.unknowns]) + self.offset
        a, b = p[:d], p[d:]
        square, product, curving = np.sum(a * a, 0), np.sum(a * b, 0), np.sum(b * b, 0)
        kappa2 = (curving * square - product**2) / square**3
        # the axial force of the strain over the stretch
        strain = (square - 1) / 2 if P.strain == "green" else 1 - 1 / np.sqrt(square)
        ss = P.EA * strain + P.EJ * (curving / square**3 - 3 * kappa2 / square)
        sb = -P.EJ * product / square**3
        bb = P.EJ / square**2
        slope, bend = self.B[1][:, n : 2 * n], self.B[d + 1][:, n : 2 * n]

        def integral(left, factor, right):
            return np.einsum("qi,q,qj->ij", left, self.weights * factor, right)

        cross = integral(slope, sb, bend)
        stiffness = integral(slope, ss, slope) + cross + cross.T + integral(bend, bb, bend)
        damping = U * self.coriolis[n : 2 * n, n : 2 * n]
        if damped:
            turning = bend / square[:, None] - slope * (product / square**2)[:, None]
            damping = damping + P.EJ * P.damping / self.rho * integral(turning, 1, turning)
        return stiffness / self.rho + U**2 * self.centrifugal[n : 2 * n, n : 2 * n], damping

    def lateral_eigenvalues(self, U, damped=None):
        """Of small motion out of the plane about the equilibrium [1/s], rightmost first."""
        n = self.modes
        stiffness, damping = self.lateral_matrices(U, damped)
        found = eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]))
        return found[np.argsort(-found.real)]

    def critical_speed(self, low, high, lateral=False, count=20, damped=None):
        """First speed [m/s] in (low, high) at which small motion turns unstable, and its angular frequency [1/s].

        `damped`: of lateral motion, as in `lateral_matrices`.  Raises ValueError if none is found on `count` intervals.
        """
        damped = not self.parameters.smoothing if damped is None else damped

        def rightmost(U):
            found = self.lateral_eigenvalues(U, damped) if lateral else self.eigenvalues(U)
            # undamped modes of high order scatter about the axis by round-off
            if not self.parameters.damping or (lateral and not damped):
                found = found[np.abs(found.imag) < 0.2 * np.abs(found.imag).max()]
            return found[0]

        speeds = np.linspace(low, high, count + 1)
        growth = [rightmost(U).real for U in speeds]
        for (left, before), (right, after) in pairwise(zip(speeds, growth, strict=True)):
            if before < 0 <= after:
                U = brentq(lambda U: rightmost(U).real, left, right, xtol=1e-12)
                return float(U), float(abs(rightmost(U).imag))
        raise ValueError(f"no loss of stability between {low} and {high} m/s")


# ----------------------------------------------------------------------------------------------------------------------
# 4. large motion in space
# ----------------------------------------------------------------------------------------------------------------------
class SpatialHose(Hose):
    """The same in space: components along, across (in the vertical plane) and out of it, along y of (x, y, z).

    With a = r', b = r'', A = a . a and the projection P = 1 - a a^T/A the curvature vector is k = P b/A.  Its rate in
    axes that turn with the tangent without spin is P k-dot = P h, as what of k-dot is along a drops out, with
    h = b-dot/A - 2 (a . a-dot) b/A^2 - (a . b) a-dot/A^2.

    State: coefficients along, across, out of the plane, then their rates; shape (6 modes,).
    """

    dimension = 3

    def __init__(self, parameters, modes=14, points=None):
        if parameters.smoothing:
            raise ValueError("in space only the law without smoothing")
        super().__init__(parameters, modes, points)

    def _turning(self, p, v):
        """Rate of the curvature vector without spin, (3, ...)."""
        a, b, da, db = p[:3], p[3:], v[:3], v[3:]
        square = np.sum(a * a, 0)
        h = db / square - (2 * np.sum(a * da, 0) * b + np.sum(a * b, 0) * da) / square**2
        return h - np.sum(a * h, 0) / square * a

    def _density(self, p, v):
        """Derivatives of energy and dissipation for (a, b) at points, elastic and viscous (6, ...)."""
        P = self.parameters
        a, b = p[:3], p[3:]
        square, product, curving = np.sum(a * a, 0), np.sum(a * b, 0), np.sum(b * b, 0)
        rate = np.sum(a * v[:3], 0)
        if P.strain == "green":
            axial = (square - 1) / 2 + P.damping * rate
        else:
            stretch = np.sqrt(square)
            axial = (stretch - 1 + P.damping * rate / stretch) / stretch
        w = P.damping * self._turning(p, v)
        bent = 3 * (curving * square - product**2) / square**4
        of_slope = (curving * a - product * b) / square**3 - bent * a
        of_slope = of_slope - (2 * np.sum(b * w, 0) * a + product * w) / square**2
        of_bend = (square * b - product * a) / square**3 + w / square
        return np.concatenate([P.EA * axial * a + P.EJ * of_slope, P.EJ * of_bend])

    def _internal(self, q, rate, derivative=False):
        p, v = self._at_points(q) + self.offset, self._at_points(rate)
        force = self.Bflat.T @ (self.weights * self._density(p, v)).ravel()
        if not derivative:
            return force
        # an imaginary step: exact, as there is nothing to cancel
        step = 1e-30j * np.eye(6)[:, :, None]
        shape = 6, 6, p.shape[-1]
        of_p = self._density(p[:, None] + step, np.broadcast_to(v[:, None], shape)).imag / 1e-30
        of_v = self._density(np.broadcast_to(p[:, None], shape), v[:, None] + step).imag / 1e-30
        return force, *self._assemble(of_p, of_v)

    def energies(self, state):
        """Kinetic (without the flow's U), strain and potential energy [J]; dissipation [W]."""
        P, n = self.parameters, self.unknowns
        q, rate = state[:n], state[n:]
        p, v = self._at_points(q) + self.offset, self._at_points(rate)
        a, b = p[:3], p[3:]
        square = np.sum(a * a, 0)
        stretching, strain = np.sum(a * v[:3], 0), (square - 1) / 2
        if P.strain != "green":
            stretching, strain = stretching / np.sqrt(square), np.sqrt(square) - 1
        kappa2 = (np.sum(b * b, 0) * square - np.sum(a * b, 0) ** 2) / square**3
        return (
            self.rho / 2 * rate @ rate,
            self.weights @ (P.EA * strain**2 + P.EJ * kappa2) / 2,
            -self.rho * self.pull @ q,
            P.damping * self.weights @ (P.EA * stretching**2 + P.EJ * np.sum(self._turning(p, v) ** 2, 0)),
        )


@dataclass(frozen=True)
class History:
    """Tip at `times` [s]: position and velocity (n, 2) as (x, z) or (n, 3) as (x, y, z); the states; steps taken."""

    times: np.ndarray
    tip: np.ndarray
    tip_velocity: np.ndarray
    states: np.ndarray
    steps: int


def simulate(hose, speed, times, tolerance=1e-9, start=None, tip_rate=0.0, lateral_rate=0.0):
    """Motion from rest, straight (or from the state `start`), with flow `speed(t)` -> (U, U-dot), or a constant U.

    Radau's method of order 5 with the exact Jacobian; `tolerance` relative and, times 0.1, absolute in the
    coefficients [m^1.5].  tip_rate [m/s] adds a velocity across, growing as (s/L)^2; lateral_rate one out of the plane.
    """
    n = hose.unknowns
    flow = speed if callable(speed) else (lambda t: (speed, 0.0))
    state = np.zeros(2 * n) if start is None else np.array(start, dtype=float)
    for component, value in ((1, tip_rate), (2, lateral_rate)):
        if value:
            state[n:] += hose.across(value, component)
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


@dataclass(frozen=True)
class Rotation:
    """A second of motion in space: frequency [Hz] and ranges, means and tops of the tip's x, y, z [m] as in `Cycle`.

    spin: mean of y vz - z vy [m^2/s]; positive if the tip goes about x from y to z.
    """

    frequency: float
    ranges: list
    means: list
    tops: list
    tip_speed: float
    spin: float
    scatter_of_period: float


def rotation_of(times, tip, velocity):
    """`Rotation` of a history sampled evenly and densely (n,), (n, 3), (n, 3)."""
    tops = [float(_extremes(c)[0]) for c in tip.T]
    lows = [float(-_extremes(-c)[0]) for c in tip.T]
    level = tip[:, 2] - (tops[2] + lows[2]) / 2
    before = np.flatnonzero((level[:-1] < 0) & (level[1:] >= 0))
    share = level[before] / (level[before] - level[before + 1])
    periods = np.diff(times[before] + share * (times[1] - times[0]))
    whole = slice(before[0] + 1, before[-1] + 1)
    spin = tip[:, 1] * velocity[:, 2] - tip[:, 2] * velocity[:, 1]
    return Rotation(
        float(1 / periods.mean()),
        [top - low for top, low in zip(tops, lows, strict=True)],
        tip[whole].mean(0).tolist(),
        tops,
        float(_extremes(np.linalg.norm(velocity, axis=1))[0]),
        float(spin[whole].mean()),
        float(np.ptp(periods) / periods.mean()),
    )


def lateral_multipliers(parameters, U, modes, settle, periods=30, fitted=10, tolerance=1e-7, push=1e-4):
    """Floquet multipliers of the planar cycle for small motion out of the plane, the two largest in magnitude.

    From the states at the last `fitted` of some periods after a push [m/s] out of the plane of the settled motion.

    Returns
    -------
    multipliers : complex array (2,)
    period : s
    """
    times = settle + np.arange(0, 1.0001, 1e-3)
    planar = simulate(Hose(parameters, modes), U, times, tolerance)
    period = 1 / cycle_of(times, planar.tip, planar.tip_velocity).frequency
    halves = planar.states[-1].reshape(2, -1)
    start = np.hstack([halves, np.zeros((2, modes))]).ravel()
    strobe = np.arange(periods + 1) * period
    states = simulate(SpatialHose(parameters, modes), U, strobe, tolerance, start, lateral_rate=push).states
    lateral = states.reshape(-1, 2, 3, modes)[-fitted - 1 :, :, 2].reshape(fitted + 1, -1)
    # successive states obey a recurrence of two terms once the others have died out
    before = np.column_stack([lateral[:-2].ravel(), lateral[1:-1].ravel()])
    weights = np.linalg.lstsq(before, lateral[2:].ravel(), rcond=None)[0]
    return np.roots([1, -weights[1], -weights[0]]).astype(complex), period


def spatial_rotation(parameters, U, modes, settle, tolerance=1e-6, lateral_rate=0.5, interval=1e-4):
    """`Rotation` in the second after `settle` s of the motion from rest, straight, but for a lateral velocity."""
    times = settle + np.arange(0, 1 + interval / 2, interval)
    history = simulate(SpatialHose(parameters, modes), U, times, tolerance, lateral_rate=lateral_rate)
    return rotation_of(times, history.tip, history.tip_velocity)


def write_spatial_file(U=15.0, lateral_rate=0.05, settle=36.0, to=HERE):
    """Write hose_space.json: motion in space after a lateral push, its settled rotation, stability of the plane."""
    start = Parameters()
    times = np.arange(1, 11) * 0.1
    result = {
        "parameters": asdict(start),
        "speed": U,
        "lateral_rate": lateral_rate,
        "critical_out_of_plane": Hose(start, 24).critical_speed(5, 30, lateral=True),  # m/s, 1/s
        "times": times.round(3).tolist(),
        "tip": {},  # by modes: x, y, z [m]
    }
    for modes in (10, 14, 18, 22):
        tip = simulate(SpatialHose(start, modes), U, times, 1e-8, lateral_rate=lateral_rate).tip
        result["tip"][str(modes)] = tip.round(10).tolist()
    multipliers, period = lateral_multipliers(start, U, 14, SETTLING[15])
    result["planar_cycle"] = {
        "period": period,
        "lateral_multipliers": [[float(m.real), float(m.imag)] for m in multipliers],
        "growth_rate": float(np.log(np.abs(multipliers).max()) / period),  # 1/s
    }
    result["settle"] = settle
    result["rotation"] = {
        str(modes): asdict(spatial_rotation(start, U, modes, settle, lateral_rate=lateral_rate))
        for modes in (10, 14, 18)
    }
    with open(to / "hose_space.json", "w") as file:
        json.dump(result, file, indent=1)
        file.write("\n")


# ----------------------------------------------------------------------------------------------------------------------
# 5. straight inextensible hoses of several pieces
# ----------------------------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Piece:
    """A uniform piece of a hose."""

    length: float  # m
    EJ: float  # N m^2
    mass: float  # kg/m of the hose alone
    water: float  # kg/m
    damping: float = 0.0  # s


class PiecewisePipe:
    """Small lateral motion of a straight, weightless, inextensible cantilever of several pieces: spectral elements.

    The flow of mass Q = M_k U_k is the same in all pieces.  Where its speed changes from U_1 to U_2 the joint
    feels -Q (U_2 - U_1) r', and so does the end with a nozzle; along a piece the axial force does not change, as the
    flow has no tangential force there.  Hence N_k = -Q (U_jet - U_k), U_jet the speed of the jet.  (With N_k's and
    the flow's own terms together, w'' has the factor Q U_jet in every piece, and EJ w''' is continuous.)  Legendre
    polynomials in every piece, w and w' made continuous by the null space of the conditions.
    """

    def __init__(self, pieces, modes=14, outlet=1.0, tip_mass=0.0):
        self.pieces = pieces
        count, n = len(pieces), modes
        x, weights = leggauss(modes + 4)
        # speeds and flow of mass for a unit speed in the first piece
        flow = pieces[0].water
        speeds = [flow / piece.water for piece in pieces]
        after = [*speeds[1:], outlet * speeds[-1]]
        self.mass, self.bend, self.kelvin, self.thrust, self.coriolis = np.zeros((5, count * n, count * n))
        conditions = np.zeros((2 * count, count * n))
        for k, piece in enumerate(pieces):
            part = slice(k * n, (k + 1) * n)
            w, slope, bend = _legendre(x, n, piece.length)
            (start, end), (start_slope, end_slope), _ = _legendre(np.array([-1.0, 1.0]), n, piece.length)
            W = weights * piece.length / 2

            def integral(left, right, W=W):
                return np.einsum("qi,qj,q->ij", left, right, W)

            axial = -flow * (after[-1] - speeds[k])
            self.mass[part, part] = (piece.mass + piece.water) * integral(w, w)
            self.bend[part, part] = piece.EJ * integral(bend, bend)
            self.kelvin[part, part] = piece.damping * self.bend[part, part]
            self.coriolis[part, part] = 2 * flow * integral(w, slope)
            self.thrust[part, part] = flow * speeds[k] * integral(w, bend) + axial * integral(slope, slope)
            self.thrust[part, part] += flow * (after[k] - speeds[k]) * np.outer(end, end_slope)
            if k == count - 1:
                self.mass[part, part] += tip_mass * np.outer(end, end)
            conditions[2 * k : 2 * k + 2, part] = start, start_slope
            if k < count - 1:
                conditions[2 * k + 2 : 2 * k + 4, part] = -end, -end_slope
        free = null_space(conditions / np.linalg.norm(conditions, axis=1)[:, None])
        mass = free.T @ self.mass @ free
        for name in ("bend", "kelvin", "thrust", "coriolis"):
            setattr(self, name, np.linalg.solve(mass, free.T @ getattr(self, name) @ free))
        self.damped = any(piece.damping for piece in pieces)

    def eigenvalues(self, U):
        """All [1/s] at U [m/s] in the first piece, by magnitude; about the lower half of them mean something."""
        n = len(self.bend)
        stiffness, damping = self.bend + U**2 * self.thrust, self.kelvin + U * self.coriolis
        found = eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]))
        return found[np.argsort(np.abs(found))]

    def critical_speed(self, low, high, count=40, considered=10):
        """First speed [m/s] of the first piece, in (low, high), at which the pipe turns unstable; frequency [1/s].

        `considered`: so many eigenvalues of least magnitude.  Raises ValueError if none is found.
        """

        def rightmost(U):
            found = self.eigenvalues(U)[:considered]
            return found[np.argmax(found.real)]

        speeds = np.linspace(low, high, count + 1)
        growth = [rightmost(U).real for U in speeds]
        for (left, before), (right, after) in pairwise(zip(speeds, growth, strict=True)):
            if before < 0 <= after:
                U = brentq(lambda U: rightmost(U).real, left, right, xtol=1e-13)
                return float(U), float(abs(rightmost(U).imag))
        raise ValueError(f"no loss of stability between {low} and {high} m/s")


def _legendre(x, count, length):
    """Legendre polynomials at x in (-1, 1) of a piece of some length, and two derivatives for the arc length."""
    units = np.eye(count) * np.sqrt((2 * np.arange(count) + 1) / length)
    derivatives = [np.polynomial.legendre.legder(units, order) if order else units for order in range(3)]
    return [np.polynomial.legendre.legval(x, c).T * (2 / length) ** order for order, c in enumerate(derivatives)]


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
            "out_of_plane": fine.critical_speed(5, 30, lateral=True, damped=False),
            "out_of_plane_damped": fine.critical_speed(5, 30, lateral=True),
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
    write_spatial_file()
