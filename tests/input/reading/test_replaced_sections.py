"""A scene that is made by replacing some keys takes over what was read of all others: it has to be the scene that would
be read in full."""

from pathlib import Path

import pytest

import tautline
from tautline.scene.errors import SceneError
from tautline.scene.model import validate

DATA = Path(__file__).parents[3] / "data"
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


PERIOD, MASS = "vessel.motion.heave.harmonic.period", "bodies[0].mass"


def test_a_section_that_was_changed_to_the_same_before_is_not_read_again():
    scene = tautline.read(DATA / "hoist.yaml")
    one = scene.replace({PERIOD: 7.0, MASS: "6 t"})
    other = scene.replace({MASS: "7 t", PERIOD: 7.0})
    assert other.vessel is one.vessel and other.vessel is not scene.vessel
    assert other.bodies[0].mass == 7000.0 and one.bodies[0].mass == 6000.0
    assert other == validate(type(scene), other.document) and other.document.told != one.document.told
    third = scene.replace({MASS: "7 t", PERIOD: 8.0})
    assert third.bodies[0] is other.bodies[0] and third.vessel.motion.heave != other.vessel.motion.heave
    assert scene.replace({MASS: "7 t"}).vessel is scene.vessel


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ({"mesh.elements_per_span": 4}, {"mesh.elements_per_span": 4.0}),
        ({"solver.rho_inf": 1}, {"solver.rho_inf": True}),
        ({MASS: 6000.0}, {MASS: "6 klb"}),
        ({MASS: 6000.0}, {"bodies[0].bottom": 6000.0}),
        ({MASS: 6000.0, "bodies[0].velocity": [0, 0, -1]}, {MASS: 6000.0}),
    ],
)
def test_a_section_that_was_changed_to_something_else_before_is_read(before, after):
    """Numbers that are equal may be no whole numbers, or no numbers at all."""

    def told(scene):
        try:
            return scene.replace(after).model_dump()
        except SceneError as error:
            return str(error)

    scene = tautline.read(DATA / "hoist.yaml")
    scene.replace(before)
    assert told(scene) == told(tautline.read(DATA / "hoist.yaml"))


def test_a_section_of_another_scene_that_was_changed_to_the_same_is_read():
    scene = tautline.read(DATA / "hoist.yaml")
    lighter = scene.replace({"bodies[0].velocity": [0, 0, -1], MASS: "2 t"})
    of_scene, of_lighter = scene.replace({MASS: "6 t"}), lighter.replace({MASS: "6 t"})
    assert (of_scene.bodies[0].velocity[2], of_lighter.bodies[0].velocity[2]) == (scene.bodies[0].velocity[2], -1.0)


def test_a_section_that_names_a_file_is_read_again_as_the_file_may_be_another(tmp_path):
    path = tmp_path / "hoist.yaml"
    path.write_text((DATA / "hoist.yaml").read_text())
    (tmp_path / "a.csv").write_text("time,value\n0,0\n5,1\n")
    based = tautline.read(path).replace({"path[0].drum.pay_out": {"table": {"file": "a.csv"}}})
    ends = []
    for value in (3.0, 4.0):
        (tmp_path / "a.csv").write_text(f"time,value\n0,0\n5,{value}\n")
        ends.append(based.replace({"path[0].drum.name": "drum"}).path[0].pay_out.value[-1])
    assert ends == [3.0, 4.0]


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
