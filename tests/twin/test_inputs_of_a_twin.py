"""Measured inputs: smoothed from both sides, never a jump, never extrapolated."""

from itertools import pairwise

import numpy as np
import pytest

from tautline.twin.map.plan import Channel
from tautline.twin.signals.inputs import InputTrack
from tautline.twin.signals.row import Row
from tautline.twin.signals.smoothing import joined, smooth
from tautline.twin.signals.waves import Waves

CHANNEL = Channel(
    column="heave", name="vessel.heave", is_input=True, unit="m", scale=1.0, zero=0.0, zero_first=False,
    sd=float("nan"), relative=False, low=-np.inf, high=np.inf, waves=True, lost_after=5.0,
)  # fmt: skip
PERIOD = 7.0


def wave(t):
    w = 2.0 * np.pi / PERIOD
    return np.array([0.6 * np.sin(w * t), 0.6 * w * np.cos(w * t), -0.6 * w * w * np.sin(w * t)])


def test_a_wave_sampled_at_10_hz_is_met_with_its_rate_and_second_rate():
    t = np.arange(7) * 0.1
    found = smooth(t, wave(t)[0], 0.3, 0.3)
    assert found == pytest.approx(wave(0.3), abs=2e-7)


def test_noise_is_smoothed_and_not_taken_for_motion():
    rng = np.random.default_rng(5)
    t = np.arange(400) * 0.1
    x = wave(t)[0] + 0.01 * rng.standard_normal(400)
    found = np.array([smooth(t, x, at, 0.5, 0.01) for at in t[10:-10]])
    error = found - wave(t[10:-10]).T
    assert error[:, 0].std() < 0.006
    # White noise of 0.01 m, differenced twice, would be 2.4 m/s^2.
    assert error[:, 2].std() < 0.25


def test_a_difference_is_made_up_for_with_value_rate_and_second_rate():
    apart = np.array([0.4, -0.3, 0.2])
    assert joined(apart, 0.0, 3.0) == pytest.approx(apart)
    assert joined(apart, 1.0, 3.0).tolist() == [0.0, 0.0, 0.0]
    share, step = 0.37, 1e-5
    around = [joined(apart, share + k * step / 3.0, 3.0) for k in (-1, 0, 1)]
    assert (around[2][0] - around[0][0]) / (2 * step) == pytest.approx(around[1][1], rel=1e-6)
    assert (around[2][1] - around[0][1]) / (2 * step) == pytest.approx(around[1][2], rel=1e-6)


def followed(values, times):
    track = InputTrack(CHANNEL, 0)
    track.begin(0.0, times[0] - 0.1)
    rows = [Row(t, np.array([x])) for t, x in zip(times, values, strict=True)]
    for before, row in pairwise(rows):
        row.after_gap = row.time - before.time > 0.45
    states = []
    for k, row in enumerate(rows):
        first = k
        while first > 0 and not rows[first].after_gap:
            first -= 1
        last = k
        while last + 1 < len(rows) and not rows[last + 1].after_gap:
            last += 1
        around = rows[first : last + 1]
        states.append(track.follow(around, np.array([one.values[0] for one in around]), row, 0.3).copy())
    return np.array(states)


@pytest.mark.parametrize("wrong", ["missing", "gap", "jump"])
def test_the_input_never_jumps_whatever_the_sensor_does(wrong):
    t = np.arange(300) * 0.1
    x = wave(t)[0]
    if wrong == "missing":
        x[100:160] = np.nan
    elif wrong == "jump":
        x[100:160] += 2.0
    keep = np.ones(300, bool)
    if wrong == "gap":
        keep[100:160] = False
    states = followed(x[keep], t[keep])
    dt = np.diff(t[keep])
    # Value from row to row by the rates at both ends, and no acceleration that a ship does not have.
    step = np.diff(states[:, 0]) - 0.5 * dt * (states[:-1, 1] + states[1:, 1])
    assert np.abs(step[dt < 0.2]).max() < 2e-3
    assert np.abs(states[:, 2]).max() < 2.0
    assert states[-1] == pytest.approx(wave(t[-1]), abs=0.02)


def test_two_harmonics_are_predicted_two_seconds_ahead():
    waves = Waves()

    def motion(t):
        value = 0.5 * np.sin(0.8 * t) + 0.3 * np.sin(0.55 * t + 1.0)
        return np.array([value, 0.4 * np.cos(0.8 * t) + 0.165 * np.cos(0.55 * t + 1.0), 0.0])

    for k in range(1500):
        waves.add(0.1 * k, motion(0.1 * k))
    ahead = waves.ahead(np.array([0.5, 1.0, 2.0]))
    now = 0.1 * 1499
    for row, after in zip(ahead, (0.5, 1.0, 2.0), strict=True):
        assert row[:2] == pytest.approx(motion(now + after)[:2], abs=0.02)


def test_before_a_motion_is_known_it_goes_on_at_its_speed():
    waves = Waves()
    waves.add(0.0, np.array([1.0, 0.2, 0.0]))
    assert waves.ahead(np.array([2.0]))[0].tolist() == pytest.approx([1.4, 0.2, 0.0])


def shaken(reach, rows=40):
    """Root mean square of the second rates that an input is given in its first rows, at 1 Hz; its sensor stands."""
    times = np.arange(float(rows))
    within = np.abs(times[:, None] - times) <= 2.0 * reach + 1e-9
    found = []
    for seed in range(30):
        values = 0.05 * np.random.default_rng(seed).standard_normal(rows)
        data = [Row(t, np.array([x])) for t, x in zip(times, values, strict=True)]
        track = InputTrack(CHANNEL, 0)
        track.begin(0.0, times[0] - 1.0)
        for k in range(16):
            around = [data[i] for i in np.flatnonzero(within[k])]
            found.append(track.follow(around, values[within[k]], data[k], reach)[2] if k > 1 else 0.0)
    return float(np.sqrt(np.mean(np.square(found))))


@pytest.mark.parametrize("reach", [3.0, 5.0, 10.0])
def test_noise_that_the_map_does_not_state_is_not_taken_for_motion_in_the_first_rows_either(reach):
    # The second difference of three such samples has sqrt(6) times their deviation.
    assert shaken(reach) < 0.5 * 6.0**0.5 * 0.05


def winch_at(times, values):
    """Times at which a winch joins its encoder, which is followed from row to row."""
    track = InputTrack(CHANNEL.model_copy(update={"name": "winch.pay_out", "waves": False}), 0)
    track.begin(float(values[0]), times[0] - 0.05)
    return [row.time for row, _ in follow(track, times, values) if track.joining]


def track_of(times, values):
    """A winch that stands when the first row comes, and its states."""
    track = InputTrack(CHANNEL.model_copy(update={"name": "winch.pay_out", "waves": False}), 0)
    track.begin(float(values[0]), times[0])
    return track, np.array([state for _, state in follow(track, times, values, after_gap=True)])


def follow(track, times, values, after_gap=False):
    """Rows, and the states at them, with four samples after each."""
    rows = [Row(t, np.array([x])) for t, x in zip(times, values, strict=True)]
    rows[0].after_gap = after_gap
    for k, row in enumerate(rows[:-4]):
        around = slice(max(0, k - 7), k + 5)
        yield row, track.follow(rows[around], values[around], row, 3.0 * float(times[1] - times[0])).copy()


@pytest.mark.parametrize("digit", [1e-4, 0.02])
def test_two_rows_eight_milliseconds_apart_are_no_jump_of_a_winch(digit):
    true = 0.05 * np.arange(120)
    # One row is stamped 42 ms too early: it seems to have gone 12 times as fast.
    stamps = true.copy()
    stamps[80] -= 0.042
    values = -np.round(2.0 * true / digit) * digit
    assert winch_at(stamps, values) == []
    # Nor does a winch that creeps, of which the last digit turns within the 8 ms.
    assert winch_at(stamps, -np.round(0.1 * true / digit) * digit) == []


def test_an_encoder_that_jumps_within_eight_milliseconds_is_still_seen_to():
    true = 0.05 * np.arange(120)
    stamps = true.copy()
    stamps[80] -= 0.042
    joined_at = winch_at(stamps, -2.0 * true + 3.0 * (np.arange(120) >= 80))
    assert joined_at[0] == pytest.approx(stamps[80], abs=1e-9)


@pytest.mark.parametrize(("rate", "speed"), [(20.0, 2.0), (50.0, 1.0), (100.0, 2.0), (1.0, 2.0)])
def test_a_winch_that_already_runs_at_the_first_row_is_followed_soon_after(rate, speed):
    times = np.arange(max(80, int(8.0 * rate))) / rate
    track, states = track_of(times, -speed * times)
    caught_up = times[: len(states)] > max(4.0, 20.0 / rate)
    assert states[caught_up, 0] == pytest.approx(-speed * times[: len(states)][caught_up], abs=1e-6)
    assert track.fastest == pytest.approx(max(1.0, speed), rel=1e-6)


def test_an_encoder_that_leaps_on_the_way_of_a_winch_that_ran_at_the_first_row_is_no_motion():
    times = 0.05 * np.arange(300)
    track, states = track_of(times, -2.0 * times + 5.0 * (times >= 9.0))
    assert np.max(np.abs(np.diff(states[:, 0]))) < 0.3
    assert track.fastest == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("leap", [10.0, -5.0])
def test_an_encoder_whose_leap_is_smeared_over_five_rows_is_no_motion_of_a_winch_that_is_followed(leap):
    times = 0.05 * np.arange(300)
    track, states = track_of(times, -2.0 * times + leap * np.clip((times - 9.0) / 0.25, 0.0, 1.0))
    assert np.max(np.abs(np.diff(states[:, 0]))) < 0.3
    assert track.fastest == pytest.approx(2.0, rel=1e-6)


def rotary(times, values):
    """States of a rotary table that is at rest before the first row."""
    table = {"column": "rpm", "name": "top.rotary_speed", "unit": "rad/s", "waves": False}
    track = InputTrack(CHANNEL.model_copy(update=table), 0)
    track.begin(float(values[0]), times[0] - 0.4)
    return track, [(row.time, state, track.joining) for row, state in follow(track, times, values)]


@pytest.mark.parametrize("interval", [0.1, 0.4, 5.0])
def test_a_rotary_table_that_is_at_full_speed_a_row_later_is_followed_and_nothing_is_made_up_for(interval):
    times = interval * np.arange(60)
    values = np.where((times > 20.0 * interval) & (times < 40.5 * interval), 8.0, 0.0)
    _, states = rotary(times, values)
    # It took 15 s to come to 8 rad/s, and as long to stop.
    assert not [at for at, _, joining in states if joining]
    assert [state[0] for _, state, _ in states] == pytest.approx(values[: len(states)], abs=0.05)


def test_one_row_of_a_speed_that_drops_out_is_left_out_and_a_stop_is_none():
    times = 0.4 * np.arange(60)
    values = np.full(60, 8.0)
    values[20] = values[30] = 0.0
    values[40:46] = 0.0
    _, states = rotary(times, values)
    true = np.where((np.arange(60) >= 40) & (np.arange(60) < 46), 0.0, 8.0)
    assert [state[0] for _, state, _ in states] == pytest.approx(true[: len(states)], abs=0.05)


@pytest.mark.parametrize("interval", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_glitch_far_faster_than_a_drive_turns_is_left_out_however_slow_rows_are(count, interval):
    times = interval * np.arange(60)
    values = np.full(60, 12.0)
    values[20 : 20 + count] = 1000.0
    _, states = rotary(times, values)
    assert [state[0] for _, state, _ in states] == pytest.approx(np.full(len(states), 12.0), abs=0.05)


def test_a_sea_that_is_dead_calm_has_a_motion_ahead():
    waves = Waves()
    for k in range(1, 700):
        waves.add(0.1 * k, np.zeros(3))
    assert not waves.ahead(np.linspace(0.1, 5.0, 9)).any()
