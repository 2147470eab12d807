"""Cost against the number of lumps: it is to grow in proportion."""

from __future__ import annotations

from statistics import median

import jwell
from page import Section, number, show, table

LUMPS = (12, 100, 1000)


def measure(quick: bool) -> Section:
    """The J-well with more and more lumps, at 1 ms."""
    end, repeats = (0.2, 1) if quick else (5.0, 5)
    rows, headline = [], []
    jwell.run("generalized-alpha", 1e-3, 0.1)
    for count in LUMPS:
        runs = [jwell.run("generalized-alpha", 1e-3, end, model__elements=count) for _ in range(repeats)]
        one = runs[0].attributes
        per_step = median(run.wall for run in runs) / one["steps"]
        each = one["newton_iterations"] / one["steps"]
        row = (
            count, f"{per_step:.2e}", f"{per_step / each:.2e}", number(1e6 * per_step / count, 3),
            number(1e6 * per_step / each / count, 3), number(each, 3), one["factorisations"], one["halvings"],
            number(median(run.real_time_factor for run in runs)),
        )  # fmt: skip
        rows.append(row)
    cost = " / ".join(row[3] for row in rows)
    headline.append(("cost of a lump and step with 12 / 100 / 1000 lumps", f"{cost} µs", "in proportion: all the same"))
    header = (
        "lumps", "s per step", "s per Newton iteration", "µs per lump and step", "µs per lump and iteration",
        "Newton iterations per step", "factorisations", "step halvings", "real-time factor",
    )  # fmt: skip
    text = (
        f"The J-well by generalized-alpha at 1 ms over {end:g} s, median of {repeats}. The wall's stiffness and "
        "damping are divided among the lumps by tributary length.\n\n" + table(header, rows)
    )
    return Section("Cost against size", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
