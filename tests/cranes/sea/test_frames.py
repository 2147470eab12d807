"""Frames that move: places and exact derivatives, as Python has them and as the time loop has them."""

import math

import numpy as np
import pytest

from crane.sea.compensation import lift_of
from crane.sea.frames import GROUND, Frame, boom, motion_of, point_of, requests_of
from tautline.kernels.jit import entry
from tautline.kernels.moving_frame import ENTRIES
from tautline.kernels.time_function import evaluate, sample
from tautline.scene.errors import SceneError
from tautline.scene.functions import Constant, Harmonic, Ramp, Spectrum, Sum, Table, Velocity
from tautline.system.time_functions import FrameEntry, FunctionRequest, all_requests, compile_functions

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
UNTURNED = (1, 0, 0, 0, 1, 0, 0, 0, 1)


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
        assert np.allclose(
            point_of(value, VESSEL.pivot, (40.0, 5.0, 25.0)), moved_by_hand(t, VESSEL, (40.0, 5.0, 25.0)), atol=1e-12
        )


def test_a_boom_slews_then_luffs_in_its_parent_and_rides_on_it():
    t, x = 14.0, np.array([30.0, 1.0, 14.0])
    value = exact(FRAMES, np.array([t]))[0][0]
    for k in (2, 1, 0):
        x = moved_by_hand(t, FRAMES[k], x)
    assert np.allclose(point_of(value[2], JIB.pivot, (30.0, 1.0, 14.0)), x, atol=1e-12)


def test_a_boom_along_x_is_lowered_by_a_positive_luff_and_swung_to_y_by_slew():
    lowered = boom("boom", GROUND, (0.0, 0.0, 0.0), Constant(value=math.pi / 2), Constant(value=math.radians(30.0)))
    tip = point_of(exact((lowered,), np.zeros(1))[0][0, 0], lowered.pivot, (10.0, 0.0, 0.0))
    assert np.allclose(tip, (0.0, 10.0 * math.cos(math.radians(30.0)), -5.0), atol=1e-14)


@pytest.mark.parametrize("angle", [40.0, -75.0])
def test_a_lever_arm_rolls_in_closed_form_at_large_angles(angle):
    """y'' of an arm that rolls as q(t) is -l (cos q q'^2 + sin q q'') with its height likewise."""
    roll = Harmonic(amplitude=math.radians(angle), period=9.0)
    frame = Frame("vessel", GROUND, (0.0, 0.0, -10.0), (NIL, NIL, NIL, roll, NIL, NIL))
    t = np.linspace(0.0, 9.0, 61)
    q, dq, ddq = values_at((frame,), t)[0, 3].T
    place, speed, acceleration = (
        point_of(derivative[:, 0], frame.pivot, (0.0, 0.0, 30.0)) for derivative in exact((frame,), t)
    )
    # of a derivative the arm's constant part is nothing: C' + R' (x - p)
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


@entry
def _evaluate(functions, times, out):
    for i in range(out.shape[0]):
        for k in range(times.size):
            out[i, k, 0], out[i, k, 1], out[i, k, 2] = evaluate(functions, i, times[k])


def between(functions, times, frames=FRAMES):
    """What the time loop sees: value, rate and second rate (3, m, frames, 12)."""
    sampled = np.zeros((ENTRIES * len(frames), times.size, 3))
    _evaluate(functions, times, sampled)
    return sampled.reshape(len(frames), ENTRIES, times.size, 3).transpose(3, 2, 0, 1)


def test_the_loop_places_frames_as_the_product_of_their_rotations_does(compiled):
    """Two ways that share no code: compiled one by one, and matrices of all times with both derivatives."""
    times = np.random.default_rng(1).uniform(0.0, END, 400)
    for got, wanted in zip(between(compiled[1], times), exact(FRAMES, times), strict=True):
        assert np.abs(got - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_rotations_stay_orthonormal(compiled):
    times = np.random.default_rng(3).uniform(0.0, END, 400)
    for k in range(len(FRAMES)):
        assert departure(matrices(between(compiled[1], times)[0][:, k])) < 2e-15


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
    moving = [j for j, model in enumerate(models) if isinstance(model, FrameEntry)]
    assert moving == [2, ENTRIES + 2]
    assert [model.value for j, model in enumerate(models) if j not in moving] == [0, 0, *UNTURNED, 1, 0, *UNTURNED]


def test_what_is_to_be_driven_moves_though_the_scene_holds_it_still():
    still = (Frame("vessel", GROUND, (0.0, 0.0, -10.0)), boom("boom", 0, (1.0, 0.0, 0.0), NIL, NIL))
    assert not any(isinstance(request.model, FrameEntry) for request in requests_of(still, 12.0))
    requests = requests_of(still, 12.0, {"boom.slew"})
    assert {r.model.number for r in requests if isinstance(r.model, FrameEntry)} == {3, 4, 6, 7}
    names = [steering.name for request in all_requests(requests) for steering in request.inputs]
    assert names == ["boom.slew", "boom.slew_speed"]


def test_preparing_does_not_take_longer_for_a_longer_run():
    """Nothing is sampled over the run: as many functions and numbers for ten hours as for a minute."""
    sizes = []
    for end in (60.0, 36000.0):
        functions = compile_functions(requests_of(FRAMES, end))
        sizes.append([np.size(array) for array in functions[:-3]])
    assert sizes[0] == sizes[1]


def test_a_sea_of_two_hundred_waves_is_followed():
    sea = Spectrum(significant_height=2.5, peak_period=9.0, gamma=2.0, seed=7, rao=0.6)
    roll = Spectrum(significant_height=2.5, peak_period=9.0, gamma=2.0, seed=7, rao=0.03)
    frame = Frame("vessel", GROUND, (0.0, 0.0, -5.0), (NIL, NIL, sea, roll, NIL, NIL))
    requests = requests_of((frame,), 120.0)
    times = np.random.default_rng(2).uniform(0.0, 120.0, 500)
    got = between(compile_functions(requests), times, (frame,))
    for mine, wanted in zip(got, exact((frame,), times), strict=True):
        assert np.abs(mine - wanted).max() < 1e-12


def test_heave_is_what_the_vessel_does_and_not_what_the_boom_does():
    still = Frame("vessel", GROUND, (0.0, 0.0, 0.0))
    swinging = boom("boom", 0, (0.0, 0.0, 0.0), NIL, Ramp(to=-0.5, over=5.0))
    times = np.linspace(0.0, END, 57)
    unmoved = lift_of(requests_of((still, swinging), END), 1, 0, (10.0, 0.0, 0.0))
    assert not np.any(sample(compile_functions([FunctionRequest(unmoved)]), 0, times))
    heave = lift_of(requests_of(FRAMES, END), 1, 0, (30.0, 1.0, 20.0))
    got = sample(compile_functions([FunctionRequest(heave)]), 0, times)
    for order, derivative in enumerate(exact(FRAMES, times)):
        at_rest = exact((Frame("vessel", GROUND, VESSEL.pivot), BOOM), times)[order]
        moved, still = (point_of(each[:, 1], BOOM.pivot, (30.0, 1.0, 20.0)) for each in (derivative, at_rest))
        lift = moved - still
        assert np.allclose(got[:, order], lift[:, 2], atol=1e-12)


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        (Table(time=(0.0, 5.0, 10.0), value=(0.0, 1.0, 0.0), interpolation="linear"), "speed jumps at t = 5 s"),
        (Table(time=(2.0, 9.0), value=(0.0, 1.0)), "speed jumps at t = 2 s"),
    ],
)
def test_motions_that_jump_are_refused_by_name(motion, words):
    frame = boom("boom", GROUND, (0.0, 0.0, 0.0), motion, NIL, key="frames[0]")
    with pytest.raises(SceneError, match=words) as caught:
        requests_of((frame,), END)
    assert caught.value.problems[0].key in ("frames[0].slew", "frames[0]")


@pytest.mark.parametrize("beside", [0.0, 1e-15, -1e-15])
def test_a_frame_whose_table_ends_with_the_run_moves_to_the_end_as_the_motion_that_was_tabled(beside):
    time = np.linspace(0.0, 12.0, 241)
    heave = Table(time=tuple(time), value=tuple(0.5 * np.sin(0.25 * np.pi * time)))
    frame = Frame("vessel", GROUND, (0.0, 0.0, -10.0), (NIL, NIL, heave, NIL, NIL, NIL))
    end = 12.0 * (1.0 + beside)
    got = between(compile_functions(requests_of((frame,), end)), np.array([end]), (frame,))
    assert got[:2, 0, 0, 2] == pytest.approx([-10.0, -0.125 * np.pi], abs=1e-6)


@pytest.mark.parametrize("end", [400.0, 800.0, 1200.0, 3600.0])
def test_a_smooth_motion_is_not_refused_where_the_run_is_a_multiple_of_its_period(end):
    """At hundredths of such a run, and where its ramp ends, the sine of 8 s is nothing but rounding."""
    heave = Harmonic(amplitude=0.5, period=8.0, ramp=8.0)
    frame = Frame("vessel", GROUND, (0.0, 0.0, -10.0), (NIL, NIL, heave, NIL, NIL, NIL))
    times = np.linspace(8.0, end - 1.0, 1001)
    got = between(compile_functions(requests_of((frame,), end)), times, (frame,))
    assert np.abs(got[0, :, 0, 2] + 10.0 - 0.5 * np.sin(0.25 * np.pi * times)).max() < 1e-9


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


def test_a_child_before_its_parent_is_a_mistake_of_the_program():
    with pytest.raises(ValueError, match="before its parent"):
        exact((boom("boom", 1, (0.0, 0.0, 0.0), NIL, NIL), VESSEL), np.zeros(1))


def test_a_sum_of_motions_moves_as_one():
    parts = Sum(terms=(Ramp(to=0.3, over=2.0), Harmonic(amplitude=0.1, period=3.0, ramp=4.0)))
    frame = boom("boom", GROUND, (1.0, 2.0, 3.0), parts, NIL)
    times = np.linspace(0.0, 10.0, 101)
    got = between(compile_functions(requests_of((frame,), 10.0)), times, (frame,))
    assert np.abs(got[0] - exact((frame,), times)[0]).max() < 1e-10
