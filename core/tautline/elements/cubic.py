"""What the groups of cubic ALE-ANCF elements share: places of an element's unknowns, and its block of a matrix.

An element has the unknowns (r1, r1', p1, r2, r2', p2), eq. 2.1: seven at each of its nodes, which begin at ``a`` and
``b`` in the full vectors. The four vectors that are interpolated, X1 ... X4 = r1, r1', r2, r2', begin at the places
that :func:`vectors` gives.
"""

from __future__ import annotations

from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import (
    LANES,
    add_at_places,
    add_pairs_at_places,
    add_to,
    collect,
    collect_fours,
    collect_pairs,
    laid_flat,
    load,
    pack,
    spread,
    store,
    transposed,
)
from tautline.kernels.matrix import have_cleared

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
def vectors_of(x, nodes):
    """r and r' of four nodes, three lanes each."""
    (r1, r2, r3, s1), (s2, s3) = collect_fours(x, nodes, 0), collect_pairs(x, nodes, LANES)
    return (r1, r2, r3), (s1, s2, s3)


@kernel(forceinline=True)
def add_to_vectors(x, nodes, on_r, on_s):
    """Add three lanes each to r and r' of four nodes, which may be the same: one node after the other."""
    add_at_places(x, nodes, 0, transposed(on_r[0], on_r[1], on_r[2], on_s[0]))
    add_pairs_at_places(x, nodes, LANES, on_s[1], on_s[2])


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
    (r1, s1), (r2, s2) = vectors_of(x, a), vectors_of(x, b)
    return (r2[0] - r1[0], r2[1] - r1[1], r2[2] - r1[2]), s1, s2


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
def nothing():
    """No force on r2 - r1, r1' and r2' of four elements yet."""
    none = spread(0.0)
    return (none, none, none), (none, none, none), (none, none, none)


@kernel(forceinline=True)
def add_forces(r, a, b, on_chord, on_first, on_second):
    """Add what works on r2 - r1, r1' and r2' of four elements to a residual."""
    x, y, z = on_chord
    add_to_vectors(r, a, (-x, -y, -z), on_first)
    add_to_vectors(r, b, on_chord, on_second)


@kernel(forceinline=True)
def place_of(i, x):
    """Where the row of one axis of the i-th vector of a shape begins."""
    return (AXES * i + x) * SHAPE * LANES


@kernel(forceinline=True)
def write_pairs(four, at, x, y, crosswise, above):
    """Write derivatives on axis x by axis y, and those the other way round, that follow from them.

    ``above`` are those of (r2 - r1, r1'), (r2 - r1, r2') and (r1', r2'), three lanes. The other way round, axis x by
    axis y is the same, or ``crosswise`` what axis y by axis x is: in a symmetric matrix.
    """
    u, w = (y, x) if crosswise else (x, y)
    store(four, at + place_of(0, x) + (AXES + y) * LANES, above[0])
    store(four, at + place_of(0, x) + (2 * AXES + y) * LANES, above[1])
    store(four, at + place_of(1, x) + (2 * AXES + y) * LANES, above[2])
    store(four, at + place_of(1, u) + w * LANES, above[0])
    store(four, at + place_of(2, u) + w * LANES, above[1])
    store(four, at + place_of(2, u) + (AXES + w) * LANES, above[2])


@kernel(forceinline=True)
def write_own(four, at, x, y, own):
    """Write derivatives on axis x by axis y of each vector of a shape by itself, three lanes."""
    for i in range(AXES):
        store(four, at + place_of(i, x) + (AXES * i + y) * LANES, own[i])


@kernel(forceinline=True)
def nodes_in_a_row(number, n, a, b):
    """Whether the unknowns of each node of four elements are numbered one after the other, r and r'."""
    for k in range(LANES):
        if not (in_a_row(number, n, a[k], 2 * AXES) and in_a_row(number, n, b[k], 2 * AXES)):
            return False
    return True


@kernel(forceinline=True)
def have_columns(matrix, number, a, b):
    """Have the columns of the nodes of four elements be cleared in the band, before something is added to them."""
    last = 0
    for k in range(LANES):
        last = max(last, number[a[k]], number[b[k]])
    have_cleared(matrix, last + 2 * AXES)


@kernel(forceinline=True)
def corners_of(number, width, a, b):
    """Where the blocks of two nodes of four elements begin in a band (n, width) laid flat.

    First those in the first node's columns: its own rows and the second's; then those in the second's columns. An entry
    a rows down and b columns on is b (width - 1) + a places further.
    """
    centre = width // 2
    i0, i1, i2, i3 = number[a[0]], number[a[1]], number[a[2]], number[a[3]]
    j0, j1, j2, j3 = number[b[0]], number[b[1]], number[b[2]], number[b[3]]
    own = i0 * width + centre, i1 * width + centre, i2 * width + centre, i3 * width + centre
    other = j0 * width + centre, j1 * width + centre, j2 * width + centre, j3 * width + centre
    return (
        own, (own[0] + j0 - i0, own[1] + j1 - i1, own[2] + j2 - i2, own[3] + j3 - i3),
        (other[0] + i0 - j0, other[1] + i1 - j1, other[2] + i2 - j2, other[3] + i3 - j3), other,
    )  # fmt: skip


@kernel(forceinline=True)
def _add_column(flat, first, second, column, on_r1, on_s1, on_r2, on_s2):
    """Add three lanes each to the rows of r1, r1', r2 and r2' in one column of four elements.

    The rows of a node are added by four and two, for it is its node's other element that adds to them next.
    """
    add_at_places(flat, first, column, transposed(on_r1[0], on_r1[1], on_r1[2], on_s1[0]))
    add_pairs_at_places(flat, first, column + LANES, on_s1[1], on_s1[2])
    add_at_places(flat, second, column, transposed(on_r2[0], on_r2[1], on_r2[2], on_s2[0]))
    add_pairs_at_places(flat, second, column + LANES, on_s2[1], on_s2[2])


@kernel(forceinline=True)
def _column_of_four(four, place, counts):
    """What works on r2 - r1, r1' and r2' of four elements for one change of their shapes: three lanes each."""
    step = SHAPE * LANES
    return (
        (counts * load(four, place), counts * load(four, place + step), counts * load(four, place + 2 * step)),
        (counts * load(four, place + 3 * step), counts * load(four, place + 4 * step),
         counts * load(four, place + 5 * step)),
        (counts * load(four, place + 6 * step), counts * load(four, place + 7 * step),
         counts * load(four, place + 8 * step)),
    )  # fmt: skip


@kernel(forceinline=True)
def _opposite(x):
    return -x[0], -x[1], -x[2]


@kernel(forceinline=True)
def _add_in_a_row(matrix, dofs, four, at, counts, a, b):
    """Add the derivatives of four elements to columns of the band, several rows of them at a time.

    What works on r2 - r1 stands in r2's rows, and with the other sign in r1's.
    """
    flat, width = laid_flat(matrix.band), matrix.band.shape[1]
    in_first, below_it, above_it, in_second = corners_of(dofs.number, width, a, b)
    for vector in range(AXES):
        # Columns of r1 and r2, of r1', of r2'.
        first, second = (in_first, below_it) if vector == 1 else (above_it, in_second)
        for y in range(AXES):
            d, s, t = _column_of_four(four, at + (AXES * vector + y) * LANES, counts)
            column = (y if vector == 0 else AXES + y) * (width - 1)
            _add_column(flat, first, second, column, _opposite(d), s, d, t)
            if vector == 0:
                _add_column(flat, in_first, below_it, column, d, _opposite(s), _opposite(d), _opposite(t))


@kernel(forceinline=True)
def _plus(x, s, axis):
    """x + s e, for three lanes x and the unit vector along an axis."""
    return x[0] + axis[0] * s, x[1] + axis[1] * s, x[2] + axis[2] * s


@kernel(forceinline=True)
def _add_in_a_row_with_mass(matrix, dofs, four, counts, mass, a, b):
    """The same, with a mass matrix whose lower half by columns is ``mass``, the same along all axes."""
    flat, width = laid_flat(matrix.band), matrix.band.shape[1]
    in_first, below_it, above_it, in_second = corners_of(dofs.number, width, a, b)
    (m11, m21, m31, m41), (m22, m32, m42), (m33, m43), (m44,) = mass
    for y in range(AXES):
        axis = 1.0 if y == 0 else 0.0, 1.0 if y == 1 else 0.0, 1.0 if y == 2 else 0.0
        d, s, t = _column_of_four(four, y * LANES, counts)
        column, opposite = y * (width - 1), _opposite(d)
        _add_column(
            flat, in_first, below_it, column,
            _plus(d, m11, axis), _plus(_opposite(s), m21, axis), _plus(opposite, m31, axis),
            _plus(_opposite(t), m41, axis),
        )  # fmt: skip
        _add_column(
            flat, above_it, in_second, column,
            _plus(opposite, m31, axis), _plus(s, m32, axis), _plus(d, m33, axis), _plus(t, m43, axis),
        )  # fmt: skip
        column += AXES * (width - 1)
        d, s, t = _column_of_four(four, (AXES + y) * LANES, counts)
        _add_column(
            flat, in_first, below_it, column,
            _plus(_opposite(d), m21, axis), _plus(s, m22, axis), _plus(d, m32, axis), _plus(t, m42, axis),
        )  # fmt: skip
        d, s, t = _column_of_four(four, (2 * AXES + y) * LANES, counts)
        _add_column(
            flat, above_it, in_second, column,
            _plus(_opposite(d), m41, axis), _plus(s, m42, axis), _plus(d, m43, axis), _plus(t, m44, axis),
        )  # fmt: skip


@kernel(forceinline=True)
def add_scalar_in_a_row(flat, width, corners, i, j, x):
    """Add lanes to entries (X_i, X_j) of four elements along all three axes, and to (X_j, X_i) where these differ.

    ``corners`` are those of :func:`corners_of` in the band (n, width) laid flat.
    """
    row, column = AXES * (i % 2), AXES * (j % 2)
    for c in range(AXES):
        add_to(flat, corners[2 * (j // 2) + i // 2], (column + c) * (width - 1) + row + c, x)
        if i != j:
            add_to(flat, corners[2 * (i // 2) + j // 2], (row + c) * (width - 1) + column + c, x)


@kernel
def add_blocks(matrix, dofs, four, at, each, counts, a, b, block):
    """Add the derivatives of four elements' forces by their shapes to a matrix; ``block`` (12, 12) is scratch.

    Members that are the last one over again, which stand for those that there are not, count nothing.
    """
    if nodes_in_a_row(dofs.number, matrix.band.shape[0], a, b):
        have_columns(matrix, dofs.number, a, b)
        _add_in_a_row(matrix, dofs, four, at, counts, a, b)
        return
    for lane in range(LANES):
        if lane > 0 and each[lane] == each[lane - 1]:
            break
        _write_block(four, at, lane, block)
        add_block(matrix, dofs, a[lane], b[lane] - a[lane], 2 * AXES, block)


@kernel(forceinline=True)
def add_blocks_with_mass(matrix, dofs, four, counts, mass, a, b):
    """The same with mass matrices, whose lower half by columns is ``mass``; the derivatives begin ``four``.

    Returns whether it could: the unknowns of each node must be numbered one after the other.
    """
    if not nodes_in_a_row(dofs.number, matrix.band.shape[0], a, b):
        return False
    have_columns(matrix, dofs.number, a, b)
    _add_in_a_row_with_mass(matrix, dofs, four, counts, mass, a, b)
    return True


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
