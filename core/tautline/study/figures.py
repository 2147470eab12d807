"""Work-precision: errors against the real-time factor, one curve for a method."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import polynomial

from tautline.scene.methods import method_of
from tautline.study.robustness.penalties import Stiffness
from tautline.view.figures.figure import COLOURS, QUIET, Axes, Figure, axes, label, save, styled

if TYPE_CHECKING:
    from tautline.study.accuracy.precision import Row, Study
    from tautline.study.robustness.stability import Stability

MARKS = "osD^vP*X"
LINES = ("-", "--", ":", "-.")
SHORTENED: dict[str, Any] = {"ls": "", "marker": "o", "ms": 10.0, "mfc": "none", "mec": "black", "mew": 1.0}
"""A ring about a run that took shorter steps than asked for."""
LEAST = 1.0e-16
"""Error that is drawn for none: a logarithm needs one."""
PANELS = (
    ("position", "position error", ""), ("force", "force amplitude error", ""), ("twist", "twist error", ""),
    ("phase", "phase error", "rad"),
)  # fmt: skip


@styled
def work_precision(study: Study, title: str, path: Path) -> Path:
    """Draw a study into a file.

    Raises
    ------
    ResultError
        If it cannot be written.
    """
    if any(row.trial.done for row in study.rows) and not any(row.errors is not None for row in study.rows):
        return save(_nothing_to_draw(study, title), path)
    kinds = [panel for panel in PANELS if any(_error(row, panel[0]) is not None for row in study.rows)]
    kinds = kinds or [PANELS[0]]
    figure, plots = axes(1, len(kinds), 0.8 + 3.9 * len(kinds), 4.4, title, sharex=True)
    curves = _curves(study.rows)
    for plot, (kind, text, unit) in zip(plots[0], kinds, strict=True):
        for name, rows in curves.items():
            _curve(plot, rows, kind, name, _look(rows, curves))
        if not any(line.get_xdata().size for line in plot.lines):
            plot.set_xlim(1e-4, 2.0)
            plot.set_ylim(1e-6, 2.0)
        _frame(plot, study, kind)
        plot.set_xlabel("real-time factor")
        plot.set_ylabel(label(text, unit))
    if any(row.shortened for row in study.rows if row.errors is not None):
        plots[0, 0].plot([], [], label="took shorter steps than asked for", **SHORTENED)
    _legend_below(figure, *plots[0, 0].get_legend_handles_labels())
    return save(figure, path)


def _nothing_to_draw(study: Study, title: str) -> Figure:
    """A figure with a sentence: why there is no error."""
    figure, plots = axes(1, 1, 4.7, 4.4, title)
    done = sum(row.trial.done for row in study.rows)
    text = f"Runs that came to their end: {done} of {len(study.rows)}.\nThere is no reference to judge them by."
    plots[0, 0].text(0.5, 0.5, text, ha="center", va="center", transform=plots[0, 0].transAxes, color=QUIET)
    plots[0, 0].set_axis_off()
    return figure


def _legend_below(figure: Figure, handles: Sequence[Any], labels: Sequence[str]) -> None:
    """A legend below all plots, of as many columns as the figure is wide, four at most."""
    for columns in range(min(4, max(1, len(labels))), 0, -1):
        legend = figure.legend(handles, labels, loc="outside lower center", ncols=columns)
        if columns == 1 or legend.get_window_extent().width < 0.97 * figure.bbox.width:
            return
        legend.remove()


def _error(row: Row, kind: str) -> float | None:
    return None if row.errors is None else getattr(row.errors, kind)


def _curves(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Runs that differ in their step alone, by what is said of them."""
    found: dict[str, list[Row]] = {}
    several = len({row.trial.setting.elements for row in rows}) > 1
    for row in rows:
        setting = row.trial.setting
        name = setting.method or "scene's method"
        if setting.step_error is not None:
            name += ", error controlled"
        if setting.constraint is not None:
            name += f", {setting.constraint}"
        if setting.newton is not None:
            name += f", {setting.newton} Newton"
        if several:
            name += f", elements x {setting.elements:g}"
        found.setdefault(name, []).append(row)
    return found


def _look(rows: Sequence[Row], curves: dict[str, list[Row]]) -> dict[str, Any]:
    """Colour by mesh and constraint where there are several, else by method; line and mark by method."""
    kinds = list(dict.fromkeys(_kind(each[0]) for each in curves.values()))
    methods = list(dict.fromkeys(_method(each[0]) for each in curves.values()))
    method = methods.index(_method(rows[0]))
    colour = kinds.index(_kind(rows[0])) if len(kinds) > 1 else method
    return {
        "color": COLOURS[colour % len(COLOURS)], "marker": MARKS[method % len(MARKS)], "ms": 5.0,
        "ls": LINES[method % len(LINES)] if len(kinds) > 1 else "-", "mfc": "white" if method % 2 else None,
    }  # fmt: skip


def _kind(row: Row) -> tuple[float, str | None]:
    return row.trial.setting.elements, row.trial.setting.constraint


def _method(row: Row) -> tuple[str | None, str | None, bool]:
    return row.trial.setting.method, row.trial.setting.newton, row.trial.setting.step_error is not None


def _curve(plot: Axes, rows: Sequence[Row], kind: str, name: str, look: dict[str, Any]) -> None:
    # Joined from step to step: two runs whose times are the same but for noise would else change places.
    ordered = sorted(rows, key=_fineness, reverse=True)
    judged = [row for row in ordered if row.factor and _error(row, kind) is not None]
    shown = [(row.factor, max(_error(row, kind) or 0.0, LEAST)) for row in judged]
    if shown:
        plot.loglog(*np.array(shown).T, label=name, **look)
        short = [place for place, row in zip(shown, judged, strict=True) if row.shortened]
        if short:
            plot.plot(*np.array(short).T, **SHORTENED)
    else:
        why = "no error was found" if any(row.trial.done for row in rows) else "none came to its end"
        plot.loglog([], [], label=f"{name}: {why}", **look)


def _fineness(row: Row) -> float:
    """The step that a run took, s, or the error that its steps were controlled by."""
    setting = row.trial.setting
    return float(setting.step_error if setting.step_error is not None else row.trial.attribute("step") or 0.0)


def _frame(plot: Axes, study: Study, kind: str) -> None:
    """Real time, the error asked for, and what the reference cannot tell."""
    plot.axvline(1.0, color=QUIET, lw=1.2, ls="--", label="real time")
    if kind == "position":
        plot.axhline(study.tolerance, color=QUIET, lw=1.0, ls=":", label="error asked for")
        if study.reference is not None:
            low, high = plot.get_ylim()
            if low < study.reference.error < high:
                plot.axhspan(low, study.reference.error, color="#F2F2F2", lw=0, label="below the reference's own error")
                plot.set_ylim(bottom=low)


@styled
def stability_figure(found: Stability, title: str, path: Path) -> Path:
    """Draw the region of stability with the scene's eigenvalues in it, and what springs do to the step.

    Raises
    ------
    ResultError
        If it cannot be written.
    """
    springs = [entry for entry in found.penalties if entry.critical_step is not None]
    columns = 1 + bool(springs)
    figure, plots = axes(1, columns, 1.0 + 4.6 * columns, 4.6, title)
    _region(plots[0, 0], found)
    if springs:
        _springs(plots[0, 1], springs)
    return save(figure, path)


def _region(plot: Axes, found: Stability) -> None:
    """Eigenvalues times a step, where one step of the explicit method does not grow."""
    method = method_of(found.critical.method)
    x, y = np.meshgrid(np.linspace(-3.2, 0.8, 300), np.linspace(-3.4, 3.4, 400))
    growth = np.abs(polynomial.polyval(x + 1j * y, method.polynomial))
    plot.contourf(x, y, growth, levels=[0.0, 1.0], colors=["#E3EEF6"])
    step = found.critical.eigenvalue
    if step is not None and found.critical.points.size:
        z = step * found.critical.points
        plot.plot(z.real, z.imag, ".", color=COLOURS[0], ms=5.0, label=f"eigenvalues x {step:.3g} s")
        inside = (z.real < 0.8) & (z.real > -3.2) & (np.abs(z.imag) < 3.4)
        plot.legend(loc="upper right", title="" if inside.all() else f"{int((~inside).sum())} outside")
    plot.set_aspect("equal")
    plot.set_xlabel("Re h λ")
    plot.set_ylabel("Im h λ")
    plot.set_title(f"stability region of {method.name}")


def _springs(plot: Axes, springs: Sequence[Stiffness]) -> None:
    for number, kind in enumerate(dict.fromkeys(entry.kind for entry in springs)):
        points = [(entry.value, entry.critical_step) for entry in springs if entry.kind == kind]
        plot.loglog(*np.array(points).T, marker=MARKS[number], color=COLOURS[number], label=kind)
    plot.legend()
    plot.set_xlabel(label("stiffness of springs", "N/m"))
    plot.set_ylabel(label("critical step at the start", "s"))
