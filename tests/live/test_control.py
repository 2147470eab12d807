"""Control in the loop: the examples that are shipped, each held against what theory says of it."""

import sys
from pathlib import Path

import numpy as np
import pytest

import tautline

sys.path.insert(0, str(Path(__file__).parents[2]))

from examples import anti_sway, constant_tension, heave_compensation, soft_torque


def test_a_pi_law_holds_the_tension_to_what_the_linear_loop_leaves_of_the_heave():
    time, tension = constant_tension.run(24.0)
    late = tension[time > 16.0]  # one period of the heave, after its first, in which it grows, and one to settle
    assert late.mean() == pytest.approx(constant_tension.WANTED, rel=2e-3)
    sim = tautline.Simulation(constant_tension.SCENE)
    plant = sim.linearise(["winch.pay_out_speed"], ["winch.tension"])
    # As much tension for a metre of rope, far below the first natural frequency.
    stiffness = float(abs(plant.response(0.02)[0, 0, 0]) * 2.0 * np.pi * 0.02)
    w = 2.0 * np.pi / constant_tension.PERIOD * time[time > 16.0]
    parts = np.linalg.lstsq(np.column_stack((np.sin(w), np.cos(w), np.ones_like(w))), late)[0]
    assert np.hypot(*parts[:2]) == pytest.approx(constant_tension.expected(stiffness), rel=0.03)
    free = constant_tension.run(14.0, controlled=False)[1]
    assert np.ptp(free) > 10.0 * np.ptp(late)


def test_slewing_takes_the_sway_out_at_the_rate_that_is_designed():
    time, sway, angle = anti_sway.run()
    assert angle == pytest.approx(anti_sway.ANGLE, abs=0.02)
    end = anti_sway.OVER
    after = [np.abs(sway[(time > begin) & (time < begin + 9.0)]).max() for begin in (end, end + 18.0)]
    rate = np.log(after[0] / after[1]) / 18.0
    assert rate == pytest.approx(0.5 * anti_sway.DAMPING, rel=0.15)
    free = anti_sway.run(controlled=False)[1]
    assert np.abs(free[time > 40.0]).max() > 10.0 * np.abs(sway[time > 40.0]).max()


@pytest.mark.parametrize("delay", [0.0, 0.2, 0.4])
def test_heave_compensation_leaves_what_its_delay_lets_through(delay):
    time, height = heave_compensation.run(delay)
    assert np.ptp(height[time > 24.0]) / 2.0 == pytest.approx(heave_compensation.expected(delay), rel=0.02)


def test_a_soft_torque_law_in_python_does_what_the_built_in_one_does_to_one_percent():
    found = soft_torque.run(10.0)
    for what in ("drive", "bit"):
        other = found[f"built-in {what}"]
        difference = np.sqrt(np.mean((found[what] - other) ** 2)) / np.abs(other).max()
        assert difference < 0.01, (what, difference)
    assert np.ptp(found["bit"]) > 5.0  # it does stick and slip meanwhile
