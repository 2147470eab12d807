"""A run that was ended in any way is gone on with, and gives the same to the bit as one that was not."""

import os
import signal
import subprocess
import sys
import time
from functools import cache
from pathlib import Path

import h5py
import numpy as np
import pytest

DATA = Path(__file__).parents[2] / "data"
COMMAND = [sys.executable, "-c", "import sys; from tautline.cli.main import main; sys.argv[0] = 'tautline'; main()"]
RUNS = {"jwell": "8 s", "hoist": "2.5 s", "hose": "2.5 s", "reeled_span": "5 s"}
STEP = "0.05 ms"
"""So short that a run steps for a second, and is ended in its first tenths."""


def command(*arguments):
    return [*COMMAND, "simulate", *map(str, arguments), "--no-verify", "--quiet"]


def simulate(*arguments):
    return subprocess.run(command(*arguments), capture_output=True, text=True, timeout=300)


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


def ended(path, name, end, number, wait):
    """Start a run and end it by a signal once it has stored more than its first frame; returns its exit code."""
    process = subprocess.Popen(
        command(DATA / f"{name}.yaml", "--end", end, "--step", STEP, "-o", path),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    deadline = time.monotonic() + 200.0
    while process.poll() is None and time.monotonic() < deadline:
        try:
            with h5py.File(path, "r", locking=False) as file:
                if file["time"].size > 3:
                    break
        except OSError:
            pass
        time.sleep(0.01)
    assert process.poll() is None, process.communicate()
    time.sleep(wait)
    process.send_signal(number)
    process.communicate(timeout=100)
    return process.returncode


@pytest.fixture(scope="module")
def whole_run(tmp_path_factory):
    """Results of runs that nothing ended, each made once."""
    folder = tmp_path_factory.mktemp("whole")

    @cache
    def made(name):
        path = folder / f"{name}.nc"
        done = simulate(DATA / f"{name}.yaml", "--end", RUNS[name], "--step", STEP, "-o", path)
        assert done.returncode == 0, done.stderr
        return path

    return made


@pytest.mark.parametrize(
    "name", ["jwell", "hoist", *(pytest.param(x, marks=pytest.mark.long) for x in ("hose", "reeled_span"))]
)
def test_a_run_that_was_killed_or_told_to_end_goes_on_to_the_bit(name, whole_run, tmp_path):
    end, whole = RUNS[name], whole_run(name)
    for number, code in ((signal.SIGKILL, -signal.SIGKILL), (signal.SIGTERM, 130), (signal.SIGINT, 130)):
        path = tmp_path / f"{number}.nc"
        assert ended(path, name, end, number, 0.05) == code
        with h5py.File(path) as file:
            stored, status = file["time"].size, file.attrs["status"]
            assert status == ("running" if number == signal.SIGKILL else "interrupted")
        done = simulate(DATA / f"{name}.yaml", "--end", end, "--step", STEP, "-o", tmp_path / "on.nc", "--resume", path)
        assert done.returncode == 0, done.stderr
        with h5py.File(tmp_path / "on.nc") as file:
            assert file["time"].size > stored
        assert_same(tmp_path / "on.nc", whole)


def test_a_killed_run_goes_on_into_its_own_file(whole_run, tmp_path):
    path, end, whole = tmp_path / "jwell.nc", RUNS["jwell"], whole_run("jwell")
    ended(path, "jwell", end, signal.SIGKILL, 0.0)
    on = simulate(DATA / "jwell.yaml", "--end", end, "--step", STEP, "-o", path, "--resume", path)
    assert on.returncode == 0, on.stderr
    assert_same(path, whole)
    assert [file.name for file in tmp_path.iterdir()] == ["jwell.nc"]


def test_a_second_run_to_the_same_file_is_refused_by_the_command(tmp_path):
    path = tmp_path / "jwell.nc"
    first = subprocess.Popen(
        command(DATA / "jwell.yaml", "--step", "0.02 ms", "-o", path), stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    try:
        while not path.exists() and first.poll() is None:
            time.sleep(0.01)
        second = simulate(DATA / "jwell.yaml", "--end", "1 s", "-o", path)
        assert second.returncode == 2, second.stderr
        assert f"process {first.pid} is writing this result" in second.stderr
    finally:
        first.kill()
        first.communicate()


LIMITED = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
from tautline.cli.main import main
sys.argv = ["tautline", *sys.argv[2:]]
main()
"""


@pytest.mark.parametrize("room", [1000, 100_000, 1_500_000, 2_200_000])
def test_a_disk_that_fills_keeps_what_was_written_and_says_so(room, tmp_path):
    path = tmp_path / "jwell.nc"
    environment = os.environ | {"TAUTLINE_CACHE": os.environ.get("TAUTLINE_CACHE", "")}
    arguments = ["simulate", str(DATA / "jwell.yaml"), "-o", str(path), "--no-verify", "--quiet", "--step", "0.2 ms"]
    # kernels are compiled and kept before the room is small
    assert simulate(DATA / "jwell.yaml", "--end", "0.1 s", "-o", tmp_path / "first.nc").returncode == 0
    run = subprocess.run(
        [sys.executable, "-c", LIMITED, str(room), *arguments], capture_output=True, text=True, env=environment
    )
    assert run.returncode == 3, run.stderr
    assert "cannot be written any more" in run.stderr and "Traceback" not in run.stderr
    if "nothing was stored" in run.stderr:
        assert not path.exists()
    else:
        with h5py.File(path) as file:
            frames = file["time"].size
            assert f"{frames} frames are kept" in run.stderr and np.isfinite(file["position"][()]).all()
    assert {file.name for file in tmp_path.iterdir()} <= {"first.nc", "jwell.nc"}
