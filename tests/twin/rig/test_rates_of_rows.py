"""Rows of a rig that come slowly: what drives the simulation between them, and what it makes of that."""

import functools

import numpy as np
import pytest
from of_the_suite import studies
from twin.rig.well_of_a_rig import VERTICAL, well

import tautline
from tautline.twin.signals.inputs import InputTrack
from tautline.twin.signals.row import Row
from tautline.twin.signals.smoothing import smooth
from tautline.twin.twin import Twin

LIGHT = well(VERTICAL, "50 s", "20 ms", translation="10", structural="1 ms")
MAP = """
sensors:
  - {column: block, unit: m, input: top.block, zero: first}
  - {column: rotary_speed, unit: rad/s, input: top.rotary_speed}
  - {column: hook_load, unit: N, output: top.hook_load, sd: 0.2 %}
ahead: 0 s
"""
STEPS = ((3.13, -0.2), (18.13, 0.2), (25.13, 0.2), (38.13, -0.2))
"""When the block's speed changes, s, and by how much, m/s."""


def block(time, over):
    """Place of a block whose speed changes evenly over a time at each of the steps, m; in closed form."""
    place = np.zeros_like(time)
    for at, change in STEPS:
        within = np.clip(time - at, 0.0, over)
        place += change * (0.5 * within**2 / over + np.maximum(time - at - over, 0.0))
    return place


def speed(time, over):
    return sum(change * np.clip((time - at) / over, 0.0, 1.0) for at, change in STEPS)


def followed(rate, over, noise=0.0):
    """Times of rows, and states (n, 3) that an input is given there."""
    channel = next(one for one in Twin(tautline.read(LIGHT), MAP).plan.channels if one.name == "top.block")
    times = np.arange(0.0, 50.0, 1.0 / rate)
    values = block(times, over) + noise * np.random.default_rng(4).standard_normal(times.size)
    rows = [Row(float(t), np.array([x])) for t, x in zip(times, values, strict=True)]
    track, states = InputTrack(channel, 0), []
    track.begin(0.0, 0.0)
    for k, row in enumerate(rows):
        near = slice(max(0, k - 8), k + 4)
        states.append(track.follow(rows[near], values[near], row, 3.0 / rate))
    return times, np.array(states)


@pytest.mark.parametrize("rate", [2.5, 1.0])
def test_a_block_that_changes_its_speed_between_two_rows_keeps_its_speed_at_all_others(rate):
    over = 0.3
    times, states = followed(rate, over)
    near = np.min([np.abs(times - at - 0.5 * over) for at, _ in STEPS], axis=0) < 0.5 * over + 1e-9
    inside = (times > 2.0 / rate) & (times < 50.0 - 3.0 / rate) & ~near
    off = np.abs(states[inside, 1] - speed(times[inside], over))
    assert off.max() < 0.01  # of 0.2 m/s: by a polynomial through all rows nearby it was 0.07
    assert np.mean(off < 1e-9) > 0.8


def test_noise_of_a_millimetre_does_not_pass_for_changes_of_speed_and_changes_do_not_pass_for_noise():
    times, states = followed(2.5, 0.3, noise=1e-3)
    steady = (times > 6.0) & (times < 17.0)
    # The difference of two samples on either side would have a deviation of 1.8 mm/s.
    assert np.std(states[steady, 1]) < 2.5e-3
    assert states[steady, 1].mean() == pytest.approx(-0.2, abs=1e-3)


def test_a_motion_does_not_begin_with_a_speed_that_no_two_rows_show():
    places = np.array([0.0, -0.2, -1.2, -2.2, -3.2])
    rate = smooth(5.0 * np.arange(5), places, 0.0, 15.0)[1]
    assert -0.2 <= rate <= 0.0  # by a quartic it was 0.13, the other way


@functools.cache
def run(over):
    """Times, block positions and hook loads of a run whose block is moved by the scene itself."""
    steps = [{"ramp": {"to": change, "over": over, "at": at}} for at, change in STEPS]
    scene = tautline.read(LIGHT).with_values({("top", "block"): ({"velocity": {"sum": steps}}, "a test")})
    result = tautline.simulate(scene)
    return tuple(np.array(result[name]) for name in ("time", "block_position", "hook_load"))


@pytest.mark.parametrize(("rate", "over", "within"), [*studies((5.0, 0.5, 2e3)), (2.5, 0.5, 4e3), (1.0, 2.0, 8e3)])
def test_a_lightly_damped_string_is_not_shaken_by_what_is_between_rows(rate, over, within):
    times, places, loads = run(over)
    twin, lines = Twin(tautline.read(LIGHT), MAP), []
    for t in np.arange(0.0, 50.0, 1.0 / rate):
        k = round(t / 0.02)
        lines += twin.add(float(t), {"block": places[k], "rotary_speed": 0.0, "hook_load": loads[k]})
    lines += twin.finish()
    off = [one["outputs"]["top.hook_load"] - np.interp(one["time"], times, loads) for one in lines[: -int(3 * rate)]]
    assert np.max(np.abs(off)) < within
