"""LAPACK's dense LU, called from compiled code.

The routines are those that SciPy ships (:data:`ROUTINES`). Their addresses change from process to process, so the
machine code refers to them by symbol and stays cacheable (a ctypes pointer would not). SciPy's linear algebra is loaded
when a routine is called first: only a matrix with a border needs it, and it starts threads of its own that keep a
processor busy for a tenth of a second.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import importlib
import sys
import threading
from collections.abc import Callable, Iterator
from importlib import util
from importlib.machinery import PathFinder
from typing import Any

import llvmlite.binding

from tautline.kernels.jit import entry, kernel
from tautline.kernels.machine.settings import UNCOMPILED
from tautline.kernels.numba_registration import taught

ROUTINES = "scipy.linalg.cython_lapack"


@contextlib.contextmanager
def _loaded_alone(name: str) -> Iterator[None]:
    """Have an extension module of SciPy without the packages that it lies in, whose import takes 0.2 s.

    It is known by its name inside only: imported later, by anybody, it is made a part of its package as ever. Where it
    cannot be loaded so, for whatever reason, it is imported as usual by whoever asks for it.
    """
    module = None if name in sys.modules else _module_alone(name)
    if module is None:
        yield
        return
    sys.modules[name] = module
    try:
        yield
    finally:
        if sys.modules.get(name) is module:
            del sys.modules[name]


def _module_alone(name: str) -> Any:
    top, package, _ = name.split(".")
    found = util.find_spec(top)
    places = found.submodule_search_locations if found else None
    spec = PathFinder.find_spec(name, [f"{place}/{package}" for place in places]) if places else None
    if spec is None or spec.loader is None:
        return None
    with contextlib.suppress(ImportError):
        module = util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    return None


_loading = threading.Lock()
_name = ctypes.pythonapi.PyCapsule_GetName
_name.restype, _name.argtypes = ctypes.c_char_p, [ctypes.py_object]
_pointer = ctypes.pythonapi.PyCapsule_GetPointer
_pointer.restype, _pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]


@functools.cache
def _address(name: str) -> int:
    with _loading, _loaded_alone(ROUTINES):
        held = importlib.import_module(ROUTINES).__pyx_capi__[name]
        return int(_pointer(held, _name(held)))


def _routine(name: str, arguments: int) -> Callable[[tuple[int, ...]], None]:
    """A routine of LAPACK for compiled code, which hands it the addresses of its arguments.

    It is called by an address in memory, as a dynamic loader does for a shared library: what stands there first finds
    the routine, has its address stand there from then on, and hands over the call.
    """
    kind = ctypes.CFUNCTYPE(None, *[ctypes.c_size_t] * arguments)

    def found(*given: int) -> None:
        held.value = _address(name)
        kind(held.value)(*given)

    first = kind(found)
    held = ctypes.c_void_p(ctypes.cast(first, ctypes.c_void_p).value)
    _kept.append((first, held))
    symbol = f"tautline_{name}"
    llvmlite.binding.add_symbol(symbol, ctypes.addressof(held))

    def call(given):
        """Call the routine with the addresses of its arguments."""

    taught("calls", "called_by_place", call, symbol)
    return call


_kept: list[Any] = []
"""What compiled code refers to, which has to stay in memory."""

_dgetrf = _routine("dgetrf", 6)
_dgetrs = _routine("dgetrs", 9)
_NO_TRANSPOSE = ord("N")


@kernel
def factorise_dense_inside(matrix, pivots, n, integers):
    """Factorise a small dense matrix (n, n), stored by columns, in place; returns 0 or the pivot that is zero."""
    integers[0] = n
    integers[4] = -1  # which LAPACK overwrites
    base = integers.ctypes.data
    _dgetrf((base, base, matrix.ctypes.data, base, pivots.ctypes.data, base + 16))
    return integers[4]


@kernel
def solve_dense_inside(matrix, pivots, n, integers, x):
    """Solve A x = b with the factors of :func:`factorise_dense_inside`, in place."""
    integers[0] = n
    integers[4] = 0
    integers[5] = 1
    integers[6] = _NO_TRANSPOSE
    base = integers.ctypes.data
    _dgetrs((base + 24, base, base + 20, matrix.ctypes.data, base, pivots.ctypes.data, x.ctypes.data, base, base + 16))


@entry
def factorise_dense(matrix, pivots, n, integers):
    """The same as :func:`factorise_dense_inside`, for Python."""
    return factorise_dense_inside(matrix, pivots, n, integers)


@entry
def solve_dense(matrix, pivots, n, integers, x):
    """The same as :func:`solve_dense_inside`, for Python."""
    solve_dense_inside(matrix, pivots, n, integers, x)


if UNCOMPILED:
    # Uncompiled, an external function does nothing: the same routines by SciPy's own wrapper.
    from scipy.linalg.lapack import dgetrf, dgetrs

    def factorise_dense(matrix, pivots, n, integers):
        """Factorise by :func:`scipy.linalg.lapack.dgetrf`, which counts rows from zero.

        Pivots are kept as compiled code keeps them, counted from one: a run may go on with the factors of another.
        """
        factors, exchanged, info = dgetrf(matrix.T)
        pivots[:] = exchanged + 1
        matrix[:] = factors.T
        return info

    def solve_dense(matrix, pivots, n, integers, x):
        """Solve by :func:`scipy.linalg.lapack.dgetrs`."""
        x[:] = dgetrs(matrix.T, pivots - 1, x)[0]

    factorise_dense_inside, solve_dense_inside = factorise_dense, solve_dense
