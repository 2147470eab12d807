"""Files of other programs and of spreadsheets: what is doubtful is told by file, line and column."""

import numpy as np
import pytest

from crane.scene.scene import CraneScene
from tautline.kernels.time_function import sample
from tautline.scene import unit_slips
from tautline.scene.errors import Problem, SceneError
from tautline.scene.functions import Table
from tautline.scene.gaps import gaps_of_records
from tautline.scene.reading.columns import Columns
from tautline.scene.reading.document import Document
from tautline.scene.unit_slips import slips_of_units
from tautline.system.time_functions import FunctionRequest, compile_functions

CRANE = """\
units: field
rope: {mass_per_length: 5.5 kg/m, axial_stiffness: 80 MN, diameter: 36 mm, damping: 10 ms}
bodies: [{name: load, mass: 5 t, position: [10.2, 0, 0]}]
path:
  - drum: {name: winch, center: [0, 0, 10], radius: 0.4, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [10, 0, 20], radius: 0.2, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: load}
mesh: {elements_per_span: 4}
vessel: {reference: [0, 0, 0], motion: {heave: {table: {file: out.csv}}}}
solver: {step: 2 ms, end: 20 s}
output: {interval: 10 ms}
"""


def given(folder, text, scene=CRANE):
    """A crane's document whose vessel heaves by a file."""
    (folder / "out.csv").write_text(text)
    return Document.parse(scene, folder / "scene.yaml")


def refused(folder, text, scene=CRANE):
    with pytest.raises(SceneError) as error:
        CraneScene.read(given(folder, text, scene))
    return str(error.value)


def column(head, values):
    return f"time [s],{head}\n" + "".join(f"{k},{value}\n" for k, value in enumerate(values))


def of_column(document):
    return [one.text for one in slips_of_units(CraneScene, document) if "column" in one.text or "out.csv" in one.text]


def test_numbers_of_a_column_with_a_unit_are_not_doubted_and_one_without_is_told_once(tmp_path):
    assert of_column(given(tmp_path, column("out [ft]", [0.5, 1.5, 2.5]))) == []
    (told,) = of_column(given(tmp_path, column("out", [0.5, 1.5, 2.5])))
    assert "the column out of out.csv has no unit" in told and "out [m], or out [ft]" in told


def test_a_file_is_read_once_for_all_doubts_of_its_numbers(tmp_path, monkeypatch):
    document, read = given(tmp_path, column("out", [0.5 + k / 1000 for k in range(200)])), []

    def counted(path, *others):
        read.append(path)
        return Columns(path, *others)

    monkeypatch.setattr(unit_slips, "Columns", counted)
    assert len(of_column(document)) == 1
    assert len(read) == 1


GAP = "time [s],value [m]\n" + "".join(f"{k},{k % 3 / 10}\n" for k in (*range(6), *range(16, 22)))


def test_a_gap_in_a_record_is_refused_with_what_the_curve_of_a_run_makes_of_it(tmp_path):
    told = refused(tmp_path, GAP)
    assert "out.csv:8: 16 in time comes 11 s after line 7 with no row between" in told
    assert "gap:" in told and "interpolation: linear" in told
    # Between two rows at 0.2 m and 0.1 m the function that a run follows goes as far beyond them as is told.
    t = np.array([*range(6), *range(16, 22)], float)
    there = followed(t, t % 3 / 10, np.linspace(5.0, 16.0, 1001))
    off = max(there.max() - 0.2, 0.1 - there.min())
    assert off > 0.01 and float(told.split("goes ")[1].split(" m")[0]) == pytest.approx(off, rel=1e-3)


def followed(times, values, at):
    """What a run follows of a table (times,): the compiled function at times `at`."""
    function = compile_functions([FunctionRequest(Table(time=tuple(times), value=tuple(values)))])
    return np.array(sample(function, 0, at))[:, 0]


HOLDS = {
    "hoist, then hold": [(t, min(t, 10) * 0.2) for t in range(13)] + [(300, 2.0)],
    "hold before": [(-300, 0.0)] + [(t, max(t - 2, 0) * 0.2) for t in range(13)],
    "zeros": [(t, 0.0) for t in (*range(12), 100, 101)],
    "straight": [(t, 0.1 * t) for t in (*range(12), 100, 101)],
}


@pytest.mark.parametrize("rows", HOLDS.values(), ids=HOLDS)
def test_a_gap_that_the_curve_of_a_run_bridges_between_its_two_rows_is_read(rows, tmp_path):
    text = "time [s],value [m]\n" + "".join(f"{t},{value:.6g}\n" for t, value in rows)
    assert len(CraneScene.read(given(tmp_path, text)).vessel.motion.heave.time) == len(rows)
    times, values = np.array(rows, float).T
    i = int(np.diff(times).argmax())
    there = followed(times, values, np.linspace(times[i], times[i + 1], 1001))
    ends = sorted(values[i : i + 2])
    assert there.min() >= ends[0] - 1e-12 and there.max() <= ends[1] + 1e-12


def test_a_gap_among_stamps_that_jitter_by_some_per_cent_is_refused(tmp_path):
    late = np.random.default_rng(3).uniform(-0.04, 0.04, 40)
    kept = [k for k in range(40) if not 20 < k < 31]
    rows = "".join(f"{k + late[k]:.3f},{k % 3 / 10}\n" for k in kept)
    assert "with no row between" in refused(tmp_path, "time [s],value [m]\n" + rows)


def test_a_gap_that_is_no_duration_is_refused_under_its_own_key(tmp_path):
    told = refused(tmp_path, GAP, CRANE.replace("out.csv", "out.csv, gap: soon"))
    assert "vessel.motion.heave.table.gap = soon: " in told


@pytest.mark.parametrize("more", [", gap: 12 s", ", interpolation: linear"])
def test_a_gap_that_is_meant_is_bridged(more, tmp_path):
    scene = CRANE.replace("out.csv", f"out.csv{more}")
    assert len(CraneScene.read(given(tmp_path, GAP, scene)).vessel.motion.heave.time) == 12


@pytest.mark.parametrize(
    "rows",
    [
        [(0, 0), (1, 0), (20, 5)],
        [(t, t % 3) for t in (0, 2, 5, 7, 10, 12, 15, 60, 62, 65)],
        [(t, 0) for t in (0, 1, 3, 4, 8, 9, 15, 30, 31, 60)],
    ],
    ids=["three rows", "written by hand", "uneven"],
)
def test_a_table_of_few_rows_or_of_uneven_ones_is_no_record_and_its_longest_stretch_no_gap(tmp_path, rows):
    document = given(tmp_path, "time [s],value [m]\n" + "".join(f"{t},{value}\n" for t, value in rows))
    heave = CraneScene.read(document).vessel.motion.heave
    assert list(zip(heave.time, heave.value, strict=True)) == rows
    assert gaps_of_records(document) == []


def test_a_gap_is_of_a_file_only(tmp_path):
    scene = CRANE.replace("file: out.csv", "time: [0, 1], value: [0, 1], gap: 1 s")
    assert "gap = 1 s: is given without a file" in refused(tmp_path, "", scene)


def test_rows_out_of_order_and_doubled_ones_are_told_by_the_file_and_its_line(tmp_path):
    assert "out.csv:4: 1 in time is less than 2 in line 3" in refused(tmp_path, "time [s],value [m]\n0,0\n2,0\n1,0\n")
    told = refused(tmp_path, "time [s],value [m]\n0,0\n2,0\n2,1\n")
    assert "out.csv:4: 2 in time is the same as in line 3; keep one of lines 3 and 4" in told


def test_a_german_mark_of_thousands_is_asked_for(tmp_path):
    told = refused(tmp_path, "time [s];value [m]\n998;0\n999;0\n1.000;0\n")
    assert "is the point a mark of thousands? Then write 1000 without it" in told


def test_the_line_by_which_a_spreadsheet_states_its_separator_is_no_header(tmp_path):
    (tmp_path / "a.csv").write_text("sep=;\nt [s];x [m]\n0;1,5\n1;2,5\n")
    columns = Columns(tmp_path / "a.csv")
    assert columns.names == ["t", "x"] and columns.values(1, "m") == (1.5, 2.5)
    assert columns.lines == [3, 4]


def test_of_a_fault_on_many_lines_three_are_told_and_the_others_counted():
    rows = [Problem("a.csv", k, "md", f"{k}", f"above the station of line {k - 1}", "sort") for k in range(2, 123)]
    other = Problem("a.csv", 200, "inc", "x", "is not a number", "")
    lines = str(SceneError([*rows, other])).splitlines()
    assert len(lines) == 5 and lines[3] == "... and 118 more like this" and lines[4] == str(other)


def gaps(tmp_path, rows, scene=CRANE):
    """Warnings of a scene whose heave is a table of rows (time, value) in a file."""
    text = "time [s],value [m]\n" + "".join(f"{t:.6g},{value:.9g}\n" for t, value in rows)
    document = given(tmp_path, text, scene)
    CraneScene.read(document)
    return [str(one) for one in gaps_of_records(document)]


def swell(*times):
    return [(t, 0.5 * np.sin(2.0 * np.pi * t / 9.0)) for t in times]


RISES = swell(*(0.5 * k for k in range(33)), *(52.5 + 0.5 * k for k in range(20)))
"""At rows 0.5 s apart a stretch of 36.5 s is missing: the curve rises from the row before to the row behind."""


def test_a_missing_stretch_between_rows_that_a_curve_bridges_is_warned_of_with_file_lines_and_length(tmp_path):
    (told,) = gaps(tmp_path, RISES)
    assert told.startswith(
        "vessel.motion.heave.table.file (line 9): out.csv has no row for 36.5 s, between line 34 (16 s)"
    )
    assert "and line 35 (52.5 s). Its rows are 0.5 s apart else." in told and "`gap: 36.5`" in told
    linear = CRANE.replace("out.csv", "out.csv, interpolation: linear")
    assert gaps(tmp_path, RISES, linear) == [told]
    shorter = CRANE.replace("out.csv", "out.csv, interpolation: linear, gap: 30 s")
    assert gaps(tmp_path, RISES, shorter) == [told]


def test_a_missing_stretch_is_among_the_warnings_of_check(tmp_path):
    from crane.application import Crane

    gaps(tmp_path, RISES)
    document = Document.parse(CRANE, tmp_path / "scene.yaml")
    told = [one.text for one in Crane().warnings(CraneScene.read(document))]
    assert any("has no row for 36.5 s" in text for text in told)


UNEVEN = np.cumsum(np.tile([0.3, 0.5, 0.9], 5))
LIFT, GROWTH = np.sin(np.pi * np.arange(15) / 14.0), np.sin(0.5 * np.pi * np.arange(15) / 14.0)


def lifts(times):
    """Rows of lifts and lowerings in turn, each with rests of 90 s at 0, and with a hold at its full speed."""
    rows = []
    for k in range(times):
        begin, way = 240.0 * k, (-1.0) ** k
        rows += [(begin + t, way * v) for t, v in zip(UNEVEN, GROWTH, strict=True)]
        rows += [(begin + 100.0 + t, way * v) for t, v in zip(UNEVEN, GROWTH[::-1], strict=True)]
    return rows


WITHOUT_A_WORD = {
    "a lift, a rest and a lowering": (
        [*zip(UNEVEN, LIFT, strict=True), *zip(100.0 + UNEVEN, -LIFT, strict=True)],
        CRANE.replace("out.csv", "out.csv, interpolation: linear"),
    ),
    "lifts with holds and rests": (lifts(6), CRANE.replace("out.csv", "out.csv, interpolation: linear")),
    "a gap that the scene allows": (RISES, CRANE.replace("out.csv", "out.csv, gap: 40 s")),
    "few rows": (HOLDS["straight"], CRANE),
    "a ramp of uneven steps": ([(t, 0.1 * t**0.5) for t in (0, 1, 2, 4, 7, 10, 20, *range(30, 400, 37), 900)], CRANE),
    "equal rows, then a hold": ([(t, min(t, 30) * 0.1) for t in range(31)] + [(900, 3.0), (901, 3.0)], CRANE),
    "one speed throughout": ([(t, 0.01 * t) for t in (*range(30), 100, 101)], CRANE),
    "a hold between ramps": ([(t, min(t, 20, 120 - t)) for t in (*range(21), *range(100, 121))], CRANE),
    "a last row that holds": ([(t, 0.1 * t + 0.02 * t**2) for t in range(30)] + [(200, 2.9 + 0.02 * 841)], CRANE),
    "a hold, then half a cosine": (
        [(0, 0.0), *((60 + t, 0.5 - 0.5 * np.cos(np.pi * t / 24.0)) for t in range(25))],
        CRANE,
    ),
    "a row or two lost": (swell(*(0.5 * k for k in range(60) if k not in (20, 21))), CRANE),
}


@pytest.mark.parametrize(("rows", "scene"), WITHOUT_A_WORD.values(), ids=WITHOUT_A_WORD)
def test_rows_that_somebody_wrote_and_holds_and_rests_and_short_losses_are_read_without_a_word(rows, scene, tmp_path):
    assert gaps(tmp_path, rows, scene) == []


def test_equal_ends_of_a_missing_stretch_in_a_record_of_waves_are_warned_of(tmp_path):
    rows = swell(*(0.5 * k for k in range(30)), *(14.5 + 36.0 + 0.5 * k for k in range(20)))
    assert abs(rows[29][1] - rows[30][1]) < 1e-9
    linear = CRANE.replace("out.csv", "out.csv, interpolation: linear")
    (told,) = gaps(tmp_path, rows, linear)
    assert "no row for 36 s" in told


def jittered(share, missing=(), rows=200):
    """Rows of a swell 0.1 s apart but for normal noise of a share of that in their stamps."""
    noise = np.clip(np.random.default_rng(7).normal(0.0, share, rows), -0.45, 0.45)
    return swell(*(0.1 * (k + noise[k]) for k in range(rows) if k not in missing))


@pytest.mark.parametrize("more", ["", ", gap: 0.5 s"])
@pytest.mark.parametrize("share", [0.0, 0.12, 0.3])
def test_a_missing_stretch_is_told_however_much_the_stamps_jitter(share, more, tmp_path):
    linear = CRANE.replace("out.csv", f"out.csv, interpolation: linear{more}")
    (told,) = gaps(tmp_path, jittered(share, range(40, 100)), linear)
    assert "has no row for 6." in told and "between line 41" in told
    assert gaps(tmp_path, jittered(share), linear) == [], "and a record without one is read without a word"


def test_a_missing_stretch_among_jittered_stamps_is_refused_where_the_curve_swings(tmp_path):
    rows = "".join(f"{t:.6g},{value:.9g}\n" for t, value in jittered(0.12, range(60, 125)))
    assert "with no row between" in refused(tmp_path, "time [s],value [m]\n" + rows)


def test_rows_that_are_uneven_throughout_are_read_without_a_word_unless_the_scene_states_the_longest_gap(tmp_path):
    rows = swell(*np.cumsum(np.tile([0.2, 0.4, 1.1, 2.3, 0.6, 3.0, 0.1], 6)))
    assert gaps(tmp_path, rows) == []
    linear = CRANE.replace("out.csv", "out.csv, interpolation: linear, gap: 2.5 s")
    assert len(gaps(tmp_path, rows, linear)) == 3, "of six such stretches as many as are listed"
    few = CRANE.replace("out.csv", "out.csv, interpolation: linear, gap: 1 s")
    assert len(gaps(tmp_path, [(0, 0), (1, 1), (9, 9)], few)) == 1, "of a few rows, in a straight line"
