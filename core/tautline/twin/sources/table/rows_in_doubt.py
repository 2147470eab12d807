"""Rows with more cells than usual, at whose end separators are: one row, or two lines that ran into one.

Of two lines the second stamp is somewhere behind the first, and it is one between the stamps of the row before and of
the row behind. So such a row waits for the row behind it. It is one row if no cell can be such a stamp; or if stamps
rise evenly through it, for then no line is missing.
"""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from tautline.scene.reading.long_rows import decimals_of, is_plain_number, kind_or_state, seems_two_lines, usual_numbers
from tautline.twin.sources.stamps import stamp_of

USUAL_ROWS = 100
"""Rows before one that is longer than the header, by which it is judged together with those of earlier times."""
LONGER = 3
"""Rows with more cells than usual that are no lines that ran into one."""
STEPS = 8
"""Steps from stamp to stamp that show whether stamps rise evenly."""
EVEN, MOST = 0.25, 0.75
"""How far a step may be from the middle one, by which it is divided; and the part of the steps that has to be so."""


@dataclass(frozen=True)
class RowInDoubt:
    """A row that may be two lines that ran into one.

    Attributes
    ----------
    time, values : float, mapping
        As they are if it is one row.
    kind : str
        "two" where a number is where few rows have one, "moved" for others.
    said : str
        For the user.
    count : int
        Of its cells.
    before : float
        Stamp of the row before, s.
    seconds : tuple of float
        What may be the stamp of a second line in it, s.
    """

    time: float
    values: Mapping[str, float]
    kind: str
    said: str
    count: int
    before: float
    seconds: tuple[float, ...]

    @property
    def left(self) -> tuple[float, Mapping[str, float]] | None:
        """What is left of it if it is not one row."""
        return None if self.kind == "two" else (self.time, dict.fromkeys(self.values, math.nan))

    def has_second(self, behind: float) -> bool:
        """Whether a second stamp may be in it, as the stamp `behind` it shows; so it may where time has gone back."""
        return not behind > self.before or any(self.before < one <= behind for one in self.seconds)


class RowsBefore:
    """What rows before have shown.

    Parameters
    ----------
    cells : int
        Of the header, with those that have no title, at its end.
    width : int
        Titles of the header.

    Attributes
    ----------
    usual : int
        Cells of the rows that have least, and no fewer than titles; 0 before the first row.
    shortest : int
        Cells of the shortest row.
    stamps : deque
        The latest ones.
    """

    def __init__(self, cells: int, width: int) -> None:
        self.usual = self.shortest = self._longest = 0
        self._width = width
        self.stamps: deque[float] = deque(maxlen=STEPS + 1)
        # The latest rows that are no longer than the header, and what they and those before them have had by column.
        self._plain: deque[Sequence[str]] = deque(maxlen=USUAL_ROWS)
        self._kinds: list[Counter[str]] = [Counter() for _ in range(cells)]
        # Longer rows in succession, those of them that nothing shows to be one row, and in all those of numbers.
        self._in_succession = self._left = self._in_all = 0
        self._decimals: set[int] = set()  # that stamps have had

    def add(self, cells: Sequence[str], stamp: int) -> None:
        """Take a row that is not in doubt."""
        count = len(cells)
        self.usual = max(self._width, min(self.usual or count, count))
        self.shortest, self._longest = min(self.shortest or count, count), max(self._longest, count)
        if count <= self.usual:
            self._in_succession = self._left = 0
        self._decimals.add(decimals_of(cells[stamp]))
        self._plain.append(cells)

    @property
    def kinds(self) -> list[Counter[str]]:
        """Kinds of cells that each column has had."""
        for row in self._plain:
            for kinds, cell in zip(self._kinds, row, strict=False):
                kinds[kind_or_state(cell)] += 1
        self._plain.clear()
        return self._kinds

    def seems_two(self, cells: Sequence[str], places: Set[int], seconds: Sequence[float]) -> str:
        """Which fault a row with more cells than usual may have, as `seems_two_lines` says it: "two", "moved", or "".

        `places` are the stamp's and those of the columns of the map, `seconds` what may be a second stamp.
        """
        if not self.usual or len(cells) <= max(self._width, self.usual):
            return ""
        return seems_two_lines(cells, usual_numbers(self.kinds) | places, bool(seconds))

    def seconds(self, cells: Sequence[str], stamp: int, factor: float) -> tuple[float, ...]:
        """What may be the stamp of a second line, s: cells behind the first one that are written as stamps are.

        Where rows begin with the stamp, a piece of the first line may stand before it in its cell, ``0.51.10``.
        """
        if not self.usual or len(cells) <= max(self._width, self.usual):
            return ()
        number = is_plain_number(cells[stamp])
        decimals = next(iter(self._decimals)) if len(self._decimals) == 1 else None
        places = [stamp + begin for begin in self._begins(cells)]
        ends = [cells[place][i:] for place in places for i in (range(len(cells[place])) if stamp == 0 else (0,))]
        ends = [one for one in ends if one[:1].isdecimal() and is_plain_number(one) == number]
        if number and decimals is not None:
            ends = [one for one in ends if decimals_of(one) == decimals]
        return tuple(one for one in (stamp_of(end, factor) for end in ends) if math.isfinite(one))

    def _begins(self, cells: Sequence[str]) -> list[int]:
        """Cells in which a second line may begin: it has as many cells as rows have, and no words for numbers."""
        count, numbers = len(cells), usual_numbers(self.kinds)
        begins = range(max(1, count - self._longest), count - self.shortest + 1)
        words = {i for i, cell in enumerate(cells) if kind_or_state(cell) == "word"}
        return [begin for begin in begins if not any(i - begin in numbers for i in words if i > begin)]

    def go_on_evenly(self) -> bool | None:
        """Whether the last three stamps rise by the step of those before; None where stamps are not even.

        Of two lines in one the second stamp is lost: there the step is twice as long.
        """
        steps = [later - one for one, later in pairwise(self.stamps)]
        middle = median(steps) if len(steps) > 1 else 0.0
        even = [abs(step - middle) <= EVEN * middle for step in steps]
        if middle <= 0.0 or sum(even) < MOST * len(even):
            return None
        return all(even[-2:])

    @property
    def _reach(self) -> float:
        """Until when a second line may be, in a last row: some steps ahead, s."""
        steps = sorted(later - one for one, later in pairwise(self.stamps))
        return self.stamps[-1] + 2 * STEPS * steps[-1] if steps else math.inf

    def is_one(self, row: RowInDoubt, behind: float | None) -> bool:
        """Whether a row in doubt is one row, by the stamp `behind` it; None where no row comes any more.

        Where stamps show nothing, the third row in succession is; and of rows that have a number where few have one,
        and no second stamp, the third in all.
        """
        if row.count <= self.usual:
            return True  # rows behind it have shown that they have so many
        second = row.has_second(self._reach if behind is None else behind)
        even = self.go_on_evenly() if behind is not None and row.time not in row.seconds else None
        one = even or (not second and row.kind == "moved")
        self._left = self._left + 1 if not one and even is not False else 0
        self._in_all += not one and not second
        one = one or self._left >= LONGER or (self._in_all >= LONGER and not second)
        self._longest = max(self._longest, row.count if one else 0)
        self._in_succession = self._in_succession + 1 if one or self._left else 0
        if self._in_succession >= LONGER:
            self.usual = row.count  # rows have more cells from here on
        return bool(one)
