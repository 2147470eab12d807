"""Who imports whom: layers run one way, and a run loads nothing that it does not use."""

import ast
import os
import shutil
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
from layers.syntax import tree_of

ROOT = Path(__file__).parents[2]
TO_DERIVE_OR_DRAW = {"sympy", "pyvista", "vtk", "matplotlib", "imageio", "PIL"}
TO_COMPUTE = {"numpy", "numba", "scipy", "llvmlite", "h5py", "xarray", "pandas", "pint"}
SCENE = """
well:
  sections: [{hold: 60 m}, {build: {radius: 100 m, to: 30 deg}}]
  diameter: 0.2 m
  wall: none
string: [{name: pipe, length: 100, od: 0.127, id: 0.1086}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
model: {elements: 6, bending: none}
solver: {step: 1 ms, end: 10 ms}
output: {interval: 10 ms}
"""


def packages_after(arguments, folder):
    """Packages and modules that a run of the drillstring program loaded, by its own account when it ends."""
    ask = (
        "import atexit, sys\n"
        "atexit.register(lambda: print('\\nloaded', *sys.modules, file=sys.stderr))\n"
        f"sys.argv = ['drillstring', *{[str(a) for a in arguments]!r}]\n"
        "from drillstring.main import main\n"
        "main()\n"
    )
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr[-2000:]
    return set(done.stderr.rpartition("\nloaded ")[2].split()), done.stdout


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scene")
    (folder / "short.yaml").write_text(SCENE)
    # The first run may compile, for which numba loads scipy.
    packages_after(["simulate", "short.yaml", "-o", "first.nc", "--quiet"], folder)
    packages, _ = packages_after(["simulate", "short.yaml", "-o", "short.nc", "--quiet"], folder)
    return folder, packages


def test_a_run_loads_no_symbolic_algebra_and_nothing_that_draws(simulated):
    folder, packages = simulated
    assert (folder / "short.nc").stat().st_size > 0 and "llvmlite" in packages
    assert packages.isdisjoint(TO_DERIVE_OR_DRAW)


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="nothing is compiled")
def test_a_run_that_finds_its_kernels_loads_no_compiler(simulated):
    assert simulated[1].isdisjoint({"numba", "tautline.kernels.compiling"})


def test_a_run_loads_no_xarray_and_for_plain_units_no_pint(simulated):
    assert simulated[1].isdisjoint({"xarray", "pandas", "pint"})


def test_a_run_loads_no_masked_arrays(simulated):
    assert "numpy.ma" not in simulated[1]


def test_a_run_leaves_nothing_of_scipy_loaded_that_it_does_not_need(simulated):
    named = ("linalg", "linalg.cython_lapack", "sparse", "optimize", "interpolate")
    assert simulated[1].isdisjoint({f"scipy.{name}" for name in named})


def test_a_run_loads_nothing_that_varies_a_scene_for_a_study(simulated):
    assert simulated[1].isdisjoint({"drillstring.model.variations", "tautline.study.robustness"})


PARTS = (ast.stmt, ast.excepthandler, ast.match_case)
"""What statements are made of, apart from expressions."""
MAPPED = Path("/proc/self/maps")


@pytest.mark.skipif(not MAPPED.exists(), reason="the system does not tell which libraries a process has loaded")
@pytest.mark.parametrize(("border", "loaded"), [(0, "False"), (1, "True")])
def test_lapack_is_loaded_for_a_matrix_with_a_border_only(border, loaded):
    ask = (
        "import numpy as np\n"
        "from tautline.kernels.matrix import factorise_matrix, new_factors, solve_matrix\n"
        f"factors, x = new_factors(3, 1, {border}), np.ones(3)\n"
        "factors.matrix.band[:, 1] = 2.0\n"
        "factors.matrix.corner[:] = 4.0\n"
        "assert factorise_matrix(factors) == 0\n"
        "solve_matrix(factors, x)\n"
        f"print(*x, 'cython_lapack' in open({str(MAPPED)!r}).read())"
    )
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True)
    assert done.stdout.split() == ["0.5", "0.5", "0.25" if border else "0.5", loaded], done.stderr


def test_a_matrix_is_not_taken_for_factorised_where_lapack_cannot_be_loaded():
    ask = (
        "import numpy as np\n"
        "from tautline.kernels.factors import lapack\n"
        "lapack.ROUTINES = 'scipy.linalg.there_is_none'\n"
        "matrix, pivots, integers = np.eye(2), np.zeros(2, np.int32), np.zeros(10, np.int32)\n"
        "print(lapack.factorise_dense(matrix, pivots, 2, integers))"
    )
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True)
    assert done.stdout.strip() == "-1" and "there_is_none" in done.stderr


def test_lapack_that_was_loaded_alone_leaves_scipy_as_it_is():
    ask = (
        "import sys, numpy as np, tautline.kernels.factors.lapack as ours\n"
        "ours.factorise_dense(np.eye(2), np.zeros(2, np.int32), 2, np.zeros(10, np.int32))\n"
        "import scipy.linalg\n"
        "from scipy.linalg import cython_lapack, solve\n"
        "same = cython_lapack is scipy.linalg.cython_lapack\n"
        "print(same, solve([[2.0]], [3.0])[0], cython_lapack.__pyx_capi__['dgetrf'])"
    )
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True)
    assert done.stdout.startswith("True 1.5 <capsule"), done.stderr


def test_a_check_of_a_scene_loads_nothing_that_derives_or_draws_or_stores(simulated):
    packages, _ = packages_after(["check", "short.yaml"], simulated[0])
    assert packages.isdisjoint(TO_DERIVE_OR_DRAW | {"h5py"})


def test_help_loads_nothing_that_computes(tmp_path):
    packages, text = packages_after(["--help"], tmp_path)
    assert "simulate" in text
    assert packages.isdisjoint(TO_COMPUTE | TO_DERIVE_OR_DRAW)


def test_reading_a_scene_in_python_loads_no_compiler():
    names = "import sys, tautline.scene.reading.document, tautline.scene.model; print('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", names], capture_output=True, text=True).stdout.strip() == "False"


LINTER = shutil.which("lint-imports", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))


@pytest.mark.skipif(LINTER is None, reason="import-linter is not installed")
def test_the_import_contracts_hold():
    done = subprocess.run([LINTER, "--no-cache"], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", sorted(p.name for p in (ROOT / "apps").iterdir() if (p / "main.py").exists()))
def test_every_room_of_an_application_has_its_layer_in_a_contract(name):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    layers = next((c["layers"] for c in contracts if c["name"] == f"the folders of {name}"), ())
    placed = {room.strip() for layer in layers for room in layer.split("|")}
    rooms = {p.stem for p in (ROOT / "apps" / name).glob("*.py")} - {"__init__", "main"}
    rooms |= {p.parent.name for p in (ROOT / "apps" / name).glob("*/__init__.py")}
    assert {f"{name}.{room}" for room in rooms} == placed


@cache
def imports_of(path):
    found = set()
    # Statements only: to visit every expression as well takes ten times as long, and none of them imports.
    waiting = [tree_of(path)]
    while waiting:
        node = waiting.pop()
        waiting += [one for one in ast.iter_child_nodes(node) if isinstance(one, PARTS)]
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
    return found


def importers(*packages):
    """Our source files that import one of the packages, anywhere in their text."""
    wanted = set(packages)
    files = [f for part in ("core", "apps") for f in (ROOT / part).rglob("*.py")]
    return {f.relative_to(ROOT).as_posix() for f in files if any(n.partition(".")[0] in wanted for n in imports_of(f))}


def test_only_the_view_imports_what_draws():
    assert all(f.startswith("core/tautline/view/") for f in importers("matplotlib", "pyvista"))


def test_only_the_derivation_imports_sympy():
    assert importers("sympy") == {"core/tautline/lumped/derive.py"}


def test_the_core_imports_no_application():
    applications = [p.name for p in (ROOT / "apps").iterdir() if p.is_dir()]
    assert not [f for f in importers(*applications) if f.startswith("core/")]


def test_compiled_code_imports_nothing_that_reads_scenes_or_stores_results():
    allowed = ("tautline.kernels", "tautline.lumped")
    for path in (ROOT / "core/tautline/kernels").glob("*.py"):
        ours = [n for n in imports_of(path) if n.partition(".")[0] == "tautline"]
        # The base of all errors imports nothing itself.
        assert all(n.startswith(allowed[0]) or n == "tautline.errors" for n in ours), path
    for path in (ROOT / "core/tautline/lumped").glob("*.py"):
        ours = [n for n in imports_of(path) if n.partition(".")[0] == "tautline"]
        assert all(n.startswith(allowed) for n in ours), path


OF_OTHERS = {"_replace", "_asdict", "_fields", "_t"}
"""Names with an underscore that collections and sympy give to all."""
OF_OURS = {"tautline._scene", "tautline._installed", "Segment._example"}
"""What the root of the package keeps for its own rooms, and a class of scenes for its own kind."""


OF_ONESELF = ("self", "cls")


def reached_into():
    """Private attributes of others' objects, but for those of numba and LLVM that the compiler has to know."""
    for path in [*(ROOT / "core").rglob("*.py"), *(ROOT / "apps").rglob("*.py")]:
        if "compiling" in path.parts:
            continue
        all_nodes = list(ast.walk(tree_of(path)))
        nodes = [node for node in all_nodes if isinstance(node, ast.Attribute) and node.attr.startswith("_")]
        named = {node.name for node in all_nodes if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        own = named | {node.attr for node in nodes if isinstance(node.value, ast.Name) and node.value.id in OF_ONESELF}
        for node in nodes:
            if node.attr not in own | OF_OTHERS and not node.attr.startswith("__"):
                yield f"{path.relative_to(ROOT).as_posix()}: {ast.unparse(node)}"


def test_no_module_reaches_into_the_private_parts_of_what_another_makes():
    assert {line for line in reached_into() if line.split(": ")[1] not in OF_OURS} == set()
