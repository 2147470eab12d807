"""What others add and that is wrong is told as theirs, and keeps no scene from running that can run without it."""

import os
import re
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from tautline import entry_points
from tautline.application import installed
from tautline.cable.application import Cable
from tautline.cable.input.syntax import nodal
from tautline.cli.output.blame import place_of
from tautline.errors import ArgumentError
from tautline.scene import extensions, methods, warnings
from tautline.scene.errors import SceneError
from tautline.scene.warnings import warning

HERE = Path(__file__)
ROPE = """
CableModelMaterial: {Gravity: [0, 0, -9.81], CableStiffness: 1.0e5, CableMass: 1}
CableModel:
  - Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}
  - Node4Dof: {id: 1, xyz: [0, 0, -1], BC: [0, 0, 0, 1]}
  - CableALEelementLin: {id: 0, nodes4: [0, 1], EA: 1.0e5, rhoA: 0, cDamp: 1 ms}
  - PointMass: {id: 0, nodes4: [1], mass: 2}
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 0.5}
"""


@pytest.fixture
def warned(tmp_path, monkeypatch):
    """The warnings of a scene, without what a test adds behind it."""
    # What is first loaded within a test would be forgotten with what the test registers.
    import_module("tautline.cable.warnings")
    monkeypatch.setattr(warnings, "REGISTERED", {name: dict(known) for name, known in warnings.REGISTERED.items()})
    (tmp_path / "rope.yaml").write_text(ROPE)

    def warned():
        cable = Cable()
        return [str(one) for one in cable.warnings(cable.read(tmp_path / "rope.yaml"))]

    return warned


def dividing(scene):
    yield "title", str(1 / 0)


def telling(scene):
    return "a text"


def silent(scene):
    return None


def test_a_warning_that_fails_is_told_with_its_function_and_line_and_stops_nothing(warned):
    before = warned()
    for check in (dividing, telling, silent):
        warning("cable")(check)
    new = [text for text in warned() if text not in before]
    assert len(new) == 2
    lines = HERE.read_text().splitlines()
    for check, word, said in (
        (dividing, "1 / 0", "ZeroDivisionError"),
        (telling, "def telling", "'a', and not pairs of a key path and a text"),
    ):
        line = next(i for i, text in enumerate(lines, 1) if word in text)
        text = next(text for text in new if check.__name__ in text)
        assert f"{HERE}:{line}: " in text and said in text and "correct it there" in text


def test_a_warning_for_an_application_that_there_is_not_is_told(warned):
    warning("cables")(silent)
    assert any("silent: is a warning for scenes of 'cables'" in text and "'cable'" in text for text in warned())


def test_an_extension_that_cannot_be_loaded_is_told_with_every_scene(warned, monkeypatch):
    monkeypatch.setattr(extensions, "load_extensions", lambda: {"brk": "ModuleNotFoundError: no nothere"})
    monkeypatch.setattr(warnings, "load_extensions", extensions.load_extensions)
    (told,) = [text for text in warned() if "extension brk" in text]
    assert "could not be loaded (ModuleNotFoundError: no nothere)" in told and "repair or uninstall it" in told


def test_a_method_of_others_does_not_take_the_place_of_one_of_ours():
    ours = methods.method_of("rk4")
    with pytest.raises(ArgumentError, match=r"tautline.scene.methods has registered a method rk4; choose another"):
        methods.register(methods.Method("rk4", "nowhere:NOTHING", order=1))
    assert methods.method_of("rk4") is ours


def test_an_application_of_others_does_not_take_the_name_of_one_of_ours():
    class Other(Cable):
        name = "crane"

    with pytest.raises(ArgumentError, match="comes with Tautline is called crane"):
        installed.register(Other)
    assert "crane" not in installed._registered


def test_an_installed_application_with_the_name_of_one_of_ours_is_left_out(tmp_path, monkeypatch):
    told = tmp_path / "raft-1.0.dist-info"
    told.mkdir()
    (told / "METADATA").write_text("Metadata-Version: 2.1\nName: raft\nVersion: 1.0\n")
    (told / "entry_points.txt").write_text("[tautline.applications]\nraft = raft_named_crane:Raft\n")
    text = "from tautline.cable.application import Cable\nclass Raft(Cable):\n    name = 'crane'\n"
    (tmp_path / "raft_named_crane.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    known = installed.Installed()
    assert [type(one).__module__.split(".")[0] for one in known.all() if one.name == "crane"] == ["crane"]
    assert "is called crane; choose another name" in known.broken["raft"]
    sys.modules.pop("raft_named_crane", None)
    entry_points._all.cache_clear()


@pytest.mark.parametrize("wrong", ["factor", "offset"])
def test_an_equation_whose_numbers_are_none_is_told_as_that(wrong, monkeypatch, tmp_path):
    def equations(layout, part):
        place = layout.start[part.nodes[0]]
        yield [(place, np.nan if wrong == "factor" else 1.0)], np.nan if wrong == "offset" else 0.0, "the node held"

    monkeypatch.setitem(nodal.NODAL, "PointMass", replace(nodal.NODAL["PointMass"], equations=equations))
    (tmp_path / "rope.yaml").write_text(ROPE)
    cable = Cable()
    with pytest.raises(SceneError, match=r"rope.yaml:7: .*the node held: a factor or the offset .* no finite number"):
        cable.build(cable.read(tmp_path / "rope.yaml"))


def test_an_error_is_laid_at_the_door_of_the_file_that_it_arose_in():
    with pytest.raises(ZeroDivisionError) as theirs:
        list(dividing(None))
    assert place_of(theirs.value) == (f"{HERE}:{place_of(theirs.value)[0].rpartition(':')[2]}", False)
    with pytest.raises(AttributeError) as ours:
        Cable().build(None)
    place, is_ours = place_of(ours.value)
    assert is_ours and re.search(r"tautline/(cable|application)/", place)
    # In numpy, which others have called: theirs.
    with pytest.raises(ValueError, match="broadcast") as called:
        np.broadcast_to(np.zeros(2), 3)
    assert place_of(called.value)[1] is False


def test_a_build_of_others_that_fails_is_told_as_theirs(tmp_path):
    text = (
        "from tautline.cable.application import Cable\nfrom tautline.cli.run import run\n"
        "from tautline.cli.verbs import make_app\nclass Broken(Cable):\n    name = 'broken'\n"
        "    def build(self, scene):\n        return 1 / 0\nrun(make_app(Broken()))\n"
    )
    (tmp_path / "brk.py").write_text(text)
    (tmp_path / "rope.yaml").write_text(ROPE)
    done = subprocess.run(
        [sys.executable, "brk.py", "check", "rope.yaml"], cwd=tmp_path, capture_output=True, text=True, env=os.environ
    )
    told = " ".join(done.stderr.split())
    assert "brk.py:7: unexpected ZeroDivisionError" in told and "this file is no part of the program" in told
    assert "report it" not in told
