"""Which entries of a matrix may differ from zero, and the order of unknowns that lays them in a narrow band."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LOCAL = 60
"""Unknowns that one may depend on and still belong to the band."""
NEAR = 0.25
"""Share of the least possible width by which a band may be wider before a better order is looked for."""


@dataclass(frozen=True)
class Pattern:
    """Entries of a symmetric (size, size) pattern: ``row`` and ``column`` (k,) of each, once."""

    size: int
    row: np.ndarray
    column: np.ndarray

    @property
    def degree(self) -> np.ndarray:
        """Number of entries in each row (size,)."""
        return np.bincount(self.row, minlength=self.size)

    def renumbered(self, rank: np.ndarray) -> Pattern:
        """The pattern with unknown i as number rank[i]; those of negative rank are left out."""
        row, column = rank[self.row], rank[self.column]
        kept = (row >= 0) & (column >= 0)
        return Pattern(np.count_nonzero(rank >= 0), row[kept], column[kept])

    def width(self, border: int = 0) -> int:
        """Entries of a row on either side of the diagonal, at most, the last `border` rows and columns left out."""
        inner = np.maximum(self.row, self.column) < self.size - border
        return int(np.abs(self.row - self.column)[inner].max(initial=0))

    def toarray(self) -> np.ndarray:
        """In full (size, size): 1 where an entry may differ from zero."""
        full = np.zeros((self.size, self.size), dtype=np.int8)
        full[self.row, self.column] = 1
        return full


def pattern_of(masters: list[list[tuple[int, float]]], size: int, stencils: Sequence[np.ndarray]) -> Pattern:
    """Pattern of a matrix whose groups couple the full degrees of freedom in each row of their stencils.

    Parameters
    ----------
    masters : list of list of (int, float)
        For each full degree of freedom the unknowns that it consists of, and their factors; negative: held.
    size : int
        Number of unknowns.
    """
    places = [np.arange(size) * (size + 1)]
    single = all(len(m) <= 1 for m in masters)
    first = np.array([m[0][0] if m else -1 for m in masters], dtype=np.int64)
    for stencil in stencils:
        if stencil.size == 0:
            continue
        if single:
            unknowns = first[stencil]
            i = np.repeat(unknowns, stencil.shape[1], axis=1).ravel()
            j = np.tile(unknowns, (1, stencil.shape[1])).ravel()
            keep = (i >= 0) & (j >= 0)
            places.append(i[keep] * size + j[keep])
        else:
            for member in stencil:
                u = np.array([k for p in member for k, _ in masters[p] if k >= 0], dtype=np.int64)
                places.append((u[:, None] * size + u).ravel())
    row, column = np.divmod(np.unique(np.concatenate(places)), max(size, 1))
    return Pattern(size, row, column)


def narrow(pattern: Pattern) -> tuple[np.ndarray, int]:
    """Order of the unknowns, and how many of the last are to be a border; found once for scenes of one structure.

    The border are those that many more others depend on than is usual; the rest is ordered as the scene was built or by
    reverse Cuthill-McKee, whichever gives the narrower band. The latter is not asked where it cannot gain much: half of
    a row's entries beside the diagonal lie on one side of it in any order.
    """
    order, border = _narrow(pattern.size, pattern.row.tobytes(), pattern.column.tobytes())
    return order.copy(), border


@functools.lru_cache(maxsize=8)
def _narrow(size: int, row: bytes, column: bytes) -> tuple[np.ndarray, int]:
    pattern = Pattern(size, np.frombuffer(row, np.int64), np.frombuffer(column, np.int64))
    natural = np.arange(pattern.size)
    if natural.size == 0:
        return natural, 0
    degree = pattern.degree
    wide = degree > max(LOCAL, 4.0 * np.median(degree))
    rank = np.where(wide, -1, np.cumsum(~wide) - 1)
    inner, outer = natural[~wide], natural[wide]
    rest = pattern.renumbered(rank)
    least = -(-(rest.degree.max(initial=1) - 1) // 2)
    order = inner
    if rest.width() - least > max(1.0, NEAR * least):
        cuthill = _cuthill_mckee(rest)
        if rest.renumbered(np.argsort(cuthill)).width() < rest.width():
            order = inner[cuthill]
    return np.concatenate((order, outer)), outer.size


def _cuthill_mckee(pattern: Pattern) -> np.ndarray:
    # SciPy's sparse matrices take a fifth of a second to import.
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    ones = np.ones(pattern.row.size, dtype=np.int8)
    matrix = csr_matrix((ones, (pattern.row, pattern.column)), shape=(pattern.size, pattern.size))
    return np.asarray(reverse_cuthill_mckee(matrix, symmetric_mode=True), dtype=np.int64)
