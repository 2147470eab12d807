"""Compiled code is kept from process to process, under a name that a change of any kernel changes."""

import json
import os
import pickle
import re
import shutil
from pathlib import Path

import pytest
from of_the_suite import studies
from young_processes import started, young_processes

import drillstring
import tautline
from tautline.kernels.machine import sources, storage

HERE = Path(__file__).parent
RUN = """
import json, sys
import numpy as np
from tautline.elements.nodal.load import Loads
from tautline.integrators.equations import SUMS, evaluate_full
from tautline.integrators.state import new_state
from tautline.kernels.groups import run_hook
from tautline.kernels.matrix import new_matrix
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

GROUPS
s = assemble(groups, Degrees(["x"], np.zeros(1), np.ones(1)), compile_functions([]), np.zeros(1), [], [])
matrix, r = new_matrix(1, 0), np.zeros(1)
evaluate_full(s.link(SUMS), s.dofs, new_state(s), 0.0, 1.0, 0.0, 0.0, matrix, r)
count = lambda kind: [getattr(f, kind) for f in (evaluate_full, run_hook)]
print(json.dumps([r[0], count("loads"), count("compilations")]))
"""
OURS = "groups = (Loads(np.array([0]), np.array([2.5])),)"
FOREIGN = """
from typing import NamedTuple
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

class Push(NamedTuple):
    force: float

@kernel
def _residual(g, t, q, v, a, r):
    r[0] -= g.force

register(Push, residual=_residual)
"""


@pytest.fixture(scope="module")
def young():
    with young_processes() as run:
        yield run


@pytest.fixture(scope="module")
def run(young):
    """Runs the script in a new process with its cache in a folder: residual, cache hits and misses of (sum, hooks)."""

    def run(folder, groups=OURS, path=()):
        search = os.pathsep.join([*map(str, path), *filter(None, [os.environ.get("PYTHONPATH")])])
        told = {"TAUTLINE_CACHE": str(folder / "cache"), "PYTHONPATH": search}
        done = young(["-c", RUN.replace("GROUPS", groups)], cwd=folder, env={**os.environ, **told})
        assert done.returncode == 0, done.stderr[-2000:]
        return json.loads(done.stdout)

    return run


def files(folder):
    kept = (f for f in folder.rglob("*") if f.suffix in (".nbc", ".code"))
    return {f.relative_to(folder): f.stat().st_mtime_ns for f in kept}


@pytest.fixture(scope="module")
def compiled(tmp_path_factory, run):
    """A folder in which one process compiled a scene, and what it saw."""
    folder = tmp_path_factory.mktemp("compiled")
    return folder, run(folder)


def test_the_second_process_compiles_nothing(compiled, run):
    folder, first = compiled
    assert first == [-2.5, [0, 0], [1, 1]]
    before = files(folder)
    assert run(folder) == [-2.5, [1, 1], [0, 0]]
    assert before and files(folder) == before


def test_code_is_kept_in_a_file_for_each_and_no_list_of_them_is_written_for_which_processes_would_wait(compiled):
    cache = compiled[0] / "cache"
    rooms = [f for f in cache.rglob("tautline.*/*") if f.is_file()]
    assert {f.suffix for f in rooms} == {".nbc", ".code"}


def test_code_compiled_for_a_group_of_someone_elses_does_not_stop_other_programs(compiled, run):
    """The cache is the user's: a script or an application with a group of its own writes into it too."""
    folder, _ = compiled
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere" / "pushing.py").write_text(FOREIGN)
    foreign = "from pushing import Push\ngroups = (Push(1.5),)"
    assert run(folder, foreign, path=[folder / "elsewhere"])[0] == -1.5
    assert run(folder)[0] == -2.5


PARTS = """
import json, sys
from tautline.kernels.jit import entry, kernel

@kernel
def third(x):
    return x / 3.0

@kernel(forceinline=True)
def twice_a_third(x):
    return 2.0 * third(x)

@entry
def whole(x):
    return twice_a_third(x) + third(x)

@entry
def another(x):
    return 1.0 + twice_a_third(x)

called = {"whole": whole, "another": another}[sys.argv[1]]
value = called(6.0)
known = vars(twice_a_third).get("compiled")
hit = sum(known.stats.cache_hits.values()) if known else 0
own = False
for inner in known.overloads.values() if known else ():
    own = own or inner.library.codegen._engine.is_symbol_defined(inner.fndesc.llvm_func_name)
print(json.dumps([value, hit, own, "numba" in sys.modules]))
"""


def test_a_kernel_that_only_kernels_call_is_machine_code_within_its_callers_only_also_from_the_cache(tmp_path, young):
    """What it gives is 2 x/3 + x/3 and 1 + 2 x/3; the second program finds it in the cache of the first.

    The third, which was just started, finds the machine code of the first, and loads no compiler.
    """
    script = tmp_path / "parts.py"
    script.write_text(PARTS)
    seen = []
    for name, run in (("whole", young), ("another", young), ("whole", started)):
        told = {"TAUTLINE_CACHE": str(tmp_path / "cache")}
        done = run([script, name], cwd=tmp_path, env={**os.environ, **told})
        assert done.returncode == 0, done.stderr[-2000:]
        seen.append(json.loads(done.stdout))
    assert seen == [[6.0, 0, False, True], [5.0, 1, False, True], [6.0, 0, False, False]]


@pytest.fixture
def kernels(tmp_path, monkeypatch):
    """Three kernel files, and a function that gives the cache folder for them as a new process would."""
    files = [tmp_path / name for name in ("contact.py", "link.py", "body.py")]
    for file in files:
        file.write_text("force = 1.0  # kernel\n")
    monkeypatch.setenv("TAUTLINE_CACHE", str(tmp_path / "cache"))

    def read(package="tautline"):
        return {file.name: file.read_bytes() for file in files}

    monkeypatch.setattr(sources, "kernel_sources", read)
    return files, fresh


def fresh():
    """The folder that a new process would write to."""
    for known in (storage.name, storage.kept_folder, storage.folder_to_write):
        known.cache_clear()
    return storage.folder_to_write()


@pytest.fixture(autouse=True)
def _as_before():
    yield
    for known in (storage.name, storage.kept_folder, storage.folder_to_write):
        known.cache_clear()
    storage.say.cache_clear()
    storage._told.clear()


def test_a_changed_kernel_means_a_new_folder_and_a_change_undone_the_old_one(kernels):
    sources, folder = kernels
    before = folder()
    assert before == folder() and before.is_dir()
    text = sources[1].read_text()
    sources[1].write_text("force = 2.0  # kernel\n")
    assert folder() != before
    sources[1].write_text(text)
    assert folder() == before


def test_an_added_kernel_means_a_new_folder(kernels):
    sources, folder = kernels
    before = folder()
    sources.append(sources[0].with_name("drag.py"))
    sources[-1].write_text("")
    assert folder() != before


def test_old_folders_go_and_the_last_few_stay(kernels):
    sources, folder = kernels
    made = []
    for i in range(storage.FOLDERS_KEPT + 4):
        sources[0].write_text(f"force = {i}  # kernel\n")
        made.append(folder())
        os.utime(made[-1], (1000.0 + i, 1000.0 + i))
    assert [f.exists() for f in made] == [False] * 3 + [True] * (storage.FOLDERS_KEPT + 1)


def test_every_file_of_core_and_applications_that_compiles_is_watched():
    roots = [Path(package.__file__).parent for package in (tautline, drillstring)]
    watched = {root.parent / place for root in roots for place in sources.kernel_sources(root.name)}
    texts = {f: f.read_text() for root in roots for f in root.rglob("*.py")}
    asked = re.compile(r"^\s*(?:from|import) (?:numba|llvmlite)|jit import|kernels\.lanes", re.M)
    room = Path(tautline.__file__).parent / "study"  # which counts what numba compiles, and compiles nothing
    compiling = {f for f, text in texts.items() if asked.search(text) and room not in f.parents}
    assert {f.name for f in compiling} >= {"lanes.py", "hooks.py", "band.py", "friction_of_four.py"}
    assert compiling - watched == set()


def test_nothing_is_removed_that_does_not_carry_our_mark(kernels, tmp_path):
    """Folders of the user beside ours, or of our form, and what links lead to, stay."""
    files, folder = kernels
    for i in range(12):
        (tmp_path / "cache" / f"project {i}").mkdir(parents=True)
        (tmp_path / "cache" / f"project {i}" / "thesis.tex").write_text("years of work")
    ours = folder().parent
    assert ours.parent == tmp_path / "cache"
    theirs = ours / "0123456789abcdef"
    theirs.mkdir()
    (theirs / "data.csv").write_text("1")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / storage.MARK).write_text("")
    (ours / "fedcba9876543210").symlink_to(elsewhere)
    for kept in (theirs, elsewhere):
        os.utime(kept, (1.0, 1.0))
    for i in range(storage.FOLDERS_KEPT + 4):
        files[0].write_text(f"force = {i}  # kernel\n")
        folder()
    assert len(list((tmp_path / "cache").glob("project */thesis.tex"))) == 12
    assert (theirs / "data.csv").exists() and (elsewhere / storage.MARK).exists()
    assert len([f for f in ours.iterdir() if storage._is_our_own(f)]) == storage.FOLDERS_KEPT + 1


@pytest.mark.parametrize("named", ["", "  "])
def test_an_empty_name_of_a_cache_is_none(named, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    monkeypatch.setenv("TAUTLINE_CACHE", named)
    monkeypatch.chdir(tmp_path)
    assert storage.root().is_absolute() and tmp_path not in (storage.root().parent, storage.root())


def test_the_home_of_a_cache_is_expanded(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("TAUTLINE_CACHE", "~/kept")
    assert storage.root() == tmp_path / "kept" / storage.OWN


DAMAGE = {
    "truncated": lambda data: data[: len(data) // 2],
    "empty": lambda data: b"",
    "garbage": lambda data: b"\x80garbage" * 50,
    "one bit": lambda data: data[: len(data) // 2] + bytes([data[len(data) // 2] ^ 1]) + data[len(data) // 2 + 1 :],
    "another version": lambda data: pickle.dumps("0.1.0", protocol=-1) + pickle.dumps(({}, {})),
    "a class that is not there": lambda data: b"cno.such.module\nThing\n.",
}


def of_module(held, name):
    """Those files of a cache that are of one module, which gave their folder its name."""
    return {file: when for file, when in held.items() if file.parent.name == name}


@pytest.fixture(scope="module")
def several(tmp_path_factory, young):
    """A folder with a cache, a module for each kind of damage, and a function that calls them all in one process."""
    folder = tmp_path_factory.mktemp("several")
    names = {damage: f"parts_{i}" for i, damage in enumerate(DAMAGE)}
    for name in names.values():
        (folder / f"{name}.py").write_text(PARTS)
    each = "for name in sys.argv[2:]:\n    importlib.import_module(name)\n"
    (folder / "all.py").write_text(f"import importlib, sys\n{each}")

    def values(cache):
        told = {"TAUTLINE_CACHE": str(cache)}
        done = young([folder / "all.py", "whole", *names.values()], cwd=folder, env={**os.environ, **told})
        assert (done.returncode, done.stderr) == (0, "")
        return [json.loads(line)[0] for line in done.stdout.splitlines()]

    assert values(folder / "cache") == [6.0] * len(DAMAGE)
    return folder / "cache", names, values


ASKED = """
import json, sys
from parts import whole
from tautline.kernels import jit

read, found = [], jit.read

def reading(function, name):
    for stored in found(function, name):
        read.append(function.__qualname__)
        yield stored

jit.read = reading
there = whole.is_ready((float,))
print(json.dumps([there, whole(6.0), read.count("whole")]))
"""


def test_code_that_was_asked_for_is_read_once_and_damaged_code_is_not_there(tmp_path, young):
    """Whether a kernel has to be compiled is known when it has been read, and it is not read again to be used."""
    (tmp_path / "parts.py").write_text(PARTS.partition("called =")[0])
    (tmp_path / "asked.py").write_text(ASKED)

    def asked():
        told = {"TAUTLINE_CACHE": str(tmp_path / "cache")}
        done = young([tmp_path / "asked.py"], cwd=tmp_path, env={**os.environ, **told})
        assert done.returncode == 0, done.stderr[-2000:]
        return json.loads(done.stdout)

    assert asked() == [False, 6.0, 0]
    assert asked() == [True, 6.0, 1]
    for file in tmp_path.rglob("whole-*.code"):
        file.write_bytes(DAMAGE["one bit"](file.read_bytes()))
    assert asked()[:2] == [False, 6.0]
    assert asked() == [True, 6.0, 1]


@pytest.mark.parametrize("kind", ["nbc", "code"])
def test_a_damaged_file_is_written_anew(tmp_path, kind, several):
    """The results are those of before; the run after it compiles nothing. Each damage is to the files of a module.

    Parts are read where something is to be compiled: there the machine code is taken away.
    """
    whole, names, values = several
    cache = tmp_path / "cache"
    shutil.copytree(whole, cache)
    if kind != "code":
        for file in [file for name in names.values() for file in cache.rglob(f"{name}/*.code")]:
            file.unlink()
    for damage, name in names.items():
        held = list(cache.rglob(f"{name}/*.{kind}"))
        assert held
        for file in held:
            file.write_bytes(DAMAGE[damage](file.read_bytes()))
    damaged = files(cache)
    assert values(cache) == [6.0] * len(DAMAGE)
    mended = files(cache)
    for damage, name in names.items():
        assert of_module(mended, name) != of_module(damaged, name), damage
    assert values(cache) == [6.0] * len(DAMAGE) and files(cache) == mended


@pytest.mark.parametrize("named", ["~nobody-of-this-name/x", "/proc/cache", *studies("file", "file/below", "link")])
def test_where_nothing_can_be_kept_a_temporary_folder_takes_its_place_which_is_said_once(tmp_path, named, young):
    (tmp_path / "file").write_text("not a folder")
    (tmp_path / "link").symlink_to("/proc/nowhere")
    (tmp_path / "tmp").mkdir()
    script = tmp_path / "parts.py"
    script.write_text(PARTS)
    told = {"TAUTLINE_CACHE": named, "TMPDIR": str(tmp_path / "tmp")}
    done = young([script, "whole"], cwd=tmp_path, env={**os.environ, **told})
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)[0] == 6.0
    assert done.stderr.count("warning: ") == 1 and "each run compiles anew" in done.stderr
    assert not any((tmp_path / "tmp").iterdir())


def test_a_disk_that_is_full_is_said_once_and_the_run_goes_on(tmp_path, young):
    script = tmp_path / "parts.py"
    full = """
import errno, tautline.kernels.compiling.caching as caching, tautline.kernels.machine.code as code
def full(*_):
    raise OSError(errno.ENOSPC, "No space left on device")
caching.save = code.save = full
"""
    script.write_text(full + PARTS)
    told = {"TAUTLINE_CACHE": str(tmp_path / "cache")}
    done = young([script, "whole"], cwd=tmp_path, env={**os.environ, **told})
    assert done.returncode == 0 and json.loads(done.stdout)[0] == 6.0
    assert done.stderr.count("warning: ") == 1 and "No space left on device" in done.stderr


def test_a_folder_removed_while_running_is_made_again(tmp_path, young):
    script = tmp_path / "parts.py"
    script.write_text(PARTS + "import shutil, os\nshutil.rmtree(os.environ['TAUTLINE_CACHE'])\nprint(another(6.0))\n")
    told = {"TAUTLINE_CACHE": str(tmp_path / "cache")}
    done = young([script, "whole"], cwd=tmp_path, env={**os.environ, **told})
    assert (done.returncode, done.stderr, done.stdout.split()[-1]) == (0, "", "5.0")
