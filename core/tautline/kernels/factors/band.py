"""LU factors of a band: Gaussian elimination that keeps to the band's envelope and exchanges few rows.

LAPACK's dgbtrf exchanges rows for the largest pivot of a column, which fills the band to half as much again, and works
on the whole width of it; most columns of a chain of elements reach less far. Here rows are exchanged only where the
diagonal is below a ``threshold`` of the largest entry under it, as sparse solvers do, and every column stops where its
envelope does. On the bands of this project, some tens of unknowns wide, that is twice as fast as the call.

A band of k diagonals on either side is stored by columns: entry (i, j) at ``band[j, k + i - j]``, shape (n, 2 k + 1).
The factors stand as LAPACK has them: entry (i, j) at ``lu[j, 2 k + i - j]``, shape (n, 3 k + 1), the first k places of
a column being room for what exchanges of rows fill. Multipliers stay where they were made.
"""

from __future__ import annotations

from math import sqrt

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import laid_flat

CAREFUL, BOLD = 0.1, 1.0e-4
"""Share of the largest entry of its column that a pivot on the diagonal must have, the matrix being scaled: in general,
and where factors are to be renewed in part and no equation is a constraint. There the only small pivots are those of a
lump that sticks or rolls, whose own inertia is what its contact's stiffness leaves: exchanging rows mends nothing."""
ROUNDED = 1.0e-15
"""Share of a column's largest entry below which two factors are the same."""
NARROW = 3
"""Diagonals on each side of the band of a bar of cubic elements."""


@kernel
def equilibrate(band, lu, scale, n, k):
    """Write the band to where it is factorised, rows and columns times one over the square root of the diagonal.

    ``scale`` (n,) keeps by what.
    """
    for j in range(n):
        size = abs(band[j, k])
        scale[j] = 1.0 / sqrt(size) if size > 0.0 else 1.0
    for j in range(n):
        column, scaled = band[j], lu[j]
        first, last = max(0, j - k), min(n, j + k + 1)
        for i in range(k):
            scaled[i] = 0.0
        for i in range(first, last):
            scaled[2 * k + i - j] = column[k + i - j] * (scale[i] * scale[j])


@kernel
def find_envelope(lu, below, right, n, k):
    """Find the last row of each column that is not zero, and the last column of each row."""
    for j in range(n):
        right[j] = j
    for j in range(n):
        column = lu[j]
        above = min(j, k)
        while above > 0 and column[2 * k - above] == 0.0:
            above -= 1
        right[j - above] = j  # columns come in order: the last to reach a row stays
        under = min(n - 1 - j, k)
        while under > 0 and column[2 * k + under] == 0.0:
            under -= 1
        below[j] = j + under


@kernel
def eliminate(lu, pivots, above, below, right, inverse, threshold, n, k):
    """Factorise in place.

    Parameters
    ----------
    lu : (n, 3 k + 1) array
        The matrix as :func:`equilibrate` writes it; its factors on return.
    pivots : (n,) int32 array
        On return, the row that was exchanged for each, counted from one.
    above, below : (n,) int32 arrays
        On return, how far from the diagonal the factors' columns go; ``below`` as :func:`find_envelope` left it.
    right : (n,) int32 array
        From :func:`find_envelope`.
    inverse : (n,) array
        On return, one over the pivots.
    threshold : float
        `CAREFUL` or `BOLD`.

    Returns
    -------
    row, exchanged : int
        0, or j > 0 where the j-th pivot is exactly zero; and how many rows were exchanged.
    """
    flat, width, centre = laid_flat(lu), lu.shape[1], 2 * k
    bottom, reach, exchanged = 0, -1, 0
    for j in range(n):
        column = lu[j]
        bottom = max(bottom, below[j])
        m = bottom - j
        size = abs(column[centre])
        largest, row = size, 0
        for i in range(1, m + 1):
            x = abs(column[centre + i])
            if x > largest:
                largest, row = x, i
        if largest == 0.0:  # what is no number goes on, and is found in the solution
            return j + 1, exchanged
        last = max(reach, right[j])
        if threshold * largest > size:
            for i in range(1, row + 1):
                last = max(last, right[j + i])
        else:
            row = 0
        for i in range(reach + 1, last + 1):
            above[i] = i - j
        reach = last
        pivots[j] = j + row + 1
        if row > 0:
            exchanged += 1
            for l in range(j, reach + 1):
                at = l * (width - 1) + centre + j
                x = flat[at]
                flat[at] = flat[at + row]
                flat[at + row] = x
        h = 1.0 / column[centre]
        inverse[j] = h
        below[j] = m
        first = j * width + centre + 1
        for i in range(m):
            flat[first + i] *= h
        for l in range(j + 1, reach + 1):
            at = l * (width - 1) + centre + j
            y = flat[at]
            if y != 0.0:
                at += 1
                for i in range(m):
                    flat[at + i] -= y * flat[first + i]
    return 0, exchanged


@kernel
def renew(factors, n, k, first, last):
    """Make the factors anew where the matrix has changed, and as far beyond as that reaches.

    A change fades from column to column of the factors as a push does along a rope. What is left of it is below their
    rounding after some tens of columns, and from there on they stay as they are.

    Parameters
    ----------
    factors : Factors
        The matrix as it is now, its entries within ``first`` to ``last`` - 1 other than those that were factorised; and
        the factors of these, from :func:`equilibrate` and :func:`eliminate`.

    Returns
    -------
    int
        Columns that were made, or -1 where a row would have to be exchanged: then all is to be factorised anew.
    """
    band, lu = factors.matrix.band, factors.lu
    pivots, scale, column = factors.pivots, factors.scale, factors.column
    above, below, inverse = factors.above, factors.below, factors.inverse
    for j in range(first, last):
        size = abs(band[j, k])
        scale[j] = 1.0 / sqrt(size) if size > 0.0 else 1.0
    # The scale of a row stands in all columns that it reaches.
    begin, same = max(0, first - k), 0
    for p in range(max(0, begin - 2 * k), begin):
        if pivots[p] != p + 1:
            return -1
    for j in range(begin, n):
        top, bottom = max(0, j - k), min(n - 1, j + k)
        for i in range(top, bottom + 1):
            column[k + i - j] = band[j, k + i - j] * scale[i] * scale[j]
        for p in range(top, j):
            y = column[k + p - j]
            if y != 0.0:
                at = k + p - j
                for i in range(1, below[p] + 1):
                    column[at + i] -= y * lu[p, 2 * k + i]
        pivot, largest = column[k], 0.0
        for i in range(1, bottom - j + 1):
            largest = max(largest, abs(column[k + i]))
        if pivots[j] != j + 1 or not factors.threshold * largest <= abs(pivot) or pivot == 0.0:
            return -1
        h = 1.0 / pivot
        for i in range(1, bottom - j + 1):
            column[k + i] *= h
        difference = most = 0.0
        for i in range(top, bottom + 1):
            old, new = lu[j, 2 * k + i - j], column[k + i - j]
            difference = max(difference, abs(new - old))
            most = max(most, abs(new))
            lu[j, 2 * k + i - j] = new
        inverse[j] = h
        above[j] = j - top
        below[j] = bottom - j
        same = same + 1 if difference <= ROUNDED * most else 0
        if same >= k and j >= last + k:
            return j + 1 - begin
    return n - begin


@kernel(forceinline=True)
def substitute(lu, pivots, above, below, inverse, scale, exchanged, n, k, x):
    """Solve by the factors; ``x`` (n,) holds the right side before and the solution after."""
    for j in range(n):
        x[j] *= scale[j]
    if k == NARROW and not exchanged:
        _substitute_narrow(lu, inverse, n, x)
    else:
        substitute_between(lu, pivots, above, below, inverse, 0, n, k, x)
    for j in range(n):
        x[j] *= scale[j]


@kernel
def substitute_between(lu, pivots, above, below, inverse, first, last, k, x):
    """Solve for rows ``first`` to ``last`` - 1 of a scaled matrix, those beyond being zero on both sides.

    Up to k places of ``x`` on either side of these are scratch.
    """
    first = max(0, first)  # no more than a hint for the compiler: places counted from the end need code of their own
    for j in range(first, last):
        row = pivots[j] - 1
        y = x[row]
        if row != j:
            x[row] = x[j]
            x[j] = y
        column = lu[j]
        for i in range(1, below[j] + 1):
            x[j + i] -= column[2 * k + i] * y
    for j in range(last - 1, first - 1, -1):
        column = lu[j]
        y = x[j] * inverse[j]
        x[j] = y
        top, place = j - above[j], 2 * k - above[j]
        for i in range(above[j]):
            x[top + i] -= column[place + i] * y


@kernel
def _substitute_narrow(lu, inverse, n, x):
    """The same for three diagonals each side, as bars have: what the next rows wait for stays in registers.

    Each row waits for the one before it. So all that need not wait is kept out of its way: the products with the
    inverse diagonal are made before a row's turn comes.
    """
    y, y1, y2 = x[0], x[1] if n > 1 else 0.0, x[2] if n > 2 else 0.0
    for j in range(n):
        column = lu[j]
        x[j] = inverse[j] * y
        y3 = x[j + 3] if j + 3 < n else 0.0
        y, y1, y2 = y1 - column[7] * y, y2 - column[8] * y, y3 - column[9] * y
    y, y1, y2 = x[n - 1], x[n - 2] if n > 1 else 0.0, x[n - 3] if n > 2 else 0.0
    h1, h2 = inverse[n - 2] if n > 1 else 0.0, inverse[n - 3] if n > 2 else 0.0
    for j in range(n - 1, -1, -1):
        column = lu[j]
        x[j] = y
        y3, h3 = (x[j - 3], inverse[j - 3]) if j > 2 else (0.0, 0.0)
        y, y1, y2 = y1 - (column[5] * h1) * y, y2 - (column[4] * h2) * y, y3 - (column[3] * h3) * y
        h1, h2 = h2, h3
