"""A simulation of a twin that stops while the machine goes on: the twin says so, and begins it where the sensors are.

The crane brakes to a stand 0.8 m below the sheave, and hangs there. What is fed to the twins is what `record` writes of
that scene, which runs to its end: nothing two-blocks.
"""

import copy
import functools
import json
import re

import numpy as np
import pytest
from of_the_suite import studies
from scipy.interpolate import BPoly
from twin.rehearsal import NOT_AHEAD, RATE, WEIGHT, alarms, changed, hoist, rows_of

import tautline
from tautline.twin.map.plan import Channel
from tautline.twin.signals.inputs import JOIN, InputTrack
from tautline.twin.signals.row import Row
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin

STANDS = -9.1
"""Where the winch of the crane stands from `STOPPED` on, m."""
STOPPED = 5.3
SETS_OFF = {"time": [0, 1, 4.8, STOPPED, 100], "value": [0, -2, -2, 0, 0]}
HIGH = 20.0
END = 9.0
BACK = 7.4
"""Time at which the winch is measured again, s."""


@functools.cache
def scene():
    return tautline.read(hoist(SETS_OFF, start_height=HIGH))


@functools.cache
def rows():
    """Rows up to `END`, of a machine that never was nearer to the sheave than 0.8 m."""
    found = tuple(rows_of(scene(), end=END))
    assert found[-1][0] >= END - 1.0 / RATE and min(r["winch_pos"] for _, r in found) > STANDS - 0.05
    return found


def twin_of(map=NOT_AHEAD, of=None):
    return Twin(of or scene(), map.replace("START", "5 t"))


def fed(twin, given, works=False):
    lines = []
    for stamp, readings in given:
        lines += twin.add(stamp, readings)
        if works:
            twin.work()
    return lines + twin.finish()


def gap(t, r):
    return None if 4.7 < t < BACK - 1e-6 else r


def lost(t, r):
    return {**r, "winch_pos": np.nan} if 4.7 < t < BACK - 1e-6 else r


@pytest.fixture(scope="module", params=[gap, *studies(lost)])
def braked_unseen(request):
    """A twin whose winch was not seen to brake, its lines, and the stamps of the rows that came.

    By itself the winch comes to rest 1.4 m further than where it was seen last: beyond the sheave.
    """
    given = changed(rows(), request.param)
    twin = twin_of(WEIGHT)
    return twin, fed(twin, given, works=True), [t for t, _ in given]


def test_a_twin_whose_winch_was_not_seen_to_brake_goes_on_where_the_sensors_are(braked_unseen):
    _, lines, stamps = braked_unseen
    assert [line["time"] for line in lines] == stamps
    assert "lost" not in {line["health"] for line in lines}
    assert lines[-1]["inputs"]["winch.pay_out"] == pytest.approx(STANDS, abs=0.02)
    # The ship lifts load and sensor by half a metre at most.
    assert lines[-1]["outputs"]["payload.position"][2] == pytest.approx(HIGH - STANDS, abs=0.6)
    # Of the way that was made up nothing is found.
    before, after = ([one for one in lines if (one["time"] < BACK - 1e-6) == first] for first in (True, False))
    known = before[-1]["estimates"]["payload.mass"]["value"]
    assert after[0]["estimates"]["payload.mass"]["value"] == pytest.approx(known, rel=1e-3)
    # No sensor shows the hook at the block.
    seen = [one for line in lines if line["time"] > BACK - 1e-6 for one in line["alarms"]]
    assert not [one for one in seen if one["name"] == "two-blocking ahead" and one["known"]]


def test_the_time_that_is_told_of_a_simulation_that_stopped_is_that_of_the_row(braked_unseen):
    twin, lines, _ = braked_unseen
    (note,) = [one for one in twin.notes if "the simulation stopped" in one]
    begun = alarms(lines)["simulation stopped"]
    assert note.startswith(f"at {begun:.1f} s the simulation stopped (boom tip: two-blocking: ")
    assert "its sensor had shown nothing for a while" in note and "Stop hoisting" not in note
    assert re.findall(r"[0-9.]+ s\b", note) == [f"{begun:.1f} s"]


def test_the_way_from_where_the_scene_begins_does_not_go_on_as_the_scene_sets_off():
    """The scene sets off with -2 m/s2, and the machine hangs still 24 m higher: on a way there of 45 s that begins with
    this second rate the winch is 100 m too high on the way."""
    low = tautline.read(hoist({"time": [0, 1, 100], "value": [0, -2, -2]}, heave=0.0))
    still = tautline.read(hoist({"time": [0, 100], "value": [0, 0]}, start_height=29.1, heave=0.0))
    given = [(t, {**r, "winch_pos": r["winch_pos"] - 24.1}) for t, r in rows_of(still, end=1.0)]
    twin = twin_of(of=low)
    lines = fed(twin, given)
    assert len(lines) == len(given) and twin.restarts == 0 and not twin.loss.text
    heights = [line["outputs"]["payload.position"][2] for line in lines]
    assert heights == pytest.approx(len(lines) * [29.1], abs=0.05)
    # It hangs still there: the weight that the sensor shows, and nothing of a bounce.
    tension = [line["outputs"]["winch.tension"] for line in lines]
    assert np.ptp(tension[:-1]) < 200.0


LOWERED = 10.6


def beyond(stamps):
    """Rows of a crane that goes on hoisting into the block, stands there, and lowers the load by 3 m."""
    hung = [r for t, r in rows() if t < 4.6][-1]
    for t in stamps:
        hoisted = -(2.0 * min(t, 5.6) - 1.0)
        yield (
            t,
            {**hung, "heave": 0.0, "winch_pos": hoisted + min(max(0.0, t - LOWERED), 3.0) + 1e-4 * np.sin(50.0 * t)},
        )


@functools.cache
def rows_into_the_block():
    return [one for one in rows() if one[0] < 4.5] + list(beyond(np.round(np.arange(4.6, 16.6, 0.2), 9)))


@pytest.fixture(scope="module")
def into_the_block():
    twin, kept = twin_of(WEIGHT), None
    lines, tries = [], set()
    for stamp, readings in rows_into_the_block():
        lines += twin.add(stamp, readings)
        twin.work()
        if twin.loss.text:
            kept = kept or copy.deepcopy(twin)
            tries.add(twin.loss.next_try)
    return twin, lines + twin.finish(), kept, len(tries)


def test_a_hook_that_the_sensors_show_at_the_block_is_told_as_long_as_it_is_there_and_the_twin_goes_on(into_the_block):
    twin, lines, *_ = into_the_block
    assert len(lines) == len(rows_into_the_block())
    at_block = [line for line in lines if 5.8 < line["time"] < LOWERED]
    kept = next(line["estimates"]["payload.mass"] for line in lines if line["outputs"] == {})
    for line in at_block:
        (one,) = [one for one in line["alarms"] if one["name"] == "two-blocking ahead"]
        assert one["known"] and line["health"] == "lost" and line["outputs"] == {}
        assert any("tries to begin" in one["text"] for one in line["alarms"] if one["name"] == "simulation stopped")
        assert line["estimates"]["payload.mass"]["value"] == kept["value"]
    begun = {one["since"] for line in at_block for one in line["alarms"] if one["name"] == "simulation stopped"}
    assert len(begun) == 1
    assert lines[-1]["health"] != "lost" and lines[-1]["outputs"]
    assert any("the simulation began again where the sensors are" in note for note in twin.notes)


def test_a_simulation_that_stops_again_and_again_is_tried_every_few_seconds_and_not_at_every_row(into_the_block):
    assert 2 <= into_the_block[3] <= 3, "in 50 rows of 10 s"


def test_why_no_simulation_goes_on_is_noted_once_and_not_at_every_try(into_the_block):
    notes = [note for note in into_the_block[0].notes if "the simulation stopped where the sensors are" in note]
    assert len(notes) == 1
    assert not into_the_block[2].loss.of_all, "it was simulated before"
    assert "Check zero" not in notes[0]


def test_an_overload_that_is_measured_is_told_while_no_simulation_goes_on(into_the_block):
    twin = copy.deepcopy(into_the_block[2])
    begin = twin.now
    given = [(t, {**r, "rope_tension": 120.0}) for t, r in rows_into_the_block() if begin + 0.3 < t < begin + 2.0]
    lines = fed(twin, given)
    assert lines[-1]["health"] == "lost"
    assert "overload" in {one["name"] for one in lines[-1]["alarms"]}


def test_a_twin_without_a_simulation_goes_on_from_a_saved_state_to_the_bit(into_the_block, tmp_path):
    twin = copy.deepcopy(into_the_block[2])
    save(twin, tmp_path / "state")
    other = twin_of(WEIGHT)
    begin = load(other, tmp_path / "state")
    given = [one for one in rows_into_the_block() if begin < one[0] < 11.0]
    told = [[json.dumps(line | {"lag": 0.0}, sort_keys=True) for line in fed(one, given)] for one in (twin, other)]
    assert told[0] == told[1][: len(told[0])] and len(told[0]) > 20


WINCH = Channel(
    column="winch", name="winch.pay_out", is_input=True, unit="m", scale=1.0, zero=0.0, zero_first=False,
    sd=np.nan, relative=False, low=-np.inf, high=np.inf, waves=False, lost_after=5.0,
)  # fmt: skip


def test_an_encoder_that_is_set_to_zero_is_joined_without_first_going_metres_on():
    """A load hoisted at 2 m/s cannot be shown to be 23 m elsewhere: on the way there it only comes to rest first."""
    dt, n = 0.05, 240
    times = dt * np.arange(2 * n)
    values = np.where(times < n * dt, -2.0 * times, 0.0)
    track = InputTrack(WINCH, 0)
    track.begin(0.0, -dt)
    states = []
    given = [Row(t, np.array([x])) for t, x in zip(times, values, strict=True)]
    for k in range(2 * n - 4):
        near = slice(max(0, k - 6), k + 4)
        states.append(track.follow(given[near], values[near], given[k], 3.0 * dt).copy())
    places = np.array(states)[:, 0]
    left = -2.0 * (n - 1) * dt
    # Braking evenly within `JOIN` takes v T / 2; with its speed kept up over the whole way it was 8 m.
    assert places.min() > left - 0.5 * 2.0 * JOIN * 0.5
    assert np.all(np.diff(places[n + round(JOIN / dt) :]) > 0.0)


def left_of(shown, held, fastest):
    """How long a track at rest at `held` takes to join what its sensor shows, `shown` (3,), and what is left (n,)."""
    track = InputTrack(WINCH, 0)
    track.fastest = fastest
    track.begin(held, 0.0)
    track.join_from_rest(np.array(shown))
    over = max(JOIN, 1.875 * abs(held - shown[0]) / fastest)
    times = np.linspace(0.0, over, 401)
    return times, np.array([track._left(time)[0] for time in times])


def one_quintic(shown, held, times):
    """The same difference made up for by the one quintic with its place, rate and second rate."""
    apart = np.array([held, 0.0, 0.0]) - shown
    return BPoly.from_derivatives([0.0, times[-1]], [apart, np.zeros(3)])(times)


def beyond_both(left):
    return max(left.max() - max(0.0, left[0]), min(0.0, left[0]) - left.min())


@pytest.mark.parametrize(("speed", "period"), [(2.0, 9.0), (2.0, 20.0)])
def test_a_join_in_a_swell_leads_no_further_beyond_the_machines_range_than_one_quintic_does(speed, period):
    w, rng = 2.0 * np.pi / period, np.random.default_rng(0)
    size, found, apart = speed / w, [], []
    for phase, held in zip(rng.uniform(0.0, 2.0 * np.pi, 60), rng.uniform(-size, size, 60), strict=True):
        sine, cosine = np.sin(phase), np.cos(phase)
        shown = (size * sine, speed * cosine, -speed * w * sine)
        times, left = left_of(shown, held, speed)
        quintic, way = one_quintic(shown, held, times), size * np.sin(w * times + phase)
        apart.append(beyond_both(left) - beyond_both(quintic))
        found.append([np.abs(way + one).max() - size for one in (left, quintic)])
    ours, theirs = np.max(found, axis=0)
    # With rates that always go within `JOIN` it was 1.2 m instead of 0.2 m, and 3.5 m instead of 0.5 m.
    assert ours <= theirs + 1e-3
    assert max(apart) <= 1e-3


@pytest.mark.parametrize("speed", [0.7, 2.0])
def test_a_leap_at_speed_leads_no_further_beyond_both_places_than_braking_within_the_shortest_join(speed):
    shown, held = (23.1, speed, 0.0), 0.0
    times, left = left_of(shown, held, 2.0)
    # Braking evenly is v T / 2. One quintic goes 1.4 and 5.8 m beyond.
    assert beyond_both(left) < 0.5 * speed * JOIN < beyond_both(one_quintic(shown, held, times))
