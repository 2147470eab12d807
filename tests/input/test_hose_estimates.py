"""Tables behind the estimates of a hose: every row against the equation that it solves, solved here in another way."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq, root

from gardenhose.estimates import ONSET, SUPPORTS, average, first_frequency, onset_of_a_cantilever
from gardenhose.scene import read
from gardenhose.warnings import figures
from tautline.scene.reading.document import Document

CONDITIONS = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3)}
"""Derivatives of the deflection that are zero at an end."""
BEAMS = [pytest.param(*ends, id="-".join(ends)) for ends in SUPPORTS]
HELD = [pytest.param(*ends, id="-".join(ends)) for ends, row in SUPPORTS.items() if row[2] is not None]


def free_end(beta, u, omega):
    """Moment and shear at the free end of a pipe that is clamped at the root: a complex number, zero at an eigenvalue.

    The four solutions exp(r x) of Gregory and Paidoussis' equation make it; over Vandermonde's determinant, so that
    two equal roots r do not count as an eigenvalue.
    """
    roots = np.roots([1.0, 0.0, u**2, 2.0 * math.sqrt(beta) * u * 1j * omega, -(omega**2)])
    clamp = np.array([roots**0, roots])
    ends = np.array([roots**2, roots**3]) * np.exp(roots)
    return np.linalg.det(np.vstack((clamp, ends))) / np.linalg.det(np.vander(roots))


@pytest.mark.parametrize(("beta", "u", "omega"), ONSET.tolist())
def test_every_onset_of_flutter_is_one_of_gregory_and_paidoussis_equation(beta, u, omega):
    def residue(factors):
        value = free_end(beta, factors[0] * u, factors[1] * omega)
        return value.real, value.imag

    solution = root(residue, [1.0, 1.0])
    assert solution.success
    np.testing.assert_allclose(solution.x, 1.0, atol=5e-4)


def test_onsets_are_in_order_of_the_mass_ratio_and_rise_with_it():
    assert (np.diff(ONSET[:, 0]) > 0.0).all() and (np.diff(ONSET[:, 1]) > 0.0).all()


def first_root(function, end):
    """Lowest root above 0.5 of a function that has one below an end."""
    x = np.linspace(0.5, end, 2001)
    signs = np.sign([function(value) for value in x])
    k = int(np.flatnonzero(signs[1:] != signs[:-1])[0])
    return brentq(function, x[k], x[k + 1])


def trigonometric(x, order):
    """Derivative of cos x and sin x."""
    return [math.cos(x + order * math.pi / 2), math.sin(x + order * math.pi / 2)]


def hyperbolic(x, order):
    """Derivative of cosh x and sinh x."""
    return [math.cosh(x), math.sinh(x)][:: 1 if order % 2 == 0 else -1]


def linear(x, order):
    """Derivative of 1 and x."""
    return [[1.0, x], [0.0, 1.0], [0.0, 0.0], [0.0, 0.0]][order]


def determinant(root_support, end, scale, other):
    """Of the conditions at both ends of a beam of length `scale` in cos, sin and two other functions."""
    rows = [trigonometric(0.0, order) + other(0.0, order) for order in CONDITIONS[root_support]]
    rows += [trigonometric(scale, order) + other(scale, order) for order in CONDITIONS[end]]
    return float(np.linalg.det(np.array(rows)))


@pytest.mark.parametrize(("root_support", "end"), BEAMS)
def test_the_first_frequency_of_a_beam_is_that_of_its_frequency_equation(root_support, end):
    """As tan b = tanh b of clamped and pinned, or 1 + cos b cosh b = 0 of clamped and free; the frequency is b^2."""
    b = first_root(lambda value: determinant(root_support, end, value, hyperbolic), 6.0)
    assert SUPPORTS[root_support, end][0] == pytest.approx(b**2, rel=3e-6)


@pytest.mark.parametrize(("root_support", "end"), HELD)
def test_the_speed_of_divergence_is_that_of_euler_s_column(root_support, end):
    u = first_root(lambda value: determinant(root_support, end, value, linear), 7.0)
    assert SUPPORTS[root_support, end][2] == pytest.approx(u, rel=1e-6)


@pytest.mark.parametrize(("root_support", "end"), BEAMS)
def test_the_sag_of_a_beam_is_the_largest_of_its_polynomial_under_a_uniform_load(root_support, end):
    basis = [np.polynomial.Polynomial.basis(k) for k in range(4)]
    load = np.polynomial.Polynomial.basis(4) / 24.0
    conditions = [(0.0, order) for order in CONDITIONS[root_support]] + [(1.0, order) for order in CONDITIONS[end]]
    matrix = [[part.deriv(order)(x) for part in basis] for x, order in conditions]
    shape = load + np.polynomial.Polynomial(np.linalg.solve(matrix, [-load.deriv(order)(x) for x, order in conditions]))
    assert SUPPORTS[root_support, end][1] == pytest.approx(shape(np.linspace(0.0, 1.0, 10001)).max(), rel=1e-4)


TIP = """
hose: {{length: 1 m, elements: 20, axial_stiffness: 10 kN, bending_stiffness: 0.01 N m^2, mass_per_length: 0.08,
  tip_mass: {mass}, direction: [0, 0, -1]}}
water: {{mass_per_length: 0.12, speed: 5, outlet: {outlet}}}
gravity: 0
disturbance: [1 mm/s, 0, 0]
solver: {{step: 1 ms, end: 5 s}}
output: {{interval: 5 ms}}
"""


def hose_with(mass=0.0, outlet=1.0):
    """A hose of EJ = 0.01 N m^2, 1 m long, of 0.2 kg with its water, with so much at its tip."""
    return read(Document.parse(TIP.format(mass=mass, outlet=outlet), "hose.yaml"))


def determinant_of_a_tip(beta, u, omega, heavy, outlet):
    """As `free_end`, with the inertia of a mass in the shear of the tip and the follower thrust of a nozzle."""
    roots = np.roots([1.0, 0.0, outlet * u**2, 2.0 * math.sqrt(beta) * u * 1j * omega, -(omega**2)])
    clamp = np.array([roots**0, roots])
    ends = np.array([roots**2, roots**3 + heavy * omega**2]) * np.exp(roots)
    return np.linalg.det(np.vstack((clamp, ends))) / np.linalg.det(np.vander(roots))


@pytest.mark.parametrize("heavy", [0.0, 0.1, 1.0, 10.0])
@pytest.mark.parametrize("outlet", [1.0, 1.5])
@pytest.mark.parametrize("beta", [0.2, 0.6])
def test_an_onset_with_a_mass_or_a_nozzle_at_the_tip_solves_the_equation_of_pipe_and_tip(beta, heavy, outlet):
    u, omega = onset_of_a_cantilever(beta, heavy, outlet)

    def residue(factors):
        value = determinant_of_a_tip(beta, factors[0] * u, factors[1] * omega, heavy, outlet)
        return value.real, value.imag

    solution = root(residue, [1.0, 1.0])
    assert solution.success
    np.testing.assert_allclose(solution.x, 1.0, atol=1e-3)


@pytest.mark.parametrize("beta", [0.05, 0.25, 0.5, 0.8])
def test_without_a_mass_and_a_nozzle_the_solution_of_the_tip_is_that_of_the_table(beta):
    row = ONSET[ONSET[:, 0] == beta][0]
    assert onset_of_a_cantilever(beta) == pytest.approx(tuple(row[1:]), rel=2e-3)


@pytest.mark.parametrize(("mass", "outlet", "speed"), [(0.2, 1.0, 0.5326), (0.0, 1.5, 2.069), (0.0, 1.0, 2.884)])
def test_the_critical_speed_of_check_is_that_of_flutter_with_what_is_at_the_tip(mass, outlet, speed):
    """The speeds are what `gardenhose flutter` finds of the elements."""
    assert figures(hose_with(mass, outlet))["flow"]["critical_speed"] == pytest.approx(speed, rel=5e-3)


@pytest.mark.parametrize(("mass", "outlet"), [(0.0, 0.5), (20.0, 1.0)])
def test_a_hose_that_a_wide_outlet_keeps_stable_and_one_with_a_heavy_tip_have_no_estimate_of_the_onset(mass, outlet):
    flow = figures(hose_with(mass, outlet))["flow"]
    assert flow["critical_speed"] is None and flow["critical_frequency"] is None


@pytest.mark.parametrize("heavy", [0.05, 1.0, 9.9, 10.1, 1e6])
def test_the_first_frequency_with_a_mass_at_the_tip_is_that_of_its_frequency_equation(heavy):
    """1 + cos b cosh b = heavy b (sin b cosh b - cos b sinh b) of a cantilever with a mass at its end."""

    def equation(b):
        shear = math.sin(b) * math.cosh(b) - math.cos(b) * math.sinh(b)
        return 1.0 + math.cos(b) * math.cosh(b) - heavy * b * shear

    scene = hose_with(0.2 * heavy)
    expected = brentq(equation, 1e-3, 1.8751) ** 2 * math.sqrt(0.01 / 0.2) / (2.0 * math.pi)
    assert first_frequency(scene, average(scene, 1.0)) == pytest.approx(expected, rel=1e-4)


def test_the_droop_counts_the_weight_of_the_mass_at_the_tip():
    scene = hose_with(0.3).replace({"gravity": [0.01, 0, 0]})
    expected = 0.01 * (0.2 / 8.0 + 0.3 / 3.0) / 0.01
    assert figures(scene)["hose"]["droop"] == pytest.approx(expected)


@pytest.mark.parametrize("heavy", [0.0, 2.0])
def test_a_droop_is_told_as_far_as_the_bent_beam_in_closed_form_is_within_a_tenth_of_it(heavy):
    """Source: the elastica EJ theta'' = -q (L - s) cos(theta) - P cos(theta), theta(0) = 0 and theta'(L) = 0."""
    share = 0.2 / 8.0 + heavy / 3.0  # of the linear sag, with L = 1 m, EJ = 0.01 N m^2 and 0.2 kg/m

    def bent(gravity):
        def rates(s, y):
            return np.vstack([y[1], -100.0 * gravity * (0.2 * (1.0 - s) + heavy) * np.cos(y[0]), np.sin(y[0])])

        grid = np.linspace(0.0, 1.0, 101)
        found = solve_bvp(rates, lambda a, b: np.array([a[0], b[1], a[2]]), grid, np.zeros((3, 101)), tol=1e-8)
        return found.y[2, -1]

    def told(linear):
        gravity = linear * 0.01 / share
        return figures(hose_with(heavy).replace({"gravity": [gravity, 0, 0]}))["hose"]["droop"], bent(gravity)

    droop, exact = told(0.299)
    assert droop == pytest.approx(0.299) and 1.05 < droop / exact < 1.10
    for linear in (0.301, 1.0, 700.0):
        assert figures(hose_with(heavy).replace({"gravity": [linear * 0.01 / share, 0, 0]}))["hose"]["droop"] is None


def test_the_droop_of_a_hose_held_at_both_ends_is_told_while_bending_carries_it_and_not_stretch():
    """The sag a between pins that do not give, a sine wave: a (1 + EA a^2 / (4 EJ)) is that of bending alone."""
    EA, EJ, L = 29e6, 2013.0, 10.0
    pinned = {"length": L, "elements": 16, "axial_stiffness": EA, "bending_stiffness": EJ, "mass_per_length": 1.51}
    text = "\n".join(line for line in TIP.splitlines() if not line.startswith("disturbance"))
    base = read(
        Document.parse(
            text.format(mass=0.0, outlet=1.0).replace("tip_mass: 0.0", "end: pinned, root_support: pinned"), "hose.yaml"
        )
    )
    base = base.replace({f"hose.{key}": value for key, value in pinned.items()} | {"water.mass_per_length": 1e-9})

    def told(gravity):
        scene = base.replace({"gravity": [gravity, 0, 0]})
        linear = 5.0 / 384.0 * 1.51 * gravity * L**4 / EJ
        exact = brentq(lambda a: a * (1.0 + EA * a**2 / (4.0 * EJ)) - linear, 0.0, linear)
        return figures(scene)["hose"]["droop"], linear, exact

    droop, linear, exact = told(0.02)
    assert droop == pytest.approx(linear, rel=1e-6) and 1.0 < droop / exact < 1.03
    droop, linear, exact = told(9.81)
    assert droop is None and linear > 10.0 * exact
