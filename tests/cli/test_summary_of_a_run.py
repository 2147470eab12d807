"""The summary of a run: first what the engineer asked for, in his units, then one block on the computation."""

import json
import math
import re
from pathlib import Path

import pytest
from cli.in_process import commands_of

from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.cli.output.summary import limit_said, table

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


def test_a_lift_is_summed_up_in_what_tells_something_new_and_the_json_has_all(summary):
    """A crate on a hook took 24 rows and 8 of limits: each tension at each place, and each rise three times."""
    lines, report = summary("crane", "si")
    first = next(i for i, line in enumerate(lines) if line.startswith("largest tension ("))
    asked = lines[first : next(i for i in range(first, len(lines)) if not lines[i])]
    assert len(asked) <= 22, asked
    told = "\n".join(asked)
    for once in (
        "largest tension (",
        "fleet angle at a sheave",
        "sidelead",
        "D/d",
        "safety factor",
        "rise of",
        "largest power of",
    ):
        assert told.count(once) == 1, once
    assert not re.search(r"rainflow|largest displacement|stretch| 0 deg.*t = 0 s|at 0 s\) +0 ", told)
    everything = {"max_tension_winch", "max_tension_hook", "tension_cycles", "max_rise", "max_displacement"}
    assert everything | {"mean_winch_power", "energy_hoisted", "max_fleet_angle", "max_sidelead"} <= report.keys()
    assert {"strain", "least_stretch", "breaking_load"} <= {record["name"] for record in report["limits"]}


def test_a_run_without_figures_begins_with_no_empty_line():
    report = dict.fromkeys(["method", "step", "steps", "newton_iterations", "simulated_time", "wall_time"])
    report |= {"total_time": 1.0, "real_time_factor": None, "energy_error": None}
    found = table(report, {}, {})
    assert found.row_count == 7 and "method" in str(next(iter(found.columns[0].cells)))


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


def test_a_limit_on_what_is_nowhere_more_than_0_names_no_place_and_no_time_and_another_does():
    record = {
        "sense": "at most",
        "unit": "rad",
        "limit": 0.1,
        "value": 0.0,
        "passed": True,
        "time": 0.0,
        "place": "tip",
    }
    assert limit_said(record) == "0 deg, at most 5.73 deg"
    assert limit_said(record | {"value": 0.05, "time": 3.2}).endswith("(tip, t = 3.2 s)")
    slack = record | {"sense": "at least", "unit": "N", "limit": 1.0, "passed": False}
    assert limit_said(slack).endswith("must be at least 1 N (tip, t = 0 s)")


def test_a_value_that_fails_its_limit_by_little_is_printed_with_the_digits_that_tell_them_apart():
    pound, kip = 4.4482216152605, 4448.2216152605
    record = {"sense": "at most", "unit": "N", "limit": 136.9 * kip, "value": 136.9 * kip + 3.4 * pound}
    record |= {"passed": False, "time": 2.0, "place": ""}
    assert limit_said(record, "field") == "136.903 kip: must be at most 136.9 kip (t = 2 s)"
    assert limit_said(record | {"passed": True, "value": 136.9 * kip - 3.4 * pound}, "field").startswith(
        "136.9 kip, at"
    )
    assert limit_said(record | {"value": 150.0 * kip}, "field").startswith("150 kip: must be at most 136.9 kip")
    unjudged = record | {"passed": None, "value": None, "note": "no frame"}
    assert limit_said(unjudged, "field") == "at most 136.9 kip is not judged: no frame"


def test_an_angle_of_two_millimetres_in_a_kilometre_is_not_printed_to_four_digits():
    """A landing had an offlead of 4.677e-06 deg: neither Newton's tolerance nor the step changes it, so it is no 0."""
    report = dict.fromkeys(["method", "step", "steps", "newton_iterations", "simulated_time", "wall_time"])
    report |= {"total_time": 1.0, "real_time_factor": None, "energy_error": None}
    for value, said in ((8.162e-8, "less than 0.0001 deg"), (0.0, "0 deg"), (math.radians(2e-4), "0.0002 deg")):
        found = table(report, {}, {"max_offlead": {"value": value, "unit": "rad", "text": "largest offlead"}})
        assert str(next(iter(found.columns[1].cells))) == said
    record = {"sense": "at most", "unit": "rad", "limit": 0.1, "value": 1e-8, "passed": True, "time": 1.0, "place": ""}
    assert limit_said(record) == "less than 0.0001 deg, at most 5.73 deg (t = 1 s)"


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
