"""A sweep in processes from a script without `if __name__ == "__main__":` says that in words, or takes threads."""

import subprocess
import sys

import pytest
from sweep.short_hoist import MASS, hoist, write_sweep

import tautline
from tautline.sweeps import workers
from tautline.sweeps.execution import Execution
from tautline.sweeps.file import read_sweep
from tautline.sweeps.sweep import run_sweep

pytest.importorskip("distributed")
SCRIPT = f"""
import tautline
from pathlib import Path
try:
    tautline.sweep(Path("hoist.yaml"), {{"{MASS}": [2000, 3000, 4000]}}, collect=["rise"], dask="local", jobs=2)
except tautline.SceneError as error:
    print(error)
"""


def test_a_script_without_a_guard_is_told_what_it_lacks(tmp_path):
    write_sweep(tmp_path, "", end="0.3 s")
    (tmp_path / "script.py").write_text(SCRIPT)
    found = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    (line,) = found.stdout.splitlines()
    assert "could not be started" in line and '`if __name__ == "__main__":`' in line
    assert found.returncode == 0 and "Traceback" not in found.stderr


def test_a_script_that_python_reads_from_its_input_is_told_to_be_saved_as_a_file(tmp_path):
    write_sweep(tmp_path, "", end="0.3 s")
    words = {"cwd": tmp_path, "capture_output": True, "text": True, "timeout": 120}
    found = subprocess.run([sys.executable], input=SCRIPT, **words)
    (line,) = found.stdout.splitlines()
    assert "could not be started (there is no file <stdin>)" in line and "save it as a file" in line
    assert found.returncode == 0 and found.stderr == "" and "__main__" not in line


def test_where_the_program_chose_processes_that_do_not_start_threads_go_on(monkeypatch):
    import distributed

    def refused(*_, **__):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr(distributed, "LocalCluster", refused)
    monkeypatch.setattr("tautline.sweeps.sweep.how", lambda *_: "processes")
    said: list[str] = []
    scene = hoist(0.3)
    read = read_sweep({"scene": "s", "vary": {MASS: [2000, 3000, 4000, 5000]}, "collect": ["rise"]})
    outcome = run_sweep(read, tautline._installed().of(scene), scene, Execution(jobs=2, say=said.append))
    assert outcome.done == 4
    assert [
        one for one in said if "could not be started (Nanny failed to start.): the other cases run on 2 threads" in one
    ]
    with pytest.raises(workers.NoWorkers):
        run_sweep(read, tautline._installed().of(scene), scene, Execution(jobs=2, dask="local"))
