"""Weight and torque at the bit from rows that come slowly: deviations that are true, and what is said at the start."""

import functools

import numpy as np
import pytest
from of_the_suite import studies
from twin.rig.well_of_a_rig import LENGTH, VERTICAL, well

import tautline
from drillstring.twin.at_bit import AtBit, AtSurface, Known
from drillstring.twin.row_rate import Needed, RowInterval
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

SCENE = well(VERTICAL, "110 s", "0.1 s")
MAP = """
sensors:
  - {column: block, unit: m, input: top.block, zero: first}
  - {column: rotary_speed, unit: rad/s, input: top.rotary_speed}
  - {column: hook_load, unit: N, output: top.hook_load, sd: 0.2 %}
  - {column: torque, unit: N m, output: surface_torque, sd: 0.5 %}
  - {column: flow, unit: m^3/s, signal: flow}
  - {column: bit_depth, unit: m, signal: bit_depth}
  - {column: hole_depth, unit: m, signal: hole_depth}
estimate:
  - {parameter: wall.friction, start: 0.25, sd: 0.001, range: [0.02, 0.8]}
ahead: 0 s
"""


@pytest.mark.parametrize("interval", [1.0, 2.6, 5.0, 16.0, 30.0])
def test_a_swing_that_rows_do_not_show_is_in_the_deviation_of_the_weight(interval):
    random, within = np.random.default_rng(5), []
    scene = tautline.read(SCENE)
    weight, swing, noise = 60e3, 8e3, 500.0
    for _ in range(60):
        found, period = AtBit(scene, 3.1), random.uniform(1.7, 2.1)
        phase = random.uniform(0.0, 2.0 * np.pi)
        for k in range(12):
            t = interval * k
            # Two swings of a string are no multiples of one another.
            off = swing * np.sin(2.0 * np.pi * t / period + phase) + 0.3 * swing * np.sin(7.3 * t + 2.0 * phase)
            lacking = weight + off + noise * random.standard_normal()
            found.add(AtSurface(t, 0.0, 12.0, 600e3, 0.0, lacking, 2e3))
        told, sd = found.told(Known(noise, 0.0), Known(1.0, 0.0), {})["bit.weight"]
        within.append(abs(told - weight) < 2.0 * sd)
    assert np.mean(within) > 0.8


def test_a_single_row_on_bottom_tells_no_weight():
    found = AtBit(tautline.read(SCENE), 3.1)
    found.add(AtSurface(0.0, 0.0, 12.0, 600e3, 0.0, 60e3, 2e3))
    assert found.told(Known(1.0, 0.0), Known(1.0, 0.0), {}) == {}


@pytest.mark.parametrize("interval", [1.0, 5.0, 8.0, 10.0, 14.0, 16.0, 30.0, 60.0])
def test_weight_is_told_however_slowly_rows_come_and_the_remark_says_over_which_time(interval):
    found, slope = AtBit(tautline.read(SCENE), 3.1), 100.0
    for k in range(12):
        # In a vertical hole the hook lacks the weight: the mean of a ramp is that of the middle of its time.
        found.add(AtSurface(interval * k, 0.0, 12.0, 600e3, 0.0, 20e3 + slope * interval * k, 2e3))
    told = found.told(Known(1.0, 0.0), Known(1.0, 0.0), {})
    assert set(told) == {"bit.weight", "bit.torque"}
    over = 2.0 * (20e3 + slope * interval * 11 - told["bit.weight"][0]) / slope
    assert found.lost == []
    remark = next(one for one in Needed.of(4.0, 1.9, 3.1, 1.3, 3.1).lost(interval, estimates=True) if "swing" in one)
    assert float(remark.split("means over ")[1].split(" s")[0]) == pytest.approx(over, abs=0.5)
    assert over == pytest.approx(min(4, max(2, 30 // interval)) * interval, abs=0.1)


def test_too_few_rows_on_bottom_are_a_reason_that_is_told():
    found, told = AtBit(tautline.read(SCENE), 3.1), []
    # A gap of the data on bottom: what was before it does not count.
    for t in (0.0, 0.4, 0.8, 60.0, 60.4, 60.8):
        found.add(AtSurface(t, 0.0, 12.0, 600e3, 0.0, 60e3, 2e3))
        told.append(bool(found.told(Known(1.0, 0.0), Known(1.0, 0.0), {})))
        assert told[-1] or found.lost == [
            "bit.weight, bit.torque and bit.depth: at least 3 rows on bottom without a gap are needed, and there are "
            "fewer so far"
        ]
        assert not (told[-1] and found.lost)
    assert told == [False, False, True] * 2


def test_what_slow_rows_do_not_tell_is_said_with_the_interval_that_is_needed():
    needed = Needed.of(4.0, 1.9, 3.1, 1.3, 3.1)
    assert needed.lost(0.4, estimates=True) == [] == needed.lost(float("nan"), estimates=True)
    assert [one.split(":")[0] for one in needed.lost(1.0, estimates=True)] == [
        "bit.weight and bit.torque as they swing", "bit.stick_slip"
    ]  # fmt: skip
    slow = needed.lost(5.0, estimates=True)
    assert slow[0].startswith("friction: rows come every 5 s, and at least every 1.33 s is needed")
    assert len(needed.lost(5.0, estimates=False)) == 2
    interval = RowInterval()
    assert [np.isfinite(interval.add(2.0 * k)) for k in range(6)] == [False] * 4 + [True] * 2
    assert interval.value == 2.0


def standing(twin, times):
    """Lines of a twin beside a string that stands off bottom."""
    row = {"block": 0.0, "rotary_speed": 0.0, "hook_load": 600e3, "torque": 0.0, "flow": 0.0}
    row |= {"bit_depth": LENGTH - 50.0, "hole_depth": LENGTH}
    return [line for t in times for line in twin.add(float(t), row)]


def remarks(twin):
    return [one.split(":")[1].strip() for one in twin.notes if "rows come every" in one]


def test_a_twin_that_is_begun_again_says_nothing_twice_and_knows_at_once_how_often_rows_come(tmp_path):
    first = Twin(tautline.read(SCENE), MAP)
    lines = standing(first, np.arange(0.0, 20.0, 1.0))
    assert len(remarks(first)) == 1
    save(first, tmp_path / "state.npz")
    again = Twin(tautline.read(SCENE), MAP)
    load(again, tmp_path / "state.npz")
    after = standing(again, np.arange(20.0, 40.0, 1.0))
    assert remarks(again) == []
    told = [[x for x in line["rig"]["cannot_be_told"] if "rows come" in x] for line in (lines[-1], after[0], after[-1])]
    assert len(told[0]) == 1 and told[0] == told[1] == told[2]


def test_what_rows_no_longer_tell_when_they_come_more_slowly_is_said_then():
    twin = Twin(tautline.read(SCENE), MAP)
    standing(twin, np.arange(0.0, 10.0, 1.0))
    assert remarks(twin) == ["bit.weight and bit.torque as they swing"]
    standing(twin, np.arange(10.0, 120.0, 5.0))
    assert sorted(remarks(twin)) == ["bit.stick_slip", "bit.weight and bit.torque as they swing", "friction"]


# -- beside a run ------------------------------------------------------------------------------------------------------


@functools.cache
def run():
    """A run that goes up, comes down, turns and drills, with a ramp of weight."""
    steps = [(3, -0.2), (13, 0.2), (15, 0.15), (24, -0.09), (34, -0.03), (42, -0.024), (70, 0.006)]
    bit = {
        "on_bottom": True, "weight": "1 kN", "torque": {"static": 4000.0, "kinetic": 4000.0, "weight": 100e3},
        "penetration": {"rate": "12 mm/s", "speed": 12.0, "weight": 100e3},
    }  # fmt: skip
    block = {"velocity": {"sum": [{"ramp": {"to": to, "over": 2.0, "at": at}} for at, to in steps]}}
    turned = {"ramp": {"to": 12.0, "over": 4.0, "at": 16.0}}
    changes = {("top", "block"): block, ("top", "rotation"): turned, ("bit",): bit}
    result = tautline.simulate(tautline.read(SCENE).with_values({p: (v, "a test") for p, v in changes.items()}))
    names = ("time", "block_position", "hook_load", "surface_torque", "weight_on_bit", "torque_on_bit")
    return {name: np.array(result[name]) for name in names} | {"turned": np.array(result["rotation_rate"])[:, 0]}


@functools.cache
def followed(every):
    """A twin beside every so many seconds of the run: its lines, and what it had to say."""
    right, random, lines = run(), np.random.default_rng(2), []
    twin = Twin(tautline.read(SCENE), MAP)
    said = []
    for k in range(0, right["time"].size, round(every / 0.1)):
        down = LENGTH + float(right["block_position"][k])
        lines += twin.add(float(right["time"][k]), {
            "block": right["block_position"][k], "rotary_speed": right["turned"][k],
            "hook_load": right["hook_load"][k] * (1.0 + 0.002 * random.standard_normal()),
            "torque": right["surface_torque"][k] * (1.0 + 0.005 * random.standard_normal()),
            "flow": 0.03, "bit_depth": down, "hole_depth": down if right["weight_on_bit"][k] > 1e3 else LENGTH + 2.0,
        })  # fmt: skip
        said.append(len(twin.notes))
    return lines + twin.finish(), twin.notes, said


@pytest.mark.parametrize("every", [0.4, *studies(1.0), 5.0])
@pytest.mark.parametrize(("name", "of"), [("bit.weight", "weight_on_bit"), ("bit.torque", "torque_on_bit")])
def test_weight_and_torque_are_within_two_stated_deviations_however_slowly_rows_come(every, name, of):
    right, (lines, _, _) = run(), followed(every)
    over, within = max(3.1, 4.0 * every), []
    for line in lines:
        if line["time"] > 45.0 + over and name in line["estimates"]:
            one = line["estimates"][name]
            near = (right["time"] > line["time"] - over) & (right["time"] <= line["time"])
            within.append(abs(one["value"] - right[of][near].mean()) < 2.0 * one["sd"])
    assert len(within) > 0.8 * (65.0 - over) / every
    assert np.mean(within) > 0.85


@pytest.mark.parametrize(("every", "count"), [(0.4, 0), (1.0, 1), (5.0, 3)])
def test_a_twin_says_once_and_at_the_start_what_so_few_rows_do_not_tell(every, count):
    lines, notes, said = followed(every)
    notes = [one for one in notes if "rows come every" in one]
    assert len(notes) == count
    assert count == 0 or next(k for k, number in enumerate(said) if number) < 12
    told = [one for one in lines[-1]["rig"]["cannot_be_told"] if "rows come every" in one]
    assert len(told) == count
