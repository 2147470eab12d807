"""What a run did to its rope: ranges of tension, and bending piece by piece."""

from __future__ import annotations

from typing import Any

import numpy as np

from crane.results.course import Course
from crane.results.summary import bending_of, most_worked_end
from crane.rope_life.fatigue import SLOPE, equivalent_range
from tautline.view.figures.figure import COLOURS, QUIET, SHADES, Axes, Figure, axes, label, scale, styled

CLASSES = 20
"""Of tension ranges in a histogram."""
MOST_CONTACTS = len(COLOURS)
HALF = 0.5


@styled
def rainflow_figure(time: np.ndarray, tension: np.ndarray, names: list[str], title: str) -> Figure:
    """Rainflow cycles of the most worked span end by range and by mean, and the one range that does as much.

    Parameters
    ----------
    time : (m,) array
        s.
    tension : (m, n) array
        N.
    names : list of str
        Of the n columns.
    """
    worst, cycles = most_worked_end(time, tension)
    factor, unit = scale([tension[:, worst]], "N")
    figure, plots = axes(1, 2, 9.0, 4.2, title, width_ratios=(1.4, 1.0))
    count, mean = plots[0]
    if cycles.range.size:
        top = float(cycles.range.max()) / factor
        edges = np.linspace(0.0, top * (1.0 + 1e-9), CLASSES + 1)
        heights, _ = np.histogram(cycles.range / factor, edges, weights=cycles.count)
        count.bar(edges[:-1], heights, width=np.diff(edges), align="edge", color=COLOURS[0], ec="white", lw=0.5)
        count.set_yscale("log")
        count.set_ylim(0.5 * HALF, 2.0 * max(float(heights.max()), 1.0))
        size = equivalent_range(cycles, SLOPE)
        words = f"equivalent range {size / factor:.3g} {unit}, {float(cycles.count.sum()):g} cycles, exponent {SLOPE:g}"
        count.axvline(size / factor, color=COLOURS[1], lw=1.4, label=words)
        figure.legend(loc="outside lower center")
        area = 12.0 + 12.0 * np.minimum(cycles.count, 4.0)
        mean.scatter(cycles.mean / factor, cycles.range / factor, s=area, color=COLOURS[0], alpha=0.6, lw=0)
        mean.set_ylim(0.0, 1.08 * top)
    else:
        for plot in (count, mean):
            plot.text(0.5, 0.5, "nothing varies", transform=plot.transAxes, ha="center", color=QUIET)
    count.set_title(names[worst], fontsize=10)
    count.set_xlabel(label("range of tension", unit))
    count.set_ylabel(label("cycles", "–"))
    mean.set_xlabel(label("mean tension", unit))
    mean.set_ylabel(label("range of tension", unit))
    return figure


@styled
def bending_figure(result: Any, course: Course, title: str) -> Figure | None:
    """Bending cycles of every piece of rope by the wheel that made them, and the tension while bent; None for none."""
    found = bending_of(result, course)
    if found is None:
        return None
    figure, plots = axes(2, 1, 8.0, 5.4, title, sharex=True, height_ratios=(1.6, 1.0))
    upper, lower = plots[:, 0]
    left, width = found.edges[:-1], np.diff(found.edges)
    few = len(found.contacts) <= MOST_CONTACTS
    below = np.zeros(len(left))
    for k, name in enumerate(found.contacts):
        colour = COLOURS[k] if few else SHADES(k / (len(found.contacts) - 1))
        share = found.by_contact[:, k]
        words = name if few or k in (0, len(found.contacts) - 1) else f"_{name}"
        upper.bar(left, share, bottom=below, width=width, align="edge", color=colour, lw=0, label=words)
        below = below + share
    upper.set_ylim(0.0, max(1.0, 1.1 * float(below.max())))
    upper.set_ylabel(label("bending cycles", "–"))
    factor, unit = scale([found.tension], "N")
    lower.step(found.edges, np.r_[found.tension, found.tension[-1:]] / factor, where="post", color=COLOURS[6], lw=1.1)
    lower.set_ylim(0.0, max(1e-3, 1.1 * float(found.tension.max()) / factor))
    lower.set_ylabel(label("largest tension\nwhere bent", unit))
    lower.set_xlabel(label("piece of rope: material coordinate p", "m"))
    lower.set_xlim(found.edges[0], found.edges[-1])
    _ratio(upper, found.ratio)
    upper.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, borderaxespad=0.2)
    return figure


def _ratio(plot: Axes, ratio: np.ndarray | None) -> None:
    if ratio is not None and np.isfinite(ratio).any():
        plot.set_title(f"smallest D/d {float(ratio.min()):.3g}", loc="right", fontsize=9)
