"""Verbs besides `simulate`: what a sweep collects of them is what they find, and their options are theirs."""

import pytest

import tautline
from tautline.scene.errors import SceneError


def test_shapes_at_rest_of_a_sweep_are_those_of_static_along_speed():
    from gardenhose.static import forms

    scene = tautline.read("data/hose.yaml")
    vary = {"gravity": [[0, 0, -9.81], [0, 0, -5.0]]}
    data = tautline.sweep(scene, vary, collect=["tip_z"], verb="static", options={"speed": "0,2"}, jobs=1)
    assert data["tip_z"].dims == ("gravity", "speed") and list(data["speed"].values) == [0.0, 2.0]
    for k, g in enumerate((-9.81, -5.0)):
        found = forms(scene.replace({"gravity": [0, 0, g]}), [0.0, 2.0])
        assert data["tip_z"].values[k].tolist() == [float(one.tip[2]) for one in found]


def test_flutter_of_a_sweep_is_that_of_the_verb():
    from gardenhose.flutter import stability

    scene = tautline.read("data/hose.yaml").replace({"hose.elements": 5})
    vary, collect = {"gravity": [[0, 0, -5.0]]}, ["critical_speed", "kind"]
    data = tautline.sweep(scene, vary, collect=collect, verb="flutter", options={"modes": 4}, jobs=1)
    first = stability(scene.replace({"gravity": [0, 0, -5.0]}), None, 4).critical[0]
    assert data["critical_speed"].item() == first.speed and data["kind"].item() == first.kind
    assert data["critical_speed"].attrs["units"] == "m/s"


def test_frequencies_of_a_sweep_are_those_of_the_campbell_diagram():
    from drillstring.modes.campbell import campbell
    from drillstring.verbs.campbell import read_options

    scene = tautline.read("data/whirl.yaml")
    options = {"modes": "lateral", "speed": "0:120"}
    data = tautline.sweep(scene, {"bit.weight": ["10 kN"]}, collect=["frequency", "first_critical_speed"],
                          verb="campbell", options=options, jobs=1)  # fmt: skip
    varied = scene.replace({"bit.weight": "10 kN"})
    found = campbell(varied, *read_options(varied, options)[1:])
    assert data["frequency"].values[0].tolist() == [mode.frequency for mode in found.modes]
    assert data["first_critical_speed"].item() == min(one.speed for one in found.critical)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"deph": "1000"}, "torque-drag has no such option; did you mean 'depth'"),
        ({"depth": "3000:1000:500"}, "ends above where it begins"),
        ({"friction": "0.2,0.3"}, "vary well.wall.friction"),
        ({"elements": "many"}, "whole number"),
    ],
)
def test_an_option_that_the_verb_cannot_read_is_refused_before_anything_runs(options, said):
    with pytest.raises(SceneError, match="options") as error:
        tautline.sweep("data/jwell.yaml", {"well.wall.friction": [0.2]}, verb="torque-drag", options=options, jobs=1)
    assert said in str(error.value)


def test_simulate_takes_no_options_in_a_sweep_and_other_verbs_no_outputs():
    with pytest.raises(SceneError, match="simulate takes none"):
        tautline.sweep("data/jwell.yaml", {"well.wall.friction": [0.2]}, options={"depth": "1000"})
    with pytest.raises(SceneError, match="no outputs over time"):
        tautline.sweep(
            "data/jwell.yaml", {"well.wall.friction": [0.2]}, "grid", [{"output": "top.force"}], verb="torque-drag"
        )


@pytest.mark.parametrize(("step", "sets"), [("2 ms", True), ([1, 2], False)])
def test_an_option_of_simulate_with_several_values_is_one_to_vary_and_none_to_set(step, sets):
    with pytest.raises(SceneError, match=r"vary solver\.step of the scene") as error:
        tautline.sweep("data/hoist.yaml", {"solver.end": ["1 s"]}, collect=["max_tension"], options={"step": step})
    assert ("--set 'solver.step=2 ms'" in str(error.value)) is sets
    assert ("--set" in str(error.value)) is sets


def test_places_that_differ_from_case_to_case_are_kept_with_each_case():
    # By default the speeds go up to that of the scene: the n-th is another one in each case.
    data = tautline.sweep(
        "data/hose.yaml", {"water.speed.ramp.to": [20.0, 35.0]}, collect=["tip_x"], verb="static", jobs=1
    )
    assert data["tip_x"].dims == data["speed"].dims == ("water.speed.ramp.to", "speed number")
    assert data["speed"].values[:, -1].tolist() == [20.0, 35.0]
    same = tautline.sweep(
        "data/hose.yaml", {"water.speed.ramp.to": [20.0, 35.0]}, collect=["tip_x"], verb="static",
        options={"speed": "5,10"}, jobs=1,
    )  # fmt: skip
    assert same["tip_x"].dims == ("water.speed.ramp.to", "speed") and same["speed"].values.tolist() == [5.0, 10.0]
