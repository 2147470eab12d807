"""Scenes are equal that say the same, however they were written and wherever they were read."""

import copy
import pickle
from pathlib import Path

import pytest

import tautline
from tautline.cable.input.parts import Tie
from tautline.cable.input.syntax.nodal import NodalPart

DATA = Path(__file__).parents[2] / "data"
HOIST = DATA / "hoist.yaml"
SCENE = tautline.read(HOIST)


def test_a_scene_of_a_file_and_one_of_its_text_are_equal_and_one_key_of_a_set():
    same = tautline.read(HOIST.read_text(encoding="utf8"))
    assert same == SCENE and len({same, SCENE}) == 1


@pytest.mark.parametrize(("written", "other"), [("0.2 s", 0.2), ("200 ms", "0.2 s")])
def test_what_is_written_otherwise_and_means_the_same_is_equal(written, other):
    assert SCENE.replace({"solver.end": written}) == SCENE.replace({"solver.end": other})


@pytest.mark.parametrize("change", [{"solver.end": "0.2 s"}, {"title": "another"}, {"bodies[0].mass": "5.001 t"}])
def test_scenes_that_say_something_else_are_not_equal(change):
    assert SCENE.replace(change) != SCENE
    assert SCENE.driven_by(["winch"]) != SCENE and SCENE != HOIST


def test_the_scene_of_a_result_is_the_one_that_was_run():
    result = tautline.simulate(SCENE.replace({"output.interval": "10 ms"}), end="20 ms")
    run = SCENE.replace({"solver.end": "20 ms", "output.interval": "10 ms"})
    assert tautline.read(result.attributes["scene"]) == run


def test_one_name_of_a_file_in_two_folders_is_not_the_same(tmp_path):
    text = HOIST.read_text(encoding="utf8")
    table = {"table": {"file": "pay_out.csv"}}
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "pay_out.csv").write_text("0,-1\n1,-1\n", encoding="utf8")
    one, again, two = (
        tautline.read(text, folder=tmp_path / folder).replace({"path[0].drum.pay_out": table})
        for folder in ("one", "one", "two")
    )
    assert one == again and one != two


def test_an_absolute_name_of_a_file_says_the_same_in_two_folders(tmp_path):
    (tmp_path / "pay_out.csv").write_text("0,-1\n1,-1\n", encoding="utf8")
    table = {"table": {"file": str(tmp_path / "pay_out.csv")}}
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
    one, two = (
        tautline.read(HOIST.read_text(encoding="utf8"), folder=tmp_path / folder).replace(
            {"path[0].drum.pay_out": table}
        )
        for folder in ("one", "two")
    )
    assert one == two


def test_who_sets_a_value_is_told_to_replace_it_and_the_scene_stays_as_it_is():
    before = SCENE.bodies[0].mass
    for part, name in ((SCENE.bodies[0], "mass"), (SCENE, "title"), (SCENE.solver, "step")):
        with pytest.raises(
            tautline.SceneError, match=rf"{name} = 3: a scene cannot be changed; .*scene\.replace"
        ) as told:
            setattr(part, name, 3)
        assert "pydantic" not in str(told.value)
    assert SCENE.bodies[0].mass == before


@pytest.mark.parametrize("part", ["scene", "solver", "tie", "item on nodes"])
@pytest.mark.parametrize(("name", "told"), [("title", "title"), ("nonsense", "nonsense"), ("step", "(time_)?step")])
def test_a_cables_scene_and_its_parts_refuse_changes_of_any_name_and_name_no_key_that_they_lack(part, name, told):
    scene = tautline.read(DATA / "cantilever_bar.yaml")
    place = scene.nodes[0].place
    whole = {
        "scene": scene,
        "solver": scene.solver,
        "tie": Tie(1, "multiplier", (1, 2), 0, None, (0.0, 0.0, 0.0), 1, place),
        "item on nodes": NodalPart("PointMass", None, (1,), 1, place),
    }[part]
    with pytest.raises(
        tautline.SceneError, match=rf"^scene: {told} = 3: a scene cannot be changed; .*\.replace"
    ) as error:
        setattr(whole, name, 3)
    assert "solver.step" not in str(error.value)
    with pytest.raises(tautline.SceneError, match=rf"^scene: {told}: a scene cannot be changed; .*\.replace"):
        delattr(whole, name)
    assert pickle.loads(pickle.dumps(whole)) == copy.copy(whole) == whole


def test_what_is_no_field_cannot_be_set_and_nothing_can_be_deleted():
    for part, name in ((SCENE, "title"), (SCENE, "nonsense"), (SCENE, "folder"), (SCENE.solver, "end")):
        for change in (lambda part, name: setattr(part, name, 3), delattr):
            with pytest.raises(tautline.SceneError, match=rf"^scene: {name}( = 3)?: a scene cannot be changed") as told:
                change(part, name)
            assert "pydantic" not in str(told.value)
    assert SCENE == tautline.read(HOIST)
