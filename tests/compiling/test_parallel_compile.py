"""What a first run compiles is shared with helper processes, and nothing depends on their help."""

import json
import os
import shutil

import numpy as np
import pytest
from of_the_suite import studies
from young_processes import young_processes

from tautline.elements.nodal.load import Loads
from tautline.integrators.method import METHODS
from tautline.integrators.state import new_state
from tautline.integrators.time_loop import compile_for
from tautline.kernels.machine import storage
from tautline.system.model import SolverSettings
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

SCRIPT = """
import sys
from typing import NamedTuple
import numpy as np
from tautline.elements.nodal.load import Loads
from tautline.integrators.time_loop import compile_for, loop_of, run_steps, new_frames
from tautline.integrators.method import METHODS
from tautline.integrators.state import new_state
from tautline.kernels import groups
from tautline.kernels import parallel_compile
from tautline.kernels.dofs import add_entry
from tautline.kernels.jit import kernel
from tautline.system.model import SolverSettings
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

class Ball(NamedTuple):
    mass: float

@kernel
def _residual(g, t, q, v, a, r):
    r[0] += g.mass * a[0]

@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    add_entry(matrix, dofs, 0, 0, cm * g.mass)

@kernel
def _energy(g, t, q, v, e):
    e[0] += 0.5 * g.mass * v[0] ** 2

@kernel
def _record(g, out, at):
    at[0] += 0

groups.register(Ball, residual=_residual, tangent=_tangent, energy=_energy, record=_record)
parallel_compile.HELPERS, parallel_compile.WORTH = HELPERS
parallel_compile.os.sched_getaffinity = lambda _: range(8)
things = (Loads(np.array([0]), np.array([2.0])), Ball(4.0))
system = assemble(things, Degrees(["x"], np.zeros(1), np.ones(1)), compile_functions([]), np.zeros(1), [], [])
settings = SolverSettings("generalized-alpha", 0, 1, 1, 0.5, 0.5)
method, state = METHODS["generalized-alpha"](system, settings), new_state(system)
state.a[:] = state.auxiliary[:] = 0.5
told = []
compile_for(method, system, state, told.append)
loop = loop_of(method)[0]
loops = list(loop._found)
from numba.core import event
late = []
class Listener(event.Listener):
    def on_start(self, e): late.append(e)
    def on_end(self, e): pass
event.register("numba:compile", Listener())
frames = new_frames(1, 1, 0)
run_steps(method, system, state, np.array([1.0]), np.array([10]), 0.0, frames)
print(told, len(late), len(loops), loops == list(loop._found), round(float(frames.q[0, 0]), 12))
"""


@pytest.fixture
def cache(tmp_path):
    """A cache with what is one for all scenes in it and takes half a minute to compile; groups are looked at here."""
    system = assemble(
        (Loads(np.array([0]), np.array([2.0])),), Degrees(["x"], np.zeros(1), np.ones(1)), compile_functions([]),
        np.zeros(1), [], [],
    )  # fmt: skip
    method = METHODS["generalized-alpha"](system, SolverSettings("generalized-alpha", 0, 1, 1, 0.5, 0.5))
    compile_for(method, system, new_state(system))
    known, cache = storage.folder_to_write(), tmp_path / "cache"
    alike = ("run_implicit-*", "evaluate_scene-*", "factorise_matrix-*", "solve_matrix-*", "evaluate_*-*", "_run-*")
    loops = [found for name in alike if (found := [*known.rglob(f"{name}.code")])]
    assert len(loops) >= 5
    for file in (file for files in loops for file in files):
        copy = cache / storage.OWN / known.name / file.relative_to(known)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, copy)
    return cache


@pytest.mark.parametrize("helpers", ["2, 1", *studies("0, 1")], ids=["two helpers", "alone"])
def test_a_scene_with_a_group_that_no_helper_can_import_is_compiled_once_and_runs(tmp_path, cache, helpers):
    """x = F t^2 / (2 m) = 0.25 at 1 s; `Ball` lives in a script that only its own process knows."""
    answers, script = [], tmp_path / "ball.py"
    script.write_text(SCRIPT.replace("HELPERS\nparallel_compile", f"{helpers}\nparallel_compile"))
    with young_processes() as run:
        for _ in range(2):
            done = run([script], cwd=tmp_path, env={**os.environ, "TAUTLINE_CACHE": str(cache)})
            assert done.returncode == 0, done.stderr[-2000:]
            answers.append(done.stdout.split())
    # compiled later: nothing, and no other loop than the one that was made ready
    assert [a[1:] for a in answers] == [["0", "1", "True", "0.25"]] * 2
    first, second = (sum(json.loads(a[0])) for a in answers)
    assert first > second
