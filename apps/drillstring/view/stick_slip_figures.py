"""The figure of ``stick-slip``: severity over rotary speed and weight on bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drillstring.stick_slip.severity_map import NOT_RUN, Map
from tautline.scene.values.systems import in_system
from tautline.scene.values.units import RPM
from tautline.view.figures.figure import (
    COLOURS,
    SHADE,
    SHADES,
    Axes,
    Figure,
    axes,
    label,
    sample_line,
    save,
    styled,
)

FRAME = COLOURS[1]
"""Colour of the frame of a cell whose bit sticks."""
MOST_NUMBERS = 150
"""Cells up to which each has its number written in it."""
MOST_SEVERE = 2.0
"""Severity at which the colours end: of a bit that sticks it is about one and more."""


def stick_slip_figure(found: Map, title: str, path: Path, system: str = "si") -> Path:
    """Draw a map into a file."""
    return save(draw(found, title, system), path)


@styled
def draw(found: Map, title: str, system: str = "si") -> Figure:
    """Severity as colour and number; a frame where the bit sticks; the name of what stopped a run."""
    share, unit = in_system(1e6, "N", system if system != "si" else "metric")
    force = 1e6 / share
    speeds, weights = np.array(found.speeds) / RPM, np.array(found.weights) / force
    across, up = _edges(speeds), _edges(weights)
    width = 3.2 + min(9.0, max(4.2, 0.75 * speeds.size))
    figure, plots = axes(1, 1, width, 2.0 + min(6.0, max(2.6, 0.55 * weights.size)), title)
    plot = plots[0, 0]
    severity = np.ma.masked_invalid(found.values("severity"))
    plot.set_facecolor(SHADE)
    image = plot.pcolormesh(across, up, severity, cmap=SHADES, vmin=0.0, vmax=MOST_SEVERE)
    plot.grid(False)
    sticks = False
    for i, row in enumerate(found.cells):
        for k, cell in enumerate(row):
            middle = 0.5 * (across[k] + across[k + 1]), 0.5 * (up[i] + up[i + 1])
            if cell.status != "done":
                words = "" if cell.status == NOT_RUN else cell.status.replace(" ", "\n")
                plot.text(*middle, words, ha="center", va="center", fontsize=7, color="black")
                continue
            if severity.size <= MOST_NUMBERS:
                dark = cell.severity < 0.6 * MOST_SEVERE
                words = cell.told.replace(" ", "\n")
                plot.text(*middle, words, ha="center", va="center", fontsize=8, color="w" if dark else "k")
            if cell.sticks:
                sticks = True
                _frame(plot, across[k : k + 2], up[i : i + 2])
    plot.set_xlabel(label("rotary speed", "rpm"))
    plot.set_ylabel(label("weight on bit", unit))
    plot.set_xticks(speeds[:: max(1, speeds.size // 12)])
    plot.set_yticks(weights[:: max(1, weights.size // 12)])
    bar = figure.colorbar(image, ax=plot, aspect=30, pad=0.02, extend="max")
    bar.set_label("severity, (max − min) / (2 mean) of the bit's speed")
    bar.outline.set_visible(False)
    handles = [sample_line("the bit sticks", color=FRAME, lw=2)] if sticks else []
    done = [cell for row in found.cells for cell in row if cell.status == "done"]
    causes = ["stopped early"] if found.failures else []
    if grey := causes + sorted({cell.told for cell in done if cell.dies_out or not cell.judged}):
        handles.append(sample_line(f"grey: {', '.join(grey)}", color=SHADE, lw=6))
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


def _frame(plot: Axes, across: np.ndarray, up: np.ndarray) -> None:
    """Draw around a cell, a little inside it."""
    left, right = across + 0.04 * (across[1] - across[0]) * np.array([1.0, -1.0])
    low, high = up + 0.06 * (up[1] - up[0]) * np.array([1.0, -1.0])
    plot.plot([left, right, right, left, left], [low, low, high, high, low], color=FRAME, lw=2)


def _edges(middles: np.ndarray) -> np.ndarray:
    """Edges (n + 1,) of cells about values (n,)."""
    if middles.size == 1:
        half = 0.5 * abs(middles[0]) or 0.5
        return np.array([middles[0] - half, middles[0] + half])
    inner = 0.5 * (middles[1:] + middles[:-1])
    return np.concatenate([[2.0 * middles[0] - inner[0]], inner, [2.0 * middles[-1] - inner[-1]]])
