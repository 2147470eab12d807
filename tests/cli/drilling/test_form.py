"""The verb `form`: table, figure, CSV, JSON contract, exit codes and refusals."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, files, leave_out_pixels, only_object

from drillstring.application import Drillstring

DATA = Path(__file__).parents[3] / "data"
KEYS = {"node", "measured_depth", "position", "reference", "difference"}
"""Keys that other programs read: part of the contract of `--json`."""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("configuration_a", "configuration_b", "hanging", "jwell"):
        Path(f"{name}.yaml").write_text((DATA / f"{name}.yaml").read_text(encoding="utf8"), encoding="utf8")
    return tmp_path


@pytest.fixture
def drawing(folder, capsys):
    """Commands that draw their figures in full."""
    return commands_of(Drillstring(), capsys)


@pytest.fixture
def drillstring(drawing, monkeypatch):
    leave_out_pixels(monkeypatch)
    return drawing


def test_form_with_json_is_one_object_of_the_contract_for_the_finest_mesh(drillstring):
    code, out, err = drillstring("form", "configuration_b.yaml", "--elements", "50,10", "--json")
    report = only_object(out)
    assert code == 0 and report.keys() >= KEYS
    assert report["node"] == list(range(51))
    position, reference = np.array(report["position"]), np.array(report["reference"])
    assert position.shape == reference.shape == (51, 3)
    assert len(report["measured_depth"]) == 51
    # in a straight level hole northwards the measured depth is how far north a lump is
    assert report["measured_depth"] == pytest.approx(position[:, 0])
    assert report["difference"] == pytest.approx(np.linalg.norm(position - reference, axis=1))
    # by tests/references/extensible_rod.py
    assert reference[-1, 0] - 1000.0 == pytest.approx(-149.31423, abs=1e-5)
    assert position[:, 2].max() == pytest.approx(233.5539, rel=1e-3)
    assert [one["elements"] for one in report["meshes"]] == [10, 50]
    assert report["meshes"][1]["difference_max"] == pytest.approx(max(report["difference"]))
    assert report["meshes"][1]["end"] == report["position"][-1]
    assert (report["status"], report["figure"], report["csv"]) == ("done", "configuration_b_form.png", None)
    assert "wrote configuration_b_form.png" in err


@pytest.mark.parametrize("model", ["lumped", "ale-ancf"])
def test_the_largest_tension_of_a_hanging_string_is_the_rods_on_a_mesh_of_an_element_to_a_section(drillstring, model):
    code, out, _ = drillstring("form", "hanging.yaml", "--elements", "2,6", "--model", model, "--json")
    report = only_object(out)
    assert code == 0
    for mesh in report["meshes"]:
        assert mesh["tension_max"] == pytest.approx(report["rod"]["tension_max"], rel=1e-6)


def test_form_prints_a_row_for_each_mesh_and_one_for_the_rod_and_writes_nothing_to_standard_output(drillstring):
    code, out, err = drillstring("form", "hanging.yaml", "--elements", "5,12", "-o", "shape.svg")
    assert (code, out) == (0, "")
    rows = [line.split() for line in err.splitlines()]
    assert [row[0] for row in rows if "1000.3765" in row] == ["hanging", "lumped", "rod"]
    assert all("404.6" in row for row in rows if "1000.3765" in row)
    assert "[m]" in err
    assert "<svg" in Path("shape.svg").read_text(encoding="utf8")
    assert not Path("hanging_form.png").exists()


def test_several_scenes_make_one_figure_one_table_and_one_json_object(drawing):
    code, out, err = drawing(
        "form", "configuration_a.yaml", "configuration_b.yaml", "hanging.yaml", "--elements", "10", "--json"
    )
    report = only_object(out)
    assert code == 0
    assert [one["scene"] for one in report["scenes"]] == [
        "configuration_a.yaml",
        "configuration_b.yaml",
        "hanging.yaml",
    ]
    assert all(one.keys() >= KEYS for one in report["scenes"])
    assert report["figure"] == "forms.png" and Path("forms.png").read_bytes().startswith(b"\x89PNG")
    assert err.count("rod ") >= 3


def test_a_string_on_the_wall_has_no_reference_and_the_reason_is_told(drillstring):
    code, out, err = drillstring("form", "jwell.yaml", "--json", "-o", "j.pdf")
    report = only_object(out)
    assert code == 0
    assert report["reference"] is None and report["difference"] is None and report["rod"] is None
    assert "no exact rod: the hole is curved" in report["reference_said"] and "no exact rod" in err
    assert report["meshes"][0]["touching"] > 0 and "lumps lie on the wall" in err
    assert Path("j.pdf").read_bytes().startswith(b"%PDF")


def test_the_table_of_lumps_has_units_in_its_header_and_a_row_for_each_lump_of_each_mesh(drillstring):
    code, _, _ = drillstring("form", "configuration_b.yaml", "jwell.yaml", "--elements", "10,12", "--csv", "lumps.csv")
    assert code == 0
    with Path("lumps.csv").open(encoding="utf8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * (11 + 13)
    level = [row for row in rows if row["scene"] == "configuration_b" and row["elements"] == "12"]
    place = np.array([[float(row[f"{who}{way} [m]"]) for way in ("north", "east", "down")]
                      for row in level for who in ("", "rod ")]).reshape(13, 2, 3)  # fmt: skip
    told = [float(row["difference [m]"]) for row in level]
    assert told == pytest.approx(np.linalg.norm(place[:, 0] - place[:, 1], axis=1))
    assert all(row["difference [m]"] == row["rod down [m]"] == "" for row in rows if row["scene"] == "jwell")


def test_dynamic_relaxation_ends_in_the_same_form(drillstring):
    ends = []
    for way in ("static", "relaxation"):
        code, out, _ = drillstring("form", "configuration_b.yaml", "--elements", "10", "--by", way, "--json")
        report = only_object(out)
        assert code == 0 and report["by"] == way
        ends.append(report["position"])
    assert np.array(ends[0]) == pytest.approx(np.array(ends[1]), abs=1e-3), "a millionth of 1000 m"


def test_a_string_that_does_not_come_to_rest_ends_with_3_and_a_named_error(drillstring, folder):
    before = files(folder)
    code, out, err = drillstring("form", "configuration_b.yaml", "--by", "relaxation", "--most", "40", "--json")
    assert code == 3
    assert only_object(out)["status"] == "no equilibrium"
    assert "the string did not come to rest" in err and "40 steps" in err and "Traceback" not in err
    assert files(folder) == before


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["missing.yaml"], "there is no such file"),
        (["hanging.yaml", "--by", "magic"], "--by magic: is no method of finding rest"),
        (["hanging.yaml", "--most", "100"], "given without --by relaxation"),
        (["hanging.yaml", "--elements", "ten"], "--elements ten: is no list of numbers of elements; write 10,20,50"),
        (["hanging.yaml", "--elements", ""], "is no list of numbers of elements"),
        (["hanging.yaml", "--elements", "10,0"], "is no list of numbers of elements"),
        (["hanging.yaml", "--elements", "1"], "fewer than the 2 sections"),
        (["hanging.yaml", "--elements", ",".join(map(str, range(2, 40)))], "more than 20"),
        (["hanging.yaml", "--elements", "500000"], "--elements"),
        (["hanging.yaml", "-o", "shape.xyz"], "is no format of figures"),
        (["hanging.yaml", "-o", "nowhere/shape.png"], "there is no folder nowhere"),
        (["hanging.yaml", "--csv", "table.txt"], "name it .csv"),
        (["hanging.yaml", "--csv", "nowhere/table.csv"], "there is no folder nowhere"),
        (["hanging.yaml", "--elemnts", "10"], "--elemnts"),
    ],
)
def test_bad_input_exits_with_2_names_the_fault_and_writes_nothing(drillstring, folder, arguments, said):
    before = files(folder)
    code, out, err = drillstring("form", *arguments)
    assert (code, out) == (2, "")
    assert said in " ".join(err.split()) and "Traceback" not in err
    assert files(folder) == before


def test_both_models_stand_beside_the_rod_in_one_table_and_figure(drillstring):
    code, out, _ = drillstring(
        "form", "configuration_a.yaml", "--model", "lumped,ALE_ANCF", "--elements", "10,20", "--csv", "a.csv", "--json"
    )
    report = only_object(out)
    assert code == 0
    assert [(one["model"], one["elements"]) for one in report["meshes"]] == [
        ("lumped", 10), ("lumped", 20), ("ale-ancf", 10), ("ale-ancf", 20),
    ]  # fmt: skip
    off = {(one["model"], one["elements"]): one["difference_max"] for one in report["meshes"]}
    # Second order against fourth: a hundred times nearer with the same number of elements.
    assert off["ale-ancf", 10] < 0.01 * off["lumped", 10]
    rows = list(csv.DictReader(Path("a.csv").open(encoding="utf8")))
    assert {row["model"] for row in rows} == {"lumped", "ale-ancf"} and len(rows) == 11 + 21 + 11 + 21


def test_an_unknown_model_is_refused_with_those_that_there_are(drillstring):
    code, out, err = drillstring("form", "configuration_a.yaml", "--model", "lumped,fem")
    assert (code, out) == (2, "")
    assert "--model" in err and "'fem'" in err and "ale-ancf" in err


def test_form_of_a_scene_in_oilfield_units_prints_and_draws_feet_and_kip_and_its_json_stays_si(drillstring):
    plain = Path("hanging.yaml").read_text(encoding="utf8")
    Path("field.yaml").write_text("units: field\n" + plain, encoding="utf8")
    figure = ("-o", "field.svg")
    code, out, err = drillstring("form", "field.yaml", "--elements", "10", "--json", *figure)
    report = only_object(out)
    found = re.sub(r"warning: units: .*", "", err)  # it repeats the bare numbers of the scene, which are SI
    assert code == 0 and "end north, east, down [ft]" in found and "kip" in found
    assert not re.search(r"\d k?N\b|\d m\b", found)
    end = report["meshes"][0]["end"][2]
    assert f"{end / 0.3048:.4f}" in err and "[ft]" in Path("field.svg").read_text(encoding="utf8")
    # 0.376529 m of stretch (docs/lumped_string.md), whatever is printed
    assert report["rod"]["stretch"] == pytest.approx(0.376529, abs=1e-6)
