"""Steps that are too long for what drives a scene, or for what it is to show: told before it runs."""

import re

import pytest
from study.oscillators import oscillator, rk4, subject


def driven(function, *, frequency=None, **solver):
    """Warnings of the step of an oscillator whose support moves along x as a function of time says."""
    moved = oscillator(**({"time_step": 0.05, "plotpoints": 20, "frequency": frequency} | solver)).replace(
        "BC: [1, 1, 1, 1], p: 0.0}", "BC: [1, 1, 1, 1], p: 0.0, BC_functions: [1, 0, 0, 0]}"
    )
    text = moved.replace("  - PointMass", f"  - Function: {{id: 1, value: {function}}}\n  - PointMass")
    study = subject(text)
    return [c for c in study.application.warnings(study.scene) if "decent picture" in str(c)]


def steps_told(found):
    (warning,) = found
    return float(re.search(r"takes ([\d.]+) steps", str(warning)).group(1))


@pytest.mark.parametrize(
    ("function", "frequency"),
    [
        ("{harmonic: {amplitude: 0.01, frequency: 4.0}}", 4.0),
        ("{harmonic: {amplitude: 0.01, period: 0.25}}", 4.0),
        # 2 pi / 1 + 2 * 2 (t - 0) at five seconds.
        ("{chirp: {amplitude: 0.01, period: 1.0, rate: 2.0}}", 1.0 + 20.0 / (2 * 3.141592653589793)),
        ("{spectrum: {significant_height: 0.1, peak_period: 0.5}}", 4.0),
        ("{ramp: {to: 0.01, over: 0.25}}", 4.0),
        ("{sum: [{constant: 0.0}, {harmonic: {amplitude: 0.01, frequency: 3.0}}, {ramp: {to: 1, over: 0.2}}]}", 5.0),
    ],
)
def test_a_step_that_is_too_long_for_a_function_of_time_is_told_with_the_steps_to_a_period(function, frequency):
    assert steps_told(driven(function)) == pytest.approx(1.0 / (0.05 * frequency), rel=0.01)
    assert driven(function, time_step=0.99 * 0.1 / frequency, plotpoints=0) == []


@pytest.mark.parametrize(
    "function",
    ["{constant: 0.0}", "{table: {time: [0, 0.01, 5], value: [0, 0.1, 0]}}", "{ramp: {to: 0.01, over: 0.1, at: 9.0}}"],
)
def test_what_has_no_frequency_within_the_run_is_not_told(function):
    assert driven(function) == []


def test_a_frequency_that_the_answer_is_to_show_is_compared_as_well():
    slow = "{harmonic: {amplitude: 0.01, frequency: 0.1}}"
    assert driven(slow) == []
    assert steps_told(driven(slow, frequency=8.0)) == pytest.approx(2.5)
    assert steps_told(driven(slow, frequency="8 Hz", **rk4(time_step=0.05))) == pytest.approx(2.5)


@pytest.mark.parametrize("control", [{"time_step": "auto"}, {"control": "error", "tolerance": 1e-6}])
def test_a_step_that_is_chosen_or_controlled_is_not_told(control):
    assert driven("{harmonic: {amplitude: 0.01, frequency: 4.0}}", **control) == []
