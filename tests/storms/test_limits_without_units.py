"""A limit without a unit is read in SI, and who writes other units is told so."""

from __future__ import annotations

from dataclasses import replace

import pytest
from storms.test_limits_on_forces import AT_SEA
from storms.test_operability import ALONE, SCENE, asked

import tautline
from crane.application import Crane
from crane.operability.criteria import bare_notes, read_criteria
from crane.operability.storms import operability

FIGURES = {"min_tension": "N", "safety_factor": "", "max_rise": "m", "longest_slack": "s"}
KIP = 4448.2216152605
"""N: 1000 pounds of 0.45359237 kg at 9.80665 m/s^2."""


def told_by_check(units, limits):
    scene = tautline.read(f"{AT_SEA}units: {units}\nlimits: [{limits}]\n")
    return [one.text for one in Crane().warnings(scene) if one.where == "units" and "limits[" in one.text]


@pytest.mark.parametrize("key", ["above", "below", "at_most", "at_least"])
def test_a_scene_in_field_units_is_told_in_what_unit_its_limits_without_one_are_read(key):
    (text,) = told_by_check("field", f"{{output: min_tension, {key}: 100}}")
    assert "1 limit has no unit" in text and "is read in SI" in text
    assert f"limits[0].{key} = 100 (line 14) of min_tension is 100 N" in text
    assert f"100 kip would be {100.0 * KIP / 1e3:.1f} kN" in text and "Write the unit that is meant" in text


def test_a_metric_scene_is_told_that_a_number_is_newtons_and_not_kilonewtons():
    (text,) = told_by_check("metric", "{output: 'winch.tension', above: 60, below: 5}, {output: max_rise, above: 3}")
    assert "2 limits have no unit" in text
    assert "limits[0].above = 60 (line 14) of winch.tension is 60 N, and not 60 kN" in text
    # A metre is one in metric units too.
    assert "max_rise" not in text


@pytest.mark.parametrize(
    ("units", "limits"),
    [
        ("si", "{output: min_tension, above: 100}"),
        ("metric", "{output: min_tension, above: 100 N}"),
        ("field", "{output: min_tension, below: 0}"),
        ("field", "{output: safety_factor, below: 3}"),
        ("metric", "{output: no_such_thing, below: 3}"),
    ],
)
def test_a_limit_that_can_mean_one_thing_only_is_not_warned_of(units, limits):
    assert told_by_check(units, limits) == []


@pytest.mark.parametrize(
    ("system", "other"), [("si", "'min_tension > 7 kN'"), ("metric", "'min_tension > 7 kN'"), ("field", "7 kip'")]
)
def test_a_bare_limit_on_the_command_line_says_what_it_was_read_as_and_how_to_write_it(system, other):
    (one,) = read_criteria(["min_tension  > 7"], FIGURES, {})
    assert (one.text, one.limit) == ("min_tension > 7 N", 7.0)
    (text,) = bare_notes([one], system)
    assert text.startswith("--limit 'min_tension > 7' has no unit, and was read as 7 N. Write 'min_tension > 7 N', or ")
    assert other in text
    # What is offered is read as it says.
    offered = [part for part in text.split("'") if part.startswith("min_tension > 7 ")]
    assert [read.bare for read in read_criteria(offered, FIGURES, {})] == [""] * 2


@pytest.mark.parametrize("limit", ["min_tension > 7 kN", "min_tension > 0", "safety_factor > 3"])
def test_a_limit_with_its_unit_or_with_none_to_have_stays_as_it_was_written(limit):
    (one,) = read_criteria([limit], FIGURES, {})
    assert one.text == limit and bare_notes([one], "metric") == []


def test_operability_says_before_and_after_its_runs_what_a_bare_limit_was_read_as(tmp_path):
    (tmp_path / "heave.yaml").write_text(SCENE + "limits: [{output: max_tension, above: 5}]\n")
    application = Crane()
    scene = application.read(tmp_path / "heave.yaml")
    said = []
    found = operability(
        application, scene, asked((0.3,), 3, 60.0, limits=["min_tension > 7"]), replace(ALONE, say=said.append)
    )
    assert [one.text for one in found.criteria] == ["min_tension > 7 N", "max_tension <= 5 N"]
    (text,) = (one for one in found.warnings if "no unit" in one)
    assert "'min_tension > 7'" in text and f"warning: {text}" in said
