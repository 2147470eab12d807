"""Spans of rope against the reference that takes Lagrange's equations of them by brute force."""

from dataclasses import replace

import numpy as np
import pytest
from cranes.groups.spans import Held
from references import span_lagrangian as exact

from tautline.kernels.groups import EMPTY

CASES = [case for seed in (1, 2) for case in exact.cases(seed)]
NAMES = [f"{case.name} {k // 12}" for k, case in enumerate(CASES)]
CASES += [replace(case, span=replace(case.span, engineering=True)) for case in CASES[:12]]
NAMES += [f"{name} with engineering strain" for name in NAMES[:12]]
SPARED = [
    pytest.param(case, id=name, marks=pytest.mark.study if name.endswith(" 1") else ())
    for case, name in zip(CASES, NAMES, strict=True)
]
"""The cases as parameters where a case takes long: the second seed says the same of other numbers, and is a study."""


def held(case, **options):
    return Held(case.span, case.q, case.v, case.time, **options)


@pytest.mark.parametrize("case", SPARED)
def test_residual_is_lagranges(case):
    made = held(case).residual(case.q, case.v, case.a)
    expected = exact.residual(case.span, case.q, case.v, case.a, case.time)
    assert np.abs(made - expected).max() < 1e-10 * np.abs(expected).max()


@pytest.mark.parametrize("keeps", [(True, False), (False, True), (True, True)], ids=["begin", "end", "both"])
@pytest.mark.parametrize("case", CASES[:6], ids=NAMES[:6])
def test_rope_that_keeps_its_stretch_beyond_an_end_pulls_there_with_all_of_its_tension(case, keeps):
    """Lagrange's equations of a span let go what leaves it, with W of its own: it is that which is not there."""
    made = held(case, keeps=keeps).residual(case.q, case.v, case.a)
    expected = exact.residual(case.span, case.q, case.v, case.a, case.time)
    energy = exact.strain_energy(case.span, case.q, case.time) / (case.q[7] - case.q[3])
    assert energy > 1e-6 * np.abs(expected).max()
    expected[[3, 7]] += np.array([energy, -energy]) * keeps
    assert np.abs(made - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("case", SPARED)
def test_energies_and_powers_are_the_references(case):
    (kinetic, strain, potential), (lost, driven, _) = held(case).energies(case.q, case.v)
    assert kinetic == pytest.approx(exact.kinetic_energy(case.span, case.q, case.v, case.time), rel=1e-12)
    assert strain == pytest.approx(exact.strain_energy(case.span, case.q, case.time), rel=1e-9)
    assert potential == pytest.approx(exact.potential_energy(case.span, case.q), rel=1e-12, abs=1e-9)
    assert lost == pytest.approx(exact.dissipation(case.span, case.q, case.v, case.time), rel=1e-8, abs=1e-9)
    power = exact.frame_power(case.span, case.q, case.v, case.time)
    assert driven == pytest.approx(power, rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
@pytest.mark.parametrize("weights", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)], ids=["mass", "damping", "all"])
@pytest.mark.parametrize("keeps", [(False, False), (True, True)], ids=["", "keeps"])
def test_tangent_is_the_residuals_difference(case, weights, keeps):
    """Exact for points; left out is how E changes on wheels that turn or are met askew, in what flows through."""
    span = held(case, keeps=keeps)
    cm, cc, ck = weights
    made = span.matrix(case.q, case.v, case.a, cm, cc, ck)
    expected = np.zeros((8, 8))
    h = 1e-5 if ck else 0.1  # the residual is of second degree in rates
    for j in range(8):
        step = np.zeros(8)
        step[j] = h
        ends = [span.residual(case.q + s * ck * step, case.v + s * cc * step, case.a + s * cm * step) for s in (1, -1)]
        expected[:, j] = (ends[0] - ends[1]) / (2.0 * h)
    scale = np.abs(expected).max()
    bound = 1e-7 if case.name == "point to point" or ck == 0.0 else 2e-4
    assert np.abs(made - expected).max() < bound * scale


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_mass_is_what_accelerations_meet(case):
    span = held(case)
    assert np.allclose(span.mass(case.q), span.matrix(case.q, case.v, case.a, 1.0, 0.0, 0.0), rtol=0, atol=1e-9)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_what_the_residual_has_found_is_taken_for_its_own_state_only(case):
    """Power and alarms are read off what the residual found where it was asked of the same state, else looked for."""
    further = case.q + 0.01 * np.array([1.0, -0.5, 0.3, 0.0, -0.2, 0.7, 0.4, 0.0])
    alone = {name: held(case).power(q, v) for name, q, v in _states(case, further)}
    span = held(case)
    for name, q, v in _states(case, further):
        span.residual(q, v, case.a)
        assert span.power(q, v) == pytest.approx(alone[name], rel=1e-10, abs=1e-10)
        for other, x, y in _states(case, further):
            assert span.power(x, y) == pytest.approx(alone[other], rel=1e-9, abs=1e-9)


def _states(case, further):
    return ("as it is", case.q, case.v), ("elsewhere", further, case.v), ("faster", case.q, 1.5 * case.v)


def test_an_element_without_length_raises_the_alarm_whether_its_line_was_found_or_not():
    case = CASES[0]
    gone = case.q.copy()
    gone[7] = gone[3] - 0.1
    assert held(case).power(gone, case.v)[1] == EMPTY
    span = held(case)
    span.residual(gone, case.v, case.a)
    assert span.power(gone, case.v)[1] == EMPTY
    assert held(case).power(case.q, case.v)[1] == 0


def test_a_span_that_goes_slack_or_taut_is_told_once_by_the_residual():
    case = CASES[0]
    span, short = held(case, slack=True), case.q.copy()
    short[7] = short[3] + 2.0 * (short[7] - short[3])
    still = np.zeros(8)
    span.residual(case.q, still, still)
    assert span.kinks() == 0 and exact.strain_energy(case.span, case.q, case.time) > 0.0
    span.residual(short, still, still)
    assert (span.kinks(), span.kinks()) == (1, 0)
    span.residual(short, still, still)
    assert span.kinks() == 0
    span.residual(case.q, still, still)
    assert span.kinks() == 1
