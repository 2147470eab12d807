"""The matrix of an implicit step and the constraints' drift, against matrices written down by hand."""

import itertools

import numpy as np
import pytest
from study.oscillators import OMEGA, START, alphas_of, amplification, bar, chain, oscillator, rk4, subject

from tautline.integrators.state import new_state
from tautline.simulation import simulate
from tautline.study.robustness import conditioning as module
from tautline.study.robustness.conditioning import SHORTER, conditioning
from tautline.study.robustness.drift import Drift
from tautline.study.robustness.stability import stability
from tautline.study.trials.trial import Setting

STIFFNESS = np.array([[100.0, 0.0, 0.0], [0.0, 100.0, -100.0], [0.0, -100.0, 100.0]])
TIE = np.array([[-1.0, 1.0, 0.0]])
WEIGHT = 0.75
"""A typical mass: three kilograms over four nodes."""


def beta_of(h, rho=0.8):
    """beta' of eq. 2.88, from Chung and Hulbert's parameters."""
    alpha_m, alpha_f = alphas_of(rho)
    gamma = 0.5 - alpha_m + alpha_f
    return (1.0 - alpha_m) / ((0.5 + gamma) ** 2 / 4.0 * h * h * (1.0 - alpha_f))


def by_hand(h, scaled):
    """Condition number of (beta' M + K, s G^T; s G, 0) with s = beta' w or 1."""
    beta = beta_of(h)
    ties = TIE * (beta * WEIGHT if scaled else 1.0)
    return float(np.linalg.cond(np.block([[beta * np.eye(3) + STIFFNESS, ties.T], [ties, np.zeros((1, 1))]])))


def test_condition_numbers_of_two_masses_made_one_are_those_of_their_matrices():
    found = conditioning(subject(chain(100.0, time_end=0.1)))
    assert [entry.step for entry in found] == pytest.approx([0.01 * share for share in SHORTER])
    for entry in found:
        assert entry.scaled == pytest.approx(by_hand(entry.step, scaled=True), rel=1e-6)
        assert entry.unscaled == pytest.approx(by_hand(entry.step, scaled=False), rel=1e-4)


def test_with_the_scaling_the_condition_stays_and_without_it_grows_as_the_step_to_the_minus_fourth():
    found = conditioning(subject(chain(100.0, time_end=0.1)))
    for long, short in itertools.pairwise(found):
        ratio = long.step / short.step
        assert short.scaled == pytest.approx(long.scaled, rel=0.05)
        assert short.unscaled / long.unscaled == pytest.approx(ratio**4, rel=0.05)


def test_without_multipliers_there_is_nothing_to_scale():
    (first, *others) = conditioning(subject(oscillator(time_end=0.1)))
    assert first.scaled == pytest.approx(1.0) and first.unscaled is None
    assert all(entry.unscaled is None for entry in others)


@pytest.mark.parametrize("stiffness", [1e5, 1e8])
def test_a_penalty_makes_the_matrix_as_bad_as_it_is_stiff(stiffness):
    found = conditioning(subject(chain(100.0, tie="Penalty4", more=f", p_spring: {stiffness}", time_end=0.1)))
    for entry in found:
        matrix = beta_of(entry.step) * np.eye(3) + STIFFNESS + stiffness * TIE.T @ TIE
        assert entry.scaled == pytest.approx(np.linalg.cond(matrix), rel=1e-6)


@pytest.mark.parametrize("settings", [rk4(time_step=0.01), {"type": "Newmark", "rho_inf": None}])
def test_of_any_method_the_matrix_is_that_of_the_scene_run_by_generalized_alpha(settings):
    (first, *_) = conditioning(subject(chain(100.0, time_end=0.1, **settings)))
    assert first.scaled == pytest.approx(by_hand(first.step, scaled=True), rel=1e-3)


def test_a_scene_that_is_too_large_has_none(monkeypatch):
    monkeypatch.setattr(module, "MOST", 5)
    assert conditioning(subject(bar(3, time_end=0.1))) == []


# drift
def drift_of(text, **setting):
    study = subject(text)
    model = study.model(Setting(**setting))
    drift = Drift(model.system)
    simulate(model, look=drift)
    return drift


def test_the_drift_is_the_distance_of_what_should_be_one():
    model = subject(chain()).model(Setting())
    drift, state = Drift(model.system), new_state(model.system)
    assert drift.there
    drift(state, 0.0)
    assert drift.largest == 0.0
    second = next(i for i, name in enumerate(model.system.places) if name.startswith("node 2") and "x" in name)
    for gap in (0.3, -0.7, 0.1):
        state.full_q[second] += gap
        drift(state, 0.0)
        state.full_q[second] -= gap
    assert drift.largest == pytest.approx(0.7)


@pytest.mark.parametrize("settings", [{}, rk4(), {"type": "Newmark", "rho_inf": None}])
def test_multipliers_drift_by_rounding(settings):
    assert drift_of(chain(time_end=1.0, **settings)).largest < 1e-12


def test_a_gap_that_nothing_closes_is_told():
    """RK4 holds accelerations together; without projection what begins a millimetre apart stays so."""
    apart = chain(time_end=0.5, **rk4(projection="none")).replace("id: 2, xyz: [1.01,", "id: 2, xyz: [1.011,")
    assert drift_of(apart).largest == pytest.approx(1e-3, rel=1e-6)


def test_a_scene_without_multipliers_has_no_drift(monkeypatch):
    monkeypatch.setattr("tautline.study.robustness.stability.variants", lambda *_: [])
    monkeypatch.setattr("tautline.study.robustness.critical.bisect", lambda *_: None)
    assert not drift_of(oscillator(time_end=0.1)).there
    assert not drift_of(chain(tie="Penalty4", time_end=0.1)).there
    assert stability(subject(oscillator(time_end=0.1))).constraint_drift is None
    assert stability(subject(chain(time_end=0.1))).constraint_drift < 1e-12


# energy drift
def test_the_energy_drift_of_a_scene_is_what_its_method_takes(monkeypatch):
    """Over what was kinetic and what was strain energy, in the powers of Chung and Hulbert's matrix."""
    monkeypatch.setattr("tautline.study.robustness.stability.variants", lambda *_: [])
    monkeypatch.setattr("tautline.study.robustness.critical.bisect", lambda *_: None)
    lossy = stability(subject(oscillator(rho_inf=0.0, time_step=0.02, time_end=1.0, plotpoints=50)))
    step, turn = amplification(0.2, 0.0), np.array([START, 0.0, -0.04 * START])
    motion = np.array([np.linalg.matrix_power(step, n) @ turn for n in range(51)])
    strain, kinetic = 0.5 * OMEGA**2 * motion[:, 0] ** 2, 0.5 * (motion[:, 1] / 0.02) ** 2
    lost = strain[0] + kinetic[0] - strain[-1] - kinetic[-1]
    assert lossy.energy_drift == pytest.approx(lost / (kinetic.max() + np.ptp(strain)), rel=1e-3)
    kept = stability(subject(oscillator(rho_inf=1.0, time_step=0.02, time_end=1.0, plotpoints=50)))
    assert kept.energy_drift < 1e-3
