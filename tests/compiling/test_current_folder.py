"""Files of the folder that a command runs in are data, whatever their names."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from of_the_suite import studies

ROOT = Path(__file__).parents[2]
NAMES = ("signal", "numba", "tautline", "json", "numpy", "sitecustomize", "drillstring", "pickle", "multiprocessing")
SPY = "open({name!r} + '.was_run', 'w').close()\nraise SystemExit('run from the current folder')\n"
HELP = """
import sys, time
from collections import deque
from tautline.kernels import parallel_compile
waiting = deque([(parallel_compile.run_compile_worker, ())])
parallel_compile._employ(waiting)
print(len(waiting))
"""


@pytest.fixture
def case(tmp_path):
    """A case folder with files that tell when they are run."""
    folder = tmp_path / "case"
    folder.mkdir()
    for name in NAMES:
        (folder / f"{name}.py").write_text(SPY.format(name=name))
    (folder / "jwell.yaml").write_text((ROOT / "data" / "jwell.yaml").read_text().replace("end: 40 s", "end: 0.1"))
    return folder


def was_run(folder):
    return sorted(f.name for f in folder.glob("*.was_run"))


@pytest.mark.parametrize("path", [None, *studies("", os.curdir)], ids=["no path", "empty path", "dot"])
def test_a_process_that_compiles_runs_nothing_of_the_current_folder(case, path, tmp_path):
    """It takes its job, so it has loaded us, from where we are installed."""
    (tmp_path / "help.py").write_text(HELP)
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    # The script itself is started safely: what it starts has to see to itself.
    start = (
        "import os, runpy, sys; import tautline.kernels.parallel_compile; os.chdir(sys.argv[2]);"
        "sys.path[:0] = [sys.argv[2], '', '.']; runpy.run_path(sys.argv[1])"
    )
    given = {} if path is None else {"PYTHONPATH": os.pathsep.join([path, ""])}
    done = subprocess.run(
        [sys.executable, "-P", "-c", f"import os; os.environ.update({given}); {start}", tmp_path / "help.py", case],
        capture_output=True, text=True, cwd=tmp_path, env=environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    assert (done.stdout.split()[-1], was_run(case)) == ("0", [])


@pytest.mark.parametrize("verb", [("simulate", "--quiet"), *studies((("check",),))], ids=["simulate", "check"])
def test_a_command_runs_nothing_of_the_current_folder(case, verb):
    command = Path(sys.executable).with_name("drillstring")
    if not command.exists():
        pytest.skip("the command is not installed beside this Python")
    done = subprocess.run([command, verb[0], "jwell.yaml", *verb[1:]], capture_output=True, text=True, cwd=case)
    assert (done.returncode, was_run(case)) == (0, []), done.stderr


SURVEY = """
import os
from pathlib import Path
from drillstring.stick_slip import severity_map as stick_slip
from tautline.scene.reading.document import Document

if __name__ == "__main__":
    with stick_slip._processes(Document.read(Path("jwell.yaml")), 2) as pool:
        during = os.environ.get("PYTHONSAFEPATH")
        asked = [pool.submit(os.getenv, "PYTHONSAFEPATH") for _ in range(2)]
        print(during, *[each.result() for each in asked], os.environ.get("PYTHONSAFEPATH"))
    print(os.environ.get("PYTHONSAFEPATH"))
"""


def test_processes_of_a_survey_run_nothing_of_the_current_folder_and_leave_the_environment_as_it_was(case, tmp_path):
    (tmp_path / "survey.py").write_text(SURVEY)
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    done = subprocess.run(
        [sys.executable, tmp_path / "survey.py"], capture_output=True, text=True, cwd=case, env=environment
    )
    assert (done.stdout.split(), was_run(case)) == (["None", "1", "1", "None", "None"], []), done.stderr[-1000:]
