"""Frames that move: places, exact derivatives, and quintics between knots that keep to them."""

import math
import time as clock

import numpy as np
import pytest

from crane.sea.frames import GROUND, Frame, boom, heave_of, motion_of, point_of, requests_of
from tautline.kernels.moving_frame import ENTRIES
from tautline.kernels.time_function import sample
from tautline.scene.errors import SceneError
from tautline.scene.functions import Constant, Harmonic, Ramp, Spectrum, Sum, Table, Velocity
from tautline.system.time_functions import FunctionRequest, Samples, compile_functions

END = 30.0
NIL = Constant(value=0.0)
VESSEL = Frame(
    "vessel",
    GROUND,
    (3.0, -2.0, -10.0),
    (
        Harmonic(amplitude=1.5, period=11.0, phase=0.4),
        Harmonic(amplitude=0.7, period=9.0, ramp=6.0),
        Harmonic(amplitude=0.5, period=8.0, ramp=8.0),
        Harmonic(amplitude=0.5, period=7.0, phase=1.0, mean=0.1),
        Harmonic(amplitude=0.3, period=6.0, phase=2.0),
        Ramp(rate=0.05, over=3.0),
    ),
)
BOOM = boom("boom", 0, (0.5, 0.0, 2.0), Ramp(rate=0.25, over=2.0, at=1.3), Ramp(to=-0.8, over=9.0, at=4.0))
JIB = boom("jib", 1, (20.0, 0.0, 12.0), NIL, Harmonic(amplitude=0.2, period=12.0, ramp=5.0))
FRAMES = (VESSEL, BOOM, JIB)


def values_at(frames, times):
    functions = compile_functions([FunctionRequest(motion) for frame in frames for motion in frame.motion])
    sampled = [sample(functions, i, times) for i in range(6 * len(frames))]
    return np.array(sampled).reshape(len(frames), 6, times.size, 3)


def exact(frames, times):
    return motion_of(frames, values_at(frames, times))


def moved_by_hand(t, frame, x):
    """Vessel-like frame, written out in angles."""
    surge, sway, heave, roll, pitch, yaw = values_at((frame,), np.array([t]))[0, :, 0, 0]
    x, y, z = np.asarray(x) - frame.pivot
    y, z = y * math.cos(roll) - z * math.sin(roll), y * math.sin(roll) + z * math.cos(roll)
    x, z = x * math.cos(pitch) + z * math.sin(pitch), -x * math.sin(pitch) + z * math.cos(pitch)
    x, y = x * math.cos(yaw) - y * math.sin(yaw), x * math.sin(yaw) + y * math.cos(yaw)
    return np.array(frame.pivot) + (surge, sway, heave) + (x, y, z)


def matrices(entries):
    return entries[..., 3:].reshape(*entries.shape[:-1], 3, 3).swapaxes(-1, -2)


def test_the_vessel_turns_about_its_reference_by_roll_then_pitch_then_yaw():
    for t in (0.0, 3.3, 17.0):
        value = exact(FRAMES, np.array([t]))[0][0, 0]
        assert np.allclose(point_of(value, (40.0, 5.0, 25.0)), moved_by_hand(t, VESSEL, (40.0, 5.0, 25.0)), atol=1e-12)


def test_a_boom_slews_then_luffs_in_its_parent_and_rides_on_it():
    t, x = 14.0, np.array([30.0, 1.0, 14.0])
    value = exact(FRAMES, np.array([t]))[0][0]
    for k in (2, 1, 0):
        x = moved_by_hand(t, FRAMES[k], x)
    assert np.allclose(point_of(value[2], (30.0, 1.0, 14.0)), x, atol=1e-12)


def test_a_boom_along_x_is_lowered_by_a_positive_luff_and_swung_to_y_by_slew():
    lowered = boom("boom", GROUND, (0.0, 0.0, 0.0), Constant(value=math.pi / 2), Constant(value=math.radians(30.0)))
    tip = point_of(exact((lowered,), np.zeros(1))[0][0, 0], (10.0, 0.0, 0.0))
    assert np.allclose(tip, (0.0, 10.0 * math.cos(math.radians(30.0)), -5.0), atol=1e-14)


@pytest.mark.parametrize("angle", [40.0, -75.0])
def test_a_lever_arm_rolls_in_closed_form_at_large_angles(angle):
    """y'' of an arm that rolls as q(t) is -l (cos q q'^2 + sin q q'') with its height likewise."""
    roll = Harmonic(amplitude=math.radians(angle), period=9.0)
    frame = Frame("vessel", GROUND, (0.0, 0.0, -10.0), (NIL, NIL, NIL, roll, NIL, NIL))
    t = np.linspace(0.0, 9.0, 61)
    q, dq, ddq = values_at((frame,), t)[0, 3].T
    place, speed, acceleration = (point_of(derivative[:, 0], (0.0, 0.0, 30.0)) for derivative in exact((frame,), t))
    # of a derivative the arm's constant part is nothing: O' + R' x
    assert np.allclose(place[:, 1:], np.column_stack((-40.0 * np.sin(q), -10.0 + 40.0 * np.cos(q))), atol=1e-12)
    assert np.allclose(speed[:, 1:], np.column_stack((-40.0 * np.cos(q) * dq, -40.0 * np.sin(q) * dq)), atol=1e-12)
    a_y = 40.0 * (np.sin(q) * dq**2 - np.cos(q) * ddq)
    a_z = -40.0 * (np.cos(q) * dq**2 + np.sin(q) * ddq)
    assert np.allclose(acceleration[:, 1:], np.column_stack((a_y, a_z)), atol=1e-11)


def test_rates_are_those_of_finite_differences():
    t, h = np.linspace(0.5, END - 0.5, 83), 2e-3
    stencil = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    value, rate, second = exact(FRAMES, t)

    def difference(order):
        derivatives = {k: exact(FRAMES, t + k * h)[order] - exact(FRAMES, t - k * h)[order] for k in stencil}
        return sum(weight * derivatives[k] for k, weight in stencil.items()) / h

    # beside the end of a ramp a difference straddles a corner of the third derivative
    corners = np.array([1.3, 3.0, 3.3, 4.0, 5.0, 6.0, 8.0, 13.0])
    smooth = np.abs(t[:, None] - corners).min(axis=1) > 4 * h
    assert np.allclose(rate[smooth], difference(0)[smooth], rtol=1e-9, atol=1e-9)
    assert np.allclose(second[smooth], difference(1)[smooth], rtol=1e-9, atol=1e-9)
    assert np.abs(value).max() > 1.0


@pytest.fixture(scope="module")
def compiled():
    requests = requests_of(FRAMES, END)
    return requests, compile_functions(requests)


def between(functions, times, frames=FRAMES):
    sampled = np.array([sample(functions, j, times) for j in range(ENTRIES * len(frames))])
    return sampled.reshape(len(frames), ENTRIES, times.size, 3).transpose(3, 2, 0, 1)


def test_quintics_keep_to_the_motion_between_knots(compiled):
    times = np.random.default_rng(1).uniform(0.0, END, 4000)
    value, rate, second = between(compiled[1], times)
    wanted = exact(FRAMES, times)
    moved = np.abs(wanted[0] - wanted[0][:1]).max(axis=(0, 2))
    assert np.all(np.abs(value - wanted[0]).max(axis=(0, 2)) < 1e-11 * moved)
    assert np.abs(rate - wanted[1]).max() < 1e-9 * np.abs(wanted[1]).max()
    assert np.abs(second - wanted[2]).max() < 1e-6 * np.abs(wanted[2]).max()


def test_rotations_stay_orthonormal_at_knots_and_between(compiled):
    for k in range(len(FRAMES)):
        knots = compiled[0][ENTRIES * k + 3].model.time[:-1]
        at_knots, halfway = (
            matrices(between(compiled[1], times)[0][:, k]) for times in (knots, 0.5 * (knots[1:] + knots[:-1]))
        )
        assert departure(at_knots) < 2e-14 and departure(halfway) < 5e-11


def departure(turn):
    """From being orthonormal."""
    return np.abs(turn @ turn.swapaxes(-1, -2) - np.eye(3)).max()


def test_the_motion_goes_on_at_the_very_end_and_is_there_at_the_start(compiled):
    for t in (0.0, END, END + 1e-9):
        got, wanted = between(compiled[1], np.array([t])), exact(FRAMES, np.array([t]))
        assert all(np.allclose(a, b, atol=1e-7) for a, b in zip(got, wanted, strict=True))


def test_what_does_not_move_is_constant():
    heaving = Frame("vessel", GROUND, (0.0, 0.0, -10.0), (NIL, NIL, VESSEL.motion[2], NIL, NIL, NIL))
    models = [request.model for request in requests_of((heaving, boom("boom", 0, (1.0, 0.0, 0.0), NIL, NIL)), 12.0)]
    moving = [j for j, model in enumerate(models) if isinstance(model, Samples)]
    assert moving == [2, ENTRIES + 2]
    assert [model.value for j, model in enumerate(models) if j not in moving] == 2 * [0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]


def test_there_are_about_seventy_knots_a_period_and_none_too_many(compiled):
    heave = Frame("vessel", GROUND, (0.0, 0.0, 0.0), (NIL, NIL, Harmonic(amplitude=1.0, period=5.0), NIL, NIL, NIL))
    knots = requests_of((heave,), 50.0)[2].model.time
    assert 600 < knots.size < 1400
    assert compiled[0][2 * ENTRIES].model.time.size < 4000


def test_a_sea_of_two_hundred_waves_is_followed_within_seconds():
    sea = Spectrum(significant_height=2.5, peak_period=9.0, gamma=2.0, seed=7, rao=0.6)
    roll = Spectrum(significant_height=2.5, peak_period=9.0, gamma=2.0, seed=7, rao=0.03)
    frame = Frame("vessel", GROUND, (0.0, 0.0, -5.0), (NIL, NIL, sea, roll, NIL, NIL))
    began = clock.perf_counter()
    requests = requests_of((frame,), 120.0)
    assert clock.perf_counter() - began < 20.0
    times = np.random.default_rng(2).uniform(0.0, 120.0, 500)
    got = between(compile_functions(requests), times, (frame,))
    assert np.abs(got[0] - exact((frame,), times)[0]).max() < 1e-10


def test_heave_is_what_the_vessel_does_and_not_what_the_boom_does():
    still = Frame("vessel", GROUND, (0.0, 0.0, 0.0))
    swinging = boom("boom", 0, (0.0, 0.0, 0.0), NIL, Ramp(to=-0.5, over=5.0))
    assert heave_of((still, swinging), 0, 1, (10.0, 0.0, 0.0), END) == NIL
    assert heave_of((still, swinging), 0, GROUND, (10.0, 0.0, 0.0), END) == NIL
    heave = heave_of(FRAMES, 0, 1, (30.0, 1.0, 20.0), END)
    times = np.linspace(0.0, END, 57)
    got = sample(compile_functions([FunctionRequest(heave)]), 0, times)
    for order, derivative in enumerate(exact(FRAMES, times)):
        at_rest = exact((Frame("vessel", GROUND, VESSEL.pivot), BOOM), times)[order]
        lift = point_of(derivative[:, 1], (30.0, 1.0, 20.0)) - point_of(at_rest[:, 1], (30.0, 1.0, 20.0))
        assert np.allclose(got[:, order], lift[:, 2], atol=1e-7)


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        (Table(time=(0.0, 5.0, 10.0), value=(0.0, 1.0, 0.0), interpolation="linear"), "speed jumps at t = 5 s"),
        (Table(time=(2.0, 9.0), value=(0.0, 1.0)), "speed jumps at t = 2 s"),
        (Harmonic(amplitude=1.0, period=1e-4), "more than 1000000 knots"),
        (Ramp(rate=1e6, over=1.0), "more than 1000000 knots"),
    ],
)
def test_motions_that_jump_or_cannot_be_followed_are_refused_by_name(motion, words):
    frame = boom("boom", GROUND, (0.0, 0.0, 0.0), motion, NIL, key="frames[0]")
    with pytest.raises(SceneError, match=words) as caught:
        requests_of((frame,), END)
    assert caught.value.problems[0].key in ("frames[0].slew", "frames[0]")


@pytest.mark.parametrize("end", [400.0, 800.0, 1200.0, 3600.0])
def test_a_smooth_motion_is_not_refused_where_the_run_is_a_multiple_of_its_period(end):
    """At hundredths of such a run, and where its ramp ends, the sine of 8 s is nothing but rounding."""
    heave = Harmonic(amplitude=0.5, period=8.0, ramp=8.0)
    frame = Frame("vessel", GROUND, (0.0, 0.0, -10.0), (NIL, NIL, heave, NIL, NIL, NIL))
    times = np.linspace(8.0, end - 1.0, 1001)
    got = between(compile_functions(requests_of((frame,), end)), times, (frame,))
    assert np.abs(got[0, :, 0, 2] - 0.5 * np.sin(0.25 * np.pi * times)).max() < 1e-9


def test_a_short_smooth_move_in_a_long_run_is_not_refused():
    frame = boom("boom", GROUND, (0.0, 0.0, 0.0), Table(time=(0.0, 4.0, 5.0, 6.0), value=(0.0, 0.0, 0.1, 0.1)), NIL)
    assert requests_of((frame,), 4000.0)


def test_a_slew_given_by_a_table_of_speeds_may_jump_in_acceleration():
    speeds = Table(time=(0.0, 2.0, 3.0, 8.0, 9.0), value=(0.0, 0.0, 0.2, 0.2, 0.0))
    frame = boom("boom", GROUND, (0.0, 0.0, 0.0), Velocity(velocity=speeds), NIL)
    times = np.setdiff1d(np.linspace(0.0, 12.0, 241), [2.0, 3.0, 8.0, 9.0])
    got = between(compile_functions(requests_of((frame,), 12.0)), times, (frame,))
    wanted = exact((frame,), times)
    assert np.abs(got[0] - wanted[0]).max() < 1e-10 and np.abs(got[2] - wanted[2]).max() < 1e-6


def test_breaks_that_differ_by_rounding_make_no_noise():
    """Between knots 1e-15 s apart a quintic's second derivative would be anything."""
    parts = [Ramp(to=0.1, over=over) for over in (8.0, 8.000000000000002, 7.99999999)]
    frame = Frame("vessel", GROUND, (100.0, 0.0, 0.0), (*(NIL,) * 3, *parts))
    times = 8.0 + np.linspace(-1e-7, 1e-7, 4001)
    got = between(compile_functions(requests_of((frame,), 12.0)), times, (frame,))
    assert np.abs(got[2] - exact((frame,), times)[2]).max() < 1e-4
    knots = requests_of((frame,), 12.0)[3].model.time
    assert np.diff(knots).min() >= 5e-5


def test_a_child_before_its_parent_is_a_mistake_of_the_program():
    with pytest.raises(ValueError, match="before its parent"):
        exact((boom("boom", 1, (0.0, 0.0, 0.0), NIL, NIL), VESSEL), np.zeros(1))


def test_a_sum_of_motions_moves_as_one():
    parts = Sum(terms=(Ramp(to=0.3, over=2.0), Harmonic(amplitude=0.1, period=3.0, ramp=4.0)))
    frame = boom("boom", GROUND, (1.0, 2.0, 3.0), parts, NIL)
    times = np.linspace(0.0, 10.0, 101)
    got = between(compile_functions(requests_of((frame,), 10.0)), times, (frame,))
    assert np.abs(got[0] - exact((frame,), times)[0]).max() < 1e-10
