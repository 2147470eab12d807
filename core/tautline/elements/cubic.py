"""What the groups of cubic ALE-ANCF elements share: places of an element's unknowns, and its block of a matrix.

An element has the unknowns (r1, r1', p1, r2, r2', p2), eq. 2.1: seven at each of its nodes, which begin at ``a`` and
``b`` in the full vectors. The four vectors that are interpolated, X1 ... X4 = r1, r1', r2, r2', begin at the places
that :func:`vectors` gives.
"""

from __future__ import annotations

from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, add_to, collect, load, pack, spread, store

NODE, MATERIAL, VECTORS, AXES = 7, 6, 4, 3
"""Unknowns of a node; place of p among them; vectors of an element; components of a vector."""
SHAPE = 3 * AXES
"""Numbers on which the slope of an element depends: r2 - r1, r1' and r2'."""
BLOCK_OF_FOUR = SHAPE * SHAPE * LANES
"""Places in memory of the derivatives of four elements' forces by these numbers."""


@kernel
def vectors(a, b):
    """Where X1 ... X4 begin in a full vector."""
    return a, a + AXES, b, b + AXES


@kernel
def row_of(j):
    """Where X_j begins in an element's block (14, 14)."""
    return (j // 2) * NODE + (j % 2) * AXES


@kernel(forceinline=True)
def in_a_row(number, n, place, count):
    """Whether degrees of freedom are unknowns of the band (n,), numbered one after the other."""
    first = number[place]
    if first < 0 or first + count > n:
        return False
    for c in range(1, count):
        if number[place + c] != first + c:
            return False
    return True


@kernel
def add_scalars(matrix, dofs, a, b, factor, block):
    """Add factor times a block (4, 4) of scalars, each of which stands for all three axes.

    To a ``Matrix``, or to a diagonal (n,).
    """
    first = vectors(a, b)
    for i in range(VECTORS):
        for j in range(VECTORS):
            for c in range(AXES):
                add_entry(matrix, dofs, first[i] + c, first[j] + c, factor * block[i, j])


@kernel
def add_scalars_to_band(matrix, dofs, a, b, factor, block):
    """The same to a ``Matrix``, quicker where an element's unknowns are numbered one after the other."""
    number = dofs.number
    n, centre = matrix.band.shape[0], 2 * ((matrix.band.shape[1] - 1) // 3)
    if not (in_a_row(number, n, a, 2 * AXES) and in_a_row(number, n, b, 2 * AXES)):
        add_scalars(matrix, dofs, a, b, factor, block)
        return
    for j in range(VECTORS):
        column = number[a if j < 2 else b] + AXES * (j % 2)
        for i in range(VECTORS):
            at = centre + number[a if i < 2 else b] + AXES * (i % 2) - column
            x = factor * block[i, j]
            matrix.band[column, at] += x
            matrix.band[column + 1, at] += x
            matrix.band[column + 2, at] += x


# -- four elements at once: tautline.kernels.lanes ---------------------------------------------------------------------


@kernel(forceinline=True)
def members(n, count):
    """Numbers of four members of a group from the n-th on, and 1 for each of them.

    Where there are fewer left, the last stands for those that there are not, and counts 0.
    """
    last = count - 1
    i, j, k = min(n + 1, last), min(n + 2, last), min(n + 3, last)
    counts = pack(1.0, 1.0 if n + 1 <= last else 0.0, 1.0 if n + 2 <= last else 0.0, 1.0 if n + 3 <= last else 0.0)
    return (n, i, j, k), counts


@kernel(forceinline=True)
def collect_vector(x, places, offset):
    """Three lanes: the components of vectors that begin at four places, each moved by ``offset``."""
    return collect(x, places, offset), collect(x, places, offset + 1), collect(x, places, offset + 2)


@kernel(forceinline=True)
def add_to_vector(x, places, offset, vector):
    """Add three lanes to the vectors that begin at four places, each moved by ``offset``."""
    add_to(x, places, offset, vector[0])
    add_to(x, places, offset + 1, vector[1])
    add_to(x, places, offset + 2, vector[2])


@kernel(forceinline=True)
def nodes_of(rows, each):
    """Places of the first and of the second nodes of four elements."""
    i, j, k, l = each
    return (rows[i].a, rows[j].a, rows[k].a, rows[l].a), (rows[i].b, rows[j].b, rows[k].b, rows[l].b)


@kernel(forceinline=True)
def lengths_of(q, a, b):
    """Unstretched lengths of four elements."""
    return collect(q, b, MATERIAL) - collect(q, a, MATERIAL)


@kernel(forceinline=True)
def shape_of(x, a, b):
    """What a slope of four elements depends on: r2 - r1, r1' and r2', three lanes each; of positions or rates."""
    r1, r2 = collect_vector(x, a, 0), collect_vector(x, b, 0)
    chord = (r2[0] - r1[0], r2[1] - r1[1], r2[2] - r1[2])
    return chord, collect_vector(x, a, AXES), collect_vector(x, b, AXES)


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
    add_to_vector(r, a, 0, (-x, -y, -z))
    add_to_vector(r, a, AXES, on_first)
    add_to_vector(r, b, 0, on_chord)
    add_to_vector(r, b, AXES, on_second)


@kernel(forceinline=True)
def clear_blocks(four, at):
    """Set the derivatives of four elements' forces by their shapes, from place ``at`` on, to zero."""
    for k in range(at, at + BLOCK_OF_FOUR, LANES):
        store(four, k, spread(0.0))


@kernel(forceinline=True)
def add_to_row(four, at, x, n):
    """Add x n1, x n2 and x n3 to a row of the derivatives, at one axis of r2 - r1, r1' and r2'."""
    store(four, at, load(four, at) + x * n[0])
    store(four, at + AXES * LANES, load(four, at + AXES * LANES) + x * n[1])
    store(four, at + 2 * AXES * LANES, load(four, at + 2 * AXES * LANES) + x * n[2])


@kernel(forceinline=True)
def place_of(i, x):
    """Where the row of one axis of the i-th vector of a shape begins."""
    return (AXES * i + x) * SHAPE * LANES


@kernel(forceinline=True)
def _add_column(column, at, to, four, place, sign):
    """Add a column of derivatives to one of a band: what works on r2 - r1 to r2, with the other sign to r1.

    The unknowns of r1 and r1' begin at ``at`` of the column, those of r2 and r2' at ``to``.
    """
    step = SHAPE * LANES
    for c in range(AXES):
        chord = sign * four[place + c * step]
        column[at + c] -= chord
        column[to + c] += chord
        column[at + AXES + c] += sign * four[place + (AXES + c) * step]
        column[to + AXES + c] += sign * four[place + (2 * AXES + c) * step]


@kernel
def add_blocks(matrix, dofs, four, at, each, a, b, block):
    """Add the derivatives of four elements' forces by their shapes to a matrix; ``block`` (12, 12) is scratch.

    Of members that are the last one over again, which stand for those that there are not, the first counts.
    """
    number = dofs.number
    n, centre = matrix.band.shape[0], 2 * ((matrix.band.shape[1] - 1) // 3)
    for lane in range(LANES):
        if lane > 0 and each[lane] == each[lane - 1]:
            break
        i, j = a[lane], b[lane]
        if not (in_a_row(number, n, i, 2 * AXES) and in_a_row(number, n, j, 2 * AXES)):
            _write_block(four, at, lane, block)
            add_block(matrix, dofs, i, j - i, 2 * AXES, block)
            continue
        i, j = number[i], number[j]
        for c in range(AXES):
            chord = at + c * LANES + lane
            first, second = chord + AXES * LANES, chord + 2 * AXES * LANES
            _add_column(matrix.band[i + c], centre - c, centre + j - i - c, four, chord, -1.0)
            _add_column(matrix.band[j + c], centre + i - j - c, centre - c, four, chord, 1.0)
            _add_column(matrix.band[i + AXES + c], centre - AXES - c, centre + j - i - AXES - c, four, first, 1.0)
            _add_column(matrix.band[j + AXES + c], centre + i - j - AXES - c, centre - AXES - c, four, second, 1.0)


@kernel
def _write_block(four, at, lane, block):
    """Write one element's derivatives by (r1, r1', r2, r2')."""
    for i in range(SHAPE):
        # r2 - r1 belongs to r2, and with the other sign to r1; r1' and r2' have rows of their own.
        row = i + 2 * AXES if i < AXES else i if i < 2 * AXES else i + AXES
        for j in range(SHAPE):
            column = j + 2 * AXES if j < AXES else j if j < 2 * AXES else j + AXES
            x = four[at + (SHAPE * i + j) * LANES + lane]
            block[row, column] = x
            if i < AXES:
                block[i, column] = -x
            if j < AXES:
                block[row, j] = -x
            if i < AXES and j < AXES:
                block[i, j] = x
