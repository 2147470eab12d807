"""Dask: a scheduler and two workers as processes of their own, one of which is killed on the way."""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter

import numpy as np
import pytest
from sweep.short_hoist import MASS, hoist

import tautline
from tautline.scene.errors import SceneError
from tautline.sweeps.execution import Execution
from tautline.sweeps.journal import NAME

CASES = 24
LONG = 4.0
"""Simulated time of a case, s: long enough that much is left when one of two workers is killed."""
VARY = {MASS: {"linspace": [2000, 8000, CASES]}}


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Address of a scheduler, and its two workers."""
    folder = tmp_path_factory.mktemp("cluster")
    place, processes = folder / "scheduler.json", []

    def begin(*words):
        process = subprocess.Popen(
            [sys.executable, "-m", *words, "--scheduler-file", str(place)], cwd=folder,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        processes.append(process)
        return process

    try:
        begin("distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", "--host", "127.0.0.1")
        worker = ("distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", "--no-dashboard")
        workers = [begin(*worker), begin(*worker)]
        until = time.monotonic() + 30.0
        while not (place.exists() and place.read_text(encoding="utf8")) and time.monotonic() < until:
            time.sleep(0.05)
        yield json.loads(place.read_text(encoding="utf8"))["address"], workers
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_worker_that_is_killed_loses_nothing_and_nothing_is_twice(cluster, tmp_path, monkeypatch):
    from distributed import Client

    # A piece is a case, on a fast machine too: both workers get some of them before one is killed.
    monkeypatch.setattr("tautline.sweeps.workers.PIECE", 0.0)
    address, workers = cluster
    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=30)
    folder, killed = tmp_path / "out", []

    def processes():
        lines = (folder / NAME).read_text(encoding="utf8").splitlines()
        return [json.loads(line)["process"] for line in lines if line.startswith('{"case"')]

    def kill_one(done, every):
        # Both have worked, and much is left.
        if not killed and done > 4 and {one.pid for one in workers} <= set(processes()):
            killed.append(workers[0].pid)
            os.kill(workers[0].pid, signal.SIGKILL)

    data = tautline.sweep(
        hoist(LONG), VARY, collect=["max_tension"], dask=address, folder=folder, progress=kill_one
    )  # fmt: skip
    assert killed and (data["status"].values == "done").all()
    rows = [json.loads(line) for line in (folder / NAME).read_text(encoding="utf8").splitlines()]
    rows = [row for row in rows if "case" in row]
    assert Counter(row["case"] for row in rows) == Counter(range(CASES))
    # Which of them has done more is the machine's affair; the last case is one that the other has done.
    assert {one.pid for one in workers} <= {row["process"] for row in rows}
    for case in (0, CASES // 2, CASES - 1):
        alone = tautline.simulate(hoist(LONG, **{MASS: float(data[MASS].values[case])}))
        assert data["max_tension"].values[case] == alone.headline["max_tension"]["value"]


@pytest.mark.study
def test_processes_of_this_machine_give_the_same_numbers_as_this_thread():
    short = {MASS: {"linspace": [2000, 8000, 6]}}
    here = tautline.sweep(hoist(0.1), short, collect=["max_tension"], jobs=1)
    there = tautline.sweep(hoist(0.1), short, collect=["max_tension"], jobs=2, dask="local")
    assert np.array_equal(here["max_tension"].values, there["max_tension"].values)


def test_an_address_without_a_scheduler_is_refused_with_a_cure(tmp_path, monkeypatch):
    monkeypatch.setattr("tautline.sweeps.workers.PATIENCE", 0.5)
    with pytest.raises(SceneError, match=r"^argument dask tcp://127.0.0.1:9: no scheduler answers.*dask scheduler"):
        tautline.sweep(hoist(0.05), VARY, collect=["rise"], dask="tcp://127.0.0.1:9", folder=tmp_path / "out")
    assert not (tmp_path / "out").exists(), "the corrected command would be refused"


def test_a_scheduler_that_is_lost_on_the_way_keeps_what_was_finished_and_is_told(tmp_path, monkeypatch):
    from concurrent.futures import CancelledError

    from tautline.cli.commands.sweep import _left_out
    from tautline.sweeps import sweep as sweeps
    from tautline.sweeps.file import read_sweep
    from tautline.sweeps.workers import SchedulerLost, _end_of

    class Gone:
        """A piece of which the result is on its way when the scheduler ends."""

        def exception(self):
            return None

        def result(self):
            raise CancelledError

    def lost(job, todo, *about):
        case, changes = next(todo)
        yield runner.run(case, changes)
        _end_of(Gone(), "tcp://10.0.0.1:8786")

    monkeypatch.setattr(sweeps, "check_scheduler", lambda address: None)
    monkeypatch.setattr(sweeps, "in_cluster", lost)
    scene = hoist(0.05)
    plan = {"latin_hypercube": {"samples": 6, "seed": 1}}
    read = read_sweep({"scene": "s", "vary": {MASS: {"uniform": ["2 t", "8 t"]}}, "plan": plan, "collect": ["rise"]})
    execution = Execution(1, "tcp://10.0.0.1:8786", tmp_path / "out")
    one = sweeps._Sweep(read, tautline._installed().of(scene), scene, execution)
    runner = one.runner
    one.check()
    one.claim()
    outcome = one.run()
    assert outcome.lost == "the scheduler tcp://10.0.0.1:8786 answers no more" and outcome.interrupted
    assert outcome.done == 2 and outcome.table.exists()
    assert _left_out(outcome) == ["percentiles are those of the 2 cases so far, of 6"]
    with pytest.raises(SchedulerLost):
        _end_of(Gone(), "a")


LOST = """
import logging, os, signal, sys, time
import distributed
from tautline.sweeps import workers

NAMES = ["distributed.client", "distributed.batched", "distributed.comm.tcp"]
talker = logging.getLogger("distributed.client")
levels = [logging.getLogger(name).level for name in NAMES]
place, scheduler = sys.argv[1], int(sys.argv[2])

with workers._client(place, 1) as client:
    waiting = client.submit(time.sleep, 60, pure=False)
    os.kill(scheduler, signal.SIGKILL)
    try:
        workers._end_of(waiting, place)
    except workers.SchedulerLost as error:
        print(error)
    talker.error("not to be seen")
assert [logging.getLogger(name).level for name in NAMES] == levels
talker.error("seen again")
"""


def test_a_scheduler_that_is_killed_is_told_without_a_traceback_and_dask_speaks_again_afterwards(tmp_path):
    place = tmp_path / "scheduler.json"
    words = ["--port", "0", "--no-dashboard", "--host", "127.0.0.1", "--scheduler-file", str(place)]
    scheduler = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", *words], cwd=tmp_path,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        until = time.monotonic() + 30.0
        while not (place.exists() and place.read_text(encoding="utf8")) and time.monotonic() < until:
            time.sleep(0.05)
        address = json.loads(place.read_text(encoding="utf8"))["address"]
        done = subprocess.run(
            [sys.executable, "-c", LOST, address, str(scheduler.pid)], capture_output=True, text=True, timeout=60
        )
    finally:
        scheduler.kill()
        scheduler.wait()
    assert done.returncode == 0, done.stderr
    assert "answers no more" in done.stdout
    assert "Traceback" not in done.stderr and "not to be seen" not in done.stderr and "seen again" in done.stderr
