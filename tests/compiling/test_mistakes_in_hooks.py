"""Mistakes in hooks that others wrote are told to them, and those in our own are a fault of the program."""

import inspect
import os
import traceback
from collections import deque
from typing import NamedTuple

import numpy as np
import pytest
from numba import njit

from tautline.elements.nodal.node import PointMasses
from tautline.errors import ArgumentTypeError, TautlineError
from tautline.kernels import groups
from tautline.kernels.compiling.errors import KernelError
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import link, register
from tautline.kernels.jit import entry, kernel
from tautline.system import hook_bounds
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

HERE = os.path.abspath(__file__)
compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is about what is compiled")


class Push(NamedTuple):
    """A force."""

    force: np.ndarray


@pytest.fixture(autouse=True)
def _push_is_forgotten():
    """What a test registers is no kind of the tests after it."""
    assert Push not in groups.KINDS
    yield
    groups.KINDS.pop(Push, None)
    groups._forget(Push)


@kernel
def misspelt(g, t, q, v, a, r):
    """It takes an array that the group has not."""
    r[0] -= g.nosuch[0]


@kernel
def helped(g):
    """What a hook calls; the mistake is here."""
    return g.plaice[0]


@kernel
def calling(g, t, q, v, a, r):
    """It calls what has a mistake."""
    r[0] -= helped(g)


@kernel
def allocating(g, t, q, v, a, r):
    """It makes an array."""
    made = np.zeros(3)
    made[0] = g.force[0]
    r[0] -= made[0]


@kernel
def ours(g, t, q, v, a, r):
    """The same mistake, in a module that goes by the name of one of ours."""
    r[0] -= g.nosuch[0]


PUSHES = (Push(np.ones(1)),)


def linked(hook):
    register(Push, residual=hook)
    return link(PUSHES, "residual")


def line_of(function, word):
    lines, first = inspect.getsourcelines(function.py_func)
    return first + next(i for i, line in enumerate(lines) if word in line)


@compiled
@pytest.mark.parametrize(
    ("hook", "at", "word", "said"),
    [
        (misspelt, misspelt, "nosuch", "Unknown attribute 'nosuch' of type record Push"),
        (calling, helped, "plaice", "Unknown attribute 'plaice'"),
        (allocating, allocating, "zeros", "zeros(Literal[int](3))"),
    ],
)
def test_a_hook_that_cannot_be_compiled_is_told_with_kind_function_line_and_what_numba_said(hook, at, word, said):
    with pytest.raises(KernelError) as refused:
        linked(hook)
    error = refused.value
    assert isinstance(error, TautlineError)
    assert error.path == f"{HERE}:{line_of(at, word)}"
    assert f"hook 'residual' of kind Push ({hook.__module__}.{hook.__name__})" in error.cause
    assert said in error.cause and "\x1b" not in str(error) and "\n" not in str(error)
    assert len(str(error)) < 700 and "makes no new ones" in error.cure


@kernel
def raising(g, t, q, v, a, r):
    """The run went on without its force."""
    if t > 0.2:
        raise ValueError("the table ends")
    r[0] -= g.force[0]


@kernel
def checked(x):
    assert x > 0.0
    return x


@njit
def checked_by_numba(x):
    if x < 0.0:
        raise ValueError
    return x


@kernel
def asserting(g, t, q, v, a, r):
    r[0] -= checked(g.force[0])


@kernel
def calling_numba(g, t, q, v, a, r):
    r[0] -= checked_by_numba(g.force[0])


@compiled
@pytest.mark.parametrize(
    ("hook", "at", "word"),
    [
        (raising, raising, "raise ValueError("),
        (asserting, checked, "assert x"),
        (calling_numba, checked_by_numba, "raise ValueError"),
    ],
)
def test_a_hook_that_can_raise_is_refused_with_the_line_of_it(hook, at, word):
    # nobody looks whether what is called by its address has raised: the force was missing, and the run was "done"
    with pytest.raises(KernelError) as refused:
        linked(hook)
    error = refused.value
    assert error.path == f"{HERE}:{line_of(at, word)}"
    assert f"hook 'residual' of kind Push ({hook.__module__}.{hook.__name__}) can raise an error" in error.cause
    assert "where the group is made" in error.cure and "write nan" in error.cure


BY_CASE = (checked_by_numba, checked_by_numba)


@kernel
def choosing(g, t, q, v, a, r):
    r[0] -= BY_CASE[0](g.force[0])


made_by_exec = {}
exec("def law(x):\n    if x > 0.2:\n        raise ValueError(x)\n    return x", {}, made_by_exec)
law_of_exec = njit(made_by_exec["law"])


@kernel
def calling_what_exec_made(g, t, q, v, a, r):
    r[0] -= law_of_exec(t)


@compiled
def test_a_function_of_exec_that_can_raise_is_refused():
    # it has no module, and was taken for one of Python's own
    with pytest.raises(KernelError, match="can raise an error") as refused:
        linked(calling_what_exec_made)
    assert "<string>:3" in str(refused.value)


@compiled
def test_a_function_that_can_raise_is_found_in_a_tuple_of_functions():
    with pytest.raises(KernelError, match="can raise an error"):
        linked(choosing)


def force(scene):
    """It has the name of what the hooks' group holds, and no hook calls it."""
    if scene is None:
        raise ValueError


@kernel
def leaving_the_tuple(g, t, q, v, a, r):
    r[1] -= (g.force[0], 5.0)[int(t)]


@kernel
def by_one(g, t, q, v, a, r):
    r[0] -= 1.0


@kernel
def by_two(g, t, q, v, a, r):
    r[0] -= 2.0


@entry
def summed(table, t, q, v, a, r):
    groups.residual(table, t, q, v, a, r)


@compiled
def test_a_hook_that_raises_without_a_raise_of_its_own_leaves_no_number_behind():
    # the force was gone from then on, and the run was "done"; numba raises where a tuple has no such place
    table, nothing = linked(leaving_the_tuple), np.zeros(3)
    for t, wanted in ((0.0, [0.0, -1.0, 0.0]), (1.0, [0.0, -5.0, 0.0]), (2.0, [np.nan] * 3)):
        r = np.zeros(3)
        summed(table, t, nothing, nothing, nothing, r)
        np.testing.assert_array_equal(r, wanted)


@compiled
def test_a_kind_that_is_registered_anew_runs_the_hook_of_now():
    found = []
    for hook in (by_one, by_two, by_one):
        r = np.zeros(3)
        summed(linked(hook), 0.0, np.zeros(3), np.zeros(3), np.zeros(3), r)
        found.append(r[0])
    assert found == [-1.0, -2.0, -1.0]


@compiled
def test_the_error_of_a_hook_comes_without_the_steps_of_the_compiler():
    with pytest.raises(KernelError) as refused:
        linked(misspelt)
    told = "".join(traceback.format_exception(refused.value))
    assert "/numba/" not in told and len(told.splitlines()) < 30


@pytest.mark.parametrize("hook", [lambda g, *more: None, njit(lambda g, *more: None)])
@compiled
def test_a_hook_that_is_no_kernel_is_refused_as_it_is_registered(hook):
    with pytest.raises(ArgumentTypeError, match=r"hook 'residual' of kind Push .*is no kernel; write @kernel"):
        register(Push, residual=hook)


@compiled
def test_a_mistake_in_a_hook_of_ours_stays_a_fault_of_the_program(monkeypatch):
    monkeypatch.setattr(ours.py_func, "__module__", "tautline.elements.imagined")
    with pytest.raises(Exception, match="nosuch") as failed:
        linked(ours)
    assert not isinstance(failed.value, TautlineError)


def short(g, t, q, v, a):
    """One argument is missing."""


def long(g, t, q, v, a, r, more):
    """One argument too many."""


@pytest.mark.parametrize("function", [short, long])
@pytest.mark.parametrize("made", [kernel, lambda function: function])
def test_a_hook_with_another_number_of_arguments_is_refused_with_both_lists(function, made):
    given = ", ".join(inspect.signature(function).parameters)
    with pytest.raises(ValueError, match=r"hook 'residual' of kind Push") as refused:
        register(Push, residual=made(function))
    told = str(refused.value)
    assert f"takes ({given}), and is called with (g, t, q, v, a, r)" in told
    assert f"{function.__module__}.{function.__name__}, {HERE}:" in told


def test_a_hook_may_have_arguments_with_defaults_and_any_number_of_them():
    for hook in map(kernel, (lambda g, t, q, v, a, r, more=0.0: None, lambda g, *more: None)):
        register(Push, residual=hook)
        assert groups.KINDS[Push].hooks == {"residual": hook}


def test_a_kind_that_is_registered_anew_forgets_what_was_said_of_it_before():
    push, mass = Push(np.zeros(1)), kernel(lambda g, q, matrix, dofs: None)
    register(Push, constant_mass=True, friction=True, mass=mass)
    assert groups.has_constant_mass((push,)) and groups.without_friction((push,)) == ()
    register(Push, mass=mass)
    assert not groups.has_constant_mass((push,)) and groups.without_friction((push,)) == (push,)


class Pushes(NamedTuple):
    """Forces at places."""

    place: np.ndarray


@kernel
def _at(g, i):
    """What a hook calls."""
    return g.place[i]


@kernel
def pushing(g, t, q, v, a, r):
    for i in range(g.place.size):
        r[_at(g, i)] -= 1.0


@kernel
def stiffening(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for i in range(g.place.size):
        add_entry(matrix, dofs, _at(g, i), _at(g, i) + 100, ck)


@kernel
def lying(g, t, q, v, a, r):
    """It cannot run in Python, and says nothing of places."""
    raise RuntimeError


def assembled(places, **hooks):
    """Three degrees of freedom, pushed at places."""
    degrees = Degrees([], np.zeros(0), np.zeros(0))
    for name in "xyz":
        degrees.add(name, 0.0)
    register(Pushes, **hooks)
    try:
        group = Pushes(np.array(places))
        return assemble((group,), degrees, compile_functions([]), np.zeros(3), [np.array([[0, 1, 2]])], [])
    finally:
        groups.KINDS.pop(Pushes)
        groups._forget(Pushes)


@pytest.mark.parametrize("place", [3, 10**9, -1])
def test_a_place_beyond_the_unknowns_is_told_with_its_element_before_anything_runs(place):
    # compiled, it wrote into memory of something else and ended the process
    with pytest.raises(KernelError) as told:
        assembled([0, 2, place], residual=pushing)
    assert isinstance(told.value, TautlineError) and told.value.path.startswith(HERE)
    for words in ("hook 'residual' of kind Pushes", "with i = 2,", f"place {place} of an array of 3", "0 to 2"):
        assert words in str(told.value)


def test_a_place_beyond_the_unknowns_is_told_of_a_tangent_too():
    with pytest.raises(KernelError, match=r"hook 'tangent' of kind Pushes.*with i = 0,.*place 100 "):
        assembled([0], residual=pushing, tangent=stiffening)


def test_places_that_are_there_and_hooks_that_python_cannot_run_are_not_refused():
    assert assembled([0, 1, 2], residual=pushing).size == 3
    assert assembled([0], residual=lying).size == 3


@pytest.mark.parametrize("place", [1, 3, -1])
def test_a_group_of_ours_that_others_fill_is_gone_through_too(place):
    """`build` of an application gave a mass, whose x, y and z are three places, a place that ends beyond the last."""
    degrees = Degrees([], np.zeros(0), np.zeros(0))
    for name in "xyz":
        degrees.add(name, 0.0)
    group = PointMasses(np.array([place]), np.array([2.0]), 0.0, np.array([0.0, 0.0, -9.81]))
    stencil = [np.array([[0, 1, 2]])]
    with pytest.raises(KernelError, match=r"of kind PointMasses.*place -?\d of an array of 3"):
        assemble((group,), degrees, compile_functions([]), np.zeros(3), stencil, stencil)
    assert assemble(
        (group._replace(place=np.array([0])),), degrees, compile_functions([]), np.zeros(3), stencil, stencil
    )


@kernel
def finding(g, t, h, beta, gamma, q, v, a):
    """It finds the places: until then they are -1."""
    for i in range(g.place.size):
        g.place[i] = i


@kernel
def finding_in_a_step(g, t, h, beta, gamma, q, v, a):
    """The same, but not at an equilibrium."""
    if beta >= 0.0:
        for i in range(g.place.size):
            g.place[i] = i


@kernel
def finding_too_far(g, t, h, beta, gamma, q, v, a):
    for i in range(g.place.size):
        g.place[i] = i + 3


@kernel
def asking(g, t, h, beta, gamma, q, v, a):
    g.place[0] = 1 if q[g.place.size + 5] > 0.0 else 0


@pytest.mark.parametrize("begin", [finding, finding_in_a_step])
def test_places_that_a_group_finds_by_its_own_begin_are_not_refused(begin):
    assert assembled([-1, -1, -1], residual=pushing, begin=begin).size == 3


def test_places_beyond_an_array_are_told_of_begin_too_and_of_what_it_found():
    with pytest.raises(KernelError, match=r"hook 'residual' of kind Pushes.*with i = 0,.*place 3 of an array of 3"):
        assembled([-1, -1, -1], residual=pushing, begin=finding_too_far)
    with pytest.raises(KernelError, match=r"hook 'begin' of kind Pushes.*place 8 of an array of 3"):
        assembled([-1, -1, -1], residual=pushing, begin=asking)


LAST = -1


@kernel
def last(g, t, q, v, e):
    e[-1] += 1.0
    e[LAST] = e[-2] + q[-3]


@kernel
def before_the_first(g, t, q, v, e):
    e[-4] += 1.0


@kernel
def linking(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    add_entry(matrix, dofs, -1, -1, ck)


def test_a_constant_place_from_the_end_is_not_refused_as_far_as_the_array_goes():
    # compiled code counts it from the end, as numpy does
    assert assembled([0], residual=pushing, energy=last).size == 3
    with pytest.raises(KernelError, match="place -4 of an array of 3"):
        assembled([0], residual=pushing, energy=before_the_first)
    # counted from the end a tangent has no entry there
    with pytest.raises(KernelError, match=r"hook 'tangent' of kind Pushes.*place -1 "):
        assembled([0], residual=pushing, tangent=linking)


def test_what_took_long_is_gone_through_once_and_anew_where_places_differ(monkeypatch):
    # 10,000 elements took 2 s in every case of a sweep
    asked = []

    @kernel
    def counting(g, t, q, v, a, r):
        asked.append(g.place.size)
        pushing(g, t, q, v, a, r)

    monkeypatch.setattr(hook_bounds, "LONG", -1.0)
    monkeypatch.setattr(hook_bounds, "_there", deque(maxlen=2))
    for _ in range(3):
        assembled([0, 1, 2], residual=counting)
    assert asked == [3]
    with pytest.raises(KernelError, match="place 3 of an array of 3"):
        assembled([0, 3, 2], residual=counting)
    assert asked == [3, 3]
