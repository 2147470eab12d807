"""What follows a function of time pushes what it carries as hard as its speed changes, however a step cuts that."""

import numpy as np
import pytest

from tautline.kernels.dofs import (
    BEFORE,
    BEGIN,
    OWED,
    SPEED,
    book_speeds,
    ease,
    prescribe_end,
    prescribe_lasting,
    prescribe_push,
    work_of_push,
)
from tautline.kernels.jit import entry
from tautline.kernels.time_function import value_at
from tautline.scene.functions import Harmonic, Ramp, Sum, Table
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import FunctionRequest, compile_functions

STEP = 1e-3


@entry
def _prescribe_end(dofs, functions, t, h, equal, known, q, v, a):
    return prescribe_end(dofs, functions, t, h, equal, 1.0, 0.5, known, q, v, a)


@entry
def _ease(dofs, functions, t, h, known, a):
    return ease(dofs, functions, t, h, known, a)


@entry
def _prescribe_push(dofs, functions, t, h, gamma, known, a):
    prescribe_push(dofs, functions, t, h, 1.0 - gamma, gamma, known, a)


@entry
def _prescribe_lasting(dofs, functions, t, h, known, a):
    prescribe_lasting(dofs, functions, t, h, known, a)


@entry
def _book_speeds(dofs, h, gamma, bends, known, v, a):
    book_speeds(dofs, h, 0.0, 0.0, gamma, bends, known, v, a)


@entry
def _work_of_push(dofs, h, known, q, v, moved, others, entered, scratch):
    return work_of_push(dofs, h, known, q, v, moved, others, entered, scratch)


def pushed(function, end, h=STEP, gamma=0.5, equal=True):
    """Changes of speed by a step that counts parts of the accelerations at its ends, the true ones, and which bend."""
    functions = compile_functions([function])
    degrees = Degrees(["driven", "free"], np.zeros(2), np.ones(2))
    degrees.prescribe(0, 0)
    dofs = assemble((), degrees, functions, np.zeros(2), [], []).dofs
    q, v, a = (np.full(2, x) for x in value_at(functions, 0, 0.0))
    first, total, found, true, bends, known = v[0], 0.0, [], [], [], np.zeros((OWED + 1, 2))
    for k in range(round(end / h)):
        t, speed, place = h * k, v[0], q[0]
        known[:3, 0], known[SPEED, 0] = a[0], v[0]
        bends.append(_prescribe_end(dofs, functions, t + h, h, equal, known, q, v, a))
        if bends[-1]:
            eased = known[BEFORE, 0] * np.ones(2)
            _ease(dofs, functions, t, h, known, eased)
            assert eased[0] == known[BEGIN, 0]
            _prescribe_push(dofs, functions, t, h, gamma, known, a)
        total += h * ((1.0 - gamma) * known[BEGIN, 0] + gamma * a[0])
        if bends[-1]:
            last = a.copy()
            _prescribe_lasting(dofs, functions, t + h, h, known, last)
            # Of a body of 2 kg on a spring of 3 N/m: inertia works by its impulse, the spring along the way.
            spring, began, mean = 3.0 * q, 2.0 * known[BEGIN, 0], 2.0 * (v[0] - speed) / h
            moved = spring + np.array([[mean, 0.0], [began, 0.0]])
            entered = np.array([[place, 0.0], [3.0 * place + began, 0.0]])
            work = _work_of_push(dofs, h, known, q, v, moved, spring, entered, np.zeros((2, 2)))
            # Of both what the energies change by.
            assert work == pytest.approx(v[0] ** 2 - speed**2 + 1.5 * (q[0] ** 2 - place**2), rel=1e-9, abs=1e-9)
            a = last
        _book_speeds(dofs, h, gamma, bends[-1], known, v, a)
        found.append(total)
        true.append(v[0] - first)
    return np.array(found), np.array(true), np.array(bends)


@pytest.mark.parametrize("gamma", [0.5, 0.5024])
@pytest.mark.parametrize("over", [1e-5, 1e-4, 9e-4, 1e-3, 2.3e-3, 6e-3])
@pytest.mark.parametrize("at", [0.02, 0.02001, 0.0203, 0.02099])
@pytest.mark.parametrize("kind", ["ramp", "table"])
def test_a_speed_that_changes_within_a_step_pushes_by_all_of_its_change_wherever_steps_end(kind, at, over, gamma):
    ramp = Ramp(**{"from": 25.0}, to=4.0, at=at, over=over)
    corners = Table(time=(0.0, at, at + over, 1.0), value=(25.0, 25.0, 4.0, 4.0), interpolation="linear")
    given = FunctionRequest(ramp if kind == "ramp" else corners, True, 1.0)
    found, true, bends = pushed(given, 0.04, gamma=gamma)
    # By accelerations at the ends of steps alone nothing of it was left, or ten times of it.
    assert true[-1] == pytest.approx(-21.0)
    assert np.max(np.abs(found - true)) < 0.05 * 21.0
    assert found[-1] == pytest.approx(true[-1], rel=0.01 if over < 2e-3 else 0.03)
    assert (over < 2e-3) <= bends.sum() <= 4 + over / STEP


def test_a_table_of_places_that_jumps_in_speed_pushes_by_each_jump():
    zigzag = Table(time=(0.0, 0.0103, 0.02, 0.0307, 1.0), value=(0.0, 0.01, 0.0, 0.02, 0.02), interpolation="linear")
    found, true, bends = pushed(FunctionRequest(zigzag), 0.04)
    assert found == pytest.approx(true, abs=1e-9)
    assert bends.sum() == 3


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("at", [0.02, 0.02 * (1.0 + 1e-15), 0.02 * (1.0 - 1e-15), 0.0203])
def test_a_table_that_ends_in_motion_before_the_run_does_is_stopped_by_one_push(at, interpolation):
    time = np.linspace(0.0, at, 41)
    table = Table(time=tuple(time), value=tuple(0.3 * time), interpolation=interpolation)
    found, true, bends = pushed(FunctionRequest(table), 0.04)
    assert found == pytest.approx(true, abs=1e-9)
    assert true[-1] == pytest.approx(-0.3)
    assert bends.sum() == 1


@pytest.mark.parametrize("end", [0.04, 0.04 * (1.0 + 1e-15), 0.04 * (1.0 - 1e-15)])
def test_no_step_stops_a_table_whose_last_row_is_at_the_end_of_the_run(end):
    time = np.linspace(0.0, end, 41)
    found, true, bends = pushed(FunctionRequest(Table(time=tuple(time), value=tuple(0.3 * time))), 0.04)
    assert (found[-1], true[-1]) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert not bends.any()


@pytest.mark.parametrize("steps", [6, 7, 9.3, 10, 50, 1000])
def test_what_is_smooth_is_left_as_it_is_to_the_bit(steps):
    found, true, bends = pushed(FunctionRequest(Harmonic(amplitude=0.3, period=steps * STEP)), 0.4)
    assert not bends.any()
    # One step makes too little of a change and another too much.
    assert found == pytest.approx(true, abs=max(0.06, 4.0 / steps**2) * np.ptp(true))


@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("steps", [4, 4.7, 7, 9, 12.5, 13, 50])
def test_of_a_sine_all_steps_are_pushed_or_none(steps, equal):
    # Where some were, what was carried was off by up to eleven times its range.
    found, true, bends = pushed(FunctionRequest(Harmonic(amplitude=0.3, period=steps * STEP)), 0.4, equal=equal)
    # One alone makes good that the swing began in its middle.
    assert bends[4:].all() or bends[4:].sum() <= (0 if equal else 1)
    assert equal or abs(np.mean(found - true)) < 1e-3 * np.ptp(true)
    assert bends[4:].all() == (steps < (5.2 if equal else 12.8))


@pytest.mark.parametrize("equal", [True, False])
def test_a_smooth_motion_that_one_step_makes_from_rest_to_rest_bends(equal):
    smooth = Ramp(**{"from": 0.0}, to=4.0, at=0.02, over=STEP)
    found, true, bends = pushed(FunctionRequest(smooth, True, 1.0), 0.04, equal=equal)
    # Accelerations are zero at both ends of its step, and two rules that integrate a cubic are right within it.
    assert bends.sum() == 1
    assert found[-1] == pytest.approx(true[-1], rel=1e-9)


@pytest.mark.parametrize("over", [2, 20])
def test_of_a_sine_of_seven_steps_that_grows_all_steps_are_pushed_or_none(over):
    # Where some of its steps were pushed by all of their change, what was carried drifted away.
    growing = Harmonic(amplitude=0.3, period=7 * STEP, ramp=over * 7 * STEP)
    _, _, bends = pushed(FunctionRequest(growing), 0.4)
    assert bends[3:].all() or not bends[3:].any()


@pytest.mark.parametrize("steps", [5, 8, 15, 60])
@pytest.mark.parametrize("off", [0.0, 0.3, 0.5, 0.9])
def test_a_smooth_ramp_of_a_few_steps_bends_nowhere_wherever_it_begins(steps, off):
    ramp = Ramp(**{"from": 25.0}, to=4.0, at=0.02 + off * STEP, over=steps * STEP)
    _, _, bends = pushed(FunctionRequest(ramp, True, 1.0), 0.1)
    assert not bends.any()


@pytest.mark.parametrize("equal", [True, False])
@pytest.mark.parametrize("to", [-1.0, 1.0])
@pytest.mark.parametrize("off", [0.0, 0.2, 0.66])
@pytest.mark.parametrize("steps", [1, 2, 3, 4, 5])
def test_two_smooth_ways_of_a_few_steps_each_leave_nothing_behind(steps, off, to, equal):
    # There and back, or on. Where some steps of a motion were pushed and others not, up to a third of a speed was left.
    first, length = 0.02 + off * STEP, steps * STEP
    ways = [Ramp(**{"from": 0.0}, to=1.0, at=first, over=length)]
    ways += [Ramp(**{"from": 0.0}, to=to, at=first + length, over=length)]
    found, true, _ = pushed(FunctionRequest(Sum(terms=tuple(ways))), 0.06, equal=equal)
    assert found[-10:] == pytest.approx(true[-10:], abs=0.01 * 1.875 / length)


def test_a_smooth_ramp_bends_nowhere_though_its_first_and_last_accelerations_are_next_to_nothing():
    ramp = Ramp(**{"from": 25.0}, to=4.0, at=0.0203, over=0.05)
    found, true, bends = pushed(FunctionRequest(ramp, True, 1.0), 0.09)
    assert not bends.any()
    assert found == pytest.approx(true, abs=0.02)
