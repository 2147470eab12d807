"""Fig. 2.32 of the thesis: run times of the hammer bar, by method, number of elements and how they are joined."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks.page import number, table
from benchmarks.thesis.bars import scenes as bars
from benchmarks.thesis.pictures import picture
from benchmarks.thesis.precision import scenes
from tautline.study.accuracy.grid import EXPLICIT, critical_at_start
from tautline.study.trials.trial import Setting, Subject, Trial
from tautline.view.figures.figure import COLOURS, QUIET, Axes, Figure, axes, label, sample_line, styled

COUNTS = (1, 2, 4, 8)
JOINTS = ("shared", "lagrange", "penalty")
"""Ways to join elements; the latter two by names of the study."""
WORDS = {"shared": "shared nodes", "lagrange": "Lagrange multipliers", "penalty": "penalty springs"}
PERIODS = {"mode 2": 4.0 / 3.0, "mode 1": 4.0}
"""Periods of the bar itself, s; ten steps are taken to one."""
SAME = "RK4's step"
STEPS = (SAME, *PERIODS)
EQUAL = "3"
"""How many times cheaper a step of RK4 is in the thesis (section 4.1)."""


class Timed(NamedTuple):
    """Runs of one bar: by RK4 and joint, by generalized-alpha's step and joint; the step of RK4, s; RK4 guarded."""

    rk4: dict[str, Trial]
    implicit: dict[tuple[str, str], Trial]
    step: float
    guarded: Trial

    def relative(self, unit: Trial, joint: str, step: str | None) -> float | None:
        """CPU time over a unit's, of RK4 where there is no step."""
        trial = self.rk4.get(joint) if step is None else self.implicit.get((step, joint))
        return None if trial is None else scenes.over(scenes.cpu(trial), scenes.cpu(unit))

    def micros(self, joint: str, step: str | None) -> float | None:
        """CPU time of one step, microseconds."""
        trial = self.rk4.get(joint) if step is None else self.implicit.get((step, joint))
        return None if trial is None else scenes.per_step(trial)


def timed(count: int, end: float, repetitions: int) -> Timed:
    """Run the bar of so many elements in all ways."""
    rk4: dict[str, Trial] = {}
    implicit: dict[tuple[str, str], Trial] = {}
    longest = 0.0
    for joint in JOINTS[:1] if count == 1 else JOINTS:
        name = None if joint == "shared" else joint
        items = bars.bar(count, 1.0) if name is None else scenes.tied(count, 1.0)
        last = count if name is None else 2 * count - 1
        # Few frames, so that steps are timed and not what is stored of them.
        subject = scenes.subject_of([*items, scenes.hammer(last)], end, 0.1 * end, time_step=0.01)
        if joint != "penalty":
            critical = critical_at_start(subject, Setting("rk4", constraint=name))
            assert critical is not None
            rk4[joint] = subject.run(Setting("rk4", EXPLICIT[0] * critical, constraint=name), repetitions)
            longest = longest or EXPLICIT[0] * critical
        for step in STEPS:
            h = longest if step == SAME else 0.1 * PERIODS[step]
            implicit[step, joint] = subject.run(Setting("generalized-alpha", h, constraint=name), repetitions)
        if joint == "shared":
            watched = Subject(subject.application, subject.scene, interval=subject.interval)
            guarded = watched.run(Setting("rk4", longest), repetitions)
    return Timed(rk4, implicit, longest, guarded)


def part(quick: bool) -> str:
    """The whole subject, in Markdown."""
    counts, end, repetitions = ((1, 2), 20.0, 1) if quick else (COUNTS, 400.0, 11)
    found = {n: timed(n, end, repetitions) for n in counts}
    figure = _figure(found)
    return (
        "### Fig. 2.32: run times of the hammer bar\n\nThe bar of Figs 2.20 to 2.22 (1 m, 1 kg, 1 N, 0.01 N for 1 s) "
        f"over {end:g} s, cut into n elements that share nodes, or have their own, tied in position and slope. RK4 at "
        f"{EXPLICIT[0]:g} of its critical step, with nobody looking after the step; generalized-α (α_m = -0.05, α_f = "
        "0.1) at the same step, and at ten steps to the bar's second and first period (0.133 s and 0.4 s). CPU times "
        f"over that of RK4 with one element, {number(1e3 * (found[1].rk4['shared'].cpu_time or 0.0))} ms; medians of "
        f"{repetitions}. RK4 is not run with penalty springs, which by the square root rule allow it steps of some "
        "microseconds (Fig. 2.26).\n\n"
        + _relative_table(found)
        + "\nMicroseconds of CPU per step, both at RK4's step:\n\n"
        + _step_table(found)
        + f"\nLooking after its step adds {_watch_time(found)} ms to these runs of RK4.\n\n"
        + table(("claim", "ours", "thesis", "why"), _claims(found))
        + f"\n{_differs(found)}\n"
        + picture(figure, "fig_2_32", "Run times of the hammer bar, Fig. 2.32", quick)
    )  # fmt: skip


def _relative_table(found: dict[int, Timed]) -> str:
    unit = found[1].rk4["shared"]
    rows = []
    for step in (None, *STEPS):
        for joint in JOINTS:
            if step is None and joint == "penalty":
                continue
            name = "RK4" if step is None else f"generalized-α, {_step_words(step)}"
            cells = [_cell(one, unit, joint, step) for one in found.values()]
            rows.append((name, WORDS[joint], *cells))
    return table(("method", "joined by", *(f"n = {n}" for n in found)), rows)


def _cell(one: Timed, unit: Trial, joint: str, step: str | None) -> str:
    trial = one.rk4.get(joint) if step is None else one.implicit.get((step, joint))
    if trial is not None and not trial.done:
        return trial.status.lower().replace("_", " ")
    return number(one.relative(unit, joint, step), 3)


def _step_words(step: str) -> str:
    return "at RK4's step" if step == SAME else f"{0.1 * PERIODS[step]:.3g} s ({step})"


def _step_table(found: dict[int, Timed]) -> str:
    rows = []
    for n, one in found.items():
        rk4, own = one.micros("shared", None), one.micros("shared", SAME)
        trial = one.implicit[SAME, "shared"]
        iterations = trial.attribute("newton_iterations") / trial.attribute("steps")
        cells = [number(one.micros(*which)) for which in (("lagrange", None), ("lagrange", SAME), ("penalty", SAME))]
        factors = trial.attribute("factorisations") / trial.attribute("steps")
        rows.append((f"{n}", f"{one.step:.4f}", number(rk4), number(own), number(_ratio(one)), number(iterations),
                     number(factors, 1), *cells))  # fmt: skip
    header = ("n", "step, s", "RK4", "generalized-α", "generalized-α over RK4", "its iterations", "its factorisations",
              "RK4, multipliers", "generalized-α, multipliers", "generalized-α, penalty")  # fmt: skip
    return table(header, rows)


def _watch_time(found: dict[int, Timed]) -> str:
    """By how much RK4 takes longer where it looks after its step, ms."""
    more = [(one.guarded.cpu_time or 0.0) - (one.rk4["shared"].cpu_time or 0.0) for one in found.values()]
    return f"{1e3 * min(more):.1f} to {1e3 * max(more):.1f}"


def _ratio(one: Timed) -> float | None:
    return scenes.over(one.micros("shared", SAME), one.micros("shared", None))


def quicker(found: dict[int, Timed], step: str) -> list[int]:
    """Numbers of elements with which generalized-alpha takes less time at a step than RK4 at its own."""
    unit = found[1].rk4["shared"]
    times = {n: (one.relative(unit, "shared", step), one.relative(unit, "shared", None)) for n, one in found.items()}
    return [n for n, (own, rk4) in times.items() if own is not None and rk4 is not None and own < rk4]


def _claims(found: dict[int, Timed]) -> list[tuple[str, ...]]:
    ratios = [ratio for one in found.values() if (ratio := _ratio(one)) is not None]
    joined = [one for n, one in found.items() if n > 1]
    why = "a step of generalized-α costs less here, so fewer steps win sooner"
    return [
        ("a step of generalized-α over one of RK4", f"{min(ratios):.1f} to {max(ratios):.1f}", f"“about {EQUAL}”",
         "factors are kept over iterations and steps: an iteration is one residual and one solution, of which RK4 "
         "takes four a step; without that see [what one step costs](#what-one-step-costs)"),
        ("generalized-α is quicker with ten steps to mode 1", _counts(quicker(found, "mode 1")),
         "n = 4, 8 (“more than 2”)", why),
        ("the same with ten steps to mode 2", _counts(quicker(found, "mode 2")), "n = 8", why),
        ("multipliers over shared nodes, generalized-α", _spread(joined, "lagrange"), "“slightly” slower",
         "6 n − 3 unknowns in place of 2 n + 1"),
        ("penalty over shared nodes, generalized-α", _spread(joined, "penalty"), "“marginally” slower than multipliers",
         "4 n − 1 unknowns, and stiff springs leave rounding in the forces: factors are made anew more often"),
        ("farthest that multipliers move the tip, of its way", f"{max(_apart(joined, 'lagrange')):.0e}",
         "accuracy “unaffected”", "none"),
        ("the same of penalty springs, by n and step", f"{min(_apart(joined, 'penalty')):.0e} to "
         f"{max(_apart(joined, 'penalty')):.0e}", "accuracy “unaffected”",
         "springs give way; most where a step did not converge and was halved"),
        ("modes of one element", f"{bars.modes_of(bars.bar(1, 1.0)).omega.size}", "“only the 1st”",
         "Table 2.1 itself lists three of a cubic element (p/f)"),
    ]  # fmt: skip


def _counts(counts: Sequence[int]) -> str:
    return "n = " + ", ".join(f"{n}" for n in counts) if counts else "never"


def _spread(found: Sequence[Timed], joint: str) -> str:
    ratios = [
        ratio
        for one in found
        for step in STEPS
        if (ratio := scenes.over(one.micros(joint, step), one.micros("shared", step))) is not None
    ]
    return f"{min(ratios):.1f} to {max(ratios):.1f} times" if ratios else "–"


def _apart(found: Sequence[Timed], joint: str) -> list[float]:
    """Differences of the tip to that with shared nodes, over its way, by the same method and step."""
    pairs = [(one.rk4[joint], one.rk4["shared"]) for one in found if joint in one.rk4]
    pairs += [(one.implicit[step, joint], one.implicit[step, "shared"]) for one in found for step in STEPS]
    errors = [scenes.off(*pair) for pair in pairs]
    return [error.position for error in errors if error is not None]


def _differs(found: dict[int, Timed]) -> str:
    stopped = [
        f"{n} elements, {WORDS[joint]}, {_step_words(step)}: {trial.sentence}"
        for n, one in found.items()
        for (step, joint), trial in one.implicit.items()
        if not trial.done
    ]
    text = (
        "What differs: the thesis shows bars without figures. Its order is ours: RK4 wins where its longest step is as "
        "long as the answer wants it (one element, or all modes wanted); generalized-α wins by the number of elements, "
        "which shortens RK4's step and not its own. It wins sooner here, because its step costs less beside RK4's."
    )
    if stopped:
        text += f"\n\nNot every run came to its end ({len(stopped)}): {stopped[0]}."
    return text


@styled
def _figure(found: dict[int, Timed]) -> Figure:
    figure, plots = axes(1, 2, 10.5, 5.0, "Hammer bar: what methods and joints cost")
    unit = found[1].rk4["shared"]
    for plot, measure in zip(plots[0], ("relative", "micros"), strict=True):
        for number_, step in enumerate((None, *STEPS)):
            for joint in JOINTS:
                points = [
                    (n, one.relative(unit, joint, step) if measure == "relative" else one.micros(joint, step))
                    for n, one in found.items()
                ]
                _curve(plot, [(n, y) for n, y in points if y is not None], number_, joint)
        plot.set_xscale("log", base=2)
        plot.set_yscale("log")
        plot.set_xticks(list(found), [f"{n}" for n in found])
        plot.set_xlabel(label("elements n", "–"))
    plots[0, 0].set_ylabel(label("CPU time over RK4's with one element", "–"))
    plots[0, 1].set_ylabel(label("CPU time of a step", "µs"))
    methods = ["RK4, longest step"] + [f"generalized-α, {_step_words(step)}" for step in STEPS]
    handles = [sample_line(text, color=_colour(i), lw=2.0) for i, text in enumerate(methods)]
    handles += [sample_line(WORDS[joint], color=QUIET, **_look(joint)) for joint in JOINTS]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _colour(number_: int) -> str:
    return ("#000000", *COLOURS)[number_]


def _look(joint: str) -> dict[str, object]:
    looks = {"shared": ("-", "o"), "lagrange": ("--", "s"), "penalty": (":", "^")}
    line, mark = looks[joint]
    return {"ls": line, "marker": mark, "ms": 4.5, "mfc": None if joint == "shared" else "white"}


def _curve(plot: Axes, points: Sequence[tuple[int, float]], number_: int, joint: str) -> None:
    if points:
        plot.plot(*np.array(points).T, color=_colour(number_), **_look(joint))
