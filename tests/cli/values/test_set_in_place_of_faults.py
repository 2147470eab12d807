"""Values of the command line replace those of the file before the scene is validated: what is replaced is no fault."""

import pickle
from pathlib import Path

import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object

import tautline
from tautline.application.installed import Installed
from tautline.results.result import Result

DATA = Path(__file__).parents[3] / "data"
HOIST = (DATA / "hoist.yaml").read_text(encoding="utf8")
SOLVER, OUTPUT = (next(line for line in HOIST.splitlines() if line.startswith(key)) for key in ("solver:", "output:"))
LATE = HOIST.replace(OUTPUT, "output: {keep: statistics, interval: 50 ms, begin: 100 s}")
HEAVY = HOIST.replace("mass: 5 t,", "mass: 5 tt,")
LINE = 1 + HEAVY[: HEAVY.index("5 tt")].count("\n")


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    leave_out_pixels(monkeypatch)
    Path("late.yaml").write_text(LATE, encoding="utf8")
    Path("heavy.yaml").write_text(HEAVY, encoding="utf8")
    return commands_of(Installed(), capsys)


def own(name, capsys):
    return commands_of(next(one for one in Installed().all() if one.name == name), capsys)


def problems(found):
    return only_object(found[1])["problems"]


def test_the_files_are_refused_as_they_stand(command):
    assert command("check", "late.yaml")[0] == command("check", "heavy.yaml")[0] == 2


@pytest.mark.parametrize("sets", [["--set", "solver.end=3600 s"], ["--set", "output.begin=1 s"]])
def test_a_scene_whose_values_fit_with_those_that_are_set_is_checked(command, capsys, sets):
    assert command("check", "late.yaml", *sets)[0] == 0
    assert own("crane", capsys)("check", "late.yaml", *sets)[0] == 0


def test_a_value_that_is_no_value_may_be_replaced(command, capsys):
    sets = ["--set", "bodies[0].mass=5 t"]
    assert command("check", "heavy.yaml", *sets)[0] == 0
    code, out, err = own("crane", capsys)("simulate", "heavy.yaml", *sets, "--end", "0.1", "--json", "--quiet")
    assert code == 0, err
    assert tautline.read(Result.read(only_object(out)["result"]).attributes["scene"]).bodies[0].mass == 5000.0


def test_an_option_of_its_own_is_what_the_scene_is_validated_with(command):
    code, _, err = command(
        "simulate", "late.yaml", "--set", "output.begin=0.1 s", "--end", "0.2", "--step", "2 ms", "--json", "--quiet"
    )
    assert code == 0, err
    # The file's own begin, 100 s, is after its end; an option says how long this run is.
    late = command("simulate", "late.yaml", "--end", "99", "--json")
    (problem,) = problems(late)
    assert late[0] == 2 and problem["key"] == "output.begin" and problem["value"] == "100 s"
    assert "the end of the run (99 s)" in problem["cause"] and problem["file"] == "late.yaml"
    bad = command("simulate", "late.yaml", "--set", "output.begin=0.1 s", "--step", "30 s", "--end", "20", "--json")
    assert bad[0] == 2 and {one["file"] for one in problems(bad)} <= {"--step", "--end", "late.yaml"}


def test_what_is_not_replaced_keeps_its_file_and_line_and_what_is_names_its_option(command):
    code, out, _ = command("check", "heavy.yaml", "--set", "solver.step=0 s", "--json")
    found = {one["key"]: (one["file"], one["line"], one["value"]) for one in only_object(out)["problems"]}
    assert code == 2
    assert found == {"solver.step": ("--set", None, "0 s"), "bodies[0].mass": ("heavy.yaml", LINE, "5 tt")}


def test_a_file_that_is_no_yaml_is_refused_whatever_is_replaced(command):
    Path("broken.yaml").write_text(HEAVY.replace("mass: 5 tt,", "mass: [5 t,"), encoding="utf8")
    code, out, _ = command("check", "broken.yaml", "--set", "bodies[0].mass=5 t", "--json")
    (problem,) = only_object(out)["problems"]
    assert code == 2 and problem["file"] == "broken.yaml" and "YAML" in problem["cause"]


def test_where_a_value_finds_no_place_in_a_faulty_file_the_file_is_told(command):
    Path("flat.yaml").write_text(HOIST.replace(SOLVER, "solver: 5"), encoding="utf8")
    (problem,) = problems(command("check", "flat.yaml", "--set", "solver.end=2 s", "--json"))
    assert (problem["file"], problem["key"], problem["value"]) == ("flat.yaml", "solver", "5")


def told(found):
    """Where each problem is, and its key, or what was given where it has none."""
    assert found[0] == 2
    return [(one["file"], one["key"] or one["value"]) for one in problems(found)]


def test_where_a_value_of_set_leaves_no_place_for_another_option_set_is_told(command):
    bar = str(DATA / "cantilever_bar.yaml")
    found = command("simulate", bar, "--set", "GeneralizedAlpha=3", "--end", "0.1", "-o", "a.nc", "--json")
    assert told(found) == [("--set", "GeneralizedAlpha")]
    Path("never.yaml").write_text(HOIST.replace("end: 12 s", "end: never"), encoding="utf8")
    found = command("simulate", "never.yaml", "--set", "solver=3", "--end", "0.1", "-o", "a.nc", "--json")
    assert told(found) == [("--set", "solver")]
    assert not Path("a.nc").exists()


WRONG = {
    "bodies[7].mass=6 t": "bodies[7]",
    "bodies[0].mass.x=6 t": "bodies[0].mass.x",
    "path[9].sheave.law=no_slip": "path[9]",
    "mass=[1,": "mass=[1,",
    "=1": "=1",
    "": "",
    "a[=1": "a[",
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_faulty_option_is_told_and_not_the_fault_of_the_file_that_another_replaces(command, wrong):
    for sets in (["bodies[0].mass=6 t", wrong], [wrong, "bodies[0].mass=6 t"]):
        found = command("check", "heavy.yaml", "--set", sets[0], "--set", sets[1], "--json")
        assert told(found) == [("--set", WRONG[wrong])]
    # What nothing replaces is told after it.
    found = command("check", "heavy.yaml", "--set", wrong, "--json")
    assert told(found) == [("--set", WRONG[wrong]), ("heavy.yaml", "bodies[0].mass")]


def test_all_faulty_options_are_told_at_once(command):
    sets = ["--set", "bodies[0].mass=6 t", "--set", "bodies[7].mass=1", "--set", "=1", "--set", "path[9].x=2"]
    assert set(told(command("check", "heavy.yaml", *sets, "--json"))) == {
        ("--set", "bodies[7]"), ("--set", "=1"), ("--set", "path[9]"),
    }  # fmt: skip


def test_commands_that_read_scenes_themselves_tell_faulty_options_and_the_file_alike(command, capsys):
    hose = own("gardenhose", capsys)
    Path("hose.yaml").write_text((DATA / "hose.yaml").read_text(encoding="utf8") + "\nnone_such: 1\n", encoding="utf8")
    found = hose("static", "hose.yaml", "--set", "none_such[3]=1", "--set", "=1", "--json")
    assert ("--set", "=1") in told(found) and ("hose.yaml", "none_such") in told(found)


def test_a_value_that_finds_no_place_changes_nothing_on_its_way():
    from tautline.scene.reading.document import Document, PartlyReplacedError

    with pytest.raises(PartlyReplacedError) as caught:
        Document.parse("a: 1").changed({"b.c[0].d": 1, "a": 2, "e.f": 3}, "--set")
    assert caught.value.document.root == {"a": 2, "e": {"f": 3}}
    (problem,) = pickle.loads(pickle.dumps(caught.value)).problems
    assert problem.key == "b.c[0]"


def test_a_number_of_another_base_may_be_replaced(command):
    Path("based.yaml").write_text(HOIST.replace("mass: 5 t,", "mass: 0x10,"), encoding="utf8")
    assert command("check", "based.yaml")[0] == 2
    assert command("check", "based.yaml", "--set", "bodies[0].mass=5 t")[0] == 0


def test_a_sweep_sets_what_its_scene_has_wrong(command):
    Path("several.yaml").write_text(
        "scene: heavy.yaml\nvary: {solver.step: [2 ms]}\ncollect: [max_tension]\n", encoding="utf8"
    )
    sets = ["--set", "bodies[0].mass=5 t", "--set", "solver.end=0.1 s"]
    code, _, err = command("sweep", "several.yaml", *sets, "-j", "1", "--quiet")
    assert code == 0, err


@pytest.mark.parametrize("made_of", ["text", "dict"])
def test_arguments_of_a_run_in_python_are_what_the_scene_is_validated_with(tmp_path, monkeypatch, made_of):
    monkeypatch.chdir(tmp_path)
    scene = short()
    if made_of == "dict":
        scene = dict(tautline.read(HOIST).written)
        scene["solver"] = {**scene["solver"], "end": "0.01 s"}
    with pytest.raises(tautline.SceneError, match=r"longer than the whole run \(0.01 s\)"):
        tautline.simulate(scene)
    assert tautline.simulate(scene, end="0.1 s").time[-1] == pytest.approx(0.1)
    with pytest.raises(tautline.SceneError, match=r"argument step"):
        tautline.simulate(scene, end="0.1 s", step="-1 ms")


def short():
    """A scene that ends before its first frame of the output."""
    return HOIST.replace("end: 12 s", "end: 0.01 s")


def test_studies_read_a_scene_with_the_end_that_they_are_given(tmp_path):
    from tautline.cli.commands.study import Options, prepared

    path = tmp_path / "short.yaml"
    path.write_text(short(), encoding="utf8")
    asked = {"tolerance": "1e-3", "point": None, "budget": 1.0, "quick": False, "changes": None}
    with pytest.raises(tautline.SceneError, match=r"longer than the whole run \(0.01 s\)"):
        prepared(Installed(), path, Options(end=None, **asked))
    subject, _ = prepared(Installed(), path, Options(end=0.2, **asked))
    assert subject.end == 0.2 and subject.scene.solver.end == 0.2
    assert tautline._subject(short(), "0.2 s").end == 0.2
    assert tautline._subject(tautline.read(HOIST), "0.2 s").end == 0.2
    assert tautline._subject(HOIST, None).end is None
