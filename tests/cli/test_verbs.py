"""The verbs: exit codes, the JSON object, files, and what a person is told."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import fake_application
import numpy as np
import pytest

from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.results.result import Result

FAKE = Path(__file__).with_name("fake_application.py")

SIMULATE_KEYS = {"scene", "result", "status", "method", "step", "end", "frames", "steps", "newton_iterations"}
SIMULATE_KEYS |= {"wall_time", "total_time", "real_time_factor", "energy_error"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("good.yaml").write_text("fake: true\n")
    for trouble in ("stops", "bug", "unbuildable", "warning"):
        Path(f"{trouble}.yaml").write_text(f"fake: true\ntrouble: {trouble}\n")
    Path("foreign.yaml").write_text("title: nothing\n")
    return tmp_path


def fake(*arguments, **environment):
    command = [sys.executable, FAKE, *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=os.environ | environment, timeout=60)


@pytest.fixture
def fake_here(monkeypatch, capsys):
    """The same in this process, for what many cases show: to start one takes a hundred times longer than to refuse."""
    stub = SimpleNamespace(simulate=fake_application.simulate)
    monkeypatch.setitem(sys.modules, "tautline.simulation", stub)

    def call(*arguments):
        with pytest.raises(SystemExit) as ended:
            run(make_app(fake_application.FakeApplication()), arguments)
        printed = capsys.readouterr()
        return SimpleNamespace(returncode=ended.value.code, stdout=printed.out, stderr=printed.err)

    return call


def only_object(done):
    """The one JSON object on standard output; Python's own reader would let NaN pass."""
    return json.loads(done.stdout, parse_constant=lambda word: pytest.fail(f"{word} in JSON"))


def test_simulate_writes_the_result_and_says_what_to_type_next(folder):
    done = fake("simulate", "good.yaml")
    assert done.returncode == 0 and done.stdout == ""
    assert len(Result.read("good.nc").time) == 20
    assert f"Next: python {FAKE} plot good.nc" in done.stderr  # a script, of which no command is installed
    for words in ("real-time factor", "faster than real time", "Newton iterations per step", "3 MN", "step halvings"):
        assert words in done.stderr


def test_simulate_json_is_one_object_with_the_promised_keys_and_no_nan(folder, fake_here):
    report = only_object(
        fake_here("simulate", "good.yaml", "--json", "-o", "other.nc", "--method", "rk4", "--end", "1")
    )
    assert report.keys() >= SIMULATE_KEYS
    assert (report["status"], report["result"], report["scene"]) == ("done", "other.nc", "good.yaml")
    assert (report["method"], report["end"], report["frames"]) == ("rk4", 1.0, 10)
    assert report["energy_error"] is None and report["odd"] is None and report["largest_tension"] > 3e6


@pytest.mark.parametrize("cold", ["1", "0"])
def test_quiet_prints_nothing_and_nothing_of_compiling(folder, fake_here, monkeypatch, cold):
    monkeypatch.setenv("FAKE_COLD", cold)
    done = fake_here("simulate", "good.yaml", "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize(("cold", "said"), [("1", True), ("0", False)])
def test_kernels_to_be_compiled_are_announced_before_the_wait(folder, fake_here, monkeypatch, cold, said):
    monkeypatch.setenv("FAKE_COLD", cold)
    assert ("first run of this kind of scene" in fake_here("simulate", "good.yaml").stderr) is said


def test_warnings_are_printed_before_a_run_and_by_check(folder, fake_here):
    assert "warning: solver.step: longer than" in fake_here("simulate", "warning.yaml", "--quiet").stderr
    report = only_object(fake_here("check", "warning.yaml", "--json"))
    assert report["warnings"] == [{"where": "solver.step", "text": "longer than the critical step"}]
    assert report["length"] == 1.0
    assert not Path("check.nc").exists()
    report = only_object(fake_here("simulate", "warning.yaml", "--json"))
    assert report["scene_warnings"] == [{"where": "solver.step", "text": "longer than the critical step"}]


BAD_INPUT = [
    (["simulate", "missing.yaml"], "there is no such file"),
    (["simulate", "foreign.yaml"], "foreign.yaml:1: fake: is missing"),
    (["simulate", "unbuildable.yaml"], "fake.yaml:3: trouble = unbuildable"),
    (["simulate", "good.yaml", "--step", "-1"], "--step -1: must be greater than zero"),
    (["simulate", "good.yaml", "--step", "soon"], "--step"),
    (["simulate", "good.yaml", "-o", "nowhere/a.nc"], "there is no folder nowhere"),
    (["simulate", "good.yaml", "-o", "."], "is a folder"),
    (["simulate", "good.yaml", "-o", "good.yaml"], "it would be lost"),
    (["simulate", "good.yaml", "--stepp", "1"], "--stepp"),
    (["simulate"], "SCENE"),
    (["simulat", "good.yaml"], "simulat"),
    (["check", "foreign.yaml"], "foreign.yaml:1"),
    (["plot", "missing.nc"], "there is no such file"),
    (["plot", "good.yaml"], "is not a NetCDF-4 file"),
    (["new", "ship"], "there is no template 'ship'; known: pendulum, other"),
    (["new", "-o", "good.yaml"], "exists; name another"),
    (["new", "-o", "nowhere/a.yaml"], "there is no folder nowhere"),
    (["schema", "-o", "."], "is a folder"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_INPUT)
def test_bad_input_exits_with_2_names_the_fault_and_writes_nothing(folder, fake_here, arguments, message):
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    done = fake_here(*arguments)
    assert done.returncode == 2
    assert message in done.stderr and "Traceback" not in done.stderr and done.stdout == ""
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before


@pytest.mark.parametrize(
    "arguments", [["simulate", "foreign.yaml"], ["check", "foreign.yaml"], ["simulate", "--nonsense"]]
)
def test_bad_input_with_json_is_an_object_of_problems(folder, fake_here, arguments):
    done = fake_here(*arguments, "--json")
    report = only_object(done)
    assert done.returncode == 2 and report["status"] == "bad input"
    assert report["problems"][0].keys() == {"file", "line", "key", "value", "cause", "cure"}


@pytest.mark.parametrize(
    "arguments", [["simulate", "foreign.yaml"], pytest.param(["simulat", "good.yaml"], marks=pytest.mark.study)]
)
def test_a_process_ends_so_too(folder, fake_here, arguments):
    done, here = fake(*arguments), fake_here(*arguments)
    assert done.returncode == here.returncode == 2
    assert done.stderr.split() == here.stderr.split() and done.stdout == here.stdout == ""


def test_a_run_that_stops_early_exits_with_3_and_keeps_its_result(folder, fake_here):
    done = fake_here("simulate", "stops.yaml", "--json")
    report = only_object(done)
    assert done.returncode == 3 and report["status"] == "not converged"
    assert report["stopped"]["part"] == "link 2" and report["frames"] == len(Result.read("stops.nc").time) == 10
    assert "stopped at t = 1 s, link 2: the iterations of a step did not converge" in done.stderr


def interrupted_run(*arguments):
    command = [sys.executable, FAKE, "simulate", "good.yaml", "--end", "1000", *arguments]
    environment = os.environ | {"FAKE_PAUSE": "0.1"}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    deadline = time.monotonic() + 30
    while not Path("good.nc").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    return process


def test_ctrl_c_exits_with_130_and_keeps_the_result(folder):
    process = interrupted_run("--json")
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=30)
    assert process.returncode == 130 and "Traceback" not in errors
    assert json.loads(output)["status"] == "interrupted"
    result = Result.read("good.nc")
    assert result.attributes["status"] == "interrupted" and len(result.time) >= 10
    assert sorted(file.name for file in folder.iterdir() if file.name.startswith(".")) == []


def test_kill_9_keeps_every_frame_that_was_stored(folder, fake_here):
    process = interrupted_run()
    time.sleep(0.25)
    process.kill()
    process.communicate()
    result = Result.read("good.nc")
    assert result.attributes["status"] == "running"
    np.testing.assert_array_equal(result["angle"], np.cos(result.time))
    assert fake_here("plot", "good.nc").returncode == 0


def test_an_unforeseen_error_is_one_line_and_exit_1(folder, fake_here):
    done = fake_here("simulate", "bug.yaml")
    assert done.returncode == 1 and len(done.stderr.splitlines()) == 1
    assert "unexpected ZeroDivisionError: nobody foresaw this" in done.stderr
    # The application of this test is none of ours.
    assert "this file is no part of the program: correct it there" in done.stderr
    assert only_object(fake_here("simulate", "bug.yaml", "--json"))["status"] == "internal error"


@pytest.mark.parametrize("arguments", [["--debug", "simulate", "bug.yaml"], ["simulate", "bug.yaml", "--debug"]])
def test_debug_shows_the_traceback_wherever_it_stands(folder, fake_here, arguments):
    done = fake_here(*arguments)
    assert done.returncode == 1 and "Traceback (most recent call last)" in done.stderr


def test_a_reader_that_went_away_is_no_error(folder):
    for arguments in ("schema", "new --list", "simulate good.yaml --json --quiet"):
        command = f"{sys.executable} {FAKE} {arguments} | true; echo ${{PIPESTATUS[0]}}"
        done = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
        assert (done.stdout.strip(), done.stderr) == ("0", "")


def test_plot_takes_a_folder_or_a_file_and_chooses_the_format_by_its_name(folder, fake_here):
    fake_here("simulate", "good.yaml", "--quiet")
    report = only_object(fake_here("plot", "good.nc", "-o", "figures", "--format", "svg", "--json"))
    assert report["figures"] == ["figures/good_overview.svg", "figures/good_tension.svg"]
    named = only_object(fake_here("plot", "good.nc", "-o", "a.pdf", "--what", "tension", "--json"))
    assert named["figures"] == ["a.pdf"]
    for arguments in (["--what", "nonsense"], ["--format", "bmp"], ["-o", "a.png", "--format", "pdf"], ["-o", "x/y/z"]):
        assert fake_here("plot", "good.nc", *arguments).returncode == 2


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("good.nc/x", "good.nc/x: good.nc is a file, not a folder"),
        ("nowhere/x", "there is no folder nowhere; make it, mkdir -p nowhere"),
        ("/proc/x", "/proc/x: cannot be made"),
    ],
)
def test_plot_says_why_a_folder_cannot_be_made(folder, fake_here, place, message):
    fake_here("simulate", "good.yaml", "--quiet")
    done = fake_here("plot", "good.nc", "-o", place)
    assert done.returncode == 2 and message in " ".join(done.stderr.split())
    assert "there is no folder /proc" not in done.stderr


def test_new_writes_a_starter_scene_and_overwrites_only_when_forced(folder, fake_here):
    assert fake_here("new").returncode == 0
    assert Path("pendulum.yaml").read_text().startswith("# A pendulum.")
    Path("pendulum.yaml").write_text("mine\n")
    assert fake_here("new").returncode == 2 and Path("pendulum.yaml").read_text() == "mine\n"
    assert fake_here("new", "other", "-o", "pendulum.yaml", "--force").returncode == 0
    assert Path("pendulum.yaml").read_text().startswith("# Another.")
    assert fake_here("new", "-o", "-").stdout == "# A pendulum.\nfake: true\n"


def test_new_lists_its_templates_and_writes_nothing(folder, fake_here):
    before = list(folder.iterdir())
    done = fake_here("new", "--list")
    assert done.stdout.split() == ["pendulum", "A", "pendulum.", "other", "Another."]
    assert list(folder.iterdir()) == before


@pytest.mark.parametrize("beside", [("-o", "mine.yaml"), ("other",), ("--force",)])
def test_a_list_of_templates_refuses_what_says_which_file_is_written(folder, fake_here, beside):
    before = list(folder.iterdir())
    done = fake_here("new", "--list", *beside)
    assert done.returncode == 2 and "has no effect beside --list" in done.stderr
    assert list(folder.iterdir()) == before


def test_schema_prints_json(folder, fake_here):
    assert json.loads(fake_here("schema").stdout)["title"] == "fake"
    assert fake_here("schema", "-o", "schema.json").returncode == 0
    assert json.loads(Path("schema.json").read_text())["title"] == "fake"
