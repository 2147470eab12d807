"""Functions of a rig's twin take a scene as others do, from a path, a text or a dict, and refuse in a sentence."""

from pathlib import Path

import numpy as np
import pytest
import yaml

import tautline
from drillstring.twin.records import Connecting, connections, write
from drillstring.twin.stands import bit_depth, with_stand
from drillstring.twin.sticking_limit import sticking_limit
from drillstring.twin.torsional_line import line_of
from tautline.errors import ArgumentError, ArgumentTypeError
from tautline.scene.errors import SceneError

DATA = Path(__file__).parents[3] / "data"
WELL = """
title: A collar
well: {diameter: 8.5 in, sections: [{hold: 300 m}], wall: {stiffness: 1.0e+7, damping: 1.0e+4, friction: 0.2}}
string: [{name: collar, length: rest, od: 0.165, id: 0.0572}]
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
model: {kind: lumped, elements: 2}
top: {block: {velocity: 0.0}, rotation: 0}
solver: {method: generalized-alpha, step: 10 ms, end: 1 s}
output: {interval: 100 ms}
"""
HOW = Connecting(travel=0.2, turning=0.2, ramp=0.1, rest=0.1, in_slips=0.5, transfer=0.2)


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    path = tmp_path_factory.mktemp("rig") / "well.yaml"
    path.write_text(WELL, encoding="utf8")
    return [tautline.read(WELL), path, str(path), WELL, yaml.safe_load(WELL)]


def test_a_record_of_connections_is_the_same_from_a_scene_a_path_a_text_and_a_dict(sources):
    first, *others = [connections(source, 1, HOW) for source in sources]
    for other in others:
        assert all(np.array_equal(values, other[name]) for name, values in first.items())


def test_functions_of_stands_and_torsion_take_paths_texts_and_dicts(sources):
    for source in sources:
        assert bit_depth(source) == 300.0 and bit_depth(with_stand(source, 28.0)) == 328.0
        assert line_of(source).frequency == line_of(sources[0]).frequency
        assert "bit.torque" in sticking_limit(source, line_of(source), 1e4, 8.0)


@pytest.mark.parametrize("of", [connections, bit_depth, line_of, lambda x: with_stand(x, 28.0)])
def test_what_is_no_scene_of_a_drill_string_is_refused_in_a_sentence(of):
    with pytest.raises(SceneError, match="there is no such file"):
        of("nowhere.yaml")
    with pytest.raises(ArgumentTypeError, match="a dict is wanted, not int"):
        of(3)
    with pytest.raises(ArgumentTypeError, match="the scene of a drill string is wanted, not CraneScene"):
        of(DATA / "hoist.yaml")


@pytest.mark.parametrize(("given", "error", "told"), [
    ({"count": 0}, ArgumentError, "count = 0: a whole number from 1 on"),
    ({"count": "2"}, ArgumentTypeError, "count = '2'"),
    ({"rate": 0.0}, ArgumentError, "rate = 0.0: a finite number above zero"),
    ({"how": {"stand": 3.0}}, ArgumentTypeError, "a Connecting"),
    ({"noise": {"hookload": 0.1}}, ArgumentError, "there is no 'hookload'; give some of time"),
    ({"noise": {"hook_load": -0.1}}, ArgumentError, "a mapping of columns to shares"),
    ({"seed": -1}, ArgumentError, "a whole number from 0 on"),
    ({"seed": 1.5}, ArgumentTypeError, "a Generator of numpy, or None"),
])  # fmt: skip
def test_other_arguments_of_a_record_that_are_none_are_refused_by_name(sources, given, error, told):
    with pytest.raises(error, match=told):
        connections(sources[0], **given)


def test_the_noise_of_a_record_is_that_of_a_number_or_a_generator_and_another_each_time_without(sources):
    def load(seed):
        return connections(sources[0], 1, HOW, seed=seed)["hook_load"]

    assert np.array_equal(load(7), load(np.random.default_rng(7)))
    goes_on = np.random.default_rng(7)
    assert not np.array_equal(load(goes_on), load(goes_on)) and not np.array_equal(load(None), load(None))


def test_a_record_is_written_from_a_mapping_to_a_path_alone(tmp_path):
    with pytest.raises(ArgumentTypeError, match="columns = "):
        write([1.0], tmp_path / "rig.csv")
    with pytest.raises(ArgumentTypeError, match="path = 3"):
        write({"time": np.zeros(2)}, 3)
    assert not list(tmp_path.iterdir())
