"""What the pages repeat of the program is what the program says."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_table_of_statuses_in_the_docs_is_the_programs():
    sys.path.insert(0, str(ROOT / "benchmarks"))
    try:
        import statuses
    finally:
        sys.path.pop(0)
    assert statuses.statuses() in (ROOT / "docs" / "solver.md").read_text(encoding="utf8")


def test_the_table_of_plausible_ranges_in_the_docs_is_the_programs():
    sys.path.insert(0, str(ROOT / "benchmarks"))
    try:
        import plausible_ranges
    finally:
        sys.path.pop(0)
    assert plausible_ranges.ranges() in (ROOT / "docs" / "ranges.md").read_text(encoding="utf8")
