"""Error against run time of four scenes, as the verb `study` finds it, with its advice."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import tautline
from benchmarks.hose import runs as hoses
from benchmarks.page import number, table
from benchmarks.thesis.pictures import DOCS, IMAGES, picture
from benchmarks.thesis.precision import figures
from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.cable.application import Cable
from tautline.study.accuracy.precision import Grid, Row, Study, study
from tautline.study.figures import PANELS, work_precision
from tautline.study.trials.trial import Subject
from tautline.view.figures.figure import QUIET, Figure, axes, label, sample_line, styled

DATA = DOCS.parent / "data"
MESHES = (0.5, 1.0, 2.0, 4.0)
"""Numbers of elements of the hammer bar over the scene's two."""
LEVELS = (0.1, 0.01, 0.001)
"""Errors of position for which the cheapest run is looked for."""
BUDGET = 8.0
"""Wall time, s, that one run may be expected to take."""


class Case(NamedTuple):
    """A scene under study: name of its picture, title, subject, grid, point to look at, times s, what is to be said."""

    name: str
    title: str
    subject: Callable[[float | None], Subject]
    grid: Grid
    point: str | None
    end: float | None
    quick: float
    budget: float
    note: str


def _undamped(end: float | None) -> Subject:
    return Subject(Gardenhose(), hoses.changed({"hose.damping": 0.0}), end=end)


def _shipped(application: type, name: str) -> Callable[[float | None], Subject]:
    return lambda end: Subject(application(), tautline.read(DATA / name), end=end)


CASES = (
    Case("hammer", "Hammer bar, n = 1, 2, 4, 8", _shipped(Cable, "cantilever_bar.yaml"), Grid(elements=MESHES), None,
         20.0, 4.0, BUDGET,
         "`data/cantilever_bar.yaml`, five periods. Its blow begins and ends at once, so its waves have kinks, and "
         "each mesh keeps an error that no step takes away."),
    Case("hose", "Garden hose at 35 m/s", _shipped(Gardenhose, "hose.yaml"), Grid(), None, 0.5, 0.05, BUDGET,
         "`data/hose.yaml`, damped as in Table 2.2: RK4 has steps of 5e-6 s and no use for shorter ones."),
    Case("hose_undamped", "Garden hose at 35 m/s, undamped", _undamped, Grid(), None, 0.5, 0.05, BUDGET,
         "The same without damping (Fig. 2.33)."),
    Case("jwell", "J-well", _shipped(Drillstring, "jwell.yaml"), Grid(), "12", None, 2.0, 2.5 * BUDGET,
         "`data/jwell.yaml`, its bit, static friction 0.3 above kinetic 0.2. RK4 cannot take exact friction and is run "
         "with a regularised law, another problem. Whether a lump stops for a moment or passes decides what follows: "
         "errors fall at once, where the step is short enough to decide alike."),
    Case("hoist", "Hoist", _shipped(Crane, "hoist.yaml"), Grid(), None, None, 0.6, BUDGET,
         "`data/hoist.yaml`, its payload. While the rope is reeled in its elements grow shorter, and RK4's critical "
         "step, which damping sets, with them: what is stable at the start is not at the end."),
)  # fmt: skip


def part(quick: bool) -> str:
    """All scenes, in Markdown."""
    text = (
        "\n### Error against run time of four scenes\n\nWhat `study` finds and advises. Errors are those of "
        "[study.md](study.md): position, of the point named, over the largest way that it goes.\n"
    )
    studies = {case: _study(case, quick) for case in CASES}
    rows = [(case.title, *(_winner(found, level) for level in LEVELS)) for case, found in studies.items()]
    header = ("cheaper, and how many times", *(f"error of position below {100.0 * level:g} %" for level in LEVELS))
    return (
        text
        + "".join(_case(case, found, quick) for case, found in studies.items())
        + "\n#### Where each wins\n\n"
        + table(header, rows)
        + "\nAlone: the other has no run as good in the study's grid, which ends at a quarter of the scene's step. RK4 "
        "has no cheap run with a large error: its stability asks for steps that are more accurate than most "
        "wish. Where its longest step is near what accuracy asks for it wins, by its order; where stiffness or "
        "damping shortens it far below that, and where friction is exact, generalized-α does.\n"
    )


def _study(case: Case, quick: bool) -> Study:
    subject = case.subject(case.quick if quick else case.end)
    budget, repetitions = (1.0, 1) if quick else (case.budget, 5)
    return study(subject, case.grid, budget=budget, repetitions=repetitions, point=case.point, reduced=quick)


def _winner(found: Study, level: float) -> str:
    """Which method is the cheaper for an error, and by how much."""
    runs = {method: cheapest(found.rows, method, level) for method in figures.NAMES}
    good = {method: row.factor or 0.0 for method, row in runs.items() if row is not None}
    if not good:
        return "–"
    best, *others = sorted(good, key=lambda method: good[method])
    more = f", {number(good[others[0]] / good[best])} times" if others else " alone"
    return figures.NAMES[best] + more


def _case(case: Case, found: Study, quick: bool) -> str:
    name = f"precision_{case.name}"
    text = f"{case.title}: error against run time"
    if len(case.grid.elements) > 1:
        image = picture(_figure(found, case.title), name, text, quick)
    else:
        if not quick:
            IMAGES.mkdir(parents=True, exist_ok=True)
            work_precision(found, case.title, IMAGES / f"{name}.png")
        image = f"\n![{text}](images/thesis/{name}.png)\n"
    lines = [f"Point: {found.watched.point}; force: {found.watched.force}.", _of_reference(found)]
    lines += [f"Warning: {warning}." for warning in found.warnings]
    lines.append(f"**Advice: {found.advice}.**")
    return (
        f"\n#### {case.title}\n\n{case.note}\n\n" + "".join(f"- {line}\n" for line in lines) + "\n" + _table(found)
        + image
    )  # fmt: skip


def _of_reference(found: Study) -> str:
    reference = found.reference
    if reference is None:
        return "No reference: no three runs of falling step came to their end."
    mesh = f" from its step and about {reference.mesh_error:.1e} from its mesh" if reference.mesh_error else ""
    proved = "**proved**" if reference.converged else f"**not proved**: {reference.why}"
    return (
        f"Reference: {figures.NAMES.get(reference.setting.method or '', '')}, step {reference.step:.2e} s, {proved}; "
        f"observed order {number(reference.observed_order, 3)}, own error about {reference.error:.1e}{mesh}; load of "
        f"the machine {found.load[0]:.1f} before and {found.load[1]:.1f} after."
    )


def _table(found: Study) -> str:
    """Cheapest runs by method and error."""
    methods = list(dict.fromkeys(row.trial.setting.method or "" for row in found.rows))
    rows = []
    for level in LEVELS:
        cells = []
        for method in methods:
            best = cheapest(found.rows, method, level)
            cells += ["–", "–"] if best is None else [_taken(best), number(best.factor)]
        rows.append((f"{100.0 * level:g} %", *cells))
    heads = [head for m in methods for head in (f"{figures.NAMES.get(m, m)}: cheapest", "real-time factor")]
    return table(("error of position below", *heads), rows)


def cheapest(rows: tuple[Row, ...], method: str, level: float) -> Row | None:
    """The run of a method that takes the least time of those whose position is better than a level."""
    good = [
        r for r in rows if r.trial.setting.method == method and r.errors and r.errors.position <= level and r.factor
    ]
    return min(good, key=lambda row: row.trial.cpu_time or 0.0, default=None)


def _taken(row: Row) -> str:
    setting = row.trial.setting
    text = f"{float(row.trial.attribute('step')):.2g} s"
    if setting.step_error is not None:
        text += f", step error {setting.step_error:.0e} m"
    return text + (f", {setting.elements:g} × the elements" if setting.elements != 1.0 else "")


@styled
def _figure(found: Study, title: str) -> Figure:
    """Work-precision of several meshes."""
    figure, plots = axes(1, len(PANELS), 12.0, 4.6, title, sharex=True)
    meshes = sorted({row.trial.setting.elements for row in found.rows})
    for plot, (kind, text, unit) in zip(plots[0], PANELS, strict=True):
        for place, mesh in enumerate(meshes):
            for method in figures.NAMES:
                rows = [r for r in found.rows if r.trial.setting.elements == mesh and r.trial.setting.method == method]
                points = [(row.factor, getattr(row.errors, kind) if row.errors else None) for row in rows]
                figures.curve(plot, points, method, place)
        plot.set_xlabel(label("real-time factor", "–"))
        plot.set_ylabel(label(text, unit))
    plots[0, 0].axhline(found.tolerance, color=QUIET, lw=1.0, ls=":")
    handles = [*figures.samples([round(2 * mesh) for mesh in meshes])]
    handles.append(sample_line("error asked for", color=QUIET, lw=1.0, ls=":"))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure
