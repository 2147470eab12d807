"""LAPACK's banded LU, called from compiled code.

The routines are those that SciPy ships (``scipy.linalg.cython_lapack``). Their addresses change from process to
process, so the machine code refers to them by symbol and stays cacheable (a ctypes pointer would not).

Band storage: ``band[j, kl + ku + i - j] = A[i, j]``, C-contiguous, shape (n, 2 kl + ku + 1): column j of the matrix
is row j here, which is LAPACK's own layout; the first ``kl`` places of a row are room for the pivoting.
"""

from __future__ import annotations

import llvmlite.binding
import numpy as np
from numba import config, types
from numba.extending import get_cython_function_address

from tautline.kernels.jit import entry


def _routine(name: str, arguments: int) -> types.ExternalFunction:
    symbol = f"tautline_{name}"
    llvmlite.binding.add_symbol(symbol, get_cython_function_address("scipy.linalg.cython_lapack", name))
    return types.ExternalFunction(symbol, types.void(*[types.uintp] * arguments))


_dgbtrf = _routine("dgbtrf", 8)
_dgbtrs = _routine("dgbtrs", 11)
_dgetrf = _routine("dgetrf", 6)
_dgetrs = _routine("dgetrs", 9)
_NO_TRANSPOSE = ord("N")


@entry
def factorise(band, pivots, n, kl, ku, integers):
    """Factorise a banded matrix in place (LU with partial pivoting).

    Parameters
    ----------
    band : (n, 2 kl + ku + 1) float array
        The matrix; its factors on return.
    pivots : (n,) int32 array
        Row interchanges, on return.
    n, kl, ku : int
        Size, sub- and superdiagonals.
    integers : (8,) int32 array
        Scratch through which the sizes are passed by reference.

    Returns
    -------
    int
        0; or k > 0 where the k-th pivot is exactly zero.
    """
    integers[0] = n
    integers[1] = kl
    integers[2] = ku
    integers[3] = 2 * kl + ku + 1
    integers[4] = 0
    base = integers.ctypes.data
    _dgbtrf(base, base, base + 4, base + 8, band.ctypes.data, base + 12, pivots.ctypes.data, base + 16)
    return integers[4]


@entry
def solve(band, pivots, n, kl, ku, integers, x):
    """Solve A x = b with the factors of :func:`factorise`; ``x`` (n,) holds b before and x after."""
    integers[0] = n
    integers[1] = kl
    integers[2] = ku
    integers[3] = 2 * kl + ku + 1
    integers[4] = 0
    integers[5] = 1
    integers[6] = _NO_TRANSPOSE
    base = integers.ctypes.data
    _dgbtrs(
        base + 24, base, base + 4, base + 8, base + 20, band.ctypes.data, base + 12, pivots.ctypes.data,
        x.ctypes.data, base, base + 16,
    )  # fmt: skip


@entry
def factorise_dense(matrix, pivots, n, integers):
    """Factorise a small dense matrix (n, n), stored by columns, in place; returns 0 or the pivot that is zero."""
    integers[0] = n
    integers[4] = 0
    base = integers.ctypes.data
    _dgetrf(base, base, matrix.ctypes.data, base, pivots.ctypes.data, base + 16)
    return integers[4]


@entry
def solve_dense(matrix, pivots, n, integers, x):
    """Solve A x = b with the factors of :func:`factorise_dense`, in place."""
    integers[0] = n
    integers[4] = 0
    integers[5] = 1
    integers[6] = _NO_TRANSPOSE
    base = integers.ctypes.data
    _dgetrs(base + 24, base, base + 20, matrix.ctypes.data, base, pivots.ctypes.data, x.ctypes.data, base, base + 16)


def band_of(n: int, kl: int, ku: int) -> np.ndarray:
    """Zero band storage, shape (n, 2 kl + ku + 1)."""
    return np.zeros((n, 2 * kl + ku + 1))


if config.DISABLE_JIT:
    # Uncompiled, an external function does nothing: the same routines by SciPy's own wrapper.
    from scipy.linalg.lapack import dgbtrf, dgbtrs, dgetrf, dgetrs

    def factorise(band, pivots, n, kl, ku, integers):
        """Factorise by :func:`scipy.linalg.lapack.dgbtrf`."""
        factors, rows, info = dgbtrf(band.T, kl, ku)
        pivots[:] = rows + 1
        band[:] = factors.T
        return info

    def solve(band, pivots, n, kl, ku, integers, x):
        """Solve by :func:`scipy.linalg.lapack.dgbtrs`."""
        x[:n] = dgbtrs(band.T, kl, ku, x[:n], pivots - 1)[0]

    def factorise_dense(matrix, pivots, n, integers):
        """Factorise by :func:`scipy.linalg.lapack.dgetrf`."""
        factors, pivots[:], info = dgetrf(matrix.T)
        matrix[:] = factors.T
        return info

    def solve_dense(matrix, pivots, n, integers, x):
        """Solve by :func:`scipy.linalg.lapack.dgetrs`."""
        x[:] = dgetrs(matrix.T, pivots, x)[0]
