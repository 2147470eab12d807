"""Compiled code goes by its contents: it may be moved, be read-only, and come with an installation."""

import importlib.util
import json
import os
import platform
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from of_the_suite import studies
from young_processes import started, young_processes

import crane
import drillstring
import gardenhose
import tautline
from tautline.kernels.machine import storage
from tautline.kernels.machine.targets import LEVELS, level_of

V3 = LEVELS["x86_64"]["x86-64-v3"]
NAMES = """
import json
from tautline.kernels.machine import sources, storage
print(json.dumps([storage.name(), *(sources.hash_of_package(each) for each in ("crane", "drillstring"))]))
"""


@pytest.fixture(scope="module")
def young():
    with young_processes() as run:
        yield run


def script(text, folder, *arguments, by=started, **environment):
    """What a script prints in a process of its own, as JSON."""
    done = by(["-c", text, *arguments], cwd=folder, env={**os.environ, **environment})
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stderr == ""
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The core and all applications, copied to another folder at another time."""
    folder = tmp_path_factory.mktemp("copy")
    for package in (tautline, crane, drillstring, gardenhose):
        source = Path(package.__file__).parent
        shutil.copytree(source, folder / source.name, ignore=shutil.ignore_patterns("__pycache__"))
    for file in folder.rglob("*.py"):
        os.utime(file, (1e9, 1e9))
    return folder


@pytest.fixture(scope="module")
def before(copy, tmp_path_factory):
    """The names of the copy as it is."""
    return script(NAMES, tmp_path_factory.mktemp("before"), PYTHONPATH=str(copy))


def test_the_same_sources_elsewhere_and_at_another_time_have_the_same_key(before, tmp_path):
    assert before == script(NAMES, tmp_path)


def test_a_changed_application_changes_the_key_of_its_own_kernels_alone(copy, before, tmp_path):
    file = copy / "crane" / "geometry" / "line.py"
    text = file.read_text()
    file.write_text(text + "\nX = 1\n")
    after = script(NAMES, tmp_path, PYTHONPATH=str(copy))
    file.write_text(text)
    assert [a == b for a, b in zip(after, before, strict=True)] == [True, False, True]


def test_a_changed_core_changes_the_folder(copy, before, tmp_path):
    file = copy / "tautline" / "kernels" / "factors" / "band.py"
    text = file.read_text()
    file.write_text(text + "\nX = 1\n")
    after = script(NAMES, tmp_path, PYTHONPATH=str(copy))
    file.write_text(text)
    assert after[0] != before[0]


@pytest.mark.parametrize("setting", ["NUMBA_BOUNDSCHECK=1", *studies("NUMBA_OPT=1")])
def test_code_that_numba_is_told_to_compile_otherwise_is_kept_apart(setting, copy, before, tmp_path):
    name, _, value = setting.partition("=")
    assert script(NAMES, tmp_path, PYTHONPATH=str(copy), **{name: value})[0] != before[0]


@pytest.mark.parametrize("missing", V3)
def test_a_processor_that_lacks_one_instruction_of_a_level_is_given_the_level_below(missing):
    has = dict.fromkeys(V3, True)
    assert level_of("x86_64", has) == "x86-64-v3"
    assert level_of("x86_64", has | {missing: False}) == "x86-64"
    assert level_of("x86_64", {each: True for each in has if each != missing}) == "x86-64"


def test_a_machine_that_no_level_is_known_of_is_given_none():
    assert level_of("riscv64", {}) is None
    assert level_of("x86_64", {}) == "x86-64" and level_of("aarch64", {}) == "generic"


SOLVE = """
import json, sys
from pathlib import Path
import numpy as np
from tautline.kernels.machine import storage, targets
installed, level = sys.argv[1:]
if installed:
    storage.SHIPPED = Path(installed)
if level:
    targets.level_of = lambda machine, features: level
from tautline.kernels.factors.lapack import factorise_dense, solve_dense
a, x = np.array([[4.0, 1.0], [1.0, 3.0]]), np.array([1.0, 2.0])
pivots, integers = np.zeros(2, np.int32), np.zeros(9, np.int32)
factorise_dense(a, pivots, 2, integers)
solve_dense(a, pivots, 2, integers, x)
count = lambda kind: sum(getattr(f, kind) for f in (factorise_dense, solve_dense))
print(json.dumps([*np.round(11.0 * x, 12).tolist(), count("loads"), count("compilations")]))
"""
SOLUTION = [1.0, 7.0]
"""Of 4 x + y = 1, x + 3 y = 2, times 11."""


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder as a wheel brings it, with code for processors with AVX2, which cannot be written to."""
    folder = tmp_path_factory.mktemp("installed")
    made = script(
        SOLVE, folder, "", "", TAUTLINE_CACHE=str(folder / "made"), NUMBA_CPU_NAME="x86-64-v3", NUMBA_CPU_FEATURES=""
    )
    assert made == [*SOLUTION, 0, 2]
    moved = folder / "moved"
    (folder / "made" / storage.OWN).rename(moved)
    for file in moved.rglob("*"):
        file.chmod(0o555 if file.is_dir() else 0o444)
    return moved


needs_v3 = pytest.mark.skipif(platform.machine() != "x86_64", reason="compiles for x86-64")


@needs_v3
def test_code_that_came_with_the_installation_is_used_and_nothing_is_written(installed, tmp_path, young):
    assert script(SOLVE, tmp_path, installed, "", by=young, TAUTLINE_CACHE=str(tmp_path / "empty")) == [*SOLUTION, 2, 0]
    assert not (tmp_path / "empty").exists()


@needs_v3
def test_a_processor_without_its_instructions_leaves_installed_code_alone(installed, tmp_path, young):
    told = {"TAUTLINE_CACHE": str(tmp_path / "empty")}
    assert script(SOLVE, tmp_path, installed, "x86-64", by=young, **told) == [*SOLUTION, 0, 2]


@needs_v3
def test_where_numba_is_told_the_processor_installed_code_is_left_alone(installed, tmp_path):
    given = {"TAUTLINE_CACHE": str(tmp_path / "empty"), "NUMBA_CPU_NAME": "x86-64", "NUMBA_CPU_FEATURES": ""}
    assert script(SOLVE, tmp_path, installed, "", **given) == [*SOLUTION, 0, 2]


@needs_v3
def test_installed_code_that_is_damaged_is_compiled_anew_into_the_users_cache(installed, tmp_path, young):
    damaged = tmp_path / "damaged"
    shutil.copytree(installed, damaged)
    for file in damaged.rglob("*.code"):
        data = file.read_bytes()
        file.chmod(0o644)
        file.write_bytes(data[: len(data) // 2])
    for hits, misses in ((0, 2), (2, 0)):
        given = script(SOLVE, tmp_path, damaged, "", by=young, TAUTLINE_CACHE=str(tmp_path / "own"))
        assert given == [*SOLUTION, hits, misses]


CALLER = """
import json, sys
import numpy as np
from tautline.kernels.jit import entry
from tautline.kernels.time_function import evaluate
from tautline.scene.functions import Harmonic
from tautline.system.time_functions import FunctionRequest, compile_functions

@entry
def twice(functions, t):
    f, df, ddf = evaluate(functions, 0, t)
    return 2.0 * f

@entry
def thrice(functions, t):
    f, df, ddf = evaluate(functions, 0, t)
    return 3.0 * f

functions = compile_functions([FunctionRequest(Harmonic(amplitude=1.5, period=4.0))])
found = [f(functions, 1.0) for f in (twice, thrice)]
hits = twice.loads + thrice.loads
print(json.dumps([found, hits]))
"""


def test_functions_of_time_stand_in_memory_once_and_are_found_by_callers_from_the_cache(tmp_path, young):
    """1.5 sin(2 pi t / 4) is 1.5 at 1 s. Their code names it in place of taking it in."""
    (tmp_path / "caller.py").write_text(CALLER)
    start = "import runpy, sys; runpy.run_path(sys.argv[1], run_name='__main__')"
    for hits in (0, 2):
        found = script(start, tmp_path, tmp_path / "caller.py", by=young, TAUTLINE_CACHE=str(tmp_path / "cache"))
        assert found == [[3.0, 4.5], hits]
    kept = [file.read_bytes() for file in (tmp_path / "cache").rglob("t*ice-*.code")]
    assert len(kept) == 2 and all(b"tautline:tautline.kernels.time_function:evaluate_written" in each for each in kept)


@pytest.mark.skipif(platform.machine() not in ("x86_64", "aarch64"), reason="no wheel has kernels for this machine")
def test_a_wheel_has_the_machine_code_and_no_parts_and_is_for_one_python_and_platform(tmp_path, young):
    """Of the parts of a program, which a compiler alone reads, and its entry; the wheel is a small one of our form."""
    (tmp_path / "program.py").write_text(PROGRAM)
    start = "import runpy, sys; runpy.run_path(sys.argv[1], run_name='__main__')"
    assert script(start, tmp_path, tmp_path / "program.py", by=young, TAUTLINE_CACHE=str(tmp_path / "cache")) == 6.0
    about = "tautline-0.1.0.dist-info"
    tree = tmp_path / "tautline-0.1.0"
    for place, text in {
        "tautline/kernels/__init__.py": "",
        f"{about}/METADATA": "Metadata-Version: 2.1\nName: tautline\nVersion: 0.1.0\n",
        f"{about}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }.items():
        (tree / place).parent.mkdir(parents=True, exist_ok=True)
        (tree / place).write_text(text)
    packing = [sys.executable, "-m", "wheel", "pack", "-d", str(tmp_path), str(tree)]
    subprocess.run(packing, check=True, capture_output=True)
    pure = tmp_path / "tautline-0.1.0-py3-none-any.whl"
    spec = importlib.util.spec_from_file_location("wheels", Path(__file__).parents[2] / ".ci" / "wheels.py")
    wheels = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(wheels)
    made, kernels, size = wheels.wheel_with(pure, tmp_path / "cache", tmp_path)
    with zipfile.ZipFile(made) as wheel:
        names = wheel.namelist()
        described = wheel.read(f"{about}/WHEEL").decode()
        record = wheel.read(f"{about}/RECORD").decode()
    code = sorted(Path(name).name.partition("-")[0] for name in names if name.endswith(".code"))
    assert kernels == len(code) == 2 and size > 0 and code == ["_run", "whole"]
    assert not any(name.endswith((".nbi", ".nbc", ".lock")) for name in names)
    assert all(name in record for name in names if name.endswith(".code"))
    assert (
        "Root-Is-Purelib: false" in described
        and made.name == f"tautline-0.1.0-{wheels.tags()[0]}-none-{wheels.tags()[1]}.whl"
    )


PROGRAM = """
from tautline.kernels.jit import entry, kernel

@kernel
def third(x):
    return x / 3.0

@entry
def whole(x):
    return 3.0 * third(x)

print(whole(6.0))
"""
