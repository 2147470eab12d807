"""Numbers, colons, angles and names of files that were written wrongly are answered with what was meant."""

from pathlib import Path

import pytest

import tautline
from drillstring.application import Drillstring
from tautline.scene.reading.document import Document
from tautline.scene.reading.slips import run_together
from tautline.sweeps.file import read_sweep, scene_path

DATA = Path(__file__).parents[3] / "data"


def _problems(name, old, new, tmp_path):
    text = (DATA / f"{name}.yaml").read_text("utf8")
    assert old in text
    (tmp_path / "scene.yaml").write_text(text.replace(old, new), "utf8")
    with pytest.raises(tautline.SceneError) as caught:
        tautline.read(tmp_path / "scene.yaml")
    return caught.value.problems


CASES = {
    "a decimal comma in a list": ("hoist", "center: [12, 0, 30]", "center: [12, 0, 30,5]", "Are there decimal commas?"),
    "decimal commas throughout": ("hoist", "center: [12, 0, 30]", "center: [12,1, 0,0, 30,5]", "decimal commas?"),
    "marks of thousands and a decimal comma": ("hoist", "mass: 5 t", "mass: 5.000,0 t", "Write one number"),
    "a missing colon": ("jwell", "{hold: 2200 m}", "{hold 2200 m}", "a colon is missing: write hold: 2200 m"),
    "degrees without their unit": ("jwell", "to: 90 deg", "to: 90", "write 90 deg if these are degrees"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_what_was_meant_is_told(case, tmp_path):
    name, old, new, cure = CASES[case]
    problems = _problems(name, old, new, tmp_path)
    assert len(problems) == 1 and cure in problems[0].cure
    assert problems[0].line is not None and problems[0].key


def test_more_numbers_than_decimal_commas_can_make_are_not_taken_for_them(tmp_path):
    problem = _problems("hoist", "center: [12, 0, 30]", "center: [1, 2, 3, 4, 5, 6, 7]", tmp_path)[0]
    assert "comma" not in problem.cure


def test_an_angle_that_is_no_angle_in_degrees_either_is_not_offered_in_them(tmp_path):
    assert "deg if" not in _problems("jwell", "to: 90 deg", "to: 900", tmp_path)[0].cure


def test_a_misspelt_solver_is_the_only_fault_where_an_option_gives_the_end():
    """The option makes a solver of its own, which lacks a step: the file has one."""
    text = (DATA / "drilling.yaml").read_text("utf8").replace("solver:", "solvr:")
    application = Drillstring()
    with pytest.raises(tautline.SceneError) as caught:
        application.read(application.overridden(Document.parse(text), end=0.2))
    assert [(one.key, one.cure) for one in caught.value.problems] == [("solvr", "did you mean 'solver'?")]


def test_a_solver_without_a_step_is_still_told():
    with pytest.raises(tautline.SceneError) as caught:
        Drillstring().read(Document.parse("solver: {end: 1 s}\nwel: {}\n"))
    assert "solver.step" in [one.key for one in caught.value.problems]


def test_the_scene_of_a_sweep_that_is_not_there_is_told_at_its_line(tmp_path):
    file = tmp_path / "sweep.yaml"
    file.write_text("vary: {'bodies[0].mass': [4 t, 5 t]}\nscene: hoist.yaml\n")
    with pytest.raises(tautline.SceneError) as caught:
        scene_path(read_sweep(file))
    problem = caught.value.problems[0]
    assert (problem.file, problem.line, problem.key, problem.value) == (str(file), 2, "scene", "hoist.yaml")


def test_the_file_of_a_table_that_is_not_there_is_told_at_the_key_that_names_it(tmp_path):
    problem = _problems("hose", "speed: {ramp: {to: 35.0, over: 0.1}}", "speed: {table: {file: none.csv}}", tmp_path)[0]
    assert (problem.key, problem.value, problem.cause) == (
        "water.speed.table.file",
        "none.csv",
        "there is no such file",
    )


@pytest.mark.parametrize(
    "asked, meant", [("hoist.yml", True), ("hoits.yaml", True), ("hoist", True), ("x.yaml", False)]
)
def test_a_file_is_offered_only_where_its_name_is_like_what_was_asked_for(asked, meant, tmp_path):
    (tmp_path / "hoist.yaml").write_text("title: none")
    with pytest.raises(tautline.SceneError) as caught:
        tautline.read(tmp_path / asked)
    assert ("hoist.yaml?" in caught.value.problems[0].cure) is meant


def test_a_key_that_is_missing_is_told_where_the_file_has_its_mapping_beside_a_misspelt_one():
    text = (DATA / "hoist.yaml").read_text("utf8").replace("  mass_per_length: 6.5", "  # ") + "rop: {}\n"
    with pytest.raises(tautline.SceneError) as caught:
        tautline.read(text)
    assert {"rop", "rope.mass_per_length"} <= {one.key for one in caught.value.problems}


@pytest.mark.parametrize(
    "data", [{"name of load": "payload"}, {"step size": None}, {"step = 5": None}, {"odd 5": None}]
)
def test_what_is_no_key_and_its_value_is_not_taken_for_them(data):
    assert run_together(["name", "step"], data, next(iter(data))) == ("", "")


@pytest.mark.parametrize("written", [[True, False, 1, 2], [0.5, 1.5, 2.5, 3.5], ["1", "2", "3", "4"]])
def test_a_list_that_no_decimal_comma_can_have_made_is_told_of_none(written):
    with pytest.raises(tautline.SceneError) as caught:
        tautline.read(DATA / "hoist.yaml").replace({"path[1].sheave.center": written})
    assert "comma" not in caught.value.problems[0].cure


@pytest.mark.parametrize("name, said", [("x" * 300, "cannot be read"), ("t.yam", "did you mean"), ("a\0b", "")])
def test_the_scene_of_a_sweep_is_refused_as_a_scene_is(name, said, tmp_path):
    (tmp_path / "t.yaml").write_text("title: none")
    read = read_sweep({"scene": name, "vary": {"a": [1, 2]}}, tmp_path)
    with pytest.raises(tautline.SceneError) as caught:
        scene_path(read)
    assert caught.value.problems[0].key == "scene"
    assert said in f"{caught.value.problems[0].cause}; {caught.value.problems[0].cure}"
