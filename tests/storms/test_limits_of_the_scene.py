"""Storms are judged by the limits of a scene as a run of it is: by the same side, and at equality."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import tautline
from crane.application import Crane
from crane.operability.allowable import BELOW, allowable
from crane.operability.conditions import Condition
from crane.operability.criteria import limits_of_scene, read_criteria
from crane.operability.storms import Asked, operability
from tautline.live.readings import handles_of
from tautline.results.assessment.bounds import judge
from tautline.sweeps.execution import Execution

SCENE = """
title: Load on a rope under a tip that heaves
rope: {mass_per_length: 0.01, axial_stiffness: 4.0e8, damping: 2.0e-3, diameter: 36 mm, breaking_load: 1.1 MN}
bodies:
  - {name: load, mass: 5 t, position: [0, 0, 0]}
path:
  - anchor: {name: tip, position: [0, 0, 10]}
  - end: {name: hook, body: load}
mesh: {elements_per_span: 1}
vessel:
  reference: [0, 0, 0]
  motion: {heave: {spectrum: {significant_height: 1, peak_period: 8 s, seed: 1, rao: 0.8, components: 100}}}
solver: {step: 50 ms, end: 100 s}
output: {interval: 50 ms}
"""
UPPER, LOWER = 60.0e3, 4.0e3
BOUNDS = {"above": "60 kN", "at_most": "60 kN", "below": "4 kN", "at_least": "4 kN"}
KEYS = [
    ("above",), ("at_most",), ("below",), ("at_least",), ("above", "below"), ("above", "at_least"),
    ("at_most", "below"), ("at_most", "at_least"),
]  # fmt: skip


@pytest.fixture(scope="module")
def scene():
    return tautline.read(SCENE)


def limited(scene, *limits):
    return scene.replace({"limits": list(limits)})


def criteria_of(scene):
    model = Crane().build(scene)
    handles = handles_of(model)
    return read_criteria(limits_of_scene(scene), dict(model.figure_units), handles.outputs, handles.instead), model


@pytest.mark.parametrize("value", [3.9e3, LOWER, 30.0e3, UPPER, 61.0e3])
@pytest.mark.parametrize("keys", KEYS, ids="-".join)
def test_a_figure_breaks_a_limit_of_the_scene_in_storms_where_it_fails_a_run(scene, keys, value):
    bounded = limited(scene, {"output": "equivalent_tension_range"} | {key: BOUNDS[key] for key in keys})
    criteria, model = criteria_of(bounded)
    headline = {"equivalent_tension_range": {"value": value}}
    run = judge(model.bounds, SimpleNamespace(time=np.array([0.0, 1.0])), headline)
    passed = [record["passed"] for record in run]
    assert [not one.broken_by(value) for one in criteria] == passed
    # The sea is allowed by the same rule, of storms that all come to that value.
    height, same = np.array([1.0]), np.ones(3)
    found = [
        allowable(height, *(one.way * value * same[:, None]), one.way * one.limit, 1.0, one.strict) for one in criteria
    ]
    assert [one.height == 1.0 for one in found] == passed
    # By hand: what is at its bound has kept it.
    upper = any(key in keys for key in ("above", "at_most"))
    lower = any(key in keys for key in ("below", "at_least"))
    assert all(passed) == ((not upper or value <= UPPER) and (not lower or value >= LOWER))


@pytest.mark.parametrize("key", ["above", "at_most"])
def test_no_sea_is_allowed_in_which_the_rope_is_overloaded_all_the_time(scene, key):
    # The load hangs with 49 kN on a rope that may bear 4 kN.
    overloaded = limited(scene, {"output": "tension", key: "4 kN"})
    asked = Asked([Condition(0.5, 8.0, None)], range(1, 4), 10.0, 10.0, (), lead=5.0)
    found = operability(Crane(), overloaded, asked, Execution(jobs=1))
    one = found.table.allowable[0, 0, 0]
    assert (one.height, one.bound) == (0.0, BELOW)


def test_no_slack_keeps_a_limit_of_the_scene_that_fails_above_none(scene):
    criteria, _ = criteria_of(limited(scene, {"output": "slack_events", "above": 0}))
    (one,) = criteria
    assert one.text == "slack_events <= 0" and not one.broken_by(0.0) and one.broken_by(1.0)
    # What is typed keeps its own meaning.
    (typed,) = read_criteria(["slack_events < 0"], {"slack_events": ""}, {})
    assert typed.broken_by(0.0)
