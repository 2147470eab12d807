"""A result is whole at every moment, whatever happens to the process that writes it."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from results.forked import Forked
from writing_process import batch, variables, write

from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.store import Store

WRITER = Path(__file__).with_name("writing_process.py")


def start(path, batches=100000):
    return Forked(write, path, batches)


def start_anew(path, batches=100000):
    """The same in a new Python process."""
    return subprocess.Popen([sys.executable, WRITER, path, str(batches)], stdout=subprocess.PIPE, text=True)


def frames_promised(lines):
    numbers = [int(line) for line in lines if line.strip().isdigit()]
    return numbers[-1] if numbers else 0


def assert_whole(path, at_least):
    """Our reader and a plain one see the same frames, with nothing missing in any variable."""
    result = Result.read(path)
    frames = len(result.time)
    assert frames >= at_least
    expected = batch(0, frames)
    for name, values in expected.items():
        np.testing.assert_array_equal(result[name], values, err_msg=name)
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        for name, values in expected.items():
            np.testing.assert_array_equal(data[name].values, values, err_msg=name)
        assert data.attrs["scene"] == "a: 1"


def test_a_killed_run_keeps_every_batch_that_was_appended(tmp_path):
    chance = random.Random(7)
    writers = {tmp_path / f"run{i}.nc": None for i in range(4)}
    for i, path in enumerate(writers):
        process = start(path) if i else start_anew(path)
        assert process.stdout.readline().strip() == "ready"
        # some batches are waited for, so that a slow machine kills in the middle of the writing too
        lines = [process.stdout.readline() for _ in range(2 * i)]
        time.sleep(chance.uniform(0.0, 0.03))
        process.send_signal(signal.SIGKILL)
        promised = frames_promised(lines + process.stdout.read().splitlines())
        process.wait()
        if promised == 0 and not path.exists():
            continue  # killed before the first batch: then there is no file, and no broken one either
        assert_whole(path, promised)
        writers[path] = promised
    assert sum(bool(promised) for promised in writers.values()) > 2, "the test killed too early to mean anything"


def test_a_run_killed_at_its_end_leaves_a_whole_file(tmp_path):
    chance = random.Random(8)
    for i in range(4):
        path = tmp_path / f"run{i}.nc"
        process = start(path, 3)
        while process.stdout.readline().strip() != "60":
            pass
        time.sleep(chance.uniform(0.0, 0.03))
        process.kill()
        process.wait()
        assert_whole(path, 60)


def without_locks(path):
    return h5py.File(path, "r", locking=False)


def by_xarray(path):
    return xarray.open_dataset(path, engine="h5netcdf")


@pytest.mark.parametrize("opened", [by_xarray, without_locks])
def test_a_running_file_can_be_read_by_another_process(tmp_path, opened):
    path = tmp_path / "run.nc"
    process = start(path)
    try:
        while frames_promised([process.stdout.readline()]) < 20:
            pass
        seen = []
        for _ in range(5):
            with opened(path) as data:
                time.sleep(0.01)  # the writer goes on meanwhile
                frames = len(data["time"])
                np.testing.assert_array_equal(np.asarray(data["quantity3"])[:, 5], np.arange(frames))
            assert len(Result.read(path).time) >= frames
            seen.append(frames)
        assert seen == sorted(seen) and seen[-1] > seen[0]
    finally:
        process.kill()
        process.communicate()


def test_a_reader_that_keeps_the_file_open_sees_what_it_opened_and_does_not_stop_the_run(tmp_path):
    path = tmp_path / "run.nc"
    with Store(path, variables(), {}, {"scene": "a: 1"}) as store:
        store.append(batch(0))
        readers = []
        for number in range(1, 5):
            readers.append((xarray.open_dataset(path, engine="h5netcdf"), number * 20))
            store.append(batch(number * 20))
        for data, frames in readers:
            np.testing.assert_array_equal(data["hook_load"].values, np.arange(frames))
            data.close()
        store.finish()
    assert_whole(path, 100)


@pytest.mark.parametrize("batches", [1, 2, 3])
def test_what_was_just_stored_is_as_a_reader_finds_it_and_is_nobodys_to_change(tmp_path, batches):
    path = tmp_path / "run.nc"
    coordinates = {"node": np.arange(4), "name": ("node", np.array(list("abcd")), "", "names")}
    with Store(path, variables(), coordinates, {"scene": "a: 1"}) as store:
        for k in range(batches):
            store.append(batch(10 * k, 10), {"memory": np.array([True, False])})
        known, read = store.result, Result.read(path)
        for name in read.variables:
            assert (known[name].dtype, known[name].tolist()) == (read[name].dtype, read[name].tolist())
            with pytest.raises(ValueError, match="read-only"):
                known[name][...] = known[name][::-1]
            assert store.result[name].tolist() == read[name].tolist()
        store.finish(restart={"memory": np.array([False, True])})
    assert_whole(path, 10 * batches)
    assert Result.read(path)["node"].tolist() == [0, 1, 2, 3]
    assert Result.read(path).restart["memory"].tolist() == [0, 1]


def test_leftovers_of_a_killed_run_are_removed_by_the_next(tmp_path):
    path = tmp_path / "run.nc"
    process = start(path)
    while frames_promised([process.stdout.readline()]) < 60:
        pass
    process.kill()
    process.communicate()
    assert len(list(tmp_path.iterdir())) > 1
    with Store(path, variables(), {}, {"scene": "a: 1"}) as store:
        store.append(batch(0))
        store.finish()
    assert [file.name for file in tmp_path.iterdir()] == ["run.nc"]


@pytest.mark.parametrize("by", ["its name", "a link to its folder"])
def test_a_second_run_into_one_file_is_refused_while_the_first_writes(tmp_path, by):
    folder, path = tmp_path / "real", tmp_path / "real" / "run.nc"
    folder.mkdir()
    (tmp_path / "link").symlink_to(folder)
    again = path if by == "its name" else tmp_path / "link" / "run.nc"
    process = start(path)
    try:
        while frames_promised([process.stdout.readline()]) < 20:
            pass
        with pytest.raises(ResultError, match=f"process {process.pid} is writing this result"):
            Store(again, variables(), {}, {"scene": "b: 2"})
        assert frames_promised([process.stdout.readline()]) > 20, "the first goes on"
    finally:
        process.kill()
        process.communicate()
    # the lock went with its process
    with Store(again, variables(), {}, {"scene": "a: 1"}) as store:
        store.append(batch(0))
        store.finish()
    assert_whole(path, 20)
    assert [file.name for file in folder.iterdir()] == ["run.nc"]


def test_a_result_deleted_in_mid_run_is_there_again_after_the_next_batch(tmp_path):
    path = tmp_path / "run.nc"
    with Store(path, variables(), {}, {"scene": "a: 1"}) as store:
        store.append(batch(0))
        store.append(batch(20))
        path.unlink()
        store.append(batch(40))
        assert_whole(path, 60)


@pytest.mark.parametrize("finished", [True, False])
def test_an_earlier_result_stays_until_the_first_batch(tmp_path, finished):
    path = tmp_path / "run.nc"
    with Store(path, variables(), {}, {"scene": "a: 1"}) as store:
        store.append(batch(0))
        store.finish()
    before = path.read_bytes()
    store = Store(path, variables(), {}, {"scene": "b: 2"})
    assert store.finish() is None if finished else store.close() is None
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["run.nc"]


LIMITED = """
import resource, signal, sys
from writing_process import batch, variables
from tautline.results.errors import WriteError
from tautline.results.result import Result
from tautline.results.store import Store

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
store = Store(sys.argv[1], variables(), {}, {"scene": "a: 1"})
store.append(batch(0))
resource.setrlimit(resource.RLIMIT_FSIZE, (4_000_000, resource.RLIM_INFINITY))
try:
    while True:
        store.append(batch(store.frames))
except WriteError as error:
    print(error)
for attempt in (lambda: store.append(batch(store.frames)), store.finish):
    try:
        attempt()
        sys.exit("wrote more than there is room for")
    except WriteError:
        pass
print(len(Result.read(sys.argv[1]).time))
"""


def test_a_full_disk_is_a_named_error_and_what_was_stored_is_kept(tmp_path):
    path = tmp_path / "run.nc"
    command = [sys.executable, "-c", LIMITED, path]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(WRITER.parent), *sys.path])}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    frames = len(Result.read(path).time)
    assert f"cannot be written any more: File too large; {frames} frames are kept in it; free some space" in done.stdout
    assert_whole(path, 100)
    assert [file.name for file in tmp_path.iterdir()] == ["run.nc"]
