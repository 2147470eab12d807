"""Our kernels are compiled by steps of our own; code of others keeps its meaning."""

import functools
import gc

import numpy as np
import pytest
from numba import config, njit
from numba.core import types
from numba.core.compiler import Flags
from numba.extending import overload

from tautline.kernels.compiling.flags import KernelFlags
from tautline.kernels.compiling.inlined import PLAIN, KernelCompiler
from tautline.kernels.compiling.target import _takes_place
from tautline.kernels.jit import entry, kernel
from tautline.kernels.machine import storage
from tautline.kernels.machine.gc_tuning import COMPILING, RARELY, collected_for_compiling, collected_rarely

compiled = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="is about what is compiled")
own_steps = pytest.mark.skipif(bool(config.DISABLE_JIT) or PLAIN, reason="is about our own steps of compiling")


@kernel
def scaled(k, x):
    return (k + 1) * x


@entry
def sum_of_three(x):
    return scaled(0, x) + scaled(1, x) + scaled(7, x)


@pytest.fixture
def empty_cache(tmp_path, monkeypatch):
    """Compiles anew what an earlier run has kept."""
    monkeypatch.setenv("TAUTLINE_CACHE", str(tmp_path))
    known = storage.kept_folder, storage.folder_to_write
    for each in known:
        each.cache_clear()
    yield
    for each in known:
        each.cache_clear()


@own_steps
def test_a_kernel_called_with_several_whole_numbers_is_compiled_once(empty_cache):
    assert sum_of_three(2.0) == 2.0 * (1 + 2 + 8)
    assert len(scaled.compiled.overloads) == 1


def doubled(x):
    """Known to nobody until the test tells numba of it."""


@entry
def doubled_and_one(x):
    return doubled(x) + 1.0


@own_steps
def test_a_function_that_numba_is_told_of_between_two_compilations_is_found_by_the_second(empty_cache):
    """Also when it learns of another type later, by a second template of the same function."""
    assert sum_of_three(2.0) == 22.0
    overload(doubled)(lambda x: (lambda x: 2.0 * x) if isinstance(x, types.Float) else None)
    assert doubled_and_one(3.0) == 7.0
    overload(doubled)(lambda x: (lambda x: 4.0 * x) if isinstance(x, types.Integer) else None)
    assert doubled_and_one(3) == 13.0


def _followed(write):
    """A function with any arguments that has the signature of another."""
    return functools.wraps(write)(lambda *given, **named: None)


@own_steps
@pytest.mark.parametrize("wrap", [lambda write: write, functools.partial, _followed])
def test_whether_an_implementation_asks_for_a_place_in_the_sources_is_what_its_signature_says(wrap):
    def placed(context, builder, sig, args, loc=None):
        loc = sig
        return loc

    def plain(context, builder, sig, args):
        loc = sig
        return loc

    assert _takes_place(wrap(placed)) and not _takes_place(wrap(plain))


@pytest.mark.parametrize(
    "change", [{}, {"nrt": True}, {"error_model": "python"}, {"release_gil": False}, {"boundscheck": True}]
)
def test_flags_of_a_kernel_are_equal_where_those_of_numba_are(change):
    """Also where one of them says what the other leaves as it is."""
    one, other = Flags(), Flags()
    one.release_gil, one.error_model = True, "numpy"
    other.release_gil, other.error_model, other.nrt = True, "numpy", False
    for name, value in change.items():
        setattr(other, name, value)
    ours = KernelFlags(one), KernelFlags(other)
    for left, right in ((ours[0], ours[1]), (ours[0], other), (one, ours[1]), (ours[0].copy(), ours[1])):
        assert (left == right) is (one == other) is (not change)
        assert (left != right) is bool(change)
        assert hash(left) == hash(right) == hash(one)


def test_flags_that_are_set_alike_are_compared_without_a_look_at_all_options(monkeypatch):
    one, other = (KernelFlags(Flags()) for _ in range(2))
    one.release_gil = other.release_gil = True
    monkeypatch.setattr(Flags, "values", lambda flags: pytest.fail("all options are looked at"))
    assert one == other


@own_steps
def test_a_kernel_is_compiled_under_such_flags(empty_cache, monkeypatch):
    seen, steps = [], KernelCompiler.define_pipelines
    monkeypatch.setattr(
        KernelCompiler, "define_pipelines", lambda made: seen.append(type(made.state.flags)) or steps(made)
    )

    @entry
    def sum_of_five(x):
        return x[0, 0] + x[1, 0] * x[2, 0] + x[3, 0] * x[4, 0]

    assert sum_of_five(np.ones((5, 1))) == 3.0
    assert set(seen) == {KernelFlags}


@compiled
def test_functions_of_others_still_see_the_whole_numbers_that_they_are_called_with():
    """An axis must be known while numba compiles."""
    rows = np.array([[1.0, 2.0], [3.0, 4.0]])
    joined = njit(lambda a: (np.concatenate((a, a), 0), np.concatenate((a, a), 1), np.expand_dims(a, 1)))
    for found, expected in zip(joined(rows), joined.py_func(rows), strict=True):
        assert found.tolist() == expected.tolist()


@compiled
def test_a_kernel_that_is_called_from_python_says_so_instead_of_ending_the_process():
    with pytest.raises(TypeError, match="scaled can be called by compiled code only"):
        scaled(1, 2.0)
    assert scaled.py_func(1, 2.0) == 4.0


@compiled
def test_arithmetic_of_arrays_and_of_numbers_in_code_of_others_is_what_it_was():
    both = njit(lambda a, b: (a + b) * 2 - a[0] / b[0])
    a, b = np.array([1.0, 2.0]), np.array([4.0, 5.0])
    assert both(a, b).tolist() == ((a + b) * 2 - a[0] / b[0]).tolist()


def test_garbage_is_searched_for_as_before_once_a_command_has_ended():
    before = gc.get_threshold()
    gc.set_threshold(500, 5, 5)
    try:
        with pytest.raises(ZeroDivisionError), collected_rarely():
            assert gc.get_threshold() == RARELY
            raise ZeroDivisionError
        assert gc.get_threshold() == (500, 5, 5)
        gc.disable()
        with collected_rarely():
            assert not gc.isenabled()
    finally:
        gc.enable()
        gc.set_threshold(*before)


@pytest.mark.parametrize(("outside", "inside"), [((500, 5, 5), (500, 5, 5)), (RARELY, COMPILING)])
def test_garbage_waits_for_a_first_run_in_processes_of_ours_and_no_others(outside, inside):
    before = gc.get_threshold()
    gc.set_threshold(*outside)
    try:
        with collected_for_compiling():
            assert gc.get_threshold() == inside
        assert gc.get_threshold() == outside
    finally:
        gc.set_threshold(*before)


@own_steps
def test_no_function_that_is_being_compiled_is_told_of_each_call_of_llvm(empty_cache):
    twice = entry(lambda x: 2.0 * x)
    assert twice(3.0) == 6.0
    ours, numbas = twice.compiled, njit(lambda x: 2.0 * x)
    assert numbas(3.0) == 6.0
    told = [["timers" in found.metadata for found in each.overloads.values()] for each in (ours, numbas)]
    assert told == [[False], [True]]


@compiled
def test_a_division_by_zero_stays_an_error_in_code_of_others():
    ratio = entry(lambda a, b: a / b)
    assert ratio(1.0, 0.0) == np.inf
    with pytest.raises(ZeroDivisionError):
        njit(lambda a, b: a / b)(1.0, 0.0)
    assert njit(error_model="numpy")(lambda a, b: a / b)(1.0, 0.0) == np.inf


@compiled
def test_an_operator_has_its_meaning_for_each_pair_of_numbers():
    both = njit(lambda a, b: (a // b, a % b, a / b, a < b, max(a, b)))
    for a, b in ((7, 2), (7.5, 2), (7, 2.5), (-7.5, 2.5), (True, 2), (np.int8(100), np.int8(30))):
        for found, expected in zip(both(a, b), both.py_func(a, b), strict=True):
            assert found == expected and isinstance(found, bool) == isinstance(expected, (bool, np.bool_))


@compiled
def test_code_of_others_may_have_closures_and_expressions_of_whole_arrays():
    made = njit(lambda a, n: (2 * a + a * a)[:n].sum() + sum([i * a[0] for i in range(n)]))
    a = np.arange(1.0, 6.0)
    assert made(a, 3) == made.py_func(a, 3)


@own_steps
def test_a_kernel_of_others_counts_from_the_end_and_one_of_ours_trusts_its_indices(empty_cache):
    """Only the core and installed applications promise that no index is negative."""
    a = np.array([1.0, 2.0, 4.0])
    theirs = entry(lambda a, i: a[i] + a[i - 1])
    assert theirs(a, 0) == 1.0 + 4.0
    assert theirs(a, -1) == 4.0 + 2.0

    def read(a, i):
        return a[i]

    read.__module__ = "tautline.kernels.factors.band"
    ours = entry(read)
    assert ours(a, 2) == 4.0
    code = next(iter(ours.compiled.inspect_llvm().values()))
    assert "icmp slt i64" not in code and "select" not in code.split("define linkonce_odr")[0]
