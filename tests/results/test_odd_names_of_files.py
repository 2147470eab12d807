"""Names of files that a system allows are names of results: bytes that are no UTF-8, and as long as a name can be."""

import json
import os
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from cli.in_process import commands_of, leave_out_pixels
from matplotlib.figure import Figure

from crane.application import Crane
from tautline.cli.output.called import quoted
from tautline.results.disk import Lock
from tautline.results.result import Result
from tautline.results.store import Store
from tautline.results.variable import Variable
from tautline.view.figures.figure import save
from tautline.whole_file import for_hidden, legible, whole_file

linux = pytest.mark.skipif(sys.platform != "linux", reason="other systems know no such names")
BYTES = os.fsdecode(b"bad\xff")
LONG = 255


def long(ending):
    """A name as long as file systems allow."""
    return "x" * (LONG - len(ending)) + ending


@linux
@pytest.mark.parametrize("name", [f"{BYTES}.nc", long(".nc"), "ü" * 126 + ".nc"])
def test_a_result_of_any_name_is_stored_batch_by_batch_and_leaves_nothing_hidden(name, tmp_path):
    path = tmp_path / name
    store = Store(path, [Variable("load", ("time",), "N", "a load")], {}, {"scene_file": name})
    for k in range(3):
        store.append({"time": np.array([1.0 * k]), "load": np.array([2.0 * k])})
    store.finish({"status": "done"})
    read = Result.read(path)
    assert np.array_equal(read["load"], [0.0, 2.0, 4.0]) and os.listdir(tmp_path) == [name]
    assert read.attributes["scene_file"] == name.replace("\udcff", "\\udcff")


@linux
@pytest.mark.parametrize("ending", [".svg", "." + "y" * 200])
@pytest.mark.parametrize("beginning", [BYTES, "é" * 20])
def test_a_file_waits_under_a_name_that_is_short_enough(beginning, ending, tmp_path):
    path = tmp_path / f"{beginning}{'z' * (LONG - len(os.fsencode(beginning + ending)))}{ending}"
    with whole_file(path) as waiting:
        waiting.write_text("whole")
    assert path.read_text() == "whole" and os.listdir(tmp_path) == [path.name]


def test_locks_of_names_that_differ_in_what_is_cut_off_are_two(tmp_path):
    names = [long("a"), long("b"), "x" * 190, BYTES, "bad", os.fsdecode(b"bad\xfe")]
    assert len({for_hidden(name) for name in names}) == len(names)
    locks = [Lock(tmp_path / name) for name in names]
    assert [lock.take() for lock in locks] == [None] * len(locks)
    for lock in locks:
        lock.give_back()


@linux
@pytest.mark.parametrize("name", [b"a\xff b'c\\d.nc", "ü\xa0.nc".encode(), b"it's.nc", b"\n\xff"])
def test_a_name_in_a_line_to_be_run_is_what_bash_reads(name):
    line = f"printf %s {quoted(os.fsdecode(name))}"
    assert subprocess.run(["bash", "-c", line.encode()], capture_output=True, check=True).stdout == name


@linux
def test_a_figure_with_such_a_name_in_it_is_drawn(tmp_path):
    figure = Figure(figsize=(1.0, 1.0))
    figure.suptitle(BYTES)
    assert save(figure, tmp_path / f"{BYTES}.svg").stat().st_size
    assert legible(BYTES) == "bad\\udcff"


@linux
def test_commands_take_scenes_and_write_files_of_such_names(tmp_path, monkeypatch, capsys):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    leave_out_pixels(monkeypatch)
    scene, result = tmp_path / f"{BYTES}.yaml", tmp_path / f"{BYTES}.nc"
    shutil.copy("data/hoist.yaml", scene)
    here = commands_of(Crane(), capsys)
    code, out, _ = here("simulate", scene, "--no-verify", "--end", "0.1", "-o", result, "--json")
    assert code == 0 and json.loads(out)["status"] == "done"
    (tmp_path / f"{BYTES}_figures").mkdir()
    assert here("plot", result, result, "-o", tmp_path / f"{BYTES}_figures")[0] == 0
    assert here("export", result, "--csv", "-o", tmp_path / f"{BYTES}_tables")[0] == 0
    code, _, told = here("export", result, "--vtk", "-o", tmp_path / f"{BYTES}_frames")
    assert code == 2 and "cannot hold a name that is not UTF-8" in " ".join(told.split())
    assert here("fmu", scene, "-o", tmp_path / f"{BYTES}.fmu", "--outputs", "winch.tension")[0] == 0
    assert zipfile.is_zipfile(tmp_path / f"{BYTES}.fmu")
