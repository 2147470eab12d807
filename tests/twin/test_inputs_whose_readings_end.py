"""An input whose readings have ended stays near what they have shown, wherever on its way the last one was."""

import json
import math

import numpy as np
import pytest
from twin.test_inputs_of_a_twin import CHANNEL

from tautline.twin.signals.inputs import InputTrack
from tautline.twin.signals.row import Row
from tautline.twin.signals.smoothing import REST

INTERVAL = 0.05
FLOW = CHANNEL.model_copy(update=dict(column="flow", name="water.speed", unit="m/s", waves=False))
WINCH = CHANNEL.model_copy(update=dict(column="winch", name="winch.pay_out", waves=False))
RISE, FIRST, LAST = 4.0, 2.0, 6.0
"""A flow that rises from 2 m/s at 3 s to 6 m/s at 4 s."""


def flow(t):
    return np.interp(t, [3.0, 4.0], [FIRST, LAST])


def made_up(channel, motion, every, noise, last, waits, halfway=False):
    """States (n, 3) behind the last reading, of rows that wait for three pauses or, without `waits`, for none."""
    track, pause = InputTrack(channel, 0), every * INTERVAL
    rng = np.random.default_rng(2)
    rows = []
    for k in range(int(9.0 / INTERVAL)):
        t = k * INTERVAL
        comes = k % every == 0 and t <= last + 1e-9
        rows.append(Row(t, np.array([motion(t) + noise * rng.standard_normal() if comes else math.nan])))
    rows[0].after_gap = True
    track.begin(float(motion(0.0)), -INTERVAL)
    states = []
    for k, row in enumerate(rows):
        known = rows[: k + (3 * every if waits else 0) + 1]
        values = np.array([one.values[0] for one in known])
        reach = 3.0 * pause
        state = track.follow(known, values, row, reach, reach)
        if row.time > last + pause + 1e-9:
            states.append(state)
        if halfway and abs(row.time - last - 0.5) < 1e-9:
            kept, track = json.loads(json.dumps(track.memory())), InputTrack(channel, 0)
            track.recall(kept)
    return np.array(states)


@pytest.mark.parametrize("waits", [True, False])
@pytest.mark.parametrize("noise", [0.0, 0.02])
@pytest.mark.parametrize("every", [1, 2, 4])
def test_a_flow_that_is_measured_no_more_stays_within_one_pause_of_what_was_measured(every, noise, waits):
    for last in np.arange(2.0, 6.0, every * INTERVAL):
        reading = float(flow(math.floor(last / (every * INTERVAL) + 1e-6) * every * INTERVAL))
        speeds = made_up(FLOW, flow, every, noise, last, waits)[:, 0]
        # It had risen by this much at most from one reading to the next, and no reading says that it rose on.
        step = RISE * every * INTERVAL + 6.0 * noise + 1e-6
        # What rows do not wait for is behind its readings all the time; it is never beyond them.
        behind = every > 1 and not waits
        assert (FIRST if behind else reading) - step < speeds.min() and speeds.max() < reading + step, last
        if not behind and last > 4.0 + every * INTERVAL:
            assert np.abs(speeds - LAST).max() < 6.0 * noise + 1e-6, last


@pytest.mark.parametrize("noise", [0.0, 0.001])
@pytest.mark.parametrize("every", [1, 2, 4])
def test_a_winch_that_has_stood_for_two_readings_stands_when_no_more_come(every, noise):
    """It ran at 1 m/s until 4 s. Of one that still runs the way to rest is 2 REST times its speed, and no more."""
    place = lambda t: np.minimum(t, 4.0)  # noqa: E731
    for last in np.arange(3.0, 5.0, every * INTERVAL):
        pause = every * INTERVAL
        reading = float(place(math.floor(last / pause + 1e-6) * pause))
        places = made_up(WINCH, place, every, noise, last, True)[:, 0]
        # Noise of a reading is a speed of twice itself over the pause, of two standard deviations.
        blurred = 6.0 * noise + 2.0 * REST * 4.0 * noise / pause
        assert reading - blurred - 1e-6 < places.min(), last
        assert places.max() < reading + 2.0 * REST * 1.0 + blurred + 1e-6, last
        if last > 4.0 + pause:
            assert np.abs(places - 4.0).max() < blurred + 1e-6, last


def test_a_ship_in_waves_whose_readings_end_goes_on_as_smoothly_as_it_moved():
    """A change of its rate that no wave has would shake a load; of the rate at 10 Hz in closed form."""
    w = 2.0 * math.pi / 7.0
    states = made_up(CHANNEL, lambda t: 0.6 * math.sin(w * t), 2, 0.0, 4.0, True)
    # The first is a pause after the last reading.
    left = math.exp(-0.15 / REST)
    rate, second = 0.6 * w * math.cos(4.0 * w), -0.6 * w * w * math.sin(4.0 * w)
    change = second + rate / REST
    assert states[0][1] == pytest.approx((rate + change * 0.15) * left, abs=2e-3)


def test_what_is_made_up_for_a_flow_goes_on_as_it_was_after_a_state_was_kept():
    for last in (3.6, 4.2, 4.4):
        whole = made_up(FLOW, flow, 4, 0.0, last, True)
        assert made_up(FLOW, flow, 4, 0.0, last, True, halfway=True).tolist() == whole.tolist()
