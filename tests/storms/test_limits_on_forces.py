"""A limit on a force or a place is on one number: the largest of its components says nothing."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import tautline
from crane.application import Crane
from crane.operability.criteria import read_criteria
from tautline.live.readings import handles_of
from tautline.scene.errors import SceneError

AT_SEA = """
title: Load on a hook
rope: {mass_per_length: 1 kg/m, axial_stiffness: 20 MN, damping: 10 ms, diameter: 24 mm, breaking_load: 400 kN}
bodies:
  - {name: load, mass: 5 t, position: [10.2, 0, 0]}
path:
  - drum: {name: winch, center: [0, 0, 10], radius: 0.4, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [10, 0, 20], radius: 0.2, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: load}
mesh: {elements_per_span: 1}
solver: {step: 50 ms, end: 1 s}
output: {interval: 100 ms}
"""
FALLS = """
title: Two falls
rope: {mass_per_length: 6.5, axial_stiffness: 80 MN, diameter: 36 mm, breaking_load: 1.1 MN}
bodies:
  - {name: block, mass: 5 t, position: [12.75, 0, 5]}
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5 m, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4 m, axis: [0, 1, 0], wrap: over}
  - sheave: {name: hook sheave, body: block, radius: 0.35 m, axis: [0, 1, 0], wrap: under}
  - anchor: {name: dead end, position: [13.1, 0, 30]}
mesh: {elements_per_span: 1}
solver: {step: 20 ms, end: 1 s}
output: {interval: 100 ms}
"""


def read(text):
    scene = tautline.read(text)
    model = Crane().build(scene)
    return SimpleNamespace(scene=scene, model=model, handles=handles_of(model), figures=dict(model.figure_units))


@pytest.fixture(scope="module")
def at_sea():
    return read(AT_SEA)


def criteria(found, *limits):
    return read_criteria(limits, found.figures, found.handles.outputs, found.handles.instead)


def refused(found, limit):
    with pytest.raises(SceneError) as error:
        criteria(found, limit)
    return str(error.value)


@pytest.mark.parametrize("name", ["sheave_load", "tip.force", "sheave_load[0]"])
@pytest.mark.parametrize("bound", ["< 60 kN", "> 1 kN"])
def test_a_limit_on_a_force_vector_is_refused_and_the_figure_of_its_size_is_offered(at_sea, name, bound):
    told = refused(at_sea, f"{name} {bound}")
    assert "has several components" in told and "name max_sheave_load" in told
    whole = name.partition("[")[0]
    first = "sheave_load[0,0]" if whole == "sheave_load" else "tip.force[0]"
    assert f"{first} is the first" in told
    # What is offered is accepted.
    assert [one.name for one in criteria(at_sea, "max_sheave_load < 60 kN", f"{first} < 60 kN")][1] == first


@pytest.mark.parametrize("name", ["position", "body_position", "load.position", "body_velocity", "load.velocity"])
def test_a_limit_on_a_place_or_a_velocity_of_three_numbers_is_refused(at_sea, name):
    assert "has several components" in refused(at_sea, f"{name} < 15")


@pytest.mark.parametrize(
    ("limit", "said", "accepted"),
    [
        ("sheave_load[0,0,0] < 1 kN", "write sheave_load[0,0]", "sheave_load[0,0] < 1 kN"),
        ("sheave_load[4,0] < 1 kN", "has 1 of these: count from 0 to 0", "sheave_load[0,0] < 1 kN"),
        ("tip.force[3] < 1 kN", "has 3 of these: count from 0 to 2", "tip.force[2] < 1 kN"),
        ("tension[0,2] < 1 kN", "has 2 of these: count from 0 to 1", "tension[0,1] < 1 kN"),
        ("min_tension[0] < 1 kN", "is one number: write min_tension", "tension[1] < 1 kN"),
    ],
)
def test_indices_that_an_output_has_not_are_told_with_a_cure_that_is_accepted(at_sea, limit, said, accepted):
    found = SimpleNamespace(handles=at_sea.handles, figures={})
    told = refused(found, limit)
    for part in said.split(": "):
        assert part in told
    assert f"there is no {limit.partition(' <')[0]}" in told
    assert criteria(at_sea, accepted)[0].text == accepted


def test_a_scene_and_the_command_refuse_the_same_limits_by_one_rule(at_sea):
    names = [*at_sea.handles.outputs, "sheave_load[0]", "position[0]", "body_position[0,2]"]
    # Of these it is known by hand whether they are one number.
    known = {"tip.force[2]": True, "tension[1]": True, "tip.force": False, "load.position": False}
    taken = {}
    for name in [*names, *known]:
        scene = at_sea.scene.replace({"limits": [{"output": name, "above": 1e9}]})
        try:
            Crane().build(scene)
            accepted = True
        except SceneError:
            accepted = False
        try:
            criteria(at_sea, f"{name} < 1e9")
            by_the_command = True
        except SceneError:
            by_the_command = False
        assert accepted == by_the_command, name
        taken[name] = accepted
    assert {name: taken[name] for name in known} == known


@pytest.mark.parametrize("statistic", ["max", "min", "mean"])
def test_a_sweep_refuses_a_statistic_of_a_force_vector_and_offers_its_size(statistic):
    collect = [{"output": "tip.force", "statistic": statistic}]
    with pytest.raises(tautline.SceneError, match=r"no single number.*several components.*max_sheave_load"):
        tautline.sweep(tautline.read(AT_SEA), {"bodies[0].mass": ["5 t"]}, collect=collect, jobs=1)


def test_a_sweep_collects_components_by_index_and_the_largest_of_the_places_that_are_left():
    mass, g = 5000.0, 9.81
    collect = [
        "max_sheave_load", {"output": "tip.force[2]", "statistic": "min", "name": "down"},
        {"output": "sheave_load[0,0]", "statistic": "min", "name": "aside"},
        {"output": "tension[1]", "statistic": "max", "name": "fall"},
        {"output": "tension[1,1]", "statistic": "max", "name": "hook"},
    ]  # fmt: skip
    data = tautline.sweep(tautline.read(AT_SEA), {"bodies[0].mass": [f"{mass} kg"]}, collect=collect, jobs=1)
    weight = mass * g
    # The rope comes up from the larger drum at 45 deg, less what the radii differ, and goes plumb down.
    line = np.hypot(10.0, 10.0)
    lean = np.arctan2(10.0, 10.0) - np.arcsin((0.4 - 0.2) / line)
    assert data["down"].item() == pytest.approx(-weight * (1.0 + np.sin(lean)), rel=0.01)
    assert data["aside"].item() == pytest.approx(-weight * np.cos(lean), rel=0.01)
    assert data["max_sheave_load"].item() == pytest.approx(np.hypot(data["down"], data["aside"]).item(), rel=1e-3)
    assert data["hook"].item() == pytest.approx(weight, rel=1e-3)
    # Its upper end bears 20 m of rope besides.
    assert data["fall"].item() == pytest.approx(weight + 20.0 * g, rel=1e-3)


@pytest.mark.parametrize("word", ["hook_load", "Hook load", "hook-load"])
@pytest.mark.parametrize(("text", "offered"), [(AT_SEA, "tension[1]"), (FALLS, "tension[1], tension[2]")])
def test_who_names_the_hook_load_is_told_the_outputs_at_the_hook_and_not_the_load_of_a_sheave(word, text, offered):
    found = read(text)
    told = refused(found, f"{word} < 12 kN")
    assert f"name {offered}" in told and "did you mean" not in told
    with pytest.raises(SceneError) as error:
        Crane().build(found.scene.replace({"limits": [{"output": word, "above": "12 kN"}]}))
    assert f"name {offered}" in str(error.value)
    assert ("hook sheave.force[2]" in told) is (text is FALLS)
    assert criteria(found, *(f"{name} < 12 kN" for name in offered.split(", ")))
