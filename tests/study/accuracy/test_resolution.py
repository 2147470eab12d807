"""What a run tells of itself: its oscillation frequency, the phase error of the method, and numerical dissipation."""

import math
import re

import numpy as np
import pytest
from scipy.linalg import eigh
from study.oscillators import (
    OMEGA,
    START,
    amplification,
    chain,
    decay_constant,
    lag_constant,
    node,
    oscillator,
    principal,
    rk4,
    rk4_factor,
    run,
    spring,
    subject,
    text_of,
)

from tautline.integrators.method import method_for
from tautline.integrators.period import lag_of_step
from tautline.results.assessment.balance import Balance
from tautline.study.trials.trial import Setting

TURNS = (1e-2, 0.1, 0.6283, 1.0, 2.0)
RHOS = (0.0, 0.5, 0.8, 1.0)


def method(name, rho=None):
    model = subject(oscillator()).model(Setting(name, rho_inf=rho))
    return method_for(model.system, model.solver)


# the lag of a step
@pytest.mark.parametrize("turn", [*TURNS, 3.0])
def test_the_average_acceleration_turns_by_twice_the_arc_tangent_of_half(turn):
    """Trapezoidal rule: (1 + i turn/2) / (1 - i turn/2)."""
    assert lag_of_step(method("newmark"), turn) == pytest.approx(turn - 2.0 * math.atan(turn / 2.0), rel=1e-9)


def test_the_lag_of_the_average_acceleration_begins_with_a_twelfth_of_the_cube():
    for turn in (0.02, 0.05, 0.1):
        assert lag_of_step(method("newmark"), turn) == pytest.approx(turn**3 / 12.0, rel=turn**2)


@pytest.mark.parametrize("rho", RHOS)
def test_the_lag_of_generalized_alpha_is_that_of_chung_and_hulberts_matrix(rho):
    m = method("generalized-alpha", rho)
    for turn in TURNS:
        expected = turn - abs(np.angle(principal(turn, rho)))
        assert lag_of_step(m, turn) == pytest.approx(expected, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("rho", RHOS)
def test_the_lag_of_generalized_alpha_begins_with_the_constant_of_its_series(rho):
    """(11 rho^2 - 14 rho + 11) / (24 (1 + rho)^2): at rho 1 the twelfth of the average acceleration, at 0 11/24."""
    assert lag_constant(1.0) == pytest.approx(1.0 / 12.0)
    for turn in (0.02, 0.05):
        assert lag_of_step(method("generalized-alpha", rho), turn) == pytest.approx(
            lag_constant(rho) * turn**3, rel=10 * turn**2
        )


@pytest.mark.parametrize("turn", [0.05, 0.1, 0.2])
def test_the_lag_of_rk4_begins_with_the_fifth_power_over_120(turn):
    assert lag_of_step(method("rk4"), turn) == pytest.approx(turn**5 / 120.0, rel=turn**2)


@pytest.mark.parametrize("turn", [0.5, 1.5, 2.2])
def test_the_lag_of_rk4_is_that_of_the_cut_off_exponential(turn):
    assert lag_of_step(method("rk4"), turn) == pytest.approx(turn - np.angle(rk4_factor(1j * turn)), rel=1e-9)


@pytest.mark.parametrize("name", ["newmark", "rk4", "generalized-alpha"])
def test_what_does_not_turn_is_never_late(name):
    assert lag_of_step(method(name), 0.0) == 0.0


@pytest.mark.parametrize(
    ("name", "rho", "step"), [("newmark", None, 0.02), ("generalized-alpha", 0.5, 0.02), ("rk4", None, 0.08)]
)
def test_a_run_tells_how_late_its_oscillation_really_is_at_its_end(name, rho, step):
    """Late by the phase of (x, -v / omega), counted from the matrix of the method and seen in the run."""
    kind = {"newmark": "Newmark", "rk4": "RK4"}.get(name, "G-alpha")
    end = 6.0
    result = run(oscillator(type=kind, rho_inf=rho, time_step=step, time_end=end, plotpoints=1 / step))
    x, v = result["position"][-1, 1, 0] - 1.0, result["velocity"][-1, 1, 0]
    late = (OMEGA * end - math.atan2(-v / OMEGA, x)) % (2.0 * math.pi)
    told = result.attributes["phase_lag"]
    assert told == pytest.approx(late, rel=0.05)
    factor = rk4_factor(1j * OMEGA * step) if name == "rk4" else principal(OMEGA * step, rho)
    assert told == pytest.approx(end / step * (OMEGA * step - abs(np.angle(factor))), rel=0.05)


# oscillation frequency
@pytest.mark.parametrize("omega", [0.3, 10.0, 4e3])
@pytest.mark.parametrize("kind", ["G-alpha", "RK4"])
def test_the_frequency_of_a_vibration_is_found(omega, kind):
    h = 0.05 / omega
    text = oscillator(omega, type=kind, rho_inf=None, time_step=h, time_end=600 * h, plotpoints=0.1 / h)
    assert 2.0 * math.pi * run(text).attributes["motion_frequency"] == pytest.approx(omega, rel=0.02)


def test_steady_motion_oscillation_frequency_never_and_what_set_it_going_counts():
    """Two free masses pushed by 1 m/s^2 for 0.1 s and left alone: the root of int a^2 over int v^2."""
    parts = [node(0, 0.0, 0.0), node(1, 1.0, 1.0), spring(0, (0, 1), 100.0)]
    push = "PointForce: {id: 0, nodes4: [0, 1], force: [1, 0, 0], timeInterval: [0, 0.1]}"
    masses = "PointMass: {id: 0, nodes4: [0, 1], mass: 1.0}"
    for end in (1.0, 10.0):
        text = text_of([*parts, masses, push], time_step=0.001, time_end=end)
        turned, moved = 0.1, 0.01 * (end - 0.1) + 0.001 / 3.0
        found = 2.0 * math.pi * run(text).attributes["motion_frequency"]
        assert found == pytest.approx(math.sqrt(turned / moved), rel=0.02)


def test_multipliers_do_not_count_as_motion():
    """Two modes of masses 2 and 1 on two springs of 100 N/m, both let go at 0.01: by their amplitudes, on average."""
    stiffness, mass = np.array([[200.0, -100.0], [-100.0, 100.0]]), np.diag([2.0, 1.0])
    squares, shapes = eigh(stiffness, mass)
    parts = (shapes.T @ mass @ np.full(2, START)) ** 2
    expected = math.sqrt(np.sum(parts * squares**2) / np.sum(parts * squares))
    for tie in ("LagMultipl4", "AugLagrange4"):
        told = run(chain(100.0, tie=tie, time_end=20.0, time_step=0.005)).attributes["motion_frequency"]
        assert 2.0 * math.pi * told == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("plotpoints", [1, 2, 4, 7, 50])
def test_the_frequency_of_a_run_is_found_whatever_its_frames(plotpoints):
    """One turn a second: with one frame or two a second every one of them falls on a turning point."""
    result = run(oscillator(omega=2.0 * math.pi, time_end=12.0, plotpoints=plotpoints))
    assert result.attributes["motion_frequency"] == pytest.approx(1.0, rel=0.05)
    assert result.warnings == []


def test_the_frequency_of_a_run_is_found_where_frames_see_no_acceleration():
    """Struck at t = 0: of one turn a second every half second falls on a passage through rest.

    The blow of 10 N for 0.01 s leaves 0.1 m/s: int v^2 = 0.005 T, int a^2 = omega^2 0.005 T and that of the blow, 1.
    """
    blow = "PointForce: {id: 0, nodes4: [1], force: [10.0, 0, 0], timeInterval: [-1.0, 0.01]}"
    struck = oscillator(2.0 * math.pi, start=0.0, items=[blow], time_step=0.005, time_end=20.0, plotpoints=2)
    expected = math.sqrt(4.0 * math.pi**2 + 1.0 / (0.005 * 20.0)) / (2.0 * math.pi)
    assert run(struck).attributes["motion_frequency"] == pytest.approx(expected, rel=0.05)


# warnings
def warned(text):
    return run(text).warnings


@pytest.mark.parametrize("steps", [4.0, 7.0, 9.7])
def test_fewer_than_ten_steps_a_turn_are_warned_of_with_the_step_to_take(steps):
    h = 2.0 * math.pi / OMEGA / steps
    found = warned(oscillator(time_step=h, time_end=400 * h, plotpoints=1 / h))
    (warning,) = (text for text in found if "steps per period" in text)
    told = float(re.search(r"gives ([\d.]+) steps per period", warning).group(1))
    assert told == pytest.approx(steps, rel=0.06)
    cure = float(re.search(r"take a step of ([\d.e+-]+) s", warning).group(1))
    assert cure == pytest.approx(0.1 * 2.0 * math.pi / OMEGA, rel=0.06)
    # a motion near a mesh's highest frequency may be the mesh's own: then a shorter step makes it no better
    assert "Compare with more elements too" in warning


@pytest.mark.parametrize("name", ["G-alpha", "Newmark", "RK4"])
def test_eleven_steps_a_turn_are_enough_for_a_short_while(name):
    h = 2.0 * math.pi / OMEGA / 11.0
    alone = {"rho_inf": None} if name != "G-alpha" else {}
    assert warned(oscillator(type=name, time_step=h, time_end=2.0, plotpoints=1 / h, **alone)) == []


def test_what_swings_freely_and_is_late_is_warned_of_with_a_step_that_cures_it():
    """Newmark with 20 steps a turn: late by a twelfth of turn^2, 0.8 % of the angle; a quarter turn after 30 turns."""
    h = 2.0 * math.pi / OMEGA / 20.0
    text = oscillator(type="Newmark", rho_inf=None, time_step=h, time_end=60.0, plotpoints=1 / h)
    (warning,) = warned(text)
    late = float(re.search(r"has grown to about ([\d.]+) rad", warning).group(1))
    assert late == pytest.approx(60.0 * OMEGA * (OMEGA * h) ** 2 / 12.0, rel=0.05)
    cure = float(re.search(r"take a step of ([\d.e+-]+) s", warning).group(1))
    assert warned(text.replace(f"time_step: {h}", f"time_step: {0.98 * cure}")) == []


def test_a_short_run_of_the_same_is_not_warned_of():
    h = 2.0 * math.pi / OMEGA / 20.0
    assert warned(oscillator(type="Newmark", rho_inf=None, time_step=h, time_end=3.0, plotpoints=1 / h)) == []


@pytest.mark.parametrize("settings", [{}, rk4(), {"type": "Newmark", "rho_inf": None}, {"time_step": "auto"}])
@pytest.mark.parametrize("loaded", [False, True])
def test_what_is_at_rest_is_not_warned_of(settings, loaded):
    """With gravity along the string it hangs stretched: rounding in its balance is no motion."""
    parts = [node(0, 0.0, 0.0, (1, 1, 1, 1)), node(1, 1.0, 1.0), spring(0, (0, 1), 1e4)]
    mass = "PointMass: {id: 0, nodes4: [1], mass: 1.0}"
    gravity = (9.81, 0, 0) if loaded else (0, 0, 0)
    result = run(text_of([*parts, mass], gravity, start="static", **({"time_end": 2.0} | settings)))
    assert result.warnings == []
    assert result.attributes["motion_frequency"] == result.attributes["phase_lag"] == 0.0


def test_what_is_pushed_steadily_is_not_warned_of():
    parts = [node(0, 0.0, 0.0), node(1, 1.0, 1.0), spring(0, (0, 1), 1e4)]
    push = "PointForce: {id: 0, nodes4: [0, 1], force: [1, 0, 0]}"
    text = text_of([*parts, "PointMass: {id: 0, nodes4: [0, 1], mass: 1.0}", push], time_end=2.0)
    assert warned(text) == []


def test_a_step_that_is_controlled_is_judged_by_what_it_takes_on_average():
    result = run(oscillator(time_step="auto", time_end=5.0, plotpoints=50))
    taken = result.attributes["end"] / result.attributes["steps"]
    m = method("generalized-alpha", 0.8)
    assert result.attributes["phase_lag"] == pytest.approx(lag_of_step(m, OMEGA * taken) * 5.0 / taken, rel=0.05)
    assert result.warnings == []


# energy
def balance(rows, force=0.0, throughput=0.0):
    """Of frames of kinetic, strain, potential energy, work done, energy dissipated."""
    made = Balance(force, 0.0)
    made.add(np.array(rows, float))
    return made.missing(), made.gained(throughput), made.moves()


@pytest.mark.parametrize(
    ("rows", "missing"),
    [
        ([[0, 9, 0, 0, 0], [9, 0, 0, 0, 0]], 0.0),
        ([[0, 0, 9, 0, 0], [4, 5, 0, 0, 0]], 0.0),
        ([[9, 0, 0, 0, 0], [5, 0, 0, 0, 4]], 0.0),
        ([[0, 0, 0, 0, 0], [6, 1, 0, 8, 1]], 0.0),
        ([[9, 0, 0, 0, 0], [7, 0, 0, 0, 0]], -2.0),
        ([[9, 0, 0, 0, 0], [10, 0, 0, 0, 0]], 1.0),
        ([[9, 0, 0, 3, 1], [9, 0, 0, 5, 1]], -2.0),
    ],
)
def test_what_is_missing_is_what_neither_work_nor_dissipation_accounts_for(rows, missing):
    """The last: two joules of work went in and nothing shows them. What went in before the first frame is in it."""
    found, gained, moves = balance(rows)
    assert found == pytest.approx(missing)
    assert np.sign(round(gained, 9)) == np.sign(missing) and moves


def test_energy_from_nowhere_counts_against_what_went_through_without_it():
    """A kinetic energy that grows from 9 to 10 by itself, while a drive moves 90 J in and out."""
    rows = [[9, 0, 0, 0, 0], [10, 0, 0, 0, 0]]
    assert balance(rows)[1] == pytest.approx(1.0 / 9.0)
    assert balance(rows, throughput=90.0)[1] == pytest.approx(1.0 / 99.0)


def test_energy_that_comes_from_nowhere_and_goes_there_again_is_told():
    assert balance([[9, 0, 0, 0, 0], [12, 0, 0, 0, 0], [9, 0, 0, 0, 0]])[1] == pytest.approx(3.0 / 9.0)


def test_energy_lost_without_account_counts_against_all_that_there_was():
    assert balance([[10, 0, 0, 0, 0], [7, 0, 0, 0, 0]])[1] == pytest.approx(-0.3)


def test_a_balance_of_nothing_is_none():
    empty = Balance(1.0, 0.0)
    assert (empty.missing(), empty.gained(0.0), empty.moves()) == (0.0, 0.0, False)
    assert balance([[0, 0, 0, 0, 0]]) == (0.0, 0.0, False)


def test_rounding_of_what_is_stored_is_no_motion_and_no_gain():
    _, gained, moves = balance([[1e-14, 1e6, 0, 0, 0], [2e-14, 1e6 * (1 + 1e-15), 0, 0, 0]])
    assert not moves and abs(gained) < 1e-6


@pytest.mark.parametrize(("rho", "step", "steps"), [(0.0, 0.03, 100), (0.5, 0.05, 150), (0.8, 0.1, 200)])
def test_generalized_alpha_tells_the_energy_that_its_spectral_radius_takes(rho, step, steps):
    """Exactly that of the powers of Chung and Hulbert's matrix; nearly rho(turn)^2n; and for short steps its series."""
    turn, energy = OMEGA * step, 0.5 * OMEGA**2 * START**2
    text = oscillator(rho_inf=rho, time_step=step, time_end=steps * step, plotpoints=1 / step)
    result = run(text)
    told = result.attributes["numerical_dissipation"]
    x, hv, _ = np.linalg.matrix_power(amplification(turn, rho), steps) @ (START * np.array([1.0, 0.0, -(turn**2)]))
    left = 0.5 * OMEGA**2 * x**2 + 0.5 * (hv / step) ** 2
    assert told == pytest.approx(energy - left, rel=1e-6)
    assert told / energy == pytest.approx(1.0 - abs(principal(turn, rho)) ** (2 * steps), abs=0.06)


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.5])
def test_the_spectral_radius_begins_as_its_series_says(rho):
    """exp(-((1 - rho) / (1 + rho))^3 turn^4 / 2) a step: what the reference itself rests on."""
    for turn in (0.05, 0.1):
        loss = 1.0 - abs(principal(turn, rho))
        assert loss == pytest.approx(decay_constant(rho) * turn**4, rel=0.1)


@pytest.mark.parametrize("settings", [{"rho_inf": 1.0}, {"type": "Newmark", "rho_inf": None}])
def test_methods_that_keep_energy_tell_that_none_is_lost(settings):
    result = run(oscillator(time_step=0.02, **settings))
    told = result.attributes["numerical_dissipation"]
    assert abs(told) < 1e-3 * 0.5 * OMEGA**2 * START**2


def test_rk4_tells_the_energy_that_it_takes_too():
    """|1 + i y - y^2/2 - i y^3/6 + y^4/24|^2 = 1 - y^6/72 + y^8/576 a step."""
    energy, y = 0.5 * OMEGA**2 * START**2, 0.5
    told = run(oscillator(**rk4(time_step=0.05, time_end=5.0, plotpoints=20))).attributes["numerical_dissipation"]
    assert told == pytest.approx(energy * (1.0 - (1.0 - y**6 / 72.0 + y**8 / 576.0) ** 100), rel=1e-6)


def test_what_dampers_take_is_not_the_methods():
    """Half of a hundredth of a second's damping takes nearly all; the method's part is the step's, not theirs."""
    energy = 0.5 * OMEGA**2 * START**2
    result = run(oscillator(zeta=0.1, time_step=0.002, plotpoints=500))
    assert result["dissipated_energy"][-1] == pytest.approx(energy, rel=1e-3)
    assert abs(result.attributes["numerical_dissipation"]) < 1e-3 * energy
