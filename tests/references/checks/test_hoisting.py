"""Self-tests of the axial rope of changing length: waves in closed form, finite elements, balances, convergence."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from of_the_suite import studies
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from references import crane, hoisting
from references.hoisting import CASES, LOWERING, Hoist, lobatto


def test_mesh_differentiates_and_integrates_polynomials():
    x, W, D = lobatto(9)
    assert D @ x**8 == pytest.approx(8 * x**7, abs=1e-12)
    assert W @ x**15 == pytest.approx(1 / 16, rel=1e-13)


def test_rest_is_the_static_rope():
    hoist = Hoist()
    y, x = hoist.rest(), hoist.mesh[0]
    at = hoist.strain(0.0, y)
    weight = (5000 + 6.5 * 25 * x) * 9.81
    assert hoist.tension(at.e, at.rate) == pytest.approx(weight, rel=1e-10)
    X, V = leggauss(20)
    stretch = crane.stretch_under((5000 + 6.5 * 25 * (1 + X) / 2) * 9.81, 8e7)
    assert y[0] == pytest.approx(25 * V @ (stretch - 1) / 2, rel=1e-12)


def test_small_vibration_is_that_of_the_bar_with_end_mass():
    hoist = Hoist(damping=0.0, speed=0.0, gravity=0.0, nodes=20)
    eigenvalues = np.linalg.eigvals(hoist.jacobian(0.0, hoist.rest()))
    found = np.sort(eigenvalues.imag[eigenvalues.imag > 0])[:4] / (2 * np.pi)
    assert found == pytest.approx(crane.bar_frequencies(8e7, 6.5, 25.0, 5000.0), rel=1e-9)


@pytest.mark.parametrize("green", [1.0, 0.0])
def test_jacobian_is_the_derivative(green):
    hoist = Hoist(nodes=8, green=green)
    y = hoist.rest() + 1e-3 * np.random.default_rng(1).normal(size=14)
    exact, size = hoist.jacobian(0.6, y), 1e-7
    columns = [(hoist.slope(0.6, y + size * e) - hoist.slope(0.6, y - size * e)) / (2 * size) for e in np.eye(14)]
    assert exact == pytest.approx(np.array(columns).T, rel=1e-5, abs=1e-4 * np.abs(exact).max() * 1e-3)


# the fall by d'Alembert's waves
def waves(hoist, end, step):
    """Linear undamped fall: waves F (upwards) and Q (downwards) of velocity beside the rope at rest of every length.

    x = x_rest(s) + f(t - s/c) + q(t + s/c), x_rest = -s - (M g s + rho g s^2/2)/EA.  Payload: P = F + Q,
    M P' = Z (2 Q - P), Z = sqrt(EA rho).  Drum point x(l) = 0 differentiated: with l, l' at the time t,
    Q(t + l/c) (1 + l'/c) = l' (1 + (M g + rho g l)/EA) - F(t - l/c) (1 - l'/c).

    Returns
    -------
    times of the payload, P, tension of the hook; times of the drum, its tension
    """
    EA, rho, M, g = hoist.axial_stiffness, hoist.mass_per_length, hoist.mass, hoist.gravity
    c, Z = np.sqrt(EA / rho), np.sqrt(EA * rho)
    tau = np.arange(round(end / step) + 1) * step
    t = tau - hoist.length / c  # when the wave left the drum that is at the payload at tau
    for _ in range(30):
        l, v, _ = hoist.feed(t)
        t = t - (t + l / c - tau) / (1 + v / c)
    l, v, _ = hoist.feed(t)
    push, back = np.where(t > 0, v * (1 + (M * g + rho * g * l) / EA), 0.0), t - l / c
    F, Q, P = np.zeros((3, len(tau)))
    X, W = leggauss(4)
    i = 0
    while i < len(tau) - 1:
        # as far as the waves that went up are known
        j = min(max(int(np.searchsorted(back, tau[i], side="right")) - 1, i + 1), len(tau) - 1)
        near = slice(max(int(np.searchsorted(tau, back[i + 1])) - 6, 0), i + 1)
        earlier = CubicSpline(tau[near], F[near])(back[i + 1 : j + 1]) if i > 4 else np.zeros(j - i)
        earlier = np.where(back[i + 1 : j + 1] > 0, earlier, 0.0)
        Q[i + 1 : j + 1] = (push[i + 1 : j + 1] - earlier * (1 - v / c)[i + 1 : j + 1]) / (1 + v / c)[i + 1 : j + 1]
        wave = CubicSpline(tau[max(i - 6, 0) : j + 1], Q[max(i - 6, 0) : j + 1])
        points = (tau[i:j, None] + tau[i + 1 : j + 1, None]) / 2 + step / 2 * X
        gain = step / 2 * np.exp(-Z / M * (tau[i + 1 : j + 1, None] - points)) * 2 * Z / M * wave(points) @ W
        for k in range(i, j):
            P[k + 1] = np.exp(-Z / M * step) * P[k] + gain[k - i]
        F[i + 1 : j + 1] = P[i + 1 : j + 1] - Q[i + 1 : j + 1]
        i = j
    returned = np.where(back > 0, CubicSpline(tau, F)(np.maximum(back, 0)), 0.0)
    return tau, P, M * g - Z * (Q - F), t, M * g + rho * g * l - Z * (Q - returned)


@pytest.mark.parametrize(
    ("hoist", "end"),
    [
        *studies((Hoist(damping=0.0, green=0.0, length=100.0, speed=-30.0, nodes=12), 3.0)),  # to 25 m
        (replace(LOWERING, damping=0.0, green=0.0, nodes=32), 6.0),
    ],
)
def test_linear_fall_is_the_sum_of_its_waves(hoist, end):
    tau, P, hook, t, drum = waves(hoist, end, 1e-3 if hoist.length > 1e3 else 1e-4)
    solution = hoist.solve(end, 1e-9)
    some = slice(len(tau) // 50, None, len(tau) // 50)
    history = hoist.history(solution, tau[some])
    assert history["velocity"] == pytest.approx(P[some], abs=2e-6 * np.abs(P).max())
    assert history["hook"] == pytest.approx(hook[some], abs=1e-5 * np.abs(hook).max())
    inside = t[some] > 0
    history = hoist.history(solution, t[some][inside])
    assert history["drum"] == pytest.approx(drum[some][inside], abs=1e-5 * np.abs(drum).max())


# balances
@pytest.mark.parametrize(("hoist", "end"), [(replace(LOWERING, nodes=16), 4.0), *studies((Hoist(nodes=12), 2.0))])
def test_energy_is_what_the_drum_gives_less_what_damping_takes(hoist, end):
    solution = hoist.solve(end, 1e-8)
    X, W = leggauss(6)
    edges = np.linspace(0, end, 401)
    work = heat = 0.0
    for low, high in pairwise(edges):
        for x, w in zip(X, W, strict=True):
            t = (low + high) / 2 + (high - low) / 2 * x
            *_, power, loss = hoist.energies(t, solution.sol(t))
            work, heat = work + w * (high - low) / 2 * power, heat + w * (high - low) / 2 * loss
    first, last = (np.array(hoist.energies(t, solution.sol(t))[:3]) for t in (0.0, end))
    assert last.sum() - first.sum() == pytest.approx(work - heat, abs=1e-4 * heat)


# load loss by linear elements that do not move
def elements(hoist, count, times):
    """Drum tension of linear Lagrangian elements with lumped mass at l constant; second order."""
    h, EA, c = hoist.length / count, hoist.axial_stiffness, hoist.damping
    mass = np.full(count, hoist.mass_per_length * h)
    mass[0] = hoist.mass_per_length * h / 2 + hoist.remaining
    middle = (np.arange(count) + 0.5) * h

    def tension(y):
        e, rate = -np.diff(np.append(y[:count], 0)) / h, -np.diff(np.append(y[count:], 0)) / h
        return EA * (1 + e) * (e + e * e / 2 + c * (1 + e) * rate)

    def slope(_, y):
        N = tension(y)
        return np.append(y[count:], hoist.gravity - np.diff(N, prepend=0.0) / mass)

    stretch = crane.stretch_under((hoist.mass + hoist.mass_per_length * middle) * hoist.gravity, EA) - 1
    start = np.append(np.cumsum(stretch[::-1])[::-1] * h, np.zeros(count))
    done = solve_ivp(slope, (0, times[-1]), start, "DOP853", t_eval=times, rtol=1e-7, atol=1e-10)
    N = np.array([tension(y) for y in done.y.T])
    return N[:, -1] + hoist.mass_per_length * hoist.gravity * h / 2  # from the middle of the last element


@pytest.mark.parametrize("remaining", [0.0, *studies(50.0)])
def test_load_loss_is_that_of_fine_linear_elements(remaining):
    hoist = Hoist(speed=0.0, remaining=remaining, nodes=40)
    times = np.linspace(0.002, 0.03, 15)
    coarse, fine = (elements(hoist, n, times) for n in (60, 120))
    drum = hoist.history(hoist.solve(times[-1], 1e-8), times)["drum"]
    assert np.abs(fine - drum).max() < 0.3 * np.abs(coarse - drum).max()
    assert (4 * fine - coarse) / 3 == pytest.approx(drum, abs=2.0)


# the file
@pytest.fixture(scope="module")
def stored():
    return json.loads(hoisting.FILE.read_text())


@pytest.mark.parametrize(
    ("name", "until"),
    [("hoist", 1.5), ("lowering", 6.0), ("load_loss_to_1000", 0.1), *studies(("load_loss_to_0", 0.03))],
)
def test_histories_in_the_file_are_what_a_coarser_mesh_gives(stored, name, until):
    case = stored[name]
    hoist = Hoist(**case["parameters"])
    assert hoist == CASES[name][0]
    coarser = replace(hoist, nodes=hoist.nodes * 5 // 8)
    rows = slice(1, 1 + round(until / case["interval"]))
    times = np.arange(len(case["drum"]))[rows] * case["interval"]
    history = coarser.history(coarser.solve(until, 1e-7), times)
    size = np.abs(case["drum"]).max()
    for column, tolerance in (("drum", 1e-5 * size), ("hook", 1e-5 * size), ("depth", 1e-6), ("velocity", 1e-5)):
        assert history[column] == pytest.approx(case[column][rows], abs=tolerance), column


def test_peaks_in_the_file_are_converged(stored):
    assert stored.keys() == CASES.keys()
    for name, case in stored.items():
        size = max(abs(value) for _, value in case["peaks"].values())
        tolerance = {"long_hoist_undamped": 6e-5, "lowering_undamped": 2e-6}.get(name, 1e-6)
        for peak, (_, value) in case["peaks"].items():
            assert value == pytest.approx(case["peaks_coarser"][peak][1], abs=tolerance * size), (name, peak)


@pytest.mark.parametrize("damping", [0.0, 1e-4])
def test_bounce_grows_as_the_rope_shortens(stored, damping):
    """Action E/omega constant: the tension's amplitude as (EA/l)^(3/4) (M + rho l/3)^(-1/4); exp(-int c omega^2/2 dt).

    Within what the higher modes add; without damping the hook goes slack a second before the end.
    """
    case = stored["long_hoist" if damping else "long_hoist_undamped"]
    times = np.arange(len(case["hook"])) * case["interval"]
    l = Hoist(length=100.0).feed(times)[0]
    moved = 5000 + 6.5 * l / 3
    rate = damping / 2 * 8e7 / (l * moved)
    loss = np.exp(-np.append(0, np.cumsum((rate[1:] + rate[:-1]) / 2) * case["interval"]))
    scaled = np.abs(np.array(case["hook"]) - 5000 * 9.81) * l**0.75 * moved**0.25 / loss
    early, late = (scaled[(times > a) & (times < b)].max() for a, b in ((5, 15), (38, 48)))
    assert late == pytest.approx(early, rel=0.05)
    assert case["end"] == (50.0 if damping else pytest.approx(49.0895, abs=1e-3))
