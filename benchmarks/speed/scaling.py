"""Cost against the number of lumps: it is to grow in proportion."""

from __future__ import annotations

from statistics import median

from benchmarks import jwell
from benchmarks.page import Section, number, show, table

LUMPS = (12, 100, 1000)
FRICTIONS = (0.0, 0.0), (0.3, 0.2)


def measure(quick: bool) -> Section:
    """The J-well with more and more lumps, at 1 ms, without and with friction."""
    end, repeats = (0.2, 1) if quick else (5.0, 5)
    rows, headline = [], []
    for static, kinetic in FRICTIONS:
        keys = jwell.friction(static, kinetic)
        jwell.run("generalized-alpha", 1e-3, 0.1, **keys)
        part = [_row(static, kinetic, count, end, repeats, keys) for count in LUMPS]
        what = f"cost of a lump and step with 12 / 100 / 1000 lumps, friction {static:g}/{kinetic:g}"
        shares = " / ".join(row[7] for row in part)
        beside = f"in proportion: all the same; rows solved for in a step, over all: {shares}"
        headline.append((what, " / ".join(row[4] for row in part) + " µs", beside))
        rows += part
    header = (
        "friction", "lumps", "s per step", "s per Newton iteration", "µs per lump and step",
        "µs per row solved for", "Newton iterations per step", "rows solved for in a step, over all",
        "factorisations per step", "step halvings", "real-time factor",
    )  # fmt: skip
    text = (
        f"The J-well by generalized-alpha at 1 ms over {end:g} s, median of {repeats}. The wall's stiffness and "
        "damping are divided among the lumps by tributary length. Among many contacts one or another sticks or slips "
        "in almost every step. That takes further iterations, which go over the rows that are out of balance and a "
        "margin, and new factors as far as the change reaches; both are counted as if they were of the whole.\n\n"
        + table(header, rows)
    )
    return Section("Cost against size", text, headline)


def _row(static: float, kinetic: float, count: int, end: float, repeats: int, keys: dict) -> tuple[str, ...]:
    runs = [jwell.run("generalized-alpha", 1e-3, end, model__elements=count, **keys) for _ in range(repeats)]
    one = runs[0].attributes
    per_step = median(run.wall for run in runs) / one["steps"]
    each = one["newton_iterations"] / one["steps"]
    rows = one["equations_solved"] / one["steps"]
    unknowns = 4 * count  # of count + 1 lumps, less what the block holds of the first
    return (
        f"{static:g}/{kinetic:g}", f"{count}", f"{per_step:.2e}", f"{per_step / each:.2e}",
        number(1e6 * per_step / count), number(1e6 * per_step / rows), number(each, 3),
        number(rows / unknowns, 3), number(one["factorisations"] / one["steps"]), f"{one['halvings']}",
        number(median(run.real_time_factor for run in runs)),
    )  # fmt: skip


if __name__ == "__main__":
    show(measure, __doc__)
