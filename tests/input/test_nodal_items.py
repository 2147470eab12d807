"""Items on cable nodes and warnings are registered, ours as a user's are."""

import re
from importlib import import_module

import numpy as np
import pytest

from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.cable.input.syntax import models, nodal
from tautline.cable.input.syntax.nodal import NodalItem, NodalPart, OnNodes, register_item
from tautline.cable.model.build import assemble_cables, build
from tautline.scene import warnings
from tautline.scene.errors import SceneError

SCENE = """
CableModelMaterial: {Gravity: [0, 0, -9.81]}
CableModel:
  - Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}
  - Node4Dof: {id: 1, xyz: [1, 0, 0], BC: [0, 0, 0, 1]}
  - CableALEelementLin: {id: 0, nodes4: [0, 1], EA: 10, rhoA: 1}
ITEM
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 0.5}
"""


class Level(OnNodes):
    """Nodes that keep their height."""


def level(layout, part):
    for node in part.nodes:
        place = layout.start[node] + 2
        yield [(place, 1.0)], -float(layout.initial[place]), f"height of node {node}"


@pytest.fixture(autouse=True)
def as_before(monkeypatch):
    """What a test registers is known for that test only."""
    # What is first loaded within a test would be forgotten with what the test registers.
    import_module("tautline.cable.warnings")
    monkeypatch.setattr(warnings, "REGISTERED", {name: dict(some) for name, some in warnings.REGISTERED.items()})
    yield
    for key in set(nodal.NODAL) - {"PointMass", "PointForce", "OneNodeSpring", "TwoNodeSpring"}:
        for known in (nodal.NODAL, models.KINDS, models.ITEM.keyed):
            known.pop(key, None)
    models.WrittenCable.model_rebuild(force=True)


def scene(item=""):
    return parse(SCENE.replace("ITEM", f"  - {item}" if item else ""))


def test_our_items_on_nodes_are_registered_and_nowhere_else_listed():
    assert list(nodal.NODAL) == ["PointMass", "PointForce", "OneNodeSpring", "TwoNodeSpring"]
    assert not models.OWN & set(nodal.NODAL)


def test_an_item_is_known_to_scenes_that_are_read_after_it_was_registered():
    with pytest.raises(SceneError, match="unknown key 'Level'"):
        scene("Level: {nodes4: [1]}")
    register_item(NodalItem("Level", Level, equations=level))
    (part,) = scene("Level: {nodes4: [1]}").nodal
    assert isinstance(part, NodalPart) and (part.key, part.nodes, part.line) == ("Level", (1,), 7)
    assert "Level" in str(Cable().schema())


def test_an_equation_of_an_item_on_held_nodes_alone_makes_no_multiplier():
    register_item(NodalItem("Level", Level, equations=level))
    plain = assemble_cables(scene()).system.q.size
    assert assemble_cables(scene("Level: {nodes4: [0]}")).system.q.size == plain
    assert assemble_cables(scene("Level: {nodes4: [1]}")).system.q.size == plain + 1


def test_an_equation_of_an_item_that_cannot_hold_is_refused_with_its_line():
    def above(layout, part):
        yield [(layout.start[0] + 2, 1.0)], -1.0, "height of node 0"

    register_item(NodalItem("Level", Level, equations=above))
    with pytest.raises(SceneError, match=r"scene.yaml:7: .*height of node 0: all are held, 1 apart"):
        build(scene("Level: {nodes4: [0]}"))


def test_an_equation_of_an_item_that_is_said_twice_is_refused():
    register_item(NodalItem("Level", Level, equations=level))
    with pytest.raises(SceneError, match="follows from the other constraints"):
        build(scene("Level: {nodes4: [1]}\n  - Level: {nodes4: [1]}"))


def test_the_mass_and_the_stiffness_that_an_item_states_count_in_check():
    class Float(OnNodes):
        """A float."""

    register_item(NodalItem("Float", Float, mass=lambda part: 3.0, stiffness=lambda part: 1.0e4))
    without, with_it = (Cable().check_figures(scene(item)) for item in ("", "Float: {nodes4: [1]}"))
    assert with_it["cable"]["mass"] == pytest.approx(without["cable"]["mass"] + 3.0)
    assert with_it["cable"]["Float"] == 1
    assert with_it["critical_step_rk4"] < 0.2 * without["critical_step_rk4"]


def test_a_scene_with_another_value_in_an_item_of_the_user_is_another_model():
    class Rated(OnNodes):
        """A number."""

        rate: float

    register_item(NodalItem("Rated", Rated))
    first, same, other = (
        build(scene(f"{gap}Rated: {{nodes4: [1], rate: {rate}}}")).attributes["model_hash"]
        for gap, rate in (("", 1.0), (" ", 1.0), ("", 2.0))
    )
    assert first == same != other


@pytest.mark.parametrize(
    ("key", "model", "error"),
    [("Level", int, TypeError), ("PointMass", Level, ValueError)],
    ids=["no model", "a name of ours"],
)
def test_a_registration_that_cannot_be_is_refused(key, model, error):
    with pytest.raises(error, match=key):
        register_item(NodalItem(key, model))


def test_an_item_with_the_name_of_a_node_is_refused():
    register_item(NodalItem("Node7Dof", Level))
    with pytest.raises(ValueError, match="Node7Dof: the cable's own syntax has this name"):
        scene()
    nodal.NODAL.pop("Node7Dof")
    assert scene().nodal == ()


def test_a_registered_warning_is_told_with_its_key_and_line_and_once_if_registered_anew():
    for text in ("first", "second"):

        @warnings.warning("cable")
        def soft(scene, text=text):
            for element in scene.elements:
                yield (*element.place, "EA"), text

    found = [str(one) for one in Cable().warnings(scene()) if "first" in str(one) or "second" in str(one)]
    assert found == ["CableModel[2].CableALEelementLin.EA (line 6): second"]


@pytest.mark.parametrize("application", ["crane", "drillstring", "gardenhose"])
def test_a_warning_registered_for_an_application_is_told_of_its_scenes(application, tmp_path):
    from importlib import import_module

    made = getattr(import_module(f"{application}.application"), application.capitalize())()
    path = tmp_path / "scene.yaml"
    path.write_text(next(iter(made.templates.values())), encoding="utf8")
    read = made.read(path)

    @warnings.warning(application)
    def odd(scene):
        yield ("solver", "step"), "is odd"
        yield "solver", "is odd as a whole"

    found = [str(one) for one in made.warnings(read)]
    assert any("solver.step (line" in text and "is odd" in text for text in found)
    assert any(re.fullmatch(r"solver \(line \d+\): is odd as a whole", text) for text in found)


def test_items_couple_what_they_say_in_the_tangent():
    layout = assemble_cables(scene()).layout
    part = NodalPart("Level", Level(nodes4=(0, 1)), (0, 1), 1, ("CableModel", 0, "Level"))
    assert [len(places) for places in nodal.each_node(layout, part)] == [3, 3]
    (together,) = nodal.all_nodes(layout, part)
    assert np.array_equal(together, [0, 1, 2, 4, 5, 6])
