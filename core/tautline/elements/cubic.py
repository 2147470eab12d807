"""What the groups of cubic ALE-ANCF elements share: places of an element's unknowns, and its block of a matrix.

An element has the unknowns (r1, r1', p1, r2, r2', p2), eq. 2.1: seven at each of its nodes, which begin at ``a`` and
``b`` in the full vectors. The four vectors that are interpolated, X1 ... X4 = r1, r1', r2, r2', begin at the places
that :func:`vectors` gives.
"""

from __future__ import annotations

from tautline.kernels.dofs import add_entry
from tautline.kernels.jit import kernel

NODE, MATERIAL, VECTORS, AXES = 7, 6, 4, 3
"""Unknowns of a node; place of p among them; vectors of an element; components of a vector."""


@kernel
def vectors(a, b):
    """Where X1 ... X4 begin in a full vector."""
    return a, a + AXES, b, b + AXES


@kernel
def row_of(j):
    """Where X_j begins in an element's block (14, 14)."""
    return (j // 2) * NODE + (j % 2) * AXES


@kernel
def add_scalars(matrix, dofs, a, b, factor, block):
    """Add factor times a block (4, 4) of scalars, each of which stands for all three axes."""
    first = vectors(a, b)
    for i in range(VECTORS):
        for j in range(VECTORS):
            for c in range(AXES):
                add_entry(matrix, dofs, first[i] + c, first[j] + c, factor * block[i, j])
