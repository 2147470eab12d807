"""Cells of a line of a table, and what separates them."""

from __future__ import annotations

import csv

SEPARATORS = ";\t,"


def has_end(line: str) -> bool:
    """Whether a line, as it was read, has a line end: one that has none may go on in what is not there yet."""
    return line.endswith(("\n", "\r"))


def separator_of(line: str) -> str:
    """What separates the cells of a header: a comma before a blank only where nothing else does: ``t, s;x, N``."""
    counts = {mark: line.count(mark) - (line.count(", ") if mark == "," else 0) for mark in SEPARATORS}
    return max(SEPARATORS, key=counts.__getitem__) if any(counts.values()) else ","


def titles_of(line: str, separator: str) -> list[str]:
    """Cells of a header: a separator at its end makes no column."""
    titles = cells_of(line, separator)
    while titles and not titles[-1]:
        titles.pop()
    return titles


def cells_of(line: str, separator: str) -> list[str]:
    """Cells of a line, without spaces around them."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]
    except csv.Error:  # a cell of more than 100,000 letters
        return []
