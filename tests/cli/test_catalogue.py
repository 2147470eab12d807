"""`tautline` finds the application that a scene belongs to."""

import importlib.metadata
import json
from pathlib import Path

import pytest
import yaml
from fake_application import FakeApplication

from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline import entry_points
from tautline.application.installed import Installed
from tautline.cable.application import Cable
from tautline.cli.commands.starter import of_any
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.scene.errors import SceneError

DATA = Path(__file__).parents[2] / "data"


class Other(FakeApplication):
    name = "other"

    def recognises(self, root):
        return "other" in root


class Point:
    def __init__(self, name, kind):
        self.name, self.kind = name, kind

    def load(self):
        if self.kind is None:
            raise ImportError("no such module")
        return self.kind


@pytest.fixture
def installed(monkeypatch):
    points = [Point("fake", FakeApplication), Point("other", Other), Point("broken", None)]
    others = entry_points.in_group

    def in_group(group):
        return points if group == "tautline.applications" else others(group)

    monkeypatch.setattr(entry_points, "in_group", in_group)
    return Installed()


@pytest.mark.parametrize(("text", "name"), [("fake: true\n", "fake"), ("other: 1\n", "other")])
def test_a_scene_goes_to_the_application_that_recognises_it(installed, tmp_path, text, name):
    (tmp_path / "scene.yaml").write_text(text)
    assert installed.for_scene(tmp_path / "scene.yaml").name == name


def test_a_scene_that_nobody_recognises_is_an_error_naming_the_applications(installed, tmp_path):
    (tmp_path / "scene.yaml").write_text("ship: 1\n")
    with pytest.raises(SceneError, match=r"no installed application .*: fake, other;.*broken could not be loaded"):
        installed.for_scene(tmp_path / "scene.yaml")


def test_a_missing_scene_is_bad_input_for_tautline_too(installed, tmp_path, capsys):
    with pytest.raises(SystemExit) as left:
        run(make_app(installed), ["check", str(tmp_path / "none.yaml"), "--json"])
    assert left.value.code == 2
    assert json.loads(capsys.readouterr().out)["status"] == "bad input"


def test_check_runs_through_the_catalogue(installed, tmp_path, capsys):
    (tmp_path / "scene.yaml").write_text("fake: true\n")
    with pytest.raises(SystemExit) as left:
        run(make_app(installed), ["check", str(tmp_path / "scene.yaml"), "--json"])
    assert left.value.code == 0
    assert json.loads(capsys.readouterr().out)["status"] == "good"


def test_schema_of_several_applications_is_one_schema_of_a_scene_of_any_of_them(installed, capsys, monkeypatch):
    length = {"$defs": {"Length": {"type": "number"}}, "properties": {"length": {"$ref": "#/$defs/Length"}}}
    words = {"$defs": {"Length": {"type": "string"}}, "properties": {"length": {"$ref": "#/$defs/Length"}}}
    monkeypatch.setattr(FakeApplication, "schema", lambda self: length)
    monkeypatch.setattr(Other, "schema", lambda self: words)
    with pytest.raises(SystemExit):
        run(make_app(installed), ["schema"])
    schema = json.loads(capsys.readouterr().out)
    assert schema["$defs"].keys() == {"fake", "other"}
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    jsonschema.Draft202012Validator.check_schema(schema)
    checked = jsonschema.Draft202012Validator(schema)
    assert checked.is_valid({"length": 1.0}) and checked.is_valid({"length": "1 m"})
    assert not checked.is_valid({"length": [1.0]})


def test_installed_packages_are_looked_through_once_for_all_groups_and_again_where_another_folder_is_looked_in(
    monkeypatch, tmp_path
):
    looks, real = [], importlib.metadata.entry_points
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda **group: looks.append(group) or real(**group))
    monkeypatch.syspath_prepend(tmp_path)
    assert {point.name for point in entry_points.in_group("tautline.applications")} >= {"crane", "drillstring"}
    assert any(point.name == "crane" for point in entry_points.in_group("console_scripts"))
    assert list(entry_points.in_group("no such group")) == []
    assert looks == [{}]
    about = tmp_path / "late" / "late-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text("Name: late\nVersion: 1.0\n", encoding="utf8")
    (about / "entry_points.txt").write_text("[tautline.extensions]\nlate = late\n", encoding="utf8")
    monkeypatch.syspath_prepend(about.parent)
    assert "late" in {point.name for point in entry_points.in_group("tautline.extensions")}


def test_an_application_that_lacks_what_every_one_has_is_broken_and_others_take_their_scenes(
    installed, monkeypatch, tmp_path
):
    class Incomplete:
        pass

    points = [Point("buoy", Incomplete), Point("other", Other)]
    monkeypatch.setattr(entry_points, "in_group", lambda group: points)
    (tmp_path / "scene.yaml").write_text("other: 1\n")
    assert Installed().for_scene(tmp_path / "scene.yaml").name == "other"
    assert [one.name for one in Installed().all()] == ["other"]
    broken = Installed().broken
    assert broken.keys() == {"buoy"}
    assert "no `recognises`" in broken["buoy"]


def test_an_application_that_asks_for_a_key_which_scenes_of_others_lack_is_kept_and_named_where_nobody_knows_the_scene(
    installed, monkeypatch, tmp_path
):
    class ByKind(FakeApplication):
        name = "by_kind"

        def recognises(self, root):
            return root["kind"] == "raft"

    monkeypatch.setattr(entry_points, "in_group", lambda group: [Point("by_kind", ByKind), Point("other", Other)])
    scene = tmp_path / "scene.yaml"
    for text, name in (("kind: raft\n", "by_kind"), ("other: 1\n", "other")):
        scene.write_text(text)
        assert Installed().for_scene(scene).name == name
    scene.write_text("ship: 1\n")
    with pytest.raises(SceneError, match=r"`recognises` of by_kind failed at this scene \(KeyError: 'kind'\)"):
        Installed().for_scene(scene)


SHIPPED = ("hoist", "hose", "jwell", "reeled_span", "cantilever_bar")


def test_the_schema_of_all_applications_allows_what_they_read_and_refuses_what_they_refuse():
    jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")
    schemas = {kind.name: kind.schema() for kind in (Crane(), Drillstring(), Gardenhose(), Cable())}
    checked = jsonschema.Draft202012Validator(json.loads(json.dumps(of_any(schemas))))
    scenes = {name: yaml.safe_load((DATA / f"{name}.yaml").read_text(encoding="utf8")) for name in SHIPPED}
    for name, scene in scenes.items():
        assert checked.is_valid(scene), name
        assert not checked.is_valid(scene | {"no such key": 1}), name
    wrong = scenes["reeled_span"] | {"GeneralizedAlpha": scenes["reeled_span"]["GeneralizedAlpha"] | {"type": "RK5"}}
    assert not checked.is_valid(wrong)
