"""Self-tests of the references for pipes conveying fluid: other methods, limits, balances, published values."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from of_the_suite import studies
from scipy.optimize import brentq

from references import hose
from references.hose import Hose, Parameters, Piece, PiecewisePipe, Pipe, SpatialHose, simulate, static_shape

SCENE = Parameters()
LADEN = replace(SCENE, tip_mass=5e-4, outlet=1.5)  # a mass and a nozzle at the free end


@pytest.fixture(scope="module")
def curve():
    return hose.boundary_curve()


# 1. the straight cantilever
@pytest.mark.parametrize(
    ("u", "beta", "alpha"), [(1.0, 0.1, 0.0), (5.0, 0.2, 0.0), (9.0, 0.5, 1e-3), (12.0, 0.85, 0.01)]
)
def test_exact_eigenvalues_are_those_of_galerkins_method(u, beta, alpha):
    exact = hose.eigenvalues(u, beta, 4, alpha)
    other = Pipe(36).eigenvalues(u, beta, alpha)
    for value in exact:
        assert np.abs(other - value).min() < 1e-8 * abs(value)


def test_eigenvalues_without_flow_are_those_of_the_clamped_free_beam():
    roots = np.array([1.8751040687119611, 4.6940911329741745, 7.8547574382376125])
    assert hose.eigenvalues(1e-9, 0.3, 3).imag == pytest.approx(roots**2, rel=1e-9)


@pytest.mark.parametrize(("beta", "u", "omega"), [(0.5, 9.32, 26.5), *studies((0.2, 5.59, 13.7), (0.1, 4.75, 14.2))])
def test_first_crossing_is_where_gregory_and_paidoussis_have_it(beta, u, omega):
    first = hose.critical_speeds(beta, upto=10.0)[0]
    assert (first.u, first.omega) == (pytest.approx(u, abs=0.01), pytest.approx(omega, abs=0.1))
    assert first.becomes == "unstable"


@pytest.mark.parametrize(("beta", "upto"), [(0.2, 9.0), *studies((0.2, 18.0), (0.9, 18.0))])
def test_crossings_account_for_every_unstable_eigenvalue(beta, upto):
    crossings, pipe = hose.critical_speeds(beta, upto=upto), Pipe(40)
    for u in np.arange(1.25, upto, 2.0):
        found = pipe.eigenvalues(u, beta)
        unstable = np.sum(found[np.abs(found) < 2000].real > 1e-9)
        passed = sum(1 if c.becomes == "unstable" else -1 for c in crossings if c.u < u)
        assert unstable == 2 * passed, u


@pytest.mark.study
def test_a_pipe_in_an_s_shaped_jump_turns_unstable_stable_and_unstable():
    assert [c.becomes for c in hose.critical_speeds(0.67, upto=13.0)] == ["unstable", "stable", "unstable"]


def test_boundary_curve_is_continuous_and_has_three_s_shaped_jumps(curve):
    beta, u, _ = curve
    assert beta[0] < 0.01
    assert beta[-1] > 0.99
    assert np.all(np.diff(u) > 0)
    assert np.abs(np.diff(curve, axis=1)).max(1) == pytest.approx(0, abs=1.0)
    turning = beta[1:-1][np.diff(np.sign(np.diff(beta))) != 0]
    assert len(turning) == 6
    for jump, (upper, lower) in zip((0.295, 0.67, 0.88), turning.reshape(3, 2), strict=True):
        assert lower < jump < upper


@pytest.mark.study
def test_boundary_curve_lies_on_the_crossings_at_fixed_mass_ratio(curve):
    for u in (7.0, 12.0):
        for beta, omega in hose.boundary(u, curve):
            nearest = min(hose.critical_speeds(beta, upto=u + 1), key=lambda c: abs(c.u - u))
            assert (nearest.u, nearest.omega) == (pytest.approx(u, abs=1e-8), pytest.approx(omega, rel=1e-8))


def test_without_coriolis_force_the_pipe_is_becks_column():
    pipe = Pipe(24)

    def gap(u):
        """Difference of the two lowest squared frequencies squared: negative once they have merged."""
        first, second = np.sort_complex(np.linalg.eigvals(pipe.matrices(u, 0.0)[0]))[:2]
        return ((first - second) ** 2).real

    u = brentq(gap, 4.0, 4.6, xtol=1e-14)
    assert u**2 == pytest.approx(20.0509, abs=2e-4)
    squares = np.sort(np.linalg.eigvals(pipe.matrices(u - 1e-6, 0.0)[0]).real)
    assert np.sqrt(squares[:2]) == pytest.approx(11.016, abs=0.03)


@pytest.mark.study
def test_the_least_coriolis_force_destabilises_becks_column():
    first = hose.critical_speeds(0.01, upto=6.0)[0]
    assert first.u < 4.3 < np.sqrt(20.05)


@pytest.mark.study
def test_gravity_of_the_galerkin_pipe_vanishes_continuously():
    with_gravity = hose.critical_speeds(0.2, gamma=1e-10, upto=7.0)
    exact = hose.critical_speeds(0.2, upto=7.0)
    assert with_gravity[0].u == pytest.approx(exact[0].u, abs=1e-8)
    assert with_gravity[0].omega == pytest.approx(exact[0].omega, abs=1e-7)


def test_a_standing_pipe_without_flow_buckles_at_greenhills_weight():
    pipe = Pipe(20)
    # (9/4) j^2 with j the first zero of the Bessel function of order -1/3
    weight = brentq(lambda gamma: np.linalg.slogdet(pipe.matrices(0.0, 0.2, gamma=-gamma)[0])[0], 7, 9, xtol=1e-12)
    assert weight == pytest.approx(7.83735, abs=1e-5)


def test_supported_pipes_buckle_at_the_closed_forms():
    def clamped_pinned(u):  # w = A (cos u x - 1) + B (sin u x - u x), w(1) = w''(1) = 0
        return np.linalg.det([[np.cos(u) - 1, np.sin(u) - u], [np.cos(u), np.sin(u)]])

    def clamped_clamped(u):  # w(1) = w'(1) = 0
        return np.linalg.det([[np.cos(u) - 1, np.sin(u) - u], [-u * np.sin(u), u * (np.cos(u) - 1)]])

    assert pytest.approx(4.493409457909064, abs=1e-13) == hose.CLAMPED_PINNED
    assert clamped_pinned(hose.CLAMPED_PINNED) == pytest.approx(0, abs=1e-12)
    assert clamped_clamped(hose.CLAMPED_CLAMPED) == pytest.approx(0, abs=1e-12)
    assert np.sin(hose.PINNED_PINNED) == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize(
    ("beta", "mu", "jet", "u", "omega"),
    [
        (0.2, 0.1, 1.0, 4.2216893472, 14.0846383388),
        (0.2, 0.0, 1.5, 4.0739480886, 14.0509762114),
        (0.5, 0.0, 2.0, 4.3942037465, 13.6138045707),
        *studies((0.2, 0.3, 1.0, 2.9057805558, 14.7181322290), (0.2, 0.0, 2.0, 3.3586842182, 14.2171025845)),
        *studies((0.5, 0.0, 1.5, 6.9183089564, 24.4641291863), (0.2, 0.3, 1.5, 2.2843498307, 14.8348498445)),
    ],
)
def test_mass_and_nozzle_at_the_end_lower_the_critical_speed(beta, mu, jet, u, omega):
    first = hose.critical_speeds(beta, upto=u + 0.2, mu=mu, jet=jet)[0]
    assert (first.u, first.omega) == (pytest.approx(u, abs=1e-9), pytest.approx(omega, abs=1e-8))
    assert np.abs(Pipe(32).eigenvalues(u, beta, mu=mu, jet=jet) - 1j * omega).min() < 1e-6
    # an end with a nozzle is that of a plain pipe of another mass ratio
    plain = hose.characteristic(1j * first.omega, first.u * np.sqrt(jet), beta / jet, mu=mu)
    beside = hose.characteristic(1j * first.omega, first.u * np.sqrt(jet) + 1e-3, beta / jet, mu=mu)
    assert abs(plain) < 1e-8 * abs(beside)


def test_the_nozzles_force_in_the_weak_form_is_the_factor_of_the_curvature():
    """-P int w' v' + P v(1) w'(1) of compression and follower force is P int v w''."""
    pipe = Pipe(12)
    slope = hose._orthonormal(np.ones(1), 12, 2)[1][0]
    assert -pipe.pull + np.outer(pipe.tip, slope) == pytest.approx(pipe.thrust, abs=1e-9 * np.abs(pipe.thrust).max())


def test_a_mass_at_the_end_without_flow_is_the_beams_frequency_equation():
    def beam(x, mu=0.3):
        return 1 + np.cos(x) * np.cosh(x) + mu * x * (np.cos(x) * np.sinh(x) - np.sin(x) * np.cosh(x))

    root = brentq(beam, 1.0, 1.8, xtol=1e-15)
    assert hose.eigenvalues(1e-9, 0.2, 1, mu=0.3)[0].imag == pytest.approx(root**2, rel=1e-9)


def test_weight_of_a_mass_at_the_end_of_the_galerkin_pipe_lowers_it_as_a_pendulum():
    # gamma and mu large: a string of little weight with a bob swings at sqrt(g/L)
    found = Pipe(40).eigenvalues(0.0, 0.2, 0.0, 100.0, 100.0)[0]
    assert abs(found.imag) == pytest.approx(10, rel=0.02)


SUPPORTED = {  # the first natural frequency at u = 0, 1, 2, 3 for beta = 0.2
    (1, 1): (9.8696044011, 9.3375314424, 7.5469402519, 2.8682688628),
    (2, 1): (15.4182057170, 15.0153953558, 13.7447292963, 11.3532537684),
    (2, 2): (22.3732854481, 22.0660768204, 21.1216934120, 19.4626743942),
}


@pytest.mark.parametrize("supports", SUPPORTED)
def test_natural_frequency_of_supported_pipes_falls_with_speed(supports):
    root, end = supports

    def exact(omega, u):
        p = np.roots([1, 0, u**2, 2 * np.sqrt(0.2) * u * 1j * omega, -(omega**2)])
        rows = [p**0, p if root == 2 else p**2, np.exp(p), (p if end == 2 else p**2) * np.exp(p)]
        return np.linalg.det(rows) / np.prod([p[j] - p[i] for i in range(4) for j in range(i + 1, 4)])

    for u, omega in enumerate(SUPPORTED[supports]):
        found = Pipe(16, root, end).eigenvalues(u, 0.2)
        assert np.abs(found - 1j * omega).min() < 2e-10
        assert np.abs(found[:8].real).max() < 1e-9
        assert abs(exact(omega, u)) < 1e-8 * abs(exact(omega + 0.5, u))


@pytest.mark.parametrize(
    ("supports", "u"), [((1, 1), hose.PINNED_PINNED), ((2, 1), hose.CLAMPED_PINNED), ((2, 2), hose.CLAMPED_CLAMPED)]
)
def test_supported_galerkin_pipes_buckle_at_the_closed_forms(supports, u):
    pipe = Pipe(16, *supports)
    assert np.abs(np.linalg.eigvals(pipe.matrices(u, 0.2)[0])).min() < 1e-8
    assert np.linalg.eigvals(pipe.matrices(u - 1e-3, 0.2)[0]).real.min() > 1e-3


# 2. the hose in a steady flow
@pytest.mark.parametrize(
    ("U", "tip"),
    [
        (0, (0.435384, -0.229892)),
        (3, (0.443159, -0.216109)),
        (6, (0.462751, -0.175513)),
        (9, (0.483430, -0.116218)),
        (12, (0.495223, -0.060137)),
    ],
)
def test_static_tips_of_the_scene(U, tip):
    assert static_shape(SCENE, U).tip == pytest.approx(tip, abs=1e-6)


@pytest.mark.parametrize(
    ("parameters", "U"),
    [
        (SCENE, 9.0),
        *studies((SCENE, 0.0), (replace(SCENE, strain="engineering", EA=1.0), 6.0)),
        *studies((replace(SCENE, angle=0.4, EA=0.5), 5.0), (LADEN, 0.0), (LADEN, 9.0)),
        (replace(LADEN, outlet=2.0, strain="engineering", EA=1.0, angle=0.3), 6.0),
    ],
)
def test_shooting_and_the_energy_of_polynomials_agree_on_the_static_shape(parameters, U):
    model = Hose(parameters, 18)
    assert model.tip(model.equilibrium(U)) == pytest.approx(static_shape(parameters, U).tip, abs=1e-10)


def test_free_end_has_no_moment_and_no_stretch_whatever_the_flow():
    for U in (0.0, 15.0):
        shape = static_shape(replace(SCENE, EA=1.0), U)
        assert (shape.moment[-1], shape.stretch[-1]) == (0, pytest.approx(1, abs=1e-14))


def test_moment_at_the_clamp_is_that_of_the_weight_and_of_the_jet():
    shape = static_shape(SCENE, 8.0, points=2001)
    jet = -SCENE.water * 8.0**2 * np.array([np.cos(shape.angle[-1]), np.sin(shape.angle[-1])])
    x, z = shape.tip
    # G is counterclockwise: it is what the part beyond does to the part before
    expected = -SCENE.weight * np.trapezoid(shape.x, shape.s) + x * jet[1] - z * jet[0]
    assert shape.moment[0] == pytest.approx(expected, rel=1e-5)


def test_a_stiff_hose_sags_as_a_beam():
    stiff = replace(SCENE, EJ=10.0, EA=1e6)
    assert static_shape(stiff).tip[1] == pytest.approx(-stiff.weight * stiff.length**4 / (8 * stiff.EJ), rel=1e-6)


def test_free_end_with_a_nozzle_is_compressed_by_its_thrust():
    p, U = replace(SCENE, outlet=2.0), 9.0
    stretch = static_shape(p, U).stretch[-1]
    # EA (stretch^2 - 1)/2 = -M U^2 (outlet - 1)
    assert (stretch**2 - 1) / 2 == pytest.approx(-p.water * U**2 / p.EA, rel=1e-12)


# 3. large motion
def some_state(model, seed=1):
    random, n = np.random.default_rng(seed), model.unknowns
    decay = np.tile(0.01 / (1 + np.arange(model.modes)) ** 3, model.dimension)
    return random.normal(size=n) * decay, random.normal(size=n) * 10 * decay


@pytest.mark.parametrize("strain", ["green", "engineering"])
@pytest.mark.parametrize(("kind", "smoothing"), [(Hose, 0.0), (Hose, 5.0), (SpatialHose, 0.0)])
def test_jacobian_is_the_derivative_of_the_acceleration(kind, strain, smoothing):
    model = kind(replace(LADEN, strain=strain, smoothing=smoothing, angle=0.3), 8)
    q, rate = some_state(model)
    n, state = model.unknowns, np.append(q, rate)

    def acceleration(y):
        return model.acceleration(y[:n], y[n:], 7.0, 3.0)

    h = 1e-7
    expected = np.column_stack(
        [(acceleration(state + e) - acceleration(state - e)) / (2 * h) for e in h * np.eye(2 * n)]
    )
    difference = model.jacobian(q, rate, 7.0, 3.0)[n:] - expected
    assert np.abs(difference).max() < 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize("kind", [Hose, SpatialHose])
@pytest.mark.parametrize("parameters", [SCENE, LADEN])
def test_power_is_that_of_dissipation_and_of_the_jet(kind, parameters):
    """d/dt (T + V - M U^2 int |r'|^2/2) = -D - M U |r_t|^2 - M U^2 outlet r' . r_t at the tip, for any motion."""
    U, M = 7.0, SCENE.water
    model = kind(replace(parameters, angle=0.3), 9)
    d = model.dimension
    q, rate = some_state(model)
    h = 1e-6
    acceleration = model.acceleration(q, rate, U)

    def energy(q, rate):
        slope = (model._at_points(q) + model.offset)[:d]
        return sum(model.energies(np.append(q, rate))[:3]) - M * U**2 / 2 * model.weights @ np.sum(slope**2, 0)

    change = (energy(q + h * rate, rate + h * acceleration) - energy(q - h * rate, rate - h * acceleration)) / (2 * h)
    velocity = model.tip_basis @ rate
    # r' at the tip by extrapolation of the polynomial through the Gauss points
    slope = (model._at_points(q) + model.offset)[:d]
    fit = [np.polynomial.Legendre.fit(model.s, component, 12, domain=[0, SCENE.length]) for component in slope]
    slope = np.array([f(SCENE.length) for f in fit])
    jet = M * U**2 * parameters.outlet * slope
    expected = -model.energies(np.append(q, rate))[3] - M * U * velocity @ velocity - jet @ velocity
    assert change == pytest.approx(expected, rel=1e-6)


def test_energy_is_conserved_without_flow_and_damping():
    model = Hose(replace(SCENE, damping=0.0), 8)
    history = simulate(model, 0.0, [0.0, 0.03, 0.06], 1e-8)
    total = [sum(model.energies(state)[:3]) for state in history.states]
    size = model.energies(history.states[-1])[0]
    assert total == pytest.approx([total[0]] * 3, abs=1e-6 * size)


def test_weightless_hose_turns_unstable_at_the_exact_critical_speed():
    model = Hose(replace(SCENE, gravity=0.0), 16)
    U, omega = model.critical_speed(12, 16, count=4)
    exact = hose.critical_speeds(SCENE.beta, SCENE.damping / SCENE.time, upto=8.0)[0]
    assert SCENE.dimensionless_speed(U) == pytest.approx(exact.u, rel=1e-9)
    assert omega * SCENE.time == pytest.approx(exact.omega, rel=1e-9)


@pytest.mark.parametrize(("mu", "jet"), [(0.0, 1.0), (0.3, 1.0), (0.2, 1.5)])
def test_hanging_hose_has_the_eigenvalues_of_the_hanging_pipe(mu, jet):
    hanging = replace(SCENE, angle=-np.pi / 2, EA=1e5, damping=1e-4, outlet=jet)
    hanging = replace(hanging, tip_mass=mu * (SCENE.mass + SCENE.water) * SCENE.length)
    gamma, U = hanging.weight * hanging.length**3 / hanging.EJ, 11.0
    dimensionless = hanging.dimensionless_speed(U), hanging.beta, hanging.damping / hanging.time, gamma, mu, jet
    pipe = Pipe(24).eigenvalues(*dimensionless)
    model = Hose(hanging, 14)
    for found in (model.eigenvalues(U), model.lateral_eigenvalues(U)):
        for value in pipe[:6]:
            assert np.abs(found * hanging.time - value).min() < 1e-4 * abs(value)


@pytest.mark.parametrize(("mu", "jet"), [(0.1, 1.0), (0.0, 1.5), (0.3, 2.0)])
def test_weightless_hose_with_mass_and_nozzle_turns_unstable_at_the_exact_critical_speed(mu, jet):
    stiff = replace(SCENE, gravity=0.0, EA=1e6, outlet=jet)
    stiff = replace(stiff, tip_mass=mu * (SCENE.mass + SCENE.water) * SCENE.length)
    exact = hose.critical_speeds(stiff.beta, stiff.damping / stiff.time, upto=5.0, mu=mu, jet=jet)[0]
    U, model = exact.u / stiff.dimensionless_speed(1.0), Hose(stiff, 14)
    for lateral in (False, True):
        found, omega = model.critical_speed(U - 0.3, U + 0.3, lateral, 2)
        assert found == pytest.approx(U, rel=1e-6)
        assert omega * stiff.time == pytest.approx(exact.omega, rel=1e-6)


@pytest.mark.parametrize("damped", [False, True])
def test_out_of_plane_a_straight_hose_is_the_pipe(damped):
    straight = replace(SCENE, gravity=0.0)
    found = Hose(straight, 18).lateral_eigenvalues(13.0, damped) * straight.time
    alpha = damped * straight.damping / straight.time
    for value in Pipe(32).eigenvalues(straight.dimensionless_speed(13.0), straight.beta, alpha)[:6]:
        assert np.abs(found - value).min() < 1e-8 * abs(value)


def test_out_of_plane_stiffness_is_the_second_difference_of_the_energy_in_space():
    model = Hose(SCENE, 8)
    n, h = model.modes, 1e-5
    plane = model._at_points(model.equilibrium(4.0)[: 2 * n]) + model.offset
    lateral = np.random.default_rng(3).normal(size=n) / (1 + np.arange(n)) ** 3
    slope, bend = model.B[1][:, n:] @ lateral, model.B[3][:, n:] @ lateral

    def energy(size):
        first = np.array([plane[0], size * slope, plane[1]])
        second = np.array([plane[2], size * bend, plane[3]])
        square = np.sum(first**2, 0)
        curvature2 = np.sum(np.cross(first.T, second.T) ** 2, -1) / square**3
        return model.weights @ (SCENE.EA * (square - 1) ** 2 / 8 + SCENE.EJ * curvature2 / 2)

    expected = 2 * (energy(h) - energy(0)) / h**2 / model.rho
    stiffness = model.lateral_matrices(4.0)[0] - 4.0**2 * model.centrifugal[n:, n:]
    assert lateral @ stiffness @ lateral == pytest.approx(expected, rel=2e-6)


def test_small_motion_about_the_static_shape_follows_the_eigenvalues():
    model, U = Hose(SCENE, 10), 12.0
    rest, n = model.equilibrium(U), 2 * model.modes
    values, vectors = np.linalg.eig(model.jacobian(rest[:n], rest[n:], U))
    at = np.argmax(np.where(values.imag > 0, values.real, -np.inf))
    size = 1e-6 / np.abs(vectors[:n, at]).max()
    history = simulate(model, U, [0.1], 1e-9, start=rest + size * vectors[:, at].real)
    expected = size * (np.exp(values[at] * 0.1) * vectors[:, at]).real
    assert history.states[0][:n] - rest[:n] == pytest.approx(expected[:n], abs=1e-3 * np.abs(expected[:n]).max())


def test_accelerating_flow_pushes_a_straight_hose_back():
    straight = replace(SCENE, gravity=0.0)
    tip = simulate(Hose(straight, 6), lambda t: (0.0, 1.0), [1.0], 1e-8).tip[0]
    assert tip[0] - SCENE.length == pytest.approx(-SCENE.water * SCENE.length**2 / (2 * SCENE.EA), rel=1e-4)


def test_tip_of_the_scene_in_the_file_is_what_fewer_modes_give():
    with open(hose.HERE / "hose_tip.csv") as file:
        rows = np.array([[float(cell) for cell in row.values()] for row in csv.DictReader(file)])
    times = rows[:26, 0]
    history = simulate(Hose(SCENE, 16), 15.0, times, 1e-6)
    assert history.tip == pytest.approx(rows[:26, 1:3], abs=1e-6)
    assert history.tip_velocity == pytest.approx(rows[:26, 3:5], abs=1e-4)
    smooth = simulate(Hose(replace(SCENE, smoothing=0.2), 16), 15.0, times, 1e-5)
    assert smooth.tip == pytest.approx(rows[:26, 5:7], abs=2e-5)


@pytest.fixture(scope="module")
def cycles():
    return json.loads((hose.HERE / "hose_cycles.json").read_text())


def test_cycle_at_15_metres_per_second_in_the_file_is_what_fewer_modes_give(cycles):
    found = hose.limit_cycle(Hose(SCENE, 12), 15.0, 2.5, 1e-4, 1e-3)
    for name in ("frequency", "z_range", "z_mean", "x_range", "x_mean", "tip_speed"):
        assert getattr(found, name) == pytest.approx(cycles["cycles"]["15"][name], rel=2e-3), name


def test_motions_in_the_file_are_periodic_and_converged(cycles):
    for U, cycle in cycles["cycles"].items():
        assert cycle["scatter_of_period"] < 1e-5, U
        assert cycle["drift"] < 1e-5, U
        for name in ("frequency", "z_range", "x_range", "x_mean", "tip_speed"):
            assert cycle[name] == pytest.approx(cycles["cycles_coarser"][U][name], rel=5e-4), (U, name)


def test_critical_speeds_in_the_file_are_recomputed(cycles):
    model = Hose(SCENE, 16)
    for name, lateral, damped in (
        ("in_plane", False, True),
        ("out_of_plane", True, False),
        ("out_of_plane_damped", True, True),
    ):
        found = model.critical_speed(13, 14.2, lateral, 2, damped)
        assert found == pytest.approx(cycles["critical"][name], rel=1e-6)


def test_dissipation_smoothed_at_zero_curvature_lowers_the_critical_speed(cycles):
    critical = cycles["critical"]
    assert critical["out_of_plane"][0] < critical["in_plane_smoothed"][0] < critical["in_plane"][0]


# 4. large motion in space
def curvature_vector(a, b):
    square = np.sum(a * a, 0)
    return (b - np.sum(a * b, 0) * a / square) / square


def test_out_of_plane_the_curvature_vector_turns_with_the_second_derivative_of_the_velocity():
    """(1 - t t^T) dc/dt is (v-dot'/|r'|)'/|r'| across the plane of a static shape stretched unevenly, nothing in it."""
    s, h = np.linspace(0.1, 0.9, 5), 1e-6

    def shape(s):  # r' and r'' of a planar curve
        stretch, turn, dstretch, dturn = 1 + 0.2 * np.sin(3 * s), s + 0.7 * s**2, 0.6 * np.cos(3 * s), 1 + 1.4 * s
        tangent, normal = (
            np.array([f(turn), 0 * s, g(turn)]) for f, g in ((np.cos, np.sin), (lambda x: -np.sin(x), np.cos))
        )
        return stretch * tangent, dstretch * tangent + stretch * dturn * normal

    def lateral(s):  # v-dot' and v-dot''
        return 2 * s + np.cos(2 * s), 2 - 2 * np.sin(2 * s)

    a, b = shape(s)
    out = np.array([[0.0], [1.0], [0.0]])
    da, db = (part * out for part in lateral(s))
    rate = (curvature_vector(a + h * da, b + h * db) - curvature_vector(a - h * da, b - h * db)) / (2 * h)
    tangent = a / np.linalg.norm(a, axis=0)
    rate = rate - tangent * np.sum(tangent * rate, 0)

    def quotient(s):
        return lateral(s)[0] / np.linalg.norm(shape(s)[0], axis=0)

    expected = (quotient(s + h) - quotient(s - h)) / (2 * h) / np.linalg.norm(a, axis=0)
    assert rate[1] == pytest.approx(expected, rel=1e-7)
    assert rate[[0, 2]] == pytest.approx(np.zeros((2, 5)), abs=1e-8)


def test_turning_of_the_curvature_in_space_is_its_definition():
    model = SpatialHose(SCENE, 8)
    q, rate = some_state(model)
    p, v, h = model._at_points(q) + model.offset, model._at_points(rate), 1e-6
    ahead, behind = (curvature_vector(p[:3] + k * v[:3], p[3:] + k * v[3:]) for k in (h, -h))
    change, tangent = (ahead - behind) / (2 * h), p[:3] / np.linalg.norm(p[:3], axis=0)
    change = change - tangent * np.sum(tangent * change, 0)
    assert model._turning(p, v) == pytest.approx(change, abs=1e-7 * np.abs(change).max())


def test_in_the_plane_the_hose_in_space_is_the_planar_one():
    flat, model = Hose(LADEN, 10), SpatialHose(LADEN, 10)
    times = [0.0, 0.1, 0.25]
    planar, spatial = (simulate(m, 12.0, times, 1e-7, tip_rate=1.0) for m in (flat, model))
    assert spatial.tip[:, [0, 2]] == pytest.approx(planar.tip, abs=1e-9)
    assert np.all(spatial.tip[:, 1] == 0)


@pytest.mark.parametrize("parameters", [SCENE, replace(LADEN, angle=0.3)])
def test_small_motion_in_space_is_that_in_the_plane_and_that_out_of_it(parameters):
    flat, U = Hose(parameters, 10), 11.0
    apart = np.append(flat.eigenvalues(U), flat.lateral_eigenvalues(U))
    found = SpatialHose(parameters, 10).eigenvalues(U)
    slow = found[np.abs(found) < 3000]
    # Of each plane a pair for each of its lowest shapes.
    assert slow.size >= 8
    for value in slow:
        assert np.abs(apart - value).min() < 1e-9 * abs(value)


@pytest.mark.study
def test_turning_a_hose_in_space_about_the_vertical_changes_nothing():
    """Straight down, a push across and one out of the plane are the same, and so is the circular motion of both."""
    model = SpatialHose(replace(SCENE, angle=-np.pi / 2), 8)
    one = simulate(model, 12.0, [0.2], 1e-9, tip_rate=0.5).tip[0]
    other = simulate(model, 12.0, [0.2], 1e-9, lateral_rate=0.5).tip[0]
    both = simulate(model, 12.0, [0.2], 1e-9, tip_rate=0.3, lateral_rate=0.4).tip[0]
    assert (other[2], other[1]) == (pytest.approx(one[2], abs=1e-10), pytest.approx(one[0], abs=1e-10))
    assert both == pytest.approx([0.6 * one[0], 0.8 * one[0], one[2]], abs=1e-10)


@pytest.fixture(scope="module")
def space():
    return json.loads((hose.HERE / "hose_space.json").read_text())


def test_tip_in_space_in_the_file_is_converged_and_what_fewer_modes_give(space):
    tips = {modes: np.array(tip) for modes, tip in space["tip"].items()}
    assert tips["18"] == pytest.approx(tips["22"], abs=1e-7)
    assert tips["14"] == pytest.approx(tips["22"], abs=5e-6)
    history = simulate(SpatialHose(SCENE, 12), space["speed"], space["times"], 1e-6, lateral_rate=space["lateral_rate"])
    assert history.tip == pytest.approx(tips["22"], abs=5e-5)
    assert space["critical_out_of_plane"] == pytest.approx(Hose(SCENE, 16).critical_speed(13.5, 14, True, 2), rel=1e-7)


def test_settled_motion_in_space_is_a_rotation_as_the_planar_cycle_is_unstable(space):
    fine, coarse = space["rotation"]["18"], space["rotation"]["10"]
    assert fine["scatter_of_period"] < 1e-5
    assert fine["frequency"] == pytest.approx(coarse["frequency"], rel=1e-3)
    assert fine["ranges"] == pytest.approx(coarse["ranges"], rel=5e-3)
    assert min(fine["ranges"][1:]) > 0.2
    # the tip of an ellipse of these axes sweeps with pi/2 ab f
    swept = np.pi / 2 * fine["ranges"][1] * fine["ranges"][2] * fine["frequency"]
    assert fine["spin"] == pytest.approx(swept, rel=0.05)
    assert np.hypot(*space["planar_cycle"]["lateral_multipliers"][0]) > 1.05


@pytest.mark.study
def test_growth_out_of_the_planar_cycle_in_the_file_is_what_fewer_modes_give(space):
    multipliers, period = hose.lateral_multipliers(SCENE, 15.0, 9, 3.0, 10, 5, 1e-4, 1e-2)
    assert np.log(np.abs(multipliers).max()) / period == pytest.approx(space["planar_cycle"]["growth_rate"], rel=0.02)


# 5. hoses of several pieces
HALF = Piece(0.25, 0.00108, 0.0031316, 0.0007854)


def test_a_hose_of_equal_pieces_turns_unstable_at_the_exact_critical_speed():
    exact = hose.critical_speeds(SCENE.beta, upto=7.0)[0]
    for pieces in ([HALF] * 2, [replace(HALF, length=0.1), replace(HALF, length=0.4)]):
        U, omega = PiecewisePipe(pieces, 12).critical_speed(10, 15, 8)
        assert SCENE.dimensionless_speed(U) == pytest.approx(exact.u, rel=1e-9)
        assert omega * SCENE.time == pytest.approx(exact.omega, rel=1e-8)


def test_a_hose_of_equal_pieces_with_mass_and_nozzle_has_the_exact_eigenvalues():
    mu, jet, U = 0.3, 1.5, 4.0
    pieces = [replace(HALF, damping=SCENE.damping)] * 2
    pipe = PiecewisePipe(pieces, 12, jet, mu * (HALF.mass + HALF.water) * SCENE.length)
    alpha = SCENE.damping / SCENE.time
    exact = Pipe(24).eigenvalues(SCENE.dimensionless_speed(U), SCENE.beta, alpha, mu=mu, jet=jet)
    for value in exact[:6]:
        assert np.abs(pipe.eigenvalues(U) * SCENE.time - value).min() < 1e-8 * abs(value)


@pytest.mark.parametrize(
    ("water", "U", "omega"), [(1.0, 12.3865733974, 26.9213491493), (0.5, 6.8684356467, 27.5895324124)]
)
def test_two_pieces_turn_unstable_where_the_boundary_determinant_vanishes(water, U, omega):
    """The second half softer and lighter, also narrower: twice the speed and a force on the joint."""
    pieces = [HALF, Piece(0.25, 0.00054, 0.0025, water * HALF.water)]
    assert PiecewisePipe(pieces, 12).critical_speed(5, 15, 10) == pytest.approx((U, omega), abs=2e-8)

    def least(speed, omega):
        """Least singular value of the equations at clamp, joint and end for the exponentials in both pieces."""
        flow, lam = HALF.water * speed, 1j * omega
        jump = flow * (flow / pieces[1].water - speed)
        axial = [-jump, 0.0]
        rows, columns = np.zeros((8, 8), dtype=complex), []
        for piece, N in zip(pieces, axial, strict=True):
            rho = piece.mass + piece.water
            p = np.roots([piece.EJ, 0, flow**2 / piece.water - N, 2 * flow * lam, rho * lam**2])
            ends = [[p**k * np.exp(p * s) for k in range(4)] for s in (0, piece.length)]
            columns.append(ends)
        (a0, a1), (b0, b1) = columns
        rows[:2, :4], rows[6:, 4:] = a0[:2], b1[2:]
        rows[2:4, :4], rows[2:4, 4:] = a1[:2], [-b0[0], -b0[1]]
        rows[4, :4], rows[4, 4:] = pieces[0].EJ * a1[2], -pieces[1].EJ * b0[2]
        # lateral force -EJ w^(3) + N w': beyond the joint minus before it, and the force on the joint
        rows[5, :4] = -(axial[0] * a1[1] - pieces[0].EJ * a1[3]) - jump * a1[1]
        rows[5, 4:] = axial[1] * b0[1] - pieces[1].EJ * b0[3]
        rows /= np.linalg.norm(rows, axis=1)[:, None]
        return np.linalg.svd(rows / np.linalg.norm(rows, axis=0), compute_uv=False)[-1]

    assert least(U, omega) < 1e-7 * least(U + 0.5, omega)
