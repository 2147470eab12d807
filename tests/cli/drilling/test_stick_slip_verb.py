"""The verb stick-slip: JSON, table, files, options and scenes that are refused, runs that fail, interruption."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
import xarray
from cli.in_process import commands_of, files, leave_out_pixels, only_object
from matplotlib.colors import to_rgba

import drillstring.stick_slip.severity_map
from drillstring.application import Drillstring
from drillstring.scene.scene import read
from drillstring.stick_slip.record import sentences, table
from drillstring.stick_slip.severity_map import Cell, Map, stick_slip_map, varied
from drillstring.verbs.stick_slip import parse_range
from drillstring.view.stick_slip_figures import draw
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.errors import SceneError

DATA = Path(__file__).parents[3] / "data"
DRILLING = (DATA / "drilling.yaml").read_text(encoding="utf8").replace("elements: 24", "elements: 6")
KEYS = {
    "scene", "status", "speed", "weight", "severity", "stuck", "bit_speed_mean", "bit_speed_min", "bit_speed_max",
    "torque_on_bit", "weight_on_bit", "rate_of_penetration", "outcome", "verdict", "severity_so_far", "end_needed",
    "sticking_ends", "failures", "files", "warnings", "scene_warnings",
}  # fmt: skip
RPM = 2.0 * math.pi / 60.0
FEW = ("--speed", "60,170", "--weight", "60 kN,1e5", "--end", "20 s")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("drilling.yaml").write_text(DRILLING, encoding="utf8")
    Path("field.yaml").write_text("units: field\n" + DRILLING, encoding="utf8")
    Path("off.yaml").write_text(DRILLING.replace("on_bottom: true", "on_bottom: false"), encoding="utf8")
    law = DRILLING[DRILLING.index("  torque: {static") : DRILLING.index("  penetration")]
    Path("smooth.yaml").write_text(DRILLING.replace(law, ""), encoding="utf8")
    return tmp_path


@pytest.fixture
def drillstring_(folder, capsys):
    return commands_of(Drillstring(), capsys)


def test_processes_hold_their_map_in_json_and_files_find_what_one_does_and_say_where_sticking_ends(
    drillstring_, monkeypatch
):
    code, out, err = drillstring_("stick-slip", "drilling.yaml", "--json", "--jobs", "2", *FEW)
    report = only_object(out)
    assert (code, report["status"]) == (0, "done") and report.keys() == KEYS
    (warned,) = report["warnings"]
    assert "--end: 20 s is 4.2 periods of the string's first torsional mode" in warned
    assert report["speed"] == pytest.approx([60 * RPM, 170 * RPM]) and report["weight"] == [60e3, 100e3]
    severity, stuck = np.array(report["severity"], float), np.array(report["stuck"])
    assert severity.shape == (2, 2)
    assert np.all(severity[:, 0] > 0.9) and np.all(stuck[:, 0] > 0.05)
    assert np.all(np.array(report["severity_so_far"], float)[:, 1] < 0.3) and np.all(stuck[:, 1] == 0.0)
    assert report["verdict"] == [["sticks", "dying out"]] * 2
    # The block follows the rate of 20 m/h at 100 kN and 120 rpm, in proportion to both.
    rates = 20.0 / 3600.0 * np.outer([0.6, 1.0], [0.5, 170.0 / 120.0])
    assert np.array(report["rate_of_penetration"]) == pytest.approx(rates, rel=0.15)
    assert np.array(report["weight_on_bit"])[:, 1] == pytest.approx([60e3, 100e3], rel=0.05)
    assert report["sticking_ends"][1] == {
        "weight": 1e5, "sticks_at": pytest.approx(60 * RPM), "turns_at": pytest.approx(170 * RPM)
    }  # fmt: skip
    assert "100 kN: sticking ends between 60 rpm and 170 rpm" in err and "60 rpm" in err
    with Path("drilling_stick_slip.csv").open(newline="", encoding="utf8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 and float(rows[3]["torque_on_bit [N m]"]) == pytest.approx(report["torque_on_bit"][1][1])
    with xarray.open_dataset("drilling_stick_slip.nc", engine="h5netcdf") as data:
        assert data["severity"].dims == ("weight", "speed")
        assert data["severity"].values == pytest.approx(severity, nan_ok=True)
        assert data["verdict"].values.tolist() == report["verdict"] and data["end_needed"].attrs["units"] == "s"
        assert data["speed"].attrs["units"] == "rad/s" and data["status"].values[0, 0] == "done"
    assert Path("drilling_stick_slip.png").read_bytes().startswith(b"\x89PNG")
    leave_out_pixels(monkeypatch)
    code, out, _ = drillstring_("stick-slip", "drilling.yaml", "--json", "--jobs", "1", "-o", "one", *FEW)
    one = only_object(out)
    assert code == 0 and Path("one.csv").exists() and Path("one.png").exists()
    assert all(one[key] == report[key] for key in KEYS - {"files"})


def test_a_map_in_oilfield_units_prints_kip(drillstring_):
    code, _, err = drillstring_("stick-slip", "field.yaml", "--jobs", "1", "--speed", "170", "--weight", "20 kip",
                                "--end", "5 s")  # fmt: skip
    assert code == 0 and "20 kip: the" in err


def test_each_run_begins_at_rest_with_the_weight_and_the_laws_of_the_scene(folder):
    scene = varied(read("drilling.yaml"), 80 * RPM, 5e4, 12.0)
    assert scene.bit.weight == 5e4 and scene.bit.torque.weight == scene.bit.penetration.weight == 1e5
    assert scene.top.rotation.speed.to == pytest.approx(80 * RPM) and scene.top.rotation.torque_limit == 40e3
    assert scene.top.block.velocity.to == pytest.approx(20.0 / 3600.0 * 0.5 * 80.0 / 120.0)
    assert scene.top.block.velocity.over == scene.top.rotation.speed.over <= 3.0
    assert scene.solver.end == 12.0


@pytest.mark.parametrize(
    ("scene", "options", "said"),
    [
        ("off.yaml", (), "bit.on_bottom = false: a bit that hangs has no torque"),
        ("smooth.yaml", (), "gives no torque"),
        ("drilling.yaml", ("--speed", "40:160"), "needs three numbers"),
        ("drilling.yaml", ("--speed", "160:40:20"), "ends below where it begins"),
        ("drilling.yaml", ("--speed", "40 m"), "is not the unit of a rotary speed"),
        ("drilling.yaml", ("--speed", "40:160:0.001"), "take a larger step"),
        ("drilling.yaml", ("--speed", "1:100:1", "--weight", "1 kN:100 kN:1 kN"), "makes 10000 runs"),
        ("drilling.yaml", ("--speed", "-40"), "greater than zero"),
        ("drilling.yaml", ("--weight", "50 kN:100 kN:0"), "50 kN:100 kN:0: never gets to its end by a step of zero"),
        ("drilling.yaml", ("--weight", "50,,60"), "an entry is empty"),
        ("drilling.yaml", ("--weight", "5 m"), "a force"),
        ("drilling.yaml", ("--weight", "0"), "greater than zero; write '50 kN:250 kN:50 kN', or '50 kN,100 kN'"),
        ("drilling.yaml", ("--weight", "90 kN:60 kN:5 kN"), "the smaller first, such as '50 kN:250 kN:50 kN'"),
        ("drilling.yaml", ("--end", "0"), "greater than zero"),
        ("drilling.yaml", ("-o", "nowhere/map"), "there is no folder nowhere"),
    ],
)
def test_what_cannot_be_mapped_is_refused_with_a_cure_and_nothing_is_written(
    drillstring_, folder, scene, options, said
):
    before = files(folder)
    code, out, err = drillstring_("stick-slip", scene, *options)
    assert (code, out) == (2, "") and said in " ".join(err.split())
    assert files(folder) == before


def test_a_bare_speed_is_in_rpm_and_a_bare_weight_in_newton():
    assert parse_range("30:90:30", "--speed", "rad/s", RPM) == pytest.approx([30 * RPM, 60 * RPM, 90 * RPM])
    assert parse_range("2 rad/s,60", "--speed", "rad/s", RPM) == pytest.approx([2.0, 60 * RPM])
    assert parse_range("50 kN:60000:5e3", "--weight", "N") == pytest.approx([50e3, 55e3, 60e3])
    with pytest.raises(SceneError, match="write 40:160:20"):
        parse_range("1:2:3:4", "--speed", "rad/s")


def test_a_run_that_fails_is_in_the_map_by_name_and_the_others_are_kept(drillstring_, monkeypatch):
    real = drillstring.stick_slip.severity_map.simulate

    def simulate(model):
        if f"{170 * RPM:.6f}" in told[-1]:
            raise StoppedEarly(Status.NOT_CONVERGED, 1.5, "lump 3")
        return real(model)

    told = [""]
    build = drillstring.stick_slip.severity_map.build

    def remembering(scene):
        told.append(f"{scene.top.rotation.speed.to:.6f}")
        return build(scene)

    monkeypatch.setattr(drillstring.stick_slip.severity_map, "build", remembering)
    monkeypatch.setattr(drillstring.stick_slip.severity_map, "simulate", simulate)
    code, out, err = drillstring_("stick-slip", "drilling.yaml", "--json", "--jobs", "1", "--speed", "60,170",
                                  "--weight", "1e5", "--end", "15 s")  # fmt: skip
    report = only_object(out)
    assert code == 3 and report["status"] == "stopped: some runs"
    assert report["outcome"] == [["done", "not converged"]] and report["severity"][0][1] is None
    (failure,) = report["failures"]
    assert failure["status"] == "not converged" and "lump 3" in failure["sentence"]
    assert "stopped at 170 rpm, 100 kN: not converged" in " ".join(err.split())
    assert Path("drilling_stick_slip.png").exists()


def test_ctrl_c_keeps_what_was_run(drillstring_, monkeypatch):
    real = drillstring.stick_slip.severity_map.run_cell

    def run_cell(scene, speed, weight, end):
        if speed > 100 * RPM:
            raise KeyboardInterrupt
        return real(scene, speed, weight, end)

    monkeypatch.setattr(drillstring.stick_slip.severity_map, "run_cell", run_cell)
    code, out, err = drillstring_("stick-slip", "drilling.yaml", "--json", "--jobs", "1", "--speed", "60,170",
                                  "--weight", "1e5", "--end", "15 s")  # fmt: skip
    report = only_object(out)
    assert code == 130 and report["status"] == "interrupted"
    assert report["outcome"] == [["done", "not run"]] and "interrupted" in err


def cell(speed, stuck=0.0, severity=0.1, status="done"):
    numbers = [severity, stuck, 10.0, 5.0, 12.0, 4e3, 1e5, 5e-3] if status == "done" else [math.nan] * 8
    return Cell(speed * RPM, 1e5, *numbers, status, "", 0.1)


def test_of_a_bit_that_never_turned_it_is_not_said_that_it_sticks():
    """Runs that end before the twist of the drive has come to the bit."""
    still = Cell(100.0 * RPM, 1e5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1e5, 0.0, "done", "", 0.1)
    ((text, style),) = sentences(Map((100.0 * RPM,), (1e5,), ((still,),)), "si")
    assert "has not begun to turn when the runs end. Give a longer --end" in text and style == "yellow"


@pytest.mark.parametrize(
    ("cells", "ends", "said"),
    [
        ((cell(60), cell(90)), (None, 60), "100 kN: the bit does not stick from 60 rpm up"),
        ((cell(60, 0.2), cell(90, status="not run")), (60, None), "the highest speed that was run, 60 rpm"),
        ((cell(60, 0.2, 1.1), cell(90)), (60, 90), "100 kN: sticking ends between 60 rpm and 90 rpm"),
        ((cell(60), cell(90, 0.2, 1.1)), (90, None), "100 kN: the bit sticks up to the highest speed of all, 90 rpm"),
        ((cell(60, 0.2), cell(90), cell(120, 0.1), cell(150)), (120, 150), "between 120 rpm and 150 rpm"),
        ((cell(60, 0.2), cell(90, status="unstable"), cell(120)), (60, 120), "between 60 rpm and 120 rpm"),
    ],
)
def test_where_sticking_ends_is_told_above_the_highest_speed_that_sticks(cells, ends, said):
    found = Map(tuple(c.speed for c in cells), (1e5,), (tuple(cells),))
    got = [None if x is None else round(x / RPM) for x in found.ends()[0]]
    assert tuple(got) == ends
    assert said in sentences(found, "si")[0][0]


def test_a_cell_whose_bit_rocks_says_so_in_table_and_figure_where_a_severity_would_stand():
    found = Map((60 * RPM,), (1e5,), ((cell(60, 0.2, math.nan),),))
    (column,) = table(found, "si").columns[1:]
    assert list(column.cells) == ["rocks\u00a020%"]
    assert "rocks" in [text.get_text() for text in draw(found, "one cell").axes[0].texts]


def test_the_table_has_the_shorter_side_across_and_gives_way_to_the_files_where_both_are_long():
    def made(speeds, weights):
        row = tuple(cell(60 + k, 0.2) for k in range(speeds))
        return table(Map(tuple(c.speed for c in row), tuple(1e5 + k for k in range(weights)), (row,) * weights), "si")

    assert (len(made(3, 2).columns), made(3, 2).row_count) == (4, 2)
    assert (len(made(12, 2).columns), made(12, 2).row_count) == (3, 12)
    assert made(12, 12) is None


def test_a_map_of_one_cell_and_one_of_failures_alone_are_drawn():
    for cells in ((cell(60),), (cell(60, status="unstable"),)):
        figure = draw(Map((60 * RPM,), (1e5,), (cells,)), "one")
        assert figure.axes


def test_a_scene_made_in_python_says_that_it_has_no_text(folder):
    scene = read("drilling.yaml")
    bare = type(scene).model_construct(**{key: getattr(scene, key) for key in type(scene).model_fields})
    with pytest.raises(SceneError, match="put together in Python cannot be changed"):
        stick_slip_map(bare, [5.0], [1e5])


@pytest.mark.parametrize(
    ("speed", "weight", "said"),
    [
        ("60", "50", ["50 N is unusual for a weight on bit"]),
        (
            "60,1e6",
            "50 kN",
            ["--speed: 1000000 rpm is unusual for a rotary speed. 0.000955 rpm to 382 rpm is plausible"],
        ),
        ("60,120", "50 kN", []),
    ],
)
def test_speeds_and_weights_that_are_unusual_are_asked_about_in_json_too(
    drillstring_, monkeypatch, speed, weight, said
):
    def unrun(scene, speeds, weights, *further, **more):
        nothing = (np.nan,) * 8
        rows = [tuple(Cell(s, w, *nothing, "done", "", 0.0) for s in speeds) for w in weights]
        return Map(tuple(speeds), tuple(weights), tuple(rows))

    monkeypatch.setattr(drillstring.stick_slip.severity_map, "stick_slip_map", unrun)
    code, out, err = drillstring_("stick-slip", "drilling.yaml", "--json", "--speed", speed, "--weight", weight)
    asked = [one for one in only_object(out)["warnings"] if "unusual" in one]
    assert all(" ".join(one.split()) in " ".join(err.split()) for one in asked)
    assert code == 0 and len(asked) == len(said) and all(text in one for text, one in zip(said, asked, strict=True))


def still(speed, stall=math.nan):
    return Cell(speed * RPM, 1e5, math.nan, 1.0, 0.0, 0.0, 0.0, 0.0, 1e5, 0.0, "done", "", 0.1, stall)


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ((still(60), cell(90)), ["when the runs end at 60 rpm. Give a longer --end", "from 90 rpm up"]),
        ((cell(60, 0.2), still(90)), ["at 90 rpm. Give a longer --end", "the highest speed that is judged, 60 rpm"]),
        ((still(60, 6e3),), ["100 kN: the bit does not turn. The drive stalls at 6 kN m. Give more torque or less"]),
        ((still(60, 6e3), cell(90)), ["does not turn at 60 rpm. The drive stalls at 6 kN m", "from 90 rpm up"]),
        ((cell(60, 0.5)._replace(late=True), cell(90)), ["last half of the runs only at 60 rpm", "from 90 rpm up"]),
    ],
)  # fmt: skip
def test_each_cell_that_does_not_turn_is_told_with_what_would_turn_it(cells, said):
    texts = [text for text, _ in sentences(Map(tuple(c.speed for c in cells), (1e5,), (tuple(cells),)), "si")]
    assert len(texts) == len(said) and all(part in text for part, text in zip(said, texts, strict=True)), texts
    assert not any("longer --end" in text for text in texts if "stalls" in text)


@pytest.mark.parametrize("end", ["40 s", "80 s"])
def test_a_drive_that_stalls_below_what_the_bit_needs_is_told_however_long_the_runs_are(drillstring_, end):
    limit = ("--set", "top.rotation.controller.torque_limit=5 kN m")
    words = ("--speed", "120", "--weight", "1e5", "--end", end, "--jobs", "1", "--json")
    code, out, err = drillstring_("stick-slip", "drilling.yaml", *limit, *words)
    told = " ".join(err.split())
    assert code == 0 and only_object(out)["severity"] == [[None]]
    assert "The drive stalls at 5 kN m. Give more torque or less weight" in told and "longer --end" not in told


def test_a_bit_that_does_not_turn_before_the_runs_end_has_no_severity_and_does_not_count_as_sticking(drillstring_):
    words = ("--speed", "60,120", "--weight", "50e3,100e3", "--end", "1 s", "--jobs", "1", "--json")
    code, out, err = drillstring_("stick-slip", "drilling.yaml", *words)
    report, told = only_object(out), " ".join(err.split())
    assert code == 0 and report["severity"] == [[None, None]] * 2
    assert all(one["sticks_at"] is one["turns_at"] is None for one in report["sticking_ends"])
    assert "not turning" in told.replace("\u00a0", " ") and told.count("Give a longer --end") == 2
    assert "sticks up to" not in told and "0.00" not in told
    with Path("drilling_stick_slip.csv").open(newline="", encoding="utf8") as file:
        assert all(row["severity"] in ("", "nan") for row in csv.DictReader(file))


def test_a_bit_that_first_turns_in_the_half_that_is_judged_is_not_said_to_stick(drillstring_):
    words = ("--speed", "60,120", "--weight", "50e3,100e3", "--end", "3 s", "--jobs", "1", "--json")
    code, out, err = drillstring_("stick-slip", "drilling.yaml", *words)
    told = " ".join(err.split())
    assert code == 0 and "too short" in told.replace("\u00a0", " ") and only_object(out)["severity"][1] == [None, None]
    assert "sticks up to" not in told and told.count("Give a longer --end") >= 2


def test_a_cell_that_does_not_turn_is_grey_in_the_figure_and_its_legend_says_so():
    figure = draw(Map((60 * RPM,), (1e5,), ((still(60),),)), "one cell")
    assert "not\nturning" in [text.get_text() for text in figure.axes[0].texts]
    assert figure.legends[0].get_texts()[0].get_text() == "grey: not turning"
    (grey,) = figure.legends[0].get_lines()
    assert to_rgba(grey.get_color()) == figure.axes[0].get_facecolor(), "the legend's grey is the cell's"
    assert figure.axes[0].collections[0].get_array().mask.all()
