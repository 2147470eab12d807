"""Write the table of plausible ranges into docs/ranges.md, from the table that scenes are checked by."""

from __future__ import annotations

from benchmarks import ROOT
from benchmarks.page import replace_between, table
from tautline.scene.values.ranges import RANGES, in_range

PAGE = ROOT / "docs" / "ranges.md"
BEGIN, END = "<!-- ranges: written by benchmarks/pages/plausible_ranges.py -->\n", "<!-- end of ranges -->\n"


def ranges() -> str:
    """The table in Markdown."""
    rows = [
        (name, "any" if row.low is None else in_range(row), ", ".join(row.meant) or "–", row.why)
        for name, row in RANGES.items()
    ]
    return table(("quantity", "plausible size", "units that are tried", "taken from"), rows)


if __name__ == "__main__":
    replace_between(PAGE, BEGIN, END, ranges())
