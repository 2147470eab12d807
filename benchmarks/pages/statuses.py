"""Write the table of how a run can end into docs/solver.md, from the program's own sentences."""

from __future__ import annotations

from benchmarks import ROOT
from benchmarks.page import table
from tautline.integrators.status import SENTENCES, Status

PAGE = ROOT / "docs" / "solver.md"
BEGIN, END = "<!-- statuses: written by benchmarks/pages/statuses.py -->\n", "<!-- end of statuses -->\n"


def statuses() -> str:
    """The table in Markdown."""
    rows = [(f"`{one.name}`", SENTENCES[one], "0" if one is Status.DONE else "3") for one in Status]
    return table(("status", "sentence", "exit code"), rows)


def main() -> None:
    text = PAGE.read_text(encoding="utf8")
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    PAGE.write_text(before + BEGIN + statuses() + END + after, encoding="utf8")


if __name__ == "__main__":
    main()
