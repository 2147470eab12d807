"""A run that was ended in any way is gone on with, and gives the same to the bit as one that was not."""

import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from cli.in_process import commands_of
from of_the_suite import studies
from results.forked import Forked

from tautline.application.installed import Installed
from tautline.cli.main import main

DATA = Path(__file__).parents[2] / "data"
COMMAND = [sys.executable, "-c", "import sys; from tautline.cli.main import main; sys.argv[0] = 'tautline'; main()"]
STEP = "0.02 ms"
"""So short that the first frames take some time, in which a run can be ended."""
FAR = "1000 s"
"""So far that no run comes to its end before it is ended, however slow the machine."""
MORE = 3
"""Frames that are still to come when a run is gone on with."""


def command(*arguments):
    return [*COMMAND, "simulate", *map(str, arguments), "--no-verify", "--quiet"]


@pytest.fixture
def here(capsys):
    """The command in this process, which has loaded the kernels: it is another than that which was ended."""

    def simulate(*arguments, code=0):
        left, _, err = commands_of(Installed(), capsys)(*command(*arguments)[len(COMMAND) :])
        assert left == code, err
        return err

    return simulate


def assert_same(path, other):
    with h5py.File(path) as one, h5py.File(other) as two:
        names = {name for name in one if isinstance(one[name], h5py.Dataset)}
        assert names == {name for name in two if isinstance(two[name], h5py.Dataset)}
        for name in names:
            first, second = np.asarray(one[name]), np.asarray(two[name])
            same = np.array_equal(first, second) if first.dtype.kind == "O" else first.tobytes() == second.tobytes()
            assert same, name
        assert one.attrs["status"] == two.attrs["status"] == "done"
        for name in ("steps", "newton_iterations", "energy_error", "headline"):
            assert one.attrs[name] == two.attrs[name], name


def forked(*arguments):
    """The command in a process of its own."""
    return Forked(as_script, command(*arguments)[len(COMMAND) :])


def anew(*arguments):
    """The command in a new Python process, which has to load all that it needs."""
    return subprocess.Popen(command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def as_script(words):
    sys.argv = ["tautline", *words]
    main()


def ended(path, name, number, wait, started=forked):
    """Start a run and end it by a signal once it has stored more than its first frame; returns its exit code."""
    process = started(DATA / f"{name}.yaml", "--end", FAR, "--step", STEP, "-o", path)
    deadline = time.monotonic() + 200.0
    while process.poll() is None and time.monotonic() < deadline:
        try:
            if path.exists():
                with h5py.File(path, "r", locking=False) as file:
                    if file["time"].size > 3:
                        break
        except OSError:
            pass
        time.sleep(0.02)
    assert process.poll() is None, process.communicate()
    time.sleep(wait)
    process.send_signal(number)
    process.communicate()
    return process.returncode


def a_little_later(path):
    """An end some frames after the last of a file, s."""
    with h5py.File(path) as file:
        times = file["time"][()]
    return f"{times[-1] + MORE * (times[-1] - times[-2]):.6g} s"


ENDS = [
    ("jwell", signal.SIGKILL), ("hoist", signal.SIGINT), ("hose", signal.SIGTERM), ("reeled_span", signal.SIGKILL),
]  # fmt: skip
"""Each application is ended in one way: the state is then that of the last batch, or of where the run ended.

That both ways of telling it come to the same is of no application."""
MORE_ENDS = [
    ("jwell", signal.SIGTERM), ("jwell", signal.SIGINT), ("hoist", signal.SIGKILL), ("hose", signal.SIGKILL),
    ("reeled_span", signal.SIGINT), ("hoist", signal.SIGHUP),
]  # fmt: skip


@pytest.mark.parametrize(("name", "number"), [*ENDS, *studies(*MORE_ENDS)])
def test_a_run_that_was_killed_or_told_to_end_goes_on_to_the_bit(name, number, here, tmp_path):
    path, scene = tmp_path / "ended.nc", DATA / f"{name}.yaml"
    assert ended(path, name, number, 0.05) == (-number if number == signal.SIGKILL else 130)
    with h5py.File(path) as file:
        stored, status = file["time"].size, file.attrs["status"]
        assert status == ("running" if number == signal.SIGKILL else "interrupted")
    end = a_little_later(path)
    here(scene, "--end", end, "--step", STEP, "-o", tmp_path / "on.nc", "--resume", path)
    here(scene, "--end", end, "--step", STEP, "-o", tmp_path / "whole.nc")
    with h5py.File(tmp_path / "on.nc") as file:
        assert file["time"].size == stored + MORE
    assert_same(tmp_path / "on.nc", tmp_path / "whole.nc")


def test_a_killed_run_goes_on_into_its_own_file(here, tmp_path):
    path, scene = tmp_path / "jwell.nc", DATA / "jwell.yaml"
    ended(path, "jwell", signal.SIGKILL, 0.0, anew)
    end = a_little_later(path)
    here(scene, "--end", end, "--step", STEP, "-o", path, "--resume", path)
    assert [file.name for file in tmp_path.iterdir()] == ["jwell.nc"]
    here(scene, "--end", end, "--step", STEP, "-o", tmp_path / "whole.nc")
    assert_same(path, tmp_path / "whole.nc")


def test_a_second_run_to_the_same_file_is_refused_by_the_command(here, tmp_path):
    path = tmp_path / "jwell.nc"
    first = forked(DATA / "jwell.yaml", "--step", "0.02 ms", "-o", path)
    try:
        while not path.exists() and first.poll() is None:
            time.sleep(0.01)
        told = here(DATA / "jwell.yaml", "--end", "1 s", "-o", path, code=2)
        assert f"process {first.pid} is writing this result" in told
    finally:
        first.kill()
        first.communicate()


def with_little_room(room, words):
    """The command where no file may have more bytes than ``room``."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, resource.RLIM_INFINITY))
    as_script(words)


@pytest.mark.parametrize("room", [1000, 1_500_000, *studies(100_000, 2_200_000)])
def test_a_disk_that_fills_keeps_what_was_written_and_says_so(room, here, tmp_path):
    path = tmp_path / "jwell.nc"
    # kernels are compiled and kept before the room is small
    here(DATA / "jwell.yaml", "--end", "0.1 s", "-o", tmp_path / "first.nc")
    words = command(DATA / "jwell.yaml", "-o", path, "--step", "0.2 ms")[len(COMMAND) :]
    run = Forked(with_little_room, room, words)
    _, errors = run.communicate()
    assert run.returncode == 3, errors
    assert "cannot be written any more" in errors and "Traceback" not in errors
    if "nothing was stored" in errors:
        assert not path.exists()
    else:
        with h5py.File(path) as file:
            frames = file["time"].size
            assert f"{frames} frames are kept" in errors and np.isfinite(file["position"][()]).all()
    assert {file.name for file in tmp_path.iterdir()} <= {"first.nc", "jwell.nc"}
