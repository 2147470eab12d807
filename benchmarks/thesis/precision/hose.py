"""Fig. 2.33 of the thesis: run times of the garden hose at 35 m/s, by method and coupling of hose and water."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks.hose import runs as hoses
from benchmarks.page import number, table
from benchmarks.thesis.pictures import picture
from benchmarks.thesis.precision import scenes
from gardenhose.application import Gardenhose
from tautline.study.accuracy.grid import EXPLICIT, critical_at_start
from tautline.study.trials.trial import Setting, Subject, Trial
from tautline.view.figures.figure import COLOURS, Axes, Figure, axes, label, styled

COUPLINGS = ("linear", "lagrange", "penalty", "augmented")
STEP = 1e-3
"""Of generalized-alpha as the scene has it, s."""
DAMPED, UNDAMPED = "With the damping of Table 2.2", "Without damping"
SHORTEST = 1e-6
"""Critical step of RK4, s, below which it is not run."""
RUNS = ("RK4", "generalized-α, RK4's step", f"generalized-α, {1e3 * STEP:g} ms")


class Coupled(NamedTuple):
    """Runs of the hose with one coupling: critical step of RK4, s, and runs by their names in `RUNS`."""

    critical: float
    runs: dict[str, Trial]

    def cost(self, name: str) -> float | None:
        """CPU time per simulated second."""
        trial = self.runs.get(name)
        if trial is None or trial.result is None:
            return None
        return scenes.over(scenes.cpu(trial), float(trial.result.time[-1]))


def coupled(coupling: str, damped: bool, spans: tuple[float, float], repetitions: int) -> Coupled:
    """Run the hose over a time, s, by generalized-alpha, and over another by RK4."""
    scene = hoses.changed({} if damped else {"hose.damping": 0.0})
    implicit, explicit = (Subject(Gardenhose(), scene, end=end, change=scenes.unguarded) for end in spans)
    critical = critical_at_start(explicit, Setting("rk4", constraint=coupling))
    assert critical is not None
    runs = {RUNS[2]: implicit.run(Setting("generalized-alpha", STEP, constraint=coupling), repetitions)}
    if critical > SHORTEST:
        step = EXPLICIT[0] * critical
        runs[RUNS[0]] = explicit.run(Setting("rk4", step, constraint=coupling), repetitions)
        runs[RUNS[1]] = explicit.run(Setting("generalized-alpha", step, constraint=coupling), repetitions)
    return Coupled(critical, runs)


def part(quick: bool) -> str:
    """The whole subject, in Markdown."""
    repetitions = 1 if quick else 5
    spans = {
        UNDAMPED: (0.02, 0.02) if quick else (0.5, 0.5),
        DAMPED: (0.02, 0.01) if quick else (0.5, 0.02),
    }
    couplings = COUPLINGS[:1] if quick else COUPLINGS
    found = {
        damping: {c: coupled(c, damping == DAMPED, spans[damping], repetitions) for c in couplings} for damping in spans
    }
    figure = _figure(found)
    shorter = found[UNDAMPED]["linear"].critical / found[DAMPED]["linear"].critical
    return (
        "\n### Fig. 2.33: run times of the hose at 35 m/s\n\n`data/hose.yaml`, ten elements of hose and ten of water, "
        "which share r and r' in four ways; the water speeds up within 0.1 s. RK4 at "
        f"{EXPLICIT[0]:g} of its critical step. {UNDAMPED} every run is of {spans[UNDAMPED][0]:g} s. "
        f"{DAMPED} RK4, and generalized-α at its step, are run for {spans[DAMPED][1]:g} s only: that step "
        f"is {shorter:.0f} times shorter ([why](#the-critical-step-of-rk4)). CPU seconds per simulated second; in "
        "brackets over that of RK4 with linear coupling; medians.\n\n"
        + "\n".join(f"{damping}:\n\n{_table(one)}" for damping, one in found.items())
        + "\n"
        + table(("claim", "ours", "thesis", "why"), _claims(found))
        + f"\n{_differs(found)}\n"
        + picture(figure, "fig_2_33", "Run times of the hose at 35 m/s, Fig. 2.33", quick)
    )  # fmt: skip


def _table(one: dict[str, Coupled]) -> str:
    unit = one["linear"].cost(RUNS[0])
    rows = []
    for coupling, runs in one.items():
        costs = [runs.cost(name) for name in RUNS]
        cells = ["–" if c is None else f"{number(c)} ({number(scenes.over(c, unit))})" for c in costs]
        trials = [runs.runs.get(name) for name in RUNS]
        micros = [number(None if trial is None else scenes.per_step(trial)) for trial in trials]
        rows.append((coupling, number(runs.critical), *(x for pair in zip(cells, micros, strict=True) for x in pair),
                     _iterations(runs.runs[RUNS[2]])))  # fmt: skip
    header = ["coupling", "RK4's critical step, s"]
    for name in RUNS:
        header += [name, "a step, µs"]
    return table([*header, "iterations a step"], rows)


def _iterations(trial: Trial) -> str:
    return number(trial.attribute("newton_iterations") / trial.attribute("steps"))


def _claims(found: dict[str, dict[str, Coupled]]) -> list[tuple[str, ...]]:
    free, damped = found[UNDAMPED]["linear"], found[DAMPED]["linear"]
    ratios = [scenes.over(one.cost(RUNS[0]), one.cost(RUNS[2])) for one in (free, damped)]
    rows = [
        ("RK4 over generalized-α at 1 ms, linear coupling, without damping", f"{number(ratios[0])} times",
         "“almost 5 times”", "none, if the thesis' RK4 ran without the damping of Table 2.2; its steps are not stated"),
        ("the same with the damping of Table 2.2", f"{number(ratios[1])} times", "–",
         "at the thesis' 0.000245 s RK4 cannot stand with it"),
        ("a step of generalized-α over one of RK4, at RK4's step", number(_step_ratio(free)), "“about 3”",
         "RK4 evaluates bending and flow four times a step; generalized-α needs "
         f"{_iterations(free.runs[RUNS[1]])} iterations with kept factors; without that see [what one step "
         "costs](#what-one-step-costs)"),
    ]  # fmt: skip
    if "lagrange" in found[UNDAMPED]:
        tied = found[UNDAMPED]["lagrange"]
        for name, said in zip((RUNS[0], RUNS[2]), ("“slower”", "–"), strict=True):
            more = number(scenes.over(tied.cost(name), free.cost(name)))
            rows.append((f"multipliers over linear coupling, {name}", f"{more} times", said,
                         "193 unknowns in place of 61, in a wider band"))  # fmt: skip
        rows.append(("farthest that a coupling moves the tip, of its way, generalized-α",
                     f"{_apart(found):.0e}", "–", "none"))  # fmt: skip
    return rows


def _step_ratio(one: Coupled) -> float | None:
    return scenes.over(scenes.per_step(one.runs[RUNS[1]]), scenes.per_step(one.runs[RUNS[0]]))


def _apart(found: dict[str, dict[str, Coupled]]) -> float:
    pairs = [(one.runs[RUNS[2]], ways["linear"].runs[RUNS[2]]) for ways in found.values() for one in ways.values()]
    return max((errors.position for pair in pairs if (errors := scenes.off(*pair)) is not None), default=0.0)


def _differs(found: dict[str, dict[str, Coupled]]) -> str:
    free = found[UNDAMPED]["linear"]
    errors = [scenes.off(free.runs[name], free.runs[RUNS[0]]) for name in RUNS[1:]]
    words = ["–" if error is None else f"{100.0 * error.position:.2g} %" for error in errors]
    more = number(scenes.over(free.cost(RUNS[0]), free.cost(RUNS[1])))
    return (
        f"What differs: without damping generalized-α is {words[1]} of the tip's way off RK4 at 1 ms, and at RK4's own "
        f"step {words[0]}, {more} times as quick. Which of the two is the better bargain depends on the error asked "
        "for: see the tables further below. With penalty springs, which allow it steps of some nanoseconds, RK4 cannot "
        "be run."
    )


@styled
def _figure(found: dict[str, dict[str, Coupled]]) -> Figure:
    figure, plots = axes(1, 2, 10.5, 4.6, "Garden hose at 35 m/s: run time by coupling", sharey=True)
    unit = found[UNDAMPED]["linear"].cost(RUNS[0]) or 1.0
    for plot, (damping, one) in zip(plots[0], found.items(), strict=True):
        for number_, name in enumerate(RUNS):
            _bars(plot, [scenes.over(runs.cost(name), unit) for runs in one.values()], number_, name)
        plot.set_yscale("log")
        plot.set_xticks(range(len(one)), list(one))
        plot.grid(False, axis="x")
        plot.set_title(damping)
    plots[0, 0].set_ylabel(label("CPU time over undamped RK4's, linear", "–"))
    low, high = plots[0, 0].get_ylim()
    plots[0, 0].set_ylim(low / 1.3, high * 1.6)
    figure.legend(*plots[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _bars(plot: Axes, heights: list[float | None], number_: int, name: str) -> None:
    places = np.arange(len(heights)) + 0.27 * (number_ - 1)
    shown = [(x, y) for x, y in zip(places, heights, strict=True) if y is not None]
    colour = ("#000000", *COLOURS)[number_]
    plot.bar([x for x, _ in shown], [y for _, y in shown], 0.25, color=colour, label=name)
    for x, y in shown:
        plot.text(x, 1.06 * y, number(y), ha="center", va="bottom", fontsize=7.5)
    if number_ == 0:
        for x, y in zip(places, heights, strict=True):
            if y is None:
                plot.text(x, 0.02, "not run", transform=plot.get_xaxis_transform(), rotation=90, ha="center",
                          va="bottom", fontsize=7.5)  # fmt: skip
