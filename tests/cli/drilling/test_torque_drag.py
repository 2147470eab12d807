"""The verb torque-drag: JSON, table, figure, options that are refused, measured hook loads, exit codes."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object

import drillstring.statics.statics
from drillstring.application import Drillstring
from drillstring.scene.scene import read
from drillstring.statics.back_calculation import COLUMNS, fit, read_measured
from drillstring.statics.torque_drag import torque_drag
from drillstring.string.factors import same
from drillstring.verbs.torque_drag import parse_frictions, unlikely_frictions
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.errors import SceneError
from tautline.scene.values.printed import shown

DATA = Path(__file__).parents[3] / "data"
JWELL = (DATA / "jwell.yaml").read_text(encoding="utf8")
KEYS = {"friction", "depth", "pick_up", "slack_off", "rotating", "torque", "buckling"}
"""Keys that other programs read: part of the contract of `--json`."""
SLANT = """
well:
  inclination: 60 deg
  azimuth: 200 deg
  sections: [{hold: 3000 m}]
  diameter: 8.5 in
  wall: {stiffness: 1.0e9, damping: 5.0e6, friction: 0.3}
string: [{name: dp, length: rest, od: 5 in, id: 4.276 in, mass_per_length: 33}]
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
mud: {density: 1500}
damping: {structural: 20 ms}
model: {elements: 40}
solver: {step: 10 ms, end: 1}
output: {interval: 0.1}
"""
BUILD = SLANT.replace("  inclination: 60 deg\n", "").replace(
    "{hold: 3000 m}", "{hold: 900 m}, {build: {rate: 3 deg/30m, to: 45 deg}}, {hold: 1100 m}"
)
FEW = ("--elements", "20")
COARSE = ("--elements", "10")
"""Enough for what is compared with nothing but other results of the same mesh."""


def test_so_few_links_that_the_hook_load_is_off_are_told(folder, capsys):
    (folder / "slant.yaml").write_text(SLANT)
    here = commands_of(Drillstring(), capsys)
    for elements, told in (("2", True), ("40", False)):
        code, _, err = here("torque-drag", "slant.yaml", "--elements", elements)
        assert code == 0
        assert ("2 links are few" in " ".join(err.split())) == told


def test_a_string_that_weighs_nothing_is_neither_buckled_nor_locked(folder, capsys):
    """Without gravity nothing pushes it: what is computed is rounding, and the limits of buckling are zero."""
    (folder / "slant.yaml").write_text(SLANT)
    here = commands_of(Drillstring(), capsys)
    code, out, err = here("torque-drag", "slant.yaml", "--elements", "20", "--set", "gravity=0", "--json")
    report, told = only_object(out), " ".join(err.split())
    assert code == 0 and report["slack_off"] == pytest.approx([0.0], abs=1e-6)
    assert report["locked"] == [False] and "own weight" not in told
    assert "no part of the string buckles or locks up" in told
    assert all(places == [] for kinds in report["buckled"][0].values() for places in kinds.values())


def test_so_few_links_that_only_the_torque_is_off_are_told(folder, capsys):
    # hook loads are within 1.5 % there, torque is 5 % below the soft string's
    (folder / "build.yaml").write_text(BUILD)
    here = commands_of(Drillstring(), capsys)
    for elements, told in (("25", True), ("50", False)):
        code, _, err = here("torque-drag", "build.yaml", "--friction", "0.3", "--elements", elements)
        assert code == 0
        text = f"{elements} links are few, and the torque is 5 % off that of the soft string"
        assert (text in " ".join(err.split())) == told, err


def test_a_hook_load_beside_next_to_nothing_is_off_by_newtons_and_by_a_share_of_what_is_named(folder, capsys):
    """Slacking off leaves little: the share is of half the load picking up, the table's of that little."""
    level = BUILD.replace("to: 45 deg", "to: 90 deg").replace("{hold: 1100 m}", "{hold: 2400 m}")
    (folder / "level.yaml").write_text(level)
    here = commands_of(Drillstring(), capsys)
    code, out, err = here("torque-drag", "level.yaml", "--elements", "3", "--json")
    found, told = only_object(out), " ".join(err.split())
    soft_up, soft_down = (found["soft_string"][way][0] for way in ("pick_up", "slack_off"))
    apart = abs(found["slack_off"][0] - soft_down)
    assert code == 0 and abs(soft_down) < 0.5 * soft_up
    share = f"a difference of {100.0 * apart / (0.5 * soft_up):.0f} % of 50 % of the soft string's hook load picking up"
    assert f"the hook load slacking off is {shown(apart, 'N', 'si')} off that of the soft string, {share}" in told
    assert "% off" not in told


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("jwell.yaml").write_text(JWELL, encoding="utf8")
    Path("field.yaml").write_text("units: field\n" + JWELL, encoding="utf8")
    strong = JWELL.replace("name: drill pipe, ", "name: drill pipe, yield_load: 1.76 MN, ")
    Path("strong.yaml").write_text(strong, encoding="utf8")
    casing = "    casing: {shoe: 2500 m, friction: 0.15}\n  diameter: 0.2032 m"
    cased = JWELL.replace("  diameter: 0.2032 m", "").replace("string:    ", casing.lstrip("\n") + "\nstring:    ", 1)
    Path("cased.yaml").write_text(cased, encoding="utf8")
    Path("pushed.yaml").write_text(JWELL.replace("{on_bottom: false}", "{force: -200 kN}"), encoding="utf8")
    block = JWELL.replace("top:\n", "top:\n  weight: 350 kN\n")
    Path("block.yaml").write_text(block, encoding="utf8")
    wall = JWELL[JWELL.index("  wall:") : JWELL.index("string:")]
    Path("free.yaml").write_text(JWELL.replace(wall, "  wall: none\n"), encoding="utf8")
    return tmp_path


@pytest.fixture
def drawing(folder, capsys):
    """Commands that draw their figures in full."""
    return commands_of(Drillstring(), capsys)


@pytest.fixture
def drillstring_(drawing, monkeypatch):
    leave_out_pixels(monkeypatch)
    return drawing


def test_csv_has_the_numbers_of_json_one_row_for_each_depth_and_friction_factor(drillstring_):
    words = ("--friction", "0.1,0.3", "--depth", "2000,3000", "--csv", "loads.csv", "--json")
    code, out, err = drillstring_("torque-drag", "jwell.yaml", *FEW, *words)
    report = only_object(out)
    assert code == 0 and report["csv"] == "loads.csv" and "wrote loads.csv" in err
    with open("loads.csv", encoding="utf8") as file:
        table = list(csv.DictReader(file))
    assert [(row["friction"], row["depth [m]"]) for row in table] == [
        (factor, depth) for factor in ("0.1", "0.3") for depth in ("2000.0", "3000.0")
    ]
    for name, head in (("pick_up", "pick up [N]"), ("slack_off", "slack off [N]"), ("torque", "torque [N m]")):
        told = [value for case in report["cases"] for value in case[name]]
        assert [float(row[head]) for row in table] == told
    assert drillstring_("torque-drag", "jwell.yaml", "--csv", "loads.txt")[0] == 2


@pytest.mark.parametrize("verb", ["torque-drag", "campbell", "form"])
def test_a_table_replaces_one_of_the_same_command_and_no_other(drillstring_, verb):
    mine, words = Path("mine.csv"), (verb, "jwell.yaml", "--csv", "mine.csv")
    mine.write_text("depth [m],pick_up [kN]\n3000,800\n")
    code, _, err = drillstring_(*words)
    assert code == 2 and "exists and is another table: it would be lost" in " ".join(err.split())
    assert mine.read_text().startswith("depth [m],pick_up")
    mine.unlink()
    assert [drillstring_(*words)[0] for _ in range(2)] == [0, 0]


def test_json_has_the_keys_of_the_contract_for_the_scenes_own_depth_and_friction(drawing):
    code, out, err = drawing("torque-drag", "jwell.yaml", "--json", *FEW)
    report = only_object(out)
    assert (code, report["status"], report["scene"]) == (0, "done", "jwell.yaml")
    assert report.keys() >= KEYS and report["buckling"].keys() >= {"sinusoidal", "helical"}
    assert report["friction"] == 0.2 and report["depth"] == pytest.approx([3770.796], abs=1e-3)
    # tests/references/soft_string.py: 748.588, 583.902, 668.394 kN and 5.9194 kN m
    assert report["pick_up"] == pytest.approx([748.588e3], rel=3e-3)
    assert report["slack_off"] == pytest.approx([583.902e3], rel=3e-3)
    assert report["rotating"] == pytest.approx([668.394e3], rel=3e-3)
    assert report["torque"] == pytest.approx([5919.4], rel=1.5e-2)
    assert len(report["buckling"]["sinusoidal"]) == 20 == report["elements"]
    assert report["soft_string"]["pick_up"] == pytest.approx([748.588e3], rel=1e-5)
    assert Path("jwell_torque_drag.png").read_bytes().startswith(b"\x89PNG") and "wrote jwell_torque_drag.png" in err


def test_lines_of_a_broomstick_go_down_whatever_the_order_of_the_depths(drillstring_, monkeypatch):
    drawn = []
    monkeypatch.setattr(
        "drillstring.verbs.torque_drag.write_figure", lambda figure, path: drawn.append(figure), raising=True
    )
    code, out, _ = drillstring_("torque-drag", "jwell.yaml", "--depth", "2000,1000,2500,500", *COARSE, "--json")
    assert (code, only_object(out)["depth"]) == (0, [500, 1000, 2000, 2500])
    lines = [line for plot in drawn[0].axes[:3] for line in plot.get_lines() if len(line.get_ydata()) == 4]
    assert lines and all(np.all(np.diff(line.get_ydata()) > 0.0) for line in lines)


def test_broomstick_over_depths_and_frictions_is_one_case_to_a_factor(drillstring_):
    options = ("--depth", "1000:3000:500", "--friction", "0.1,0.3", "-o", "broom.svg", "--json")
    code, out, err = drillstring_("torque-drag", "jwell.yaml", *options, *COARSE)
    report = only_object(out)
    assert code == 0 and report["depth"] == [1000, 1500, 2000, 2500, 3000]
    assert [case["friction"] for case in report["cases"]] == [0.1, 0.3] and report["friction"] == 0.1
    low, high = (np.array(case["pick_up"]) for case in report["cases"])
    # no drag in the vertical, more of it with more friction and depth below the kick-off at 2200 m
    assert high[:3] == pytest.approx(low[:3], rel=1e-9) and (high - low)[3] > 10.0 and (high - low)[4] > 1e4
    assert "<svg" in Path("broom.svg").read_text() and "2500" in err and "…" not in err


def test_table_says_both_models_their_difference_and_the_unit_and_fits_80_columns(drillstring_):
    code, out, err = drillstring_("torque-drag", "jwell.yaml", *FEW)
    assert (code, out) == (0, "")
    lines = err.splitlines()
    assert all(len(line.rstrip()) <= 80 for line in lines[:5]) and "…" not in err
    assert lines[0].split() == ["friction", "depth", "[m]", "statics", "soft", "string", "differs", "by"]
    row = next(line for line in lines if "pick up" in line)
    assert "748.59 kN" in row and "%" in row
    assert "no part of the string buckles or locks up" in err


def test_field_units_are_printed_where_the_scene_asks_for_them_and_json_stays_si(drillstring_):
    _, out, err = drillstring_("torque-drag", "field.yaml", "--json", *FEW)
    assert "168.29 kip" in err and "depth [ft]" in err and "kft-lbf" in err
    assert only_object(out)["pick_up"] == pytest.approx([748.588e3], rel=3e-3)


def test_lock_up_and_buckled_stretches_are_said_in_words(drillstring_):
    code, out, err = drillstring_("torque-drag", "jwell.yaml", "--friction", "0.5", "--elements", "50", "--json")
    report = only_object(out)
    assert code == 0 and report["locked"] == [False] and report["lock_up"] == [{}]
    assert "buckles into a helix from" in err and "lock-up" not in err
    ((top, bottom),) = report["buckled"][0]["slack_off"]["helical"]
    assert 1700.0 < top < bottom < 2350.0


def test_bit_that_is_pushed_through_much_friction_locks_up_and_has_no_hook_load(drillstring_):
    code, out, err = drillstring_("torque-drag", "pushed.yaml", "--friction", "0.4", "--elements", "50", "--json")
    report = only_object(out)
    assert code == 0 and report["locked"] == [True] and report["slack_off"] == [None]
    assert 0.0 < report["lock_up"][0]["slack_off"] < 2200.0 and report["status"] == "done"
    assert "lock-up: the friction of a helix grows without end" in " ".join(err.split()) and "nan" not in err


def test_overpull_is_the_yield_load_less_the_pick_up_load(drillstring_):
    _, out, err = drillstring_("torque-drag", "strong.yaml", "--json", *COARSE)
    report = only_object(out)
    pull = report["overpull"][0]
    assert pull["margin"] == pytest.approx(1.76e6 - report["pick_up"][0], rel=1e-9)
    assert pull["section"] == "drill pipe" and "margin of overpull" in err
    _, out, err = drillstring_("torque-drag", "jwell.yaml", "--json", *COARSE)
    assert only_object(out)["overpull"] == [None] and "overpull" not in err


def test_a_string_that_picking_up_alone_pulls_beyond_its_yield_load_is_told_so_and_not_of_a_margin(drillstring_):
    Path("weak.yaml").write_text(Path("strong.yaml").read_text(encoding="utf8").replace("1.76 MN", "700 kN"), "utf8")
    _, out, err = drillstring_("torque-drag", "weak.yaml", "--json", *COARSE)
    report, told = only_object(out), " ".join(err.split())
    (pull,), (lifted,) = report["overpull"], report["pick_up"]
    assert pull["margin"] == pytest.approx(700e3 - lifted, rel=1e-9) and pull["margin"] < 0.0
    beyond = f"picking up pulls drill pipe {(lifted - 700e3) / 1e3:.2f} kN beyond its yield load at 0 m"
    assert beyond in told and "There is no margin of overpull." in told and "margin of overpull at" not in told
    (record,) = [one for one in report["warnings"] if "picking up" in one["text"]]
    assert record["where"] == "string[0].yield_load" and beyond in record["text"]


def test_strokes_that_move_the_bit_are_told_in_words_and_in_json(drillstring_):
    # tests/references/soft_string.py: 0.394004 m up, 0.433944 m down with friction 0.2; few elements are coarse
    _, out, err = drillstring_("torque-drag", "jwell.yaml", "--json", "--elements", "50")
    (strokes,) = only_object(out)["break_away"]
    assert strokes["pick_up"] == pytest.approx(0.394, rel=1e-2)
    assert strokes["slack_off"] == pytest.approx(0.4339, rel=1e-2)
    assert strokes["reversing"] == pytest.approx(0.8279, rel=1e-2)
    up, down = (f"{strokes[way]:.4g} m" for way in ("pick_up", "slack_off"))
    assert f"stroke of the block of {up} up or {down} down from rest" in " ".join(err.split())


def test_weight_of_the_block_is_told_beside_hook_loads_that_are_without_it(drillstring_):
    _, out, err = drillstring_("torque-drag", "block.yaml", "--json", *FEW)
    report = only_object(out)
    assert report["block_weight"] == 350e3 and report["pick_up"] == pytest.approx([748.588e3], rel=3e-3)
    said = re.search(r"with the block's 350 kN: pick up ([\d.]+) MN", " ".join(err.split()))
    assert float(said[1]) * 1e6 == pytest.approx(report["pick_up"][0] + 350e3, rel=1e-3)


def test_reaming_adds_two_motions_with_less_drag_than_tripping_to_table_json_and_figure(drillstring_):
    code, out, err = drillstring_(
        "torque-drag", "jwell.yaml", "--reaming", "0.3 m/s", "--rotary", "90 rpm", "--json", *FEW
    )
    report = only_object(out)
    up, down = (report["reaming"][way]["hook_load"][0] for way in ("up", "down"))
    assert code == 0 and report["slack_off"][0] < down < report["rotating"][0] < up < report["pick_up"][0]
    assert 0.0 < report["reaming"]["up"]["torque"][0] < report["torque"][0]
    assert up == pytest.approx(report["reaming"]["up"]["soft_string"]["hook_load"][0], rel=3e-3)
    assert "reaming up" in err and "torque down" in err and set(report["profile"]) > {"reaming_up", "reaming_down"}
    many = ("--depth", "2400:3600:200", "-o", "ream.svg")
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "--reaming", "0.3", *many, *COARSE)
    assert code == 0 and "ream up" in err and "…" not in err and max(map(len, err.splitlines()[:8])) <= 80
    assert "reaming down" in Path("ream.svg").read_text()


def test_a_bare_rotary_speed_of_reaming_is_in_rpm_and_is_told_in_table_and_json(drillstring_):
    found = []
    for rotary in ("90", "90 rpm"):
        words = ("--reaming", "0.3", "--rotary", rotary, "--json", *COARSE)
        code, out, err = drillstring_("torque-drag", "jwell.yaml", *words)
        assert code == 0 and "0.3 m/s up or down, turning at 90 rpm" in " ".join(err.split())
        found.append(only_object(out)["reaming"])
    assert found[0] == found[1]
    assert found[0]["down"]["rotary"] == found[0]["up"]["rotary"] == pytest.approx(90.0 * 2.0 * np.pi / 60.0)
    assert (found[0]["up"]["speed"], found[0]["down"]["speed"]) == (-0.3, 0.3)


def test_pair_of_factors_is_that_of_cased_and_open_hole(drillstring_):
    code, out, err = drillstring_("torque-drag", "cased.yaml", "--friction", "0.1/0.3,0.2", "--json", *COARSE)
    report = only_object(out)
    assert code == 0 and report["friction"] == {"cased": 0.1, "open": 0.3} and report["cases"][1]["friction"] == 0.2
    assert "0.1/0.3" in err
    code, out, _ = drillstring_("torque-drag", "cased.yaml", "--json", *COARSE)
    assert only_object(out)["friction"] == {"cased": 0.15, "open": 0.2}
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "--friction", "0.1/0.3", *FEW)
    assert code == 2 and "has no casing" in " ".join(err.split())


def test_both_models_stand_beside_each_other_in_table_json_and_figure(drillstring_):
    options = ("--model", "lumped,ale-ancf", "-o", "both.svg", "--json")
    code, out, err = drillstring_("torque-drag", "jwell.yaml", *options, *FEW)
    report = only_object(out)
    assert code == 0 and [case["model"] for case in report["cases"]] == ["lumped", "ale-ancf"]
    lumps, beam = report["cases"]
    assert report["model"] == "lumped" and report["pick_up"] == lumps["pick_up"] != beam["pick_up"]
    assert beam["pick_up"] == pytest.approx(lumps["pick_up"], rel=5e-3)
    # a beam touches at two points of each element and at the bit
    assert len(beam["profile"]["pick_up"]["side_force"]) == 41 and len(lumps["profile"]["pick_up"]["side_force"]) == 21
    warned, *lines = err.splitlines()
    assert warned.startswith("warning: model.elements: ale-ancf, 20 elements")
    assert lines[0].split()[0] == "model" and all(len(line.rstrip()) <= 80 for line in lines[:9]) and "…" not in err
    assert "friction 0.2, ale-ancf, bit at" in " ".join(err.split())
    assert "friction 0.2, ale-ancf" in Path("both.svg").read_text()
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "--model", "beam", *FEW)
    assert code == 2 and "--model" in err and "write lumped, ale-ancf or lumped,ale-ancf" in " ".join(err.split())
    Path("soft.yaml").write_text(JWELL.replace("bending: stiff", "bending: soft"), encoding="utf8")
    code, _, err = drillstring_("torque-drag", "soft.yaml", "--model", "ale-ancf", *FEW)
    assert code == 2 and "model.bending" in err and "give stiff or none" in " ".join(err.split())


# what is refused
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--friction", "0.2,x"), ("--friction", "'x'|x", "is no friction factor")),
        (("--friction", "-0.2"), ("--friction", "between 0 and 2")),
        (("--friction", "nan"), ("--friction nan", "a share such as 25 %")),
        (("--friction", "3"), ("--friction", "between 0 and 2")),
        (("--friction", "0.2,,0.3"), ("--friction", "empty")),
        (("--friction", "0.1/0.2/0.3"), ("--friction", "cased/open")),
        (("--reaming", "fast"), ("--reaming",)),
        (("--reaming", "-0.3"), ("--reaming",)),
        (("--rotary", "60 rpm"), ("--rotary", "give --reaming a speed")),
        (("--depth", "500:3000"), ("--depth", "needs three numbers", "write 500:3500:250")),
        (("--depth", "3990:1000:-500"), ("has a step below zero", "first, such as 1000:3990:500")),
        (("--depth", "3990:1000:500"), ("ends above where it begins", "first, such as 1000:3990:500")),
        (("--depth", "1000:3990:-500"), ("has a step below zero", "first, such as 1000:3990:500")),
        (("--depth", "500:600:0 ft"), ("500:600:0 ft: never gets to its end by a step of zero", "500:3500:250")),
        (("--depth", "3000:500:100"), ("--depth", "ends above where it begins")),
        (("--depth", "1:3000:0.001"), ("--depth", "larger step")),
        (("--depth", "0"), ("--depth",)),
        (("--depth", "3770.8964"), ("be at 3770.896 m, below the end of the well, 3770.796 m",)),
        (("--depth", "12371.7 ft"), ("be at 12371.7 ft, below the end of the well, 12371.38 ft",)),
        (("--depth", "500 ft"), ("with the bit at 500 ft", "give depths of more than 787.4016 ft")),
        (("--depth", "5000"), ("below the end of the well", "give depths within the well")),
        (("--depth", "100"), ("nothing is left of drill pipe", "give depths of more than 240 m")),
        (("--elements", "1"), ("--elements", "fewer than the 2 sections")),
        (("-o", "figure.bmp"), ("figure.bmp", "name it .png, .svg or .pdf")),
        (("--measured", "nothing.csv"), ("nothing.csv", "there is no such file")),
    ],
)
def test_bad_options_are_refused_with_the_cure_and_exit_code_2(drillstring_, folder, options, words):
    before = sorted(file.name for file in folder.iterdir())
    code, out, err = drillstring_("torque-drag", "jwell.yaml", *options)
    text = " ".join(err.split())
    assert (code, out) == (2, "") and "Traceback" not in err
    assert all(any(part in text for part in word.split("|")) for word in words), text
    assert sorted(file.name for file in folder.iterdir()) == before


def test_scene_without_a_wall_is_refused_by_its_key(drillstring_):
    code, _, err = drillstring_("torque-drag", "free.yaml")
    assert code == 2 and "free.yaml" in err and "well.wall" in err and "no friction" in err


def test_where_the_figure_goes_is_looked_at_before_the_search(drillstring_, monkeypatch):
    monkeypatch.setattr(drillstring.statics.torque_drag, "torque_drag", lambda *_, **__: pytest.fail("searched"))
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "-o", "nowhere/loads.png")
    assert code == 2 and "there is no folder nowhere" in " ".join(err.split())


def test_direction_without_an_equilibrium_is_named_the_rest_is_kept_and_the_exit_code_is_3(drillstring_, monkeypatch):
    solve = drillstring.statics.statics.Statics.solve

    def fails(self, friction, direction):
        if direction == "slack_off" and same(friction).open == 0.3:
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "lump 7", "friction factor 0.3")
        return solve(self, friction, direction)

    monkeypatch.setattr(drillstring.statics.statics.Statics, "solve", fails)
    code, out, err = drillstring_("torque-drag", "jwell.yaml", "--friction", "0.2,0.3", "--json", *COARSE)
    report = only_object(out)
    assert code == 3 and report["status"].startswith("stopped")
    assert report["cases"][1]["slack_off"] == [None] and report["cases"][1]["pick_up"][0] > 7e5
    assert "slack off: lump 7: no static equilibrium was found" in " ".join(err.split())
    assert Path("jwell_torque_drag.png").exists()


# measured loads
def test_a_bit_that_rounding_puts_some_centimetres_below_the_well_is_at_its_end(drillstring_):
    # 12371.5 ft are 3770.83 m, 37 mm below the end
    for depth in ("3770.84", "12371.5 ft"):
        code, out, _ = drillstring_("torque-drag", "jwell.yaml", "--depth", depth, "--json", *COARSE)
        assert code == 0 and only_object(out)["depth"] == pytest.approx([3770.796327], abs=1e-6)


def test_measured_loads_at_total_depth_in_feet_are_taken_and_refused_in_feet_where_they_are_deeper(drillstring_):
    Path("feet.csv").write_text("MD [ft],pick_up [klbf],slack_off [klbf]\n12371.5,180,150\n", "utf8")
    code, out, _ = drillstring_("torque-drag", "jwell.yaml", "--measured", "feet.csv", "--json", *COARSE)
    assert code == 0 and only_object(out)["depth"][0] == pytest.approx(3770.796327, abs=1e-6)
    Path("feet.csv").write_text("MD [ft],pick_up [klbf],slack_off [klbf]\n12372,180,150\n10000,160,140\n", "utf8")
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "--measured", "feet.csv", *COARSE)
    told = "feet.csv:2: depth = 12372 ft: the bit would be at 12372 ft, below the end of the well, 12371.38 ft"
    assert code == 2 and told in " ".join(err.split())


def test_a_column_of_loads_that_is_not_read_is_among_the_warnings_with_what_the_fit_is_of(drillstring_):
    Path("other.csv").write_text("MD [ft],pick_up [klbf],down [klbf]\n12371.5,180,150\n", "utf8")
    code, out, err = drillstring_("torque-drag", "jwell.yaml", "--measured", "other.csv", "--json", *COARSE)
    told = "other.csv: not read: down [klbf]; the fit is of pick_up alone"
    assert code == 0 and told in " ".join(err.split())
    assert {"where": "--measured", "text": told} in only_object(out)["warnings"]


def test_measured_loads_are_told_as_written_where_the_block_has_a_weight_and_other_columns_are_named(folder):
    Path("gauge.csv").write_text("md [m],pick_up [kN],slack_off [kN],rotating [kN]\n2000,600,800,700\n", "utf8")
    with pytest.raises(SceneError, match="pick_up = 600 kN: smaller than slack_off = 800 kN"):
        read_measured(Path("gauge.csv"), 350e3)
    Path("gauge.csv").write_text("md [m],pick_up [kN],slack_off [kN],rotating [kN]\n2000,800,600,700\n", "utf8")
    measured = read_measured(Path("gauge.csv"), 350e3)
    assert measured.unused == ("rotating [kN]",) and measured.pick_up.tolist() == [450e3]


NONE_SAID = "such as -999.25, which rigs write for none"


def test_a_measured_load_that_stands_for_none_is_left_out_and_counted(loads, drillstring_):
    head, *rows = loads.splitlines()
    cells = [row.split(",") for row in rows]
    cells[0][1], cells[2][2] = "-999.25", "-9999"
    Path("loads.csv").write_text("\n".join([head, *map(",".join, cells)]), "utf8")
    code, out, err = drillstring_("torque-drag", "jwell.yaml", "--measured", "loads.csv", "--json", *COARSE)
    report = only_object(out)
    assert code == 0 and f"loads.csv: 2 loads are numbers {NONE_SAID}" in " ".join(err.split())
    assert any(NONE_SAID in one["text"] for one in report["warnings"])
    assert report["fit"]["loads"] == 6 and report["fit"]["friction"] == pytest.approx(0.24, abs=1e-3)


def test_a_row_of_loads_that_all_stand_for_none_is_refused_as_an_empty_one(folder):
    Path("none.csv").write_text("depth [m],pick_up [kN],slack_off [kN]\n2000,-999.25,-999\n1500,330,160\n", "utf8")
    with pytest.raises(
        SceneError, match=r"none\.csv:2: .*no load in this row \(a number such as -999.25 stands for none"
    ):
        read_measured(Path("none.csv"))


def test_a_load_of_minus_999_is_one_where_others_of_its_column_push_nearly_as_hard(folder):
    Path("pushed.csv").write_text("depth [m],slack_off [kN]\n2000,-999\n1500,-600\n1000,-200\n", "utf8")
    measured = read_measured(Path("pushed.csv"))
    assert measured.slack_off.tolist() == [-999e3, -600e3, -200e3] and measured.nulls == 0


def test_a_comma_at_the_end_of_the_header_of_measured_loads_is_no_column(folder):
    Path("gauge.csv").write_text("md [m],pick_up [kN],slack_off [kN],\n2000,800,600,\n", "utf8")
    assert read_measured(Path("gauge.csv")).unused == ()


def test_a_friction_factor_may_be_a_share():
    assert parse_frictions("25 %,0.3") == parse_frictions("0.25,0.3")
    with pytest.raises(SceneError, match="one lies between 0 and"):
        parse_frictions("25 %,-5 %")


@pytest.fixture(scope="module")
def trip():
    """Hook loads of a trip that were made with friction 0.24, in field units."""
    depths = [2600.0, 3000.0, 3400.0, 3700.0]
    (case,) = torque_drag(read(DATA / "jwell.yaml"), [0.24], depths, 10)
    rows = zip(depths, case.hook_loads("pick_up"), case.hook_loads("slack_off"), strict=True)
    text = "depth [ft],pick_up [kip],slack_off [kip]\n"
    for depth, up, down in rows:
        text += f"{depth / 0.3048:.6f},{up / 4448.2216152605:.6f},{down / 4448.2216152605:.6f}\n"
    return text


@pytest.fixture
def loads(folder, trip):
    """The same in a file."""
    Path("loads.csv").write_text(trip, encoding="utf8")
    return trip


def test_back_calculation_recovers_the_friction_factor_that_made_the_loads(loads, drillstring_):
    options = ("--measured", "loads.csv", "--json")
    # every other depth: two of them tell whether the factor is the one of all depths
    head, *rows = loads.splitlines()
    Path("loads.csv").write_text("\n".join([head, *rows[::2]]), encoding="utf8")
    code, out, err = drillstring_("torque-drag", "jwell.yaml", *options, *COARSE)
    report = only_object(out)
    assert code == 0
    assert report["fit"]["friction"] == pytest.approx(0.24, abs=1e-3)
    assert report["fit"]["pick_up"] == pytest.approx(0.24, abs=1e-3)
    assert report["fit"]["slack_off"] == pytest.approx(0.24, abs=1e-3)
    assert report["friction"] == report["fit"]["friction"] and report["fit"]["loads"] == 4
    assert len(report["depth"]) == 2 and "friction factor of the 4 measured hook loads: 0.2400" in err


def test_measured_loads_are_the_gauges_where_the_block_has_a_weight(loads, drillstring_):
    rows = [line.split(",") for line in loads.splitlines()[:3]]
    kip = 350e3 / 4448.2216152605
    for row in rows[1:]:
        row[1:] = [repr(float(cell) + kip) for cell in row[1:]]
    Path("gauge.csv").write_text("\n".join(",".join(row) for row in rows), encoding="utf8")
    code, out, _ = drillstring_("torque-drag", "block.yaml", "--measured", "gauge.csv", "--json", *COARSE)
    assert code == 0 and only_object(out)["fit"]["friction"] == pytest.approx(0.24, abs=1e-3)
    # loads that are less than the block alone are not the gauge's
    rows[2][1:] = ["", "70"]
    Path("gauge.csv").write_text("\n".join(",".join(row) for row in rows), encoding="utf8")
    code, _, err = drillstring_("torque-drag", "block.yaml", "--measured", "gauge.csv", *FEW)
    assert code == 2 and "gauge.csv:3" in err and "top.weight" in err


def test_spread_of_the_factor_is_that_of_the_loads_noise(loads):
    # noise of +-2 kN; the factor moves a load by about 400 kN, so the spread of eight is 2/(400 sqrt(8)) or so
    scene, measured = read("jwell.yaml"), read_measured(Path("loads.csv"))
    sign = np.array([1.0, -1.0, 1.0, -1.0])
    noisy = measured._replace(pick_up=measured.pick_up + 2e3 * sign, slack_off=measured.slack_off - 2e3 * sign)
    found = fit(scene, noisy, 10)
    assert found.friction == pytest.approx(0.24, abs=4.0 * found.spread)
    assert 3e-4 < found.spread < 1e-2
    assert found.residual == pytest.approx(2e3, rel=0.2)


STEEP = """
well:
  sections: [{hold: 1000 m}, {build: {radius: 500 m, to: 60 deg, azimuth: 40 deg}}, {hold: 500 m}]
  diameter: 0.2159
  wall: {stiffness: 1.0e9, damping: 5.0e6, friction: 0.25}
string: [{name: pipe, length: rest, od: 0.127, id: 0.1086}, {name: collar, length: 150 m, od: 0.165, id: 0.0572}]
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
mud: {density: 1200}
model: {kind: lumped, elements: 20}
solver: {step: 5 ms, end: 2 s}
output: {interval: 0.1 s}
"""
"""A hole in which factors near 0.8 buckle the string, and rounding of the statics moves its loads."""
LINKS = 30
"""Enough that it buckles at these factors; a fit of 40 takes twice as long."""


@pytest.mark.parametrize(
    ("steep", "depth", "more", "within"),
    [(False, 3400.0, 20e3, 5e-3), pytest.param(True, 2000.0, None, 0.15, marks=pytest.mark.study)],
)
def test_standard_error_of_loads_that_disagree_is_told_by_differences_of_the_programs_own_loads(
    folder, steep, depth, more, within
):
    # Both loads are too large, or wide apart: what explains the one contradicts the other.
    Path("steep.yaml").write_text(STEEP, encoding="utf8")
    scene, ways = read("steep.yaml" if steep else "jwell.yaml"), ("pick_up", "slack_off")
    (case,) = torque_drag(scene, [0.24], [depth], LINKS)
    loads = [1000e3, 200e3] if more is None else [case.hook_loads(way)[0] + more for way in ways]
    row = f"{depth},{loads[0]},{loads[1]}"
    Path("two.csv").write_text(f"depth [m],pick_up [N],slack_off [N]\n{row}\n", encoding="utf8")
    found = fit(scene, read_measured(Path("two.csv")), LINKS)
    below, there, above = torque_drag(scene, [found.friction + d for d in (-0.01, 0.0, 0.01)], [depth], LINKS)
    slopes = np.array([above.hook_loads(way)[0] - below.hook_loads(way)[0] for way in ways]) / 0.02
    errors = np.array([there.hook_loads(way)[0] for way in ways]) - loads
    # s^2 (J^T J)^-1 of two loads and one factor; the curvature over +-0.01 makes a difference
    assert found.spread == pytest.approx(np.sqrt(errors @ errors / (slopes @ slopes)), rel=within)


def test_loads_on_the_wrong_side_of_the_rotating_weight_are_told_to_be_explained_by_no_factor(drillstring_, folder):
    # the string of the J-well rotates at 668 kN, with ten links at 681 kN
    Path("light.csv").write_text("depth [m],pick_up [kN]\n3700,300\n3600,500\n", encoding="utf8")
    code, out, err = drillstring_("torque-drag", "jwell.yaml", "--measured", "light.csv", "--json", *COARSE)
    told, text = only_object(out)["fit"]["unexplained"], " ".join(err.split())
    assert code == 0 and [(one["depth"], one["direction"]) for one in told] == [(3700, "pick_up"), (3600, "pick_up")]
    assert told[0]["load"] == 300e3 and told[0]["rotating"] == pytest.approx(668e3, rel=0.03)
    assert "no friction factor explains pick up 300 kN at 3700 m: it is below the rotating weight" in text
    assert "– by slack-off" in text and "nan" not in text


def test_factor_that_ends_at_the_largest_that_is_tried_is_told_to_be_out_of_reach(drillstring_, folder):
    Path("heavy.csv").write_text("depth [m],pick_up [kN]\n3400,9000\n", encoding="utf8")
    _, _, err = drillstring_("torque-drag", "jwell.yaml", "--measured", "heavy.csv", *COARSE)
    assert "the friction factor is the largest that is tried" in " ".join(err.split())


def test_load_that_no_equilibrium_reaches_is_named(drillstring_, folder):
    Path("stuck.csv").write_text("depth [m],slack_off [kN]\n3700,-900\n", encoding="utf8")
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "--measured", "stuck.csv", *COARSE)
    text = " ".join(err.split())
    assert code == 3 and "slack off -900 kN with the bit at 3700 m" in text and "Traceback" not in text


@pytest.mark.parametrize(
    ("row", "new", "line", "words"),
    [
        (2, "9842.5,abc,130", 3, "abc"),
        (2, "9842.5,,", 3, "no load in this row"),
        (2, "9842.5,120,160", 3, "swap the two"),
        (3, "99842.5,170,130", 4, "below the end of the well"),
        (1, "-5,170,130", 2, "not below the rotary table"),
        (0, "depth [ft],pick_up [m],slack_off [kip]", 1, "is not a unit like N"),
        (0, "depth [ft],pick_up [m],slack_off [kip]", 1, "the unit that the numbers are in, such as pick_up [kN]"),
        (0, "depth [ft],pick_up (klb),slack_off [kip]", 1, "a thousand pounds is a mass; write pick_up [klbf]"),
        (0, "depth [ft],pick_up [klbs],slack_off [kip]", 1, "a thousand pounds is a mass; write pick_up [klbf]"),
        (0, "depth [ft],pick_up [lbs],slack_off [kip]", 1, "a pound is a mass; write pick_up [lbf]"),
        (0, "depth [ft],pick_up [t],slack_off [kip]", 1, "a tonne is a mass; write pick_up [tf]"),
        (0, "depth [ft],up,down", 1, "pick_up"),
        (2, "9842.5,120,160", 3, "pick_up = 120 kip: smaller than slack_off = 160 kip"),
        (0, "depth [ft],pick_up [kip],pick up [kip]", 1, "pick_up = pick up [kip]: the header has two such columns"),
        (0, "depth,pick_up [kip],slack_off [kip]", 1, "depth: no unit"),
        (0, "depth [ft],pick_up [kip],slack_off", 1, "slack_off: no unit"),
    ],
)
def test_bad_row_of_measured_loads_is_named_by_its_number(loads, drillstring_, row, new, line, words):
    rows = loads.splitlines()
    rows[row] = new
    Path("loads.csv").write_text("\n".join(rows) + "\n", encoding="utf8")
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "--measured", "loads.csv", *FEW)
    text = " ".join(err.split())
    assert code == 2 and f"loads.csv:{line}" in text and words in text and "Traceback" not in err


POUNDS, TONNES = "write pick_up [klbf]", "write pick_up [tf]"
MASSES = dict.fromkeys(("KLB", "klb", "KLBS", "Klbs.", "k lbs", "k.lbs", "1000 lb", "1,000 lbs", "x1000 lb"), POUNDS)
MASSES |= dict.fromkeys(("MT", "mT", "mt", "te", "Te", "T", "t", "Tonnes", "metric tons", "1000 kg"), TONNES)
MASSES |= {"Lbs": "write pick_up [lbf]", "lb.": "write pick_up [lbf]", "KG": "write pick_up [kgf]"}
TONS = dict.fromkeys(
    ("ton", "tons", "Tons", "TONF"), f"for tonnes {TONNES}; for short tons multiply the numbers by 2 and "
)
FORCES = {"KN": "write pick_up [kN]", "KLBF": POUNDS, "kips": "", "Kips": "write pick_up [kip]", "DAN": "pick_up [daN]"}
FORCES |= {"kkgf": "write pick_up [tf]", "kdaN": "multiply the numbers by 10 and write pick_up [kN]"}


@pytest.mark.parametrize(
    ("unit", "cure"), [*(MASSES | TONS | FORCES).items(), ("foos", "'foos' is not a unit of force")]
)
def test_a_mass_over_hook_loads_is_answered_with_the_force_that_is_meant_however_it_is_written(tmp_path, unit, cure):
    path = tmp_path / "loads.csv"
    path.write_text(f"depth [m];pick_up [{unit}]\n2600;640\n", encoding="utf8")
    if not cure:
        assert read_measured(path).pick_up == pytest.approx([640 * 4448.2216], rel=1e-6)
        return
    with pytest.raises(SceneError) as caught:
        read_measured(path)
    text = str(caught.value)
    assert cure in text and ("[kN]" not in text or "kN" in cure or unit == "foos")
    for mass in ("'klb'", "'lb'", "'lbs'", "'t'", "'tonne'", "'kg'"):
        assert f"did you mean {mass}" not in text


THOUSANDS = {"kkgs": TONNES, "kkp": TONNES, "kkN": "write pick_up [MN]", "kkgforce": ""}
THOUSANDS |= {"kklbf": "multiply the numbers by 1000 and write pick_up [klbf]"}
THOUSANDS |= {"kkip": "by 1000 and write pick_up [kip]", "kkips": "by 1000 and write pick_up [kip]"}
THOUSANDS |= {"kdaNs": "multiply the numbers by 10 and write pick_up [kN]", "kMN": ""}
THOUSANDS |= dict.fromkeys(("Mgf", "Mkgf", "Mlbf", "MkN", "MdaN", "mkN", "dkN"), "")


@pytest.mark.parametrize(("unit", "cure"), THOUSANDS.items())
def test_a_unit_of_force_with_a_prefix_too_many_is_never_answered_with_one_that_lacks_it(tmp_path, unit, cure):
    path = tmp_path / "loads.csv"
    path.write_text(f"depth [m];pick_up [{unit}]\n2600;640\n", encoding="utf8")
    with pytest.raises(SceneError) as caught:
        read_measured(path)
    said = str(caught.value)
    assert cure in said and f"'{unit}'" in said and "did you mean" not in said


def test_a_thousand_kilograms_are_named_as_they_were_written(tmp_path):
    path = tmp_path / "loads.csv"
    for unit in ("kkg", "1000 kg"):
        path.write_text(f"depth [m];pick_up [{unit}]\n2600;640\n", encoding="utf8")
        with pytest.raises(SceneError, match=rf"'{unit}': a thousand kilograms is a mass; write pick_up \[tf\]"):
            read_measured(path)


def test_empty_cells_and_a_missing_column_are_loads_that_were_not_measured(folder):
    Path("some.csv").write_text("md [m];pick up [kN]\n2600;640\n3000;\n3400;700\n", encoding="utf8")
    with pytest.raises(SceneError, match=r"some\.csv:3"):
        read_measured(Path("some.csv"))
    Path("some.csv").write_text("md [m];pick up [kN];sow [kN]\n2600;640;\n3000;;600\n", encoding="utf8")
    found = read_measured(Path("some.csv"))
    assert found.pick_up == pytest.approx([640e3, np.nan], nan_ok=True)
    assert found.slack_off == pytest.approx([np.nan, 600e3], nan_ok=True)
    assert set(COLUMNS) == {"depth", "pick_up", "slack_off"}


@pytest.mark.parametrize(("written", "meant"), [("0,2", "0.2"), ("0, 2", "0.2"), ("00,2", "0.2"), (" 0,15", "0.15")])
def test_a_decimal_comma_in_a_friction_factor_is_asked_about(written, meant):
    try:
        told = unlikely_frictions(written, parse_frictions(written))[0].text
    except SceneError as error:  # beyond the largest factor
        told = str(error)
    assert f"Was {meant} meant?" in told and f"--friction {meant}" in told


@pytest.mark.parametrize(("written", "warned"), [("0.2,0.3", 0), ("0,0.2", 0), ("1.5", 0), ("1.6", 1), ("0.2,1.9", 1)])
def test_friction_factors_are_warned_of_where_those_of_a_scene_are(written, warned):
    assert len(unlikely_frictions(written, parse_frictions(written))) == warned


def test_a_word_of_the_trade_for_an_option_is_answered_with_the_option(drillstring_):
    code, _, err = drillstring_("torque-drag", "jwell.yaml", "--ff", "0.2")
    assert code == 2 and "did you mean --friction? Else see" in " ".join(err.split())
