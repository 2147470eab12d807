"""Scenes go to other processes: what a function of time is made of was found in no module."""

import copy
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.scene.model import MADE

ROOT = Path(__file__).parents[2]
SCENES = sorted([*(ROOT / "data").glob("*.yaml"), *ROOT.glob("*/**/templates/**/*.yaml")])


def read_or_skip(path):
    try:
        return tautline.read(path)
    except tautline.SceneError:
        pytest.skip("is no scene by itself")


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_and_a_variant_of_it_are_the_same_after_they_were_pickled(path):
    scene = read_or_skip(path)
    for one in (scene, scene.replace({"title": "another"})):
        sent = pickle.loads(pickle.dumps(one))
        assert sent == one and type(sent) is type(one) and sent.document.root == one.document.root
        assert sent.replace({"title": "a third"}) == one.replace({"title": "a third"})


def test_a_scene_that_has_run_is_pickled_without_what_was_prepared_of_it():
    scene = tautline.read(ROOT / "data" / "hoist.yaml").replace({"solver.end": 0.1})
    whole = tautline.simulate(scene)
    sent = pickle.loads(pickle.dumps(scene))
    assert MADE in scene.__dict__ and MADE not in sent.__dict__ and copy.deepcopy(scene) == scene
    again = tautline.simulate(sent)
    assert again.attributes["model_hash"] == whole.attributes["model_hash"]
    np.testing.assert_array_equal(again["position"], whole["position"])


def test_a_pool_of_processes_simulates_a_scene():
    scene = tautline.read(ROOT / "data" / "hoist.yaml").replace({"bodies[0].mass": 6000.0})
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        found = pool.submit(tautline.simulate, scene, end=0.1).result()
    np.testing.assert_array_equal(found["position"], tautline.simulate(scene, end=0.1)["position"])


@pytest.mark.parametrize("what", ["inputs", "outputs", "parameters"])
def test_the_handles_of_a_simulation_say_what_to_pickle_in_their_place(what):
    sim = tautline.Simulation(ROOT / "data" / "hoist.yaml")
    with pytest.raises(tautline.SimulationError, match=f"{what} of a simulation cannot be pickled.*save"):
        pickle.dumps(getattr(sim, what))
