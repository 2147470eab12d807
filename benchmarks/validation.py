"""Put the thesis' tables and figures beside ours: write docs/validation.md. With --quick nothing is written."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from page import Section, load, machine, quick_asked
from thesis_bars_pictures import DOCS

PAGE = DOCS / "validation.md"
SECTIONS = ("thesis_bars", "thesis_hose", "thesis_strings", "thesis_precision")
"""Scripts of the sections, in the thesis' order; one that is not there is left out."""


def page(sections: list[Section], measured: str) -> str:
    """The page of all comparisons."""
    head = (
        "# The thesis beside Tautline\n\nWritten by `python benchmarks/validation.py`; each section is also a script "
        "of its own, `benchmarks/thesis_*.py`.\n\nTables and figures of G. Fotland's thesis (2022) made again with "
        "the program. Where the thesis prints a number it stands beside ours, with what makes the difference; “–” "
        "where it prints none. Figures are drawn from the program's own results. What tests hold the program to is in "
        f"[claims.md](claims.md).\n\nMeasured: {measured}.\n"
    )
    return "\n".join([head, *(f"{section}" for section in sections)])


def main() -> None:
    quick = quick_asked(__doc__)
    before = load()
    modules = [import_module(name) for name in SECTIONS if find_spec(name)]
    sections = [module.measure(quick) for module in modules]
    text = page(sections, machine(before))
    print(text)
    if not quick:
        PAGE.write_text(text, encoding="utf8")


if __name__ == "__main__":
    main()
