"""The status that a file holds is the one that the command said, however a run ends."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest
import pyvista
import yaml
from cli.in_process import commands_of, only_object
from physics.lifting.crane_scenes import fall, hoist

import tautline
from crane.application import Crane
from tautline.integrators.status import Status, StoppedEarly
from tautline.interruption import ended_by_signal
from tautline.results.naming import shortfall
from tautline.results.result import Result
from tautline.results.variable import Variable
from tautline.run import Run
from tautline.study.trials import step_error
from tautline.twin.twin import Twin

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"
MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
ahead: 0 s
"""
RUNS = {
    "done": (fall(), 0),
    "imbalance": (fall(load={"velocity": [1.0, 0.0, 0.0]}), 3),
    "unstable": (fall(solver={"method": "rk4", "step": 0.01}), 3),
    "not converged": (
        hoist(solver={"max_iterations": 1, "max_halvings": 0, "tolerance": 1e-13, "control": "fixed"}),
        3,
    ),
    "two blocked": (hoist(drive={"pay_out": {"ramp": {"to": -48.0, "over": 4.0}}}, solver={"end": 4.0}), 3),
    "interrupted": (fall(), 130),
}
"""What a run ends as, the scene, and the exit code."""


def press_ctrl_c(*_, **__):
    os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.parametrize("ending", RUNS)
def test_the_file_says_of_its_run_what_the_command_said(ending, tmp_path, capsys, monkeypatch):
    scene, expected = RUNS[ending]
    if ending == "imbalance":
        # No share of energy is small enough any more.
        monkeypatch.setattr("tautline.run.GAINED", -1.0)
    if ending == "interrupted":
        steps = Run._advance  # its first batch is of one frame
        monkeypatch.setattr(Run, "_advance", lambda self, store: (steps(self, store), press_ctrl_c()))
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scene))
    command = commands_of(Crane(), capsys)
    code, out, _ = command("simulate", tmp_path / "scene.yaml", "-o", tmp_path / "r.nc", "--json", "--no-verify")
    report = only_object(out)
    assert (code, report["status"]) == (expected, ending)
    result = tautline.Result.read(tmp_path / "r.nc")
    assert result.attributes["status"] == ending
    if ending != "interrupted":
        assert result.attributes["steps"] > 0 or ending == "unstable"


SWINGING = fall(load={"velocity": [1.0, 0.0, 0.0]})


def in_the_last_frames(monkeypatch, send):
    steps = Run._advance

    def advance(self, store):
        steps(self, store)
        if self.done == self.ends.size:
            send()

    monkeypatch.setattr(Run, "_advance", advance)


def before_the_look(monkeypatch, send):
    monkeypatch.setattr(step_error, "watch", send)


def in_the_first_run_of_the_look(monkeypatch, send):
    runs, begin = [], Run.start
    monkeypatch.setattr(Run, "start", lambda self: (begin(self), runs.append(self), len(runs) == 2 and send()))


@pytest.mark.parametrize("phase", [in_the_last_frames, before_the_look, in_the_first_run_of_the_look])
@pytest.mark.parametrize("name", ["SIGINT", "SIGHUP", "SIGTERM"])
def test_a_run_whose_frames_are_all_there_is_done_whichever_signal_ends_the_look_at_its_error(
    name, phase, tmp_path, capsys, monkeypatch
):
    if not hasattr(signal, name):
        pytest.skip(f"there is no {name} here")
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(SWINGING))
    phase(monkeypatch, lambda *_, **__: os.kill(os.getpid(), getattr(signal, name)))
    with ended_by_signal():
        code, out, _ = commands_of(Crane(), capsys)(
            "simulate", tmp_path / "scene.yaml", "-o", tmp_path / "r.nc", "--json", "--verify"
        )
    report, end = only_object(out), SWINGING["solver"]["end"]
    assert (code, report["status"], report["simulated_time"], report["step_error"]) == (0, "done", end, None)
    told = "the error due to the time step is not known: the run that was to show it was interrupted"
    result = tautline.Result.read(tmp_path / "r.nc")
    assert told in report["warnings"] and told in result.warnings
    assert result.attributes["status"] == "done" and result.time[-1] == end


def test_a_run_without_a_look_that_is_interrupted_in_its_last_frames_is_done(tmp_path, capsys, monkeypatch):
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(fall()))
    in_the_last_frames(monkeypatch, press_ctrl_c)
    command = commands_of(Crane(), capsys)
    code, out, _ = command("simulate", tmp_path / "scene.yaml", "-o", tmp_path / "r.nc", "--json", "--no-verify")
    assert (code, only_object(out)["status"]) == (0, "done")


def test_a_run_for_an_accuracy_that_is_interrupted_behind_its_last_frame_is_interrupted(tmp_path, capsys, monkeypatch):
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(fall()))
    in_the_last_frames(monkeypatch, press_ctrl_c)
    command = commands_of(Crane(), capsys)
    code, out, _ = command("simulate", tmp_path / "scene.yaml", "-o", tmp_path / "r.nc", "--json", "--accuracy", "1 %")
    assert (code, only_object(out)["status"]) == (130, "interrupted")


def test_a_twin_that_cannot_go_on_leaves_its_status_in_its_file(tmp_path, capsys, monkeypatch):
    command = commands_of(Crane(), capsys)
    (tmp_path / "map.yaml").write_text(MAP)
    record = tmp_path / "r.csv"
    assert command("record", HOIST, "--map", tmp_path / "map.yaml", "-o", record, "--end", "1 s")[0] == 0
    answered = Twin.add

    def add(self, time, *given):
        if time > 0.5:
            raise tautline.StoppedEarly(Status.TWO_BLOCKED, time, "payload")
        return answered(self, time, *given)

    monkeypatch.setattr(Twin, "add", add)
    code, _, told = command(
        "twin", HOIST, "--map", tmp_path / "map.yaml", "--source", record, "-o", tmp_path / "t.nc", "--json"
    )
    assert code == 3 and "stopped" in told
    result = tautline.Result.read(tmp_path / "t.nc")
    assert result.attributes["status"] == "two blocked" and result.time[-1] <= 0.5


def test_a_live_result_names_how_its_simulation_stopped(monkeypatch):
    sim = tautline.Simulation(fall())
    assert sim.result.attributes["status"] == "done"
    sim.add_force(lambda t, q, v: [0.0, 0.0, float("nan") if t > 0.05 else 0.0], on="payload.position")
    with pytest.raises(tautline.StoppedEarly) as stop:
        sim.advance(0.1)
    assert stop.value.result.attributes["status"] == sim.result.attributes["status"] == "no force"
    sim = tautline.Simulation(fall())
    sim.advance(0.1)
    monkeypatch.setattr("tautline.run.GAINED", -1.0)
    assert sim.result.attributes["status"] == "imbalance"


def test_a_live_result_of_an_advance_that_was_interrupted_says_so_and_the_next_does_not():
    sim = tautline.Simulation(fall())
    sim.advance(0.1)
    observe = sim._arrive
    sim._arrive = lambda end: (observe(end), press_ctrl_c())
    with pytest.raises(tautline.Interrupted) as stop:
        sim.advance(0.1)
    assert stop.value.result.attributes["status"] == "interrupted"
    sim._arrive = observe
    sim.advance(0.1)
    assert sim.result.attributes["status"] == "done"


MISSING = "stopped early: two blocked, last frame at "


@pytest.fixture(scope="module")
def blocked(tmp_path_factory):
    """A result of a run that two-blocked."""
    path = tmp_path_factory.mktemp("blocked") / "r.nc"
    scene = RUNS["two blocked"][0]
    scene["rope"] = scene["rope"] | {"diameter": 0.03}  # bending is told by it
    (path.parent / "scene.yaml").write_text(yaml.safe_dump(scene))
    with pytest.raises(StoppedEarly):
        tautline.simulate(path.parent / "scene.yaml", path)
    return path


def test_figures_of_a_run_that_stopped_early_say_so_in_their_headings(blocked):
    result = tautline.Result.read(blocked)
    words = f"{MISSING}{result.time[-1]:g} s"
    for name in ("overview", "path", "tension", "winch", "energy", "bending"):
        assert " ".join(result.plot(name).get_suptitle().splitlines()[1:]) == words, name
    both = result.plot("drum_tension", beside=[result])
    assert " ".join(both.get_suptitle().split()).count(MISSING) == 2


def test_commands_that_show_a_run_that_stopped_early_say_so_and_so_do_their_files(blocked, tmp_path, capsys):
    command = commands_of(Crane(), capsys)
    for words in (
        ("plot", blocked, "-o", tmp_path / "figures", "--what", "overview"),
        ("render", blocked, "--html", tmp_path / "page.html"),
        ("export", blocked, "--vtk", "--every", "1000", "-o", tmp_path / "frames"),
    ):
        code, out, said = command(*words, "--json")
        assert code == 0 and MISSING in said, words[0]
        (warning,) = only_object(out)["warnings"]
        assert warning["where"] == str(blocked) and MISSING in warning["text"], words[0]
    assert MISSING in (tmp_path / "page.html").read_text()
    held = [pyvista.read(file).field_data for file in (tmp_path / "frames").glob("*.vtp")]
    assert any(MISSING in str(one["notes"]) for one in held if "notes" in one)


def test_a_whole_run_is_shown_without_a_word_on_its_end(tmp_path, capsys):
    tautline.simulate(yaml.safe_dump(fall()), path=tmp_path / "r.nc")
    result = tautline.Result.read(tmp_path / "r.nc")
    assert len(result.plot("energy").get_suptitle().splitlines()) == 1
    code, _, said = commands_of(Crane(), capsys)("render", tmp_path / "r.nc", "--html", tmp_path / "page.html")
    assert code == 0 and "early" not in said and "unfinished" not in said


@pytest.mark.parametrize(
    ("status", "words"),
    [
        ("done", ""),
        ("running", "unfinished: the run goes on, or was killed, last frame at 2 s"),
        ("interrupted", "stopped early: interrupted, last frame at 2 s"),
        ("imbalance", "the energy of the run does not balance"),
        ("not converged", "stopped early: not converged, last frame at 2 s"),
    ],
)
def test_what_is_missing_of_a_run_is_told_for_every_status(status, words):
    time = Variable("time", ("time",), "s", "time")
    result = Result(None, ([time], {"time": np.array([0.0, 2.0])}, {}, {"status": status}, {}))
    assert shortfall(result) == words
    of_a_twin = Result(
        None, ([time], {"time": np.array([0.0, 2.0])}, {}, {"status": status, "application": "twin"}, {})
    )
    assert (shortfall(of_a_twin) == "") == (status != "not converged")
