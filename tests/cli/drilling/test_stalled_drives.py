"""A drive whose torque limit is below what its bit needs: `check` says so before a run, and `simulate` after it."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, only_object

from drillstring.application import Drillstring
from drillstring.results.drilling import stall_of, stalled_drive

DRILLING = (Path(__file__).parents[3] / "data/drilling.yaml").read_text(encoding="utf8")
LIMIT = "top.rotation.controller.torque_limit"
LAST = "in the last half of the run the bit does not turn. "


@pytest.fixture
def drillstring_(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("drilling.yaml").write_text(DRILLING.replace("elements: 24", "elements: 6"), encoding="utf8")
    return commands_of(Drillstring(), capsys)


def said(drillstring_, limit, *words):
    """What check says of the torque limit: kinetic and static torque are 4 and 8 kN m at 100 kN, decay 60 rpm."""
    *_, err = drillstring_("check", "drilling.yaml", "--set", f"{LIMIT}={limit}", *words)
    return " ".join(line for line in err.splitlines() if line.startswith(f"warning: {LIMIT}"))


def test_check_says_where_the_drive_has_less_torque_than_its_bit_takes_at_the_fastest_of_the_run(drillstring_):
    # 4 kN m + 4 kN m exp(-2) at 120 rpm
    text = said(drillstring_, "4.5 kN m")
    assert "4.5 kN m is less than the 4.541 kN m that the bit takes with 100 kN on it at 120 rpm, the fastest" in text
    assert "the drive stalls. Give more torque or less weight" in text
    assert "2.271 kN m" in said(drillstring_, "2 kN m", "--set", "bit.weight=50 kN", "--set", "bit.torque.weight=1e5")
    # Half way up the ramp of 5 s, which is alike both ways: 4 kN m + 4 kN m exp(-1)
    text = said(drillstring_, "5 kN m", "--set", "solver.end=2.5 s")
    assert "the 5.472 kN m that the bit takes with 100 kN on it at 60 rpm, the fastest of the run" in text


def test_check_says_where_the_drive_has_less_torque_than_holds_its_bit_at_rest(drillstring_):
    assert "less than the 8 kN m that hold a bit at rest" in said(drillstring_, "4.6 kN m")
    text = DRILLING.replace(", decay: 60 rpm", "")
    Path("drilling.yaml").write_text(text, encoding="utf8")
    assert "less than the 8 kN m that hold a bit at rest" in said(drillstring_, "4.6 kN m")
    assert "less than the 4 kN m that the bit takes" in said(drillstring_, "3.9 kN m")


@pytest.mark.parametrize("limit", ["8.1 kN m", "40 kN m"])
def test_check_says_nothing_of_a_drive_that_has_enough_torque(drillstring_, limit):
    assert said(drillstring_, limit) == ""


def test_check_says_nothing_of_a_weak_drive_that_is_not_asked_to_turn_or_whose_bit_hangs(drillstring_):
    assert said(drillstring_, "1 kN m", "--set", "top.rotation.controller.speed=0") == ""
    assert said(drillstring_, "1 kN m", "--set", "bit.on_bottom=false") == ""


@pytest.mark.parametrize(("limit", "stalls"), [("3 kN m", True), ("40 kN m", False)])
def test_a_run_says_that_its_drive_stalls(drillstring_, limit, stalls):
    words = ("simulate", "drilling.yaml", "--set", f"{LIMIT}={limit}", "--end", "40", "--no-verify", "--json")
    code, out, _ = drillstring_(*words)
    told = [text for text in only_object(out)["warnings"] if "stalls" in text]
    sentence = LAST + "The drive stalls at 3 kN m. Give more torque or less weight"
    assert code == 0 and told == ([sentence] if stalls else [])


def run_of(turned, torque, spin):
    """Two numbers of every frame in each quarter: the drive's speed and torque; the bit's speed throughout."""
    shape = np.ones(40)
    return {
        "time": np.linspace(0.0, 39.0, 40), "drive_speed": turned * shape, "drive_torque": np.repeat(torque, 10),
        "rotation_rate": np.full((40, 2), spin),
    }  # fmt: skip


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_drive_stalls_that_neither_turns_nor_gains_torque_whichever_way_it_is_to_turn(way):
    held, winds = np.array([1.0, 3.0, 3.0, 3.0]) * 1e3, np.array([0.0, 1.0, 2.0, 3.0]) * 1e3
    assert stall_of(run_of(0.0, way * held, 0.0), 10.0 * way) == pytest.approx(3e3)
    for other in (run_of(way, way * held, 0.0), run_of(0.0, way * winds, 0.0)):
        assert np.isnan(stall_of(other, 10.0 * way))
    assert np.isnan(stall_of(run_of(0.0, held, 0.0), 0.0))
    (told,) = stalled_drive(run_of(0.0, way * held, 0.0), 10.0 * way, False, "si")
    assert told == LAST + "The drive stalls at 3 kN m. Give more torque"
    assert not stalled_drive(run_of(0.0, way * held, 1.0), 10.0 * way, False, "si")


@pytest.mark.parametrize("frames", [1, 2])
def test_of_a_run_of_one_or_two_frames_it_is_not_said_whether_its_drive_stalls(frames):
    run = {name: values[:frames] for name, values in run_of(0.0, np.full(4, 3e3), 0.0).items()}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isnan(stall_of(run, 10.0)) and stalled_drive(run, 10.0, False, "si") == []
