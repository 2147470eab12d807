"""A row of a table that broke off, with a header behind it on the same line, as a logger writes that is begun anew."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tautline.scene.reading.long_rows import is_number_or_date, kind_of

HALF = re.compile(r"(\d{4}-\d\d?-\d\d?[ T])?[\d.,:+-]*")
"""What may be left of a number or a date before the first title: ``1006.time``."""


@dataclass(frozen=True)
class BrokenRow:
    """What a line has of a row and of a header behind it.

    Attributes
    ----------
    titles : list of str
        Of the header.
    words : bool
        Whether words stand before them: a status of the row, or more titles.
    """

    titles: list[str]
    words: bool

    def header(self, separator: str) -> str:
        """The header as a line of its own."""
        text = io.StringIO()
        csv.writer(text, delimiter=separator, lineterminator="").writerow(self.titles)
        return text.getvalue()


def broken_row(
    cells: Sequence[str], titles: Sequence[str], stamped: bool, is_header: Callable[[Sequence[str]], bool]
) -> BrokenRow | None:
    """Half a row with a header behind it, ``1006.0,time,winch``; None where a line is no such thing.

    Of the row there is its stamp, or a number that it begins with: else what stands before the titles is titles, too,
    of a header that has more columns. And it is no longer than a row is.

    Parameters
    ----------
    cells, titles : sequence of str
        Those of the line, and those of the header before.
    stamped : bool
        Whether there is a number or a date in the place of the stamp.
    is_header : callable
        Whether titles, of which the first names a stamp, have all columns that are wanted.
    """
    cells = list(cells)
    while cells and not cells[-1]:
        cells.pop()
    found = _same(cells, titles) or _other(cells, is_header)
    if found is None:
        return None
    before, behind = found
    if len(before) > len(titles) or not (stamped or is_number_or_date(before[0])):
        return None
    return BrokenRow(behind, any(kind_of(cell) == "word" for cell in before))


def _same(cells: Sequence[str], titles: Sequence[str]) -> tuple[list[str], list[str]] | None:
    """What stands before the same titles, and these; None where they are not there, or stand alone."""
    first = len(cells) - len(titles)
    if first < 0 or len(titles) < 2 or [*cells[first + 1 :]] != [*titles[1:]] or not cells[first].endswith(titles[0]):
        return None
    left = cells[first].removesuffix(titles[0])
    before = [*cells[:first], *([left] if left else [])]
    return (before, [*titles]) if before else None


def _other(cells: Sequence[str], is_header: Callable[[Sequence[str]], bool]) -> tuple[list[str], list[str]] | None:
    """What stands before the first titles that are a header, and these."""
    for place, cell in enumerate(cells):
        half = HALF.match(cell)
        left = half[0] if half else ""
        title = cell[len(left) :]
        before, behind = [*cells[:place], *([left] if left else [])], [title, *cells[place + 1 :]]
        if before and title and title[0] != " " and is_header(behind):
            return before, behind
    return None
