"""Types of values in compiled code: found without numba's own search, and the same."""

import inspect
from typing import NamedTuple

import numpy as np
import pytest
from numba import config, typeof
from numba_types import in_numba

from tautline.kernels.compiling.signatures import signature_of
from tautline.kernels.compiling.types.kinds import kind_of
from tautline.kernels.jit import entry
from tautline.kernels.memory import form_of

ROW = np.dtype([("length", np.float64), ("numbers", np.int64, 3), ("inner", [("x", np.float64), ("y", np.int32)])])


class Pair(NamedTuple):
    first: object
    second: object


TABLE = np.zeros((6, 4))
FIXED = np.zeros(3)
FIXED.flags.writeable = False
VALUES = {
    "vector": np.zeros(3),
    "nothing in a vector": np.zeros(0),
    "matrix": TABLE,
    "matrix by columns": np.asfortranarray(TABLE),
    "every other row": TABLE[::2],
    "number in an array": np.zeros(()),
    "read only": FIXED,
    "truth values": np.zeros(3, bool),
    "small numbers": np.zeros(3, np.int32),
    "texts": np.array(["a", "bc"]),
    "records": np.zeros(2, ROW),
    "aligned records": np.zeros(2, np.dtype(ROW, align=True)),
    "record arrays": np.zeros(2, ROW).view(np.recarray),
    "pair of one kind": Pair(np.zeros(3), np.ones(4)),
    "pair of two kinds": Pair(TABLE, 3),
    "pair of pairs": Pair(Pair(1.0, True), Pair(np.zeros(2, ROW), (1, 2.0, np.float64(3.0)))),
    "nothing": None,
    "number that needs 64 bits": 2**63,
}


@pytest.mark.parametrize("name", VALUES)
def test_a_value_is_of_the_type_that_numba_says(name):
    assert in_numba(kind_of(form_of(VALUES[name]))) == typeof(VALUES[name])
    assert in_numba(kind_of(form_of(Pair(VALUES[name], 1.0)))) == typeof(Pair(VALUES[name], 1.0))


def _of_none(): ...
def _of_two(x, y): ...
def _with_default(x, y=2.0): ...
def _annotated(x: float) -> float: ...
def _by_position(x, /, y): ...
def _by_name(x, *, y): ...
def _of_any(x, *more): ...
def _of_any_name(x, **more): ...


SHAPES = [_of_none, _of_two, _with_default, _annotated, _by_position, _by_name, _of_any, _of_any_name]


@pytest.mark.parametrize("function", SHAPES)
def test_the_arguments_of_a_kernel_are_those_that_python_says(function):
    assert signature_of(function) == inspect.signature(function)


@entry
def _twice(values):
    return 2.0 * values[0]


@pytest.mark.skipif(config.DISABLE_JIT, reason="nothing is compiled")
@pytest.mark.parametrize("values", [np.ma.masked_array([1.0, 2.0], [True, False]), np.array([object()]), (object(),)])
def test_what_compiled_code_cannot_take_is_refused(values):
    with pytest.raises(TypeError, match="compiled code takes"):
        _twice(values)
    assert _twice(np.array([1.5])) == 3.0
