"""Vectors in compiled code: those of a whole system as arrays, those in space as three numbers each.

Three numbers stay in registers. They may be lanes of four elements each (:mod:`tautline.kernels.lanes`): what is
written here is then done for all four. Where such vectors are kept they are rows of arrays, which may be given as well.
"""

from __future__ import annotations

from tautline.kernels.jit import kernel


@kernel
def copy(source, target):
    """Write the vector ``source`` (n,) over ``target``.

    A plain loop: NumPy's slice assignment would do, but compiles fifty times as much code.
    """
    for i in range(source.size):
        target[i] = source[i]


@kernel(forceinline=True)
def dot(x, y):
    """Scalar product of two vectors (3,)."""
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


@kernel(forceinline=True)
def cross(x, y):
    """Vector product of two vectors (3,)."""
    return x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]


@kernel(forceinline=True)
def scaled(s, x):
    """Vector s x (3,)."""
    return s * x[0], s * x[1], s * x[2]


@kernel(forceinline=True)
def scaled_sum(x, s, y):
    """Vector x + s y (3,)."""
    return x[0] + s * y[0], x[1] + s * y[1], x[2] + s * y[2]
