"""Factors in single precision: an iteration that evaluates its residual in double precision can do with them.

They are read from memory once an iteration, and take half of the memory (``singles`` of kernels/matrix.py). Where
single precision keeps too few digits of an equation, the iteration contracts badly although its factors are new. That
alone proves nothing, for a way that bends does the same: then the first solution by the next factors is tested.
"""

from __future__ import annotations

from tautline.kernels.jit import kernel
from tautline.kernels.matrix import (
    DOUBTED,
    FACTORS,
    IN_BLOCKS,
    MAY_BE_SINGLE,
    PACKED,
    SINGLE,
    VECTOR,
    factorise_apart,
    solve_apart,
)
from tautline.kernels.separate import separate
from tautline.kernels.vector import copy

LEFT = 0.01
"""Share of the right side that a solution by rounded blocks may leave."""


@kernel(forceinline=True)
def solve_for(factors, x, right_side):
    """Solve A x = b for an iteration that improves the solution; ``x`` and ``right_side`` (n,) hold b.

    Where it is doubted that rounded factors serve, their first solution is put to the test.
    """
    integers = factors.integers
    doubted = integers[SINGLE] == 1 and integers[DOUBTED] == 1 and integers[PACKED] == IN_BLOCKS
    solve_apart(factors, x)
    if doubted:
        _make_sure(factors, x, right_side)


@kernel
def doubt(factors):
    """Doubt that rounded factors serve: the next that are made are tested."""
    factors.integers[DOUBTED] = 1


@separate(type(None), FACTORS, VECTOR, VECTOR, late=True)
def _make_sure(f, x, right_side):
    """Keep a solution by rounded factors that leaves little of the right side, or make factors of double precision.

    They are double from then on.
    """
    f.integers[DOUBTED] = 0
    if _left_over(f, x, right_side) <= LEFT:
        return
    f.integers[MAY_BE_SINGLE] = 0
    factorise_apart(f)
    copy(right_side, x)
    solve_apart(f, x)


@kernel
def _left_over(f, x, right_side):
    """The largest part of a row of b - A x, scaled as the matrix is, over that of b; blocks leave the band as it is."""
    n, k = f.matrix.band.shape[0], f.matrix.band.shape[1] // 2
    # One over the pivots is asked for by nobody who solves in blocks.
    left = f.inverse
    copy(right_side, left)
    for j in range(n):
        first, last = max(0, j - k), min(n, j + k + 1)
        for i in range(first, last):
            left[i] -= f.matrix.band[j, k + i - j] * x[j]
    most = largest = 0.0
    for i in range(n):
        most = max(most, abs(f.scale[i] * right_side[i]))
        largest = max(largest, abs(f.scale[i] * left[i]))
    return largest / most if most > 0.0 else 0.0
