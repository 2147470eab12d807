"""The house style of figures: size, type, colours that everyone can tell apart, units at every axis.

Figures are made without pyplot, so they need no display and no backend: saving one chooses what its format wants.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes as Axes
from matplotlib.figure import Figure as Figure

from tautline.results.errors import ResultError

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's colours (jfly.uni-koeln.de/color), told apart by colour-blind readers; yellow is left out."""

QUIET = "#9A9A9A"
SHADE = "#EDEDED"

STYLE: dict[Any, Any] = {
    "figure.dpi": 100,
    "savefig.dpi": 160,
    "font.size": 10,
    "axes.labelsize": 10,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "axes.prop_cycle": cycler(color=COLOURS),
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}

styled = matplotlib.rc_context(STYLE)
"""Decorator of every function that draws: the style holds inside it, and a user's own settings are left alone."""

PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"))


def axes(
    rows: int = 1, columns: int = 1, width: float = 8.0, height: float = 4.5, title: str = "", **subplots: Any
) -> tuple[Figure, np.ndarray]:
    """Make a figure; call it from a function decorated with `styled`.

    Parameters
    ----------
    rows, columns : int
        Number of plots.
    width, height : float
        Size of the whole figure, inches.
    title : str
        Heading of the figure.
    **subplots
        Passed on to ``Figure.subplots``: ``sharex``, ``width_ratios`` and so on.

    Returns
    -------
    figure : Figure
        Unknown to pyplot: it needs no closing.
    plots : (rows, columns) array of Axes
    """
    figure = Figure(figsize=(width, height), layout="constrained")
    plots = figure.subplots(rows, columns, squeeze=False, **subplots)
    if title:
        figure.suptitle(title, x=0.01, ha="left", fontsize=12)
    return figure, plots


def scale(values: Sequence[np.ndarray], unit: str) -> tuple[float, str]:
    """Choose the factor to divide by and the unit to write, so that labels stay short: N -> (1e6, "MN").

    Units other than forces, moments and energies stay as they are.
    """
    if unit not in ("N", "N m", "J", "W", "Pa"):
        return 1.0, unit
    largest = max((float(np.max(np.abs(array))) for array in values if array.size), default=0.0)
    for factor, letter in PREFIXES:
        if largest >= factor:
            return factor, letter + unit
    return 1.0, unit


def label(text: str, unit: str) -> str:
    """Axis label: ``hook load [MN]``."""
    return f"{text} [{unit}]" if unit else text


def widen(plot: Axes, values: np.ndarray, least: float) -> None:
    """Keep a vertical axis from blowing rounding up: it spans at least `least`, in the axis' unit, about the values."""
    low, high = (float(np.min(values)), float(np.max(values))) if values.size else (0.0, 0.0)
    if high - low < least:
        middle = 0.5 * (low + high)
        plot.set_ylim(middle - 0.55 * least, middle + 0.55 * least)


def shade(plot: Axes, time: np.ndarray, flags: np.ndarray, colour: str = SHADE, text: str = "") -> None:
    """Shade the times at which flags is true.

    Parameters
    ----------
    time : (n,) array
    flags : (n,) array of bool
        A frame's flag holds halfway to its neighbours.
    """
    if time.size < 2 or not flags.any():
        return
    edges = np.concatenate([time[:1], 0.5 * (time[1:] + time[:-1]), time[-1:]])
    changes = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    for number, (first, last) in enumerate(changes.reshape(-1, 2)):
        words = text if number == 0 else "_" + text
        plot.axvspan(edges[first], edges[last], color=colour, lw=0, zorder=0, label=words)


@styled
def save(figure: Figure, path: str | Path) -> Path:
    """Write a figure; the ending of the name says the format.

    Raises
    ------
    ResultError
        If the file cannot be written, or the format is unknown.
    """
    path = Path(path)
    try:
        figure.savefig(path)
    except OSError as error:
        raise ResultError(path, f"cannot be written: {error.strerror}", "name another with -o") from None
    except ValueError as error:
        raise ResultError(path, f"cannot be written: {error}", "use png, svg or pdf") from None
    return path


def save_all(figures: Mapping[str, Figure], folder: Path, stem: str, formats: Sequence[str], whole: bool) -> list[Path]:
    """Write figures as ``stem_name.format``, or as ``stem.format`` if there is one figure and `whole` says so."""
    written = []
    for name, figure in figures.items():
        base = stem if whole and len(figures) == 1 else f"{stem}_{name}"
        written += [save(figure, folder / f"{base}.{ending}") for ending in formats]
    return written
