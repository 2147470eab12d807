"""How Python calls compiled code: arguments in memory, and what comes back."""

import copy
import os
import pickle
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import pytest
from young_processes import young_processes

from tautline.kernels.bound import Lasting
from tautline.kernels.jit import entry, kernel
from tautline.kernels.machine import code

compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is about what is compiled")


class Load(NamedTuple):
    place: int
    force: np.ndarray


@entry
def _small(numbers):
    numbers[0] = -1
    return numbers[0]


@entry
def _several(x, n, yes, nothing, load):
    return (x, -n), not yes, load.force[load.place], nothing is None


@entry
def _nothing(values):
    values[0] = 7.0


@entry
def _too_many(x):
    return (x, x, x, x), (x, x, x, x), (x, x, x, x), (x, x, x, x), x


@entry
def _array(values):
    return values


@entry
def _sum_of(values):
    total = 0.0
    for i in range(values.shape[0]):
        for j in range(values.shape[1]):
            total += (1 + i) * (10 + j) * values[i, j]
    return total


@entry
def _slowly(load, x):
    for _ in range(20_000):
        load.force[0] += x
    return x


def test_numbers_of_fewer_bits_keep_their_sign_on_the_way_to_python():
    assert _small(np.zeros(2, np.int32)) == -1 and _small(np.zeros(2, np.int8)) == -1
    assert _small(np.zeros(2, np.float32)) == -1.0


def test_tuples_truth_values_and_nothing_go_both_ways():
    given = 1.5, 3, True, None, Load(1, np.array([2.0, 4.0]))
    assert _several(*given) == ((1.5, -3), False, 4.0, True)
    assert _several(1.5, 3, False, None, given[-1])[1] is True
    values = np.zeros(1)
    assert _nothing(values) is None and values[0] == 7.0


@pytest.mark.parametrize("made", [lambda a: a, np.asfortranarray, lambda a: np.repeat(a, 2, axis=1)[:, ::2]])
def test_an_array_is_read_as_it_lies_in_memory(made):
    """Sum over (1 + i) (10 + j) a_ij, by NumPy."""
    values = np.arange(6.0).reshape(2, 3)
    expected = float(np.sum((1 + np.arange(2))[:, None] * (10 + np.arange(3)) * values))
    assert _sum_of(made(values)) == expected


@compiled
def test_what_python_cannot_take_from_memory_is_refused():
    for function, given in ((_too_many, 1.0), (_array, np.zeros(2))):
        with pytest.raises(TypeError, match="gives back what Python cannot take"):
            function(given)


def test_arguments_that_last_are_found_once_and_an_equal_one_in_their_place_is_found_anew():
    calls, load = Lasting(), Load(0, np.array([2.0, 4.0]))
    assert calls.call(_several, (1.0, 1, True, None, load)) == ((1.0, -1), False, 2.0, True)
    load.force[0] = 3.0
    assert calls.call(_several, (1.0, 1, True, None, load))[2] == 3.0
    for place in (0, 1):
        other = Load(place, np.array([5.0, 6.0]))
        assert calls.call(_several, (1.0, 1, True, None, other))[2] == 5.0 + place


def test_what_is_handed_over_for_one_call_is_that_of_the_call():
    """The same tuple with other numbers in its array, another tuple, another number and another kind of number."""
    calls, lasting, load = Lasting(), (1.5,), Load(0, np.array([2.0, 4.0]))
    assert calls.call(_several, lasting, 3, True, None, load) == ((1.5, -3), False, 2.0, True)
    load.force[0] = 3.0
    assert calls.call(_several, lasting, 3, True, None, load)[2] == 3.0
    assert calls.call(_several, lasting, 4, False, None, Load(1, load.force)) == ((1.5, -4), True, 4.0, True)
    assert calls.call(_several, lasting, 3, True, None, Load(1, np.array([7.0, 8.0])))[2] == 8.0
    assert calls.call(_several, lasting, 3, True, None, load)[2] == 3.0


def test_an_array_that_got_another_shape_is_handed_over_with_that():
    calls, values = Lasting(), np.arange(6.0).reshape(2, 3)
    assert calls.call(_sum_of, (), values) == _sum_of(values.copy())
    values.shape = 3, 2
    assert calls.call(_sum_of, (), values) == _sum_of(values.copy())
    assert calls.call(_sum_of, (), values[:, ::-1]) == _sum_of(values[:, ::-1].copy())


def test_threads_that_call_with_the_same_arguments_each_get_their_own_answer():
    calls, lasting = Lasting(), (Load(0, np.zeros(2)),)

    def wrong(number):
        given = [number + 0.001 * k for k in range(300)]
        return [x for x in given if calls.call(_slowly, lasting, x) != x]

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(wrong, (1.0, 2.0, 3.0, 4.0))) == [[]] * 4


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))], ids=["copied", "sent"])
def test_a_copy_of_what_lasts_is_found_where_its_own_arrays_are(copied):
    calls, load = Lasting(), Load(0, np.array([2.0, 4.0]))
    assert calls.call(_several, (1.0, 1, True, None, load))[2] == 2.0
    other_calls, other = copied((calls, load))
    other.force[0] = 9.0
    assert other_calls.call(_several, (1.0, 1, True, None, other))[2] == 9.0
    assert calls.call(_several, (1.0, 1, True, None, load))[2] == 2.0


@kernel
def _third(x):
    return x / 3.0


@compiled
@pytest.mark.skipif(os.name != "posix", reason="others have no such rights")
def test_code_that_is_kept_may_be_read_by_whom_the_user_lets_read_his_files(tmp_path):
    mask = os.umask(0o022)
    try:
        code.save(tmp_path / "whole.code", b"123")
    finally:
        os.umask(mask)
    assert (tmp_path / "whole.code").stat().st_mode & 0o777 == 0o644 and len(list(tmp_path.iterdir())) == 1


@compiled
def test_code_that_refers_to_what_is_nowhere_counts_as_absent_and_ends_no_process():
    @entry
    def whole(x):
        return 3.0 * _third(x)

    assert whole(2.0) == 2.0
    name = code.name_of(whole.py_func, (float,))
    (stored,) = code.read(whole.py_func, name)
    assert code.load(stored) is not None
    assert code.load(stored._replace(needed=("there_is_none_of_this_name",))) is None


@compiled
def test_forms_go_to_another_process_as_they_are():
    found = next(iter(_several._found), None) or (float, int)
    assert pickle.loads(pickle.dumps(found)) == found


@compiled
def test_threads_that_ask_for_the_same_code_at_once_get_the_same():
    @entry
    def whole(x):
        return 6.0 * _third(x)

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(whole, np.arange(1.0, 9.0))) == [2.0 * x for x in range(1, 9)]
        fresh = entry(whole.py_func)
        assert len({pool.submit(fresh.at, (float,)).result().address for _ in range(4)}) == 1


CHANGED = """
import sys
from tautline.kernels.jit import entry

def made(factor):
    space = {}
    exec(f"def whole(x):\\n    return {factor} * x\\n", space)
    space["whole"].__module__ = "changed"
    return entry(space["whole"])

import types
sys.modules["changed"] = types.ModuleType("changed")
print(*(made(float(factor))(1.0) for factor in sys.argv[1:]))
"""


@pytest.fixture(scope="module")
def young():
    with young_processes() as run:
        yield run


@compiled
def test_changed_code_of_one_name_does_not_run_as_what_it_was_before(tmp_path, young):
    """Each of two processes has given its code the same symbol; the third loads both."""

    def run(*factors):
        done = young(["-c", CHANGED, *factors], cwd=tmp_path, env={**os.environ, "TAUTLINE_CACHE": str(tmp_path)})
        assert done.returncode == 0, done.stderr[-2000:]
        return done.stdout.split()

    assert run("2") + run("3") == ["2.0", "3.0"]
    symbols = {code._from_bytes(file.read_bytes()).symbol for file in tmp_path.rglob("whole-*.code")}
    assert len(symbols) == 1
    assert run("2", "3", "2") == ["2.0", "3.0", "2.0"]


TOGETHER = """
import sys, threading
import numpy as np
from tautline.kernels.jit import entry

@entry
def first(x, n):
    return x[0] * n

arrays = [np.ones(3), np.ones(3, np.int64), np.ones(6)[::2]]
failed = []

def call(k):
    try:
        for i in range(60):
            assert first(arrays[(i + k) % 3], (2, 2.0)[i % 2]) == 2
    except Exception as error:
        failed.append(repr(error))

sys.setswitchinterval(1e-6)
threads = [threading.Thread(target=call, args=(k,)) for k in range(6)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(failed)
"""


@compiled
def test_threads_that_compile_and_call_at_once_do_not_disturb_each_other(tmp_path, young):
    """Six forms of arguments, more than are remembered, with an empty cache."""
    done = young(["-c", TOGETHER], cwd=tmp_path, env={**os.environ, "TAUTLINE_CACHE": str(tmp_path)})
    assert (done.returncode, done.stdout.strip()) == (0, "[]"), done.stderr[-2000:]
