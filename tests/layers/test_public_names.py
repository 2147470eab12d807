"""What ``import tautline`` offers: every public name, loaded when asked for; one base of exceptions; types."""

import ast
import importlib
import inspect
import subprocess
import sys
from importlib import resources
from pathlib import Path

import pytest
from layers.syntax import tree_of

import tautline
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.interruption import listening
from tautline.results.errors import ResultError, WriteError
from tautline.scene.errors import SceneError, option_error

ROOT = Path(__file__).parents[2]
PACKAGES = ("tautline", "crane", "drillstring", "gardenhose")
WITHIN = {"Ended", "OutOfTime", "NoRod", "LockedUp", "UnknownUnit", "Uncounted"}
"""Exceptions that are raised and caught inside, and that nobody outside ever sees."""
NAMES = (
    "read simulate study_errors study_stability Result TautlineError SceneError ResultError StoppedEarly Interrupted"
)


def test_every_public_name_is_there_and_in_all():
    assert set(NAMES.split()) <= set(tautline.__all__) and tautline.__all__ == sorted(tautline.__all__)
    assert all(getattr(tautline, name) is not None for name in tautline.__all__)
    assert set(tautline.__all__) == set(dir(tautline)), "nothing that the module itself imports"
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        tautline.simulat  # noqa: B018


def test_a_star_import_gives_them_all():
    space = {}
    exec("from tautline import *", space)
    assert set(tautline.__all__) <= set(space)


def test_to_import_tautline_loads_none_of_its_modules_but_its_version_and_nothing_that_computes():
    ask = "import sys, tautline; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert {name for name in loaded if name.partition(".")[0] == "tautline"} == {"tautline", "tautline.version"}
    assert loaded.isdisjoint({"numpy", "numba", "pydantic", "yaml", "scipy", "h5py", "xarray"})


def test_the_base_of_exceptions_comes_without_anything_that_computes():
    ask = "import sys, tautline; tautline.TautlineError, tautline.SceneError; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()).isdisjoint({"numpy", "numba", "pydantic", "yaml", "scipy", "h5py", "xarray"})


def test_every_exception_that_leaves_the_packages_is_a_tautline_error():
    found = {}
    for package in PACKAGES:
        for file in Path(importlib.import_module(package).__file__).parent.rglob("*.py"):
            tree = tree_of(file)
            for node in (n for n in tree.body if isinstance(n, ast.ClassDef) and n.name not in WITHIN):
                parts = file.relative_to(Path(importlib.import_module(package).__file__).parents[1]).with_suffix("")
                if any(ast.unparse(base).endswith(("Error", "Exception", "Early")) for base in node.bases):
                    found[node.name] = getattr(importlib.import_module(".".join(parts.parts)), node.name)
    found = {name: one for name, one in found.items() if inspect.isclass(one) and issubclass(one, BaseException)}
    assert {"SceneError", "ResultError", "StoppedEarly", "Interrupted", "WellboreError", "ReevingError"} <= set(found)
    assert {name for name, one in found.items() if not issubclass(one, tautline.TautlineError)} == set()


@pytest.mark.parametrize(
    "error",
    [
        option_error("--step", "x", "is no time"),
        ResultError("a.nc", "is no result"),
        WriteError("a.nc", "the disk is full"),
        StoppedEarly(Status.SINGULAR, 0.0, "node 1"),
        Interrupted(1.0),
    ],
    ids=lambda error: type(error).__name__,
)
def test_one_clause_catches_them_all_and_keeps_what_they_say(error):
    said = str(error)
    with pytest.raises(tautline.TautlineError) as caught:
        raise error
    assert str(caught.value) == said and said


@pytest.mark.parametrize("made", [
    tautline.read, tautline.simulate, tautline.Simulation, tautline.study_errors, tautline.study_stability,
    tautline.Result.read,
])  # fmt: skip
@pytest.mark.parametrize("wrong", [42, [1], None])
def test_what_is_no_scene_and_no_file_is_refused_by_a_tautline_error_that_is_a_type_error(made, wrong):
    with pytest.raises(tautline.ArgumentTypeError, match=type(wrong).__name__) as caught:
        made(wrong)
    assert isinstance(caught.value, tautline.TautlineError) and isinstance(caught.value, TypeError)


@pytest.mark.parametrize("room", ["tautline.statistics", "crane.rope_life", "tautline.results"])
def test_functions_that_are_called_from_python_raise_no_bare_value_error_or_type_error(room):
    for file in Path(importlib.import_module(room).__path__[0]).rglob("*.py"):
        nodes = ast.walk(ast.parse(file.read_text(encoding="utf8")))
        raised = [node.exc for node in nodes if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call)]
        assert {ast.unparse(one.func) for one in raised}.isdisjoint({"ValueError", "TypeError"}), file


def test_ctrl_c_is_still_a_keyboard_interrupt_where_nothing_of_a_run_can_be_kept():
    with pytest.raises(KeyboardInterrupt), listening() as ear:
        ear.heard = True
        ear.check()
    assert not issubclass(tautline.TautlineError, KeyboardInterrupt)


def test_what_is_lazy_is_the_class_itself():
    assert tautline.SceneError is SceneError and tautline.StoppedEarly is StoppedEarly
    assert tautline.ResultError is ResultError and tautline.Interrupted is Interrupted


@pytest.mark.parametrize("package", PACKAGES)
def test_every_package_says_that_it_is_typed_and_ships_the_mark(package):
    assert (resources.files(package) / "py.typed").is_file()
    import tomllib

    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf8"))
    assert "py.typed" in settings["tool"]["setuptools"]["package-data"][package]
