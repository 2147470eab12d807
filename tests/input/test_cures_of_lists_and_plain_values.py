"""What is to be a list is told with a list that may stand there; what has no keys is told where they are written."""

import re
from pathlib import Path

import pytest
import yaml

import tautline
from tautline import SceneError
from tautline.scene.choices.branches import Branch, OneOf
from tautline.scene.model import Model
from tautline.twin.map.file import read_map

CRANE = (Path(__file__).parent / "crane_scenes" / "hoist.yaml").read_text(encoding="utf8")
DRILLING = (Path(__file__).parents[2] / "apps/drillstring/templates/drilling.yaml").read_text(encoding="utf8")
MAP = {"sensors": [{"column": "t", "unit": "kN", "output": "winch.tension", "range": "x"}]}
WELL = "well: {sections: %s, diameter: 8.5 in, wall: none}\n"
NO_WELL = re.sub(r"(?m)^well:.*\n(?:  .*\n)+", "", DRILLING)


def refusal(read, text):
    with pytest.raises(SceneError) as error:
        read(text)
    return error.value.problems[0]


def drilled(sections):
    return WELL % sections + NO_WELL


LISTS = {
    "guide": (tautline.read, CRANE.replace("position: [12.4, 0, 5]", "position: [12.4, 0, 5], guide: x")),
    "sections": (tautline.read, drilled("x")),
    "range": (read_map, MAP),
    "sensors": (read_map, {"sensors": "x"}),
    "estimate": (read_map, {**MAP, "estimate": "x"}),
    "watch": (read_map, {**MAP, "watch": "x"}),
    "keep": (read_map, {**MAP, "keep": "x"}),
}
OF = {
    "guide": "[x, y]: of x, y and z those along which it is held",
    "sections": "[{hold: 600 m}, {build: {rate: 3 deg/30 m, to: 60 deg}}]",
    "range": "[4 t, 6 t]: the least and the most",
    "sensors": "[{column: load, unit: kN, output: winch.tension}]",
    "estimate": "[{parameter: 'bodies[0].mass', sd: 100 kg, range: [4 t, 6 t]}]",
    "watch": "[{output: winch.tension, above: 60 kN, name: overload}]",
    "keep": "[winch.tension]",
}


@pytest.mark.parametrize("key", LISTS)
def test_what_is_no_list_is_told_with_entries_that_may_stand_there(key):
    read, text = LISTS[key]
    with pytest.raises(SceneError) as error:
        read(text)
    cures = [one.cure for one in error.value.problems if one.key.endswith(key)]
    assert cures == [f"give a list such as {OF[key]}"]


def models(kind=Model):
    for one in kind.__subclasses__():
        yield one
        yield from models(one)


def test_no_list_that_can_be_written_is_told_with_the_numbers_of_a_list_of_anything():
    """All models of the applications that are loaded; a sum is read before it is made."""
    tautline.read(CRANE), tautline.read(DRILLING)
    bare = {
        f"{one.__name__}.{name}"
        for one in models()
        for name, field in one.model_fields.items()
        if re.match(r"(tuple|list)\[", str(field.annotation))
        and not (field.examples or field.metadata)
        and one.__module__.partition(".")[0] in ("tautline", "crane", "drillstring", "gardenhose")
    }
    assert bare <= {"Sum.terms", "Table.time", "Table.value", "SweepFile.collect"}


@pytest.mark.parametrize("beside", ["inclination: 90 deg", "azimuth: 10 deg"])
def test_a_direction_beside_a_hold_is_told_where_it_is_written_and_is_accepted_there(beside):
    problem = refusal(tautline.read, drilled(f"[{{hold: 600 m, {beside}}}]"))
    assert problem.cure.startswith("remove it, because hold has no keys: it goes on as the piece before it ends")
    key = beside.partition(":")[0]
    assert f"well.{key}" in problem.cure
    sound = yaml.safe_load(drilled("[{hold: 600 m}]"))
    sound["well"][key] = beside.partition(": ")[2]
    tautline.read(sound)


def test_only_a_branch_that_has_keys_is_told_to_take_one_more():
    choice = OneOf("a thing", {"plain": Branch(float), "whole": Branch(type("Whole", (Model,), {}))})
    for key, cure in (("plain", "remove it, because plain has no keys"), ("whole", "make it a key of whole")):
        with pytest.raises(Exception, match="stands beside") as error:
            choice.select({key: 1, "unlike": 2})
        assert cure in error.value.context["cure"]
