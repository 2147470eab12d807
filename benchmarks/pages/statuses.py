"""Write the table of how a run can end into docs/solver.md, from the program's own sentences."""

from __future__ import annotations

from benchmarks import ROOT
from benchmarks.page import replace_between, table
from tautline.integrators.status import SENTENCES, Status

PAGE = ROOT / "docs" / "solver.md"
BEGIN, END = "<!-- statuses: written by benchmarks/pages/statuses.py -->\n", "<!-- end of statuses -->\n"


def statuses() -> str:
    """The table in Markdown."""
    rows = [(f"`{one.name}`", SENTENCES[one], "0" if one is Status.DONE else "3") for one in Status]
    return table(("status", "sentence", "exit code"), rows)


if __name__ == "__main__":
    replace_between(PAGE, BEGIN, END, statuses())
