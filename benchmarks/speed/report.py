"""Run all benchmarks; write docs/performance.md and the README's table of figures. With --quick nothing is written.

The race with another program (`race/race.py`) and the accuracy that is asked for (`accuracy/choice.py`) are runs of
their own: their parts of the page are kept.
"""

from __future__ import annotations

from benchmarks import jwell
from benchmarks.accuracy import bit as accuracy
from benchmarks.accuracy import error_estimates
from benchmarks.hose import validation as hose
from benchmarks.page import RACE, Section, between, load, machine, quick_asked, table
from benchmarks.race import work_precision
from benchmarks.speed import cables as cable_speed
from benchmarks.speed import cold_start, cranes, real_time, scaling, stepping, variants
from benchmarks.thesis import table_2_5

PAGE = jwell.ROOT / "docs" / "performance.md"
README = jwell.ROOT / "README.md"
BEGIN, END = "<!-- figures: written by benchmarks/speed/report.py -->", "<!-- end of figures -->"


def page(sections: list[Section], measured: str) -> str:
    """The page of all figures."""
    head = (
        "# Performance\n\nWritten by `python -m benchmarks.speed.report`; each section is also a script of its own in "
        f"`benchmarks/`.\n\nMeasured: {measured}.\n"
    )
    return "\n".join([head, *(f"{section}" for section in sections)])


def kept(old: str) -> str:
    """What others wrote at the end of the page, from the mark of `race.py` on; nothing where it never did."""
    begin = old.find(RACE[0])
    return "" if begin < 0 else f"\n{old[begin:]}"


TOLD = ("Real time", "Waiting times", "Run time of the hose", "Cranes", "Accuracy")
"""Sections of which the README has figures; the page has those of all."""


def headline(sections: list[Section], measured: str) -> str:
    """The README's table."""
    rows = [row for section in sections if section.title in TOLD for row in section.headline]
    return f"{BEGIN}\n{table(('figure', 'measured', 'beside it'), rows)}\n{measured}.\n{END}"


def main() -> None:
    quick = quick_asked(__doc__)
    before = load()
    modules = (
        real_time, stepping, variants, cold_start, scaling, cable_speed, hose, cranes, accuracy, error_estimates,
        table_2_5, work_precision,
    )  # fmt: skip
    sections = [module.measure(quick) for module in modules]
    measured = machine(before)
    text, part = page(sections, measured), headline(sections, measured)
    print(f"{text}\n{part}")
    if not quick:
        PAGE.write_text(text + kept(PAGE.read_text(encoding="utf8")), encoding="utf8")
        README.write_text(between(README.read_text(encoding="utf8"), part, BEGIN, END), encoding="utf8")


if __name__ == "__main__":
    main()
