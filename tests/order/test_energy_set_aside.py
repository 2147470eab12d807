"""What an implicit method sets aside for accelerations: a recursion of numbers on one oscillator, without our steps."""

import numpy as np
import pytest

from tautline.integrators.generalized_alpha import alphas, coefficients, energy_set_aside

STEPS = 300


def energies(alpha_m, alpha_f, turn, q, v):
    """Energy of q.. + q = 0, and what is set aside, at each step of h = turn (eqs 2.84 to 2.86)."""
    beta, gamma = coefficients(alpha_m, alpha_f)
    share, h, found = (1.0 - alpha_f) / (1.0 - alpha_m), turn, []
    a = other = -q
    for _ in range(STEPS):
        found.append((0.5 * (v * v + q * q), energy_set_aside(beta, gamma, h, a * a)))
        rest = (alpha_f * a - alpha_m * other) / (1.0 - alpha_m)
        ahead = q + h * v + h * h * ((0.5 - beta) * other + beta * rest)
        a = -ahead / (1.0 + h * h * beta * share)
        new = share * a + rest
        q, v, other = ahead + h * h * beta * share * a, v + h * ((1.0 - gamma) * other + gamma * new), new
    return np.array(found).T


@pytest.mark.parametrize("rho_inf", [0.0, 0.3, 0.6, 0.8, 0.95])
@pytest.mark.parametrize("turn", [0.03, 0.3, 1.0, 3.0, 10.0])
def test_a_free_vibration_never_has_more_energy_than_it_had_with_what_was_set_aside_at_its_start(rho_inf, turn):
    above = 0.0
    for phase in np.linspace(0.0, np.pi, 41):
        energy, aside = energies(*alphas(rho_inf), turn, np.cos(phase), np.sin(phase))
        assert energy.max() <= (energy[0] + aside[0]) * (1.0 + 1e-12)
        above = max(above, energy.max() / energy[0] - 1.0)
    # Without it a run of long steps would be said to create energy.
    assert above > 0.01 or rho_inf > 0.5 or turn < 3.0


def test_of_generalized_alpha_the_sum_swings_and_is_no_conserved_quantity():
    energy, aside = energies(*alphas(0.6), 0.1, 1.0, 0.0)
    assert np.diff(energy + aside).max() > 1e-5


def test_the_average_acceleration_sets_nothing_aside_and_keeps_the_energy():
    energy, aside = energies(0.0, 0.0, 0.7, 1.0, 0.3)
    assert np.all(aside == 0.0)
    assert energy == pytest.approx(energy[0], rel=1e-12)
