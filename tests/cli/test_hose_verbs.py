"""The hose's own verbs, static and flutter, and what simulate says of a hose: files, JSON, exit codes, resumption."""

import re
from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, files, leave_out_pixels, only_object

from gardenhose.application import Gardenhose
from tautline.integrators.status import Status, StoppedEarly
from tautline.results.result import Result

HOSE = (Path(__file__).parents[2] / "data" / "hose.yaml").read_text(encoding="utf8")
CLAIMED = [[0.435384, -0.229892], [0.443159, -0.216109], [0.462751, -0.175513], [0.483430, -0.116218]]
CLAIMED += [[0.495223, -0.060137]]
"""Tip at rest, x and z in m, at 0, 3, 6, 9, 12 m/s: figures of the issue."""
STABILITY = "gardenhose.flutter.stability"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("hose.yaml").write_text(HOSE, encoding="utf8")
    dry = HOSE.replace(HOSE[HOSE.index("water:") : HOSE.index("gravity:")], "")
    Path("dry.yaml").write_text(dry, encoding="utf8")
    nozzle = HOSE.replace("  mass_per_length: 0.0007854\n", "  mass_per_length: 0.0007854\n  outlet: 2\n")
    Path("nozzle.yaml").write_text(nozzle, encoding="utf8")
    return tmp_path


@pytest.fixture
def drawing(folder, capsys):
    """Commands that draw their figures in full."""
    return commands_of(Gardenhose(), capsys)


@pytest.fixture
def gardenhose(drawing, monkeypatch):
    leave_out_pixels(monkeypatch)
    return drawing


# static
def test_static_of_a_range_of_speeds_gives_the_claimed_tips_and_a_figure(drawing):
    code, out, err = drawing("static", "hose.yaml", "--speed", "0:12:3", "--json")
    report = only_object(out)
    assert (code, report["status"], report["scene"]) == (0, "done", "hose.yaml")
    assert report["speed"] == [0, 3, 6, 9, 12]
    tip = np.array(report["tip"])
    assert tip[:, [0, 2]] == pytest.approx(np.array(CLAIMED), abs=1e-4)
    assert np.abs(tip[:, 1]).max() < 1e-12
    assert report["figure"] == "hose_static.png"
    assert Path("hose_static.png").read_bytes().startswith(b"\x89PNG")
    assert "wrote hose_static.png" in err


def test_static_prints_a_table_and_takes_speeds_one_by_one(gardenhose):
    code, out, err = gardenhose("static", "hose.yaml", "--speed", "9,-3", "-o", "shapes.svg")
    assert (code, out) == (0, "")
    assert "0.48343" in err
    assert "-3" in err and "<svg" in Path("shapes.svg").read_text()
    assert not Path("hose_static.png").exists()


@pytest.mark.parametrize(("typed", "speeds"), [("9,0,3", [0, 3, 9]), ("9,3,0", [9, 3, 0]), ("9:0:-3", [9, 6, 3, 0])])
def test_static_goes_one_way_through_speeds_in_any_order(typed, speeds, gardenhose):
    code, out, _ = gardenhose("static", "hose.yaml", "--speed", typed, "--json")
    assert (code, only_object(out)["speed"]) == (0, speeds)


def test_static_and_flutter_say_their_units_and_take_those_of_the_scene_and_of_speeds(gardenhose):
    code, _, err = gardenhose("static", "hose.yaml", "--speed", "9")
    assert code == 0 and all(f"{head} [m]" in err for head in ("tip x", "tip y", "tip z")) and "flow [m/s]" in err
    field = ("hose.yaml", "--set", "units=field", "--speed")
    code, out, err = gardenhose("static", *field, "0 ft/s:29.527559 ft/s:29.527559 ft/s", "--json")
    assert code == 0 and only_object(out)["speed"] == pytest.approx([0, 9], abs=1e-6), "9 m/s; JSON stays SI"
    assert "flow [ft/s]" in err and "tip x [ft]" in err and f"{0.483430 / 0.3048:.3f}" in err
    code, _, err = gardenhose("flutter", *field, "12:15:1")
    found = re.sub(r"warning: units: .*", "", err)  # it repeats the bare numbers of the scene, which are SI
    assert code == 0 and f"{13.8405929422 / 0.3048:.1f}" in found and "ft/s" in found and " m/s" not in found


def test_static_goes_to_the_scenes_fastest_flow_where_it_is_not_told(gardenhose):
    code, out, _ = gardenhose("static", "hose.yaml", "--json")
    assert code == 0
    assert only_object(out)["speed"] == pytest.approx(np.linspace(0, 35, 7))


def test_static_finds_no_shape_of_a_hose_that_its_nozzle_crushes_and_exits_with_3(gardenhose, folder):
    # EA (stretch^2 - 1)/2 = -M U^2 (outlet - 1) at the end: beyond 79.8 m/s there is no such stretch
    before = files(folder)
    code, out, err = gardenhose("static", "nozzle.yaml", "--speed", "300")
    assert (code, out) == (3, "")
    assert "no static equilibrium was found" in " ".join(err.split())
    assert "300 m/s" in " ".join(err.split()) and "Traceback" not in err
    assert files(folder) == before


# flutter
FLUTTER_KEYS = {
    "scene",
    "status",
    "figure",
    "critical_speed",
    "critical_frequency",
    "plane",
    "kind",
    "critical",
    "unstable",
}
FLUTTER_KEYS |= {
    "speed",
    "eigenvalues",
    "out_of_plane",
    "stable_from",
    "direction",
    "warnings",
    "windows",
    "resolution",
    "unstable_at",
    "doubtful",
    "ways",
    "fine_up_to",
}


def test_flutter_gives_critical_speed_and_frequency_of_either_plane_and_a_figure(drawing):
    code, out, err = drawing("flutter", "hose.yaml", "--json")
    report = only_object(out)
    assert code == 0 and report.keys() == FLUTTER_KEYS
    # reference 13.840593 m/s at 27.555857 1/s and 13.914898 m/s at 27.404189 1/s; 10 elements err by 5e-5 and 1.5e-4
    assert report["critical_speed"] == pytest.approx(13.8405929422, rel=1e-4)
    assert report["critical_frequency"] == pytest.approx(27.5558565694 / (2 * np.pi), rel=4e-4)
    assert (report["plane"], report["kind"]) == ("out", "flutter")
    assert [one["plane"] for one in report["critical"]] == ["out", "in"]
    assert report["critical"][1]["speed"] == pytest.approx(13.9148976569, rel=1e-4)
    assert np.shape(report["eigenvalues"]) == (len(report["speed"]), 8, 2)
    assert np.shape(report["out_of_plane"]) == (len(report["speed"]), 8)
    assert Path("hose_flutter.png").read_bytes().startswith(b"\x89PNG")
    assert "flutters at 4.386 Hz out of the plane from 13.84" in err


def test_flutter_takes_speeds_modes_and_a_figures_name_and_says_where_there_is_no_onset(gardenhose):
    code, out, err = gardenhose(
        "flutter", "hose.yaml", "--speed", "0:10:5", "--modes", "3", "-o", "argand.pdf", "--json"
    )
    report = only_object(out)
    assert code == 0 and report["speed"] == [0, 5, 10]
    assert np.shape(report["eigenvalues"]) == (3, 3, 2)
    assert report["critical_speed"] is None and report["critical"] == []
    assert "stable from 0 to 10 m/s" in err
    assert Path("argand.pdf").read_bytes().startswith(b"%PDF")


# bad input
BAD_SPEEDS = {
    "fast": "is no range of speeds",
    "1:fast:2": "is no range of speeds",
    "": "is no range of speeds",
    "0:12": "needs three numbers: from, to and step",
    "0:12:3:4": "needs three numbers",
    "0:12:0": "never gets to its end by a step of zero",
    "0:12:-3": "never gets to its end",
    "12:0:3": "never gets to its end",
    "0:12:1e-9": "more than 10000",
    "0:12 kg:3": "'kg' is not the unit of a speed",
    "0:12 m/s:3": "has units, and 3 has none",
    "nan": "not a finite number",
    "0:inf:1": "not a finite number",
    "0,nan,3": "not a finite number",
}


@pytest.mark.parametrize("verb", ["static", "flutter"])
@pytest.mark.parametrize("speed", BAD_SPEEDS)
def test_bad_speeds_exit_with_2_and_a_cure_and_write_nothing(gardenhose, folder, verb, speed):
    before = files(folder)
    code, out, err = gardenhose(verb, "hose.yaml", "--speed", speed)
    err = " ".join(err.split())
    assert (code, out) == (2, "")
    assert "--speed" in err and BAD_SPEEDS[speed] in err and "Traceback" not in err
    assert "write 0:12:3" in err or "take a larger step" in err
    assert files(folder) == before


@pytest.mark.parametrize("verb", ["static", "flutter"])
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["dry.yaml", "--speed", "1"], "water: is missing"),
        (["missing.yaml"], "there is no such file"),
        (["hose.yaml", "--speed", "1,2", "-o", "shapes.xyz"], "is no format of figures"),
        (["hose.yaml", "--speed", "1,2", "-o", "shapes"], "is no format of figures"),
        (["hose.yaml", "--speed", "1,2", "-o", "nowhere/shapes.png"], "there is no folder nowhere"),
        (["hose.yaml", "--sped", "1"], "--sped"),
    ],
    ids=["no water", "no file", "unknown ending", "no ending", "no folder", "misspelt"],
)
def test_bad_input_exits_with_2_names_the_fault_and_writes_nothing(gardenhose, folder, verb, arguments, said):
    before = files(folder)
    code, out, err = gardenhose(verb, *arguments)
    assert (code, out) == (2, "")
    assert said in " ".join(err.split()) and "Traceback" not in err
    assert files(folder) == before


@pytest.mark.parametrize(("verb", "search"), [("static", "gardenhose.static.forms"), ("flutter", STABILITY)])
def test_where_the_figure_goes_is_looked_at_before_the_search(gardenhose, monkeypatch, verb, search):
    monkeypatch.setattr(search, lambda *_: pytest.fail("searched for what cannot be written"))
    assert gardenhose(verb, "hose.yaml", "-o", "nowhere/shapes.png")[0] == 2


@pytest.mark.parametrize(("verb", "search"), [("static", "gardenhose.static.forms"), ("flutter", STABILITY)])
def test_a_search_that_finds_nothing_exits_with_3_and_json_tells_where_and_why(gardenhose, monkeypatch, verb, search):
    def fails(*_):
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "element 3")

    monkeypatch.setattr(search, fails)
    code, out, err = gardenhose(verb, "hose.yaml", "--json")
    report = only_object(out)
    assert (code, report["status"], report["scene"]) == (3, "no equilibrium", "hose.yaml")
    assert report["stopped"]["part"] == "element 3" and report["stopped"]["sentence"] in " ".join(err.split())
    assert "hose.yaml" in err and not list(Path().glob("*.png"))


@pytest.mark.parametrize("verb", ["static", "flutter"])
def test_a_hose_without_water_is_refused_without_speeds_too(gardenhose, folder, verb):
    before = files(folder)
    code, _, err = gardenhose(verb, "dry.yaml")
    assert code == 2
    assert "water" in err and "Traceback" not in err
    assert files(folder) == before


def test_bad_speed_with_json_is_an_object_of_problems(gardenhose):
    code, out, _ = gardenhose("static", "hose.yaml", "--speed", "12:0:3", "--json")
    report = only_object(out)
    assert (code, report["status"]) == (2, "bad input")
    assert report["problems"][0]["file"] == "--speed"


# simulate
HEADLINE = {"motion", "tip_amplitude", "frequency", "cycles", "tip_speed_max", "tip_mean", "axial_force_max"}
HEADLINE |= {"axial_force_min", "flow_speed"}


def test_simulate_tells_the_limit_cycle_in_its_json(gardenhose):
    # 35 m/s: 13.4754 Hz, amplitude 0.514454/2 m along z and 0.153668/2 along x, of the reference; the mesh and step of
    # the scene err by 2.5e-3
    code, out, _ = gardenhose("simulate", "hose.yaml", "--json", "--end", "3", "--no-verify")
    report = only_object(out)
    assert (code, report["status"], report["result"]) == (0, "done", "hose.nc")
    assert report.keys() >= HEADLINE
    assert report["motion"] == "periodic"
    assert report["frequency"] == pytest.approx(13.47536, rel=5e-3)
    assert report["tip_amplitude"] == pytest.approx(0.257227, rel=1e-2)
    assert (report["flow_speed"], report["energy_error"]) == (35, pytest.approx(0, abs=1e-3))


def test_run_of_a_hose_that_is_gone_on_with_equals_the_whole_run(gardenhose):
    for arguments in (
        ["--end", "0.2", "-o", "whole.nc"],
        ["--end", "0.1", "-o", "half.nc"],
        ["--end", "0.2", "-o", "rest.nc", "--resume", "half.nc"],
    ):
        assert gardenhose("simulate", "hose.yaml", *arguments, "--no-verify")[0] == 0
    whole, rest = Result.read("whole.nc"), Result.read("rest.nc")
    for name in (
        "time",
        "position",
        "slope",
        "velocity",
        "axial_force",
        "flow_speed",
        "external_work",
        "strain_energy",
    ):
        np.testing.assert_array_equal(np.asarray(rest[name]), np.asarray(whole[name]), err_msg=name)


def test_run_is_not_gone_on_with_under_another_speed(gardenhose):
    assert gardenhose("simulate", "hose.yaml", "--end", "0.05", "-o", "half.nc", "--no-verify")[0] == 0
    Path("other.yaml").write_text(HOSE.replace("to: 35.0", "to: 30.0"), encoding="utf8")
    code, _, err = gardenhose("simulate", "other.yaml", "--end", "0.1", "-o", "rest.nc", "--resume", "half.nc")
    assert code == 2
    assert "belongs to another scene" in " ".join(err.split())
    assert "simulating" not in err


def test_a_stable_hose_is_called_stable_at_one_speed_and_at_many(gardenhose):
    for speeds, said in (("0", "stable at 0 m/s"), ("0:5:1", "stable from 0 to 5 m/s")):
        code, out, err = gardenhose("flutter", "hose.yaml", "--set", "hose.elements=5", "--speed", speeds, "--json")
        assert code == 0 and not any(only_object(out)["unstable"]) and said in err and "unstable" not in err


def test_a_hose_that_falls_without_flow_is_told_so_and_from_where_on_the_flow_holds_it_up(gardenhose, folder):
    # 12.2 of Greenhill's 7.837; few elements have the same order of what is found
    standing = ("flutter", "standing.yaml", "--set", "hose.length=0.7", "--set", "hose.elements=5")
    text = (folder / "hose.yaml").read_text().replace("direction: [1, 0, 0]", "direction: [0, 0, 1]")
    (folder / "standing.yaml").write_text(text)
    code, out, err = gardenhose(*standing, "--json")
    report, said = only_object(out), " ".join(err.split())
    assert code == 0
    assert (report["critical_speed"], report["kind"], report["unstable"][0]) == (0.0, "divergence", True)
    assert "the hose diverges from 0 m/s" in said
    again = report["windows"][-1]["from"]
    assert f"it is stable from {report['stable_from']:.6g} m/s to {again:.6g} m/s" in said
    assert report["critical"][-1]["kind"] == "flutter" and report["critical"][-1]["speed"] > report["stable_from"]
    code, _, err = gardenhose(*standing, "--speed", "0,0.5")
    assert code == 0 and "stable at none of the speeds looked at, up to 0.5 m/s" in " ".join(err.split())


# times, figures
def test_times_may_have_units(gardenhose):
    code, out, _ = gardenhose("simulate", "hose.yaml", "--json", "--end", "100 ms", "--step", "2.5 ms", "--no-verify")
    assert code == 0 and only_object(out)["end"] == pytest.approx(0.1)
    assert Result.read("hose.nc").attributes["step"] == pytest.approx(2.5e-3)
    code, _, err = gardenhose("simulate", "hose.yaml", "--end", "0.1", "--step", "auto")
    assert code == 0 and "step: auto" in err
    for option, value in (("--end", "2 kg"), ("--step", "soon"), ("--end", "auto"), ("--end", "inf")):
        code, _, err = gardenhose("simulate", "hose.yaml", option, value)
        assert code == 2 and f"{option} {value}" in err


def test_a_run_that_has_come_to_the_end_is_not_gone_on_with(gardenhose):
    assert gardenhose("simulate", "hose.yaml", "--end", "0.1", "-o", "first.nc", "-q", "--no-verify")[0] == 0
    for end in ("0.1", "0.05"):
        code, _, err = gardenhose("simulate", "hose.yaml", "--end", end, "-o", "second.nc", "--resume", "first.nc")
        assert (
            code == 2 and "ends at 0.1 s: nothing is left" in " ".join(err.split()) and not Path("second.nc").exists()
        )
        # Refusals come first: nothing is said to begin that does not.
        assert "simulating" not in err
    code, _, err = gardenhose("simulate", "hose.yaml", "--end", "0.12", "-o", "second.nc", "--resume", "first.nc")
    assert code == 0 and err.count("simulating hose.yaml") == 1


def test_a_figure_that_cannot_be_drawn_leaves_no_folder_and_a_picture_no_folder_of_its_name(gardenhose, folder):
    assert gardenhose("simulate", "hose.yaml", "--end", "0.1", "-q", "--no-verify")[0] == 0
    before = files(folder)
    for arguments, said in ((["--what", "nothing", "-o", "drawn"], "nothing"), (["-o", "tip.jpg"], "no format")):
        code, _, err = gardenhose("plot", "hose.nc", *arguments)
        assert code == 2 and said in err and files(folder) == before


def test_an_overview_that_is_several_figures_is_a_dictionary_of_them(gardenhose):
    assert gardenhose("simulate", "hose.yaml", "--end", "0.1", "-q", "--no-verify")[0] == 0
    drawn = Result.read("hose.nc").plot.overview()
    assert list(drawn) == ["tip", "phase", "shape", "ramp"] and all(figure.axes for figure in drawn.values())


def test_a_hose_that_is_held_at_both_ends_tells_of_the_node_that_moves_most(gardenhose):
    """Its small motion has the frequency of the slowest eigenvalue about the shape at rest."""
    assert gardenhose("new", "supported", "-o", "held.yaml")[0] == 0
    report = only_object(gardenhose("simulate", "held.yaml", "--json", "--no-verify")[1])
    slowest = only_object(gardenhose("flutter", "held.yaml", "--speed", str(report["flow_speed"]), "--json")[1])
    assert (report["motion"], report["tip_amplitude"]) == ("rest", 0) and 1 < report["node"] < 20
    assert report["node_frequency"] == pytest.approx(slowest["eigenvalues"][0][0][1] / (2 * np.pi), rel=0.02)
    assert report["node_amplitude"] > 1e-4


@pytest.mark.parametrize(
    "words", [("flutter", "--speed", "0,3"), ("static", "--speed", "3")], ids=lambda words: words[0]
)
def test_static_and_flutter_warn_of_the_scene_and_not_of_its_run(gardenhose, words):
    change = ("--set", "gravity=[0, 0, -32.2]", "--set", "output.interval=1.7 ms")
    code, out, err = gardenhose(words[0], "hose.yaml", *change, *words[1:], "--json")
    told = [one["where"] for one in only_object(out)["warnings"]]
    assert code == 0 and "gravity[2]" in told and "output.interval" not in told
    assert "warning: gravity[2]: " in err
