"""Kernels of a user's own script: what is edited is compiled anew, and what is not comes from the cache."""

import json
import os

import pytest
from young_processes import young_processes

pytestmark = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is about what is compiled")

RUN = """
import json, sys
import numpy as np
from numba import typeof
from typing import NamedTuple
from tautline.kernels.groups import link, register, run_hook, residual
from tautline.kernels.jit import entry, kernel
{imports}

FACTOR = {factor}

class Push(NamedTuple):
    force: float

@kernel
def scaled(x):
    return {body}

@kernel
def _residual(g, t, q, v, a, r):
    r[0] -= scaled(g.force)

register(Push, residual=_residual)

@entry
def evaluate(groups, t, q, v, a, r):
    residual(groups, t, q, v, a, r)

if __name__ == "__main__":
    group, r, z = (Push(2.0),), np.zeros(1), np.zeros(1)
    table = link(group, "residual")
    evaluate(table, 0.0, z, z, z, r)
    print(json.dumps([-r[0], run_hook.loads]))
"""
HELPER = """
from tautline.kernels.jit import kernel
WEIGHT = {weight}
@kernel
def helped(x):
    return {helped}
"""


@pytest.fixture(scope="module")
def young():
    with young_processes() as run:
        yield run


@pytest.fixture
def run(tmp_path, young):
    """Runs the script of a folder with its contents: the force, and the times that the group came from the cache."""

    def run(folder=".", imports="", factor="3.0", body="x * FACTOR", **helper):
        here = tmp_path / folder
        here.mkdir(exist_ok=True)
        (here / "pushing.py").write_text(RUN.format(imports=imports, factor=factor, body=body))
        (here / "helping.py").write_text(HELPER.format(**{"weight": "1.0", "helped": "x", **helper}))
        # Python itself would take a module for unchanged that was edited within a second and kept its length.
        told = {"TAUTLINE_CACHE": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
        done = young(["pushing.py"], cwd=here, env={**os.environ, **told})
        assert done.returncode == 0, done.stderr[-2000:]
        assert done.stderr == ""
        return json.loads(done.stdout)

    return run


def test_an_edited_script_runs_what_it_says_now(run):
    """The kernel itself, a constant of the script, and back: that one is still in the cache."""
    assert run() == [6.0, 0]
    assert run(body="x * FACTOR + 1.0") == [7.0, 0]
    assert run(factor="5.0") == [10.0, 0]
    assert run() == [6.0, 1]


def test_an_edited_module_that_the_script_takes_from_runs_what_it_says_now(run):
    """A constant by its module and by its name, and the code of a kernel."""
    by_module = {"imports": "import helping", "body": "x * helping.WEIGHT"}
    assert run(**by_module) == [2.0, 0]
    assert run(**by_module, weight="4.0") == [8.0, 0]
    by_name = {"imports": "from helping import WEIGHT", "body": "x * WEIGHT"}
    assert [run(**by_name), run(**by_name, weight="4.0")] == [[2.0, 0], [8.0, 0]]


def test_an_edited_kernel_of_another_module_runs_what_it_says_now(run):
    called = {"imports": "from helping import helped", "body": "helped(x)"}
    assert run(**called) == [2.0, 0]
    assert run(**called, helped="x + WEIGHT") == [3.0, 0]
    assert run(**called, helped="x + WEIGHT", weight="9.0") == [11.0, 0]
    assert run(**called, helped="x + WEIGHT", weight="9.0") == [11.0, 1]


def test_scripts_of_one_name_in_two_folders_do_not_take_each_other_for_themselves(run):
    assert run("one", factor="3.0")[0] == 6.0
    assert run("two", factor="4.0")[0] == 8.0
    assert run("one", factor="3.0") == [6.0, 1]
    assert run("two", factor="4.0") == [8.0, 1]
