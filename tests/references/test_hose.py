"""Self-tests of the references for pipes conveying fluid: other methods, limits, balances, published values."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from . import hose
from .hose import Hose, Parameters, Pipe, simulate, static_shape

SCENE = Parameters()


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


@pytest.mark.parametrize(("beta", "u", "omega"), [(0.2, 5.59, 13.7), (0.5, 9.32, 26.5), (0.1, 4.75, 14.2)])
def test_first_crossing_is_where_gregory_and_paidoussis_have_it(beta, u, omega):
    first = hose.critical_speeds(beta, upto=10.0)[0]
    assert (first.u, first.omega) == (pytest.approx(u, abs=0.01), pytest.approx(omega, abs=0.1))
    assert first.becomes == "unstable"


@pytest.mark.parametrize("beta", [0.2, 0.9])
def test_crossings_account_for_every_unstable_eigenvalue(beta):
    crossings, pipe = hose.critical_speeds(beta), Pipe(40)
    for u in np.arange(1.25, 18, 2.0):
        found = pipe.eigenvalues(u, beta)
        unstable = np.sum(found[np.abs(found) < 2000].real > 1e-9)
        passed = sum(1 if c.becomes == "unstable" else -1 for c in crossings if c.u < u)
        assert unstable == 2 * passed, u


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


def test_the_least_coriolis_force_destabilises_becks_column():
    first = hose.critical_speeds(0.01, upto=6.0)[0]
    assert first.u < 4.3 < np.sqrt(20.05)


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
        (SCENE, 0.0),
        (SCENE, 9.0),
        (replace(SCENE, strain="engineering", EA=1.0), 6.0),
        (replace(SCENE, angle=0.4, EA=0.5), 5.0),
    ],
)
def test_shooting_and_the_energy_of_polynomials_agree_on_the_static_shape(parameters, U):
    model = Hose(parameters, 18)
    assert model.tip(model.equilibrium(U)) == pytest.approx(static_shape(parameters, U).tip, abs=1e-10)


def test_free_end_has_no_moment_and_no_stretch_whatever_the_flow():
    for U in (0.0, 9.0, 15.0):
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


# 3. large motion
def some_state(model, seed=1):
    random, n = np.random.default_rng(seed), model.modes
    decay = np.tile(0.01 / (1 + np.arange(n)) ** 3, 2)
    return random.normal(size=2 * n) * decay, random.normal(size=2 * n) * 10 * decay


@pytest.mark.parametrize("strain", ["green", "engineering"])
@pytest.mark.parametrize("smoothing", [0.0, 5.0])
def test_jacobian_is_the_derivative_of_the_acceleration(strain, smoothing):
    model = Hose(replace(SCENE, strain=strain, smoothing=smoothing, angle=0.3), 8)
    q, rate = some_state(model)
    n, state = 2 * model.modes, np.append(q, rate)

    def acceleration(y):
        return model.acceleration(y[:n], y[n:], 7.0, 3.0)

    h = 1e-7
    expected = np.column_stack(
        [(acceleration(state + e) - acceleration(state - e)) / (2 * h) for e in h * np.eye(2 * n)]
    )
    difference = model.jacobian(q, rate, 7.0, 3.0)[n:] - expected
    assert np.abs(difference).max() < 1e-6 * np.abs(expected).max()


def test_power_is_that_of_dissipation_and_of_the_jet():
    """d/dt (T + V - M U^2 int |r'|^2/2) = -D - M U |r_t|^2 - M U^2 r' . r_t at the tip, for any motion."""
    U, M = 7.0, SCENE.water
    model = Hose(replace(SCENE, angle=0.3), 9)
    q, rate = some_state(model)
    h = 1e-6
    acceleration = model.acceleration(q, rate, U)

    def energy(q, rate):
        slope = (model._at_points(q) + model.offset)[:2]
        return sum(model.energies(np.append(q, rate))[:3]) - M * U**2 / 2 * model.weights @ np.sum(slope**2, 0)

    change = (energy(q + h * rate, rate + h * acceleration) - energy(q - h * rate, rate - h * acceleration)) / (2 * h)
    velocity = model.tip_basis @ rate
    # r' at the tip by extrapolation of the polynomial through the Gauss points
    slope = (model._at_points(q) + model.offset)[:2]
    fit = [np.polynomial.Legendre.fit(model.s, component, 12, domain=[0, SCENE.length]) for component in slope]
    slope = np.array([f(SCENE.length) for f in fit])
    expected = -model.energies(np.append(q, rate))[3] - M * U * velocity @ velocity - M * U**2 * slope @ velocity
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


def test_hanging_hose_has_the_eigenvalues_of_the_hanging_pipe():
    hanging = replace(SCENE, angle=-np.pi / 2, EA=1e5, damping=1e-4)
    gamma = hanging.weight * hanging.length**3 / hanging.EJ
    pipe = Pipe(24).eigenvalues(hanging.dimensionless_speed(11.0), hanging.beta, hanging.damping / hanging.time, gamma)
    found = Hose(hanging, 14).eigenvalues(11.0) * hanging.time
    for value in pipe[:6]:
        assert np.abs(found - value).min() < 1e-5 * abs(value)


def test_out_of_plane_a_straight_hose_is_the_undamped_pipe():
    straight = replace(SCENE, gravity=0.0)
    found = Hose(straight, 18).lateral_eigenvalues(13.0, damped=False) * straight.time
    for value in hose.eigenvalues(straight.dimensionless_speed(13.0), straight.beta, 3):
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
    found = hose.limit_cycle(Hose(SCENE, 12), 15.0, 4.0, 1e-4, 1e-3)
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
