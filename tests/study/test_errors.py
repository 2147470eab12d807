"""Errors of made-up histories, whose lag, amplitude and distance are known: no run, no solver."""

import numpy as np
import pytest

from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.variable import Variable
from tautline.study.trials.errors import compare, ends_apart, first_mode
from tautline.study.trials.history import History, watch

OMEGA, AMPLITUDE = 2.0 * np.pi, 0.02
TIME = np.linspace(0.0, 10.0, 501)


def swing(time=TIME, omega=OMEGA, lag=0.0, amplitude=AMPLITUDE, force=30.0, axis=(1.0, 0.0, 0.0), mean=500.0):
    """A point that swings about (1, 2, 3) along an axis, and a force about a mean."""
    angle = omega * np.asarray(time) - lag
    way = amplitude * np.cos(angle)[:, None] * np.asarray(axis)
    return History(np.asarray(time, float), np.array([1.0, 2.0, 3.0]) + way, mean + force * np.cos(angle))


# phase
@pytest.mark.parametrize("lag", [1e-6, 1e-3, 0.05, 0.7, 2.5, -0.3])
def test_the_phase_of_a_motion_that_is_late_by_an_angle_is_that_angle(lag):
    assert compare(swing(lag=lag), swing(), 1.0).phase == pytest.approx(abs(lag), rel=2e-3, abs=1e-9)


def test_a_motion_whose_frequency_is_off_has_the_phase_of_the_middle_of_its_record():
    """Hann's window is even: of a lag that grows with time its mean counts, 1 % of the turn after five periods."""
    assert compare(swing(omega=1.001 * OMEGA), swing(), 1.0).phase == pytest.approx(0.001 * OMEGA * 5.0, rel=2e-2)


def test_the_phase_is_that_of_the_strongest_direction_whatever_else_moves():
    skew = np.array([0.3, -0.9, 0.3])
    assert compare(swing(axis=skew, lag=0.2), swing(axis=skew), 1.0).phase == pytest.approx(0.2, rel=2e-3)


def test_a_motion_in_a_circle_has_a_phase():
    circle, late = (
        History(TIME, np.stack([np.cos(OMEGA * TIME - lag), np.sin(OMEGA * TIME - lag), 0 * TIME], 1), np.zeros(0))
        for lag in (0.0, 0.1)
    )
    assert compare(late, circle, 1.0).phase == pytest.approx(0.1, rel=5e-3)


@pytest.mark.parametrize("periods", [0.3, 1.0, 1.6])
def test_what_does_not_last_two_periods_has_no_phase(periods):
    time = np.linspace(0.0, periods, 200)
    assert compare(swing(time, lag=0.1), swing(time), 1.0).phase is None


def test_a_steady_way_has_no_phase():
    going = History(TIME, np.outer(TIME, [1.0, 0.0, 0.0]), np.zeros(0))
    assert compare(going, going, 1.0).phase in (None, 0.0)


def test_noise_without_a_line_of_its_own_has_no_first_mode():
    noise = np.random.default_rng(2).standard_normal(4001)
    assert first_mode(np.linspace(0.0, 100.0, 4001), noise) is None


# first mode
@pytest.mark.parametrize("omega", [1.7, OMEGA, 11.3, 61.0])
def test_the_first_mode_of_one_vibration_is_its_frequency(omega):
    assert first_mode(TIME, np.sin(omega * TIME)) == pytest.approx(omega, rel=2e-3)


def test_the_first_mode_of_several_is_the_strongest_and_not_the_slowest():
    motion = 0.4 * np.sin(3.0 * TIME) + np.sin(9.0 * TIME) + 0.5 * np.sin(30.0 * TIME)
    assert first_mode(TIME, motion) == pytest.approx(9.0, rel=5e-3)


def test_the_first_mode_is_seen_beside_a_mean_and_when_it_dies_away():
    assert first_mode(TIME, 1e3 + np.exp(-0.1 * TIME) * np.cos(9.0 * TIME)) == pytest.approx(9.0, rel=5e-3)


def test_what_rests_has_no_first_mode():
    assert first_mode(TIME, np.full_like(TIME, 7.0)) is None


def test_a_creep_with_a_small_vibration_on_it_has_no_first_mode():
    """The vibration makes up a twentieth of what moves: its phase says nothing about the motion."""
    assert first_mode(TIME, TIME / 10.0 + 0.02 * np.sin(9.0 * TIME)) is None


# position
def test_the_position_error_is_the_largest_distance_over_the_largest_way():
    """Of two cosines that are apart by a small lag: A lag over the 2 A that it goes; frames miss the top."""
    found = compare(swing(lag=1e-3), swing(), 1.0)
    assert found.position == pytest.approx(0.5e-3, rel=5e-3)


def test_the_way_counts_from_where_the_point_began_and_not_from_the_origin():
    far = [History(h.time, h.position + 1e4, h.force) for h in (swing(lag=1e-2), swing())]
    assert compare(*far, 1.0).position == pytest.approx(0.5e-2, rel=5e-3)


def test_a_point_that_stays_elsewhere_is_wrong_by_its_distance():
    moved = History(TIME, swing().position + np.array([0.0, 0.0, 0.03]), swing().force)
    assert compare(moved, swing(), 1.0).position == pytest.approx(0.03 / (2 * AMPLITUDE), rel=1e-3)


def test_a_point_that_should_rest_is_judged_against_the_scene():
    """It rests, and the run has it move by a hundred-thousandth of the scene: that is no rounding, and no zero."""
    rests = History(TIME, np.tile([1.0, 2.0, 3.0], (TIME.size, 1)), np.zeros(0))
    rounding = History(TIME, rests.position + 1e-16, np.zeros(0))
    assert compare(rests, rests, 10.0).position == 0.0
    assert compare(rounding, rests, 10.0).position < 1e-6
    stirs = History(TIME, rests.position + 1e-4 * np.cos(TIME)[:, None], np.zeros(0))
    assert compare(stirs, rests, 10.0).position > 1.0
    assert np.isfinite(compare(stirs, rests, 0.0).position)


def test_rmse_is_the_thesis_mean_of_the_distance_from_the_origin():
    """Eqs 2.172 and 2.173 of two points on the x axis at a + b: the root of the mean square of b."""
    one = History(TIME, np.outer(2.0 + 0.1 * np.sin(TIME), [1.0, 0.0, 0.0]), np.zeros(0))
    other = History(TIME, np.outer(2.0 + 0.1 * np.sin(TIME) + 0.003, [1.0, 0.0, 0.0]), np.zeros(0))
    assert compare(other, one, 1.0).rmse == pytest.approx(0.003)
    turned = History(TIME, one.position[:, [1, 0, 2]], np.zeros(0))
    # A point at the same distance in another direction is right by 2.173, and plainly elsewhere.
    assert compare(turned, one, 1.0).rmse == pytest.approx(0.0, abs=1e-15)
    assert compare(turned, one, 1.0).position > 1.0


# force
@pytest.mark.parametrize("factor", [0.0, 0.9, 1.0, 1.25])
def test_the_force_error_is_that_of_its_amplitude(factor):
    assert compare(swing(force=30.0 * factor), swing(), 1.0).force == pytest.approx(abs(factor - 1.0), abs=1e-4)


def test_a_scene_without_a_force_has_no_force_error():
    bare = swing()._replace(force=np.zeros(0))
    assert compare(bare, bare, 1.0).force is None


def test_a_steady_force_that_a_run_makes_ring_is_wrong():
    # 30 N in 500 N, by a hundredth of these
    assert compare(swing(), swing(force=0.0), 1.0).force == pytest.approx(6.0)


def test_a_force_that_hardly_varies_is_judged_by_a_hundredth_of_its_size():
    # The foot valve of a riser: 0.45 N in 5062 N, of which 0.21 N are missing.
    exact, wrong = (swing(force=size, mean=5062.0) for size in (0.45, 0.24))
    assert compare(wrong, exact, 1.0).force == pytest.approx(0.21 / 50.62, rel=1e-3)
    assert ends_apart(wrong.force, exact.force) == pytest.approx(0.21 / 50.62, rel=1e-3)


def test_a_force_that_should_be_zero_throughout_and_is_not_is_wrong():
    nothing = swing(force=0.0, mean=0.0)
    assert compare(nothing, nothing, 1.0).force == 0.0
    assert compare(swing(force=5.0, mean=0.0), nothing, 1.0).force == np.inf


# frames
@pytest.mark.parametrize("count", [77, 251, 502, 1999])
def test_frames_at_other_times_are_compared_where_they_are(count):
    """The reference between its frames is a cubic spline: fifty of them a period leave 5 h^4 omega^4 / 384 = 3e-6."""
    time = np.linspace(0.0, 10.0, count)
    found = compare(swing(time), swing(), 1.0)
    assert found.position < 1e-4 and found.rmse < 1e-6 and (found.phase or 0.0) < 1e-4


def test_frames_at_other_times_show_the_same_lag():
    time = np.linspace(0.0, 10.0, 333)
    assert compare(swing(time, lag=0.05), swing(), 1.0).phase == pytest.approx(0.05, rel=5e-3)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_few_frames_are_compared_without_a_phase(count):
    time = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.0])
    few, exact = swing(time, lag=0.3), swing(time)
    found = compare(few, exact, 1.0)
    assert found.phase is None and np.isfinite([found.position, found.rmse]).all()
    distance = np.linalg.norm(few.position - exact.position, axis=1).max()
    way = np.linalg.norm(exact.position - exact.position[0], axis=1).max() or 1e-9
    assert found.position == pytest.approx(distance / way)


def test_a_few_frames_of_a_reference_are_joined_by_lines():
    straight = History(np.array([0.0, 1.0, 2.0]), np.outer([0.0, 1.0, 2.0], [1.0, 0.0, 0.0]), np.array([0.0, 1.0, 2.0]))
    between = History(np.array([0.5, 1.5]), np.outer([0.5, 1.5], [1.0, 0.0, 0.0]), np.array([0.5, 1.5]))
    found = compare(between, straight, 1.0)
    assert found.position == pytest.approx(0.0, abs=1e-15) and found.force == pytest.approx(0.0, abs=1e-15)


# what is looked at
def result_of(moves, forces=None, names=("a", "b", "c"), dims="node", more=()):
    """A result whose nodes swing by ``moves`` m along x, with forces in elements that vary by ``forces`` N."""
    time = np.linspace(0.0, 1.0, 41)
    turn = np.sin(2 * np.pi * time)
    where = np.arange(len(moves), dtype=float)[None, :, None] * np.array([0.0, 0.0, 2.0])
    position = where + (turn[:, None] * np.asarray(moves))[:, :, None] * np.array([1.0, 0.0, 0.0])
    variables = [Variable("time", ("time",), "s", ""), Variable("position", ("time", dims, "axis"), "m", "")]
    arrays = {"time": time, "position": position}
    if forces is not None:
        variables.append(Variable("axial_force", ("time", "element"), "N", ""))
        arrays["axial_force"] = 100.0 + turn[:, None] * np.asarray(forces)
    for name, values in more:
        variables.append(Variable(name, ("time", "body", "axis") if values.ndim == 3 else ("time", "axis"), "m", ""))
        arrays[name] = values
    coordinates = {dims: (dims, np.array(names), "", "")}
    return Result(None, (variables, arrays, coordinates, {}, {}))


def test_the_far_end_is_looked_at_where_it_moves():
    seen = watch(result_of([0.0, 0.5, 0.1], [1.0, 7.0]))
    assert (seen.point.label, seen.force.label) == ("c", "2")
    assert seen.extent == pytest.approx(4.0)


def test_what_moves_most_between_the_ends_is_looked_at_where_the_far_end_is_held():
    assert watch(result_of([0.0, 0.2, 0.5, 0.1, 0.0], names=list("abcde"))).point.label == "c"


def test_a_point_is_looked_at_by_its_name():
    seen = watch(result_of([0.0, 0.5, 0.1]), "b")
    assert seen.of(result_of([0.0, 0.5, 0.1])).position[:, 0].max() == pytest.approx(0.5)


def test_a_name_that_nothing_has_is_refused_with_those_that_there_are():
    with pytest.raises(ResultError, match=r"nothing is called 'z'.*a, b, c") as error:
        watch(result_of([0.0, 0.5, 0.1]), "z")
    assert str(error.value.path) == "--point"


def test_a_result_without_positions_is_refused():
    bare = Result(None, ([Variable("time", ("time",), "s", "")], {"time": np.zeros(1)}, {}, {}, {}))
    with pytest.raises(ResultError, match="no positions"):
        watch(bare)


def test_a_scene_without_forces_is_looked_at_without():
    seen = watch(result_of([0.0, 0.5, 0.1]))
    assert seen.force is None and seen.of(result_of([0.0, 0.5, 0.1])).force.size == 0


def test_bodies_come_before_nodes_and_the_one_that_moves_most_is_looked_at():
    time = np.linspace(0.0, 1.0, 41)
    bodies = np.zeros((41, 2, 3))
    bodies[:, 0, 2] = 3.0 * time
    seen = watch(result_of([0.0, 0.5, 0.1], more=[("body_position", bodies)]))
    assert (seen.point.variable, seen.point.label) == ("body_position", "1")


def test_the_middle_of_a_mesh_stays_the_middle_when_the_mesh_is_halved_or_doubled():
    """A straight line whose nodes move in proportion to their place: any mesh has the same point at a half."""
    seen = watch(result_of([0.0, 1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 4.0], names=list("01234")), "2")
    fine = result_of(np.arange(9) / 2.0, np.arange(1, 9) / 2.0, names=[str(i) for i in range(9)])
    coarse = result_of([0.0, 2.0, 4.0], names=list("012"))
    assert seen.of(fine).position[:, 0].max() == pytest.approx(2.0)
    assert watch(result_of([0.0, 1.0, 2.0, 3.0, 4.0], names=list("01234")), "2").of(coarse).position[:, 0].max() == 2.0
    # The fourth of four elements, at 7/8 of the line, lies between the seventh and the eighth of eight.
    assert np.ptp(seen.of(fine).force) == pytest.approx(2.0 * (3.5 + 4.0) / 2.0)
