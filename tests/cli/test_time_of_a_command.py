"""The time of a whole command, and what is not made for it."""

import json
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.main import get_command

from drillstring.application import Drillstring
from tautline.cli.output import duration
from tautline.cli.verbs import SHARED, make_app
from tautline.results.result import Result

DATA = Path(__file__).parents[2] / "data"


def names(arguments):
    return set(get_command(make_app(Drillstring(), arguments)).commands)


def test_the_total_time_counts_from_the_start_of_the_process_and_holds_that_of_the_loop(tmp_path):
    script = "import time; time.sleep(0.3); from drillstring.main import main; main()"
    words = ["simulate", DATA / "jwell.yaml", "--end", "0.1", "-o", tmp_path / "j.nc", "--json", "--no-verify"]
    before = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", script, *words], capture_output=True, text=True, check=True)
    waited = time.perf_counter() - before
    report = json.loads(done.stdout)
    assert 0.28 + report["wall_time"] < report["total_time"] < waited + 0.02
    assert "total time of the command" in done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="a process does not become another program there")
def test_a_script_that_becomes_the_command_is_no_part_of_its_time(tmp_path):
    words = ["check", str(DATA / "jwell.yaml")]
    told = "from atexit import register; from tautline.cli.output.duration import total_time; "
    run = "register(lambda: print(total_time())); from drillstring.main import main; main()"
    command = [sys.executable, "-c", told + run, *words]
    script = ["sh", "-c", 'sleep 1; exec "$@"', "sh", *command]
    before = time.perf_counter()
    done = subprocess.run(script, capture_output=True, text=True, check=True)
    assert 0.0 < float(done.stdout.split()[-1]) < time.perf_counter() - before - 0.9


def test_where_no_system_tells_when_a_process_started_the_time_counts_from_the_import(monkeypatch):
    monkeypatch.setattr(duration, "STAT", Path("nowhere"))
    monkeypatch.setattr(duration, "_had_children", lambda: False)
    before = duration.total_time()
    duration.begin(of_process=True)
    assert before <= duration.total_time() < before + 5.0
    duration.begin(of_process=False)
    assert duration.total_time() < 5.0


@pytest.mark.parametrize("arguments", [["simulate", "a.yaml"], ["--debug", "check", "a.yaml"]])
def test_for_a_shared_verb_no_other_is_made(arguments):
    assert names(arguments) == {next(one for one in arguments if not one.startswith("-"))}


@pytest.mark.parametrize("arguments", [[], ["--help"], ["torque-drag", "a.yaml"], ["simulat", "a.yaml"]])
def test_all_verbs_are_made_where_help_an_unknown_verb_or_one_of_the_application_is_asked_for(arguments):
    assert names(arguments) == names(()) > {verb.__name__ for verb in SHARED} - {"torque-drag"}


@pytest.mark.parametrize("name", ["jwell", "hoist", "reeled_span"])
def test_a_result_that_was_just_written_knows_its_variables_as_its_file_has_them(name, tmp_path):
    import tautline

    scene = tautline.read(DATA / f"{name}.yaml")
    key = "GeneralizedAlpha.time_end" if name == "reeled_span" else "solver.end"
    made = tautline.simulate(scene.replace({key: 0.1}), tmp_path / "r.nc")
    assert list(made.variables.items()) == list(Result.read(made.path).variables.items())
