"""Kernels of a user's own script: what is edited is compiled anew, and what is not comes from the cache."""

import functools
import importlib
import json
import math
import os
import sys
import types

import numpy as np
import pytest
import sympy
from numba import cfunc
from numba.extending import overload
from young_processes import young_processes

from tautline.kernels.jit import kernel
from tautline.kernels.machine import sources

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
INSTALLED = """
import json, sys
import numpy as np
import pushing
from tautline.kernels.groups import link, run_hook

group, r, z = (pushing.Push(2.0),), np.zeros(1), np.zeros(1)
table = link(group, "residual")
pushing.evaluate(table, 0.0, z, z, z, r)
print(json.dumps([-r[0], run_hook.loads]))
"""
HELPER = """
from tautline.kernels.jit import kernel
WEIGHT = {weight}
@kernel
def helped(x):
    return {helped}
"""
CONSTANTS = """
from enum import IntEnum
WEIGHT = {weight}
class Weights(IntEnum):
    NOW = int({weight})
"""


@pytest.fixture(scope="module")
def young():
    with young_processes() as run:
        yield run


@pytest.fixture
def run(tmp_path, young):
    """Runs the script of a folder with its contents: the force, and the times that the group came from the cache."""

    def run(folder=".", imports="", factor="3.0", body="x * FACTOR", installed="", **helper):
        here = tmp_path / folder
        here.mkdir(exist_ok=True)
        pushing = here / ("pushing/__init__.py" if installed == "package" else "pushing.py")
        pushing.parent.mkdir(exist_ok=True)
        pushing.write_text(RUN.format(imports=imports, factor=factor, body=body))
        (here / "helping.py").write_text(HELPER.format(**{"weight": "1.0", "helped": "x", **helper}))
        (pushing.parent / "constants.py").write_text(CONSTANTS.format(**{"weight": "1.0", **helper}))
        if installed:
            told = here / "pushing-1.0.dist-info"
            told.mkdir(exist_ok=True)
            (told / "METADATA").write_text("Metadata-Version: 2.1\nName: pushing\nVersion: 1.0\n")
            (told / "entry_points.txt").write_text("[tautline.applications]\npushing = pushing:Pushing\n")
        (here / "going.py").write_text(INSTALLED)
        # Python itself would take a module for unchanged that was edited within a second and kept its length.
        told = {"TAUTLINE_CACHE": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
        done = young(["going.py" if installed else "pushing.py"], cwd=here, env={**os.environ, **told})
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


@pytest.mark.parametrize("installed", ["file", "package"])
def test_an_installed_application_that_is_edited_runs_what_it_says_now(run, installed):
    """A number in the kernel: the bytecode and the line stay what they are. An upgrade of a package is such an edit."""
    assert run(installed=installed, body="x * 3.0") == [6.0, 0]
    assert run(installed=installed, body="x * 4.0") == [8.0, 0]
    assert run(installed=installed, body="x * 4.0") == [8.0, 1]


@pytest.mark.parametrize(
    ("installed", "imports", "body"),
    [
        ("package", "from pushing.constants import WEIGHT", "x * WEIGHT"),
        ("file", "from helping import helped", "helped(x)"),
        ("", "from constants import Weights", "x * Weights.NOW.value"),
    ],
    ids=["a constant of its package", "a kernel of another package", "a value of an enumeration"],
)
def test_what_kernels_take_from_another_file_and_is_edited_there_counts(run, installed, imports, body):
    taken = {"installed": installed, "imports": imports, "body": body}
    assert run(**taken, weight="1.0", helped="x * 1.0") == [2.0, 0]
    assert run(**taken, weight="4.0", helped="x * 4.0") == [8.0, 0]


def test_a_file_with_the_name_of_a_module_of_python_is_no_module_of_python(tmp_path, monkeypatch):
    """A helper ``wave.py`` beside a script was taken for Python's own, which is known by its version."""
    kernel = "from tautline.kernels.jit import kernel\n@kernel\ndef high(x):\n    return x * {}\n"
    found = []
    monkeypatch.syspath_prepend(str(tmp_path))
    for factor in ("1.0", "2.0", "1.0"):
        (tmp_path / "wave.py").write_text(kernel.format(factor))
        monkeypatch.delitem(sys.modules, "wave", raising=False)
        monkeypatch.setattr(sys, "dont_write_bytecode", True)
        importlib.invalidate_caches()
        sources._is_known_package.cache_clear()
        found.append(sources.fingerprint(importlib.import_module("wave").high))
    sources._is_known_package.cache_clear()
    monkeypatch.delitem(sys.modules, "wave")
    assert found[0] == found[2] != found[1]


def _of_exec(factor, names):
    """A function that text in a program makes, as `sympy.lambdify` does."""
    made = {}
    exec(f"def law(x):\n    return {factor} * x", names, made)
    return made["law"]


def _in_wraps(factor):
    """A function that goes by the name and the module of one of numpy's."""

    @functools.wraps(np.sum)
    def law(x):
        return factor * x

    return law


def _in_a_class(factor):
    """A class of numbers that text makes: it says of itself that it is Python's own."""
    made = {}
    exec(f"class Law:\n    factor = {factor}", {}, made)
    return made["Law"]


@pytest.mark.parametrize(
    "made",
    [
        lambda factor: _of_exec(factor, {}),
        lambda factor: eval(f"lambda x: {factor} * x", {}),
        lambda factor: _of_exec(factor, vars(math).copy()),
        lambda factor: sympy.lambdify(sympy.Symbol("x"), factor * sympy.Symbol("x")),
        _in_wraps,
        _in_a_class,
    ],
    ids=["exec", "eval", "exec with the names of math", "sympy.lambdify", "functools.wraps", "a class of exec"],
)
def test_what_has_no_module_of_its_own_counts_by_its_contents(made):
    """It was taken for Python's own: an edited law ran as it had been compiled before."""
    found = []
    for factor in (2.0, 3.0, 2.0):
        law = made(factor)

        @kernel
        def calling(x, law=law):
            return law(x)

        found.append(sources.fingerprint(calling))
    assert found[0] == found[2] != found[1]


def test_a_law_of_exec_that_is_edited_is_compiled_anew(run):
    made = "ns = {{}}\nexec('def law(x): return {} * x', {{}}, ns)\nfrom numba import njit\nlaw = njit(ns['law'])"
    for factor in (2.0, 3.0):
        assert run(imports=made.format(factor), body="law(x)")[0] == 2.0 * factor


laws = types.ModuleType("laws")
laws.sub = types.ModuleType("laws.sub")


@kernel
def second(x):
    return x * laws.sub.B


@kernel
def first(x):
    return laws.sub.A * second(x)


def test_each_function_counts_with_the_names_that_it_takes_of_a_module_in_a_module():
    """Of a submodule only those names counted that the first function took."""
    laws.sub.A, laws.sub.B = 1.0, 5.0
    before = sources.fingerprint(first)
    assert sources.fingerprint(first) == before
    laws.sub.B = 7.0
    assert sources.fingerprint(first) != before


def test_a_callback_for_c_is_never_taken_from_a_cache():
    """Its address is in the machine code, and another process ended at it."""

    @cfunc("float64(float64)")
    def law(x):
        return 5.0 * x

    @kernel
    def calling(x):
        return law(x)

    assert sources.fingerprint(calling) != sources.fingerprint(calling)


def test_what_a_library_has_by_its_name_is_known_whatever_it_is():
    """Functions of numpy that dispatch, its operators and types, and contexts of numba are objects of classes."""
    import numba

    known = np.linalg.solve, np.sum, np.sin, np.float64, np.dtype("f8"), numba.objmode, abs, math.sin, str.upper, float
    assert all(map(sources.is_known, known))
    assert all(map(sources.is_known, (json.dumps, functools.wraps, numba.types.Float, np.linalg.LinAlgError)))


def test_an_overload_that_is_edited_counts():
    found = []
    for factor in (5.0, 7.0):

        def law(x):
            """What the overload stands for."""

        @overload(law)
        def _law(x, factor=factor):
            return lambda x: factor * x

        @kernel
        def calling(x, law=law):
            return law(x)

        found.append(sources.fingerprint(calling))
    assert found[0] != found[1]


place = object()


@kernel
def of_a_group(g):
    return g.place[0]


def test_an_attribute_with_the_name_of_a_global_is_not_that_global():
    """An object without contents of that name had the kernel compiled in every process."""
    assert sources.fingerprint(of_a_group) == sources.fingerprint(of_a_group)
