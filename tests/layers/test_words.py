"""The field's words: home-made ones that were replaced do not come back, and the glossary holds each term once."""

import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
REPLACED = {
    r"\bcautions?\b": "warning",
    r"free swinging|swings freely": "free vibration",
    r"lost to the method|come from nowhere|came from nowhere": "numerical dissipation, energy created numerically",
    r"motion turns over": "oscillation frequency",
    r"takes? tension only": "carries no compression",
    r"\b(travel|way) of the bit\b": "bit displacement",
    r"\bmarch(_implicit|_explicit)?\(": "run_steps",
    r"\btake_up\b": "resume_from",
    r"\brows_solved\b": "equations_solved",
    r"\bmaterial_rate\b": "material_velocity",
    r"rope's way": "path of the rope",
    r"\bread_quirks\b": "read_compat",
}
OWN = {"test_words.py"}


@cache
def texts():
    """Every file that is read by people, and its text, without capitals, as patterns that ignore them take long."""
    return [(path, path.read_text(encoding="utf8").lower()) for path in _files() if path.name not in OWN]


def _files():
    for folder, kinds in (
        ("core", ("py",)),
        ("apps", ("py", "yaml")),
        ("tests", ("py",)),
        ("docs", ("md",)),
    ):
        for kind in kinds:
            yield from (ROOT / folder).rglob(f"*.{kind}")
    yield ROOT / "README.md"


@pytest.mark.parametrize("word", REPLACED)
def test_a_word_that_was_replaced_stands_nowhere(word):
    assert word == word.lower()
    pattern = re.compile(word)
    found = [
        f"{path.relative_to(ROOT)}: {match.group()}: {REPLACED[word]}"
        for path, text in texts()
        if (match := pattern.search(text))
    ]
    assert found == []


def test_the_glossary_explains_each_term_once_and_in_order():
    page = (ROOT / "docs" / "glossary.md").read_text(encoding="utf8")
    sections = page.split("\n## ")[1:]
    assert len(sections) == 6
    for section in sections:
        terms = [line.split("|")[1].strip() for line in section.splitlines() if line.startswith("| ")][1:]
        assert len(terms) >= 5 and len(set(terms)) == len(terms)
        assert terms == sorted(terms, key=str.lower), section.splitlines()[0]
