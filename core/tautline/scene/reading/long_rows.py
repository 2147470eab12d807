"""Rows that fill more cells than their header has: remarks without a title, or numbers of which nobody knows whose."""

from __future__ import annotations

from collections.abc import Collection, Sequence

NO_WORDS = frozenset("na n/a n.a. #n/a nan null none nil inf infinity bad off".split())
"""What programs and loggers write where a number is missing, in small letters; dashes are such, too."""


def filled(cells: Sequence[str]) -> int:
    """Number of cells of a row up to the last one that has something in it: separators at its end make none."""
    return max((i for i, cell in enumerate(cells, 1) if cell), default=0)


def kind_of(cell: str) -> str:
    """What a cell holds: "word", "number" for all that begins as one, such as dates, or empty for what is missing."""
    bare = cell.lower().lstrip("+-")
    if not bare or bare in NO_WORDS:
        return ""
    return "number" if cell.lstrip("+-.,").lstrip()[:1].isdecimal() else "word"


def has_remark(cells: Sequence[str], width: int, usual: Sequence[Collection[str]]) -> bool:
    """Whether the cells of a row beyond the `width` of the header are a remark, and those before it in their places.

    Cells beyond it are words. Behind a last cell of words they may begin with a number, as text with a comma in it
    does: ``started, 2 stands``. The others are of the kinds that other rows show in their columns (`usual`, of each
    column): a row name before them, or a decimal comma among them, moves a number to where words are.
    """
    text = kind_of(cells[width - 1]) == "word"
    beyond = [cell for cell in cells[width:] if cell]
    if not all(_may_be_text(cell) if text else kind_of(cell) == "word" for cell in beyond):
        return False
    return all(_is_usual(kind_of(cell), kinds) for cell, kinds in zip(cells[:width], usual, strict=False))


def only_words_behind(cells: Sequence[str], place: int) -> bool:
    """Whether a cell is no word, and those behind it are: then its number is not likely moved from behind it.

    That is no proof: where numbers have moved by one cell, and the last sensor shows a word, it looks the same. So the
    first word is none that stands for a missing number.
    """
    behind = [kind_of(cell) for cell in cells[place + 1 :] if cell]
    return kind_of(cells[place]) != "word" and behind[:1] == ["word"] and "number" not in behind


def has_half_a_second(cells: Sequence[str], stamp: int) -> bool:
    """Whether a time of the day may go on behind a comma, in a cell of three digits: ``2026-01-01 00:00:00,100``."""
    time, behind = cells[stamp], next(iter(cells[stamp + 1 :]), "")
    return ":" in time and "." not in time and len(behind) == 3 and behind.isdecimal()


def _is_usual(kind: str, usual: Collection[str]) -> bool:
    return not kind or kind in usual or (kind == "word" and "number" not in usual)


def is_number_or_date(cell: str) -> bool:
    """Whether a cell is a number, a date, or the beginning of one: no title that begins with a number, ``1 (kN)``."""
    return kind_of(cell) == "number" and not _may_be_text(cell)


def _may_be_text(cell: str) -> bool:
    """Whether a cell has a letter or is a word: no number, and no date of digits."""
    return kind_of(cell) == "word" or any(one.isalpha() for one in cell.lstrip("+-.,0123456789eETZ:"))


def cure_of_long_rows(separator: str, one_more: bool, rows: str = "every row") -> str:
    """What to do where rows fill more cells than the header has.

    `one_more` is whether each of the `rows` that were read has one more: so programs such as R write tables, where row
    names have no title.
    """
    commas = "if numbers have decimal commas, put semicolons between the cells" if separator == "," else ""
    if one_more:
        names = "the first cell of each row is a row name or a number of the row: give it a title (in R: "
        names += "`write.table(..., row.names = FALSE)`, or `col.names = NA`)"
        return f"the header has one cell less than {rows}. It may be that {names}{commas and f'; or, {commas}'}"
    first = f"{commas}; or give" if commas else "give"
    return f"{first} each column a title in the header; or, if two lines have run into one, delete that row"
