"""Wrong arguments from Python are refused in plain words by an error of this package, and name no option."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline import ArgumentError, ArgumentTypeError, Grid, SimulationError

SCENE = tautline.read(Path(__file__).parents[2] / "data" / "hoist.yaml")
VARY = {"bodies[0].mass": [4000.0]}
WRONG = {
    "grid": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, grid=3)),
    "steps below zero": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(steps=[-1]))),
    "steps": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, grid=Grid(steps="x"))),
    "elements": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(elements=[0]))),
    "methods": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(methods=["x"]))),
    "newton": (ArgumentError, lambda: tautline.study_errors(SCENE, grid=Grid(newton=["x"]))),
    "repetitions": (ArgumentError, lambda: tautline.study_errors(SCENE, repetitions=0)),
    "repetitions of a text": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, repetitions="x")),
    "budget": (ArgumentError, lambda: tautline.study_errors(SCENE, budget=-1)),
    "reference": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, reference="x")),
    "'foo'": (ArgumentTypeError, lambda: tautline.study_errors(SCENE, foo=1)),
    "budget of stability": (ArgumentTypeError, lambda: tautline.study_stability(SCENE, budget="x")),
    "quick": (ArgumentTypeError, lambda: tautline.study_stability(SCENE, quick="x")),
    "vary": (ArgumentTypeError, lambda: tautline.sweep(SCENE, None)),
    "vary of a number": (ArgumentTypeError, lambda: tautline.sweep(SCENE, 3)),
    "collect": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, collect=3)),
    "jobs": (ArgumentError, lambda: tautline.sweep(SCENE, VARY, jobs=0)),
    "jobs of a text": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, jobs="x")),
    "options": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, options=3)),
    "folder": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, folder=3)),
    "progress": (ArgumentTypeError, lambda: tautline.sweep(SCENE, VARY, progress=3)),
    "resume": (ArgumentError, lambda: tautline.sweep(SCENE, VARY, resume=True)),
    "changes": (ArgumentTypeError, lambda: SCENE.replace(None)),
    "changes of a list": (ArgumentTypeError, lambda: SCENE.replace([])),
    "folder of a text": (ArgumentTypeError, lambda: tautline.read("a: 1\nb: 2", folder=3)),
    "path": (ArgumentTypeError, lambda: tautline.simulate(SCENE, path=3)),
    "progress of a run": (ArgumentTypeError, lambda: tautline.simulate(SCENE, progress=3)),
    "resume of a run": (ArgumentTypeError, lambda: tautline.simulate(SCENE, resume="x")),
    "simulations": (ArgumentTypeError, lambda: tautline.rollout([3], until=1.0)),
}


@pytest.mark.parametrize("what", WRONG)
def test_an_argument_that_cannot_be_is_refused_by_its_name(what):
    error, call = WRONG[what]
    with pytest.raises(error, match=what.split(" ")[0]) as refused:
        call()
    assert "--" not in str(refused.value)


def test_a_point_that_there_is_not_is_refused_by_the_name_of_the_argument():
    with pytest.raises(tautline.ResultError, match="argument point: nothing is called 'nosuch'"):
        tautline.study_errors(SCENE, end=0.1, point="nosuch")


@pytest.fixture(scope="module")
def sim():
    return tautline.Simulation(SCENE)


@pytest.mark.parametrize("on", [[0.5], [True], [0, 0], ["a"], [10**30], 3, [-1], []], ids=str)
def test_what_names_no_degrees_of_freedom_is_refused(sim, on):
    with pytest.raises(SimulationError):
        sim.add_force(lambda t, q, v: np.zeros(len(q)), on=on)


def test_what_is_no_name_is_none_of_the_names(sim):
    result = sim.result
    for name in ([1], np.array([1]), None, 3):
        for names in (result, sim, sim.outputs, sim.inputs, sim.parameters):
            assert name not in names
        with pytest.raises(tautline.ResultError, match="has no variable"):
            result[name]
        with pytest.raises(tautline.UnknownName, match="there is no input"):
            sim.inputs[name] = 0.0
    assert list(sim) == list(sim.outputs) and "payload.position" in sim


def test_simulations_may_come_one_after_the_other(sim):
    copies = [sim.copy() for _ in range(2)]
    tautline.rollout((one for one in copies), until=0.1)
    assert [one.time for one in copies] == [0.1, 0.1]
    with pytest.raises(ArgumentTypeError, match="list of simulations"):
        tautline.rollout(sim, until=0.2)
