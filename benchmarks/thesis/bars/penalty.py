"""Fig. 2.26 of the thesis: RK4's longest step against the stiffness of the penalty springs that join two elements."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from benchmarks.page import number, table
from benchmarks.thesis.bars import scenes as bars
from benchmarks.thesis.pictures import picture
from tautline.integrators.linearise import matrices
from tautline.integrators.state import new_state
from tautline.results.result import Result
from tautline.simulation import simulate
from tautline.view.figures.figure import COLOURS, QUIET, Figure, axes, label, styled
from tautline.view.figures.spectrum import spectrum

MULTIPLES = np.logspace(-3.0, 6.0, 37)
"""Penalty over the highest stiffness of the bar."""
WAYS = {"positions only": (1.0, None), "positions k, slopes k L_e²": (1.0, 0.25), "positions k, slopes k": (1.0, 1.0)}
"""What is joined: shares of the stiffness for positions and, unless None, slopes; L_e = 0.5 m."""
TABLED = (1e-2, 1.0, 1e2, 1e4, 1e6)
HIT = "PointForce: {id: 0, nodes7: [3], force: [0.01, 0, 0], timeInterval: [0, 1]}"
"""The hammer of Fig. 2.21."""
RUNS = (("shared node", None), ("penalty", 1e9), ("penalty", 1e12))
"""Runs of generalized-alpha: stiffness N/m of position and slope."""


def joined(stiffness: Sequence[float | None]) -> list[str]:
    """Two elements, EA = 1 N, whose middle node stands there twice, joined by springs on r and on r'; None for none."""
    nodes = [bars.node(0, 0.0, "pinned"), bars.node(1, 0.5), bars.node(2, 0.5), bars.node(3, 1.0)]
    springs = [
        f"Penalty7: {{id: {what}, nodes7: [1, 2], constr: {what}, p_spring: {float(k)!r}}}"
        for what, k in zip((0, 2), stiffness, strict=True)
        if k is not None
    ]
    return [*nodes, bars.element(0, (0, 1), 1.0), bars.element(1, (2, 3), 1.0), *springs]


def longest_step(stiffness: Sequence[float | None]) -> float:
    """2.8 over the highest frequency, s."""
    return bars.STEP_LIMIT / float(bars.modes_of(joined(stiffness)).omega[-1])


def highest_stiffness() -> float:
    """Largest entry of the stiffness matrix of the bar with one middle node, N/m."""
    model = bars.model_of(bars.bar(2, 1.0))
    return float(np.abs(matrices(model.system, new_state(model.system))[2]).max())


def chosen_stiffness() -> float:
    """What the program takes where a scene gives no stiffness, N/m, from what it tells of it."""
    items = [item.replace(", p_spring: 1.0", "") for item in joined((1.0, 1.0))]
    (note,) = bars.model_of(items).notes
    (found,) = re.findall(r"([\d.e+]+) N/m", note)
    return float(found)


def hammered(stiffness: float | None, end: float) -> Result:
    """The hammer test by generalized-alpha at 0.4 s, elements joined by springs, or by a shared node."""
    items = bars.bar(2, 1.0) if stiffness is None else joined((stiffness, stiffness))
    hit = HIT if stiffness is not None else HIT.replace("[3]", "[2]")
    chosen = {"type": "G-alpha", "alpha_m": -0.05, "alpha_f": 0.1, "time_step": 0.4, "time_end": end, "plotpoints": 2.5}
    return simulate(bars.model_of([*items, hit], **chosen, eps_energy=1e-10, maxIter=50))


def part(quick: bool) -> str:
    """The whole subject, in Markdown."""
    highest, shared = highest_stiffness(), bars.STEP_LIMIT / float(bars.textbook(2, 1.0)[-1])
    free = bars.STEP_LIMIT / float(bars.textbook(1, 1.0, ())[-1]) / 2.0
    alike = longest_step((highest, None))
    multiples = MULTIPLES[::12] if quick else MULTIPLES
    steps = {
        name: np.array([longest_step([s if s is None else s * m * highest for s in shares]) for m in multiples])
        for name, shares in WAYS.items()
    }
    rows = []
    for multiple in TABLED:
        found = [longest_step([s if s is None else s * multiple * highest for s in shares]) for shares in WAYS.values()]
        rows.append((f"{multiple:g}", *(f"{step:.3g} ({step / shared:.2g})" for step in found)))
    figure = _figure(multiples, steps, shared)
    return (
        "\n### Fig. 2.26: penalty springs and RK4's longest step\n\nThe bar of the hammer test, 1 N, each element with "
        "its own middle node. Longest step, s: 2.8 over the highest frequency of the program's own matrices; in "
        f"brackets its share of {shared:.4f} s, which shared nodes have. That runs stand just below it and do not just "
        "above is what `tests/physics/cables/test_cable_constraints.py` holds them to.\n\n"
        + table(("k over the highest stiffness", *WAYS), rows)
        + "\n"
        + table(("figure", "ours", "thesis", "difference and why"), _printed(highest, 20.0 if quick else 100.0))
        + "\nWhat differs: the thesis does not say what its springs join. Soft springs leave the elements with free "
        f"ends, so the curves begin at f/f 1 of Table 2.1, {free:.3f} s, and not at shared nodes. With springs on "
        f"positions alone, as stiff as the bar, the step is {100.0 * (1.0 - alike / free):.0f} % below that: “slightly "
        "reduced”, as printed. Eq. 2.157 joins the slopes as well, and a slope has so little inertia that its springs "
        "shorten the step from a hundredth of that stiffness on. Iterations do not rise with the penalty here.\n"
        + picture(figure, "fig_2_26", "Longest step against penalty stiffness, Fig. 2.26", quick)
    )  # fmt: skip


def _printed(highest: float, end: float) -> list[tuple[str, ...]]:
    """What the thesis prints, beside ours."""
    runs = [hammered(k, end) for _, k in RUNS]
    iterations = [run.attributes["newton_iterations"] / run.attributes["steps"] for run in runs]
    tips = [run["position"][:, -1, 0] for run in runs]
    lines = [spectrum(run["time"], tip) for run, tip in zip(runs, tips, strict=True)]
    first = [float(frequency[np.argmax(amplitude[1:]) + 1]) for frequency, amplitude in lines]
    apart = [float(np.abs(tip - tips[0]).max()) for tip in tips[1:]]
    return [
        ("highest stiffness of the bar, N/m", f"{highest:.3f}", "4.8", "none: 2 (6/5) EA/L_e of the middle node"),
        ("penalty that is chosen, N/m", f"{chosen_stiffness():.0e}", "1e9",
         "the thesis takes 10^k √(10^16), with 10^k the order of 2 EA/L_e = 4; where coordinates are large, that "
         "leaves nothing of the force but rounding (docs/cables.md)"),
        ("first line: shared node, 1e9, 1e12 N/m, Hz", ", ".join(f"{f:.4f}" for f in first),
         "“the same frequency as in Case 1”",
         f"none: the tip is {apart[0]:.0e} and {apart[1]:.0e} m from that with a shared node"),
        ("iterations per step: the same three", ", ".join(number(x, 3) for x in iterations),
         "“starts to increase” at 1e12", "the equations are linear in a spring, however stiff"),
    ]  # fmt: skip


@styled
def _figure(multiples: np.ndarray, steps: dict[str, np.ndarray], shared: float) -> Figure:
    figure, plots = axes(1, 1, 7.6, 5.0, "Longest step of RK4 with penalty springs, two elements")
    plot = plots[0, 0]
    for at, (name, values) in enumerate(steps.items()):
        plot.loglog(multiples, values, color=COLOURS[at], label=name.replace("L_e²", "$L_e^2$"))
    plot.axhline(shared, color="black", lw=1.0, ls="--", label="shared nodes")
    plot.axvline(1.0, color=QUIET, lw=1.0, ls=":", label="as stiff as the bar")
    ends = np.array([1e3, 1e6])
    plot.loglog(ends, 0.35 * shared * (ends / ends[0]) ** -0.5, color=QUIET, lw=1.0, label="slope −1/2")
    plot.set_xlabel(label("penalty k over the highest stiffness of the bar", "–"))
    plot.set_ylabel(label("longest step", "s"))
    figure.legend(*plot.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
