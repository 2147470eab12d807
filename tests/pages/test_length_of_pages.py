"""Pages can be read: a cell of a table is short, and the guide to twins is some pages and not one of 64 kB."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
LONGEST_CELL = 700
"""Characters; what is longer is a section of its own with a list, and the cell has a link to it."""
LONGEST_PAGE = 20_000
"""Bytes of a page of the guide to twins."""


def long_cells(text):
    """Numbers of lines with a cell that is too long, and how long it is; a bar in code or behind \\ ends no cell."""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("|"):
            for cell in re.split(r"(?<!\\)\|", re.sub(r"`[^`]*`", lambda code: "c" * len(code[0]), line)):
                if len(cell) > LONGEST_CELL:
                    yield number, len(cell)


@pytest.mark.parametrize("page", sorted(DOCS.glob("*.md")), ids=lambda page: page.name)
def test_no_cell_of_a_table_of_a_page_is_longer_than_a_paragraph(page):
    assert list(long_cells(page.read_text(encoding="utf8"))) == []


def test_a_cell_of_a_thousand_letters_is_found():
    assert list(long_cells("| a | b |\n|---|---|\n| " + "a" * 1000 + " | b |\n")) == [(3, 1002)]


@pytest.mark.parametrize("page", sorted(DOCS.glob("twin*.md")), ids=lambda page: page.name)
def test_a_page_of_the_guide_to_twins_is_at_most_20_kb(page):
    assert page.stat().st_size <= LONGEST_PAGE


def test_the_guide_to_twins_leads_to_each_of_its_pages():
    guide = (DOCS / "twin.md").read_text(encoding="utf8")
    others = [page.name for page in DOCS.glob("twin_*.md")]
    assert len(others) > 4
    assert [name for name in others if f"]({name})" not in guide.partition("\n## ")[0]] == []
