"""Put the thesis' tables and figures beside ours: write docs/validation.md. With --quick nothing is written."""

from __future__ import annotations

from benchmarks.page import Section, load, machine, quick_asked
from benchmarks.thesis import hose
from benchmarks.thesis.bars import section as bars
from benchmarks.thesis.pictures import DOCS
from benchmarks.thesis.precision import section as precision
from benchmarks.thesis.strings import section as strings

PAGE = DOCS / "validation.md"
SECTIONS = (bars, hose, strings, precision)
"""Scripts of the sections, in the thesis' order."""


def page(sections: list[Section], measured: str) -> str:
    """The page of all comparisons."""
    head = (
        "# The thesis beside Tautline\n\nWritten by `python -m benchmarks.thesis.validation`; each section is also a "
        "script of its own in `benchmarks/thesis`.\n\nTables and figures of G. Fotland's thesis (2022) made again with "
        "the program. Where the thesis prints a number it stands beside ours, with what makes the difference; “–” "
        "where it prints none. Figures are drawn from the program's own results. What tests hold the program to is in "
        f"[claims.md](claims.md).\n\nMeasured: {measured}.\n"
    )
    return "\n".join([head, *(f"{section}" for section in sections)])


def main() -> None:
    quick = quick_asked(__doc__)
    before = load()
    sections = [section.measure(quick) for section in SECTIONS]
    text = page(sections, machine(before))
    print(text)
    if not quick:
        PAGE.write_text(text, encoding="utf8")


if __name__ == "__main__":
    main()
