"""What `check` tells of a scene beyond its warnings: a table for people, and a drawing."""

import json
from pathlib import Path

import pytest
from fake_application import FakeApplication

from tautline.application.installed import Single
from tautline.cli.commands.simulate import check
from tautline.results.errors import ResultError


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
