"""What each degree of freedom of a scene consists of: unknowns and held degrees of freedom, with factors.

Flat arrays, as compiled code reads them: a cable may have a million degrees of freedom, nearly all of them an unknown
each, and a Python list for each would take longer than all else that is built.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tautline.kernels.dofs import HELD, TIED

Terms = Sequence[tuple[int, float]]
"""Masters of one degree of freedom, each with its factor."""


@dataclass(frozen=True, eq=False)
class Masters:
    """The masters of n full degrees of freedom.

    Attributes
    ----------
    start : (n + 1,) int array
        Degree of freedom i has ``unknown[start[i]:start[i + 1]]``: none where it is held.
    unknown : (k,) int array
        Number of an unknown; negative for a held degree of freedom, -1 less its full number.
    factor : (k,) array
        Of each master.
    """

    start: np.ndarray
    unknown: np.ndarray
    factor: np.ndarray

    @classmethod
    def of(cls, number: np.ndarray, held: Iterable[int], tied: Mapping[int, Terms]) -> Masters:
        """Masters of degrees of freedom of which most are an unknown themselves.

        Parameters
        ----------
        number : (n,) int array
            Of the unknown that each is, if it is one.
        held : iterable of int
            Those without masters.
        tied : mapping
            Those that consist of others, and of which.
        """
        count = np.ones(number.size, dtype=np.int64)
        places = np.fromiter(tied, np.int64, len(tied))
        count[places] = [len(terms) for terms in tied.values()]
        count[np.fromiter(held, np.int64)] = 0
        start = np.concatenate((np.zeros(1, np.int64), np.cumsum(count)))
        unknown, factor = np.empty(start[-1], np.int64), np.ones(start[-1])
        own = count == 1
        own[places] = False
        unknown[start[:-1][own]] = number[own]
        for i in places[count[places] > 0]:
            unknown[start[i] : start[i + 1]] = [k for k, _ in tied[int(i)]]
            factor[start[i] : start[i + 1]] = [f for _, f in tied[int(i)]]
        return cls(start, unknown, factor)

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return self.start.size - 1

    @property
    def first(self) -> np.ndarray:
        """First master of each (n,), -1 where there is none."""
        first = np.full(self.size, -1, dtype=np.int64)
        some = np.diff(self.start) > 0
        first[some] = self.unknown[self.start[:-1][some]]
        return first

    @property
    def is_single(self) -> np.ndarray:
        """Whether each has one master at most (n,)."""
        return np.diff(self.start) <= 1

    def _any(self, which: np.ndarray) -> np.ndarray:
        """Whether each degree of freedom has a master of which something holds (n,)."""
        before = np.concatenate((np.zeros(1, np.int64), np.cumsum(which)))
        return before[self.start[1:]] > before[self.start[:-1]]

    @property
    def is_free(self) -> np.ndarray:
        """Whether each depends on an unknown (n,)."""
        return self._any(self.unknown >= 0)

    @property
    def is_carried(self) -> np.ndarray:
        """Whether each depends on a held degree of freedom (n,)."""
        return self._any(self.unknown < 0)

    def marks(self, rank: np.ndarray) -> np.ndarray:
        """The only free master of each, numbered by its rank, where that has factor 1, else `HELD` or `TIED` (n,)."""
        free = self.unknown >= 0
        before = np.concatenate((np.zeros(1, np.int64), np.cumsum(free)))
        count = before[self.start[1:]] - before[self.start[:-1]]
        marks = np.where(count == 0, HELD, TIED)
        one = np.flatnonzero(count == 1)
        at = np.flatnonzero(free)[before[self.start[:-1][one]]]
        plain = self.factor[at] == 1.0
        marks[one[plain]] = rank[self.unknown[at[plain]]]
        return marks

    def ranked(self, rank: np.ndarray) -> np.ndarray:
        """``unknown`` under other numbers; what is held keeps its mark (k,)."""
        moved, free = self.unknown.copy(), self.unknown >= 0
        moved[free] = rank[moved[free]]
        return moved
