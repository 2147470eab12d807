"""The ALE-ANCF cable element from its kinematics alone: forces, energies and rates to full precision.

The element (thesis sections 2.2 and 2.3) has the nodes (r1, r1', p1) and (r2, r2', p2); a point of it is
r = H1 r1 + L H2 r1' + H3 r2 + L H4 r2' with the cubic Hermite polynomials H of xi = (p - p1)/L and L = p2 - p1
(linear element: r = (1 - xi) r1 + xi r2).  A particle keeps its p while r, r' and p of the nodes move.  Everything here
follows from that sentence by truncated power series in time, `Series`: put q(t) = q + v t + a t^2/2 into r(p, q(t)) at
fixed p and read velocity and acceleration off the coefficients.  The virtual displacement of a particle for one degree
of freedom is its velocity when only that degree of freedom moves, at speed one.  No derivative of a shape function with
respect to p1 or p2 is written down anywhere.

Order of the degrees of freedom: cubic (r1, r1', p1, r2, r2', p2), 14; linear (r1, p1, r2, p2), 8.  SI units.  All
functions accept complex arguments, so that `jacobian` gives tangents by complex steps.
"""

from functools import lru_cache

import numpy as np

POINTS = 20  # Gauss points of inertia and energies: exact for polynomials to degree 39


class Series:
    """Power series in one variable, cut off after the given terms (arrays that broadcast)."""

    __array_ufunc__ = None  # an array on the left leaves the operation to this class

    def __init__(self, *terms):
        self.terms = terms

    def _of(self, other):
        if isinstance(other, Series):
            return other.terms
        return [np.asarray(other)] + [np.zeros(())] * (len(self.terms) - 1)

    def __getitem__(self, key):
        return Series(*(t[key] for t in self.terms))

    def __neg__(self):
        return Series(*(-t for t in self.terms))

    def __add__(self, other):
        if isinstance(other, float):
            return Series(self.terms[0] + other, *self.terms[1:])
        return Series(*(a + b for a, b in zip(self.terms, self._of(other), strict=True)))

    def __sub__(self, other):
        return Series(*(a - b for a, b in zip(self.terms, self._of(other), strict=True)))

    def __mul__(self, other):
        if not isinstance(other, Series):
            return Series(*(t * other for t in self.terms))
        a, b = self.terms, other.terms
        made = []
        for n in range(len(a)):
            total = a[0] * b[n]
            for i in range(1, n + 1):
                total = total + a[i] * b[n - i]
            made.append(total)
        return Series(*made)

    def __truediv__(self, other):
        if not isinstance(other, Series):
            return Series(*(t / other for t in self.terms))
        a, b = self.terms, other.terms
        c = []
        for n in range(len(a)):
            c.append((a[n] - sum(b[i] * c[n - i] for i in range(1, n + 1))) / b[0])
        return Series(*c)

    def __radd__(self, other):
        return self + other

    def __rsub__(self, other):
        return -self + other

    def __rmul__(self, other):
        return self * other

    def sqrt(self):
        c = [np.sqrt(self.terms[0])]
        for n in range(1, len(self.terms)):
            c.append((self.terms[n] - sum(c[i] * c[n - i] for i in range(1, n))) / (2 * c[0]))
        return Series(*c)

    def sum(self):
        """Sum over the last axis."""
        return Series(*(t.sum(axis=-1) for t in self.terms))


def jacobian(function, x, step=1e-40):
    """Derivative of a real function by complex steps, shape (len(function), len(x)); a row for a scalar function."""
    columns = []
    for j in range(len(x)):
        z = np.array(x, dtype=complex)
        z[j] += 1j * step
        columns.append(np.imag(function(z)) / step)
    return np.stack(columns, axis=-1)


@lru_cache
def rule(name, points):
    """Points and weights on [0, 1]: 'gauss' or 'lobatto'."""
    if name == "gauss":
        x, w = np.polynomial.legendre.leggauss(points)
    elif name == "lobatto":
        last = np.polynomial.legendre.Legendre.basis(points - 1)
        x = np.concatenate([[-1.0], np.sort(last.deriv().roots().real), [1.0]])
        w = 2 / (points * (points - 1) * last(x) ** 2)
    else:
        raise ValueError(f"no quadrature {name!r}; there are gauss and lobatto")
    return (1 + x) / 2, w / 2


def _hermite():
    """Coefficients (powers 0 to 3) of the cubics with one end value or slope equal to one and the other three zero."""
    conditions = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 1, 1], [0, 1, 2, 3]])  # value, slope at 0; at 1
    return np.rint(np.linalg.inv(conditions)).T


CUBIC, LINEAR = _hermite(), np.array([[1.0, -1.0], [0.0, 1.0]])


@lru_cache
def _derived(coefficients, times):
    """Coefficients of a derivative of a polynomial."""
    return tuple(map(float, np.polynomial.polynomial.polyder(coefficients, times)))


def _parts(q, linear):
    """Vectors that the shape polynomials multiply, and p1 and L."""
    if linear:
        return [q[..., 0:3], q[..., 4:7]], q[..., 3], q[..., 7] - q[..., 3]
    p1, length = q[..., 6], q[..., 13] - q[..., 6]
    stretch = length[..., None]
    return [q[..., 0:3], stretch * q[..., 3:6], q[..., 7:10], stretch * q[..., 10:13]], p1, length


def centreline(q, xi, derivative=0, linear=False):
    """d^n r/dp^n at the points xi, shape (..., points, 3), for arrays or series q (..., dofs) and xi (..., points)."""
    vectors, _, length = _parts(q, linear)
    total = None
    for coefficients, vector in zip(LINEAR if linear else CUBIC, vectors, strict=True):
        polynomial = _derived(tuple(map(float, coefficients)), derivative)
        shape = 0 * xi + polynomial[-1]
        for c in polynomial[-2::-1]:
            shape = shape * xi + c
        term = shape[..., None] * vector[..., None, :]
        total = term if total is None else total + term
    for _ in range(derivative):
        total = total / length[..., None, None]
    return total


def _follow(q, xi):
    """The points of the particles that are at xi at t = 0, as a series, for a series q (dofs)."""
    linear = q.terms[0].shape[-1] == 8
    _, p1, length = _parts(q, linear)
    p = p1.terms[0][..., None] + xi * length.terms[0][..., None]
    return (p - p1[..., None]) / length[..., None]


def particle(q, v, a, xi, linear=False):
    """Position, velocity and acceleration (points, 3) of the particles at xi, and their virtual displacements.

    The virtual displacements have the shape (dofs, points, 3).
    """
    motion = Series(q, v, a / 2)
    r = centreline(motion, _follow(motion, xi), linear=linear).terms
    unit = Series(q, np.eye(len(q)))
    virtual = centreline(unit, _follow(unit, xi), linear=linear).terms[1]
    return r[0], r[1], 2 * r[2], virtual


def _length(q, linear):
    return _parts(q, linear)[2]


def inertia(q, v, a, rhoA, load=(0.0, 0.0, 0.0), linear=False):
    """Generalized force of inertia minus load, (14,) or (8,): virtual work of the particles between p1 and p2.

    Parameters
    ----------
    q, v, a : (14,) or (8,) degrees of freedom, rates [.../s], accelerations [.../s2]
    rhoA : mass per unstretched length [kg/m]
    load : (3,) force per unstretched length [N/m]
    """
    q, v, a = np.asarray(q), np.asarray(v), np.asarray(a)
    xi, w = rule("gauss", POINTS)
    _, _, acceleration, virtual = particle(q, v, a, xi, linear)
    return _length(q, linear) * np.einsum("g,gi,jgi->j", w, rhoA * acceleration - np.asarray(load), virtual)


def mass(q, rhoA, linear=False):
    """Mass matrix, d inertia/da: integral of rhoA times the products of the virtual displacements."""
    q = np.asarray(q)
    xi, w = rule("gauss", POINTS)
    virtual = particle(q, 0 * q, 0 * q, xi, linear)[3]
    return rhoA * _length(q, linear) * np.einsum("g,igk,jgk->ij", w, virtual, virtual)


def _axial_strain(slope, strain):
    """Green or engineering strain from r' (..., points, 3)."""
    square = (slope * slope).sum()
    if strain == "green":
        return 0.5 * (square - 1)
    if strain == "engineering":
        return (square.sqrt() if isinstance(square, Series) else np.sqrt(square)) - 1
    raise ValueError(f"no strain {strain!r}; there are green and engineering")


def _squared_curvature(slope, bend):
    if isinstance(slope, Series):
        a, b, c = (slope * slope).sum(), (slope * bend).sum(), (bend * bend).sum()
    else:
        a, b, c = np.sum(slope * slope, -1), np.sum(slope * bend, -1), np.sum(bend * bend, -1)
    return (a * c - b * b) / (a * a * a)


def _strain_energy(q, EA, EJ, strain, compression, axial, bending, linear):
    """Series of the strain energy at fixed xi: the points of integration move with the nodes, as p1 and p2 do."""
    length = _length(q, linear)
    xi, w = rule(*axial)
    strains = _axial_strain(centreline(q, xi, 1, linear), strain)
    taut = 1.0 if compression else np.where(strains.terms[0].real > 0, 1.0, 0.0)
    energy = (strains * strains * (taut * w * (EA / 2))).sum() * length
    if EJ and not linear:
        xi, w = rule(*bending)
        squares = _squared_curvature(centreline(q, xi, 1), centreline(q, xi, 2))
        energy = energy + (squares * (w * (EJ / 2))).sum() * length
    return energy


def elastic(q, EA, EJ, strain="green", compression=True, axial=("gauss", 3), bending=("gauss", 3), linear=False):
    """Gradient (14,) or (8,) of the strain energy with respect to all degrees of freedom, p1 and p2 included [N].

    Parameters
    ----------
    EA, EJ : axial [N] and bending stiffness [N m2]
    strain : 'green' or 'engineering'
    compression : False: no energy where the strain is negative
    axial, bending : (name, points) of the rules of integration
    """
    q = np.asarray(q)
    motion = Series(q, np.eye(len(q)))
    return _strain_energy(motion, EA, EJ, strain, compression, axial, bending, linear).terms[1]


def damping(
    q,
    v,
    EA,
    EJ,
    c,
    eps_kappa=1e-9,
    strain="green",
    compression=True,
    axial=("gauss", 3),
    bending=("gauss", 3),
    linear=False,
):
    """Gradient with respect to v of the dissipation function, (14,) or (8,), [N].

    The function is the integral of c EA (d eps/dt)^2/2 + c EJ (d kappa^2/dt)^2/(8 (kappa^2 + eps_kappa^2)) over p with
    the rates of a fixed particle; the second is c EJ (d kappa/dt)^2/2 without the division by zero at kappa = 0.
    Where `compression` is False the axial part acts only where the strain is positive.
    """
    q, v = np.asarray(q), np.asarray(v)
    motion, unit = Series(q, v), Series(q, np.eye(len(q)))
    length = _length(q, linear)
    xi, w = rule(*axial)
    # the rates are linear in v, so the derivative of a rate with respect to v_j is the rate at v = e_j
    rate, rates = (_axial_strain(centreline(s, _follow(s, xi), 1, linear), strain) for s in (motion, unit))
    taut = 1.0 if compression else np.where(rate.terms[0].real > 0, 1.0, 0.0)
    force = c * EA * length * np.einsum("g,jg->j", taut * w * rate.terms[1], rates.terms[1])
    if EJ and not linear:
        xi, w = rule(*bending)
        rate, rates = (
            _squared_curvature(centreline(s, at, 1), centreline(s, at, 2))
            for s, at in ((s, _follow(s, xi)) for s in (motion, unit))
        )
        weight = w / (4 * (rate.terms[0] + eps_kappa**2))
        force = force + c * EJ * length * np.einsum("g,jg->j", weight * rate.terms[1], rates.terms[1])
    return force


# energies
def kinetic_energy(q, v, rhoA, linear=False):
    """Kinetic energy of the particles between p1 and p2 [J]."""
    q, v = np.asarray(q), np.asarray(v)
    xi, w = rule("gauss", POINTS)
    velocity = particle(q, v, 0 * q, xi, linear)[1]
    return rhoA / 2 * _length(q, linear) * np.sum(w * np.sum(velocity * velocity, -1))


def strain_energy(q, EA, EJ, strain="green", compression=True, axial=("gauss", 3), bending=("gauss", 3), linear=False):
    """Strain energy [J]; its gradient is `elastic`."""
    return _strain_energy(Series(np.asarray(q)), EA, EJ, strain, compression, axial, bending, linear).terms[0]


def strain_energy_density(q, xi, EA, EJ, strain="green", compression=True, linear=False):
    """Strain energy per unstretched length Psi [J/m] at the points xi, shape (points,)."""
    q, xi = Series(np.asarray(q)), np.atleast_1d(xi)
    strains = _axial_strain(centreline(q, xi, 1, linear), strain).terms[0]
    density = EA / 2 * strains**2 * (1.0 if compression else strains.real > 0)
    if EJ and not linear:
        density = density + EJ / 2 * _squared_curvature(centreline(q, xi, 1), centreline(q, xi, 2)).terms[0]
    return density


def potential_energy(q, load, linear=False):
    """Potential of the constant load (3,) [N/m], zero at the origin [J]."""
    q = np.asarray(q)
    xi, w = rule("gauss", POINTS)
    return -_length(q, linear) * np.sum(w * (centreline(q, xi, linear=linear) @ np.asarray(load)))


def power_balance(q, v, a, rhoA, load, EA=0.0, EJ=0.0, linear=False, **material):
    """Powers of the forces against the rates of the energies, each a pair that has to agree [W].

    With the energy densities k, -load.r and Psi of the particles, the energy between p1 and p2 grows by the power of
    the forces on the particles and by what enters through the ends, [density dp/dt] from p1 to p2.  The strain energy
    has no such term because `elastic` is the gradient of all of it; `strain_flux` is what an open end takes away.

    Returns
    -------
    dict with the pairs 'inertia' (v.R of inertia, rate of the kinetic energy minus its flux), 'load' (v.R of the load,
    rate of the potential minus its flux), 'elastic' (v.R, rate of the strain energy), and the floats 'kinetic_flux',
    'potential_flux', 'strain_flux'.
    """
    q, v, a = np.asarray(q, float), np.asarray(v, float), np.asarray(a, float)
    step = 1e-40
    moved, sped = q + 1j * step * v, v + 1j * step * a
    p_rows = (3, 7) if linear else (6, 13)
    ends = np.array([0.0, 1.0])
    position, velocity, _, _ = particle(q, v, a, ends, linear)
    sign = np.array([-1.0, 1.0]) * v[list(p_rows)]
    kinetic_flux = float(sign @ (rhoA / 2 * np.sum(velocity**2, -1)))
    potential_flux = float(sign @ (-position @ np.asarray(load)))
    strain_flux = float(sign @ strain_energy_density(q, ends, EA, EJ, linear=linear, **_density_only(material)))
    powers = {
        "inertia": (
            v @ inertia(q, v, a, rhoA, linear=linear),
            np.imag(kinetic_energy(moved, sped, rhoA, linear)) / step - kinetic_flux,
        ),
        "load": (
            v @ inertia(q, v, a, 0.0, load, linear),
            np.imag(potential_energy(moved, load, linear)) / step - potential_flux,
        ),
        "elastic": (
            v @ elastic(q, EA, EJ, linear=linear, **material),
            np.imag(strain_energy(moved, EA, EJ, linear=linear, **material)) / step,
        ),
    }
    return powers | {
        "kinetic_flux": kinetic_flux,
        "potential_flux": potential_flux,
        "strain_flux": strain_flux,
    }


def _density_only(material):
    return {k: v for k, v in material.items() if k in ("strain", "compression")}


def kink(slope_left, slope_right, pdot, rhoA):
    """Force of inertia of the material that turns the corner at a node between two linear elements: on r (3,), on p.

    The particle at the node has the velocity dr/dt - r' dp/dt on either side, so crossing costs the momentum
    (v_left - v_right) per mass, and rhoA dp/dt of mass crosses from right to left (p of the node grows).  Its virtual
    displacement is dr - r' dp; in between it is taken half way, which is what makes the power v.R equal to the kinetic
    energy that the crossing mass gains.
    """
    left, right = np.asarray(slope_left), np.asarray(slope_right)
    gain = rhoA * pdot * ((-left * pdot) - (-right * pdot))
    return gain, -gain @ (left + right) / 2
