"""``--set key=value``: every verb that takes a scene takes it with other values, by the names of ``scene.replace``."""

import subprocess
import sys
from pathlib import Path

import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object
from typer.main import get_command

import tautline
from tautline.application.installed import Installed
from tautline.cli.verbs import make_app
from tautline.results.result import Result

DATA = Path(__file__).parents[3] / "data"
TAKE_NO_SCENE = {"plot", "render", "export", "new", "schema", "tubulars"}


@pytest.fixture
def command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    leave_out_pixels(monkeypatch)
    for file in DATA.glob("*.yaml"):
        Path(file.name).write_text(file.read_text(encoding="utf8"), encoding="utf8")
    return commands_of(Installed(), capsys)


def own(name, capsys):
    return commands_of(next(one for one in Installed().all() if one.name == name), capsys)


def all_commands():
    for application in Installed().all():
        for name, one in get_command(make_app(application)).commands.items():
            yield application.name, name, one


def test_every_verb_that_takes_a_scene_takes_other_values_for_it():
    options = {(app, name): {o for p in one.params for o in p.opts} for app, name, one in all_commands()}
    missing = {name for (_, name), known in options.items() if "--set" not in known}
    assert missing == TAKE_NO_SCENE
    assert {"torque-drag", "campbell", "form", "stick-slip", "static", "flutter"} <= {name for _, name in options}


def test_simulate_runs_the_changed_scene_and_the_result_tells_it(command):
    sets = ["--set", "bodies[0].mass=6 t", "--set", "solver.end=100 ms"]
    code, out, err = command("simulate", "hoist.yaml", *sets, "--json", "--quiet")
    assert code == 0, err
    result = Result.read(only_object(out)["result"])
    scene = tautline.read(result.attributes["scene"])
    assert (scene.bodies[0].mass, scene.solver.end) == (6000.0, 0.1)
    assert "bodies[0].mass, by --set" in result.attributes["scene"]
    assert result.time[-1] == pytest.approx(0.1)


def test_check_looks_at_the_changed_scene_and_names_the_next_command_with_it(command):
    code, _, err = command("check", "hoist.yaml", "--set", "bodies[0].mass=6 t")
    assert code == 0 and "simulate hoist.yaml --set 'bodies[0].mass=6 t'" in err
    assert "warning" not in err
    _, _, err = command("check", "hoist.yaml", "--set", "vessel.motion.heave.harmonic.period=20 ms")
    assert "warning: solver.step" in err


def test_values_are_read_as_yaml(command):
    changes = ["solver.step=1 ms", "solver.end=0.1", "title='a: b'  # a title"]
    changes += ["path[0].drum.pay_out={ramp: {to: -0.2 m/s, over: 2}}", "gravity=[0, 0, -1.62]"]
    sets = [word for change in changes for word in ("--set", change)]
    code, out, err = command("simulate", "hoist.yaml", *sets, "--json", "--quiet")
    assert code == 0, err
    scene = tautline.read(Result.read(only_object(out)["result"]).attributes["scene"])
    assert (scene.solver.step, scene.solver.end, scene.title, scene.gravity[2]) == (0.001, 0.1, "a: b", -1.62)
    assert scene.drums[0].pay_out.to == -0.2


def test_an_option_of_its_own_counts_more_than_the_same_key_that_is_set(command):
    sets = ["--set", "solver.end=0.1", "--set", "solver.step=4 ms", "--step", "2 ms"]
    code, out, _ = command("simulate", "hoist.yaml", *sets, "--json", "--quiet")
    scene = tautline.read(Result.read(only_object(out)["result"]).attributes["scene"])
    assert code == 0 and (scene.solver.end, scene.solver.step) == (0.1, 0.002)


def test_a_key_that_is_set_twice_is_refused(command):
    code, out, _ = command("simulate", "hoist.yaml", "--set", "solver.end=9", "--set", "solver.end = 0.1", "--json")
    (problem,) = only_object(out)["problems"]
    assert (code, problem["file"], problem["value"]) == (2, "--set", "solver.end = 0.1")
    assert problem["cause"] == "gives solver.end a second time"
    assert not Path("hoist.nc").exists()


BAD = {
    "bodies[0].mas=6 t": ("bodies[0].mas", "6 t", "unknown key", "did you mean 'mass'?"),
    "bodies[0].mass=6 m": ("bodies[0].mass", "6 m", "'m' is not the unit of a mass", "5 t"),
    "bodies[0].mass=": ("bodies[0].mass", None, "is empty", "give a mass"),
    "solver.step": ("", "solver.step", "is no key with a value", "--set 'solver.step=2 ms'"),
    "=3": ("", "=3", "is no key with a value", "--set 'solver.step=2 ms'"),
    "bodies[0.mass=3": ("", "bodies[0.mass", "is no name of a key", "string[0].od"),
    "title=a\nunits: field": ("", "title=a\nunits: field", "is more than one key", "--set again"),
    "gravity=[0, 0": ("", "gravity=[0, 0", "the bracket [ is not closed", "write ]"),
    "solver.end=!!python/object:x": ("", "solver.end=!!python/object:x", "is not allowed", "remove the tag"),
}


@pytest.mark.parametrize("text", BAD)
def test_a_value_that_cannot_be_ends_with_code_2_and_key_value_cause_and_cure(command, text):
    key, value, cause, cure = BAD[text]
    code, out, err = command("simulate", "hoist.yaml", "--set", text, "--json")
    (problem,) = only_object(out)["problems"]
    assert (code, problem["file"], problem["key"], problem["value"]) == (2, "--set", key, value)
    assert cause in problem["cause"] and cure in problem["cure"] and "--set" in err
    assert not Path("hoist.nc").exists()


ALL = [
    ("crane", "check", "hoist.yaml"), ("crane", "simulate", "hoist.yaml"), ("crane", "study", "hoist.yaml"),
    ("crane", "stability", "hoist.yaml"), ("cable", "check", "cantilever_bar.yaml"),
    ("cable", "simulate", "cantilever_bar.yaml"), ("gardenhose", "static", "hose.yaml"),
    ("gardenhose", "flutter", "hose.yaml"), ("drillstring", "form", "hanging.yaml"),
    ("drillstring", "torque-drag", "jwell.yaml"), ("drillstring", "campbell", "whirl.yaml"),
    ("drillstring", "stick-slip", "drilling.yaml"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "verb", "scene"), ALL, ids=[f"{name} {verb}" for name, verb, _ in ALL])
def test_every_verb_refuses_an_unknown_key_with_the_nearest(command, capsys, name, verb, scene):
    section, key = ("GeneralizedAlpha", "time_end") if name == "cable" else ("solver", "end")
    code, out, _ = own(name, capsys)(verb, scene, "--set", f"{section}.{key}x=1", "--json")
    (problem,) = only_object(out)["problems"]
    assert (code, problem["file"], problem["key"]) == (2, "--set", f"{section}.{key}x")
    assert problem["cure"] == f"did you mean '{key}'?"


def test_the_verbs_of_drill_strings_and_hoses_look_at_the_changed_scene(command, capsys):
    drillstring, gardenhose = own("drillstring", capsys), own("gardenhose", capsys)
    weight = [
        only_object(drillstring("torque-drag", "jwell.yaml", "--elements", 24, *sets, "--json")[1])["rotating"][0]
        for sets in ([], ["--set", "mud.density=1000 kg/m^3"])
    ]
    assert weight[1] > 1.1 * weight[0]
    depth = [
        only_object(drillstring("form", "hanging.yaml", *sets, "--json")[1])["position"][-1][2]
        for sets in ([], ["--set", "material.density=15000 kg/m^3"])
    ]
    assert depth[1] != depth[0]
    tips = [
        only_object(gardenhose("static", "hose.yaml", "--speed", "0", *sets, "--json")[1])["tip"][0]
        for sets in ([], ["--set", "gravity=[0, 0, 0.1]"])
    ]
    assert tips[1][2] > tips[0][2]


def test_a_process_ends_with_code_2(tmp_path):
    command = [sys.executable, "-m", "crane.main", "check", str(DATA / "hoist.yaml"), "--set", "solver.stp=1"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2 and "did you mean 'step'?" in done.stderr and "Traceback" not in done.stderr
