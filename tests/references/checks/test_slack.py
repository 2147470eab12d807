"""Self-tests of slack and snap: closed forms, phases in closed form, energy, periodic motion."""

from dataclasses import replace

import numpy as np
import pytest
from of_the_suite import studies
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from references import slack
from references.slack import Snap

# every period slack once; slack once with bounces after it
HEAVING = Snap(damping=0.03, amplitude=1.5, period=2.0, ramp=4.0)
BOUNCING = Snap(damping=0.01, amplitude=1.2, period=2.0, ramp=4.0)
FALL = np.sqrt(2 * 9.81 * 0.5)  # speed after 0.5 m


def test_linear_snap_is_the_energy_of_the_fall_and_tends_to_v_sqrt_k_m():
    drop = Snap(damping=0.0, green=False)
    peak = slack.snap_tension(5000.0, 3.2e6, FALL)
    motion = drop.simulate(0.6, drop.length - 0.5)
    assert motion.peaks[0][1] == pytest.approx(peak, rel=1e-11)
    assert motion.changes[0] == pytest.approx(FALL / 9.81, rel=1e-12)
    assert slack.snap_tension(5000.0, 3.2e6, 0.0) == 2 * 5000 * 9.81
    assert slack.snap_tension(5000.0, 3.2e6, 1e4) == pytest.approx(1e4 * np.sqrt(3.2e6 * 5000), rel=1e-4)


def test_snap_with_greens_law_is_what_the_motion_gives():
    motion = Snap(damping=0.0).simulate(0.6, 24.5)
    peak = slack.snap_tension_green(5000.0, 8e7, 25.0, FALL)
    assert motion.peaks[0][1] == pytest.approx(peak, rel=1e-11)
    assert peak == pytest.approx(slack.snap_tension(5000.0, 3.2e6, FALL), rel=6e-3)


def test_damped_linear_snap_is_the_closed_form():
    """Taut: d'' + c w^2 d' + w^2 d = g from where d + c d' = 0; the peak of d + c d' by its derivative."""
    drop = Snap(damping=0.01, green=False)
    w2, c, g = 3.2e6 / 5000, 0.01, 9.81
    v = np.sqrt(g * g * c * c + 2 * g * 0.5) - g * c  # d = -c v, v^2 = 2 g (0.5 - c v)
    decay, omega = c * w2 / 2, np.sqrt(w2 - (c * w2 / 2) ** 2)
    A = -c * v - g / w2
    B = (v + decay * A) / omega

    def force(t):
        cos, sin = np.cos(omega * t), np.sin(omega * t)
        d = g / w2 + np.exp(-decay * t) * (A * cos + B * sin)
        rate = np.exp(-decay * t) * ((B * omega - decay * A) * cos - (A * omega + decay * B) * sin)
        return d + c * rate, rate + c * (g - w2 * (d + c * rate))

    top = brentq(lambda t: force(t)[1], 1e-4, np.pi / omega, xtol=1e-15)
    motion = drop.simulate(0.6, 24.5)
    assert motion.changes[0] == pytest.approx(v / g, rel=1e-11)
    assert motion.peaks[0] == (pytest.approx(v / g + top, rel=1e-7), pytest.approx(3.2e6 * force(top)[0], rel=1e-10))


@pytest.mark.parametrize("case", [HEAVING, *studies(BOUNCING)])
def test_energy_is_the_tips_work_less_the_heat(case):
    motion = case.simulate(8.0, case.rest(), tolerance=1e-11)
    times = np.linspace(0, 8, 81)
    x, v, work, heat, _ = case.at(motion, times)
    total = case.energy(times, x, v)
    assert heat[-1] > 1e4
    assert np.all(np.diff(heat) > -1e-6)
    assert total - total[0] == pytest.approx(work - heat, abs=1e-6 * heat[-1])


def test_events_do_not_matter_to_small_steps():
    motion = HEAVING.simulate(5.0, HEAVING.rest(), tolerance=1e-11)

    def slope(t, y):
        return [y[1], 9.81 - float(HEAVING.tension(t, *y)) / 5000]

    done = solve_ivp(slope, (0, 5), [HEAVING.rest(), 0], "RK45", rtol=1e-9, atol=1e-11, max_step=1e-3)
    assert HEAVING.at(motion, [5.0])[:2, 0] == pytest.approx(done.y[:, -1], abs=1e-6)


@pytest.mark.parametrize(
    ("case", "end", "slacks", "peak"), [*studies((HEAVING, 20.0, 1, 549167), (BOUNCING, 36.0, 2, 312567))]
)
def test_motion_becomes_periodic_with_a_slack_rope_in_every_period(case, end, slacks, peak):
    motion = case.simulate(end, case.rest(), tolerance=1e-9)
    last = motion.changes[motion.changes > end - 4]
    assert len(last) == 2 * 2 * slacks
    assert last[2 * slacks :] - last[: 2 * slacks] == pytest.approx(np.full(2 * slacks, 2.0), abs=1e-6)
    assert max(value for time, value in motion.peaks if time > end - 2) == pytest.approx(peak, abs=1)


def test_snaps_of_the_heaving_tip_are_those_of_its_closing_speed():
    """Nearly undamped: speed relative to the tip as the rope tightens, weight with the tip's acceleration then."""
    case = replace(HEAVING, damping=1e-4)
    motion = case.simulate(6.0, case.rest(), tolerance=1e-10)
    tightened = [solution for taut, solution in motion.phases[1:] if taut]
    assert len(tightened) == 4
    for solution in tightened:
        time, (_, v) = solution.t[0], solution.y[:2, 0]
        weight = 9.81 - (case.tip(time + 1e-4)[1] - case.tip(time - 1e-4)[1]) / 2e-4
        expected = slack.snap_tension_green(5000.0, 8e7, 25.0, v - case.tip(time)[1], weight)
        assert next(value for at, value in motion.peaks if at > time) == pytest.approx(expected, rel=0.03)
