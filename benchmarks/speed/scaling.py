"""Cost against the number of lumps of a string and of elements of a rope: it is to grow in proportion."""

from __future__ import annotations

from statistics import median

from benchmarks import jwell
from benchmarks.page import Section, number, show, table
from benchmarks.race import scenes
from tautline.simulation import simulate

LUMPS = (12, 100, 1000)
FRICTIONS = (0.0, 0.0), (0.3, 0.2)
ELEMENTS = (1000, 10_000)
ROPE_TOLERANCE = 1e-3
"""Of both meshes of the rope, by the rule of the race: a tenth moves the rope by less than a tenth of its error."""
MOST_OF_LARGE = 1.3
"""What was asked of the time of an element of the fine mesh over one of the other."""


def measure(quick: bool) -> Section:
    """The J-well with more and more lumps, and the rope of the race with more elements, at 1 ms."""
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
        + _of_ropes(quick)
    )
    return Section("Cost against size", text, headline)


def _of_ropes(quick: bool) -> str:
    """The rope of the race with both meshes in turn, so that a busy minute strikes both."""
    end, repeats = (0.02, 1) if quick else (2.0, 7)
    cases = [scenes.Case("catenary", n, 1e-3, end, end, end, ROPE_TOLERANCE, 0.0, 0.0) for n in ELEMENTS]
    spent, facts = [[], []], [{}, {}]
    for turn in range(repeats + 1):
        for k, case in enumerate(cases):
            facts[k] = simulate(scenes.build(case, scenes.text(case, end, end))).attributes
            spent[k] += [1e6 * facts[k]["cpu_time"] / facts[k]["steps"] / case.elements] if turn else []
    rows = [
        (
            f"{case.elements}", number(median(times), 3), f"{number(min(times), 3)} to {number(max(times), 3)}",
            number(one["newton_iterations"] / one["steps"], 3), number(one["factorisations"] / one["steps"]),
        )
        for case, times, one in zip(cases, spent, facts, strict=True)
    ]  # fmt: skip
    header = "elements", "µs per element and step, median", "spread", "iterations per step", "factorisations per step"
    shares = [after / before for before, after in zip(*spent, strict=True)]
    return (
        f"\nThe rope of the race ({scenes.CATENARY['length']:g} m, one end moved) at 1 ms over {end:g} s, CPU time, "
        f"median of {repeats} after one that warms up, both meshes in turn:\n\n{table(header, rows)}\n"
        f"An element of the fine mesh takes {median(shares):.2f} times as long as one of the other ({min(shares):.2f} "
        f"to {max(shares):.2f}; {MOST_OF_LARGE:g} at most is asked).\n"
    )


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
