"""Figs 2.34, 2.35 and 2.36 of the thesis: a bar let go under its weight, its errors against run time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.patches import Patch

from benchmarks.page import number, table
from benchmarks.thesis.bars import scenes as bars
from benchmarks.thesis.pictures import picture
from benchmarks.thesis.precision import figures, scenes
from tautline.results.result import Result
from tautline.study.accuracy.grid import EXPLICIT, critical_at_start
from tautline.study.accuracy.precision import Grid, Row, Study, study
from tautline.study.trials.errors import at_times, compare
from tautline.study.trials.history import History
from tautline.study.trials.trial import Setting, Subject
from tautline.view.figures.figure import SHADE, Figure, axes, label, styled

EA = 1000.0
"""N, of a bar of 1 m and 1 kg: that of Table 2.1, and the least that eq. 2.156 allows."""
SOUND = float(np.sqrt(EA))
PERIOD = 4.0 / SOUND
"""First period of the bar itself, s."""
PERIODS = 10.0
COUNTS = (1, 2, 4, 8)
FRAME = 0.9
"""Interval of the frames over RK4's critical step with 4 elements: those of all meshes fit it with little loss."""
TERMS = 4000
"""Modes of the closed form."""
KINDS = ("amplitude", "force", "phase")
FIGURES = {
    "amplitude": ("fig_2_34", "displacement amplitude error", "", "Displacement amplitude of the tip, Fig. 2.34"),
    "force": ("fig_2_35", "force amplitude error", "", "Axial force amplitude at the pinned node, Fig. 2.35"),
    "phase": ("fig_2_36", "phase error", "rad", "Phase of the tip, Fig. 2.36"),
}
"""By what is wrong: file, axis, unit, title."""
SHARES = (0.1, 0.05, 0.025, 0.0125, 0.00625, 0.003125)
"""Steps of generalized-alpha over the bar's period; those below a frame are divisors of it."""
TABLED = (0, 2, 5)
"""Which of them the table shows, by their place."""


class Off(NamedTuple):
    """Errors of a run: of the tip's amplitude (with its sign) and the root force's, relative, and of phase, rad."""

    signed: float
    force: float | None
    phase: float | None

    @property
    def amplitude(self) -> float:
        """Of displacement, without its sign."""
        return abs(self.signed)


class Point(NamedTuple):
    """A run: number of elements, method, step s, CPU time s, errors against the reference and against the thesis'."""

    n: int
    method: str
    step: float
    cpu: float
    off: Off
    thesis: Off


def history(result: Result) -> History:
    """Way of the tip, and axial force at the pinned node by Green's strain of its slope."""
    stretch = result["slope"][:, 0, 0]
    return History(result["time"], result["position"][:, -1], 0.5 * EA * stretch * (stretch**2 - 1.0))


def off(run: History, reference: History) -> Off:
    """Errors against a run, at the times of the first."""
    exact = at_times(reference, run.time)
    found = compare(run, reference, 1.0)
    ratio = float(np.ptp(run.position[:, 0]) / np.ptp(exact.position[:, 0]))
    return Off(ratio - 1.0, found.force, found.phase)


def subject(strain: str, periods: float) -> Subject:
    """One element hanging, let go unstretched; the study cuts it into more."""
    items, end = bars.bar(1, EA, strain=strain), periods * PERIOD
    first = scenes.subject_of(items, end, PERIOD, bars.GRAVITY, time_step=PERIOD / 80.0)
    critical = critical_at_start(first, Setting("rk4", elements=4.0))
    assert critical is not None
    return scenes.subject_of(items, end, FRAME * critical, bars.GRAVITY, time_step=PERIOD / 80.0)


def points(found: Study, rows: Sequence[Row]) -> list[Point]:
    """Every run that came to its end, judged by the reference of a study."""
    assert found.reference is not None and found.reference.trial.result is not None
    reference = history(found.reference.trial.result)
    done = [row for row in rows if row.trial.done and row.trial.result is not None]
    most = max(row.trial.setting.elements for row in done)
    longest = next(row for row in done if row.trial.setting.method == "rk4" and row.trial.setting.elements == most)
    thesis = history(_result(longest))
    made = []
    for row in done:
        setting, run = row.trial.setting, history(_result(row))
        step = float(row.trial.attribute("step"))
        made.append(Point(round(setting.elements), setting.method or "", step, row.trial.cpu_time or 0.0,
                          off(run, reference), off(run, thesis)))  # fmt: skip
    return made


def _result(row: Row) -> Result:
    assert row.trial.result is not None
    return row.trial.result


def part(quick: bool) -> str:
    """The whole subject, in Markdown."""
    counts, periods = ((1, 2), 3.0) if quick else (COUNTS, PERIODS)
    factors, repetitions = tuple(float(n) for n in counts), 1 if quick else 7
    bar = subject("green", periods)
    steps = tuple(share * PERIOD for share in (SHARES[::5] if quick else SHARES))
    found = study(bar, Grid(("rk4",), elements=factors), repetitions=repetitions, budget=10.0)
    other = study(bar, Grid(("generalized-alpha",), steps, factors), repetitions=repetitions, budget=10.0)
    made = points(found, [*found.rows, *other.rows])
    meshes = mesh_errors(periods, counts)
    amplitude, _, force = meshes[2 * max(counts)]
    below = {"amplitude": abs(amplitude), "force": abs(force), "phase": 0.0}
    images = "".join(
        picture(_figure(made, kind, counts, below[kind]), FIGURES[kind][0], FIGURES[kind][3], quick) for kind in KINDS
    )
    assert found.reference is not None
    proof = found.reference
    return (
        "\n### Figs 2.34 to 2.36: accuracy of a hanging bar\n\nA bar of 1 m and 1 kg, EA = "
        f"{EA:g} N, Green's strain, pinned at one end, let go unstretched under its weight, {periods:g} periods of "
        f"{PERIOD:.4f} s. **The thesis does not state EA, how long it ran, or its steps**; ours are RK4's longest, a "
        "half, a quarter and an eighth of it, and ten to 320 steps of generalized-α to a period. The reference is the "
        f"study's: {round(proof.setting.elements)} elements, RK4 at {proof.step:.1e} s, "
        f"{'proved' if proof.converged else 'not proved: ' + proof.why}, observed order "
        f"{number(proof.observed_order, 3)}, error of position from its step {proof.error:.0e}. The thesis' own is RK4 "
        f"with {max(counts)} elements, here at its longest step. Amplitudes are half of the range, at the times of the "
        "run; force is that at the pinned node, from its slope; phase is the mean lag of the first mode. Run times are "
        "over that of RK4 with one element at its longest step.\n\n"
        + _table(made)
        + "\n"
        + _mesh_table(meshes, proof.mesh_error)
        + "\n"
        + table(("claim", "ours", "thesis", "why"), _claims(made))
        + f"\n{_differs(made)}\n"
        + images
    )  # fmt: skip


def _unit(made: Sequence[Point]) -> float:
    return max((p for p in made if p.method == "rk4" and p.n == 1), key=lambda p: p.step).cpu


def longest(made: Sequence[Point], n: int) -> Point:
    """RK4 with so many elements at its longest step."""
    return max((p for p in made if p.method == "rk4" and p.n == n), key=lambda p: p.step)


def _table(made: Sequence[Point]) -> str:
    rows = []
    for n in sorted({p.n for p in made}):
        chosen = [longest(made, n)]
        implicit = sorted((p for p in made if p.method != "rk4" and p.n == n), key=lambda p: -p.step)
        chosen += [implicit[place] for place in TABLED if place < len(implicit)]
        for p in chosen:
            cells = [f"{error:.1e}" if error is not None else "–"
                     for o in (p.off, p.thesis) for error in (o.signed, o.force, o.phase)]  # fmt: skip
            rows.append((f"{n}", figures.NAMES[p.method], f"{p.step:.2e}", number(p.cpu / _unit(made)), *cells))
    header = ("n", "method", "step, s", "run time", "displacement", "force", "phase, rad",
              "displacement, against RK4 with most elements", "force", "phase, rad")  # fmt: skip
    return table(header, rows)


def mesh_errors(periods: float, counts: Sequence[int]) -> dict[int, tuple[float, float, float]]:
    """What the mesh alone makes wrong by n: amplitude of displacement, position, amplitude of force; relative.

    Of bars with engineering strain, which are linear, beside the closed form.
    """
    found = {}
    bar = subject("engineering", periods)
    for n in (*counts, 2 * max(counts)):
        critical = critical_at_start(bar, Setting("rk4", elements=float(n)))
        trial = bar.run(Setting("rk4", EXPLICIT[2] * (critical or 0.0), elements=float(n)))
        assert trial.result is not None
        tip, root = closed_form(trial.result["time"])
        way, force = trial.result["position"][:, -1, 0] - 1.0, EA * (trial.result["slope"][:, 0, 0] - 1.0)
        size = float(np.ptp(tip))
        found[n] = (
            float(np.ptp(way)) / size - 1.0, float(np.abs(way - tip).max()) / size,
            float(np.ptp(force) / np.ptp(root)) - 1.0,
        )  # fmt: skip
    return found


def _mesh_table(errors: dict[int, tuple[float, float, float]], estimate: float) -> str:
    cells = [(f"{n}", *(f"{error:.1e}" for error in row)) for n, row in errors.items()]
    header = ("n, engineering strain", "displacement amplitude", "position, largest", "force amplitude")
    return (
        "What the mesh alone makes wrong, the reference's too: with engineering strain the bar is linear, and stands "
        "beside its closed form (sum of modes), RK4 at a quarter of its critical step. Errors in the other table and "
        "the figures that are below those of the last line here tell of the reference's mesh, not of the bar. The "
        f"study's own estimate of its mesh error is {estimate:.1e} (position, Green's strain).\n\n"
        + table(header, cells)
    )


def closed_form(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displacement of the tip, m, and force at the root, N, of the linear bar let go at t = 0, by its modes."""
    odd = 2.0 * np.arange(TERMS) + 1.0
    swing = 1.0 - np.cos(0.5 * np.pi * SOUND * np.outer(time, odd))
    tip = swing @ (16.0 * bars.GRAVITY / (np.pi**3 * SOUND**2) * (-1.0) ** np.arange(TERMS) / odd**3)
    return tip, swing @ (8.0 * bars.GRAVITY / np.pi**2 / odd**2)


def _claims(made: Sequence[Point]) -> list[tuple[str, ...]]:
    counts = sorted({p.n for p in made})
    most = max(counts)
    listed = ", ".join(f"{n}" for n in counts)
    coarse, finest = {n: _coarsest(made, n) for n in counts}, _finest(made, most)
    quicker = [n for n in counts if coarse[n].cpu < longest(made, n).cpu]
    forces = [longest(made, n).off.force or 0.0 for n in counts]
    ways = [longest(made, n).off.amplitude for n in counts]
    return [
        (f"Fig. 2.34: displacement of RK4 at its longest step, n = {listed}", ", ".join(f"{x:.1e}" for x in ways),
         "“accurate for all the runs”", "one element has three modes, and two of them are not the bar's"),
        (f"the same of generalized-α, ten steps to the period, n = {listed}",
         ", ".join(f"{coarse[n].off.signed:+.1e}" for n in counts), "“overshoots a little”",
         "so does the first swing, before damping; with 40 steps higher modes fall out of step and add up later"),
        ("generalized-α is quicker with ten steps to the period", "n = " + ", ".join(f"{n}" for n in quicker),
         "“from 2 elements and onwards”", "run times are those of Fig. 2.32"),
        (f"Fig. 2.35: force of RK4 at its longest step, n = {listed}", ", ".join(f"{x:.1e}" for x in forces),
         "“converges”, “slower than for displacement”",
         "it does so unevenly: force has kinks where the wave returns, and each mesh rings about them"),
        (f"Fig. 2.36: phase of generalized-α, n = {most}, ten and {round(PERIOD / finest.step)} steps, rad",
         f"{coarse[most].off.phase or 0.0:.2g}, {finest.off.phase or 0.0:.1e}",
         "“high at large time-steps”, “accurate” at lower", "its period error, of order two"),
        ("phase of RK4 at its longest step, by n, rad",
         ", ".join(f"{longest(made, n).off.phase or 0.0:.1e}" for n in counts), "–", "not printed"),
    ]  # fmt: skip


def _coarsest(made: Sequence[Point], n: int) -> Point:
    return max((p for p in made if p.method != "rk4" and p.n == n), key=lambda p: p.step)


def _finest(made: Sequence[Point], n: int) -> Point:
    return min((p for p in made if p.method != "rk4" and p.n == n), key=lambda p: p.step)


def _differs(made: Sequence[Point]) -> str:
    most = max(p.n for p in made)
    own = longest(made, most).off
    return (
        f"What differs: the thesis takes its own RK4 run with {most} elements for the truth, so that run has no error "
        f"there and every other is off by what that one lacks. It lacks {own.amplitude:.0e} of the displacement, "
        f"{own.force or 0.0:.0e} of the force and {own.phase or 0.0:.0e} rad: errors below these cannot be told on the "
        "right-hand sides of the figures. How the elements are joined changes no error (Fig. 2.32), only run times. A "
        "run whose steps are longer than the frames stores one of each step, which costs about as much as a step of "
        "one element."
    )


@styled
def _figure(made: Sequence[Point], kind: str, counts: Sequence[int], own: float) -> Figure:
    _, text, unit, title = FIGURES[kind]
    figure, plots = axes(1, 2, 10.5, 4.8, title, sharey=True)
    heads = ("against the study's reference", f"against RK4, n = {max(counts)}, as in the thesis")
    for plot, head, which in zip(plots[0], heads, ("off", "thesis"), strict=True):
        for place, n in enumerate(counts):
            for method in figures.NAMES:
                chosen = [p for p in made if p.n == n and p.method == method]
                if which == "thesis" and method == "rk4" and n == max(counts):
                    chosen = [p for p in chosen if p is not longest(made, n)]
                figures.curve(plot, [(p.cpu / _unit(made), getattr(getattr(p, which), kind)) for p in chosen], method,
                              place)  # fmt: skip
        plot.set_title(head)
        plot.set_xlabel(label("CPU time over RK4's with one element", "–"))
    plots[0, 0].set_ylabel(label(text, unit))
    handles = figures.samples(counts)
    low = plots[0, 0].get_ylim()[0]
    if own > low:
        plots[0, 0].axhspan(low, own, color=SHADE, lw=0, zorder=0)
        plots[0, 0].set_ylim(bottom=low)
        handles.append(Patch(color=SHADE, label="below the mesh error of the reference"))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure
