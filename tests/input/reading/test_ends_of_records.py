"""Records that begin after a run or end before it: what holds there is told where it matters."""

import numpy as np
import pytest

from crane.application import Crane
from crane.scene.scene import CraneScene
from crane.sea.mru import read_motions
from tautline.scene.errors import SceneError
from tautline.scene.gaps import ends_of_records
from tautline.scene.reading.document import Document
from tautline.scene.unit_slips import slips_of_units

CRANE = """\
rope: {mass_per_length: 2 kg/m, axial_stiffness: 40 MN, damping: 1 ms}
bodies: [{name: load, mass: 2 t, position: [0.3, 0, -30]}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.3, axis: [0, 1, 0], wrap: over, pay_out: {table: {file: w.csv}}}
  - end: {name: hook, body: load}
solver: {step: 10 ms, end: 20 s}
output: {interval: 20 ms}
"""
HEAVE = CRANE.replace("{table: {file: w.csv}}", "0") + (
    "vessel: {reference: [0, 0, 0], motion: {heave: {sum: [{table: {file: w.csv}}, 0.1]}}}\n"
)


def told(folder, rows, scene=CRANE, step=0.01):
    """Warnings of a scene with a file of rows (time, value)."""
    (folder / "w.csv").write_text("time,value\n" + "".join(f"{t:.15g},{value:.9g}\n" for t, value in rows))
    document = Document.parse(scene, folder / "scene.yaml")
    CraneScene.read(document)
    return [str(one) for one in ends_of_records(CraneScene, document, 20.0, step)]


def speed(first, last):
    return [(t, -0.2 + np.sin(t)) for t in np.arange(first, last, 0.1)]


def test_a_record_without_a_row_in_the_run_is_told(tmp_path):
    (text,) = told(tmp_path, speed(100.0, 125.0))
    assert text.startswith("path[0].drum.pay_out.table.file (line 4): no row of w.csv lies in the run, from 0 to 20 s")
    assert "The first value, -0.7064 m/s, holds throughout" in text and "from the start of the run" in text
    (text,) = told(tmp_path, speed(-40.0, -10.0))
    assert "The last value" in text


def test_a_speed_that_goes_on_behind_the_last_row_is_told(tmp_path):
    (text,) = told(tmp_path, [(0.25 * k, -0.5) for k in range(21)])
    assert "w.csv ends at 5 s, and the run goes on to 20 s: the last value, -0.5 m/s, holds from there on" in text


def test_a_speed_before_the_first_row_is_told(tmp_path):
    (text,) = told(tmp_path, [(t, -0.5) for t in range(6, 30)])
    assert "w.csv begins at 6 s, and the run at 0: the first value, -0.5 m/s, holds until then" in text


def test_waves_and_what_still_moves_are_told_where_a_place_is_held(tmp_path):
    waves = [(t, np.sin(t)) for t in np.arange(0.0, 4.75, 0.05)]
    for rows in (waves, [(0.0, 0.0), (5.0, 2.0)]):
        (text,) = told(tmp_path, rows, HEAVE)
        assert text.startswith("vessel.motion.heave.sum[0].table.file (line 8): w.csv ends at")


WITHOUT_A_WORD = {
    "a record of the whole run": (speed(0.0, 25.0), CRANE),
    "a record that lacks a row's time": (speed(0.05, 20.0), CRANE),
    "a winch that has come to rest": ([(0, 0), (1, -1), (4, -1), (5, 0)], CRANE),
    "a winch that begins at rest": ([(5, 0), (6, -1), (30, -1)], CRANE),
    "a speed that is reached and held": ([(0, 0), (1, -0.5), (10, -0.5)], CRANE),
    "a speed that grows to its end": ([(0, 0), (5, -0.5)], CRANE),
    "times of a clock, which are told as such": (speed(1714564800.0, 1714564825.0), CRANE),
    "a single row": ([(0, -1.0)], CRANE),
    "a place that is reached": ([(2, 0), (3, 0), (4, 0.5), (8, 2.0), (9, 2.0)], HEAVE),
    "what does not move at all": ([(30, 1.0), (40, 1.0)], HEAVE),
}


@pytest.mark.parametrize(("rows", "scene"), WITHOUT_A_WORD.values(), ids=WITHOUT_A_WORD)
def test_ends_that_hold_what_is_meant_are_read_without_a_word(rows, scene, tmp_path):
    assert told(tmp_path, rows, scene) == []


def test_a_list_in_the_scene_holds_its_ends_without_a_word(tmp_path):
    scene = CRANE.replace("file: w.csv", "time: [2, 3], value: [-1, -1]")
    assert told(tmp_path, [(0, 0)], scene) == []


def test_the_end_of_a_record_is_among_the_warnings_of_check(tmp_path):
    told(tmp_path, speed(0.0, 5.0))
    scene = CraneScene.read(Document.parse(CRANE, tmp_path / "scene.yaml"))
    assert any("w.csv ends at 4.9 s" in one.text for one in Crane().warnings(scene))


def test_times_are_told_with_all_their_digits(tmp_path):
    (text,) = told(tmp_path, speed(86400123.45, 86400150.0))
    assert "its times go from 86400123.45 s to " in text


def slips(tmp_path, rows):
    told(tmp_path, rows)
    return [one.text for one in slips_of_units(CraneScene, Document.parse(CRANE, tmp_path / "scene.yaml"))]


def test_times_of_a_clock_are_told_as_such_and_no_unit_is_offered(tmp_path):
    (text,) = slips(tmp_path, [(1714564800.0 + 0.1 * k, 0.5) for k in range(30)])
    assert text.startswith("1714564800.0 s") and "looks like a time of the clock" in text
    assert "counted from the start of the run" in text and "meant" not in text


def test_begin_of_a_record_may_be_a_time_of_its_clock(tmp_path):
    head = "time,surge,sway,heave,roll [deg],pitch [deg],yaw [deg]\n"
    rows = "".join(f"{1714564800.0 + 0.1 * k:.1f},0,0,{np.sin(0.08 * k):.6f},0,0,0\n" for k in range(300))
    (tmp_path / "m.csv").write_text(head + rows)
    scene = CRANE.replace("{table: {file: w.csv}}", "0")
    scene += "vessel: {reference: [0, 0, 0], motion: {file: m.csv, ramp: 4, begin: 1714564800}}\n"
    document = Document.parse(scene, tmp_path / "scene.yaml")
    read = CraneScene.read(document)
    assert [one for one in Crane().warnings(read) if "begin" in one.where] == []


def test_the_cure_of_a_record_that_begins_or_ends_elsewhere_works(tmp_path):
    time = 1714564800.3 + 0.1 * np.arange(300)
    rows = "".join(f"{t:.1f},0,0,{np.sin(0.8 * k):.6f},0,0,0\n" for k, t in enumerate(time))
    (tmp_path / "m.csv").write_text("time,surge,sway,heave,roll [deg],pitch [deg],yaw [deg]\n" + rows)
    with pytest.raises(SceneError) as error:
        read_motions(tmp_path / "m.csv", 20.0)
    begin = error.value.problems[0].cure.split("`begin: ")[1].split("`")[0]
    assert begin == "1714564800.3"
    read_motions(tmp_path / "m.csv", 20.0, begin=float(begin))
    (tmp_path / "m.csv").write_text(
        "time,surge,sway,heave,roll [deg],pitch [deg],yaw [deg]\n"
        + "".join(f"{41.15226667 * k:.8f},0,0,{k},0,0,0\n" for k in range(4))
    )
    with pytest.raises(SceneError) as error:
        read_motions(tmp_path / "m.csv", 200.0)
    end = error.value.problems[0].cure.split("end at ")[1].split(" s")[0]
    assert float(end) == pytest.approx(123.4568, abs=1e-6)
    read_motions(tmp_path / "m.csv", float(end))


def test_a_row_near_which_a_record_passes_zero_is_no_slip_of_a_unit(tmp_path):
    rows = [(t, np.sin(2.0 * np.pi * t / 5.0)) for t in np.arange(0.0, 20.1, 0.1)]
    assert any(0.0 < abs(value) < 1e-12 for _, value in rows)
    assert slips(tmp_path, rows) == []
    (text,) = slips(tmp_path, [(t, 1e-8 * (1.0 + value)) for t, value in rows])
    assert "unusual for a winch speed" in text, "but one of which all rows are small is"


def test_the_step_that_is_advised_for_close_rows_is_short_enough(tmp_path):
    """0.067 s / 4 was rounded up to 0.017 s, and with that step the warning came again."""
    draw = np.random.default_rng(1)
    rows = [(t, 0.5 * np.sin(t) + 1e-2 * draw.standard_normal()) for t in np.arange(0.0, 20.1, 0.067)]
    scene = HEAVE.replace("file: w.csv", "file: w.csv, interpolation: linear")
    (found,) = told(tmp_path, rows, scene, 0.02)
    advised = found.split("steps of ")[1].split(" s")[0]
    assert float(advised) == 0.016
    assert not told(tmp_path, rows, scene, float(advised))


@pytest.mark.parametrize(
    ("apart", "noise", "said"), [(0.013, 1e-3, True), (0.013, 0.0, False), (0.05, 1e-3, False), (0.013, 1e-7, False)]
)
def test_a_speed_that_jumps_like_noise_between_rows_closer_than_some_steps_is_told(tmp_path, apart, noise, said):
    draw = np.random.default_rng(1)
    times = np.arange(0.0, 20.1, apart)
    rows = [(t, 0.5 * np.sin(t) + noise * draw.standard_normal()) for t in times]
    found = told(tmp_path, rows, HEAVE.replace("file: w.csv", "file: w.csv, interpolation: linear"))
    assert bool(found) == said
    assert not said or ("are 0.013 s apart, and a step takes 0.01 s" in found[0] and "steps of 0.0032 s" in found[0])
    assert not told(tmp_path, rows, HEAVE)


JUMPING = CRANE.replace("{table: {file: w.csv}}", "0") + (
    "vessel: {reference: [0, 0, 0], motion: {heave: {table: {time: TIMES, value: VALUES, interpolation: linear}}}}\n"
)


def told_of_a_list(times, values, step=0.05):
    document = Document.parse(JUMPING.replace("TIMES", str(times)).replace("VALUES", str(values)), "scene.yaml")
    CraneScene.read(document)
    return [str(one) for one in ends_of_records(CraneScene, document, 2.0, step)]


def test_a_place_that_jumps_within_a_step_is_told_with_how_far_it_may_throw():
    """10 mm in 0.1 ms are 100 m/s, which a step of 50 ms would keep: 5 m, 500 times as far."""
    (text,) = told_of_a_list([0, 0.49995, 0.50005, 50.0], [0, 0, 0.01, 0.01])
    assert text.startswith(
        "vessel.motion.heave.table.value (line 8): the table jumps by 0.01 m within 0.0001 s, at 0.49995 s"
    )
    assert "up to 5e+02 times" in text and "over 0.1 s or more, or take steps of 5e-05 s" in text
    assert len(told_of_a_list(["0 s", "499.95 ms", "500.05 ms", "50 s"], [0, 0, 0.01, 0.01])) == 1
    # 8 mm of 10 m throw by 4 m; steeper rows of next to nothing hide no jump
    assert len(told_of_a_list([0, 0.49995, 0.50005, 9], [0, 0, 0.008, 10])) == 1
    steep = [0, 0.2, 0.2000001, 0.3, 0.3000001, 0.4, 0.4000001, 0.5, 0.501, 9]
    assert len(told_of_a_list(steep, [0, 0, 9e-6, 9e-6, 18e-6, 18e-6, 27e-6, 27e-6, 0.01, 0.01])) == 1


@pytest.mark.parametrize(
    ("times", "values"),
    [
        ([0, 0.45, 0.55, 50.0], [0, 0, 0.01, 0.01]),
        ([0, 1, 1.01, 2], [0, 1, 1.01, 2]),
        ([0.001 * k for k in range(2000)], [float(np.sin(0.005 * k)) for k in range(2000)]),
        ([0, 1, 1.001, 2], [0, 0.5, 0.5, 0]),
        ([0, 0.001], [1, 1]),
        ([0, 5, 5.0001, 50], [0, 0, 0.01, 0.01]),
    ],
    ids=[
        "over two steps",
        "a row more on a line",
        "a smooth record of fine rows",
        "two rows at a top",
        "no way",
        "behind the end",
    ],
)
def test_of_places_that_do_not_jump_within_a_step_nothing_is_said(times, values):
    assert told_of_a_list(times, values) == []
