"""`flutter` and `static` over speeds of both signs: each way of flow has its own words, and JSON has both."""

from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object
from of_the_suite import studies
from references import hose as reference
from scipy.optimize import brentq

from gardenhose.application import Gardenhose
from gardenhose.stability import Stability, Way
from tautline.integrators.status import Status, StoppedEarly

BETA, M, C = 0.3, 0.3, 0.02
SCENE = """\
hose: {length: 1, elements: 6, axial_stiffness: 1.0e6, bending_stiffness: 1, mass_per_length: 0.7, damping: 0.02}
water: {mass_per_length: 0.3, speed: 1}
gravity: 0
solver: {step: 1 ms, end: 1 s}
output: {interval: 5 ms}
"""
HELD = ("--set", "hose.root_support=clamped", "--set", "hose.end=clamped", "--set", "hose.damping=0")
UPRIGHT = ("--set", "hose.direction=[0,0,1]", "--set", "gravity=12", "--set", "hose.elements=6")
EULER = 2.0 * np.pi / np.sqrt(M)
"""Speed, m/s, at which a pipe clamped at both ends diverges, whichever way the water goes: u = 2 pi."""
FIRST = 1.875104068711961
"""Root of cos x cosh x = -1."""
ASPIRATING = -C * FIRST**4 / (4.0 * M)
"""Slow flow, first mode: c EJ int phi''^2 = -M U phi(L)^2; of a unit mode phi(L)^2 = 4 and int phi''^2 = FIRST^4."""
WAYS = ["root to tip", "tip to root"]


@pytest.fixture
def gardenhose(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("hose.yaml").write_text(SCENE, encoding="utf8")
    leave_out_pixels(monkeypatch)
    return commands_of(Gardenhose(), capsys)


def parts(err):
    """What is said of each way of flow."""
    text = " ".join(err.split()).split("warning:")[0]
    _, down, up = text.split("the water flows from the ")
    assert down.startswith("root to the tip:") and up.startswith("tip to the root (negative speeds):")
    return down, up


def galerkin_onset():
    pipe = reference.Pipe(12)

    def growth(U):
        return pipe.eigenvalues(U * np.sqrt(M), BETA, alpha=C)[: pipe.modes].real.max()

    return brentq(growth, 5.0, 30.0)


@pytest.mark.parametrize("speeds", ["-3,20", *studies("-3:20:1")])
def test_each_way_of_flow_has_its_critical_speed_with_its_sign_however_speeds_of_both_signs_are_given(
    gardenhose, speeds
):
    code, out, err = gardenhose("flutter", "hose.yaml", "--speed", speeds, "--json")
    report, (down, up) = only_object(out), parts(err)
    onset = galerkin_onset()
    assert code == 0 and report["direction"] == "both"
    assert [one["direction"] for one in report["ways"]] == WAYS
    assert [one["critical_speed"] for one in report["ways"]] == pytest.approx([onset, ASPIRATING], rel=5e-3)
    # the slowest first, and once in each list
    assert [one["speed"] for one in report["critical"]] == [one["critical_speed"] for one in report["ways"]][::-1]
    assert report["critical_speed"] == report["ways"][1]["critical_speed"]
    assert [one["windows"] for one in report["ways"]] == [
        [{"from": one["critical_speed"], "to": None}] for one in report["ways"]
    ]
    assert report["windows"] == [window for one in report["ways"] for window in one["windows"]]
    assert f"from {report['ways'][0]['critical_speed']:.6g} m/s" in down and "window" not in down
    assert f"from {report['ways'][1]['critical_speed']:.6g} m/s" in up and "window" not in up


@pytest.mark.parametrize("speeds", ["-13:13:2"])
def test_a_pipe_held_at_both_ends_diverges_at_one_speed_both_ways(gardenhose, speeds):
    code, out, err = gardenhose("flutter", "hose.yaml", *HELD, "--speed", speeds, "--json")
    report, (down, up) = only_object(out), parts(err)
    assert code == 0 and [one["critical_speed"] for one in report["ways"]] == pytest.approx([EULER, -EULER], rel=1e-3)
    assert report["critical_speed"] == report["ways"][0]["critical_speed"], "of two that are as slow, from root to tip"
    assert "diverges from 11.4" in down and "diverges from -11.4" in up
    assert len(report["critical"]) == 2 and report["warnings"] == []


@pytest.mark.parametrize(
    ("more", "speeds", "extent"),
    [
        # The cantilever's onsets are at some 16 m/s and at -0.206 m/s: at rest it is stable.
        ((), "-5,20", "part"),
        ((), "-5,-2", "all"),
        # It falls without flow, and what flows either way does not hold it up.
        (UPRIGHT, "-1,1", "all"),
        # It falls without flow, and is held up at 8 m/s.
        (UPRIGHT, "-1,8", "part"),
    ],
    ids=["stable at rest alone", "one way", "falls", "held up"],
)
def test_rest_between_speeds_of_both_signs_counts_among_those_at_which_a_hose_is_unstable(
    gardenhose, more, speeds, extent
):
    code, out, _ = gardenhose("flutter", "hose.yaml", *more, "--speed", speeds, "--json")
    assert code == 0 and only_object(out)["unstable_at"] == extent


def test_a_hose_that_is_unstable_at_rest_alone_is_unstable_at_part_of_the_speeds():
    ways = [
        Way(sign, np.sort([0.0, sign]), np.array(grows), [], [], None)
        for sign, grows in ((1.0, [True, False]), (-1.0, [False, True]))
    ]
    speeds = np.array([-1.0, 1.0])
    made = Stability(speeds, *(np.zeros((2, 1)),) * 2, np.zeros(2, bool), [], ways=ways)
    assert made.unstable_at == "part"


def test_windows_are_told_for_each_way_and_those_of_one_contradict_nothing_that_is_said_of_the_other(gardenhose):
    # u of the pipe clamped at both ends: 2 pi, stable once more from 8.99 to 9.29 (Paidoussis and Issid 1974)
    fast = 9.4 / np.sqrt(0.5)
    changes = ("--set", "water.mass_per_length=0.5", "--set", "hose.mass_per_length=0.5")
    code, out, err = gardenhose("flutter", "hose.yaml", *HELD, *changes, "--speed", f"-10,5,{fast}", "--json")
    report, (down, up) = only_object(out), parts(err)
    first, last = report["ways"][0]["windows"]
    u = np.array([first["from"], first["to"], last["from"]]) * np.sqrt(0.5)
    assert code == 0 and u == pytest.approx([2.0 * np.pi, 8.99, 9.29], rel=5e-3) and last["to"] is None
    (back,) = report["ways"][1]["windows"]
    assert back == {"from": report["ways"][1]["critical_speed"], "to": None}
    assert "unstable in windows of speed" in down and "window" not in up


def test_a_hose_that_falls_at_rest_is_unstable_at_zero_both_ways_and_told_from_where_the_flow_holds_it_up(gardenhose):
    # 12 of Greenhill's 7.837 EJ / L^2
    code, out, err = gardenhose("flutter", "hose.yaml", *UPRIGHT, "--speed", "-1,8", "--json")
    report, (down, up) = only_object(out), parts(err)
    assert code == 0 and [one["critical_speed"] for one in report["ways"]] == [0.0, 0.0]
    assert [one["speed"] for one in report["critical"]].count(0.0) == 1
    held = report["ways"][0]["stable_from"]
    assert 0.0 < held < 8.0 and f"it is stable from {held:.6g} m/s" in down
    assert "diverges from 0 m/s" in down and "diverges from 0 m/s" in up and "stable at none" in up


@pytest.mark.parametrize("verb", ["flutter", "static"])
@pytest.mark.parametrize(("speeds", "least"), [("-3,5", "-3"), ("-2:0:1", "-2")])
def test_water_that_is_drawn_in_at_speeds_asked_for_is_warned_of_as_that_of_a_scene(gardenhose, verb, speeds, least):
    _, out, err = gardenhose(verb, "hose.yaml", "--speed", speeds, "--json")
    (told,) = (one for one in only_object(out)["warnings"] if one["where"] == "--speed")
    assert f"down to {least} m/s" in told["text"] and "In experiments it has not" in told["text"]
    assert "In experiments it has not" in " ".join(err.split())


@pytest.mark.parametrize("verb", ["flutter", "static"])
def test_water_that_is_drawn_in_is_warned_of_once_and_not_where_the_tip_is_held_or_the_water_leaves(gardenhose, verb):
    for more, count in (
        (("--set", "water.speed=-1", "--speed", "-2:0:1"), 1),
        (("--set", "hose.end=clamped", "--speed", "-2:0:1"), 0),
        (("--speed", "0:2:1"), 0),
    ):
        _, out, _ = gardenhose(verb, "hose.yaml", *more, "--json")
        assert sum("drawn in" in one["text"] for one in only_object(out)["warnings"]) == count


@pytest.mark.parametrize(
    ("speeds", "said"),
    [
        # One element is of two radians of the waves of the flow at u = 2. The cantilever flutters at about 16 m/s.
        ((), "stable from 0 to 3.651 m/s. Beyond, up to"),
        (("--speed", "50"), "the elements are too coarse to tell whether the hose is stable at 50 m/s"),
        (("--speed", "20,50"), "the elements are too coarse to tell whether the hose is stable from 20 to 50 m/s"),
    ],
    ids=["searched", "one", "range"],
)
def test_a_hose_on_elements_too_coarse_for_the_speeds_is_not_called_stable_there(gardenhose, speeds, said):
    code, out, err = gardenhose("flutter", "hose.yaml", "--set", "hose.elements=1", *speeds, "--json")
    report = only_object(out)
    assert code == 0 and said in " ".join(err.split()) and not any(report["unstable"])
    assert report["unstable_at"] == "unknown" and report["fine_up_to"] == pytest.approx(2.0 / np.sqrt(M))


def test_a_critical_speed_on_elements_too_coarse_for_it_is_told_with_that(gardenhose):
    code, out, err = gardenhose("flutter", "hose.yaml", "--set", "hose.elements=2", "--speed", "0,25", "--json")
    report, said = only_object(out), " ".join(err.split())
    assert code == 0 and report["critical_speed"] > report["fine_up_to"] == pytest.approx(4.0 / np.sqrt(M))
    assert f"from {report['critical_speed']:.6g} m/s, by elements that are too coarse for this speed" in said
    _, out, err = gardenhose("flutter", "hose.yaml", "--json")
    assert only_object(out)["critical_speed"] < only_object(out)["fine_up_to"] and "coarse" not in err


@pytest.mark.parametrize(
    ("speeds", "said"),
    [
        # Two elements are fine up to 4 / sqrt(M) = 7.303 m/s; drawn in, the water makes this hose unstable from -0.206.
        ("-10:-5:1", "unstable from -10 to -5 m/s, beyond -7.303 m/s by elements that are too coarse"),
        ("-10:-8:1", "unstable from -10 to -8 m/s, by elements that are too coarse for these speeds"),
    ],
    ids=["the fastest", "all"],
)
def test_only_the_speeds_that_elements_are_too_coarse_for_are_called_so_where_a_hose_is_unstable_at_all(
    gardenhose, speeds, said
):
    code, _, err = gardenhose("flutter", "hose.yaml", "--set", "hose.elements=2", "--speed", speeds)
    assert code == 0 and said in " ".join(err.split())


def test_a_search_that_takes_long_says_so_before_it_begins(gardenhose, monkeypatch):
    def search(*_):
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "element 3")

    monkeypatch.setattr("gardenhose.flutter.stability", search)
    for more, said in (((), True), (("--speed", "0,1"), False)):
        _, _, err = gardenhose("flutter", "hose.yaml", "--set", "hose.elements=200", *more)
        assert ("eigenvalues of 200 elements at some sixty speeds" in " ".join(err.split())) == said
    assert "sixty" not in gardenhose("flutter", "hose.yaml")[2]
