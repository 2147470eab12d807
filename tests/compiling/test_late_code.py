"""Code that few scenes come to is compiled, or loaded, when it is called first, and by no other run."""

import ctypes
import importlib
import json
import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from young_processes import started

from tautline.kernels import separate
from tautline.kernels.jit import Kernel
from tautline.kernels.machine.packet import Machine
from tautline.kernels.memory import form_of

DATA = Path(__file__).parents[2] / "data"
RUN = """
import contextlib, json, sys
from tautline.cli.main import main
from tautline.kernels.separate import late_code

sys.argv = ["tautline", "simulate", sys.argv[1], "--end", "0.1", "--no-verify", "-q"]
with contextlib.suppress(SystemExit):
    main()
print(json.dumps({kernel.__name__: kernel.loads + kernel.compilations for kernel, _ in late_code()}))
"""


@pytest.fixture(scope="module")
def come_to(tmp_path_factory):
    """How often a run of a scene, in a process of its own, has loaded or compiled each piece of late code."""

    @cache
    def come_to(scene):
        folder = tmp_path_factory.mktemp("late")
        ended = started(["-c", RUN, DATA / scene], cwd=folder, env={**os.environ})
        assert ended.returncode == 0, ended.stderr
        assert list(folder.glob("*.nc")), ended.stderr
        return json.loads(ended.stdout.splitlines()[-1])

    return come_to


@pytest.mark.parametrize("scene", ["jwell.yaml", "hose.yaml"])
def test_a_string_and_a_hose_come_to_no_frames_and_no_border(scene, come_to):
    times = come_to(scene)
    assert times["_factorise_in_blocks"] == 1
    for name in ("evaluate_any", "_factorise_border", "_solve_border", "_pack"):
        assert times[name] == 0, name


def test_a_hose_that_begins_as_it_is_drawn_comes_to_no_search_for_rest(come_to):
    assert come_to("hose.yaml")["iterate"] == 0


def test_a_crane_on_a_vessel_comes_to_frames(come_to):
    assert come_to("hoist.yaml")["evaluate_any"] == 1


class _Pressed:
    """A kernel while whose compilation Ctrl-C is pressed twice."""

    def __init__(self):
        self.asked = 0

    def at(self, forms):
        self.asked += 1
        if self.asked < 3:
            raise KeyboardInterrupt
        return Machine(4711, int)


def test_ctrl_c_while_compiled_code_waits_for_late_code_does_not_leave_it_without():
    kernel = _Pressed()
    assert separate._address_of(kernel, ()) == 4711
    assert kernel.asked == 3


def test_a_helper_finds_all_separate_code_by_the_name_it_is_sent(monkeypatch):
    """It is sent the module and the name of a kernel, and asks what stands there for the code."""
    monkeypatch.setattr(Kernel, "at", lambda kernel, forms: (kernel, forms))
    for kernel, forms in separate._known.values():
        found = getattr(importlib.import_module(kernel.__module__), kernel.__name__).at(forms)
        assert found[0] is kernel and found[1] is forms


def test_arguments_are_handed_over_as_numba_does():
    assert len(separate._carried(form_of(np.zeros(2)))) == 7
    assert separate._carried(float) == [ctypes.c_double]
    assert separate._carried(int) == [ctypes.c_int64]


@pytest.mark.parametrize("form", [bool, type(None), ("literal", 3)])
def test_what_late_code_cannot_be_handed_is_refused_as_it_is_defined(form):
    with pytest.raises(TypeError, match="late code takes"):
        separate._carried(form)
