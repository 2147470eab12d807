"""Which entries of a matrix may differ from zero, and the order of unknowns that lays them in a narrow band."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from tautline.system.masters import Masters

LOCAL = 60
"""Unknowns that one may depend on and still belong to the band."""
MOST_MARKS = 200_000_000
"""Places of a band, a byte each, up to which entries are marked in it."""
PAIRS = 100_000
"""Entries that are looked at together."""
ROWS = 4096
"""Rows of a band whose marks are gathered together."""
NEAR = 0.25
"""Share of the least possible width by which a band may be wider before a better order is looked for."""


NO_UNKNOWNS = np.zeros(0, np.int64)


class Pattern:
    """Entries of a symmetric (size, size) pattern: ``row`` and ``column`` (k,) of each, once.

    ``bare`` lists the unknowns whose entry on the diagonal is zero: multipliers, which have no force of their own.
    """

    def __init__(self, size: int, row: np.ndarray, column: np.ndarray, bare: np.ndarray = NO_UNKNOWNS) -> None:
        self.size = size
        self.row, self.column, self.bare = row, column, bare

    @functools.cached_property
    def degree(self) -> np.ndarray:
        """Number of entries in each row (size,)."""
        return np.bincount(self.row, minlength=self.size)

    def renumbered(self, rank: np.ndarray) -> Pattern:
        """The pattern with unknown i as number rank[i]; those of negative rank are left out."""
        if np.array_equal(rank, np.arange(self.size)):
            return self
        row, column = rank[self.row], rank[self.column]
        kept = (row >= 0) & (column >= 0)
        bare = rank[self.bare]
        return Pattern(np.count_nonzero(rank >= 0), row[kept], column[kept], bare[bare >= 0])

    def width(self, border: int = 0) -> int:
        """Entries of a row on either side of the diagonal, at most, the last `border` rows and columns left out."""
        beside = np.abs(self.row - self.column)
        if border > 0:
            beside = beside[np.maximum(self.row, self.column) < self.size - border]
        return int(beside.max(initial=0))

    @functools.cached_property
    def narrowest(self) -> tuple[np.ndarray, int]:
        """What `narrow` gives, found once: systems of one structure share their patterns."""
        return _narrow(self)

    def toarray(self) -> np.ndarray:
        """In full (size, size): 1 where an entry may differ from zero."""
        full = np.zeros((self.size, self.size), dtype=np.int8)
        full[self.row, self.column] = 1
        return full


class MarkedBand(Pattern):
    """A pattern by its marks (size, 2 w + 1): row i has an entry in column i + k - w where ``marks[i, k]``.

    Many unknowns have dozens of entries each, of which nobody may ever ask where every single one is.
    """

    def __init__(self, marks: np.ndarray, bare: np.ndarray = NO_UNKNOWNS) -> None:
        self.size = marks.shape[0]
        self.marks, self.bare = marks, bare

    @functools.cached_property
    def row(self) -> np.ndarray:
        """Of each entry (k,)."""
        return np.repeat(np.arange(self.size, dtype=np.int32), self.degree)

    @functools.cached_property
    def column(self) -> np.ndarray:
        """Of each entry (k,)."""
        found = np.empty(int(self.degree.sum()), dtype=np.int32)
        half, end = self.marks.shape[1] // 2, 0
        for begin in range(0, self.size, ROWS):
            # Part by part: the places of all marks as numpy gives them take twice what the pattern does.
            some, beside = np.nonzero(self.marks[begin : begin + ROWS])
            start, end = end, end + some.size
            found[start:end] = some + beside + (begin - half)
        return found

    @functools.cached_property
    def degree(self) -> np.ndarray:
        """Number of entries in each row (size,)."""
        return np.count_nonzero(self.marks, axis=1)

    def width(self, border: int = 0) -> int:
        """As of any pattern."""
        if border > 0:
            return super().width(border)
        half = self.marks.shape[1] // 2
        beside = np.flatnonzero(self.marks.any(axis=0)) - half
        return int(np.abs(beside).max(initial=0))


def pattern_of(masters: Masters, size: int, stencils: Sequence[np.ndarray], bare: np.ndarray = NO_UNKNOWNS) -> Pattern:
    """Pattern of a matrix whose groups couple the full degrees of freedom in each row of their stencils.

    Parameters
    ----------
    masters : Masters
        The unknowns that each full degree of freedom consists of.
    size : int
        Number of unknowns.
    stencils : sequence of (m, k) int arrays
        Each row lists full degrees of freedom that are coupled.
    bare : (m,) int array
        Unknowns whose entry on the diagonal is zero.
    """
    # Ties bring a stencil of one row each, by the thousand: numpy is asked once for all rows that are as long.
    coupled = _stacked(unknowns for stencil in _stacked(stencils) for unknowns in _unknowns(masters, stencil))
    width = max((_spread(unknowns) for unknowns in coupled), default=0)
    if size * (2 * width + 1) <= MOST_MARKS:
        return _marked(size, width, coupled, bare)
    places = [np.arange(size) * (size + 1)]
    for i, j in _pairs(coupled):
        places += [i * size + j, j * size + i]
    row, column = np.divmod(_distinct(np.concatenate(places)), max(size, 1))
    return Pattern(size, row, column, bare)


def _unknowns(masters: Masters, stencil: np.ndarray) -> Iterator[np.ndarray]:
    """Unknowns that the rows of a stencil couple, (m, k) each; negative: none."""
    single = masters.is_single[stencil].all(axis=1)
    if single.any():
        yield masters.first[stencil[single]]
    for member in stencil[~single]:
        yield np.concatenate([masters.unknown[masters.start[i] : masters.start[i + 1]] for i in member])[None, :]


def _stacked(parts: Iterable[np.ndarray]) -> list[np.ndarray]:
    """Arrays (m, k) one upon the other, one for each k; those without entries are left out."""
    alike: dict[int, list[np.ndarray]] = {}
    for part in parts:
        if part.size:
            alike.setdefault(part.shape[1], []).append(part)
    return [np.concatenate(some) if len(some) > 1 else some[0] for some in alike.values()]


def _spread(unknowns: np.ndarray) -> int:
    """Largest difference between two unknowns of a row."""
    most = unknowns.max(axis=1)
    least = np.where(unknowns >= 0, unknowns, most[:, None]).min(axis=1)
    return int((most - least).max(initial=0))


def _pairs(coupled: Sequence[np.ndarray]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Each two of coupled unknowns, in one order only, a part at a time: all at once would not fit the cache."""
    for unknowns in coupled:
        one, other = np.triu_indices(unknowns.shape[1], 1)
        rows = max(1, PAIRS // max(1, one.size))
        for begin in range(0, unknowns.shape[0], rows):
            part = unknowns[begin : begin + rows]
            i, j = part[:, one].ravel(), part[:, other].ravel()
            if part.min() < 0:
                there = (i >= 0) & (j >= 0)
                i, j = i[there], j[there]
            yield i, j


def _marked(size: int, width: int, coupled: Sequence[np.ndarray], bare: np.ndarray) -> Pattern:
    """Pattern within a band, by a mark for each place of the band: nothing has to be sorted."""
    above = np.zeros(size * (width + 1), dtype=bool)
    for i, j in _pairs(coupled):
        above[np.minimum(i, j) * width + np.maximum(i, j)] = True
    upper = above.reshape(size, width + 1)
    upper[:, 0] = True
    across = 2 * width + 1
    band = np.zeros((size, across), dtype=bool)
    band[:, width:] = upper
    for k in range(1, min(width + 1, size)):
        band[k:, width - k] = upper[: size - k, k]
    return MarkedBand(band, bare)


def _distinct(places: np.ndarray) -> np.ndarray:
    """Places in order, each once. Sorting takes a tenth of the time of ``numpy.unique``, which hashes whole numbers."""
    places.sort()
    kept = np.ones(places.size, dtype=bool)
    kept[1:] = places[1:] != places[:-1]
    return places[kept]


def narrow(pattern: Pattern) -> tuple[np.ndarray, int]:
    """Order of the unknowns, and how many of the last are to be a border; found once for scenes of one structure.

    The border are those that many more others depend on than is usual, and multipliers that are left with nothing to
    hold where those are taken out; the rest is ordered as the scene was built or by reverse Cuthill-McKee, whichever
    gives the narrower band. The latter is not asked where it cannot gain much: half of a row's entries beside the
    diagonal lie on one side of it in any order.
    """
    order, border = pattern.narrowest
    return order.copy(), border


def _narrow(pattern: Pattern) -> tuple[np.ndarray, int]:
    natural = np.arange(pattern.size)
    if natural.size == 0:
        return natural, 0
    degree = pattern.degree
    wide = degree > max(LOCAL, 4.0 * np.median(degree))
    if pattern.bare.size and wide.any():
        wide[_left_alone(pattern, wide)] = True
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


def _left_alone(pattern: Pattern, wide: np.ndarray) -> list[int]:
    """Bare unknowns that have to follow the wide ones out of the band, for it to be factorised on its own.

    The rows of m of them can be independent only where each has a neighbour of its own in the band. They are matched,
    one after another, by augmenting paths; those that hang on nothing wide come first, for they may stay in any case.
    """
    bare = np.zeros(pattern.size, dtype=bool)
    bare[pattern.bare] = True
    entries = bare[pattern.row] & ~bare[pattern.column]
    row, column = pattern.row[entries], pattern.column[entries]
    beside: dict[int, list[int]] = {int(one): [] for one in pattern.bare if not wide[one]}
    for one, other in zip(row[~wide[column]].tolist(), column[~wide[column]].tolist(), strict=True):
        if one in beside:
            beside[one].append(other)
    hangs = set(row[wide[column]].tolist())
    own: dict[int, int] = {}
    owner: dict[int, int] = {}
    return [one for one in sorted(beside, key=hangs.__contains__) if not _finds_own(one, beside, own, owner)]


def _finds_own(first: int, beside: dict[int, list[int]], own: dict[int, int], owner: dict[int, int]) -> bool:
    """Give an unknown one of its neighbours, others changing theirs where they can; whether there is one for it."""
    seeker: dict[int, int] = {}
    waiting = [first]
    for one in waiting:
        for place in beside[one]:
            if place in seeker:
                continue
            seeker[place] = one
            if place not in owner:
                _hand_on(place, seeker, own, owner)
                return True
            waiting.append(owner[place])
    return False


def _hand_on(place: int, seeker: dict[int, int], own: dict[int, int], owner: dict[int, int]) -> None:
    """Give a place that is free to who sought it, the one that it had to who sought that, and so on."""
    taken: int | None = place
    while taken is not None:
        one = seeker[taken]
        owner[taken] = one
        own[one], taken = taken, own.get(one)


def _cuthill_mckee(pattern: Pattern) -> np.ndarray:
    """Reverse Cuthill-McKee order (size,), level by level: neighbours of the first come first, of few neighbours first.

    SciPy has it too, and takes a tenth of a second to import: a sixth of a command that lifts a load for 12 s.
    """
    degree = pattern.degree
    beside = pattern.column[np.lexsort((degree[pattern.column], pattern.row))]
    begin = np.cumsum(degree) - degree
    waiting, levels = np.ones(pattern.size, dtype=bool), []
    for root in np.argsort(degree, kind="stable").tolist():
        level = np.array([root])[waiting[root : root + 1]]
        while level.size:
            levels.append(level)
            waiting[level] = False
            count = degree[level]
            place = np.arange(count.sum()) + np.repeat(begin[level] - np.cumsum(count) + count, count)
            found = beside[place]
            found = found[waiting[found]]
            level = found[_first_of_each(found, pattern.size)]
    return np.concatenate(levels)[::-1]


def _first_of_each(found: np.ndarray, size: int) -> np.ndarray:
    """Places at which each of some unknowns stands for the first time, in order."""
    first = np.empty(size, dtype=np.int64)
    places = np.arange(found.size)
    first[found[::-1]] = places[::-1]
    return places[first[found] == places]
