"""Records of a vessel's motion that can be read and that no vessel moves by: told with line, cause and cure."""

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from crane.application import Crane
from crane.scene.scene import CraneScene
from crane.sea.mru import Record
from crane.sea.record_doubts import doubts, doubts_of_table
from tautline.kernels.time_function import sample
from tautline.scene.functions import Table
from tautline.scene.reading.document import Document
from tautline.system.time_functions import FunctionRequest, compile_functions

T = 0.1 * np.arange(250)
SWELL = 1.5 * np.sin(2.0 * np.pi * T / 8.0)
FIRST_LINE = 2


def told(time, heave, begin=0.0, end=20.0, ramp=4.0, **others):
    """Doubts of a record in which the vessel heaves, m, and does what others say, m and rad."""
    names = ("surge", "sway", "heave", "roll", "pitch", "yaw")
    motions = np.array([{"heave": heave, **others}.get(name, np.zeros(time.size)) for name in names])
    record = Record(Path("mru.csv"), np.array(time), motions, FIRST_LINE + np.arange(time.size))
    return list(doubts(record, begin, end, ramp))


def changed(rows, values):
    heave = SWELL.copy()
    heave[rows] = values
    return heave


NEAR = np.insert(T, 101, T[100] + 1e-4), np.insert(SWELL, 101, SWELL[100] + 0.002)
FAULTS = {
    "a sensor that is stuck": (T, changed(slice(80, 130), SWELL[80]), ("from line 82 to line 131", "stuck")),
    "a jump": (T, changed(90, 9.0), ("at line 92", "It jumps from", "between lines 91 and 92")),
    "two rows too close": (*NEAR, ("Lines 102 and 103 are only 0.0001 s apart", "Delete one")),
    "coarse steps": (T, np.round(2.0 * SWELL) / 2.0, ("go in steps of 0.5 m", "more digits")),
    "a step from a rest to another": (T, np.where(T < 10.0, 0.0, 5.0), ("It jumps from 0 m to 5 m", "lines 101")),
    "decimetres": (T, np.round(3.0 * np.sin(T / 48.0), 1), ("go in steps of 0.1 m", "more digits")),
    "a slow sensor with centimetres": (
        T,
        np.round(2.0 * np.sin(T / 15.0), 2)[np.arange(250) // 10 * 10],
        ("changes once in", "Keep only"),
    ),
    "stamps that jitter": (
        T + np.random.default_rng(4).uniform(-0.046, 0.046, 250),
        np.round(SWELL, 3),
        ("The times of its rows jitter", "Write the times evenly"),
    ),
    "a sensor that is stuck for half a second": (
        T,
        np.round(changed(slice(95, 102), SWELL[95]), 3),
        ("from line 97 to line 103", "stuck"),
    ),
    "a sensor that dies": (T, changed(slice(160, 250), SWELL[160]), ("stands still at", "from line 162 to line 251")),
    "a slow sensor": (T, SWELL[np.arange(250) // 10 * 10], ("changes once in", "Keep only the rows")),
    "a time in minutes": (T / 60.0, SWELL, ("No single row stands out", "the unit of the time")),
}


@pytest.mark.parametrize(("time", "heave", "words"), FAULTS.values(), ids=FAULTS)
def test_an_acceleration_that_no_vessel_has_is_told_with_its_cause_and_cure(time, heave, words):
    (text,) = told(time, heave)
    assert text.startswith("mru.csv gives heave an acceleration of ")
    assert all(word in text for word in words), text


def test_the_acceleration_told_is_that_of_a_spline_through_a_single_wrong_row():
    """The reference is the closed form of a natural spline through zeros and one reading, on an endless row."""
    e, h = 0.2, 0.1
    heave = np.zeros(250)
    heave[100] = e
    (text,) = told(T, heave)
    # m[k-1] + 4 m[k] + m[k+1] = 6 (f[k-1] - 2 f[k] + f[k+1]) / h^2 has the Green's function r^|k| / sqrt(12),
    # r = sqrt(3) - 2, on an endless row.
    r = np.sqrt(3.0) - 2.0
    expected = 6.0 * e / h**2 * (2.0 - 2.0 * r) / np.sqrt(12.0)
    assert float(text.split("acceleration of ")[1].split()[0]) == pytest.approx(expected, rel=1e-3)


def test_a_rotation_is_told_in_degrees():
    roll = np.radians(changed(90, 30.0))
    (text,) = told(T, SWELL, roll=roll)
    assert "gives roll an acceleration" in text and "deg/s^2 at line 92 (9 s, 30 deg)" in text


def test_a_stuck_sensor_is_told_where_it_goes_on_without_a_jump():
    crest = SWELL[100]
    heave = np.where(T <= T[100], SWELL, crest)
    heave[140:] = crest * np.cos(2.0 * np.pi * (T[140:] - T[139]) / 8.0)
    (text,) = told(T, heave)
    assert text.startswith(
        "heave of mru.csv may be wrong. It stands still at 1.5 m from line 102 to line 141, for 3.9 s"
    )


@pytest.mark.parametrize("apart", [5.0, 100.0])
def test_rows_more_than_a_second_apart_are_told_and_whether_the_time_is_in_ms_is_asked(apart):
    time = apart * np.arange(400.0)
    text = told(time, 1.5 * np.sin(2.0 * np.pi * np.arange(400.0) / 80.0))[0]
    assert f"are {apart:g} s apart" in text and "`time [ms]`" in text


@pytest.mark.parametrize(
    ("motion", "mean"), [({"heave": SWELL + 3.0}, "3.0"), ({"yaw": np.full(250, np.pi)}, "180 deg")]
)
def test_a_mean_that_a_ramp_grows_as_if_it_were_motion_is_told(motion, mean):
    (text,) = told(T, **{"heave": SWELL, **motion})
    assert f"has a mean of {mean}" in text and "Take the mean off" in text
    assert told(T, ramp=0.0, **{"heave": SWELL, **motion}) == []


def sea(time, deviation, peak):
    """A motion of 100 waves of a Pierson-Moskowitz sea, of a standard deviation."""
    frequency = 2.0 * np.pi / peak * np.linspace(0.5, 1.6, 100)
    size = np.sqrt(frequency**-5 * np.exp(-1.25 * (2.0 * np.pi / peak / frequency) ** 4))
    phase = np.random.default_rng(5).uniform(0.0, 2.0 * np.pi, 100)
    waves = np.cos(np.outer(time, frequency) + phase) @ size
    return deviation * waves / np.sqrt(0.5 * (size**2).sum())


@pytest.mark.parametrize("rate", [1.0, 5.0, 20.0, 100.0])
@pytest.mark.parametrize(("deviation", "peak"), [(0.05, 6.0), (0.5, 8.0), (1.5, 12.0)])
@pytest.mark.parametrize("end", [190.0, 20.0])
def test_a_sound_record_with_millimetres_is_read_without_a_word(rate, deviation, peak, end):
    time = np.arange(0.0, 200.0, 1.0 / rate)
    motion = sea(time, deviation, peak)
    angle = np.radians(np.round(5.0 * motion, 2))
    assert told(time, np.round(motion, 3), end=end, surge=np.round(motion, 3), roll=angle) == []


def test_rests_before_a_motion_and_behind_it_are_no_stuck_sensor():
    heave = np.where((T > 6.0) & (T < 18.0), 0.4 * np.sin(np.pi * (T - 6.0) / 12.0) ** 2, 0.0)
    assert told(T, heave) == []


def test_a_rest_at_any_place_before_a_motion_and_behind_it_is_no_stuck_sensor():
    heave = 2.0 - 0.3 * np.cos(np.pi * np.clip((T - 6.0) / 12.0, 0.0, 1.0))
    assert told(T, heave, ramp=0.0) == []


def test_a_fault_of_several_motions_is_told_once():
    wrong = changed(90, 9.0)
    (text,) = told(T, wrong, surge=0.5 * wrong, sway=wrong)
    assert text.startswith("mru.csv gives surge an acceleration") and text.endswith("The same is so of sway and heave")
    two = told(T, changed(90, 9.0), surge=changed(120, 9.0))
    assert len(two) == 2, "faults on other lines are others"


def test_rows_that_the_run_does_not_reach_are_not_judged():
    assert told(T, changed(200, 9.0), end=15.0) == []


def of_table(folder, heave, end=20.0, time=T, **others):
    rows = "".join(f"{t:.6g},{z:.9g}\n" for t, z in zip(time, heave, strict=True))
    (folder / "heave.csv").write_text("time,heave\n" + rows)
    table = Table(time=tuple(time), value=tuple(heave), file="heave.csv", **others)
    return list(doubts_of_table(folder / "heave.csv", table, "heave", end))


def test_a_jump_in_a_table_of_one_motion_is_told(tmp_path):
    (text,) = of_table(tmp_path, changed(90, 9.0))
    assert text.startswith("heave.csv gives heave an acceleration of") and "between lines 91 and 92" in text
    assert of_table(tmp_path, SWELL) == []
    assert of_table(tmp_path, changed(90, 9.0), interpolation="linear") == [], "corners are meant there"
    assert of_table(tmp_path, changed(200, 9.0), end=15.0) == [], "behind the run"


@pytest.mark.parametrize("step", [1.1, 5.0])
def test_the_acceleration_of_a_table_is_that_of_the_curve_that_a_run_follows_between_its_rows(step, tmp_path):
    time = np.arange(40.0)
    heave = np.where(time < 10.0, 0.0, step)
    (text,) = of_table(tmp_path, heave, 30.0, time)
    # Between two rests the quintic x^3 (10 - 15 x + 6 x^2) goes from one to the other: 10 / sqrt(3) at most.
    expected = step * 10.0 / np.sqrt(3.0)
    assert float(text.split("acceleration of ")[1].split()[0]) == pytest.approx(expected, rel=1e-3)
    assert f"It jumps from 0 m to {step:g} m between lines 11 and 12" in text
    followed = compile_functions([FunctionRequest(Table(time=tuple(time), value=tuple(heave)))])
    second = np.array(sample(followed, 0, np.linspace(9.0, 10.0, 20001)))[:, 2]
    assert np.abs(second).max() == pytest.approx(expected, rel=1e-6), "as the run has it"


@pytest.mark.parametrize("rate", [1.0, 5.0, 20.0, 100.0])
@pytest.mark.parametrize(("deviation", "peak"), [(0.05, 6.0), (0.5, 8.0), (1.5, 12.0)])
def test_a_sound_table_with_millimetres_is_read_without_a_word(rate, deviation, peak, tmp_path):
    time = np.arange(0.0, 100.0, 1.0 / rate)
    assert of_table(tmp_path, np.round(sea(time, deviation, peak), 3), 20.0, time) == []


def test_whole_centimetres_at_10_hz_are_told_as_what_they_are_and_not_as_noise(tmp_path):
    """A run follows a curve through them, with a tension of 86 kN in place of 51 kN on a rope without a ramp."""
    time = np.arange(0.0, 60.0, 0.1)
    heave = 0.5 * np.sin(2.0 * np.pi * time / 8.0)
    (text,) = of_table(tmp_path, np.round(heave, 2), 30.0, time)
    assert "Its readings have a last digit of 0.01 m" in text and "accelerations of up to 6 m/s^2 of that alone" in text
    assert "more digits" in text and "wrong unit" not in text
    # What up and down by half a digit makes, by a spline of another hand.
    ripple = CubicSpline(time, 0.005 * (-1.0) ** np.arange(time.size), bc_type="natural")
    assert np.abs(ripple(time, 2)).max() == pytest.approx(6.0, rel=0.3)
    assert np.abs(ripple(time[250:350], 2)).max() == pytest.approx(6.0, rel=1e-6)
    assert of_table(tmp_path, np.round(heave, 3), 30.0, time) == []
    noise = np.random.default_rng(1).uniform(-0.01, 0.01, time.size)
    assert "No single row stands out" in of_table(tmp_path, np.round(heave + noise, 6), 30.0, time)[0]


def test_a_doubtful_record_is_among_the_warnings_of_check(tmp_path):
    rows = "".join(f"{t:.6g},0,0,{z:.9g},0,0,0\n" for t, z in zip(T, changed(90, 9.0), strict=True))
    head = "time,surge,sway,heave,roll [deg],pitch [deg],yaw [deg]\n"
    (tmp_path / "mru.csv").write_text(head + rows)
    text = """\
rope: {mass_per_length: 5 kg/m, axial_stiffness: 50 MN, damping: 2 ms}
bodies: [{name: load, mass: 5 t, position: [20, 5, 5]}]
path: [{anchor: {name: tip, position: [20, 5, 30]}}, {end: {name: hook, body: load}}]
vessel: {reference: [5, 1, -3], motion: {file: mru.csv, ramp: 4}}
solver: {step: 10 ms, end: 20 s}
output: {interval: 20 ms}
"""
    scene = CraneScene.read(Document.parse(text, tmp_path / "scene.yaml"))
    found = [one for one in Crane().warnings(scene) if "It jumps from" in one.text]
    assert [one.where for one in found] == ["vessel.motion.file"]
    one_motion = text.replace("{file: mru.csv, ramp: 4}", "{heave: {table: {file: mru.csv, column: heave}}}")
    scene = CraneScene.read(Document.parse(one_motion, tmp_path / "scene.yaml"))
    found = [one for one in Crane().warnings(scene) if "It jumps from" in one.text]
    assert [one.where for one in found] == ["vessel.motion.heave"]
