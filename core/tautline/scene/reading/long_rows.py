"""Rows that fill more cells than their header has: remarks without a title, or numbers of which nobody knows whose."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Sequence

NO_WORDS = frozenset("na n/a n.a. #n/a nan null none nil inf infinity".split())
"""What programs and loggers write where a number is missing, in small letters; dashes are such, too."""
STATES = frozenset(("bad", "off"))
"""What a sensor without a number may show, and a status, too."""
RARE = 50
"""Of so many words of a column, one number shows no column of numbers."""
TO_THE_SECOND = re.compile(r"(.*[T ])?\d\d?:\d\d:\d\d")
"""A time of the day that may go on with parts of a second: no zone is behind it."""


def filled(cells: Sequence[str]) -> int:
    """Number of cells of a row up to the last one that has something in it: separators at its end make none."""
    return max((i for i, cell in enumerate(cells, 1) if cell), default=0)


def kind_of(cell: str) -> str:
    """What a cell holds: "word", "number" for all that begins as one, such as dates, or empty for what is missing."""
    bare = cell.lower().lstrip("+-")
    if not bare or bare in NO_WORDS:
        return ""
    return "number" if cell.lstrip("+-.,").lstrip()[:1].isdecimal() else "word"


def shows_nothing(cell: str) -> bool:
    """Whether a cell is, or may be, that of a sensor that has no number; of a titled column `OFF` is a word."""
    return not kind_of(cell) or cell.lower() in STATES


def first_beyond(cells: Sequence[str], width: int) -> str:
    """The first cell beyond the header that has something in it; empty where none has."""
    return next((cell for cell in cells[width:] if cell), "")


def kind_or_state(cell: str) -> str:
    """What a cell holds, as `kind_of`; "state" for a word that a sensor without a number may show."""
    return "state" if cell.lower() in STATES else kind_of(cell)


def usual_kinds(shown: Counter[str]) -> set[str]:
    """Kinds of cells that a column shows: a status that was a number once, `7` among `run`, is one of words."""
    kinds = {"word" if kind == "state" else kind for kind, count in shown.items() if count}
    few = shown["number"] <= max(1, shown["word"] // RARE) and shown["word"] >= shown["number"]
    return kinds - {"number"} if few else kinds


def has_remark(cells: Sequence[str], width: int, usual: Sequence[Collection[str]], status: bool = False) -> bool:
    """Whether the cells of a row beyond the `width` of the header are a remark, and those before it in their places.

    Cells beyond it are words. Behind a last cell of words they may begin with a number, as text with a comma in it
    does: ``started, 2 stands``. The others are of the kinds that other rows show in their columns (`usual`, of each
    column): a row name before them, or a decimal comma among them, moves a number to where words are. Where the first
    cell beyond is known to be a `status`, `OFF` is a word there, and no sensor's that was moved.
    """
    text = kind_of(cells[width - 1]) == "word"
    if text and not all(_may_be_text(cell) for cell in cells[width:] if cell):
        return False
    if not text and any(kind != "word" for kind in _kinds_beyond(cells, width, status)):
        return False
    return all(_is_usual(kind_of(cell), kinds) for cell, kinds in zip(cells[:width], usual, strict=False))


def _kinds_beyond(cells: Sequence[str], width: int, status: bool) -> list[str]:
    """Kinds of the cells beyond the header that have something in them."""
    kinds = [kind_of(cell) for cell in cells[width:] if cell]
    if shows_nothing(first_beyond(cells, width)):
        kinds[:1] = ["word" if status else ""]
    return kinds


def only_words_behind(cells: Sequence[str], place: int, width: int, status: bool = False) -> bool:
    """Whether a cell is no word, and those behind it are: then its number is not likely moved from behind it.

    That is no proof: where numbers have moved by one cell, and the last sensor shows a word, it looks the same. So the
    first word is none that stands for a missing number, unless the first cell beyond the header is a `status`.
    """
    behind = [kind_of(cell) for cell in cells[place + 1 : width] if cell] + _kinds_beyond(cells, width, status)
    return kind_of(cells[place]) != "word" and behind[:1] == ["word"] and "number" not in behind


def seems_two_lines(cells: Sequence[str], usual: Collection[int], second: bool) -> str:
    """Which fault a row with more cells than any before may have: "two", "moved", or "" for none.

    It may be two lines that ran into one, with empty cells at its end: "two" where a number is in a column in which it
    is not `usual`. Else it is "moved" where numbers may have been moved: behind the end of the first line there may be
    a `second` stamp.
    """
    if any(is_number_or_date(cell) and i not in usual for i, cell in enumerate(cells)):
        return "two"
    return "moved" if second else ""


def decimals_of(cell: str) -> int:
    """How many digits stand behind the mark of a number."""
    return len(cell.replace(",", ".").partition(".")[2])


def usual_numbers(shown: Sequence[Counter[str]]) -> set[int]:
    """Columns in which most rows have numbers, of the kinds of cells that each has `shown`."""
    rows = max(kinds.total() for kinds in shown)
    return {i for i, kinds in enumerate(shown) if kinds["number"] and 2 * kinds["number"] >= rows}


def is_plain_number(cell: str) -> bool:
    """Whether a cell is a number, and neither a date nor a time."""
    return kind_of(cell) == "number" and not any(one in ":/-T" for one in cell.lstrip("+-").replace("e-", ""))


def has_half_a_second(cells: Sequence[str], stamp: int) -> bool:
    """Whether a time of the day may go on behind a comma, in a cell of three digits: ``2026-01-01 00:00:00,100``."""
    time, behind = cells[stamp], next(iter(cells[stamp + 1 :]), "")
    return TO_THE_SECOND.fullmatch(time) is not None and len(behind) == 3 and behind.isdecimal()


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
