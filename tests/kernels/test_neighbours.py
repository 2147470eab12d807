"""What is around us stays as it is: numba and its caches, Python's hooks, the packages of others."""

import json
import os
from pathlib import Path

import pytest
from young_processes import started, young_processes

DATA = Path(__file__).parents[2] / "data"

MINE = """
from numba import njit

@njit(cache=True)
def before(a, i):
    return a[i - 1]

@njit(cache=True)
def total(a, n):
    s = 0.0
    for i in range(n):
        s += before(a, i) * a[-1]
    return s
"""
USE = """
import json, sys
import numpy as np

def foreign():
    import mine
    value = mine.total(np.array([1.0, 2.0, 4.0]), 2)
    print(json.dumps([value, *(sum(f.stats.cache_hits.values()) for f in (mine.total,))]))

def ours():
    from kernels_of_mine import whole
    print(json.dumps([whole(np.array([1.0, 2.0]), 1), whole.loads]))

def calls():
    import calling
    print(json.dumps([calling.both(np.array([1.0, 2.0, 4.0])), sum(calling.both.stats.cache_hits.values())]))

for name in sys.argv[1:]:
    globals()[name]()
"""
OURS = """
from tautline.kernels.jit import entry, kernel

@kernel
def inner(a, i):
    return 3.0 * a[i]

@entry
def whole(a, i):
    return inner(a, i) + 1.0
"""
CALLING = """
from numba import njit
from kernels_of_mine import inner
from mine import before

@njit(cache=True)
def both(a):
    return inner(a, 1) + before(a, 0)
"""
EXPECTED = {"foreign": 20.0, "ours": 7.0, "calls": 10.0}


@pytest.fixture(scope="module")
def young():
    with young_processes() as run:
        yield run


@pytest.fixture
def run(tmp_path, young):
    """Runs some of the above, in order, in a process of their own; what each gave, and whether from its cache.

    The first process loads numba by itself, before or after us.
    """
    for name, text in {"mine": MINE, "use": USE, "kernels_of_mine": OURS, "calling": CALLING}.items():
        (tmp_path / f"{name}.py").write_text(text)
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}

    def run(*names):
        ways = started if not (tmp_path / "cache").exists() else young
        told = {"TAUTLINE_CACHE": str(tmp_path / "cache")}
        done = ways([tmp_path / "use.py", *names], cwd=tmp_path, env={**environment, **told})
        assert done.returncode == 0, (names, done.returncode, done.stderr[-2000:])
        answers = [json.loads(line) for line in done.stdout.splitlines()]
        assert [value for value, _ in answers] == [EXPECTED[name] for name in names]
        return [hits for _, hits in answers]

    return run


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is about what is compiled")
@pytest.mark.parametrize(
    "first", [("ours", "foreign", "calls"), pytest.param(("foreign", "calls", "ours"), marks=pytest.mark.study)]
)
def test_caches_of_others_are_used_in_all_orders_with_us_and_without(run, tmp_path, first):
    """What one process has kept the next one finds, whichever of them has loaded us; numba's files stay numba's."""
    assert run(*first) == [0, 0, 0]
    for names in (("foreign",), ("calls", "foreign"), ("foreign", "ours"), ("ours", "calls")):
        assert run(*names) == [1] * len(names), names
    own = {f.name.split("-")[0] for f in (tmp_path / "__pycache__").glob("*.nbi")}
    assert own == {"mine.before", "mine.total", "calling.both"}
    kept = {f.name.split("-")[0] for kind in ("*.nbc", "*.code") for f in (tmp_path / "cache").rglob(kind)}
    assert kept == {"kernels_of_mine.inner", "whole", "_run"}


UNCHANGED = """
import gc, json, os, signal, sys, types, warnings
import numba, numpy, scipy.linalg, llvmlite.binding, pkgutil, importlib
import numba.np.arrayobj, numba.core.typing.npydecl, numba.core.event, numba.core.caching
WATCHED = ("numba", "llvmlite", "scipy", "gc", "signal", "pickle", "subprocess")
KINDS = (type, types.FunctionType, types.BuiltinFunctionType, classmethod, staticmethod, property)

def things():
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] not in WATCHED:
            continue
        for key, value in list(vars(module).items()):
            if isinstance(value, KINDS):
                yield f"{name}.{key}", value
            if isinstance(value, type) and value.__module__.split(".")[0] in WATCHED:
                for inner, held in list(vars(value).items()):
                    if isinstance(held, KINDS):
                        yield f"{name}.{key}:{inner}", held

def settings():
    return {
        "CACHE_DIR": numba.config.CACHE_DIR, "gc": [gc.get_threshold(), gc.isenabled(), gc.get_freeze_count()],
        "hooks": [id(sys.excepthook), id(sys.displayhook), id(sys.unraisablehook)], "path": list(sys.path),
        "signals": [str(signal.getsignal(s)) for s in (signal.SIGINT, signal.SIGTERM)],
        "warnings": [str(w) for w in warnings.filters], "environment": dict(os.environ), "folder": os.getcwd(),
        "numpy": [numpy.geterr(), str(numpy.get_printoptions())], "recursion": sys.getrecursionlimit(),
        "locators": [str(c) for c in numba.core.caching.CacheImpl._locator_classes],
        "targets": sorted(map(str, numba.core.target_extension.target_registry)),
    }

numba.njit(lambda a: (a + a).sum())(numpy.ones(3))  # what numba loads late is loaded
import tautline.scene  # what other packages load is theirs
import xarray, pint
before, set_before = dict(things()), settings()
import tautline
tautline.simulate(sys.argv[1])
after, set_after = dict(things()), settings()
import scipy.linalg.cython_lapack
scipy.linalg.cython_lapack.__pyx_capi__["dgetrf"]
changed = [name for name, held in before.items() if after.get(name) is not held]
print(json.dumps([len(before), changed, [k for k in set_before if set_before[k] != set_after[k]]]))
"""


def test_a_run_from_python_leaves_numba_and_python_as_they_are(tmp_path, young):
    """Functions, classes and methods of numba, llvmlite and SciPy, hooks, signals, garbage collector, settings."""
    scene = tmp_path / "jwell.yaml"
    text = (DATA / "jwell.yaml").read_text()
    assert "end: 40 s" in text
    scene.write_text(text.replace("end: 40 s", "end: 0.1"))
    done = young(["-c", UNCHANGED, scene], cwd=tmp_path, env={**os.environ})
    assert done.returncode == 0, done.stderr[-2000:]
    watched, changed, settings = json.loads(done.stdout.splitlines()[-1])
    assert watched > 5000
    assert (changed, settings) == ([], [])


BITS = """
import json, sys
import numpy as np
from exact import spring
rng = np.random.default_rng(7)
out, at = np.zeros(60), np.zeros(60)
spring(rng.normal(size=60), rng.normal(size=(60, 3)), out)
print(out.tobytes().hex())
"""
EXACT = """
from math import sqrt, cos
from tautline.kernels.jit import entry, kernel

@kernel
def product(x, i, row):
    return x[i] * row[0] + x[i - 1] * row[1] - row[2] * cos(x[i])

@entry
def spring(x, rows, out):
    for i in range(1, x.size):
        out[i] = product(x, i, rows[i]) + sqrt(abs(product(x, i, rows[i - 1]))) / 3.0 + rows[i, 2] * x[i]
"""


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is about what is compiled")
def test_plain_numba_gives_the_same_numbers_to_the_bit_where_nothing_is_fused(tmp_path, young):
    (tmp_path / "exact.py").write_text(EXACT)
    (tmp_path / "bits.py").write_text(BITS)
    seen = set()
    for plain in ("0", "1", "0", "1"):
        told = {"TAUTLINE_PLAIN_NUMBA": plain, "TAUTLINE_UNFUSED": "1", "TAUTLINE_CACHE": str(tmp_path)}
        done = young(["bits.py"], cwd=tmp_path, env={**os.environ, **told})
        assert done.returncode == 0, done.stderr[-2000:]
        seen.add(done.stdout)
    assert len(seen) == 1
    assert len(list((tmp_path / "tautline-kernels").iterdir())) == 2, "each way has a folder"
