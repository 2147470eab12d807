"""A command before it has begun: Ctrl-C while it imports, and what it says while it prepares a scene."""

import json
import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest

from tautline.cli.output import preparing

PRESSED = """
import signal, sys
class Pressed:
    def find_spec(self, name, path, target=None):
        if name == {name!r}:
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Pressed())
sys.argv = ["command", "simulate", "none.yaml", *{more!r}]
from {script} import main
main()
"""


@pytest.mark.parametrize("script", ["crane.main", "drillstring.main", "gardenhose.main", "tautline.cli.main"])
@pytest.mark.parametrize("name", ["tautline.cli.run", "typer", "tautline.kernels.machine.gc_tuning"])
def test_ctrl_c_while_a_command_imports_ends_it_with_a_word_and_its_code(script, name):
    code = PRESSED.format(script=script, name=name, more=[])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr, done.stdout) == (130, "\ninterrupted\n", "")


def test_ctrl_c_while_a_command_imports_is_told_to_programs_too():
    code = PRESSED.format(script="crane.main", name="typer", more=["--json"])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 130 and json.loads(done.stdout) == {"status": "interrupted"}


@pytest.fixture
def said(monkeypatch):
    """What is said, and an event that it is; nobody waits long."""
    told, event = [], threading.Event()
    monkeypatch.setattr(preparing, "PATIENCE", 0.01)
    monkeypatch.setattr(preparing, "say", lambda text: (told.append(text), event.set()))
    return told, event


SCENE = SimpleNamespace(solver=SimpleNamespace(end=20000.0))


def test_a_long_preparation_is_told_with_the_length_of_the_run(said):
    told, event = said
    with preparing.preparing(Path("landing.yaml"), SCENE):
        assert event.wait(10.0)
    assert len(told) == 1 and told[0].startswith("preparing landing.yaml, 20000 s: ")


def test_of_a_short_preparation_nothing_is_told_and_of_a_quiet_one_neither(said, monkeypatch):
    told, event = said
    with preparing.preparing(Path("landing.yaml"), SCENE, quiet=True):
        assert not event.wait(0.1)
    monkeypatch.setattr(preparing, "PATIENCE", 0.3)
    with preparing.preparing(Path("landing.yaml"), SCENE):
        pass
    assert not event.wait(0.5) and told == []


def test_a_command_says_that_it_prepares_before_it_says_that_it_simulates(said, monkeypatch, capsys, tmp_path):
    from cli.in_process import commands_of

    from crane.application import Crane

    told, event = said
    monkeypatch.setattr(Crane, "warnings", lambda self, scene: [] if event.wait(10.0) else None)
    monkeypatch.chdir(tmp_path)
    command = commands_of(Crane(), capsys)
    assert command("new", "lift", "-o", "lift.yaml")[0] == 0
    _, _, err = command("simulate", "lift.yaml", "--end", "20 ms", "--no-verify", "-o", "lift.nc")
    assert told[0].startswith("preparing lift.yaml, 0.02 s") and "simulating lift.yaml" in err
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
