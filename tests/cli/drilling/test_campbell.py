"""The verb `campbell`: table, figure, CSV, JSON contract, exit codes and refusals."""

import csv
from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, files, leave_out_pixels, only_object
from matplotlib.colors import to_rgb

from drillstring.application import Drillstring
from drillstring.modes.campbell import campbell
from drillstring.modes.natural_modes import KINDS
from drillstring.scene.scene import read
from drillstring.view.campbell_figures import INKS, campbell_figure
from tautline.scene.values.units import RPM

DATA = Path(__file__).parents[3] / "data"
KEYS = {
    "speed",
    "orders",
    "up_to",
    "part",
    "supports",
    "model",
    "links",
    "loose",
    "rock_stiffness",
    "modes",
    "critical",
    "scene",
    "status",
    "figure",
    "csv",
    "warnings",
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("field_well", "hanging", "iscwsa_reference"):
        for path in DATA.glob(f"{name}.*"):
            Path(path.name).write_text(path.read_text(encoding="utf8"), encoding="utf8")
    return tmp_path


@pytest.fixture
def drawing(folder, capsys):
    """Commands that draw their figures in full."""
    return commands_of(Drillstring(), capsys)


@pytest.fixture
def drillstring(drawing, monkeypatch):
    leave_out_pixels(monkeypatch)
    return drawing


def test_campbell_takes_one_model_the_scenes_or_that_which_is_asked_for(drillstring):
    options = ("campbell", "field_well.yaml", "--modes", "axial", "--up-to", "2", "--json", "-o", "c.png")
    code, out, _ = drillstring(*options)
    lumps = only_object(out)
    code, out, _ = drillstring(*options, "--model", "ale-ancf")
    beam = only_object(out)
    assert code == 0 and (lumps["model"], beam["model"]) == ("lumped", "ale-ancf")
    first, other = (report["modes"][0]["frequency"] for report in (lumps, beam))
    assert first == pytest.approx(other, rel=2e-3) and first != other
    code, _, err = drillstring(*options, "--model", "lumped,ale-ancf")
    assert code == 2 and "--model" in err and "one diagram shows one" in " ".join(err.split())


@pytest.mark.parametrize(("kind", "words"), [("lumped", " links (axial)"), ("ale-ancf", "model: a beam (ale-ancf)")])
def test_table_figure_and_csv_name_the_model_that_they_were_made_with(drillstring, kind, words):
    files_asked = ("-o", "c.svg", "--csv", "c.csv")
    code, _, err = drillstring(
        "campbell", "field_well.yaml", "--modes", "axial", "--up-to", "2", "--model", kind, *files_asked
    )
    assert code == 0 and words in err
    assert words in Path("c.svg").read_text(encoding="utf8")
    with Path("c.csv").open(encoding="utf8", newline="") as file:
        assert {row["model"] for row in csv.DictReader(file)} == {kind}


def test_campbell_with_json_is_one_object_of_the_contract_in_si(drawing):
    code, out, err = drawing("campbell", "field_well.yaml", "--modes", "lateral,torsional", "--json")
    report = only_object(out)
    assert code == 0 and report.keys() == KEYS and report["status"] == "done"
    assert report["speed"] == pytest.approx([0.0, 200.0 * 2.0 * np.pi / 60.0])
    assert report["up_to"] == pytest.approx(10.0) and report["orders"] == [1.0, 2.0, 3.0]
    assert {mode["kind"] for mode in report["modes"]} == {"lateral", "torsional"}
    for mode in report["modes"]:
        assert len(mode["shape"]) == len(mode["measured_depth"]) and np.abs(mode["shape"]).max() == pytest.approx(1.0)
    for one in report["critical"]:
        frequency = report["modes"][one["mode"]]["frequency"]
        assert one["order"] * one["speed"] == pytest.approx(2.0 * np.pi * frequency)
    assert "stabiliser on the wall" in err and "wrote field_well_campbell.png" in err
    assert Path("field_well_campbell.png").read_bytes().startswith(b"\x89PNG")


def test_campbell_prints_a_row_for_each_mode_and_writes_nothing_to_standard_output(drillstring):
    code, out, err = drillstring(
        "campbell", "hanging.yaml", "--modes", "torsional,axial", "--blades", "5", "-o", "d.svg", "--csv", "modes.csv"
    )
    assert (code, out) == (0, "")
    heads, first, *_ = (line for line in err.splitlines() if line.strip())
    assert heads.split() == [
        "motion",
        "Hz",
        "error",
        "most",
        "at",
        "[m]",
        "1x",
        "rpm",
        "2x",
        "rpm",
        "3x",
        "rpm",
        "5x",
        "rpm",
    ]
    assert first.split()[:2] == ["T1", "torsional"]
    assert "<svg" in Path("d.svg").read_text(encoding="utf8") and not Path("hanging_campbell.png").exists()
    with Path("modes.csv").open(encoding="utf8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["kind"] for row in rows} == {"torsional", "axial"}
    for row in rows:
        assert 5.0 * float(row["5x [rpm]"]) / 60.0 == pytest.approx(float(row["frequency [Hz]"]))


def test_units_of_the_field_are_printed_where_the_scene_asks_for_them(drillstring):
    _, _, err = drillstring("campbell", "field_well.yaml", "--speed", "60 rpm:180 rpm", "--hold", "stabiliser,bit")
    assert "most at [ft]" in err and "stabiliser held" in err and "bit held on the axis" in err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["missing.yaml"], "there is no such file"),
        (["hanging.yaml", "--speed", "100"], "--speed 100: needs two numbers"),
        (["hanging.yaml", "--speed", "200:100"], "does not end above where it begins"),
        (["hanging.yaml", "--speed", "0:fast"], "--speed 0:fast"),
        (["hanging.yaml", "--speed", "0:5000"], "goes beyond 1000 rpm"),
        (["hanging.yaml", "--modes", "sideways"], "is not one of lateral, torsional, axial"),
        (["hanging.yaml", "--orders", "0"], "is no multiple of the rotary speed"),
        (["hanging.yaml", "--orders", "two"], "is no multiple of the rotary speed"),
        (["hanging.yaml", "--from", "1000"], "leaves nothing of the string"),
        (["hanging.yaml", "--modes", "axial", "--from", "100"], "--from 100: is of lateral modes, and axial ones are"),
        (["hanging.yaml", "--modes", "torsional,axial", "--hold", "bit"], "--hold bit: is of lateral modes"),
        (["hanging.yaml", "--hold", "collars"], "is not one of drill pipe"),
        (["hanging.yaml", "--from", "1", "--up-to", "150"], "links for bending waves of 150 Hz"),
        (["hanging.yaml", "--up-to", "0"], "--up-to"),
        (["hanging.yaml", "-o", "d.xyz"], "is no format of figures"),
        (["hanging.yaml", "--csv", "nowhere/t.csv"], "there is no folder nowhere"),
        (["hanging.yaml", "--blades", "0"], "--blades"),
    ],
)
def test_bad_input_exits_with_2_names_the_fault_and_writes_nothing(drillstring, folder, arguments, said):
    before = files(folder)
    code, out, err = drillstring("campbell", *arguments)
    assert (code, out) == (2, "")
    assert said in " ".join(err.split()) and "Traceback" not in err
    assert files(folder) == before


def test_a_campbell_diagram_writes_speeds_up_to_the_fastest_and_names_modes_of_all_kinds(folder):
    made = campbell(read(Path("field_well.yaml")), (0.0, 200.0 * RPM), kinds=KINDS)
    figure = campbell_figure(made)
    diagram, *shapes = figure.axes
    words = [text.get_text() for text in diagram.texts]
    speeds = [float(word) for word in words if word.isdigit()]
    assert max(speeds) > 150.0 and len(speeds) > 20
    assert {
        kind: any(word.startswith(letter) for word in words) for kind, letter in zip(KINDS, "LTA", strict=True)
    } == (dict.fromkeys(KINDS, True))
    assert "critical speed, rpm" in [text.get_text() for text in figure.legends[0].get_texts()]
    inks = [to_rgb(plot.get_lines()[0].get_color()) for plot in shapes]
    assert inks == [to_rgb(INKS[kind]) for kind in KINDS], "the darkest is the colour of the kind above"


def test_a_string_that_buckles_has_modes_without_frequency_and_error_and_json_warns_of_it(drillstring):
    # Euler's load of the pinned collar is 178.4 kN
    Path("column.yaml").write_text(
        "well: {sections: [{hold: 20 m}], diameter: 8.5 in, wall: none}\n"
        "string: [{name: c, length: 20 m, od: 0.165, id: 0.0714375}]\n"
        "material: {youngs_modulus: 206 GPa, shear_modulus: 79.3 GPa, density: 7850}\n"
        "bit: {lateral: pinned, force: -190 kN}\ngravity: 1.0e-3\nmodel: {elements: 20}\n"
        "solver: {step: 1 ms, end: 1 s}\noutput: {interval: 10 ms}\n",
        encoding="utf8",
    )
    code, out, err = drillstring("campbell", "column.yaml", "--up-to", "10", "--json")
    report = only_object(out)
    grown = [mode for mode in report["modes"] if not mode["stable"]]
    assert code == 0 and grown and all(mode["frequency"] is mode["error"] is None for mode in grown)
    (told,) = [one for one in report["warnings"] if one["where"] == "modes"]
    assert "the string does not rest so, it buckles" in told["text"]
    assert told["text"].split(";")[0] in " ".join(err.split())
