"""``scene.replace``: another scene by the names of keys, validated as if its file said so."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from drillstring.model.prepared import prepared, well_of
from tautline.cable.input.parts import CableScene
from tautline.scene.reading.document import Document

DATA = Path(__file__).parents[3] / "data"


def read(name):
    return tautline.read(DATA / f"{name}.yaml")


def refusal(scene, changes):
    with pytest.raises(tautline.SceneError) as error:
        scene.replace(changes)
    return error.value.problems[0]


def test_values_are_replaced_by_dotted_names_with_indices_and_the_scene_that_was_changed_stays_as_it_is():
    scene = read("hoist")
    before = scene.model_dump()
    other = scene.replace({"bodies[0].mass": "6 t", "solver.step": "2 ms", "gravity[2]": -1.6, "title": "moon"})
    assert (other.bodies[0].mass, other.solver.step, other.gravity[2], other.title) == (6000.0, 0.002, -1.6, "moon")
    assert scene.model_dump() == before and scene.bodies[0].mass == 5000.0
    assert {key for key in before if other.model_dump()[key] != before[key]} == {"bodies", "solver", "gravity", "title"}


def test_numbers_lists_and_mappings_replace_and_a_key_that_the_file_leaves_out_can_be_given():
    scene = read("hoist")
    other = scene.replace(
        {
            "path[0].drum.pay_out": {"ramp": {"to": "-3 m/s", "over": 4}},
            "bodies[0].position": np.array([12.0, 0.0, 1.0]),
            "solver.tolerance": 1e-9,
            "mesh": {"elements_per_span": 2},
        }
    )
    assert other.drums[0].pay_out.to == -3.0 and other.bodies[0].position == (12.0, 0.0, 1.0)
    assert other.solver.tolerance == 1e-9 and other.elements == (2, 2)


@pytest.mark.parametrize(
    ("changes", "key", "cause", "cure"),
    [
        ({"bodies[0].mas": 6}, "bodies[0].mas", "unknown key", "did you mean 'mass'?"),
        ({"solvr.step": 1}, "solvr", "unknown key", "did you mean 'solver'?"),
        ({"path[0].drumm.radius": 1}, "path[0]", "'drumm' stands beside drum", "did you mean 'drum'?"),
        ({"vessel.motion.heave.harmonc": {}}, "vessel.motion.heave", "'harmonc' stands beside", "'harmonic'?"),
        ({"bodies[7].mass": 6}, "bodies[7]", "there is no such entry", "counted from 0"),
        ({"bodies.mass": 6}, "bodies.mass", "this is a list", "the first by [0]"),
        ({"rope[0]": 6}, "rope[0]", "is a mapping, not a list", "mass_per_length"),
        ({"title.short": 6}, "title.short", "there is no such key", "check the name"),
        ({"solver.step": "2 m"}, "solver.step", "'m' is not the unit of a time", "1 ms"),
        ({"solver.step": float("nan")}, "solver.step", "is not a finite number", "1 ms"),
        ({"bodies[0].mass": True}, "bodies[0].mass", "true and false are not numbers", "give a mass"),
        ({"bodies[0].mass": None}, "bodies[0].mass", "is empty", "give a mass"),
        ({"start": "statc"}, "start", "is not known here", "did you mean 'static'? It must be static or as drawn"),
    ],
)
def test_what_cannot_be_is_refused_by_key_cause_and_cure_and_names_what_gave_it(changes, key, cause, cure):
    problem = refusal(read("hoist"), changes)
    assert (problem.file, problem.line, problem.key) == ("replace", None, key)
    assert cause in problem.cause and cure in problem.cure


@pytest.mark.parametrize("name", ["", ".", "bodies[0", "bodies[].mass", "bodies[-1].mass", "a..b", "a.", " a", 3])
def test_what_is_no_name_of_a_key_is_refused(name):
    problem = refusal(read("hoist"), {name: 1})
    assert problem.cause == "is no name of a key" and problem.value == str(name)


def test_a_value_that_contradicts_another_is_refused_where_the_other_stands_too():
    problem = refusal(read("jwell"), {"string[1].od": "0.3 m"})
    assert (problem.file, problem.key) == ("replace", "string[1].od") and "does not fit into the hole" in problem.cause
    other = refusal(read("jwell"), {"well.diameter": "0.1 m"})
    assert other.key == "string[0].od" and other.line == read("jwell").document.line("string[0].od")


def test_cable_scenes_of_the_thesis_are_changed_by_the_keys_of_their_file():
    scene = read("cantilever_bar")
    other = scene.replace({"GeneralizedAlpha.time_step": "2 ms", "CableModelMaterial.Gravity": [0, 0, -1.62]})
    assert isinstance(other, CableScene)
    assert (other.solver.step, other.gravity) == (0.002, (0.0, 0.0, -1.62)) and scene.solver.step != 0.002
    place = next(i for i, item in enumerate(scene.document.root["CableModel"]) if "Node7Dof" in item)
    moved = scene.replace({f"CableModel[{place}].Node7Dof.xyz[2]": 0.25})
    assert moved.nodes[0].position[2] == 0.25
    problem = refusal(scene, {f"CableModel[{place}].Node7Dof.xzy": [0, 0, 0]})
    assert problem.file == "replace" and problem.cure == "did you mean 'xyz'?"
    assert refusal(scene, {"GeneralizedAlpha.time_stp": 1}).cure == "did you mean 'time_step'?"


def test_a_scene_that_was_changed_can_be_changed_again_and_says_all_that_was():
    scene = read("jwell").replace({"bit.weight": "10 kN"}).replace({"solver.end": 1}).replace({"bit.weight": "20 kN"})
    assert (scene.bit.weight, scene.solver.end) == (20000.0, 1.0)
    told = scene.document.told
    assert Document.parse(told).root == scene.document.root
    assert "# bit.weight, by replace\n" in told and "# solver.end, by replace\n" in told


def test_a_scene_that_was_not_changed_tells_the_text_of_its_file():
    text = (DATA / "jwell.yaml").read_text(encoding="utf8")
    assert read("jwell").document.told == text and tautline.read(text).document.told == text


def test_a_scene_that_was_changed_shares_what_was_prepared_and_does_not_depend_on_the_change():
    scene = read("jwell")
    well, lumps = well_of(scene), prepared(scene)
    slippery = scene.replace({"well.wall.friction.kinetic": 0.1, "solver.step": "0.5 ms"})
    assert well_of(slippery) is well and prepared(slippery) is lumps
    thicker = scene.replace({"string[1].od": "0.17 m"})
    assert well_of(thicker) is well and prepared(thicker) is not lumps
    assert well_of(scene.replace({"well.sections[0].hold": "2300 m"})).length == pytest.approx(well.length + 100.0)
    assert prepared(scene).lumps.length.sum() == lumps.lumps.length.sum()


def test_a_scene_that_was_put_together_in_python_has_no_keys_of_a_file_to_change():
    scene = read("jwell")
    bare = type(scene)(**{name: getattr(scene, name) for name in type(scene).model_fields})
    assert "put together in Python" in refusal(bare, {"bit.weight": 1}).cause


def test_a_result_of_a_changed_scene_carries_the_changed_scene():
    scene = read("hoist").replace({"bodies[0].mass": "6 t", "solver.end": "100 ms"})
    again = tautline.read(tautline.simulate(scene).attributes["scene"])
    assert (again.bodies[0].mass, again.solver.end) == (6000.0, 0.1)
