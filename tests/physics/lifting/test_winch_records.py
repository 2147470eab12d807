"""A winch moved by a record of straight lines: corners take nothing of a bounce, and their work is booked."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import hoist, ran

RATE = 100.0
JERK, MOVED = 0.3, 0.02
"""How long the winch hauls, s, and how much, m: a smooth jerk, after which the load bounces freely."""


def record(noise, seconds):
    """Times, s, and speeds, m/s, of a winch that jerks and then stands, with noise."""
    time = np.arange(round(seconds * RATE) + 1) / RATE
    share = np.clip(time / JERK, 0.0, 1.0)
    jerk = -30.0 * MOVED / JERK * share**2 * (1.0 - share) ** 2
    return time, jerk + noise * np.random.default_rng(3).standard_normal(time.size)


def bounce(noise, step):
    """Amplitudes of the rope's force, N, from 0.5 to 1.5 s and from 6.5 to 7.5 s, without damping."""
    time, speed = record(noise, 7.5)
    table = {"time": time.tolist(), "value": speed.tolist()}
    scene = hoist(
        drive={"pay_out": {"table": table}}, rope={"damping": 0.0}, solver={"end": 7.5, "step": step}, start="static"
    )
    result = ran(scene, energy=1e-3)
    at, force = result["time"], np.asarray(result["axial_force"])[:, -1]
    return [float(np.ptp(force[(at > a) & (at < a + 1.0)])) / 2.0 for a in (0.5, 6.5)]


@pytest.mark.parametrize("step", [5e-3, 1e-3])
def test_corners_of_no_size_in_a_winch_record_take_nothing_of_a_bounce(step):
    calm, noisy = bounce(0.0, step), bounce(1e-5, step)
    # Accelerations that were found anew at each corner took 14 % of it in ten seconds.
    assert noisy == pytest.approx(calm, rel=0.01)
    assert calm[1] == pytest.approx(calm[0], rel=0.1)
