"""What `check` tells of a scene beyond its warnings: a table for people, and a drawing."""

import json
from pathlib import Path

import pytest
from fake_application import FakeApplication

from tautline.application.installed import Single
from tautline.cli.commands.simulate import check
from tautline.results.errors import ResultError
from tautline.scene.errors import Problem, SceneError


class Telling(FakeApplication):
    """An application that describes and draws its scenes."""

    def describe(self, figures):
        return [("length of all", f"{figures['length']:g} m"), ("[brackets]", "stay")]

    def draw(self, scene, path):
        path.write_text("a picture")
        return path


@pytest.fixture
def scene(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("good.yaml").write_text("fake: true\n")
    return Path("good.yaml")


def test_a_table_of_the_figures_is_printed_for_people_and_not_beside_json(scene, capfd):
    check(Single(Telling()), scene, as_json=False)
    err = capfd.readouterr().err
    assert "length of all" in err and "1 m" in err and "[brackets]" in err
    check(Single(Telling()), scene, as_json=True)
    out, err = capfd.readouterr()
    assert json.loads(out)["length"] == 1.0 and "length of all" not in err


def test_a_scene_is_drawn_where_a_figure_is_asked_for(scene, capfd):
    check(Single(Telling()), scene, as_json=True, figure=Path("scene.png"))
    out, err = capfd.readouterr()
    assert json.loads(out)["figure"] == "scene.png" and "wrote scene.png" in err
    assert Path("scene.png").read_text() == "a picture"


def test_an_application_that_draws_no_scenes_says_so(scene):
    check(Single(FakeApplication()), scene, as_json=False)
    with pytest.raises(ResultError, match="scenes of fake are not drawn; leave it out"):
        check(Single(FakeApplication()), scene, as_json=False, figure=Path("scene.png"))


@pytest.mark.parametrize(
    ("name", "said"),
    [("good.yaml", "no format of figures"), ("drawn.jpg", "no format of figures"), ("mine.svg", "with --figure")],
)
def test_a_figure_is_refused_by_the_rule_of_all_figures_and_the_cure_names_the_option_of_check(scene, name, said):
    Path("mine.svg").write_text("my own words\n")
    before = {path.name: path.read_bytes() for path in Path().iterdir()}
    with pytest.raises(ResultError, match=said) as told:
        check(Single(Telling()), scene, as_json=True, figure=Path(name))
    assert " -o" not in str(told.value)
    assert {path.name: path.read_bytes() for path in Path().iterdir()} == before


def test_a_scene_that_cannot_be_built_is_not_drawn(scene, monkeypatch):
    def refuse(self, scene):
        raise SceneError([Problem("good.yaml", 1, "fake", None, "cannot be built")])

    monkeypatch.setattr(Telling, "build", refuse, raising=False)
    with pytest.raises(SceneError):
        check(Single(Telling()), scene, as_json=True, figure=Path("drawn.png"))
    assert not Path("drawn.png").exists()
