"""What is stated of the error of an explicit run: a bar of stiff elements was wrong by 19 % without a word."""

import re

import numpy as np
import pytest
from study.oscillators import OMEGA, oscillator, rk4, subject

from tautline.study.trials.step_error import estimate, runs_for
from tautline.study.trials.trial import Setting


@pytest.mark.parametrize("turn", [0.5, 1.0, 1.9])
def test_an_explicit_run_states_no_less_than_its_error_and_no_more_than_three_times_it(turn):
    """RK4's own closed form: one step multiplies by 1 + z + z^2/2 + z^3/6 + z^4/24, z = i omega h."""
    h, end = turn / OMEGA, 30.0 * turn / OMEGA
    study = subject(oscillator(**rk4(time_step=h, time_end=end, plotpoints=1.0 / h)))
    run = study.run(Setting())
    z, n = 1j * turn, np.arange(round(end / h) + 1)
    motion = ((1.0 + z * (1.0 + z * (0.5 + z * (1.0 / 6.0 + z / 24.0)))) ** n).real
    exact = np.cos(turn * n)
    true = np.abs(motion - exact).max() / np.abs(exact - exact[0]).max()
    parts = runs_for(study.model(Setting()))
    assert parts == (0.5,)
    found = estimate(study, run.result, parts=parts)
    assert true <= found.position <= 3.0 * true


def test_an_explicit_run_whose_step_is_controlled_states_nothing_unasked():
    automatic = subject(oscillator(**rk4(time_step=0.01))).model(Setting())
    assert runs_for(automatic, False) == ()


def test_an_explicit_run_that_is_far_off_is_told_a_step_that_does_better():
    # `step: auto` is no number: "take a shorter step" said nothing of which
    h = 1.9 / OMEGA
    study = subject(oscillator(**rk4(time_step=h, time_end=30.0 * h, plotpoints=1.0 / h)))
    run = study.run(Setting())
    found = estimate(study, run.result, parts=(0.5,))
    assert found.taken == pytest.approx(h)
    step = re.search(
        r"Take a shorter step than \S+ s, such as with --step '(\S+) s', or run with --verify", found.warning
    )
    shorter = float(step.group(1))
    assert shorter < h
    better = estimate(study, study.run(Setting(step=shorter)).result, Setting(step=shorter), parts=(0.5,))
    assert better.position < 0.5 * found.position
