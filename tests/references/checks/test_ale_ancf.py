"""Self-tests of the reference element: manufactured motions, textbook matrices, steady flows, balances of energy."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from references import ale_ancf as ale

RHO_A, G = 1.3, np.array([0.2, 0.5, -9.81])
FINE = {"axial": ("gauss", 20), "bending": ("gauss", 20)}


def free_state(seed, linear=False):
    """A bent and stretched element with all degrees of freedom moving."""
    rng = np.random.default_rng(seed)
    if linear:
        q = np.concatenate([0.3 * rng.normal(size=3), [0.3], [1.7, 0.3, 0.1] + 0.3 * rng.normal(size=3), [1.9]])
    else:
        ends = np.array([[0, 0, 0], [1, 0.1, -0.2], [1.7, 0.3, 0.1], [1, 0.1, 0.3]]) + 0.2 * rng.normal(size=(4, 3))
        q = np.concatenate([*ends[:2], [0.3], *ends[2:], [1.9]])
    return q, rng.normal(size=len(q)), rng.normal(size=len(q))


class Motion:
    """A motion x(p, t) of the material, cubic in p (or straight: linear), seen by nodes that slide over it.

    The element holds such a motion exactly whatever its nodes do, so its particles must move as prescribed.
    """

    def __init__(self, seed, linear=False, moving=True):
        rng = np.random.default_rng(seed)
        powers = 2 if linear else 4
        scale = np.array([1.0, 1.0, 0.3, 0.1])[:powers, None, None]
        self.x = scale * rng.normal(size=(powers, 3, 3))  # power of p, axis, power of t
        if not moving:
            self.x[..., 1:] = 0.0
        self.p = np.array([[0.3, *rng.normal(size=2)], [1.9, *rng.normal(size=2)]])
        terms = []
        for p in (Polynomial(row) for row in self.p):
            terms += [self._at(p, 0, axis) for axis in range(3)]
            terms += [] if linear else [self._at(p, 1, axis) for axis in range(3)]
            terms.append(p)
        coefficients = np.array([[*t.coef, 0, 0, 0][:3] for t in terms])
        self.q, self.v, self.a = coefficients[:, 0], coefficients[:, 1], 2 * coefficients[:, 2]

    def _at(self, p, derivative, axis):
        total = Polynomial([0.0])
        for k in range(derivative, len(self.x)):
            factor = np.prod(np.arange(k, k - derivative, -1))
            total = total + float(factor) * Polynomial(self.x[k, axis]) * p ** (k - derivative)
        return total

    def coefficient(self, p, time_power, derivative=0):
        """(points, 3) coefficient of t^n of d^k x/dp^k at the particles p."""
        polynomial = np.polynomial.polynomial.polyder(self.x[..., time_power], derivative, axis=0)
        return np.polynomial.polynomial.polyval(p, polynomial).T


# kinematics
@pytest.mark.parametrize("linear", [False, True])
def test_particles_move_as_the_material_does_whatever_the_nodes_do(linear):
    motion, xi = Motion(1, linear), np.array([0.0, 0.13, 0.6, 1.0])
    p = motion.p[0, 0] + xi * (motion.p[1, 0] - motion.p[0, 0])
    r, velocity, acceleration, _ = ale.particle(motion.q, motion.v, motion.a, xi, linear)
    for got, power, factor in ((r, 0, 1), (velocity, 1, 1), (acceleration, 2, 2)):
        assert got == pytest.approx(factor * motion.coefficient(p, power), abs=1e-12)


@pytest.mark.parametrize("linear", [False, True])
def test_nodes_sliding_over_material_at_rest_feel_no_inertia(linear):
    motion = Motion(2, linear, moving=False)
    assert np.abs(motion.v).max() > 0.1
    assert ale.inertia(motion.q, motion.v, motion.a, RHO_A, linear=linear) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("linear", [False, True])
def test_inertia_is_linear_in_the_acceleration_with_the_symmetric_mass_matrix(linear):
    q, v, a = free_state(3, linear)
    matrix = ale.mass(q, RHO_A, linear)
    by_steps = ale.jacobian(lambda z: ale.inertia(q, v, z, RHO_A, linear=linear), a)
    assert by_steps == pytest.approx(matrix, abs=1e-13)
    assert matrix == pytest.approx(matrix.T, abs=1e-15)
    # two motions of the mesh leave the material at rest; all others carry mass
    size = np.sort(np.linalg.eigvalsh(matrix))
    assert size[:2] == pytest.approx(0, abs=1e-14)
    assert size[2] > 1e-3


def test_fixed_p_leaves_the_textbook_mass_matrix():
    q, _, _ = free_state(4)
    length = q[13] - q[6]
    textbook = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420.0
    size = np.array([1, length, 1, length])
    expected = np.kron(RHO_A * length * textbook * np.outer(size, size), np.eye(3))
    kept = [*range(6), *range(7, 13)]
    assert ale.mass(q, RHO_A)[np.ix_(kept, kept)] == pytest.approx(expected, rel=1e-13, abs=1e-15)


def test_fixed_p_leaves_the_textbook_mass_matrix_of_the_linear_element():
    q, _, _ = free_state(4, linear=True)
    kept = [0, 1, 2, 4, 5, 6]
    expected = np.kron(RHO_A * (q[7] - q[3]) / 6 * np.array([[2, 1], [1, 2]]), np.eye(3))
    assert ale.mass(q, RHO_A, linear=True)[np.ix_(kept, kept)] == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("linear", [False, True])
def test_uniform_load_does_the_work_of_gravity_on_the_particles(linear):
    q, _, _ = free_state(5, linear)
    rest = np.zeros(len(q))
    falling = rest.copy()
    for row in (0, 4) if linear else (0, 7):
        falling[row : row + 3] = G
    # all particles in free fall: inertia and weight cancel in every row
    assert ale.inertia(q, rest, falling, RHO_A, RHO_A * G, linear) == pytest.approx(0, abs=1e-12)
    assert np.abs(ale.inertia(q, rest, rest, RHO_A, RHO_A * G, linear)).max() > 1


# steady flow through nodes at rest
def flow(slope, end, length, u):
    q = np.concatenate([[0, 0, 0], slope[0], [0.0], end, slope[1], [length]])
    v = np.zeros(14)
    v[[6, 13]] = u
    return ale.inertia(q, v, np.zeros(14), RHO_A), q, v


def test_steady_flow_through_a_straight_pipe_needs_no_force():
    force, _, _ = flow([[1, 0, 0], [1, 0, 0]], [1.6, 0, 0], 1.6, 5.0)
    assert force == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(("angle", "tolerance"), [(0.4, 1e-4), (0.1, 5e-7)])
def test_steady_flow_round_an_arc_needs_the_centripetal_force(angle, tolerance):
    radius, u = 2.0, 5.0
    turn = np.array([np.cos(angle), np.sin(angle), 0.0])
    end = radius * np.array([np.sin(angle), 1 - np.cos(angle), 0.0])
    force, _, _ = flow([[1, 0, 0], turn], end, radius * angle, u)
    nodes = np.array([0, 1, 2, 7, 8, 9])
    xi, w = ale.rule("gauss", 20)
    normal = np.stack([-np.sin(xi * angle), np.cos(xi * angle), 0 * xi], -1)
    cubics = np.stack([1 - 3 * xi**2 + 2 * xi**3, 3 * xi**2 - 2 * xi**3])
    expected = RHO_A * u**2 / radius * radius * angle * np.einsum("g,ig,gk->ik", w, cubics, normal).ravel()
    assert force[nodes] == pytest.approx(expected, abs=tolerance * np.abs(expected).max())
    # all of it: the turn of the momentum flux, whatever the curve
    assert force[0:3] + force[7:10] == pytest.approx(RHO_A * u**2 * (turn - [1, 0, 0]), abs=1e-12)


def test_the_kink_of_linear_elements_is_the_limit_of_a_bend_of_the_cubic_one():
    slopes, u = np.array([[1.0, 0.1, 0.0], [0.7, 0.8, 0.2]]), -5.0
    for length in (1.0, 1e-3):
        force, _, _ = flow(slopes, length * slopes.mean(axis=0), length, u)
        on_r, on_p = ale.kink(*slopes, u, RHO_A)
        assert force[0:3] + force[7:10] == pytest.approx(on_r, abs=1e-12)
        assert force[6] + force[13] == pytest.approx(on_p, abs=1e-12)


def test_the_kink_closes_the_kinetic_energy_of_two_linear_elements():
    rng = np.random.default_rng(6)
    nodes = np.array([[0, 0, 0, 0.0], [1, 0.2, -0.1, 1.1], [1.5, 1.0, 0.4, 2.0]])
    v, a = rng.normal(size=(2, 3, 4))
    power = rate = 0.0
    for k in (0, 1):
        both = slice(k, k + 2)
        pairs = ale.power_balance(
            nodes[both].ravel(), v[both].ravel(), a[both].ravel(), RHO_A, np.zeros(3), linear=True
        )
        power += pairs["inertia"][0]
        rate += pairs["inertia"][1] + pairs["kinetic_flux"]  # rate of the energy inside
    slopes = np.diff(nodes[:, :3], axis=0) / np.diff(nodes[:, 3])[:, None]
    on_r, on_p = ale.kink(*slopes, v[1, 3], RHO_A)
    power += on_r @ v[1, :3] + on_p * v[1, 3]
    ends = ((nodes[k], v[k], slope, sign) for k, slope, sign in ((0, slopes[0], -1), (2, slopes[1], 1)))
    outer = sum(s * d[3] * RHO_A / 2 * np.sum((d[:3] - slope * d[3]) ** 2) for _, d, slope, s in ends)
    assert power == pytest.approx(rate - outer, rel=1e-12)
    assert abs(on_r @ v[1, :3] + on_p * v[1, 3]) > 1e-2 * abs(power)


# energies
@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("seed", [7, 8, 9])
def test_power_of_each_force_is_the_rate_of_its_energy_less_the_flux_through_the_ends(seed, linear):
    q, v, a = free_state(seed, linear)
    pairs = ale.power_balance(q, v, a, RHO_A, RHO_A * G, 100.0, 7.0, linear)
    for name in ("inertia", "load", "elastic"):
        assert pairs[name][0] == pytest.approx(pairs[name][1], rel=1e-12), name
    assert abs(pairs["kinetic_flux"]) > 1e-2


def test_kinetic_energy_is_half_the_mass_matrix():
    q, v, _ = free_state(10)
    assert ale.kinetic_energy(q, v, RHO_A) == pytest.approx(v @ ale.mass(q, RHO_A) @ v / 2, rel=1e-13)


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("strain", ["green", "engineering"])
@pytest.mark.parametrize("axial", [("gauss", 3), ("lobatto", 3)])
@pytest.mark.parametrize("compression", [True, False])
def test_elastic_force_is_the_gradient_of_the_strain_energy(axial, strain, compression, linear):
    q, _, _ = free_state(11, linear)
    if not linear:
        q[3:6] *= 0.6  # slack at one end
    options = {"strain": strain, "compression": compression, "axial": axial, "linear": linear}
    force = ale.elastic(q, 100.0, 7.0, **options)
    gradient = ale.jacobian(lambda z: ale.strain_energy(z, 100.0, 7.0, **options), q)
    assert force == pytest.approx(gradient, rel=1e-12, abs=1e-12)


def test_tension_only_drops_the_slack_points_and_nothing_else():
    q, _, _ = free_state(11)
    q[3:6] *= 0.6
    xi, w = ale.rule("gauss", 3)
    slope = ale.centreline(q, xi, 1)
    strains = (np.sum(slope**2, -1) - 1) / 2
    assert strains.min() < 0 < strains.max()
    taut = 100.0 / 2 * (q[13] - q[6]) * np.sum(w * np.maximum(strains, 0) ** 2)
    assert ale.strain_energy(q, 100.0, 0.0, compression=False) == pytest.approx(taut, rel=1e-13)


def test_stretched_straight_element_pulls_with_the_force_of_its_strain():
    stretch, length, EA = 1.02, 1.6, 1e5
    q = np.array([0, 0, 0, stretch, 0, 0, 0, stretch * length, 0, 0, stretch, 0, 0, length])
    for strain, pull, energy in (
        ("green", EA * (stretch**2 - 1) / 2 * stretch, EA * ((stretch**2 - 1) / 2) ** 2 / 2),
        ("engineering", EA * (stretch - 1), EA * (stretch - 1) ** 2 / 2),
    ):
        force = ale.elastic(q, EA, 3.0, strain)
        assert force[[0, 7]] == pytest.approx([-pull, pull], rel=1e-12)
        assert force[[6, 13]] == pytest.approx([stretch * pull - energy, energy - stretch * pull], rel=1e-12)
        assert force[[3, 10]] == pytest.approx(0, abs=1e-10)


def test_curvature_does_not_depend_on_the_stretch_along_the_curve():
    radius, xi = 2.0, ale.rule("gauss", 3)[0]
    angle = 0.02
    turn, end = np.array([np.cos(angle), np.sin(angle), 0]), np.array([np.sin(angle), 1 - np.cos(angle), 0])
    for stretch in (1.0, 1.3):
        length = radius * angle / stretch
        q = np.concatenate([[0, 0, 0], [stretch, 0, 0], [0.0], radius * end, stretch * turn, [length]])
        density = ale.strain_energy_density(q, xi, 0.0, 2.0)
        assert density == pytest.approx(1 / radius**2, rel=1e-3)


@pytest.mark.parametrize("EJ", [0.0, 7.0])
def test_work_on_the_particles_is_the_gradient_less_the_energy_swept_by_the_ends(EJ):
    q, v, _ = free_state(12)
    xi, w = ale.rule("gauss", 20)
    motion = ale.Series(q, v)
    at = ale._follow(motion, xi)
    slope, bend = ale.centreline(motion, at, 1), ale.centreline(motion, at, 2)
    density = ale._axial_strain(slope, "green") * ale._axial_strain(slope, "green") * 50.0
    density = density + ale._squared_curvature(slope, bend) * (EJ / 2)
    work = (q[13] - q[6]) * np.sum(w * density.terms[1])
    swept = ale.power_balance(q, v, 0 * v, RHO_A, G, 100.0, EJ)["strain_flux"]
    # curvature is no polynomial: 20 points leave 1e-7
    assert v @ ale.elastic(q, 100.0, EJ, **FINE) - swept == pytest.approx(work, rel=1e-6)


# damping
def rigid(q, linear=False):
    turn, rate = np.array([0.3, -0.7, 1.1]), np.zeros(len(q))
    for row in (0, 4) if linear else (0, 3, 7, 10):
        rate[row : row + 3] = np.cross(turn, q[row : row + 3])
    for row in (0, 4) if linear else (0, 7):
        rate[row : row + 3] += [1.0, 2.0, -3.0]
    return rate


@pytest.mark.parametrize("linear", [False, True])
def test_rigid_motion_dissipates_nothing(linear):
    q, v, _ = free_state(13, linear)
    assert ale.damping(q, rigid(q, linear), 100.0, 7.0, 0.1, linear=linear) == pytest.approx(0, abs=1e-12)
    assert np.abs(ale.damping(q, v, 100.0, 7.0, 0.1, linear=linear)).max() > 1


@pytest.mark.parametrize("linear", [False, True])
def test_nodes_sliding_over_material_at_rest_dissipate_nothing(linear):
    motion = Motion(14, linear, moving=False)
    assert ale.damping(motion.q, motion.v, 100.0, 7.0, 0.1, linear=linear) == pytest.approx(0, abs=1e-10)


@pytest.mark.parametrize("strain", ["green", "engineering"])
def test_power_of_damping_is_twice_the_dissipation_of_the_prescribed_motion(strain):
    motion = Motion(15)
    xi, w = ale.rule("gauss", 3)
    length = motion.p[1, 0] - motion.p[0, 0]
    p = motion.p[0, 0] + xi * length

    def strains(t):
        e, k = (sum(motion.coefficient(p, n, d) * t**n for n in range(3)) for d in (1, 2))
        stretch = np.sqrt(np.sum(e * e, -1))
        eps = (stretch**2 - 1) / 2 if strain == "green" else stretch - 1
        return eps, np.sqrt(np.sum(np.cross(e, k) ** 2, -1)) / stretch**3

    eps_rate, kappa_rate = (np.imag(s) / 1e-40 for s in strains(1e-40j))
    expected = 0.1 * length * np.sum(w * (100.0 * eps_rate**2 + 7.0 * kappa_rate**2))
    force = ale.damping(motion.q, motion.v, 100.0, 7.0, 0.1, strain=strain)
    assert motion.v @ force == pytest.approx(expected, rel=1e-10)


def test_damping_is_linear_in_the_rates_with_a_symmetric_matrix_that_takes_energy():
    q, v, _ = free_state(16)
    matrix = ale.jacobian(lambda z: ale.damping(q, z, 100.0, 7.0, 0.1), v)
    assert matrix @ v == pytest.approx(ale.damping(q, v, 100.0, 7.0, 0.1), rel=1e-10)
    assert matrix == pytest.approx(matrix.T, abs=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > -1e-12 * np.linalg.norm(matrix)


def test_series_divides_and_takes_roots():
    t = 0.01
    x = ale.Series(2.0, 0.3, -0.5)
    y = (x / x.sqrt()) * x.sqrt() - x
    assert [float(c) for c in y.terms] == pytest.approx([0, 0, 0], abs=1e-15)
    value = 2.0 + 0.3 * t - 0.5 * t**2
    assert sum(float(c) * t**n for n, c in enumerate(x.sqrt().terms)) == pytest.approx(np.sqrt(value), abs=1e-7)


def test_lobatto_and_gauss_rules_integrate_their_polynomials():
    for name, points, degree in (("gauss", 3, 5), ("lobatto", 3, 3), ("lobatto", 4, 5)):
        x, w = ale.rule(name, points)
        assert [w @ x**n for n in range(degree + 1)] == pytest.approx([1 / (n + 1) for n in range(degree + 1)])
        assert w @ x ** (degree + 1) != pytest.approx(1 / (degree + 2), rel=1e-6)
