"""A twin that waits for no later rows: it follows the winch by what was measured before."""

import warnings

import numpy as np
import pytest
from twin.rehearsal import HOIST
from twin.test_inputs_that_come_back import MAP, finer_rows, rows_until

from tautline.twin.map.plan import Channel
from tautline.twin.signals.inputs import InputTrack
from tautline.twin.signals.row import Row
from tautline.twin.twin import Twin


def lines_without_delay(every=1):
    twin = Twin(HOIST, MAP + "delay: 0 s\n")
    rows = rows_until(8.0)[::every]
    return [line for stamp, readings in rows for line in twin.add(stamp, readings)] + twin.finish(), dict(rows)


def test_without_delay_the_winch_is_followed_at_any_speed_and_the_load_is_found():
    lines, rows = lines_without_delay()
    off = [line["inputs"]["winch.pay_out"] - rows[line["time"]]["winch_pos"] for line in lines]
    # At 2 m/s it was taken for a sensor that jumps at each row: 4.5 m behind after 6 s, and 9 +- 4 t.
    assert np.abs(off).max() < 1e-4
    assert lines[-1]["estimates"]["payload.mass"]["value"] == pytest.approx(5300.0, rel=0.01)


def test_an_input_of_which_each_sample_stands_alone_sets_off_no_join_as_it_gains_speed():
    channel = Channel(
        column="winch", name="winch.pay_out", is_input=True, unit="m", scale=1.0, zero=0.0, zero_first=False,
        sd=np.nan, relative=False, low=-np.inf, high=np.inf, waves=False, lost_after=5.0,
    )  # fmt: skip
    times = 0.05 * np.arange(120)
    values = np.where(times < 2.0, 0.5 * times**2, 2.0 * times - 2.0)
    track = InputTrack(channel, 0)
    track.begin(0.0, -0.05)
    rows = [Row(t, np.array([x])) for t, x in zip(times, values, strict=True)]
    with warnings.catch_warnings():
        # A row that stands alone has no interval.
        warnings.simplefilter("error")
        for k in range(len(rows)):
            first = k if k < 10 else k - 6
            track.follow(rows[first : k + 1], values[first : k + 1], rows[k], 0.0)
            assert not track.joining
            assert track.state[0] == values[k]


def test_the_first_line_waits_for_the_noise_of_inputs_for_a_second_at_most_and_not_where_a_delay_is_given():
    rows = finer_rows()
    given, slow = Twin(HOIST, MAP + "delay: 0 s\n"), Twin(HOIST, MAP)
    assert given.add(*rows[0])
    # At 5 Hz the first of twelve rows came after 2.2 s.
    first = next(stamp for stamp, readings in rows[::4] if slow.add(stamp, readings))
    assert first == pytest.approx(1.0, abs=0.01)


def test_a_simulation_that_is_begun_again_does_not_say_that_the_first_reading_is_far_from_its_start():
    twin = Twin(HOIST, MAP)
    rows = rows_until(6.0)
    for stamp, readings in rows[:-10]:
        twin.add(stamp, readings)
    twin._rest()
    lines = [line for stamp, readings in rows[-10:] for line in twin.add(stamp, readings)]
    assert lines
    assert not twin.readings.far
    assert not [text for text in twin.notes if "begins at" in text]
