"""Self-tests of the reference solutions: closed forms, other methods, and the numbers of docs/lumped_string.md."""

import itertools

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid

from references import extensible_rod as rod
from references import planar_well_dynamics as planar
from references import soft_string as soft
from references import stepped_rod_modes as modes

HISTORY = planar.history()


# soft string
@pytest.mark.parametrize("direction", ["pick_up", "slack_off", "rotating"])
def test_hook_load_in_a_slant_hole_is_the_closed_form(direction):
    well = soft.well_from_angles(lambda s: 0.7, lambda s: 0.3, 1500.0)
    string = soft.String([(1500.0, 0.127, 0.1086)])
    exact = soft.slant_hook_load(string.weight(0.127, 0.1086), 1500.0, 0.7, 0.25, direction)
    assert soft.hook_load(well, string, 0.25, direction) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("mu", [0.2, 0.3])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off", "rotating"])
def test_hook_load_in_the_jwell_is_the_closed_form(mu, direction):
    well, string = soft.jwell()
    assert soft.hook_load(well, string, mu, direction) == pytest.approx(soft.jwell_hook_load(mu, direction), rel=1e-8)


def test_jwell_numbers_stay():
    well, string = soft.jwell()
    assert soft.hook_load(well, string, 0.2, "pick_up") == pytest.approx(748587.758, abs=0.01)
    assert soft.hook_load(well, string, 0.2, "slack_off") == pytest.approx(583902.247, abs=0.01)
    assert soft.hook_load(well, string, 0.0, "rotating") == pytest.approx(668394.381, abs=0.01)
    assert soft.rotating_torque(well, string, 0.2) == pytest.approx(5919.877, abs=0.01)


def test_rotating_hook_load_is_the_weight_times_the_vertical_extent_in_any_well():
    well = soft.well_from_survey([0, 300, 800, 1500], [0.0, 0.4, 1.1, 0.9], [0.0, 1.0, 2.5, 4.0])
    string = soft.String([(1500.0, 0.127, 0.1086)])
    x, weights = np.polynomial.legendre.leggauss(20)
    depth = sum(
        0.5 * (b - a) * weights @ [well.tangent(s)[2] for s in 0.5 * (a + b) + 0.5 * (b - a) * x]
        for a, b in itertools.pairwise([0, 300, 800, 1500])
    )
    w = string.weight(0.127, 0.1086)
    assert soft.hook_load(well, string, 0.3, "rotating") == pytest.approx(w * depth, rel=1e-7)


def test_drag_in_a_horizontal_turn_is_w_r_sinh_of_mu_times_the_turned_angle():
    well = soft.well_from_angles(lambda s: np.pi / 2, lambda s: s / 500.0, 500.0)
    string = soft.String([(500.0, 0.127, 0.1086)])
    # T' = -mu sqrt((T/R)^2 + w^2)
    exact = string.weight(0.127, 0.1086) * 500.0 * np.sinh(0.3)
    assert soft.hook_load(well, string, 0.3, "pick_up") == pytest.approx(exact, rel=1e-7)


def test_clearance_changes_the_hook_load_by_the_order_of_curvature_times_clearance():
    well, string = soft.jwell()
    plain, offset = (soft.hook_load(well, string, 0.2, "pick_up", hole=h) for h in (None, 0.2032))
    assert 0 < abs(offset / plain - 1) < 4e-5


# extensible rod
@pytest.mark.parametrize(
    ("case", "sag", "sag_at", "end", "y440"),
    [
        ("A", -3.278958, 506.7, None, -3.209892),
        ("B", -233.5539, 506.0, -149.31423, None),
        ("C", -24.735459, 532.0, 0.108223, -23.994371),
    ],
)
def test_rod_with_the_second_moments_of_the_table_gives_the_numbers_of_section_10(case, sag, sag_at, end, y440):
    shape = rod.solve(case)
    assert shape.sag == pytest.approx(sag, rel=3e-7)
    assert shape.sag_at == pytest.approx(sag_at, abs=0.05)
    assert end is None or shape.end_displacement == pytest.approx(end, abs=6e-6)
    assert y440 is None or shape.at(440.0)[1] == pytest.approx(y440, abs=6e-7)


def test_rod_with_the_second_moments_of_od_and_id_sags_less_in_a_and_b_and_the_same_in_c():
    ratio = {c: rod.solve(c, rod.OD_ID_I).sag / rod.solve(c).sag for c in "ABC"}
    assert ratio["A"] == pytest.approx(0.999689, abs=1e-6)
    assert ratio["B"] == pytest.approx(0.999827, abs=1e-6)
    assert ratio["C"] == pytest.approx(1.0, abs=1e-8)


def test_sag_of_a_is_the_linear_beam_less_a_part_in_ten_thousand():
    s = np.linspace(0, 1000, 200001)
    w = np.where(s < 880, *(rod.DENSITY * rod.area(*x[1:]) * 9.81e-6 for x in rod.SECTIONS))
    load = cumulative_trapezoid(w, s, initial=0)
    moment = cumulative_trapezoid(load, s, initial=0)
    moment = moment[-1] * s / 1000 - moment
    slope = cumulative_trapezoid(moment / (rod.E * np.where(s < 880, *rod.TABLE_I)), s, initial=0)
    y = cumulative_trapezoid(slope, s, initial=0)
    y -= y[-1] * s / 1000
    assert y.min() == pytest.approx(-3.279138, abs=2e-5)
    assert 0 < rod.solve("A").sag - y.min() < 3e-4


def test_hanging_string_stretches_by_0_376529_m():
    assert rod.hanging_elongation() == pytest.approx(0.376529, abs=5e-7)


# stepped rod modes
@pytest.mark.parametrize("string", [modes.TABLE_2_3, modes.JWELL])
def test_modes_are_all_the_sign_changes_of_the_determinant(string):
    for kind in (modes.axial, modes.torsional):
        found = 2 * np.pi * kind(string, 40)
        (l1, od1, id1), (l2, od2, id2) = string
        power = 2 if kind is modes.axial else 4
        z1, z2 = od1**power - id1**power, od2**power - id2**power
        c = np.sqrt((modes.E if kind is modes.axial else modes.G) / modes.DENSITY)
        w = np.linspace(0, 0.5 * (found[-1] + kind(string, 41)[-1] * 2 * np.pi), 100001)
        f = z1 * np.cos(w * l1 / c) * np.cos(w * l2 / c) - z2 * np.sin(w * l1 / c) * np.sin(w * l2 / c)
        crossed = w[1:][np.sign(f[1:]) != np.sign(f[:-1])]
        assert len(crossed) == 40
        assert np.abs(crossed - found).max() <= w[1]


def test_a_uniform_string_has_the_odd_quarter_waves():
    f = modes.frequencies((700.0, 300.0), (6e8, 6e8), (25.0, 25.0))
    assert f == pytest.approx((2 * np.arange(5) + 1) / 4 * np.sqrt(6e8 / 25.0) / 1000.0, rel=1e-12)


# planar lumped string in the J-well
def energy(s, u, link):
    """Elastic energy of the planar string, written again and plainly."""
    k = np.where(s > planar.KICK_OFF, 1 / planar.RADIUS, 0.0)
    phi = k * (s - planar.KICK_OFF)
    d = np.array([np.diff(s) - np.diff(phi) * (u[1:] + u[:-1]) / 2, np.diff(u)])
    l = np.hypot(*d)
    kv = np.diff(d / l, axis=1) + np.array([0 * phi[1:-1], (phi[2:] - phi[:-2]) / 2])
    stretch = link[:, planar.EA] / link[:, planar.L0] * (l - link[:, planar.L0]) ** 2
    return (stretch.sum() + (link[1:, planar.EI] / link[1:, planar.LB] * (kv**2).sum(0)).sum()) / 2


def test_elastic_forces_are_the_gradient_of_the_energy():
    body, link = planar.jwell()
    link[:, planar.EI] *= 1e4  # make bending matter
    y, _ = planar.static_start(body, link)
    rng = np.random.default_rng(1)
    q = np.concatenate([[0.0], y[0], [0.0], y[1]]) + rng.uniform(-0.02, 0.02, 26)
    forces = np.concatenate(planar.elastic_forces(q[:13], q[13:], link)[:2])
    h = 1e-3 * np.eye(26)
    slope = [(energy(*(q + e).reshape(2, 13), link) - energy(*(q - e).reshape(2, 13), link)) / 2e-3 for e in h]
    assert np.abs(forces + slope).max() < 1e-6 * np.abs(forces).max()


def test_static_start_balances_and_is_the_one_of_the_stored_history():
    y, residual = planar.static_start(*planar.jwell())
    stored = [line.split() for line in planar.CSV.read_text().splitlines() if line.startswith("#   body")]
    assert residual < 1e-4
    assert [float(x[5]) for x in stored] == pytest.approx(y[0], abs=2e-9)
    assert [float(x[9]) for x in stored] == pytest.approx(y[1], abs=2e-9)


# Its loop over events takes five seconds to compile; the other method below notices an error of 0.1 mm.
@pytest.mark.study
def test_event_accurate_run_reproduces_the_stored_history_at_ten_times_the_step():
    run = planar.run(h=1e-3)
    assert np.abs(run[:, 13] - run[0, 13] - HISTORY["bit_displacement"]).max() < 1e-6


def test_moreau_stepping_converges_to_the_stored_history_at_first_order():
    error = []
    for h in (4e-4, 2e-4):
        run = planar.run(h, method="moreau")
        error.append(np.abs(run[:, 13] - run[0, 13] - HISTORY["bit_displacement"]).max())
    assert error[1] < 2e-4
    assert error[0] / error[1] == pytest.approx(2.0, abs=0.3)
