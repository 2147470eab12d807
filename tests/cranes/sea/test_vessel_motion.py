"""Records and seas that move a vessel: read as meant, or refused with file, line and cure."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from crane.sea.frames import GROUND, MOTIONS, requests_of
from crane.sea.mru import read_motions
from crane.sea.vessel import frames_of, in_sea, motions_of, read_response
from tautline.kernels.time_function import sample
from tautline.scene.errors import SceneError
from tautline.scene.functions import Constant, Harmonic, Ramp, Spectrum
from tautline.system.time_functions import FunctionRequest, compile_functions, jonswap

TIMES = np.arange(0.0, 20.05, 0.1)
HEADER = "t [s], surge [m], sway [m], heave [m], roll [deg], pitch [deg], yaw [deg]"
SEA = Spectrum(significant_height=2.5, peak_period=9.0, gamma=2.0, seed=7)
RAO_HEADER = "period [s], heave [m/m], heave phase [deg], roll [deg/m], roll phase [deg]"
PERIODS = np.arange(1.5, 30.1, 0.5)


def rows_of(times):
    """Six plain waves, angles in degrees."""
    columns = [times] + [(i + 1.0) * np.sin(0.6 * times + i) for i in range(6)]
    return [", ".join(f"{x:.15g}" for x in row) for row in zip(*columns, strict=True)]


def record(folder, rows=None, header=HEADER):
    path = folder / "mru.csv"
    path.write_text("\n".join([header, *(rows_of(TIMES) if rows is None else rows)]) + "\n", encoding="utf8")
    return path


def evaluated(models, times):
    functions = compile_functions([FunctionRequest(model, end=float(times[-1])) for model in models])
    return np.array([sample(functions, i, times) for i in range(len(models))])


def spline(i, times, order=0):
    values = (i + 1.0) * np.sin(0.6 * TIMES + i) * (math.pi / 180.0 if i > 2 else 1.0)
    return CubicSpline(TIMES, values, bc_type="natural")(times, order)


def test_a_record_is_its_natural_spline_in_si(tmp_path):
    times = np.linspace(0.0, 19.9, 777)
    got = evaluated(read_motions(record(tmp_path), 20.0), times)
    for i in range(6):
        for order, error in ((0, 1e-12), (1, 1e-10), (2, 1e-8)):
            assert np.allclose(got[i, :, order], spline(i, times, order), atol=error)


@pytest.mark.parametrize(
    ("header", "units"),
    [
        ("Time (s);Surge (m);Sway (m);Heave (m);Roll (deg);Pitch (DEG);Yaw (degrees)", {}),
        ("t_s;surge_m;sway_m;heave_m;roll_deg;pitch deg;YawDeg", {}),
        ("t;surge;sway;heave;roll;pitch;yaw", {"roll": "deg", "pitch": "deg", "yaw": "deg"}),
        ("time [ms];surge;sway;heave;roll [deg];pitch [deg];yaw [deg]", {}),
        ("t_ms;surge;sway;heave;roll [deg];pitch [deg];yaw [deg]", {}),
    ],
)
def test_units_stand_in_the_header_or_in_the_scene(tmp_path, header, units):
    factor = 1000.0 if "ms" in header else 1.0
    rows = []
    for row in rows_of(TIMES):
        cells = row.split(", ")
        rows.append(";".join([f"{factor * float(cells[0]):.15g}", *cells[1:]]).replace(".", ","))
    got = evaluated(read_motions(record(tmp_path, rows, header), 20.0, units), np.array([7.3]))
    assert np.allclose(got[:, 0, 0], [spline(i, 7.3) for i in range(6)], atol=1e-12)


@pytest.mark.parametrize("name", ["T_min", "T_h", "t_min", "T_s", "time-ms", "Time/ms", "timems"])
def test_a_least_tension_is_no_time_of_a_record_and_a_time_that_is_not_understood_is_refused(name, tmp_path):
    with pytest.raises(SceneError) as error:
        read_motions(record(tmp_path, header=HEADER.replace("t [s]", name)), 20.0)
    (problem,) = error.value.problems
    assert problem.key == "t" and "no such column" in problem.cause and "t [s]" in problem.cure


def test_a_record_with_a_least_tension_beside_its_time_is_read_by_its_time(tmp_path):
    rows = [f"{row}, 1.0" for row in rows_of(TIMES)]
    got = evaluated(read_motions(record(tmp_path, rows, HEADER + ", T_min"), 20.0), np.array([7.3]))
    assert np.allclose(got[:, 0, 0], [spline(i, 7.3) for i in range(6)], atol=1e-12)


def test_other_columns_and_comments_are_passed_over(tmp_path):
    header = "# a record\nroll rate [deg/s]," + HEADER + ", heading [deg]"
    rows = ["9, " + row + ", 271" for row in rows_of(TIMES)]
    got = evaluated(read_motions(record(tmp_path, rows, header), 20.0), np.array([7.3]))
    assert got[2, 0, 0] == pytest.approx(spline(2, 7.3), abs=1e-12)


def test_an_envelope_lets_the_motion_grow_from_nothing(tmp_path):
    models = read_motions(record(tmp_path), 20.0, ramp=5.0)
    start = evaluated(models, np.array([0.0]))
    assert np.all(start == 0.0)
    times = np.linspace(0.01, 19.9, 777)
    x = np.clip(times / 5.0, 0.0, 1.0)
    envelope = x**3 * (10.0 - 15.0 * x + 6.0 * x * x)
    got = evaluated(models, times)
    for i in range(6):
        assert np.allclose(got[i, :, 0], envelope * spline(i, times), atol=1e-9)
    h = 1e-4
    above, below = evaluated(models, times + h), evaluated(models, times - h)
    assert np.allclose(got[..., 1], (above - below)[..., 0] / (2 * h), atol=1e-6)
    assert np.allclose(got[..., 2], (above - below)[..., 1] / (2 * h), atol=1e-3)


def test_a_record_may_begin_before_the_run_or_be_told_where(tmp_path):
    models = read_motions(record(tmp_path), 12.0, begin=7.3)
    assert evaluated(models, np.zeros(1))[4, 0, 0] == pytest.approx(spline(4, 7.3), abs=1e-12)


def replaced(number, old, new):
    def edit(lines):
        lines[number - 1] = lines[number - 1].replace(old, new, 1)
        return lines

    return edit


def with_cell(number, place, cell):
    def edit(lines):
        cells = lines[number - 1].split(", ")
        lines[number - 1] = ", ".join([*cells[:place], cell, *cells[place + 1 :]])
        return lines

    return edit


def without(first, last):
    return lambda lines: lines[: first - 1] + lines[last:]


def column(name, factor):
    """Every cell of a column times a number."""

    def edit(lines):
        place = [cell.split()[0] for cell in lines[0].split(", ")].index(name)
        for i, line in enumerate(lines[1:], 1):
            cells = line.split(", ")
            cells[place] = f"{factor * float(cells[place]):.15g}"
            lines[i] = ", ".join(cells)
        return lines

    return edit


# what is done to the record, the line and column at fault, words of the message
FAULTS = {
    "a gap": (without(100, 105), 100, "t", "no row in the 0.7 s before (gap is 0.3 s)"),
    "not a number": (with_cell(50, 1, "nan"), 50, "surge", "is not a finite number"),
    "a cell too many": (replaced(50, ", ", ", 7, "), 50, "row", "fills 8 cells, and the header has 7"),
    "a word": (replaced(51, "4.9", "four"), 51, "t", "is not a number"),
    "a row cut short": (lambda lines: [*lines[:9], "0.8, 1.0", *lines[10:]], 10, "sway", "the cell is empty"),
    "a time twice": (replaced(33, "3.1", "3"), 33, "t", "the same time as line 32"),
    "out of order": (replaced(33, "3.1", "1.1"), 33, "t", "earlier than line 32"),
    "three rows": (lambda lines: lines[:4], None, "", "3 rows are no record"),
    "no rows": (lambda lines: lines[:1], 1, "", "holds a header and no rows"),
    "nothing": (lambda lines: [], None, "", "is empty"),
    "no header": (lambda lines: lines[1:], 1, "", "the first line holds numbers"),
    "no yaw": (replaced(1, "yaw", "heading"), 1, "yaw", "there is no such column"),
    "two rolls": (replaced(1, "pitch", "roll"), 1, "roll", "columns 5 and 6 are both this"),
    "a bare angle": (replaced(1, "roll [deg]", "roll"), 1, "roll", "no unit"),
    "degrees as radians": (replaced(1, "pitch [deg]", "pitch [rad]"), None, "pitch", "more than 90 deg, here and in"),
    "heave in centimetres": (column("heave", 100.0), 2, "heave", "more than 30 m, here and in"),
    "a roll in metres": (replaced(1, "roll [deg]", "roll [m]"), 1, "roll", "'m' is not a unit like rad"),
    "an unknown unit": (replaced(1, "roll [deg]", "roll [furlongs]"), 1, "roll", "roll [deg]"),
    "a record that ends early": (without(180, 202), 179, "t", "the record ends 2.3 s before the run"),
    "a record that begins late": (column("t", -1.0), None, "t", "earlier than line 2"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_record_is_refused_by_line(tmp_path, name):
    edit, line, key, words = FAULTS[name]
    path = tmp_path / "mru.csv"
    path.write_text("\n".join(edit([HEADER, *rows_of(TIMES)])) + "\n", encoding="utf8")
    with pytest.raises(SceneError) as caught:
        read_motions(path, 20.0)
    problem = caught.value.problems[0]
    assert problem.file == str(path) and problem.key == key and words in str(problem)
    assert line is None or problem.line == line
    assert problem.cure


def test_a_record_without_units_names_those_of_the_scene_which_cure_it(tmp_path):
    path = tmp_path / "mru.csv"
    path.write_text("\n".join([HEADER.replace(" [deg]", ""), *rows_of(TIMES)]) + "\n", encoding="utf8")
    with pytest.raises(SceneError) as caught:
        read_motions(path, 20.0)
    said = "or `motion: {file: mru.csv, units: {roll: deg, pitch: deg, yaw: deg}}` in the scene"
    assert len(caught.value.problems) == 3 and all(said in problem.cure for problem in caught.value.problems)
    read_motions(path, 20.0, {"roll": "deg", "pitch": "deg", "yaw": "deg"})


def test_all_faulty_rows_are_named_at_once(tmp_path):
    rows = rows_of(TIMES)
    rows[10] = rows[10].replace("1", "x", 1)
    rows[20] = rows[20] + "e"
    with pytest.raises(SceneError) as caught:
        read_motions(record(tmp_path, rows), 20.0)
    assert [problem.line for problem in caught.value.problems] == [12, 22]


def test_a_record_without_file_and_one_of_later_times(tmp_path):
    with pytest.raises(SceneError, match="there is no such file"):
        read_motions(tmp_path / "no.csv", 20.0)
    with pytest.raises(SceneError, match=r"begins 1000 s after the run.*begin: 1000"):
        read_motions(record(tmp_path, rows_of(1000.0 + TIMES)), 20.0)


def test_a_gap_is_bridged_where_the_scene_says_so(tmp_path):
    rows = rows_of(TIMES)
    path = record(tmp_path, rows[:98] + rows[104:])
    read_motions(path, 20.0, gap=0.8)
    with pytest.raises(SceneError, match=r"gap is 0.5 s"):
        read_motions(path, 20.0, gap=0.5)


def test_a_wrapped_heading_is_refused(tmp_path):
    rows = [f"{t:.1f}, 0, 0, 0, 0, 0, {(358.0 + t) % 360.0}" for t in TIMES]
    with pytest.raises(SceneError, match="jumps by 35"):
        read_motions(record(tmp_path, rows), 20.0)


def test_units_of_header_and_scene_must_not_differ(tmp_path):
    with pytest.raises(SceneError, match="the header says deg, and the scene says rad"):
        read_motions(record(tmp_path), 20.0, {"roll": "rad"})
    with pytest.raises(SceneError, match="no such column; did you mean 'roll'"):
        read_motions(record(tmp_path), 20.0, {"rol": "rad"})


def test_a_run_to_the_records_very_end_moves_to_its_end(tmp_path):
    """Frames of a record that ends with the run neither stop at its last row nor are refused for it."""
    ship = SimpleNamespace(reference=(0.0, 0.0, -5.0), motion=SimpleNamespace(file="mru.csv", units={}, gap=None))
    record(tmp_path)
    frames, places = frames_of(ship, (), tmp_path, 20.0)
    assert places == {"ground": GROUND, "vessel": 0}
    requests = requests_of(frames, 20.0)
    rate = sample(compile_functions(requests[2:3]), 0, np.array([20.0]))[0, 1]
    assert abs(rate) > 0.1


def table(folder, header=RAO_HEADER, rows=None):
    if rows is None:
        rows = [f"{t:g}, {0.9 / (1.0 + 0.1 * t):.12g}, {-10.0 * t:g}, {0.1 * t:.6g}, {5.0 * t:g}" for t in PERIODS]
    path = folder / "rao.csv"
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf8")
    return path


def test_motions_in_a_sea_share_the_phase_of_every_wave(tmp_path):
    response = read_response(table(tmp_path))
    models = in_sea(SEA, response)
    a, w, phi = jonswap(SEA)
    frequency = 2.0 * math.pi / PERIODS[::-1]
    inside = w <= frequency[-1]
    times = np.linspace(0.0, 60.0, 301)
    got = evaluated(models, times)
    for i, size, lead in (
        (2, 0.9 / (1.0 + 0.1 * PERIODS), -np.radians(10.0 * PERIODS)),
        (3, np.radians(0.1 * PERIODS), np.radians(5.0 * PERIODS)),
    ):
        amplitude = a * np.interp(w, frequency, size[::-1]) * inside
        angle = phi + np.interp(w, frequency, lead[::-1])
        assert np.allclose(got[i, :, 0], np.sin(np.outer(times, w) + angle) @ amplitude, atol=1e-10)
    assert all(models[i] == Constant(value=0.0) for i in (0, 1, 4, 5))


def test_a_response_of_one_without_phase_is_the_sea_itself(tmp_path):
    rows = ["0.1, 1, 0", "5, 1, 0"]
    path = table(tmp_path, "frequency [rad/s], heave [m/m], heave lag [deg]", rows)
    times = np.linspace(0.0, 40.0, 101)
    got, wanted = evaluated([in_sea(SEA, read_response(path))[2], SEA], times)
    assert np.allclose(got, wanted, atol=1e-10)


def test_frequencies_may_be_in_hertz_in_any_order_and_lags_are_negative_leads(tmp_path):
    rows = ["0.5, 0.2, 30", "0.05, 1.0, 0", "0.1, 0.9, 350"]
    response = read_response(table(tmp_path, "frequency [Hz], pitch amplitude [deg/m], pitch_lag_deg", rows))
    assert np.allclose(response.frequency, 2.0 * math.pi * np.array([0.05, 0.1, 0.5]))
    assert np.allclose(response.amplitude["pitch"], np.radians([1.0, 0.9, 0.2]))
    assert np.allclose(response.phase["pitch"], np.radians([0.0, 10.0, -30.0]))


def test_a_direction_is_chosen_from_the_file(tmp_path):
    header = "direction [deg], frequency [rad/s], heave [m/m], heave phase [deg]"
    path = table(tmp_path, header, ["0, 0.2, 1, 0", "0, 4, 0.5, 0", "90, 0.2, 0.8, 0", "90, 4, 0.1, 0"])
    assert np.allclose(read_response(path, math.radians(90.0)).amplitude["heave"], [0.8, 0.1])
    with pytest.raises(SceneError, match=r"one of 0, 90 deg"):
        read_response(path)
    with pytest.raises(SceneError, match=r"45 deg is not in the file"):
        read_response(path, math.radians(45.0))


@pytest.mark.parametrize(
    ("asked", "heave"), [(180, 0.8), (-180, 0.8), (540, 0.8), (0, 1.0), (360, 0.9), (720, 1.0), (-90, 0.6), (270, 0.6)]
)
def test_a_direction_may_be_whole_turns_from_that_of_the_file(tmp_path, asked, heave):
    header = "direction [deg], frequency [rad/s], heave [m/m], heave phase [deg]"
    held = {0: 1.0, 180: 0.8, 270: 0.6, 360: 0.9}
    rows = [f"{angle}, {w}, {value}, 0" for angle, value in held.items() for w in (0.2, 4)]
    response = read_response(table(tmp_path, header, rows), math.radians(asked))
    assert np.allclose(response.amplitude["heave"], [heave, heave])


PLAIN = "frequency [rad/s], heave [m/m], heave phase [deg]"
FAULTY_TABLES = {
    "no unit of frequency": (PLAIN.replace(" [rad/s]", ""), ["0.2, 1, 0", "4, 1, 0"], 1, "rad/s or Hz?"),
    "a misspelt motion": (PLAIN.replace("heave [", "heve ["), ["0.2, 1, 0", "4, 1, 0"], 1, "no such column"),
    "no phase": (PLAIN.rpartition(",")[0], ["0.2, 1", "4, 1"], 1, "no column of its phase"),
    "a phase without a unit": (PLAIN.replace(" [deg]", ""), ["0.2, 1, 0", "4, 1, 0"], 1, "no unit"),
    "a rotation without a unit": (
        "frequency [rad/s], roll, roll phase [deg]", ["0.2, 1, 0", "4, 1, 0"], 1, "roll [deg/m]",
    ),
    "degrees as radians": (
        "frequency [rad/s], roll [rad/m], roll phase [deg]", ["0.2, 0.1, 0", "4, 3, 0"], 3, "more than any vessel's",
    ),
    "a negative response": (PLAIN, ["0.2, 1, 0", "4, -1, 0"], 3, "is negative"),
    "no frequency": (PLAIN.replace("frequency [rad/s]", "sway [m/m]"), ["1, 1, 0", "1, 1, 0"], 1, ""),
    "a frequency twice": (PLAIN, ["0.2, 1, 0", "4, 1, 0", "0.2, 1, 0"], 4, "the same frequency as line 2"),
    "a frequency of zero": (PLAIN, ["0, 1, 0", "4, 1, 0"], 2, "is not positive"),
    "one row": (PLAIN, ["0.2, 1, 0"], 2, "no table"),
    "no number": (PLAIN, ["0.2, 1, 0", "4, one, 0"], 3, "is not a number"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTY_TABLES)
def test_a_faulty_table_of_responses_is_refused_by_line(tmp_path, name):
    header, rows, line, words = FAULTY_TABLES[name]
    path = table(tmp_path, header, rows)
    with pytest.raises(SceneError) as caught:
        read_response(path)
    assert caught.value.problems[0].line == line and words in str(caught.value)
    assert all(problem.file == str(path) and problem.cure for problem in caught.value.problems)


def test_a_table_that_misses_the_sea_is_refused(tmp_path):
    path = table(tmp_path, PLAIN, ["0.2, 1, 0", "0.7, 1, 0"])
    with pytest.raises(SceneError, match=r"% of the sea's energy lies outside"):
        in_sea(SEA, read_response(path))


def test_six_functions_are_taken_as_they_stand():
    motion = SimpleNamespace(**{name: Harmonic(amplitude=1.0 + i, period=5.0) for i, name in enumerate(MOTIONS)})
    ship = SimpleNamespace(reference=(0.0, 0.0, 0.0), motion=motion)
    assert motions_of(ship, ".", 10.0) == tuple(getattr(motion, name) for name in MOTIONS)


def booms(*names_and_parents):
    nil = Constant(value=0.0)
    return [
        SimpleNamespace(name=name, parent=parent, pivot=(1.0, 2.0, 3.0), slew=Ramp(to=1.0, over=2.0), luff=nil)
        for name, parent in names_and_parents
    ]


def test_frames_stand_behind_their_parents_whatever_their_order_in_the_scene():
    nil = dict.fromkeys(MOTIONS, Constant(value=0.0))
    ship = SimpleNamespace(reference=(0.0, 0.0, 0.0), motion=SimpleNamespace(**nil))
    items = booms(("jib", "boom"), ("boom", None), ("post", "ground"), ("mast", "vessel"))
    frames, places = frames_of(ship, items, ".", 10.0)
    assert [frame.name for frame in frames] == ["vessel", "boom", "post", "mast", "jib"]
    assert [frame.parent for frame in frames] == [GROUND, 0, GROUND, 0, 1]
    assert places["jib"] == 4 and frames[4].key == "frames[0]"
    ashore, _ = frames_of(None, booms(("boom", None)), ".", 10.0)
    assert ashore[0].parent == GROUND and ashore[0].motion[5] == Ramp(to=1.0, over=2.0)
    with pytest.raises(ValueError, match="stand on"):
        frames_of(None, booms(("a", "b"), ("b", "a")), ".", 10.0)
