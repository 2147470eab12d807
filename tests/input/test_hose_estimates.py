"""Tables behind the estimates of a hose: every row against the equation that it solves, solved here in another way."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, root

from gardenhose.estimates import ONSET, SUPPORTS

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
