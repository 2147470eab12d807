"""Runs of the map of stick-slip that end before the starting transient has decayed: no severity is drawn."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object

from drillstring.application import Drillstring
from drillstring.stick_slip.dying_out import CYCLES, dying_out
from drillstring.stick_slip.record import sentences, table
from drillstring.stick_slip.severity_map import Cell, Map
from drillstring.view.stick_slip_figures import draw

DATA = Path(__file__).parents[3] / "data"
RPM = 2.0 * math.pi / 60.0
PERIOD = 5.0


def turning(end, share, rate, mean=10.0):
    """Rotary speed that swings by a share of its mean with the period, and less with a rate, 1/s."""
    time = np.linspace(0.0, end, 20 * int(end) + 1)
    return time, mean * (1.0 + share * np.exp(-rate * time) * np.cos(2.0 * np.pi * time / PERIOD))


@pytest.mark.parametrize(
    ("end", "share", "rate", "falls"),
    [
        (40.0, 0.9, 0.05, True),  # 0.33 at the half, a share of exp(-0.5) from quarter to quarter
        (400.0, 0.9, 0.005, True),  # long, and the string has next to no damping
        (40.0, 0.9, 0.0, False),  # swings on
        (40.0, 0.9, 0.005, False),  # exp(-0.05) from quarter to quarter
        (100.0, 0.9, 0.1, False),  # 0.006 at the half: as good as none
    ],
)
def test_a_swing_that_falls_is_told_from_one_that_stays_and_from_one_that_is_gone(end, share, rate, falls):
    assert (dying_out(*turning(end, share, rate), PERIOD) is not None) == falls


@pytest.mark.parametrize(("end", "rate"), [(40.0, 0.05), (40.0, 0.02), (400.0, 0.005)])
def test_the_length_that_is_named_is_one_after_which_an_exponential_decay_is_faint(end, rate):
    told = dying_out(*turning(end, 0.9, rate), PERIOD)
    at_three_quarters = 0.9 * math.exp(-0.75 * rate * end)
    assert 0.9 * at_three_quarters < told.severity <= at_three_quarters
    left = 0.9 * math.exp(-0.5 * rate * told.enough)
    assert told.enough >= CYCLES * PERIOD and left < 0.06
    assert dying_out(*turning(1.05 * told.enough, 0.9, rate), PERIOD) is None


def test_a_bit_that_sticks_to_the_end_is_not_one_whose_swing_dies_out():
    time, spin = turning(40.0, 3.0, 0.02)
    assert dying_out(time, np.maximum(spin, 0.0), PERIOD) is None
    assert dying_out(time, spin, PERIOD) is not None


@pytest.mark.parametrize("phase", np.linspace(0.0, 2.0 * np.pi, 9))
def test_two_quarters_without_a_whole_swing_do_not_show_that_one_falls(phase):
    """It stays the same, rests in its troughs, and its quarters of 0.6 periods have any part of it."""
    time = np.linspace(0.0, 2.4 * PERIOD, 241)
    spin = np.maximum(10.0 + 12.0 * np.cos(2.0 * np.pi * time / PERIOD + phase), 0.0)
    assert dying_out(time, spin, PERIOD) is None


@pytest.mark.parametrize("frames", [2, 3, 4, 8])
def test_a_run_of_few_frames_does_not_show_that_a_swing_falls(frames):
    time, spin = turning(100.0, 0.9, 0.02)
    assert dying_out(time, spin, PERIOD) is not None
    few = np.linspace(0, len(time) - 1, frames).astype(int)
    assert dying_out(time[few], spin[few], PERIOD) is None


@pytest.fixture
def drillstring_(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    leave_out_pixels(monkeypatch)
    text = (DATA / "drilling.yaml").read_text(encoding="utf8").replace("elements: 24", "elements: 6")
    Path("drilling.yaml").write_text(text, encoding="utf8")
    return commands_of(Drillstring(), capsys)


def mapped(command, end, *more):
    words = ("--speed", "80,120", "--weight", "50 kN", "--jobs", "1", "--json")
    code, out, err = command("stick-slip", "drilling.yaml", *words, *(("--end", end) if end else ()), *more)
    assert code == 0
    return only_object(out), " ".join(err.replace("\u00a0", " ").split())


def test_a_short_end_gives_no_severity_where_the_bit_will_turn_steadily_and_names_the_end_that_shows_it(drillstring_):
    """Without blades, and far above the weight and below the speed at which this bit sticks, the severity is zero."""
    report, told = mapped(drillstring_, "30 s")
    assert report["severity"] == [[None, None]] and report["verdict"] == [["dying out", "dying out"]]
    assert all(0.01 < one < 0.3 for one in report["severity_so_far"][0])
    assert (
        told.count("dying out") == 3
        and "has not decayed (`dying out`): severity" in told
        and "does not stick from 80 rpm" in told
    )
    (needed,) = {math.ceil(one) for one in report["end_needed"][0]}
    assert f"--end '{needed} s'" in told
    with Path("drilling_stick_slip.csv").open(newline="", encoding="utf8") as file:
        rows = list(csv.DictReader(file))
    assert [row["verdict"] for row in rows] == ["dying out"] * 2 and float(rows[0]["end_needed [s]"]) > 90.0
    enough, told = mapped(drillstring_, f"{needed} s", "-o", "enough")
    assert enough["severity"] == [pytest.approx([0.0, 0.0], abs=0.05)] and enough["warnings"] == []
    assert enough["verdict"] == [["does not stick"] * 2] and "die" not in told


def test_an_end_of_few_periods_is_warned_of_before_the_runs_and_shows_no_swing(drillstring_):
    report, told = mapped(drillstring_, "8 s")
    (warned,) = report["warnings"]
    assert "--end: 8 s is 1.7 periods" in warned and "--end '97 s'" in warned and warned in told
    assert told.index("1.7 periods") < told.index("share of time stuck")
    assert report["severity"] == [[None, None]] and report["verdict"] == [["too short"] * 2]
    assert "too short to show how the bit turns. Give a longer --end" in told and "does not stick" not in told


def test_a_bit_that_comes_to_rest_in_a_run_of_few_periods_is_not_told_to_come_to_turn_steadily(drillstring_):
    """Run for twenty periods it sticks for a tenth of the time; the last of these 2.5 happens to be its fast part."""
    report, told = mapped(drillstring_, "12 s", "--speed", "60")
    assert report["verdict"] == [["sticks"]] and report["stuck"][0][0] > 0.0
    assert "the bit sticks up to the highest speed of all, 60 rpm" in told and "has not decayed" not in told


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_run_of_two_frames_is_told_as_one_that_shows_nothing(drillstring_):
    report, told = mapped(drillstring_, "0.05 s", "--speed", "60")
    assert report["verdict"] == [["not turning"]] and "has not begun to turn when the runs end" in told


def cell(speed, **more):
    numbers = [0.1, 0.0, 10.0, 5.0, 12.0, 4e3, 1e5, 5e-3]
    return Cell(speed * RPM, 1e5, *numbers, "done", "", 0.1)._replace(**more)


def test_a_swing_that_dies_out_is_marked_in_table_and_figure_and_its_bit_counts_as_one_that_turns():
    """Stuck in the third quarter, and no more in the last."""
    fading = cell(90, severity=math.nan, stuck=0.1, so_far=0.62, enough=96.3)
    found = Map((60 * RPM, 90 * RPM), (1e5,), ((cell(60, stuck=0.2), fading),))
    assert [list(column.cells) for column in table(found, "si").columns[2:]] == [["dying out"]]
    figure = draw(found, "two cells")
    assert "dying\nout" in [text.get_text() for text in figure.axes[0].texts]
    assert "grey: dying out" in [text.get_text() for text in figure.legends[0].get_texts()]
    texts = [text for text, _ in sentences(found, "si")]
    assert (
        "has not decayed (`dying out`) at 90 rpm: severity 0.62 at the end, and it falls. Give --end '97 s'" in texts[0]
    )
    assert "sticking ends between 60 rpm and 90 rpm" in texts[1]
