"""A scene is read from a file, a text or a dict, by all applications, and validated with the same messages."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import tautline
from crane.scene.scene import CraneScene
from drillstring.model.prepared import well_of
from drillstring.scene.scene import DrillstringScene
from gardenhose.scene import HoseScene
from tautline.application.installed import Installed
from tautline.cable.input.parts import CableScene
from tautline.scene.identity.contents import model_hash
from tautline.scene.reading.document import Document
from tautline.scene.reading.scalars import written_out

DATA = Path(__file__).parents[3] / "data"
KINDS = {"hoist": CraneScene, "jwell": DrillstringScene, "hose": HoseScene, "reeled_span": CableScene}
ODD = ["1e5", "no", "NO", "12", "0x1F", "~", "null", "a: b", "- x", "é", "a\nb", "", " x ", "#a", "1_000", "12:30"]
ODD += ["\x07", "off", ".nan", ".5", "+.inf", "[1", "yes", "*a", "&b", "!c", "%d", "@e", "`", "True", "a" * 300, "x #y"]


def content(scene):
    """What a scene says, whatever it was read from."""
    application = Installed().of(scene)
    return application.build(scene).attributes["model_hash"], scene.solver


def text_of(name):
    return (DATA / f"{name}.yaml").read_text(encoding="utf8")


@pytest.mark.parametrize("name", KINDS)
def test_a_path_its_text_and_a_dict_of_it_give_the_same_scene_of_every_application(name):
    path = DATA / f"{name}.yaml"
    scenes = [tautline.read(each) for each in (path, str(path), text_of(name), Document.read(path).root)]
    assert [type(scene) for scene in scenes] == [KINDS[name]] * 4
    assert [content(scene) for scene in scenes[1:]] == [content(scenes[0])] * 3


@pytest.mark.parametrize("name", sorted(file.stem for file in DATA.glob("*.yaml")))
def test_the_plain_values_of_every_shipped_scene_are_written_as_a_text_that_reads_as_the_same_values(name):
    root = Document.read(DATA / f"{name}.yaml").root
    assert Document.parse(written_out(root)).root == root


def test_texts_that_yaml_would_read_as_something_else_stay_texts_when_they_are_written():
    root = {f"key {i}": {"word": word, "list": [word, {"x": word}]} for i, word in enumerate(ODD)}
    root |= {word: i for i, word in enumerate(ODD)}
    assert Document.parse(written_out(root)).root == root


def test_numbers_are_written_to_the_last_bit():
    numbers = [0.1, 1e-7, 1e300, 5e-324, -0.0, 1.0, 3, 2**62, True, False, None]
    back = Document.parse(written_out({"n": numbers})).root["n"]
    assert [repr(x) for x in back] == [repr(x) for x in numbers]


@pytest.mark.parametrize("one", ["{well: 3}", "well: 3", "  {", "a: 1\n"])
def test_a_str_that_reads_as_a_mapping_is_a_text(one):
    with pytest.raises(tautline.SceneError) as error:
        tautline.read(one)
    assert all(problem.file == "scene" for problem in error.value.problems)


@pytest.mark.parametrize("one", ["nowhere.yaml", "word", "C:\\scenes\\hoist.yaml", "-", "1"])
def test_a_str_of_a_bare_word_is_a_path(one):
    with pytest.raises(tautline.SceneError, match="there is no such file"):
        tautline.read(one)


@pytest.mark.parametrize("source", [None, 3, [1], b"well: 3"])
def test_what_is_no_scene_at_all_is_refused_as_a_type(source):
    with pytest.raises(TypeError, match="the path of its file, its text or a dict"):
        tautline.simulate(source)


def test_a_folder_beside_a_file_is_refused():
    with pytest.raises(TypeError, match="its own folder"):
        tautline.read(DATA / "hoist.yaml", folder=DATA)


def test_a_fault_in_a_dict_is_told_with_its_line_key_value_cause_and_cure_as_in_a_file():
    root = Document.read(DATA / "jwell.yaml").root
    root["string"][1]["od"] = "0.10 kg"
    root["solver"]["stp"] = 1
    lines = written_out(root).splitlines()
    with pytest.raises(tautline.SceneError) as error:
        tautline.read(root)
    told = {problem.key: problem for problem in error.value.problems}
    assert set(told) == {"string[1].od", "solver.stp"}
    assert "0.10 kg" in lines[told["string[1].od"].line - 1] and told["string[1].od"].value == "0.10 kg"
    assert (told["solver.stp"].cause, told["solver.stp"].cure) == ("unknown key", "did you mean 'step'?")
    assert str(told["solver.stp"]).startswith(f"scene:{told['solver.stp'].line}: solver.stp = 1: ")


@pytest.mark.parametrize("name", KINDS)
def test_a_text_and_a_dict_are_refused_with_the_messages_of_a_file(name, tmp_path):
    key = "GeneralizedAlpha" if name == "reeled_span" else "solver"
    root = Document.read(DATA / f"{name}.yaml").root
    root[key]["fast"] = 1
    text = written_out(root)
    (tmp_path / "scene").write_text(text, encoding="utf8")
    told = []
    for source in (tmp_path / "scene", text, root):
        with pytest.raises(tautline.SceneError) as error:
            tautline.read(source)
        told.append([(one.line, one.key, one.value, one.cause, one.cure) for one in error.value.problems])
    assert told[0] == told[1] == told[2] and told[0][0][1] == f"{key}.fast"


def test_values_of_numpy_tuples_and_paths_stand_for_what_they_are():
    root = Document.read(DATA / "hoist.yaml").root
    root["bodies"][0]["mass"] = np.float64(5000.0)
    root["gravity"] = np.array([0.0, 0.0, -9.81])
    root["mesh"] = {"elements_per_span": np.int64(4)}
    root["title"] = Path("a title")
    scene = tautline.read(root)
    assert (scene.bodies[0].mass, scene.gravity, scene.title) == (5000.0, (0.0, 0.0, -9.81), "a title")


def test_what_no_file_could_hold_is_refused_with_its_key():
    with pytest.raises(tautline.SceneError, match=r"scene: solver\.step: a object cannot stand in a scene"):
        tautline.read({"solver": {"step": object()}})


def test_a_dict_that_holds_itself_is_refused():
    endless = {"title": "round"}
    endless["bodies"] = [endless]
    with pytest.raises(tautline.SceneError, match="nested more than 50 deep"):
        tautline.read(endless)


def test_files_that_a_text_names_are_looked_for_in_the_current_folder_or_in_the_one_given(tmp_path, monkeypatch):
    (tmp_path / "survey.csv").write_text("md [m],inc [deg],azi [deg]\n0,0,0\n60,0,0\n90,6,0\n", encoding="utf8")
    root = Document.read(DATA / "jwell.yaml").root
    root["well"] = {"survey": "survey.csv", "diameter": 0.2032, "wall": "none"}
    root["string"] = root["string"][:1]
    assert well_of(tautline.read(root, folder=tmp_path)).length == 90.0
    with pytest.raises(tautline.SceneError, match=r"survey\.csv"):
        well_of(tautline.read(root))
    monkeypatch.chdir(tmp_path)
    assert well_of(tautline.read(written_out(root))).length == 90.0


def test_simulate_and_the_studies_take_a_path_a_text_a_dict_and_a_scene(tmp_path):
    path = tmp_path / "hanging.yaml"
    shutil.copy(DATA / "hanging.yaml", path)
    text, root = text_of("hanging"), Document.read(path).root
    results = [tautline.simulate(each, end="100 ms") for each in (path, text, root, tautline.read(root))]
    assert len({result["position"].tobytes() for result in results}) == 1
    assert len({result.attributes["model_hash"] for result in results}) == 1
    quick = tautline.Grid(methods=["generalized-alpha"], steps=[1e-3, 5e-4])
    study = tautline.study_errors(text, end="100 ms", grid=quick, repetitions=1)
    assert [row.trial.setting.step for row in study.rows] == [1e-3, 5e-4]


def test_a_step_an_end_and_a_method_given_to_simulate_are_numbers_or_texts_with_units_of_the_scene_that_is_stored():
    scene = tautline.read(DATA / "hoist.yaml")
    result = tautline.simulate(scene, step="1 ms", end=0.1, method="rk4")
    assert (result.attributes["step"], result.time[-1], result.attributes["method"]) == (0.001, 0.1, "rk4")
    again = tautline.read(result.attributes["scene"])
    assert (again.solver.step, again.solver.end, again.solver.method) == (0.001, 0.1, "rk4")
    assert model_hash(again, folder=again.folder) == result.attributes["model_hash"]
    for given, key in (({"step": "3 kg"}, "step"), ({"end": "soon"}, "end"), ({"method": "eulr"}, "method")):
        with pytest.raises(tautline.SceneError) as error:
            tautline.simulate(scene, **given)
        assert error.value.problems[0].key == f"solver.{key}" and error.value.problems[0].cure


def test_a_number_that_pyyaml_has_left_a_text_is_refused_with_the_name_of_pyyaml_and_the_cure():
    import yaml

    read = yaml.safe_load((DATA / "hoist.yaml").read_text(encoding="utf8"))
    assert read["rope"]["axial_stiffness"] == "8.0e7"
    with pytest.raises(tautline.SceneError, match=r"If PyYAML has read the file: it takes 8\.0e7 for text\. Give"):
        tautline.read(read)
    # A number in quotes that PyYAML would have read is another slip.
    with pytest.raises(tautline.SceneError, match="remove the quotes, or add the unit") as refused:
        tautline.read(read | {"rope": read["rope"] | {"axial_stiffness": "8.0e+7"}})
    assert "PyYAML" not in str(refused.value)


def test_a_scene_that_is_read_again_is_given_back_as_it_is():
    scene = tautline.read(DATA / "hoist.yaml")
    assert tautline.read(scene) is scene
    with pytest.raises(TypeError, match="leave `folder` out"):
        tautline.read(scene, folder=DATA)
