"""What the groups of cubic ALE-ANCF elements share: places of an element's unknowns, and its block of a matrix.

An element has the unknowns (r1, r1', p1, r2, r2', p2), eq. 2.1: seven at each of its nodes, which begin at ``a`` and
``b`` in the full vectors. The four vectors that are interpolated, X1 ... X4 = r1, r1', r2, r2', begin at the places
that :func:`vectors` gives.
"""

from __future__ import annotations

from tautline.kernels.dofs import add_entry
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import gather, gather_vector, scatter_vector

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


# -- four elements at once: tautline.kernels.lanes ---------------------------------------------------------------------


@kernel(forceinline=True)
def nodes_of(rows, each):
    """Places of the first and of the second nodes of four elements."""
    i, j, k, l = each
    return (rows[i].a, rows[j].a, rows[k].a, rows[l].a), (rows[i].b, rows[j].b, rows[k].b, rows[l].b)


@kernel(forceinline=True)
def lengths_of(q, a, b):
    """Unstretched lengths of four elements."""
    return gather(q, b, MATERIAL) - gather(q, a, MATERIAL)


@kernel(forceinline=True)
def shape_of(x, a, b):
    """What a slope of four elements depends on: r2 - r1, r1' and r2', three lanes each; of positions or rates."""
    r1, r2 = gather_vector(x, a, 0), gather_vector(x, b, 0)
    chord = (r2[0] - r1[0], r2[1] - r1[1], r2[2] - r1[2])
    return chord, gather_vector(x, a, AXES), gather_vector(x, b, AXES)


@kernel(forceinline=True)
def combined(n, shape):
    """n1 (r2 - r1) + n2 r1' + n3 r2'."""
    d, s, t = shape
    return (
        n[0] * d[0] + n[1] * s[0] + n[2] * t[0],
        n[0] * d[1] + n[1] * s[1] + n[2] * t[1],
        n[0] * d[2] + n[1] * s[2] + n[2] * t[2],
    )


@kernel(forceinline=True)
def dot(x, y):
    """Scalar products of three lanes each."""
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


@kernel(forceinline=True)
def scaled_sum(x, s, y):
    """x + s y, for three lanes x and y."""
    return x[0] + s * y[0], x[1] + s * y[1], x[2] + s * y[2]


@kernel(forceinline=True)
def add_forces(r, a, b, on_chord, on_first, on_second):
    """Add what works on r2 - r1, r1' and r2' of four elements to a residual."""
    x, y, z = on_chord
    scatter_vector(r, a, 0, (-x, -y, -z))
    scatter_vector(r, a, AXES, on_first)
    scatter_vector(r, b, 0, on_chord)
    scatter_vector(r, b, AXES, on_second)
