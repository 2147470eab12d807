"""Lines of a title above the header of a CSV file: the first of them is taken for the header."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence

from tautline.scene.reading.long_rows import filled, is_number_or_date, kind_of
from tautline.scene.values.units import TABLE

SEPARATORS = "\t;,"
"""What may stand between cells, the surest first."""
MOST_LINES = 100
"""Lines from the begin of a file in which its header is looked for."""
BRACKETS = re.compile(r".*[^\s\[(]\s*(?:\[(?P<square>[^\[\]]+)\]|\((?P<round>[^()]+)\))")
"""A title with something in brackets at its end."""


def header_below(lines: Sequence[tuple[int, str]]) -> tuple[int, str] | None:
    """The line, and its text, that looks like the header of a file of which the first line is none; else None.

    It has two titles at least and no number, rows of numbers as wide as it follow, and none stand above it. It is wider
    than the first line, or has units behind more titles: else it may be a remark below the header, and who is told to
    delete what stands above it would lose the header. A row of units is none.
    """
    rows = [(line, text, split(text)) for line, text in lines[:MOST_LINES]]
    for k, (line, text, cells) in enumerate(rows):
        if shows_numbers(cells):
            return None
        below = [row for _, _, row in rows[k + 1 : k + 3]]
        follow = any(shows_numbers(row) and filled(row) == filled(cells) for row in below)
        if k and follow and is_of_titles(cells) and says_more(cells, rows[0][2]):
            return line, text
    return None


def says_more(cells: Sequence[str], first: Sequence[str]) -> bool:
    """Whether the titles of a line are more likely those of the columns than what stands in the first line."""
    if filled(cells) > filled(first):
        return True
    return not has_units(cells) and with_unit(cells) > with_unit(first)


def with_unit(cells: Sequence[str]) -> int:
    """Number of titles with a unit in brackets behind them: in round ones it is one that is known, as words may be."""
    found = [match for match in map(BRACKETS.fullmatch, cells) if match]
    return sum(1 for match in found if match["square"] or match["round"].strip().lower() in TABLE)


def split(text: str) -> list[str]:
    """Cells of a line, by the separator that it has itself."""
    separator = next((mark for mark in SEPARATORS if mark in text), ",")
    try:
        return [cell.strip() for cell in next(csv.reader([text], delimiter=separator, skipinitialspace=True))]
    except csv.Error:
        return [text]


def shows_numbers(cells: Sequence[str]) -> bool:
    """Whether a line is a row: two cells at least, and most of those that are filled hold numbers or dates."""
    kinds = [kind_of(cell) for cell in cells if cell]
    return len(kinds) > 1 and 2 * kinds.count("number") > len(kinds)


def is_of_titles(cells: Sequence[str]) -> bool:
    """Whether all cells of a line could be titles of columns, of which there are two at least."""
    titles = [cell for cell in cells if cell]
    return len(titles) > 1 and not any(is_number_or_date(cell) for cell in titles)


def has_units(cells: Sequence[str]) -> bool:
    """Whether a cell of a line is a unit and nothing else: ``[m]``, ``deg``."""
    return any(cell.startswith(("[", "(")) or cell.lower() in TABLE for cell in cells if cell)
