"""The summary of a run: first what the engineer asked for, in his units, then one block on the computation."""

import json
import re
from pathlib import Path

import pytest
from cli.in_process import commands_of

from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose

DATA = Path(__file__).parents[2] / "data"
NUMBERS = ["method", "step", "steps", "Newton iterations per step", "simulated time", "wall time"]
NUMBERS += ["total time of the command", "real-time factor"]
CASES = {
    "crane": (Crane, "hoist", "0.2", "largest tension (", r"\d N\b|\d MN\b|\brad\b"),
    "string": (Drillstring, "jwell", "0.2", "hook load at the start", r"\d MN\b|\blump\b|\bbody \d|\blink \d"),
    "hose": (Gardenhose, "hose", "0.02", "type of motion", r"\brad\b"),
}


@pytest.fixture
def summary(tmp_path, monkeypatch, capsys):
    """Run a shipped scene in a system of units; returns the lines of its summary and the JSON object."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")

    def made(case, units):
        application, name, end, *_ = CASES[case]
        text = (DATA / f"{name}.yaml").read_text(encoding="utf8")
        Path("scene.yaml").write_text(f"units: {units}\n{text}", encoding="utf8")
        code, out, err = commands_of(application(), capsys)("simulate", "scene.yaml", "--end", end, "--json")
        assert code == 0, err
        return [line.rstrip() for line in err.splitlines()], json.loads(out)

    return made


@pytest.mark.parametrize("case", CASES)
def test_it_begins_with_what_was_asked_and_ends_with_the_numbers_of_the_computation(case, summary):
    lines, _ = summary(case, "si")
    first = next(i for i, line in enumerate(lines) if line.startswith(CASES[case][3]))
    blank = next(i for i in range(first, len(lines)) if not lines[i])
    assert all("real-time" not in line and "method" not in line for line in lines[first:blank])
    heads = [re.split(r"  +", line)[0] for line in lines[blank + 1 :]]
    assert heads[: len(NUMBERS)] == NUMBERS
    assert not any(head in NUMBERS for head in heads[len(NUMBERS) :])


@pytest.mark.parametrize("case", CASES)
def test_metric_units_are_those_of_the_summary_and_the_json_stays_si(case, summary):
    si = summary(case, "si")[1]
    lines, metric = summary(case, "metric")
    first = next(i for i, line in enumerate(lines) if line.startswith(CASES[case][3]))
    blank = next(i for i in range(first, len(lines)) if not lines[i])
    asked = "\n".join(lines[first:blank])
    assert " kN" in asked or case == "hose"
    assert not re.search(CASES[case][4], asked.replace(" 0 N", "").replace("m = 5", "")), asked
    times = {"wall_time", "total_time", "real_time_factor", "cpu_time"}
    same = {key for key in si if isinstance(si[key], float)} - times
    assert {key: si[key] for key in same} == {key: metric[key] for key in same}


def test_warnings_of_a_crane_are_in_the_units_of_its_scene(summary, tmp_path):
    text = (DATA / "hoist.yaml").read_text(encoding="utf8").replace("1.1 MN", "90 kN")
    assert "90 kN" in text

    def said(units):
        scene = tmp_path / f"{units}.yaml"
        scene.write_text(f"units: {units}\n{text}", encoding="utf8")
        crane = Crane()
        (found,) = [one.text for one in crane.warnings(crane.read(scene)) if one.where == "rope.breaking_load"]
        return found

    assert " kN is " in said("si") and " kip is " in said("field") and " kN is " in said("metric")
