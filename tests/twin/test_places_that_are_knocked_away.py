"""Readings of a place that a sensor knocks away for a row or two: left out, and no motion of a machine with them."""

import numpy as np
import pytest
from twin.rehearsal import alarms, calm_rows, weight_twin

from tautline.twin.map.plan import Channel
from tautline.twin.signals import knocks
from tautline.twin.signals.sensors import Health

SAMPLE = 0.1
"""s."""


def health():
    return Health(
        Channel(
            column="pos", name="winch.pay_out", is_input=True, is_output=False, unit="m", scale=1.0, zero=0.0,
            zero_first=False, sd=np.nan, relative=False, low=-np.inf, high=np.inf, waves=False, lost_after=5.0,
        )
    )  # fmt: skip


def left_out(values, sample=SAMPLE, known=3):
    """Which of the readings are left out, each judged with so many behind it."""
    one, times = health(), sample * np.arange(len(values))
    found = []
    for i, (time, value) in enumerate(zip(times, values, strict=True)):
        behind = slice(i + 1, i + 1 + known)
        one.check(float(time), float(value), values[behind].tolist(), times[behind].tolist())
        if np.isfinite(one.left_out):
            found.append(i)
    return found


def winch(count=200, sample=SAMPLE, period=20.0, amplitude=4.0):
    return amplitude * np.sin(2.0 * np.pi * sample * np.arange(count) / period)


@pytest.mark.parametrize("size", [0.1, -0.3, 2.0])
@pytest.mark.parametrize("at", [100, 120, 150])  # at full speed, in between, at the crest
def test_a_row_by_which_an_encoder_knocks_is_left_out_and_no_other(at, size):
    values = winch()
    values[at] += size
    assert left_out(values) == [at]


def test_two_rows_in_a_row_and_a_later_one_are_left_out():
    values = winch()
    values[100:102] += 0.5
    values[130] -= 0.3
    assert left_out(values) == [100, 101, 130]


def test_a_knock_with_no_row_known_behind_it_is_left_in_for_it_may_be_a_motion():
    values = winch()
    values[100] += 0.3
    assert left_out(values, known=0) == []


@pytest.mark.parametrize("speed", [0.5, 2.0, 3.5])
def test_a_machine_that_sets_off_stops_or_turns_at_once_is_not_left_out(speed):
    """After a minute of standing nothing tells of what it can do."""
    still = 0.01 * np.sin(0.3 * np.arange(80))
    way = speed * SAMPLE * np.arange(1, 21)
    assert left_out(np.concatenate([still, still[-1] + way, np.full(20, still[-1] + way[-1])])) == []
    assert left_out(np.concatenate([still, still[-1] + way, still[-1] + way[::-1]])) == []


def test_a_place_that_is_set_elsewhere_is_not_left_out():
    values = winch()
    values[120:] += 0.3
    assert left_out(values) == []


@pytest.mark.parametrize("sample", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("period", [3.0, 8.0])
def test_crests_of_waves_that_grow_are_not_left_out(period, sample):
    time = sample * np.arange(400)
    swell = np.where(time < 0.4 * time[-1], 0.05, 1.0) * np.sin(2.0 * np.pi * time / period)
    assert left_out(swell, sample) == []


@pytest.mark.parametrize("step", [0.01, 0.05, 0.2])
def test_steps_of_an_encoder_are_not_left_out(step):
    rng = np.random.default_rng(1)
    for place in (winch(400, amplitude=1.0), np.zeros(400)):
        noisy = place + 0.3 * step * rng.standard_normal(400)
        assert left_out(step * np.round(noisy / step)) == []


def test_a_coarse_encoder_that_shows_its_first_step_late_is_not_left_out():
    values = np.zeros(200)
    values[[60, 90, 91, 120]] = 0.1
    assert left_out(values) == []


def test_a_winch_that_stands_and_is_knocked_away_for_a_row_raises_no_alarm_of_loads():
    """The load cell shows that nothing happened; the simulation of the knock had 100 kN, and lost the estimate."""
    rows = [(t, dict(readings)) for t, readings in calm_rows() if t <= 15.0]
    next(readings for t, readings in rows if t >= 12.0)["winch_pos"] += 0.3
    twin = weight_twin(start="5 t")
    lines = [line for stamp, readings in rows for line in twin.add(stamp, readings)] + twin.finish()
    assert {name for line in lines for name in alarms([line])} == {"winch_pos jumping"}
    assert max(line["outputs"]["winch.tension"] for line in lines if line["time"] > 5.0) < 60e3
    assert lines[-1]["estimates"]["payload.mass"]["value"] == pytest.approx(5000.0, rel=0.01)


def test_noise_and_a_slow_logger_are_not_left_out():
    rng = np.random.default_rng(2)
    assert left_out(winch(400) + 0.03 * rng.standard_normal(400)) == []
    values = winch(200, sample=1.0)
    values[120] += 0.5  # a machine may go there and back in two seconds
    assert left_out(values, 1.0) == []


def test_a_health_that_goes_on_knows_how_fast_the_place_last_moved():
    """Before it did not, a knock in the first reading behind a resume counted as true."""
    values = [*(0.02 * np.arange(60)), 0.02 * 59 + 0.4, *(0.02 * np.arange(61, 70))]
    times = SAMPLE * np.arange(len(values))
    one, other = health(), health()
    for i in range(61):
        if i == 60:
            other.recall(one.memory())
        behind = slice(i + 1, i + 4)
        for which in (one,) if i < 60 else (one, other):
            which.check(float(times[i]), float(values[i]), list(values[behind]), list(times[behind]))
    assert one.jumps == other.jumps == 1


def test_each_reading_of_a_window_is_looked_at_with_the_few_behind_it_however_long_the_window(monkeypatch):
    looked, judge = [], knocks.is_knock

    def counted(before, speed, at, reading, following, seen):
        looked.append(len(following))
        return judge(before, speed, at, reading, following, seen)

    monkeypatch.setattr(knocks, "is_knock", counted)
    times = SAMPLE * np.arange(400)
    knocks.knocked(times, np.sin(times), 0.01)
    # With all that are behind it a window of 400 rows is gone through 80,000 times, for every row that comes.
    assert len(looked) == 398 and max(looked) == knocks.ROWS
