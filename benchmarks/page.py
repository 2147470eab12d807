"""What a benchmark puts on a page: a table in Markdown, and the machine it was measured on."""

from __future__ import annotations

import argparse
import os
import platform
from collections.abc import Callable, Iterable, Sequence
from datetime import date
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

RACE = "<!-- race: written by benchmarks/race/race.py -->", "<!-- end of race -->"
"""Marks of what `race.py` writes, in docs/performance.md."""


class Section(NamedTuple):
    """A title, Markdown below it, and rows for the README: what was measured, the figure, what stands beside it."""

    title: str
    text: str
    headline: list[tuple[str, str, str]]

    def __str__(self) -> str:
        return f"## {self.title}\n\n{self.text}"


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in Markdown; the cells are texts."""
    lines = [header, ["---"] * len(header), *rows]
    return "".join("| " + " | ".join(str(cell) for cell in line) + " |\n" for line in lines)


def number(value: float | None, digits: int = 2) -> str:
    """A number to so many significant digits; a dash where there is none."""
    if value is None:
        return "–"
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text else text


def load() -> str:
    """Load of the machine over the last 1, 5 and 15 minutes."""
    return "/".join(f"{x:.2f}" for x in os.getloadavg())


def machine(before: str) -> str:
    """Date, processor, cores, the versions that count, and the load before and now."""
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in ("tautline", "numba", "numpy", "scipy"))
    return (
        f"{date.today().isoformat()}, {_processor()}, {os.cpu_count()} cores, {platform.system()}, "
        f"Python {platform.python_version()}, {versions}; load over 1/5/15 minutes {before} before and {load()} after"
    )


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    facts = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    name = facts.get("model name", platform.machine())
    family = f"family {facts['cpu family']} model {facts['model']}" if "cpu family" in facts else ""
    clock = f"{float(facts['cpu MHz']) / 1000:.1f} GHz" if "cpu MHz" in facts else ""
    return " ".join(part for part in (name, family, clock) if part)


def quick_asked(text: str) -> bool:
    """Read the one option that all benchmarks have."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("--quick", action="store_true", help="a reduced run that only shows that it runs")
    return parser.parse_args().quick


def between(text: str, part: str, begin: str, end: str) -> str:
    """A text with a part, which has both marks, in the place of what stood between them."""
    before, _, rest = text.partition(begin)
    _, _, after = rest.partition(end)
    return before + part + after


def replace_between(page: Path, begin: str, end: str, text: str) -> None:
    """Write a text between two marks of a page, which stay."""
    page.write_text(between(page.read_text(encoding="utf8"), begin + text + end, begin, end), encoding="utf8")


def show(measure: Callable[[bool], Section], text: str) -> None:
    """Run one benchmark and print its section."""
    quick, before = quick_asked(text), load()
    print(f"{measure(quick)}\n{machine(before)}.")
