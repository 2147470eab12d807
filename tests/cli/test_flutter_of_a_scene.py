"""`flutter` looks the way that the scene's water flows, and says where elements are too coarse for what it finds."""

from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object

import tautline
from gardenhose.application import Gardenhose
from gardenhose.stability import Curves, Stability
from gardenhose.verbs import _uncertain_curves

SCENE = """\
hose: {length: 1, elements: 12, axial_stiffness: 1.0e6, bending_stiffness: 1, mass_per_length: 0.2, damping: 0.02}
water: {mass_per_length: 0.3, speed: 1}
gravity: 0
solver: {step: 1 ms, end: 1 s}
output: {interval: 5 ms}
"""
FIRST = 1.875104068711961
"""Root of cos x cosh x = -1."""


@pytest.fixture
def gardenhose(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("hose.yaml").write_text(SCENE, encoding="utf8")
    leave_out_pixels(monkeypatch)
    return commands_of(Gardenhose(), capsys)


def test_flutter_is_sought_the_way_that_the_scenes_water_flows(gardenhose):
    code, out, err = gardenhose("flutter", "hose.yaml", "--set", "water.speed=-1", "--json")
    report = only_object(out)
    # Slow flow, first mode: c EJ int phi''^2 = -M U phi(L)^2; of a unit mode phi(L)^2 = 4 and int phi''^2 = FIRST^4
    onset = -0.02 * FIRST**4 / (4.0 * 0.3)
    assert code == 0 and report["critical_speed"] == pytest.approx(onset, rel=1e-3)
    assert report["direction"] == "tip to root" and report["speed"] == sorted(report["speed"])
    assert report["speed"][-1] == 0.0 and not report["unstable"][-1] and report["unstable"][0]
    assert "from the tip to the root" in err and "from -0.206" in err
    # the first column is the first mode where nothing flows: (FIRST / L)^2 sqrt(EJ / (m + M))
    assert abs(complex(*report["eigenvalues"][-1][0])) == pytest.approx(FIRST**2 / 0.5**0.5, rel=1e-3)


def test_flutter_with_the_flow_to_the_tip_is_what_it_was(gardenhose):
    _, out, err = gardenhose("flutter", "hose.yaml", "--json")
    report = only_object(out)
    assert report["direction"] == "root to tip" and report["critical_speed"] == pytest.approx(15.958, rel=2e-3)
    assert report["warnings"] == [] and "coarse" not in err


@pytest.mark.parametrize(
    "more",
    [("--set", "hose.elements=2"), ("--set", "hose.elements=1"), ("--set", "hose.elements=3", "--speed", "0,1,14")],
    ids=["at the speed found", "where none is found", "at the top of --speed"],
)
def test_flutter_says_where_elements_are_coarse_for_the_flows_waves(gardenhose, more):
    code, out, err = gardenhose("flutter", "hose.yaml", *more, "--json")
    (told,) = only_object(out)["warnings"]
    assert code == 0 and told["where"] == "hose.elements" and "coarse" in told["text"]
    assert "hose.elements" in err


def test_flutter_does_not_warn_of_elements_for_speeds_below_two_radians_of_a_wave(gardenhose):
    # sqrt(M / EJ) U L / 3 = 1.8 rad at 10 m/s
    _, out, _ = gardenhose("flutter", "hose.yaml", "--set", "hose.elements=3", "--speed", "0,5,10", "--json")
    assert only_object(out)["warnings"] == []


PLAIN = """\
hose: {length: 1, elements: 12, axial_stiffness: 1.0e6, bending_stiffness: 1, mass_per_length: 0.7028}
water: {mass_per_length: 0.2972, speed: 1}
gravity: 0
solver: {step: 1 ms, end: 1 s}
output: {interval: 5 ms}
"""
"""Gregory and Paidoussis' cantilever where its boundary folds back: unstable from 13.76 to 13.91 m/s, on this mesh."""


def test_flutter_tells_the_windows_in_which_a_hose_is_unstable_and_how_narrow_one_may_be_missed(gardenhose):
    Path("plain.yaml").write_text(PLAIN, encoding="utf8")
    code, out, err = gardenhose("flutter", "plain.yaml", "--json")
    report, said = only_object(out), " ".join(err.split())
    first, last = report["windows"]
    assert code == 0 and first["from"] == report["critical_speed"] and last["to"] is None
    assert 13.7 < first["from"] < first["to"] < 14.0 < last["from"] < 15.2
    assert f"unstable in windows of speed: from {first['from']:.6g} m/s to {first['to']:.6g} m/s" in said
    assert f"a window narrower than {report['resolution']:.2g} m/s may be missed" in said


def test_flutter_warns_of_a_window_between_the_speeds_that_are_given(gardenhose):
    Path("plain.yaml").write_text(PLAIN, encoding="utf8")
    code, out, err = gardenhose("flutter", "plain.yaml", "--speed", "13:15:1", "--json")
    report, said = only_object(out), " ".join(err.split())
    (told,) = (one for one in report["warnings"] if one["where"] == "--speed")
    assert code == 0 and report["unstable"] == [False] * 3 and len(report["windows"]) == 1
    assert "None of the speeds given lies there" in told["text"] and told["text"] in said


def test_flutter_of_a_hose_that_becomes_unstable_once_speaks_of_no_windows(gardenhose):
    code, out, err = gardenhose("flutter", "hose.yaml", "--json")
    (window,) = only_object(out)["windows"]
    assert code == 0 and window["to"] is None and "window" not in err


@pytest.mark.parametrize(
    ("speeds", "extent"), [("16.5:18:0.5", "all"), ("1:3:1", "none"), ("15:17:1", "part")], ids=["all", "none", "part"]
)
def test_flutter_says_whether_a_hose_is_unstable_at_none_part_or_all_of_the_speeds(gardenhose, speeds, extent):
    code, out, err = gardenhose("flutter", "hose.yaml", "--speed", speeds, "--json")
    assert code == 0 and only_object(out)["unstable_at"] == extent
    # above the onset: it lies below, and there is a way to it
    below = "the critical speed lies below 16.5 m/s. Leave out --speed to search from 0, or give lower speeds"
    assert (below in " ".join(err.split())) == (extent == "all")


def test_a_sweep_tells_a_hose_that_is_stable_at_every_speed_from_one_that_is_unstable_at_all(gardenhose):
    scene = tautline.read("hose.yaml")
    vary = {"hose.length": [0.5, 4.0]}
    data = tautline.sweep(
        scene, vary, collect=["unstable_at", "critical_speed"], verb="flutter", options={"speed": "6:8:1"}, jobs=1
    )
    assert data["unstable_at"].values.tolist() == ["none", "all"]


def test_static_says_that_it_does_not_judge_the_stability_of_a_hose_with_a_free_end(gardenhose):
    code, out, err = gardenhose("static", "hose.yaml", "--speed", "0,17", "--json")
    (told,) = only_object(out)["warnings"]
    assert code == 0 and told["where"] == "hose.end" and "not judged" in told["text"]
    assert "gardenhose flutter" in " ".join(err.split())
    for more in (("--speed", "0"), ("--set", "hose.end=pinned", "--speed", "0,2")):
        _, out, _ = gardenhose("static", "hose.yaml", *more, "--json")
        assert only_object(out)["warnings"] == []


@pytest.mark.parametrize("verb", ["static", "flutter"])
def test_static_and_flutter_say_where_the_waters_momentum_takes_all_of_the_axial_stiffness(gardenhose, verb):
    # M U^2 = 0.3 10^2 = 30 N, of EA = 20 N
    change = ("--set", "hose.axial_stiffness=20", "--set", "hose.elements=4")
    code, out, err = gardenhose(verb, "hose.yaml", *change, "--speed", "0,10", "--json")
    told = {one["where"]: one["text"] for one in only_object(out)["warnings"]}
    assert code == 0 and "momentum M U^2 equals EA" in told["hose.axial_stiffness"]
    assert "momentum M U^2 equals EA" in " ".join(err.split())


def test_static_says_where_elements_are_coarse_for_the_flows_waves(gardenhose):
    _, out, _ = gardenhose("static", "hose.yaml", "--set", "hose.elements=3", "--speed", "0,14", "--json")
    assert "coarse" in {one["where"]: one["text"] for one in only_object(out)["warnings"]}["hose.elements"]


def test_flutter_advises_a_narrower_range_where_speeds_are_as_near_as_any_looked_at_in_one_as_wide():
    def text(low, high):
        curves = Curves(np.array([0.0, low, high]), *(np.zeros((3, 1)),) * 2, np.array([[True], [False]]), ())
        made = Stability(np.array([10.0, 50.0]), *(np.zeros((2, 1)),) * 2, np.zeros(2, bool), [], curves=curves)
        (warning,) = _uncertain_curves(made, "si")
        return warning.text

    # A thousandth of 40 m/s is as near as speeds are looked at there.
    assert "Take a smaller step" in text(40.0, 40.05)
    assert "Take a smaller step" not in text(40.0, 40.03) and "A narrower range of --speed" in text(40.0, 40.03)


def test_flutter_says_where_it_is_not_sure_which_mode_goes_on_as_which(gardenhose, monkeypatch):
    # as where no more speeds than those asked for are looked at
    for name, value in {"BETWEEN": 0, "ROUND": 1, "MOST_BETWEEN": 1, "APART": 0.1}.items():
        monkeypatch.setattr(f"gardenhose.flutter.{name}", value)
    code, out, err = gardenhose("flutter", "hose.yaml", "--speed", "0,20,40", "--json")
    report = only_object(out)
    assert code == 0 and report["doubtful"]
    assert {"mode", "from", "to"} == report["doubtful"][0].keys()
    assert any("not sure which mode goes on as which" in one["text"] for one in report["warnings"])
    assert "The curves have gaps there" in " ".join(err.split())


def test_flutter_of_a_hose_without_bending_stiffness_says_that_the_elements_decide(gardenhose):
    change = ("--set", "hose.bending_stiffness=0", "--set", "hose.elements=4")
    _, out, err = gardenhose("flutter", "hose.yaml", *change, "--speed", "0,5", "--json")
    told = [one["text"] for one in only_object(out)["warnings"] if one["where"] == "hose.bending_stiffness"]
    assert len(told) == 1 and "depends on the number of elements" in told[0] and told[0] in " ".join(err.split())
