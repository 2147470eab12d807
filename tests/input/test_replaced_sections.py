"""A scene that is made by replacing some keys takes over what was read of all others: it has to be the scene that would
be read in full."""

from pathlib import Path

import pytest

import tautline
from tautline.scene.errors import SceneError
from tautline.scene.model import validate

DATA = Path(__file__).parents[2] / "data"
SCENES = sorted(path.name for path in DATA.glob("*.yaml") if "\nsolver:" in path.read_text())
OF_ALL = [{"solver.end": "1.5 s"}, {"output.interval": "1 ms", "solver.step": "0.1 ms"}]


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_with_other_values_is_what_would_be_read_in_full(name):
    scene = tautline.read(DATA / name)
    for changes in OF_ALL:
        changed = scene.replace(changes)
        assert changed == validate(type(scene), changed.document)
        assert changed.model_dump() != scene.model_dump()
        assert changed.model_fields_set == scene.model_fields_set | {key.split(".")[0] for key in changes}


def test_sections_that_nothing_is_changed_in_are_not_read_again():
    scene = tautline.read(DATA / "hoist.yaml")
    changed = scene.replace({"bodies[0].mass": "6 t"})
    assert changed.rope is scene.rope and changed.vessel is scene.vessel and changed.path[1] is scene.path[1]
    assert changed.bodies[0].mass == 6000.0 and scene.bodies[0].mass == 5000.0
    assert changed.replace({"bodies[0].mass": "5 t"}).model_dump() == scene.model_dump()


def test_a_fault_between_sections_is_found_though_only_one_is_read():
    scene = tautline.read(DATA / "hoist.yaml")
    with pytest.raises(SceneError, match="there is no body of this name"):
        scene.replace({"bodies[0].name": "load"})
    with pytest.raises(SceneError, match=r"bodies\[0\].mass"):
        scene.replace({"bodies[0].mass": "-1 t"})


def test_what_an_alias_repeats_is_changed_in_one_place_only():
    text = (DATA / "hoist.yaml").read_text()
    text = text.replace("gravity: [0, 0, -9.81]\n", "")
    text = text.replace("{name: payload, mass: 5 t,", "{name: payload, mass: 5 t, velocity: *down,")
    text = text.replace("bodies:", "gravity: &down [0, 0, -9.81]\nbodies:")
    scene = tautline.read(text)
    changed = scene.replace({"gravity[2]": -9.0})
    assert changed.gravity[2] == -9.0 and scene.gravity[2] == -9.81
    assert changed.bodies[0].velocity == scene.bodies[0].velocity == (0.0, 0.0, -9.81)
