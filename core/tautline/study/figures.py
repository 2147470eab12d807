"""Work-precision: errors against the real-time factor, one curve for a method."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tautline.view.figure import COLOURS, QUIET, Axes, axes, label, save, styled

if TYPE_CHECKING:
    from tautline.study.precision import Row, Study

MARKS = "osD^vP*X"
LEAST = 1.0e-16
"""Error that is drawn for none: a logarithm needs one."""
PANELS = (("position", "position error", ""), ("force", "force amplitude error", ""), ("phase", "phase error", "rad"))


@styled
def work_precision(study: Study, title: str, path: Path) -> Path:
    """Draw a study into a file.

    Raises
    ------
    ResultError
        If it cannot be written.
    """
    kinds = [panel for panel in PANELS if any(_error(row, panel[0]) is not None for row in study.rows)]
    kinds = kinds or [PANELS[0]]
    figure, plots = axes(1, len(kinds), 0.8 + 3.9 * len(kinds), 4.4, title, sharex=True)
    curves = _curves(study.rows)
    for plot, (kind, text, unit) in zip(plots[0], kinds, strict=True):
        for number, (name, rows) in enumerate(curves.items()):
            _curve(plot, rows, kind, name, number)
        _frame(plot, study, kind)
        plot.set_xlabel("real-time factor")
        plot.set_ylabel(label(text, unit))
    handles, labels = plots[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(4, max(1, len(labels))))
    return save(figure, path)


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
        if several:
            name += f", elements x {setting.elements:g}"
        found.setdefault(name, []).append(row)
    return found


def _curve(plot: Axes, rows: Sequence[Row], kind: str, name: str, number: int) -> None:
    shown = [(row.factor, max(error, LEAST)) for row in rows if row.factor and (error := _error(row, kind)) is not None]
    look = {"color": COLOURS[number % len(COLOURS)], "marker": MARKS[number % len(MARKS)], "ms": 5.0}
    if shown:
        plot.loglog(*np.array(sorted(shown)).T, label=name, **look)
    else:
        plot.loglog([], [], label=f"{name}: none came to its end", **look)


def _frame(plot: Axes, study: Study, kind: str) -> None:
    """Real time, the error asked for, and what the reference cannot tell."""
    plot.axvline(1.0, color=QUIET, lw=1.2, ls="--", label="real time")
    if kind == "position":
        plot.axhline(study.tolerance, color=QUIET, lw=1.0, ls=":", label="error asked for")
        if study.reference is not None:
            low = plot.get_ylim()[0]
            if study.reference.error > low:
                plot.axhspan(low, study.reference.error, color="#F2F2F2", lw=0, label="below the reference's own error")
                plot.set_ylim(bottom=low)
