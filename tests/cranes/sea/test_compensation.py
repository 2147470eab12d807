"""Active heave compensation: at its command below its limits, within them always."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from of_the_suite import kept

from crane.sea.compensation import compensate, lift_of, unlimited
from crane.sea.frames import GROUND, Frame, boom, requests_of
from crane.sea.mru import read_motions
from tautline.kernels.jit import entry
from tautline.kernels.time_function import evaluate, sample
from tautline.scene.functions import Constant, Harmonic, Spectrum
from tautline.system.time_functions import FrameLift, FunctionRequest, compile_functions

END = 40.0
ROUNDING = 1e-9
NIL = Constant(value=0.0)
WAVE = Harmonic(amplitude=1.0, period=8.0, ramp=8.0)
SEA = Spectrum(significant_height=2.5, peak_period=9.0, gamma=2.0, seed=7, rao=0.6, ramp=10.0)


@dataclass(frozen=True)
class Limits:
    stroke: float | None = None
    speed: float | None = None
    acceleration: float | None = None


@cache
def compensated(name, gain, delay, limits):
    """The compensation of a heave, which several tests look at."""
    return compensate(HEAVES[name], gain, delay, limits, END)


def heave(model, end=END):
    frame = Frame("vessel", GROUND, (0.0, 0.0, 0.0), (NIL, NIL, model, NIL, NIL, NIL))
    return lift_of(requests_of((frame,), end), 0, 0, (10.0, 0.0, 20.0))


HEAVES = {"wave": heave(WAVE), "sea": heave(SEA)}


def sampled(model, times, factor=1.0):
    return sample(compile_functions([FunctionRequest(model, factor=factor)]), 0, times)


def commanded(model, gain, delay, times):
    return sampled(model, times - delay, gain)


def times(end=END, n=40001):
    """Neither at the steps nor between them."""
    return np.linspace(0.0, end, n)


def assert_within(compensation, limits, end=END):
    moved = np.abs(sampled(compensation.place, times(end))).max(axis=0)
    for most, limit in zip(moved, (limits.stroke, limits.speed, limits.acceleration), strict=True):
        assert limit is None or most <= limit * (1.0 + ROUNDING)


@pytest.mark.parametrize("name", HEAVES)
@pytest.mark.parametrize("gain", [0.95, 1.0])
@pytest.mark.parametrize("delay", [0.0, 0.1, 0.37])
def test_below_its_limits_it_pays_out_gain_times_the_heave_of_a_while_ago(name, gain, delay):
    limits = Limits(4.0, 2.0, 2.0)
    compensation = compensate(HEAVES[name], gain, delay, limits, END)
    got, wanted = sampled(compensation.pay_out, times()), commanded(HEAVES[name], gain, delay, times())
    assert np.abs(got[:, 0] - wanted[:, 0]).max() < 1e-9
    assert np.abs(got[:, 1] - wanted[:, 1]).max() < 1e-6 and np.abs(got[:, 2] - wanted[:, 2]).max() < 1e-4
    assert compensation.away == 0.0 and compensation.error == 0.0 and not any(compensation.met.values())
    assert_within(compensation, limits)


@pytest.mark.parametrize("name", HEAVES)
def test_in_a_run_that_ends_as_the_heave_is_first_answered_it_stands_still(name):
    delay = 0.1
    compensation = compensate(HEAVES[name], 0.9, delay, Limits(), delay)
    assert np.abs(sampled(compensation.pay_out, np.linspace(0.0, delay, 7))).max() < 1e-9


def test_limits_that_are_just_not_met_change_nothing():
    w = 2.0 * np.pi / 8.0
    limits = Limits(1.0001, 1.0001 * w, 1.0001 * w * w)
    plain = heave(Harmonic(amplitude=1.0, period=8.0))
    compensation = compensate(plain, 1.0, 0.0, limits, END)
    assert compensation.away == 0.0 and compensation.met == {"stroke": 0.0, "speed": 0.0, "acceleration": 0.0}


def test_without_limits_there_is_no_actuator_to_see():
    compensation = compensate(HEAVES["sea"], 0.95, 0.1, Limits(), END)
    got, wanted = sampled(compensation.pay_out, times()), commanded(HEAVES["sea"], 0.95, 0.1, times())
    assert np.abs(got[:, 0] - wanted[:, 0]).max() < 1e-9


SATURATED = {
    "stroke": Limits(stroke=0.5),
    "speed": Limits(speed=0.5),
    "acceleration": Limits(acceleration=0.3),
    "stroke, not to be stopped at once": Limits(stroke=0.5, acceleration=1.0),
    "all three": Limits(0.4, 0.3, 0.25),
    "a crawl": Limits(speed=0.01, acceleration=2.0),
    "a hair": Limits(stroke=0.001),
    "a feeble actuator": Limits(acceleration=0.01),
}


@pytest.mark.parametrize("limits", SATURATED.values(), ids=SATURATED)
@pytest.mark.parametrize("name", HEAVES)
def test_no_limit_is_ever_exceeded_and_those_met_are_told(name, limits):
    compensation = compensated(name, 0.95, 0.1, limits)
    assert_within(compensation, limits)
    for limit, share in compensation.met.items():
        if getattr(limits, limit) is None and limit != "acceleration":
            assert share == 0.0
    assert 0.0 < compensation.away <= 1.0 and sum(compensation.met.values()) <= compensation.away + 1e-12
    assert max(compensation.met.values()) > 0.0
    got = sampled(compensation.place, times())
    off = np.abs(got[:, 0] - commanded(HEAVES[name], 0.95, 0.1, times())[:, 0])
    assert off.max() == pytest.approx(compensation.error, rel=1e-3)


@pytest.mark.parametrize("limits", [Limits(stroke=0.55), Limits(speed=0.6), Limits(stroke=0.55, acceleration=2.0)])
def test_it_joins_its_command_again_after_a_limit(limits):
    """Of a sea only the highest waves reach these limits; between them the command is followed to the last digit."""
    compensation = compensate(HEAVES["sea"], 0.95, 0.1, limits, END)
    off = sampled(compensation.place, times())[:, 0] - commanded(HEAVES["sea"], 0.95, 0.1, times())[:, 0]
    assert 0.0 < compensation.away < 0.2
    assert np.mean(np.abs(off) > 1e-9) < compensation.away + 0.01
    assert np.abs(off).max() < 0.15


def test_a_stroke_that_is_used_up_is_used_fully():
    compensation = compensate(HEAVES["wave"], 1.0, 0.0, Limits(stroke=0.5, acceleration=3.0), END)
    late = times() > 20.0
    place, goal = sampled(compensation.place, times())[late, 0], commanded(HEAVES["wave"], 1.0, 0.0, times())[late, 0]
    assert np.all(np.abs(place[np.abs(goal) > 0.8]) > 0.48)
    assert compensation.met["stroke"] > 0.3 and compensation.met["speed"] == 0.0
    assert compensation.error == pytest.approx(0.5, abs=0.01)


def test_a_speed_that_is_too_low_gives_a_saw_tooth():
    compensation = compensate(HEAVES["wave"], 1.0, 0.0, Limits(speed=0.4), END)
    late = times() > 20.0
    speed = np.abs(sampled(compensation.place, times())[late, 1])
    assert np.mean(speed > 0.399) > 0.6 and compensation.met["speed"] > 0.5


def test_an_actuator_of_half_the_acceleration_still_helps():
    compensation = compensate(HEAVES["sea"], 1.0, 0.0, Limits(acceleration=0.4), END)
    late = times() > 15.0
    rest = (sampled(compensation.place, times()) - commanded(HEAVES["sea"], 1.0, 0.0, times()))[late, 0]
    assert np.std(rest) < 0.7 * np.std(commanded(HEAVES["sea"], 1.0, 0.0, times())[late, 0])


@pytest.mark.parametrize("limits", SATURATED.values(), ids=SATURATED)
def test_the_pay_out_is_c2_and_moves_without_chatter(limits):
    place = compensated("wave", 0.95, 0.1, limits).place
    knots = place.time[1:-1]
    jump = np.abs(sampled(place, np.nextafter(knots, 0.0)) - sampled(place, knots)).max(axis=0)
    assert np.all(jump < (1e-10, 1e-9, 1e-6))
    # a switching actuator would go from one end to the other at every step
    turns = np.abs(np.diff(place.second)).sum() / np.abs(place.second).max()
    assert turns < 60.0


@pytest.mark.parametrize(
    ("source", "gain", "limits"),
    [
        (HEAVES["wave"], 0.0, Limits(4.0, 2.0, 2.0)),
        (NIL, 0.95, Limits()),
        (Constant(value=0.4), 0.95, Limits(stroke=0.1)),
        (HEAVES["wave"], 0.95, Limits(stroke=0.0)),
    ],
)
def test_what_has_nothing_to_do_or_cannot_move_stays_where_it_is(source, gain, limits):
    compensation = compensate(source, gain, 0.1, limits, END)
    assert compensation.pay_out == NIL
    assert (compensation.away > 0.0) == (limits.stroke == 0.0)


def test_a_vessel_that_heaves_from_the_first_moment_is_caught_up_with():
    """Without an envelope the heave has a speed at t = 0, and with a delay its command jumps in speed."""
    plain = heave(Harmonic(amplitude=1.0, period=8.0, phase=0.5))
    limits = Limits(1.5, 1.0, 1.5)
    compensation = compensate(plain, 0.95, 0.1, limits, END)
    assert_within(compensation, limits)
    assert sampled(compensation.pay_out, np.zeros(1))[0, 0] == 0.0
    late = times()[times() > 5.0]
    start = commanded(plain, 0.95, 0.1, np.zeros(1))[0, 0]
    off = sampled(compensation.pay_out, late)[:, 0] - commanded(plain, 0.95, 0.1, late)[:, 0] + start
    assert np.abs(off).max() < 1e-6
    outside = compensate(plain, 5.0, 0.1, Limits(stroke=0.5, acceleration=1.0), END)
    assert_within(outside, Limits(stroke=0.5, acceleration=1.0))


def test_it_moves_on_at_the_very_end_of_the_run():
    compensation = compensate(HEAVES["wave"], 1.0, 0.0, Limits(), END)
    got, wanted = (sampled(model, np.array([END])) for model in (compensation.pay_out, HEAVES["wave"]))
    assert np.allclose(got, wanted, atol=1e-6) and abs(got[0, 1]) + abs(got[0, 2]) > 0.1


def test_a_coarser_step_keeps_to_the_limits_as_well():
    for step in (0.02, 0.05, 0.2):
        limits = Limits(0.4, 0.3, 0.25)
        assert_within(compensate(HEAVES["sea"], 1.0, 0.1, limits, END, step), limits)


@settings(max_examples=15, deadline=None)
@given(
    stroke=st.none() | st.floats(0.01, 3.0),
    speed=st.none() | st.floats(0.01, 3.0),
    acceleration=st.none() | st.floats(0.01, 3.0),
    gain=st.floats(0.1, 2.0),
    delay=st.floats(0.0, 1.0),
    seed=st.integers(0, 100),
)
def test_any_actuator_in_any_sea_keeps_to_its_limits(stroke, speed, acceleration, gain, delay, seed):
    end = 12.0
    limits = Limits(stroke, speed, acceleration)
    source = heave(SEA.model_copy(update={"seed": seed, "components": 40, "ramp": 0.0}), end)
    assert isinstance(source, FrameLift)
    assert_within(compensate(source, gain, delay, limits, end), limits, end)


@entry
def _evaluate(functions, i, times, out):
    for k in range(times.size):
        out[k, 0], out[k, 1], out[k, 2] = evaluate(functions, i, times[k])


@dataclass
class Asked:
    gain: float
    delay: float
    limits: Limits


@pytest.mark.parametrize("delay", [0.0, 0.1, 0.37])
def test_without_limits_the_loop_itself_finds_what_is_else_computed_ahead(delay):
    """A tip on a boom that luffs, on a vessel that heaves and rolls; and nothing is longer for a longer run."""
    ship = Frame(
        "vessel", GROUND, (3.0, 0.0, -10.0), (NIL, NIL, WAVE, Harmonic(amplitude=0.1, period=11.0, ramp=9.0), NIL, NIL)
    )
    frames = (ship, boom("boom", 0, (1.0, 0.0, 0.0), NIL, Harmonic(amplitude=0.1, period=20.0, ramp=9.0)))
    point, sizes = (30.0, 1.0, 20.0), []
    for end in (END, 100.0 * END):
        free = unlimited(requests_of(frames, end), 1, 0, point, Asked(0.95, delay, Limits()))
        functions = compile_functions([FunctionRequest(free.pay_out, factor=-1.0), FunctionRequest(free.place)])
        sizes.append(sum(np.size(array) for array in functions[:-4]))
    assert sizes[0] == sizes[1] and free.away == free.error == 0.0
    ahead = compensate(lift_of(requests_of(frames, END), 1, 0, point), 0.95, delay, Limits(), END)
    at = times(n=4001)[:-1]
    out = np.zeros((at.size, 3))
    _evaluate(functions, 0, at, out)
    wanted = -sampled(ahead.pay_out, at)
    assert np.abs(out[:, 0] - wanted[:, 0]).max() < 1e-8 and np.abs(out[:, 1] - wanted[:, 1]).max() < 1e-6
    assert np.allclose(sample(functions, 0, at), out, atol=1e-12)
    _evaluate(functions, 1, at, out)
    assert np.abs(out[:, 0] - sampled(ahead.place, at)[:, 0]).max() < 1e-8


def test_a_limit_or_a_heave_that_begins_with_a_speed_is_still_computed_ahead():
    frames = (Frame("vessel", GROUND, (0.0, 0.0, 0.0), (NIL, NIL, Harmonic(amplitude=1.0, period=8.0), NIL, NIL, NIL)),)
    requests = requests_of(frames, END)
    assert unlimited(requests, 0, 0, (1.0, 0.0, 0.0), Asked(1.0, 0.3, Limits())) is None
    assert unlimited(requests, 0, 0, (1.0, 0.0, 0.0), Asked(1.0, 0.0, Limits(stroke=9.0))) is None
    assert unlimited(requests, 0, 0, (1.0, 0.0, 0.0), Asked(1.0, 0.0, Limits())) is not None


ROLL = Harmonic(amplitude=0.05, period=13.0, ramp=9.0)
LONG_SEA = SEA.model_copy(update={"components": 60})
TIGHT = {
    "stroke and speed": Limits(stroke=0.5, speed=0.6),
    "acceleration": Limits(acceleration=0.4),
    "all three": Limits(0.45, 0.5, 0.5),
}


def recorded(times):
    """What a vessel does in a record: waves of three periods."""
    return sum(a * np.sin(w * times + p) for a, w, p in ((0.7, 0.8, 0.0), (0.5, 1.13, 1.0), (0.2, 2.1, 2.0)))


def lift_to(end, kind, folder):
    """The lift of a tip, as the scene of a run to `end` has it."""
    if kind == "record":
        rows = [f"{t:.2f},0,0,{recorded(t):.12f},{0.02 * np.sin(0.7 * t):.12f},0,0" for t in np.arange(0.0, 90.0, 0.2)]
        head = "t [s],surge [m],sway [m],heave [m],roll [rad],pitch [rad],yaw [rad]"
        (folder / "mru.csv").write_text("\n".join([head, *rows]))
        six = read_motions(folder / "mru.csv", end, ramp=5.0)
    else:
        six = (NIL, NIL, {"wave": WAVE, "sea": LONG_SEA}[kind], ROLL, NIL, NIL)
    frames = (Frame("vessel", GROUND, (0.0, 0.0, 0.0), six),)
    return lift_of(requests_of(frames, end), 0, 0, (10.0, 4.0, 20.0))


@pytest.mark.parametrize("name", kept(TIGHT, ("all three",)))
@pytest.mark.parametrize("kind", ["wave", "sea", "record"])
def test_runs_that_end_at_other_times_have_the_same_motion_as_long_as_both_last(kind, name, tmp_path):
    limits = TIGHT[name]
    made = {end: compensate(lift_to(end, kind, tmp_path), 1.0, 0.15, limits, end) for end in (13.1, 31.7, 80.0)}
    longest = made[80.0]
    assert longest.away > 0.0
    for end, shorter in made.items():
        at = np.linspace(0.0, end, 7001)
        apart = np.abs(sampled(shorter.pay_out, at) - sampled(longest.pay_out, at)).max(axis=0)
        assert np.all(apart < 1e-9)
        assert shorter.made_with == longest.made_with
        assert_within(shorter, limits, end)
