"""Records, variables and operations in compiled code are what they are in Python."""

import pickle
import subprocess
import sys
from types import FunctionType
from typing import NamedTuple

import numpy as np
import pytest
from numba import config, njit

from tautline.kernels.jit import Kernel, entry, kernel

pytestmark = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="is about what is compiled")


class Spring(NamedTuple):
    """A spring and the positions of its ends."""

    stiffness: float
    slack: int
    ends: np.ndarray


class Pair(NamedTuple):
    """Two springs and a count."""

    near: Spring
    far: Spring
    count: int


class Alike(NamedTuple):
    """Two vectors: numba holds parts of one type as an array."""

    first: np.ndarray
    second: np.ndarray


def pair():
    return Pair(Spring(2.0, 0, np.array([1.0, 4.0])), Spring(3.0, 1, np.array([0.5, 1.0])), 2)


@kernel
def force(spring):
    if spring.slack:
        return 0.25
    return spring.stiffness * (spring.ends[1] - spring.ends[0])


@kernel
def both(springs):
    return force(springs.near) + 10.0 * force(springs.far)


@entry
def of_parts(springs):
    return both(springs) + 100.0 * force(springs.near)


@entry
def of_one_that_is_made(springs, x):
    stiffer = Spring(springs.near.stiffness + x, springs.far.slack, springs.near.ends)
    tighter = Spring(springs.near.stiffness * x, springs.near.slack, springs.far.ends)
    return force(stiffer) + 10.0 * force(tighter) + 100.0 * both(Pair(tighter, stiffer, 1))


@kernel
def scalar_product(vectors):
    total = 0.0
    for i in range(vectors.first.size):
        total += vectors.first[i] * vectors.second[i]
    return total


@entry
def of_one_type(vectors):
    return scalar_product(vectors) + 100.0 * scalar_product(Alike(vectors.second, vectors.second))


@entry
def chosen_anew(springs, n):
    chosen = springs.far
    total = 0.0
    for i in range(n):
        total = 2.0 * total + force(chosen)
        if i % 3 == 1:
            chosen = springs.near
        elif i % 3 == 2:
            chosen = springs.far
    return total + 1000.0 * force(chosen)


def arguments_of(function):
    return {
        of_parts: (pair(),), of_one_that_is_made: (pair(), 1.5), chosen_anew: (pair(), 8),
        of_one_type: (Alike(np.array([1.0, 2.0]), np.array([3.0, 5.0])),),
    }[function]  # fmt: skip


FUNCTIONS = [of_parts, of_one_that_is_made, of_one_type, chosen_anew]


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.__name__)
def test_a_record_that_is_handed_on_is_what_it_is_in_python(function):
    arguments = arguments_of(function)
    assert function(*arguments) == in_python(function)(*arguments) != 0.0


def in_python(function):
    """A function as it is written, and all that it calls."""
    scope = dict(globals())
    for name, each in globals().items():
        if isinstance(each, Kernel):
            scope[name] = FunctionType(each.py_func.__code__, scope)
    return scope[function.__name__]


@njit
def of_numba(spring, x):
    return x * spring.stiffness + spring.ends[0]


@entry
def asks_numba(springs):
    return of_numba(springs.near, 3.0) + 10.0 * of_numba(springs.far, 1.0)


def test_a_function_of_numbas_own_takes_a_record_from_a_kernel_and_from_python():
    springs = pair()
    assert asks_numba(springs) == 2.0 * 3.0 + 1.0 + 10.0 * (3.0 + 0.5)
    assert of_numba(springs.near, 3.0) == 7.0


@entry
def fibonacci(n):
    a, b = 0, 1
    for _ in range(n):
        a, b = b, a + b
    return a


@entry
def known_on_one_way(x, n):
    total = 0.0
    for i in range(n):
        if x > i:
            step = x - i
            last = i
        else:
            step = 0.5
        if step > 1.0:
            total += step * last
            continue
        k = 0
        while True:
            k += 1
            if k * step > 2.0:
                break
        total += k
    return total


@pytest.mark.parametrize(("function", "arguments"), [(fibonacci, (40,)), (known_on_one_way, (4.25, 9))])
def test_a_variable_is_what_was_written_last_on_every_way(function, arguments):
    assert function(*arguments) == function.py_func(*arguments)


@entry
def operations(i, j, x, y, yes):
    whole = i + j - 3 * i // 2 + i % 3 + (i << 2) - (j >> 1) + (i & j) - (i | 6) + (i ^ j) + i**2
    real = x + y - x * y / 3.0 + i * x - y / j + x**2 + x**y + x // y + x % y + j / i
    truth = (i < j) + (x >= y) + (i == x) + (yes and x != y) + (not yes) + yes * 2 + (yes | (i > j)) + (-i) + abs(-x)
    return whole + real + truth


@pytest.mark.parametrize("yes", [True, False])
@pytest.mark.parametrize(("i", "j"), [(7, 2), (-5, 3), (4, -9)])
@pytest.mark.parametrize(("x", "y"), [(2.5, 1.25), (0.75, 3.0)])
def test_operations_of_numbers_give_what_they_give_in_python(i, j, x, y, yes):
    assert operations(i, j, x, y, yes) == pytest.approx(operations.py_func(i, j, x, y, yes), rel=1e-15)


WRITTEN = """
import pickle, sys
from tautline.kernels.matrix import FACTORS, MATRIX
from tautline.kernels.numba_registration import compiler
kinds = [compiler().kind_of(form) for form in (FACTORS, MATRIX)]
sys.stdout.buffer.write(pickle.dumps((list(map(hash, kinds)), kinds)))
"""


def test_a_type_that_another_process_wrote_is_the_same_type():
    """Code is kept with its types. A class has another hash in each process, so one that is kept finds nothing."""
    from tautline.kernels.matrix import FACTORS, MATRIX
    from tautline.kernels.numba_registration import compiler

    written = subprocess.run([sys.executable, "-c", WRITTEN], capture_output=True, check=True).stdout
    _, kinds = pickle.loads(written)
    own = [compiler().kind_of(form) for form in (FACTORS, MATRIX)]
    assert kinds == own
    assert [{kind: 1}.get(mine) for kind, mine in zip(kinds, own, strict=True)] == [1, 1]
